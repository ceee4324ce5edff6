"""Hold a target so that a camera sees it: turned to the camera, all of it inside the picture."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    MOST,
    Array,
    DegenerateError,
    ShapeError,
    number,
    points,
    rigid_motion,
    rotation,
)
from cvnotes.camera import Camera, move, pose
from cvnotes.camera.model import is_camera
from cvnotes.pictures.faces import Target, is_target

_PUSHES = 20  # after which a target no longer moves
_ROOM = 4.0  # pixels kept free along the border of the picture


def target_and_camera(target: Target, camera: Camera) -> None:
    """Refuse what has no faces, and what is no camera."""
    is_target(target)
    is_camera(camera, "camera")


def facing(target: Target) -> Array:
    """Return the rotation (3, 3), CRF ← target, that turns the mean of all faces to the camera.

    Raises
    ------
    DegenerateError
        The faces look in opposite directions.

    Examples
    --------
    >>> from cvnotes.targets import Chessboard, TwoPlanes
    >>> facing(Chessboard((9, 6)))
    array([[1., 0., 0.],
           [0., 1., 0.],
           [0., 0., 1.]])
    >>> (facing(TwoPlanes()) @ [1, 0, -1]).round(3) + 0.0  # out of the fold, to the camera
    array([ 0.   ,  0.   , -1.414])
    """
    z = np.sum([G[:3, 2] for G, _ in target.faces], axis=0)
    x = np.cross(target.faces[0][0][:3, 1], z)
    if np.linalg.norm(x) < 1e-6:
        raise DegenerateError("the faces of the target look in opposite directions")
    x, z = x / np.linalg.norm(x), z / np.linalg.norm(z)
    return np.stack([x, np.cross(z, x), z])


def hold_at(
    target: Target, camera: Camera, R: npt.ArrayLike, aim: npt.ArrayLike, farther: float = 1.0
) -> Array:
    """Return the pose G (4, 4) of a target seen at pixel `aim`, as large as the picture allows.

    Parameters
    ----------
    target : Target
        Anything with ``faces``.
    camera : Camera
        Who looks; its own pose does not matter.
    R : array_like, shape (3, 3)
        How the target is turned, CRF ← target.
    aim : array_like, shape (2,)
        Where the middle of the target is to be seen.
    farther : float
        Factor on the distance.

    Raises
    ------
    DegenerateError
        At no distance do all squares lie inside the picture, or the lens shows nothing there.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> from cvnotes.targets import Chessboard
    >>> camera, board = Camera(intrinsics(800, 800, 320, 240)), Chessboard((9, 6), 25.0)
    >>> G = hold_at(board, camera, np.eye(3), [320, 240])
    >>> camera.moved(G).project(board.points[[0, -1]]).round()
    array([[ 70.,  83.],
           [570., 397.]])
    """
    target_and_camera(target, camera)
    R, aim, outline = rotation(R), points(aim, "aim", 2), _outline(target)
    if R.ndim != 2 or aim.ndim != 1:
        raise ShapeError(f"expected one rotation R and one pixel aim, got {R.shape}, {aim.shape}")
    farther = number(farther, "farther", at_least=1e-3, at_most=MOST)
    middle = (outline.min(axis=0) + outline.max(axis=0)) / 2
    ray = np.append(camera.ideal(aim), 1.0)
    if not np.isfinite(ray).all():
        raise DegenerateError(f"aim: pixel {aim.tolist()} is beyond the reach of the lens")
    half = (np.array(camera.size) - 1) / 2
    nearest = np.linalg.norm(outline - middle, axis=1).max()
    camera = Camera(camera.A, lens=camera.lens, size=camera.size)
    turned = (outline - middle) @ R.T
    for distances in np.split(nearest * 1.03 ** np.arange(200), 10):
        m = camera.project(turned + (distances[:, None] * ray)[:, None])
        inside = (np.abs(m - half) <= half - _ROOM).all(axis=(1, 2))  # never true for NaN
        if inside.any():
            return pose(R, farther * distances[inside.argmax()] * ray - R @ middle)
    raise DegenerateError(
        f"the target does not fit into a picture of {camera.size[0]}×{camera.size[1]} pixels"
    )


def pushed_into_corner(
    target: Target, camera: Camera, G: npt.ArrayLike, corner: tuple[int, int]
) -> Array:
    """Move a target in pose G, turned and as far away as it is, into a corner of the picture.

    Parameters
    ----------
    target : Target
        Anything with ``faces``.
    camera : Camera
        Who looks; its own pose does not matter.
    G : array_like, shape (4, 4)
        Where the target is, whole in the picture.
    corner : (−1 or 1, −1 or 1)
        Left or right, upper or lower.

    Raises
    ------
    DegenerateError
        The lens shows nothing there, or the target is too large.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> from cvnotes.targets import Chessboard
    >>> camera, board = Camera(intrinsics(800, 800, 320, 240)), Chessboard((9, 6), 25.0)
    >>> G = hold_at(board, camera, np.eye(3), [320, 240], 1.6)
    >>> seen = camera.moved(pushed_into_corner(board, camera, G, (-1, 1))).project(board.points)
    >>> seen[:, 0].min().round(), seen[:, 1].max().round()
    (np.float64(43.0), np.float64(436.0))
    """
    G, side, outline = rigid_motion(G), np.array(corner), _outline(target)
    half = (np.array(camera.size) - 1) / 2
    middle = (outline.min(axis=0) + outline.max(axis=0)) / 2
    distance = (G[:3, :3] @ middle + G[:3, 3])[2]
    aim = camera.project(G[:3, :3] @ middle + G[:3, 3])
    for _ in range(_PUSHES):
        T = distance * np.append(camera.ideal(aim), 1.0) - G[:3, :3] @ middle
        m = (camera.moved(pose(G[:3, :3], T)).project(outline) - half) * side
        aim = aim + side * (half - _ROOM - m.max(axis=0))
    if not (np.isfinite(m).all() and (np.abs(m) <= half - _ROOM / 2).all()):
        raise DegenerateError("the target cannot be pushed into this corner of the picture")
    return pose(G[:3, :3], T)


def every_face_seen(target: Target, G: Array) -> bool:
    """Return whether in pose G the camera sees each face from its printed side, by 15° at least.

    Examples
    --------
    >>> from cvnotes.camera import look_at
    >>> from cvnotes.targets import TwoPlanes
    >>> every_face_seen(TwoPlanes(), look_at([300, 0, -300], [0, 0, 0]))
    True
    >>> every_face_seen(TwoPlanes(), look_at([0, 0, -600], [0, 0, 0]))  # along the side face
    False
    """
    for world_from_board, board in target.faces:
        face = G @ world_from_board
        middle = move(face, board.points.mean(axis=0))
        if face[:3, 2] @ middle < np.sin(np.radians(15)) * np.linalg.norm(middle):
            return False
    return True


def _outline(target: Target) -> Array:
    """Points (m, 3) around the outer squares of all faces, dense enough for curved images."""
    t = np.linspace(0, 1, 9)
    around = np.concatenate([np.stack([t, 0 * t], -1), np.stack([0 * t, t], -1)])
    around = np.column_stack([np.concatenate([around, 1 - around]), np.zeros(4 * len(t))])
    faces = [(G, np.array([*board.squares, 0]), board.square) for G, board in target.faces]
    return np.concatenate([move(G, (around * n - [1, 1, 0]) * side) for G, n, side in faces])
