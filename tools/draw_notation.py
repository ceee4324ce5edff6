"""Draw the small pictures of docs/notation.md: python tools/draw_notation.py"""

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from cvnotes.camera import Lens
from cvnotes.show import CAMERA, ESTIMATED, IDEAL, LENS, WORLD
from cvnotes.show.style import MUTED
from cvnotes.targets import Chessboard

OUT = Path(__file__).resolve().parents[1] / "docs" / "figures"
mpl.rcParams.update({"svg.hashsalt": "cvnotes", "svg.fonttype": "none", "font.size": 11})


def canvas(width: float, height: float, x: tuple[float, float], y: tuple[float, float]) -> Any:
    """Return empty axes, v downwards."""
    ax = Figure(figsize=(width, height)).add_axes((0, 0, 1, 1))
    ax.set(xlim=x, ylim=(y[1], y[0]), aspect="equal")
    ax.axis("off")
    return ax


def arrow(ax: Any, start: Any, end: Any, text: str, colour: str, shift: Any = (4, 4)) -> None:
    ax.annotate("", end, start, arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.8})
    ax.annotate(text, end, shift, textcoords="offset points", color=colour)


def frames() -> Any:
    """The CRF, and a world frame that G carries into it."""
    ax = canvas(4.6, 2.5, (-1.2, 8.0), (-2.1, 2.9))
    c, w = np.array([0.6, 0.9]), np.array([6.0, -0.4])
    ax.plot([c[0], 1.7, 1.7, c[0]], [c[1], 0.2, 1.6, c[1]], color=CAMERA, lw=1)
    arrow(ax, c, c + [1.7, 0], "z forward", CAMERA, (4, -4))
    arrow(ax, c, c + [-0.55, 0.55], "x right", CAMERA, (-44, -10))
    arrow(ax, c, c + [0, 1.2], "y down", CAMERA, (-18, -14))
    arrow(ax, w, w + [1.4, -0.3], "X", WORLD)
    arrow(ax, w, w + [0.35, 1.2], "Y", WORLD)
    arrow(ax, w, w + [0.8, 0.8], "Z", WORLD)
    arrow(ax, c + [0.1, -0.1], w + [-0.1, -0.15], "", ESTIMATED)
    ax.text(3.0, -1.15, "T: the WRF's origin,\nseen from the CRF", color=ESTIMATED, ha="center")
    ax.text(0.2, -0.1, "CRF", color=CAMERA, ha="center")
    ax.text(6.2, -1.5, "WRF", color=WORLD)
    return ax


def pixels() -> Any:
    """A picture of 4 × 3 pixels, with its corners in coordinates."""
    ax = canvas(4.2, 2.9, (-1.9, 5.0), (-1.3, 3.4))
    for u in range(4):
        for v in range(3):
            ax.add_patch(Rectangle((u - 0.5, v - 0.5), 1, 1, fc="white", ec=MUTED))
            ax.plot(u, v, ".", color=LENS)
    for (u, v), place in {(0, 0): (0, 6), (3, 2): (0, 6)}.items():
        ax.annotate(f"({u}, {v})", (u, v), place, textcoords="offset points", color=LENS, size=8,
                    ha="center")  # fmt: skip
    ax.text(-0.5, -0.7, "(−½, −½)", ha="center", color=IDEAL, size=10)
    ax.text(3.5, 2.95, "(3½, 2½)", ha="center", color=IDEAL, size=10)
    arrow(ax, (-0.9, -1.0), (0.9, -1.0), "u", IDEAL, (4, -4))
    arrow(ax, (-1.3, -0.5), (-1.3, 1.1), "v", IDEAL, (-4, -14))
    ax.text(1.5, 3.3, "size = (4, 3), image.shape = (3, 4)", ha="center", size=10)
    return ax


def planes() -> Any:
    """Ideal image point, lens, pixel."""
    ax = canvas(4.6, 2.1, (-1.25, 6.2), (-1.3, 1.75))
    lens, ideal = Lens(k=(-0.25,)), np.array([0.78, 0.5])
    seen = lens.distort(ideal)
    for left, name in ((0.0, "plane z = 1"), (4.2, "picture")):
        ax.add_patch(Rectangle((left - 1.1, -0.85), 2.2, 1.7, fc="none", ec=MUTED))
        ax.text(left, 1.25, name, ha="center", color=MUTED)
    ax.plot(0, 0, "+", color=IDEAL, ms=9)
    ax.plot([0, ideal[0]], [0, ideal[1]], ":", color=MUTED)
    ax.plot(*ideal, "+", color=IDEAL, ms=10, mew=2)
    ax.plot(*seen, "o", color=LENS)
    ax.annotate("xy", ideal, (-3, 7), textcoords="offset points", color=IDEAL)
    ax.annotate("xy_lens", seen, (-52, -8), textcoords="offset points", color=LENS)
    arrow(ax, (1.5, 0.0), (2.7, 0.0), "", IDEAL)
    ax.text(2.1, -0.15, "A", ha="center")
    ax.plot(4.2 + seen[0], seen[1], "o", color=LENS)
    ax.annotate("m = (u, v)", (4.2 + seen[0], seen[1]), (-62, 3), textcoords="offset points",
                color=LENS)  # fmt: skip
    return ax


def board() -> Any:
    """A chessboard: origin, axes, order of corners, the dark square."""
    target = Chessboard((5, 4), 1.0)
    ax = canvas(4.0, 3.2, (-1.9, 5.9), (-1.7, 4.6))
    for i in range(-1, 5):
        for j in range(-1, 4):
            ax.add_patch(
                Rectangle((i, j), 1, 1, fc="#404040" if (i + j) % 2 == 0 else "white", ec=MUTED)
            )
    for n, (x, y, _) in enumerate(target.points):
        ax.plot(x, y, "s", color=WORLD, ms=4)
        ax.annotate(str(n), (x, y), (3, 3), textcoords="offset points", color=ESTIMATED, size=9)
    arrow(ax, (0, -1.3), (1.8, -1.3), "x", WORLD, (4, -4))
    arrow(ax, (-1.4, 0), (-1.4, 1.8), "y", WORLD, (-4, -14))
    return ax


def homography() -> Any:
    """H leads from the source plane to the target plane."""
    ax = canvas(4.6, 1.7, (-0.4, 7.2), (-0.5, 2.3))
    src = np.array([[0, 0], [2, 0], [2, 1.5], [0, 1.5], [0, 0]])
    dst = np.array([[4.6, 0.3], [6.6, 0.0], [6.9, 1.8], [4.8, 1.3], [4.6, 0.3]])
    ax.plot(*src.T, "s-", color=WORLD, ms=4)
    ax.plot(*dst.T, "o-", color=LENS, ms=4)
    arrow(ax, (2.5, 0.75), (4.2, 0.75), "", ESTIMATED)
    ax.text(3.3, 0.55, "H", ha="center", color=ESTIMATED)
    ax.text(1.0, 2.1, "src", ha="center", color=WORLD)
    ax.text(5.7, 2.2, "dst ≈ H src", ha="center", color=LENS)
    return ax


def rotation() -> Any:
    """A positive angle about z turns x towards y: clockwise on the screen."""
    ax = canvas(2.9, 2.2, (-0.6, 2.9), (-0.6, 2.2))
    arrow(ax, (0, 0), (2.2, 0), "x", CAMERA)
    arrow(ax, (0, 0), (0, 1.9), "y", CAMERA)
    angle = np.linspace(0, np.radians(40), 30)
    ax.plot(1.2 * np.cos(angle), 1.2 * np.sin(angle), color=ESTIMATED)
    arrow(ax, (0, 0), (2.0 * np.cos(angle[-1]), 2.0 * np.sin(angle[-1])), "R x", ESTIMATED)
    ax.text(1.3, 0.6, "θ > 0", color=ESTIMATED)
    return ax


def cell() -> Any:
    """The four pixels around a point, and its fractions."""
    ax = canvas(3.2, 2.6, (-0.7, 2.2), (-0.5, 1.6))
    for n, (u, v) in enumerate([(0, 0), (1, 0), (0, 1), (1, 1)], start=1):
        ax.plot(u, v, "o", color=LENS)
        ax.annotate(f"$I_{n}$", (u, v), (-16, 6), textcoords="offset points", color=LENS)
    ax.plot([0, 1, 1, 0, 0], [0, 0, 1, 1, 0], color=MUTED, lw=1)
    ax.plot(0.35, 0.6, "x", color=ESTIMATED)
    ax.annotate("(u, v)", (0.35, 0.6), (5, -3), textcoords="offset points", color=ESTIMATED)
    arrow(ax, (0, 0.6), (0.35, 0.6), "", IDEAL)
    ax.text(0.13, 0.78, "du", size=10)
    ax.plot([0.35, 0.35], [0, 0.6], ":", color=IDEAL)
    ax.text(0.4, 0.27, "dv", size=10)
    ax.text(0, -0.3, "$(u_k, v_k) = (⌊u⌋, ⌊v⌋)$", ha="left", size=10)
    return ax


def main() -> None:
    OUT.mkdir(parents=True, exist_ok=True)
    for draw in (frames, pixels, planes, board, homography, rotation, cell):
        figure = draw().figure
        figure.savefig(OUT / f"{draw.__name__}.svg", metadata={"Date": None})


if __name__ == "__main__":
    main()
