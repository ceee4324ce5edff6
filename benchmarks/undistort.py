"""Undistorting points: `Camera.ideal` (`Lens.undistort`, from pixels) against OpenCV.

Run ``python -m benchmarks.undistort``. `cv2.undistortPoints` stops after five iterations; its
error says what that costs. Points fill the picture up to 90 % of the radius where the lens folds,
at most 0.8 of the focal length.
"""

from collections.abc import Callable
from typing import Any

import cv2
import numpy as np

from benchmarks.turns import in_turns
from cvnotes.base import Array
from cvnotes.camera import Camera, Lens, intrinsics

A = intrinsics(800, 805, 640, 480)
LENSES = (
    Lens(k=(-0.4,)),
    Lens(k=(-0.25, 0.1)),
    Lens(k=(-0.25, 0.1), p=(0.001, -0.0005)),
    Lens(k=(-0.3, 0.1, -0.02), p=(0.001, 0.001)),
)


def disc(radius: float, count: int) -> Array:
    """Spread points (count, 2) evenly over a disc."""
    rng = np.random.default_rng(0)
    r, angle = radius * np.sqrt(rng.uniform(0, 1, count)), rng.uniform(0, 2 * np.pi, count)
    return np.stack([r * np.cos(angle), r * np.sin(angle)], axis=-1)


def coefficients(lens: Lens) -> Array:
    """Return OpenCV's (k1, k2, p1, p2, k3)."""
    k1, k2, k3 = [*lens.k, 0.0, 0.0, 0.0][:3]
    return np.array([k1, k2, *lens.p, k3])


def compare(lens: Lens, count: int) -> None:
    """Print what both cost, and how far off they are in pixels."""
    camera, theirs = Camera(A, lens=lens), coefficients(lens)
    truth = disc(min(0.9 * lens.max_radius, 0.8), count)
    m = camera.project(np.concatenate([truth, np.ones((count, 1))], axis=1))
    rounds = max(1, 2000 // count)
    ways: dict[str, Callable[[], list[Any]]] = {
        "cvnotes": lambda: [camera.ideal(m) for _ in range(rounds)],
        "OpenCV": lambda: [cv2.undistortPoints(m[:, None], A, theirs) for _ in range(rounds)],
    }
    cost = in_turns(ways, repeats=25)
    error = {
        name: np.abs(np.reshape(way()[0], (-1, 2)) - truth).max() for name, way in ways.items()
    }
    micro = {name: 1e6 * seconds / rounds for name, seconds in cost.items()}
    kind = f"{len(lens.k)} radial" + (", 2 tangential" if any(lens.p) else "")
    print(
        f"{kind:24}{count:8}{micro['cvnotes']:10.0f} µs{micro['OpenCV']:10.0f} µs"
        f"{micro['cvnotes'] / micro['OpenCV']:9.2f}"
        f"{800 * error['cvnotes']:14.0e} px{800 * error['OpenCV']:9.0e} px"
    )


def main() -> None:
    print(f"Undistorting points (OpenCV {cv2.__version__}, five iterations)")
    print(f"{'lens':24}{'points':>8}{'ours':>13}{'OpenCV':>13}{'ratio':>9}{'error':>17}{'its':>12}")
    for count in (100_000, 1000, 54):
        for lens in LENSES:
            compare(lens, count)


if __name__ == "__main__":
    main()
