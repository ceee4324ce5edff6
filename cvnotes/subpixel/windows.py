"""Where the edges around a corner run to begin with, and which pixels to look at."""

import numpy as np

from cvnotes.errors import Array, DegenerateError, ShapeError, image_size
from cvnotes.interpolate import Image
from cvnotes.subpixel.model import PARAMETERS, Window
from cvnotes.subpixel.patches import patch_gradients, patches

# How far a window reaches towards the neighbouring corner, and beyond the outermost corners, as
# fractions of a square; what comes after those (narrow squares, paper, stray light) is unknown.
_TOWARDS_NEIGHBOUR, _BEYOND_BOARD = 0.7, 0.1
_BEYOND_PX, _BEYOND_BLUR = 2.0, 1.5  # but at least so many pixels, and widths of the blur


def board_axes(m: Array, grid: tuple[int, int], blur: float = 0.0) -> tuple[Array, Array]:
    """Give each corner's two steps to the next ones (n, 2, 2), and its reach (n, 2, 2) in them.

    Of the reach, the last index is that of backward and forward.
    """
    columns, rows = image_size(grid, "grid")
    if len(m) != columns * rows or min(columns, rows) < 2:
        raise ShapeError(f"grid: {columns}×{rows} corners cannot be {len(m)} points")
    lattice = m.reshape(rows, columns, 2)
    axes = np.stack([np.gradient(lattice, axis=1), np.gradient(lattice, axis=0)], axis=-2)
    area, sides = np.abs(_cross(axes[..., 0, :], axes[..., 1, :])), np.linalg.norm(axes, axis=-1)
    if not (area > 0.01 * sides.prod(-1)).all():
        raise DegenerateError(
            f"m: neighbours on the {columns}×{rows} grid lie on a line; are the corners row by row?"
        )
    height = area[..., None] / sides[..., ::-1]
    outside = max(_BEYOND_PX, _BEYOND_BLUR * blur) / height
    beyond = outside.clip(_BEYOND_BOARD, _TOWARDS_NEIGHBOUR)
    reach = np.full((rows, columns, 2, 2), _TOWARDS_NEIGHBOUR)
    reach[:, 0, 0, 0], reach[:, -1, 0, 1] = beyond[:, 0, 0], beyond[:, -1, 0]
    reach[0, :, 1, 0], reach[-1, :, 1, 1] = beyond[0, :, 1], beyond[-1, :, 1]
    return axes.reshape(-1, 2, 2), reach.reshape(-1, 2, 2)


def gradient_axes(grey: Image, m: Array, half: int) -> Array:
    """Give the directions of the two edges (n, 2, 2) that the gradients around m show.

    Gradients point across one edge or the other, so that (t1ᵀ g)(t2ᵀ g) = gᵀ Q g is 0 for all of
    them. The three coefficients of Q are the null vector of the sum of fourth powers of g.
    """
    _, _, g_u, g_v = patch_gradients(grey, m, half)
    powers = np.stack([g_u * g_u, g_u * g_v, g_v * g_v], axis=1)
    a, b, c = np.linalg.eigh(powers @ powers.mT)[1][:, :, 0].T
    values, vectors = np.linalg.eigh(np.stack([2 * a, b, b, 2 * c], -1).reshape(-1, 2, 2))
    # λ2 (e2ᵀ g)² − |λ1| (e1ᵀ g)² is the product of a sum and a difference.
    e1, e2 = (np.sqrt(np.abs(values))[:, None] * vectors).transpose(2, 0, 1)
    axes = np.stack([e2 + e1, e2 - e1], axis=1)
    axes /= np.maximum(np.linalg.norm(axes, axis=-1, keepdims=True), 1e-300)
    axes[np.abs(_cross(axes[:, 0], axes[:, 1])) < 0.1] = np.eye(2)  # there are no two edges
    return np.asarray(axes)


def cut_out(
    grey: Image, m: Array, half: int, axes: Array, reach: Array | None
) -> tuple[Array, Window]:
    """Cut windows out around the pixels next to m, which are given too."""
    u, v, pixels, counts = patches(grey, m, half)
    if reach is not None:
        q = np.stack([u - m[:, :1], v - m[:, 1:]], axis=1)
        along = np.linalg.inv(axes).mT @ q  # in steps to the neighbours
        counts &= ((along >= -reach[..., :1]) & (along <= reach[..., 1:])).all(1)
    y, x = np.indices((2 * half + 1, 2 * half + 1)).reshape(2, -1) - half
    single = [z.astype(np.float32) for z in (np.stack([x, y, np.ones_like(x)]), pixels, counts)]
    return np.rint(m), Window(*single)


def sharp_crossing(offset: Array, axes: Array, window: Window) -> Array:
    """Give parameters to start from: the crossing of both axes, with a blur of 0.7 px."""
    p = np.zeros((len(offset), PARAMETERS))
    across = normals(axes)
    p[:, 0:2], p[:, 3:5] = across[:, 0], across[:, 1]
    p[:, [2, 5]] = -(across @ offset[:, :, None])[..., 0]
    quadrant = np.sign((p[:, 0:3] @ window.place) * (p[:, 3:6] @ window.place)) * window.weight
    count = np.maximum(window.weight.sum(-1), 1)
    p[:, 7] = (window.weight * window.grey).sum(-1) / count
    p[:, 6] = (quadrant * (window.grey - p[:, 7:8])).sum(-1) / count
    return p


def normals(axes: Array) -> Array:
    """Give unit normals (n, 2, 2) of both edges that point into the quadrant between the axes."""
    across = np.stack([-axes[..., 1], axes[..., 0]], axis=-1) * [[1.0], [-1.0]]
    turned = np.where(_cross(axes[:, 0], axes[:, 1]) < 0, -1.0, 1.0)[:, None, None]
    return np.asarray(turned * across / np.linalg.norm(across, axis=-1, keepdims=True))


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
