"""Explore a forged shadow: the line from its tip over the top of its pole has to end in the sun."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.explorations.shadows import GROUND, POLES, SIZE, draw_sun, shaded, tip_of
from cvnotes.show.style import ESTIMATED, LENS

_CAMERA = Camera(intrinsics(800, 804, 325, 238), size=SIZE)  # the course's, level
_SUN = np.array([0.06, -0.2, 0.8])
_MOST = 4.0  # m, of a tip from its place
_NEAR = 2.0  # px: a line that misses the sun by less could be true
_CLOSE = (33, 35)  # px to each side of the sun that are shown enlarged
_HORIZON = 250.0  # px: below it is ground


def forged_model() -> Model:
    """Make the model of the railway with a low sun, the shadow of whose second pole is pulled."""
    settings = (
        Setting("aside", "to the right (m)", -_MOST, _MOST, 0.05, 1, "of where the sun throws it"),
        Setting("ahead", "ahead (m)", -2 * _MOST, 3 * _MOST, 0.05, 0, "of where the sun throws it"),
    )
    about = (
        "A railway with poles and their long shadows; lines from the tips of three shadows over "
        "the tops of their poles, drawn on towards the sun."
    )
    top, sun = POLES[1], _CAMERA.vanishing_point(_SUN)
    place = tip_of(top, _SUN)

    def draw(paper: Paper, values: Values) -> Drawing:
        tip = place + [values["aside"], 0, values["ahead"]]
        suns = np.tile(_SUN, (len(POLES), 1))
        suns[1] = top - tip
        photo, ends = shaded(_CAMERA, suns), _CAMERA.project([tip, top])
        panel = paper.picture_panel((470, 352), SIZE, "is this shadow true?")
        panel.image(photo)
        (u, v), (w, h) = np.rint(sun).astype(int), _CLOSE
        close = paper.panel(
            (330, 352), (u - w - 0.5, u + w + 0.5), (v - h - 0.5, v + h + 0.5), "enlarged: the sun"
        )
        close.image(photo[max(v - h, 0) : v + h + 1, u - w : u + w + 1])
        for sheet in (panel, close):
            _draw_lines(sheet, sun, ends)
        panel.grip("tip", "the tip of the shadow of the second pole", ends[0], 2)
        miss = _miss(ends, sun)
        return Drawing(paper.join((panel, close)), _sentence(miss))

    def pulled(_: Values, at: Array) -> Values:
        ray = np.linalg.solve(_CAMERA.A, [at[0], max(at[1], _HORIZON), 1])
        aside, _, ahead = GROUND * ray / ray[1] - place
        return {"aside": float(aside), "ahead": float(ahead)}

    return Model("forged", about, settings, draw, {"tip": pulled})


def _draw_lines(panel: Panel, sun: Array, ends: Array) -> None:
    """Draw the sun, two true lines to it, and the line of the shadow that is pulled."""
    draw_sun(panel, sun)
    for other in POLES[2:4]:
        panel.line([_CAMERA.project(tip_of(other, _SUN)), sun], ESTIMATED, 1.2)
    true = _miss(ends, sun) < _NEAR
    panel.line([ends[0], ends[1] + 1.5 * (ends[1] - ends[0])], LENS if true else ESTIMATED, 2)
    panel.mark(ends[0], "lens" if true else "estimated", 7)


def _miss(ends: Array, sun: Array) -> float:
    """Return how far the line through two pixels passes beside the sun, in px."""
    along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    return float(abs(np.linalg.det([along, sun - ends[0]])))


def _sentence(miss: float) -> str:
    said = f"The line from this tip over the top of its pole passes {miss:.1f} px beside the sun"
    return f"{said}: it could be true." if miss < _NEAR else f"{said}: it was painted in."
