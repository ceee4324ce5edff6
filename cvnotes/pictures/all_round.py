"""Scenes through a fisheye, whose rays the plane z = 1 does not hold: by way of a cube around it.

Six pinhole cameras at one spot, one for each side of a cube, see every ray there is. A pixel of
the fisheye's picture is looked up in the picture of the side that its ray passes through.
"""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics, pose, rotation_from_vector
from cvnotes.pictures.antialiasing import pixel_centres, within_pixel
from cvnotes.warping import interpolate

Pixels = npt.NDArray[np.intp]

# Forward, right, back, left, down and up: how the camera turns to look there.
_SIDES = (
    np.pi / 2 * np.array([[0, 0, 0], [0, -1, 0], [0, 2, 0], [0, 1, 0], [1, 0, 0], [-1, 0, 0.0]])
)
_FINER = 1.5  # pixels of a side for each of the fisheye, in its middle
_RAYS = 4  # through each pixel of the fisheye
_MARGIN = 2  # pixels of a side around those that are looked up


def through_a_cube(camera: Camera, radiance: Callable[[Camera], Array]) -> Array:
    """Return the light (height, width, 3) on the pixels of any camera, the rays' sides joined.

    Parameters
    ----------
    camera : Camera
        Of any lens. Pixels that its lens model does not reach are black.
    radiance : callable
        Takes a pinhole camera, gives the light on its pixels.

    Examples
    --------
    >>> from cvnotes.camera import FisheyeLens
    >>> camera = Camera(intrinsics(8, 8, 15.5, 15.5), lens=FisheyeLens(), size=(32, 32))
    >>> through_a_cube(camera, lambda side: np.full((*side.size, 3), 7.0))[16, 16]
    array([7., 7., 7.])
    """
    half = int(np.ceil(_FINER * max(camera.A[0, 0], camera.A[1, 1])))
    turns = rotation_from_vector(_SIDES)
    light = np.zeros((camera.size[1] * camera.size[0], 3))
    for turn, (pixels, xy) in zip(turns, _looked_up(camera, turns), strict=True):
        if len(pixels):
            m = half * xy + half + 0.5  # a side is 90° wide, and a pixel wider on each border
            corner = np.maximum(np.floor(m.min(axis=0)) - _MARGIN, 0)
            end = np.minimum(np.ceil(m.max(axis=0)) + _MARGIN, 2 * half + 1)
            w, h = (end - corner).astype(int) + 1
            pinhole = intrinsics(half, half, *(half + 0.5 - corner))
            side = Camera(pinhole, pose(turn, np.zeros(3)) @ camera.G, size=(int(w), int(h)))
            seen = interpolate(radiance(side), m - corner) / _RAYS
            for c in range(3):
                light[:, c] += np.bincount(pixels, seen[:, c], len(light))
    return light.reshape(camera.size[1], camera.size[0], 3)


def _looked_up(camera: Camera, turns: Array) -> list[tuple[Pixels, Array]]:
    """Return for each side the pixels whose rays pass through it, and where, on its plane z = 1."""
    found: list[list[tuple[Pixels, Array]]] = [[] for _ in turns]
    for offset in within_pixel(_RAYS):
        d = camera.ray(pixel_centres(camera.size) + offset) @ camera.R.T
        ahead = d @ turns[:, 2].T  # of each side, how far along its axis
        nearest = np.where(np.isnan(ahead[..., 0]), -1, np.argmax(ahead, axis=-1))
        for i, turn in enumerate(turns):
            pixels = np.flatnonzero(nearest == i)
            x, y, z = np.moveaxis(d.reshape(-1, 3)[pixels] @ turn.T, -1, 0)
            found[i].append((pixels, np.stack([x / z, y / z], axis=-1)))
    sides = (zip(*parts, strict=True) for parts in found)
    return [(np.concatenate(pixels), np.concatenate(xy)) for pixels, xy in sides]
