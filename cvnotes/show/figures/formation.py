"""Figures of how an image is formed: the chain of steps, the field of view, sensor and pixels."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, ShapeError, image_size, intrinsic_matrix, points
from cvnotes.camera import Camera, inverse, move, xy_from_px
from cvnotes.camera.model import is_camera
from cvnotes.show.axes import arrow, beside, drawn_on, halo, letter, panels
from cvnotes.show.figures.images import draw_image
from cvnotes.show.guards import count, one_point
from cvnotes.show.guards import picture as checked
from cvnotes.show.style import CAMERA, ESTIMATED, FONT, IDEAL, LENS, MUTED, WORLD

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def box_lines(x: npt.ArrayLike, y: npt.ArrayLike, z: npt.ArrayLike) -> Array:
    """Return the twelve edges of a box from x[0] to x[1] and so on, as lines (12, 25, 3).

    Examples
    --------
    >>> box_lines((0, 200), (0, 125), (0, 80)).max(axis=(0, 1))
    array([200., 125.,  80.])
    """
    sides = np.stack([one_point(side, name, 2) for side, name in ((x, "x"), (y, "y"), (z, "z"))])
    corners = np.array(list(np.ndindex(2, 2, 2)))
    pairs = [(a, b) for a in range(8) for b in range(a) if (corners[a] != corners[b]).sum() == 1]
    ends = sides[[0, 1, 2], corners][np.array(pairs)]
    along = np.linspace(0, 1, 25)[:, None]
    return np.asarray(ends[:, :1] + along * (ends[:, 1:] - ends[:, :1]))


_STEPS = """1. G: M = R W + T
2. ÷ z: x / z and y / z
3. lens: times L(r), plus p1 and p2
4. A: to pixels"""


def draw_formation(camera: Camera, lines: npt.ArrayLike, point: npt.ArrayLike) -> Any:
    """Draw the chain from the world to the picture, its steps between panels; gives their axes.

    Parameters
    ----------
    camera : Camera
        Its A, G and lens are the steps. An ideal lens has no panel.
    lines : array_like, shape (k, n, 3)
        Lines of the world, n points on each.
    point : array_like, shape (3,)
        A point of the world to be followed, drawn as a cross.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> camera = Camera(intrinsics(800, 800, 320, 240))
    >>> axes = draw_formation(camera, [[[0, 0, 5], [1, 0, 5]]], [1, 0, 5])
    >>> [ax.get_title() for ax in axes][-1]
    '3. A → the picture'
    """
    lines, point = points(lines, "lines", 3), one_point(point, "point", 3)
    if lines.ndim != 3 or lines.size == 0:
        raise ShapeError(f"lines: expected (k, n, 3), lines of n points, got {lines.shape}")
    bent = not is_camera(camera, "camera").lens.is_ideal
    columns = 3 if bent else 2
    grid = panels(columns, 2, width=960, height=660 if bent else 840)
    axes = grid.ravel()[: 5 if bent else 4]
    for ax in grid.ravel()[5:]:  # a place that is free says what the steps are
        ax.axis("off")
        ax.text(0.05, 0.5, _STEPS, transform=ax.transAxes, va="center", linespacing=2)
    W = np.concatenate([lines.reshape(-1, 3), point[None]])
    M = move(camera.G, W)
    _from_above(axes[0], camera, W, lines.shape, camera.G)
    _from_above(axes[1], camera, M, lines.shape, None)
    xy = np.where(M[:, 2:] > 0, M[:, :2] / np.where(M[:, 2:] > 0, M[:, 2:], 1), np.nan)
    _plane(axes[2], camera, xy, lines.shape, IDEAL)
    states = {"the world": W, "the camera's frame": M, "the plane z = 1": xy}
    steps = ["G", "÷ z", "A"]
    if bent:
        states["through the lens"] = camera.lens.distort(np.nan_to_num(xy, nan=1e9))
        _plane(axes[3], camera, states["through the lens"], lines.shape, LENS)
        steps.insert(2, "lens")
    states["the picture"] = camera.project(W)
    _trace(axes[-1], states["the picture"], lines.shape, LENS)
    _border(axes[-1], _corners(camera), "u → , v ↓ (px)")
    leading = ["", *(f"{i}. {step} → " for i, step in enumerate(steps, start=1))]
    for ax, step, (name, (*_, place)) in zip(axes, leading, states.items(), strict=True):
        ax.set_title(step + name, fontsize=FONT + 1)
        ax.locator_params(nbins=4)
        ax.set_box_aspect(0.85)
        ax.set_aspect("equal", adjustable="datalim")
        digits = 0 if len(place) == 3 else 4 if np.abs(place).max() < 10 else 1
        words = ", ".join(f"{number:.{digits}f}" for number in place).replace("-", "−")
        y, va = (0.97, "top") if len(place) == 3 else (0.03, "bottom")  # a camera stands below
        ax.text(0.98, y, f"({words})", transform=ax.transAxes, ha="right", va=va, color=ESTIMATED)
    return axes


def _trace(ax: "Axes", m: Array, shape: tuple[int, ...], colour: str) -> None:
    """Draw the lines, and the last point as a cross."""
    for line in m[:-1].reshape(*shape[:2], -1):
        ax.plot(*line[:, :2].T, color=colour, lw=1.1)
    ax.plot(*m[-1, :2], "x", color=ESTIMATED, ms=9, mew=2.5, zorder=5)


def _from_above(
    ax: "Axes", camera: Camera, X: Array, shape: tuple[int, ...], G: Array | None
) -> None:
    """Draw lines and camera from above, z upwards; in the world's frame if G is given."""
    _trace(ax, X[:, [0, 2]], shape, WORLD)
    middle = X.mean(axis=0)
    reach = 0.25 * float(np.linalg.norm(middle if G is None else move(G, middle)))
    w = camera.size[0]
    sides = np.array([[-0.5, camera.A[1, 2]], [w - 0.5, camera.A[1, 2]]])
    tips = np.concatenate([xy_from_px(camera.A, sides), np.ones((2, 1))], axis=1)
    tips = reach * tips / tips[:, 2:]
    frame = reach * np.array([[0, 0, 0], [1, 0, 0], [0, 0, 1.0]])
    cone = np.concatenate([np.zeros((1, 3)), tips, np.zeros((1, 3))])
    if G is not None:
        _frame(ax, frame, WORLD, "XZ")
        cone, frame = move(inverse(G), cone), move(inverse(G), frame)
    ax.plot(*cone[:, [0, 2]].T, color=CAMERA, lw=1.4)
    _frame(ax, frame, CAMERA, "xz")
    ax.set_xlabel("x → , z ↑" if G is None else "X → , Z ↑")


def _frame(ax: "Axes", frame: Array, colour: str, letters: str) -> None:
    for tip, name in zip(frame[1:], letters, strict=True):
        arrow(ax, frame[0, [0, 2]], tip[[0, 2]], colour, 1.5, gap=2)
        out = 1.22 * tip - 0.22 * frame[0]
        ax.plot(*np.stack([frame[0], out])[:, [0, 2]].T, alpha=0)  # makes room
        letter(ax, name, out[[0, 2]], colour, fontsize=FONT - 1)


def _plane(ax: "Axes", camera: Camera, xy: Array, shape: tuple[int, ...], colour: str) -> None:
    """Draw the plane z = 1, with the picture's border."""
    _trace(ax, xy, shape, colour)
    axes = "x / z → , y / z ↓" if colour == IDEAL else "x' → , y' ↓"
    _border(ax, xy_from_px(camera.A, _corners(camera)), axes)
    ax.plot(0, 0, "+", color=IDEAL, ms=8)


def _corners(camera: Camera) -> Array:
    """Return the corners (4, 2) of a camera's picture, in pixels."""
    w, h = camera.size
    return np.array([[0, 0], [w, 0], [w, h], [0, h]]) - 0.5


def _border(ax: "Axes", corners: Array, label: str) -> None:
    """Draw the picture's border, and let the second coordinate run down."""
    ax.plot(*corners[[0, 1, 2, 3, 0]].T, color=CAMERA, lw=1.2)
    ax.set_xlabel(label)
    ax.invert_yaxis()


def draw_field_of_view(cameras: Mapping[str, Camera], *, ax: "Axes | None" = None) -> "Axes":
    """Draw, from above and in pixels, how wide an angle each camera's picture spans.

    Parameters
    ----------
    cameras : mapping from names to Camera
        Up to five. The picture is drawn at the distance α_u from the centre.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> ax = draw_field_of_view({"wide": Camera(intrinsics(320, 320, 319.5, 240))})
    >>> [text.get_text() for text in ax.texts]
    ['wide: 90.0°']
    """
    from matplotlib.patches import Polygon

    if not isinstance(cameras, Mapping) or not 1 <= len(cameras) <= len(_OWN):
        raise CvnotesError(f"cameras: expected one to {len(_OWN)} by name")
    ax = drawn_on(ax, height=340)
    for (name, camera), colour in zip(cameras.items(), _OWN, strict=False):
        alpha, u0 = is_camera(camera, "camera").A[[0, 0], [0, 2]]
        left, right = -0.5 - u0, camera.size[0] - 0.5 - u0
        ax.plot([alpha, alpha], [left, right], color=colour, lw=4)
        ax.add_patch(Polygon([[0, 0], [alpha, left], [alpha, right]], fc=colour, alpha=0.12))
        angle = np.degrees(np.arctan2(right, alpha) - np.arctan2(left, alpha))
        beside(ax, f"{name}: {angle:.1f}°", (alpha, right), (0, -16), colour, ha="center")
    ax.axhline(0, color=MUTED, ls="-.", lw=0.8)
    ax.plot(0, 0, ">", color=CAMERA, ms=9)
    ax.set(xlabel="along the axis (px)", ylabel="sideways (px)", aspect="equal")
    ax.margins(x=0.12, y=0.12)
    ax.invert_yaxis()
    return ax


_OWN = (LENS, ESTIMATED, WORLD, CAMERA, IDEAL)


def draw_sensor(A: npt.ArrayLike, *, ax: "Axes | None" = None) -> "Axes":
    """Draw a sensor's lines of pixels on the plane z = 1, as A has it: its axes may lean.

    Parameters
    ----------
    A : array_like, shape (3, 3)
        Intrinsic matrix of a sensor of 640 × 480 pixels; every 80 of them a line is drawn.

    Examples
    --------
    >>> draw_sensor([[800, 0, 320], [0, 800, 240], [0, 0, 1]]).get_xlabel()
    'x / z'
    """
    A, step = intrinsic_matrix(A), 80
    ax = drawn_on(ax, height=400)
    columns, rows = np.arange(0, 641, step), np.arange(0, 481, step)
    for u in columns:
        ax.plot(*xy_from_px(A, [[u, 0], [u, 480]]).T, color=MUTED, lw=0.8)
    for v in rows:
        ax.plot(*xy_from_px(A, [[0, v], [640, v]]).T, color=MUTED, lw=0.8)
    start, *tips = xy_from_px(A, [[0, 0], [2 * step, 0], [0, 2 * step]])
    for tip, name in zip(tips, "uv", strict=True):
        arrow(ax, start, tip, LENS, 2.2, gap=2)
        letter(ax, name, 1.2 * tip - 0.2 * start, LENS)
    first, last = (np.arctan2(*(tip - start)[::-1]) for tip in tips)
    arc = np.linspace(first, last, 25)[:, None]
    reach = 0.4 * float(np.linalg.norm(tips[0] - start))
    ax.plot(*(start + reach * np.hstack([np.cos(arc), np.sin(arc)])).T, color=ESTIMATED, lw=1.8)
    middle = start + 1.5 * reach * np.hstack([np.cos(arc), np.sin(arc)])[12]
    letter(ax, "θ", middle, ESTIMATED)
    ax.plot(0, 0, "^", color=CAMERA, ms=8)
    beside(ax, "(u0, v0)", (0, 0), (8, 8), CAMERA, path_effects=halo())
    ax.set(xlabel="x / z", ylabel="y / z", aspect="equal")
    ax.invert_yaxis()
    return ax


def draw_pixels(
    image: npt.ArrayLike,
    corner: tuple[int, int],
    size: tuple[int, int] = (8, 6),
    *,
    ax: "Axes | None" = None,
) -> "Axes":
    """Draw a few pixels of a picture as the squares they are, with their centres and numbers.

    Parameters
    ----------
    image : array_like, shape (height, width) or (height, width, 3)
        The picture.
    corner : (u, v)
        The first pixel to show.
    size : (columns, rows)
        How many.

    Examples
    --------
    >>> draw_pixels(np.zeros((48, 64), np.uint8), (0, 0), (4, 3)).get_xlim()
    (np.float64(-0.5), np.float64(3.5))
    """
    from matplotlib.patches import Rectangle

    picture, (columns, rows) = checked(image), image_size(size)
    first = one_point(corner, "corner", 2)
    if (first < 0).any() or (first + size > picture.shape[1::-1]).any():
        raise CvnotesError("these pixels are not inside of the picture")
    u0, v0 = np.rint(first).astype(int)
    ax = drawn_on(ax, width=560)
    draw_image(picture, ax=ax, ticks=True)
    for u in range(u0, u0 + columns):
        for v in range(v0, v0 + rows):
            ax.add_patch(Rectangle((u - 0.5, v - 0.5), 1, 1, fc="none", ec=MUTED, lw=0.8))
    centres = np.mgrid[u0 : u0 + columns, v0 : v0 + rows].reshape(2, -1)
    ax.plot(*centres, "o", color=MUTED, ms=4, mec="white", mew=0.8)
    ax.set(xlim=(u0 - 0.5, u0 + columns - 0.5), ylim=(v0 + rows - 0.5, v0 - 0.5))
    ax.set(xticks=range(u0, u0 + columns), yticks=range(v0, v0 + rows))
    return ax


def draw_half_pixels(factor: int = 2, *, ax: "Axes | None" = None) -> "Axes":
    """Draw a row of pixels, and below it the same row with `factor` times fewer, wider pixels.

    Examples
    --------
    >>> [text.get_text() for text in draw_half_pixels(4).texts if "½" in text.get_text()]
    ['−½', '7½', '−½', '1½']
    """
    from matplotlib.patches import Rectangle

    factor = count(factor, "factor")
    ax = drawn_on(ax, height=230)
    few = max(2, 8 // factor)
    rows = ((few * factor, 1, 0.0, -0.2, LENS), (few, factor, 1.4, 2.85, ESTIMATED))
    for n, wide, top, words, colour in rows:
        for u in range(n):
            middle = ((u + 0.5) * wide, top + 0.4)
            ax.add_patch(Rectangle((u * wide, top), wide, 1, fc="white", ec=colour, lw=1.5))
            ax.plot(*middle, ".", color=colour, ms=8)
            beside(ax, str(u), middle, (0, -16), colour, ha="center")
        for at, text in ((0, "−½"), (n * wide, f"{n - 1}½")):
            ax.text(at, words, text, ha="center", color=colour, fontsize=FONT + 1)
    for u in (0, few * factor):
        ax.plot([u, u], [0, 2.4], ":", color=IDEAL, lw=1)
    ax.set(xlim=(-1, few * factor + 1), ylim=(3.1, -0.8), aspect="equal")
    ax.axis("off")
    return ax
