"""Sets of views of a board: good ones, some that face the camera, and what they are made of."""

from contextlib import suppress

import numpy as np

from cvnotes.base import Array, CvnotesError, DegenerateError, generator, numbers, whole
from cvnotes.camera import Camera, move, rotation_from_vector
from cvnotes.pictures.faces import Target
from cvnotes.pictures.placing import (
    every_face_seen,
    facing,
    hold_at,
    pushed_into_corner,
    target_and_camera,
)

TILT = (float(np.radians(20)), float(np.radians(45)))


def guard(target: Target, camera: Camera, n: int, rng: np.random.Generator) -> int:
    """Refuse what no set of views can be made of; return n."""
    target_and_camera(target, camera)
    generator(rng)
    return whole(n, "n")


def turned(towards: Array, angle: Array, rng: np.random.Generator) -> Array:
    """Rotations (n, 3, 3) of a board that rolls a little and tilts towards a picture direction."""
    axis = np.stack([-np.sin(towards), np.cos(towards), np.zeros_like(towards)], axis=-1)
    roll = rng.uniform(-1, 1, (len(towards), 1)) * np.radians([0.0, 0.0, 15.0])
    return np.asarray(
        rotation_from_vector.inside(angle[:, None] * axis) @ rotation_from_vector.inside(roll)
    )


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


def good_views(
    target: Target,
    camera: Camera,
    n: int,
    *,
    rng: np.random.Generator,
    tilt: tuple[float, float] = TILT,
) -> Array:
    """Hold a target as one should: tilted to all sides, all over the picture, large.

    Parameters
    ----------
    target : Target
        What is held; anything with ``faces``, none of which turns away.
    camera : Camera
        Who looks; its own pose does not matter.
    n : int
        How many views. Three suffice for a calibration, ten or more make a good one.
    rng : numpy.random.Generator
        Where the poses come from.
    tilt : (least, most)
        Angle in radians by which the target turns away from facing the camera.

    Returns
    -------
    ndarray, shape (n, 4, 4)
        Poses G of the target.

    Raises
    ------
    DegenerateError
        The target cannot be seen whole like this.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> from cvnotes.targets import Chessboard
    >>> camera = Camera(intrinsics(800, 804, 325, 238))
    >>> G = good_views(Chessboard((9, 6), 25.0), camera, 10, rng=np.random.default_rng(1))
    >>> tilts = np.degrees(np.arccos(G[:, 2, 2]))
    >>> bool((tilts > 20).all() and (tilts < 45).all())
    True
    """
    n = guard(target, camera, n, rng)
    angles = numbers(tilt, "tilt")
    if angles.shape != (2,) or not 0 <= angles[0] <= angles[1] < np.pi / 2:
        raise CvnotesError(
            f"tilt: expected (least, most) in radians, between 0 and π/2, got {angles.tolist()}"
        )
    least, most = angles.tolist()
    views = []
    for towards, aim in zip(all_sides(n, rng), all_over(camera, n, rng), strict=True):
        for _ in range(100):
            R = turned(np.array([towards]), rng.uniform(least, most, 1), rng)[0] @ facing(target)
            G = hold_at(target, camera, R, aim, rng.uniform(1.0, 1.3))
            if every_face_seen(target, G):
                break
            towards = rng.uniform(0, 2 * np.pi)
        else:
            raise DegenerateError("tilted like this, a face of the target is hidden; tilt it less")
        views.append(G)
    return np.stack(views)


def covering_views(
    target: Target,
    camera: Camera,
    n: int,
    *,
    rng: np.random.Generator,
    tilt: tuple[float, float] = TILT,
) -> Array:
    """Hold a target as in `good_views`, but four times in the corners of the picture.

    A lens bends most in the corners of the picture, and what no board has shown there is only
    guessed; on the other hand, boards in a corner are smaller.

    Parameters
    ----------
    target, camera, n, rng, tilt
        As in `good_views`; n is at least 4.

    Returns
    -------
    ndarray, shape (n, 4, 4)
        Poses G of the target, those in the corners first.

    Raises
    ------
    DegenerateError
        The target cannot be seen whole like this, or not in a corner.

    Examples
    --------
    >>> from cvnotes.calibration.coverage import covered_cells
    >>> from cvnotes.camera import intrinsics
    >>> from cvnotes.targets import Chessboard
    >>> camera, board = Camera(intrinsics(800, 804, 325, 238)), Chessboard((9, 6), 25.0)
    >>> G = covering_views(board, camera, 10, rng=np.random.default_rng(1))
    >>> seen = covered_cells([camera.moved(G_i).project(board.points) for G_i in G], camera.size)
    >>> seen[[0, -1]][:, [0, -1]].all()
    np.True_
    """
    views = good_views(target, camera, n, rng=rng, tilt=tilt)
    if n < len(_CORNERS):
        raise CvnotesError(f"n: there are four corners to be reached, so at least 4, got {n}")
    for i, towards in enumerate(all_sides(len(_CORNERS), rng)):
        views[i] = _in_corner(target, camera, _CORNERS[i], towards, tilt, rng)
    return views


_CORNERS = ((-1, -1), (1, -1), (-1, 1), (1, 1))
_NEAR = 1 / 9  # of the picture's longer side, from its corner to the nearest one of the board
_TRIES = 60


def _in_corner(
    target: Target,
    camera: Camera,
    corner: tuple[int, int],
    towards: float,
    tilt: tuple[float, float],
    rng: np.random.Generator,
) -> Array:
    """Hold a target in a corner of the picture, so that corners of its board come close to it."""
    half = (np.array(camera.size) - 1) / 2
    W = np.concatenate([move(G, board.points) for G, board in target.faces])
    best, nearest = None, np.inf
    for _ in range(_TRIES):
        R = turned(np.array([towards]), rng.uniform(*tilt, 1), rng)[0] @ facing(target)
        with suppress(DegenerateError):
            G = hold_at(target, camera, R, half, rng.uniform(1.3, 1.9))
            G = pushed_into_corner(target, camera, G, corner)
            m = camera.moved(G).project(W)
            apart = float(np.abs(m - half - half * corner).max(axis=1).min())
            if apart < nearest and every_face_seen(target, G):
                best, nearest = G, apart
        if nearest < _NEAR * max(camera.size):
            break
        towards = rng.uniform(0, 2 * np.pi)
    if best is None:
        raise DegenerateError("the target cannot be held whole in a corner of the picture")
    return best


def fronto_parallel_views(
    target: Target, camera: Camera, n: int, *, rng: np.random.Generator
) -> Array:
    """Hold the board parallel to the sensor in every view: the focal length stays unknown.

    Nothing in such a picture gets smaller with depth. A camera twice as long takes the same
    pictures from twice as far away, and every view repeats the two constraints of the first.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> from cvnotes.targets import Chessboard
    >>> camera = Camera(intrinsics(800, 804, 325, 238))
    >>> G = fronto_parallel_views(Chessboard((9, 6)), camera, 3, rng=np.random.default_rng(1))
    >>> G[:, 2, 2]
    array([1., 1., 1.])
    """
    n = guard(target, camera, n, rng)
    R = turned(np.zeros(n), np.zeros(n), rng) @ facing(target)
    aims, far = all_over(camera, n, rng), rng.uniform(1.0, 1.3, n)
    return np.stack([hold_at(target, camera, *given) for given in zip(R, aims, far, strict=True)])
