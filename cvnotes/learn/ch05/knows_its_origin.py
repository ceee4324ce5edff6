"""Which boards know their origin."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng


def knows_its_origin(columns: Array, rows: Array) -> Array:
    """Tell for boards of so many inner corners whether half a turn changes how they look."""
    return np.asarray((columns + rows) % 2 == 1, dtype=float)


def _boards(_: Rng) -> list[Case]:
    counts = [(9, 6), (8, 6), (7, 7), (5, 4), (7, 5), (3, 2), (8, 8), (12, 9), (4, 9), (11, 3)]
    columns, rows = np.array(counts).T
    return [Case((columns[:4], rows[:4])), Case((columns, rows))]


ORIGIN = Exercise(
    name="knows_its_origin",
    chapter=5,
    title="Which boards know their origin?",
    task="For boards with `columns` × `rows` inner corners, arrays (n,) of whole numbers, tell "
    "whether the board looks different after half a turn, so that a picture tells where its first "
    "corner is: True or False, shape (n,).",
    stub='''def my_knows_its_origin(columns, rows):
    """Tell for each board whether half a turn changes how it looks."""
    ...''',
    hints=(
        "Draw 2 × 2, 3 × 2 and 3 × 3 inner corners, and turn the paper.",
        "Half a turn exchanges opposite corner squares. When do they have one colour?",
        "A board has (columns + 1) × (rows + 1) squares; colours alternate.",
    ),
    cases=_boards,
    properties=(Property("It is so exactly if one count is even and the other odd."),),
    misconceptions=(
        Misconception(
            "different counts",
            "That is what the notes ask for, and it is not enough: 8 × 6 differ, and the board "
            "looks the same after half a turn. What must differ is the parity.",
            lambda c, r: c != r,
        ),
        Misconception(
            "the other way round",
            "These are the boards that look the same after half a turn.",
            lambda c, r: (c + r) % 2 == 0,
        ),
        Misconception(
            "one count even",
            "One even count is not enough: with two even ones the board looks the same after "
            "half a turn.",
            lambda c, r: (c * r) % 2 == 0,
        ),
        Misconception(
            "one count odd",
            "One odd count is not enough: with two odd ones the board looks the same after half "
            "a turn.",
            lambda c, r: (c % 2 == 1) | (r % 2 == 1),
        ),
        Misconception(
            "no common divisor",
            "What the counts share does not matter: 9 × 6 is fine, although both are divisible "
            "by 3. One count must be even and the other odd.",
            lambda c, r: np.gcd(c, r) == 1,
        ),
        Misconception(
            "counts that differ by one",
            "Counts that differ by 1 do, but those that differ by 3, or by 5, do so too.",
            lambda c, r: np.abs(c - r) == 1,
        ),
        Misconception(
            "columns only",
            (
                "An odd number of columns is not enough: 7 × 7 looks the same after half a turn. "
                "Rows count too."
            ),
            lambda c, r: c % 2 == 1,
        ),
        Misconception(
            "rows only",
            (
                "The rows alone do not tell: 8 × 6 looks the same after half a turn. Columns "
                "count too."
            ),
            lambda c, r: r % 2 == 0,
        ),
        Misconception(
            "both counts odd",
            ("With two odd counts the board looks the same after half a turn; one has to be even."),
            lambda c, r: (c * r) % 2 == 1,
        ),
        Misconception(
            "more columns than rows",
            "Which count is larger does not matter: one must be even and the other odd.",
            lambda c, r: c > r,
        ),
        Misconception(
            "every board",
            "You say that all boards do; 8 × 6 looks the same after half a turn.",
            lambda c, r: np.ones(len(c)),
        ),
        Misconception(
            "one count odd, the wide ones only",
            "You say so of wide boards alone; which count is larger does not matter.",
            lambda c, r: ((c + r) % 2 == 1) & (c > r),
        ),
        Misconception(
            "the upright ones only",
            "You say so of upright boards alone; which count is larger does not matter.",
            lambda c, r: ((c + r) % 2 == 1) & (r > c),
        ),
        Misconception(
            "odd columns, even rows",
            "You want one count odd and the other even in this order alone; the other order is "
            "as good.",
            lambda c, r: (c % 2 == 1) & (r % 2 == 0),
            variants=(lambda c, r: (c % 2 == 0) & (r % 2 == 1),),
        ),
        Misconception(
            "both counts even",
            "With two even counts the board looks the same after half a turn.",
            lambda c, r: (c % 2 == 0) & (r % 2 == 0),
        ),
        Misconception(
            "even columns",
            "An even number of columns is not enough: 8 × 6 looks the same after half a turn.",
            lambda c, r: c % 2 == 0,
        ),
        Misconception(
            "odd rows",
            "An odd number of rows is not enough: 7 × 7 looks the same after half a turn.",
            lambda c, r: r % 2 == 1,
        ),
        Misconception(
            "equal counts",
            "7 × 7 looks the same even after a quarter turn.",
            lambda c, r: c == r,
        ),
        Misconception(
            "no board",
            "You say that no board does; 9 × 6 looks different after half a turn.",
            lambda c, r: np.zeros(len(c)),
        ),
    ),
    reference=knows_its_origin,
    concepts=("39", "k", "E18"),
    sources=(knows_its_origin,),
)
