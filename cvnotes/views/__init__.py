"""Where to hold the target: sets of poses that calibrate a camera well, and sets that do not.

Every generator gives poses G (n, 4, 4), CRF ← target, in which all squares of the target lie inside
the picture and within the reach of the lens. As pictures all sets look reasonable, and all of them
calibrate with the same small residuals; they differ in what they tell about the camera.
"""

from cvnotes.views.good import good_views
from cvnotes.views.misleading import (
    centre_only_views,
    fronto_parallel_views,
    nearly_parallel_views,
    one_axis_views,
    pure_translation_views,
    repeated_views,
)

__all__ = [
    "centre_only_views",
    "fronto_parallel_views",
    "good_views",
    "nearly_parallel_views",
    "one_axis_views",
    "pure_translation_views",
    "repeated_views",
]
