"""Explorations: pictures that follow sliders, and stills of the same pictures for the page.

``explore(name)`` gives a widget for a running notebook, ``model(name).still(…)`` the picture it
shows for some values, with its alternative text. Both call one pure model, so the page and the
widget cannot disagree.
"""

from importlib import import_module
from typing import TYPE_CHECKING, cast

import numpy.typing as npt

from cvnotes.base import CvnotesError
from cvnotes.base.writing import PathLike
from cvnotes.camera import Camera
from cvnotes.show.explorations.hand import Tell, hand_model
from cvnotes.show.explorations.model import Model
from cvnotes.targets import Chessboard

if TYPE_CHECKING:
    from cvnotes.show.explorations.shell import Explorer, PulledPoints

# Each is a module of this folder, in which `<name>_model` makes its model: of a camera and a board,
_MODELS = ("camera", "lens", "tilt")
# or of what the course itself has photographed or thought of.
_STORIES = (
    "straighten", "stands", "ring", "maps", "ruler", "eye", "rod", "shadows",
    "triangle", "formation", "pinhole", "dolly", "walks", "gimbal", "fisheye", "clouds",
    "subpixel", "votes", "twins", "ellipse", "ransac", "homography", "fold", "folds", "finding",
    "moved", "eleventh", "sheets", "whose", "between", "rings", "plane", "epipolar",
    "rectification", "disparity", "depth", "cube", "conic", "seam", "swing", "frame", "meet",
    "residuals", "hinge", "horizon", "nails", "origin", "similar", "clicks", "zoom", "rim",
    "decentred", "rail", "protractor", "asks", "glass", "stop", "rodrigues", "push", "wishes",
    "bowl", "rows", "entries", "parabola", "six", "parallel", "warp", "poster", "thirteen",
    "imitation", "uphill", "forty",
)  # fmt: skip
__all__ = ["NAMES", "pull_points", "explore", "model"]
NAMES = (*_MODELS, *_STORIES)


def model(name: str, camera: Camera | None = None, board: Chessboard | None = None) -> Model:
    """Return a model of an exploration, for the course's camera and board unless others are given.

    Parameters
    ----------
    name : str
        One of `NAMES`.
    camera, board : optional
        By default the course's. What shows photographs or a thought of the course's own takes
        none.

    Raises
    ------
    CvnotesError
        There is no such exploration, or it takes no camera and no board.

    Examples
    --------
    >>> model("lens").drawing(k1=-4 / 3, k2=0).sentence[:28]
    'The model folds at r = 0.500'
    """
    if name not in NAMES:
        raise CvnotesError(f"name: expected one of {', '.join(NAMES)}, got {name!r}")
    make = getattr(import_module(f"{__name__}.{name}"), f"{name}_model")
    if name in _STORIES:
        if camera is not None or board is not None:
            raise CvnotesError(f"{name}: shows photographs of the course; give no camera or board")
        return cast(Model, make())
    if camera is None or board is None:
        from cvnotes.pictures import course

        camera = course.camera() if camera is None else camera
        board = course.board() if board is None else board
    return cast(Model, make(camera, board))


def explore(
    name: str, *, camera: Camera | None = None, board: Chessboard | None = None, **values: float
) -> "Explorer":
    """Explore an idea of the course: sliders, and a picture that follows them and the hand.

    Parameters
    ----------
    name : str
        "straighten", "ring", "lens", …: one of `NAMES`.
    camera, board : optional
        As for `model`.
    **values : float
        Where sliders stand at first, by the names of the model's settings.

    Raises
    ------
    CvnotesError
        There is no such exploration or slider, or it takes no camera and no board.

    Examples
    --------
    >>> explore("ring").values
    {'angle': 45.0}
    >>> explore("ring", angle=90).values
    {'angle': 90.0}
    """
    from cvnotes.show.explorations.shell import Explorer

    return Explorer(model(name, camera, board).starting(**values), camera, board)


def pull_points(picture: npt.ArrayLike | PathLike, at: npt.ArrayLike, tell: Tell) -> "PulledPoints":
    """Pull points over a picture; at every pull a function of yours says what they mean.

    A loupe shows the point that was moved last, and moves it finely.

    Parameters
    ----------
    picture : array_like, shape (height, width) or (height, width, 3), or path
        Grey values or RGB, as for `draw_image`; or the file of a photograph of your own, which is
        shrunk by a whole number until it is 1600 pixels long at most.
    at : array_like, shape (n, 2)
        Pixels (u, v) where the points are at first, 12 at most. In a photograph of your own there
        are as many, laid around its middle.
    tell : callable
        Called with the picture and the points (n, 2). It returns a sentence and a list of lines
        (k, 2), in pixels, which are drawn over the picture; and, if it likes, another picture,
        shown beside, and lines upon that.

    Returns
    -------
    PulledPoints
        Its ``points`` are where they are now.

    Raises
    ------
    CvnotesError
        There is no point or too many, one lies outside, or what `tell` returns is something else.
    FileError
        The photograph cannot be read.

    Examples
    --------
    >>> def slope(picture, points):
    ...     (u1, v1), (u2, v2) = points
    ...     return f"{(v2 - v1) / (u2 - u1):.2f}", [points]
    >>> black = [64 * [0]] * 48
    >>> pull_points(black, [[10, 40], [30, 20]], slope).model.drawing(u2=20).sentence
    '−2.00'
    """
    from cvnotes.show.explorations.shell import PulledPoints

    return PulledPoints(hand_model(picture, at, tell))
