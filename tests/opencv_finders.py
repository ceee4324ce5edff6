"""OpenCV's finders of boards, which ours is held against, the same in every version.

Since version 5 they give (n, 2), before it (n, 1, 2). They raise for pictures that are too small.
"""

import cv2
import numpy as np


def find_classic(grey, corners):
    """Look for a board with `cv2.findChessboardCorners`; corners (n, 2) in its order, or None."""
    flags = cv2.CALIB_CB_ADAPTIVE_THRESH | cv2.CALIB_CB_NORMALIZE_IMAGE
    return _found(cv2.findChessboardCorners, grey, corners, flags)


def find_sb(grey, corners):
    """Look for a board with `cv2.findChessboardCornersSB`; corners (n, 2) in its order, or None."""
    # Without NORMALIZE_IMAGE, boards with narrow outer squares are missed.
    return _found(cv2.findChessboardCornersSB, grey, corners, cv2.CALIB_CB_NORMALIZE_IMAGE)


def _found(finder, grey, corners, flags):
    try:
        found, m = finder(np.ascontiguousarray(grey), corners, flags=flags)
    except cv2.error:
        return None
    m = np.asarray(m, dtype=np.float64).reshape(-1, 2) if found else np.empty((0, 2))
    return m if len(m) == corners[0] * corners[1] else None
