"""Does `calibrate` end where it should, from any corners? Random sets against OpenCV's minimum.

Run ``python -m benchmarks.convergence [SETS] [--jobs 4] [--cluster tcp://scheduler:8786]``.

Boards of 9×6 at random places and tilts in a
640×480 picture, σ = 0.3 px, through lenses from mild to strong. *Worse* counts the sets in which
our RMS is more than 10⁻⁴ of its value above OpenCV's, *failed* those that we refuse.

Then exact corners of distant boards through narrow lenses that bend strongly (f of 1 to 2.5 widths,
corners of the picture moved by 10 to 30 %), of which each board nearly has two poses: in how many
sets the camera is not the exact one.
"""

import argparse
import warnings
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from functools import partial

import cv2
import numpy as np

from benchmarks.calibration import BOARD, opencv
from cvnotes.base import Array, CalibrationWarning, CvnotesError
from cvnotes.base.study import study
from cvnotes.calibration import calibrate
from cvnotes.camera import Camera, Lens, intrinsics, pose, rotation_from_vector

# k1 and k2, and between which focal lengths
LENSES = {
    "mild": ((-0.25, 0.10), (350, 1200)),
    "barrel": ((-0.40, 0.15), (350, 1200)),
    "strong barrel": ((-0.45, 0.25), (300, 500)),
    "pincushion": ((0.30, 0.10), (350, 1200)),
}
VIEWS = (3, 4, 5, 8, 15)
OF_TWO_POSES = (3, 4, 5, 8, 9, 12, 15)


def random_camera(k: tuple[float, float], f: tuple[int, int], rng: np.random.Generator) -> Camera:
    """Return a camera with the piercing point somewhere near the middle."""
    alpha, (u0, v0) = rng.uniform(*f), rng.normal([319.5, 239.5], 15)
    return Camera(intrinsics(alpha, 1.005 * alpha, u0, v0), lens=Lens(k, (0.001, -0.0005)))


def random_corners(camera: Camera, n: int, rng: np.random.Generator) -> Array:
    """Return the noisy corners (n, 54, 2) of boards that lie within the picture."""
    seen: list[Array] = []
    while len(seen) < n:
        R = rotation_from_vector(rng.normal(0, [0.5, 0.5, 0.6]))
        z = rng.uniform(180, 700)
        middle = [*rng.uniform(-0.6, 0.6, 2) * z, z]
        G = pose(R, middle - R @ BOARD.points.mean(axis=0))
        m = camera.moved(G).project(BOARD.points)
        if np.isfinite(m).all() and (m > 5).all() and (m < [635, 475]).all():
            seen.append(m)
    m = np.array(seen) + rng.normal(0, 0.3, (n, *seen[0].shape))
    return m.astype(np.float32).astype(float)


def two_poses(n: int, rng: np.random.Generator) -> tuple[float, Array]:
    """Return f and the exact corners (n, 54, 2) of boards that look alike in two poses."""
    seen: list[Array] = []
    while len(seen) < n:
        f = rng.uniform(1, 2.5) * 640
        k1 = -rng.uniform(0.1, 0.3) * (f / 400) ** 2
        camera = Camera(intrinsics(f, f, 320, 240), lens=Lens((k1,)))
        seen = []
        for _ in range(400 * n):  # some cameras see hardly a whole board
            T = [rng.uniform(-180, -40), rng.uniform(-130, 0), f * rng.uniform(0.35, 0.9)]
            G = pose(rotation_from_vector(rng.uniform(-0.45, 0.45, 3)), T)
            m = camera.moved(G).project(BOARD.points)
            if np.isfinite(m).all() and (m > 0).all() and (m < [640, 480]).all():
                seen.append(m)
            if len(seen) == n:
                break
    return f, np.array(seen)


def is_wrong(seed: int, *, n: int) -> tuple[bool, bool]:
    """Return whether our camera is not the exact one, and whether OpenCV's is not."""
    f, m = two_poses(n, np.random.default_rng([n, seed]))
    boards = [BOARD.points.astype(np.float32)] * n
    only_k1 = cv2.CALIB_ZERO_TANGENT_DIST | cv2.CALIB_FIX_K2 | cv2.CALIB_FIX_K3
    A = cv2.calibrateCamera(boards, list(m.astype(np.float32)), (640, 480), None, None,
                            flags=only_k1)[1]  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CalibrationWarning)
        ours = calibrate(BOARD.points, m, (640, 480), lens="k1").A
    return bool(abs(ours[0, 0] / f - 1) > 1e-3), bool(abs(A[0, 0] / f - 1) > 1e-3)


def outcome(m: Array) -> str:
    """Calibrate in both ways, and tell how ours compares."""
    theirs = opencv(cv2.calibrateCamera, m)()[0]
    try:
        ours = calibrate(BOARD.points, m, (640, 480), lens="k1 k2 p1 p2").rms
    except CvnotesError:
        return "failed"
    if abs(ours / theirs - 1) < 1e-4:
        return "equal"
    return "worse" if ours > theirs else "better"


def one(seed: int, *, n: int, k: tuple[float, float], f: tuple[int, int]) -> str:
    """Return the outcome of one random set: a function of its seed alone."""
    rng = np.random.default_rng([n, seed])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CalibrationWarning)
        return outcome(random_corners(random_camera(k, f, rng), n, rng))


def counted(
    k: tuple[float, float], f: tuple[int, int], n: int, sets: int, executor: Executor | None = None
) -> Counter[str]:
    """Count the outcomes of many sets."""
    return Counter(study(partial(one, n=n, k=k, f=f), range(sets), executor))


@contextmanager
def workers(jobs: int, cluster: str | None) -> Iterator[Executor | None]:
    """Return those who do it: this process, several, or the workers of a Dask scheduler."""
    if cluster:
        from distributed import Client

        with Client(cluster) as client:
            yield client.get_executor()
    elif jobs > 1:
        with ProcessPoolExecutor(jobs) as pool:
            yield pool
    else:
        yield None


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.convergence")
    parser.add_argument("sets", nargs="?", type=int, default=30)
    parser.add_argument("--jobs", type=int, default=1, help="processes on this machine")
    parser.add_argument("--cluster", metavar="ADDRESS", help="of a Dask scheduler")
    args = parser.parse_args()
    print(f"{args.sets} random sets each; our RMS against OpenCV's ({cv2.__version__})")
    print(f"{'lens':>14}{'views':>7}" + "".join(f"{w:>8}" for w in ("worse", "failed", "better")))
    with workers(args.jobs, args.cluster) as executor:
        for name, (k, f) in LENSES.items():
            for n in VIEWS:
                found = counted(k, f, n, args.sets, executor)
                numbers = "".join(f"{found[w]:8}" for w in ("worse", "failed", "better"))
                print(f"{name:>14}{n:7}{numbers}", flush=True)
        print(f"{'exact corners':>14}{'views':>7}{'wrong':>8}{'OpenCV':>8}")
        for n in OF_TWO_POSES:
            wrong = study(partial(is_wrong, n=n), range(args.sets), executor)
            ours, theirs = np.sum(wrong, axis=0)
            print(f"{'two poses':>14}{n:7}{ours:8}{theirs:8}", flush=True)


if __name__ == "__main__":
    main()
