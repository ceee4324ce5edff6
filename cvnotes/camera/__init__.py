"""Chapters 2 to 4: vanishing points, the camera and its lens (notes 2b.1 to 2b.3)."""

from cvnotes.camera.any_lens import AnyLens, PlaneLens
from cvnotes.camera.factors import centre_of, decompose
from cvnotes.camera.fisheye import FisheyeLens
from cvnotes.camera.lens import Lens
from cvnotes.camera.model import (
    Camera,
    intrinsics,
    intrinsics_from_pixel_size,
    px_from_xy,
    xy_from_px,
)
from cvnotes.camera.rational import RationalLens
from cvnotes.camera.rigid import (
    board_from_board,
    cam_from_cam,
    chain,
    inverse,
    look_at,
    move,
    nearest_rotation,
    pose,
    rotation_from_angles,
    rotation_from_vector,
    skew_matrix,
    vector_from_rotation,
)
from cvnotes.camera.vanishing import (
    focal_length,
    horizon,
    intrinsics_from_vanishing_points,
    vanishing_point,
)

__all__ = [
    "Camera",
    "AnyLens",
    "PlaneLens",
    "Lens",
    "RationalLens",
    "FisheyeLens",
    "intrinsics",
    "intrinsics_from_pixel_size",
    "px_from_xy",
    "xy_from_px",
    "decompose",
    "centre_of",
    "pose",
    "inverse",
    "move",
    "chain",
    "look_at",
    "board_from_board",
    "cam_from_cam",
    "rotation_from_vector",
    "vector_from_rotation",
    "rotation_from_angles",
    "nearest_rotation",
    "skew_matrix",
    "vanishing_point",
    "horizon",
    "focal_length",
    "intrinsics_from_vanishing_points",
]
