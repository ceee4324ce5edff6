"""Chapter 7: a camera from its pictures of a board, with error bars (notes 2b.4)."""

from cvnotes.calibration.board_shape import BOARDS, BoardShape
from cvnotes.calibration.choice import Choice, choose_model
from cvnotes.calibration.driver import calibrate
from cvnotes.calibration.next_view import NextView, next_view
from cvnotes.calibration.one_view import calibrate_one_view
from cvnotes.calibration.pose import pose_from_view
from cvnotes.calibration.ppm import ppm_dlt, resect
from cvnotes.calibration.prediction import prediction_std
from cvnotes.calibration.result import Calibration
from cvnotes.calibration.zhang import (
    constraints,
    extrinsics,
    intrinsics_from_b,
    intrinsics_from_b_by_formulas,
    radial_distortion,
    solve_b,
    v_ij,
)
from cvnotes.camera.any_lens import LENSES

__all__ = [
    "calibrate",
    "Calibration",
    "LENSES",
    "choose_model",
    "Choice",
    "BOARDS",
    "BoardShape",
    "v_ij",
    "constraints",
    "solve_b",
    "intrinsics_from_b",
    "intrinsics_from_b_by_formulas",
    "extrinsics",
    "radial_distortion",
    "prediction_std",
    "NextView",
    "next_view",
    "ppm_dlt",
    "resect",
    "pose_from_view",
    "calibrate_one_view",
]
