"""Carry a camera round a board by hand: from a place on the sheet to angles and T."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, rotation_from_vector
from cvnotes.show.explorations.boards import on_sheet
from cvnotes.show.explorations.model import Values
from cvnotes.targets import Chessboard

_SPEED = 2.0  # radians for one radius on the sheet, on which the sphere is foreshortened
_STEEPEST = np.radians(75)  # the camera stays on the side from which the board is seen


def round_the_board(camera: Camera, board: Chessboard, at: Array) -> Values:
    """Carry a camera round the middle of a board, by as much as a hand pulls it on the sheet.

    Along a sphere: to the right round the board's vertical axis, downwards towards its lower side.
    The camera turns along, so that the board's middle stays where it is in the picture.
    """
    middle = board.points.mean(axis=0)
    before = camera.centre - middle
    radius = float(np.linalg.norm(before))
    if radius < 1e-9:
        return {}
    x, y, z = before / radius
    aside, below = np.arctan2(x, -z), np.arcsin(np.clip(y, -1, 1))
    by = _SPEED * (at - on_sheet(camera.centre)) / radius
    after = np.clip([aside + by[0], below + by[1]], -_STEEPEST, _STEEPEST)
    R = camera.R @ _facing(aside, below) @ _facing(*after.tolist()).T
    T = camera.R @ middle + camera.T - R @ middle
    x, y, z = np.degrees(angles_of(R)).tolist()
    return {
        "angle_x": x, "angle_y": y, "angle_z": z,
        "T_x": float(T[0]), "T_y": float(T[1]), "T_z": float(T[2]),
    }  # fmt: skip


def _facing(aside: float, below: float) -> Array:
    """Return the rotation (3, 3) from straight before the board to so far aside and below."""
    return rotation_from_vector([0, -aside, 0]) @ rotation_from_vector([below, 0, 0])


def angles_of(R: Array) -> Array:
    """Return the angles (3,) about the fixed axes x, y, z of a rotation R = Rz Ry Rx.

    Examples
    --------
    >>> from cvnotes.camera import rotation_from_angles
    >>> angles_of(rotation_from_angles(0.1, -0.2, 0.3)).round(12)
    array([ 0.1, -0.2,  0.3])
    """
    y = -np.arcsin(np.clip(R[2, 0], -1, 1))
    return np.array([np.arctan2(R[2, 1], R[2, 2]), y, np.arctan2(R[1, 0], R[0, 0])])
