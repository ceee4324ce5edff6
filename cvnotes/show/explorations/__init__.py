"""Explorations: pictures that follow sliders, and stills of the same pictures for the page.

``explore(name)`` gives a widget for a running notebook, ``model(name).still(…)`` the picture it
shows for some values, with its alternative text. Both call one pure model, so the page and the
widget cannot disagree.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING

from cvnotes.base import CvnotesError
from cvnotes.camera import Camera
from cvnotes.show.explorations.camera import camera_model
from cvnotes.show.explorations.columns import columns_model
from cvnotes.show.explorations.cube import cube_model
from cvnotes.show.explorations.depth import depth_model
from cvnotes.show.explorations.dolly import dolly_model
from cvnotes.show.explorations.finding import finding_model
from cvnotes.show.explorations.fisheye import fisheye_model
from cvnotes.show.explorations.fold import fold_model
from cvnotes.show.explorations.folds import folds_model
from cvnotes.show.explorations.homography import homography_model
from cvnotes.show.explorations.lens import lens_model
from cvnotes.show.explorations.model import Model
from cvnotes.show.explorations.noise import noise_model
from cvnotes.show.explorations.pinhole import pinhole_model
from cvnotes.show.explorations.projection import projection_model
from cvnotes.show.explorations.ransac import ransac_model
from cvnotes.show.explorations.rectification import rectification_model
from cvnotes.show.explorations.ring import ring_model
from cvnotes.show.explorations.rod import rod_model
from cvnotes.show.explorations.ruler import ruler_model
from cvnotes.show.explorations.shadows import shadows_model
from cvnotes.show.explorations.straighten import straighten_model
from cvnotes.show.explorations.tilt import tilt_model
from cvnotes.show.explorations.triangle import triangle_model
from cvnotes.show.explorations.valley import valley_model
from cvnotes.show.explorations.votes import votes_model
from cvnotes.show.explorations.warp import warp_model
from cvnotes.targets import Chessboard

if TYPE_CHECKING:
    from cvnotes.show.explorations.shell import Explorer

_MODELS: dict[str, Callable[[Camera, Chessboard], Model]] = {
    "projection": lambda camera, _: projection_model(camera),
    "camera": camera_model,
    "lens": lambda camera, _: lens_model(camera),
    "homography": homography_model,
    "noise": noise_model,
    "warp": warp_model,
    "rectification": rectification_model,
    "tilt": tilt_model,
}
# What the course itself has photographed or thought of: no other camera or board can be given.
_STORIES: dict[str, Callable[[], Model]] = {
    "straighten": straighten_model,
    "ring": ring_model,
    "ruler": ruler_model,
    "rod": rod_model,
    "shadows": shadows_model,
    "triangle": triangle_model,
    "pinhole": pinhole_model,
    "votes": votes_model,
    "fold": fold_model,
    "folds": folds_model,
    "finding": finding_model,
    "columns": columns_model,
    "depth": depth_model,
    "dolly": dolly_model,
    "cube": cube_model,
    "fisheye": fisheye_model,
    "valley": valley_model,
    "ransac": ransac_model,
}
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
    if name in _STORIES:
        if camera is not None or board is not None:
            raise CvnotesError(f"{name}: shows photographs of the course; give no camera or board")
        return _STORIES[name]()
    if camera is None or board is None:
        from cvnotes.pictures import course

        camera = course.camera() if camera is None else camera
        board = course.board() if board is None else board
    return _MODELS[name](camera, board)


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
