"""Boards found by their saddle points, with OpenCV's filters and, as in a browser, without."""

import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from cvnotes.base import CornersNotFound
from cvnotes.camera import Camera, Lens, intrinsics, look_at, pose, rotation_from_vector
from cvnotes.pictures import clutter, course, desk, render, render_scene
from cvnotes.targets import Chessboard, find_corners
from cvnotes.targets.finding import count_corners
from cvnotes.targets.harris_corners import largest_around
from cvnotes.targets.markers import has_opencv
from cvnotes.targets.saddle_points import lattices, saddle_points, smoothed

ROOT = Path(__file__).resolve().parents[1]
VIEWS = sorted((ROOT / "data" / "views").glob("*.png"))
BOARD = Chessboard((9, 6), 25.0)
CAMERA = Camera(intrinsics(800, 804, 325, 238), lens=Lens(k=(-0.25, 0.10)), size=(640, 480))


@pytest.fixture
def no_opencv(monkeypatch):
    """Hide OpenCV from whoever imports it from now on."""
    monkeypatch.setitem(sys.modules, "cv2", None)
    assert not has_opencv()


def read_image(path):
    return np.asarray(Image.open(path))


def view(distance=520.0):
    R = rotation_from_vector((0.3, -0.4, 0.2))
    return CAMERA.moved(pose(R, np.array([0, 0, distance]) - R @ BOARD.points.mean(0)))


def test_where_four_squares_meet_is_a_saddle_with_its_place_and_its_light_quadrant():
    v, u = np.indices((41, 41)) - 20.0
    t = np.array([[np.cos(0.3), np.sin(0.3)], [np.cos(1.6), np.sin(1.6)]])  # of the two edges
    sides = [np.tanh((a * (v - 0.25) - b * (u - 0.4)) / 0.7) for a, b in t]
    found = saddle_points(128 + 100 * sides[0] * sides[1], 1.5)
    np.testing.assert_allclose(found.m[0], [20.4, 20.25], atol=0.05)
    # the quadrant between both directions is on different sides of the edges: dark
    assert t[0] @ found.H[0] @ t[1] < 0


def test_around_a_crossing_of_straight_edges_the_second_derivatives_have_no_trace():
    v, u = np.indices((61, 61)) - 30.0
    for angle in (0.5, 1.0, 1.5):
        other = np.cos(angle) * v - np.sin(angle) * u
        H = saddle_points(np.tanh(2 * v) * np.tanh(2 * other), 6.0).H[0]
        assert abs(np.trace(H)) < 0.1 * np.sqrt(-np.linalg.det(H))


@pytest.mark.usefixtures("no_opencv")
def test_a_board_on_a_desk_seen_from_the_side():
    camera = course.camera().moved(look_at([-330, 380, -200], [95, 60, -20], up=(0, 0, -1)))
    board = course.board()
    m = find_corners(render_scene(desk(board), camera), board)
    np.testing.assert_allclose(m, camera.project(board.points), atol=0.1)


def test_in_all_rendered_views_corners_are_where_opencv_leads_to(monkeypatch):
    pictures = [read_image(path) for path in VIEWS]
    expected = [find_corners(picture, BOARD) for picture in pictures]
    monkeypatch.setitem(sys.modules, "cv2", None)
    found = [find_corners(picture, BOARD) for picture in pictures]
    assert len(found) == 12
    np.testing.assert_allclose(found, expected, rtol=0, atol=0.005)


@pytest.mark.parametrize("n", range(0, len(VIEWS), 4))
def test_the_row_of_corners_where_the_outer_squares_end_is_not_taken_for_corners(n):
    assert sorted(next(lattices(read_image(VIEWS[n]))).shape[:2]) == [6, 9]


def test_points_along_an_edge_are_no_crossings():
    # Steps of a slanting edge are full of saddles.
    v, u = np.indices((60, 80))
    edge = np.where(7 * v > 2 * u + 90, 200.0, 40.0)
    assert len(saddle_points(edge).m) == 0
    assert len(saddle_points(edge * np.where(2 * v < 150 - 7 * u, 1, 0.2)).m) <= 1


def test_the_edges_of_a_crossing_have_their_directions():
    v, u = np.indices((41, 41)) - 20.0
    for angle in (0.6, 1.1, 1.6):
        t = np.array([[np.cos(a), np.sin(a)] for a in (0.2, 0.2 + angle)])
        sides = [np.tanh((a * v - b * u) / 0.7) for a, b in t]
        along = np.abs(saddle_points(100 * sides[0] * sides[1]).edges[0] @ t.T)
        assert along.max(1).min() > np.cos(0.25)
        assert along.max(0).min() > np.cos(0.25)


@pytest.mark.parametrize(
    ("effects", "limit"),
    [
        ({"noise": 10.0}, 0.04),
        ({"blur": 2.5}, 0.03),
        ({"light": (0.5, 0.4)}, 0.012),
        ({"margin": 0.2}, 0.01),
        ({"background": "clutter"}, 0.01),
    ],
    ids=str,
)
@pytest.mark.usefixtures("no_opencv")
def test_pictures_of_all_kinds(effects, limit):
    rng = np.random.default_rng(2)
    if "background" in effects:
        effects = {"background": clutter(CAMERA.size, rng=np.random.default_rng(3))}
    camera = view()
    picture = render(BOARD, camera, **({"blur": 0.7, "noise": 2.0, "rng": rng} | effects))
    off = find_corners(picture, BOARD) - camera.project(BOARD.points)
    assert np.sqrt(np.mean(off**2)) < limit


@pytest.mark.usefixtures("no_opencv")
@pytest.mark.slow
def test_the_count_that_is_there_is_named():
    picture = read_image(VIEWS[0])
    assert count_corners(picture) == (9, 6)
    with pytest.raises(CornersNotFound, match="a board of 9×6 inner corners is there"):
        find_corners(picture, Chessboard((8, 5), 25.0))


@pytest.mark.usefixtures("no_opencv")
@pytest.mark.slow
def test_a_hidden_corner_is_lost_and_the_others_are_not():
    camera = view(480.0)
    picture = render(BOARD, camera, blur=0.7, noise=2.0, rng=np.random.default_rng(1))
    truth = camera.project(BOARD.points)
    v, u = np.indices(picture.shape)
    picture[np.hypot(u - truth[22, 0], v - truth[22, 1]) < 14] = 90
    with pytest.raises(CornersNotFound):
        find_corners(picture, BOARD)
    m = find_corners(picture, BOARD, partial=True)
    assert np.flatnonzero(np.isnan(m).any(-1)).tolist() == [22]
    assert np.nanmax(np.abs(m - truth)) < 0.2


@pytest.mark.parametrize("shape", [(1, 1), (3, 400), (40, 40)])
@pytest.mark.usefixtures("no_opencv")
def test_where_there_is_no_board_none_is_found(shape):
    noise = np.random.default_rng(0).integers(0, 255, shape, np.uint8)
    for picture in (np.zeros(shape, np.uint8), noise):
        assert list(lattices(picture)) == []
        with pytest.raises(CornersNotFound, match=f"picture of {shape[1]}×{shape[0]} pixels"):
            find_corners(picture, BOARD)


@pytest.mark.parametrize("size", [(417, 300), (5, 2), (1, 1)])
@pytest.mark.parametrize("sigma", [1.0, 2.5])
def test_scipy_smooths_and_seeks_the_largest_as_opencv_does(size, sigma, monkeypatch):
    picture = np.random.default_rng(0).uniform(0, 255, size[::-1])
    around = 2 * int(1.5 * sigma) + 1
    smooth, largest = smoothed(picture.astype(np.float32), sigma), largest_around(picture, around)
    monkeypatch.setitem(sys.modules, "cv2", None)
    np.testing.assert_allclose(smoothed(picture.astype(np.float32), sigma), smooth, atol=2e-3)
    np.testing.assert_array_equal(largest_around(picture, around), largest)
