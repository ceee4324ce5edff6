"""Explore T and C: one camera before a board, from above, in the board's frame and in its own."""

import numpy as np

from cvnotes.base import Array
from cvnotes.show.explorations.formation import draw_floor, looked_at
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import CAMERA, IDEAL, WORLD

_Motion = tuple[Array, Array]  # R and T, from above
_EDGES = np.linspace([-25.0, 0], [225, 0], 11)  # mm, X and Z where the board's squares begin
_SHADOW, _LIGHT, _WEDGE = np.array([70.0, 45]), "#B5AC9A", "#D3E9F7"  # mm, of the board
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
    about = """A camera before a board, from above, twice: in the board's frame, with the walk from
    its origin to the camera, C; and in the camera's frame, with the walk to the origin, T."""
    drags = {"camera": placed("X", "Z"), "line of sight": looked_at}
    return Model("walks", about, settings, _draw, drags)


def frames(values: Values) -> tuple[Array, Array, Array]:
    """Return R (2, 2), CRF ← WRF, from above, the camera's place C (2,), and T (2,)."""
    a = np.radians(values["turn"])
    R = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
    C = np.array([values["X"], values["Z"]])
    return R, C, -R @ C


def _draw(paper: Paper, values: Values) -> Drawing:
    R, C, T = frames(values)
    title = "board's frame: from origin to camera, C"
    world = _frame(paper, _WORLD, title, (np.eye(2), np.zeros(2)), C, R)
    beside, anchor = (-45, "rm") if C[0] > 0 else (245, "lm")
    world.text([beside, 0], "board", IDEAL, anchor=anchor, size=13)
    _walk(world, C, WORLD, "XZ")
    sight = C + R.T @ [0, _AHEAD]
    world.mark(sight, "ideal", 6)
    world.grip("camera", "where the camera stands", C, 6)
    world.grip("line of sight", "where the camera looks", sight, 6)
    title = "camera's frame: from camera to origin, T"
    own = _frame(paper, _OWN, title, (R, T), np.zeros(2), np.eye(2))
    _walk(own, T, CAMERA, "xz")
    said = f"""C = ({C[0]:.0f}, {C[1]:.0f}) mm along X and Z; T = ({round(T[0])}, {round(T[1])}) mm
    along the camera's x and z. Both ways are {np.linalg.norm(C):.0f} mm long."""
    return Drawing(paper.join((world, own)), said)


def _frame(
    paper: Paper, reach: tuple[int, int, int], title: str, motion: _Motion, camera: Array, R: Array
) -> Panel:
    """Draw floor, board and camera from above, moved into a frame, ahead being upwards."""
    turn, shift = motion
    aside, ahead, behind = reach
    size = round(2 * aside / _MM), round((ahead - behind) / _MM)
    panel = paper.panel(size, (-aside, aside), (ahead, behind), title)
    draw_floor(panel, lambda W: W[..., [0, 2]] @ turn.T + shift)
    edges, back = _EDGES @ turn.T + shift, turn @ _SHADOW
    panel.polygons([[edges[0], edges[-1], edges[-1] + back, edges[0] + back]], _LIGHT)
    sides = 10 * _AHEAD * np.array([[-_WIDE, 1], [_WIDE, 1]]) @ R + camera
    panel.veil([np.stack([camera, *sides])], [_WEDGE])
    panel.line(edges[[0, -1]], IDEAL, 8)
    panel.segments(np.stack([edges[:-1:2], edges[1::2]], axis=1), "#FFFFFF", 5)
    panel.line(np.stack([camera, camera + R.T @ [0, _AHEAD]]), IDEAL, 1, dash=4)
    panel.mark(camera, "camera", 9, looks=(R[1, 0], -R[1, 1]))
    panel.mark(shift, "world", 7)
    return panel


def _walk(panel: Panel, to: Array, colour: str, names: str) -> None:
    """Draw the walk from the middle of the frame along its two axes, with its numbers."""
    corner = np.array([to[0], 0.0])
    panel.arrows(np.stack([0 * to, corner]), np.stack([corner, to - corner]), colour, 3)
    panel.line(np.stack([0 * to, to]), IDEAL, 1, dash=4)
    aside = np.copysign(95, to[0] * (panel.x[1] - 165 - abs(to[0])))  # within, where the panel ends
    for name, number, at, by in (
        (names[0], to[0], corner / 2, [0, -50 if to[1] > 0 else 50]),
        (names[1], to[1], (corner + to) / 2, [aside, 0]),
    ):
        panel.text(at + by, f"{name} {round(number)}", colour, anchor="mm", size=14)
