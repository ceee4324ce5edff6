"""Photographs in which left and right are exchanged, beside others in which they are not."""

from dataclasses import replace

import numpy as np

from cvnotes.calibration import Calibration
from cvnotes.calibration.doubts import Doubt, View, Views
from cvnotes.calibration.pose import rms_of_views
from cvnotes.calibration.thresholds import EXCHANGED, MANY_VIEWS
from cvnotes.photographs.detection import Photographs
from cvnotes.photographs.reasons import Exchanged
from cvnotes.targets import CharucoBoard


def mirrored(photographs: Photographs, result: Calibration) -> list[int]:
    """List the photographs that the camera explains better when left and right are exchanged.

    Where nothing is doubtful there are none, and of a ChArUco board the markers would not be read.
    """
    board = photographs.board
    if isinstance(board, CharucoBoard) or not result.warnings:
        return []
    # (the flat board in both, so that only the exchange makes a difference)
    used, poses = photographs.used[:MANY_VIEWS], result.poses[:MANY_VIEWS]
    m = np.array([photo.corners for photo in used])
    columns, rows = board.corners
    # The corners are numbered from the other side, too, so that they stay right-handed.
    other = m.reshape(len(m), rows, columns, 2)[:, :, ::-1].reshape(m.shape)
    other[..., 0] = result.size[0] - 1 - other[..., 0]
    # Exchanged are left and right of the camera, and of the board around its middle.
    flip, back = np.diag([-1.0, 1, 1, 1]), np.diag([-1.0, 1, 1, 1])
    back[0, 3] = (columns - 1) * board.square
    held = result.camera, result.names, board.points
    as_is = rms_of_views(*held, m, poses)
    turned = rms_of_views(*held, other, flip @ poses @ back)
    return np.flatnonzero(turned < EXCHANGED * as_is).tolist()


def doubted(result: Calibration, exchanged: list[int]) -> Calibration:
    """Return a result that rests on mirrored photographs too: no camera shows both kinds."""
    if not exchanged:
        return result
    several = len(exchanged) > 1
    doubt = Doubt(
        f"{{}}: {Exchanged().brief}, for the camera fits {'them' if several else 'it'} better so; "
        "was it a front camera, or an editing program? Leave out what is mirrored, or turn it back",
        Views(tuple(exchanged)) if several else View(exchanged[0]),
    )
    return replace(result, warnings=(doubt, *result.warnings), reliable=False)
