"""Figures of estimates: how they scatter, and which sets of views they can be trusted for."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import CvnotesError, InputTypeError, ShapeError, number, paired, points
from cvnotes.calibration import Calibration
from cvnotes.pictures.meshes import outlined
from cvnotes.show.axes import as_picture, beside, drawn_on, panels
from cvnotes.show.guards import length, thing
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED, rgb

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


def draw_view_families(
    results: Mapping[str, Sequence[Calibration]], W: npt.ArrayLike, *, truth: float
) -> Any:
    """Draw sets of views, and the focal lengths of calibrations repeated for each of them.

    Parameters
    ----------
    results : mapping from name to sequence of Calibration
        For each set of views its repetitions, with other noise each time.
    W : array_like, shape (n, 3)
        The points of the board.
    truth : float
        The true α_u in pixels.

    Returns
    -------
    ndarray of two Axes
        The outlines of all boards of the first repetition, in a picture's frame, with the median
        RMS; and the relative errors of α_u on a logarithmic axis: a dot for each repetition, a
        thick line for their median, and a thin one for what the standard deviations promised for
        it: 0.674 times their own median, for half of all Gaussian errors are smaller. Orange are
        those whose errors are more than twice what was promised.
    """
    if not thing(results, "results", Mapping):  # type: ignore[type-abstract]
        raise CvnotesError("results: expected at least one set of views")
    for name, runs in results.items():
        if not isinstance(runs, list | tuple) or not runs:
            raise InputTypeError(f"results[{name!r}]: expected a list of calibrations")
        for run in runs:
            thing(run, f"results[{name!r}]", Calibration)
    W, truth = points(W, "W", 3).reshape(-1, 3), length(truth, "truth")
    if not len(W):
        raise CvnotesError("W: expected the points of the board")
    n = len(results)
    axes = panels(2, width=820, height=90 + 86 * n, sharey=True, width_ratios=(1.6, 4.2))
    boards, strips = axes
    names = []
    for y, (name, runs) in enumerate(results.items()):
        _frame(boards, runs[0], W, y)
        _strip(strips, runs, truth, y)
        names.append(f"{name}\nRMS {np.median([run.rms for run in runs]):.2f} px")
    strips.set(xscale="log", xlim=(1e-3, 1e4), xlabel="error of the focal length (%)")
    strips.xaxis.set_major_formatter("{x:g}")
    boards.set(aspect="equal", anchor="E", xticks=[], title="all its boards")
    boards.set(yticks=range(n), yticklabels=names, ylim=(n - 0.5, -0.5))
    boards.spines[:].set_visible(False)
    for ax in axes:
        ax.tick_params(which="both", length=0)
    return axes


def _frame(ax: "Axes", run: Calibration, W: Any, y: float) -> None:
    """Draw the outlines of a calibration's boards in a picture's frame, 0.9 high, in the row y."""
    (u0, v0, _), (u1, v1, _) = W.min(0), W.max(0)
    edge = outlined(np.array([[u0, v0, 0], [u1, v0, 0], [u1, v1, 0], [u0, v1, 0]]))
    scale, half = 0.9 / run.size[1], np.array(run.size) / 2
    w, h = scale * half
    ax.fill([-w, w, w, -w], [y - h, y - h, y + h, y + h], fc="#F4F4F0", ec=MUTED, lw=0.8)
    for pose in run.poses:
        u, v = scale * (run.camera.moved(pose).project(edge) + 0.5 - half).T
        ax.fill(u, v + y, fc=(*rgb(LENS), 0.06), ec=LENS, lw=0.7)


def _strip(ax: "Axes", runs: Sequence[Calibration], truth: float, y: int) -> None:
    """Draw the errors of the focal length in the row y, in percent, and what was promised."""
    error = np.array([100 * max(abs(run.A[0, 0] / truth - 1), 1e-5) for run in runs])
    std = 100 / truth * np.array([run.std["alpha_u"] for run in runs])
    kept = float(np.sqrt(np.mean((error / std) ** 2))) < 2
    colour = LENS if kept else ESTIMATED
    promised, expected = _HALF * float(np.median(std)), float(np.median(error))
    ax.plot(
        error,
        y + np.linspace(-0.24, 0.24, len(runs)),
        "o",
        color=colour,
        markersize=3.6,
        mec="white",
        mew=0.4,
    )
    far = error.max() > 10  # so that there is no room on the right
    names = ("promised ", promised, IDEAL, 1.6, "right"), (" median", expected, colour, 3, "left")
    for name, tick, ink, wide, side in reversed(names):
        ax.plot([tick] * 2, [y - 0.36, y + 0.36], color=ink, linewidth=wide, zorder=1)
        beside(ax, "" if y else name, (tick, y - 0.36), (0, 3), ink, ha=side, size=9)
    words = f"{expected:.2f} %" if expected < 100 else "over 100 %"
    words += "" if kept else ",\nnot as promised"
    end, by, side = (min(*error, promised), -7, "right") if far else (error.max(), 7, "left")
    beside(ax, words, (end, y), (by, 0), va="center", ha=side, size=9)
