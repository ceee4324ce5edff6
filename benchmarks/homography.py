"""Homographies of many views: one `dlt` of the stack against findHomography in a loop.

Run ``python -m benchmarks.homography``. 54 corners a view, σ = 0.3 px. OpenCV refines what its DLT
finds; the last columns say what that is worth, as the RMS distance in pixels between where each
homography and the true one put the corners. `refine_homography` is our refinement of one view.

Then `ransac_homography` against ``cv2.findHomography(…, cv2.RANSAC)``, with pairs of which some are
wrong: processor time, and by how much the homographies miss the true places of the right ones.
"""

import time
from collections.abc import Callable
from functools import partial
from typing import Any

import cv2
import numpy as np

from benchmarks.turns import all_in_turns
from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics
from cvnotes.homography import dlt, ransac_homography, refine_homography
from cvnotes.pictures import good_views
from cvnotes.projective import apply
from cvnotes.targets import Chessboard

BOARD = Chessboard((9, 6), 25.0)
CAMERA = Camera(intrinsics(800, 804, 325, 238))
VIEWS = (1, 2, 5, 10, 20, 100, 1000)


def find_each(src: Array, views: Array) -> Array:
    """Ask OpenCV view by view."""
    return np.array([cv2.findHomography(src, m)[0] for m in views])


def refine_each(src: Array, views: Array) -> Array:
    return refine_homography(dlt(src, views), src, views)


def compare(n: int) -> None:
    """Print what n views cost, each by itself, and how good the answers are."""
    rng = np.random.default_rng(n)
    poses = good_views(BOARD, CAMERA, n, rng=rng)
    exact = np.array([CAMERA.moved(G).project(BOARD.points) for G in poses])
    views, src = exact + rng.normal(0, 0.3, exact.shape), BOARD.points[:, :2]
    one = views if n > 1 else views[0]
    ways = {
        "dlt": lambda: dlt(src, one),
        "OpenCV": lambda: find_each(src, views),
        "refined": lambda: refine_each(src, views),
    }
    times = all_in_turns(ways, repeats=max(5, 400 // n))
    words = f"{n:6}"
    for name in ways:
        micro = 1e6 * times[name] / n
        words += f"{np.median(micro):10.1f}/{micro.min():<7.1f}"
    own, other = times["dlt"], times["OpenCV"]
    words += f"{np.median(other) / np.median(own):8.1f}/{other.min() / own.min():<7.1f}"
    found = dlt(src, views), find_each(src, views), refine_each(src, views)
    for H in found:
        off = np.linalg.norm([apply(h, src) for h in H] - exact, axis=-1)
        words += f"{np.sqrt(np.mean(off**2)):8.4f}"
    print(words)


WRONG = ((54, 0.2), (100, 0.4), (1000, 0.5), (300, 0.7))  # pairs, and which part is wrong


def _ours(src: Array, dst: Array, seed: int) -> Any:
    return ransac_homography(src, dst, threshold=1.0, rng=np.random.default_rng(seed))


def compare_robust(n: int, part: float, sets: int = 10) -> None:
    """Print the median over some sets of what both cost, and how far off they are."""
    H = np.array([[1.1, 0.1, 20], [-0.05, 0.9, 30], [2e-4, 1e-4, 1]])
    times, off = [], []
    for seed in range(sets):
        rng = np.random.default_rng(seed)
        src = rng.uniform(0, 640, (n, 2))
        true = apply(H, src)
        dst, wrong = true + rng.normal(0, 0.3, true.shape), int(part * n)
        dst[:wrong] = rng.uniform(0, 640, (wrong, 2))
        ways: dict[str, Callable[[], Any]] = {
            "ours": partial(_ours, src, dst, seed),
            "OpenCV": partial(
                cv2.findHomography, src, dst, cv2.RANSAC, 1.0, maxIters=20_000, confidence=0.999
            ),
        }
        spent = all_in_turns(ways, repeats=5, clock=time.process_time)
        times.append([np.median(spent[name]) for name in ways])
        distances = [apply(way()[0], src) - true for way in ways.values()]
        off.append(np.sqrt([np.mean((d[wrong:] ** 2).sum(-1)) for d in distances]))
    (own, other), errors = np.median(times, axis=0), np.median(off, axis=0)
    print(
        f"{n:6}{part:7.0%}{1e3 * own:10.2f}{1e3 * other:10.2f}{own / other:14.1f}"
        f"{errors[0]:16.4f}{errors[1]:9.4f}"
    )


def main() -> None:
    print(f"Homographies [µs a view], median/shortest (OpenCV {cv2.__version__})")
    print(
        f"{'views':>6}{'dlt':>12}{'findHomography':>23}{'dlt, refined':>17}{'dlt faster':>17}"
        f"{'off: dlt':>16}{'OpenCV':>8}{'refined':>8}"
    )
    for n in VIEWS:
        compare(n)
    print("\nWith wrong pairs [ms, processor]")
    print(
        f"{'pairs':>6}{'wrong':>7}{'ours':>10}{'OpenCV':>10}{'OpenCV = 1':>14}"
        f"{'off by: ours':>16}{'OpenCV':>9}"
    )
    for n, part in WRONG:
        compare_robust(n, part)


if __name__ == "__main__":
    main()
