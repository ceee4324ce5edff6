"""Photographs of two cameras on one rig: which belong together, and what they say of the rig."""

import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from cvnotes.base import Array, DegenerateError
from cvnotes.base.writing import printable
from cvnotes.calibration.doubts import Doubt, Place, Views
from cvnotes.calibration.reliability import misfits
from cvnotes.calibration.thresholds import FEWEST_KEPT, PART_KEPT
from cvnotes.files import Reason, Rejected
from cvnotes.photographs.choosing import Model, NoCamera
from cvnotes.photographs.detection import Detection, Photographs
from cvnotes.photographs.driver import CalibratedPhotographs, calibrate_detected
from cvnotes.photographs.reasons import FewInCommon, Misfit, NoPartner, PartnerNotUsed
from cvnotes.stereo import StereoCalibration
from cvnotes.stereo.calibration import SIDES, paired_points, together
from cvnotes.stereo.half_turn import half_turns
from cvnotes.targets import Chessboard

Pair = tuple[Detection, Detection]
_IN_COMMON = 6  # corners that both must see: a pose, and more than chance


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

    def without(self, reasons: dict[int, Reason]) -> "Pairs":
        """Return them without some: reasons by their number."""
        lost = [Rejected(printable(self.pairs[i][0].path), reason) for i, reason in reasons.items()]
        kept = [pair for i, pair in enumerate(self.pairs) if i not in reasons]
        return replace(self, pairs=kept, rejected=[*self.rejected, *lost])


@dataclass(frozen=True, eq=False)
class CalibratedPairs:
    """What pairs of photographs say about the rig that took them.

    Attributes
    ----------
    result : StereoCalibration
        The rig.
    alone : list of CalibratedPhotographs
        What the photographs of either camera say by themselves: left, right.
    found : Pairs
        The pairs, in the order of the result's, and the photographs that are in none.
    corners : list of two lists of ndarray (n_i, 2)
        Where both cameras saw the same corners: left, right.
    """

    result: StereoCalibration
    alone: list[CalibratedPhotographs]
    found: Pairs
    corners: list[list[Array]]

    @property
    def reliable(self) -> bool:
        """Whether both cameras and the rig are to be believed."""
        return self.result.reliable and all(camera.reliable for camera in self.alone)

    @property
    def doubts(self) -> list[str]:
        """What whoever uses the rig should know, in sentences that name the photographs."""
        names = [printable(left.path.name) for left, _ in self.found.pairs]

        def name(place: Place) -> str:
            return place.listed(names.__getitem__) if isinstance(place, Views) else str(place)

        of_rig = [
            doubt.naming(name) if isinstance(doubt, Doubt) else doubt
            for doubt in self.result.warnings
        ]
        left, right = (camera.doubts for camera in self.alone)
        both = [doubt for doubt in left if doubt in right]
        # (first of the camera that is not to be believed, if one is)
        order = sorted(zip(SIDES, self.alone, strict=True), key=lambda each: each[1].reliable)
        of_cameras = [
            f"{side} camera: {doubt}"
            for side, camera in order
            for doubt in camera.doubts
            if doubt not in both
        ]
        return [*of_rig, *of_cameras, *both]


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
                reason: Reason = PartnerNotUsed(printable(partner.path.name))
                alone.append(Rejected(printable(photo.path), reason))
            elif (n := int((photo.seen & partner.seen).sum())) < _IN_COMMON:
                reason = FewInCommon(printable(partner.path.name), n)
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


def calibrate_pairs(
    left: Photographs, right: Photographs, model: Model | None = None, *, keep_all: bool = False
) -> CalibratedPairs:
    """Calibrate a rig from the photographs of its two cameras, as ``cvnotes stereo`` does.

    Parameters
    ----------
    left, right : Photographs
        Of the same board, in which it was looked for.
    model : Model, optional
        Of both cameras.
    keep_all : bool
        Use photographs and pairs that do not fit the others too; they are left out otherwise.

    Raises
    ------
    NoCamera
        The photographs of one side do not determine their camera.
    DegenerateError
        Nothing pairs the photographs, or the pairs do not determine the rig.

    Notes
    -----
    1. Photographs are paired, see `paired`; 2. each camera is calibrated by itself, with all its
    photographs (`calibrate_detected`); 3. both together with their pairs; 4. pairs that do not fit
    the others are out, and 3. is repeated.
    """
    if not paired(left, right).pairs:
        raise DegenerateError(
            "a board of {}×{} inner corners was found in both pictures of none".format(
                *left.board.corners
            )
        )
    alone = []
    for side, photographs in zip(SIDES, (left, right), strict=True):
        try:
            alone.append(calibrate_detected(photographs, model, keep_all=keep_all))
        except NoCamera as error:
            raise NoCamera(f"{side} camera: {error}", error.photographs) from error
    found = paired(*(camera.photographs for camera in alone))
    result, corners = _rig(found, alone)
    bad = misfits(result.view_rms.max(axis=1)).tolist()
    fewest = max(FEWEST_KEPT, PART_KEPT * len(found.pairs))
    if bad and not keep_all and len(found.pairs) - len(bad) >= fewest:
        worst, typical = result.view_rms.max(axis=1), float(np.median(result.view_rms))
        found = found.without({i: Misfit(float(worst[i]), typical) for i in bad})
        result, corners = _rig(found, alone)
    return CalibratedPairs(result, alone, found, corners)


def _rig(
    found: Pairs, alone: list[CalibratedPhotographs]
) -> tuple[StereoCalibration, list[list[Array]]]:
    """Calibrate both cameras together, with the corners that both see in each pair."""
    if not found.pairs:
        raise DegenerateError("no pair is left of which both photographs fit the others")
    board = alone[0].photographs.board
    left, right = (np.array([pair[i].corners for pair in found.pairs]) for i in (0, 1))
    if isinstance(board, Chessboard) and board.half_turn_symmetric:
        turned = half_turns(board.points, *(_poses(found, alone, i) for i in (0, 1)))
        right = np.where(turned[:, None, None], right[:, ::-1], right)
    seen = np.isfinite(left + right).all(-1)
    W = [board.points[s] for s in seen]
    corners = [[m[s] for m, s in zip(side, seen, strict=True)] for side in (left, right)]
    pairs = paired_points(W, *corners)
    cameras = [camera.calibration for camera in alone]
    return together(pairs, cameras, judged=True), corners


def _poses(found: Pairs, alone: list[CalibratedPhotographs], i: int) -> Array:
    """Return the poses (n_pairs, 4, 4) of the board in one camera's photographs of the pairs."""
    used = [photo.path for photo in alone[i].photographs.used]
    return alone[i].calibration.poses[[used.index(pair[i].path) for pair in found.pairs]]
