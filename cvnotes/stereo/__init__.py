"""Chapter 10: two cameras, and the depth that they see together (notes 2b.5)."""

from cvnotes.stereo.calibration import calibrate_stereo
from cvnotes.stereo.epipolar import baseline, epipole, relative_pose
from cvnotes.stereo.rectification import RectifiedPair, rectify
from cvnotes.stereo.result import StereoCalibration
from cvnotes.stereo.triangulation import disparity_to_depth, rectified_baseline, triangulate

__all__ = [
    "relative_pose",
    "baseline",
    "epipole",
    "RectifiedPair",
    "rectify",
    "triangulate",
    "disparity_to_depth",
    "rectified_baseline",
    "calibrate_stereo",
    "StereoCalibration",
]
