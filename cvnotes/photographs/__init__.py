"""Chapter 9: from photographs of a board to a camera that one can rely on, all steps in one."""

from cvnotes.photographs.choosing import Model, NoCamera
from cvnotes.photographs.detection import Detection, Photographs, detect
from cvnotes.photographs.driver import (
    CalibratedPhotographs,
    calibrate_detected,
    calibrate_photographs,
    detect_photographs,
)
from cvnotes.photographs.pairs import CalibratedPairs, calibrate_pairs
from cvnotes.photographs.reasons import Exchanged, LeftOut, Misfit, NoBoard

__all__ = [
    "calibrate_photographs",
    "CalibratedPhotographs",
    "detect_photographs",
    "detect",
    "Detection",
    "Photographs",
    "calibrate_detected",
    "Model",
    "calibrate_pairs",
    "CalibratedPairs",
    "NoBoard",
    "LeftOut",
    "Misfit",
    "Exchanged",
    "NoCamera",
]
