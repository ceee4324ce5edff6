"""A figure of calibration: a cube on the board."""

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, DegenerateError
from cvnotes.camera import Camera
from cvnotes.camera.model import is_camera
from cvnotes.pictures.meshes import box, outlined
from cvnotes.pictures.scenes import DESK_LIGHT
from cvnotes.show.axes import pixel_axes
from cvnotes.show.guards import length, one_point

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_COLOUR = (0.96, 0.55, 0.16)  # of the side that is lit best
_EDGE = (1.0, 0.86, 0.7)
# Outwards from the top, the bottom, low and high x, low and high y.
_NORMALS = np.array([[0, 0, -1], [0, 0, 1], [-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0]])
# On a face of side 1: of an odd number the middle one, then pairs. Opposite faces make seven.
_SPOTS = np.array([[0, 0], [1, 1], [-1, -1], [1, -1], [-1, 1], [1, 0], [-1, 0]]) / 3.7
_NUMBERS = 5, 2, 3, 4, 1, 6
_ROUND = 0.09 * np.stack([f(np.linspace(0, 2 * np.pi, 33)) for f in (np.cos, np.sin)], axis=1)
_AMBIENT, _STEEP = 0.45, 0.5  # brightness without light; sine of the flattest light with a shadow


def draw_cube(
    camera: Camera,
    side: float,
    *,
    origin: npt.ArrayLike = (0, 0),
    light: npt.ArrayLike = DESK_LIGHT,
    ax: "Axes | None" = None,
) -> "Axes":
    """Draw a cube, a die, that stands on a board, with its shadow, as the camera would see it.

    Parameters
    ----------
    camera : Camera
        With the board as its WRF; its lens bends the edges.
    side : float
        Length of an edge, in the unit of the board.
    origin : array_like, shape (2,)
        Where on the board its first corner stands; the others are at larger x and y.
    light : array_like, shape (3,)
        Where the light comes from, in the board's WRF; a flat one throws no shadow.
    ax : Axes, optional
        With the photograph on it.

    Raises
    ------
    DegenerateError
        A corner has no image: it lies behind the camera, or beyond the lens.

    Notes
    -----
    The cube is convex: a face is seen from outside exactly if its picture goes round the same way
    as the face itself, and then nothing of the cube hides it. Others are not drawn. z leads into
    the board, so the cube reaches from 0 to −side.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics, look_at
    >>> camera = Camera(intrinsics(800, 800, 320, 240), look_at([200, 300, -400], [25, 25, 0]))
    >>> len(draw_cube(camera, 50.0).patches)  # three faces and the shadow
    4
    """
    from matplotlib.collections import PolyCollection
    from scipy.spatial import ConvexHull

    camera, side = is_camera(camera, "camera"), length(side, "side")
    x0, y0 = one_point(origin, "origin", 2)
    cube = box((x0, x0 + side), (y0, y0 + side), (-side, 0))
    ax = pixel_axes(ax, camera.size)
    limits = ax.get_xlim(), ax.get_ylim()
    lit = one_point(light, "light", 3)
    lit = lit / max(float(np.linalg.norm(lit)), np.finfo(float).tiny)
    if lit[2] < -_STEEP:
        foot = cube.vertices[np.isclose(cube.vertices[:, 2], 0), :2]
        floor = np.concatenate([foot, foot + side * lit[:2] / lit[2]])
        floor = floor[ConvexHull(floor).vertices]
        shadow = _outline(camera, np.column_stack([floor, np.zeros(len(floor))]))
        look: dict[str, Any] = {"color": "black", "linewidth": 0, "zorder": 2}
        ax.fill(*shadow.T, alpha=0.5, agg_filter=partial(_softened, 0.8), **look)
        under = PolyCollection([_outline(camera, cube.faces[1])], alpha=0.7, **look)
        under.set_agg_filter(partial(_softened, 4))  # light from all sides is less round a foot
        ax.add_collection(under, autolim=False)
    faces = _outline(camera, cube.faces)
    shades = _AMBIENT + 0.65 * np.maximum(_NORMALS @ lit, 0)
    sides = zip(cube.faces, faces.transpose(0, 2, 1), shades.clip(0, 1), _NUMBERS, strict=True)
    for (a, b, _, d), (u, v), shade, n in sides:
        if np.sum(u * np.roll(v, -1) - v * np.roll(u, -1)) > 0:  # nothing hides this face
            colour, edge = np.multiply.outer(shade, [_COLOUR, _EDGE])
            ax.fill(u, v, facecolor=colour, edgecolor=_EDGE, linewidth=0.6, zorder=3)
            spots = (_SPOTS[1 - n % 2 : n + 1 - n % 2, None] + _ROUND + 0.5) @ [b - a, d - a] + a
            dots = PolyCollection(list(camera.project(spots)), color=edge, linewidth=0, zorder=3)
            ax.add_collection(dots, autolim=False)
    ax.set(xlim=limits[0], ylim=limits[1])
    return ax


def _softened(reach: float, drawn: Array, dpi: float) -> tuple[Array, int, int]:
    """Blur what was drawn in black, (height, width, 4), by so many points; and where it begins."""
    from scipy.ndimage import gaussian_filter

    sigma = reach * dpi / 72
    rim = round(3 * sigma)
    wider = np.pad(drawn, ((rim, rim), (rim, rim), (0, 0)))
    wider[..., :3], wider[..., 3] = 0, gaussian_filter(wider[..., 3], sigma)
    return wider, -rim, -rim


def _outline(camera: Camera, W: Array) -> Array:
    """Picture (..., 2) of closed polygons in space, their edges in short pieces."""
    m = camera.project(outlined(W))
    if np.isnan(m).any():
        raise DegenerateError("a corner of the cube has no image: it is not before the camera")
    return m
