"""Pictures to read a number off: rendered by known cameras, so that the checker knows it too."""

from functools import cache

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics, look_at, pose, rotation_from_angles
from cvnotes.targets import Chessboard


def rails_camera() -> Camera:
    """Return the camera of `rails_picture`: turned to the left, and lowered below the horizon.

    Examples
    --------
    >>> rails_camera().size
    (640, 480)
    """
    G = look_at([0, 0, 0], [-0.13, 0.45, 1.0])
    return Camera(intrinsics(700, 700, 319.5, 239.5), G)


def rails_picture() -> npt.NDArray[np.uint8]:
    """Photograph the rails: (480, 640, 3), for the exercise ``where_the_rails_meet``."""
    from cvnotes.pictures import rails, render_scene

    return render_scene(rails(), rails_camera())


def turned_board() -> tuple[Chessboard, Camera]:
    """Return the board of `board_picture`, and the camera that sees it turned.

    Examples
    --------
    >>> turned_board()[0].corners
    (4, 3)
    """
    R = rotation_from_angles(0.35, -0.3, 2.5)
    T = np.array([4.0, -2.0, 450.0]) - R @ [45, 30, 0]
    camera = Camera(intrinsics(500, 500, 159.5, 119.5), pose(R, T), size=(320, 240))
    return Chessboard((4, 3), 30.0), camera


def board_picture() -> npt.NDArray[np.uint8]:
    """Photograph the turned board in a room: (240, 320, 3), for the exercise ``first_corner``.

    Examples
    --------
    >>> board_picture().shape
    (240, 320, 3)
    """
    from cvnotes.pictures import render_scene, room_with

    board, camera = turned_board()
    return render_scene(room_with(board, camera.G), Camera(camera.A, size=camera.size))


def stereo_cameras() -> tuple[Camera, Camera]:
    """Return the two cameras of `stereo_pictures`, 800 mm apart, with parallel axes.

    Examples
    --------
    >>> left, right = stereo_cameras()
    >>> right.centre - left.centre
    array([800.,   0.,   0.])
    """
    A = intrinsics(640, 640, 319.5, 239.5)
    left, right = (Camera(A, pose(np.eye(3), [x, 0, -1300])) for x in (300, -500))
    return left, right


@cache
def nearest_edge() -> Array:
    """Return the top (3,) of the nearest upright edge of the red block in `stereo_pictures`.

    Examples
    --------
    >>> nearest_edge().round()
    array([  977., -3400., 10206.])
    """
    from cvnotes.pictures import blocks

    corners = blocks().vertices[:8]
    nearest = corners[np.isclose(corners[:, 2], corners[:, 2].min())]
    return np.asarray(nearest[nearest[:, 1].argmin()])


def stereo_pictures() -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.uint8]]:
    """Photograph the blocks twice: (480, 640, 3) each, for the exercise ``how_far``."""
    from cvnotes.pictures import blocks, render_scene

    left, right = (render_scene(blocks(), camera) for camera in stereo_cameras())
    return left, right
