import re
import shutil
import subprocess
from xml.etree import ElementTree

import numpy as np
import pytest

from cvnotes.base import CvnotesError
from cvnotes.targets import PAPERS, Chessboard
from cvnotes.targets.page import Line

SVG = "{http://www.w3.org/2000/svg}"


def lay_out(corners, square, paper="A4"):
    same = isinstance(corners, tuple) and (corners[0] - corners[1]) % 2 == 0
    return Chessboard(corners, square, half_turn_symmetric=same).sheet(paper)


def dark_squares(sheet):
    """(n, 4, 2) corners in mm of the black squares in the SVG, from the top left one clockwise."""
    area = ElementTree.fromstring(sheet.svg()).find(f"{SVG}path[@fill='#000000']")
    squares = re.findall(r"M([^Z]*)Z", area.get("d"))
    return np.array([square.split() for square in squares], float).reshape(-1, 4, 2)


def inner_corners(picture, corners):
    """(rows, columns, 2) pixels, found and refined by OpenCV, from the top left."""
    import cv2

    found, m = cv2.findChessboardCornersSB(picture, corners)
    assert found
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 100, 1e-6)
    m = cv2.cornerSubPix(picture, m.astype(np.float32), (20, 20), (-1, -1), stop)
    m = m.reshape(corners[1], corners[0], 2).astype(float)
    if m[0, 0, 0] > m[0, -1, 0]:
        m = m[:, ::-1]
    return m if m[0, 0, 1] < m[-1, 0, 1] else m[::-1]


def printed(sheet, folder, dpi=300):
    """Turn the sheet's PDF into a grey picture, as a printer would."""
    import cv2

    if shutil.which("pdftoppm") is None:
        pytest.skip("pdftoppm (poppler-utils) is not installed")
    sheet.save(folder / "board.pdf")
    command = ["pdftoppm", "-r", str(dpi), "-gray", "-singlefile", "board.pdf", "page"]
    subprocess.run(command, cwd=folder, check=True)
    return cv2.imread(str(folder / "page.pgm"), cv2.IMREAD_GRAYSCALE)


@pytest.mark.slow
@pytest.mark.parametrize("paper", ["A4", "Letter"])
def test_a_printed_sheet_has_squares_of_25_mm(paper, tmp_path):
    picture = printed(Chessboard((9, 6), 25.0).sheet(paper), tmp_path)
    corners = inner_corners(picture, (9, 6)) / 300 * 25.4
    for axis in (0, 1):
        steps = np.diff(corners[..., 1 - axis], axis=axis)
        assert np.allclose(steps, 25.0, atol=0.02)
        assert np.allclose(steps.mean(), 25.0, atol=0.005)


def longest_line(rows):
    """The longest run of dark pixels in any row, of those that are no side of the frame."""
    longest = 0
    for row in rows:
        edges = np.flatnonzero(np.diff(np.r_[0, row, 0]))
        runs = edges[1::2] - edges[::2]
        longest = max(longest, *(run for run in runs if run < 1500), 0)
    return longest


@pytest.mark.parametrize("corners", [(9, 6), (6, 9)])
def test_both_rulers_are_100_mm_long_on_the_printed_sheet(corners, tmp_path):
    sheet = lay_out(corners, 20.0)
    picture = printed(sheet, tmp_path) < 200
    border = next(shape.places for shape in sheet.page.shapes if isinstance(shape, Line))
    left, below = np.array([border[0][0] - 0.5, border[2][1] + 0.5]) / 25.4 * 300
    for rows in (picture[int(below) :], picture.T[: int(left)]):
        assert longest_line(rows) / 300 * 25.4 == pytest.approx(100, abs=0.25)


def test_a_stretched_page_shows_on_one_ruler_only():
    """What the second ruler is for: each runs along one direction of the paper."""
    rulers = [line for line in lay_out((9, 6), 25.0).page.shapes if isinstance(line, Line)]
    ends = np.array([line.places for line in rulers if len(line.places) == 2])
    sides = np.abs(ends[:, 1] - ends[:, 0])
    assert (np.isclose(sides, [100, 0]).all(axis=1)).sum() == 1
    assert (np.isclose(sides, [0, 100]).all(axis=1)).sum() == 1


@pytest.mark.parametrize(("corners", "square"), [((9, 6), 25.0), ((5, 8), 20.0), ((4, 3), 12.5)])
def test_the_squares_are_those_of_the_board(corners, square):
    boxes = dark_squares(lay_out(corners, square))
    place = (boxes[:, 0] - boxes[:, 0].min(axis=0)) / square
    assert np.allclose(boxes[:, 2] - boxes[:, 0], square, atol=2e-6)
    assert np.allclose(place, place.round(), atol=1e-6)
    columns, rows = corners
    expected = {(i, j) for i in range(columns + 1) for j in range(rows + 1) if (i + j) % 2 == 0}
    assert {tuple(p) for p in place.round().astype(int).tolist()} == expected


@pytest.mark.parametrize("paper", PAPERS)
@pytest.mark.parametrize("corners", [(9, 6), (6, 9)])
def test_everything_stays_on_the_paper_and_the_margin_is_white(paper, corners):
    sheet = lay_out(corners, 20.0, paper)
    width, height = sheet.page.size
    assert sorted((width, height)) == sorted(PAPERS[paper])
    assert (width > height) == (corners[0] > corners[1])
    boxes = dark_squares(sheet)
    root = ElementTree.fromstring(sheet.svg())
    lines = [
        np.array(e.get("points").split(), float).reshape(-1, 2) for e in root.iter(f"{SVG}polyline")
    ]
    places = np.concatenate([*lines, boxes.reshape(-1, 2)])
    assert places.min() >= 4.9
    assert (np.array([width, height]) - places.max(axis=0)).min() >= 4.9
    # The margin line is as far from the squares on all four sides: at most a square, at least 5 mm.
    line = lines[0]
    gaps = [*(boxes.min(axis=(0, 1)) - line.min(axis=0))]
    gaps += [*(line.max(axis=0) - boxes.max(axis=(0, 1)))]
    assert np.allclose(gaps, gaps[0], atol=1e-5)
    assert 5 <= gaps[0] <= 20 + 1e-5


def texts_of(sheet):
    return [element.text for element in ElementTree.fromstring(sheet.svg()).iter(f"{SVG}text")]


@pytest.mark.parametrize("board", [Chessboard(), Chessboard((8, 6), 12.5, True)])
def test_the_code_on_the_sheet_makes_its_board(board):
    code = next(text for text in texts_of(board.sheet()) if text.startswith("Chessboard"))
    assert eval(code) == board


def test_the_numbers_are_printed_in_words():
    texts = texts_of(lay_out((9, 6), 25.0))
    assert "9 by 6 inner corners" in texts
    assert "10 by 7 squares of 25 mm" in texts
    assert "Chessboard((9, 6), 25)" in texts


def test_pdf_and_svg_hold_the_same_drawing():
    sheet = lay_out((9, 6), 25.0)
    squares = re.search(rb"(?m)^0 g (.* h) f$", sheet.pdf())[1]
    numbers = np.array(re.sub(rb"[mlh]", b"", squares).split(), float)
    assert numbers.reshape(-1, 4, 2).tolist() == dark_squares(sheet).tolist()


def test_the_same_sheet_is_the_same_file_byte_for_byte(tmp_path):
    for name in ("board.pdf", "board.svg"):
        Chessboard().sheet().save(tmp_path / name)
        first = (tmp_path / name).read_bytes()
        Chessboard().sheet().save(str(tmp_path / name))
        assert (tmp_path / name).read_bytes() == first
        assert re.search(rb"20\d\d-|D:20\d\d", first) is None


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (((9, 6), 26.0), "10 by 7 squares of 26 mm does not fit on A4.*up to 25 mm do, or take A3"),
        (((9, 6), 60.0, "A3"), "does not fit on A3; squares of up to 37 mm do$"),
        (((400, 301), 5.0), "does not fit on A4; take fewer squares"),
        (((9, 6), 1e12), "up to 25 mm do$"),
        (((9, 6), 25.0, "A5"), "expected one of A4, Letter, A3, got 'A5'"),
        (((9.5, 6), 25.0), "corners: expected .* two positive whole numbers"),
        (((9, 6), float("nan")), "square contains NaN"),
        (((9, 6), 0.025), r"squares of 0.025 mm cannot be printed \(metres\?\)"),
    ],
)
def test_a_board_that_cannot_be_printed_is_refused_with_what_would_fit(arguments, words):
    with pytest.raises(CvnotesError, match=words):
        lay_out(*arguments)


def test_the_square_that_the_refusal_offers_does_fit_and_the_next_does_not():
    for corners in [(9, 6), (6, 9), (4, 3), (13, 8)]:
        with pytest.raises(CvnotesError) as refusal:
            lay_out(corners, 60.0)
        offered = float(re.search(r"up to (\S+) mm", str(refusal.value))[1])
        lay_out(corners, offered)
        with pytest.raises(CvnotesError):
            lay_out(corners, offered + 0.5)


def test_other_formats_are_refused_by_name(tmp_path):
    with pytest.raises(CvnotesError, match=r"as .pdf or .svg, not as '.png'"):
        lay_out((9, 6), 25.0).save(tmp_path / "board.png")
    with pytest.raises(CvnotesError, match="not as 'no suffix'"):
        lay_out((9, 6), 25.0).save(tmp_path / "board")
    assert list(tmp_path.iterdir()) == []
