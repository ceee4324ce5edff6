"""How far predictions may be off: the pixel at which a ray is seen."""

from collections.abc import Sequence
from typing import Literal

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, points
from cvnotes.calibration.result import Calibration
from cvnotes.camera import Camera

_STEP = 1e-6  # of a parameter, relative to its standard deviation or to 1


def prediction_std(
    calibration: Calibration, m: npt.ArrayLike, *, of: Literal["noise", "views"] = "noise"
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

    Returns
    -------
    ndarray, shape (...)
        √ trace(J Σ Jᵀ): the standard deviation of the predicted pixel, both coordinates together,
        for a ray that is fixed in the camera's frame. NaN where the lens model does not reach.

    Notes
    -----
    Σ is the covariance of the estimated parameters and J the derivative of the pixel by them. A
    small rotation of the camera, which the poses would absorb, is not subtracted, so this is
    a cautious value.

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
    camera, rays, names = calibration.camera, calibration.camera.ray(m), calibration.names
    if of == "noise":
        return np.asarray(np.sqrt(_variance(camera, names, calibration.covariance, rays)))
    C = calibration.covariance_of_views
    if not np.isfinite(C).all():  # known not at all
        return np.full(m.shape[:-1], np.inf)
    if calibration.choice is None:
        return np.asarray(np.sqrt(_variance(camera, names, C, rays)))
    # Parameters of different lenses are not to be compared, but what they predict is.
    widest = _variance(camera, names, calibration.choice.chosen.covariance, rays)
    for other in calibration.choice.close:
        off = other.camera.project(np.nan_to_num(rays, nan=1.0)) - m
        variance = _variance(other.camera, other.names, other.covariance, rays)
        widest = np.fmax(widest, variance + np.vecdot(off, off))
    return np.asarray(np.sqrt(np.where(np.isfinite(rays).all(-1), widest, np.nan)))


def _variance(camera: Camera, names: Sequence[str], C: Array, rays: Array) -> Array:
    """Variance (...) of the pixels that rays (..., 3) have, both coordinates together."""
    J = pixel_jacobian(camera, names, rays)
    return np.asarray(np.einsum("...ci,ij,...cj->...", J, C, J))


def pixel_jacobian(camera: Camera, names: Sequence[str], rays: Array) -> Array:
    """Differentiate the images of rays (..., 3) of the CRF by the parameters.

    (..., 2, q); NaN where the lens model does not reach.
    """
    J = np.full((*rays.shape[:-1], 2, len(names)), np.nan)
    reached = np.isfinite(rays).all(-1)
    value = camera.parameters
    for i, name in enumerate(names):
        at = value.get(name, 0.0)
        h = _STEP * max(1.0, abs(at))
        up, down = (camera.with_parameters({name: at + s * h}) for s in (1, -1))
        J[reached, :, i] = (up.project(rays[reached]) - down.project(rays[reached])) / (2 * h)
    return J
