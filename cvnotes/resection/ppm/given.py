"""Points in space and their pixels: guarded, normalised, refused where they leave P open."""

import numpy as np
import numpy.typing as npt

from cvnotes.errors import Array, CvnotesError, DegenerateError, ShapeError, paired, points

# Relative singular value, after normalisation, below which a rank is called deficient.
RANK = 1e-9


def normaliser(W: npt.ArrayLike) -> Array:
    """Give the similarity N (4, 4) with which N W has centroid 0 and mean distance √3 from it.

    Hartley's normalisation, one dimension up. With it the estimated P depends neither on the unit
    of W nor on where the origin of the WRF is.

    Raises
    ------
    DegenerateError
        All points coincide.

    References
    ----------
    .. [1] Absent from the notes; see erratum E26.
    .. [2] Hartley and Zisserman, Multiple View Geometry, 2nd ed. (2004), 7.1.

    Examples
    --------
    >>> normaliser([[0, 0, 0], [2, 2, 2]])
    array([[ 1.,  0.,  0., -1.],
           [ 0.,  1.,  0., -1.],
           [ 0.,  0.,  1., -1.],
           [ 0.,  0.,  0.,  1.]])
    """
    W = _several(W)
    centre = W.mean(0)
    distance = np.linalg.norm(W - centre, axis=-1).mean()
    if not distance > 1e-12 * np.abs(centre).max():
        raise DegenerateError("all points of W coincide; the PPM needs six that do not")
    s = np.sqrt(3) / distance
    N = np.diag([s, s, s, 1.0])
    N[:3, 3] = -s * centre
    return N


def pairs(W: npt.ArrayLike, m: npt.ArrayLike, *, at_least: int) -> tuple[Array, Array]:
    """Guard points W (n, 3) and their pixels m (n, 2)."""
    W, m = _several(W), points(m, "m", 2)
    if m.ndim != 2:
        raise ShapeError(f"m: expected pixels (n, 2) of one picture, got {m.shape}")
    paired(W, m, ("W", "m"), at_least=at_least)
    return W, m


def refuse_flat(W: Array, m: Array) -> None:
    """Refuse normalised points that span no space, or no picture, and say what they span."""
    distinct = len(np.unique(W.round(9), axis=0))
    if distinct < 6:
        raise DegenerateError(
            f"W has only {distinct} distinct points (duplicates); the PPM needs 6"
        )
    s = np.linalg.svd(W, compute_uv=False)
    if s[1] <= RANK * s[0]:
        raise DegenerateError("all points of W are collinear; the PPM needs points in space")
    if s[2] <= RANK * s[0]:
        raise DegenerateError(
            "all points of W are coplanar: one picture of a plane gives a homography but not P; "
            "use a target of two planes, or several views of the plane (calibrate)"
        )
    s = np.linalg.svd(m, compute_uv=False)
    if s[1] <= RANK * s[0]:
        raise DegenerateError("all pixels of m lie on a line: they show the target edge-on")


def _several(W: npt.ArrayLike) -> Array:
    W = points(W, "W", 3)
    if W.ndim != 2 or not len(W):
        raise ShapeError(f"W: expected points (n, 3) of one picture, got {W.shape}")
    if np.abs(W).max() > 1e100:
        raise CvnotesError("W: coordinates beyond 1e100 cannot be computed with")
    return W
