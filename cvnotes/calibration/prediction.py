"""How far predictions may be off: the pixel at which a ray is seen."""

from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, DegenerateError, points
from cvnotes.calibration.coverage import joined
from cvnotes.calibration.result import Calibration
from cvnotes.camera import Camera

_STEP = 1e-6  # of a parameter, relative to its standard deviation or to 1
_CORNERS = 200  # that a camera is turned to meet


def prediction_std(
    calibration: Calibration,
    m: npt.ArrayLike,
    *,
    of: Literal["noise", "views"] = "noise",
    turning: bool = False,
) -> Array:
    """How far off, in pixels, the image of a ray may be that the camera shows at pixels m.

    Parameters
    ----------
    calibration : Calibration
        The camera and the covariance of its parameters.
    m : array_like, shape (..., 2)
        Pixels, for example the corners of the picture.
    of : {"noise", "views"}
        Which covariance: ``covariance``, for residuals that are only noise, or
        ``covariance_of_views``, from the scatter between views.
    turning : bool
        Whether the camera may be turned so that the corners it was calibrated with are met best.
        An error that turns the whole picture is absorbed by poses, or by how a camera is mounted.

    Returns
    -------
    ndarray, shape (...)
        √ trace(J Σ Jᵀ): the standard deviation of the predicted pixel, both coordinates together,
        for a ray that is fixed in the camera's frame. NaN where the lens model does not reach.

    Notes
    -----
    Σ is the covariance of the estimated parameters and J the derivative of the pixel by them.
    Unless the camera may turn, this is a cautious value: a principal point that is off by a pixel
    moves all pixels by one. If it may, J − T T'⁺ J' is in the place of J, T being the derivative by
    a rotation, and T', J' those at the corners.

    References
    ----------
    .. [1] Hartley and Zisserman, Multiple View Geometry, 2nd ed. (2004), 5.2.6, "forward
       propagation of covariance".

    Examples
    --------
    >>> from cvnotes.pictures import course
    >>> from cvnotes.calibration import calibrate
    >>> found = calibrate(course.board().points, course.measured_corners(), (640, 480))
    >>> middle, corner = prediction_std(found, [[320, 240], [0, 0]])
    >>> bool(middle < corner)
    True
    """
    m = points(m, "m", 2)
    if of not in ("noise", "views"):
        raise CvnotesError(f'of: expected "noise" or "views", got {of!r}')
    rays = calibration.camera.ray(m)
    reached = np.isfinite(rays).all(-1)
    rays = np.nan_to_num(rays, nan=1.0)

    def pixels(camera: Camera) -> Array:
        return camera.project(rays)

    of_camera = _pixels_turned(calibration, rays) if turning else pixels

    if of == "noise":
        here = calibration.camera, calibration.names, calibration.covariance
        variance = _variance(*here, of_camera)
    else:
        variance = _variance_of_views(calibration, of_camera)
    return np.asarray(np.sqrt(np.where(reached, variance, np.nan)))


def _pixels_turned(calibration: Calibration, rays: Array) -> Callable[[Camera], Array]:
    """Return what gives the pixels of rays in a camera that is turned to meet the corners."""
    camera, m = calibration.camera, joined(calibration.image_points)
    if not len(m):
        raise DegenerateError("turning: this calibration was read from a file that has no corners")
    corners = camera.ray(m[:: -(-len(m) // _CORNERS)])
    corners = corners[np.isfinite(corners).all(-1)]
    at, moved = camera.project(corners), _turned(camera, rays)
    inverse = np.linalg.pinv(_turned(camera, corners).reshape(-1, 3))

    def pixels(other: Camera) -> Array:
        turn = inverse @ (other.project(corners) - at).ravel()
        return np.asarray(other.project(rays) - moved @ turn)

    return pixels


def _turned(camera: Camera, rays: Array) -> Array:
    """Differentiate the pixels (..., 2, 3) of rays by a rotation of the camera."""
    unit = rays / np.linalg.norm(rays, axis=-1, keepdims=True)
    columns = []
    for axis in np.eye(3):
        up, down = (camera.project(unit + s * _STEP * np.cross(axis, unit)) for s in (1, -1))
        columns.append((up - down) / (2 * _STEP))
    return np.stack(columns, axis=-1)


def _variance_of_views(calibration: Calibration, of: Callable[[Camera], Array]) -> Array:
    """Variance (...) of what is computed from the camera, (..., c), all c coordinates together.

    From the scatter between views, and between models that fit as well: parameters of different
    lenses are not to be compared, but what they predict is.
    """
    C, here = calibration.covariance_of_views, of(calibration.camera)
    if not np.isfinite(C).all():  # known not at all
        return np.full(here.shape[:-1], np.inf)
    if calibration.tied:  # a valley is curved: left-out steps along it are no derivative's steps
        C = max(calibration.times_noise, 1.0) ** 2 * calibration.covariance
    if calibration.tied or calibration.choice is None:
        return _variance(calibration.camera, calibration.names, C, of)
    widest = np.zeros(here.shape[:-1])
    for model in calibration.choice.close:  # the chosen one among them
        off = of(model.camera) - here
        variance = _variance(model.camera, model.names, model.covariance, of)
        widest = np.fmax(widest, variance + np.vecdot(off, off))
    return widest


def _variance(
    camera: Camera, names: Sequence[str], C: Array, of: Callable[[Camera], Array]
) -> Array:
    J = _derivative(of, camera, names)
    return np.asarray(np.einsum("...ci,ij,...cj->...", J, C, J))


def _derivative(of: Callable[[Camera], Array], camera: Camera, names: Sequence[str]) -> Array:
    """Differentiate (..., q) what is computed from a camera by its parameters."""
    value, columns = camera.parameters, []
    for name in names:
        at = value.get(name, 0.0)
        h = _STEP * max(1.0, abs(at))
        up, down = (of(camera.with_parameters({name: at + s * h})) for s in (1, -1))
        columns.append((up - down) / (2 * h))
    return np.stack(columns, axis=-1)


def pixel_jacobian(calibration: Calibration, rays: Array) -> Array:
    """Differentiate the images of rays (..., 3) of a camera that may turn by the parameters.

    (..., 2, q); NaN where the lens model does not reach.
    """
    of_camera = _pixels_turned(calibration, np.nan_to_num(rays, nan=1.0))
    J = _derivative(of_camera, calibration.camera, calibration.names)
    J[~np.isfinite(rays).all(-1)] = np.nan
    return J


def angles_seen(calibration: Calibration) -> tuple[Array, Array]:
    """Return the angles that the seen part of the picture spans, and how well they are known.

    Parameters
    ----------
    calibration : Calibration
        With its corners.

    Returns
    -------
    angles, std : ndarray, shape (2,)
        In radians, horizontally and vertically: between the outermost corners of all views, through
        the middle. NaN where the lens model does not reach, infinite deviations where the views do
        not determine the camera.

    Notes
    -----
    Where no corner was seen, a lens is only prolonged, and its field of view is a guess.

    Examples
    --------
    >>> from cvnotes.pictures import course
    >>> from cvnotes.calibration import calibrate
    >>> found = calibrate(course.board().points, course.measured_corners(), (640, 480))
    >>> angles, std = np.degrees(angles_seen(found))
    >>> bool((angles < np.degrees(found.camera.field_of_view)).all()), bool((std < 0.1).all())
    (True, True)
    """
    m = joined(calibration.image_points)
    low, high = m.min(0), m.max(0)
    u, v = calibration.A[:2, 2].clip(low, high)
    ends = np.array([[low[0], v], [high[0], v], [u, low[1]], [u, high[1]]])

    def spanned(camera: Camera) -> Array:
        x, y, z = camera.ray(ends).T
        left, right, top, bottom = np.arctan2([x[0], x[1], y[2], y[3]], z)
        return np.array([[right - left], [bottom - top]])

    angles = spanned(calibration.camera)[:, 0]
    return angles, np.sqrt(_variance_of_views(calibration, spanned))
