"""A second, slow renderer: pictures of a board made of samples, to hold `cvnotes` against.

Nothing but `Camera.ideal` and `Camera.project` is shared with the package. Only the surroundings
of the corners are drawn; the rest of the picture is grey.
"""

from functools import cache

import numpy as np
from scipy.ndimage import gaussian_filter1d

WHITE, DARK, GREY = 220.0, 30.0, 128.0
_HALF = 11  # pixels around each corner that are drawn


def picture(board, camera, blur=0.0, half=_HALF):
    """Draw the surroundings of all corners: float64 (height, width), and the corners (n, 2).

    Light is blurred first, as a lens does it, and gathered by square pixels afterwards.
    """
    m = camera.project(board.points)
    width, height = camera.size
    image = np.full((height, width), GREY)
    rim = int(np.ceil(4 * blur))
    side, n = (
        2 * (half + rim) + 1,
        max(4, round(7 / blur)) if blur else 16,
    )  # samples per pixel and direction
    fine = (np.arange(side * n) + 0.5) / n - 0.5 - half - rim
    # Samples step aside from their grid, or upright edges would snap to it.
    aside = (np.arange(side * n) * (np.sqrt(5) - 1) / 2 % 1 - 0.5) / n
    u, v = fine + aside[:, None], fine[:, None] + aside
    gather = _blurred_means(side, n, blur)
    for corner in np.rint(m):
        light = _colour(board, camera, np.stack([u, v], axis=-1) + corner)
        pixels = (gather @ light @ gather.T)[rim : side - rim, rim : side - rim]
        rows, columns = (np.arange(-half, half + 1) + int(c) for c in corner[::-1])
        image[np.ix_(rows, columns)] = pixels
    return image, m


@cache
def _blurred_means(side, n, blur):
    """What blurring and gathering along one side of the picture do: a matrix (side, side · n)."""
    light = np.eye(side * n)
    if blur:
        light = gaussian_filter1d(light, blur * n, axis=0, mode="nearest")
    return light.reshape(side, n, side * n).mean(1)


def eight_bits(image, noise=0.0, rng=None):
    noisy = image + (noise * rng.standard_normal(image.shape) if noise else 0.0)
    return noisy.round().clip(0, 255).astype(np.uint8)


def _colour(board, camera, m):
    """Colour of the board's plane where the rays of the pixels m meet it."""
    rays = np.concatenate([camera.ideal(m), np.ones((*m.shape[:-1], 1))], axis=-1)
    plane = rays @ np.linalg.inv(camera.G[:3][:, [0, 1, 3]]).T
    i, j = np.moveaxis(np.floor(plane[..., :2] / plane[..., 2:] / board.square), -1, 0)
    columns, rows = board.corners
    on_squares = (i >= -1) & (i < columns) & (j >= -1) & (j < rows)
    on_paper = (i >= -2) & (i <= columns) & (j >= -2) & (j <= rows)
    dark = on_squares & ((i + j) % 2 == 0)
    return np.where(dark, DARK, np.where(on_paper, WHITE, GREY))
