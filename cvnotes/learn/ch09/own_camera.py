"""A camera of your own."""

from dataclasses import replace

import numpy as np

from cvnotes.base import Array
from cvnotes.calibration import calibrate
from cvnotes.learn.personal import PersonalCamera, personal_camera
from cvnotes.tutor import Case, Exercise, Misconception, Property, mistakes
from cvnotes.tutor.checker.equality import Same

_COURSE = np.array([800.0, 804.0, 325.0, 238.0])
_STILL_TO_FILL_IN = (
    'Put your own id in the place of "your id", in both lines: it decides which camera is yours.'
)
_NEAR = 10.0  # px; the corners determine each number to about 2 px


def numbers_of(own: PersonalCamera) -> Array:
    """Return (α_u, α_v, u0, v0) of a student's camera."""
    return own.truth().A[[0, 1, 0, 1], [0, 1, 2, 2]]


def _each_within(distance: float) -> Same:
    def same(answer: Array, right: Array, _: float) -> bool:
        return answer.shape == right.shape and bool((np.abs(answer - right) <= distance).all())

    return same


# What the notebook and the documentation write in place of an id.
_PLACEHOLDERS = ("your id", "student id", "my id", "id")


def _of_student(student: str) -> Exercise:
    if student.strip().casefold() in _PLACEHOLDERS:
        return replace(EXERCISE, refusal=_STILL_TO_FILL_IN)
    own = personal_camera(student)
    return replace(EXERCISE, reference=lambda: numbers_of(own), misconceptions=_slips(own))


def _slips(own: PersonalCamera) -> tuple[Misconception, ...]:
    right, side = numbers_of(own), own.board.square
    return mistakes(
        ("α_u and α_v exchanged", "α_u and α_v are exchanged: α_u = A[0, 0] is in pixel widths, "
         "α_v = A[1, 1] in pixel heights.",
         lambda: right[[1, 0, 2, 3]]),
        ("u0 and v0 exchanged", "Exchange u0 = A[0, 2], which counts columns, and v0 = A[1, 2].",
         lambda: right[[0, 1, 3, 2]]),
        ("parameters in another order", "The order is α_u, α_v, u0, v0.",
         *(lambda i=i: right[i] for i in ([0, 2, 1, 3], [2, 3, 0, 1], [2, 0, 3, 1], [3, 2, 1, 0]))),
        ("in squares", "You divided or multiplied by the side of a square. A is in pixels, "
         "whatever unit the board is measured in.",
         lambda: right / side, lambda: right * side),
        ("another size of the pictures", "All four are half as large as they should be, or twice: "
         "were the pictures scaled before the corners were found?",
         lambda: right / 2, lambda: 2 * right),
        ("someone else's camera", "That is the course's camera. Calibrate your own: "
         'personal_camera("your id").',
         lambda: _COURSE if np.abs(right - _COURSE).max() > _NEAR else None,
         {"same": _each_within(1.0)}),
        ("principal point in the middle", "You took the middle of the picture for the principal "
         "point; no lens sits exactly there.",
         lambda: np.array([*right[:2], 319.5, 239.5]),
         {"seen": lambda answer, _: bool(np.abs(answer[2:] - [319.5, 239.5]).max() < 1)}),
        ("one focal length for both", "These pixels are not square: α_u ≠ α_v.",
         lambda: right[[0, 0, 2, 3]],
         {"seen": lambda answer, _: bool(abs(answer[0] - answer[1]) < 0.5)}),
        ("principal point off", "The focal lengths are right, the principal point is not: is the "
         "lens left out of the model, or a picture's corners found badly?",
         lambda: right + [0, 0, 30, -25],
         {"seen": lambda answer, _: bool(np.abs(answer - right)[:2].max() < _NEAR)}),
        ("focal lengths off", "The principal point is right, the focal lengths are not: is the "
         "lens left out of the model, or were pictures of tilted boards left out?",
         lambda: right + [40, 40, 0, 0],
         {"seen": lambda answer, _: bool(np.abs(answer - right)[2:].max() < _NEAR)}),
        ("not exact enough", "Near, but not within 10 pixels: use all pictures, and the lens.",
         lambda: right + [30, 30, 20, 20],
         {"seen": lambda answer, _: bool(np.abs(answer - right).max() < 60)}),
    )  # fmt: skip


_DEMO = personal_camera("demo")

EXERCISE = Exercise(
    name="own_camera",
    chapter=9,
    title="A camera of your own",
    task="""mine = personal_camera("your id") is a camera that nobody else has. Calibrate it from \
mine.photos(), or from mine.corners, and mine.board, and give (α_u, α_v, u0, v0), each to 10 pixels:
check("own_camera", my_own_camera, student="your id").""",
    stub="my_own_camera = ...  # (alpha_u, alpha_v, u0, v0)",
    hints=(
        "find_corners finds the board in each picture; calibrate takes it from there.",
        "calibrate(mine.board.points, mine.corners, mine.size) starts from the corners.",
        "α_u = A[0, 0], α_v = A[1, 1], u0 = A[0, 2], v0 = A[1, 2].",
    ),
    cases=lambda _: [Case(())],
    properties=(Property("They are α_u, α_v, u0 and v0 of your camera, each to 10 pixels."),),
    misconceptions=_slips(_DEMO),
    reference=lambda: numbers_of(_DEMO),
    same=_each_within(_NEAR),
    concepts=("20", "36", "64"),
    answer="value",
    personal=_of_student,
    sources=(personal_camera, calibrate),
)
