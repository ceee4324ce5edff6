"""Explore the next photograph: what would be known with one more view of the board."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from PIL import Image

from cvnotes.base import Array
from cvnotes.calibration import Calibration, calibrate
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.jackknife import eliminated_by_view
from cvnotes.calibration.prediction import pixel_jacobian
from cvnotes.calibration.refinement import Problem
from cvnotes.camera import Camera, Lens, intrinsics, rotation_from_vector
from cvnotes.pictures import course, good_views, hold_at
from cvnotes.show.explorations.boards import draw_net
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, LENS, MUTED, rgb

# Of chapter 9.
_PHONE = Camera(intrinsics(1180, 1176, 655, 470), lens=Lens(k=(0.08, -0.15)), size=(1280, 960))
_BOARD = course.board()
_SHOWN, _NOISE = (504, 378), 0.1  # px
_BARS, _CURVE = (360, 178), (360, 170)
_LABELS = ("αᵤ", "αᵥ", "u₀", "v₀", "k₁", "k₂")
_HIGHEST = 0.9  # px, where the map is darkest
_DARK = 0.75  # of the way from white to orange
_TINTS = 60  # between them: a picture has 256 colours, and the marks need some
_TILTS = np.arange(-45.0, 46, 5)  # degrees


class _Known(NamedTuple):
    """What ten pictures say: the calibration, and how each pixel moves with the parameters."""

    found: Calibration
    J: Array
    seen: Array


def eleventh_model() -> Model:
    """Make the model of ten pictures, and of an eleventh that has not been taken."""
    nearer = "positive: its outer corner comes nearer; in the middle there is none"
    settings = (
        Setting("u", "u (px)", 100, 1180, 10, 820, "where the board's middle is held"),
        Setting("v", "v (px)", 80, 880, 10, 580, "where the board's middle is held"),
        Setting("tilt", "tilt of outer corner (°)", -45, 45, 5, 0, nearer),
    )
    about = """The picture of a camera, the paler the better a pixel of it is known from ten
    pictures of a board and one more, which is drawn; beside it which part of each standard
    deviation the new picture leaves, and below it what is left of that of k₂ at each tilt."""
    drags = {
        "board": lambda _, at: {"u": float(at[0]), "v": float(at[1])},
        "left": lambda _, at: {"tilt": float(at[0])},
    }
    return Model("eleventh", about, settings, _draw, drags)


@lru_cache(maxsize=1)
def known() -> _Known:
    """Calibrate from ten pictures, as in chapter 9."""
    poses = good_views(_BOARD, _PHONE, 10, rng=np.random.default_rng(2))
    seen = np.array([_PHONE.moved(G).project(_BOARD.points) for G in poses])
    seen += np.random.default_rng(3).normal(scale=_NOISE, size=seen.shape)
    found = calibrate(_BOARD.points, seen, _PHONE.size, lens="k1 k2")
    u, v = np.meshgrid(np.linspace(0, 1279, 65), np.linspace(0, 959, 49))
    return _Known(found, pixel_jacobian(found, np.stack([u, v], axis=-1)), seen)


def held(u: float, v: float, tilt: float) -> Array:
    """Return the pose of the board at a place of the picture, its outer corner tilted nearer."""
    found = known().found
    w, h = found.size
    axis = np.array([h / 2 - v, u - w / 2, 0.0])
    length = np.linalg.norm(axis)
    axis = axis / length if length > 1 else np.array([1.0, 0, 0])
    return hold_at(_BOARD, found.camera, rotation_from_vector(np.radians(tilt) * axis), (u, v))


def with_one_more(G: Array) -> Array:
    """Return the covariance of the camera with the board once more, in pose G (..., 4, 4)."""
    found, poses = known().found, np.reshape(G, (-1, 4, 4))
    data = Correspondences.in_unit_frame(
        _BOARD.points, np.zeros((len(poses), len(_BOARD.points), 2))
    )
    problem = Problem.at(found.camera, found.names, data)
    S, _ = eliminated_by_view(
        problem, problem.state(found.camera, data.pose_in_scaled_units(poses))
    )
    after = np.linalg.inv(np.linalg.inv(found.covariance) + S / _NOISE**2)
    return np.asarray(after.reshape(*G.shape[:-2], *after.shape[1:]))


@lru_cache(maxsize=4)
def left_of_k2(u: float, v: float) -> Array:
    """Return what is left of the standard deviation of k2 at each tilt of the board there."""
    after = with_one_more(np.array([held(u, v, tilt) for tilt in _TILTS]))
    return np.asarray(np.sqrt(after[:, -1, -1] / known().found.covariance[-1, -1]))


def faces_its_ray(u: float, v: float) -> float:
    """Return the tilt at which the board there is square to its line of sight, in degrees."""
    return float(np.degrees(np.arccos(known().found.camera.ray([u, v])[2])))


def _draw(paper: Paper, values: Values) -> Drawing:
    of = known()
    G = held(values["u"], values["v"], values["tilt"])
    after = with_one_more(G)
    std = np.sqrt(np.einsum("...ci,ij,...cj->...", of.J, after, of.J))
    before = np.sqrt(np.einsum("...ci,ij,...cj->...", of.J, of.found.covariance, of.J))
    w, h = of.found.size
    title = "how far the camera may be wrong (σ, px)"
    panel = paper.panel(_SHOWN, (-0.5, w - 0.5), (-0.5, h - 0.5), title)
    part = Image.fromarray((_TINTS * np.clip(std / _HIGHEST, 0, 1)).astype(np.float32))
    fine = np.rint(np.asarray(part.resize((panel.width, panel.height), Image.Resampling.BILINEAR)))
    tints = 1 - np.linspace(0, _DARK, _TINTS + 1)[:, None] * (1 - np.array(rgb(ESTIMATED)))
    panel.image(np.rint(255 * tints).astype(np.uint8)[fine.astype(int)])
    panel.polygons(of.seen.reshape(-1, 1, 2) + 2.4 * circle(9)[:-1], MUTED)
    draw_net(panel, of.found.camera.moved(G).project(_BOARD.points), _BOARD, LENS, 1.5)
    for row, column in ((0, 0), (0, -1), (-1, 0), (-1, -1)):
        at = np.array([44 if column == 0 else w - 45, 24 if row == 0 else h - 25])
        panel.text(at, f"{std[row, column]:.2f}", IDEAL, anchor="mm", size=12)
    panel.mark([values["u"], values["v"]], "estimated", 9)
    panel.grip("board", "the board of the next picture", [values["u"], values["v"]], 20)
    left = np.sqrt(np.diag(after) / np.diag(of.found.covariance))
    column = [_bars(paper, left), _curve(paper, values, float(left[5]))]
    return Drawing(paper.join((panel, column)), _sentence(left, before, std))


def _bars(paper: Paper, left: Array) -> Panel:
    """Draw which part of each standard deviation is left."""
    panel = paper.panel(_BARS, (-0.22, 1.2), (-0.7, 6.1), "what is left of each ±")
    panel.ticks(x=(0, 0.5, 1))
    for i, (label, part) in enumerate(zip(_LABELS, left, strict=True)):
        box = np.array([[0, i - 0.15], [1, i - 0.15], [1, i + 0.15], [0, i + 0.15]])
        panel.polygons(box[None], "#E4E4E4")
        panel.polygons((box * [part, 1])[None], CAMERA)
        panel.text([-0.04, i], label, IDEAL, anchor="rm", size=13)
        panel.text([1.04, i], f"{part:.2f}", IDEAL, size=13)
    return panel


def _curve(paper: Paper, values: Values, left: float) -> Panel:
    """Draw what is left of that of k2 against the tilt, at the same place of the picture."""
    u, v, tilt = values["u"], values["v"], values["tilt"]
    title = "what is left for k₂, by tilt towards the camera (°)"
    panel = paper.panel(_CURVE, (-56, 52), (1.12, -0.2), title)
    panel.ticks(x=(-45, -30, -15, 0, 15, 30, 45), y=(0, 0.5, 1))
    square = faces_its_ray(u, v)
    panel.line([[square, 0], [square, 1.12]], LENS, 1, dash=4)
    panel.text([square - 2, 0.12], "faces the camera", LENS, anchor="rm", size=12)
    panel.line(np.column_stack([_TILTS, left_of_k2(u, v)]), CAMERA, 2)
    panel.mark([tilt, left], "estimated", 8)
    panel.grip("left", "the tilt of the board's outer corner", [tilt, left], 5)
    return panel


def _sentence(left: Array, before: Array, after: Array) -> str:
    return f"""With this picture {left[5]:.2f} of the standard deviation of k₂ would be left, and
    {left[0]:.2f} of that of αᵤ. The worst corner of the picture is known to {before.max():.2f} px
    now, and then to {after.max():.2f}."""
