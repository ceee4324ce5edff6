"""Explore the noise: how exact a calibration can be, by the bound and by trying it."""

from dataclasses import replace
from functools import lru_cache, partial

import numpy as np

from cvnotes.base import Array
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.refinement import Problem, State, covariance, minimise
from cvnotes.camera import Camera
from cvnotes.pictures import good_views
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, MUTED
from cvnotes.targets import Chessboard

_FEWEST, _MOST = 3, 30
_SHOWN = ("alpha_u", "alpha_v", "u0", "v0")
_LABELS = ("αᵤ", "αᵥ", "u₀", "v₀")
# px, of the error bars: the first is taken that holds 3.5 times the largest bound.
_REACHES = (1, 3, 8, 20, 60, 90)
_HELD = "#F2C4A5"  # the orange of a try whose error bar reaches the truth
_OTHERS, _PALE = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0), "#BFDFF4"  # px, of noise, to be compared


class _Study:
    """Many exact views of a board by a known camera, and what the first n of them say."""

    def __init__(self, camera: Camera, board: Chessboard) -> None:
        poses = good_views(board, camera, _MOST, rng=np.random.default_rng(4))
        m = np.stack([camera.moved(G).project(board.points) for G in poses])
        data = Correspondences.in_unit_frame(board.points, m)
        self.problem = Problem(
            data.W, m, skew=False,
            coefficients=tuple(dict.fromkeys(["k1", "k2", *camera.lens.parameters])),
            size=camera.size, model=type(camera.lens),
        )  # fmt: skip
        self.truth = self.problem.state(camera, data.pose_in_scaled_units(poses))
        counts = range(_FEWEST, _MOST + 1)
        self.std_by_views = np.array([self._std(n) for n in counts])  # for noise of 1 px
        self.estimate = lru_cache(maxsize=10_000)(self._estimate)

    def std(self, n: int, sigma: float) -> Array:
        """Return the least standard deviations possible with n views, in the order of `_SHOWN`."""
        return np.asarray(sigma * self.std_by_views[n - _FEWEST])

    def tries(self, n: int, sigma: float, draws: int) -> Array:
        """Return the errors of that many calibrations, and their error bars, (2, draws, 4)."""
        return np.stack([self.estimate(n, sigma, draw + 1) for draw in range(draws)], axis=1)

    def _estimate(self, n: int, sigma: float, draw: int) -> Array:
        problem, start = self._first(n)
        noise = np.random.default_rng([1, draw]).normal(0, 1, self.problem.m.shape)[:n]
        noisy = replace(problem, m=problem.m + sigma * noise)
        found = minimise(noisy, start)
        std = np.sqrt(found.cost / problem.freedom * np.diag(covariance(found.system)))
        return np.stack([(found.x.shared - start.shared)[self._shown], std[self._shown]])

    def _std(self, n: int) -> Array:
        problem, start = self._first(n)
        _, system = problem.linearise(start)
        return np.sqrt(np.diag(covariance(system)))[self._shown]

    def _first(self, n: int) -> tuple[Problem, State]:
        x = self.truth
        return self.problem.some(np.arange(n)), State(x.shared, x.R[:n], x.T[:n])

    @property
    def _shown(self) -> list[int]:
        return [self.problem.names.index(name) for name in _SHOWN]


def noise_model(camera: Camera, board: Chessboard) -> Model:
    """Make the model of calibrations of `camera` from good views of `board`."""
    settings = (
        Setting("sigma", "noise σ (px)", 0, 1, 0.01, 0.2, "standard deviation of u and of v"),
        Setting("views", "views", _FEWEST, _MOST, 1, 6, "how many pictures of the board"),
        Setting("draw", "another try", 1, 100, 1, 1, "which sample of the noise is drawn"),
    )
    about = (
        "Errors of a simulated calibration with its own error bars, below the least possible "
        "standard deviations, and a stroke for each try so far, dark where its bar misses the "
        "truth; beside them the least standard deviation against the number of views."
    )
    study = _Study(camera, board)

    def pulled(_: Values, at: Array) -> Values:
        n, std = 10 ** at.clip(np.log10([_FEWEST, 1e-9]), np.log10([_MOST, 1e9]))
        return {"views": float(n), "sigma": float(std / study.std(round(n), 1)[0])}

    return Model("noise", about, settings, partial(_draw, study), {"bound": pulled})


def _draw(study: _Study, paper: Paper, values: Values) -> Drawing:
    n, sigma = int(values["views"]), values["sigma"]
    bound = study.std(n, sigma)
    draw = int(values["draw"])
    tries = study.tries(n, sigma, draw)
    error, std = tries[:, -1]
    reach = next((r for r in _REACHES if r > 3.5 * bound.max()), _REACHES[-1])
    bars = paper.panel(
        (450, 300),
        (-1.25 * reach, reach),
        (-0.5, 4.3),
        "estimate − truth (px), ± standard deviation (thin: twice)",
    )
    missed = _draw_tries(bars, *tries)
    for i, count in enumerate(missed if draw > 1 and sigma else ()):
        words = f"missed {count} of {draw}"
        bars.text([0.97 * reach, i - 0.27], words, ESTIMATED, anchor="rm", size=12)
    _draw_bars(bars, bound, error, std, min(error[0] - std[0], tries[0, :, 0].min()))
    curve = paper.panel(
        (400, 300), (np.log10(2.6), np.log10(48)), (1.4, -1.8),
        "least standard deviation of αᵤ (px) against views",
    )  # fmt: skip
    _draw_curve(curve, study, n, sigma)
    off = round(float(error[0]), 2) + 0.0  # no "−0.00"
    sentence = (
        f"σ = {sigma:.2f} px and {n} views: αᵤ cannot be known better than ±{bound[0]:.2f} px "
        f"(one standard deviation); this try is off by {off:+.2f} px, and claims ± {std[0]:.2f} px."
    )
    if draw > 1 and sigma:
        sentence += f" Of {draw} tries {missed[0]} are off by more than their ±."
    return Drawing(paper.join((bars, curve)), sentence)


def _draw_tries(panel: Panel, error: Array, std: Array) -> list[int]:
    """Draw all tries so far (draws, 4) below the bounds; return how many bars of each miss."""
    missed = np.abs(error) > std
    down = 0.35 + 0.34 * (0.618 * np.arange(len(error)) % 1 - 0.5)  # beside each other
    for i in range(len(_LABELS)):
        ends = error[:, i, None, None] * [1, 0] + [[0, i - 0.04], [0, i + 0.04]]
        ends[..., 1] += down[:, None]
        for some, colour in ((~missed[:, i], _HELD), (missed[:, i], ESTIMATED)):
            panel.segments(ends[some], colour, 2)
    return [int(count) for count in missed.sum(axis=0)]


def _draw_bars(panel: Panel, bound: Array, error: Array, std: Array, leftmost: float) -> None:
    left, reach = panel.x
    panel.ticks(x=np.array([-2, -1, 1, 2]) * (reach // 3 if reach > 1 else 0.3), size=12)
    panel.line([[0, -0.5], [0, 4.3]], IDEAL, 1, dash=4)
    panel.text([0.02 * reach, 3.85], "truth", IDEAL)
    panel.text([2 * bound[0] + 0.04 * reach, 0], "the bound", CAMERA)
    panel.text([leftmost - 0.04 * reach, 0.35], "this try", ESTIMATED, anchor="rm")
    for i, label in enumerate(_LABELS):
        for k, width in ((2, 3.5), (1, 8)):
            panel.line([[-k * bound[i], i], [k * bound[i], i]], CAMERA, width)
        y = i + 0.35
        panel.line([[error[i] - std[i], y], [error[i] + std[i], y]], ESTIMATED, 2)
        panel.mark([error[i], y], "estimated", 5)
        panel.text([0.95 * left, i], label, IDEAL, size=15)


def _draw_curve(panel: Panel, study: _Study, n: int, sigma: float) -> None:
    """Draw both axes as logarithms; a halved error bar needs four times as many views."""
    for value in (3, 5, 10, 20, 30):
        x = float(np.log10(value))
        panel.line([[x, -1.8], [x, 1.4]], "#DDDDDD", 0.5)
        panel.text([x, -1.72], f"{value}", anchor="md", size=12)
    for value in (0.1, 1, 10):
        panel.line([[0, np.log10(value)], [2, np.log10(value)]], "#DDDDDD", 0.5)
        panel.text([np.log10(2.7), np.log10(value)], f"{value:g}", size=12)
    counts = np.arange(_FEWEST, _MOST + 1)
    for other in _OTHERS:
        curve = other * study.std_by_views[:, 0]
        panel.line(np.log10(np.stack([counts, curve], -1)), _PALE, 0.8)
        panel.text(np.log10([counts[-1] * 1.09, curve[-1]]), f"σ {other:g}", CAMERA, size=10)
    std = sigma * study.std_by_views[:, 0]
    here = np.log10([n, max(std[n - _FEWEST], 1e-9)])
    panel.grip("bound", "views to the right, noise upwards", here, 4)
    if sigma == 0:
        panel.text([1.0, -1.5], "no noise, no error", MUTED, anchor="mm", size=12)
        return
    slope = std[-1] * np.sqrt(_MOST / counts)
    panel.line(np.log10(np.stack([counts, slope], -1)), IDEAL, 1.5, dash=4)
    panel.text(np.log10([3.2, 0.03]), "dashed: as 1/√views", MUTED)
    panel.line(np.log10(np.stack([counts, std], -1)), CAMERA, 2.2)
    panel.mark(here, "camera", 8)
