"""Warping a grey picture of 1 Mpx by a homography, bilinear: `backward_warp` against its peers.

Run ``python -m benchmarks.warping``. All take turns in one process; every way evaluates the map
itself. scikit-image is shown where it is installed.

Then pictures are undistorted: `undistort_image`, which makes its map each time, against
`cv2.remap` with its maps made before, and `cv2.undistort`, which makes its maps too; and as it is
where OpenCV rounds positions. There the times are those of the processor, in all threads.
"""

import importlib.util
import time
from collections.abc import Callable
from functools import partial
from typing import Any
from unittest.mock import patch

import cv2
import numpy as np
from scipy.ndimage import map_coordinates

from benchmarks.turns import in_turns
from cvnotes.base import Array, Image
from cvnotes.camera import Camera, Lens, intrinsics
from cvnotes.warping import backward_warp, homography_map, undistort_image, undistortion

SIZE = (1000, 1000)
ANGLE = 0.1
H = np.array(
    [
        [np.cos(ANGLE), -np.sin(ANGLE), 60.0],
        [np.sin(ANGLE), np.cos(ANGLE), -20.0],
        [1e-4, 5e-5, 1.0],
    ]
)


def picture() -> Image:
    """Draw a fine pattern, so that a wrong position shows as a wrong grey value."""
    v, u = np.indices(SIZE[::-1])
    return np.asarray(128 + 70 * np.sin(u / 2.3) + 50 * np.cos(v / 1.7), dtype=np.uint8)


def positions() -> Array:
    """Ask the map for every pixel: (2, height, width)."""
    v, u = np.indices(SIZE[::-1])
    x, y, w = np.tensordot(H, np.stack([u, v, np.ones_like(u)]), axes=1)
    return np.stack([x / w, y / w])


def opencv(image: Image) -> Any:
    return cv2.warpPerspective(image, H, SIZE, flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP)


def opencv_alone(image: Image) -> Any:
    """Let OpenCV use one core, as NumPy does."""
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    warped = opencv(image)
    cv2.setNumThreads(threads)
    return warped


def scipy(image: Image) -> Any:
    values = map_coordinates(image.astype(float), positions()[::-1], order=1, mode="grid-constant")
    return np.floor(values + 0.5).astype(np.uint8)


def naive(image: Image) -> Any:
    """Interpolate the way a notebook does, in three lines (and two for the border)."""
    framed = np.pad(image.astype(float), 1)
    u, v = np.clip(positions(), -1, np.array([*SIZE])[:, None, None] - 1e-9) + 1
    j, i = u.astype(int), v.astype(int)
    I1, I2, I3, I4 = (framed[i + k, j + n] for k in (0, 1) for n in (0, 1))
    I_a, I_b = (I2 - I1) * (u - j) + I1, (I4 - I3) * (u - j) + I3
    return np.floor((I_b - I_a) * (v - i) + I_a + 0.5).astype(np.uint8)


def optional_peers() -> dict[str, Callable[[Image], Any]]:
    peers: dict[str, Callable[[Image], Any]] = {}
    if importlib.util.find_spec("skimage"):
        warp = importlib.import_module("skimage.transform").warp
        peers["skimage.transform.warp"] = lambda image: warp(image, H, order=1, preserve_range=True)
    return peers


def main() -> None:
    image, f = picture(), homography_map(H)
    peers: dict[str, Callable[[Image], Any]] = {
        "cv2.warpPerspective": opencv,
        "the same on one core": opencv_alone,
        "cvnotes.backward_warp": lambda image: backward_warp(image, f),
        **optional_peers(),
        "scipy map_coordinates": scipy,
        "three lines of NumPy": naive,
    }
    ways = {name: partial(way, image) for name, way in peers.items()}
    cost, exact = in_turns(ways), scipy(image).astype(float)
    inside = cv2.erode((exact > 0).astype(np.uint8), np.ones((5, 5))) > 0
    print(f"1 Mpx grey by a homography, bilinear (OpenCV {cv2.__version__})")
    print(f"{'':26}{'time':>10}{'cv2 = 1':>10}{'pixels off':>13}{'by up to':>10}")
    for name, way in ways.items():
        error = np.abs(way() - exact)[inside]
        ratio, wrong = cost[name] / cost["cv2.warpPerspective"], 100 * (error > 0.6).mean()
        print(f"{name:26}{1e3 * cost[name]:7.1f} ms{ratio:10.1f}{wrong:12.3f}%{error.max():10.1f}")
    undistorted()


def by_numpy(image: Any, camera: Camera) -> Image:
    """Undistort as with an OpenCV that rounds positions, or with none."""
    with patch.object(undistortion, "_opencv_is_exact", lambda: False):
        return undistort_image(image, camera)


def undistorted() -> None:
    """Print what a picture costs."""
    width, height = 1280, 960
    lens, rng = Lens((-0.25, 0.1), (0.001, -0.0005)), np.random.default_rng(0)
    camera = Camera(intrinsics(1000, 1005, 640, 480), lens=lens, size=(width, height))
    maps = cv2.initUndistortRectifyMap(
        camera.A, np.array([*lens.k, *lens.p]), None, camera.A, camera.size, cv2.CV_32FC1
    )
    print(f"\nA picture of {width}×{height} undistorted, processor")
    for name, channels in (("grey", ()), ("colour", (3,))):
        image = cv2.blur(rng.integers(0, 256, (height, width, *channels), np.uint8), (9, 9))
        ways: dict[str, Callable[[], Any]] = {
            "cv2.remap": partial(cv2.remap, image, *maps, cv2.INTER_LINEAR),
            "cv2.undistort": partial(cv2.undistort, image, camera.A, np.array([*lens.k, *lens.p])),
            "undistort_image": partial(undistort_image, image, camera),
            "by NumPy alone": partial(by_numpy, image, camera),
        }
        cost = in_turns(ways, clock=time.process_time)
        for way, seconds in cost.items():
            print(f"{name:8}{way:18}{1e3 * seconds:8.1f} ms{seconds / cost['cv2.remap']:8.1f}")


if __name__ == "__main__":
    main()
