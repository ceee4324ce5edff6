"""Cameras in 3-D figures: their pyramids, rays, and the pictures in them."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, ShapeError, number, points
from cvnotes.camera import Camera, inverse, move, xy_from_px
from cvnotes.camera.model import is_camera
from cvnotes.show.guards import eight_bits
from cvnotes.show.space.shapes import Label, Lines, Photo, Shapes
from cvnotes.show.style import CAMERA, LENS


def camera_shapes(
    camera: Camera,
    depth: float = 100.0,
    *,
    image: npt.NDArray[np.uint8] | None = None,
    name: str = "camera",
) -> Shapes:
    """Return a camera: its centre, and the pyramid to its image plane at z = `depth`.

    Parameters
    ----------
    camera : Camera
        Where it stands, and what it sees.
    depth : float
        How far away the image plane is drawn; the true one, z = 1, would be too small to see.
    image : ndarray of uint8, optional
        A picture to put on the image plane, (height, width) or (height, width, 3).
    name : str
        Written beside its centre.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> [shape.name for shape in camera_shapes(Camera(intrinsics(800, 800, 320, 240)))]
    ['camera pyramid', 'camera']
    """
    w, h = is_camera(camera, "camera").size
    depth = number(depth, "depth")
    border = [[-0.5, -0.5], [w - 0.5, -0.5], [w - 0.5, h - 0.5], [-0.5, h - 0.5]]
    corners = _on_plane(camera, xy_from_px(camera.A, border), depth)
    around = np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)
    spokes = np.stack([np.broadcast_to(camera.centre, (4, 3)), corners], axis=1)
    # A tick on the upper side says which way is up.
    left, right = _on_plane(camera, xy_from_px(camera.A, [[0.4 * w, -0.5], [0.6 * w, -0.5]]), depth)
    up = (left + right) / 2 - 0.1 * (corners[3] - corners[0])
    ends = np.concatenate([around, spokes, [[left, up], [up, right]]])
    shapes: Shapes = (Lines(f"{name} pyramid", ends, CAMERA),)
    if image is not None:
        shapes += (Photo(f"{name} picture", corners, _picture(image)),)
    return (*shapes, Label(name, camera.centre, CAMERA, camera.centre - up))


def ray_shapes(camera: Camera, m: npt.ArrayLike, *, to: npt.ArrayLike) -> Shapes:
    """Return the rays that pixels see, from the camera's centre.

    Parameters
    ----------
    camera : Camera
        Whose rays.
    m : array_like, shape (..., 2)
        Pixels. Those that the lens model does not reach have no ray.
    to : array_like, shape (..., 3)
        World points to end near: each ray is as long as its point is far.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> camera = Camera(intrinsics(800, 800, 320, 240))
    >>> lines, = ray_shapes(camera, [320, 240], to=[0, 0, 1000])
    >>> lines.ends[0, 1]
    array([   0.,    0., 1000.])
    """
    d = is_camera(camera, "camera").ray(m)
    reach = np.linalg.norm(points(to, "to", 3) - camera.centre, axis=-1)[..., None]
    if reach.shape[:-1] != d.shape[:-1]:
        raise ShapeError(f"to: expected one point for each of the rays {d.shape[:-1]}")
    tips = (camera.centre + reach * d).reshape(-1, 3)
    tips = tips[np.isfinite(tips[:, 0])]
    ends = np.stack([np.broadcast_to(camera.centre, tips.shape), tips], axis=1)
    return (Lines("rays", ends, LENS, 1.0),)


def _on_plane(camera: Camera, xy: Array, z: float) -> Array:
    """Place points (n, 2) of the plane z = 1 on the plane z, in the WRF."""
    M = np.concatenate([xy, np.ones_like(xy[:, :1])], axis=-1) * z
    return move(inverse(camera.G), M)


def _picture(image: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """Guard a picture; grey becomes red, green, blue."""
    image = eight_bits(image)
    return image if image.ndim == 3 else np.repeat(image[..., None], 3, axis=2)
