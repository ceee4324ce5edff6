"""Figures of how an image is formed: the chain of steps, and the field of view."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import MOST, Array, CvnotesError, ShapeError, number, points
from cvnotes.camera import Camera, inverse, move, xy_from_px
from cvnotes.camera.model import is_camera
from cvnotes.pictures import render_scene, room
from cvnotes.pictures.meshes import Colour, Scene, box, from_above, join, quads
from cvnotes.show.axes import arrow, beside, drawn_on, halo, letter, panels
from cvnotes.show.guards import one_point
from cvnotes.show.style import CAMERA, ESTIMATED, FONT, IDEAL, LENS, MUTED, WORLD, rgb

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def box_lines(x: npt.ArrayLike, y: npt.ArrayLike, z: npt.ArrayLike) -> Array:
    """Return the twelve edges of a box from x[0] to x[1] and so on, as lines (12, 2, 3).

    Examples
    --------
    >>> box_lines((0, 200), (0, 125), (0, 80)).max(axis=(0, 1))
    array([200., 125.,  80.])
    """
    sides = np.stack([one_point(side, name, 2) for side, name in ((x, "x"), (y, "y"), (z, "z"))])
    corners = np.array(list(np.ndindex(2, 2, 2)))
    pairs = [(a, b) for a in range(8) for b in range(a) if (corners[a] != corners[b]).sum() == 1]
    return np.asarray(sides[[0, 1, 2], corners][np.array(pairs)])


_FILL = rgb(WORLD)
_SHADES = (1.0, 0.5, 0.55, 0.85, 0.9, 0.6)  # of front, back, left, right, top, bottom
_FARTHEST = 1e9  # what is farther away is not drawn
_AXES = np.array([[0, 0, 0], [1, 0, 0], [0, 0, 1.0]])
_TABLE = ((0.93, 0.90, 0.84), (0.87, 0.83, 0.76))


def draw_formation(camera: Camera, lines: npt.ArrayLike, point: npt.ArrayLike) -> Any:
    """Draw the chain from the world to the picture, its steps between panels; gives their axes.

    Parameters
    ----------
    camera : Camera
        Its A, G and lens are the steps. An ideal lens has no panel.
    lines : array_like, shape (12, n, 3)
        The edges of a box, as `box_lines` gives them.
    point : array_like, shape (3,)
        A point of the world to be followed, drawn as a cross.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> camera = Camera(intrinsics(800, 800, 320, 240))
    >>> axes = draw_formation(camera, box_lines((0, 1), (0, 1), (5, 6)), [1, 0, 5])
    >>> [ax.get_title() for ax in axes][-1]
    'the picture'
    """
    lines, point = points(lines, "lines", 3), one_point(point, "point", 3)
    if lines.ndim != 3 or len(lines) != 12 or lines.size == 0:
        raise ShapeError(f"lines: expected (12, n, 3), edges of n points, got {lines.shape}")
    number(float(np.abs(lines).max()), "lines", at_most=MOST)
    low, high = lines.min(axis=(0, 1)), lines.max(axis=(0, 1))
    x, y, z = np.stack([low, high], axis=1)
    thing = box(x, y, z, _FILL)
    W = np.concatenate([outlined(thing.faces).reshape(-1, 3), point[None]])
    M = move(is_camera(camera, "camera").G, W)
    xy = np.where(M[:, 2:] > 0, M[:, :2] / np.where(M[:, 2:] > 0, M[:, 2:], 1), np.nan)
    states = [("", "the world", W), ("G", "the camera's frame", M), ("÷ z", "the plane z = 1", xy)]
    if not camera.lens.is_ideal:
        bent = camera.lens.distort(np.nan_to_num(xy, nan=_FARTHEST))
        states.append(("lens", "through the lens", bent))
    states.append(("A", "the picture", camera.project(W)))
    axes = _places(len(states) - 4)
    for ax, frame in zip(axes, (camera.G, None), strict=False):
        _draw_above(ax, camera, M if frame is None else W, frame)
    for ax, (*_, m), colour in zip(axes[2:-1], states[2:], (IDEAL, LENS), strict=False):
        _border(ax, camera, ideal=m is xy)
        if m is not xy:  # where it would be without the lens
            draw_faces(ax, xy[:-1], _SHADES, (0.8, 0.8, 0.8), lw=0)
        draw_faces(ax, m[:-1], _SHADES, _FILL, ec=colour, lw=1.2)
    w, h = camera.size
    axes[-1].imshow(_photograph(camera, thing, low, high), extent=(-0.5, w - 0.5, h - 0.5, -0.5))
    for i, (ax, (step, name, m)) in enumerate(zip(axes, states, strict=True)):
        ax.set_title(name, fontsize=FONT + 1)
        ax.axis("off")
        _follow(ax, m[-1])
        if step:
            _lead_to(ax, f"{i}. {step}", below=i == 3)
    return axes


def _places(bent: int) -> Array:
    """Make the panels: two that are high, two below each other, and one more if the lens bends."""
    grid = panels(3 + bent, 2, width=960, height=440, width_ratios=[1, 1, 1.25, 1.25][: 3 + bent])
    for k in (0, 1, 3)[: 2 + bent]:
        grid[1, k].remove()
        grid[0, k].set_subplotspec(grid[0, k].get_gridspec()[:, k])
    return np.array([*grid[0, :3], grid[1, 2], *grid[0, 3:]])


def _lead_to(ax: "Axes", step: str, below: bool) -> None:
    """Draw the arrow of a step from the panel before, on the left or above."""
    places = ((0.92, 1.24), (0.92, 1.02), (0.89, 1.13)), ((-0.2, 0.5), (-0.02, 0.5), (-0.11, 0.56))
    start, end, at = places[0 if below else 1]
    arrow(ax, start, end, MUTED, 1.8, xycoords="axes fraction", textcoords="axes fraction")
    letter(ax, step, at, "#333333", transform=ax.transAxes, ha="right" if below else "center")


def _follow(ax: "Axes", at: Array) -> None:
    """Mark the point that is followed, and write its numbers beside it, towards the middle."""
    place = at[[0, -1]]  # from above, x and z
    ax.plot(*place, "x", color=ESTIMATED, ms=9, mew=2.5, zorder=5)
    digits = 0 if len(at) == 3 else 3 if np.abs(at).max() < 10 else 1
    words = ", ".join(f"{number:.{digits}f}" for number in at).replace("-", "−")
    look = {"ha": "right", "va": "top", "path_effects": halo(), "zorder": 6}
    beside(ax, f"({words})", place, (14, -8), ESTIMATED, **look)


def outlined(corners: Array) -> Array:
    """Divide the edges of polygons (..., k, 3) into short pieces that a lens may bend."""
    edges = np.roll(corners, -1, axis=-2) - corners
    pieces = corners[..., None, :] + np.arange(16)[:, None] / 16 * edges[..., None, :]
    return np.asarray(pieces.reshape(*corners.shape[:-2], -1, corners.shape[-1]))


def draw_faces(
    ax: "Axes", m: Array, shades: tuple[float, ...], colour: Colour, *, turn: int = 1, **style: Any
) -> None:
    """Draw, of a box's outlined faces, those that nothing hides: the ones that go round one way."""
    m = np.where(np.abs(m) < _FARTHEST, m, np.nan)
    for (u, v), shade in zip(m.reshape(6, -1, 2).transpose(0, 2, 1), shades, strict=True):
        if turn * np.sum(u * np.roll(v, -1) - v * np.roll(u, -1)) > 0:
            ax.fill(u, v, fc=np.multiply(shade, colour), **style)


def _photograph(camera: Camera, thing: Scene, low: Array, high: Array) -> npt.NDArray[np.uint8]:
    """Take the box's picture, on a table of squares that are a quarter of its longest edge."""
    edge = float((high - low).max())
    sheet = low[:2] + edge * np.array([[-30, -30], [30, -30], [30, 30], [-30, 30]])
    table = quads([[*xy, high[2]] for xy in sheet], [[0, 1, 2, 3]], _TABLE, edge / 4)
    return render_scene(join(thing, table), camera, samples=16)


def _draw_above(ax: "Axes", camera: Camera, X: Array, G: Array | None) -> None:
    """Draw box and camera from above, z upwards; in the world's frame if G is given."""
    from matplotlib.patches import Polygon

    back = np.eye(4) if G is None else inverse(G)
    far = float(move(inverse(back), X)[:, 2].max())
    left, right = _sides(camera)
    cone = move(back, 9 * far * np.array([[0, 0, 0], [left, 0, 1], [right, 0, 1]]))
    if G is not None:
        _frame(ax, 1.3 * np.ptp(X[:, 0]) * _AXES, WORLD, "XZ")
    draw_faces(ax, X[:-1, [0, 2]], _SHADES, _FILL, turn=-1, ec=WORLD)
    _frame(ax, move(back, 0.22 * far * _AXES), CAMERA, "xz")
    ax.add_artist(Polygon(cone[:, [0, 2]], fc=CAMERA, alpha=0.2, zorder=0))  # not to be fitted
    ax.set_aspect("equal", adjustable="datalim")


def _sides(camera: Camera) -> Array:
    """Return x / z at the left and the right border of a picture, in the row of its (u0, v0)."""
    borders = [[-0.5, camera.A[1, 2]], [camera.size[0] - 0.5, camera.A[1, 2]]]
    return np.asarray(camera.ideal(borders)[:, 0])


def _frame(ax: "Axes", frame: Array, colour: str, letters: str) -> None:
    for tip, name in zip(frame[1:], letters, strict=True):
        arrow(ax, frame[0, [0, 2]], tip[[0, 2]], colour, 1.5, gap=2)
        out = 1.13 * tip - 0.13 * frame[0]
        ax.plot(*np.stack([frame[0], out])[:, [0, 2]].T, alpha=0)  # makes room
        letter(ax, name, out[[0, 2]], colour, fontsize=FONT - 1)


def _border(ax: "Axes", camera: Camera, ideal: bool) -> None:
    """Draw the picture's border on z = 1, before the lens or after it; y runs down."""
    corners = outlined(np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) * camera.size - 0.5)
    seen = camera.ideal(corners) if ideal else xy_from_px(camera.A, corners)
    ax.fill(*seen.T, fc=(*rgb(CAMERA), 0.12), ec=CAMERA, lw=1.2)
    ax.set_aspect("equal")
    ax.invert_yaxis()


def draw_field_of_view(cameras: Mapping[str, Camera], *, ax: "Axes | None" = None) -> "Axes":
    """Draw the course's room from above, what each camera sees of it, and the pictures below.

    Parameters
    ----------
    cameras : mapping from names to Camera
        Up to five. They stand in the origin of `room`, and look along its z axis; of the pictures,
        the middle rows are shown. Lenses are left out.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> ax = draw_field_of_view({"wide": Camera(intrinsics(320, 320, 319.5, 240))})
    >>> [text.get_text() for text in ax.texts]
    ['wide: 90.0°', 'wide']
    """
    from matplotlib.patches import Rectangle

    if not isinstance(cameras, Mapping) or not 1 <= len(cameras) <= len(_OWN):
        raise CvnotesError(f"cameras: expected one to {len(_OWN)} by name")
    ax = drawn_on(ax, height=500)
    walls = Rectangle((-_BACK, -3000), _WALL + _BACK, 6000, fc="white", ec=MUTED, lw=3)
    ax.add_patch(walls)
    for corners, colour in zip(*from_above(room(), -1500), strict=True):
        ax.fill(*corners.T[::-1], fc=colour, zorder=2)
    ax.plot([9940, 9940], [-600, 600], color="#3A6A66", lw=5, solid_capstyle="butt")  # blackboard
    across = (_WALL + _BACK) / len(cameras)
    for i, ((name, camera), own) in enumerate(zip(cameras.items(), _OWN, strict=False)):
        (left, right), (w, h) = _sides(is_camera(camera, "camera")), camera.size
        sides = _WALL * np.array([[1, left], [0, 0], [1, right]])
        ax.fill(*sides.T, fc=own, alpha=0.16)[0].set_clip_path(walls)
        ax.plot(*sides.T, color=own, lw=1.6, zorder=3)[0].set_clip_path(walls)
        arc, reach = np.linspace(np.arctan(left), np.arctan(right), 50), 1500 + 2100 * i
        ax.plot(reach * np.cos(arc), reach * np.sin(arc), color=own, lw=2)
        words = f"{name}: {np.degrees(np.ptp(arc)):.1f}°"
        beside(ax, words, (reach, 0), (8, 0), own, va="center", path_effects=halo())
        rows = Camera(camera.A, size=(w, h)).cropped((0, h // 4), (w, h // 2))
        x0, x1 = -_BACK + across * i + 60, -_BACK + across * (i + 1) - 60
        span = (x0, x1, 3300 + (x1 - x0) * (h // 2) / w, 3300)
        ax.imshow(render_scene(room(), rows, samples=16), extent=span)
        ax.add_patch(Rectangle((x0, 3300), x1 - x0, span[2] - 3300, fc="none", ec=own, lw=3))
        beside(ax, name, (x0, span[2]), (8, 8), own, path_effects=halo())
    ax.plot(0, 0, ">", color=CAMERA, ms=11)
    ax.set(xlim=(-_BACK - 100, _WALL + 100), ylim=(span[2] + 100, -3100), aspect="equal")
    ax.axis("off")
    return ax


_OWN = (CAMERA, LENS, IDEAL, WORLD, ESTIMATED)
_WALL, _BACK = 10_000, 400  # mm, from the camera to the room's far wall, and what is behind it
