"""Explore Levenberg–Marquardt: a cost over two unknowns as ground, and two walks over it."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera
from cvnotes.homography import dlt, normaliser, refine_homography
from cvnotes.pictures import course
from cvnotes.projective import apply, to_homogeneous
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.explorations.strokes import contours
from cvnotes.show.style import ESTIMATED, IDEAL, LENS

_H6, _H9, _MOST = (-2.7, 1.0), (-1.4, 2.3), 25  # where walks may set out; steps
_SHOWN = (-2.8, 1.1), (2.4, -1.5)  # of the two unknowns: a little more
_TONES = np.array([[255, 255, 252], [224, 217, 202], [120, 108, 92]])  # from low to high ground
_WALKS = (("Levenberg–Marquardt", ESTIMATED, 3.2), ("without damping", LENS, 1.4))


class Floor(NamedTuple):
    """Corners of tiles and where they are seen, normalised, and the homography between them."""

    tiles_h: Array
    seen: Array
    best: Array
    px: float  # from the length of the residuals to their RMS in pixels

    def residuals(self, h: Array) -> tuple[Array, Array]:
        """Return r (84,) and J (84, 2) where the unknowns 6 and 9 are h, the others the best."""
        H = self.best.copy()
        H[1, 2], H[2, 2] = h
        x, y, w = H @ self.tiles_h.T
        r = np.stack([x / w, y / w], axis=1) - self.seen
        J = np.stack([np.stack([0 * w, 1 / w], 1), np.stack([-x, -y], 1) / w[:, None] ** 2], 2)
        return r.ravel(), J.reshape(-1, 2)

    def rms(self, h: Array) -> float:
        """Return the RMS in pixels."""
        return float(np.linalg.norm(self.residuals(h)[0])) * self.px

    def walk(self, h: Array, mu: float) -> Array:
        """Return the places (26, 2) of a walk of the chapter; without damping where mu is 0."""
        way = [h]
        damped = mu > 0
        for _ in range(_MOST):
            r, J = self.residuals(way[-1])
            step = np.linalg.lstsq(J.T @ J + mu * np.eye(2), -J.T @ r)[0]
            lower = self.rms(way[-1] + step) < self.rms(way[-1])
            mu = mu / 10 if lower else mu * 10
            way.append(way[-1] + step * (lower or not damped))
        return np.array(way)


@lru_cache(maxsize=1)
def rows_of_tiles() -> tuple[Array, Array]:
    """Return the corners (42, 2) of six rows of tiles on chapter 6's floor, and their pixels."""
    G = np.array([[1.0, 0, 0, 0], [0, 0, -1, 300], [0, 1, 0, 0], [0, 0, 0, 1]])
    rows, columns = (450, 600, 900, 1500, 3000, 6000), range(-300, 301, 100)
    tiles = np.array([[x, y] for y in rows for x in columns], float)
    return tiles, Camera(course.camera().A, G).project(np.insert(tiles, 2, 0, axis=1))


@lru_cache(maxsize=1)
def floor() -> Floor:
    """Measure the rows of tiles with a noise of one pixel, as chapter 6 does."""
    tiles, exact = rows_of_tiles()
    seen = exact + np.random.default_rng(6).normal(scale=1.0, size=exact.shape)
    N1, N2 = normaliser(tiles), normaliser(seen)
    best = N2 @ refine_homography(dlt(tiles, seen), tiles, seen) @ np.linalg.inv(N1)
    px = 1 / (N2[0, 0] * np.sqrt(len(tiles)))
    return Floor(to_homogeneous(apply(N1, tiles)), apply(N2, seen), best / best[2, 2], px)


@lru_cache(maxsize=1)
def _ground() -> Drawn:
    """Paint the logarithm of the cost: light where it is low, with lines of equal height."""
    (h6, h9), of = (np.linspace(*ends, 396) for ends in _SHOWN), floor()
    H = np.broadcast_to(of.best, (396, 396, 3, 3)).copy()
    H[..., 1, 2], H[..., 2, 2] = h6, h9[:, None]
    x = H @ of.tiles_h.T
    cost = np.sum((x[..., :2, :] / x[..., 2:, :] - of.seen.T) ** 2, axis=(2, 3))
    height = np.log10(cost.clip(1e-2, 1e5))
    ground = np.stack([np.interp(height, [0.2, 2.2, 4.5], tone) for tone in _TONES.T], axis=-1)
    slope = np.interp(height, [2, 2.7], [14, 0]) * np.gradient(height, axis=0)
    lit = (1 + slope).clip(0.8, 1)[..., None]  # from above; walls are dark anyway
    line = contours(height, np.arange(0, 2.6, 1 / 3), 1)[..., None]  # none on the walls
    return np.asarray((lit * ground + line * (255 - lit * ground)).round(), dtype=np.uint8)


def valley_model() -> Model:
    """Make the model of the ground, and of two walks that set out from one place."""
    settings = (
        Setting("h6", "start, ĥ6", *_H6, 0.05, 0.3, "the start: height in the picture"),
        Setting("h9", "start, ĥ9", *_H9, 0.05, 2.0, "the start: depth of the tiles"),
        Setting("steps", "steps", 0, _MOST, 1, 12, "how many steps are taken"),
        Setting("mu", "log₁₀ μ at the start", -6, 4, 1, -3, "how the first step is damped"),
    )
    about = (
        "A cost over two unknowns as ground, light where it is low, with dark walls, and two walks "
        "from one start: Levenberg–Marquardt and one without damping. Beside it their RMS after "
        "each step."
    )

    def draw(paper: Paper, values: Values) -> Drawing:
        start, taken = np.array([values["h6"], values["h9"]]), int(values["steps"])
        of, mu = floor(), 10.0 ** values["mu"]
        ways = [of.walk(start, mu)[: taken + 1], of.walk(start, 0)[: taken + 1]]
        ground = paper.panel((396, 396), *_SHOWN, "the cost over ĥ6 (→) and ĥ9 (↑)")
        ground.image(_ground())
        for tick in (-2, -1, 0):
            ground.text([tick, -1.42], f"{tick}".replace("-", "−"), anchor="md", size=11)
        for tick in (-1, 0, 1, 2):
            ground.text([-2.76, tick], f"{tick}".replace("-", "−"), size=11)
        for row, wall in enumerate(-(of.tiles_h[::7, :2] @ of.best[2, :2])[:5], 1):
            ground.text([1.02 - 0.12 * (row % 2), wall], f"{row}", IDEAL, anchor="mm", size=11)
        ground.mark(of.best[[1, 2], [2, 2]], "ideal", 12)
        for way, (_, colour, width) in zip(ways, _WALKS, strict=True):
            ground.line(way, colour, width)
        for way, meaning in zip(ways, ("estimated", "lens"), strict=True):
            ground.mark(way[-1], meaning, 8)
        ground.mark(start, "world", 9)
        ground.grip("start", "where the walks set out", start, 5)
        rms = [[of.rms(h) for h in way] for way in ways]
        return Drawing(paper.join((ground, _curves(paper, rms))), _sentence(of, ways, rms))

    def moved(_: Values, at: Array) -> Values:
        return {"h6": float(at[0]), "h9": float(at[1])}

    return Model("valley", about, settings, draw, {"start": moved})


def _curves(paper: Paper, rms: list[list[float]]) -> Panel:
    panel = paper.panel((440, 396), (-1.5, _MOST + 1), (5.4, -0.9), "RMS (px) after each step")
    panel.ticks(x=(5, 10, 15, 20, 25), size=11)
    for power in range(6):
        panel.line([[-2, power], [_MOST + 2, power]], "#DDDDDD", 0.5)
        panel.text([-1.3, power], f"{10**power:,}", anchor="lm", size=11)
    for values, (name, colour, width), meaning, up in zip(
        rms, _WALKS, ("estimated", "lens"), (-0.3, 0.3), strict=True
    ):
        curve = np.column_stack([np.arange(len(values)), np.log10(np.clip(values, 0.1, 1e6))])
        panel.line(curve, colour, width)
        panel.mark(curve[-1], meaning, 7)
        steps, high = curve[-1].tolist()
        at, anchor = (steps + 0.8, "lm") if steps < 15 else (_MOST, "rm")
        panel.text([at, min(high + up, 5)], name, colour, anchor=anchor, size=12)
    return panel


def _sentence(of: Floor, ways: list[Array], rms: list[list[float]]) -> str:
    best, steps = of.best[[1, 2], [2, 2]], len(ways[0]) - 1
    ends = []
    for way, values in zip(ways, rms, strict=True):
        there = np.flatnonzero(np.linalg.norm(way - best, axis=1) < 1e-3)
        arrived = f"is in the hollow after {there[0]}" if len(there) else "is not there"
        ends.append(f"{arrived}, RMS {values[-1]:,.4g} px")
    return f"{steps} steps. Levenberg–Marquardt {ends[0]}; without damping the walk {ends[1]}."
