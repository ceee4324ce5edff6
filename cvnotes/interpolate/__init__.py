"""The picture between its pixels: nearest neighbour and bilinear (notes 2b.5).

Pixel centres are integers, so the picture covers [−½, width − ½] × [−½, height − ½]; what a
position beyond the outermost centres shows is the border's business.
"""

from cvnotes.interpolate.guards import Image, checked_fill, checked_image, positions
from cvnotes.interpolate.sampler import Border, Method, Sampler, bilinear, interpolate

__all__ = [
    "Border",
    "Image",
    "Method",
    "Sampler",
    "bilinear",
    "checked_fill",
    "checked_image",
    "interpolate",
    "positions",
]
