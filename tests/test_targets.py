import numpy as np
import pytest

from cvnotes.base import CvnotesError
from cvnotes.camera import Camera, intrinsics, look_at, move
from cvnotes.targets import Chessboard, ThreePlanes, TwoPlanes

TARGETS = [Chessboard(), TwoPlanes(), TwoPlanes(angle=np.deg2rad(120)), ThreePlanes()]


def test_corners_run_along_x_first_and_lie_in_the_plane_z_0():
    points = Chessboard((3, 2), 10).points
    assert points.tolist() == [
        [0, 0, 0],
        [10, 0, 0],
        [20, 0, 0],
        [0, 10, 0],
        [10, 10, 0],
        [20, 10, 0],
    ]


def test_a_board_has_one_square_more_than_inner_corners_each_way():
    assert Chessboard((9, 6)).squares == (10, 7)


@pytest.mark.parametrize("corners", [(8, 6), (9, 7), (6, 6)])
def test_equal_parity_is_refused_with_the_reason_and_the_way_out(corners):
    with pytest.raises(CvnotesError, match=r"same after half a turn.*half_turn_symmetric=True"):
        Chessboard(corners)
    assert Chessboard(corners, half_turn_symmetric=True).corners == corners


def test_the_parity_rule_is_about_the_half_turn_of_the_pattern():
    for corners in [(9, 6), (8, 6), (4, 3), (5, 5)]:
        board = Chessboard(corners, half_turn_symmetric=True)
        i, j = np.indices(board.squares)
        dark = (i + j) % 2 == 0
        assert (dark == dark[::-1, ::-1]).all() == (sum(corners) % 2 == 0)


@pytest.mark.parametrize(
    ("corners", "square", "words"),
    [
        ((0, 0), 25, "two positive whole numbers"),
        ((9, 1), 25, "at least 2×2"),
        ("9x6", 25, "two positive whole numbers"),
        ((9, 6), 0, "must be positive"),
        ((9, 6), -1, "must be positive"),
        ((9, 6), float("nan"), "NaN"),
    ],
)
def test_impossible_boards_are_refused_in_words(corners, square, words):
    with pytest.raises(CvnotesError, match=words):
        Chessboard(corners, square)


@pytest.mark.parametrize("target", TARGETS)
def test_points_are_the_faces_corners_one_face_after_the_other(target):
    n = 54
    assert target.points.shape == (n * len(target.faces), 3)
    for k, (world_from_board, board) in enumerate(target.faces):
        expected = move(world_from_board, board.points)
        assert np.allclose(target.points[k * n : (k + 1) * n], expected, atol=1e-12)


def test_the_two_planes_are_z_0_and_x_0_when_they_meet_at_a_right_angle():
    back, side = np.split(TwoPlanes(Chessboard((4, 3), 20)).points, 2)
    assert np.allclose(back[:, 2], 0, atol=1e-12)
    assert np.allclose(side[:, 0], 0, atol=1e-12)
    assert sorted(set(back[:, 0].round(9))) == [40, 60, 80, 100]
    assert sorted(set(side[:, 2].round(9))) == [-100, -80, -60, -40]


@pytest.mark.parametrize("degrees", [30, 90, 135, 180])
def test_the_two_planes_meet_at_the_angle_asked_for(degrees):
    back, side = np.split(TwoPlanes(angle=np.deg2rad(degrees)).points, 2)
    # From the edge (the y axis) to the last corner of the first row on either page.
    out, other = back[8], side[0]
    cosine = out @ other / np.linalg.norm(out) / np.linalg.norm(other)
    assert np.rad2deg(np.arccos(np.clip(cosine, -1, 1))) == pytest.approx(degrees, abs=1e-5)


def test_the_three_planes_are_z_0_x_0_and_y_0():
    for axis, face in zip((2, 0, 1), np.split(ThreePlanes().points, 3), strict=True):
        assert np.allclose(face[:, axis], 0, atol=1e-12)
        assert np.abs(np.delete(face, axis, axis=1)).min() == pytest.approx(50)


@pytest.mark.parametrize("target", TARGETS)
def test_papers_with_the_same_margin_touch_but_do_not_overlap(target):
    # Corners of the squares plus margin, seen from every other board's frame: none behind it.
    for frame, _ in target.faces:
        for world_from_board, board in target.faces:
            columns, rows = board.squares
            paper = np.array([[x, y, 0] for x in (-2, columns) for y in (-2, rows)]) * board.square
            seen = move(np.linalg.inv(frame), move(world_from_board, paper))
            assert seen[:, 2].max() <= 1e-9


@pytest.mark.parametrize("target", TARGETS)
def test_every_face_shows_its_printed_side_to_a_camera_in_the_open(target):
    camera = Camera(intrinsics(800, 800, 320, 240), look_at([900, -700, -1200], [50, 0, -50]))
    for world_from_board, board in target.faces:
        corners = camera.project(move(world_from_board, board.points)).reshape(6, 9, 2)
        along_x, along_y = corners[0, -1] - corners[0, 0], corners[-1, 0] - corners[0, 0]
        # Seen from its printed side, x to y turns clockwise on the screen, where v points down.
        assert along_x[0] * along_y[1] - along_x[1] * along_y[0] > 0


def test_faces_are_proper_rigid_motions():
    for target in TARGETS:
        for world_from_board, _ in target.faces:
            assert np.allclose(world_from_board[:3, :3] @ world_from_board[:3, :3].T, np.eye(3))
            assert np.linalg.det(world_from_board) == pytest.approx(1)


def test_what_a_caller_does_to_the_points_does_not_reach_the_target():
    board = Chessboard()
    board.points[:] = 7
    board.faces[0][0][:] = 7
    assert board.points[1].tolist() == [25, 0, 0]
    assert board.faces[0][0].tolist() == np.eye(4).tolist()


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: TwoPlanes(angle=90), r"\(0, π\] radians, got 90 \(degrees\?\)"),
        (lambda: TwoPlanes(angle=0), r"\(0, π\] radians, got 0"),
        (lambda: TwoPlanes(margin=-0.5), "overlap"),
        (lambda: ThreePlanes(margin=-0.5), "overlap"),
        (lambda: TwoPlanes((9, 6)), "expected a Chessboard, got tuple"),
    ],
)
def test_impossible_arrangements_are_refused_in_words(make, words):
    with pytest.raises(CvnotesError, match=words):
        make()
