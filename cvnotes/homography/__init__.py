"""Homographies between planes, from point pairs (notes 2b.4, "P as a Homography").

A plane Z = 0 is seen through columns 1, 2 and 4 of P, a 3×3 matrix H: dst ≈ H src. Estimators
take one set of points (n, 2) or a stack of sets (..., n, 2).
"""

from cvnotes.homography.four_points import four_points_h9_one, four_points_unit_norm
from cvnotes.homography.geometric import geometric_error, refine_homography
from cvnotes.homography.linear import design_matrix, dlt
from cvnotes.homography.normalise import normaliser

__all__ = [
    "design_matrix",
    "dlt",
    "four_points_h9_one",
    "four_points_unit_norm",
    "geometric_error",
    "normaliser",
    "refine_homography",
]
