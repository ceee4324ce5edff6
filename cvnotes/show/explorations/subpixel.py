"""Explore a corner between the pixels: pull it, and two finders follow to a hundredth of one."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array, Image
from cvnotes.camera import Camera
from cvnotes.pictures import course, expose, render
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.explorations.strokes import circle
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED
from cvnotes.targets import refine_edges, refine_subpixel

_VIEW, _CORNER = 6, 22  # which photograph of the course, and which of its corners
_HALF, _WINDOW = 20, 8  # px, of the picture that is made, and of the window
_PIXEL = np.array([352.0, 213.0])  # in the middle of both
_SHOWN = 6.5  # px to each side of the middle
_RINGS = 0.005, 0.02, 0.1, 0.5  # px: the largest ring, as large as the errors ask for


def subpixel_model() -> Model:
    """Make the model of one corner of a photograph, whose place is pulled."""
    u, v = course.exact_corners()[_VIEW, _CORNER].round(2).tolist()
    settings = (
        Setting("u", "u (px)", 350.5, 353.5, 0.01, u, "where the corner truly is"),
        Setting("v", "v (px)", 211.5, 214.5, 0.01, v, "where the corner truly is"),
        Setting("blur", "blur σ (px)", 0.2, 2, 0.05, 0.7, "of the lens"),
        Setting("noise", "noise σ", 0, 10, 0.5, 2, "of each pixel, in grey levels"),
    )
    about = (
        "Thirteen by thirteen pixels around a corner of a chessboard; beside it, enlarged as far "
        "as their errors allow, what two finders say: the gradients and the edge model."
    )
    return Model("subpixel", about, settings, _draw, {"corner": _pulled})


def _pulled(_: Values, at: Array) -> Values:
    return {"u": float(at[0]), "v": float(at[1])}


@lru_cache(maxsize=64)
def photograph(u: float, v: float, blur: float, noise: float) -> Image:
    """Photograph the corner at (u, v), at each place with new noise."""
    A = course.camera().A.copy()
    corner = Camera(A, course.poses()[_VIEW]).project(course.board().points[_CORNER])
    A[:2, 2] += [u, v] - _PIXEL + _HALF - corner
    size = (2 * _HALF + 1, 2 * _HALF + 1)
    light = render(course.board(), Camera(A, course.poses()[_VIEW], size=size), blur=blur)
    return expose(light, noise=noise, rng=np.random.default_rng([round(100 * u), round(100 * v)]))


def measured(grey: Image) -> Array:
    """Measure the corner in two ways, from the whole pixel in the middle: (2, 2)."""
    start = [[_HALF, _HALF]]
    both = (find(grey, start, window=_WINDOW)[0] for find in (refine_subpixel, refine_edges))
    return np.asarray(np.array([*both]) + _PIXEL - _HALF)


def _draw(paper: Paper, values: Values) -> Drawing:
    true = np.array([values["u"], values["v"]])
    grey = photograph(values["u"], values["v"], values["blur"], values["noise"])
    found = measured(grey)
    panel = _square(paper, _PIXEL, _SHOWN, "the pixels: pull the corner")
    inside = slice(round(_HALF - _SHOWN + 0.5), round(_HALF + _SHOWN + 0.5))
    panel.image(grey[inside, inside].astype(np.uint8), smooth=False)
    panel.mark(true, "ideal", 11)
    panel.grip("corner", "the true corner", true, 1)
    far = np.linalg.norm(found - true, axis=1).max()
    ring = next((r for r in _RINGS if r > far), _RINGS[-1])
    near = 1.14 * ring
    close = _square(paper, true, near, f"{ring:g} px about the true corner")
    for r in (0.2 * ring, 0.5 * ring, ring):
        close.line(true + r * circle(91), "#DDDDDD", 0.8)
        close.text(true + [0, r - 0.045 * near], f"{r:g} px", MUTED, anchor="mm", size=10)
    for row, (name, meaning, ink, at) in enumerate(
        (
            ("true", "ideal", IDEAL, true),
            ("gradients", "lens", LENS, found[0]),
            ("edge model", "estimated", ESTIMATED, found[1]),
        )
    ):
        key = true + [-0.93 * near, (-0.94 + 0.085 * row) * near]  # beyond the rings
        shown = np.clip(at, true - 0.94 * near, true + 0.94 * near)  # farther: at the rim
        close.mark(shown, meaning, 9)
        close.mark(key, meaning, 6)
        close.text(key + [0.05 * near, 0], name, ink, size=11)
    return Drawing(paper.join((panel, close)), _sentence(true, found))


def _square(paper: Paper, middle: Array, reach: float, title: str) -> Panel:
    u, v = middle.tolist()
    return paper.panel((390, 390), (u - reach, u + reach), (v - reach, v + reach), title)


def _sentence(true: Array, found: Array) -> str:
    gradients, edges = (
        f"{off:.3f} px" if off >= 0.0005 else "less than 0.001 px"
        for off in np.linalg.norm(found - true, axis=1)
    )
    return (
        f"The corner is at ({true[0]:.2f}, {true[1]:.2f}). The gradients find it to {gradients}, "
        f"the edge model to {edges}."
    )
