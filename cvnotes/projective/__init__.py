"""Chapter 1: points, lines and planes of projective space, at infinity too (notes 2b.1)."""

from cvnotes.projective.lines import cross_ratio, join, meet
from cvnotes.projective.points import (
    apply,
    direction_to_homogeneous,
    from_homogeneous,
    same_up_to_scale,
    to_homogeneous,
)
from cvnotes.projective.space import PLANE_AT_INFINITY, line_through, meet_plane

__all__ = [
    "to_homogeneous",
    "direction_to_homogeneous",
    "from_homogeneous",
    "apply",
    "same_up_to_scale",
    "join",
    "meet",
    "cross_ratio",
    "PLANE_AT_INFINITY",
    "line_through",
    "meet_plane",
]
