"""Samples of four pairs, and the maps that they alone determine."""

import numpy as np
import numpy.typing as npt

from cvnotes.errors import Array

# Samples tried at a time.
BATCH = 64
# Twice the area of a triangle of normalised points below which three of them count as collinear.
_FLAT = 1e-6


def samples(rng: np.random.Generator, n: int) -> npt.NDArray[np.intp]:
    """Draw four different rows of n, (BATCH, 4): the j-th among the n − j that are left."""
    rows = rng.integers(0, [n, n - 1, n - 2, n - 3], size=(BATCH, 4))
    for j in (1, 2, 3):
        for earlier in np.sort(rows[:, :j], axis=-1).T:
            rows[:, j] += rows[:, j] >= earlier
    return rows


def of_four(src: Array, dst: Array) -> tuple[Array, int]:
    """Give the H (k, 3, 3) that map four normalised points (s, 4, 2) exactly, where one does.

    Four points, no three of them collinear, are a projective basis: the fourth is
    λ1 a + λ2 b + λ3 c, so [λ1 a, λ2 b, λ3 c] maps the standard basis and (1, 1, 1)ᵀ to the four,
    and H is this matrix for dst times the inverse of that for src. No h9 is fixed. Also given is
    how many samples count as trials: those that a right map could have come from.
    """
    M_src, areas_src = _basis(src)
    M_dst, areas_dst = _basis(dst)
    trial = (np.abs(areas_src) > _FLAT).all(-1)
    # λ_dst / λ_src is the third coordinate of each image: one sign for all points in front.
    sides = np.sign(areas_src * areas_dst) * (np.abs(areas_dst) > _FLAT)
    usable = trial & (np.abs(sides.sum(-1)) == 4)
    H = M_dst[usable] @ np.linalg.inv(M_src[usable]) * sides[usable, :1, None]
    return H / np.linalg.norm(H, axis=(-2, -1), keepdims=True), int(trial.sum())


def _basis(x: Array) -> tuple[Array, Array]:
    """Give M diag(λ) (..., 3, 3), and the four triangles' signed areas (..., 4), twice.

    By Cramer's rule λ_i is a triangle's area over another's, so the areas serve as λ.
    """
    x_h = np.concatenate([x, np.ones_like(x[..., :1])], axis=-1)
    a, b, c, d = (x_h[..., i, :] for i in range(4))
    areas = np.stack([_det(d, b, c), _det(a, d, c), _det(a, b, d), _det(a, b, c)], axis=-1)
    return np.stack([a, b, c], axis=-1) * areas[..., None, :3], areas


def _det(a: Array, b: Array, c: Array) -> Array:
    return np.asarray((np.cross(a, b) * c).sum(-1))
