"""Explore how clicks scatter: what they make of three vanishing points and the principal point."""

from functools import lru_cache

import numpy as np
from PIL import Image as Bitmap

from cvnotes.base import Array
from cvnotes.camera import Camera, look_at
from cvnotes.pictures import blocks, course, render_scene
from cvnotes.projective import from_homogeneous, to_homogeneous
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper, circle
from cvnotes.show.style import ESTIMATED, FAINT, MUTED, mixed

_POSE = look_at([1200, -8000, 2000], [700, -1000, 12800])
_CAMERA = Camera(course.camera().A, _POSE, size=(640, 480))
_ENDS = np.array([[0, 1, 4, 5, 2, 3], [0, 2, 1, 3, 5, 7], [0, 4, 1, 5, 3, 7]])  # along X, Y and Z
_EDGES = _CAMERA.project(blocks().vertices[_ENDS]).reshape(3, 3, 2, 2)
_SQUARE, _C = np.array([1, 800 / 804]), _CAMERA.A[:2, 2]
_TRUE = _CAMERA.vanishing_point(blocks().vertices[[1, 2, 4]] - blocks().vertices[0])
_SHOWN, _SIZE, _CLOSE = ((-1250.0, 1390.0), (-560.0, 1720.0)), (440, 380), (330, 380)
_TIMES, _REACH = 3, 24.0  # so many times larger are clouds; px to either side of c, enlarged
_DOT = mixed(ESTIMATED, "#FFFFFF", 0.4)
_TURNED = np.array([[1, 1], [-1, 1]]) / np.sqrt(2)
_DRAWS, _FIRST = 200, 14.4  # how often one clicks; about so many px does c scatter for 1 px


def clicks_model() -> Model:
    """Make the model of the chapter's nine edges, clicked two hundred times with errors."""
    settings = (Setting("noise", "clicks (px)", 0.1, 0.8, 0.05, 0.3, "their standard deviation"),)
    about = """A box, and far around it two hundred findings of each of its three vanishing points:
    clouds that point at the box. In the middle is the cloud of the principal point, round and
    small; beside it the same enlarged, with its circle and the middle of the picture."""

    @lru_cache(maxsize=2)
    def sheet(sharpness: int) -> Drawn:
        """Put the photograph on white paper, pale, once for all values."""
        photo = render_scene(blocks(), _CAMERA, samples=4)
        pale = Bitmap.fromarray((0.6 * photo + 102).astype("u1"))
        paper = Bitmap.new("RGB", (sharpness * _SIZE[0], sharpness * _SIZE[1]), "white")
        scale = paper.width / np.ptp(_SHOWN[0])
        corner = (round(-scale * _SHOWN[0][0]), round(-scale * _SHOWN[1][0]))
        paper.paste(pale.resize((round(scale * 640), round(scale * 480))), corner)
        return np.asarray(paper)

    def draw(paper: Paper, values: Values) -> Drawing:
        v, c, f = found(values["noise"])
        title = f"200 measurements, their scatter {_TIMES} times too large"
        far = paper.panel(_SIZE, *_SHOWN, title)
        far.image(sheet(paper.sharpness))
        for family, true in zip(_EDGES, _TRUE, strict=True):
            far.segments([[edge[0], true] for edge in family], FAINT, 0.8)
        for name, cloud, true in zip("XYZc", [*v.transpose(1, 0, 2), c], [*_TRUE, _C], strict=True):
            _dots(far, true + _TIMES * (cloud - true))
            far.mark(true, "ideal", 6)
            if name != "c":
                aside = (110, 0) if name == "Y" else (0, -110)
                far.text(true + aside, name, ESTIMATED, anchor="mm", size=14)
        far.line(_C + np.array([[345, 92], [75, 20]]), ESTIMATED, 0.8)
        far.text([690, 340], "principal point c", ESTIMATED, size=13)
        close = _draw_close(paper, c)
        return Drawing(paper.join((far, close)), _sentence(values["noise"], c, f))

    drags = {"circle": lambda _, at: {"noise": (at[0] - _C[0]) / _FIRST}}
    return Model("clicks", about, settings, draw, drags)


def found(noise: float) -> tuple[Array, Array, Array]:
    """Return what clicks with errors give: v (200, 3, 2), c (200, 2) and α_u (200,), in px."""
    errors = noise * np.random.default_rng(2).normal(size=(_DRAWS, *_EDGES.shape))
    seen = (_EDGES + errors) * _SQUARE
    ends = to_homogeneous(seen / 100)  # numbers of one size
    lines = np.cross(ends[..., 0, :], ends[..., 1, :])
    lines = lines / np.linalg.norm(lines[..., :2], axis=-1, keepdims=True)
    v = 100 * from_homogeneous(np.linalg.svd(lines)[2][..., -1, :])
    X, Y, Z = np.moveaxis(v, 1, 0)
    across = np.stack([Y - Z, Z - X], axis=1)
    at = np.stack([((Y - Z) * X).sum(-1), ((Z - X) * Y).sum(-1)], axis=-1)
    c = np.linalg.solve(across, at[..., None])[..., 0]
    square = -((X - c) * (Y - c)).sum(-1)
    return v / _SQUARE, c / _SQUARE, np.sqrt(square.clip(0))


def _draw_close(paper: Paper, c: Array) -> Panel:
    """Draw the principal points at their size, the circle of their scatter, and the middle."""
    (u, v), high = _C, _REACH * _CLOSE[1] / _CLOSE[0]
    x, y = (u - _REACH, u + _REACH), (v - high, v + high)
    panel = paper.panel(_CLOSE, x, y, "the principal point c alone, larger")
    _dots(panel, c)
    radius, middle = float(np.std(c - _C)), np.array([319.5, 239.5])
    panel.line(_C + radius * circle(90), ESTIMATED, 1.6)
    panel.mark(_C, "ideal", 9)
    panel.polygons([middle + r * circle(5) @ _TURNED for r in (1.1, 0.8)], ["#000000", "#FFFFFF"])
    panel.text([u + 3, v - 21], "the true c", "#000000", anchor="mm", size=13)
    panel.line(np.array([[u + 2.4, v - 19.3], [u + 0.2, v - 1.6]]), "#000000", 0.8)
    panel.text([u - 3, v + 21], "middle of the picture", "#000000", anchor="mm", size=13)
    panel.line(np.array([[u - 4, v + 19.3], [middle[0], middle[1] + 1.1]]), "#000000", 0.8)
    panel.line([[u + 12, v + 25.5], [u + 22, v + 25.5]], MUTED, 2)
    panel.text([u + 17, v + 23.9], "10 px", anchor="mm", size=12)
    at = _C + radius * np.array([1, 0])
    panel.grip("circle", "the circle, wider for worse clicks", at, 2, "estimated", 7)
    return panel


def _dots(panel: Panel, places: Array) -> None:
    panel.polygons(places[:, None] + 1.6 * panel.pixel * circle(9), _DOT)


def _sentence(noise: float, c: Array, f: Array) -> str:
    return f"""Clicks that err by {noise:.2f} px: the principal point scatters by
    {np.std(c - _C):.1f} px along each axis, the focal length by {np.std(f):.1f} px."""
