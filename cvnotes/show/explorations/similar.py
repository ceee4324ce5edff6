"""Explore the pinhole: two similar triangles, and what they make of a tree that is farther away."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.style import CAMERA, IDEAL, LENS, MUTED, WORLD, mixed

_FOOT, _TOP = 1.6, -1.4  # m, the y of a tree's foot and of its top
_FAR = np.array([2.2, 10.0])  # m, x and z of the pale tree
# px of the side view for a metre to the right and down, and for a millimetre of the camera.
_AHEAD, _DOWN, _INSIDE = 33.0, 72.0, 12.0
_SKY, _GRASS, _BOX, _PAPER = "#EAF3FA", "#CBDDB4", "#3A3A3A", "#FBF6E6"
_LIGHT, _BEAM, _PANE = "#FFF3CC", "#9A8C62", "#CFE6F6"
_TRUNK = np.array([[-0.13, 1.6], [0.13, 1.6], [0.05, 0.1], [-0.05, 0.1]])
_CROWN = (  # x, y, radius in m, colour
    (-0.42, 0.04, 0.37, "#2F7A48"), (0.44, 0.0, 0.37, "#2A7042"), (0.05, 0.1, 0.38, "#2F7A48"),
    (-0.36, -0.45, 0.4, "#3D8F56"), (0.37, -0.48, 0.38, "#348250"), (0, -0.3, 0.42, "#3D8F56"),
    (0.03, -0.98, 0.42, "#44975C"), (-0.08, -0.72, 0.36, "#52A469"), (-0.4, -0.55, 0.22, "#52A469"),
    (-0.06, -1.06, 0.26, "#67B47A"),
)  # fmt: skip


def similar_model() -> Model:
    """Make the model of a pinhole camera from the side, before it two trees that are as high."""
    settings = (
        Setting("z", "z (m)", 4, 10, 0.1, 5, "how far the green tree is from the hole"),
        Setting("f", "f (mm)", 4, 9, 0.1, 8, "how far the film is from the hole"),
    )
    about = """A dark box with a hole, from the side: light from a tree goes through the hole to the
    film, upside down there, upright on the image plane before the hole; a blue triangle of height v
    in a similar green one of height y. Beside it the image plane from before."""

    def draw(paper: Paper, values: Values) -> Drawing:
        z, f = values["z"], values["f"]
        title = "from the side: heights stretched, camera enlarged"
        side = paper.panel((560, 336), (-150, 410), (-152, 184), title)
        _draw_side(side, z, f)
        plane = paper.panel((244, 336), (-2.0, 3.88), (-3.8, 4.3), "the image plane (mm)")
        _draw_plane(plane, z, f)
        return Drawing(paper.join((side, plane)), _sentence(z, f))

    drags = {
        "tree": lambda _, at: {"z": float(at[0]) / _AHEAD},
        "film": lambda _, at: {"f": -at[0] / _INSIDE},
    }
    return Model("similar", about, settings, draw, drags)


def _draw_tree(panel: Panel, M: Array, at: npt.ArrayLike, pale: float = 0) -> None:
    """Draw a tree, its metres taken to the panel by M (2, 2), its axis point to `at`."""
    inks = ["#7A5230", *(ink for *_, ink in _CROWN)]
    parts = [_TRUNK, *(r * circle(40) + [x, y] for x, y, r, _ in _CROWN)]
    parts = [part @ M.T + np.asarray(at) for part in parts]
    panel.polygons(parts, [mixed(ink, _SKY, pale) for ink in inks])


def _draw_side(panel: Panel, z: float, f: float) -> None:
    ground, ahead, film = _DOWN * _FOOT, _AHEAD * z, _INSIDE * f
    for v0, v1, ink in ((-200, ground, _SKY), (ground, 200, _GRASS)):
        panel.polygons([np.array([[-200, v0], [500, v0], [500, v1], [-200, v1]])], ink)
    v, top = np.array([_FOOT, _TOP]) * _DOWN * film / ahead
    tree = np.array([[0, 0], [ahead, 0], [ahead, ground]])
    panel.veil([tree + [[0, 0], [0, _DOWN * _TOP], [0, 0]]], [_LIGHT])
    panel.veil([tree], ["#C9E9C9"])
    panel.polygons([np.array([[-142, -134], [0, -134], [0, ground], [-142, ground]])], _BOX)
    panel.polygons([np.array([[0, 0], [-film, -v], [-film, -top]])], _BEAM)
    panel.line([[-150, 0], [410, 0]], MUTED, 0.9, dash=6)
    for away, pale in ((_AHEAD * _FAR[1], 0.6), (ahead, 0)):
        _draw_tree(panel, _DOWN * np.eye(2), (away, 0), pale)
    sheet = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) @ [[22, -10], [0, 98]]
    panel.polygons([sheet + [-film, 0]], _PAPER)
    panel.veil([sheet + [film, 0]], [_PANE])
    panel.line((sheet + [film, 0])[[0, 1, 2, 3, 0]], CAMERA, 1.2)
    for at, k in ((-film, -film / _AHEAD), (film, film / _AHEAD)):  # seen aslant, as the planes
        for (x, away), pale in ((_FAR, 0.6), ((0, z), 0)):
            M = _DOWN * k / away * np.array([[0.35, 0], [-0.16, 1]])
            _draw_tree(panel, M, M[:, 0] * x + [at, 0], pale)
    panel.veil([tree * film / ahead], ["#8CBCE0"])
    for end in (_FOOT, _TOP):
        panel.line(np.outer([-film, ahead], [1, end * _DOWN / ahead]), MUTED, 1)
    panel.arrows([ahead, 0], [0, ground], WORLD, 3)
    panel.arrows([film, 0], [0, v], LENS, 3)
    for tip, name, at in (((38, 0), "z", (40, -14)), ((0, 38), "y", (14, 40))):  # the frame at C
        panel.arrows((0, 0), tip, CAMERA, 2)
        panel.text(at, name, CAMERA, anchor="mm", size=14, rim=_SKY)
    panel.polygons([6 * circle(20)], CAMERA)
    for end, row, name in ((film, ground + 20, "f"), (ahead, ground + 48, "z")):
        panel.segments([[[0, ground], [0, row + 6]], [[end, ground], [end, row + 6]]], MUTED, 0.9)
        panel.arrows([[end / 2, row]] * 2, [[-end / 2, 0], [end / 2, 0]], IDEAL, 1.2)
        panel.text([end / 2, row - 10], name, IDEAL, anchor="mm", size=15, rim=_GRASS)
    for at, name, ink, anchor in (
        ((ahead + 9, ground / 2 + 12), "y", WORLD, "lm"), ((film + 8, v / 2 + 2), "v", LENS, "lm"),
        ((4, -70), "pinhole C", CAMERA, "lm"), ((film + 4, -132), "image plane", CAMERA, "mm"),
        ((406, -10), "axis", MUTED, "rm"),
    ):  # fmt: skip
        panel.text(at, name, ink, anchor=anchor, size=15 if len(name) == 1 else 13, rim=_SKY)
    panel.text([-film, -120], "film", "#FFFFFF", anchor="mm", size=13, rim=_BOX)
    panel.mark([[-film, -v], [film, v]], "lens", 7)
    panel.mark([ahead, ground], "world", 8)
    panel.grip("film", "the film, nearer to the hole or farther", [-film, -v], 2)
    panel.grip("tree", "the foot of the tree, nearer or farther", [ahead, ground], 4)


def _draw_plane(panel: Panel, z: float, f: float) -> None:
    """Draw what is on the image plane: both trees upright, and the heights of their feet."""
    panel.polygons([[[-9, -9], [9, -9], [9, 0], [-9, 0]]], _SKY)
    for part in np.linspace(0, 1, 30).tolist():  # the lawn, paler towards the horizon
        row = 4.3 * part
        strip = [[-9, row], [9, row], [9, 9], [-9, 9]]
        panel.polygons([strip], mixed(_SKY, _GRASS, 0.25 + 0.75 * part))
    panel.line([[-9, 0], [9, 0]], MUTED, 0.9, dash=6)
    for (x, away), pale, side in ((_FAR, 0.6, 1), ((0, z), 0, -1)):
        at, v = f * x / away, f * _FOOT / away
        _draw_tree(panel, f / away * np.eye(2), (at, 0), pale)
        panel.arrows([at, 0], [0, v], LENS, 3)
        aside = [at + side * (0.2 * f / away + 0.05), 0.72 * v]
        # What becomes of v is asked: the pale tree tells it when the green one has come there.
        told = f"{v:.2f}" if side < 0 or z == _FAR[1] else "?"
        panel.text(aside, told, LENS, anchor="lm" if side > 0 else "rm", size=13)
    panel.mark([0, f * _FOOT / z], "lens", 7)


def _sentence(z: float, f: float) -> str:
    return f"v = f · y / z = {f:g} · {1e3 * _FOOT:.0f} / {1e3 * z:.0f} = {f * _FOOT / z:.2f} mm."
