"""Which boards know their origin."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

import numpy as np

from cvnotes.base import Array
from cvnotes.tutor import Case, Exercise, Property, mistakes


def knows_its_origin(columns: Array, rows: Array) -> Array:
    """Return for each board whether half a turn changes how it looks."""
    return np.asarray((columns + rows) % 2 == 1, dtype=float)


def _boards(_: np.random.Generator) -> list[Case]:
    counts = [(9, 6), (8, 6), (7, 7), (5, 4), (7, 5), (3, 2), (8, 8), (12, 9), (4, 9), (11, 3)]
    columns, rows = np.array(counts).T
    return [Case((columns[:4], rows[:4])), Case((columns, rows))]


MISTAKES = mistakes(
    ("different counts", "That is what the notes ask for, and it is not enough: 8 × 6 differ, and "
     "the board looks the same after half a turn. What must differ is the parity.",
     lambda c, r: c != r),
    ("even or odd alone",
     "With two even counts, or two odd ones, the board looks the same after half a turn.",
     lambda c, r: c * r % 2 == 0, lambda c, r: (c % 2 == 1) | (r % 2 == 1),
     lambda c, r: c * r % 2 == 1, lambda c, r: (c % 2 == 0) & (r % 2 == 0)),
    ("no common divisor", "What the counts share does not matter: 9 × 6 is fine, although both are "
     "divisible by 3. One count must be even and the other odd.",
     lambda c, r: np.gcd(c, r) == 1),
    ("counts that differ by one", "Counts that differ by 1 do, but others do so too.",
     lambda c, r: np.abs(c - r) == 1),
    ("columns only", "One count alone does not tell: 7 × 7, 8 × 6 look the same after half a turn.",
     lambda c, r: c % 2 == 1, lambda c, r: r % 2 == 0, lambda c, r: c % 2 == 0,
     lambda c, r: r % 2 == 1),
    ("more columns than rows", "Which count is larger, or which comes first, does not matter.",
     lambda c, r: c > r, lambda c, r: ((c + r) % 2 == 1) & (c > r),
     lambda c, r: ((c + r) % 2 == 1) & (r > c), lambda c, r: (c % 2 == 1) & (r % 2 == 0),
     lambda c, r: (c % 2 == 0) & (r % 2 == 1)),
    ("equal counts", "7 × 7 looks the same even after a quarter turn.",
     lambda c, r: c == r),
)  # fmt: skip


EXERCISE = Exercise(
    name="knows_its_origin",
    chapter=5,
    title="Which boards know their origin?",
    task="For boards with `columns` × `rows` inner corners, arrays (n,) of whole numbers, tell "
    "whether the board looks different after half a turn, so that a picture tells where its first "
    "corner is: True or False, shape (n,).",
    hints=(
        "Draw 2 × 2, 3 × 2 and 3 × 3 inner corners, and turn the paper.",
        "Half a turn exchanges opposite corner squares. When do they have one colour?",
        "A board has (columns + 1) × (rows + 1) squares; colours alternate.",
    ),
    cases=_boards,
    properties=(Property("It is so exactly if one count is even and the other odd."),),
    misconceptions=MISTAKES,
    reference=knows_its_origin,
    concepts=("39", "k", "E18"),
)
