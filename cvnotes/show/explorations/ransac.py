"""Explore RANSAC: four pairs at a time are believed, and all pairs vote on their homography."""

from contextlib import suppress
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError
from cvnotes.camera import Camera
from cvnotes.homography import dlt
from cvnotes.pictures import course, render
from cvnotes.projective import apply
from cvnotes.show.explorations.boards import draw_net
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.style import ESTIMATED, IDEAL, LENS

_BOARD, _CAMERA = course.board(), Camera(course.camera().A, course.poses()[6])
_PART = (160, 78), (580, 420)  # px: the part of the picture that is shown
_DRAWS, _NOISE = 60, 0.3  # px
_WRONG, _LINE = "#7A7A7A", "#8A8A8A"

Mask = npt.NDArray[np.bool_]


def ransac_model() -> Model:
    """Make the model of 54 pairs, some of which changed places."""
    settings = (
        Setting("draw", "draw", 0, _DRAWS, 1, 12, "0 believes all pairs; each other draws four"),
        Setting("wrong", "wrong pairs", 0, 40, 2, 16, "how many of the 54 changed places"),
        Setting("threshold", "threshold (px)", 0.3, 6, 0.1, 1.5,
                "how far a pair that agrees is off"),
    )  # fmt: skip
    about = """A board, and where 54 pairs say that its corners are seen; the net of the homography
    of four of them, or of all, and the pairs that agree with it. Beside it how many have agreed in
    each draw so far."""

    @lru_cache(maxsize=1)
    def photograph() -> Drawn:
        (left, top), (right, bottom) = 2 * np.array(_PART)
        grey = render(_BOARD, _CAMERA.resized((1280, 960)), blur=0.7)
        return np.asarray(185 + 0.27 * grey).astype(np.uint8)[top:bottom, left:right]

    def draw(paper: Paper, values: Values) -> Drawing:
        n, wrong, limit = int(values["draw"]), int(values["wrong"]), values["threshold"]
        pairs, fours, put, true = drawn_pairs(wrong)
        agree = np.linalg.norm(put - pairs, axis=-1) < limit
        (left, top), (right, bottom) = _PART
        part, title = (right - left, bottom - top), "the pairs, and one homography"
        panel = paper.picture_panel((504, 410), part, title, (left, top))
        panel.image(photograph())
        _draw_pairs(panel, put[n], pairs, agree[n], true)
        panel.mark(fours[n][: 4 * min(n, 1)], "ideal", 8)
        panel.text([right - 12, top + 24], f"{agree[n].sum()} agree", LENS, anchor="rm", size=22)
        _name_marks(panel, left + 16, bottom - 14)
        title = "pairs that agree, draw by draw"
        votes = paper.panel((276, 410), (-4, _DRAWS + 3), (60, -9), title)
        counts = agree.sum(axis=1)
        _draw_votes(votes, counts[: n + 1])
        return Drawing(paper.join((panel, votes)), _sentence(n, agree, true))

    return Model("ransac", about, settings, draw, {"draw": placed("draw")})


@lru_cache(maxsize=8)
def drawn_pairs(wrong: int) -> tuple[Array, Array, Array, Mask]:
    """Return the pairs (54, 2), the four of each draw (61, 4, 2), where these put the corners.

    The last, (61, 54, 2), begins with what all pairs put down. Four on a line put them nowhere.
    Beside them which of the pairs are right.
    """
    W, rng = _BOARD.points, np.random.default_rng(8)
    pairs = _CAMERA.project(W) + rng.normal(scale=_NOISE, size=(len(W), 2))
    lies = np.sort(rng.permutation(len(W))[:wrong])
    pairs[lies] = np.roll(pairs[lies], 1, axis=0)
    fours = np.array([rng.choice(len(W), 4, replace=False) for _ in range(_DRAWS + 1)])
    put = np.full((_DRAWS + 1, len(W), 2), np.nan)
    for i, four in enumerate([np.arange(len(W)), *fours[1:]]):
        with suppress(CvnotesError):
            put[i] = apply(dlt(W[four, :2], pairs[four]), W[:, :2])
    return pairs, pairs[fours], put, ~np.isin(np.arange(len(W)), lies)


def _draw_pairs(panel: Panel, put: Array, pairs: Array, agree: Mask, true: Mask) -> None:
    """Draw the net that a homography puts down, and each pair, led to its corner if it is off.

    Wrong pairs lie in a diamond in all draws.
    """
    ways, shape = np.stack([put, pairs], axis=1), np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    panel.segments(ways[~agree], _LINE, 0.8)
    draw_net(panel, put, _BOARD, ESTIMATED, 2)
    panel.polygons(pairs[~agree & true][:, None] + 2.5 * panel.pixel * shape, _WRONG)
    diamond = panel.pixel * np.array([[0, -1], [1, 0], [0, 1], [-1, 0]])
    for size, ink in ((8, IDEAL), (6, "white")):
        panel.polygons(pairs[~true][:, None] + size * diamond, ink)
    panel.mark(pairs[agree], "lens", 5)


def _name_marks(panel: Panel, x: float, y: float) -> None:
    """Write what the marks mean, below the board."""
    panel.polygons([[[0, y - 18], [1e3, y - 18], [1e3, 1e3], [0, 1e3]]], "white")
    panel.mark([x, y], "ideal", 8)
    panel.mark([x + 95, y], "lens", 7)
    diamond = panel.pixel * np.array([[0, -1], [1, 0], [0, 1], [-1, 0]])
    panel.polygons([[x + 175, y] + 8 * diamond, [x + 175, y] + 6 * diamond], (IDEAL, "white"))
    for aside, words in ((12, "believed"), (105, "agrees"), (188, "wrong")):
        panel.text([x + aside, y], words, size=14)


def _draw_votes(panel: Panel, counts: Array) -> None:
    """Draw how many pairs agree in each draw so far, and the most of them as a line of steps."""
    panel.ticks(x=(0, 20, 40, 60), y=(0, 18, 36, 54), size=12)
    n = len(counts) - 1
    if n > 1:
        best = np.maximum.accumulate(counts[1:])
        ends = np.arange(1, n + 1).repeat(2)[1:]
        panel.line(np.column_stack([ends, best.repeat(2)[:-1]]), IDEAL, 1.2)
    draws = np.flatnonzero(counts[1:]) + 1
    bars = np.stack([draws, 0 * draws, draws, counts[draws]], axis=-1)
    panel.segments(bars.reshape(-1, 2, 2), LENS, 2.2)
    panel.mark([n, counts[n]], "estimated", 9)
    panel.grip("draw", "which draw is shown", [n, float(counts[n])], 5)


def _sentence(n: int, agree: Mask, true: Mask) -> str:
    counts, wrong = agree.sum(axis=1), int((~true).sum())
    if n == 0:
        said = f"All 54 pairs are believed, {wrong} of them wrong"
        return f"{said}: {counts[0]} agree with the answer."
    best = int(counts[1 : n + 1].argmax()) + 1
    one = f"{counts[n]} of 54 pairs agree" if counts[n] else "three of the four lie on one line"
    return f"""Draw {n}: {one}. The largest set so far, of draw {best}, has {counts[best]} pairs,
    {(agree[best] & true).sum()} of them right. Of all {len(true)} pairs {true.sum()} are right."""
