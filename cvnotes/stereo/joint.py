"""Both cameras of a rig and all pairs together: from a closed-form start to a judged result."""

from dataclasses import replace
from warnings import warn

import numpy as np

from cvnotes.camera import Camera
from cvnotes.correspondences import Correspondences
from cvnotes.errors import Array, CalibrationWarning, DegenerateError
from cvnotes.homography import dlt
from cvnotes.lens import Lens
from cvnotes.refine import Problem, State, covariance
from cvnotes.rigid import chain, inverse, nearest_rotation, pose, vector_from_rotation
from cvnotes.stereo.judging import judge_rig
from cvnotes.stereo.refinement import StereoProblem, StereoState
from cvnotes.stereo.result import StereoCalibration
from cvnotes.zhang import extrinsics

# A pair whose relative pose is this far from the others' (radians) does not belong to the rig.
_APART = np.deg2rad(10)


def refined(
    problem: StereoProblem, pairs: tuple[Correspondences, Correspondences], cameras: list[Camera]
) -> StereoCalibration:
    """Refine from a closed-form start, undo the scaling, add error bars, and judge."""
    unknowns = len(problem.names) + 6 * len(pairs[0])
    measured = 2 * (problem.left.n_seen + problem.right.n_seen)
    if measured <= unknowns:
        raise DegenerateError(
            f"{measured} measured coordinates cannot determine {unknowns} parameters; add pairs"
        )
    start, strangers = _start(problem, pairs, cameras)
    best = problem.minimise(start)
    variance = best.cost / (measured - unknowns)
    scale = np.ones(len(problem.names))
    scale[-3:] = pairs[0].scale  # T, back in the unit of the board
    cov = variance * covariance(best.system) * np.outer(scale, scale)
    left, right = _cameras(problem, best.x, pairs[0].scale, cameras)
    distances = _distances(problem, best.x, left, right)
    view_rms = np.sqrt(
        [
            np.nansum(d**2, axis=1) / p.n_seen_by_view
            for d, p in zip(distances, (problem.left, problem.right), strict=True)
        ]
    ).T
    result = StereoCalibration(
        left=left,
        right=right,
        poses=pairs[0].pose_in_given_units(best.x.left.R, best.x.left.T),
        rms=float(np.sqrt(2 * best.cost / measured)),
        view_rms=view_rms,
        names=problem.names,
        covariance=cov,
        converged=best.converged,
    )
    sentences, reliable = judge_rig(result, (problem.left.m, problem.right.m), distances, strangers)
    for sentence in sentences:
        warn(sentence, CalibrationWarning, stacklevel=3)
    return replace(result, warnings=sentences, reliable=reliable)


def _start(
    problem: StereoProblem, pairs: tuple[Correspondences, Correspondences], cameras: list[Camera]
) -> tuple[StereoState, list[int]]:
    """Give the state from which to refine, and the pairs that do not agree with the others."""
    poses = [_poses(data, camera) for data, camera in zip(pairs, cameras, strict=True)]
    G = chain(poses[1], inverse(poses[0]))  # right ← left, as each pair has it
    R, T = nearest_rotation(np.median(G[:, :3, :3], axis=0)), np.median(G[:, :3, 3], axis=0)
    apart = np.linalg.norm(vector_from_rotation(G[:, :3, :3] @ R.T), axis=-1) > _APART
    left = problem.left.state(cameras[0].A, cameras[0].lens, poses[0])
    right = problem.right.state(cameras[1].A, cameras[1].lens, poses[1]).shared
    return StereoState(left, right, R, T), np.flatnonzero(apart).tolist()


def _poses(data: Correspondences, camera: Camera) -> Array:
    """Poses (n_views, 4, 4) of the scaled boards from the homographies of the ideal points."""
    H = []
    for i, (W, m) in enumerate(data.views()):
        xy = camera.ideal(m)
        known = ~np.isnan(xy).any(-1)
        try:
            H.append(dlt(W[known, :2], xy[known]))
        except DegenerateError as error:
            raise DegenerateError(f"view {i}: {error}") from error
    return extrinsics(np.eye(3), np.array(H))


def _cameras(
    problem: StereoProblem, x: StereoState, scale: float, given: list[Camera]
) -> tuple[Camera, Camera]:
    """Give both cameras in the left one's frame."""
    G = pose(nearest_rotation(x.R), scale * x.T)
    if problem.cameras_known:
        return given[0].moved(np.eye(4)), given[1].moved(G)
    A_left, lens_left = problem.left.camera_of(x.left.shared)
    A_right, lens_right = problem.right.camera_of(x.right)
    return (
        Camera(A_left, np.eye(4), lens_left, given[0].size),
        Camera(A_right, G, lens_right, given[1].size),
    )


def _distances(
    problem: StereoProblem, x: StereoState, left: Camera, right: Camera
) -> tuple[Array, Array]:
    """Reprojection distances (n_views, n) in both pictures; 0 where no corner was seen."""

    def of(p: Problem, A: Array, lens: Lens, state: State) -> Array:
        d = np.linalg.norm(p.m - p.predicted(A, lens, state), axis=-1)
        return d if p.seen is None else np.where(p.seen, d, 0.0)

    return (
        of(problem.left, left.A, left.lens, x.left),
        of(problem.right, right.A, right.lens, x.of_right()),
    )
