"""Rotations and rigid motions: R and T, made, turned into each other, and chained (notes 2b.2)."""

from functools import reduce

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    Array,
    CvnotesError,
    DegenerateError,
    Matrix,
    Points,
    ShapeError,
    equally_many,
    guarded,
    number,
    points,
    rigid_motion,
    rotation,
)

# [v]× = Σ v_i E_i; the rows here are E_1, E_2 and E_3 from left to right, top to bottom.
_CROSS = np.array(
    [[0, 0, 0, 0, 0, -1, 0, 1, 0], [0, 0, 1, 0, 0, 0, -1, 0, 0], [0, -1, 0, 1, 0, 0, 0, 0, 0.0]]
)
# Makes an angle of 0 the smallest of all, and changes no other.
_NOT_ZERO = 1e-300


@guarded(w=Points(3))
def rotation_from_vector(w: Array) -> Array:
    """Rotate about the axis w (..., 3) by ‖w‖ radians: R = exp([w]×) (Rodrigues' formula).

    R = I + (sin θ / θ) [w]× + ((1 − cos θ) / θ²) [w]×².

    Examples
    --------
    >>> rotation_from_vector([0, 0, np.pi / 2]).round(3) + 0.0
    array([[ 0., -1.,  0.],
           [ 1.,  0.,  0.],
           [ 0.,  0.,  1.]])
    """
    # With half angles, K = (sin(θ/2) / (θ/2)) [w]×, no small angle needs a series:
    # sin θ [w]× / θ = cos(θ/2) K and (1 − cos θ) [w]×² / θ² = K² / 2.
    half = np.sqrt(np.vecdot(w, w) + _NOT_ZERO)[..., None] / 2
    K = skew_matrix.inside(np.sin(half) / half * w)
    return np.asarray(np.eye(3) + np.cos(half)[..., None] * K + K @ K / 2)


def vector_from_rotation(R: npt.ArrayLike) -> Array:
    """Return the axis times the angle (..., 3), angle in [0, π], of rotations (..., 3, 3).

    Goes through the quaternion of R, whose largest component is never small, so that angles
    near 0 and near π keep all their digits.

    Examples
    --------
    >>> vector_from_rotation(rotation_from_vector([0.1, -0.2, 0.3])).round(12)
    array([ 0.1, -0.2,  0.3])
    """
    R = rotation(R)
    t = np.trace(R, axis1=-2, axis2=-1)
    # 4 q qᵀ, of which any row is the quaternion (x, y, z, w) up to scale.
    Q = np.empty((*R.shape[:-2], 4, 4))
    Q[..., :3, :3] = R + R.mT + (1 - t)[..., None, None] * np.eye(3)
    Q[..., :3, 3] = Q[..., 3, :3] = np.stack(
        [R[..., 2, 1] - R[..., 1, 2], R[..., 0, 2] - R[..., 2, 0], R[..., 1, 0] - R[..., 0, 1]], -1
    )
    Q[..., 3, 3] = 1 + t
    largest = np.argmax(np.diagonal(Q, axis1=-2, axis2=-1), axis=-1)
    q = np.take_along_axis(Q, largest[..., None, None], axis=-2)[..., 0, :]
    q = q / np.linalg.norm(q, axis=-1, keepdims=True)
    q = np.where(q[..., 3:] < 0, -q, q)
    s = np.linalg.norm(q[..., :3], axis=-1, keepdims=True)
    angle = 2 * np.arctan2(s, q[..., 3:])
    factor = np.divide(angle, s, out=np.full_like(s, 2.0), where=s > 0)
    return np.asarray(q[..., :3] * factor)


def rotation_from_angles(x: float, y: float, z: float) -> Array:
    """Rotate about the fixed axes x, then y, then z, by angles in radians: R = Rz Ry Rx.

    Examples
    --------
    >>> np.allclose(rotation_from_angles(0, 0, 0.3), rotation_from_vector([0, 0, 0.3]))
    True
    """
    angles = [number(angle, name) for angle, name in ((x, "x"), (y, "y"), (z, "z"))]
    Rx, Ry, Rz = rotation_from_vector.inside(np.diag(angles))
    return np.asarray(Rz @ Ry @ Rx)


@guarded(M=Matrix(3, 3))
def nearest_rotation(M: Array) -> Array:
    """Return the rotation closest to M (..., 3, 3): R = U diag(1, 1, det(U Vᵀ)) Vᵀ.

    Raises
    ------
    DegenerateError
        M has rank below 2, or mirrors with two equal smallest singular values (as −I does), so
        that many rotations are equally close.

    Examples
    --------
    >>> nearest_rotation(2 * np.eye(3))
    array([[1., 0., 0.],
           [0., 1., 0.],
           [0., 0., 1.]])
    """
    U, s, Vt = np.linalg.svd(M)
    if (s[..., 1] <= 1e-12 * s[..., 0]).any():
        raise DegenerateError("M has rank below 2: no rotation is closest to it")
    det = np.round(np.linalg.det(U @ Vt))
    if ((det < 0) & (s[..., 1] - s[..., 2] <= 1e-12 * s[..., 0])).any():
        raise DegenerateError("M is a reflection to which many rotations are equally close")
    U[..., :, 2] *= det[..., None]
    return np.asarray(U @ Vt) + 0.0


@guarded(v=Points(3))
def skew_matrix(v: Array) -> Array:
    """Return [v]× (..., 3, 3), the matrix of the cross product: [v]× w = v × w.

    Examples
    --------
    >>> skew_matrix([1, 2, 3]) @ [4, 5, 6]
    array([-3.,  6., -3.])
    """
    return np.asarray((v @ _CROSS).reshape(*v.shape, 3))


def pose(R: npt.ArrayLike, T: npt.ArrayLike) -> Array:
    """Join R (..., 3, 3) and T (..., 3) to the rigid motion G (..., 4, 4).

    Examples
    --------
    >>> pose(np.eye(3), [1, 2, 3])[:3, 3]
    array([1., 2., 3.])
    """
    R, T = rotation(R), points(T, "T", 3)
    stack = equally_many("R and T", R.shape[:-2], T.shape[:-1])
    G = np.zeros((*stack, 4, 4))
    G[..., :3, :3], G[..., :3, 3], G[..., 3, 3] = R, T, 1.0
    return G


def inverse(G: npt.ArrayLike) -> Array:
    """Invert rigid motions (..., 4, 4): [Rᵀ  −RᵀT; 0 1].

    Examples
    --------
    >>> from cvnotes.camera import rotation_from_vector
    >>> G = pose(rotation_from_vector([0, 0, 1]), [1, 2, 3])
    >>> np.allclose(inverse(G) @ G, np.eye(4))
    True
    """
    G = rigid_motion(G)
    R_inv = G[..., :3, :3].mT
    return pose(R_inv, -(R_inv @ G[..., :3, 3, None])[..., 0])


def move(G: npt.ArrayLike, W: npt.ArrayLike) -> Array:
    """Carry points W (..., 3) into the other frame: M = R W + T.

    Examples
    --------
    >>> move(pose(np.eye(3), [0, 0, 5]), [1, 1, 0])
    array([1., 1., 5.])
    """
    G, W = rigid_motion(G), points(W, "W", 3)
    equally_many("the motions G and the sets of points W", G.shape[:-2], W.shape[:-2])
    if W.ndim == 1:
        return G[..., :3, :3] @ W + G[..., :3, 3]
    return W @ G[..., :3, :3].mT + G[..., None, :3, 3]


def look_at(eye: npt.ArrayLike, target: npt.ArrayLike, up: npt.ArrayLike = (0, -1, 0)) -> Array:
    """Return the G of a camera at `eye` that looks at `target`, both (3,) in the WRF.

    `up` is the world direction that points up in the picture (the default: y runs down, as in
    the camera's own frame).

    Raises
    ------
    DegenerateError
        `eye` and `target` coincide, or the line of sight is parallel to `up`.

    Examples
    --------
    >>> look_at([0, 0, -5], [0, 0, 0])[:3, 3]
    array([0., 0., 5.])
    """
    eye, target, up = points(eye, "eye", 3), points(target, "target", 3), points(up, "up", 3)
    if not eye.ndim == target.ndim == up.ndim == 1:
        raise ShapeError("eye, target and up: expected one point (3,) each; loop over several")
    z = target - eye
    x = np.cross(z, up)
    length = np.linalg.norm(z)
    if length == 0:
        raise DegenerateError("eye and target coincide: there is no line of sight")
    if np.linalg.norm(x) <= 1e-9 * length * np.linalg.norm(up):
        raise DegenerateError("the line of sight is parallel to up; choose another up")
    z = z / length
    x = x / np.linalg.norm(x)
    R = np.stack([x, np.cross(z, x), z])
    return pose(R, -R @ eye + 0.0)


def chain(*motions: npt.ArrayLike) -> Array:
    """Chain rigid motions from left to right as they are written: a ← b ← c is chain(ab, bc).

    Examples
    --------
    >>> chain(pose(np.eye(3), [1, 0, 0]), pose(np.eye(3), [0, 2, 0]))[:3, 3]
    array([1., 2., 0.])
    """
    if not motions:
        raise CvnotesError("chain needs at least one rigid motion")
    guarded = [rigid_motion(G, f"motions[{i}]") for i, G in enumerate(motions)]
    equally_many("the motions", *(G.shape[:-2] for G in guarded))
    return reduce(np.matmul, guarded)


def board_from_board(cam_from_to: npt.ArrayLike, cam_from_from: npt.ArrayLike) -> Array:
    """Chain the WRFs of two views of a board that moved before a fixed camera.

    W_to = G_to⁻¹ G_from W_from: the two boards are seen from one CRF. This is one of the two
    readings of the notes' "transformation chaining" (erratum E20); `cam_from_cam` is the other.

    Examples
    --------
    >>> near, far = pose(np.eye(3), [0, 0, 500]), pose(np.eye(3), [10, 0, 700])
    >>> move(board_from_board(near, far), [0, 0, 0])  # the far board's origin, in the near's WRF
    array([ 10.,   0., 200.])
    """
    to, start = (
        rigid_motion(cam_from_to, "cam_from_to"),
        rigid_motion(cam_from_from, "cam_from_from"),
    )
    return chain(inverse(to), start)


def cam_from_cam(to_from_world: npt.ArrayLike, from_from_world: npt.ArrayLike) -> Array:
    """Chain the CRFs of two views of a fixed board by a camera that moved.

    M_to = G_to G_from⁻¹ M_from: the two cameras see one WRF (the second reading of E20).

    Examples
    --------
    >>> left, right = pose(np.eye(3), [0, 0, 500]), pose(np.eye(3), [-100, 0, 500])
    >>> cam_from_cam(right, left)[:3, 3]  # what the left camera calls its origin
    array([-100.,    0.,    0.])
    """
    to = rigid_motion(to_from_world, "to_from_world")
    return chain(to, inverse(rigid_motion(from_from_world, "from_from_world")))
