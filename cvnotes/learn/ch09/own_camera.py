"""A camera of your own."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from cvnotes.calibration import calibrate
from cvnotes.errors import Array
from cvnotes.learn.exercise import Case, Exercise, Misconception, Property
from cvnotes.learn.personal import PersonalCamera, personal_camera


def _within_percent(percent: float) -> Callable[[Array, Array, float], bool]:
    def same(answer: Array, right: Array, _: float) -> bool:
        return bool(np.abs(answer - right).max() <= percent / 100 * np.abs(right).max())

    return same


def _of_student(student: str) -> Exercise:
    own = personal_camera(student)
    return replace(OWN, reference=lambda: own.camera.A[0, 0], misconceptions=_slips(own))


def _slips(own: PersonalCamera) -> tuple[Misconception, ...]:
    A = own.camera.A
    return (
        Misconception(
            "the vertical focal length",
            "That is α_v = A[1, 1], in pixel heights; α_u is in pixel widths.",
            lambda: A[1, 1],
        ),
        Misconception(
            "the piercing point",
            "That is u0 = A[0, 2], where the optical axis is seen; α_u is A[0, 0].",
            lambda: A[0, 2],
        ),
        Misconception(
            "the piercing point's row",
            "That is v0 = A[1, 2]; α_u is A[0, 0].",
            lambda: A[1, 2],
        ),
        Misconception(
            "in squares",
            "You divided by the side of a square. α_u is in pixels, whatever unit the board is "
            "measured in.",
            lambda: A[0, 0] / own.board.square,
        ),
        Misconception(
            "someone else's camera",
            "That is the focal length of the course's camera. Calibrate your own: "
            'personal_camera("your id").',
            lambda: 800.0 if abs(A[0, 0] / 800 - 1) > 0.04 else None,
        ),
        Misconception(
            "half a picture",
            "That is half of it: were the pictures scaled down before the corners were found?",
            lambda: A[0, 0] / 2,
        ),
    )


OWN = Exercise(
    name="own_camera",
    chapter=9,
    title="A camera of your own",
    task='mine = personal_camera("your id") is a camera that nobody else has. Calibrate it from '
    "mine.photos(), or from mine.corners, and mine.board, and give its α_u in pixels, to 1.5 %: "
    'check("own_camera", alpha_u, student="your id").',
    stub="my_alpha_u = ...",
    hints=(
        "find_corners finds the board in each picture; calibrate takes it from there.",
        "calibrate(mine.board.points, mine.corners, mine.camera.size) starts from the corners.",
        "α_u is the first entry of A.",
    ),
    cases=lambda _: [Case(())],
    properties=(Property("It is the α_u of your camera, to 1.5 %."),),
    misconceptions=_slips(personal_camera("demo")),
    reference=lambda: personal_camera("demo").camera.A[0, 0],
    same=_within_percent(1.5),
    concepts=("20", "36", "64"),
    answer="value",
    personal=_of_student,
    sources=(personal_camera, calibrate),
)
