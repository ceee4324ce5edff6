"""The focal length from a camera that turns on the spot: no board, no distances."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import ABOUT_X, ABOUT_Y, rounded, some_factors, some_rotation
from cvnotes.tutor import Case, Exercise, Property, mistakes_in

# About x and y at once, f = 300: the axis is at 45° to both.
_ABOUT_BOTH = np.array([[2.0, 1, 600], [1, 2, -600], [-1 / 150, 1 / 150, 1]])


def _turn(f: float, R: Array, factor: float = 1.0) -> Array:
    A = np.diag([f, f, 1.0])
    return np.asarray(factor * A @ R @ np.linalg.inv(A))


def _turns(rng: np.random.Generator) -> list[Case]:
    f, g = rounded(rng.uniform(500, 900, 2), 1)
    first, second = some_factors(rng, 2)
    return [
        Case((_turn(500.0, ABOUT_Y),), about="about the vertical"),
        Case((_turn(500.0, ABOUT_X @ ABOUT_Y),)),
        Case((_ABOUT_BOTH,), about="an axis at 45°"),
        Case((_turn(float(f), some_rotation(rng), float(first)),)),
        Case((_turn(float(g), some_rotation(rng), float(second)),)),
    ]


def focal_from_turn(H: Array) -> float:
    """Return f in pixels from H (3, 3), of any scale and sign."""
    column = np.hypot(H[0, 2], H[1, 2])  # the length of the last column without its last entry
    row = np.hypot(H[2, 0], H[2, 1])  # the length of the last row without its last entry
    return np.sqrt(column / row)


_MISTAKES = mistakes_in(focal_from_turn,
    ("scale believed", "You took the scale of H for that of a rotation, and H comes in any scale.",
     "np.sqrt(H[:2, 2] @ H[:2, 2] / (1 - H[2, 2]**2))",
     ("    column =", "    H = H / np.linalg.norm(H); column =",
      "np.sqrt(H[:2, 2] @ H[:2, 2] / (1 - H[2, 2]**2))")),
    ("h33 made 1", "H with h33 = 1 is no turn: in which ratio does the scale cancel?",
     "float(np.linalg.norm(H[:2, 2] / H[2, 2]))"),
    ("entries for lengths", "You compared single entries; they are of one size only if the "
     "camera turns about the vertical.",
     "np.sqrt(abs(H[0, 2] / H[2, 0]))", "np.sqrt(abs(H[1, 2] / H[2, 1]))",
     "np.sqrt(np.abs(H[:2, 2] / H[2, :2]).mean())"),
    ("one right angle", "You used that the first two rows are perpendicular. It holds, but about "
     "the vertical it reads 0 = 0 and says nothing.",
     "np.sqrt(-H[0, 2] * H[1, 2] / (H[0, 0] * H[1, 0] + H[0, 1] * H[1, 1]))"),
    ("only the column", "That is f times the sine of the angle between the two optical axes.",
     "column / abs(np.cbrt(np.linalg.det(H)))", "column"),
    ("whole columns", "You took whole columns and rows. Does f stand in all of their entries?",
     "float(np.sqrt(np.linalg.norm(H[:, 2]) / np.linalg.norm(H[2])))"),
    ("sums for lengths", "You added entries for a length, and they may have either sign.",
     "float(np.sqrt(np.abs(H[:2, 2]).sum() / np.abs(H[2, :2]).sum()))",
     "float(np.sqrt(abs(H[:2, 2].sum() / H[2, :2].sum())))"),
    ("two columns", "You compared the first two columns, or rows. About an axis at 45° that reads "
     "0 = 0 and says nothing: which column and which row share an entry?",
     "np.sqrt((H[2, 1]**2 - H[2, 0]**2) / (H[:2, 0] @ H[:2, 0] - H[:2, 1] @ H[:2, 1]))",
     ("    column =", "    H = np.linalg.inv(H).T; column =",
      "np.sqrt((H[:2, 0] @ H[:2, 0] - H[:2, 1] @ H[:2, 1]) / (H[2, 1]**2 - H[2, 0]**2))")),
)  # fmt: skip

EXERCISE = Exercise(
    name="focal_from_turn",
    chapter=7,
    title="The focal length without a board",
    task="A camera with square pixels is turned on the spot between two pictures. Pixels are "
    "counted from the principal point, and H (3, 3), of any scale and sign, takes the pixels of "
    "the first picture to those of the second. Give the focal length in pixels. The axis of the "
    "turn is any but the optical one; it may be the vertical.",
    hints=(
        "T plays no part: H ≈ A R A⁻¹ with A = diag(f, f, 1). Multiply that out.",
        "h13 = f r13 and h23 = f r23, but h31 = r31 / f and h32 = r32 / f, all times one factor.",
        "The last row and the last column of R have length 1 and share r33: so "
        "r13² + r23² = r31² + r32².",
    ),
    cases=_turns,
    properties=(
        Property("It is the focal length of the camera that turned."),
        Property(
            "A turn about the vertical alone, as for a panorama, is enough.",
            about="about the vertical",
        ),
        Property("So is one about an axis at 45° to the rows.", about="an axis at 45°"),
    ),
    misconceptions=_MISTAKES,
    steps=focal_from_turn,
    concepts=("56", "q"),
)
