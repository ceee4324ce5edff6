"""The printed faces of a target, held before a camera: what is seen in each direction.

All is said with planes through the camera. A line of a board spans one, whose normal is the cross
product of the line's ends; on which side of it a direction d = (x, y, 1) lies is the sign of one
scalar product, and counting the lines that d has passed gives the field it meets. A board's own
plane n·M = 1 gives the depth: M = z d, hence 1/z = n·d.
"""

from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, rigid_motion

Mask = npt.NDArray[np.bool_]

PAPER, INK = 220.0, 30.0  # grey levels of a printed face in even light
_THIN = 1e-5  # a face thinner than this, on z = 1, is not seen; closer planes count as one


class Target(Protocol):
    """What can be photographed: chessboards, each with its pose in the target's frame."""

    @property
    def faces(self) -> tuple[tuple[Array, Any], ...]:
        """Pairs (``world_from_board`` (4, 4), board)."""


@dataclass(frozen=True)
class Face:
    """A printed board before a camera, in the CRF.

    Parameters
    ----------
    plane : ndarray, shape (3,)
        The n of n·M = 1.
    lines : ndarray, shape (n, 2, 3)
        Both ends of each line: first those that follow each other along the board's x axis.
    passed : ndarray, shape (n, 3)
        For each line the normal with normal·d > 0 in the directions that have passed it.
    grey : ndarray, shape (rows, columns)
        Grey levels of the fields between the lines.
    """

    plane: Array
    lines: Array
    passed: Array
    grey: Array

    def grey_along(self, d: Array) -> tuple[Mask, Array]:
        """Tell which directions (m, 3) meet the face, and the grey levels (m,) they find."""
        beyond = d @ self.passed.T > 0
        rows, columns = self.grey.shape
        i, j = beyond[:, : columns + 1].sum(axis=1) - 1, beyond[:, columns + 1 :].sum(axis=1) - 1
        hit = (d @ self.plane > 0) & (i >= 0) & (i < columns) & (j >= 0) & (j < rows)
        return hit, self.grey[j * hit, i * hit]


def faces_before_camera(target: Target, cam_from_world: Array, margin: float) -> list[Face]:
    """Carry the faces of a target into a camera's frame, the nearest plane first.

    Each board has `margin` squares of white paper around it; from behind it is plain paper. Faces
    seen edge on are left out.

    Examples
    --------
    >>> from cvnotes.camera import look_at
    >>> from cvnotes.targets import Chessboard
    >>> (face,) = faces_before_camera(Chessboard((4, 3)), look_at([0, 0, -500], [0, 0, 0]), 1.0)
    >>> face.grey
    array([[220., 220., 220., 220., 220., 220., 220.],
           [220.,  30., 220.,  30., 220.,  30., 220.],
           [220., 220.,  30., 220.,  30., 220., 220.],
           [220.,  30., 220.,  30., 220.,  30., 220.],
           [220., 220.,  30., 220.,  30., 220., 220.],
           [220., 220., 220., 220., 220., 220., 220.]])
    """
    held = []
    for world_from_board, board in target.faces:
        G = cam_from_world @ rigid_motion(world_from_board, "world_from_board")
        distance = float(G[:3, 2] @ G[:3, 3])  # of the board's plane, < 0 from behind
        x, y, grey = _print(board, margin, plain=distance < 0)
        across = [[[X, y[0], 0], [X, y[-1], 0]] for X in x]
        down = [[[x[0], Y, 0], [x[-1], Y, 0]] for Y in y]
        lines = np.array(across + down) @ G[:3, :3].T + G[:3, 3]
        extent = np.linalg.norm(lines[0, 0] - lines[-1, 1])
        if abs(distance) * extent <= _THIN * (lines**2).sum(axis=-1).max():
            continue
        # det(p0, p1, M) has the sign of distance·(X0 − X) for one family, (Y − Y0) for the other.
        sign = np.sign(distance) * np.repeat([-1, 1], [len(x), len(y)])
        passed = sign[:, None] * np.cross(lines[:, 0], lines[:, 1])
        held.append((abs(distance), Face(G[:3, 2] / distance, lines, passed, grey)))
    held.sort(key=lambda pair: pair[0])
    return _aligned([face for _, face in held])


def nearest_grey(faces: list[Face], xy: Array) -> Array:
    """Return the grey level of what is nearest at points `xy` of the plane z = 1, and 1: (m, 2).

    Rows are (0, 0) where nothing is.

    Examples
    --------
    >>> from cvnotes.camera import look_at
    >>> from cvnotes.targets import Chessboard
    >>> cam_from_world = look_at([0, 0, -500], [0, 0, 0])
    >>> faces = faces_before_camera(Chessboard((4, 3)), cam_from_world, 1.0)
    >>> nearest_grey(faces, np.array([[-0.01, -0.01], [0.01, -0.01], [-0.2, 0.0]]))
    array([[ 30.,   1.],
           [220.,   1.],
           [  0.,   0.]])
    """
    d = np.column_stack([xy, np.ones(len(xy))])
    front, seen = np.zeros((len(xy), 3)), np.zeros((len(xy), 2))
    for face in faces:
        hit, grey = face.grey_along(d)
        # One difference instead of two depths, so that `folds` agrees to the last digit.
        nearer = hit & (((face.plane - front) * d).sum(axis=1) > 0)
        front[nearer], seen[nearer, 0], seen[nearer, 1] = face.plane, grey[nearer], 1
    return seen


def folds(faces: list[Face]) -> list[Array]:
    """Return the lines (1, 2, 3) in which the planes of two faces meet, as long as the first.

    Examples
    --------
    >>> from cvnotes.camera import look_at
    >>> from cvnotes.targets import TwoPlanes
    >>> cam_from_world = look_at([300, 0, -400], [0, 0, 0])
    >>> (fold,) = folds(faces_before_camera(TwoPlanes(), cam_from_world, 1.0))
    >>> abs(fold[0, 1] - fold[0, 0]).round()  # the common edge, 9 fields of 25 mm, is upright
    array([  0., 225.,   0.])
    """
    found = []
    for first, second in combinations(faces, 2):
        normals = np.stack([first.plane, second.plane])
        along = np.cross(*normals)
        length = np.linalg.norm(along)
        if length <= _THIN * np.prod(np.linalg.norm(normals, axis=1)):
            continue  # parallel
        along = along / length
        foot = np.linalg.solve(np.vstack([normals, along]), [1, 1, 0])
        reach = first.lines @ along
        found.append(np.array([[foot + reach.min() * along, foot + reach.max() * along]]))
    return found


def _print(board: Any, margin: float, plain: bool) -> tuple[Array, Array, Array]:
    """Say where the lines of a printed board lie, and how grey the fields between them are."""
    x, y, dark = board.printed
    grey = np.where(dark & (not plain), INK, PAPER)
    if margin > 0:
        grey = np.pad(grey, 1, constant_values=PAPER)
        white = margin * board.square
        x, y = (np.concatenate([[z[0] - white], z, [z[-1] + white]]) for z in (x, y))
    return x, y, grey


def _aligned(faces: list[Face]) -> list[Face]:
    """Put faces whose planes nearly agree into one plane, where the earlier one is in front."""
    for i, j in combinations(range(len(faces)), 2):
        plane = faces[i].plane
        if np.linalg.norm(faces[j].plane - plane) <= _THIN * np.linalg.norm(plane):
            faces[j] = replace(faces[j], plane=plane)
    return faces
