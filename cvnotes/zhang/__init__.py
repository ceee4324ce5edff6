"""Zhang's closed form: from homographies to A, the poses and the lens (notes 2b.4).

Each view's H = λ A [r1 r2 T] puts two linear constraints on B = A⁻ᵀ A⁻¹, because r1 and r2 are
orthonormal. With B known, A, then each pose, then the lens follow. Stacks of H are (..., 3, 3).
"""

from cvnotes.zhang.b import constraints, solve_b, v_ij
from cvnotes.zhang.distortion import radial_distortion
from cvnotes.zhang.intrinsics import (
    focal_lengths_from_homographies,
    focal_lengths_from_v,
    intrinsics_from_b,
    intrinsics_from_b_by_formulas,
    intrinsics_from_homographies,
)
from cvnotes.zhang.poses import extrinsics

__all__ = [
    "constraints",
    "extrinsics",
    "focal_lengths_from_homographies",
    "focal_lengths_from_v",
    "intrinsics_from_b",
    "intrinsics_from_b_by_formulas",
    "intrinsics_from_homographies",
    "radial_distortion",
    "solve_b",
    "v_ij",
]
