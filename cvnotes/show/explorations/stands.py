"""Explore what calibrates: a board that faces the camera fits every focal length, a tilted one."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from cvnotes.base import Array
from cvnotes.calibration import pose_from_view
from cvnotes.camera import Camera, move, rotation_from_vector
from cvnotes.pictures import course, hold_at, render_scene, room_with
from cvnotes.show.explorations.boards import draw_net
from cvnotes.show.explorations.finding import rms
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.style import CAMERA, ESTIMATED, LENS, MUTED

_BOARD, _A = course.board(), course.camera().A
_SIZE, _ALPHA, _CUT = (640, 480), 800.0, 32  # px; rows that are cut off above and below
_PANEL, _MOST = (400, 260), 14  # px; of misses
_LOW, _HIGH, _STEP = 400, 1200, 20  # px, of α
_MM = 0.22  # so many are a pixel of the picture, in the plan
_ENDS = _BOARD.square * np.array([[-1, 2.5, 0], [9, 2.5, 0]])  # of the board, seen from above
# How a board is held, in radians about y, and how much farther than would fill the picture; where
# the axis of its camera is in the plan, in mm; its colour.
_WAYS = {"facing": (0, 1.2, -104, MUTED), "tilted": (0.8, 1.06, 136, ESTIMATED)}


class Best(NamedTuple):
    """The best pose, CRF ← board; the net by it (n, 2), its RMS miss in px; mm to the middle."""

    pose: Array
    net: Array
    miss: float
    away: float


def stands_model() -> Model:
    """Make the model of two photographs of a board, and the best pose of it for a focal length."""
    settings = (Setting("alpha", "α (px)", _LOW, _HIGH, _STEP, _LOW, "the focal length"),)
    about = """Two photographs of a board, one facing the camera and one tilted; over each an orange
    net, the best that a camera with this focal length can do. Below, where the boards would be,
    from above; beside it how far the nets miss the corners, up to this focal length."""

    def draw(paper: Paper, values: Values) -> Drawing:
        alpha = values["alpha"]
        photos = tuple(_photo(paper, how, best(how, alpha)) for how in _WAYS)
        drawn = paper.join(photos, (_plan(paper, alpha), _graph(paper, alpha)))
        return Drawing(drawn, _sentence(alpha))

    drags = {"plane": lambda _, at: {"alpha": float(at[0]) / _MM}, "alpha": placed("alpha")}
    return Model("stands", about, settings, draw, drags)


def camera_of(alpha: float) -> Camera:
    """Return the course's camera with another focal length, and without its lens."""
    k = alpha / _ALPHA
    return Camera(_A * [[k, 1, 1], [1, k, 1], [1, 1, 1]], size=_SIZE)


@lru_cache(maxsize=2)
def held(how: str) -> Array:
    """Return the pose of the board in its photograph."""
    tilt, farther, *_ = _WAYS[how]
    R = rotation_from_vector([0, tilt, 0])
    return hold_at(_BOARD, camera_of(_ALPHA), R, _A[:2, 2], farther)


@lru_cache(maxsize=2)
def photograph(how: str) -> Drawn:
    """Photograph the board in the room."""
    return render_scene(room_with(_BOARD, held(how)), camera_of(_ALPHA))[_CUT:-_CUT]


@lru_cache(maxsize=2 * (_HIGH - _LOW) // _STEP + 2)
def best(how: str, alpha: float) -> Best:
    """Find where a board would stand if this were the focal length."""
    m = camera_of(_ALPHA).moved(held(how)).project(_BOARD.points)
    G = pose_from_view(camera_of(alpha), _BOARD.points, m)
    net = camera_of(alpha).moved(G).project(_BOARD.points)
    return Best(G, net, rms(net - m), float(move(G, _BOARD.points.mean(axis=0))[2]))


def _photo(paper: Paper, how: str, found: Best) -> Panel:
    title = f"{how}: the best net misses by {found.miss:.1f} px"
    panel = paper.picture_panel(_PANEL, (_SIZE[0], _SIZE[1] - 2 * _CUT), title, (0, _CUT))
    panel.image(photograph(how))
    draw_net(panel, found.net, _BOARD, ESTIMATED, 1.2)
    if how == "tilted":  # a wrong focal length makes its two sides too alike, or not enough
        _sides(panel, found.net)
    return panel


def _sides(panel: Panel, net: Array) -> None:
    """Write how long the left and the right side of the board are, and those of the net."""
    m = camera_of(_ALPHA).moved(held("tilted")).project(_BOARD.points)
    for column, across in ((0, -80), (-1, 91)):
        place = m[column] * [1, 0] + [across, _SIZE[1] / 2]
        for name, points, ink, down in (("board", m, LENS, -14), ("net", net, ESTIMATED, 18)):
            line = points.reshape(*_BOARD.corners[::-1], 2)[:, column]
            long = np.linalg.norm(line[-1] - line[0])
            panel.text(place + [0, down], f"{name} {long:.0f}", ink, anchor="mm", size=13)


def _plan(paper: Paper, alpha: float) -> Panel:
    """Draw both cameras, the planes of their pictures, and the boards that show this there."""
    title = "from above, with the depth of each board's middle"
    panel = paper.panel(_PANEL, (-40, 776), (-255, 255), title)
    z, half = _MM * alpha, _MM * _SIZE[0] / 2
    middle = 16  # mm, between both cameras
    panel.line([[z, middle - half], [z, middle + half]], CAMERA, 1, dash=3)
    for how, (tilt, _, across, colour) in _WAYS.items():
        found = best(how, alpha)
        a, b = move(found.pose, _ENDS)[:, [2, 0]] + [0, across]
        panel.line([a, [0, across], b], colour, 1)
        panel.line([[z, across - half], [z, across + half]], CAMERA, 2)
        panel.line([a, b], colour, 4)
        panel.mark([0, across], "camera", 9, (1, 0))
        beside = [found.away + 30, across + 25 * tilt]
        panel.text(beside, f"{found.away:.0f} mm", colour, size=13)
    panel.text([z + 8, -196], "picture", CAMERA, anchor="rm", size=12)
    panel.mark([z, middle], "estimated", 8)
    panel.grip("plane", "the planes of both pictures, nearer or farther", [z, middle], 2)
    return panel


def _graph(paper: Paper, alpha: float) -> Panel:
    """Draw the misses, as far as the focal length has been pulled up."""
    title = "how far the nets miss (RMS, px), by α (px)"
    panel = paper.panel(_PANEL, (_LOW - 90, _HIGH + 160), (_MOST, -2.4), title)
    panel.ticks(x=(400, 600, 800, 1000, 1200), y=(0, 5, 10), size=12)
    tried = np.arange(_LOW, alpha + 1, _STEP)
    for how, (tilt, *_, colour) in _WAYS.items():
        misses = [best(how, float(a)).miss for a in tried]
        panel.line(np.column_stack([tried, misses]), colour, 2.4)
        panel.line([[alpha - 6, misses[-1]], [alpha + 6, misses[-1]]], colour, 5)
        above = max(misses[-1] + 0.2, 1.7 if tilt else 0.6)  # both can be read at 800
        panel.text([alpha + 36, above], how, colour, size=13)
    panel.mark([alpha, misses[-1]], "estimated", 8)
    panel.grip("alpha", "the focal length, shorter or longer", [alpha, misses[-1]], 4)
    return panel


def _sentence(alpha: float) -> str:
    facing, tilted = (best(how, alpha) for how in _WAYS)
    said = f"""With α = {alpha:.0f} px the facing board would be {facing.away:.0f} mm away, and its
    net misses by {facing.miss:.1f} px. The tilted board """
    if tilted.miss < 0.05:
        return f"{said}would be {tilted.away:.0f} mm away, and its net fits, too."
    return f"{said}fits nowhere: at its best its net misses by {tilted.miss:.1f} px."
