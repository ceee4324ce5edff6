"""Photographs in which left and right are exchanged, beside others in which they are not."""

from dataclasses import replace

import numpy as np

from cvnotes.base import Array
from cvnotes.calibration import Calibration
from cvnotes.calibration.doubts import Doubt, View, Views
from cvnotes.calibration.pose import rms_of_views
from cvnotes.calibration.thresholds import ALIKE, EXCHANGED, MANY_VIEWS, MISSES_MORE
from cvnotes.calibration.two_cameras import TwoCameras
from cvnotes.camera import Camera
from cvnotes.photographs.detection import Photographs
from cvnotes.photographs.reasons import Exchanged
from cvnotes.targets import CharucoBoard, Chessboard


def mirrored(photographs: Photographs, result: Calibration, two: TwoCameras | None) -> list[int]:
    """List the photographs that miss more than others, and that a mirror explains.

    `two` are the cameras that explain the photographs better than one, if there are such.

    An honest view of a steep board may fit better in a mirror, too, where the lens is not quite
    that of the camera; but it does not miss more than others as it is. Of a ChArUco board the
    markers would not be read.
    """
    board = photographs.board
    if isinstance(board, CharucoBoard):
        return []
    m, as_is = np.array([photo.corners for photo in photographs.used]), result.view_rms
    if two:
        # as many as those that are not mirrored, or nearly: none of them misses more
        strange, seen_by = np.flatnonzero(two.second), two.cameras[0]
        limit = np.full(len(m), ALIKE * np.median(two.view_rms[strange]))
    else:
        strange, seen_by = np.flatnonzero(as_is > MISSES_MORE * np.median(as_is)), result.camera
        limit = EXCHANGED * as_is
    strange = strange[:MANY_VIEWS]
    if not len(strange):
        return []
    turned = _in_a_mirror(m[strange], board, result, seen_by, result.poses[strange])
    return [int(i) for i in strange[turned < limit[strange]]]


def _in_a_mirror(
    m: Array, board: Chessboard, result: Calibration, camera: Camera, poses: Array
) -> Array:
    """Return the RMS (n_views,) of corners (n_views, n, 2), left and right being exchanged."""
    (columns, rows), width = board.corners, result.size[0]
    W = board.points if result.shape is None else result.shape.points
    # Exchanged are left and right of the camera, and of the board around its middle. The corners
    # are numbered from another end, so that they stay right-handed: as its colours want it, the
    # rows are exchanged or the columns, which a board that is not flat tells apart.
    flip = np.diag([-1.0, 1, 1, 1])
    other = m.reshape(len(m), rows, columns, 2) * [-1, 1] + [width - 1, 0]
    found = []
    for axis, (way, n) in enumerate([(other[:, :, ::-1], columns), (other[:, ::-1], rows)]):
        back = np.eye(4)
        back[axis, axis], back[axis, 3] = -1, (n - 1) * board.square
        there = flip @ poses @ back
        found.append(rms_of_views(camera, result.names, W, way.reshape(m.shape), there))
    return np.asarray(np.min(found, axis=0))


def with_doubt_of_mirrored(result: Calibration, exchanged: list[int]) -> Calibration:
    """Return a result that rests on mirrored photographs too: no camera shows both kinds."""
    if not exchanged:
        return result
    several = len(exchanged) > 1
    doubt = Doubt(
        f"{{}}: {Exchanged.words}, for the camera fits {'them' if several else 'it'} better so; "
        "was it a front camera, or an editing program? Leave out what is mirrored, or turn it back",
        Views(tuple(exchanged)) if several else View(exchanged[0]),
    )
    return with_doubt(result, doubt)


def with_doubt(result: Calibration, doubt: Doubt) -> Calibration:
    """Return a result that is not to be believed, and why before all else."""
    return replace(result, warnings=(doubt, *result.warnings), reliable=False)
