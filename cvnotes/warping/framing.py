"""Ideal cameras that show a part of what others do: all of it, or as much as leaves no border."""

from collections.abc import Sequence

import numpy as np

from cvnotes.base import Array, DegenerateError
from cvnotes.camera import Camera, intrinsics

# Smallest z of unit rays that an ideal camera is made to see: 70° from where it looks, where a
# flat picture is stretched to eight times its size in the middle.
_SIDEWAYS = np.cos(np.deg2rad(70))


def ideal_camera(
    camera: Camera,
    *,
    zoom: float = 1.0,
    size: tuple[int, int] | None = None,
    keep_all: bool = False,
) -> Camera:
    """Return the camera without its lens, as a picture without distortion is to be seen.

    Parameters
    ----------
    camera : Camera
        The camera that took the picture.
    zoom : float
        How much larger things are shown; below 1 more is seen.
    size : (width, height), optional
        Of the new picture, by default that of the old one, which it holds.
    keep_all : bool
        Begin with all that the photograph shows, in square pixels, not with the camera's own A.

    Examples
    --------
    >>> from cvnotes.camera import Lens
    >>> camera = Camera(intrinsics(800, 800, 319.5, 239.5), lens=Lens(k=(-0.2,)), size=(640, 480))
    >>> ideal_camera(camera, zoom=0.5, size=(1280, 960)).A[0]
    array([800. ,   0. , 639.5])
    >>> ideal_camera(camera, keep_all=True).A[0].round(1)
    array([755.3,   0. , 319.5])
    """
    size = camera.size if size is None else size
    middle, A, scale = (np.array(size) - 1) / 2, camera.A, zoom
    if keep_all:
        A, before = framing([border(camera, np.eye(3))], size, full=False), middle
    else:
        before = (np.array(camera.size) - 1) / 2
        scale *= min(n / own for n, own in zip(size, camera.size, strict=True))
    S = np.diag([scale, scale, 1.0])
    S[:2, 2] = middle - scale * before
    return Camera(S @ A, size=size)


def border(camera: Camera, R: Array) -> list[Array]:
    """Return the picture's left, right, top and bottom pixels on the plane z = 1, turned by R.

    What the lens does not reach, or looks too far to the side, is moved inwards until it does not.
    """
    w, h = camera.size
    u, v = np.arange(w, dtype=float), np.arange(h, dtype=float)
    edge = np.concatenate(
        [
            np.column_stack([np.zeros(h), v]),
            np.column_stack([np.full(h, w - 1.0), v]),
            np.column_stack([u, np.zeros(w)]),
            np.column_stack([u, np.full(w, h - 1.0)]),
        ]
    )

    def seen(m: Array) -> Array:
        xyz = camera.ray(m) @ (R @ camera.R).T
        return np.asarray(np.where(xyz[:, 2:] >= _SIDEWAYS, xyz[:, :2] / xyz[:, 2:], np.nan))

    centre = camera.A[:2, 2] + camera.A[:2, :2] @ camera.lens.centre
    xy = seen(edge)
    lost = np.isnan(xy).any(-1)
    inside, outside = np.zeros((lost.sum(), 1)), np.ones((lost.sum(), 1))
    for _ in range(30 if lost.any() else 0):
        middle = (inside + outside) / 2
        reached = np.isfinite(seen(centre + middle * (edge[lost] - centre)))[:, :1]
        inside, outside = np.where(reached, middle, inside), np.where(reached, outside, middle)
    xy[lost] = seen(centre + inside * (edge[lost] - centre))
    return np.split(xy, np.cumsum([h, h, w]))


def framing(borders: Sequence[list[Array]], size: tuple[int, int], *, full: bool) -> Array:
    """Choose α and (u0, v0) such that one picture of `size` holds others, given by their borders.

    Either all of them, or if it is to be `full`, what all of them show.
    """
    inner, outer = (np.max, np.min), (np.min, np.max)
    low_of, high_of = inner if full else outer
    low, high = np.empty(2), np.empty(2)
    for axis in range(2):
        low[axis] = low_of([low_of(each[2 * axis][:, axis]) for each in borders])
        high[axis] = high_of([high_of(each[2 * axis + 1][:, axis]) for each in borders])
    if not (low < high).all():
        raise DegenerateError(
            "the rectified pictures have no common full part, the cameras are turned too far from "
            "each other; try keep='all'"
        )
    steps = np.array(size) - 1.0  # from the first pixel centre to the last
    scales = steps / (high - low)
    # A few thousandths of a pixel closer: the border was looked at in whole pixels only.
    alpha = max(scales) * (1 + 1e-5) if full else min(scales) * (1 - 1e-5)
    u0, v0 = steps / 2 - alpha * (low + high) / 2
    return intrinsics(alpha, alpha, u0, v0)
