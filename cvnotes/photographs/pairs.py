"""Photographs of two cameras on one rig: which belong together, and what they say of the rig."""

import re
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CalibrationWarning, CvnotesError, DegenerateError
from cvnotes.base.writing import printable
from cvnotes.calibration import calibrate, choose_model
from cvnotes.files import Rejected
from cvnotes.photographs.detection import Detection, Photographs
from cvnotes.photographs.reasons import NoPartner, PartnerWithoutBoard
from cvnotes.stereo import StereoCalibration, calibrate_stereo
from cvnotes.stereo.half_turn import half_turns
from cvnotes.stereo.jackknife import std_of_pairs
from cvnotes.targets import Chessboard

Pair = tuple[Detection, Detection]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Pairs:
    """Photographs that belong together.

    Parameters
    ----------
    pairs : list of (Detection, Detection)
        Left and right, where both show the board.
    by_number : bool
        Whether numbers in their names paired them, not their order.
    rejected : list of Rejected
        All that are in no pair, with their reasons.
    """

    pairs: list[Pair]
    by_number: bool
    rejected: list[Rejected]


@dataclass(frozen=True, eq=False)
class CalibratedPairs:
    """What pairs of photographs say about a rig: error bars over pairs, and the corners used."""

    result: StereoCalibration
    std: dict[str, float]
    left: list[Array]
    right: list[Array]


def paired(left: Photographs, right: Photographs) -> Pairs:
    """Pair the photographs of two cameras that were taken at the same moment.

    The last number in a name tells when it was taken, unless one stands in two names of a side;
    without such numbers the order of the names does, where no file of either side is missing.

    Raises
    ------
    DegenerateError
        Nothing pairs them.
    """
    sides = left.looked_at, right.looked_at
    numbers: list[list[int | None]] = [[_number(photo.path) for photo in side] for side in sides]
    numbered = all(None not in own and len(set(own)) == len(own) for own in numbers)
    by_number = numbered and bool(set(numbers[0]) & set(numbers[1]))
    if not by_number:
        if len(sides[0]) != len(sides[1]) or _unread(left) or _unread(right):
            raise DegenerateError(
                f"{len(sides[0])} left photographs but {len(sides[1])} right ones, and no numbers "
                "in their names that would pair them: give partners the same number"
            )
        numbers = [list(range(len(side))) for side in sides]
    lefts, rights = (
        dict(zip(own, side, strict=True)) for own, side in zip(numbers, sides, strict=True)
    )
    pairs, alone = [], []
    for own, others, side in ((lefts, rights, "right"), (rights, lefts, "left")):
        for key, photo in own.items():
            if photo.corners is None:
                continue  # has its reason
            partner = others.get(key)
            if partner is None:
                alone.append(Rejected(printable(photo.path), NoPartner(side)))
            elif partner.corners is None:
                reason = PartnerWithoutBoard(printable(partner.path.name))
                alone.append(Rejected(printable(photo.path), reason))
            elif side == "right":
                pairs.append((photo, partner))
    return Pairs(pairs, by_number, [*left.rejected, *right.rejected, *alone])


def _unread(photographs: Photographs) -> int:
    """Count the files that are not even pictures of this camera."""
    without_board = sum(photo.corners is None for photo in photographs.looked_at)
    return len(photographs.rejected) - without_board


def _number(path: Path) -> int | None:
    digits = re.findall(r"[0-9]+", path.stem)
    return int(digits[-1]) if digits else None


def calibrate_pairs(pairs: Sequence[Pair], board: Chessboard, lens: str) -> CalibratedPairs:
    """Calibrate a rig from pairs of photographs that show the board.

    Parameters
    ----------
    pairs : sequence of (Detection, Detection)
        Left and right.
    board : Chessboard
        What was photographed.
    lens : str
        Of both cameras, as for `calibrate`; "auto" lets left photographs that are left out decide.

    Raises
    ------
    DegenerateError
        They do not determine the rig.
    """
    if not pairs:
        raise DegenerateError(
            "a board of {}×{} inner corners was found in both pictures of none".format(
                *board.corners
            )
        )
    sizes = {photo.size for pair in pairs for photo in pair}
    if len(sizes) > 1:
        listed = " and ".join(f"{w}×{h}" for w, h in sorted(sizes))
        raise DegenerateError(
            f"left and right pictures must have one size, got {listed} pixels: take both at the "
            "same resolution"
        )
    (size,) = sizes
    left, right = (np.array([pair[i].corners for pair in pairs]) for i in (0, 1))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CalibrationWarning)  # the result has them
        if lens == "auto":
            lens = _chosen(board, left, size)
        if board.half_turn_symmetric:
            right = _same_end(board, left, right, size, lens)
        W, (m_left, m_right) = _seen(board, left, right)
        result = calibrate_stereo(W, m_left, m_right, size, lens=lens)
        try:
            std = std_of_pairs(result, W, m_left, m_right, lens=lens)
        except CvnotesError as error:
            raise DegenerateError(
                f"without some of the pairs the rig is not determined ({error}): take more pairs, "
                "or a lens with fewer coefficients"
            ) from error
    return CalibratedPairs(result, std, m_left, m_right)


def _seen(board: Chessboard, *sides: Array) -> tuple[list[Array], list[list[Array]]]:
    """Return board points and pixels of the corners that all sides (n_views, n, 2) see."""
    seen: Mask = np.asarray(np.isfinite(sum(sides)).all(-1))
    m = [[view[s] for view, s in zip(side, seen, strict=True)] for side in sides]
    return [board.points[s] for s in seen], m


def _chosen(board: Chessboard, left: Array, size: tuple[int, int]) -> str:
    """Choose the lens of both cameras, which are nearly always alike, by the left photographs."""
    W, (m,) = _seen(board, left)
    return choose_model(W, m, size, boards=["flat"]).lens


def _same_end(
    board: Chessboard, left: Array, right: Array, size: tuple[int, int], lens: str
) -> Array:
    """Count the right corners of a symmetric board from the same end as the left ones."""
    poses = []
    for side in (left, right):
        W, (m,) = _seen(board, side)
        poses.append(calibrate(W, m, size, lens=lens).poses)
    turned = half_turns(board.points, *poses)
    return np.where(turned[:, None, None], right[:, ::-1], right)
