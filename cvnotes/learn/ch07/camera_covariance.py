"""What the views know of the camera, once their poses have taken their share."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _views(rng: np.random.Generator) -> list[Case]:
    by_camera = np.array([[[1.0], [1], [0]], [[0.0], [1], [2]]])
    by_pose = np.array([[[1.0], [0], [0]], [[1.0], [1], [1]]])
    n, m, c, p = 4, 9, 3, 2
    return [
        Case((by_camera, by_pose)),
        Case((rounded(rng.normal(size=(n, m, c)), 1), rounded(rng.normal(size=(n, m, p)), 1))),
    ]


def camera_covariance(Jc: Array, Jp: Array) -> Array:
    """Return (c, c) from Jc (n, m, c) and Jp (n, m, p)."""
    CC = Jc.mT @ Jc  # what each view knows of the camera
    CP = Jc.mT @ Jp  # the mixed block of each view
    PP = np.linalg.inv(Jp.mT @ Jp)  # the inverse of each pose's own block
    share = CP @ PP @ CP.mT  # what each pose takes
    S = (CC - share).sum(axis=0)  # the sum over all views of what is left
    return np.linalg.inv(S)


_MISTAKES = mistakes_in(camera_covariance,
    ("poses held fixed", "That is the covariance if every pose were given, which is too small. "
     "Who else takes a share of what is seen?",
     "np.linalg.inv(CC.sum(0))"),
    ("inverted view by view", "You inverted each view's share and added the inverses. "
     "Information adds up, not covariance.",
     "np.linalg.inv(CC - share).sum(0)", "np.linalg.inv(CC - share).mean(0)",
     "np.linalg.inv(CC - share).mean(0) / len(Jc)"),
    ("one pose for all", "You stacked all views over one pose. Each view has a pose of its own, "
     "and its derivatives stand in columns of their own.",
     "np.linalg.inv((J := np.hstack([np.vstack(Jc), np.vstack(Jp)])).T @ J)[: len(S), : len(S)]"),
)  # fmt: skip

EXERCISE = Exercise(
    name="camera_covariance",
    chapter=7,
    title="What is known of the camera when every pose is unknown too",
    task="Each of n views has m residuals. Jc (n, m, c) are their derivatives by the camera's c "
    "unknowns, which all views share, and Jp (n, m, p) those by the p unknowns of the view's own "
    "pose. Give the covariance (c, c) of the camera's unknowns for noise of variance 1: the "
    "camera's corner of (JᵀJ)⁻¹, however many views there are.",
    hints=(
        "JᵀJ is an arrow: the views meet in the camera's c × c corner only.",
        "Eliminate a view's pose within its own block: NᵀN = JcᵀJc − JcᵀJp (JpᵀJp)⁻¹ JpᵀJc is left "
        "(N is Jc less its part in the span of Jp).",
        "Add what is left over all views, S += …, and invert the sum once.",
    ),
    cases=_views,
    properties=(
        Property(
            "A covariance is symmetric, and no unknown has a variance below 0.",
            lambda X, _: np.allclose(X, X.T, rtol=1e-5) and bool((np.diag(X) > 0).all()),
        ),
        Property("It is the camera's corner of the inverse of the whole JᵀJ."),
    ),
    misconceptions=_MISTAKES,
    steps=camera_covariance,
    concepts=("r",),
)
