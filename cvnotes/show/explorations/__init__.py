"""Explorations: pictures that follow sliders, and stills of the same pictures for the page.

``explore(name)`` gives a widget for a running notebook, ``model(name).still(…)`` the picture it
shows for some values, with its alternative text. Both call one pure model, so the page and the
widget cannot disagree.
"""

from importlib import import_module
from typing import TYPE_CHECKING, cast

from cvnotes.base import CvnotesError
from cvnotes.camera import Camera
from cvnotes.show.explorations.model import Model
from cvnotes.targets import Chessboard

if TYPE_CHECKING:
    from cvnotes.show.explorations.shell import Explorer

# Each is a module of this folder, in which `<name>_model` makes its model: of a camera and a board,
_MODELS = ("projection", "camera", "lens", "noise", "warp", "rectification", "tilt")
# or of what the course itself has photographed or thought of.
_STORIES = (
    "straighten", "ring", "maps", "ruler", "rod", "shadows", "triangle", "pinhole", "dolly",
    "walks", "gimbal", "fisheye", "newton", "clouds", "votes", "ellipse", "valley", "ransac",
    "homography", "fold", "folds", "finding", "eleventh", "columns", "between", "rings", "epipolar",
    "depth", "cube",
)  # fmt: skip
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
    >>> model("lens").drawing(k1=-4 / 3, k2=0).sentence[:48]
    'The lens shows nothing beyond max_radius = 0.500'
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
    name: str, *, camera: Camera | None = None, board: Chessboard | None = None
) -> "Explorer":
    """Explore an idea of the course: sliders, and a picture that follows them and the hand.

    Parameters
    ----------
    name : str
        "straighten", "ring", "lens", …: one of `NAMES`.
    camera, board : optional
        As for `model`.

    Raises
    ------
    CvnotesError
        There is no such exploration, or it takes no camera and no board.

    Examples
    --------
    >>> explore("ring").values
    {'angle': 45.0}
    """
    from cvnotes.show.explorations.shell import Explorer

    return Explorer(model(name, camera, board), camera, board)
