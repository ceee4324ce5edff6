"""Random known cameras, boards and points that the exercises are tried on.

Numbers are rounded where that is possible, so that a counterexample can be read and copied.
"""

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.camera import intrinsics, pose, rotation_from_vector

# A rotation about y, and one about x, whose entries are short decimals.
ABOUT_Y = np.array([[0.8, 0.0, -0.6], [0.0, 1.0, 0.0], [0.6, 0.0, 0.8]])
ABOUT_X = np.array([[1.0, 0.0, 0.0], [0.0, 0.6, -0.8], [0.0, 0.8, 0.6]])

# A, R and T of a camera with tidy numbers.
TIDY_A = np.array([[500.0, 0.0, 300.0], [0.0, 600.0, 200.0], [0.0, 0.0, 1.0]])
TIDY = TIDY_A, ABOUT_Y, np.array([1.0, 2.0, 10.0])
# A square of 10 mm, and where it is seen.
SQUARE = (
    np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]),
    np.array([[100.0, 120.0], [300.0, 100.0], [280.0, 260.0], [120.0, 240.0]]),
)


def some_intrinsics(rng: np.random.Generator, *, skew: bool = False) -> Array:
    """Return an intrinsic matrix with two focal lengths that are clearly different.

    Examples
    --------
    >>> some_intrinsics(np.random.default_rng(0)).shape
    (3, 3)
    """
    alpha_u = round(rng.uniform(600, 900), 1)
    alpha_v = round(alpha_u * rng.uniform(1.05, 1.25), 1)
    u0, v0 = np.round(rng.uniform([280, 200], [340, 250]), 1)
    return intrinsics(alpha_u, alpha_v, u0, v0, round(rng.uniform(3, 9), 1) if skew else 0.0)


def some_rotation(rng: np.random.Generator, largest: float = 0.7) -> Array:
    """Return a rotation by 0.3 to `largest` radians about a random axis."""
    axis = rng.standard_normal(3)
    return rotation_from_vector(axis / np.linalg.norm(axis) * rng.uniform(0.3, largest))


def some_pose(rng: np.random.Generator) -> tuple[Array, Array]:
    """Return R and T of a camera about half a metre away from the world's origin."""
    return some_rotation(rng), np.round(rng.uniform([-80, -60, 400], [80, 60, 700]), 1)


def some_camera(rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Return A, with skew, R and T."""
    R, T = some_pose(rng)
    return some_intrinsics(rng, skew=True), R, T


def photographed(rng: np.random.Generator) -> Iterator[tuple[Array, Array, Array, Array]]:
    """Yield A, R, T and world points (n, 3) that the camera has in front of it, in its picture."""
    yield *TIDY, np.array([[5.0, 1.0, 0.0]])
    for n in (4, 6):
        A, R, T = some_camera(rng)
        z = rng.uniform(300, 900, (n, 1))
        M = np.concatenate([z * rng.uniform(-0.35, 0.35, (n, 2)), z], axis=1)
        yield A, R, T, np.round((M - T) @ R, 1)


def board_grid(columns: int = 4, rows: int = 3, square: float = 30.0) -> Array:
    """Return the corners of a board, (n, 2), in its plane."""
    x, y = np.meshgrid(square * np.arange(columns), square * np.arange(rows))
    return np.stack([x.ravel(), y.ravel()], axis=1)


def plane_image(A: Array, R: Array, T: Array) -> Array:
    """Return H ≈ A [r1 r2 T], which takes the plane Z = 0 to the picture."""
    return np.asarray(A @ np.stack([R[:, 0], R[:, 1], T], axis=1))


def some_homography(rng: np.random.Generator) -> Array:
    """Return the homography (3, 3) of a board in front of a camera."""
    return plane_image(some_intrinsics(rng), *some_pose(rng))


def incident(x_h: Array, y_h: Array, slack: float) -> bool:
    """Return whether points (n, 3) are on a line (3,), or lines through a point; 0 is neither."""
    bound = 1e-6 * slack * (np.abs(x_h) @ np.abs(y_h))
    return bool((np.abs(x_h @ y_h) <= bound).all() and y_h.any())


def affine_fit(src: Array, dst: Array) -> Array:
    """Return the affine map (3, 3) nearest to points (n, 2) → points (n, 2)."""
    lifted = np.column_stack([src, np.ones(len(src))])
    M = np.linalg.lstsq(lifted, dst, rcond=None)[0]
    return np.vstack([M.T, [0, 0, 1]])


def some_views(rng: np.random.Generator, A: Array, n: int) -> Array:
    """Return homographies (n, 3, 3) of a tilted board, each of a scale and sign of its own."""
    H = np.stack([plane_image(A, *some_pose(rng)) for _ in range(n)])
    return H * some_factors(rng, n)[:, None, None]


def some_factors(rng: np.random.Generator, n: int) -> Array:
    """Return factors that are not 0, of either sign."""
    factors = np.round(rng.uniform(0.3, 3.0, n), 2) * rng.choice([-1.0, 1.0], n)
    return np.asarray(factors)


def some_lens(rng: np.random.Generator) -> tuple[Array, Array]:
    """Return k (2,) and p (2,) of a lens that is valid up to a radius of 0.7 at least."""
    k = np.round([rng.uniform(-0.3, -0.1), rng.uniform(0.03, 0.12)], 3)
    return k, np.round(rng.uniform(0.002, 0.01, 2) * rng.choice([-1, 1], 2), 4)


def some_pose_matrix(rng: np.random.Generator) -> Array:
    """Return a pose as G (4, 4)."""
    return pose(*some_pose(rng))


def lens_factor(xy: Array, k: Array) -> Array:
    """Return L(r) of a lens with k (2,) as a column; r is the length of the rows of xy (n, 2)."""
    r2 = (xy**2).sum(-1, keepdims=True)
    return np.asarray(1 + k[0] * r2 + k[1] * r2**2)


def pixel_centres(size: tuple[int, int]) -> Array:
    """Return all pixel centres (n, 2) of a picture of size (width, height), row by row."""
    v, u = np.mgrid[: size[1], : size[0]]
    return np.stack([u.ravel(), v.ravel()], axis=1).astype(float)


def image_of_noise(rng: np.random.Generator, width: int, height: int) -> Array:
    """Return a picture (height, width) of whole grey levels that nothing repeats."""
    return rng.integers(0, 256, (height, width)).astype(float)


def rounded(x: npt.ArrayLike, digits: int = 2) -> Array:
    """Round, without a negative zero."""
    return np.asarray(np.round(np.asarray(x, dtype=float), digits) + 0.0)
