"""Corners to a fraction of a pixel: the detector, and two ways to refine what it finds."""

from cvnotes.subpixel.edges import EdgeFit, fit_edges, refine_edges
from cvnotes.subpixel.gradient import refine_subpixel
from cvnotes.subpixel.harris import harris, local_maxima

__all__ = [
    "EdgeFit",
    "fit_edges",
    "harris",
    "local_maxima",
    "refine_edges",
    "refine_subpixel",
]
