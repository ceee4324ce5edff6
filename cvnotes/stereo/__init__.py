"""Chapter 8: two cameras, and the depth that they see together (notes 2b.5)."""

from cvnotes.stereo.calibration import calibrate_relative_pose, calibrate_stereo
from cvnotes.stereo.epipolar import (
    baseline,
    epipolar_lines,
    epipole,
    essential_matrix,
    fundamental_matrix,
    relative_pose,
)
from cvnotes.stereo.rectification import RectifiedPair, rectify
from cvnotes.stereo.result import StereoCalibration
from cvnotes.stereo.triangulation import disparity_to_depth, rectified_baseline, triangulate

__all__ = [
    "relative_pose",
    "baseline",
    "essential_matrix",
    "fundamental_matrix",
    "epipolar_lines",
    "epipole",
    "RectifiedPair",
    "rectify",
    "triangulate",
    "disparity_to_depth",
    "rectified_baseline",
    "calibrate_stereo",
    "calibrate_relative_pose",
    "StereoCalibration",
]
