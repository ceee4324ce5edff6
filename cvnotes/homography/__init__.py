"""Chapter 6: the image of a plane, from four pairs of points or from many (notes 2b.4)."""

from cvnotes.homography.four_points import four_points_h9_one, four_points_unit_norm
from cvnotes.homography.linear import design_matrix, dlt
from cvnotes.homography.ransac import ransac_homography, trials_needed
from cvnotes.homography.refinement import geometric_error, refine_homography
from cvnotes.projective.points import normaliser

__all__ = [
    "design_matrix",
    "normaliser",
    "dlt",
    "four_points_h9_one",
    "four_points_unit_norm",
    "geometric_error",
    "refine_homography",
    "ransac_homography",
    "trials_needed",
]
