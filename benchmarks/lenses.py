"""Wide lenses from corners alone: "rational" and "fisheye" against OpenCV's calibrations of them.

Run ``python -m benchmarks.lenses``. Boards of 9×6 stand all over a 640×480 picture, before the
camera and, as far as OpenCV's model goes by the plane z = 1, no farther aside than 75°; σ = 0.2 px.
OpenCV runs as its users run it, from no guess: `calibrateCamera` with the rational model, and
`fisheye.calibrate` with recomputed poses and without skew. Both in turns, in one process; median
and, behind the slash, shortest time. Then how far, in the root mean square over a grid of the
picture's pixels, each camera's rays are from the true ones: in pixels, after the small rotation of
the whole camera that no calibration can tell is taken away.
"""

import warnings
from collections.abc import Callable
from typing import Any

import cv2
import numpy as np

from benchmarks.turns import all_in_turns
from cvnotes.base import Array, CalibrationWarning
from cvnotes.calibration import calibrate
from cvnotes.camera import (
    Camera,
    FisheyeLens,
    RationalLens,
    intrinsics,
    pose,
    rotation_from_vector,
)
from cvnotes.targets import Chessboard

BOARD = Chessboard((9, 6), 25.0)
CAMERAS = {
    "rational": Camera(
        intrinsics(300, 301, 325, 238),
        lens=RationalLens((0.8, 0.1, 0.01, 1.1, 0.3, 0.02), (0.0005, -0.0003)),
    ),
    "fisheye": Camera(intrinsics(220, 221, 322, 241), lens=FisheyeLens((0.02, -0.01, 0.003))),
}
VIEWS = (10, 20, 50)
NOISE = 0.2
_ASIDE = np.cos(np.radians(75))


def corners(camera: Camera, n: int) -> Array:
    """Return the noisy corners (n, 54, 2) of boards all over the picture, exact in float32."""
    rng, size = np.random.default_rng(n), np.array(camera.size)
    seen: list[Array] = []
    while len(seen) < n:
        d = camera.ray(rng.uniform(0.1 * size, 0.9 * size))
        x = np.cross([0, 1, 0], d) / np.linalg.norm(np.cross([0, 1, 0], d))
        facing = np.stack([x, np.cross(d, x), d], axis=1)
        R = facing @ rotation_from_vector(rng.uniform(-0.6, 0.6, 3))
        T = d * rng.uniform(120, 400) - R @ BOARD.points.mean(0)
        M = BOARD.points @ R.T + T
        m = camera.moved(pose(R, T)).project(BOARD.points)
        inside = np.isfinite(m).all() and (m > 0).all() and (m < size).all()
        if inside and (M[:, 2] > _ASIDE * np.linalg.norm(M, axis=1)).all():
            seen.append(m)
    m = np.array(seen) + rng.normal(0, NOISE, (n, *seen[0].shape))
    return m.astype(np.float32).astype(float)


def by_opencv(name: str, m: Array) -> Callable[[], tuple[float, Camera]]:
    """Return OpenCV's calibration of the same corners: its RMS per point and its camera."""
    size = CAMERAS[name].size
    if name == "rational":
        W = [BOARD.points.astype(np.float32)] * len(m)
        views = list(m.astype(np.float32))

        def rational() -> tuple[float, Camera]:
            flags = cv2.CALIB_RATIONAL_MODEL
            rms, A, d, *_ = cv2.calibrateCamera(W, views, size, None, None, flags=flags)
            k1, k2, p1, p2, *more = d.ravel().tolist()
            lens = RationalLens((k1, k2, *more[:4]), (p1, p2))
            return rms, Camera(np.asarray(A, float), lens=lens, size=size)

        return rational

    # (4 and 5 keep the flags in different places)
    where: Any = cv2.fisheye if hasattr(cv2.fisheye, "CALIB_FIX_SKEW") else cv2
    flags = where.CALIB_FIX_SKEW | where.CALIB_RECOMPUTE_EXTRINSIC
    boards, views = [BOARD.points[None]] * len(m), [one[None] for one in m]
    function: Any = cv2.fisheye.calibrate

    def fisheye() -> tuple[float, Camera]:
        A, k = np.eye(3), np.zeros((4, 1))
        rms, A, k, *_ = function(boards, views, size, A, k, flags=flags)
        return rms, Camera(A, lens=FisheyeLens(k.ravel()), size=size)

    return fisheye


def off(camera: Camera, true: Camera) -> float:
    """Return how far a camera's rays are from the true ones, in pixels of the true camera."""
    u, v = np.meshgrid(np.linspace(0, 639, 33), np.linspace(0, 479, 25))
    m = np.stack([u, v], axis=-1).reshape(-1, 2)
    M, d = true.ray(m), camera.ray(m)
    both = np.isfinite(M + d).all(-1)
    U, _, Vt = np.linalg.svd(M[both].T @ d[both])  # the rotation that no calibration can tell
    m_off = true.project(d[both] @ (U @ np.diag([1, 1, np.linalg.det(U @ Vt)]) @ Vt).T) - m[both]
    return float(np.sqrt(np.nanmean((m_off**2).sum(-1))))


def compare(name: str, n: int) -> None:
    """Print one row."""
    true = CAMERAS[name]
    m = corners(true, n)

    def ours() -> Any:
        return calibrate(BOARD.points, m, true.size, lens=name)

    times = all_in_turns({"ours": ours, "OpenCV": by_opencv(name, m)}, repeats=5)
    own, other = times["ours"], times["OpenCV"]
    found, (rms, theirs) = ours(), by_opencv(name, m)()
    print(
        f"{name:>9}{n:6}"
        f"{1e3 * np.median(own):10.1f}/{1e3 * own.min():<8.1f}"
        f"{1e3 * np.median(other):10.1f}/{1e3 * other.min():<8.1f}"
        f"{np.median(other) / np.median(own):7.1f}/{other.min() / own.min():<6.1f}"
        f"{found.rms:9.4f}{rms - found.rms:+10.0e}"
        f"{off(found.camera, true):10.3f}{off(theirs, true):9.3f}"
    )


def main() -> None:
    warnings.simplefilter("ignore", CalibrationWarning)
    print(f"Wide lenses [ms], median/shortest (OpenCV {cv2.__version__}); RMS and rays off [px]")
    print(
        f"{'lens':>9}{'views':>6}{'cvnotes':>14}{'OpenCV':>19}{'faster':>18}{'RMS':>13}"
        f"{'theirs':>10}{'ours off':>10}{'theirs':>9}"
    )
    for name in CAMERAS:
        for n in VIEWS:
            compare(name, n)


if __name__ == "__main__":
    main()
