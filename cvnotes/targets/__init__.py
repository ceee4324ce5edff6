"""What is photographed: calibration targets as points in a frame of their own (notes 2b.4).

Every target is made of chessboards: ``faces`` gives each board with its pose in the target's
frame, ``points`` all inner corners, face after face and each in its board's own order.
"""

from cvnotes.targets.chessboard import Chessboard, Faces
from cvnotes.targets.planes import ThreePlanes, TwoPlanes

__all__ = ["Chessboard", "Faces", "ThreePlanes", "TwoPlanes"]
