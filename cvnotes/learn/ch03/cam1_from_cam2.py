"""From one view to the other."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import chain, inverse, pose
from cvnotes.learn.cases.cameras import ABOUT_Y, some_pose_matrix
from cvnotes.learn.checker.equality import same_motion
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property


def cam1_from_cam2(G1: Array, G2: Array) -> Array:
    """Chain camera 1's pose with the inverse of camera 2's, both CRF ← world."""
    return chain(G1, inverse(G2))


def _both_see_the_board(G: Array, case: Case) -> bool:
    G1, G2 = case.args
    W = np.array([[0.0, 0, 0, 1], [100, 0, 0, 1], [0, 100, 0, 1], [0, 0, 100, 1]])
    return np.allclose(W @ G2.T @ G.T, W @ G1.T, atol=1e-3)


CHAIN = Exercise(
    name="cam1_from_cam2",
    chapter=3,
    title="From one view to the other",
    task="G1 and G2 (4, 4) carry points of one board into the frames of camera 1 and camera 2. "
    "Give the motion (4, 4) that carries points from camera 2's frame into camera 1's.",
    stub='''def my_cam1_from_cam2(G1, G2):
    """Give the motion (4, 4) from camera 2's frame to camera 1's."""
    ...''',
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
    misconceptions=(
        Misconception(
            "the other direction",
            "Your motion leads from camera 1 to camera 2; asked is the way back.",
            lambda G1, G2: G2 @ np.linalg.inv(G1),
        ),
        Misconception(
            "the board moved",
            "G1⁻¹ G2 is the other reading: one camera, and a board that moved. Here the board "
            "stands still and there are two cameras.",
            lambda G1, G2: np.linalg.inv(G1) @ G2,
        ),
        Misconception(
            "the board moved back",
            "G2⁻¹ G1 begins and ends in the board's frame: it moves a board, in front of one "
            "camera.",
            lambda G1, G2: np.linalg.inv(G2) @ G1,
        ),
        Misconception(
            "no inverse",
            "G1 G2 chains two motions that both start at the board. The names must touch: "
            "cam1_from_board, then board_from_cam2.",
            lambda G1, G2: G1 @ G2,
        ),
        Misconception(
            "translations subtracted",
            "The rotation is right, but translations cannot just be subtracted: T2 has to be "
            "turned into camera 1's frame first.",
            lambda G1, G2: pose(G1[:3, :3] @ G2[:3, :3].T, G1[:3, 3] - G2[:3, 3]),
        ),
        Misconception(
            "poses subtracted",
            "The difference of two poses is no pose; motions are chained by multiplication.",
            lambda G1, G2: G1 - G2,
        ),
        Misconception(
            "transposed for inverse",
            (
                "The transpose of a rotation is its inverse, that of a motion (4, 4) is not: its "
                "translation has to be turned."
            ),
            lambda G1, G2: G1 @ G2.T,
        ),
        Misconception(
            "inverse without turning T",
            "The inverse of (R, T) is (Rᵀ, −Rᵀ T); you have −T.",
            lambda G1, G2: G1 @ pose(G2[:3, :3].T, -G2[:3, 3]),
        ),
        Misconception(
            "the motions in the other order",
            (
                "You started with G1. Rightmost is what comes first: board_from_cam2, then "
                "cam1_from_board."
            ),
            lambda G1, G2: G2 @ G1,
        ),
        Misconception(
            "translation left out",
            "The rotation is right; the translation is missing.",
            lambda G1, G2: pose(G1[:3, :3] @ G2[:3, :3].T, np.zeros(3)),
        ),
        Misconception(
            "both inverted",
            "You inverted both motions: only that of camera 2 is turned around, cam1_from_board @ "
            "board_from_cam2.",
            lambda G1, G2: np.linalg.inv(G1) @ np.linalg.inv(G2),
            variants=(lambda G1, G2: np.linalg.inv(G2) @ np.linalg.inv(G1),),
        ),
        Misconception(
            "entry by entry",
            "* multiplies entry by entry; motions are chained by @.",
            lambda G1, G2: G1 * np.linalg.inv(G2),
            variants=(
                lambda G1, G2: np.linalg.inv(G2) * G1.T,
                lambda G1, G2: G1 * G2,
            ),
        ),
        Misconception(
            "divided entry by entry",
            "G1 / G2 divides entry by entry; the inverse of a motion is np.linalg.inv.",
            lambda G1, G2: G1 / G2,
        ),
        Misconception(
            "rotation only",
            "The rotation is right; asked is the whole motion (4, 4).",
            lambda G1, G2: G1[:3, :3] @ G2[:3, :3].T,
        ),
        Misconception(
            "last row left out",
            "A motion is (4, 4): (0, 0, 0, 1) is missing below.",
            lambda G1, G2: (G1 @ np.linalg.inv(G2))[:3],
        ),
        Misconception(
            "sign of the translation",
            "The rotation is right. The translation is T1 − R T2, with R = R1 R2ᵀ.",
            lambda G1, G2: pose(
                G1[:3, :3] @ G2[:3, :3].T, G1[:3, 3] + G1[:3, :3] @ G2[:3, :3].T @ G2[:3, 3]
            ),
            variants=(
                lambda G1, G2: pose(
                    G1[:3, :3] @ G2[:3, :3].T, G1[:3, :3] @ G2[:3, :3].T @ G2[:3, 3] - G1[:3, 3]
                ),
            ),
        ),
        Misconception(
            "translations subtracted the other way",
            "The rotation is right, but translations cannot just be subtracted, and T1 comes "
            "first: T1 − R T2.",
            lambda G1, G2: pose(G1[:3, :3] @ G2[:3, :3].T, G2[:3, 3] - G1[:3, 3]),
        ),
        Misconception(
            "translations added",
            "The rotation is right; the translation is T1 − R T2, with R = R1 R2ᵀ.",
            lambda G1, G2: pose(G1[:3, :3] @ G2[:3, :3].T, G1[:3, 3] + G2[:3, 3]),
        ),
        Misconception(
            "T2 not turned by the whole rotation",
            "The rotation is right. T2 has to be turned by R1 R2ᵀ: T1 − R1 R2ᵀ T2.",
            lambda G1, G2: pose(G1[:3, :3] @ G2[:3, :3].T, G1[:3, 3] - G2[:3, :3].T @ G2[:3, 3]),
        ),
        Misconception(
            "rotations in the other order",
            "The rotations are in the wrong order: R1 R2ᵀ, as first camera 2 is left.",
            lambda G1, G2: pose(
                G2[:3, :3].T @ G1[:3, :3], G1[:3, 3] - G2[:3, :3].T @ G1[:3, :3] @ G2[:3, 3]
            ),
            variants=(lambda G1, G2: pose(G2[:3, :3].T @ G1[:3, :3], G1[:3, 3] - G2[:3, 3]),),
        ),
    ),
    reference=cam1_from_cam2,
    same=same_motion,
    concepts=("24", "42", "E20"),
    sources=(cam1_from_cam2, chain, inverse),
)
