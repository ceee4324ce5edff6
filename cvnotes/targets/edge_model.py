"""What a camera shows where two edges cross: the two-edge model, fitted to many windows at once.

    I(x, y) = (1 + sx x + sy y) (level + contrast · erf(t1) · erf(t2)),   t_i = a_i x + b_i y + c_i

x and y count pixels from the middle of the window. Edge i is the line t_i = 0; its step is seen
through a Gaussian blur of 1 / (√2 ‖(a_i, b_i)‖) pixels, which may differ from edge to edge. The
pixel's own width belongs to it: a variance of 1/12 px² adds to that of the lens. (sx, sy) is a
slight slope of the lighting.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, chunks

Mask = npt.NDArray[np.bool_]
Single = npt.NDArray[np.float32]

# Parameters, in this order: a1, b1, c1, a2, b2, c2, contrast, level, sx, sy.
PARAMETERS = 10
SLOPES = 8  # where the slopes of the lighting begin
_TOGETHER = 6000  # pixels differentiated at a time: their numbers then stay in the cache
_SHARPEST = 1 / (np.sqrt(2) * 0.25)  # of a pixel's own width remain 0.29 px


@dataclass(frozen=True)
class Window:
    """The pixels to be explained: as many for every corner, but not all of them count.

    Attributes
    ----------
    place : ndarray, shape (3, pixels)
        x, y and 1 of the pixels, seen from the middle one.
    grey, weight : ndarray, shape (n, pixels)
        Grey levels, and 1 where a pixel counts, 0 elsewhere. Single precision: twice as quick, and
        still 16 bits finer than the grey levels.
    """

    place: Single
    grey: Single
    weight: Single

    def rows(self, k: slice | npt.NDArray[np.intp]) -> "Window":
        """Give the same for some of the corners."""
        return Window(self.place, self.grey[k], self.weight[k])


def jacobian(p: Array, window: Window) -> Single:
    """Differentiate the model by its parameters p (n, 10).

    Returns
    -------
    ndarray, shape (n, 11, pixels)
        The derivatives, and in the last row the pixels minus the model; all times the weight.
    """
    q = p.astype(np.float32)
    contrast, level = q[:, 6:7], q[:, 7:8]
    t1, t2 = q[:, 0:3] @ window.place, q[:, 3:6] @ window.place
    (S1, E1), (S2, E2) = _erf(t1), _erf(t2)
    light = (1 + q[:, 8:10] @ window.place[:2]) * window.weight
    M = light * S1 * S2
    slope = np.float32(2 / np.sqrt(np.pi)) * contrast * light  # d(erf t)/dt = 2/√π exp(−t²)
    A1, A2 = slope * S2 * E1, slope * S1 * E2
    shade = window.weight * (level + contrast * S1 * S2)
    J = np.empty((len(p), PARAMETERS + 1, window.place.shape[1]), dtype=np.float32)
    np.multiply(A1[:, None], window.place, out=J[:, 0:3])
    np.multiply(A2[:, None], window.place, out=J[:, 3:6])
    J[:, 6], J[:, 7] = M, light
    np.multiply(shade[:, None], window.place[:2], out=J[:, 8:10])
    J[:, 10] = window.weight * window.grey - (level * light + contrast * M)
    return J


def crossing(p: Array) -> Array:
    """Give where the two edges cross, (n, 2), from the middle of the window.

    Examples
    --------
    >>> crossing(np.array([[1.0, 0, -2, 0, 1, -3, 1, 0, 0, 0]]))
    array([[2., 3.]])
    """
    a1, b1, c1, a2, b2, c2 = p.T[:6]
    m = np.empty((len(p), 2))
    with np.errstate(divide="ignore", invalid="ignore"):  # parallel edges cross nowhere
        area = a1 * b2 - a2 * b1
        m[:, 0] = (b1 * c2 - b2 * c1) / area
        m[:, 1] = (a2 * c1 - a1 * c2) / area
    return m


def crossing_jacobian(p: Array) -> Array:
    """Differentiate `crossing` by the parameters, (n, 2, 10).

    N m + c = 0 with the rows of N the (a_i, b_i), so that N dm = −(x da_i + y db_i + dc_i).
    """
    m_h = np.concatenate([crossing(p), np.ones((len(p), 1))], axis=-1)
    inverse = np.linalg.inv(p[:, [[0, 1], [3, 4]]])
    D = np.zeros((len(p), 2, PARAMETERS))
    D[:, :, 0:3] = -inverse[:, :, :1] * m_h[:, None]
    D[:, :, 3:6] = -inverse[:, :, 1:] * m_h[:, None]
    return D


# Sum of squares, in grey levels, that single precision leaves in a window.
_ROUNDING = 3.0


def minimise(
    p: Array, window: Window, *, tolerance: float, free: int = PARAMETERS, iterations: int = 15
) -> tuple[Array, Array, Mask]:
    """Fit the model to every window, each by a Levenberg–Marquardt of its own, all at once.

    Only the first `free` parameters change.

    Returns
    -------
    p : ndarray, shape (n, 10)
        The parameters found.
    system : ndarray, shape (n, 11, 11)
        [J r]ᵀ [J r] before the last step: the normal matrix, the gradient, the sum of squares.
    converged : ndarray of bool, shape (n,)
        Whether the crossing came to rest: to about `tolerance` pixels.
    """
    p, moved, damping = p.copy(), np.full(len(p), np.inf), np.zeros(len(p))
    system = _system(p, window)
    k, part = np.arange(len(p)), window
    for _ in range(iterations):
        step = _solve(system[k], damping[k], free)
        gain, cost = (system[k, :PARAMETERS, -1] * step).sum(-1), system[k, -1, -1]
        p_new = _limited(p[k] + step)
        moved[k] = np.abs(crossing(p_new) - crossing(p[k])).max(-1)
        # A step this small needs no proof that it leads downhill, unless it promises much: at a
        # symmetric start the crossing rests while everything else may go astray. Nor may an edge
        # turn over unproved: as sharp as it may be, it does so with its crossing at rest.
        close = (moved[k] < tolerance) & (gain < 0.1 * cost + _ROUNDING) & ~_overturned(p[k], p_new)
        p[k[close]] = p_new[close]
        if close.any():
            k, p_new = k[~close], p_new[~close]
            part = window.rows(k)
        if not k.size:
            break
        system_new = _system(p_new, part)
        better = system_new[:, -1, -1] < system[k, -1, -1]
        p[k[better]], system[k[better]] = p_new[better], system_new[better]
        damping[k] = np.where(better, 0.1 * damping[k], np.maximum(10 * damping[k], 1e-2))
        damping[damping < 1e-4] = 0.0
    # Edges that would be sharper than they may be keep swaying by a little.
    return p, system, moved < 10 * tolerance


def _system(p: Array, window: Window) -> Array:
    system = np.empty((len(p), PARAMETERS + 1, PARAMETERS + 1))
    for part in chunks(len(p), max(1, _TOGETHER // window.place.shape[1])):
        J = jacobian(p[part], window.rows(part))
        system[part] = J @ J.mT
    return system


def _erf(t: Single) -> tuple[Single, Single]:
    """Give erf t and exp(−t²) at once, to single precision, in a third of the usual time.

    Formula 7.1.26 of Abramowitz and Stegun, Handbook of Mathematical Functions (1964).
    """
    bell = np.exp(-t * t)
    k = 1 / (1 + np.float32(0.3275911) * np.abs(t))
    tail = np.float32(1.061405429) * k
    for coefficient in (-1.453152027, 1.421413741, -0.284496736, 0.254829592):
        tail += np.float32(coefficient)
        tail *= k
    return np.copysign(1 - tail * bell, t), bell


def _overturned(p: Array, p_new: Array) -> Mask:
    """Tell for which windows (n,) an edge's normal turns by more than 90°."""
    along = p[:, [0, 1, 3, 4]] * p_new[:, [0, 1, 3, 4]]
    return np.asarray(along.reshape(-1, 2, 2).sum(-1).min(-1) <= 0)


def _limited(p: Array) -> Array:
    """Keep edges from becoming sharper than pixels are wide."""
    for line in (slice(0, 3), slice(3, 6)):
        sharpness = np.hypot(p[:, line.start], p[:, line.start + 1])
        p[:, line] /= np.maximum(sharpness / _SHARPEST, 1)[:, None]
    return p


def _solve(system: Array, damping: Array, free: int) -> Array:
    """Solve the damped normal equations of each window for its first `free` parameters."""
    normal = system[:, :free, :free]
    scale = np.sqrt(np.diagonal(normal, axis1=1, axis2=2))
    scale[scale == 0] = 1.0
    scaled = normal / (scale[:, :, None] * scale[:, None, :])
    scaled += (damping[:, None, None] + 1e-6) * np.eye(free)
    gradient = system[:, :free, PARAMETERS] / scale
    step = np.zeros((len(system), PARAMETERS))
    step[:, :free] = np.linalg.solve(scaled, gradient[..., None])[..., 0] / scale
    return step
