"""Explore Levenberg–Marquardt: a cost over two unknowns as ground, and two walks over it."""

from collections.abc import Sequence
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
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, rgb

_H6, _H9, _MOST = (-2.7, 1.0), (-1.4, 2.3), 25  # where walks may set out; steps
_MU = 1e-3  # how the first step of the damped one is damped
_SHOWN, _SIDE = ((-2.8, 1.1), (2.4, -1.5)), 396  # of the two unknowns: a little more; px
_HEIGHTS = (-1.0, 0.5, 1.4, 2.0, 2.7, 4.2)  # of the ground: the lower, the darker
_TONES = np.array(
    [rgb(tone) for tone in ("#13233A", "#3A506B", "#7C91AC", "#AABACD", "#D5DDE7", "#FFFFFF")]
)
_LINES = (3, 10, 30, 60, 100, 150, 200, 250, 300)  # px, RMS: of equal height
_WALKS = (("damped", ESTIMATED, 3.2, "estimated"), ("undamped", LENS, 2.0, "lens"))


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
    """Return the corners (42, 2) of six rows of tiles on chapter 6's floor, and their pixels.

    The sensor has 1600 × 1200 pixels, so that the nearest row is seen, too.
    """
    G = np.array([[1.0, 0, 0, 0], [0, 0, -1, 300], [0, 1, 0, 0], [0, 0, 0, 1]])
    rows, columns = (450, 600, 900, 1500, 3000, 6000), range(-300, 301, 100)
    tiles = np.array([[x, y] for y in rows for x in columns], float)
    return tiles, Camera(floor_A(), G).project(np.insert(tiles, 2, 0, axis=1))


def measured() -> tuple[Array, Array]:
    """Return the corners (42, 2) of the tiles, and where they are seen with a noise of a pixel."""
    tiles, exact = rows_of_tiles()
    return tiles, exact + np.random.default_rng(6).normal(scale=1.0, size=exact.shape)


def floor_A() -> Array:
    """Return A (3, 3) of the camera over the floor: as the course's, with a larger sensor."""
    return np.asarray(course.camera().A + [[0, 0, 480], [0, 0, 360], [0, 0, 0]])


@lru_cache(maxsize=1)
def floor() -> Floor:
    """Measure the rows of tiles with a noise of one pixel, as chapter 6 does."""
    tiles, seen = measured()
    N1, N2 = normaliser(tiles), normaliser(seen)
    best = N2 @ refine_homography(dlt(tiles, seen), tiles, seen) @ np.linalg.inv(N1)
    px = 1 / (N2[0, 0] * np.sqrt(len(tiles)))
    return Floor(to_homogeneous(apply(N1, tiles)), apply(N2, seen), best / best[2, 2], px)


@lru_cache(maxsize=1)
def _ground() -> Drawn:
    """Paint the logarithm of the cost, the higher the paler, with lines of equal height.

    With ĥ6 and ĥ9 free, x and the other parts of y and w stay: Σ (a + ĥ6 b)² in each row.
    """
    n = 2 * _SIDE
    (h6, h9), of, H = (np.linspace(*ends, n) for ends in _SHOWN), floor(), floor().best
    x, y, w = (H - np.outer([0, 1, 1], [0, 0, 1]) * H) @ of.tiles_h.T
    b = 1 / (w + h9[:, None])
    a, across = b * y - of.seen[:, 1], b * x - of.seen[:, 0]
    A, B, C = np.sum(a**2 + across**2, axis=1), np.sum(a * b, axis=1), np.sum(b**2, axis=1)
    height = np.log10(A[:, None] + 2 * np.outer(B, h6) + np.outer(C, h6**2))
    line = contours(height, 2 * np.log10(np.divide(_LINES, of.px)), 1.1)
    line[height > 2.5] = 0  # none on the walls
    ground = np.stack([np.interp(height, _HEIGHTS, tone) for tone in _TONES.T], axis=-1)
    ground += line[..., None] * (1 - ground)
    return np.asarray((255 * ground).round().astype(np.uint8))


def valley_model() -> Model:
    """Make the model of the ground, and of two walks that set out from one place."""
    settings = (
        Setting("h6", "start, ĥ6", *_H6, 0.05, -1.2, "the start: height in the picture"),
        Setting("h9", "start, ĥ9", *_H9, 0.05, 1.8, "the start: depth of the tiles"),
        Setting("steps", "steps", 0, _MOST, 1, 15, "how many steps are taken"),
    )
    about = (
        "A cost over two unknowns as ground, with a hollow and walls, and two walks from one "
        "start: Levenberg–Marquardt's, which is damped, and one that is not. Beside it their RMS "
        "after each step."
    )

    def draw(paper: Paper, values: Values) -> Drawing:
        start, taken = np.array([values["h6"], values["h9"]]), int(values["steps"])
        of = floor()
        ways = [of.walk(start, mu)[: taken + 1] for mu in (_MU, 0)]
        ground = paper.panel((_SIDE, _SIDE), *_SHOWN, "cost over ĥ6 (→) and ĥ9 (↑): dark is low")
        ground.image(_ground())
        for way, (_, colour, width, _) in zip(ways, _WALKS, strict=True):
            ground.line(way, "#FFFFFF", width + 1.6)
            ground.line(way, colour, width)
        _name_ground(ground, of)
        for way, (*_, meaning) in zip(ways, _WALKS, strict=True):
            ground.mark(way[-1], meaning, 8)
        ground.mark(start, "world", 9)
        ground.grip("start", "where the walks set out", start, 5)
        rms = [[of.rms(h) for h in way] for way in ways]
        return Drawing(paper.join((ground, _curves(paper, rms))), _sentence(of, ways, rms))

    def moved(_: Values, at: Array) -> Values:
        return {"h6": float(at[0]), "h9": float(at[1])}

    return Model("valley", about, settings, draw, {"start": moved})


def _name_ground(ground: Panel, of: Floor) -> None:
    """Write the numbers of both axes, and what lines and walls are; mark the lowest place."""
    for tick in (-2, -1, 0):
        ground.text([tick, -1.42], f"{tick}".replace("-", "−"), anchor="md", size=11)
    for tick in (-1, 0, 1, 2):
        ground.text([-2.76, tick], f"{tick}".replace("-", "−"), size=11)
    walls = -(of.tiles_h[::7, :2] @ of.best[2, :2])
    names = ("rows 1, 2", "row 3", "row 4", "wall: row 5 at infinity")
    for name, wall in zip(names, (walls[:2].mean(), *walls[2:5]), strict=True):
        ground.text([-2.5, wall], name, IDEAL, size=11)
    best = of.best[[1, 2], [2, 2]]
    for line, way in ((150, [1, 0.5]), (200, [1, 0.75])):
        far = np.outer(np.linspace(0, 1.5, 301), way)
        at = best + far[np.searchsorted([of.rms(best + by) for by in far], line)]
        ground.text(at, f"RMS {line} px", IDEAL, anchor="mm", size=11)
    ground.mark(best, "ideal", 12)


def rms_panel(paper: Paper, size: tuple[int, int], most: int) -> Panel:
    """Make a panel for the RMS after each of so many steps, as a logarithm."""
    left = -46 * most / (size[0] - 60)  # there the numbers stand
    panel = paper.panel(size, (left, 1.04 * most), (4.3, -0.5), "RMS (px) after each step")
    panel.ticks(x=np.arange(1, 6) * (most // 5), size=11)
    for power in range(5):
        panel.line([[-most, power], [2 * most, power]], "#DDDDDD", 0.5)
        panel.text([0.95 * left, power], f"{10**power:,}", anchor="lm", size=11)
    return panel


def rms_curve(panel: Panel, rms: Sequence[float], colour: str, width: float) -> Array:
    """Draw the RMS after each step; return where it ends."""
    curve = np.column_stack([np.arange(len(rms)), np.log10(np.clip(rms, 0.1, 1e6))])
    panel.line(curve, colour, width)
    return np.asarray(curve[-1])


def _curves(paper: Paper, rms: list[list[float]]) -> Panel:
    panel = rms_panel(paper, (440, 396), _MOST)
    for values, (name, colour, width, meaning), up in zip(rms, _WALKS, (-0.3, 0.3), strict=True):
        end = rms_curve(panel, values, colour, width)
        panel.mark(end, meaning, 7)
        steps, high = end.tolist()
        at, anchor = (steps + 0.8, "lm") if steps < 18 else (_MOST, "rm")
        panel.text([at, np.clip(high + up, -0.1, 3.9)], name, colour, anchor=anchor, size=12)
    return panel


def _sentence(of: Floor, ways: list[Array], rms: list[list[float]]) -> str:
    best, steps = of.best[[1, 2], [2, 2]], len(ways[0]) - 1
    ends = []
    for way, values in zip(ways, rms, strict=True):
        there = np.flatnonzero(np.linalg.norm(way - best, axis=1) < 1e-3)
        arrived = f"is in the hollow after {there[0]}" if len(there) else "is not there"
        ends.append(f"{arrived}, RMS {values[-1]:,.4g} px")
    said = f"{steps} steps, refused ones counted."
    return f"{said} The damped walk {ends[0]}; the undamped one {ends[1]}."
