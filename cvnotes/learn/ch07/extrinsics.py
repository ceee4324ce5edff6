"""Where the board was."""

import numpy as np

from cvnotes.base import Array
from cvnotes.calibration import extrinsics
from cvnotes.camera import nearest_rotation
from cvnotes.learn.cases.cameras import TIDY, plane_image, some_factors, some_intrinsics, some_pose
from cvnotes.tutor import Case, Exercise, Property, mistakes_in
from cvnotes.tutor.checker.equality import same_motion, up_to_scale


def _posed(rng: np.random.Generator) -> list[Case]:
    A, R, T = TIDY
    # T_z is not the only sign that there is
    cases = [Case((A, plane_image(A, r, t))) for r, t in ((R, T), (R.T, T * [-1, -1, 1]))]
    A = some_intrinsics(rng, skew=True)
    for sign, about in ((1.0, ""), (-1.0, "negative")):
        factor = sign * abs(some_factors(rng, 1)[0])
        cases.append(Case((A, factor * plane_image(A, *some_pose(rng))), about=about))
    R, T = some_pose(rng)
    H = plane_image(A, R, T) * (1 + 2e-3 * rng.standard_normal((3, 3)))
    cases.append(Case((A, H), truth=(R, T), about="noisy"))
    return cases


def _is_view(G: Array, case: Case) -> bool:
    A, H = case.args
    return up_to_scale(A @ G[:3, [0, 1, 3]], H, 1e-6 * case.slack)


def _is_near(G: Array, case: Case) -> bool:
    """Return whether G is a rigid motion, and as near to the truth as the noise allows."""
    (R, T), near = case.truth, 0.05
    rigid = np.abs(G[:3, :3] @ G[:3, :3].T - np.eye(3)).max() <= 1e-6 * case.slack
    return bool(
        rigid
        and np.linalg.det(G[:3, :3]) > 0
        and np.array_equal(G[3], [0, 0, 0, 1])
        and np.abs(G[:3, :3] - R).max() < near
        and np.linalg.norm(G[:3, 3] - T) < near * np.linalg.norm(T)
    )


def _steps(A: Array, H: Array) -> Array:
    """Return G (4, 4), CRF ← board."""
    X = np.linalg.inv(A) @ H  # the columns λ r1, λ r2 and λ T
    size = np.linalg.norm(X[:, 0])  # the size of λ
    scale = np.sign(X[2, 2]) * size  # λ, with the sign that puts the board in front
    r1 = X[:, 0] / scale  # r1
    r2 = X[:, 1] / scale  # r2
    T = X[:, 2] / scale  # T
    r3 = np.cross(r1, r2)  # r3
    U, _, Vt = np.linalg.svd(np.column_stack([r1, r2, r3]))  # what the nearest rotation is made of
    R = U @ Vt  # the nearest rotation
    return np.vstack([np.column_stack([R, T]), [0, 0, 0, 1]])


# The steps without the line that cures what noise did.
_RAW = ("R = U @ Vt", "R = np.column_stack([r1, r2, r3])")
_MISTAKES = mistakes_in(_steps,
    ("sign of λ", "Right for a positive scale. With a negative one your board stands behind the "
     "camera: which sign has T_z?",
     ("np.sign(X[2, 2]) * size", "size", *_RAW), ("np.sign(X[2, 2]) * size", "size")),
    ("sign in T only", "Right for a positive scale. With a negative one you changed the sign of T "
     "alone: λ has one sign, for all three columns.",
     "extrinsics(A, H) * np.where(X[2, 2] > 0, 1, [-1, -1, 1, 1])"),
    ("T not divided", "R is right, but T is still multiplied by λ, as the other columns were.",
     ("X[:, 2] / scale", "X[:, 2]", *_RAW), ("X[:, 2] / scale", "X[:, 2]"),
     ("X[:, 2] / scale", "X[:, 2] * np.sign(X[2, 2])")),
    ("R transposed", "You have r1, r2 and r3 as rows of R; what are they?",
     ("[R, T]", "[R.T, T]")),
    ("A⁻¹ forgotten", "You took r1 and r2 from H itself, which is in pixels.",
     ("np.linalg.inv(A) @ H", "H", *_RAW), ("np.linalg.inv(A) @ H", "H")),
    ("A for A⁻¹", "You multiplied by A, which H has in it already.",
     ("np.linalg.inv(A)", "A", *_RAW), ("np.linalg.inv(A)", "A")),
    ("r3 the third column", "You took the third column of A⁻¹ H for r3: it is λ T.",
     ("np.cross(r1, r2)", "T", *_RAW), ("np.cross(r1, r2)", "T"),
     ("np.cross(r1, r2)", "T / np.linalg.norm(T)")),
    ("no rotation with noise", "Right on exact data. With noise r1 and r2 are neither of one "
     "length nor perpendicular: which rotation is nearest?",
     (*_RAW,), ("[:, 0])", "[:, 1])", *_RAW),
     ("np.linalg.norm(X[:, 0])", "np.linalg.norm(X[:, :2], axis=0).mean()", *_RAW),
     ("np.linalg.norm(X[:, 0])", "np.sqrt(np.prod(np.linalg.norm(X[:, :2], axis=0)))", *_RAW)),
    ("r1 and r2 scaled each by itself", "Right on exact data. You scaled r1 and r2 to length 1 one "
     "by one: with noise they are still not perpendicular.",
     *(("    r3 =", "    n = np.linalg.norm(r2); r2 = r2 / n; "
        f"T = T / (1 + {w} * (n - 1)); r3 =", *_RAW) for w in (0, 0.5, 1))),
    ("camera's position for T", "You gave where the camera stands beside R: G has T itself.",
     ("[R, T]", "[R, -R.T @ T]")),
    ("r1 and r2 exchanged", "r1 and r2 are exchanged: to which column of H belongs which?",
     ("np.linalg.inv(A) @ H", "np.linalg.inv(A) @ H[:, [1, 0, 2]]")),
    ("λ left out", "r1, r2 and T are still multiplied by λ: how long is r1?",
     ("np.sign(X[2, 2]) * size", "1", *_RAW),
     ("np.sign(X[2, 2]) * size", "np.sign(X[2, 2])", *_RAW)),
)  # fmt: skip

EXERCISE = Exercise(
    name="extrinsics",
    chapter=7,
    title="Where the board was",
    task="Give the pose G (4, 4) of the board in the camera's frame from A and the view's "
    "homography H, of any scale and sign. The board was in front of the camera, and H has a "
    "little noise: make R a rotation all the same.",
    hints=(
        "A⁻¹ H = λ [r1 r2 T], and r1 and r2 are unit vectors: |λ| is the length of the first "
        "column, of the second, or the mean of both, which noise makes differ a little.",
        "Its sign is the one that makes T_z positive.",
        "r3 = r1 × r2; the nearest rotation to [r1 r2 r3], or one by Gram and Schmidt, cures what "
        "noise did to it. G has R and T in its first three rows and (0, 0, 0, 1) below.",
    ),
    cases=_posed,
    properties=(
        Property("A [r1 r2 T] is the homography, up to scale.", _is_view),
        Property("R is a rotation, and T has the length it has."),
        Property(
            "With noise R is a rotation all the same, and near the true one.",
            _is_near,
            about="noisy",
        ),
        Property("A negative scale of H still puts the board in front: T_z > 0.", about="negative"),
    ),
    misconceptions=_MISTAKES,
    reference=extrinsics,
    steps=_steps,
    sources=(extrinsics, nearest_rotation),
    same=same_motion,
    concepts=("54", "60", "d", "E32"),
)
