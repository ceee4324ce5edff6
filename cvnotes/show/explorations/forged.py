"""Explore a forged shadow: from its tip over the top of its pole there has to be the sun."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.explorations.shadows import GROUND, POLES, SIZE, draw_ray, photographed, tip_of
from cvnotes.show.style import ESTIMATED, LENS

_CAMERA = Camera(intrinsics(800, 804, 325, 238), size=SIZE)  # the course's, level
_SUN = np.array([0.06, -0.2, 0.8])
_MOST = 4.0  # m, of a tip from its place
_PAINTED = 2.5  # m to the right of where the sun throws it: the tip at first
_NEAR = 2.0  # px: a line that misses its end by less is taken for true
_CLOSE = (263, 507), (22, 282)  # px, u and v, of the part that is shown enlarged
_HORIZON = 250.0  # px: below it is ground


def forged_model() -> Model:
    """Make the model of the railway with a low sun, the shadow of whose second pole is pulled."""
    settings = (
        Setting(
            "aside", "to the right (m)", -1.5 * _MOST, _MOST, 0.05, 0, "of where it was painted"
        ),
        Setting("ahead", "ahead (m)", -2 * _MOST, 3 * _MOST, 0.05, 0, "of where it was painted"),
    )
    about = (
        "A railway with poles and their long shadows; from the tips of three shadows lines over "
        "the tops of their poles, towards the sun, and along the ground, towards the point of the "
        "horizon below the sun."
    )
    top, foot = POLES[1], POLES[1] * [1, 0, 1] + [0, GROUND, 0]
    # Where the lines should end: over the top and along the ground.
    ends = _CAMERA.vanishing_point(np.array([_SUN, _SUN * [1, 0, 1]]))
    place = tip_of(top, _SUN) + [_PAINTED, 0, 0]

    def draw(paper: Paper, values: Values) -> Drawing:
        tip = place + [values["aside"], 0, values["ahead"]]
        suns = np.tile(_SUN, (len(POLES), 1))
        suns[1] = top - tip
        photo, seen = photographed(_CAMERA, suns, _SUN), _CAMERA.project([tip, top, foot])
        misses = [_miss(seen[[0, i]], end) for i, end in enumerate(ends, 1)]
        panel = paper.picture_panel((470, 352), SIZE, "is this shadow true?")
        panel.image(photo)
        (u0, u1), (v0, v1) = _CLOSE
        close = paper.panel(
            (330, 352), (u0 - 0.5, u1 - 0.5), (v0 - 0.5, v1 - 0.5), "enlarged: sun and horizon"
        )
        close.image(photo[v0:v1, u0:u1])
        for sheet in (panel, close):
            _draw_lines(sheet, ends, seen, misses)
        panel.grip("tip", "the tip of the shadow of the second pole", seen[0], 2)
        return Drawing(paper.join((panel, close)), _sentence(*misses))

    def pulled(_: Values, at: Array) -> Values:
        ray = np.linalg.solve(_CAMERA.A, [at[0], max(at[1], _HORIZON), 1])
        aside, _, ahead = GROUND * ray / ray[1] - place
        return {"aside": float(aside), "ahead": float(ahead)}

    return Model("forged", about, settings, draw, {"tip": pulled})


def _draw_lines(panel: Panel, ends: Array, seen: Array, misses: list[float]) -> None:
    """Draw the horizon point, two true lines to each, and those of the shadow pulled."""
    panel.mark(ends[1], "ideal", 7)
    for other in POLES[2:4]:
        panel.line([_CAMERA.project(tip_of(other, _SUN)), ends[1]], ESTIMATED, 1, dash=4)
        draw_ray(panel, _CAMERA, other, _SUN)
    tip, *through = seen
    for by, miss, dash in zip(through, misses, (0, 6), strict=True):
        panel.line([tip, by + 9 * (by - tip)], LENS if miss < _NEAR else ESTIMATED, 2, dash=dash)
    if panel.x[0] < 0:  # on the whole picture; a tip outside is held at its border
        tip = tip.clip(0, np.array(SIZE) - 1)
        panel.mark(tip, "lens" if max(misses) < _NEAR else "estimated", 7)


def _miss(line: Array, end: Array) -> float:
    """Return how far the line through two pixels passes beside a third, in px."""
    along = (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
    return float(abs(np.linalg.det([along, end - line[0]])))


def _sentence(over: float, ground: float) -> str:
    said = (
        f"The line over the pole's top misses the sun by {over:.1f} px, the line along the shadow "
        f"misses the plus by {ground:.1f} px"
    )
    return (
        f"{said}: true." if max(over, ground) < _NEAR else f"{said}: so this shadow was painted in."
    )
