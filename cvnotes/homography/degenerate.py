"""Point sets that determine no homography, and what is wrong with them."""

import numpy as np
import numpy.typing as npt

from cvnotes.errors import Array, DegenerateError

Mask = npt.NDArray[np.bool_]

# Relative singular value, after normalisation, below which a rank is called deficient.
RANK = 1e-9


def refuse_singular(H: Array, src: Array, dst: Array) -> None:
    """Refuse a normalised H that squeezes the plane onto a line: no two planes are related so."""
    # det is the product of the singular values, of which the largest is at most ‖H‖ = 1.
    doubtful = np.abs(np.linalg.det(H)) < 1e-4
    if doubtful.any():
        s = np.linalg.svd(H[doubtful], compute_uv=False)
        bad = s[..., 2] <= RANK * s[..., 0]
        if bad.any():
            raise DegenerateError(why_degenerate(src, dst, doubtful, bad))


def why_degenerate(src: Array, dst: Array, doubtful: Mask, bad: Mask) -> str:
    """Say in words which configuration keeps the first bad homography from being determined.

    `bad` has one entry for each set of points that is `doubtful`, which has one for every set.
    """
    where = tuple(np.argwhere(doubtful)[np.argmax(bad)].tolist())
    src, dst = np.broadcast_arrays(src, dst)
    prefix = f"set {', '.join(map(str, where))}: " if where else ""
    for name, x in (("src", src[where]), ("dst", dst[where])):
        distinct = len(np.unique(x.round(9), axis=0))
        if distinct < 4:
            return f"{prefix}{name} has only {distinct} distinct points (duplicates); 4 are needed"
        s = np.linalg.svd(x - x.mean(0), compute_uv=False)
        if s[1] <= RANK * s[0]:
            return f"{prefix}all points of {name} are collinear; move some off the line"
    return (
        f"{prefix}all but one of the points lie on a line (collinear), so they do not fix a "
        "homography; use four points of which no three are collinear"
    )
