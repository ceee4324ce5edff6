"""Exercises of chapter 7, Zhang's method: from homographies to the camera, its poses, its lens."""

from cvnotes.learn.ch07.a_from_b import A_FROM_B
from cvnotes.learn.ch07.b_from_views import B_FROM_VIEWS
from cvnotes.learn.ch07.bad_views import BAD_VIEWS
from cvnotes.learn.ch07.camera_covariance import CAMERA_COVARIANCE
from cvnotes.learn.ch07.extrinsics import EXTRINSICS
from cvnotes.learn.ch07.focal_from_turn import TURN
from cvnotes.learn.ch07.levenberg_marquardt import LEVENBERG_MARQUARDT
from cvnotes.learn.ch07.radial_fit import RADIAL
from cvnotes.learn.ch07.v_ij import V_IJ

EXERCISES = (
    V_IJ,
    B_FROM_VIEWS,
    A_FROM_B,
    EXTRINSICS,
    RADIAL,
    BAD_VIEWS,
    TURN,
    CAMERA_COVARIANCE,
    LEVENBERG_MARQUARDT,
)
