"""The camera of photographs: its lens, the shape of the board, and which do not fit the others."""

import warnings
from dataclasses import dataclass

import numpy as np

from cvnotes.base import CalibrationWarning, CvnotesError, DegenerateError
from cvnotes.calibration import Calibration, calibrate
from cvnotes.calibration.reliability import misfits
from cvnotes.calibration.thresholds import FEWEST_KEPT, PART_KEPT, ROUNDS
from cvnotes.files import Reason
from cvnotes.photographs.detection import Photographs
from cvnotes.photographs.mirrored import mirrored
from cvnotes.photographs.reasons import Exchanged, Misfit


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
        They do not determine a camera.
    """
    if not photographs.used:
        raise DegenerateError(
            "a board of {}×{} inner corners was found in none (count where four squares meet, "
            "not squares)".format(*photographs.board.corners)
        )
    W, m = photographs.correspondences()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CalibrationWarning)  # the result has them
        return calibrate(
            W, m, photographs.size, lens=model.lens, board=model.board_shape, skew=model.skew
        )


def choose(
    photographs: Photographs, model: Model, *, keep_all: bool = False
) -> tuple[Calibration, Photographs]:
    """Calibrate, and again without photographs that do not fit the others.

    Only where enough of them are left: which of many are wrong, nobody can tell.

    Raises
    ------
    NoCamera
        They do not determine a camera.
    """
    try:
        result = fit(photographs, model)
    except CvnotesError as error:
        message = f"{len(photographs.used)} usable photographs; {error}"
        raise NoCamera(message, photographs) from error
    fewest = max(FEWEST_KEPT, PART_KEPT * len(photographs.used))
    for _ in range(0 if keep_all else ROUNDS):
        bad = _strangers(photographs, result)
        if not bad or len(photographs.used) - len(bad) < fewest:
            break
        kept = photographs.without(bad)
        try:
            result = fit(kept, model)
        except CvnotesError:  # these alone do not determine the camera
            break
        photographs = kept
    return result, photographs


def _strangers(photographs: Photographs, result: Calibration) -> dict[int, Reason]:
    """List the used photographs that do not fit the others, with the reasons, by their numbers."""
    typical = float(np.median(result.view_rms))
    bad: dict[int, Reason] = {
        i: Misfit(float(result.view_rms[i]), typical) for i in misfits(result.view_rms).tolist()
    }
    bad |= {i: Exchanged() for i in mirrored(photographs, result)}
    return dict(sorted(bad.items()))
