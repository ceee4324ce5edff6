"""Vanishing points and horizons found in a picture, and the camera they give away (notes 2b.1).

All pixels here are ideal ones: take the lens out first (``camera.lens``, `cvnotes.warp`), since a
bent line has no vanishing point. Vanishing points are homogeneous (3,), for they may lie at
infinity; `cvnotes.projective.from_homogeneous` drops them to pixels.
"""

from cvnotes.vanishing.finding import horizon, horizon_from_vanishing_points, vanishing_point
from cvnotes.vanishing.giving_away import (
    focal_length,
    intrinsics_from_vanishing_points,
    normal_from_horizon,
    rotation_from_vanishing_points,
)

__all__ = [
    "focal_length",
    "horizon",
    "horizon_from_vanishing_points",
    "intrinsics_from_vanishing_points",
    "normal_from_horizon",
    "rotation_from_vanishing_points",
    "vanishing_point",
]
