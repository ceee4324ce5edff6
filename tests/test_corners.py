from functools import cache

import cv2
import numpy as np
import pytest

from cvnotes.base import CornersNotFound, CvnotesError, InputTypeError, ShapeError
from cvnotes.camera import Camera, FisheyeLens, Lens, intrinsics, pose, rotation_from_vector
from cvnotes.pictures import clutter, good_views, render
from cvnotes.targets import Chessboard, find_corners, finding
from cvnotes.targets import lattice as _lattice
from cvnotes.targets.finding import count_corners
from cvnotes.targets.grey import _LARGEST, reduced
from cvnotes.targets.lattice import completed, handedness, measured, ordered, out_of_line
from cvnotes.targets.subpixel import fit_edges

BOARD = Chessboard((9, 6), 25.0)
CAMERA = Camera(intrinsics(800, 804, 325, 238), lens=Lens(k=(-0.25, 0.10)), size=(640, 480))
# What shows the same in a quarter of the pixels, where finders look for long.
HALF = Camera(intrinsics(400, 402, 162.25, 118.75), lens=CAMERA.lens, size=(320, 240))


def view(turn=(0.3, -0.4, 0.2), centre=(0, 0, 520), board=BOARD, half=False):
    R = rotation_from_vector(turn)
    return (HALF if half else CAMERA).moved(pose(R, np.array(centre) - R @ board.points.mean(0)))


def views(n, board=BOARD, seed=0):
    return [CAMERA.moved(G) for G in good_views(board, CAMERA, n, rng=np.random.default_rng(seed))]


def photograph(camera, board=BOARD, noise=2.0, seed=1, **effects):
    effects = {"blur": 0.7, **effects}
    return render(board, camera, noise=noise, rng=np.random.default_rng(seed), **effects)


@cache
def cluttered():
    return clutter((640, 480), rng=np.random.default_rng(5))


def rms(x):
    return float(np.sqrt(np.mean(np.square(x))))


@pytest.fixture(scope="module")
def shot():
    camera = view()
    return photograph(camera), camera.project(BOARD.points)


@pytest.fixture(scope="module")
def small_shot():
    camera = view(half=True)
    return photograph(camera), camera.project(BOARD.points)


class TestFound:
    def test_corners_lie_where_the_camera_put_them_in_the_boards_order(self):
        for camera in views(6):
            m = find_corners(photograph(camera, noise=0), BOARD)
            np.testing.assert_allclose(m, camera.project(BOARD.points), atol=0.03)
            assert rms(m - camera.project(BOARD.points)) < 0.004

    @pytest.mark.slow
    @pytest.mark.parametrize(
        ("effects", "limit"),
        [
            ({"blur": 0.0, "noise": 0.0}, 0.05),
            ({"noise": 5.0}, 0.018),
            ({"noise": 25.0}, 0.1),
            ({"blur": 2.5}, 0.03),
            ({"blur": 0.0, "motion": (5, 2)}, 0.06),
            ({"light": (0.5, 0.4)}, 0.012),
            ({"vignetting": 0.6}, 0.012),
            ({"gain": 0.1, "noise": 1.0}, 0.05),
            ({"gain": 0.15, "noise": 8.0}, 0.3),  # noise a quarter of the contrast
            ({"gain": 2.0}, 0.05),
            ({"jpeg": 20}, 0.05),
            ({"margin": 0.2}, 0.01),
            ({"background": "clutter"}, 0.01),
            ({"background": "clutter", "margin": 0.0}, 0.01),
        ],
        ids=str,
    )
    def test_pictures_of_all_kinds(self, effects, limit):
        if effects.get("background") == "clutter":
            effects = {**effects, "background": cluttered()}
        errors = []
        for camera in views(3, seed=2):
            m = find_corners(photograph(camera, **effects), BOARD)
            errors.append(m - camera.project(BOARD.points))
        assert rms(errors) < limit

    def test_steep_boards(self):
        for turn in ((1.05, 0.2, 0.1), (-0.3, 1.0, 0.4)):
            camera = view(turn, (0, 0, 480))
            m = find_corners(photograph(camera), BOARD)
            assert rms(m - camera.project(BOARD.points)) < 0.03

    @pytest.mark.parametrize("corners", [(3, 4), (4, 3), (6, 9), (14, 9)])
    def test_boards_of_other_counts(self, corners):
        board = Chessboard(corners, 200 / max(corners))
        camera = view((0.3, -0.2, 0.1), board=board)
        m = find_corners(photograph(camera, board), board)
        np.testing.assert_allclose(m, camera.project(board.points), atol=0.05)

    def test_a_large_picture_is_measured_at_its_full_size(self):
        camera = view()
        A = intrinsics(4 * 800, 4 * 804, 4 * 325.5 - 0.5, 4 * 238.5 - 0.5)
        large = Camera(A, camera.G, camera.lens, (2560, 1920))
        m = find_corners(photograph(large, blur=1.2), BOARD)
        assert rms(m - large.project(BOARD.points)) < 0.012

    @pytest.mark.slow
    def test_a_small_board_in_a_large_picture(self):
        camera = Camera(intrinsics(3000, 3000, 1280, 960), size=(2560, 1920))
        camera = camera.moved(pose(np.eye(3), [-300, 100, 6500]))
        m = find_corners(photograph(camera), BOARD)
        np.testing.assert_allclose(m, camera.project(BOARD.points), atol=0.05)


# Two lenses whose pictures bend a board more than its smallest square is wide: 120 and 140 degrees
# of view at their fold. Each board fills a good part of the picture.
WIDE = Camera(intrinsics(330, 330, 322, 237), lens=Lens(k=(-0.28, 0.06, -0.0055)), size=(640, 480))
FISHEYE = Camera(
    intrinsics(280, 280, 322, 237), lens=Lens(k=(-0.2, 0.027, -0.0014)), size=(640, 480)
)
CLOSE = [
    (WIDE, (0, 0, 0.1), (0, 0, 95)),
    (WIDE, (0.4, 0.2, 0), (40, 20, 130)),
    (WIDE, (0.4, 0.2, 0), (-35, 25, 110)),
    (FISHEYE, (0.4, 0.2, 0), (0, 0, 95)),
    (FISHEYE, (0.4, 0.2, 0), (-35, 25, 110)),
    (FISHEYE, (-0.3, 0.6, 0.2), (40, 20, 130)),
]


def close_up(camera, turn, centre):
    R = rotation_from_vector(turn)
    return camera.moved(pose(R, np.array(centre) - R @ BOARD.points.mean(0)))


def with_coin(image, camera, corner, radius=9.0, grey=150):
    """Lay a coin on a corner of the board."""
    angle = np.linspace(0, 2 * np.pi, 60)
    rim = np.zeros((60, 3)) + BOARD.points[corner]
    rim[:, :2] += radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    image, around = image.copy(), np.rint(16 * camera.project(rim)).astype(np.int32)
    cv2.fillPoly(image, [around], grey, cv2.LINE_AA, 4)
    return image


class TestWideLenses:
    @pytest.mark.parametrize("shot", CLOSE, ids=str)
    def test_a_board_is_found_however_much_the_lens_bends_it(self, shot):
        camera = close_up(*shot)
        m = find_corners(photograph(camera), BOARD)
        np.testing.assert_allclose(m, camera.project(BOARD.points), atol=0.1)

    @pytest.mark.parametrize("shot", CLOSE[3:], ids=str)
    def test_a_wrong_corner_is_seen_there_too(self, shot):
        lattice = close_up(*shot).project(BOARD.points).reshape(6, 9, 2)
        assert not out_of_line(lattice, _lattice._UNEVEN, 5).any()
        for i, j in ((2, 3), (0, 4), (3, 8), (5, 7)):
            wrong = lattice.copy()
            wrong[i, j] += 0.3 * (lattice[i, j - 1] - lattice[i, j])
            np.testing.assert_array_equal(
                np.argwhere(out_of_line(wrong, _lattice._UNEVEN, 5)), [[i, j]]
            )


class TestEdgesAlongPixelRows:
    @pytest.mark.parametrize("phase_v", np.arange(4) / 4)
    @pytest.mark.slow
    def test_a_sharp_board_is_found_in_all_phases(self, phase_v):
        # Where an edge is as sharp as may be, a step may turn it over with its crossing at rest.
        side = 24.3
        for phase_u in np.arange(4) / 4:
            G = np.eye(4)
            G[:3, 3] = np.array([60 + phase_u, 55 + phase_v, 20 * side]) * 500 / (20 * side)
            camera = Camera(intrinsics(20 * side, 20 * side, 0, 0), G, size=(360, 280))
            for seed in range(3):
                image = photograph(camera, blur=0.3, noise=4, seed=seed)
                truth = camera.project(BOARD.points)
                for start in (truth, np.rint(truth)):
                    fit = fit_edges(image, start, grid=(9, 6))
                    _lattice.check_board(fit, (9, 6))
                    np.testing.assert_allclose(fit.m, truth, atol=0.12)
            np.testing.assert_allclose(find_corners(image, BOARD), truth, atol=0.12)


@pytest.fixture(scope="module")
def whole():
    camera = view((0.3, -0.4, 0.2), (0, 0, 480), half=True)
    return photograph(camera), camera


class TestHiddenCorners:
    @pytest.mark.parametrize("corner", [0, 4, 13, 22, 31, 40, 53])
    @pytest.mark.slow
    def test_a_coin_takes_one_corner_and_leaves_the_others(self, corner, whole):
        image, camera = whole
        image = with_coin(image, camera, corner)
        m, truth = find_corners(image, BOARD, partial=True), camera.project(BOARD.points)
        assert np.flatnonzero(np.isnan(m).any(-1)).tolist() == [corner]
        assert np.nanmax(np.abs(m - truth)) < 0.2
        with pytest.raises(CornersNotFound):
            find_corners(image, BOARD)

    @pytest.mark.slow
    def test_a_coin_on_a_board_seen_through_a_wide_lens(self):
        camera = close_up(*CLOSE[1])
        image = with_coin(photograph(camera), camera, 30)
        m, truth = find_corners(image, BOARD, partial=True), camera.project(BOARD.points)
        assert np.flatnonzero(np.isnan(m).any(-1)).tolist() == [30]
        assert np.nanmax(np.abs(m - truth)) < 0.2

    def test_a_whole_board_is_whole_with_partial_too(self, shot):
        expected = find_corners(shot[0], BOARD)
        np.testing.assert_array_equal(find_corners(shot[0], BOARD, partial=True), expected)

    @pytest.mark.slow
    def test_of_a_board_mostly_hidden_nothing_is_believed(self, whole):
        image, camera = whole
        for corner in np.random.default_rng(0).choice(54, 24, replace=False):
            image = with_coin(image, camera, corner)
        with pytest.raises(CornersNotFound):
            find_corners(image, BOARD, partial=True)

    def test_a_corner_that_a_finder_missed_is_looked_for_where_the_others_expect_it(self, shot):
        wrong = shot[1].copy()
        wrong[[7, 30]] += 12.0
        m = measured(shot[0], wrong.reshape(6, 9, 2))
        np.testing.assert_allclose(m, shot[1], atol=0.06)

    @pytest.mark.parametrize(
        ("turn", "place", "most"),
        [
            ((-0.712, -0.75, -0.139), (-272.6, -45.1, 39.9), 9),  # the paper ends at 90°
            ((1.186, -0.722, -0.469), (-91.6, -38.5, 8.3), 2),  # a corner beyond the picture
        ],
    )
    def test_corners_that_edges_do_not_vouch_for_are_left_out(self, turn, place, most):
        camera = Camera(intrinsics(190, 190, 320, 240), lens=FisheyeLens((0.02, -0.01, 0.003)))
        camera = camera.moved(pose(rotation_from_vector(turn), place))
        truth, picture = camera.project(BOARD.points), photograph(camera)
        start = truth.reshape(6, 9, 2) + 0.3
        m = measured(picture, start, partial=True)
        assert 0 < np.count_nonzero(np.isnan(m).any(-1)) <= most
        assert np.nanmax(np.abs(m - truth)) < 0.15
        with pytest.raises(_lattice.NotABoard):
            measured(picture, start)

    def test_gaps_of_a_lattice_are_filled_as_its_neighbours_bend(self):
        lattice = close_up(*CLOSE[0]).project(BOARD.points).reshape(6, 9, 2)
        gaps = lattice.copy()
        gaps[[0, 2, 5], [0, 4, 5]] = np.nan
        side = np.linalg.norm(np.diff(lattice, axis=1), axis=-1).mean()
        assert np.abs(completed(gaps) - lattice).max() < 0.1 * side


class TestCount:
    @pytest.mark.parametrize("corners", [(9, 6), (8, 6), (7, 4), (4, 3), (13, 12)])
    @pytest.mark.slow
    def test_the_count_is_found_in_the_picture(self, corners):
        board = Chessboard(corners, 200 / max(corners), half_turn_symmetric=sum(corners) % 2 == 0)
        for turn in ((0.3, -0.2, 0.1), (-0.4, 0.3, 1.4)):
            assert count_corners(photograph(view(turn, board=board), board)) == corners

    @pytest.mark.slow
    def test_a_covered_corner_does_not_change_it(self, whole):
        image, camera = whole
        for corner in (0, 13, 31, 53):
            assert count_corners(with_coin(image, camera, corner)) == (9, 6)

    @pytest.mark.slow
    @pytest.mark.parametrize(
        ("corners", "turn", "far", "blur"),
        [
            ((4, 3), (0.01, 0.45, -0.36), 1159, 1.0),
            ((9, 6), (-0.41, -0.26, 0.3), 866, 0.7),
            ((9, 6), (0.44, 0.01, 0.48), 465, 1.0),
            ((12, 9), (0.31, 0.31, 0.02), 629, 1.3),
        ],
    )
    def test_nor_does_how_far_away_and_how_large_the_board_is(self, corners, turn, far, blur):
        # Where the outer squares end two edges cross as well, at one dark quadrant of four.
        board = Chessboard(corners, 25.0)
        camera = view(turn, (0, 0, far), board=board)
        image = photograph(camera, board, blur=blur)
        assert count_corners(image) == corners
        assert count_corners(with_coin(image, camera, 0)) == corners

    @pytest.mark.slow
    @pytest.mark.parametrize("shot", CLOSE, ids=str)
    def test_a_wide_lens_does_not_change_it(self, shot):
        assert count_corners(photograph(close_up(*shot))) == (9, 6)

    def test_there_is_none_without_a_board(self):
        assert count_corners(np.full((480, 640), 90, np.uint8)) is None
        noise = np.random.default_rng(0).integers(0, 255, (480, 640), dtype=np.uint8)
        assert count_corners(noise) is None

    @pytest.mark.slow
    @pytest.mark.parametrize(
        ("asked", "words"),
        [
            ((8, 5), "a board of 9×6 inner corners is there: were all of its inner corners"),
            ((7, 6), "a board of 9×6 inner corners is there: were all of its inner corners"),
            ((10, 7), "a board of 9×6 inner corners is there: were its squares counted"),
            ((12, 7), "only 9×6 of them can be seen: is the whole board in the picture"),
        ],
    )
    def test_the_count_that_is_there_is_named(self, small_shot, asked, words):
        with pytest.raises(CornersNotFound, match=words):
            find_corners(small_shot[0], Chessboard(asked, 25.0))

    @pytest.mark.slow
    def test_it_is_not_guessed_where_a_finder_found_the_board_that_was_asked_for(self):
        camera = view((0.3, -0.4, 0.2), (0, 0, 480), half=True)
        image = photograph(camera)
        for corner in (3, 4, 5):
            image = with_coin(image, camera, corner, radius=7)
        with pytest.raises(CornersNotFound) as error:
            find_corners(image, BOARD)
        assert "is there" not in str(error.value)


class TestKindsOfPictures:
    def test_colours_alpha_depth_and_range_give_the_same_corners(self, shot):
        grey, m = shot
        kinds = [
            np.dstack([grey] * 3),
            np.dstack([grey] * 3 + [np.zeros_like(grey)]),
            grey.astype(np.uint16) * 257,
            grey.astype(np.uint16) * 16,  # 12 bits in 16
            grey / np.float32(255),
            grey.astype(float) - 128,
        ]
        expected = find_corners(grey, BOARD)
        np.testing.assert_allclose(expected, m, atol=0.06)
        for image in kinds:
            np.testing.assert_allclose(find_corners(image, BOARD), expected, atol=0.02)

    def test_the_picture_is_left_alone(self, shot):
        image = shot[0].copy()
        image.setflags(write=False)
        find_corners(image, BOARD)
        np.testing.assert_array_equal(image, shot[0])

    def test_what_is_no_picture_is_refused(self, shot):
        with pytest.raises(InputTypeError, match="expected uint8, uint16, float32 or float64"):
            find_corners(shot[0] > 100, BOARD)
        with pytest.raises(ShapeError, match="expected"):
            find_corners(shot[0][0], BOARD)
        with pytest.raises(ShapeError, match="grey, RGB or RGBA"):
            find_corners(np.dstack([shot[0]] * 2), BOARD)
        with pytest.raises(ShapeError, match="expected"):
            find_corners(np.zeros((0, 5), np.uint8), BOARD)
        with pytest.raises(CvnotesError, match="NaN or infinite"):
            find_corners(np.full((40, 40), np.nan), BOARD)
        with pytest.raises(InputTypeError, match="None"):
            find_corners(None, BOARD)
        with pytest.raises(InputTypeError, match="a Chessboard or CharucoBoard, got tuple"):
            find_corners(shot[0], (9, 6))

    @pytest.mark.parametrize("shape", [(1, 1), (1, 500), (7, 500), (20, 20)])
    def test_tiny_pictures_hold_no_board(self, shape):
        with pytest.raises(CornersNotFound, match=f"picture of {shape[1]}×{shape[0]} pixels"):
            find_corners(np.zeros(shape, np.uint8), BOARD)


class TestOrder:
    @pytest.mark.parametrize("quarters", [0, 1, 2, 3])
    def test_turning_the_picture_turns_the_corners(self, shot, quarters):
        image, m = shot
        height, width = image.shape
        m = find_corners(image, BOARD)
        for _ in range(quarters):  # a quarter turn takes (u, v) to (v, width − 1 − u)
            m, width, height = np.stack([m[:, 1], width - 1 - m[:, 0]], -1), height, width
        turned = find_corners(np.rot90(image, quarters).copy(), BOARD)
        np.testing.assert_allclose(turned, m, atol=2e-3)

    def test_a_mirrored_picture_is_read_as_a_board_seen_from_its_front(self, shot):
        m = find_corners(shot[0][:, ::-1].copy(), BOARD).reshape(6, 9, 2)
        assert handedness(m) > 0
        # The mirror image of the first column, from its other end.
        expected = shot[1].reshape(6, 9, 2)[::-1]
        np.testing.assert_allclose(m, [639, 0] - expected * [1, -1], atol=0.06)

    @pytest.mark.parametrize("flip", [np.s_[::-1, ::-1], np.s_[::-1], np.s_[:, ::-1]], ids=str)
    def test_the_order_in_which_they_were_found_does_not_matter(self, shot, flip):
        m = measured(shot[0], shot[1].reshape(6, 9, 2)[flip])
        np.testing.assert_allclose(m, find_corners(shot[0], BOARD), atol=2e-3)

    @pytest.mark.parametrize("corners", [(8, 6), (7, 5), (7, 7)])
    @pytest.mark.parametrize("turn", [0.3, 1.9, 3.3, -1.2])
    def test_the_origin_of_a_symmetric_board_is_at_the_end_near_the_top_left(self, corners, turn):
        board = Chessboard(corners, 25.0, half_turn_symmetric=True)
        camera = view((0.2, -0.3, turn), (0, 0, 620), board)
        m = find_corners(photograph(camera, board), board)
        truth = camera.project(board.points)
        apart = np.linalg.norm(m[:, None] - truth, axis=-1)
        assert apart.min(1).max() < 0.06
        assert handedness(m.reshape(*corners[::-1], 2)) > 0
        half_turn = m[::-1]
        assert np.hypot(*m[0]) < np.hypot(*half_turn[0])
        # Only half a turn away, at most, from what was rendered: its dark squares are there.
        assert min(np.abs(m - truth).max(), np.abs(half_turn - truth).max()) < 0.06

    def test_the_square_outside_of_the_first_corner_is_dark(self):
        lattice = np.stack(np.meshgrid([10.0, 20, 30], [10.0, 20]), axis=-1)
        dark = np.array([[-1, 1, -1], [1, -1, 1]])
        assert ordered(lattice, dark)[0].tolist() == [10, 10]
        assert ordered(lattice, -dark)[0].tolist() == [30, 20]

    def test_left_handed_corners_are_mirrored(self):
        lattice = np.stack(np.meshgrid([30.0, 20, 10], [10.0, 20]), axis=-1)
        assert handedness(ordered(lattice, np.ones((2, 3))).reshape(2, 3, 2)) == 100


class TestRefused:
    def test_no_board_tells_what_was_tried_and_what_to_look_at(self):
        image = np.full((480, 640), 90, np.uint8)
        with pytest.raises(CornersNotFound) as error:
            find_corners(image, BOARD)
        message = str(error.value)
        assert "no board of 9×6 inner corners found in a picture of 640×480 pixels" in message
        assert "(320×240: not found; 640×480: not found)" in message
        assert "is the whole board in the picture" in message

    def test_squares_counted_for_corners(self, small_shot):
        with pytest.raises(CornersNotFound, match="a board of 9×6 inner corners is there: were"):
            find_corners(small_shot[0], Chessboard((10, 7), 25.0))

    def test_boards_that_no_finder_finds(self, shot):
        with pytest.raises(CornersNotFound, match="at least 3 inner corners along each side"):
            find_corners(shot[0], Chessboard((9, 2), 25.0))

    def test_a_board_that_is_cut_off(self, small_shot):
        image, m = small_shot
        with pytest.raises(CornersNotFound, match="whole board"):
            find_corners(image[:, : int(np.sort(m[:, 0])[-4])].copy(), BOARD)

    @pytest.mark.slow
    def test_a_hidden_corner(self, small_shot):
        image, m = small_shot
        u, v = m[31]
        v_all, u_all = np.indices(image.shape)
        hidden = np.where(np.hypot(u_all - u, v_all - v) < 7, 140, image).astype(np.uint8)
        with pytest.raises(CornersNotFound):
            find_corners(hidden, BOARD)

    @pytest.mark.slow
    @pytest.mark.parametrize(
        ("corners", "part"),
        [
            ((11, 8), np.s_[:6, :9]),
            ((11, 8), np.s_[1:7, 1:10]),
            ((11, 8), np.s_[2:, 2:]),
            ((9, 8), np.s_[:6]),
            ((9, 8), np.s_[2:]),
            ((11, 6), np.s_[:, :9]),
            ((11, 6), np.s_[:, 2:]),
        ],
        ids=str,
    )
    @pytest.mark.parametrize("light", [(0.0, 0.0), (0.5, 0.4)])
    def test_part_of_a_larger_board(self, corners, part, light):
        larger = Chessboard(corners, 20.0)
        camera = view((0.3, -0.5, 0.4), board=larger)
        image = photograph(camera, larger, light=light)
        found = camera.project(larger.points).reshape(*corners[::-1], 2)[part]
        with pytest.raises(_lattice.NotABoard, match="squares go on beyond 9×6 corners"):
            measured(image, found)

    @pytest.mark.slow
    def test_larger_boards_are_not_taken_for_it(self):
        for corners in ((10, 7), (11, 6), (9, 8)):
            board = Chessboard(corners, 20.0)
            camera = view((0.2, -0.3, 0.1), board=board, half=True)
            with pytest.raises(CornersNotFound):
                find_corners(photograph(camera, board), BOARD)

    def test_a_corner_out_of_line(self, shot):
        image, m = shot
        fit = fit_edges(image, m, grid=(9, 6))
        _lattice.check_board(fit, (9, 6))
        fit.m[20] += 3.0
        with pytest.raises(_lattice.NotABoard, match=r"out of line by \d+\.\d px"):
            _lattice.check_board(fit, (9, 6))

    def test_squares_that_do_not_alternate(self, shot):
        fit = fit_edges(shot[0], shot[1], grid=(9, 6))
        fit.contrast[20] *= -1
        with pytest.raises(_lattice.NotABoard, match="not alternately light and dark"):
            _lattice.check_board(fit, (9, 6))

    @pytest.mark.slow
    def test_noise_is_no_board(self):
        # In all of these, one of OpenCV's finders sees a 3×3 board.
        board = Chessboard((3, 3), 25.0, half_turn_symmetric=True)
        for seed, shape in ((0, (480, 640)), (1, (480, 640)), (5, (240, 320))):
            noise = np.random.default_rng(seed).integers(0, 255, shape, dtype=np.uint8)
            with pytest.raises(CornersNotFound):
                find_corners(noise, board)

    @pytest.mark.parametrize("found", [np.zeros((54, 2)), np.arange(108.0).reshape(54, 2)])
    def test_points_on_a_line_are_no_board(self, shot, found):
        with pytest.raises(_lattice.NotABoard, match="found, but its corners lie on a line"):
            measured(shot[0], found.reshape(6, 9, 2))


class TestCopies:
    def test_large_pictures_are_looked_at_in_reduced_copies(self, monkeypatch):
        seen = []
        monkeypatch.setattr(finding, "lattices", lambda grey: seen.append(grey.shape) or [])
        with pytest.raises(CornersNotFound, match="333×250: not found; 666×500: not found"):
            find_corners(np.zeros((6000, 8000), np.uint8), BOARD)
        assert seen == [(250, 333), (500, 666), (1000, 1333), (2000, 2666)]
        assert 6000 * 8000 > _LARGEST >= 3000 * 4000

    def test_a_pixel_of_a_reduced_copy_is_the_mean_of_those_it_covers(self):
        grey = np.random.default_rng(0).integers(0, 256, (6, 8), dtype=np.uint8)
        small = reduced(grey, 2)
        np.testing.assert_allclose(small, grey.reshape(3, 2, 4, 2).mean((1, 3)), atol=0.51)


@pytest.mark.parametrize("side", [48.0, 50.0])
def test_a_board_seen_straight_from_the_front_is_found_wherever_it_stands(side):
    # On such symmetric pictures a first step may leave the crossing at rest and ruin the rest.
    board = Chessboard((9, 6), 25.0)
    A = intrinsics(20 * side, 20 * side, 0, 0)
    for shift in (0.0, 0.25, 0.5):
        G = np.eye(4)
        G[:3, 3] = [500 * 90 / (20 * side), 500 * (90 + shift) / (20 * side), 500]
        camera = Camera(A, G, size=(600, 460))
        found = find_corners(render(board, camera, blur=0.7), board)
        np.testing.assert_allclose(found, camera.project(board.points), atol=0.02)
