"""Maximum likelihood: refine A, the lens and all poses together (notes 2b.4).

Minimises Σ ‖m_ij − m̂(A, k, R_i, T_i, w_j)‖². Each view's residuals depend on the shared
parameters and on that view's own pose only, so the normal matrix has the shape of an arrow: one
6×6 block per view and one border for what is shared. The poses are eliminated block by block
(Schur complement), the small system that is left is solved, and the poses follow from it: the
cost grows linearly with the number of views.
"""

from cvnotes.refine.arrow import Arrow, covariance, pose_covariance, solve_arrow
from cvnotes.refine.minimum import minimise, move, poses_follow
from cvnotes.refine.problem import Problem, State

__all__ = [
    "Arrow",
    "Problem",
    "State",
    "covariance",
    "minimise",
    "move",
    "pose_covariance",
    "poses_follow",
    "solve_arrow",
]
