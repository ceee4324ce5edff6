"""The report of a calibration: what its drawings show stands where it is, and no word is lost."""

import io
import re
import xml.etree.ElementTree as ET
from base64 import b64decode
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from accessible import violations
from PIL import Image, ImageColor

from cvnotes.commands import pictures
from cvnotes.commands.drawing import ESTIMATED, LENS, WORLD, Drawing
from cvnotes.commands.page import report_page
from cvnotes.commands.report import as_text, camera_report
from cvnotes.files import Rejected
from cvnotes.photographs import CalibratedPhotographs, calibrate_photographs
from cvnotes.photographs.reasons import LeftOut
from cvnotes.pictures import course
from cvnotes.targets import Chessboard

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def found():
    return calibrate_photographs(course.photos()[:5], course.board(), lens="k1 k2")


def lines(drawing, colour):
    """Read the lines (k, 2) of a colour."""
    paths = [p for p in ET.fromstring(str(drawing)).iter(f"{SVG}path") if p.get("stroke") == colour]
    ways = [way for path in paths for way in path.get("d").split("M")[1:]]
    return [
        np.array([point.split() for point in way.rstrip("Z").split("L")], float) for way in ways
    ]


def words(drawing):
    """Read what is written, and where: (text, x, y)."""
    return [
        (each.text, float(each.get("x")), float(each.get("y")))
        for each in ET.fromstring(str(drawing)).iter(f"{SVG}text")
    ]


def image(drawing):
    """Decode the picture in a drawing."""
    data = ET.fromstring(str(drawing)).find(f"{SVG}image").get("href").partition(",")[2]
    return np.asarray(Image.open(io.BytesIO(b64decode(data))).convert("RGB")).astype(int)


# --- drawings -------------------------------------------------------------------------------------


def test_a_line_has_a_gap_where_a_point_is_not_known_and_an_area_is_closed():
    sheet = Drawing((30, 20), "<&>")
    sheet.lines([[[1, 2], [3, 4], [np.nan, 5], [6, 7], [8, np.inf], [9, 9.04]]], "red")
    sheet.lines([[[0, 0], [4, 0], [4, 4]]], "blue", fill="blue")
    assert [line.tolist() for line in lines(sheet, "red")] == [[[1, 2], [3, 4]], [[6, 7]], [[9, 9]]]
    assert 'd="M0 0L4 0L4 4Z"' in str(sheet)
    assert ET.fromstring(str(sheet)).get("aria-label") == "<&>"


def test_dots_at_one_place_are_drawn_once_and_unknown_ones_not_at_all():
    sheet = Drawing((30, 20), "dots")
    sheet.dots([[5.2, 7], [4.9, 7.3], [np.nan, 3], [20, 1]], "red")
    assert [line.tolist() for line in lines(sheet, "red")] == [[[5, 7]] * 2, [[20, 1]] * 2]


def test_the_colours_are_those_of_the_deviations(found, monkeypatch):
    def growing(result, m, **_):  # 0.03 px at the left border, ten times as much at every third
        std = 0.03 * 10 ** (3 * m[..., 0] / result.size[0])
        return np.where(m[..., 1] > 400, np.nan, std)

    monkeypatch.setattr(pictures, "prediction_std", growing)
    sheet, key = pictures.uncertainty(found.calibration)
    picture, where = image(sheet), {}
    unknown = ImageColor.getrgb(key["not known"])
    for name, colour in list(key.items())[:-1]:
        here = np.flatnonzero((picture[100] == ImageColor.getrgb(colour)).all(-1))
        where[name] = here.min() / 720, (here.max() + 1) / 720
    of = np.log10(np.array([0.1, 0.2, 0.5, 1, 2, 5]) / 0.03) / 3
    assert list(key) == ["up to 0.1 px", "0.1 to 0.2 px", "0.2 to 0.5 px", "0.5 to 1 px",
                         "1 to 2 px", "2 to 5 px", "more than 5 px", "not known"]  # fmt: skip
    np.testing.assert_allclose([*where.values()], np.transpose([[0, *of], [*of, 1]]), atol=0.004)
    grey = (picture == unknown).all(-1)
    assert np.abs(np.flatnonzero(grey.any(1)).min() - 401 * 720 / 640) < 12
    assert (grey.all(1) == grey.any(1)).all()
    # and what is known is drawn alike up to there, but for the width of a place
    border = np.flatnonzero(grey.any(1)).min() - 1
    assert (picture[border] != picture[100]).any(-1).sum() < 6 * 720 / 33


def test_the_corners_and_the_next_view_are_where_they_are(found):
    result, proposal = found.calibration, found.next_view
    sheet, _ = pictures.uncertainty(result, proposal)
    zoom = 720 / 640
    dots = np.array(lines(sheet, "#0009"))[:, 0]
    corners = (np.concatenate(result.image_points) + 0.5) * zoom
    assert np.abs(dots[:, None] - corners).max(-1).min(0).max() < 0.51
    (outline,) = lines(sheet, LENS)
    np.testing.assert_allclose(outline[:-1], (proposal.outline + 0.5) * zoom, atol=0.051)


def test_without_other_views_the_deviations_are_those_of_noise(found):
    unknown = replace(
        found.calibration, choice=None,
        _covariance_of_views=np.full_like(found.calibration.covariance, np.inf),
    )  # fmt: skip
    _, key = pictures.uncertainty(unknown)
    assert not any("not known" in words for words in key)


def result(views, points, scale=0.1):
    """Make what the picture of residuals needs of a calibration."""
    rng = np.random.default_rng(views)
    return SimpleNamespace(
        size=(640, 480),
        image_points=[rng.uniform(0, 470, (points, 2)) for _ in range(views)],
        residuals=[rng.normal(scale=scale, size=(points, 2)) for _ in range(views)],
    )


@pytest.mark.parametrize("scale", [0.1, 7.0])
def test_residuals_are_as_long_as_the_bar_says(scale):
    made = result(5, 20, scale)
    made.residuals[2][:] = np.nan  # where a lens folds
    sheet, said = pictures.residuals(made)
    times = float(re.search(r"([\d.,]+) times", said)[1].replace(",", ""))
    m, r = (
        np.concatenate([x for i, x in enumerate(all_) if i != 2])
        for all_ in (made.image_points, made.residuals)
    )
    drawn = [line for line in lines(sheet, ESTIMATED) if np.ptp(line, axis=0).any()]
    zoom = 720 / 640
    expected = (np.stack([m - r, m - r + times * r], axis=1) + 0.5) * zoom
    np.testing.assert_allclose(drawn, expected, atol=0.051)
    (bar,) = [line for line in lines(sheet, "currentColor") if len(line) == 2]
    ((text, x, _),) = words(sheet)
    length = float(text.removesuffix(" px"))
    np.testing.assert_allclose(np.ptp(bar[:, 0]), length * times * zoom, atol=0.11)
    assert x == pytest.approx(bar[:, 0].mean(), abs=0.1)
    assert bar[:, 1].min() > 480 * zoom


def test_of_many_residuals_the_mean_of_each_place_is_drawn():
    m = np.array([[5.0, 5.0], [7.0, 3.0], [100.0, 100.0]])
    r = np.array([[1.0, 0.0], [3.0, 2.0], [-1.0, 5.0]])
    places, mean = pictures._cell_means(m, r, (640, 480))
    assert np.array_equal(places, [[6, 4], [100, 100]])
    assert np.array_equal(mean, [[2, 1], [-1, 5]])
    sheet, said = pictures.residuals(result(60, 54))
    assert said.startswith("Mean residuals")
    assert len(lines(sheet, ESTIMATED)) < 2 * 32 * 24


@pytest.mark.parametrize(("apart", "all_of_them"), [(20.0, True), (2.0, False)])
def test_numbers_of_boards_that_stand_close_do_not_overlap(apart, all_of_them):
    board, poses = Chessboard((9, 6), 20.0), np.tile(np.eye(4), (14, 1, 1))
    poses[:, :3, 3] = [-80, -50, 600]
    poses[:, 0, 3] += apart * np.arange(14) * (-1) ** np.arange(14)
    A = np.array([[500.0, 0, 320], [0, 500, 240], [0, 0, 1]])
    sheet, said = pictures.boards(SimpleNamespace(poses=poses, size=(640, 480), A=A), board)
    at = np.array([(x, y) for _, x, y in words(sheet)])
    gaps = np.linalg.norm(at[:, None] - at, axis=-1)[~np.eye(len(at), dtype=bool)]
    assert gaps.min() > 27
    assert (len(at) == 14) is all_of_them
    assert ("as many numbered as fit" in said) is not all_of_them
    assert len(at) > 5


def test_boards_stand_around_the_camera_as_they_are_seen():
    def at(x, y, z):
        G = np.eye(4)
        G[:3, 3] = np.array([x, y, z]) - (80, 50, 0)
        return G

    board = Chessboard((9, 6), 20.0)
    poses = np.array([at(0, 0, 300), at(0, 0, 900), at(-400, 0, 600), at(0, -400, 600)])
    A = np.array([[500.0, 0, 320], [0, 500, 240], [0, 0, 1]])
    sheet, said = pictures.boards(SimpleNamespace(poses=poses, size=(640, 480), A=A), board)
    assert said == "The boards, 30 to 90 cm from the camera."
    quads, pyramid = lines(sheet, ESTIMATED), lines(sheet, WORLD)
    own = {}  # the board whose upper left corner a number stands beside
    for text, x, y in words(sheet):
        beside = [np.linalg.norm(q[0] + 0.12 * (q[2] - q[0]) - (x, y)) for q in quads]
        assert min(beside) < 1
        own[text] = quads[int(np.argmin(beside))]
    near, far, _, above = (own[text].mean(0) for text in "1234")
    camera = pyramid[0][0]
    # who looks stands to the right, above: the axis leads to the near board, and on to the far one
    (ax, ay), (bx, by) = near - camera, far - camera
    assert (ax * by - ay * bx) / np.hypot(bx, by) == pytest.approx(0, abs=8)
    assert np.hypot(bx, by) > 1.8 * np.hypot(ax, ay)
    assert above[1] < (near[1] + far[1]) / 2 - 50
    assert quads[0] is own["3"]
    assert quads[-1] is own["4"]  # the nearest is on top
    every = np.concatenate([*quads, *pyramid])
    assert (every >= 0).all()
    assert (every[:, 0] <= 720).all()


def test_corners_lie_on_the_small_photograph_where_they_lie_on_the_large(found):
    photo = found.photographs.used[1]
    sheet = pictures.photograph(photo, course.board())
    np.testing.assert_array_less(np.abs(image(sheet)[..., 0] - photo.thumbnail.astype(int)), 60)
    rows = [line for line in lines(sheet, ESTIMATED) if np.ptp(line, axis=0).any()]
    zoom = photo.thumbnail.shape[1] / photo.size[0]
    corners = (photo.corners.reshape(6, 9, 2) + 0.5) * zoom
    np.testing.assert_allclose(rows, corners, atol=0.051)
    x, y, origin = lines(sheet, WORLD)
    np.testing.assert_allclose([x, y], [corners[0, :3], corners[:3, 0]], atol=0.051)
    np.testing.assert_allclose(origin[0], corners[0, 0], atol=0.51)
    hidden = replace(photo, corners=None, found=photo.corners[:2])
    assert len(lines(pictures.photograph(hidden, course.board()), LENS)) == 2


@pytest.mark.parametrize("axis", [0, 1])
def test_the_lines_of_partners_run_through_both_pictures(axis):
    pair = [np.full((30, 40), level, np.uint8) for level in (50, 200)]
    root = ET.fromstring(str(pictures.partners(pair, "a pair", axis)))
    places = [[float(each.get(k)) for k in ("x", "y", "width", "height")]
              for each in root.iter(f"{SVG}image")]  # fmt: skip
    side = 360 if axis == 0 else 720
    second = [side, 0] if axis == 0 else [0, 0.75 * side]
    assert places == [[0, 0, side, 0.75 * side], [*second, side, 0.75 * side]]
    *_, width, height = map(float, root.get("viewBox").split())
    assert (width, height) == ((720, 270) if axis == 0 else (720, 1080))
    drawn = np.array(lines(pictures.partners(pair, "a pair", axis), ESTIMATED))
    assert drawn.shape == (9, 2, 2)
    assert (drawn[:, 0, 1 - axis] == drawn[:, 1, 1 - axis]).all()
    assert (drawn[:, :, axis] == [0, (width, height)[axis]]).all()


# --- the page -------------------------------------------------------------------------------------


class Read(HTMLParser):
    """What stands on a page, its elements being closed in their order."""

    def __init__(self, text):
        super().__init__()
        self.open, self.words, self.addresses = [], "", []
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.open += [tag] * (tag not in ("meta", "br"))
        self.addresses += [
            value for name, value in attrs if name in ("src", "href", "action", "data")
        ]

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        self.open.pop()

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words += data


def test_the_page_holds_all_words_and_no_address_of_elsewhere(found):
    found = replace(found, doubts=["k1 < k2 & more"])
    text = report_page(found, note="made by cvnotes calibrate")
    said = Read(text)
    assert "made by cvnotes calibrate" in text[:300]
    printed = [as_text(camera_report(found.calibration)), *found.doubts, str(found.next_view)]
    printed += [photo.path.name for photo in found.photographs.used]
    printed += [f"{rms:.3f} px" for rms in found.calibration.view_rms]
    for line in "\n".join(printed).splitlines():
        for word in re.split(r"  +", line):
            assert word in said.words
    assert all(address.startswith("data:image/") for address in said.addresses)
    assert set(re.findall(r"https?://[^\s\"'<]+", text)) == {"http://www.w3.org/2000/svg"}
    assert "url(" not in text
    assert "@import" not in text
    assert "<script" not in text


def test_names_of_files_are_words_and_what_is_not_used_is_there_with_its_reason(found):
    evil = Path('<img src=x onerror="alert(1)">&amp;.png')
    first, *others = found.photographs.looked_at
    lost = replace(first.without(LeftOut()), path=Path("<i>two"))
    photographs = replace(
        found.photographs,
        looked_at=[replace(first, path=evil), lost, *others],
        rejected=[Rejected("<i>two", LeftOut()), Rejected("<u>three", LeftOut())],
    )
    text = report_page(CalibratedPhotographs(found.calibration, photographs, [], None))
    said = Read(text)
    assert str(evil) in said.words
    assert f"<i>two: {LeftOut()}" in said.words
    assert f"<u>three: {LeftOut()}" in said.words
    assert (
        text.count("<image") == 1 + 5 + 1
    )  # the uncertainty, five used, and one that was looked at
    assert "<img" not in text


def test_what_is_not_reliable_is_said_first(found):
    doubtful = replace(found.calibration, reliable=False)
    said = Read(report_page(replace(found, calibration=doubtful, next_view=None))).words
    assert "This camera is not reliable." in said[: said.index("alpha_u")]
    assert "next photograph" not in said


@pytest.mark.slow
@pytest.mark.once
def test_a_telephone_shows_it_in_both_lights(found, chromium, tmp_path):
    long = Path(f"{'photograph' * 20}.png")
    used = [replace(found.photographs.used[0], path=long), *found.photographs.used[1:]]
    found = replace(found, photographs=replace(found.photographs, looked_at=used))
    (tmp_path / "report.html").write_text(report_page(found), encoding="utf-8")
    for width in (1280, 390):
        window = chromium.new_page(viewport={"width": width, "height": 844})
        window.goto((tmp_path / "report.html").as_uri())
        assert window.evaluate("document.documentElement.scrollWidth") == width
        letters = window.evaluate(
            "[...document.querySelectorAll('text')].map(e => e.getBoundingClientRect().height)"
        )
        assert min(letters) >= 12
        assert violations(window) == []
        window.close()


def test_on_paper_a_heading_stays_with_its_figure_and_colours_stay(found, chromium, tmp_path):
    (tmp_path / "report.html").write_text(report_page(found), encoding="utf-8")
    window = chromium.new_page()
    window.goto((tmp_path / "report.html").as_uri())
    window.emulate_media(media="print")

    def every(of, what):
        of_all = f"[...document.querySelectorAll('{of}')].map(e => getComputedStyle(e).{what})"
        return set(window.evaluate(of_all))

    assert every("h1, h2", "breakAfter") == {"avoid"}
    assert every("section, figure", "breakInside") == {"avoid"}
    assert every(".key i, .bar", "printColorAdjust") == {"exact"}
    window.close()
