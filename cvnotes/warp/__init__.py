"""Image warping: maps from pixels to pixels, and the two ways to move a picture (notes 2b.5).

A map is a function (u, v) ↦ (f_u, f_v). Forward, it says where a pixel of the source goes;
backward, where a pixel of the target comes from.
"""

from cvnotes.warp.lens_maps import distortion_map, undistort_image, undistortion_map
from cvnotes.warp.maps import homography_map, plane_map, rotation_map, zoom_map
from cvnotes.warp.moving import ForwardWarp, backward_warp, forward_warp, rectify_plane
from cvnotes.warp.pixel_map import Mapping, PixelMap, compose, map_array

__all__ = [
    "ForwardWarp",
    "Mapping",
    "PixelMap",
    "backward_warp",
    "compose",
    "distortion_map",
    "forward_warp",
    "homography_map",
    "map_array",
    "plane_map",
    "rectify_plane",
    "rotation_map",
    "undistort_image",
    "undistortion_map",
    "zoom_map",
]
