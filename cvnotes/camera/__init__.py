"""The camera: the perspective projection matrix and what it is made of (notes 2b.1-2b.3)."""

from cvnotes.camera.factors import centre_of, decompose
from cvnotes.camera.model import Camera
from cvnotes.camera.sensor import (
    intrinsics,
    intrinsics_from_pixel_size,
    pixels,
    px_from_xy,
    xy_from_px,
)

__all__ = [
    "Camera",
    "centre_of",
    "decompose",
    "intrinsics",
    "intrinsics_from_pixel_size",
    "pixels",
    "px_from_xy",
    "xy_from_px",
]
