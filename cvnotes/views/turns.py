"""Random turns, directions and places, from which sets of views are made."""

import numpy as np

from cvnotes.camera import Camera
from cvnotes.errors import Array, CvnotesError, InputTypeError
from cvnotes.faces import Target
from cvnotes.placing import facing, hold_at
from cvnotes.rigid import exp_so3

TILT = (float(np.radians(20)), float(np.radians(45)))


def guard(target: Target, camera: Camera, n: int, rng: np.random.Generator) -> None:
    """Refuse what no set of views can be made of."""
    if not hasattr(target, "faces"):
        raise InputTypeError(
            f"target: expected a Chessboard or the like, got {type(target).__name__}"
        )
    if not isinstance(camera, Camera):
        raise InputTypeError(f"camera: expected a Camera, got {type(camera).__name__}")
    if not isinstance(rng, np.random.Generator):
        raise InputTypeError(f"rng: expected a numpy.random.Generator, got {type(rng).__name__}")
    if isinstance(n, bool) or not isinstance(n, int | np.integer) or n < 1:
        raise CvnotesError(f"n: expected a number of views, at least 1, got {n!r}")


def turned(towards: Array, angle: Array, rng: np.random.Generator) -> Array:
    """Rotations (n, 3, 3) of a board that rolls a little and tilts towards a picture direction."""
    axis = np.stack([-np.sin(towards), np.cos(towards), np.zeros_like(towards)], axis=-1)
    roll = rng.uniform(-1, 1, (len(towards), 1)) * np.radians([0.0, 0.0, 15.0])
    return np.asarray(exp_so3(angle[:, None] * axis) @ exp_so3(roll))


def one_tilt(rng: np.random.Generator) -> Array:
    """One rotation (1, 3, 3) by 30° towards any direction."""
    return turned(rng.uniform(0, 2 * np.pi, 1), np.radians([30.0]), rng)


def all_sides(n: int, rng: np.random.Generator) -> Array:
    """Directions (n,) in the picture, one in each n-th of the circle, shuffled."""
    return np.asarray(2 * np.pi * (rng.permutation(n) + rng.random(n)) / n)


def all_over(camera: Camera, n: int, rng: np.random.Generator) -> Array:
    """Pixels (n, 2) in turn in all of 3 × 3 cells around the middle, shuffled.

    Boards reach farther out than their middles: the cells fill two fifths of either side.
    """
    cell = rng.permutation(np.arange(n) % 9)
    place = (np.stack([cell % 3, cell // 3], axis=-1) + rng.random((n, 2))) / 3 - 0.5
    return np.array(camera.size) * (0.5 + 0.4 * place) - 0.5


def spread(target: Target, camera: Camera, R: Array, rng: np.random.Generator) -> Array:
    """Hold a target in each of the rotations (n, 3, 3), all over the picture."""
    R, aims = R @ facing(target), all_over(camera, len(R), rng)
    far = rng.uniform(1.0, 1.3, len(R))
    return np.stack([hold_at(target, camera, *given) for given in zip(R, aims, far, strict=True)])
