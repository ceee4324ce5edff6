"""Which corner is the first."""

from cvnotes.base import Array
from cvnotes.learn.cases.pictures import turned_board
from cvnotes.learn.cases.slips import misreadings
from cvnotes.tutor import Case, Exercise, Property, mistakes_in
from cvnotes.tutor.checker.equality import within


def _corner(column: float, row: float) -> Array:
    return turned_board()[1].project([30.0 * column, 30.0 * row, 0.0])


def first_corner() -> Array:
    """Return the pixel (2,) of the board's first inner corner."""
    return _corner(0, 0)


MISTAKES = mistakes_in(first_corner,
    ("mirrored", "That is the other corner beside a dark outer square, the end of the first row. "
     "With the origin there, x and y would be a mirror image: y is clockwise from x.",
     "_corner(3, 0)"),
    ("half a turn", "That corner is in the last row: the square outside of it is light, not dark.",
     "_corner(3, 2)", "_corner(0, 2)"),
    ("outer corner", "Inner corners are those in which four squares meet; you are outside of them, "
     "at the edge or in a square.",
     "_corner(-1, -1)", "_corner(-0.5, -0.5)", "_corner(4, -1)",
     "_corner(-1, 3)", "_corner(4, 3)", "_corner(-1, 0)", "_corner(0, -1)"),
    ("a neighbour", "That is an inner corner, but none of the four outermost ones.",
     "_corner(1, 0)", "_corner(0, 1)", "_corner(1, 1)", "_corner(2, 0)",
     "_corner(2, 1)", "_corner(3, 1)", "_corner(1, 2)", "_corner(2, 2)"),
    ("middle of the board",
     "That is the middle of the board; its frame begins in the first corner.",
     "_corner(1.5, 1)"),
)  # fmt: skip


EXERCISE = Exercise(
    name="first_corner",
    chapter=5,
    title="Which corner is the first?",
    task="Look at board_picture(), which has 320 × 240 pixels and shows a board with 4 × 3 "
    "inner corners. At which pixel (u, v) is its first inner corner? The square outside of it, "
    "towards −x and −y, is dark; x runs along the 4 corners, and seen from the front y is a "
    "quarter turn clockwise from x. To within 4 pixels is good enough.",
    stub="my_first_corner = ...  # (u, v)",
    hints=(
        "Two of the four outermost squares are dark; the first corner is at one of them.",
        "Stand on either corner and look along the side with 4 corners: that is x. The board must "
        "lie to your right, for y leads there: turn x clockwise by 90°, and it points along y.",
        "Zoom in, and count pixels: u from the left, v from the top.",
    ),
    cases=lambda _: [Case(())],
    properties=(Property("It is the first corner, to within 4 pixels."),),
    misconceptions=(
        *MISTAKES,
        *misreadings(first_corner, (320, 240), 4.0),
    ),
    reference=first_corner,
    same=within(4.0),
    concepts=("39", "41", "E18"),
    answer="value",
    sources=(turned_board, first_corner),
)
