"""Sets of views that look reasonable and leave the camera open, each for a reason of its own."""

import numpy as np

from cvnotes.camera import Camera
from cvnotes.errors import Array
from cvnotes.faces import Target
from cvnotes.placing import facing, hold_at
from cvnotes.rigid import exp_so3
from cvnotes.views.good import good_views
from cvnotes.views.turns import TILT, all_sides, guard, one_tilt, spread, turned


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
    guard(target, camera, n, rng)
    return spread(target, camera, turned(np.zeros(n), np.zeros(n), rng), rng)


def pure_translation_views(
    target: Target, camera: Camera, n: int, *, rng: np.random.Generator
) -> Array:
    """Move a tilted board without turning it: n views say no more than one.

    Parallel planes have the same vanishing line, and the two constraints that a view puts on the
    intrinsics depend on nothing else: every view repeats those of the first. (A strong distortion
    may hide this from the refinement, for it gives the piercing point away.)

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> from cvnotes.targets import Chessboard
    >>> camera = Camera(intrinsics(800, 804, 325, 238))
    >>> G = pure_translation_views(Chessboard((9, 6)), camera, 3, rng=np.random.default_rng(1))
    >>> bool((G[:, :3, :3] == G[0, :3, :3]).all())
    True
    """
    guard(target, camera, n, rng)
    return spread(target, camera, np.repeat(one_tilt(rng), n, axis=0), rng)


def nearly_parallel_views(
    target: Target, camera: Camera, n: int, *, rng: np.random.Generator
) -> Array:
    """Turn a tilted board by hardly a degree between views: noise decides the answer.

    The equations do have a solution, for no two vanishing lines agree; but the differences between
    them are of the size of the noise in the corners, and so is what is concluded from them.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> from cvnotes.targets import Chessboard
    >>> camera = Camera(intrinsics(800, 804, 325, 238))
    >>> G = nearly_parallel_views(Chessboard((9, 6)), camera, 3, rng=np.random.default_rng(1))
    >>> bool((np.degrees(np.arccos(G[1:, :3, 2] @ G[0, :3, 2])) < 5).all())
    True
    """
    guard(target, camera, n, rng)
    wobble = exp_so3(rng.normal(0, np.radians(1), (n, 3)))
    return spread(target, camera, wobble @ one_tilt(rng), rng)


def one_axis_views(target: Target, camera: Camera, n: int, *, rng: np.random.Generator) -> Array:
    """Tilt the board forwards and backwards only, by about 30°: α_u and α_v run away together.

    With the board's x axis always along u, a tilt by θ gives one relation between α_u and α_v, and
    a tilt by −θ gives the same one again. The normals differ by 60° and still it is not enough:
    the board must be tilted about different axes.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> from cvnotes.targets import Chessboard
    >>> camera = Camera(intrinsics(800, 804, 325, 238))
    >>> G = one_axis_views(Chessboard((9, 6)), camera, 3, rng=np.random.default_rng(1))
    >>> G[:, 0, 0]  # x stays along u
    array([1., 1., 1.])
    """
    guard(target, camera, n, rng)
    angle = np.where(np.arange(n) % 2, 1, -1) * np.radians(rng.uniform(28, 32, n))
    return spread(target, camera, exp_so3(angle[:, None] * [1.0, 0.0, 0.0]), rng)


def centre_only_views(target: Target, camera: Camera, n: int, *, rng: np.random.Generator) -> Array:
    """Keep a small board in the middle of the picture: the lens is seen where it does nothing.

    Distortion grows with the cube of the distance from the centre. What is estimated from the
    middle of the picture says little about k1 and nothing about k2, and is wrong at the borders,
    where it is then used.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> from cvnotes.targets import Chessboard
    >>> camera = Camera(intrinsics(800, 804, 325, 238))
    >>> G = centre_only_views(Chessboard((9, 6)), camera, 3, rng=np.random.default_rng(1))
    >>> camera.moved(G[0]).project([100, 62.5, 0]).round()  # the middle of the board
    array([320., 240.])
    """
    guard(target, camera, n, rng)
    R = turned(all_sides(n, rng), rng.uniform(*TILT, n), rng) @ facing(target)
    middle = (np.array(camera.size) - 1) / 2
    return np.stack([hold_at(target, camera, R_i, middle, rng.uniform(2.0, 2.5)) for R_i in R])


def repeated_views(
    target: Target, camera: Camera, n: int, *, rng: np.random.Generator, distinct: int = 2
) -> Array:
    """Photograph `distinct` good views over and over: counting pictures is not counting views.

    A copy adds no equation. With two views among three the general camera stays undetermined,
    however many pictures there are; with noise, the residuals do not tell.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> from cvnotes.targets import Chessboard
    >>> camera = Camera(intrinsics(800, 804, 325, 238))
    >>> G = repeated_views(Chessboard((9, 6)), camera, 3, rng=np.random.default_rng(1))
    >>> bool((G[2] == G[0]).all()), bool((G[1] == G[0]).all())
    (True, False)
    """
    guard(target, camera, n, rng)
    return good_views(target, camera, distinct, rng=rng)[np.arange(n) % distinct]
