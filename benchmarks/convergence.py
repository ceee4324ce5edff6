"""Does `calibrate` end where it should, from any corners? Random sets against OpenCV's minimum.

Run ``python -m benchmarks.convergence [SETS] [--jobs 4] [--cluster tcp://scheduler:8786]``.

Boards of 9×6 at random places and tilts in a
640×480 picture, σ = 0.3 px, through lenses from mild to strong. *Worse* counts the sets in which
our RMS is more than 10⁻⁴ of its value above OpenCV's, *failed* those that we refuse.
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


def random_camera(k: tuple[float, float], f: tuple[int, int], rng: np.random.Generator) -> Camera:
    """Give a camera with the piercing point somewhere near the middle."""
    alpha, (u0, v0) = rng.uniform(*f), rng.normal([319.5, 239.5], 15)
    return Camera(intrinsics(alpha, 1.005 * alpha, u0, v0), lens=Lens(k, (0.001, -0.0005)))


def random_corners(camera: Camera, n: int, rng: np.random.Generator) -> Array:
    """Give the noisy corners (n, 54, 2) of boards that lie within the picture."""
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
    """Give the outcome of one random set: a function of its seed alone."""
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
    """Give those who do it: this process, several, or the workers of a Dask scheduler."""
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


if __name__ == "__main__":
    main()
