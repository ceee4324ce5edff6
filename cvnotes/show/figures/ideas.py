"""A drawing of the course's colours, each with its meaning."""

from typing import TYPE_CHECKING, Any

import numpy as np

from cvnotes.camera import Camera, Lens, intrinsics, move, pose, rotation_from_vector
from cvnotes.pictures import render
from cvnotes.show.axes import drawn_on
from cvnotes.show.space.camera_shapes import camera_shapes, ray_shapes
from cvnotes.show.space.directions import sheet
from cvnotes.show.space.shapes import Lines, target_shapes
from cvnotes.show.space.stills import draw_scene
from cvnotes.show.style import CAMERA, COLOURS, FAINT, FONT, MARKERS
from cvnotes.targets import Chessboard

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MEANINGS = {  # with where the words stand on the axes
    "world": ("what stands in the world", (0.03, 0.97)),
    "camera": ("the camera: its centre,\nits image plane", (0.45, 0.08)),
    "ideal": ("the truth, or an ideal:\nhere, without the lens", (0.825, 0.86)),
    "lens": ("a point in a picture,\nas one sees it", (0.825, 0.5)),
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
    # The camera without its name, and without the tick that says which way is up.
    its = [
        shape._replace(ends=shape.ends[:-2]) if isinstance(shape, Lines) else shape
        for shape in camera_shapes(camera, 300, image=image)[:-1]
    ]
    shapes = [*target_shapes(board, there), *its]
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
        # Light blue is too light for words: it is their ground.
        ground = {"facecolor": CAMERA, "edgecolor": "none", "boxstyle": "round,pad=0.3"}
        ink, box = ("black", ground) if meaning == "camera" else (colour, None)
        ax.annotate(words, (at[0], at[1]), by, where.transData, "axes fraction", va="center",
                    zorder=4e6, color=ink, fontsize=FONT + 1, bbox=box,
                    arrowprops=leader)  # fmt: skip
    return ax
