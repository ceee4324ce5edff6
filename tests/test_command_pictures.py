"""The pictures of a large calibration: every name is legible, and residuals are no hedgehog."""

import io
import itertools
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

from cvnotes.commands.pictures import _cell_means, _residuals, _view_rms


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


def test_of_many_residuals_the_mean_of_each_place_is_drawn():
    m = np.array([[5.0, 5.0], [7.0, 3.0], [100.0, 100.0]])
    r = np.array([[1.0, 0.0], [3.0, 2.0], [-1.0, 5.0]])
    places, mean = _cell_means(m, r, (640, 480))
    assert np.array_equal(places, [[6, 4], [100, 100]])
    assert np.array_equal(mean, [[2, 1], [-1, 5]])


def test_a_picture_of_thousands_of_residuals_has_more_paper_than_ink():
    picture = ink(_residuals(result(60, 54)))[40:, 10:880]
    assert (picture < 250).any(-1).mean() < 0.15
