"""Where the board was."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

from collections.abc import Callable

import numpy as np

from cvnotes.base import Array
from cvnotes.calibration import extrinsics
from cvnotes.camera import nearest_rotation, pose
from cvnotes.learn.cases.cameras import (
    ABOUT_Y,
    TIDY_A,
    TIDY_T,
    plane_image,
    some_factors,
    some_intrinsics,
    some_pose,
)
from cvnotes.learn.checker.equality import same_motion, up_to_scale
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng


def _posed(rng: Rng) -> list[Case]:
    cases = [Case((TIDY_A, plane_image(TIDY_A, ABOUT_Y, TIDY_T)))]
    A = some_intrinsics(rng, skew=True)
    for sign, about in ((1.0, ""), (-1.0, "negative")):
        factor = sign * abs(some_factors(rng, 1)[0])
        cases.append(Case((A, factor * plane_image(A, *some_pose(rng))), about=about))
    R, T = some_pose(rng)
    H = plane_image(A, R, T) * (1 + 2e-3 * rng.standard_normal((3, 3)))
    cases.append(Case((A, H), truth=(R, T), about="noisy"))
    return cases


def _parts(A: Array, H: Array) -> tuple[Array, Array, Array, float]:
    """Give λ r1, λ r2, λ T and λ, with the sign that puts the board in front."""
    rays = np.linalg.inv(A) @ H
    scale = float(np.linalg.norm(rays[:, 0])) * (1.0 if rays[2, 2] > 0 else -1.0)
    return rays[:, 0], rays[:, 1], rays[:, 2], scale


def _joined(r1: Array, r2: Array, r3: Array, T: Array) -> Array:
    G = np.eye(4)
    G[:3] = np.stack([r1, r2, r3, T], axis=1)
    return G


def _G(A: Array, H: Array, *, T_scale: float = 1.0, r3: float = 1.0, sign: bool = True) -> Array:
    a, b, c, scale = _parts(A, H)
    if not sign:
        scale = abs(scale)
    return _joined(a / scale, b / scale, r3 * np.cross(a, b) / scale**2, c / scale * T_scale)


def _is_view(G: Array, case: Case) -> bool:
    A, H = case.args
    return up_to_scale(A @ G[:3, [0, 1, 3]], H, 1e-6 * case.slack)


def _is_near(G: Array, case: Case) -> bool:
    """Tell whether G is a rigid motion, and as near to the truth as the noise allows."""
    (R, T), near = case.truth, 0.05
    rigid = np.abs(G[:3, :3] @ G[:3, :3].T - np.eye(3)).max() <= 1e-6 * case.slack
    return bool(
        rigid
        and np.linalg.det(G[:3, :3]) > 0
        and np.array_equal(G[3], [0, 0, 0, 1])
        and np.abs(G[:3, :3] - R).max() < near
        and np.linalg.norm(G[:3, 3] - T) < near * np.linalg.norm(T)
    )


def _no_rotation(A: Array, H: Array, length: Callable[[float, float], float]) -> Array:
    """Give [r1 r2 r1×r2 T] as it is, with a λ made of the lengths of both columns."""
    a, b, c, scale = _parts(A, H)
    scale = np.sign(scale) * length(*np.linalg.norm([a, b], axis=1))
    return _joined(a / scale, b / scale, np.cross(a, b) / scale**2, c / scale)


def _each_by_itself(A: Array, H: Array, first: float = 0.5) -> Array:
    """Scale r1 and r2 to length 1 one by one; T with a mean of both factors."""
    a, b, c, scale = _parts(A, H)
    la, lb = np.sign(scale) * np.linalg.norm([a, b], axis=1)
    return _joined(a / la, b / lb, np.cross(a / la, b / lb), c / (first * la + (1 - first) * lb))


def _signed(A: Array, H: Array) -> Array:
    """Give A⁻¹ H with the right sign, and nothing else."""
    a, b, c, scale = _parts(A, H)
    s = np.sign(scale)
    return _joined(s * a, s * b, np.cross(a, b), s * c)


def _behind(G: Array) -> Array:
    return np.asarray(G * [-1, -1, 1, -1] * [[1], [1], [1], [-1]])


def _T_below(G: Array) -> Array:
    G[3, :3], G[:3, 3] = G[:3, 3].copy(), 0
    return G


def _transposed(G: Array) -> Array:
    G[:3, :3] = G[:3, :3].T
    return G


def _T_not_divided(G: Array, case: Case) -> bool:
    """Tell whether all but T is right, and T is A⁻¹ h3, or minus that."""
    A, H = case.args
    c = np.linalg.inv(A) @ H[:, 2]
    rest = np.linalg.norm(G[:3, :3] - case.right[:3, :3]) < 0.05
    off = min(np.linalg.norm(G[:3, 3] - c), np.linalg.norm(G[:3, 3] + c))
    return bool(rest and off <= 1e-6 * np.linalg.norm(c))


def _sign_in_T_only(A: Array, H: Array) -> Array:
    G = extrinsics(A, H)
    if _parts(A, H)[3] < 0:
        G[:3, :2] *= -1  # r3 = r1 × r2 comes out the same
    return G


def _nearest_to(A: Array, H: Array, *, third: str) -> Array:
    """Give the nearest rotation of three columns that do not belong together."""
    a, b, c, scale = _parts(A, H)
    r3 = {"T": c / scale, "T / |T|": c / np.linalg.norm(c) * np.sign(scale)}[third]
    return pose(nearest_rotation(np.column_stack([a / scale, b / scale, r3])), c / scale)


EXTRINSICS = Exercise(
    name="extrinsics",
    chapter=7,
    title="Where the board was",
    task="Give the pose G (4, 4) of the board in the camera's frame from A and the view's "
    "homography H, of any scale and sign. The board was in front of the camera, and H has a "
    "little noise: make R a rotation all the same.",
    stub='''def my_extrinsics(A, H):
    """Give G (4, 4), CRF ← board."""
    ...''',
    hints=(
        "A⁻¹ H = λ [r1 r2 T], and r1 and r2 are unit vectors: |λ| is the length of the first "
        "column, "
        "of the second, or the mean of both, which noise makes differ a little.",
        "Its sign is the one that makes T_z positive.",
        "r3 = r1 × r2; the nearest rotation to [r1 r2 r3], or one by Gram and Schmidt, cures what "
        "noise did to it. G has R and "
        "T in its first three rows and (0, 0, 0, 1) below.",
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
    misconceptions=(
        Misconception(
            "sign in T only",
            "Right for a positive scale. With a negative one you changed the sign of T alone: λ "
            "has one sign, for r1, r2 and T.",
            _sign_in_T_only,
        ),
        Misconception(
            "T not divided",
            "R is right, but T is still multiplied by λ: all three columns are divided.",
            lambda A, H: _G(A, H, T_scale=_parts(A, H)[3]),
            seen=_T_not_divided,
        ),
        Misconception(
            "λ for 1/λ",
            "You multiplied T by λ where it is divided. Zhang's λ is the reciprocal of the notes'.",
            lambda A, H: _G(A, H, T_scale=_parts(A, H)[3] ** 2),
        ),
        Misconception(
            "sign of λ",
            "Right for a positive scale. With a negative one your board stands behind the camera: "
            "choose the sign for which T_z > 0.",
            lambda A, H: _G(A, H, sign=False),
        ),
        Misconception(
            "r3 the wrong way round",
            "r3 = r1 × r2, in this order; with r2 × r1 the determinant of R is −1, a reflection.",
            lambda A, H: _G(A, H, r3=-1.0),
        ),
        Misconception(
            "R transposed",
            "r1, r2 and r3 are the columns of R; you have them as rows.",
            lambda A, H: _transposed(extrinsics(A, H)),
        ),
        Misconception(
            "A⁻¹ forgotten",
            "You took r1 and r2 from H itself. H = λ A [r1 r2 T]: multiply by A⁻¹ first.",
            lambda A, H: _G(np.eye(3), H),
        ),
        Misconception(
            "the way back",
            "That is the pose of the camera in the board's frame, G⁻¹.",
            lambda A, H: np.linalg.inv(extrinsics(A, H)),
        ),
        Misconception(
            "r3 the third column",
            "The third column of A⁻¹ H is λ T, not r3: the board's own z axis is not seen. "
            "r3 = r1 × r2.",
            lambda A, H: _joined(
                *(x / _parts(A, H)[3] for x in (*_parts(A, H)[:3], _parts(A, H)[2]))
            ),
        ),
        Misconception(
            "no rotation with noise",
            (
                "Right on exact data. With noise r1 and r2 are neither of one length nor "
                "perpendicular: take the rotation nearest to [r1 r2 r3]."
            ),
            lambda A, H: _no_rotation(A, H, lambda a, b: (a + b) / 2),
            variants=(
                lambda A, H: _no_rotation(A, H, lambda a, b: a),
                lambda A, H: _no_rotation(A, H, lambda a, b: b),
                lambda A, H: _no_rotation(A, H, lambda a, b: np.sqrt(a * b)),
            ),
        ),
        Misconception(
            "r1 and r2 scaled each by itself",
            (
                "Right on exact data. You scaled r1 and r2 to length 1 one by one: with noise "
                "they are still not perpendicular. Take the rotation nearest to [r1 r2 r3]."
            ),
            lambda A, H: _each_by_itself(A, H),
            variants=(
                lambda A, H: _each_by_itself(A, H, 1.0),
                lambda A, H: _each_by_itself(A, H, 0.0),
            ),
        ),
        Misconception(
            "T left out",
            "R is right; T = λ⁻¹ A⁻¹ h3 is missing.",
            lambda A, H: pose(extrinsics(A, H)[:3, :3], np.zeros(3)),
        ),
        Misconception(
            "last row left out",
            "G is a motion (4, 4): (0, 0, 0, 1) is missing below.",
            lambda A, H: extrinsics(A, H)[:3],
        ),
        Misconception(
            "last row of zeros",
            "The last row of G is (0, 0, 0, 1): without its 1 no translation is ever added.",
            lambda A, H: np.diag([1, 1, 1, 0]) @ extrinsics(A, H),
        ),
        Misconception(
            "A for A⁻¹",
            "You multiplied by A: H = λ A [r1 r2 T], so A has to be undone.",
            lambda A, H: _G(np.linalg.inv(A), H),
        ),
        Misconception(
            "rows of H",
            "You took the rows of H; h1, h2 and h3 are its columns.",
            lambda A, H: extrinsics(A, H.T),
        ),
        Misconception(
            "T negated",
            "Your board stands behind the camera: T has the wrong sign.",
            lambda A, H: pose(extrinsics(A, H)[:3, :3], -extrinsics(A, H)[:3, 3]),
        ),
        Misconception(
            "camera's position for T",
            "You gave where the camera stands, −Rᵀ T, beside R: G has T itself.",
            lambda A, H: pose(
                extrinsics(A, H)[:3, :3], -extrinsics(A, H)[:3, :3].T @ extrinsics(A, H)[:3, 3]
            ),
        ),
        Misconception(
            "nearest rotation of [r1 r2 T]",
            "You made a rotation of [r1 r2 T]: its third column is T, not r3 = r1 × r2.",
            lambda A, H: _nearest_to(A, H, third="T"),
            variants=(lambda A, H: _nearest_to(A, H, third="T / |T|"),),
        ),
        Misconception(
            "r3 left out",
            "r3 = r1 × r2 is missing: R has three columns.",
            lambda A, H: extrinsics(A, H) * [1, 1, 0, 1],
            variants=(lambda A, H: extrinsics(A, H)[:3, [0, 1, 3]],),
        ),
        Misconception(
            "T from H itself",
            "T = λ⁻¹ A⁻¹ h3: you left out A⁻¹.",
            lambda A, H: pose(extrinsics(A, H)[:3, :3], H[:, 2] / _parts(A, H)[3]),
            variants=(lambda A, H: pose(extrinsics(A, H)[:3, :3], H[:, 2]),),
        ),
        Misconception(
            "T scaled to length 1",
            "T has the length it has: it is divided by λ, not by its own length.",
            lambda A, H: pose(
                extrinsics(A, H)[:3, :3],
                extrinsics(A, H)[:3, 3] / np.linalg.norm(extrinsics(A, H)[:3, 3]),
            ),
        ),
        Misconception(
            "R only",
            "R is right; asked is the pose (4, 4), with T.",
            lambda A, H: extrinsics(A, H)[:3, :3],
        ),
        Misconception(
            "λ from the determinant",
            "You divided T by the determinant of A⁻¹ H. λ is the length of its first two "
            "columns, as r1 and r2 are unit vectors.",
            lambda A, H: pose(
                extrinsics(A, H)[:3, :3], _parts(A, H)[2] / np.linalg.det(np.linalg.inv(A) @ H)
            ),
        ),
        Misconception(
            "r1 and r2 exchanged",
            "r1 belongs to the first column of H, r2 to the second.",
            lambda A, H: extrinsics(A, H[:, [1, 0, 2]]),
        ),
        Misconception(
            "board behind the camera",
            "Your board stands behind the camera: choose the sign for which T_z > 0, for r1, r2 "
            "and T.",
            lambda A, H: _behind(extrinsics(A, H)),
        ),
        Misconception(
            "T in the last row",
            "T stands in the last column of G, (0, 0, 0, 1) in its last row.",
            lambda A, H: extrinsics(A, H).T,
            variants=(lambda A, H: _T_below(extrinsics(A, H)),),
        ),
        Misconception(
            "λ left out",
            "r1, r2 and T are still multiplied by λ: r1 is a unit vector, so divide all three by "
            "the length of the first column of A⁻¹ H.",
            lambda A, H: _joined(*_parts(A, H)[:2], np.cross(*_parts(A, H)[:2]), _parts(A, H)[2]),
            variants=(lambda A, H: _signed(A, H),),
        ),
    ),
    reference=extrinsics,
    sources=(extrinsics, nearest_rotation),
    same=same_motion,
    concepts=("54", "60", "d", "E32"),
)
