"""Singular matrices where NumPy cannot raise: in WebAssembly it gives NaN instead."""

import numpy as np
import pytest

from cvnotes.base import DegenerateError, solve_dense
from cvnotes.calibration import calibrate, intrinsics_from_b
from cvnotes.calibration.refinement import covariance, pose_covariance, solve_by_schur
from cvnotes.camera import Camera, intrinsics, pose, rotation_from_vector
from cvnotes.homography import four_points_h9_one
from cvnotes.targets import Chessboard


@pytest.fixture
def numpy_that_cannot_raise(monkeypatch):
    """Give what `inv`, `solve` and `cholesky` give in a browser for a singular matrix."""
    for name in ("inv", "solve", "cholesky"):
        usual = getattr(np.linalg, name)

        def quiet(a, *b, usual=usual):
            try:
                return usual(a, *b)
            except np.linalg.LinAlgError:
                return np.full(np.shape(b[0] if b else a), np.nan)

        monkeypatch.setattr(np.linalg, name, quiet)


@pytest.mark.usefixtures("numpy_that_cannot_raise")
@pytest.mark.parametrize(
    ("call", "why"),
    [
        (lambda: solve_dense(np.zeros((3, 3)), 0.0), "normal equations are singular"),
        (lambda: intrinsics_from_b([-1, 0, -1, 0, 0, -1]), "B is not positive definite"),
        (lambda: four_points_h9_one(*[[[0, 0], [1, 1], [2, 2], [3, 3]]] * 2), "8×8 system"),
    ],
)
def test_a_singular_matrix_is_refused_in_words(call, why):
    with pytest.raises(DegenerateError, match=why):
        call()


def _normal_equations(monkeypatch):
    """Give the normal equations of a calibration."""
    from cvnotes.calibration import refinement

    kept = []
    usual = refinement.covariance
    monkeypatch.setattr(
        refinement, "solve_by_schur", lambda s, d: kept.append(s) or solve_by_schur(s, d)
    )
    assert usual is covariance
    camera = Camera(intrinsics(800, 800, 320, 240))
    W = Chessboard((5, 4), 30.0).points
    tilts = ([0.5, 0, 0], [0, 0.5, 0], [-0.4, 0.3, 0.1])
    poses = [pose(rotation_from_vector(w), [-60, -45, 450.0]) for w in tilts]
    m = np.array([camera.moved(G).project(W) for G in poses])
    calibrate(W, m, (640, 480), lens="none")
    return kept[-1]


@pytest.mark.parametrize("broken", ["solve", "inv"])
def test_normal_equations_that_gave_nan_are_refused(monkeypatch, broken):
    system = _normal_equations(monkeypatch)
    good = covariance(system)

    def nan(a, *b):
        return np.full(np.shape(b[0] if b else a), np.nan)

    monkeypatch.setattr(np.linalg, broken, nan)
    system = system.damped(0.5)  # without what is remembered of the undamped ones
    calls = {
        "solve": [lambda: solve_by_schur(system, 0.0), lambda: covariance(system)],
        "inv": [lambda: covariance(system), lambda: pose_covariance(system, good)],
    }
    for call in calls[broken]:
        with pytest.raises(DegenerateError, match="do not determine every parameter"):
            call()
