"""Chapter 5: what is photographed, and its corners found in the photograph (notes 2b.4)."""

from cvnotes.targets.charuco import CharucoBoard
from cvnotes.targets.chessboard import Chessboard
from cvnotes.targets.finding import find_corners
from cvnotes.targets.harris_corners import harris, local_maxima
from cvnotes.targets.planes import ThreePlanes, TwoPlanes
from cvnotes.targets.sheet import PAPERS
from cvnotes.targets.subpixel import refine_edges, refine_subpixel

__all__ = [
    "Chessboard",
    "CharucoBoard",
    "TwoPlanes",
    "ThreePlanes",
    "PAPERS",
    "find_corners",
    "harris",
    "local_maxima",
    "refine_subpixel",
    "refine_edges",
]
