"""The camera of photographs: its lens, the shape of the board, and which do not fit the others."""

import warnings
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from cvnotes.base import CalibrationWarning, CvnotesError, DegenerateError
from cvnotes.calibration import Calibration, calibrate
from cvnotes.calibration.doubts import Views
from cvnotes.calibration.reliability import astray, misfits
from cvnotes.calibration.thresholds import FEWEST_KEPT, PART_KEPT, ROUNDS
from cvnotes.calibration.two_cameras import TwoCameras, two_cameras
from cvnotes.camera import Lens
from cvnotes.files import Reason
from cvnotes.photographs.detection import Photographs
from cvnotes.photographs.mirrored import Mirrored, mirrored, with_doubt, with_doubt_of_mirrored
from cvnotes.photographs.reasons import Exchanged, Misfit, Mixed

_TELLS_APART = "k1 k2 p1 p2"


@dataclass(frozen=True)
class Model:
    """What is estimated.

    Parameters
    ----------
    lens : str
        As for `calibrate`; "auto" lets cross-validation decide.
    board_shape : {"flat", "bent", "free", "auto"}
        The same for the board.
    skew : bool
        Whether the pixels' axes may be skew.
    """

    lens: str = "auto"
    board_shape: str = "auto"
    skew: bool = False


class NoCamera(CvnotesError):
    """The photographs do not determine a camera; `photographs` knows what was seen in each."""

    def __init__(self, message: str, photographs: Photographs) -> None:
        super().__init__(message)
        self.photographs = photographs


def fit(photographs: Photographs, model: Model) -> Calibration:
    """Calibrate with the photographs that show the board.

    Raises
    ------
    DegenerateError
        They do not determine a camera, or more of them show another board.
    """
    asked = "a board of {}×{} inner corners".format(*photographs.board.corners)
    if other := photographs.instead:  # of which a part was found here and there, if anything
        n, there = photographs.counts[other], "{}×{}".format(*other)
        show = "photograph shows" if n == 1 else "photographs show"
        raise DegenerateError(f"{asked} was asked for, but {n} {show} one of {there}")
    if photographs.rejected and not photographs.looked_at:
        raise DegenerateError("none of them could be read")
    if not photographs.used:
        hint = (
            f": there are markers of {there}"
            if (there := photographs.markers)
            else (" (count where four squares meet, not squares)")
        )
        raise DegenerateError(f"{asked} was found in none{hint}")
    W, m = photographs.correspondences()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CalibrationWarning)  # the result has them
        return calibrate(
            W, m, photographs.size, lens=model.lens, board=model.board_shape, skew=model.skew
        )


def choose(
    photographs: Photographs, model: Model, *, keep_all: bool = False
) -> tuple[Calibration, Photographs]:
    """Calibrate, and again without single corners, and photographs, that do not fit the others.

    Only where enough photographs are left: which of many are wrong, nobody can tell. Photographs
    of two cameras are all kept, and named.

    Raises
    ------
    NoCamera
        They do not determine a camera, or more of them show another board.
    """
    try:
        result = fit(photographs, model)
    except CvnotesError as error:
        n = len(photographs.used)
        message = f"{n} usable photograph{'s' * (n != 1)}; {error}"
        raise NoCamera(message, photographs) from error
    exchanged, two = _accused(photographs, result, model)
    fewest = max(FEWEST_KEPT, PART_KEPT * len(photographs.used))
    for _ in range(0 if keep_all else ROUNDS):
        if two and not exchanged.views:
            break
        kept = _without_corners_astray(photographs, result)
        if kept is photographs:
            kept = photographs.without(_strangers(result, exchanged.views))
        if kept is photographs or len(kept.used) < fewest:
            break
        try:
            result = fit(kept, model)
        except CvnotesError:  # these alone do not determine the camera
            break
        photographs = kept
        exchanged, two = _accused(photographs, result, model)
    if two and not exchanged.views:
        return with_doubt(result, _of_two_cameras(two)), photographs
    return with_doubt_of_mirrored(result, exchanged), photographs


def _accused(
    photographs: Photographs, result: Calibration, model: Model
) -> tuple[Mirrored, TwoCameras | None]:
    """List the photographs that are mirrored, and tell those of two cameras, whatever the model.

    What a lens misses that is too simple, or a flat board, a mirror or a second camera may explain,
    too: nothing is said before each photograph was heard with the best lens and a board that may
    bend. (Corners that are free would explain the mirror.)
    """
    two = two_cameras(result)
    exchanged = mirrored(photographs, result, two)  # both with one lens, so that they compare
    if two and not exchanged.views:
        two = _told_apart(photographs, result, model, two)
        if two and not two.told:  # what changes may look like its mirror, too
            return Mirrored(), two
    if (two or exchanged != Mirrored()) and (model.lens != "auto" or result.shape is None):
        with suppress(CvnotesError):  # few views do not determine so much
            bent = fit(photographs, replace(model, lens="auto", board_shape="bent"))
            two = two and two_cameras(bent)
            again = mirrored(photographs, bent, two)
            named = [i for i in exchanged.views if i in again.views]
            exchanged = Mirrored(named, exchanged.some and again.some)
    return exchanged, two


def _told_apart(
    photographs: Photographs, result: Calibration, model: Model, two: TwoCameras
) -> TwoCameras | None:
    """Part two cameras with a lens that can tell: one for both is chosen too simple for that.

    What such a lens does not confirm is no second camera if a simpler one was prescribed, and else
    one of which it is not told which photographs are its own.
    """
    if type(result.camera.lens) is not Lens or {*result.names} & {"p1", "k3"}:
        return two
    with suppress(CvnotesError):
        if parted := two_cameras(fit(photographs, replace(model, lens=_TELLS_APART))):
            return parted
    return replace(two, told=False) if model.lens == "auto" else None


def _of_two_cameras(two: TwoCameras) -> Mixed:
    """Return what is to be said of photographs that no single camera took."""
    off = f"({two.rms:.2f} px off with two cameras, {two.of_one:.2f} px with one)"
    if not two.told:
        return Mixed(
            f"the camera was not the same in all photographs {off}, and they do not tell which "
            "belong together: do they come from several cameras, did zoom, focus or an image "
            "stabiliser change in between, or was it moved while it took them?"
        )
    return Mixed(
        f"{{}} fit one camera, and {{}} another {off}: do they come from two cameras, was the zoom "
        "or focus changed, has an image stabiliser moved, or are some mirrored? Calibrate each "
        "part by itself",
        *(Views(tuple(np.flatnonzero(own).tolist())) for own in (~two.second, two.second)),
    )


def _without_corners_astray(photographs: Photographs, result: Calibration) -> Photographs:
    """Leave out the single corners that miss their places by far more than others."""
    used = photographs.used
    distances = np.zeros((len(used), len(used[0].seen)))
    for d, photo, r in zip(distances, used, result.residuals, strict=True):
        d[photo.seen] = np.linalg.norm(r, axis=-1)
    return photographs.without_corners(astray(distances), distances)


def _strangers(result: Calibration, exchanged: list[int]) -> dict[int, Reason]:
    """List the used photographs that do not fit the others, with the reasons, by their numbers."""
    typical = float(np.median(result.view_rms))
    bad: dict[int, Reason] = {
        i: Misfit(float(result.view_rms[i]), typical) for i in misfits(result.view_rms).tolist()
    }
    bad |= {i: Exchanged() for i in exchanged}
    return dict(sorted(bad.items()))
