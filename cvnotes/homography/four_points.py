"""Four point pairs and no more: the notes' two normalisations, with their blind spot."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, DegenerateError, ShapeError, points
from cvnotes.homography.linear import design_matrix


def four_points_h9_one(src: npt.ArrayLike, dst: npt.ArrayLike) -> Array:
    """Solve the 4-point case with h9 = 1: eight equations in h1 … h8 (notes, first choice).

    Raises
    ------
    DegenerateError
        The 8×8 matrix is singular: three points on a line, or a true h9 of zero (erratum E27),
        which happens when the origin of `src` is seen at infinity.

    Examples
    --------
    >>> square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    >>> four_points_h9_one(square, [[5, 5], [7, 5], [7, 7], [5, 7]]).round(9) + 0.0
    array([[2., 0., 5.],
           [0., 2., 5.],
           [0., 0., 1.]])
    """
    return np.append(_eight_of_four(src, dst), 1.0).reshape(3, 3)


def four_points_unit_norm(src: npt.ArrayLike, dst: npt.ArrayLike) -> Array:
    """Solve the 4-point case with ‖h‖ = 1: h9 = 1 / √(‖Ã⁻¹ A9‖² + 1) (notes, second choice).

    Fails where `four_points_h9_one` fails, for the same 8×8 matrix is solved (erratum E27).

    Raises
    ------
    DegenerateError
        The 8×8 matrix is singular.

    Examples
    --------
    >>> square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    >>> float(np.linalg.norm(four_points_unit_norm(square, square)).round(12))
    1.0
    """
    h = _eight_of_four(src, dst)
    with np.errstate(over="ignore", invalid="ignore"):
        h9 = 1 / np.sqrt(h @ h + 1)
        return np.append(h9 * h, h9).reshape(3, 3)


def _eight_of_four(src: npt.ArrayLike, dst: npt.ArrayLike) -> Array:
    """Solve Ã h̃ = −A9 for h1 … h8, with h9 = 1."""
    src, dst = points(src, "src", 2), points(dst, "dst", 2)
    if src.shape != (4, 2) or dst.shape != (4, 2):
        raise ShapeError(f"the 4-point case takes (4, 2) and (4, 2), got {src.shape}, {dst.shape}")
    D = design_matrix(src, dst)
    # Scale the columns so that the rank does not depend on the units.
    scale = np.abs(D).max(axis=0)
    scale[scale == 0] = 1
    s = np.linalg.svd(D[:, :8] / scale[:8], compute_uv=False)
    if s[7] <= 1e-12 * s[0]:
        raise DegenerateError(
            "the 8×8 system is singular: three of the four points lie on a line, or the true h9 "
            "is zero, which neither h9 = 1 nor its closed form can express; use dlt"
        )
    with np.errstate(over="ignore"):  # from points within less than all numbers
        return np.asarray(np.linalg.solve(D[:, :8] / scale[:8], -D[:, 8]) / scale[:8])
