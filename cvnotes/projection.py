"""The image of points given in the CRF, together with its derivative (notes 2b.3, the flow)."""

from typing import Any

import numpy as np

from cvnotes.camera import Camera, pixels
from cvnotes.errors import Array, InputTypeError


def is_camera(x: Any, name: str) -> Camera:
    """Guard a camera.

    Examples
    --------
    >>> is_camera("left.json", "left")
    Traceback (most recent call last):
    cvnotes.errors.InputTypeError: left: expected a Camera, got str
    """
    if not isinstance(x, Camera):
        raise InputTypeError(f"{name}: expected a Camera, got {type(x).__name__}")
    return x


def project_with_derivative(camera: Camera, M: Array) -> tuple[Array, Array]:
    """Image points M (n, 3) of the CRF: pixels m (n, 2), and dm/dM (n, 2, 3).

    Rows that are not in front of the camera, or that its lens does not reach, are NaN in both.
    No guard: for use inside, by who refines.

    Notes
    -----
    dm/dM = A₂ₓ₂ · d(x', y')/d(x, y) · [1 0 −x; 0 1 −y] / z.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> camera = Camera(intrinsics(800, 800, 320, 240))
    >>> project_with_derivative(camera, np.array([[0.0, 1, 10]]))
    (array([[320., 320.]]), array([[[80.,  0.,  0.],
            [ 0., 80., -8.]]]))
    """
    z = np.where(M[:, 2:] > 0, M[:, 2:], np.nan)
    xy = M[:, :2] / z
    m = pixels(camera.A, camera.lens._distort(xy))
    by_xy = np.full((len(M), 2, 2), np.nan)
    valid = np.isfinite(m).all(-1)
    by_xy[valid] = camera.A[:2, :2] @ camera.lens.jacobian(xy[valid])
    along_z = -by_xy @ xy[:, :, None]
    return m, np.concatenate([by_xy, along_z], axis=-1) / z[:, :, None]
