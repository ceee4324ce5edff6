"""Stereo calibration: two cameras and how they stand to each other, from pairs of pictures."""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from functools import cache
from warnings import catch_warnings, simplefilter, warn

import numpy as np

from cvnotes.base import Array, CalibrationWarning, DegenerateError, ShapeError, image_size
from cvnotes.calibration import Calibration, calibrate, extrinsics
from cvnotes.calibration.board_shape import BOARDS, BoardShape, deformations, with_shape
from cvnotes.calibration.correspondences import Correspondences, PointSets
from cvnotes.calibration.doubts import Doubt, Views
from cvnotes.calibration.refinement import Problem, covariance, refuse_too_few
from cvnotes.calibration.reliability import Diagnostics, judge
from cvnotes.calibration.thresholds import MOVED, OF_PICTURE
from cvnotes.camera import Camera, chain, inverse, nearest_rotation, pose, vector_from_rotation
from cvnotes.homography import dlt
from cvnotes.stereo.jackknife import covariance_over_pairs
from cvnotes.stereo.refinement import StereoProblem, StereoState
from cvnotes.stereo.result import StereoCalibration


def calibrate_stereo(
    board_points: PointSets,
    left_points: PointSets,
    right_points: PointSets,
    size: tuple[int, int],
    *,
    lens: str = "k1 k2",
    board: str = "flat",
    skew: bool = False,
) -> StereoCalibration:
    """Calibrate two cameras and their relative pose from pairs of pictures of a planar board.

    Parameters
    ----------
    board_points : array_like, shape (n, 2) or (n, 3), or a list of such
        The corners on the board, Z = 0; one set for all pairs, or one for each.
    left_points, right_points : array_like, shape (n_views, n, 2), or lists of (n_i, 2)
        The same corners in the left and right pictures, in pixels; pair i was taken at once.
    size : (width, height)
        Size of the pictures.
    lens, board, skew
        As for `calibrate`, of either camera; with "auto" each of them has the lens that its own
        pictures speak for. The board is one: its shape is estimated if either asks for one.

    Returns
    -------
    StereoCalibration
        With error bars, and with sentences about what is doubtful.

    Raises
    ------
    DegenerateError
        Too few views or points, or pairs that do not fit two cameras on one rig.

    Warns
    -----
    CalibrationWarning
        The answer is doubtful; the sentences are also in ``warnings`` of the result.

    Notes
    -----
    1. Each camera is calibrated by itself; 2. every pair then gives a relative pose, of which the
    median is taken; 3. both cameras, the relative pose, the board and one board pose for each pair
    are refined together (see `cvnotes.stereo.refinement`). One board pose for two pictures is what
    sharpens both cameras.

    References
    ----------
    .. [1] Notes 2b.4 for one camera; stereo is named in 2b.5.

    Examples
    --------
    >>> import numpy as np
    >>> from cvnotes.camera import chain, intrinsics, pose, rotation_from_vector
    >>> from cvnotes.targets import Chessboard
    >>> board = Chessboard((9, 6), 25.0)
    >>> left = Camera(intrinsics(800, 804, 325, 238))
    >>> right = Camera(intrinsics(790, 794, 315, 243), pose(np.eye(3), [-100, 0, 0]))
    >>> tilts = [(0.5, 0, 0), (0, 0.5, 0), (-0.4, 0.3, 0.1)]
    >>> boards = [pose(rotation_from_vector(w), [-40, -60, 600]) for w in tilts]
    >>> seen = [[c.moved(chain(c.G, G)).project(board.points) for G in boards]
    ...         for c in (left, right)]
    >>> rig = calibrate_stereo(board.points, *seen, left.size, lens="none")
    >>> rig.T.round(6) + 0.0
    array([-100.,    0.,    0.])
    """
    size = image_size(size)
    pairs = paired_points(board_points, left_points, right_points)
    alone = []
    for side, points in zip(SIDES, (left_points, right_points), strict=True):
        with catch_warnings():  # said below, with the side
            simplefilter("ignore", CalibrationWarning)
            try:
                found = calibrate(board_points, points, size, lens=lens, board=board, skew=skew)
            except DegenerateError as error:
                raise DegenerateError(f"{side} camera: {error}") from error
        alone.append(found)
    rig = together(pairs, alone)
    for sentence in rig.warnings:
        warn(sentence, CalibrationWarning, stacklevel=2)
    return rig


def paired_points(
    board_points: PointSets, left_points: PointSets, right_points: PointSets
) -> tuple[Correspondences, Correspondences]:
    """Pair corners with the board in both pictures, or say what does not fit together."""
    left = Correspondences.of(board_points, left_points, name="left_points")
    right = Correspondences.of(board_points, right_points, name="right_points")
    if len(left) != len(right):
        raise ShapeError(
            f"left_points has {len(left)} views but right_points has {len(right)}; each left "
            "picture needs its partner, taken at the same moment"
        )
    return left, right


def together(
    pairs: tuple[Correspondences, Correspondences],
    alone: list[Calibration],
    *,
    judged: bool = False,
) -> StereoCalibration:
    """Refine two cameras that were calibrated by themselves together, from pairs of pictures.

    If both have been judged already, it is only said what is doubtful about the rig.
    """
    problems = [Problem.at(c.camera, c.names, data) for c, data in zip(alone, pairs, strict=True)]
    shapes = [c.shape for c in alone if c.shape is not None]
    if shapes:
        shape = max(shapes, key=lambda shape: BOARDS.index(shape.kind))
        with suppress(DegenerateError):  # there are too few pairs for it
            problems = _with_shape(problems, pairs, shape)
    problem = StereoProblem(problems[0], problems[1])
    rig = refined(problem, pairs, [c.camera for c in alone], judged=judged)
    apart = float(np.sqrt(np.mean([c.rms**2 for c in alone])))
    if rig.rms <= max(_TOGETHER * apart, MOVED * max(rig.left.size)):
        return rig
    doubt = Doubt(
        f"two cameras on one rig miss the corners by {rig.rms:.2f} px, each by itself by "
        f"{apart:.2f}: were partners taken at the same moment, and did the rig stay rigid?"
    )
    return replace(rig, warnings=(*rig.warnings, doubt))


def _with_shape(
    problems: list[Problem], pairs: tuple[Correspondences, Correspondences], shape: BoardShape
) -> list[Problem]:
    """Return the problems with one shape of the board, held as it was for a camera by itself."""
    kind = shape.kind
    left, right = (with_shape(p, data, kind) for p, data in zip(problems, pairs, strict=True))
    if shape.hold is None:
        return [left, right]
    # (bends come first; of the corners, the pairs may show fewer than all photographs do)
    bends = len(deformations("bent", left.W))
    hold = np.where(np.arange(left.n_shape) < bends, shape.hold[0], shape.hold[-1])
    return [replace(left, hold=hold), right]


# A pair whose relative pose is this far from the others' (radians) does not belong to the rig.
_APART = np.deg2rad(10)
_TOGETHER = 2.0  # times the RMS of either camera by itself, from which they are no rig


def refined(
    problem: StereoProblem,
    pairs: tuple[Correspondences, Correspondences],
    cameras: list[Camera],
    *,
    judged: bool = False,
) -> StereoCalibration:
    """Refine from a closed-form start, undo the scaling, add error bars, and judge."""
    q = len(problem.names)
    unknowns = q + 6 * len(pairs[0])
    measured = 2 * (problem.left.n_seen + problem.right.n_seen)
    refuse_too_few(measured, unknowns, "add pairs")
    start, strangers = _start(problem, pairs, cameras)
    best = problem.minimise(start)
    unit = covariance(best.system)
    # The shape of the board is held: neither belongs what that costs to a picture, nor is it free.
    held = problem.left.held[len(problem.left.names) :]
    s = best.x.left.shared[len(problem.left.names) :]
    cost = best.cost - float(held @ s**2)
    determined = len(s) - float(held @ np.diag(unit)[q:])
    variance = cost / (measured - unknowns - determined)
    scale = np.ones(q)
    scale[-3:] = pairs[0].scale  # T, back in the unit of the board
    scale = np.outer(scale, scale)
    left, right = _cameras(problem, best.x, pairs[0].scale)
    residuals = (
        problem.left.residuals(left.moved(np.eye(4)), best.x.left),
        problem.right.residuals(right.moved(np.eye(4)), best.x.of_right()),
    )
    view_rms = [
        np.sqrt(np.nansum(r**2, axis=(1, 2)) / p.n_seen_by_view)
        for r, p in zip(residuals, (problem.left, problem.right), strict=True)
    ]
    result = StereoCalibration(
        left=left,
        right=right,
        poses=pairs[0].pose_in_given_units(best.x.left.R, best.x.left.T),
        rms=float(np.sqrt(2 * cost / measured)),
        view_rms=np.stack(view_rms, axis=-1),
        names=problem.names,
        covariance=variance * unit[:q, :q] * scale,
        converged=best.converged,
        _covariance_of_pairs=cache(lambda: covariance_over_pairs(problem, best.x)[:q, :q] * scale),
    )
    sentences = [*_doubts(result, strangers)]
    reliable = not sentences
    for i, side in enumerate(() if judged else SIDES):
        one = replace(result.of_camera(i), converged=True)  # said above
        corners = (problem.left, problem.right)[i].m
        found, believed = judge(Diagnostics.of(one, residuals[i], corners, problem.left.W))
        sentences += [Doubt(f"{side} camera: {each.sentence}", *each.places) for each in found]
        reliable = reliable and believed
    return replace(result, warnings=tuple(sentences), reliable=reliable)


def _start(
    problem: StereoProblem, pairs: tuple[Correspondences, Correspondences], cameras: list[Camera]
) -> tuple[StereoState, list[int]]:
    """Return the state from which to refine, and the pairs that do not agree with the others."""
    poses = [_poses(data, camera) for data, camera in zip(pairs, cameras, strict=True)]
    G = chain(poses[1], inverse(poses[0]))  # right ← left, as each pair has it
    R, T = nearest_rotation(np.median(G[:, :3, :3], axis=0)), np.median(G[:, :3, 3], axis=0)
    apart = np.linalg.norm(vector_from_rotation(G[:, :3, :3] @ R.T), axis=-1) > _APART
    left = problem.left.state(cameras[0], poses[0])
    right = problem.right.state(cameras[1], poses[1]).shared
    return StereoState(left, right, R, T), np.flatnonzero(apart).tolist()


def _poses(data: Correspondences, camera: Camera) -> Array:
    """Poses (n_views, 4, 4) of the scaled boards from the homographies of the ideal points."""
    if data.seen is None and not np.isnan(ideal := camera.ideal(data.m)).any():
        with suppress(DegenerateError):  # one by one, so that the message names the view
            return extrinsics(np.eye(3), dlt.inside(data.W[..., :2], ideal))
    H = []
    for i, (W, m) in enumerate(data.views()):
        xy = camera.ideal(m)
        known = ~np.isnan(xy).any(-1)
        try:
            H.append(dlt(W[known, :2], xy[known]))
        except DegenerateError as error:
            raise DegenerateError(f"view {i}: {error}") from error
    return extrinsics(np.eye(3), np.array(H))


def _cameras(problem: StereoProblem, x: StereoState, scale: float) -> tuple[Camera, Camera]:
    """Return both cameras in the left one's frame."""
    G = pose(nearest_rotation(x.R), scale * x.T)
    left, right = problem.left.camera_of(x.left.shared), problem.right.camera_of(x.right)
    return left, right.moved(G)


SIDES = ("left", "right")


def _doubts(result: StereoCalibration, strangers: list[int]) -> Iterator[Doubt]:
    """Say why a rig is not to be believed.

    Parameters
    ----------
    result : StereoCalibration
        Not judged yet.
    strangers : list of int
        Pairs that show the cameras in another relative pose than the others do.
    """
    if strangers:
        yield Doubt(
            "{} show the cameras turned by more than 10° from where the others do: do left and "
            "right belong together, is the board numbered from the same corner in both, did the "
            "rig stay rigid?",
            Views(tuple(strangers)),
        )
    if not result.converged:
        yield Doubt("the refinement stopped before it reached a minimum")
    if (typical := float(np.median(result.view_rms))) > OF_PICTURE * max(result.left.size):
        yield Doubt(
            f"the corners are {typical:.1f} px away from where the cameras put them, in a typical "
            "picture: do left and right belong together?"
        )
