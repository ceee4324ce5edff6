"""How far predictions may be off: the pixel at which a ray is seen."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, DegenerateError, points
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.coverage import joined
from cvnotes.calibration.jacobian import jacobian
from cvnotes.calibration.refinement import Problem
from cvnotes.calibration.result import Calibration
from cvnotes.camera import Camera

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
    seen = _Seen.of(calibration, m, turning=turning)
    if of == "noise":
        here = calibration.camera, calibration.names, calibration.covariance
        return np.asarray(np.sqrt(_propagated(seen.jacobian(*here[:2]), here[2])))
    return np.asarray(np.sqrt(_variance_of_views(calibration, seen.jacobian, seen.off)))


@dataclass(frozen=True, eq=False)
class _Seen:
    """Where rays are seen, (...), by a camera that may turn to meet the corners."""

    camera: Camera
    rays: Array  # (n + corners, 3): those asked for, then those that the camera is turned by
    turned: Array | None  # (n + corners, 2, 3), derivative of their pixels by a rotation
    known: npt.NDArray[np.bool_]  # (...), False where the lens model does not reach

    @staticmethod
    def of(calibration: Calibration, m: Array, *, turning: bool) -> "_Seen":
        """Take the rays that a camera shows at pixels m (..., 2)."""
        camera, corners = calibration.camera, np.empty((0, 3))
        rays = camera.ray(m)
        known = np.asarray(np.isfinite(rays).all(-1))
        if turning:
            at = joined(calibration.image_points)
            if not len(at):
                raise DegenerateError(
                    "turning: this calibration was read from a file that has no corners"
                )
            corners = camera.ray(at[:: -(-len(at) // _CORNERS)])
            corners = corners[np.isfinite(corners).all(-1)]
        rays = np.concatenate([np.nan_to_num(rays, nan=1.0).reshape(-1, 3), corners])
        by_turn = _by_parameters_and_turn(camera, calibration.names, rays)[1]
        return _Seen(camera, rays, by_turn if turning else None, known)

    def jacobian(self, camera: Camera, names: tuple[str, ...]) -> Array:
        """Differentiate the pixels (..., 2, q) by the camera's parameters."""
        return self._still(_by_parameters_and_turn(camera, names, self.rays)[0])

    def off(self, other: Camera) -> Array:
        """How far from here another camera sees them, (..., 2)."""
        apart = other.project(self.rays) - self.camera.project(self.rays)
        return self._still(apart[..., None])[..., 0]

    def _still(self, d: Array) -> Array:
        """Take from differences (n + corners, 2, k) what a turn of the camera absorbs."""
        n = self.known.size
        if self.turned is not None:
            inverse = np.linalg.pinv(self.turned[n:].reshape(-1, 3))
            d = d - self.turned @ (inverse @ d[n:].reshape(-1, d.shape[-1]))
        d = d[:n].reshape(*self.known.shape, *d.shape[1:])
        return np.where(self.known[..., None, None], d, np.nan)


def _by_parameters_and_turn(
    camera: Camera, names: tuple[str, ...], rays: Array
) -> tuple[Array, Array]:
    """Differentiate the pixels of rays (n, 3) by parameters (n, 2, q), and by a turn (n, 2, 3)."""
    data = Correspondences(rays, np.zeros((1, len(rays), 2)), None, np.zeros(3), 1.0)
    problem = Problem.at(camera, names, data)
    J = jacobian(problem, problem.state(camera, np.eye(4)[None]))[0][0]
    return J[..., :-6], J[..., -6:-3]


def _variance_of_views(
    calibration: Calibration,
    jacobian: Callable[[Camera, tuple[str, ...]], Array],
    off: Callable[[Camera], Array],
) -> Array:
    """Variance (...) of what is computed from the camera, all c coordinates together.

    From the scatter between views, and between models that fit as well: parameters of different
    lenses are not to be compared, but what they predict is. Of a camera `jacobian` is the
    derivative (..., c, q) by parameters, and `off` (..., c) how far it is from the chosen one.
    """
    C, J = calibration.covariance_of_views, jacobian(calibration.camera, calibration.names)
    if not np.isfinite(C).all():  # known not at all
        return np.where(np.isnan(J).any((-2, -1)), np.nan, np.inf)
    if calibration.tied:  # a valley is curved: left-out steps along it are no derivative's steps
        C = max(calibration.times_noise, 1.0) ** 2 * calibration.covariance
    if calibration.tied or calibration.choice is None:
        return _propagated(J, C)
    widest = _propagated(J, np.zeros_like(C))  # 0, or NaN where there is nothing to be known
    for model in calibration.choice.close:  # the chosen one among them
        variance = _propagated(jacobian(model.camera, model.names), model.covariance)
        d = off(model.camera)
        widest = np.maximum(widest, np.nan_to_num(variance + np.vecdot(d, d)))
    return widest


def _propagated(J: Array, C: Array) -> Array:
    """Return trace(J C Jᵀ) (...)."""
    return np.asarray(np.einsum("...ci,ij,...cj->...", J, C, J, optimize=True))


def pixel_jacobian(calibration: Calibration, m: Array) -> Array:
    """Differentiate where the rays of pixels m (..., 2) are seen, the camera being free to turn.

    By the parameters, (..., 2, q); NaN where the lens model does not reach.
    """
    seen = _Seen.of(calibration, m, turning=True)
    return seen.jacobian(calibration.camera, calibration.names)


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
        return np.array([right - left, bottom - top])

    def jacobian(camera: Camera, names: tuple[str, ...]) -> Array:
        # a pixel stays where it is while its ray turns by ω: 0 = J dp + T ω
        rays = camera.ray(ends)
        J, T = _by_parameters_and_turn(camera, names, rays)
        omega = -np.linalg.pinv(T) @ J
        by = np.cross(omega, rays[..., None], axis=1)  # (4, 3, q)
        across = [0, 0, 1, 1]
        a, b = rays[range(4), across], rays[:, 2]
        angle = (b[:, None] * by[range(4), across] - a[:, None] * by[:, 2]) / (a**2 + b**2)[:, None]
        return (angle[1::2] - angle[::2])[:, None]

    angles = spanned(calibration.camera)

    def off(camera: Camera) -> Array:
        return (spanned(camera) - angles)[:, None]

    return angles, np.sqrt(_variance_of_views(calibration, jacobian, off))
