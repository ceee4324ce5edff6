"""Scenes through a fisheye, whose rays the plane z = 1 does not hold: by way of a cube around it.

Six pinhole cameras at one spot, one for each side of a cube, see every ray there is. A pixel of
the fisheye's picture is looked up in the picture of the side that its ray passes through.
"""

from collections.abc import Callable

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics, pose, rotation_from_vector
from cvnotes.pictures.antialiasing import pixel_centres, within_pixel
from cvnotes.warping import interpolate

# Forward, right, back, left, down and up: how the camera turns to look there.
_SIDES = (
    np.pi / 2 * np.array([[0, 0, 0], [0, -1, 0], [0, 2, 0], [0, 1, 0], [1, 0, 0], [-1, 0, 0.0]])
)
_FINER = 1.5  # pixels of a side for each of the fisheye, in its middle
_RAYS = 4  # through each pixel of the fisheye


def through_a_cube(camera: Camera, radiance: Callable[[Camera], Array]) -> Array:
    """Give the light (height, width, 3) on the pixels of any camera, the rays' sides joined.

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
    middle = half + 0.5  # a side is 90° wide, and a pixel wider on each border
    pinhole = intrinsics(half, half, middle, middle)
    size = (2 * half + 2, 2 * half + 2)
    turns = rotation_from_vector(_SIDES)
    sides = [Camera(pinhole, pose(turn, np.zeros(3)) @ camera.G, size=size) for turn in turns]
    pictures: dict[int, Array] = {}
    light = np.zeros((camera.size[1], camera.size[0], 3))
    for offset in within_pixel(_RAYS):
        d = camera.ray(pixel_centres(camera.size) + offset) @ camera.R.T
        ahead = d @ turns[:, 2].T  # of each side, how far along its axis
        nearest = np.where(np.isnan(ahead[..., 0]), -1, np.argmax(ahead, axis=-1))
        for i in np.unique(nearest[nearest >= 0]):
            if i not in pictures:
                pictures[i] = radiance(sides[i])
            here = nearest == i
            x, y, z = turns[i] @ d[here].T
            m = middle + half * np.stack([x, y], axis=-1) / z[:, None]
            light[here] += interpolate(pictures[i], m) / _RAYS
    return light
