"""Drawings of ideas: the pinhole, the course's colours."""

from typing import TYPE_CHECKING, Any

import numpy as np

from cvnotes.camera import Camera, Lens, intrinsics, move, pose, rotation_from_vector
from cvnotes.pictures import render
from cvnotes.show.axes import arrow, beside, drawn_on, letter
from cvnotes.show.space.camera_shapes import camera_shapes, ray_shapes
from cvnotes.show.space.directions import sheet
from cvnotes.show.space.shapes import target_shapes
from cvnotes.show.space.stills import draw_scene
from cvnotes.show.style import (
    CAMERA,
    COLOURS,
    FAINT,
    FONT,
    IDEAL,
    LENS,
    MARKERS,
    MUTED,
    WORLD,
)
from cvnotes.targets import Chessboard

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Where x, y and w lead on paper: x to the right, y away from us, w up.

_MEANINGS = {  # with where the words stand on the axes
    "world": ("what stands in the world", (0.03, 0.97)),
    "camera": ("the camera: its centre,\nits image plane", (0.45, 0.08)),
    "ideal": ("the truth, or an ideal:\nhere, without the lens", (0.825, 0.86)),
    "lens": ("a point in a picture,\nas the lens shows it", (0.825, 0.5)),
    "estimated": ("found by a computation:\ncorners, lines, cameras", (0.825, 0.14)),
}


def draw_meanings(*, ax: "Axes | None" = None) -> "Axes":
    """Draw one scene with all five colours and markers, each with its meaning beside it.

    Examples
    --------
    >>> [text.get_text().split(chr(10))[0] for text in draw_meanings().texts][-3:-1]
    ['the truth, or an ideal:', 'a point in a picture,']
    """
    ax, view = drawn_on(ax, width=900, height=290), (14.0, -150.0)
    board = Chessboard((4, 3), 40.0)
    there = pose(rotation_from_vector([0.1, 0.6, 0.1]), [-60, -90, 600])
    camera = Camera(intrinsics(450, 450, 160, 120), lens=Lens(k=(-0.9,)), size=(320, 240))
    image, corner = render(board, camera.moved(there), blur=0.6), move(there, board.points[3])
    seen, true = camera.project(corner), Camera(camera.A).project(corner)
    shapes = [*target_shapes(board, there), *camera_shapes(camera, 300, image=image)[:-1]]
    draw_scene(*shapes, *ray_shapes(camera, seen, to=corner), ax=ax, view=view)
    left, (bottom, top) = ax.get_xlim()[0], ax.get_ylim()
    ax.set_xlim(left, left + 3.15 * (bottom - top))
    for spoke in ax.lines[:-1]:
        spoke.set_linewidth(min(spoke.get_linewidth(), 1.2))
    close = ax.inset_axes((0.625, 0.14, 0.185, 0.72), xticks=[], yticks=[])
    close.imshow(image, cmap="gray", vmin=0, vmax=255, alpha=0.5)
    close.set(xlim=seen[0] + [-7, 7], ylim=seen[1] + [7, -7])
    close.spines[:].set(color=CAMERA, linewidth=1.2)
    here, centre = np.array([corner, camera.centre]) @ sheet(view).T
    # The piece of the picture that is enlarged, and from its near side the lines to the panel.
    piece = np.array([[-7, -7], [7, -7], [7, 7], [-7, 7], [-7, -7]]) + seen - [160, 120]
    frame = 300 * np.insert(piece / 450, 2, 1, axis=1) @ sheet(view).T
    ax.plot(*frame.T, color=FAINT, lw=0.8, zorder=2e6)
    line: dict[str, Any] = {"arrowstyle": "-", "linewidth": 0.9, "shrinkA": 0}
    for side, start in zip((1, 0), frame[1:3], strict=True):
        ax.annotate("", tuple(start), (0, side), "data", close.transAxes, zorder=-1,
                    arrowprops=line | {"lw": 0.7, "shrinkB": 0, "color": FAINT})  # fmt: skip
    places = (here, centre, true, seen, seen + [0.8, 0.9])
    for (meaning, (words, by)), at in zip(_MEANINGS.items(), places, strict=True):
        colour, where = COLOURS[meaning], ax if meaning in ("world", "camera") else close
        marker = "<" if meaning == "camera" else MARKERS[meaning]  # to where it looks
        where.plot(*at, marker, color=colour, ms=12, mew=2.5, zorder=3e6)
        leader = None if where is ax else line | {"color": colour, "shrinkB": 5}
        ax.annotate(words, (at[0], at[1]), by, where.transData, "axes fraction", va="center",
                    zorder=4e6, color=colour, fontsize=FONT + 1, arrowprops=leader)  # fmt: skip
    return ax


def draw_pinhole(*, ax: "Axes | None" = None) -> "Axes":
    """Draw a pinhole camera from the side, with the two similar triangles of v = f y / z.

    Examples
    --------
    >>> ax = draw_pinhole()  # of the point y = 1.5, z = 4, with f = 1.5
    >>> [float(v) for v in ax.lines[0].get_xydata()[1]]  # the ray meets the image plane
    [1.5, 0.5625]
    """
    from matplotlib.patches import FancyBboxPatch

    y, z, f, top = 1.5, 4.0, 1.5, -1.3
    v, light = f * y / z, "#FFE9A8"
    ax = drawn_on(ax, width=760, height=372)
    for end in (y, top):
        ax.plot([-f, f, z], end / z * np.array([-f, f, z]), color=MUTED, linewidth=1, zorder=4)
    ax.fill([-9, 9, 9, -9], [y, y, 9, 9], color="#E3EEDC", linewidth=0)
    box = FancyBboxPatch((-f - 0.5, -y), f + 0.5, 2 * y, "round,pad=0,rounding_size=0.12")
    box.set(facecolor="#3A3A3A", linewidth=0)
    ax.add_patch(box)
    ax.plot([0, 0], [-0.05, 0.05], color=light, linewidth=3)
    for end in (-f, z):
        ax.fill(*np.transpose([[0, 0], [end, y * end / z], [end, top * end / z]]), color=light,
                alpha=0.5, linewidth=0, zorder=2)  # fmt: skip
    _draw_tree(ax, z, 1)
    sheet = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) @ [[0.38, -0.17], [0, 1]]
    for at, colour, alpha in ((-f, "#FBF6E6", 1), (f, CAMERA, 0.3)):  # planes, seen aslant
        ax.fill(*(sheet + [at, 0]).T, fc=colour, ec=CAMERA, lw=1.5, alpha=alpha, zorder=3)
        _draw_tree(ax, at, at / z, 0.5)
    ax.plot([0, 1.22 * z], [0, 0], color=MUTED, linewidth=1, linestyle="-.", zorder=4)
    for at, tip, colour in ((z, y, WORLD), (f, v, LENS)):
        ax.fill([0, at, at], [0, 0, tip], color=colour, alpha=0.2, linewidth=0, zorder=3.5)
        arrow(ax, (at, 0), (at, tip), colour, 2.2, zorder=5)
    ax.plot(0, 0, "o", color=CAMERA, markersize=8, zorder=5)
    span: dict[str, Any] = {"arrowstyle": "<->", "color": IDEAL, "shrinkA": 0, "shrinkB": 0}
    for end, row, name in ((f, y + 0.2, "f"), (z, y + 0.5, "z")):
        ax.annotate("", (0, row), (end, row), arrowprops=span)
        ax.plot([[0, end]] * 2, [[y] * 2, [row + 0.07] * 2], color=MUTED, linewidth=0.8)
        letter(ax, name, (end / 2, row), IDEAL, fontsize=FONT + 3, fontstyle="italic")
    for name, at, by, colour in (
        ("y", (z, y / 2), (8, -3), WORLD), ("v", (f, v / 2), (7, -4), LENS),
        ("pinhole C", (0, 0), (8, 40), CAMERA), ("image plane", (f, -1), (0, 18), CAMERA),
        ("film", (-f, -1), (0, 16), "white"), ("axis", (1.22 * z, 0), (4, -4), MUTED),
    ):  # fmt: skip
        style = "italic" if len(name) == 1 else "normal"
        beside(ax, name, at, by, colour, fontsize=FONT + 1, fontstyle=style, zorder=6)
    ax.set(xlim=(-f - 0.6, 1.33 * z), ylim=(y + 0.75, -y - 0.15), aspect="equal")
    ax.axis("off")
    return ax


def _draw_tree(ax: "Axes", at: float, scale: float, wide: float = 1) -> None:
    """Draw a tree that reaches from y = 1.5 down there to −1.3, or its picture on a plane."""
    from matplotlib.patches import Circle, Polygon
    from matplotlib.transforms import Affine2D

    place = Affine2D.from_values(wide * scale, -(1 - wide) * 0.45 * scale, 0, scale, at, 0)
    trunk = [[-0.1, 1.5], [0.1, 1.5], [0.04, -0.3], [-0.04, -0.3]]
    leaves = (((-0.3, -0.15), "#3E8E54"), ((0.3, -0.2), "#357D49"), ((0, -0.8), "#4BA063"))
    crown = [Circle(middle, 0.5 if middle[0] == 0 else 0.4, color=c) for middle, c in leaves]
    for part in (Polygon(trunk, color="#7A5230"), *crown):
        part.set(transform=place + ax.transData, linewidth=0, zorder=3.7)  # before both wedges
        ax.add_patch(part)
