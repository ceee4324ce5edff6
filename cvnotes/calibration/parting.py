"""Which views belong together? What each costs where the camera changes a little tells at once."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, solved
from cvnotes.calibration.jackknife import eliminated_by_view
from cvnotes.calibration.refinement import Problem, State
from cvnotes.calibration.thresholds import CORNERS_THAT_TELL

_GUESSES, _ROUNDS = 128, 20  # of how views part, and how often each is mended
_HELD = 1e-6  # of what all views know: holds a camera that its views do not determine


@dataclass(frozen=True, eq=False)
class NearBy:
    """What views cost near a camera, their poses following: c + 2 gᵀ d + dᵀ S d.

    Attributes
    ----------
    c, g, S : ndarray, shapes (n,), (n, q) and (n, q, q)
        For a change d of the camera's parameters in units in which all of `views` together make S
        the identity.
    """

    c: Array
    g: Array
    S: Array

    @staticmethod
    def of(problem: Problem, x: State, views: slice = slice(None)) -> "NearBy":
        """Take views whose poses fit the camera as well as they can.

        Raises
        ------
        DegenerateError
            These views do not determine one camera.
        """
        S, g = eliminated_by_view(problem, x)
        why = "the views hardly determine one camera"
        to_units = np.linalg.inv(solved(np.linalg.cholesky, S[views].sum(0), why=why))
        c = problem.linearise(x)[1].view_costs
        return NearBy(c, g @ to_units.T, to_units @ S @ to_units.T)

    def camera_of(self, weights: Array) -> Array:
        """Return the change (..., q) that makes the sum of weighted views (..., n) least."""
        S = np.tensordot(weights, self.S, 1) + _HELD * np.eye(self.g.shape[1])
        return np.asarray(-np.linalg.solve(S, (weights @ self.g)[..., None])[..., 0])

    def at(self, d: Array) -> Array:
        """Return what each view costs, (..., n), after changes (..., q) of the camera."""
        quadratic = np.einsum("...i,nij,...j->...n", d, self.S, d, optimize=True)
        return np.asarray(np.maximum(self.c + 2 * d @ self.g.T + quadratic, 0.0))


def guesses(n: int, fewest: int) -> npt.NDArray[np.intp]:
    """Return ways (k, n) in which up to half of the views, 1, might differ from the others, 0."""
    rng = np.random.default_rng(n)
    sizes = rng.integers(fewest, max(n // 2, fewest) + 1, _GUESSES)
    return (rng.random((_GUESSES, n)).argsort(axis=1) < sizes[:, None]).astype(np.intp)


def settled(
    parts: npt.NDArray[np.intp], costs_of: Callable[[npt.NDArray[np.intp]], Array]
) -> tuple[npt.NDArray[np.intp], Array]:
    """Let each view go to the part where it costs least, until all stay.

    `parts` (k, n) are guesses, and `costs_of` them are those in each part, (k, parts, n). Gives
    the parts, and what all cost together, (k,).
    """
    for _ in range(_ROUNDS):
        costs = costs_of(parts)
        before, parts = parts, costs.argmin(1)
        if (parts == before).all():
            break
    return parts, costs.min(1).sum(1)


def freedom(problem: Problem) -> float:
    """How many coordinates tell something new, beyond those that the poses take.

    Corners of a view miss their places together: of more than 40 in a view the rest says little.
    """
    told = np.minimum(problem.n_seen_by_view, CORNERS_THAT_TELL)
    return float((2 * told - 6).sum())
