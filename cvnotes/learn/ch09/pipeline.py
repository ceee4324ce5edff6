"""Your own functions, real photographs."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from cvnotes.base import Array, FileError
from cvnotes.calibration import calibrate
from cvnotes.camera import move
from cvnotes.learn.ch06 import dlt
from cvnotes.learn.ch07 import a_from_b, b_from_views, extrinsics, radial_fit
from cvnotes.learn.personal import personal_camera
from cvnotes.tutor import Case, Exercise, Property

_PARTS = tuple(m.EXERCISE for m in (dlt, b_from_views, a_from_b, extrinsics, radial_fit))
Step = Callable[..., Any]


def assemble(steps: Mapping[str, Step]) -> Callable[..., Array]:
    """Make one function of the student's steps, from corners to (α_u, α_v, u0, v0, k1, k2).

    Parameters
    ----------
    steps : mapping
        Functions by the names of their exercises.

    Returns
    -------
    callable
        (board_points, image_points, size) → array (6,).
    """
    own = {part.name: _finished(steps.get(part.name)) for part in _PARTS}

    def intrinsics(H: Array) -> Array:
        return np.asarray(own["A_from_b"](own["b_from_views"](H)), dtype=float)

    def extrinsics(A: Array, H: Array) -> Array:
        return np.stack([own["extrinsics"](A, one) for one in H])

    def distortion(A: Array, G: Array, W: Array, m: Array, *, terms: int) -> Array:
        M = move(G, W)
        seen = (m - A[:2, 2]) / A[[0, 1], [0, 1]]
        ideal = M[..., :2] / M[..., 2:]
        return np.asarray(own["radial_fit"](ideal.reshape(-1, 2), seen.reshape(-1, 2)))[:terms]

    def pipeline(board_points: Array, image_points: Array, size: tuple[int, int]) -> Array:
        return _numbers(
            calibrate(
                board_points,
                image_points,
                size,
                homography=own["dlt"],
                intrinsics=intrinsics,
                extrinsics=extrinsics,
                distortion=distortion,
            )
        )

    return pipeline


def _finished(step: Step | None) -> Step:
    """Return the step; one that does nothing yet ends the whole pipeline as not solved."""

    def called(*args: Any) -> Any:
        answer = step(*args) if callable(step) else None
        if answer is None or answer is ...:
            raise NotImplementedError
        return answer

    return called


def _numbers(result: Any) -> Array:
    A, k = result.A, result.lens.k
    return np.array([A[0, 0], A[1, 1], A[0, 2], A[1, 2], *k])


def by_the_library(board_points: Array, image_points: Array, size: tuple[int, int]) -> Array:
    """Return (α_u, α_v, u0, v0, k1, k2) by the library's own steps."""
    return _numbers(calibrate(board_points, image_points, size))


def _real_board(_: np.random.Generator) -> list[Case]:
    """Take the corners of real photographs; where the data are not at hand, those of a student."""
    from cvnotes.pictures.course import real_corners

    try:
        real = real_corners()
    except FileError:
        own = personal_camera("demo")
        return [Case((own.board.points, own.corners, own.size))]
    return [Case((real.board.points, real.left, real.size))]


EXERCISE = Exercise(
    name="pipeline",
    chapter=9,
    title="Your own functions, real photographs",
    task="Calibrate a real camera with your own steps. Hand them over by the names of their "
    "exercises: dlt, b_from_views, A_from_b, extrinsics and radial_fit. Each is tried by itself "
    "first; then all of them start the refinement on the corners of 13 photographs.",
    stub="""my_steps = {
    "dlt": ...,
    "b_from_views": ...,
    "A_from_b": ...,
    "extrinsics": ...,
    "radial_fit": ...,
}""",
    hints=(
        "Copy dlt from notebook 06, and A_from_b and extrinsics from 07; b_from_views and "
        "radial_fit are exercises of this notebook.",
        "check each of them by its own name first.",
        'my_steps = {"dlt": my_dlt, …}: functions, without brackets.',
    ),
    cases=_real_board,
    properties=(Property("Started with your steps, the refinement ends at the library's camera."),),
    reference=by_the_library,
    concepts=("36", "37", "42", "64", "65"),
    sources=(assemble, calibrate),
    answer="steps",
    assemble=assemble,
    parts=_PARTS,
)
