"""The drawings of ideas show what they say: incidence, maps, similar triangles."""

import numpy as np
from matplotlib.colors import to_hex
from matplotlib.lines import Line2D

from cvnotes.show import draw_meanings, draw_pinhole
from cvnotes.show.style import COLOURS


def test_every_colour_has_its_meaning_in_the_legend():
    ax = draw_meanings()
    shown = {to_hex(line.get_color()).upper() for line in ax.figure.findobj(Line2D)}
    assert shown >= {colour.upper() for colour in COLOURS.values()}
    assert len([text for text in ax.texts if text.get_text()]) == len(COLOURS)


def test_the_ray_of_the_pinhole_passes_through_the_image_and_the_film():
    ray = draw_pinhole().lines[0].get_xydata()
    assert np.allclose(ray, [[-1.5, -0.5625], [1.5, 0.5625], [4, 1.5]])
