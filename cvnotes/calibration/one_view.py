"""The whole camera from one picture of a target that is not flat (notes 2b.4, first approach)."""

from warnings import warn

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    Array,
    CalibrationWarning,
    CvnotesError,
    DegenerateError,
    image_size,
    paired,
    points,
)
from cvnotes.calibration.arrow import covariance, pose_covariance
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.driver import LENSES
from cvnotes.calibration.ppm import resect
from cvnotes.calibration.refinement import Problem, minimise
from cvnotes.calibration.result import Calibration
from cvnotes.camera import Lens, decompose, pose

# Standard deviation of a focal length over its value, and RMS over the picture's longer side.
_UNCERTAIN, _UNKNOWN, _MISFIT = 0.01, 0.10, 0.005


def calibrate_one_view(
    target_points: npt.ArrayLike,
    image_points: npt.ArrayLike,
    size: tuple[int, int],
    *,
    lens: str = "none",
    skew: bool = False,
) -> Calibration:
    """Calibrate a camera from one picture of a target of known shape that is not flat.

    Parameters
    ----------
    target_points : array_like, shape (n, 3)
        Points in the WRF, for example ``TwoPlanes().points``.
    image_points : array_like, shape (n, 2)
        The same points in the picture, in pixels.
    size : (width, height)
        Size of the picture.
    lens : {"none", "k1", "k1 k2", "k1 k2 k3", "k1 k2 p1 p2", "k1 k2 p1 p2 k3"}
        Which lens coefficients are estimated; the others are zero.
    skew : bool
        Estimate the skew too.

    Returns
    -------
    Calibration
        Of one view, with error bars.

    Raises
    ------
    DegenerateError
        Too few points, or points that leave the camera open.

    Warns
    -----
    CalibrationWarning
        The answer is doubtful; the sentences are also in ``warnings`` of the result.

    Notes
    -----
    `resect` gives P, `decompose` takes it apart. P has skew and no lens; from there the parameters
    that are asked for are refined together with the pose, as in `calibrate`.

    References
    ----------
    .. [1] Notes 2b.4, "Calibration Targets".

    Examples
    --------
    >>> from cvnotes.camera import Camera, intrinsics
    >>> from cvnotes.camera import look_at
    >>> from cvnotes.targets import TwoPlanes
    >>> target = TwoPlanes()
    >>> G = look_at([500, 0, -700], [100, 60, -80])
    >>> camera = Camera(intrinsics(800, 805, 320, 240), G, Lens(k=(-0.2, 0.05)))
    >>> seen = camera.project(target.points)
    >>> calibrate_one_view(target.points, seen, camera.size, lens="k1 k2").A.round(6) + 0.0
    array([[800.,   0., 320.],
           [  0., 805., 240.],
           [  0.,   0.,   1.]])
    """
    if not isinstance(lens, str) or lens not in LENSES:
        raise CvnotesError(f"lens: expected one of {', '.join(map(repr, LENSES))}, got {lens!r}")
    size = image_size(size)
    W, m = points(target_points, "target_points", 3), points(image_points, "image_points", 2)
    paired(W, m, ("target_points", "image_points"), at_least=6)
    A, G = _start(W, m)
    data = _scaled(W, m)
    n_radial, tangential = LENSES[lens]
    problem = Problem(data.W, data.m, None, skew, n_radial, tangential)
    freedom = m.size - len(problem.names) - 6
    if freedom <= 0:
        raise DegenerateError(
            f"{m.size} measured coordinates cannot determine {len(problem.names) + 6} parameters; "
            "add points or estimate a simpler lens"
        )
    # The target's scaled frame: R stays, the scaled origin is seen at (R c + T) / s.
    G = pose(G[:3, :3], (G[:3, :3] @ data.centre + G[:3, 3]) / data.scale)
    best = minimise(problem, problem.state(A, Lens(), G[None]))
    A, found = problem.camera_of(best.x.shared)
    variance = best.cost / freedom
    cov = covariance(best.system)

    def poses() -> Array:
        J = data.pose_jacobian(best.x.R)
        return np.asarray(J @ pose_covariance(best.system, cov) @ J.mT) * variance

    rms = float(np.sqrt(best.cost / len(W)))
    std = dict(zip(problem.names, np.sqrt(np.diag(variance * cov)).tolist(), strict=True))
    sentences, reliable = _judge(A, std, rms, size, best.converged)
    for sentence in sentences:
        warn(sentence, CalibrationWarning, stacklevel=2)
    return Calibration(
        A=A,
        lens=found,
        size=size,
        poses=data.pose_in_given_units(best.x.R, best.x.T),
        rms=rms,
        view_rms=np.array([rms]),
        names=problem.names,
        covariance=variance * cov,
        warnings=sentences,
        reliable=reliable,
        converged=best.converged,
        _data=data,
        _pose_covariance=poses,
    )


def _start(W: Array, m: Array) -> tuple[Array, Array]:
    """Take the PPM apart, or refuse what only a mirror could show."""
    P = resect(W, m)
    if np.linalg.det(P[:, :3]) < 0:
        raise DegenerateError(
            "no camera shows the points like this: is the picture mirrored, (v, u) given for "
            "(u, v), or the target's frame left-handed?"
        )
    A, R, T = decompose(P)
    return A, pose(R, T)


def _scaled(W: Array, m: Array) -> Correspondences:
    """Centre the target and scale it to unit size, as one view."""
    low, high = W.min(0), W.max(0)
    centre, scale = (low + high) / 2, float(np.linalg.norm(high - low)) / 2
    return Correspondences((W - centre) / scale, m[None], None, centre, scale)


def _judge(
    A: Array, std: dict[str, float], rms: float, size: tuple[int, int], converged: bool
) -> tuple[tuple[str, ...], bool]:
    """Say what is doubtful, and whether the result is reliable all the same."""
    if rms > _MISFIT * max(size):
        return (
            f"the points are {rms:.1f} px away from where the model puts them: are they paired "
            "with the right pixels?",
        ), False
    if not converged:
        return ("the refinement stopped before it reached a minimum",), False
    focal = max(std["alpha_u"] / A[0, 0], std["alpha_v"] / A[1, 1])
    if focal > _UNCERTAIN:
        return (
            f"the focal length has a standard deviation of {focal:.1%}: use a target that is "
            "deeper, and come closer so that it fills the picture",
        ), focal <= _UNKNOWN
    return (), True
