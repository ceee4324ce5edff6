"""Lines and planes of projective space: what passes through what, at infinity too (notes 2b.1).

A line of P² is a vector (3,), a plane of P³ a vector (4,); a point x lies on it if their product
is 0. So points and lines (or planes) change roles freely: what joins two points also meets two
lines. A line of P³ is a skew matrix (4, 4) (Plücker). Everything is defined up to a factor.
"""

from cvnotes.incidence.plane import LINE_AT_INFINITY, cross_ratio, join, lies_on, map_lines, meet
from cvnotes.incidence.space import (
    PLANE_AT_INFINITY,
    dual,
    join_point,
    line_of_planes,
    line_through,
    meet_plane,
    plane_through,
    point_of_planes,
)

__all__ = [
    "LINE_AT_INFINITY",
    "PLANE_AT_INFINITY",
    "cross_ratio",
    "dual",
    "join",
    "join_point",
    "lies_on",
    "line_of_planes",
    "line_through",
    "map_lines",
    "meet",
    "meet_plane",
    "plane_through",
    "point_of_planes",
]
