"""Corners to a fraction of a pixel: bias and spread of every method against the truth.

Run ``python -m benchmarks.corners``. Twenty views of the course's board are rendered by
`cvnotes.pictures.render`, which knows where the corners are; all methods see the same pictures in
the same run. Those that refine start from the truth, up to half a pixel away either way. The last
column is the time per board of 54 corners: refining alone, or, for the finders, finding.

The bound is the Cramér–Rao bound of the two-edge model for the noise of the picture, its 8-bit
rounding included. Without noise the model's own misfit counts, not the bound.
"""

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field

import cv2
import numpy as np

from cvnotes.base import Array, CornersNotFound
from cvnotes.camera import Camera, Lens, intrinsics
from cvnotes.pictures import clutter, good_views, render
from cvnotes.pictures.exposure import Image
from cvnotes.targets import Chessboard, find_corners, refine_edges, refine_subpixel
from cvnotes.targets.subpixel import fit_edges

BOARD = Chessboard((9, 6), 25.0)
CAMERA = Camera(intrinsics(800, 804, 325, 238), lens=Lens(k=(-0.25, 0.10)), size=(640, 480))
VIEWS = 20
CONDITIONS = ((0.0, 0.0), (0.7, 0.0), (0.7, 5.0))  # blur in px, noise in grey levels
ROUNDING = 1 / 12  # variance of rounding to whole grey levels

Method = Callable[[Image, Array], Array | None]


@dataclass
class Score:
    """What a method did to all pictures: its errors (n, 54, 2), and seconds per board."""

    errors: list[Array] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)

    def row(self) -> str:
        """Put the score into words of a table."""
        if not self.errors:
            return f"{'–':>8}{'–':>8}{'–':>9}{'–':>8}{0:>8}"
        errors = np.concatenate(self.errors)
        bias_u, bias_v = errors.mean(0)
        rms, worst = np.sqrt(np.mean(errors**2)), np.abs(errors).max()
        time_ms = 1e3 * float(np.median(self.seconds))
        return (
            f"{bias_u:+8.4f}{bias_v:+8.4f}{rms:9.4f}{worst:8.3f}{len(self.errors):>6}{time_ms:9.2f}"
        )


def corner_sub_pix(window: int) -> Method:
    criteria = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 50, 1e-4)

    def method(image: Image, start: Array) -> Array:
        m = np.ascontiguousarray(start, dtype=np.float32)
        found = cv2.cornerSubPix(image, m, (window, window), (-1, -1), criteria)
        return np.asarray(found, np.float64).reshape(-1, 2)

    return method


def finder(flags: int) -> Method:
    def method(image: Image, start: Array) -> Array | None:
        found, m = cv2.findChessboardCornersSB(image, BOARD.corners, flags=flags)
        if not found:
            return None
        m = np.asarray(m, np.float64).reshape(-1, 2)
        nearest = np.linalg.norm(start[:, None] - m, axis=-1).argmin(1)  # whatever their order
        return np.asarray(m[nearest])

    return method


METHODS: dict[str, Method] = {
    "cv2.cornerSubPix, window 5": corner_sub_pix(5),
    "cv2.cornerSubPix, window 11": corner_sub_pix(11),
    "cv2 SB": finder(0),
    "cv2 SB, exhaustive + accuracy": finder(cv2.CALIB_CB_EXHAUSTIVE | cv2.CALIB_CB_ACCURACY),
    "refine_subpixel, window 5": lambda image, start: refine_subpixel(image, start),
    "refine_edges": lambda image, start: refine_edges(image, start, grid=BOARD.corners),
}


def measure(blur: float, noise: float) -> tuple[dict[str, Score], float]:
    """Let all methods loose on all views; also give the bound on their RMS error."""
    rng = np.random.default_rng(0)
    shots, variances = [], []
    for G in good_views(BOARD, CAMERA, VIEWS, rng=np.random.default_rng(0)):
        shot = CAMERA.moved(G)
        image, m = render(BOARD, shot, blur=blur, noise=noise, rng=rng), shot.project(BOARD.points)
        shots.append((image, m, m + rng.uniform(-0.5, 0.5, m.shape)))
        covariance = fit_edges(image, m, grid=BOARD.corners).covariance
        variances.append((noise**2 + ROUNDING) * np.diagonal(covariance, axis1=1, axis2=2))
    # One method after the other: OpenCV's threads wait busily for a while after their work.
    scores = {name: score(method, shots) for name, method in METHODS.items()}
    return scores, float(np.sqrt(np.mean(variances)))


def score(method: Method, shots: list[tuple[Image, Array, Array]]) -> Score:
    result = Score()
    for image, m, start in shots:
        began = time.perf_counter()
        found = method(image, start)
        result.seconds.append(time.perf_counter() - began)
        if found is not None:
            result.errors.append(found - m)
    return result


def in_the_dark(noise: float) -> str:
    """Say in how many dark pictures each finder sees the board: a contrast of 29 grey levels."""
    found, rng = (
        {"ours": 0, "ours, partly": 0, "cv2 SB": 0, "cv2 classic": 0},
        np.random.default_rng(1),
    )
    for G in good_views(BOARD, CAMERA, VIEWS, rng=np.random.default_rng(0)):
        image = render(BOARD, CAMERA.moved(G), blur=0.7, gain=0.15, noise=noise, rng=rng)
        for name, partial in (("ours", False), ("ours, partly", True)):
            with suppress(CornersNotFound):
                find_corners(image, BOARD, partial=partial)
                found[name] += 1
        found["cv2 SB"] += cv2.findChessboardCornersSB(image, BOARD.corners)[0]
        found["cv2 classic"] += cv2.findChessboardCorners(image, BOARD.corners)[0]
    return ", ".join(f"{name} {n}" for name, n in found.items())


def in_nothing() -> tuple[int, int]:
    """Count the boards that are found in noise and clutter, and the trials."""
    found = trials = 0
    for seed in range(8):
        rng = np.random.default_rng(seed)
        shapes = clutter((640, 480), rng=rng).astype(float)
        for gain, noise in ((0.0, 30.0), (1.0, 0.0), (0.3, 16.0), (0.15, 16.0)):
            image = (100 * (gain == 0) + gain * shapes + rng.normal(0, noise, shapes.shape)).clip(
                0, 255
            )
            for corners in ((9, 6), (6, 5), (4, 3)):
                trials += 1
                with suppress(CornersNotFound):
                    find_corners(image.astype(np.uint8), Chessboard(corners, 25.0), partial=True)
                    found += 1
    return found, trials


def main() -> None:
    print(f"Corners of a 9×6 board in {VIEWS} pictures of 640×480 (OpenCV {cv2.__version__})")
    for blur, noise in CONDITIONS:
        print(f"\nblur {blur} px, noise {noise} grey levels")
        print(f"{'':30}{'bias u, v [px]':>16}{'RMS':>9}{'worst':>8}{'views':>6}{'ms':>9}")
        scores, bound = measure(blur, noise)
        for name, score in scores.items():
            print(f"{name:30}{score.row()}")
        ours = np.sqrt(np.mean(np.square(scores["refine_edges"].errors)))
        theirs = np.sqrt(np.mean(np.square(scores["cv2.cornerSubPix, window 5"].errors)))
        print(f"{'Cramér–Rao bound':30}{'':16}{bound:9.4f}", end="")
        print(f"   refine_edges: {ours / bound:.2f} × bound, {theirs / ours:.1f}× cornerSubPix")
    for noise in (4.0, 8.0, 16.0):
        print(f"\nin the dark, noise {noise}: of {VIEWS} boards {in_the_dark(noise)}")
    print("boards found where there are none: {} of {}".format(*in_nothing()))


if __name__ == "__main__":
    main()
