"""Explore the epipolar line: a pixel of one picture, and where the other may show the same."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array, Image, luma
from cvnotes.camera import Camera, intrinsics, pose, rotation_from_vector
from cvnotes.pictures import radiance, room
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import ESTIMATED, FAINT, LENS
from cvnotes.warping import interpolate

_SIZE, _SHOWN = (640, 480), (392, 294)  # px
_NEAREST, _FARTHEST = 2000, 20_000  # mm
_PATCH = 7  # px from the middle of a patch to its border
_AROUND = np.stack(np.meshgrid(*2 * [np.arange(-_PATCH, _PATCH + 1.0)]), axis=-1)
_ALIKE = 1.0  # grey levels: so little more is as good as the best
_LEAST = 80.0  # grey levels on the scale, so that a valley of a few of them looks shallow
_WIDE = 1.2  # the farthest over the nearest depth of a valley that is wide
_WIDTH, _HIGH = 410, (44, 112)  # px of the page: the strip along the line, and the curve below it
_AXIS = 1000 / _NEAREST + 0.02, 1000 / _FARTHEST - 0.03  # 1/m, from near to far
_BESIDE = np.linspace(-2.5, 2.5, 22)  # px of the picture that the strip shows across the line
_TRIED = 1 / np.linspace(1 / _NEAREST, 1 / _FARTHEST, 240)  # mm: in even steps along the line


def epipolar_model() -> Model:
    """Make the model of the room by the two cameras of chapter 10."""
    settings = (
        Setting("u", "u (px)", 120, 620, 1, 449, "a pixel of the first picture"),
        Setting("v", "v (px)", 40, 450, 1, 205, "and its row"),
        Setting("depth", "depth (mm)", _NEAREST, _FARTHEST, 50, 4000, "how far away it may be"),
    )
    about = """Two pictures of a room; a pixel of the first, the line on which the second shows what
    may lie behind this pixel, and how well a patch around both agrees, depth by depth."""
    drags = {"depth": lambda _, at: {"depth": 1000 / max(at[0], 1e-3)}, "pixel": placed("u", "v")}
    return Model("epipolar", about, settings, _draw, drags)


def cameras() -> tuple[Camera, Camera]:
    """Return the two cameras: the second 200 mm to the right, and turned a little."""
    first = Camera(intrinsics(520, 520, 319.5, 239.5), size=_SIZE)
    turn = rotation_from_vector([0.02, -0.06, 0.03])
    return first, first.moved(pose(turn, [-200, 10, 15]))


@lru_cache(maxsize=1)
def photographs() -> tuple[Image, Image]:
    """Return what both see, in colours."""
    first, second = (radiance(room(), camera, samples=4) for camera in cameras())
    return first, second


@lru_cache(maxsize=1)
def in_grey() -> tuple[Image, Image]:
    """Return the same in grey levels, which are compared."""
    first, second = map(luma, photographs())
    return first, second


def seen_by_the_second(m: Array, depth: Array) -> Array:
    """Return where (n, 2) the second camera sees what lies in pixel m of the first, by depth."""
    first, second = cameras()
    return second.project(np.asarray(depth)[:, None] * [*first.ideal(m), 1])


def differences(m: Array, places: Array) -> Array:
    """Return by which RMS (n,) the patches around places (n, 2) differ from the one around m."""
    first, second = in_grey()
    apart = interpolate(second, places[:, None, None] + _AROUND) - interpolate(first, m + _AROUND)
    return np.asarray(np.sqrt(np.mean(apart**2, axis=(1, 2))))


def _draw(paper: Paper, values: Values) -> Drawing:
    m, depth = np.array([values["u"], values["v"]]), values["depth"]
    line, place = seen_by_the_second(m, _TRIED), seen_by_the_second(m, np.array([depth]))[0]
    pictures, patches = [], []
    for photo, at, name in zip(photographs(), (m, place), ("first", "second"), strict=True):
        picture = paper.picture_panel(_SHOWN, _SIZE, f"the {name} camera")
        picture.image(photo.clip(0, 255).astype(np.uint8))
        pictures.append(picture)
        patches.append(_patch(paper, photo, at, f"{name}, enlarged"))
    left, right = pictures
    left.grip("pixel", "a pixel of the first picture", m, 4, "ideal", 8)
    endless = cameras()[1].project(1e9 * cameras()[0].ray(m))  # beyond it, points lie behind
    right.line([endless, endless + 60 * (line[0] - line[-1])], LENS, 1.5, dash=6)
    right.text(endless + [4, -14], "∞", LENS, size=14)
    begin = endless + (14 - endless[0]) / (line[0] - line[-1])[0] * (line[0] - line[-1])
    right.text(begin + [0, 10], "epipolar line", LENS, anchor="la", size=12, rim="white")
    right.line(line, ESTIMATED, 2)
    right.mark(place, "estimated", 7)
    cost, (now,) = differences(m, line), differences(m, place[None])
    below = [_strip(paper, m, depth), _curve(paper, cost, depth, now)]
    picture = paper.join((left, right), (*patches, below))
    return Drawing(picture, _sentence(depth, now, cost))


def _patch(paper: Paper, photo: Image, at: Array, title: str) -> Panel:
    """Draw what one camera shows around a place, pixel by pixel."""
    n = 2 * _PATCH + 1
    panel = paper.picture_panel((184, 184), (n, n), title, (-_PATCH, -_PATCH))
    patch = np.rint(interpolate(photo, at + _AROUND)).clip(0, 255).astype(np.uint8)
    panel.image(patch, smooth=False)
    panel.mark([0, 0], "ideal", 6)
    return panel


def _strip(paper: Paper, m: Array, depth: float) -> Panel:
    """Draw the second picture along the line, which is level here, above the curve of the same."""
    panel = paper.panel((_WIDTH, _HIGH[0]), _AXIS, (-1, 1), "the second picture along its line")
    along = seen_by_the_second(m, 1000 / np.linspace(*_AXIS, _WIDTH // 2))
    way = along[-1] - along[0]
    across = np.array([-way[1], way[0]]) / np.linalg.norm(way) * np.sign(way[0])
    strip = interpolate(photographs()[1], along + _BESIDE[:, None, None] * across)
    panel.image(strip.clip(0, 255).astype(np.uint8))
    panel.mark([1000 / depth, 0], "estimated", 7)
    return panel


def _curve(paper: Paper, cost: Array, depth: float, now: float) -> Panel:
    """Draw by how much both patches differ, for each depth; equal steps are equal disparities."""
    top = max(_LEAST, 1.18 * float(cost.max()))
    title = "RMS of the difference: pull the cross"
    panel = paper.panel((_WIDTH, _HIGH[1]), _AXIS, (top, -0.25 * top), title)
    for metres in (2, 3, 4, 5, 7, 10, 20):
        panel.line([[1 / metres, 0], [1 / metres, top]], FAINT, 0.5)
        panel.text([1 / metres, -0.13 * top], f"{metres} m", anchor="mm", size=10)
    panel.line(np.column_stack([1000 / _TRIED, cost]), LENS, 2)
    most = float(cost.max())
    panel.segments([[[panel.x[0], y], [panel.x[1], y]] for y in (0, most)], FAINT, 0.5)
    panel.text([panel.x[1] + 0.006, most - 0.13 * top], f"{most:.0f} grey levels", anchor="rm")
    panel.grip("depth", "how far away it may be", [1000 / depth, now], 4, "estimated", 7)
    return panel


def _sentence(depth: float, now: float, cost: Array) -> str:
    said = f"At {depth / 1000:.2f} m the two patches differ by {now:.1f} grey levels (RMS). "
    if np.ptp(cost) < _ALIKE:
        return f"{said}So they do everywhere: nothing here tells one depth from another."
    low = _TRIED[cost < cost.min() + _ALIKE] / 1000
    if low.max() < _WIDE * low.min():
        return f"{said}They agree best at {_TRIED[cost.argmin()] / 1000:.2f} m."
    to = "on" if low.max() > 0.99 * _FARTHEST / 1000 else f"to {low.max():.1f} m"
    return f"{said}They agree about as well from {low.min():.1f} m {to}."
