"""Figures of estimates: how they scatter, and which sets of views they can be trusted for."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import CvnotesError, InputTypeError, ShapeError, number, paired, points
from cvnotes.calibration import Calibration
from cvnotes.show.axes import as_picture, beside, drawn_on, panels
from cvnotes.show.guards import length, thing
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_HALF = 0.674  # standard deviations: half of all Gaussian errors are smaller


def draw_plane_error(
    m: npt.ArrayLike,
    predicted: npt.ArrayLike,
    *,
    ax: "Axes | None" = None,
    magnify: float = 10.0,
    title: str = "",
) -> "Axes":
    """Draw how far predicted points are from the true ones, as magnified arrows.

    Parameters
    ----------
    m, predicted : array_like, shape (n, 2)
        True and predicted pixels.
    magnify : float
        How much longer than true the arrows are; said in the title.

    Examples
    --------
    >>> draw_plane_error([[0, 0], [9, 9]], [[1, 0], [9, 9]], title="two points").get_title()
    'two points (arrows × 10)'
    """
    m, predicted = points(m, "m", 2), points(predicted, "predicted", 2)
    paired(m, predicted, ("m", "predicted"), at_least=1)
    if m.ndim != 2 or m.shape != predicted.shape:
        raise ShapeError(f"m and predicted: expected (n, 2), got {m.shape} and {predicted.shape}")
    magnify = number(magnify, "magnify")
    ax = drawn_on(ax)
    d = magnify * (predicted - m)
    ax.plot(*m.T, "o", color=LENS, ms=3)
    arrows = ax.quiver(
        *m.T, *d.T, color=ESTIMATED, angles="xy", scale_units="xy", scale=1, width=0.005,
        minshaft=2, clip_on=False,
    )  # fmt: skip
    arrows.set_in_layout(False)  # one that leads out of the picture leaves it as large as it is
    if not ax.images:  # (else the photograph says what is shown)
        low, high = m.min(0), m.max(0)  # of the points alone, so that two figures can be compared
        room = max(0.15 * float((high - low).max()) + 1, 1e-9 * float(np.abs(m).max()))
        as_picture(ax, (2, 2))
        ax.set(xlim=(low[0] - room, high[0] + room), ylim=(high[1] + room, low[1] - room))
    ax.set_title(f"{title} (arrows × {magnify:g})".strip())
    return ax


def draw_view_families(results: Mapping[str, Sequence[Calibration]], *, truth: float) -> Any:
    """Draw RMS and error of the focal length of calibrations repeated for several sets of views.

    Parameters
    ----------
    results : mapping from name to sequence of Calibration
        For each set of views its repetitions, with other noise each time.
    truth : float
        The true α_u in pixels.

    Returns
    -------
    ndarray of two Axes
        The RMS on the left; on the right the relative errors of α_u on a logarithmic axis: a dot
        for each repetition, a thick line for their median, and a thin one for what the standard
        deviations promised for it: 0.674 times their own median, for half of all Gaussian errors
        are smaller. Orange are those whose errors are more than twice what was promised.
    """
    if not thing(results, "results", Mapping):  # type: ignore[type-abstract]
        raise CvnotesError("results: expected at least one set of views")
    for name, runs in results.items():
        if not isinstance(runs, list | tuple) or not runs:
            raise InputTypeError(f"results[{name!r}]: expected a list of calibrations")
        for run in runs:
            thing(run, f"results[{name!r}]", Calibration)
    truth = length(truth, "truth")
    left, right = axes = panels(2, width=900, height=90 + 52 * len(results), sharey=True)
    for y, runs in enumerate(results.values()):
        error = np.array([100 * max(abs(run.A[0, 0] / truth - 1), 1e-5) for run in runs])
        std = 100 / truth * np.array([run.std["alpha_u"] for run in runs])
        kept = float(np.sqrt(np.mean((error / std) ** 2))) < 2
        colour = LENS if kept else ESTIMATED
        promised, expected = _HALF * float(np.median(std)), float(np.median(error))
        spread = y + np.linspace(-0.24, 0.24, len(runs))
        left.plot([run.rms for run in runs], spread, ".", color=MUTED, markersize=4)
        right.plot(error, spread, ".", color=colour, markersize=4)
        for tick, ink, wide in ((expected, colour, 4), (promised, IDEAL, 1.6)):
            right.plot([tick] * 2, [y - 0.36, y + 0.36], color=ink, linewidth=wide)
        words = f"{float(f'{expected:.2g}'):g} %" + ("" if kept else ", beyond its promise")
        end = max(expected, float(error.max()), promised)
        beside(right, words, (end, y), (7, 0), va="center", size=9)
    right.set_xscale("log")
    right.set_xlim(1e-3, 1e6)
    left.set_xlim(0, 1.08 * max(run.rms for runs in results.values() for run in runs) or None)
    left.set(yticks=range(len(results)), yticklabels=list(results), title="what is looked at")
    left.set(xlabel="RMS (px per point)")
    right.set(xlabel="error of the focal length (%)", title="what counts")
    left.invert_yaxis()
    right.tick_params(labelleft=True)  # a narrow page shows the panels one below the other
    return axes
