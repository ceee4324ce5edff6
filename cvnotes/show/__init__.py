"""Figures and the page: what draws, and what shows the drawing with a text beside it."""

from cvnotes.show.figures import draw_corners, draw_image, draw_points
from cvnotes.show.picture import Picture, show
from cvnotes.show.quality import (
    draw_coverage,
    draw_residual_scatter,
    draw_residuals,
    draw_view_rms,
)
from cvnotes.show.style import panels

__all__ = [
    "Picture",
    "draw_corners",
    "draw_coverage",
    "draw_image",
    "draw_points",
    "draw_residual_scatter",
    "draw_residuals",
    "draw_view_rms",
    "panels",
    "show",
]
