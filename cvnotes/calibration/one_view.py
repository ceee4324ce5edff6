"""The whole camera from one picture of a target that is not flat (notes 2b.4, first approach)."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, DegenerateError, image_size, paired, points
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.ppm import resect
from cvnotes.calibration.refinement import Problem, minimise, refuse_too_few
from cvnotes.calibration.result import Calibration
from cvnotes.camera import Camera, decompose, pose

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
    >>> from cvnotes.camera import Camera, Lens, intrinsics, look_at
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
    size = image_size(size)
    W, m = points(target_points, "target_points", 3), points(image_points, "image_points", 2)
    paired(W, m, ("target_points", "image_points"), at_least=6)
    camera, G = _start(W, m, size)
    data = Correspondences.of(W, m, flat=False)
    problem = Problem.of(data, size, lens, skew)
    remedy = "add points or estimate a simpler lens"
    refuse_too_few(m.size, len(problem.names) + 6, remedy)
    best = minimise(problem, problem.state(camera, data.pose_in_scaled_units(G)[None]))
    found = Calibration.of(problem, data, best)
    return found.judged(*_judge(found))


def _start(W: Array, m: Array, size: tuple[int, int]) -> tuple[Camera, Array]:
    """Take the PPM apart into sensor and pose, or refuse what only a mirror could show."""
    P = resect(W, m)
    if np.linalg.det(P[:, :3]) < 0:
        raise DegenerateError(
            "no camera shows the points like this: is the picture mirrored, (v, u) given for "
            "(u, v), or the target's frame left-handed?"
        )
    A, R, T = decompose(P)
    return Camera(A, size=size), pose(R, T)


def _judge(found: Calibration) -> tuple[tuple[str, ...], bool]:
    """Describe what is doubtful, and whether the result is reliable all the same."""
    if found.rms > _MISFIT * max(found.size):
        return (
            f"the points are {found.rms:.1f} px away from where the model puts them: are they "
            "paired with the right pixels?",
        ), False
    if not found.converged:
        return ("the refinement stopped before it reached a minimum",), False
    std, A = found.std, found.A
    focal = max(std["alpha_u"] / A[0, 0], std["alpha_v"] / A[1, 1])
    if focal > _UNCERTAIN:
        return (
            f"the focal length has a standard deviation of {focal:.1%}: use a target that is "
            "deeper, and come closer so that it fills the picture",
        ), focal <= _UNKNOWN
    return (), True
