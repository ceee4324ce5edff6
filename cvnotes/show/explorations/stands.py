"""Explore what a focal length is good for: a cube stands on its squares by the right one alone."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, Lens
from cvnotes.pictures import course, render_scene, room_with
from cvnotes.show.explorations.boards import draw_net
from cvnotes.show.explorations.cube import draw_tower
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.style import ESTIMATED, LENS, WORLD

_BOARD, _TRUE, _POSE = course.board(), course.camera(), course.poses()[0]
_SIZE, _ALPHA = (640, 480), 800.0
_SIDE = 2 * _BOARD.square
_BASE = np.array([[0.0, 0], [50, 0], [50, 50], [0, 50]])  # mm: on four squares
_STANDS = 0.5  # px: corners that are missed by less


def stands_model() -> Model:
    """Make the model of a board in a room, and a cube that is drawn onto it."""
    settings = (
        Setting("alpha", "α (px)", 600, 1000, 5, 680, "the focal length, both along u and v"),
        Setting("lens", "with the lens", 0, 1, 1, 1, "whether the lens is known, too"),
    )
    about = (
        "A photograph of a board in a room; a cube is drawn onto the board, and the net of its "
        "corners, by a camera with another focal length; beside it how far the net misses them."
    )

    def draw(paper: Paper, values: Values) -> Drawing:
        camera = camera_of(values["alpha"], bool(values["lens"]))
        panel = paper.picture_panel((440, 330), _SIZE, "a cube on its squares: pull it")
        panel.image(photograph())
        draw_net(panel, camera.project(_BOARD.points), _BOARD, ESTIMATED, 1)
        squares = np.column_stack([_BASE, 0 * _BASE[:, 0]])[[0, 1, 2, 3, 0]]
        around = squares + 0.06 * np.sign(squares - _SIDE / 2) * [_SIDE / 2, _SIDE / 2, 0]
        panel.line(_TRUE.moved(_POSE).project(around), WORLD, 3)  # it stays in sight
        draw_tower(panel, camera, _BASE, _SIDE, windows=False)
        foot = camera.project([*_BASE.mean(axis=0), 0])
        panel.grip("cube", "the cube, to be pulled onto its squares", foot, 4)
        return Drawing(paper.join((panel, _curve(paper, values))), _sentence(values))

    def pulled(values: Values, at: Array) -> Values:
        """Choose the focal length by which the foot comes nearest to the hand."""
        tried = np.arange(600.0, 1001, 5)
        lens = bool(values["lens"])
        feet = [camera_of(alpha, lens).project([*_BASE.mean(axis=0), 0]) for alpha in tried]
        return {"alpha": float(tried[np.linalg.norm(feet - at, axis=1).argmin()])}

    return Model("stands", about, settings, draw, {"cube": pulled})


@lru_cache(maxsize=1)
def photograph() -> Drawn:
    """Photograph the board in the room."""
    return render_scene(room_with(_BOARD, _POSE), _TRUE)


def camera_of(alpha: float, lens: bool) -> Camera:
    """Return the course's camera, where it stood, with another focal length and perhaps no lens."""
    A = _TRUE.A.copy()
    A[[0, 1], [0, 1]] *= alpha / _ALPHA
    return Camera(A, _POSE, _TRUE.lens if lens else Lens(), _SIZE)


@lru_cache(maxsize=200)
def missed(alpha: float, lens: bool) -> float:
    """Return how far the corners are from where such a camera puts them, RMS in px."""
    off = camera_of(alpha, lens).project(_BOARD.points) - _TRUE.moved(_POSE).project(_BOARD.points)
    return float(np.sqrt(np.mean(np.sum(off**2, axis=1))))


def _curve(paper: Paper, values: Values) -> Panel:
    alpha, lens = values["alpha"], bool(values["lens"])
    panel = paper.panel((340, 330), (560, 1025), (56, -7), "corners missed (RMS, px) by α")
    panel.ticks(x=(600, 700, 800, 900, 1000), y=(0, 20, 40), size=11)
    tried = np.arange(600.0, 1001, 5)  # as the slider: the lowest is one of them
    panel.line([[a, missed(a, lens)] for a in tried], LENS, 2)
    here = [alpha, missed(alpha, lens)]
    panel.mark(here, "estimated", 8)
    high = here[1] > 12  # between the two arms; near their foot, outside of them
    inside = 16 if (alpha < 800) == high else -16
    panel.text(
        [alpha + inside, here[1] + (2 if high else -0.5)], f"{here[1]:.1f} px", ESTIMATED,
        anchor="lm" if inside > 0 else "rm", size=13,
    )  # fmt: skip
    return panel


def _sentence(values: Values) -> str:
    alpha, lens = values["alpha"], bool(values["lens"])
    off = missed(alpha, lens)
    said = (
        f"With α = {alpha:.0f} px {'and' if lens else 'without'} the lens the corners of the board"
    )
    if off < _STANDS:
        return f"{said} are met: the cube stands on its four squares."
    return f"{said} are missed by {off:.1f} px, and the cube is off, too."
