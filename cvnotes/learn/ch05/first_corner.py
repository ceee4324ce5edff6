"""Which corner is the first."""

from cvnotes.base import Array
from cvnotes.learn.cases.pictures import turned_board
from cvnotes.learn.cases.slips import misreadings
from cvnotes.tutor.checker.equality import within
from cvnotes.tutor.checker.exercise import Case, Exercise, Property, mistakes


def _corner(column: float, row: float) -> Array:
    return turned_board()[1].project([30.0 * column, 30.0 * row, 0.0])


def first_corner() -> Array:
    """Return the pixel (2,) of the board's first inner corner."""
    return _corner(0, 0)


MISTAKES = mistakes(
    ("mirrored",
     "That is the other corner beside a dark outer square, the end of the first row. With "
     "the origin there, x and y would be a mirror image: y is clockwise from x.",
     lambda: _corner(3, 0)),
    ("half a turn",
     "That is a corner of the last row. Its outer square is light; the one at the first "
     "corner is dark.",
     lambda: _corner(3, 2), lambda: _corner(0, 2)),
    ("outer corner",
     "Inner corners are those in which four squares meet; you are outside of them, at the "
     "edge or in a square.",
     lambda: _corner(-1, -1), lambda: _corner(-0.5, -0.5), lambda: _corner(4, -1),
     lambda: _corner(-1, 3), lambda: _corner(4, 3), lambda: _corner(-1, 0),
     lambda: _corner(0, -1)),
    ("a neighbour",
     "That is an inner corner, but not one of the four outermost: the first is at the end of"
     " a row.",
     lambda: _corner(1, 0), lambda: _corner(0, 1), lambda: _corner(1, 1), lambda: _corner(2, 0),
     lambda: _corner(2, 1), lambda: _corner(3, 1), lambda: _corner(1, 2), lambda: _corner(2, 2)),
    ("middle of the board",
     "That is the middle of the board; its frame begins in the first corner.",
     lambda: _corner(1.5, 1)),
)  # fmt: skip


FIRST = Exercise(
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
