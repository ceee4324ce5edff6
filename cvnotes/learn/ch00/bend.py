"""How much a row bends."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _rows(rng: np.random.Generator) -> list[Case]:
    by_hand = np.array([[0.0, 0.0], [2.0, 4.0], [6.0, 8.0]])
    along = np.linspace(0, 300, 7)[:, None] * np.array([[0.6, 0.8]])
    bow = np.array([0.0, 1.0, 1.8, 2.5, 1.6, 0.9, 0.0])[:, None] * np.array([[-0.8, 0.6]])
    many = rng.uniform(20, 400, 2) + along + rng.choice([-1.0, 1.0]) * bow
    wave = np.array([[0.0, 0.0], [12.0, 10.0], [18.0, 20.0], [32.0, 28.0], [40.0, 40.0]])
    upright = np.array([[50.0, 10.0], [53.0, 40.0], [51.0, 70.0], [50.0, 100.0]])
    return [
        Case((by_hand,)),
        Case((rounded(many, 2),)),
        Case((rounded(many[:, ::-1], 2),)),
        Case((wave,)),
        Case((upright,), about="upright"),
    ]


def bend(row: Array) -> float:
    """Return how far points (n, 2) lie at most from the line through first and last."""
    d = row[-1] - row[0]  # the way from the first point to the last
    n = np.array([-d[1], d[0]])  # a normal of the line
    u = n / np.linalg.norm(d)  # the normal, of length 1
    across = (row - row[0]) @ u  # how far each point is from the line, with a sign
    return np.abs(across).max()


MISTAKES = mistakes_in(bend,
    ("measured straight down", "You measured straight down, or across; the distance from a "
     "line is at right angles to it.",
     "np.abs(across).max() * np.linalg.norm(d) / abs(d[0])",
     "np.abs(across).max() * np.linalg.norm(d) / abs(d[1])"),
    ("equal steps", "You compared with equal steps along the line. The points need not be spaced "
     "evenly; measure at right angles to the line.",
     "np.linalg.norm(row - np.linspace(row[0], row[-1], len(row)), axis=1).max()",
     "np.abs(row - np.linspace(row[0], row[-1], len(row)))[:, 1].max()",
     "np.abs(row - np.linspace(row[0], row[-1], len(row)))[:, 0].max()"),
    ("sign kept", "You took the largest without abs(): points on the other side count as negative.",
     "across.max()", "(-across).max()"),
    ("along for across",
     "That is how far the points reach along the line. Turn its direction by 90° first.",
     ("@ u", "@ d / np.linalg.norm(d)"), "np.linalg.norm(row - row[0], axis=1).max()"),
    ("mean for the largest", "You took a mean of the distances; asked is the largest.",
     "np.abs(across).mean()", "np.sqrt((across**2).mean())"),
    ("a level line",
     "You measured from a level line through the first point. The row may be tilted.",
     "np.abs(row[:, 1] - row[0, 1]).max()", "np.ptp(row[:, 1])"),
    ("the point in the middle",
     "You measured the point in the middle; it need not be the farthest from the line.",
     "np.abs(across)[len(row) // 2]"),
    ("both sides added",
     "You added the largest distances of the two sides; asked is the larger one.",
     "np.ptp(across)"),
)  # fmt: skip


EXERCISE = Exercise(
    name="bend",
    chapter=0,
    title="How much does a row bend?",
    task="Give the largest distance, in pixels, of points row, shape (n, 2), from the straight "
    "line through the first and the last of them.",
    hints=(
        "row[-1] - row[0] leads along the line. Divide it by its length: np.linalg.norm.",
        "Turned by 90°, (a, b) becomes (−b, a). The dot product of row - row[0] with it, for all "
        "points at once by @, is how far they are from the line, with a sign.",
        "np.abs(…).max() is the largest of these distances.",
    ),
    cases=_rows,
    properties=(
        Property("The distance is the one of the point that is farthest from the line."),
        Property("It is right for a row that stands upright.", about="upright"),
    ),
    misconceptions=MISTAKES,
    steps=bend,
    concepts=("28",),
)
