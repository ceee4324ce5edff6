"""Explore T and C: one camera before a board, from above, in the board's frame and in its own."""

import numpy as np

from cvnotes.base import Array
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import CAMERA, IDEAL, MUTED, WORLD

_BOARD = np.array([[-25.0, 0], [225, 0]])  # mm, X and Z of its ends
_AHEAD, _WIDE = 150, 0.5  # mm, how far the line of sight is drawn; half the width of the view there
# mm: what is shown to each side, ahead and behind of the board's frame, and of the camera's; both
# have one scale, in which the two walks are equally long.
_WORLD, _OWN, _MM = (540, 200, -600), (640, 620, -180), 2.7


def walks_model() -> Model:
    """Make the model of a camera that is moved and turned before a board."""
    settings = (
        Setting("X", "camera's X (mm)", -400, 400, 10, 300, "where the camera stands"),
        Setting("Z", "camera's Z (mm)", -500, -200, 10, -400, "negative: before the board"),
        Setting("turn", "turn (°)", -60, 60, 0.1, -20, "of the camera on the spot, to the right"),
    )
    about = (
        "A camera before a board, from above, twice: in the board's frame, with the walk from its "
        "origin to the camera, C; and in the camera's frame, with the walk to the origin, T."
    )

    def looked(values: Values, at: Array) -> Values:
        x, z = at - [values["X"], values["Z"]]
        return {"turn": float(np.degrees(np.arctan2(x, z)))}

    drags = {
        "camera": lambda _, at: {"X": float(at[0]), "Z": float(at[1])},
        "line of sight": looked,
    }
    return Model("walks", about, settings, _draw, drags)


def frames(values: Values) -> tuple[Array, Array, Array]:
    """Return R (2, 2), CRF ← WRF, from above, the camera's place C (2,), and T (2,)."""
    a = np.radians(values["turn"])
    R = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
    C = np.array([values["X"], values["Z"]])
    return R, C, -R @ C


def _draw(paper: Paper, values: Values) -> Drawing:
    R, C, T = frames(values)
    at_0 = np.zeros(2)
    world = _frame(paper, _WORLD, "board's frame: from origin to camera, C", (_BOARD, at_0), C, R)
    beside, anchor = (-45, "rm") if C[0] > 0 else (245, "lm")
    world.text([beside, 0], "board", "#333333", anchor=anchor, size=13)
    _walk(world, C, WORLD, "XZ")
    sight = C + R.T @ [0, _AHEAD]
    world.mark(sight, "ideal", 6)
    world.grip("camera", "where the camera stands", C, 6)
    world.grip("line of sight", "where the camera looks", sight, 6)
    seen = _BOARD @ R.T + T, T
    own = _frame(paper, _OWN, "camera's frame: from camera to origin, T", seen, at_0, np.eye(2))
    _walk(own, T, CAMERA, "xz")
    return Drawing(
        paper.join((world, own)),
        f"C = ({C[0]:.0f}, {C[1]:.0f}) mm along X and Z; T = ({round(T[0])}, {round(T[1])}) mm "
        f"along the camera's x and z. Both ways are {np.linalg.norm(C):.0f} mm long.",
    )


def _frame(
    paper: Paper,
    reach: tuple[int, int, int],
    title: str,
    seen: tuple[Array, Array],
    camera: Array,
    R: Array,
) -> Panel:
    """Draw the board, its origin and the camera from above, ahead being upwards."""
    board, origin = seen
    aside, ahead, behind = reach
    size = round(2 * aside / _MM), round((ahead - behind) / _MM)
    panel = paper.panel(size, (-aside, aside), (ahead, behind), title)
    panel.ticks(x=(-400, 0, 400), y=[y for y in (-400, 0, 400) if behind < y < ahead])
    sides = _AHEAD * np.array([[-_WIDE, 1], [_WIDE, 1]]) @ R + camera
    panel.polygons([[camera, *sides]], "#DDEFFA")
    panel.line(np.stack([sides[0], camera, sides[1]]), CAMERA, 1.5)
    panel.line(board, "#333333", 7)
    panel.line(np.stack([camera, camera + R.T @ [0, _AHEAD]]), IDEAL, 1, dash=4)
    panel.mark(camera, "camera", 9, looks=(R[1, 0], -R[1, 1]))
    panel.mark(origin, "world", 7)
    return panel


def _walk(panel: Panel, to: Array, colour: str, names: str) -> None:
    """Draw the walk from the middle of the frame along its two axes, with its numbers."""
    corner = np.array([to[0], 0.0])
    panel.line(np.stack([0 * to, corner, to]), colour, 2.5)
    panel.line(np.stack([0 * to, to]), MUTED, 1, dash=4)
    aside = np.copysign(95, to[0] * (panel.x[1] - 165 - abs(to[0])))  # within, where the panel ends
    for name, number, at, by in (
        (names[0], to[0], corner / 2, [0, -50 if to[1] > 0 else 50]),
        (names[1], to[1], (corner + to) / 2, [aside, 0]),
    ):
        words = f"{name} {round(number)}".replace("-", "−")
        panel.text(at + by, words, colour, anchor="mm", size=14)
