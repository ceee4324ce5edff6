"""The lens along a radius: the curve r L(r), where it folds, and its inverse (notes 2b.3).

A point at the ideal offset x from the distortion centre, r = ‖x‖, is seen at the offset

    d = (L(r) + 2 p·x) x + r² p,    L(r) = 1 + k1 r² + k2 r⁴ + …

The way back has no closed form, but tangential terms or not, only one number has to be searched:
q = ‖x‖/‖d‖ (see `Inverse`). Nothing here guards its input; `cvnotes.lens` does.
"""

from cvnotes.radial.fold import fold_radius
from cvnotes.radial.inverse import Inverse
from cvnotes.radial.polynomial import horner, radial_factor

__all__ = ["Inverse", "fold_radius", "horner", "radial_factor"]
