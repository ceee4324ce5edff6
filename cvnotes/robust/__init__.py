"""Homographies in spite of wrong correspondences: RANSAC (notes 2b.5, erratum E39).

Least squares resists noise, not outliers: one wrong pair pulls the whole map. RANSAC draws four
pairs at a time, maps by them alone, and keeps the map that most other pairs agree with.
"""

from cvnotes.robust.chance import trials_needed
from cvnotes.robust.ransac import Mask, ransac_homography

__all__ = ["Mask", "ransac_homography", "trials_needed"]
