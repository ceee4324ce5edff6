"""What 3-D figures are made of: frames, boards, scenes and the horizon, as arrays in the WRF.

Each ``<thing>_shapes`` gives a tuple of shapes, those of cameras in `camera_shapes`. Any number of
them make a scene to turn in the hand (`viewer`) or a still for the page (`stills`).
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, InputTypeError, number
from cvnotes.camera import move
from cvnotes.pictures import Scene
from cvnotes.show.guards import one_motion, thing
from cvnotes.show.style import MUTED, colour_of
from cvnotes.targets import Chessboard, ThreePlanes, TwoPlanes


class Faces(NamedTuple):
    """Flat faces of three or four corners each, (m, 3 or 4, 3), with colours (m, 4) in 0..1."""

    name: str
    corners: Array
    colours: Array


class Lines(NamedTuple):
    """Segments (k, 2, 3) of one colour."""

    name: str
    ends: Array
    colour: str
    width: float = 1.5


class Photo(NamedTuple):
    """A picture on a rectangle (4, 3), its corners from the top left one clockwise."""

    name: str
    corners: Array
    image: npt.NDArray[np.uint8]


class Label(NamedTuple):
    """Words beside a point (3,): a name, or the letter of an axis, and the way they stand off."""

    name: str
    at: Array
    colour: str
    way: Array = np.zeros(3)


Shape = Faces | Lines | Photo | Label
Shapes = tuple[Shape, ...]


def axes_shapes(
    world_from_frame: npt.ArrayLike | None = None,
    length: float = 100.0,
    *,
    name: str = "WRF",
    meaning: str = "world",
) -> Shapes:
    """Return a frame: three arrows with their letters, small ones for a camera's.

    Parameters
    ----------
    world_from_frame : array_like, shape (4, 4), optional
        Where the frame is; by default it is the WRF.
    length : float
        Of each axis.
    name : str
        Written at the origin.
    meaning : {"world", "camera", "ideal", "lens", "estimated"}
        Whose frame it is; sets the colour.

    Examples
    --------
    >>> [shape.name for shape in axes_shapes(length=50.0)]
    ['WRF axes', 'WRF', 'X', 'Y', 'Z']
    """
    G = np.eye(4) if world_from_frame is None else one_motion(world_from_frame, "world_from_frame")
    length = number(length, "length")
    colour, letters = colour_of(meaning), "xyz" if meaning == "camera" else "XYZ"
    tip, wing = 0.1 * length, 0.04 * length
    ends = []
    for axis, side in zip(np.eye(3), np.eye(3)[[1, 0, 0]], strict=True):
        head = axis * length
        ends.append([0 * axis, head])
        ends += [[head, head - tip * axis + s * wing * side] for s in (-1, 1)]
    tips = np.vstack([np.zeros(3), length * np.eye(3)])
    ways = np.vstack([-np.ones(3), np.eye(3)]) @ G[:3, :3].T
    return (
        Lines(f"{name} axes", move(G, np.array(ends)), colour, 2.2),
        *map(Label, (name, *letters), move(G, tips), [colour] * 4, ways),
    )


def target_shapes(
    target: Chessboard | TwoPlanes | ThreePlanes, world_from_target: npt.ArrayLike | None = None
) -> Shapes:
    """Return a target: the squares of its boards, and a square of white paper around them.

    Parameters
    ----------
    target : Chessboard, TwoPlanes or ThreePlanes
        What was photographed.
    world_from_target : array_like, shape (4, 4), optional
        Where it stands; by default in the origin.

    Examples
    --------
    >>> faces, border = target_shapes(Chessboard((9, 6), 25.0))
    >>> faces.corners.shape
    (108, 4, 3)
    """
    if not hasattr(target, "faces"):
        raise InputTypeError(
            f"target: expected a Chessboard or the like, got {type(target).__name__}"
        )
    G = np.eye(4)
    if world_from_target is not None:
        G = one_motion(world_from_target, "world_from_target")
    parts, inks, borders = [], [], []
    for world_from_board, board in target.faces:
        columns, rows = board.squares
        i, j = np.meshgrid(np.arange(-2, columns), np.arange(-2, rows))
        cells = np.stack([i, j], axis=-1).reshape(-1, 1, 2) + [[0, 0], [1, 0], [1, 1], [0, 1]]
        corners = np.concatenate([cells, 0 * cells[..., :1]], axis=-1) * board.square
        on_board = (i >= -1) & (i < columns - 1) & (j >= -1) & (j < rows - 1)
        dark = on_board & ((i + j) % 2 == 0)
        parts.append(move(G @ world_from_board, corners))
        paper = corners[[0, columns + 1, -1, -columns - 2], [0, 1, 2, 3]]
        borders.append(move(G @ world_from_board, np.stack([paper, np.roll(paper, -1, 0)], 1)))
        inks.append(np.where(dark.ravel()[:, None], (0.15, 0.15, 0.16, 1), (0.99, 0.99, 0.98, 1)))
    faces = Faces("target", np.concatenate(parts), np.concatenate(inks))
    return faces, Lines("target border", np.concatenate(borders), MUTED, 0.7)


def scene_shapes(scene: Scene) -> Shapes:
    """Return a scene's triangles; a checker shows as the mean of its two colours.

    Examples
    --------
    >>> from cvnotes.pictures.meshes import box
    >>> scene_shapes(box((0, 1), (0, 1), (0, 1)))[0].corners.shape
    (12, 3, 3)
    """
    colours = np.ones((len(thing(scene, "scene", Scene).triangles), 4))
    colours[:, :3] = scene.colours.mean(axis=1).clip(0, 1)
    return (Faces("scene", scene.corners, colours),)


def places(*shapes: Shape) -> Array:
    """Return all points (n, 3) of shapes."""
    if not shapes:
        raise CvnotesError("a scene needs at least one shape")
    for shape in shapes:
        if not isinstance(shape, Shape):
            raise InputTypeError(
                "shapes: expected Faces, Lines, Photo or Label one by one, got "
                f"{type(shape).__name__} (forgotten *?)"
            )
    parts = [shape.at if isinstance(shape, Label) else shape[1] for shape in shapes]
    return np.concatenate([np.asarray(part).reshape(-1, 3) for part in parts])


def extent(*shapes: Shape) -> float:
    """Return the longest side of the box around shapes.

    Examples
    --------
    >>> extent(Lines("way", np.array([[[0.0, 0, 0], [3, 20, 4]]]), "black"))
    20.0
    """
    return float(np.ptp(places(*shapes), axis=0).max())
