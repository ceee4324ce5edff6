"""What the evidence says: sentences about doubts, and whether the result is reliable."""

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from cvnotes.camera import xy_from_px
from cvnotes.reliability.evidence import Evidence, median

# Thresholds between sets that give the focal length and sets that do not, measured on 25 noisy
# sets of each family in tests/test_reliability.py.
_UNDETERMINED, _WEAK = 0.0023, 0.01  # second smallest over largest singular value of V
_PARALLEL, _FLAT = 5.0, 15.0  # largest angle between two boards, degrees
_UNCERTAIN, _UNKNOWN = 0.01, 0.10  # standard deviation of the focal length over its value
_ALIKE = 0.4  # correlation of neighbouring residuals; photographs with a fitting lens reach 0.3
_MOVED = 0.0006  # RMS over the picture's size from which a camera must have changed
_ADVICE = "tilt the board by 30 to 45 degrees, in different directions"
_NO_NOISE = (
    "neighbouring corners miss their places in the same direction, so this is no noise: is the "
    "board bent, did zoom, focus or orientation change between the pictures, or does the lens "
    "need more coefficients?"
)


def judge(evidence: Evidence) -> tuple[tuple[str, ...], bool]:
    """Give sentences about what is doubtful, and whether the result is reliable all the same.

    Returns
    -------
    warnings : tuple of str
        Empty if nothing is doubtful.
    reliable : bool
        False when the answer may be wrong by more than its error bars say.
    """
    fatal = [*_undetermined(evidence), *_mirrored(evidence), *_badly_fitted(evidence)]
    doubtful = [*_systematic(evidence), *_outside(evidence), *_outliers(evidence)]
    if not fatal:
        doubtful = [*_weak(evidence), *doubtful]
    return tuple(fatal + doubtful), not fatal


def _undetermined(e: Evidence) -> Iterator[str]:
    if not e.converged:
        yield "the refinement stopped before it reached a minimum; the answer is only a start"
    if e.tilt_between < _PARALLEL:
        yield (
            f"all boards are nearly parallel (at most {e.tilt_between:.1f}° between two), which "
            f"leaves the focal length open: {_ADVICE}"
        )
    elif e.determinacy < _UNDETERMINED:
        yield (
            f"these views do not determine the camera (V is singular to {e.determinacy:.4f}): "
            f"{_ADVICE}"
        )
    elif e.focal_uncertainty > _UNKNOWN:
        yield f"the focal length is known to {e.focal_uncertainty:.0%} only: {_ADVICE}"
    ratio = e.A[1, 1] / e.A[0, 0]
    if not 0.5 < ratio < 2:
        yield (
            f"pixels {ratio:.2g} times as high as wide are unlikely: are rows and columns of the "
            "board swapped, or its squares not square?"
        )


def _weak(e: Evidence) -> Iterator[str]:
    if len(e.poses) == 2:
        yield (
            "two views give as many constraints as A has unknowns, so nothing checks the answer: "
            "add views"
        )
    elif e.tilt_between < _FLAT or e.determinacy < _WEAK:
        yield (
            f"the boards' tilts (at most {e.tilt_between:.0f}° between two) determine the focal "
            f"length only weakly: {_ADVICE}"
        )
    elif e.focal_uncertainty > _UNCERTAIN:
        yield (
            f"the focal length has a standard deviation of {e.focal_uncertainty:.1%}: add views, "
            "fill more of the picture, or tilt the board more"
        )


def _mirrored(e: Evidence) -> Iterator[str]:
    """Find boards seen from behind: the sign of det H, which no RMS shows."""
    facing = np.vecdot(e.poses[:, :3, 2], e.poses[:, :3, 3])
    behind = np.flatnonzero(facing < 0)
    if len(behind) == len(e.poses):
        yield (
            "every board is seen from behind: are the pictures mirrored, or (v, u) given for "
            "(u, v)?"
        )
    elif len(behind):
        yield f"boards seen from behind in views {_listed(behind)}: mirrored labels or pictures?"


def _badly_fitted(e: Evidence) -> Iterator[str]:
    """Find views and whole sets that no camera of this kind explains."""
    typical = e.typical_rms
    limit = 0.005 * max(e.size)
    if typical > limit:
        yield (
            f"the corners are {typical:.1f} px away from where the model puts them, in a typical "
            "view: are the board's counts and the order of its corners right?"
        )
        return
    bad = np.flatnonzero(e.view_rms > np.maximum(4 * typical, 0.5))
    if len(bad):
        worst = int(np.argmax(e.view_rms))
        yield (
            f"views {_listed(bad)} do not fit the others (view {worst}: "
            f"{e.view_rms[worst]:.2f} px, typical {typical:.2f} px): moved, zoomed, rotated or "
            "badly found? Leave them out and see what changes"
        )
    if e.likeness > _ALIKE and typical > _MOVED * max(e.size):
        yield _NO_NOISE


def _systematic(e: Evidence) -> Iterator[str]:
    """Find residuals that are small, but of which the error bars are not a measure."""
    if e.likeness > _ALIKE and e.typical_rms <= _MOVED * max(e.size):
        yield f"{_NO_NOISE} The true error is then larger than the error bars say"


def _outliers(e: Evidence) -> Iterator[str]:
    """Find single corners far from their place."""
    d = e.distances
    if np.isnan(d).any():
        yield "some corners lie where the estimated lens folds over: estimate fewer coefficients"
        d = np.nan_to_num(d)
    # A distance with Gaussian coordinates exceeds 5 of its medians once in 30 million corners.
    limit = max(5 * median(d[d > 0]), 0.2) if d.any() else np.inf
    worst = d.argmax(1)
    found = [
        f"view {i}, corner {worst[i]} ({d[i, worst[i]]:.1f} px)"
        for i in np.flatnonzero(d.max(1) > limit)
    ]
    if found:
        more = f" and in {len(found) - 3} more views" if len(found) > 3 else ""
        yield f"corners far from their place: {', '.join(found[:3])}{more}"


def _outside(e: Evidence) -> Iterator[str]:
    w, h = e.size
    u, v = e.corners[..., 0], e.corners[..., 1]
    if min(u.min(), v.min()) < -0.5 or u.max() > w - 0.5 or v.max() > h - 0.5:
        yield (
            f"corners lie outside of the {w}×{h} picture: is size (width, height), and of these "
            "pictures?"
        )
    reach = e.lens.max_radius
    if np.isfinite(reach):
        xy = xy_from_px(e.A, [[0, 0], [w - 1, 0], [0, h - 1], [w - 1, h - 1]])
        if np.linalg.norm(xy, axis=-1).max() > reach * e.lens.L(reach):
            yield (
                "the estimated lens folds over before it reaches the corners of the picture: it "
                "holds only where corners were seen; bring the board into the corners too"
            )


def _listed(indices: npt.NDArray[np.intp]) -> str:
    words = [str(i) for i in indices[:5]]
    return ", ".join(words) + (" …" if len(indices) > 5 else "")
