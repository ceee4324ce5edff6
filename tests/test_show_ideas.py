"""The drawing of the colours shows them all."""

from matplotlib.colors import to_hex
from matplotlib.lines import Line2D

from cvnotes.show import draw_meanings
from cvnotes.show.style import COLOURS


def test_every_colour_has_its_meaning_in_the_legend():
    ax = draw_meanings()
    shown = {to_hex(line.get_color()).upper() for line in ax.figure.findobj(Line2D)}
    assert shown >= {colour.upper() for colour in COLOURS.values()}
    assert len([text for text in ax.texts if text.get_text()]) == len(COLOURS)
