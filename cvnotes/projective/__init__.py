"""Chapter 1: points, lines and planes of projective space, at infinity too (notes 2b.1)."""

from cvnotes.projective.lines import LINE_AT_INFINITY, cross_ratio, join, lies_on, map_lines, meet
from cvnotes.projective.points import (
    apply,
    direction_to_homogeneous,
    from_homogeneous,
    same_up_to_scale,
    to_homogeneous,
)
from cvnotes.projective.space import (
    PLANE_AT_INFINITY,
    dual,
    line_of_planes,
    line_through,
    meet_plane,
    plane_through,
)

__all__ = [
    "to_homogeneous",
    "direction_to_homogeneous",
    "from_homogeneous",
    "apply",
    "same_up_to_scale",
    "LINE_AT_INFINITY",
    "join",
    "meet",
    "lies_on",
    "map_lines",
    "cross_ratio",
    "PLANE_AT_INFINITY",
    "plane_through",
    "line_through",
    "line_of_planes",
    "dual",
    "meet_plane",
]
