"""Steps 1 to 4 of Zhang's method, the library's own or the student's (notes 2b.4).

They see the board centred and scaled to unit size and the picture centred and scaled to [−1, 1],
and give starts for the refinement, the most robust first. Each gets copies, and what a student's
function gives back is looked at before it is used.
"""

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from cvnotes.base import (
    Array,
    CvnotesError,
    DegenerateError,
    InputTypeError,
    ShapeError,
    intrinsic_matrix,
    matrix,
    numbers,
    rigid_motion,
)
from cvnotes.calibration.refinement import Problem, State
from cvnotes.calibration.zhang import (
    constraints,
    extrinsics,
    focal_lengths_from_v,
    intrinsics_from_b,
    poses_of,
    radial_distortion,
    radial_from_poses,
    solve_b,
)
from cvnotes.camera import Lens, xy_from_px
from cvnotes.homography import dlt, geometric_error

# Strong lenses bend the boards so much that homographies mislead. In reserve, the corners are
# first straightened: x ← x (1 + bend r²), with r = 1 at the ends of the picture's longer axis.
_BENDS = (0.0, 0.2, -0.2)
# A student's H is wrong when it puts half of the corners this far off; the picture's width is 2.
_WRONG = 0.25


@dataclass(frozen=True)
class Steps:
    """The four steps, and the size of the picture that scales what they see."""

    size: tuple[int, int]
    homography: Callable[..., Any] = dlt
    intrinsics: Callable[..., Any] | None = None
    extrinsics: Callable[..., Any] = extrinsics
    distortion: Callable[..., Any] = radial_distortion

    def __post_init__(self) -> None:
        for name in self.own:
            step = getattr(self, name)
            if not callable(step):
                raise InputTypeError(f"{name}: expected a function, got {type(step).__name__}")

    @property
    def own(self) -> list[str]:
        """Names of the steps that are not the library's."""
        library = Steps.__dataclass_fields__
        return [n for n in list(library)[1:] if getattr(self, n) is not library[n].default]

    def starts(self, problem: Problem) -> Iterator[State]:
        """Run the steps; gives a state for each candidate, the most robust first."""
        to_px = _px_from_normalised(self.size)
        m = (problem.m - to_px[:2, 2]) / to_px[0, 0]
        for bend in _BENDS if problem.n_radial else _BENDS[:1]:
            straight = m * (1 + bend * (m * m).sum(-1, keepdims=True)) if bend else m
            H = self.homographies(problem, straight)
            for A in self.candidates(H, problem.skew):
                with suppress(DegenerateError):
                    yield self.with_lens(problem, to_px @ A, self.poses(A, H))

    def resumed(self, problem: Problem, shared: Array) -> State:
        """Give the state of all views, from what a few of them say about the camera."""
        A, lens = problem.camera_of(shared)
        as_seen = xy_from_px(A, problem.m)
        ideal = lens.undistort(as_seen)
        H = self.homographies(problem, np.where(np.isnan(ideal), as_seen, ideal))
        G = self.poses(np.eye(3), H)
        return State(shared, G[:, :3, :3], G[:, :3, 3])

    def homographies(self, problem: Problem, m: Array) -> Array:
        """1. One homography for each view."""
        if self.homography is dlt and problem.seen is None:
            with suppress(DegenerateError):  # one by one, so that the message names the view
                return dlt(problem.W[..., :2], m)
        return np.array([self.homography_of(problem, m, i) for i in range(len(m))])

    def homography_of(self, problem: Problem, m: Array, i: int) -> Array:
        """Ask for one homography, and look whether it can be one."""
        W = problem.W if problem.W.ndim == 2 else problem.W[i]
        seen = np.ones(len(W), bool) if problem.seen is None else problem.seen[i]
        src, dst = W[seen, :2], m[i, seen]
        try:
            H = matrix(self.homography(src.copy(), dst.copy()), f"the homography of view {i}", 3, 3)
        except DegenerateError as error:
            raise DegenerateError(f"view {i}: {error}") from error
        if self.homography is not dlt and not np.median(geometric_error(H, src, dst)) < _WRONG:
            raise CvnotesError(
                f"the homography of view {i} puts the corners far from where they were seen; it "
                "must map the board to the picture, dst ≈ H src: is it transposed, or the inverse?"
            )
        return H

    def candidates(self, H: Array, skew: bool) -> Iterator[Array]:
        """2. Intrinsics: the focal lengths alone, then, in reserve, the full closed form."""
        if self.intrinsics is not None:
            yield intrinsic_matrix(self.intrinsics(H.copy()), "the A of your intrinsics")
            return
        V = constraints(H)
        b = solve_b(V, skew=skew)
        with suppress(DegenerateError):
            yield np.diag([*focal_lengths_from_v(V), 1.0])
        with suppress(DegenerateError):
            yield intrinsics_from_b(b)
        # Noise and strong lenses can leave neither; then fields of view from 118° to 28° are tried.
        for f in (0.6, 1.0, 2.0, 4.0):
            yield np.diag([f, f, 1.0])

    def poses(self, A: Array, H: Array) -> Array:
        """3. The pose of each view."""
        if self.extrinsics is extrinsics and self.homography is dlt:
            return poses_of(A, H)
        G = rigid_motion(self.extrinsics(A.copy(), H.copy()), "the poses of your extrinsics")
        if G.shape != (len(H), 4, 4):
            raise ShapeError(
                f"the poses of your extrinsics: expected shape {(len(H), 4, 4)}, got {G.shape}"
            )
        if G[:, 2, 3].min() <= 0:
            i = int(G[:, 2, 3].argmin())
            raise CvnotesError(
                f"your extrinsics put the board of view {i} behind the camera; H and −H show the "
                "same picture: take the sign that gives T_z > 0"
            )
        return G

    def with_lens(self, problem: Problem, A: Array, G: Array) -> State:
        """4. The lens by linear least squares."""
        k: Array = np.zeros(0)
        if problem.n_radial and self.distortion is radial_distortion:
            k = radial_from_poses(A, G, problem.W, problem.m, problem.n_radial)
        elif problem.n_radial:
            copies = (x.copy() for x in (A, G, problem.W, problem.m))
            given = self.distortion(*copies, terms=problem.n_radial)
            k = numbers(given, "the k of your distortion")
        if k.shape != (problem.n_radial,):
            raise ShapeError(
                f"the k of your distortion: expected shape {(problem.n_radial,)}, got {k.shape}"
            )
        return problem.state(A, Lens(k=tuple(k)), G)


def _px_from_normalised(size: tuple[int, int]) -> Array:
    """Similarity that takes 0 to the picture's middle and [−1, 1] to its longer side."""
    w, h = size
    s = max(w, h) / 2
    return np.array([[s, 0, (w - 1) / 2], [0, s, (h - 1) / 2], [0, 0, 1]])
