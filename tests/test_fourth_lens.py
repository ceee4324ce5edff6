"""A lens that the package does not have takes one class: everything else here is how it is used."""

from dataclasses import dataclass

import numpy as np
import pytest
from differences import numerical_jacobian

from cvnotes.base import CvnotesError, FileError, InputTypeError
from cvnotes.calibration import LENSES, Calibration, calibrate
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.jacobian import jacobian
from cvnotes.calibration.refinement import Problem
from cvnotes.camera import AnyLens, Camera, PlaneLens, intrinsics, look_at, pose, px_from_xy
from cvnotes.camera import rotation_from_vector as turned
from cvnotes.camera.any_lens import MODELS
from cvnotes.files import read_camera, write_camera
from cvnotes.pictures import render
from cvnotes.targets import Chessboard
from cvnotes.warping import undistort_image

BOARD = Chessboard((9, 6), 25.0)


@dataclass(frozen=True)
class DivisionLens(PlaneLens):
    """The division model of Fitzgibbon (CVPR 2001): x = x' / (1 + q r'²)."""

    model = "division"
    choices = {"division": ("q",)}  # noqa: RUF012

    q: float = 0.0

    @property
    def max_radius(self):
        return np.inf if self.q <= 0 else 0.5 / np.sqrt(self.q)

    def undistort(self, xy_lens):
        below = 1 + self.q * (xy_lens**2).sum(-1, keepdims=True)
        r_end = np.inf if self.q == 0 else 1 / np.sqrt(abs(self.q))
        reached = (xy_lens**2).sum(-1, keepdims=True) <= r_end**2
        return np.where(reached, xy_lens / np.where(below > 0, below, np.nan), np.nan)

    def distort(self, xy):
        r2 = (xy**2).sum(-1, keepdims=True)
        with np.errstate(invalid="ignore"):
            return xy * 2 / (1 + np.sqrt(1 - 4 * self.q * r2))

    def on_plane(self, xy, names, by_coefficients):  # noqa: ARG002
        # s = 2 / (1 + w) with w = √(1 − 4 q r²), and dw = −2 (r² dq + q dr²) / w
        r2 = (xy**2).sum(0)
        w = np.sqrt(1 - 4 * self.q * r2)
        s, by_w = 2 / (1 + w), -2 / (1 + w) ** 2
        by_r2, by_q = by_w * -2 * self.q / w, by_w * -2 * r2 / w
        e = np.eye(2).reshape(2, 2, *[1] * r2.ndim)
        by_x, by_y = (s * e[i] + by_r2 * 2 * xy[i] * xy for i in (0, 1))
        by_coefficients[0] = by_q * xy
        return s * xy, (by_x, by_y)


@dataclass(frozen=True)
class MirrorLens(AnyLens):
    """A camera that looks into a mirror: the unified model, x' = X / (Z + ξ ‖M‖), 0.5 ≤ ξ ≤ 1."""

    model = "unified"
    choices = {"unified": ("xi",)}  # noqa: RUF012
    wide = True

    xi: float = 0.8

    @property
    def max_angle(self):
        return np.arccos(-min(self.xi, 1 / self.xi)) - 1e-6

    def of_rays(self, M):
        Z, norm = M[..., 2:], np.linalg.norm(M, axis=-1, keepdims=True)
        with np.errstate(all="ignore"):
            seen = np.cos(self.max_angle) * norm <= Z
            return np.where(seen, M[..., :2] / (Z + self.xi * norm), np.nan)

    def rays(self, xy_lens):
        r2 = (xy_lens**2).sum(-1, keepdims=True)
        with np.errstate(invalid="ignore"):
            s = (self.xi + np.sqrt(1 + (1 - self.xi**2) * r2)) / (1 + r2)
        return np.concatenate([s * xy_lens, s - self.xi], axis=-1)

    def derivatives(self, M, names=None, out=None):
        by_M, by_coefficients = out or self.room(M, names)
        norm = np.sqrt((M**2).sum(0))
        below = M[2] + self.xi * norm
        xy = M[:2] / below
        e = np.eye(3).reshape(3, 3, *[1] * norm.ndim)
        by_M[...] = (e[:2] - xy[:, None] * (e[2] + self.xi * M / norm)) / below
        by_coefficients[0] = -xy * norm / below
        return xy, by_M, by_coefficients


LENS = {
    "division": (DivisionLens(-0.35), intrinsics(420, 424, 325, 238)),
    "unified": (MirrorLens(0.9), intrinsics(330, 333, 325, 238)),
}


@pytest.fixture(params=LENS)
def camera(request):
    lens, A = LENS[request.param]
    return Camera(A, lens=lens)


def views(n=8):
    rng = np.random.default_rng(5)
    turns = turned(rng.normal(0, 0.35, (n, 3)))
    return [pose(R, R @ [-100, -62, 0] + [*rng.uniform(-50, 50, 2), 330]) for R in turns]


def corners(camera, n=8):
    return np.array([camera.moved(G).project(BOARD.points) for G in views(n)])


def test_what_it_shows_it_takes_back_and_its_derivatives_are_right(camera):
    lens, rng = camera.lens, np.random.default_rng(1)
    M = rng.uniform([-1, -1, 0.8], [1, 1, 2], (30, 3))
    back = lens.rays(lens.of_rays(M))
    np.testing.assert_allclose(back, M / np.linalg.norm(M, axis=1, keepdims=True), atol=1e-12)
    [name] = lens.parameters
    for row in M:
        xy_lens, by_M, by_coefficients = lens.derivatives(row)
        np.testing.assert_allclose(xy_lens, lens.of_rays(row), atol=1e-14)
        np.testing.assert_allclose(by_M, numerical_jacobian(lens.of_rays, row), atol=1e-8)
        by_name = numerical_jacobian(
            lambda x, row=row: lens.with_parameters({name: x[0]}).of_rays(row),
            np.array([lens.parameters[name]]),
        )
        np.testing.assert_allclose(by_coefficients[0], by_name[:, 0], atol=1e-8)


def test_it_is_calibrated_by_its_name_and_exact_corners_give_the_exact_camera(camera):
    m = corners(camera)
    assert np.isfinite(m).all()
    found = calibrate(BOARD.points, m, camera.size, lens=next(iter(camera.lens.choices)))
    assert type(found.lens) is type(camera.lens)
    np.testing.assert_allclose(found.A, camera.A, rtol=1e-8, atol=1e-6)
    for key, value in camera.lens.parameters.items():
        assert abs(found.lens.parameters[key] - value) < 1e-8
    np.testing.assert_allclose(found.poses, views(), atol=1e-6)
    assert found.rms < 1e-8


@pytest.mark.filterwarnings("ignore::cvnotes.base.CalibrationWarning")
def test_noisy_corners_end_in_the_minimum_within_its_error_bars(camera):
    m = corners(camera) + np.random.default_rng(2).normal(0, 0.2, (8, 54, 2))
    name = next(iter(camera.lens.choices))
    found = calibrate(BOARD.points, m, camera.size, lens=name)
    truth = camera.parameters
    for key, value in found.parameters.items():
        assert abs(value - truth[key]) < 4 * found.std[key], key
    data = Correspondences.of(BOARD.points, m)
    problem = Problem.of(data, camera.size, name, skew=False)
    x = problem.state(found.camera, data.pose_in_scaled_units(found.poses))
    J, r = jacobian(problem, x)
    J, r = J.reshape(8, 108, -1), r.reshape(8, 108)
    gradient = np.einsum("vij,vi->vj", J, r)  # of each view; the camera's share cancels in the sum
    size = np.sqrt((J**2).sum(1) * (r**2).sum(1)[:, None])
    shared = np.abs(gradient[:, :5].sum(0)) / size[:, :5].sum(0)
    assert max(shared.max(), (np.abs(gradient[:, 5:]) / size[:, 5:]).max()) < 1e-6


@pytest.mark.filterwarnings("ignore::cvnotes.base.CalibrationWarning")  # rays beyond 90°
def test_a_board_is_rendered_through_it_and_its_picture_straightened(camera):
    camera = camera.moved(views()[0])
    picture = render(BOARD, camera)
    assert len(np.unique(picture)) > 50
    new_A = intrinsics(300, 300, 320, 240)
    straight = undistort_image(picture, camera, new_A)
    ideal = render(BOARD, Camera(new_A, camera.G)).astype(float)
    xy = (np.stack(np.meshgrid(np.arange(640), np.arange(480)), -1) - [320, 240]) / 300
    both = np.isfinite(camera.lens.distort(xy)).all(-1)
    u, v = np.moveaxis(px_from_xy(camera.A, np.nan_to_num(camera.lens.distort(xy))), -1, 0)
    both &= (u > 2) & (u < 637) & (v > 2) & (v < 477)
    assert both.mean() > 0.5
    assert np.abs(straight - ideal)[both].mean() < 2.5


def test_points_come_back_from_the_picture(camera):
    m = np.array([[320.0, 240], [100, 60], [500, 400]])
    d = camera.ray(m)
    np.testing.assert_allclose(camera.project(7 * d), m, atol=1e-9)
    np.testing.assert_allclose(camera.ideal(m), d[:, :2] / d[:, 2:], atol=1e-12)
    xy = camera.ideal(m)
    np.testing.assert_allclose(camera.lens.undistort(camera.lens.distort(xy)), xy, atol=1e-12)


@pytest.mark.filterwarnings("ignore::cvnotes.base.CalibrationWarning")
def test_it_is_saved_and_read(camera, tmp_path):
    write_camera(camera, tmp_path / "camera.json")
    assert read_camera(tmp_path / "camera.json").lens == camera.lens
    found = calibrate(
        BOARD.points, corners(camera), camera.size, lens=next(iter(camera.lens.choices))
    )
    found.save(tmp_path / "found.json")
    again = Calibration.load(tmp_path / "found.json")
    assert again.lens == found.lens
    assert again.parameters == found.parameters
    with pytest.raises(CvnotesError, match=f"no {camera.lens.model} lens; keep it as JSON"):
        write_camera(camera, tmp_path / "camera.yaml")
    text = (tmp_path / "camera.json").read_text()
    (tmp_path / "other.json").write_text(text.replace(camera.lens.model, "periscope"))
    with pytest.raises(FileError, match=r"expected polynomial, .*unified, got 'periscope'"):
        read_camera(tmp_path / "other.json")


def test_what_comes_into_it_is_guarded_like_ours(camera):
    for name, wrong in (("of_rays", [1.0, 2]), ("rays", [1.0, 2, 3]), ("distort", "ab")):
        with pytest.raises((CvnotesError, InputTypeError), match="expected"):
            getattr(camera.lens, name)(wrong)
    with pytest.raises(CvnotesError, match="'k7' is no coefficient of a"):
        camera.lens.with_parameters({"k7": 1.0})


def test_no_two_lenses_have_one_name():
    before = dict(LENSES), dict(MODELS)
    with pytest.raises(CvnotesError, match="FisheyeLens has the same name"):
        type("Mine", (PlaneLens,), {"model": "mine", "choices": {"fisheye": ("k1",)}})
    assert before == (LENSES, MODELS)


def test_the_camera_stands_where_it_looks_from(camera):
    seen = camera.moved(look_at([60, 40, -300], [90, 60, 0])).project(BOARD.points)
    assert np.isfinite(seen).all()
