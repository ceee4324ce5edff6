"""`cvnotes calibrate` as a whole against scripts with OpenCV's finders: processor and wall time.

Run ``python -m benchmarks.command``. Each way is a process of its own that reads photographs,
finds the board and calibrates; cvnotes also refines the corners further, judges the result, and
draws and writes its pictures. The scripts draw nothing. The sets are twenty rendered photographs
and, where they lie beside the project, real ones (``../shared/data``).
"""

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import cv2
import numpy as np

from cvnotes.camera import Camera, Lens, intrinsics
from cvnotes.pictures import good_views, render
from cvnotes.targets import Chessboard

SHARED = Path(__file__).resolve().parents[2] / "shared" / "data"
REAL = {
    "left": ("left_right", "left*.jpg", (9, 6)),
    "right": ("left_right", "right*.jpg", (9, 6)),
    "wide": ("wide", "*.jpg", (8, 6)),
    "fisheye": ("fisheye", "*.jpg", (6, 4)),
    "sony": ("sony", "*.jpg", (6, 4)),
    "depth": ("depth", "*.png", (9, 6)),
}
SCRIPT = """
import sys
import cv2, numpy as np
finder, columns, rows, *files = sys.argv[1:]
count = int(columns), int(rows)
board = np.float32([(30 * x, 30 * y, 0) for y in range(count[1]) for x in range(count[0])])
stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 30, 1e-3)
W, m = [], []
for file in files:
    grey = cv2.imread(file, cv2.IMREAD_GRAYSCALE)
    if finder == "SB":
        found, corners = cv2.findChessboardCornersSB(grey, count)
    else:
        found, corners = cv2.findChessboardCorners(grey, count)
        if found:
            start = np.ascontiguousarray(corners, np.float32)
            corners = cv2.cornerSubPix(grey, start, (11, 11), (-1, -1), stop)
    if found:
        W.append(board)
        m.append(np.asarray(corners, np.float32).reshape(-1, 1, 2))
cv2.calibrateCamera(W, m, grey.shape[::-1], None, None)
"""


def rendered(folder: Path) -> list[Path]:
    """Photograph the course's board twenty times."""
    board, rng = Chessboard((9, 6), 30.0), np.random.default_rng(0)
    camera = Camera(intrinsics(800, 804, 325, 238), lens=Lens(k=(-0.25, 0.1)), size=(640, 480))
    files = []
    for i, G in enumerate(good_views(board, camera, 20, rng=rng)):
        files.append(folder / f"{i:02}.png")
        cv2.imwrite(str(files[-1]), render(board, camera.moved(G), blur=0.7, noise=2, rng=rng))
    return files


def cost(arguments: list[str], compiled: Path, repeats: int = 3) -> tuple[float, float]:
    """Return the processor time and the wall time of a process, in seconds: the least of some.

    Modules are `compiled` by the first, as those of an installed package are.
    """
    environment = {**os.environ, "PYTHONPYCACHEPREFIX": str(compiled)}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    spent = []
    for _ in range(repeats):
        before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        done = subprocess.run(
            [sys.executable, *arguments], capture_output=True, check=False, env=environment
        )
        wall = time.perf_counter() - began
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if done.returncode not in (0, 3):  # 3: done, but not reliable
            raise RuntimeError(done.stderr.decode())
        user, system = after.ru_utime - before.ru_utime, after.ru_stime - before.ru_stime
        spent.append((user + system, wall))
    return min(cpu for cpu, _ in spent), min(wall for _, wall in spent)


def compare(name: str, files: list[Path], count: tuple[int, int], folder: Path) -> None:
    """Print what each way costs on one set."""
    paths, (columns, rows) = [str(file) for file in files], count
    board = ["--corners", f"{columns}x{rows}", "--square", "30", "--out", str(folder / name)]
    ours = cost(["-m", "cvnotes", "calibrate", *paths, *board], folder / "compiled")
    classic, sb = (
        cost(["-c", SCRIPT, finder, str(columns), str(rows), *paths], folder / "compiled")
        for finder in ("classic", "SB")
    )
    row = "".join(f"{cpu:9.2f}{wall:7.2f}" for cpu, wall in (ours, classic, sb))
    print(f"{name:10}{len(files):5}{row}{ours[0] / classic[0]:9.1f}{ours[0] / sb[0]:7.2f}")


def main() -> None:
    print(f"The whole command, seconds of processor and wall (OpenCV {cv2.__version__})")
    print(f"{'':15}{'cvnotes':>16}{'classic':>16}{'SB':>16}{'ratio of processor to':>25}")
    print(
        f"{'set':10}{'n':>5}{'cpu':>9}{'wall':>7}"
        + 2 * f"{'cpu':>9}{'wall':>7}"
        + "  classic     SB"
    )
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        compare("rendered", rendered(folder), (9, 6), folder)
        for name, (where, pattern, count) in REAL.items():
            if files := sorted((SHARED / where).glob(pattern)):
                compare(name, files, count, folder)


if __name__ == "__main__":
    main()
