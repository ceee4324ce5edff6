"""One picture of known points: the PPM, the pose of a known camera, or the whole camera."""

from cvnotes.resection.one_view import calibrate_one_view
from cvnotes.resection.pose import pose_from_view
from cvnotes.resection.ppm import normaliser, ppm_design_matrix, ppm_dlt, refine_ppm, resect

__all__ = [
    "calibrate_one_view",
    "normaliser",
    "pose_from_view",
    "ppm_design_matrix",
    "ppm_dlt",
    "refine_ppm",
    "resect",
]
