"""Photographs in which left and right are exchanged, beside others in which they are not."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from cvnotes.commands.examined import Examined
from cvnotes.targets import CharucoBoard, Chessboard

if TYPE_CHECKING:
    from cvnotes.calibration import Calibration

EXCHANGED = "left and right seem exchanged"
_BETTER = 0.7  # RMS of a mirrored photograph over that of the photograph as it is
_MOST = 200  # photographs that are looked at


def mirrored(
    used: Sequence[Examined], result: "Calibration", board: Chessboard | CharucoBoard
) -> list[int]:
    """List the photographs that the camera explains better when left and right are exchanged.

    Where nothing is doubtful there are none, and of a ChArUco board the markers would not be read.
    """
    from cvnotes.calibration.pose import rms_of_views

    if isinstance(board, CharucoBoard) or not result.warnings:
        return []
    # (the flat board in both, so that only the exchange makes a difference)
    used, poses = used[:_MOST], result.poses[:_MOST]
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
    return np.flatnonzero(turned < _BETTER * as_is).tolist()


def doubted(result: "Calibration", exchanged: Sequence[int]) -> "Calibration":
    """Give a result that rests on mirrored photographs too: no camera shows both kinds."""
    if not exchanged:
        return result
    views = f"view{'s' * (len(exchanged) > 1)} {', '.join(map(str, exchanged))}"
    sentence = (
        f"{views}: {EXCHANGED}, for the camera fits {'them' if len(exchanged) > 1 else 'it'} "
        "better so; was it a front camera, or an editing program? Leave out what is mirrored, or "
        "turn it back"
    )
    return replace(result, warnings=(sentence, *result.warnings), reliable=False)
