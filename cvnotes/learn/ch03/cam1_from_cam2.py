"""From one view to the other."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import pose
from cvnotes.learn.cases.cameras import ABOUT_Y, some_pose_matrix
from cvnotes.tutor import Case, Exercise, Property, mistakes_in
from cvnotes.tutor.checker.equality import same_motion


def _both_see_the_board(G: Array, case: Case) -> bool:
    G1, G2 = case.args
    W = np.array([[0.0, 0, 0, 1], [100, 0, 0, 1], [0, 100, 0, 1], [0, 0, 100, 1]])
    return np.allclose(W @ G2.T @ G.T, W @ G1.T, atol=1e-3)


def cam1_from_cam2(G1: Array, G2: Array) -> Array:
    """Return the motion (4, 4) from camera 2's frame to camera 1's."""
    R = G2[:3, :3].T  # the rotation from camera 2 to the board
    T = -R @ G2[:3, 3]  # the translation from camera 2 to the board
    B = np.vstack([np.column_stack([R, T]), [0, 0, 0, 1]])  # the motion from camera 2 to the board
    return G1 @ B


MISTAKES = mistakes_in(cam1_from_cam2,
    ("the board moved", "The names do not touch: go from camera 2 to the board, then to camera 1.",
     "np.linalg.inv(G1) @ G2", "np.linalg.inv(G2) @ G1", "G2 @ G1",
     "np.linalg.inv(G1) @ np.linalg.inv(G2)", "np.linalg.inv(G2) @ np.linalg.inv(G1)"),
    ("translations subtracted", "The rotation is right. The translation of camera 2 has to be "
     "turned into camera 1's frame before it is subtracted from the other.",
     *(f"pose(G1[:3, :3] @ R, {other})" for other in (
         "G1[:3, 3] - G2[:3, 3]", "G2[:3, 3] - G1[:3, 3]", "G1[:3, 3] + G2[:3, 3]", "G1[:3, 3] + T",
         "np.zeros(3)", "G1[:3, 3] - G1[:3, :3] @ T", "-G1[:3, :3] @ T - G1[:3, 3]"))),
    ("poses subtracted", "Motions are chained, not subtracted, divided or multiplied by entries.",
     "G1 - G2", "G1 / G2", "G1 * np.linalg.inv(G2)", "np.linalg.inv(G2) * G1.T", "G1 * G2"),
    ("transposed for inverse", "The transpose of a rotation is its inverse, that of a motion (4, "
     "4) is not: its translation has to be turned.",
     "G1 @ G2.T"),
    ("rotations in the other order",
     "The rotations are in the wrong order: camera 2 is left first.",
     "pose(R @ G1[:3, :3], G1[:3, 3] - R @ G1[:3, :3] @ G2[:3, 3])",
     "pose(R @ G1[:3, :3], G1[:3, 3] - G2[:3, 3])"),
)  # fmt: skip


EXERCISE = Exercise(
    name="cam1_from_cam2",
    chapter=3,
    title="From one view to the other",
    task="G1 and G2 (4, 4) carry points of one board into the frames of camera 1 and camera 2. "
    "Give the motion (4, 4) that carries points from camera 2's frame into camera 1's.",
    hints=(
        "Go from camera 2 to the board, and from there to camera 1.",
        "Written by names: cam1_from_cam2 = cam1_from_board @ board_from_cam2.",
        "board_from_cam2 is the inverse of cam2_from_board = G2.",
    ),
    cases=lambda rng: [
        Case((pose(ABOUT_Y, [1.0, 2.0, 10.0]), pose(np.eye(3), [0.0, 1.0, 8.0]))),
        Case((some_pose_matrix(rng), some_pose_matrix(rng))),
    ],
    properties=(
        Property("What camera 2 sees of the board, camera 1 sees too.", _both_see_the_board),
    ),
    misconceptions=MISTAKES,
    steps=cam1_from_cam2,
    same=same_motion,
    concepts=("24", "42", "E20"),
)
