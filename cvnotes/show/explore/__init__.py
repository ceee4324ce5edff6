"""Explorations: pictures that follow sliders, and stills of the same pictures for the page.

``explore_<name>()`` gives a widget for a running notebook, ``model(name).still(…)`` the picture it
shows for some values, with its alternative text. Both call one pure model, so the page and the
widget cannot disagree.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING

from cvnotes.base import CvnotesError
from cvnotes.camera import Camera
from cvnotes.show.explore.camera import camera_model
from cvnotes.show.explore.columns import columns_model
from cvnotes.show.explore.cube import cube_model
from cvnotes.show.explore.depth import depth_model
from cvnotes.show.explore.finding import finding_model
from cvnotes.show.explore.fold import fold_model
from cvnotes.show.explore.folds import folds_model
from cvnotes.show.explore.homography import homography_model
from cvnotes.show.explore.lens import lens_model
from cvnotes.show.explore.model import Model
from cvnotes.show.explore.noise import noise_model
from cvnotes.show.explore.pinhole import pinhole_model
from cvnotes.show.explore.projection import projection_model
from cvnotes.show.explore.rectification import rectification_model
from cvnotes.show.explore.shadows import shadows_model
from cvnotes.show.explore.straighten import straighten_model
from cvnotes.show.explore.tilt import tilt_model
from cvnotes.show.explore.triangle import triangle_model
from cvnotes.show.explore.votes import votes_model
from cvnotes.show.explore.warp import warp_model
from cvnotes.targets import Chessboard

if TYPE_CHECKING:
    from cvnotes.show.explore.shell import Explorer

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
# What the course itself has photographed: no other camera or board can be given.
_STORIES: dict[str, Callable[[], Model]] = {
    "straighten": straighten_model,
    "shadows": shadows_model,
    "triangle": triangle_model,
    "pinhole": pinhole_model,
    "votes": votes_model,
    "fold": fold_model,
    "folds": folds_model,
    "finding": finding_model,
    "columns": columns_model,
    "depth": depth_model,
    "cube": cube_model,
}
NAMES = (*_MODELS, *_STORIES)


def model(name: str, camera: Camera | None = None, board: Chessboard | None = None) -> Model:
    """Return a model of an exploration, for the course's camera and board unless others are given.

    Parameters
    ----------
    name : str
        One of `NAMES`.
    camera, board : optional
        By default the course's. "straighten", "shadows", "triangle", "pinhole", "votes", "fold",
        "folds", "finding", "columns", "depth" and "cube" show photographs of the course, and take
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


def explore_projection(*, camera: Camera | None = None) -> "Explorer":
    """Move the direction of two rails, and watch where they seem to meet."""
    return _explorer("projection", camera)


def explore_camera(*, camera: Camera | None = None, board: Chessboard | None = None) -> "Explorer":
    """Move α, (u0, v0), the skew, three angles and T; watch a board's picture and the space."""
    return _explorer("camera", camera, board)


def explore_lens(*, camera: Camera | None = None) -> "Explorer":
    """Move k1, k2, k3, p1 and p2, and watch a grid bend and fold."""
    return _explorer("lens", camera)


def explore_homography(
    *, camera: Camera | None = None, board: Chessboard | None = None
) -> "Explorer":
    """Nudge four corners of a board, and watch the picture that their homography makes upright."""
    return _explorer("homography", camera, board)


def explore_noise(*, camera: Camera | None = None, board: Chessboard | None = None) -> "Explorer":
    """Change noise and number of views, and watch the error bars of a calibration."""
    return _explorer("noise", camera, board)


def explore_warp(*, camera: Camera | None = None, board: Chessboard | None = None) -> "Explorer":
    """Turn and zoom a picture forward and backward, and count the holes."""
    return _explorer("warp", camera, board)


def explore_rectification(
    *, camera: Camera | None = None, board: Chessboard | None = None
) -> "Explorer":
    """Turn one camera of a stereo pair, and watch the epipolar lines become rows."""
    return _explorer("rectification", camera, board)


def explore_tilt(*, camera: Camera | None = None, board: Chessboard | None = None) -> "Explorer":
    """Tilt a board before two lenses, and watch when their pictures can be told apart."""
    return _explorer("tilt", camera, board)


def explore_straighten() -> "Explorer":
    """Move the k1 that is taken off a photograph, until a row of its corners is straight."""
    return _explorer("straighten", None)


def explore_shadows() -> "Explorer":
    """Move the sun, and watch where the lines from shadows through what throws them meet."""
    return _explorer("shadows", None)


def explore_triangle() -> "Explorer":
    """Pull the vanishing points of a box, and watch principal point and focal length follow."""
    return _explorer("triangle", None)


def explore_pinhole() -> "Explorer":
    """Make a pinhole wider and smaller, and watch the picture behind it."""
    return _explorer("pinhole", None)


def explore_votes() -> "Explorer":
    """Move a small window over a photograph, and watch its votes and their structure tensor."""
    return _explorer("votes", None)


def explore_fold() -> "Explorer":
    """Turn the eye about a photograph's horizon; it goes on seeing both right angles."""
    return _explorer("fold", None)


def explore_folds() -> "Explorer":
    """Undo the lens, and watch the half circles of twelve photographs meet in the camera."""
    return _explorer("folds", None)


def explore_finding() -> "Explorer":
    """Follow a calibration from the closed form to the answer, and watch its misses."""
    return _explorer("finding", None)


def explore_columns() -> "Explorer":
    """Let the corners of a real board move, and hold one camera's measurement against another's."""
    return _explorer("columns", None)


def explore_depth() -> "Explorer":
    """Shift one picture of a pair over the other, and read how far away things are."""
    return _explorer("depth", None)


def explore_cube() -> "Explorer":
    """Pull a tower over the board on a photographed desk, with the lens and without it."""
    return _explorer("cube", None)


def _explorer(name: str, camera: Camera | None, board: Chessboard | None = None) -> "Explorer":
    from cvnotes.show.explore.shell import Explorer

    return Explorer(model(name, camera, board), camera, board)
