"""Calibration from corners alone: `calibrate` against OpenCV's calibrateCamera.

Run ``python -m benchmarks.calibration``. A 9×6 board in 640×480, σ = 0.3 px, k1 k2 p1 p2. OpenCV
runs once as its users run it (30 iterations, eps 2e-16) and once stopped after the 8 iterations
that it needs to converge. Both start from the corners, in turns, in one process; a turn of a few
views is several calibrations. Each time is that of the processor, the median, and behind the slash
the shortest, of all turns: on a machine that others use too, the shortest is the steadier of the
two. The difference of the RMS says that both ended in the same minimum. As in most programs that
calibrate, a picture has been in memory before: only then does the C library keep what arrays gave
back, instead of fetching each page anew (which would cost us 5 % at 20 views and 10 % at 50, and
OpenCV nothing).

``python -m benchmarks.calibration PYTHON…`` names Pythons in which mrcal or pycolmap (Ceres) is
installed; without names, this one and the system's are asked. They only refine, from the start
that our closed form gives, so our refinement alone stands beside them.
"""

import json
import shutil
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from benchmarks.turns import all_in_turns
from cvnotes.base import Array, CalibrationWarning
from cvnotes.calibration import Calibration, calibrate, extrinsics, radial_distortion
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.refinement import Problem, State, minimise
from cvnotes.calibration.starts import Search
from cvnotes.camera import Camera, Lens, intrinsics
from cvnotes.homography import dlt
from cvnotes.pictures import good_views
from cvnotes.targets import Chessboard

BOARD = Chessboard((9, 6), 25.0)
CAMERA = Camera(intrinsics(800, 804, 325, 238), lens=Lens(k=(-0.25, 0.10), p=(0.001, -0.0005)))
VIEWS = (3, 5, 10, 20, 50, 100, 200, 500, 1000)
CONVERGED = (cv2.TERM_CRITERIA_COUNT, 8, 0.0)
PEERS = {"mrcal": "mrcal_refinement.py", "pycolmap": "ceres_refinement.py"}


def corners(n: int) -> Array:
    """Return the corners (n, 54, 2) of n views, with noise, exact in OpenCV's float32."""
    rng = np.random.default_rng(n)
    poses = good_views(BOARD, CAMERA, n, rng=rng)
    m = np.array([CAMERA.moved(G).project(BOARD.points) for G in poses])
    m += rng.normal(0, 0.3, m.shape)
    return m.astype(np.float32).astype(float)


def ours(m: Array) -> Calibration:
    return calibrate(BOARD.points, m, CAMERA.size, lens="k1 k2 p1 p2")


def ours_with_error_bars(m: Array) -> Array:
    return ours(m).pose_covariance


def opencv(function: Callable[..., Any], m: Array) -> Callable[..., Any]:
    """Return OpenCV's function of the same corners, converted beforehand."""
    W, views = BOARD.points.astype(np.float32), list(m.astype(np.float32))

    def run(**options: Any) -> Any:
        flags = cv2.CALIB_FIX_K3
        return function([W] * len(m), views, CAMERA.size, None, None, flags=flags, **options)

    return run


def row(n: int, times: dict[str, Array], rest: str) -> None:
    """Print median/shortest of each way in milliseconds, and how many times ours is faster."""
    own, *others = times.values()
    words = f"{n:6}{_pair(1e3 * np.median(own), 1e3 * own.min())}"
    for other in others:
        words += f"{_pair(1e3 * np.median(other), 1e3 * other.min())}"
        words += f"{_pair(np.median(other) / np.median(own), other.min() / own.min())}"
    print(words + rest)


def _pair(a: Any, b: Any) -> str:
    return f"{a:9.1f}/{b:<8.1f}"


def again(way: Callable[[], Any], rounds: int) -> Callable[[], Any]:
    """Do the same thing several times."""
    return lambda: [way() for _ in range(rounds)]


def timed(n: int, ways: dict[str, Callable[[], Any]]) -> dict[str, Array]:
    """Time each way to calibrate from n views, in seconds a calibration."""
    rounds = max(1, 100 // n)
    repeated = {name: again(way, rounds) for name, way in ways.items()}
    repeats = max(3, min(15, 1000 // n))
    times = all_in_turns(repeated, repeats, time.process_time)
    return {name: spent / rounds for name, spent in times.items()}


def compare(n: int) -> None:
    """Time one number of views."""
    m = corners(n)
    theirs = opencv(cv2.calibrateCamera, m)
    ways = {
        "ours": lambda: ours(m),
        "OpenCV": theirs,
        "OpenCV, converged": lambda: theirs(criteria=CONVERGED),
    }
    row(n, timed(n, ways), f"{ours(m).rms - theirs()[0]:+11.0e} px")


def compare_error_bars(n: int) -> None:
    """Time one number of views, with the error bars of every pose too."""
    m = corners(n)
    ways = {
        "ours": lambda: ours_with_error_bars(m),
        "OpenCV": opencv(cv2.calibrateCameraExtended, m),
    }
    row(n, timed(n, ways), "")


def crumpled_corners(n: int) -> Array:
    """Return the corners of n views of a board whose corners are out of place by 0.3 mm."""
    rng = np.random.default_rng(n)
    W = BOARD.points + rng.normal(0, 0.3, BOARD.points.shape)
    poses = good_views(BOARD, CAMERA, n, rng=rng)
    m = np.array([CAMERA.moved(G).project(W) for G in poses])
    m += rng.normal(0, 0.1, m.shape)
    return m.astype(np.float32).astype(float)


def compare_free_boards(n: int) -> None:
    """Time the camera and every corner of the board together, against calibrateCameraRO."""
    m = crumpled_corners(n)
    W, views = BOARD.points.astype(np.float32), list(m.astype(np.float32))
    function: Any = cv2.calibrateCameraRO  # (whose stubs know of no first guess that is none)
    held = BOARD.corners[0] - 1  # the second of the corners that hold the board

    def ours_free() -> Calibration:
        return calibrate(BOARD.points, m, CAMERA.size, lens="k1 k2 p1 p2", board="free")

    def theirs(**options: Any) -> Any:
        return function(
            [W] * n, views, CAMERA.size, held, None, None, flags=cv2.CALIB_FIX_K3, **options
        )

    times = all_in_turns({"ours": ours_free, "OpenCV": theirs}, repeats=3)
    row(n, times, f"{ours_free().rms - theirs()[0]:+11.0e} px")


def pythons_with_peers(candidates: list[str]) -> dict[str, str]:
    """Find for each peer a Python that can import it."""
    found: dict[str, str] = {}
    for peer in PEERS:
        for python in candidates:
            asked = subprocess.run([python, "-c", f"import {peer}"], capture_output=True)
            if asked.returncode == 0:
                found.setdefault(peer, python)
    return found


def first_start(problem: Problem) -> State:
    """Return the state that the first four steps of `calibrate` lead to, from all views."""
    search = Search(problem)
    start = next(start for start in search.starts() if start.search is search)
    H = start.homographies(dlt)
    A = start.intrinsics(None, H)
    G = start.extrinsics(extrinsics, A, H)
    return start.state(A, G, start.distortion(radial_distortion, A, G))


def start_of(m: Array) -> tuple[Problem, State, dict[str, Any]]:
    """Return the problem, our closed form's start, and the same start in the peers' terms."""
    data = Correspondences.of(BOARD.points, m)
    problem = Problem.of(data, CAMERA.size, "k1 k2 p1 p2", skew=False)
    start = first_start(problem)
    camera = problem.camera_of(start.shared)
    A, lens = camera.A, camera.lens
    G = data.pose_in_given_units(start.R, start.T)
    frames = [np.append(cv2.Rodrigues(g[:3, :3])[0], g[:3, 3]) for g in G]
    columns, rows = BOARD.corners
    return (
        problem,
        start,
        {
            "m": m.reshape(-1, rows, columns, 2),
            "W": BOARD.points[:, :2].reshape(rows, columns, 2),
            "spacing": BOARD.square,
            "size": np.array(CAMERA.size),
            "intrinsics": np.array([A[0, 0], A[1, 1], A[0, 2], A[1, 2], *lens.k, *lens.p]),
            "frames": np.array(frames),
        },
    )


def compare_refinements(n: int, pythons: dict[str, str]) -> None:
    """Time the refinement alone, all from the same start."""
    problem, start, given = start_of(corners(n))
    repeats = max(5, min(50, 1000 // n))
    own = all_in_turns({"ours": lambda: minimise(problem, start)}, repeats)["ours"]
    rms = np.sqrt(minimise(problem, start).cost / problem.n_seen)
    words = f"{n:6}{_pair(1e3 * np.median(own), 1e3 * own.min())}"
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "start.npz"
        np.savez(file, repeats=repeats, **given)
        for peer, python in pythons.items():
            worker = Path(__file__).parent / "peers" / PEERS[peer]
            run = subprocess.run([python, worker, file], capture_output=True, text=True, check=True)
            answer = json.loads(run.stdout)
            spent = np.array(answer["seconds"])
            words += f"{_pair(1e3 * np.median(spent), 1e3 * spent.min())}"
            words += f"{answer['rms'] - rms:+9.0e} px"
    print(words)


def main() -> None:
    warnings.simplefilter("ignore", CalibrationWarning)
    np.ones((3000, 4000), np.uint8).sum()  # a picture, which is gone again
    print(f"Calibration from corners [ms], median/shortest (OpenCV {cv2.__version__})")
    print(
        f"{'views':>6}{'cvnotes':>13}{'calibrateCamera':>20}{'faster':>15}"
        f"{'stopped at 8':>19}{'faster':>16}{'RMS difference':>22}"
    )
    for n in VIEWS:
        compare(n)
    print("\nWith the error bars of every parameter and pose, against calibrateCameraExtended [ms]")
    for n in (20, 200):
        compare_error_bars(n)
    print("\nWith every corner of the board, against calibrateCameraRO [ms], and RMS differences")
    for n in (10, 20):
        compare_free_boards(n)
    system = shutil.which("python3", path="/usr/bin") or sys.executable
    pythons = pythons_with_peers(sys.argv[1:] or [sys.executable, system])
    print("\nThe refinement alone, from the same start [ms], and RMS differences:")
    print(f"{'views':>6}{'cvnotes':>13}" + "".join(f"{peer:>19}{'':12}" for peer in pythons))
    for n in VIEWS:
        compare_refinements(n, pythons)


if __name__ == "__main__":
    main()
