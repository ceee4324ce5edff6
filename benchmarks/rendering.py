"""Rendering a board through a distorted lens: `render` against OpenCV's remap at 4× and area mean.

Run ``python -m benchmarks.rendering``. Both take the same picture, in turns, in one process. The
peer is given its undistorted rays (computed once, as with any fixed camera) and the fastest route
from there: `cv2.perspectiveTransform` to the board's texture, bilinear `cv2.remap`, and
`cv2.resize` with INTER_AREA. `render` keeps nothing from call to call.
"""

import time
from collections.abc import Callable
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.camera import Camera, Lens, intrinsics
from cvnotes.pictures import good_views, render
from cvnotes.pictures.exposure import Image
from cvnotes.targets import Chessboard

BOARD = Chessboard((9, 6), 25.0)
LENS = Lens(k=(-0.25, 0.10))
Rays = npt.NDArray[np.float32]
FINE = 4  # the peer's oversampling
TEXEL = 200  # texels per square
BEHIND, PAPER, INK = 110, 220, 30


def camera(scale: int) -> Camera:
    """Return the course's camera, with `scale` times as many pixels either way."""
    A = intrinsics(800 * scale, 804 * scale, 325 * scale, 238 * scale)
    return Camera(A, lens=LENS, size=(640 * scale, 480 * scale))


def texture() -> Image:
    """Draw the board with its margin of one square, TEXEL texels to the square."""
    columns, rows = BOARD.squares
    i, j = np.meshgrid(np.arange(columns + 2), np.arange(rows + 2))
    inner = (i > 0) & (i <= columns) & (j > 0) & (j <= rows)
    cells = np.where(inner & ((i + j) % 2 == 0), INK, PAPER).astype(np.uint8)
    return np.kron(cells, np.ones((TEXEL, TEXEL), np.uint8))


def texel_from_xy(G: Array) -> Array:
    """Return the homography (3, 3) from ideal image points to texels (centres are integers)."""
    scale, first = TEXEL / BOARD.square, 2 * TEXEL - 0.5
    texel_from_board = np.array([[scale, 0, first], [0, scale, first], [0, 0, 1]])
    return np.asarray(texel_from_board @ np.linalg.inv(G[:3, [0, 1, 3]]), np.float64)


def remap_at_4x(rays: Rays, sheet: Image, G: Array, size: tuple[int, int]) -> Image:
    """Take the picture the peer's way."""
    texels = cv2.perspectiveTransform(rays, texel_from_xy(G))
    none: Any = None  # both channels of the map are in one array
    fine = cv2.remap(
        sheet, texels, none, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=BEHIND
    )
    return np.asarray(cv2.resize(fine, size, interpolation=cv2.INTER_AREA), np.uint8)


def fine_rays(seen_by: Camera) -> Rays:
    """Return the ideal points at the centres of the peer's fine pixels."""
    u, v = ((np.arange(FINE * n) + 0.5) / FINE - 0.5 for n in seen_by.size)
    return seen_by.ideal(np.stack(np.meshgrid(u, v), axis=-1)).astype(np.float32)


def supersampled(shot: Camera, n: int = 32) -> Array:
    """Average n × n looks at the board in each pixel where its colour changes."""
    w, h = shot.size
    corners = shot.ideal(np.stack(np.meshgrid(np.arange(w + 1), np.arange(h + 1)), -1) - 0.5)
    seen = _grey(shot, corners)
    four = np.stack([seen[:-1, :-1], seen[:-1, 1:], seen[1:, :-1], seen[1:, 1:]])
    picture, (row, column) = four[0].copy(), np.nonzero(np.ptp(four, axis=0))
    t = (np.arange(n) + 0.5) / n
    weights = np.stack([1 - t, t])
    for k in np.array_split(np.arange(len(row)), len(row) // 200 + 1):
        box = corners[row[k, None, None] + [[0], [1]], column[k, None, None] + [[0, 1]]]
        xy = np.einsum("jr,is,pjic->prsc", weights, weights, box, optimize=True)
        picture[row[k], column[k]] = _grey(shot, xy).mean(axis=(1, 2))
    return np.asarray(picture, np.float64)


def _grey(shot: Camera, xy: Array) -> Array:
    """Look the board's grey level up at ideal points."""
    texel = np.linalg.inv(shot.G[:3, [0, 1, 3]])
    X, Y, w = np.moveaxis(xy @ texel[:, :2].T + texel[:, 2], -1, 0)
    i, j = np.floor(X / (w * BOARD.square)), np.floor(Y / (w * BOARD.square))
    columns, rows = BOARD.corners
    paper = (i >= -2) & (i <= columns) & (j >= -2) & (j <= rows)
    dark = (i >= -1) & (i < columns) & (j >= -1) & (j < rows) & ((i + j) % 2 == 0)
    return np.where(dark, float(INK), np.where(paper, float(PAPER), float(BEHIND)))


def corner_errors(image: Image, shot: Camera) -> Array:
    """Return found minus projected corners, by cornerSubPix started at the truth."""
    m = shot.project(BOARD.points)
    start = np.ascontiguousarray(m[:, None], dtype=np.float32)
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 100, 1e-5)
    return np.asarray(cv2.cornerSubPix(image, start, (5, 5), (-1, -1), stop)[:, 0] - m)


def compare(scale: int, poses: Array, repeats: int = 15) -> None:
    """Print what either way costs, and how far it is from the truth."""
    seen_by = camera(scale)
    rays, sheet, size = fine_rays(seen_by), texture(), seen_by.size
    shots = [seen_by.moved(G) for G in poses]
    ways: dict[str, Callable[[Camera], Image]] = {
        "remap at 4×, area mean": lambda shot: remap_at_4x(rays, sheet, shot.G, size),
        "render": lambda shot: render(BOARD, shot),
    }
    spent = {name: [0.0] * repeats for name in ways}
    for k in range(repeats):
        for name, way in ways.items():
            start = time.perf_counter()
            way(shots[k % len(shots)])
            spent[name][k] = time.perf_counter() - start
    slowest = float(np.median(spent["remap at 4×, area mean"]))
    references = [supersampled(shot) for shot in shots[:4]]
    for name, way in ways.items():
        images = [way(shot) for shot in shots]
        square = [np.mean((a - b) ** 2) for a, b in zip(images, references, strict=False)]
        found = np.concatenate([corner_errors(*pair) for pair in zip(images, shots, strict=True)])
        cost = float(np.median(spent[name]))
        print(
            f"{size[0]:5}×{size[1]:<5} {name:24} {1e3 * cost:7.1f} ms {slowest / cost:6.1f}×"
            f" {np.sqrt(np.mean(square)):9.3f} {found[:, 0].mean():+10.4f}"
            f" {found[:, 1].mean():+8.4f} {np.sqrt(np.mean(found**2)):8.4f}"
        )


def main() -> None:
    print(f"Rendering a 9×6 board, k1 = -0.25, k2 = 0.10 (OpenCV {cv2.__version__})")
    print(f"{'':37}{'time':>8}{'faster':>11}{'grey RMS':>10}{'bias u, v [px]':>20}{'RMS':>9}")
    poses = good_views(BOARD, camera(1), 20, rng=np.random.default_rng(0))
    for scale in (1, 2):
        compare(scale, poses)


if __name__ == "__main__":
    main()
