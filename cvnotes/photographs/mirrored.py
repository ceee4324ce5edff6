"""Photographs in which left and right are exchanged, beside others in which they are not."""

from contextlib import suppress
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError
from cvnotes.calibration import Calibration
from cvnotes.calibration.board_shape import deformations
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.doubts import View, Views
from cvnotes.calibration.jackknife import Influence
from cvnotes.calibration.refinement import Problem, State, minimise, refit_poses
from cvnotes.calibration.thresholds import (
    AS_WELL,
    CORNERS_THAT_TELL,
    EXCHANGED,
    MIRRORED,
    MISSES_MORE,
    PART_KEPT,
    TELLS_ITS_MIRROR,
)
from cvnotes.calibration.two_cameras import DIRECTIONS, TwoCameras
from cvnotes.photographs.detection import Photographs
from cvnotes.photographs.reasons import Exchanged, Mixed
from cvnotes.targets import CharucoBoard, Chessboard

_CLOSE, _ROUNDS = 1e-6, 6  # tolerance while views are sorted, and how often


def mirrored(photographs: Photographs, result: Calibration, two: TwoCameras | None) -> list[int]:
    """List the photographs that a mirror explains: the smaller part, where there are many.

    `two` are the cameras that explain the photographs better than one, if there are such.

    Notes
    -----
    Each photograph is read as it is, and with left and right exchanged. The camera is refined with
    those exchanged that a mirror explains better, or that pull it to one side; then each is read
    as it fits better, until all stay; the board is refined, too. That takes no parameter more:
    whatever is gained is evidence. Half of the views must lose or gain far more than by chance,
    which tells the camera from its mirror, and each that is named its part.

    Where they do not, one may still be strange that misses more than others as it is, and far less
    in the mirror. (An honest view of a steep board may fit better in a mirror, too, where the lens
    is not quite that of the camera; but it does not miss more than others.)

    Of a ChArUco board the markers would not be read.
    """
    board, n = photographs.board, len(photographs.used)
    if isinstance(board, CharucoBoard):
        return []
    problem, x = _read_in_all_ways(photographs, board, result)
    costs = refit_poses(problem, x)[1].reshape(-1, n)
    turned = costs[1:].min(0)
    best = _best_of(problem, x, costs)
    # (two cameras are no camera and its mirror if they explain more)
    most = (AS_WELL * two.rms) ** 2 * problem.n_seen_by_view[:n].sum() if two else np.inf
    if best is not None and best.min(0).sum() < most:
        told = np.minimum(problem.n_seen_by_view[:n], CORNERS_THAT_TELL)
        left = best.min(0).sum()
        gain = (best[0] - best[1:].min(0)) * 2 * told.sum() / left
        # All read the other way is the same: the fewer count; of halves, that without the first.
        if 2 * np.count_nonzero(gain > 0) + (gain[0] > 0) > n:
            gain = -gain
        found = np.flatnonzero(gain > MIRRORED)
        if found.size and np.median(np.abs(gain)) > TELLS_ITS_MIRROR:
            return [int(i) for i in found]
    if two:
        return []
    rms = result.view_rms
    turned = np.sqrt(turned / problem.n_seen_by_view[:n])
    strange = (rms > MISSES_MORE * np.median(rms)) & (turned < EXCHANGED * rms)
    return [int(i) for i in np.flatnonzero(strange)]


def _read_in_all_ways(
    photographs: Photographs, board: Chessboard, result: Calibration
) -> tuple[Problem, State]:
    """Return the problem of all views as they are, then in a mirror, twice, and where it stands.

    Exchanged are left and right of the camera, and of the board around its middle. The corners
    are numbered from another end, so that they stay right-handed: as its colours want it, the
    rows are exchanged or the columns, which a board that is not flat tells apart.
    """
    m = np.array([photo.corners for photo in photographs.used])
    columns, rows = board.corners
    other = m.reshape(len(m), rows, columns, 2) * [-1, 1] + [result.size[0] - 1, 0]
    ways = [m, other[:, :, ::-1].reshape(m.shape), other[:, ::-1].reshape(m.shape)]
    poses = [result.poses]
    for axis, count in enumerate(board.corners):
        back = np.eye(4)
        back[axis, axis], back[axis, 3] = -1, (count - 1) * board.square
        poses.append(np.diag([-1.0, 1, 1, 1]) @ result.poses @ back)
    m = np.concatenate(ways)
    seen = np.asarray(np.isfinite(m).all(-1))
    m = np.where(seen[..., None], m, 0.0)
    data = Correspondences.in_unit_frame(board.points, m, None if seen.all() else seen)
    problem, W, shape = Problem.at(result.camera, result.names, data), None, result.shape
    if shape is not None and len(shape.points) == len(board.points):  # each was seen somewhere
        ways_to_bend = deformations(shape.kind, data.W)
        problem = replace(problem, shape=ways_to_bend, hold=shape.hold)
        W = (shape.points - data.centre) / data.scale
    poses_of_unit = data.pose_in_scaled_units(np.concatenate(poses))
    return problem, problem.state(result.camera, poses_of_unit, W)


def _best_of(problem: Problem, x: State, costs: Array) -> Array | None:
    """Return what each view costs (ways, n) where all are read as they fit best together.

    `costs` are those with the camera of all as they are. None if nothing is better in a mirror; a
    board that is held, which is quick, says so of nearly all sets.
    """
    views = np.arange(costs.shape[1])
    held = replace(problem, W=problem.board(x.shared), shape=None, hold=None)
    at = State(x.shared[: len(problem.names)], x.R, x.T)
    try:
        sides = Influence.of(held.some(views), at.some(views)).sides[:DIRECTIONS]
    except (CvnotesError, np.linalg.LinAlgError):  # the views hardly determine one camera
        return None
    guesses = [costs[1:].min(0) < costs[0], *sides]
    best = None
    for stage, start in ((held, at), (problem, x)):
        found = []
        for guess in guesses:
            with suppress(CvnotesError):  # read like this, they may have no camera
                way = np.where(guess, 1 + costs[1:].argmin(0), 0)
                found.append(_sorted(stage, start, way))
        best = min(found, key=lambda each: float(each.min(0).sum()), default=None)
        if best is None or len(set(best.argmin(0) > 0)) == 1:
            return None
    return best


def _sorted(problem: Problem, x: State, way: npt.NDArray[np.intp]) -> Array:
    """Refine the camera, and the board, with views that are read in such ways (n,), until all stay.

    Gives what each view then costs in each way, (ways, n).
    """
    n = len(way)
    costs = np.zeros((3, n))
    for _ in range(_ROUNDS):
        now = way * n + np.arange(n)
        shared = minimise(problem.some(now), x.some(now), tolerance=_CLOSE).x.shared
        costs = refit_poses(problem, State(shared, x.R, x.T))[1].reshape(-1, n)
        before, way = way, costs.argmin(0)
        if (way == before).all():
            break
    return costs


def with_doubt_of_mirrored(result: Calibration, exchanged: list[int]) -> Calibration:
    """Return a result that rests on mirrored photographs too: no camera shows both kinds.

    Of so many nobody can tell whether they are mirrored or the others.
    """
    if not exchanged:
        return result
    several = len(exchanged) > 1
    why = f", for the camera fits {'them' if several else 'it'} better so"
    if len(exchanged) > (1 - PART_KEPT) * len(result.poses):
        why = " there, or in all the others"
    doubt = Mixed(
        f"{{}}: {Exchanged.words}{why}; "
        "was it a front camera, or an editing program? Leave out what is mirrored, or turn it back",
        Views(tuple(exchanged)) if several else View(exchanged[0]),
    )
    return with_doubt(result, doubt)


def with_doubt(result: Calibration, doubt: Mixed) -> Calibration:
    """Return a result that is not to be believed, and why before all else."""
    return replace(result, warnings=(doubt, *result.warnings), reliable=False)
