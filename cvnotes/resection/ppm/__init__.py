"""The 3×4 PPM from one picture of a target that is not flat (notes 2b.4, "Calibration Targets").

k m̃ = P W̃ is linear in the twelve entries of P, of which eleven are independent. `decompose`
then takes P apart into the sensor A and the pose R, T.
"""

from cvnotes.resection.ppm.geometric import refine_ppm, resect
from cvnotes.resection.ppm.given import normaliser
from cvnotes.resection.ppm.linear import ppm_design_matrix, ppm_dlt

__all__ = ["normaliser", "ppm_design_matrix", "ppm_dlt", "refine_ppm", "resect"]
