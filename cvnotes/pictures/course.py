"""The running example of the course: one camera, one board, twelve pictures, and real corners.

Everything is read from the folder ``data/`` of the repository, which ``tools/make_data.py`` makes
and an installed package brings along; ``data/README.md`` says what each file is.
"""

import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, FileError, whole
from cvnotes.base.material import material
from cvnotes.camera import Camera, rotation_from_vector
from cvnotes.files import read_camera, read_photo
from cvnotes.pictures.placing import hold_at
from cvnotes.targets import Chessboard

DATA = material("data")


class RealCorners(NamedTuple):
    """Corners measured in real photographs of a board, by a pair of cameras."""

    board: Chessboard
    size: tuple[int, int]
    names: tuple[str, ...]  # of the 13 pairs of photographs
    left: Array  # (13, 54, 2) px
    right: Array  # (13, 54, 2) px


def camera() -> Camera:
    """Return the course's camera, with its own frame as the WRF.

    Examples
    --------
    >>> camera().A
    array([[800.,   0., 325.],
           [  0., 804., 238.],
           [  0.,   0.,   1.]])
    """
    return read_camera(_file("camera.json"))


def board() -> Chessboard:
    """Return the course's board: 9 × 6 inner corners, 25 mm apart.

    Examples
    --------
    >>> board().corners
    (9, 6)
    """
    return Chessboard((9, 6), 25.0)


def poses() -> Array:
    """Return the pose of the board in each of the twelve pictures, (12, 4, 4), CRF ← board.

    Examples
    --------
    >>> poses().shape
    (12, 4, 4)
    """
    return np.array(_json("views.json")["poses"])


def photos() -> list[npt.NDArray[np.uint8]]:
    """Return the twelve pictures, grey (480, 640).

    Examples
    --------
    >>> len(photos())
    12
    """
    return [photo(i) for i in range(12)]


def photo(i: int) -> npt.NDArray[np.uint8]:
    """Return one of the twelve pictures, grey (480, 640).

    Examples
    --------
    >>> photo(6).shape
    (480, 640)
    """
    i = whole(i, "i", at_least=0, at_most=11)
    return np.asarray(read_photo(_file(f"views/view_{i:02d}.png")).image)


def exact_corners() -> Array:
    """Return the true corners of the twelve pictures, (12, 54, 2), px.

    Examples
    --------
    >>> bool(np.allclose(exact_corners()[0], camera().moved(poses()[0]).project(board().points)))
    True
    """
    return np.array(_json("views.json")["exact_corners"])


def measured_corners() -> Array:
    """Return the corners that `find_corners` finds in the twelve pictures, (12, 54, 2), px.

    Examples
    --------
    >>> bool(np.abs(measured_corners() - exact_corners()).max() < 0.2)
    True
    """
    return np.array(_json("views.json")["measured_corners"])


def first_pose() -> Array:
    """Return where the board is in the first photograph of chapter 0, (4, 4), CRF ← board.

    Its last corner is the one that the head of every chapter follows.

    Examples
    --------
    >>> camera().moved(first_pose()).project([200, 125, 0]).round(1)
    array([522.8, 327.4])
    """
    tilt = rotation_from_vector([0.45, 0.25, -0.03])
    return hold_at(board(), camera(), tilt, aim=[330, 215], farther=1.15)


def first_corners() -> Array:
    """Return the corners found in the twelve photographs in a room of chapter 0, (12, 54, 2), px.

    Examples
    --------
    >>> first_corners().shape
    (12, 54, 2)
    """
    return np.array(_json("first_corners.json")["corners"])


def real_corners() -> RealCorners:
    """Return the corners that `find_corners` finds in 13 real pairs of photographs.

    Examples
    --------
    >>> real_corners().left.shape
    (13, 54, 2)
    """
    stored = _json("real_corners.json")
    return RealCorners(
        Chessboard(tuple(stored["corners"]), stored["square"]),
        tuple(stored["size"]),
        tuple(stored["names"]),
        np.array(stored["left"]),
        np.array(stored["right"]),
    )


def _file(name: str) -> Path:
    path = DATA / name
    if not path.exists():
        raise FileError(
            f"data/{name} is missing from {DATA.parent}: the course's data come with the package "
            "and with a clone of the repository (python tools/make_data.py makes them again)"
        )
    return path


def _json(name: str) -> dict[str, Any]:
    return dict(json.loads(_file(name).read_text()))
