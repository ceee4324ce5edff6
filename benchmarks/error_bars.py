"""Do error bars hold? The jackknife over views against OpenCV's standard deviations, and its time.

Run ``python -m benchmarks.error_bars [SETS]``. In each of the simulated sets a 9×6 board is seen
in 20 views; how often is the true value of each parameter within 1 and 1.96 deviations? What holds
says 68 and 95 %; deviations that come from 20 views, with Student's 19 degrees of freedom, 67 and
93.5 %. The boards are flat with noise alone, or twisted by 0.3 mm at their ends, and then taken for
flat (as OpenCV must) or for bent.

Then the photographs of a real pair of cameras: how far apart are the cameras of two random halves,
over what their deviations promise? 1 if they hold. Last the time of the deviations of views, for
which OpenCV would have to calibrate once without each view.
"""

import argparse
import warnings
from typing import Any

import cv2
import numpy as np

from benchmarks.calibration import opencv
from benchmarks.turns import all_in_turns
from cvnotes.base import Array, CalibrationWarning
from cvnotes.calibration import Calibration, calibrate
from cvnotes.camera import Camera, Lens, intrinsics, pose, rotation_from_vector
from cvnotes.pictures import course
from cvnotes.targets import Chessboard

BOARD = Chessboard((9, 6), 25.0)
CAMERA = Camera(intrinsics(800, 804, 325, 238), lens=Lens((-0.25, 0.1), (0.001, -0.0005)))
LENS = "k1 k2 p1 p2"
VIEWS = 20
# twist in mm, noise in px, and what we take the board for
SETS = ((0.0, 0.2, "flat"), (0.3, 0.02, "flat"), (0.3, 0.02, "bent"))


def seen(twist: float, noise: float, rng: np.random.Generator) -> Array:
    """Return the corners of a board at random places and tilts, exact in OpenCV's float32."""
    W = BOARD.points.copy()
    xy = (W - W.mean(0))[:, :2]
    W[:, 2] = twist * (xy / np.abs(xy).max(0)).prod(1)
    views: list[Array] = []
    while len(views) < VIEWS:
        R = rotation_from_vector([0, 0, rng.uniform(-np.pi, np.pi)])
        R = rotation_from_vector([*rng.normal(0, 0.4, 2), 0]) @ R
        z = rng.uniform(350, 700)
        middle = [*rng.uniform(-0.3, 0.3, 2) * z, z]
        m = CAMERA.moved(pose(R, middle - R @ BOARD.points.mean(0))).project(W)
        if (m > 0).all() and (m < CAMERA.size).all():
            views.append(m)
    m = np.array(views) + rng.normal(0, noise, (VIEWS, len(W), 2))
    return m.astype(np.float32).astype(float)


def by_opencv(W: Array, m: Array, size: tuple[int, int]) -> tuple[Array, Array]:
    """Return OpenCV's fx, fy, cx, cy, k1, k2, p1, p2 and the deviations that it promises."""
    boards = [W.astype(np.float32)] * len(m)
    function: Any = cv2.calibrateCameraExtended  # (whose stubs know of no first guess that is none)
    _, A, d, _, _, std, *_ = function(
        boards, list(m.astype(np.float32)), size, None, None, flags=cv2.CALIB_FIX_K3
    )
    return np.array([A[0, 0], A[1, 1], A[0, 2], A[1, 2], *d.ravel()[:4]]), std.ravel()[:8]


def both(found: Calibration) -> tuple[Array, Array, Array]:
    """Return our parameters, the deviations by noise alone, and those of views."""
    return tuple(  # type: ignore[return-value]
        np.array([*x.values()]) for x in (found.parameters, found.std, found.std_of_views)
    )


def coverage(twist: float, noise: float, board: str, sets: int) -> None:
    """Print how often the true values lie within the bars of each kind."""
    truth = np.array([800, 804, 325, 238, -0.25, 0.1, 0.001, -0.0005])
    z = np.empty((sets, 3, len(truth)))
    for seed in range(sets):
        m = seen(twist, noise, np.random.default_rng(seed))
        theirs, promised = by_opencv(BOARD.points, m, CAMERA.size)
        found = calibrate(BOARD.points, m, CAMERA.size, lens=LENS, board=board)
        ours, by_noise, by_views = both(found)
        z[seed] = (theirs - truth) / promised, (ours - truth) / by_noise, (ours - truth) / by_views
    row = "".join(
        f"{(np.abs(z[:, i]) < 1).mean():8.0%}{(np.abs(z[:, i]) < 1.96).mean():6.0%}"
        for i in range(3)
    )
    print(f"{twist:6.1f}{noise:7.2f}{board:>7}{row}", flush=True)


def halves(side: str, sets: int) -> None:
    """Print the RMS of the differences between two halves of real photographs, over the bars."""
    real, z = course.real_corners(), []
    m, W, rng = np.asarray(getattr(real, side)), real.board.points, np.random.default_rng(0)
    for _ in range(sets):
        order = rng.permutation(len(m))
        parts = [m[order[: len(m) // 2]], m[order[len(m) // 2 :]]]
        (a, da), (b, db) = (by_opencv(W, part, real.size) for part in parts)
        (c, dc, jc), (d, dd, jd) = (
            both(calibrate(W, part, real.size, lens=LENS)) for part in parts
        )
        z.append(
            [(a - b) / np.hypot(da, db), (c - d) / np.hypot(dc, dd), (c - d) / np.hypot(jc, jd)]
        )
    cv, noise, views = np.sqrt(np.mean(np.square(z), axis=(0, 2)))
    print(f"{side:>20}{cv:14.2f}{noise:14.2f}{views:14.2f}", flush=True)


def timed() -> None:
    """Print what the bars cost."""
    m = seen(0.0, 0.2, np.random.default_rng(0))

    def one_by_one() -> None:
        for i in range(len(m)):
            opencv(cv2.calibrateCamera, np.delete(m, i, axis=0))()

    def ours() -> Array:
        return calibrate(BOARD.points, m, CAMERA.size, lens=LENS).covariance_of_views

    times = all_in_turns(
        {
            "calibrate": lambda: calibrate(BOARD.points, m, CAMERA.size, lens=LENS),
            "and std_of_views": ours,
            "OpenCV without each view": one_by_one,
        },
        repeats=5,
    )
    least = {name: spent.min() for name, spent in times.items()}
    for name, seconds in least.items():
        print(f"{name:>26}{1e3 * seconds:9.1f} ms{seconds / least['calibrate']:9.1f} × calibrate")


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.error_bars")
    parser.add_argument("sets", nargs="?", type=int, default=100)
    sets = parser.parse_args().sets
    warnings.simplefilter("ignore", CalibrationWarning)
    print(f"True values within 1 and 1.96 deviations, {sets} sets (OpenCV {cv2.__version__})")
    print(f"{'twist':>6}{'noise':>7}{'board':>7}{'OpenCV':>14}{'std':>14}{'std_of_views':>14}")
    for case in SETS:
        coverage(*case, sets)
    print("\nHalves of real photographs apart, over the deviations")
    print(f"{'':>20}{'OpenCV':>14}{'std':>14}{'std_of_views':>14}")
    for side in ("left", "right"):
        halves(side, sets)
    print(f"\nTime for {VIEWS} views")
    timed()


if __name__ == "__main__":
    main()
