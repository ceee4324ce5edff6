"""Rigid motions between reference frames (notes 2b.2).

G = [R T; 0 1] carries world points into the camera's frame: M = R W + T. T is where the world's
origin is seen from the camera; the camera itself stands at C = −Rᵀ T.
"""

from cvnotes.rigid.motions import (
    board_from_board,
    cam_from_cam,
    chain,
    inverse,
    look_at,
    move,
    pose,
)
from cvnotes.rigid.rotations import (
    exp_so3,
    nearest_rotation,
    rotation_from_angles,
    rotation_from_vector,
    skew_matrix,
    vector_from_rotation,
)

__all__ = [
    "board_from_board",
    "cam_from_cam",
    "chain",
    "exp_so3",
    "inverse",
    "look_at",
    "move",
    "nearest_rotation",
    "pose",
    "rotation_from_angles",
    "rotation_from_vector",
    "skew_matrix",
    "vector_from_rotation",
]
