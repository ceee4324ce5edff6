"""Figures of calibration: the picture of J, a cube on the board."""

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, DegenerateError, ShapeError, numbers
from cvnotes.camera import Camera
from cvnotes.camera.model import is_camera
from cvnotes.pictures.meshes import box, outlined
from cvnotes.pictures.scenes import DESK_LIGHT
from cvnotes.show.axes import beside, panels, pixel_axes
from cvnotes.show.guards import count, length, one_point
from cvnotes.show.style import FONT, MUTED

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_COLOUR = (0.96, 0.55, 0.16)  # of the side that is lit best
_EDGE = (1.0, 0.86, 0.7)
# Outwards from the top, the bottom, low and high x, low and high y.
_NORMALS = np.array([[0, 0, -1], [0, 0, 1], [-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0]])
_AMBIENT, _STEEP = 0.45, 0.5  # brightness without light; sine of the flattest light with a shadow


def draw_arrow(J: npt.ArrayLike, shared: int) -> Any:
    """Draw the Jacobian of a calibration, JᵀJ, which has the shape of an arrow, and what remains.

    What remains of the camera's corner of JᵀJ, when the poses have taken all that they can imitate,
    is the Schur complement.

    Parameters
    ----------
    J : array_like, shape (n, shared + 6 n_views)
        One row for each measured coordinate, one column for each unknown; the shared ones first.
    shared : int
        How many columns belong to the camera, which all views share.

    Returns
    -------
    ndarray of three Axes
        J, JᵀJ and what remains, each column of J scaled to length 1; darker is larger. Beside
        each row of what remains is the length of its column that no pose can imitate.

    Examples
    --------
    >>> J = np.zeros((8, 14))
    >>> J[:, :2] = J[:4, 2:8] = J[4:, 8:] = 1
    >>> [ax.get_title() for ax in draw_arrow(J, 2)]
    ['J: 8 rows, 14 columns', 'JᵀJ: 14 × 14', 'remains: 2 × 2']
    """
    J, shared = numbers(J, "J"), count(shared, "shared")
    if J.ndim != 2 or len(J) == 0 or J.shape[1] <= shared or (J.shape[1] - shared) % 6:
        raise ShapeError(f"J: expected (n, {shared} + 6 n_views), got {J.shape}")
    lengths = np.linalg.norm(J, axis=0)
    J = J / np.where(lengths > 0, lengths, 1)
    left, right, rest = axes = panels(3, width=980, height=400, width_ratios=(1, 1, 0.36))
    rows, columns = J.shape
    left.imshow(_dark(J), cmap="Blues", vmin=0, vmax=1, aspect="auto", interpolation="nearest")
    right.imshow(_dark(J.T @ J), cmap="Blues", vmin=0, vmax=1, interpolation="nearest")
    left.set_title(f"J: {rows} rows, {columns} columns", pad=18)
    right.set_title(f"JᵀJ: {columns} × {columns}", pad=18)
    _draw_remaining(rest, J[:, :shared], J[:, shared:])
    for ax in (left, right):
        ax.set(xticks=[], xlabel="unknowns")
        for first, last, name, side in (
            (0, shared, "camera", "left"),
            (shared, columns, "poses", "center"),
        ):
            at = {"xycoords": ("data", "axes fraction"), "ha": side, "fontsize": FONT - 1}
            u = first - 0.5 if side == "left" else (first + last) / 2
            beside(ax, name, (u, 1), (0, 6), MUTED, **at)
            span, over = [first - 0.2, last - 0.8], ax.get_xaxis_transform()
            ax.plot(span, [1.01, 1.01], color=MUTED, lw=0.8, transform=over, clip_on=False)
        ax.axvline(shared - 0.5, color=MUTED, linewidth=0.8)
    right.axhline(shared - 0.5, color=MUTED, linewidth=0.8)
    right.set(yticks=[])
    left.set_ylabel("measured coordinates, view after view")
    return axes


def _draw_remaining(ax: "Axes", J_c: Array, J_p: Array) -> None:
    """Draw NᵀN, where N is of the camera's columns what no columns of a pose can imitate."""
    N = J_c - J_p @ np.linalg.lstsq(J_p, J_c, rcond=None)[0]
    size = N.shape[1]
    ax.imshow(_dark(N.T @ N, 1), cmap="Blues", vmin=0, vmax=1, interpolation="nearest", aspect=1)
    ax.set(xticks=[], yticks=[], anchor="N", xlabel="what no pose\ncan imitate")
    ax.set_title(f"remains: {size} × {size}", pad=18)
    for row, left in enumerate(np.linalg.norm(N, axis=0)):
        at = {"xycoords": "data", "ha": "left", "va": "center", "fontsize": FONT - 1}
        beside(ax, f"{100 * left:.2g} %", (size - 0.5, row), (5, 0), MUTED, **at)


def _dark(x: Array, largest: float = 0) -> Array:
    """Shades from 0 to 1 in which small numbers can be told from none."""
    largest = largest or float(np.abs(x).max())
    return np.asarray((np.abs(x) / largest) ** 0.35 if largest else np.abs(x))


def draw_cube(
    camera: Camera,
    side: float,
    *,
    origin: npt.ArrayLike = (0, 0),
    light: npt.ArrayLike = DESK_LIGHT,
    ax: "Axes | None" = None,
) -> "Axes":
    """Draw a cube that stands on a board, with its shadow, as the camera would photograph it.

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
    for (u, v), shade in zip(faces.transpose(0, 2, 1), shades.clip(0, 1), strict=True):
        if np.sum(u * np.roll(v, -1) - v * np.roll(u, -1)) > 0:  # nothing hides this face
            colour = np.multiply(shade, _COLOUR)
            ax.fill(u, v, facecolor=colour, edgecolor=_EDGE, linewidth=0.6, zorder=3)
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
