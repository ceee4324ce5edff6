"""Explore the votes: a small window over a photograph, and what its pixels say of a corner."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from cvnotes.base import Array
from cvnotes.pictures import course
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Drawn, Panel, Paper, circle
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, WORLD, mixed

_HALF = 3  # px from the window's middle to its border: 7 × 7 pixels vote
_LEFT, _TOP, _SIDE = 326, 187, 53  # px, the part of the photograph that is shown
_PANEL = (424, 424)  # px of the page
_WEAK, _STRONG = 33.0, 75.0  # grey levels a pixel: of votes drawn in grey, and of the thickest
_NOISE = "#BBBBBB"  # of weak votes
_K = 0.05  # of the Harris measure
_NOTHING = 2000.0  # an eigenvalue that the noise of flat paper does not reach


class Window(NamedTuple):
    """Pixels (n, 2), their gradients (n, 2), and what the structure tensor says of them."""

    p: Array
    g: Array
    eigenvalues: Array  # the smaller one first
    axes: Array  # their directions, in columns
    R: float
    least: Array  # where the sum of squares is least
    crossing: Array  # the same; NaN, where the votes do not cross

    def misses(self, m: Array) -> float:
        """Return the sum Σ (gᵀ(p − m))², how far the lines of all pixels pass m by."""
        return float(np.sum(np.sum(self.g * (self.p - m), axis=1) ** 2))


def window_at(gradients: Array, at: tuple[int, int]) -> Window:
    """Return what the pixels around a place say, from the gradients (height, width, 2) of all."""
    i, j = np.indices((2 * _HALF + 1, 2 * _HALF + 1)).reshape(2, -1) - _HALF
    u, v = at[0] + j, at[1] + i
    p, g = np.stack([u, v], axis=1).astype(float), gradients[v, u]
    S = g.T @ g
    eigenvalues, axes = np.linalg.eigh(S)
    R = float(np.linalg.det(S) - _K * np.trace(S) ** 2)
    crosses = R > 0 and eigenvalues[0] > _NOTHING
    least = np.linalg.lstsq(S, g.T @ (g * p).sum(axis=1))[0]
    crossing = least if crosses else np.full(2, np.nan)
    return Window(p, g, eigenvalues, axes, R, least, crossing)


@lru_cache(maxsize=1)
def slopes() -> Array:
    """Return the gradients (height, width, 2) of the photograph."""
    return np.stack(np.gradient(course.photo(6).astype(float))[::-1], axis=-1)


def votes_model() -> Model:
    """Make the model of a window over one of the course's photographs."""
    photo, corners = course.photo(6), course.exact_corners()[6]
    (u, v), far = (_LEFT + _HALF, _TOP + _HALF), _SIDE - 2 * _HALF - 1
    settings = (
        Setting("u", "u (px)", u, u + far, 1, 352, "column of the window's middle"),
        Setting("v", "v (px)", v, v + far, 1, 213, "row of the window's middle"),
        Setting("m_u", "m, aside (px)", -_HALF, _HALF, 0.05, -1.5, "to the right of the middle"),
        Setting("m_v", "m, down (px)", -_HALF, _HALF, 0.05, 1.5, "below the window's middle"),
    )
    about = """A part of a photograph of the board with a window of 7 × 7 pixels; and the lines
    along which its pixels see an edge, upright ones orange, level ones blue, weak ones grey, with a
    guess and how far each line passes it by."""

    def draw(paper: Paper, values: Values) -> Drawing:
        at = round(values["u"]), round(values["v"])
        window = window_at(slopes(), at)
        m = np.add(at, [values["m_u"], values["m_v"]])
        votes = _votes(paper, photo, at, window, corners)
        _draw_misses(votes, window, m)
        votes.mark(window.crossing, "estimated", 11)
        drawn = paper.join((_photo(paper, photo, at), votes))
        return Drawing(drawn, _sentence(at, window, m))

    def pulled(values: Values, at: Array) -> Values:
        return placed("m_u", "m_v", (values["u"], values["v"]))(values, at)

    return Model("votes", about, settings, draw, {"window": placed("u", "v"), "m": pulled})


def _photo(paper: Paper, photo: Drawn, at: tuple[int, int]) -> Panel:
    title, part = "the photograph, and the window", (_SIDE, _SIDE)
    panel = paper.picture_panel(_PANEL, part, title, (_LEFT, _TOP))
    panel.image(photo[_TOP : _TOP + _SIDE, _LEFT : _LEFT + _SIDE])
    corners = [[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]
    panel.line(np.add(at, np.multiply(corners, _HALF + 0.5)), ESTIMATED, 1.8, rim=1.7)
    panel.grip("window", "the window, to be moved over the photograph", at, 5)
    return panel


def _votes(
    paper: Paper, photo: Drawn, at: tuple[int, int], window: Window, corners: Array
) -> Panel:
    """Draw each pixel's line, the thicker and darker the longer its gradient, weak ones first."""
    (u, v), n = at, 2 * _HALF + 1
    panel = paper.picture_panel(_PANEL, (n, n), "the votes in it: pull m", (u - _HALF, v - _HALF))
    part = photo[v - _HALF : v + _HALF + 1, u - _HALF : u + _HALF + 1]
    pale = 255 - 16 * np.rint((271.0 - part) / 64)  # few greys pack small
    panel.image(pale.astype(np.uint8), smooth=False)
    length = np.linalg.norm(window.g, axis=1)
    for i in np.argsort(length)[(length == 0).sum() :]:
        across = window.g[i, ::-1] * [-1, 1] / length[i]
        ends = window.p[i] + 3 * _HALF * np.outer([-1, 1], across)
        if length[i] < _WEAK:
            panel.line(ends, _NOISE, 0.7)
            continue
        upright = abs(window.g[i, 0]) > abs(window.g[i, 1])
        weight = _weight(length[i])
        ink = mixed("#FFFFFF", ESTIMATED if upright else LENS, 0.25 + 0.75 * weight)
        panel.line(ends, ink, 0.8 + 3.2 * weight)
    panel.mark(corners, "ideal", 16)
    return panel


def _weight(steep: float) -> float:
    """Return how much a pixel counts in the sum of squares, from its gradient's length: up to 1."""
    return min(steep / _STRONG, 1) ** 2


def _draw_misses(panel: Panel, window: Window, m: Array) -> None:
    """Draw how far the lines pass m by, and round their crossing where the sum is 2, 4 … times."""
    length = np.linalg.norm(window.g, axis=1)
    strong = length > _WEAK
    n = window.g[strong] / length[strong, None]
    feet = m + n * np.sum(n * (window.p[strong] - m), axis=1)[:, None]
    for foot, steep in zip(feet, length[strong], strict=True):
        panel.line([m, foot], WORLD, 0.6 + 2 * _weight(steep))
    if window.eigenvalues[1] > _NOTHING:
        half = window.axes / np.sqrt(window.eigenvalues / window.misses(window.least))
        across = half[:, 1] * np.sign(half[0, 1] - half[1, 1])  # the short way, up or to the right
        for times in (2, 4, 8):
            reach = np.sqrt(times - 1)
            panel.line(window.least + circle(181) * reach @ half.T, IDEAL, 1.6, dash=4)
            panel.text(window.least + reach * across, f"{times}×", IDEAL, anchor="mm", size=12)
    panel.mark(m, "world", 11)
    panel.text(m + [0.2, 0.25], "m", WORLD, size=18)
    panel.grip("m", "a point, for which all lines might vote", m, 5)


def _sentence(at: tuple[int, int], window: Window, m: Array) -> str:
    small, large = window.eigenvalues
    said = f"""At ({at[0]}, {at[1]}) the eigenvalues are {small:.0f} and {large:.0f}, R =
    {window.R / 1e6 + 0.0:.0f} million: """
    if large < _NOTHING:
        return f"{said}both are small: flat, nothing changes here."
    if np.isnan(window.crossing).any():
        return f"{said}one is large, this is an edge."
    u, v = window.crossing
    inside = max(abs(u - at[0]), abs(v - at[1])) <= _HALF
    what = "this is a corner" if inside else "a corner is near, outside of the window"
    said = f"{said}both are large, {what}. The votes cross at ({u:.2f}, {v:.2f})"
    times = window.misses(m) / window.misses(window.least)
    return f"{said}; at m the sum of squares is {times:.1f} times as large as there."
