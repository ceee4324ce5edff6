"""Photographs in which left and right are exchanged, beside others in which they are not."""

from contextlib import suppress
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, DegenerateError
from cvnotes.calibration import Calibration, thresholds
from cvnotes.calibration.board_shape import deformations
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.doubts import View, Views
from cvnotes.calibration.parting import NearBy, freedom, guesses, settled
from cvnotes.calibration.refinement import Problem, State, minimise, refit_poses
from cvnotes.calibration.two_cameras import TwoCameras
from cvnotes.photographs.detection import Photographs
from cvnotes.photographs.reasons import Exchanged, Mixed
from cvnotes.targets import CharucoBoard, Chessboard

_CLOSE, _ROUNDS = 1e-6, 6  # tolerance while views are sorted, and how often


@dataclass(frozen=True)
class Mirrored:
    """What a mirror explains.

    Attributes
    ----------
    views : list of int
        The photographs that are mirrored: the fewer, where there are many.
    some : bool
        Whether some are of which it cannot be told which.
    """

    views: list[int] = field(default_factory=list)
    some: bool = False


def mirrored(photographs: Photographs, result: Calibration, two: TwoCameras | None) -> Mirrored:
    """Tell which photographs a mirror explains.

    `two` are the cameras that explain the photographs better than one, if there are such.

    Notes
    -----
    Each photograph is read as it is, and with left and right exchanged. Of many guesses which are
    mirrored, each is mended until all photographs are read as they fit best with the others
    (`NearBy`). That takes no parameter more: whatever is gained is evidence. If it is more than
    chance, the camera and the board are refined with the best, and a photograph is named that loses
    or gains far more than by chance; half of them must, which tells the camera from its mirror.

    Where they do not, one may still be strange that misses more than others as it is, and far less
    in the mirror. (An honest view of a steep board may fit better in a mirror, too, where the lens
    is not quite that of the camera; but it does not miss more than others.)

    Of a ChArUco board the markers would not be read.
    """
    board, n = photographs.board, len(photographs.used)
    if isinstance(board, CharucoBoard):
        return Mirrored()
    problem, x = _read_in_all_ways(photographs, board, result)
    # A board that is held, which is quick, tells nearly always; one that is free explains a mirror.
    held = replace(problem, W=problem.board(x.shared), shape=None, hold=None)
    at, costs = refit_poses(held, State(x.shared[: len(problem.names)], x.R, x.T))
    costs = costs.reshape(-1, n)
    way, left = _read_best(held, at, costs)
    some = bool((costs[0].sum() - left) * freedom(problem.some(slice(n))) > thresholds.MIXED * left)
    best = None
    if some:
        with suppress(CvnotesError):  # read like this, they may have no camera
            best = _refined(problem, State(x.shared, at.R, at.T), way)
    if best is not None:
        if two:  # they are no camera and its mirror if they explain more
            times = np.sqrt(best.min(0).sum() / problem.n_seen_by_view[:n].sum()) / two.rms
            if times > thresholds.AS_WELL:
                return Mirrored()
        told = np.minimum(problem.n_seen_by_view[:n], thresholds.CORNERS_THAT_TELL)
        gain = (best[0] - best[1:].min(0)) * 2 * told.sum() / best.min(0).sum()
        # All read the other way is the same: the fewer count; of halves, that without the first.
        if 2 * np.count_nonzero(gain > 0) + (gain[0] > 0) > n:
            gain = -gain
        found = np.flatnonzero(gain > thresholds.MIRRORED)
        if found.size and np.median(np.abs(gain)) > thresholds.TELLS_ITS_MIRROR:
            return Mirrored(found.tolist())
    elif two:
        return Mirrored()
    rms = result.view_rms
    turned = np.sqrt(costs[1:].min(0) / problem.n_seen_by_view[:n])
    strange = rms > thresholds.MISSES_MORE * np.median(rms)
    strange &= turned < thresholds.EXCHANGED * rms
    if some and (strange != (way > 0)).any() and (strange != (way == 0)).any():
        return Mirrored(some=True)  # the camera of all, of both kinds, judges none of them
    return Mirrored(np.flatnonzero(strange).tolist())


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


def _read_best(held: Problem, at: State, costs: Array) -> tuple[npt.NDArray[np.intp], float]:
    """Return in which ways (n,) views fit best together, and what they cost then.

    `costs` (ways, n) are those with the camera of all as they are.
    """
    ways, n = costs.shape

    def costs_of(way: npt.NDArray[np.intp]) -> Array:
        read = (way[:, None] == np.arange(ways)[:, None]).astype(float)  # (k, ways, n)
        d = near.camera_of(read.reshape(len(way), -1))
        return near.at(d).reshape(read.shape)

    try:
        near = NearBy.of(held, at, slice(n))
        exchanged = np.concatenate([[costs.argmin(0) > 0], guesses(n, 1)])
        way, left = settled(np.where(exchanged, 1 + costs[1:].argmin(0), 0), costs_of)
    except (DegenerateError, np.linalg.LinAlgError):  # the views hardly determine one camera
        return np.zeros(n, dtype=np.intp), float(costs[0].sum())
    return way[left.argmin()], float(left.min())


def _refined(problem: Problem, x: State, way: npt.NDArray[np.intp]) -> Array:
    """Refine the camera, and the board, with views that are read in such ways (n,), until all stay.

    Gives what each view then costs in each way, (ways, n).
    """
    n = len(way)
    for _ in range(_ROUNDS):
        now = way * n + np.arange(n)
        shared = minimise(problem.some(now), x.some(now), tolerance=_CLOSE).x.shared
        costs = refit_poses(problem, State(shared, x.R, x.T))[1].reshape(-1, n)
        before, way = way, costs.argmin(0)
        if (way == before).all():
            break
    return costs


def with_doubt_of_mirrored(result: Calibration, found: Mirrored) -> Calibration:
    """Return a result that rests on mirrored photographs too: no camera shows both kinds.

    Of so many nobody can tell whether they are mirrored or the others.
    """
    exchanged, asked = found.views, "was it a front camera, or an editing program?"
    if not exchanged and not found.some:
        return result
    if not exchanged:
        return with_doubt(
            result,
            Mixed(
                f"in some photographs {Exchanged.words}, but they do not tell in which: {asked} Or "
                "has an image stabiliser moved?"
            ),
        )
    several = len(exchanged) > 1
    why = f", for the camera fits {'them' if several else 'it'} better so"
    if len(exchanged) > (1 - thresholds.PART_KEPT) * len(result.poses):
        why = " there, or in all the others"
    doubt = Mixed(
        f"{{}}: {Exchanged.words}{why}; {asked} Leave out what is mirrored, or turn it back",
        Views(tuple(exchanged)) if several else View(exchanged[0]),
    )
    return with_doubt(result, doubt)


def with_doubt(result: Calibration, doubt: Mixed) -> Calibration:
    """Return a result that is not to be believed, and why before all else."""
    return replace(result, warnings=(doubt, *result.warnings), reliable=False)
