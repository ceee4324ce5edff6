"""The pictures of a large calibration: every name is legible, and residuals are no hedgehog."""

import io
import itertools
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

from cvnotes.commands.canvas import ESTIMATED, FAINT, INK, WORLD, Canvas
from cvnotes.commands.pictures import _cell_means, _picture, _residuals, _view_rms


def result(views, points):
    """Make what the pictures need of a calibration."""
    rng = np.random.default_rng(views)
    return SimpleNamespace(
        view_rms=rng.uniform(0.1, 0.3, views),
        rms=0.2,
        size=(640, 480),
        image_points=[rng.uniform(0, 470, (points, 2)) for _ in range(views)],
        residuals=[rng.normal(scale=0.1, size=(points, 2)) for _ in range(views)],
    )


def ink(canvas):
    with Image.open(io.BytesIO(canvas.png())) as picture:
        return np.asarray(picture.convert("RGB")).astype(int)


@pytest.mark.parametrize("views", [5, 48, 150])
def test_every_bar_has_its_name(views):
    names = [f"photograph {i:04d}.jpg" for i in range(views)]
    given = ink(_view_rms(result(views, 4), names))
    blank = ink(_view_rms(result(views, 4), [" " * len(name) for name in names]))
    written = (given != blank).any(axis=(0, 2))
    columns = np.linspace(62, given.shape[1] - 88, views + 1).round().astype(int)
    assert all(written[a:b].any() for a, b in itertools.pairwise(columns))


def test_a_name_with_an_umlaut_can_be_read():
    def written(text):
        sheet = Canvas(120, 30)
        sheet.text((60, 20), text, size=16)
        return ink(sheet)

    letters = ["a", "ä", "ö", "ü", "é", "ø", "\uffff"]  # the last is of no font
    assert len({written(letter).tobytes() for letter in letters}) == len(letters)


def test_of_many_residuals_the_mean_of_each_place_is_drawn():
    m = np.array([[5.0, 5.0], [7.0, 3.0], [100.0, 100.0]])
    r = np.array([[1.0, 0.0], [3.0, 2.0], [-1.0, 5.0]])
    places, mean = _cell_means(m, r, (640, 480))
    assert np.array_equal(places, [[6, 4], [100, 100]])
    assert np.array_equal(mean, [[2, 1], [-1, 5]])


def test_a_picture_of_thousands_of_residuals_has_more_paper_than_ink():
    picture = ink(_residuals(result(60, 54)))[40:, 10:880]
    assert (picture < 250).any(-1).mean() < 0.15


def test_a_line_is_as_wide_as_asked_and_cut_off_at_the_border():
    sheet = Canvas(60, 40)
    sheet.line([(-1e9, 20.5), (1e9, 20.5)], INK, 3)  # along the middle of row 20
    sheet.line([(-50, -20), (-20, -50)], INK, 3)
    sheet.dots([(30, 1e9)], INK)
    rows = ink(sheet)
    assert np.array_equal(np.flatnonzero((rows[..., 0] < 128).all(1)), [19, 20, 21])
    assert (np.delete(rows, [19, 20, 21], axis=0) == 255).all()


def test_a_slanted_line_darkens_by_its_area_and_a_dot_by_its_disc():
    sheet, dots = Canvas(120, 80), Canvas(50, 50)
    sheet.line([(10, 10), (90, 70)], INK, 2)  # 100 px long
    assert np.isclose((255 - ink(sheet)[..., 0]).sum() / 255, 2 * 100 + np.pi, rtol=0.05)
    dots.dots([(25.3, 24.6)], INK, 8)
    assert np.isclose((255 - ink(dots)[..., 0]).sum() / 255, 64 * np.pi, rtol=0.03)


def test_what_is_drawn_later_lies_above_and_words_above_all():
    sheet = Canvas(80, 60)
    sheet.photograph(np.full((30, 40), 100, np.uint8), (0, 0), (80, 60))
    sheet.text((40, 55), "x", WORLD, size=24, halo=True)
    sheet.line([(0, 30), (80, 30)], FAINT, 4)
    sheet.dots([(40, 30)], ESTIMATED, 6)
    picture = ink(sheet)
    assert np.abs(picture[30, 40] - [213, 94, 0]).max() <= 1
    assert (picture[30, 5] >= 236).all()
    assert np.abs(picture[10, 5] - 100).max() <= 1
    assert (np.abs(picture - [0, 158, 115]).sum(-1) < 40).any()
    assert (picture[35:] == 255).all(-1).any()


@pytest.mark.parametrize("size", [(640, 480), (640, 720), (300, 1800), (1800, 200)])
def test_words_end_before_the_sheet_does(size):
    words = "at the bottom of the picture, 6 cm away, tilted by 49° with its lower left corner "
    found = result(5, 54)
    found.image_points = [(0.25 + m / 1000) * size for m in found.image_points]
    found.size = size
    drawn = [
        _picture(size, f"Next: {words} farther away, turned by 38° clockwise").sheet,
        _residuals(found),
    ]
    for sheet in map(ink, drawn):
        assert (sheet < 250).any()
        for border in (sheet[:, 0], sheet[:, -1], sheet[0], sheet[-1]):
            assert (border == 255).all()
    # a title is no wider than what it stands over
    title = np.flatnonzero((ink(drawn[0])[:60] < 250).any((0, 2)))
    assert title[0] >= 3
    assert title[-1] <= ink(drawn[0]).shape[1] - 4
