"""Explore the homography: four corners that can be nudged, and the picture made upright by them."""

from functools import lru_cache

import numpy as np
from PIL import Image as Bitmap

from cvnotes.base import Array, Image
from cvnotes.camera import Camera, pose, rotation_from_vector
from cvnotes.homography import dlt
from cvnotes.pictures import render
from cvnotes.projective import from_homogeneous, to_homogeneous
from cvnotes.show.explorations.boards import pinhole
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Paper, Range
from cvnotes.show.style import ESTIMATED, WORLD
from cvnotes.targets import Chessboard
from cvnotes.warping import rectify_plane

_PICTURE, _SIZE = (440, 330), (410, 330)
_NAMES = ("top left", "top right", "bottom right", "bottom left")


def homography_model(camera: Camera, board: Chessboard) -> Model:
    """Make the model of an oblique picture of `board` by `camera`, its lens left out."""
    settings = tuple(
        Setting(
            f"d{axis}{i}", f"corner {i} {axis}", -80, 80, 1, 0,
            f"moves the {name} corner by so many px along {axis}",
        )
        for i, name in enumerate(_NAMES, start=1)
        for axis in "uv"
    )  # fmt: skip
    view = pinhole(camera).moved(_oblique(board))
    photo = render(board, view, blur=0.7)
    about = (
        "An oblique picture of a chessboard with four corners marked; beside it the picture with "
        "the perspective removed, by the homography of those four corners."
    )

    @lru_cache(maxsize=2)
    def shown(sharpness: int) -> Drawn:
        """Keep the photograph as large as its panel: it is the same for all values."""
        size = (sharpness * _PICTURE[0], sharpness * _PICTURE[1])
        return np.asarray(Bitmap.fromarray(photo.astype(np.uint8)).resize(size))

    def draw(paper: Paper, values: Values) -> Drawing:
        return _draw(photo, shown(paper.sharpness), view, board, paper, values)

    exact = view.project(_outer(board))

    def pulled(i: int, at: Array) -> Values:
        du, dv = (at - exact[i - 1]).tolist()
        return {f"du{i}": du, f"dv{i}": dv}

    drags = {f"corner {i}": lambda _, at, i=i: pulled(i, at) for i in range(1, 5)}
    return Model("homography", about, settings, draw, drags)


def _draw(
    photo: Image, shown: Drawn, camera: Camera, board: Chessboard, paper: Paper, values: Values
) -> Drawing:
    W = _outer(board)
    nudge = [[values[f"du{i}"], values[f"dv{i}"]] for i in range(1, 5)]
    m = camera.project(W) + nudge
    picture = paper.picture_panel(_PICTURE, camera.size, "the picture, and four corners of it")
    picture.image(shown)
    picture.line(m[[0, 1, 2, 3, 0]], ESTIMATED, 1.8)
    picture.mark(m, "estimated", 7)
    for i, at in enumerate(m, start=1):
        picture.grip(f"corner {i}", f"corner {i}, {_NAMES[i - 1]}", at, 1)
        picture.text(
            at + 22 * np.sign(at - m.mean(axis=0)), f"{i}", ESTIMATED, anchor="mm", size=14
        )
    H = dlt(W[:, :2], m)
    upright = paper.panel(_SIZE, *_region(board), "the board from straight above, by H")
    (X0, X1), (Y0, Y1) = upright.x, upright.y
    pixel = (X1 - X0) / (_SIZE[0] * paper.sharpness)
    upright.image(rectify_plane(photo, H, ((X0, Y0), (X1, Y1)), pixel, fill=255).astype(np.uint8))
    upright.line(W[[0, 1, 2, 3, 0], :2], WORLD, 1.2, dash=5)
    upright.mark(W[:, :2], "world", 5)
    return Drawing(paper.join((picture, upright)), _sentence(H, camera, board, bool(np.any(nudge))))


def _sentence(H: Array, camera: Camera, board: Chessboard, nudged: bool) -> str:
    """Return how far the board's inner corners land from where they are, on the plane."""
    W = board.points
    found = from_homogeneous.inside(to_homogeneous(camera.project(W)) @ np.linalg.inv(H).T)
    off = float(np.linalg.norm(found - W[:, :2], axis=-1).max())
    if not nudged:
        return "The four corners are exact, and so is H: every square becomes a square."
    far = f"up to {off:.1f} mm" if off < 1e4 else "more than 10 m"
    return f"By this H the {len(W)} inner corners land {far} away from where they are on the board."


def _outer(board: Chessboard) -> Array:
    """Outer corners (4, 3) of the squares, from the top left clockwise."""
    columns, rows = board.corners
    x0, x1, y0, y1 = -1, columns, -1, rows
    return board.square * np.array([[x0, y0, 0], [x1, y0, 0], [x1, y1, 0], [x0, y1, 0]], float)


def _region(board: Chessboard) -> tuple[Range, Range]:
    """Part of the board's plane to show, x and y: the squares and some more, as wide as needed."""
    corners = _outer(board)[:, :2]
    middle, reach = corners.mean(axis=0), np.ptp(corners, axis=0)
    half = 0.65 * (reach / _SIZE).max() * np.array(_SIZE)
    (x0, y0), (x1, y1) = middle - half, middle + half
    return (float(x0), float(x1)), (float(y0), float(y1))


def _oblique(board: Chessboard) -> Array:
    """Hold the board so that it fills the middle of the picture, tilted to the right and back."""
    R = rotation_from_vector([-0.55, 0.5, 0.1])
    extent = float(np.linalg.norm(board.points[-1] + 2 * board.square))
    return pose(R, [0, 0, 1.75 * extent] - R @ board.points.mean(axis=0))
