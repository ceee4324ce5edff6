"""Two cameras: how they stand to each other, rectified pictures, and depth (notes 2b.5)."""

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
    "RectifiedPair",
    "StereoCalibration",
    "baseline",
    "calibrate_relative_pose",
    "calibrate_stereo",
    "disparity_to_depth",
    "epipolar_lines",
    "epipole",
    "essential_matrix",
    "fundamental_matrix",
    "rectified_baseline",
    "rectify",
    "relative_pose",
    "triangulate",
]
