"""A camera and pictures of one's own for each student: the same work, other numbers.

Every number is made of the student's id by SHA-256 alone, so that it is the same on all systems
and with all versions of all libraries. The poses and the noise follow from them by arithmetic and
are rounded.
"""

import unicodedata
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError
from cvnotes.camera import Camera, Lens, intrinsics, pose, rotation_from_vector
from cvnotes.targets import Chessboard

_SIZE = (640, 480)
_VIEWS = 10
_NOISE = 0.2  # px


@dataclass(frozen=True, eq=False)
class PersonalCamera:
    """A camera, a board and views that belong to one student.

    Attributes
    ----------
    student : str
        The id, as it was understood.
    board : Chessboard
        What is photographed.
    poses : ndarray, shape (10, 4, 4)
        Its pose in each picture, CRF ← board.

    Examples
    --------
    >>> personal_camera("Ada").size
    (640, 480)
    """

    student: str
    _camera: Camera
    board: Chessboard
    poses: Array

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the pictures."""
        return _SIZE

    def truth(self) -> Camera:
        """Return the camera itself, with its own frame as the WRF: what a calibration should find.

        It is a method, so that nobody who looks around in the object, or presses tab, is told the
        answer before the question. Whoever asks for it wants to compare.

        Examples
        --------
        >>> personal_camera("Ada").truth().A.shape
        (3, 3)
        """
        return self._camera

    @cached_property
    def corners(self) -> Array:
        """The corners found in each picture, (10, n, 2), with noise of 0.2 px."""
        exact = [self._camera.moved(G).project(self.board.points) for G in self.poses]
        noise = normals(self.student, "noise", 2 * _VIEWS * len(self.board.points))
        return np.round(np.stack(exact) + _NOISE * noise.reshape(_VIEWS, -1, 2), 4)

    def photos(self) -> list[npt.NDArray[np.uint8]]:
        """Take the ten pictures, grey (480, 640), a little blurred and noisy."""
        from cvnotes.pictures import render

        rng = np.random.Generator(np.random.PCG64(_whole(self.student, "photos")))
        cameras = [self._camera.moved(G) for G in self.poses]
        return [render(self.board, camera, blur=0.7, noise=2.0, rng=rng) for camera in cameras]

    def __repr__(self) -> str:
        columns, rows = self.board.corners
        return (
            f"PersonalCamera({self.student!r}: {_VIEWS} pictures of a {columns}×{rows} board, "
            f"squares of {self.board.square:g} mm)"
        )


def personal_camera(student: str | int) -> PersonalCamera:
    """Return the camera, board and pictures of one student.

    Parameters
    ----------
    student : str or int
        Any id; capitals and spaces around it do not matter.

    Returns
    -------
    PersonalCamera
        Always the same for the same id.

    Raises
    ------
    CvnotesError
        The id is empty or no text.

    Examples
    --------
    >>> personal_camera("Ada").corners.shape
    (10, 54, 2)
    >>> personal_camera(" ada").student == personal_camera("Ada").student
    True
    """
    if isinstance(student, int):
        student = str(student)
    if not isinstance(student, str) or not student.strip():
        raise CvnotesError(f"student: expected your id, a text that is not empty, got {student!r}")
    name = unicodedata.normalize("NFKC", student).strip().casefold()
    u = uniforms(name, "camera", 7)
    alpha_u = round(700 + 250 * u[0], 1)
    ratio = 1.03 + 0.04 * u[1]
    A = intrinsics(
        alpha_u, round(alpha_u * ratio, 1), round(300 + 40 * u[2], 1), round(220 + 40 * u[3], 1)
    )
    k = (round(-0.28 + 0.12 * u[4], 3), round(0.04 + 0.06 * u[5], 3))
    square = round(22 + 8 * u[6], 1)
    board = Chessboard((9, 6), square)
    camera = Camera(A, lens=Lens(k), size=_SIZE)
    return PersonalCamera(name, camera, board, _poses(name, camera, board))


def uniforms(name: str, purpose: str, n: int) -> Array:
    """Return n numbers in [0, 1) that depend on a name and a purpose only.

    Examples
    --------
    >>> uniforms("ada", "camera", 2).round(6)
    array([0.56006, 0.39901])
    """
    digests = (sha256(f"{name}/{purpose}/{i}".encode()).digest()[:6] for i in range(n))
    return np.array([int.from_bytes(digest, "big") / 2**48 for digest in digests])


def normals(name: str, purpose: str, n: int) -> Array:
    """Return n numbers with a standard normal distribution, rounded to 4 decimals."""
    u = uniforms(name, purpose, 2 * n).reshape(2, n)
    return np.asarray(np.round(np.sqrt(-2 * np.log1p(-u[0])) * np.cos(2 * np.pi * u[1]), 4))


def _whole(name: str, purpose: str) -> int:
    return int.from_bytes(sha256(f"{name}/{purpose}".encode()).digest()[:8], "big")


def _poses(name: str, camera: Camera, board: Chessboard) -> Array:
    """Hold the board tilted by 20° to 40° to all sides, whole in the picture."""
    u = uniforms(name, "poses", 5 * _VIEWS).reshape(_VIEWS, 5)
    around = 2 * np.pi * (np.arange(_VIEWS) + u[:, 0]) / _VIEWS
    tilt = np.radians(20 + 20 * u[:, 1])
    axis = np.stack([np.cos(around), np.sin(around), 0 * around], axis=1)
    R = rotation_from_vector(tilt[:, None] * axis)
    # as far away as makes its squares 46 to 58 % of the picture's width, and all over the picture
    part = 0.46 + 0.12 * u[:, 2]
    z = 10 * board.square * camera.A[0, 0] / (_SIZE[0] * part)
    room = (1 - 1.26 * part)[:, None] * np.array(_SIZE)
    aim = np.array(_SIZE) / 2 + room * (u[:, 3:] - 0.5)
    ideal = (aim - camera.A[:2, 2]) / np.diag(camera.A)[:2]
    middle = np.column_stack([z[:, None] * ideal, z])
    return np.asarray(np.round(pose(R, middle - R @ board.points.mean(0)), 9))
