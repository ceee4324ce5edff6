from dataclasses import replace

import numpy as np
import pytest

from cvnotes.base import DegenerateError
from cvnotes.calibration import calibrate, prediction_std
from cvnotes.camera import Lens
from cvnotes.pictures import course

W, CAMERA, POSES = course.board().points, course.camera(), course.poses()
EXACT = course.exact_corners()
PLACES = np.array([[0, 0], [320, 240], [639, 479], [100, 400.0]])


@pytest.fixture(scope="module")
def repeated():
    rng = np.random.default_rng(3)
    noisy = EXACT + rng.normal(scale=0.2, size=(150, *EXACT.shape))
    return [calibrate(W, m, CAMERA.size, lens="k1 k2 p1 p2") for m in noisy]


@pytest.mark.slow
def test_the_scatter_of_predicted_pixels_is_the_one_that_was_promised(repeated):
    rays = CAMERA.ray(PLACES)
    seen = np.array([found.camera.project(rays) for found in repeated])
    scatter = np.sqrt(seen.var(0, ddof=1).sum(-1))
    promised = np.mean([prediction_std(found, PLACES) for found in repeated], axis=0)
    np.testing.assert_allclose(promised, scatter, rtol=0.25)


def test_beyond_the_reach_of_the_lens_nothing_is_promised(repeated):
    folding = replace(repeated[0], lens=Lens((-0.9, 0.0)))
    assert np.isnan(prediction_std(folding, [5000.0, 240]))
    assert np.isfinite(prediction_std(folding, [320.0, 240]))


def test_coefficients_of_a_quotient_that_compensate_each_other_are_said_to():
    board, m = course.board(), course.measured_corners()
    quotient, plain = (
        calibrate(board.points, m, (640, 480), lens=lens) for lens in ("rational", "k1 k2 p1 p2 k3")
    )
    assert set(quotient.tied) >= {"k1", "k4"}
    assert not set(quotient.tied) & {"alpha_u", "alpha_v", "u0", "v0"}
    assert "k1, k2" in quotient.notes_on_deviations[0]
    assert "depend on each other so strongly" in quotient.notes_on_deviations[0]
    assert plain.tied == ()


@pytest.mark.slow
def test_what_a_turn_of_the_camera_absorbs_can_be_left_out(repeated):
    rays, corners = CAMERA.ray(PLACES), EXACT.reshape(-1, 2)
    true = CAMERA.ray(corners)
    true = true / np.linalg.norm(true, axis=-1, keepdims=True)
    seen = []
    for found in repeated:  # the rotation that takes the true rays to those of this camera
        own = found.camera.ray(corners)
        U, _, Vt = np.linalg.svd(true.T @ (own / np.linalg.norm(own, axis=-1, keepdims=True)))
        turn = U @ np.diag([1, 1, np.linalg.det(U @ Vt)]) @ Vt
        seen.append(found.camera.project(rays @ turn))
    scatter = np.sqrt(np.var(seen, axis=0, ddof=1).sum(-1))
    promised = [prediction_std(found, PLACES, turning=True) for found in repeated]
    np.testing.assert_allclose(np.mean(promised, axis=0), scatter, rtol=0.25)
    assert (scatter[1:3] < 0.5 * prediction_std(repeated[0], PLACES)[1:3]).any()


def test_a_turn_takes_nothing_where_corners_are_not_known(repeated):
    unseen = replace(repeated[0], _data=None)
    with pytest.raises(DegenerateError, match="has no corners"):
        prediction_std(unseen, PLACES, turning=True)
