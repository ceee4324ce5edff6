"""Boards whose corners have numbers: drawn as OpenCV draws them, and found better."""

import re
from xml.etree import ElementTree

import cv2
import numpy as np
import pytest
from PIL import Image

from cvnotes.base import CornersNotFound, CvnotesError, DegenerateError
from cvnotes.calibration import calibrate
from cvnotes.camera import Camera, FisheyeLens, Lens, intrinsics, look_at
from cvnotes.commands.cli import main
from cvnotes.commands.report import note_of, notes_of
from cvnotes.photographs import NoCamera, calibrate_photographs
from cvnotes.pictures import render
from cvnotes.targets import CharucoBoard, Chessboard, find_corners
from cvnotes.targets.markers import _dictionary, _outlines, _read, find_numbered

BOARD = CharucoBoard((9, 6), 25.0)
SMALL = CharucoBoard((4, 3), 25.0)  # each square that might be a marker is looked up in thousands
SIZE = (640, 480)
A = intrinsics(800, 804, 325, 238)


def theirs(squares, dictionary="4X4_50", marker=18.75):
    markers = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, f"DICT_{dictionary}"))
    return cv2.aruco.CharucoBoard(squares, 25.0, marker, markers)


LENS = Lens(k=(-0.25, 0.10))


def camera(eye, at=(100, 62, 0)):
    return Camera(A, look_at(eye, at), LENS, SIZE)


@pytest.mark.parametrize(
    ("corners", "dictionary"), [((9, 6), "4x4_50"), ((6, 9), "5x5_100"), ((4, 4), "6x6_250")]
)
def test_it_is_the_board_that_opencv_draws(corners, dictionary):
    # 40 px a square, 4 px a cell, of which a marker has two more than bits
    marker = 25 * (int(dictionary[0]) + 2) * 4 / 40
    squares = (corners[0] + 1, corners[1] + 1)
    drawn = theirs(squares, dictionary.upper(), marker).generateImage(
        (40 * squares[0], 40 * squares[1])
    )
    x, y, dark = CharucoBoard(corners, 25.0, marker, dictionary).printed
    columns, rows = (np.rint((z - z[0]) * 40 / 25).astype(int) for z in (x, y))
    ours = np.where(np.repeat(np.repeat(dark, np.diff(rows), 0), np.diff(columns), 1), 0, 255)
    assert np.array_equal(ours, drawn)


def test_numbers_and_places_of_corners_are_those_of_opencv_but_for_the_origin():
    at = theirs((10, 7)).getChessboardCorners()
    assert np.allclose(np.asarray(at).reshape(-1, 3) - [25, 25, 0], BOARD.points)
    assert BOARD.ids.tolist() == list(range(54))
    assert BOARD.n_markers == len(theirs((10, 7)).getIds())
    assert np.array_equal(BOARD.points, Chessboard((9, 6), 25.0).points)


def test_a_picture_of_it_has_ink_and_paper_where_they_are():
    # 40 px a square; the board's middle, 200 and 140 px from its edges, is at (179.5, 119.5)
    G = look_at([100, 62.5, -25], [100, 62.5, 0])
    picture = render(BOARD, Camera(intrinsics(40, 40, 179.5, 119.5), G, size=(400, 280)))
    drawn = theirs((10, 7)).generateImage((400, 280))[20:, 20:]
    shown = picture[: drawn.shape[0], : drawn.shape[1]]
    assert np.array_equal(shown, np.where(drawn == 0, 30, 220))


@pytest.mark.parametrize("noise", [0.0, 5.0])
def test_corners_are_several_times_better_than_opencvs(noise):
    rng = np.random.default_rng(0)
    ours, opencvs = [], []
    for eye in ([60, 40, -330], [200, -60, -450], [-60, 140, -600]):
        known = camera(eye)
        picture = render(BOARD, known, blur=0.7, noise=noise, rng=rng)
        truth, m = known.project(BOARD.points), find_corners(picture, BOARD)
        found, ids, *_ = cv2.aruco.CharucoDetector(theirs((10, 7))).detectBoard(picture)
        assert np.isfinite(m).all()
        ours.append(m - truth)
        opencvs.append(np.reshape(found, (-1, 2)) - truth[np.ravel(ids)])
    rms = [np.sqrt(np.mean(np.concatenate(e) ** 2)) for e in (ours, opencvs)]
    assert rms[0] < (0.006 if noise == 0 else 0.02)
    assert rms[1] > 3 * rms[0]


def test_the_side_of_a_square_that_is_no_round_number_loses_no_corner():
    board, side = CharucoBoard((30, 15), 49.33, dictionary="4x4_250"), 49.33
    squares = board.points[:, :2] / side
    assert (squares != np.rint(squares)).any()  # or there is nothing to be tried
    G = look_at([15 * side, 7.5 * side, -1150], [15 * side, 7.5 * side, 0])
    known = Camera(intrinsics(900, 900, 639.5, 399.5), G, size=(1280, 800))
    assert np.isfinite(find_corners(render(board, known, blur=0.7), board)).all()


def test_a_board_cut_at_the_border_gives_the_corners_that_are_there():
    known = camera([20, 20, -200], at=(20, 20, 0))
    truth = known.project(BOARD.points)
    m = find_corners(render(BOARD, known, blur=0.7), BOARD)
    seen = np.isfinite(m[:, 0])
    inside = ((truth > 0) & (truth < np.array(SIZE) - 1)).all(-1)
    assert 10 < seen.sum() < 54
    assert not (seen & ~inside).any()
    assert np.abs(m[seen] - truth[seen]).max() < 0.03
    with pytest.raises(CornersNotFound):  # of a plain board that is no picture at all
        find_corners(render(Chessboard((9, 6), 25.0), known, blur=0.7), Chessboard((9, 6), 25.0))


def test_a_board_that_looks_the_same_after_half_a_turn_knows_its_origin():
    board, known = CharucoBoard((8, 6), 25.0), camera([80, 60, -400], at=(80, 60, 0))
    upside_down = render(board, known, blur=0.7)[::-1, ::-1]
    m = find_corners(upside_down, board)
    assert np.allclose(m, np.array(SIZE) - 1 - known.project(board.points), atol=0.03)


@pytest.mark.parametrize("corners", [(9, 5), (8, 5)])
def test_a_board_in_the_legacy_pattern_is_known_by_where_its_markers_stand(corners):
    old = CharucoBoard(corners, 25.0, legacy=True)
    squares = (corners[0] + 1, corners[1] + 1)
    drawn = theirs(squares)
    drawn.setLegacyPattern(True)
    known = camera([60, 40, -330])
    picture, truth = render(old, known, blur=0.7), known.project(old.points)
    ids = cv2.aruco.CharucoDetector(drawn).detectBoard(picture)[1]
    assert len(ids) == len(truth)  # it is the board that OpenCV means
    m = find_corners(picture, CharucoBoard(corners, 25.0))
    assert np.abs(m - truth).max() < 0.03
    new = find_corners(
        render(CharucoBoard(corners, 25.0), known, blur=0.7), CharucoBoard(corners, 25.0)
    )
    assert np.abs(new - truth).max() < 0.03


def test_squares_that_were_counted_for_corners_are_named():
    picture = render(BOARD, camera([60, 40, -330]), blur=0.7)
    with pytest.raises(CornersNotFound, match="of 10×7 squares; count the inner corners, 9×6"):
        find_corners(picture, CharucoBoard((10, 7), 25.0))


def test_a_numbered_board_that_is_taken_for_a_plain_one_is_named(tmp_path, capsys):
    picture = render(BOARD, camera([60, 40, -330]), blur=0.7)
    for i in range(2):
        Image.fromarray(picture[:, 7 * i :]).save(tmp_path / f"{i}.png")
    with pytest.raises(CornersNotFound, match=r"are markers of 4x4; is it a ChArUco board") as no:
        find_corners(picture, Chessboard((9, 6), 25.0))
    assert no.value.markers == "4x4"
    asked = ["calibrate", str(tmp_path), "--corners", "9x6", "--square", "25"]
    assert main([*asked, "--out", str(tmp_path / "out")]) == 1
    said = capsys.readouterr().err
    assert said.endswith("9×6 inner corners was found in none: there are markers of 4x4\n")


def test_a_dictionary_that_is_too_small_is_said_and_not_another_count():
    large = CharucoBoard((13, 8), 25.0, dictionary="4x4_100")
    picture = render(large, camera([150, 100, -500], at=(150, 100, 0)), blur=0.7)
    with pytest.raises(CornersNotFound, match="there are markers of 4x4_250"):
        find_corners(picture, CharucoBoard((8, 5), 25.0))


def test_tags_are_markers_too():
    board = CharucoBoard((4, 3), 25.0, dictionary="apriltag_36h11")
    known = camera([50, 30, -400], at=(37, 25, 0))
    m = find_corners(render(board, known, blur=0.7), board)
    assert np.abs(m - known.project(board.points)).max() < 0.03


@pytest.mark.slow
def test_from_cut_boards_to_the_camera():
    rng = np.random.default_rng(4)
    eyes = [(-80, -60, -260), (260, -80, -260), (-60, 180, -280), (240, 200, -270),
            (100, -160, -330), (100, 260, -330), (320, 60, -300), (-140, 60, -300)]  # fmt: skip
    targets = [(20, 10, 0), (190, 20, 0), (10, 110, 0), (180, 110, 0), (100, 62, 0)]
    W, m = [], []
    for i, eye in enumerate(eyes):
        known = camera(eye, targets[i % 5])
        found = find_corners(render(BOARD, known, blur=0.7, noise=3, rng=rng), BOARD)
        seen = np.isfinite(found[:, 0])
        W.append(BOARD.points[seen])
        m.append(found[seen])
    assert min(map(len, m)) < 54
    result = calibrate(W, m, SIZE, lens="k1 k2")
    std = result.std
    for name, truth in {"alpha_u": 800, "alpha_v": 804, "u0": 325, "v0": 238, "k1": -0.25}.items():
        assert abs(result.parameters[name] - truth) < 3 * std[name], name


@pytest.mark.parametrize(
    ("there", "board", "said"),
    [
        (SMALL, CharucoBoard((4, 3), 25.0, dictionary="5x5_100"), "there are markers of 4x4"),
        (BOARD, CharucoBoard((5, 4), 25.0), "stand as on a board of 10×7 squares"),
        (BOARD, CharucoBoard((9, 4), 25.0), "stand as on a board of 10×7 squares"),
        (BOARD, CharucoBoard((9, 5), 25.0), "stand as on a board of 10×7 squares"),
    ],
)
@pytest.mark.slow
def test_another_board_is_named(there, board, said):
    picture = render(there, camera([60, 40, -330]), blur=0.7)
    with pytest.raises(CornersNotFound, match=said):
        find_corners(picture, board)


@pytest.mark.slow
def test_another_dictionary_is_known_from_two_photographs_of_which_none_is_measured(monkeypatch):
    monkeypatch.setattr("cvnotes.photographs.detection.detect", None)
    pictures = [render(SMALL, camera([60 + i, 40, -330]), blur=0.7) for i in range(2)]
    asked = CharucoBoard((4, 3), 25.0, dictionary="5x5_100")
    with pytest.raises(DegenerateError, match="have markers of 4x4, not 5x5_100"):
        calibrate_photographs([*pictures, np.zeros((480, 640), np.uint8)], asked)


@pytest.mark.slow
def test_a_dictionary_is_known_by_a_board_of_which_the_first_markers_cannot_be_seen():
    large = CharucoBoard((19, 11), 25.0, dictionary="4x4_250")
    far = camera([240, 260, -420], at=(240, 220, 0))
    u, v = far.project(large.points[0])
    assert v < -100 or u < -100
    picture = render(large, far, blur=0.7)
    asked = large.squares, 0.75, "5x5_250"
    assert find_numbered(picture, *asked).other == "4x4"
    assert find_numbered(picture, *asked[:2], "4x4_50").other == "4x4_250"
    seen = find_numbered(picture, *large.read_by)
    assert not seen.other
    assert len(seen.m) > 20


@pytest.mark.parametrize("dictionary", ["4x4_250", "5x5_250", "7x7_250", "apriltag_36h11"])
def test_markers_are_read_as_opencv_reads_them(dictionary):
    board = CharucoBoard((13, 8), 25.0, dictionary=dictionary)
    known = camera([60, 200, -400], at=(150, 100, 0))
    picture = render(board, known, blur=0.7, noise=4, rng=np.random.default_rng(1))
    grey = np.ascontiguousarray(picture[::-1, ::-1])
    whole = _dictionary(dictionary)
    outlines, numbers, _ = cv2.aruco.ArucoDetector(whole).detectMarkers(grey)
    theirs = dict(zip(np.ravel(numbers).tolist(), np.reshape(outlines, (-1, 4, 2)), strict=True))
    read, at = _read(grey, _outlines(grey), dictionary)[::-1]
    ours = dict(zip(read.tolist(), at, strict=True))
    assert len(theirs) > 40
    assert set(ours) >= set(theirs)
    # (of two outlines that one marker may have, it may be the other)
    assert max(np.abs(ours[i] - theirs[i]).max() for i in theirs) < 3


def test_one_misread_marker_does_not_lose_the_board():
    known = camera([60, 40, -600])
    picture = render(BOARD, known, blur=0.7)
    stray = cv2.aruco.generateImageMarker(_dictionary("4x4_50"), 20, 60)
    picture[10:90, 10:90] = 220
    picture[20:80, 20:80] = np.where(stray > 0, 220, 30)
    m = find_corners(picture, BOARD)
    seen = np.isfinite(m[:, 0])
    assert seen.sum() > 40
    assert np.abs(m - known.project(BOARD.points))[seen].max() < 0.05


def test_a_wide_lens_leads_no_corner_beyond_the_horizon_of_the_others():
    board = CharucoBoard((19, 9), 25.0, dictionary="4x4_100")
    G = look_at([100, 160, -60], [240, 40, 0])
    wide = Camera(intrinsics(330, 330, 639.5, 399.5), G, FisheyeLens((-0.02, 0.01)), (1280, 800))
    m = find_corners(render(board, wide, blur=0.7), board)
    seen = np.isfinite(m[:, 0])
    assert seen.sum() > 70  # a homography of them would lead to 57, one of them a pixel off
    assert np.abs(m - wide.project(board.points))[seen].max() < 0.2


def test_corners_outside_the_picture_are_not_called_unclear():
    found = calibrate_photographs(
        [render(BOARD, camera(*at), blur=0.7) for at in (
            ([60, 40, -330], (100, 62, 0)), ([200, 0, -330], (100, 62, 0)),
            ([100, 160, -330], (100, 62, 0)), ([60, 40, -330], (10, 62, 0)),
        )], BOARD, lens="k1 k2", board_shape="flat",
    )  # fmt: skip
    cut = found.photographs.used[3]
    m = camera([60, 40, -330], (10, 62, 0)).project(BOARD.points)
    out = ((m < -0.5) | (m > np.array(SIZE) - 0.5)).any(-1).sum()
    assert 5 < out < 40
    *whole, note = notes_of(found.photographs, found.calibration)
    assert whole == [""] * 3
    assert f"{out} of 54 corners are outside the picture" in note
    assert "or are outside the picture" in note_of(cut)


@pytest.mark.slow
def test_without_any_marker_that_is_said():
    with pytest.raises(CornersNotFound, match="not one marker can be read"):
        find_corners(render(Chessboard((4, 3), 25.0), camera([60, 40, -330]), blur=0.7), SMALL)
    with pytest.raises(CornersNotFound, match="not one marker can be read"):
        find_corners(np.zeros((40, 40)), BOARD)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (((9, 6), 25.0, 25.0), "does not fit into a square"),
        (((9, 6), 25.0, -1.0), "does not fit into a square"),
        (((1, 6), 25.0), "at least 2×2"),
        (((9, 6), 25.0, None, "8x8_50"), "expected one of 4x4_50"),
        (((12, 9), 25.0), "has 50 markers and a board of 12×9"),
    ],
)
def test_boards_that_cannot_be_are_refused_in_words(arguments, said):
    with pytest.raises(CvnotesError, match=said):
        CharucoBoard(*arguments)


@pytest.mark.parametrize(
    ("dictionary", "largest", "too_large"),
    # squares: 10×10 and 17×6, of which half are light; 29×7, where one more is dark than light
    [("4x4_50", (9, 9), (16, 5)), ("5x5_100", (19, 9), (28, 6))],
)
def test_a_board_may_need_every_marker_of_its_dictionary_but_not_one_more(
    dictionary, largest, too_large
):
    columns, rows = largest
    opencvs = theirs((columns + 1, rows + 1), dictionary.upper())
    board = CharucoBoard(largest, 25.0, dictionary=dictionary)
    assert board.n_markers == len(opencvs.getIds()) == len(opencvs.getDictionary().bytesList)

    most, (columns, rows) = board.n_markers, too_large
    said = f"{dictionary} has {most} markers and a board of {columns}×{rows} .* needs {most + 1}$"
    with pytest.raises(CvnotesError, match=said):
        CharucoBoard(too_large, 25.0, dictionary=dictionary)


def test_the_sheet_shows_every_dark_field_in_millimetres():
    sheet = BOARD.sheet()
    area = ElementTree.fromstring(sheet.svg()).find(
        "{http://www.w3.org/2000/svg}path[@fill='#000000']"
    )
    ways = re.findall(r"M([^Z]*)Z", area.get("d"))
    boxes = [np.array(re.findall(r"[\d.]+", way), float).reshape(-1, 2) for way in ways]
    inked = sum(np.prod(np.ptp(box, axis=0)) for box in boxes)
    x, y, dark = BOARD.printed
    assert inked == pytest.approx((np.outer(np.diff(y), np.diff(x)) * dark).sum(), rel=1e-6)
    assert 'CharucoBoard((9, 6), 25, 18.75, "4x4_50")' in sheet.svg().replace("&quot;", '"')


@pytest.mark.slow
def test_the_command_prints_and_calibrates_it(tmp_path, capsys):
    assert main(["target", "--charuco", "--out", str(tmp_path / "board.pdf")]) == 0
    assert (tmp_path / "board.pdf").read_bytes().startswith(b"%PDF")
    photos = tmp_path / "photos"
    photos.mkdir()
    rng = np.random.default_rng(5)
    for i, eye in enumerate(
        [(-80, -60, -300), (260, -80, -320), (-60, 220, -330), (240, 200, -300)]
    ):
        made = render(BOARD, camera(eye, (40 + 40 * i, 62, 0)), blur=0.7, noise=3, rng=rng)
        Image.fromarray(made).save(photos / f"{i}.png")
    plain = ["calibrate", str(photos), "--corners", "9x6", "--square", "25", "--lens", "k1 k2"]
    out = tmp_path / "out"
    assert main([*plain, "--charuco", "--board-shape", "flat", "--out", str(out)]) == 0
    assert (out / "report.html").exists()
    assert "4 photographs" in capsys.readouterr().out
    assert main([*plain, "--marker", "18", "--out", str(out)]) == 2
    assert "--marker is of ChArUco boards" in capsys.readouterr().err
    for photograph in sorted(photos.iterdir())[1:]:  # each one would be named alike
        photograph.unlink()
    assert main([*plain, "--charuco", "5x5_100", "--out", str(out)]) == 1
    assert "there are markers of 4x4" in capsys.readouterr().out


@pytest.mark.slow
def test_a_count_that_is_one_row_short_is_answered_with_the_right_one():
    views = [camera([60, 40, -330]), camera([160, 90, -330]), camera([90, 10, -360])]
    pictures = [render(BOARD, view, blur=0.7) for view in views]
    with pytest.raises(NoCamera, match=r"a board of 9×5 .* 3 photographs show one of 9×6"):
        calibrate_photographs(pictures, CharucoBoard((9, 5), 25.0))
