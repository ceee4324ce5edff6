"""Sets of poses: that the target is seen whole, and what each set says about the camera."""

import numpy as np
import pytest

from cvnotes.base import CvnotesError, DegenerateError, InputTypeError
from cvnotes.calibration.coverage import covered_cells
from cvnotes.camera import Camera, Lens, intrinsics, pose, rotation_from_vector
from cvnotes.pictures import (
    covering_views,
    facing,
    fronto_parallel_views,
    good_views,
    hold_at,
)
from cvnotes.pictures.placing import every_face_seen
from cvnotes.targets import Chessboard, ThreePlanes, TwoPlanes

BOARD = Chessboard((9, 6), 25.0)
CAMERA = Camera(intrinsics(800, 804, 325, 238), lens=Lens(k=(-0.25, 0.10)), size=(640, 480))
FAMILIES = [good_views, fronto_parallel_views]
families = pytest.mark.parametrize("family", FAMILIES, ids=lambda f: f.__name__)


def views(family, n, seed=0, target=BOARD, camera=CAMERA, **options):
    return family(target, camera, n, rng=np.random.default_rng(seed), **options)


def squares_lie_inside(target, camera, G):
    """Every point along the outer squares, densely."""
    w, h = camera.size
    for world_from_board, board in target.faces:
        x = np.linspace(-1, board.corners[0], 60) * board.square
        y = np.linspace(-1, board.corners[1], 60) * board.square
        X, Y = np.meshgrid(x, y)
        W = np.stack([X, Y, 0 * X], -1).reshape(-1, 3)
        m = camera.moved(G @ world_from_board).project(W)
        if not ((m > 0) & (m < [w - 1, h - 1])).all():  # False for NaN, too
            return False
    return True


@families
@pytest.mark.parametrize("n", [1, 3, 20])
def test_in_every_view_all_squares_lie_in_the_picture(family, n):
    G = views(family, n)
    assert G.shape == (n, 4, 4)
    assert all(squares_lie_inside(BOARD, CAMERA, G_i) for G_i in G)


@families
def test_the_same_seed_gives_the_same_views(family):
    np.testing.assert_array_equal(views(family, 4, seed=5), views(family, 4, seed=5))
    assert not np.allclose(views(family, 4, seed=5), views(family, 4, seed=6))


def test_boards_stay_where_the_lens_still_maps_one_to_one():
    camera = Camera(intrinsics(400, 400, 320, 240), lens=Lens(k=(-0.4,)))
    assert camera.lens.max_radius < camera.ideal([320 + 160, 240])[0] * 3
    G = views(good_views, 12, camera=camera)
    assert all(squares_lie_inside(BOARD, camera, G_i) for G_i in G)


def tilts(G):
    return np.degrees(np.arccos(G[:, 2, 2]))


def test_good_views_are_tilted_by_20_to_45_degrees_to_all_sides():
    G = views(good_views, 40)
    assert tilts(G).min() >= 20
    assert tilts(G).max() <= 45
    towards = np.arctan2(G[:, 1, 2], G[:, 0, 2])  # of the normals
    quarters, _ = np.histogram(towards, bins=4, range=(-np.pi, np.pi))
    assert quarters.min() >= 8
    assert tilts(views(good_views, 9, tilt=(0.0, 0.1))).max() < np.degrees(0.1)


def covered(G, camera=CAMERA):
    return covered_cells([camera.moved(G_i).project(BOARD.points) for G_i in G], camera.size)


@pytest.mark.parametrize("seed", range(6))
def test_covering_views_reach_all_four_corners_of_the_picture(seed):
    wide = Camera(intrinsics(420, 420, 320, 240), lens=Lens(k=(-0.2, 0.05)))
    for camera in (CAMERA, wide):
        G = views(covering_views, 12, seed=seed, camera=camera)
        seen = covered(G, camera)
        assert seen[[0, -1]][:, [0, -1]].all()
        assert seen.sum() >= 44
        assert all(squares_lie_inside(BOARD, camera, G_i) for G_i in G)
        angle = np.degrees(np.arccos(G[:, 2, 2]))
        assert angle.min() >= 20
        assert angle.max() <= 45


def test_the_cells_in_which_corners_were_seen():
    # 8 × 4 cells of 10 px; the outermost pixels of the picture belong to its outermost cells.
    m = [[-0.5, -0.5], [9.4, 9.4], [9.5, 0], [79.4, 39.4], [79.5, 0], [500, -3]]
    for seen in (covered_cells(m, (80, 40)), covered_cells([np.array([p]) for p in m], (80, 40))):
        assert seen.shape == (8, 4)
        assert np.argwhere(seen).tolist() == [[0, 0], [1, 0], [7, 3]]
    assert not covered_cells([], (80, 40)).any()


def test_three_views_reach_no_four_corners():
    with pytest.raises(CvnotesError, match="n: there are four corners to be reached, so at least"):
        views(covering_views, 3)


def test_good_views_cover_the_picture():
    corners = np.concatenate([CAMERA.moved(G).project(BOARD.points) for G in views(good_views, 12)])
    cells = np.unique((corners / [640 / 8, 480 / 6]).astype(int), axis=0)
    assert len(cells) >= 0.7 * 48


@pytest.mark.parametrize("target", [TwoPlanes(), ThreePlanes(Chessboard((5, 4)))])
def test_good_views_show_all_faces_of_a_target(target):
    for G in views(good_views, 6, target=target, tilt=(0.0, 0.3)):
        assert squares_lie_inside(target, CAMERA, G)
        for world_from_board, board in target.faces:
            face = G @ world_from_board
            middle = face[:3, :3] @ board.points.mean(axis=0) + face[:3, 3]
            assert face[:3, 2] @ middle > 0.25 * np.linalg.norm(middle)


def test_fronto_parallel_boards_are_parallel_to_the_sensor():
    np.testing.assert_allclose(views(fronto_parallel_views, 5)[:, :3, 2], [[0, 0, 1]] * 5)


# ---- what a set of views says about the camera


def pixels(parameters, G):
    """All corners in all views, for α_u, α_v, u0, v0 and perhaps k1, k2."""
    alpha_u, alpha_v, u0, v0, *k = parameters
    camera = Camera(intrinsics(alpha_u, alpha_v, u0, v0), lens=Lens(k=tuple(k)))
    return np.stack([camera.moved(G_i).project(BOARD.points).ravel() for G_i in G])


def derivatives(f, steps):
    return np.stack([(f(e) - f(-e)) / (2 * e.sum()) for e in np.diag(steps)], axis=-1)


def error_bars(G, truth=(800, 804, 325, 238, -0.25, 0.10), sigma=0.3):
    """Smallest standard deviations that any estimate from these views can have (Cramér, Rao).

    Of the parameters of `pixels`; poses are unknown too, and eliminated.
    """
    steps = [1e-2] * 4 + [1e-4] * (len(truth) - 4)

    def moved(e):
        return np.stack([pose(rotation_from_vector.inside(e[:3]), e[3:]) @ G_i for G_i in G])

    of_camera = derivatives(lambda e: pixels(truth + e, G), steps)
    of_pose = derivatives(lambda e: pixels(truth, moved(e)), [1e-6] * 3 + [1e-3] * 3)
    information = np.zeros((len(truth), len(truth)))
    for J, E in zip(of_camera, of_pose, strict=True):
        left = J - E @ np.linalg.lstsq(E, J, rcond=None)[0]
        information += left.T @ left
    return sigma / np.sqrt(np.maximum(eliminate(information), 1e-30))


def eliminate(information):
    """What is known of each parameter when all others are unknown."""
    known = []
    for i in range(len(information)):
        rest = np.arange(len(information)) != i
        tied = information[i, rest]
        known.append(
            information[i, i] - tied @ np.linalg.lstsq(information[rest][:, rest], tied)[0]
        )
    return np.array(known)


GOOD = error_bars(views(good_views, 12))


def test_good_views_know_the_camera_well():
    np.testing.assert_array_less(GOOD, [3, 3, 4, 4, 0.02, 0.15])
    np.testing.assert_array_less(error_bars(views(good_views, 3)), [12, 12, 12, 12, 0.06, 0.6])


def test_boards_that_face_the_camera_leave_its_focal_length_unknown():
    assert error_bars(views(fronto_parallel_views, 12))[0] > 100 * GOOD[0]


# ---- placing


def test_a_target_is_held_where_it_is_wanted_and_as_near_as_it_fits():
    R = rotation_from_vector([0.4, -0.3, 0.1])
    G = hold_at(BOARD, CAMERA, R, [300, 200])
    middle = CAMERA.moved(G).project([100, 62.5, 0])
    np.testing.assert_allclose(middle, [300, 200], atol=1e-9)
    assert squares_lie_inside(BOARD, CAMERA, G)
    nearer = G.copy()
    nearer[:3, 3] -= 0.1 * (G @ [100, 62.5, 0, 1])[:3]
    assert not squares_lie_inside(BOARD, CAMERA, nearer)


def test_a_target_of_several_faces_turns_all_of_them_to_the_camera():
    for target in (TwoPlanes(), ThreePlanes()):
        assert every_face_seen(target, hold_at(target, CAMERA, facing(target), [320, 240]))
        behind = facing(target) @ rotation_from_vector([0, np.pi, 0])
        assert not every_face_seen(target, hold_at(target, CAMERA, behind, [320, 240]))


class BackToBack:
    faces = ((np.eye(4), BOARD), (pose(rotation_from_vector([0, np.pi, 0]), [0, 0, 9]), BOARD))


@pytest.mark.slow
def test_impossible_wishes_are_refused_in_words():
    with pytest.raises(DegenerateError, match="look in opposite directions"):
        views(good_views, 3, target=BackToBack())
    with pytest.raises(DegenerateError, match="does not fit into a picture of 9×7 pixels"):
        views(good_views, 3, camera=Camera(intrinsics(20, 20, 4, 3), size=(9, 7)))
    with pytest.raises(DegenerateError, match="a face of the target is hidden; tilt it less"):
        views(good_views, 3, target=TwoPlanes(), tilt=(1.4, 1.5))
    folded = Camera(intrinsics(800, 800, 320, 240), lens=Lens(k=(-1.6,)))
    with pytest.raises(DegenerateError, match="beyond the reach of the lens"):
        hold_at(BOARD, folded, np.eye(3), [0, 0])


@families
@pytest.mark.parametrize(
    ("change", "error", "words"),
    [
        ({"target": 5}, InputTypeError, "target: expected a Chessboard or the like, got int"),
        ({"camera": None}, InputTypeError, "camera: expected a Camera, got NoneType"),
        ({"n": 0}, CvnotesError, "from 1 to 10000, got 0"),
        ({"n": 2.5}, CvnotesError, "from 1 to 10000, got 2.5"),
        ({"rng": 1}, InputTypeError, r"rng: expected a numpy\.random\.Generator, got int"),
    ],
)
def test_a_wrong_argument_is_refused_in_words(family, change, error, words):
    given = {"target": BOARD, "camera": CAMERA, "n": 3, "rng": np.random.default_rng(0)} | change
    with pytest.raises(error, match=words):
        family(given["target"], given["camera"], given["n"], rng=given["rng"])


@pytest.mark.parametrize("tilt", [(0.5, 0.2), (20, 45), (-0.1, 0.3), 0.3])
def test_a_tilt_that_is_no_range_of_radians_is_refused(tilt):
    with pytest.raises(CvnotesError, match=r"tilt: expected \(least, most\) in radians"):
        views(good_views, 3, tilt=tilt)
