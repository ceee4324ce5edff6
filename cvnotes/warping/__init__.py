"""Chapter 8: pictures bent without holes (notes 2b.5)."""

from cvnotes.warping.interpolation import bilinear, interpolate
from cvnotes.warping.maps import homography_map, plane_map, rotation_map, zoom_map
from cvnotes.warping.pixel_map import PixelMap, compose, map_array
from cvnotes.warping.undistortion import undistort_image, undistortion_map
from cvnotes.warping.warp import backward_warp, forward_warp, rectify_plane

__all__ = [
    "interpolate",
    "bilinear",
    "forward_warp",
    "backward_warp",
    "PixelMap",
    "compose",
    "map_array",
    "homography_map",
    "rotation_map",
    "zoom_map",
    "plane_map",
    "rectify_plane",
    "undistortion_map",
    "undistort_image",
]
