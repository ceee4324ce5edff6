"""What the views know of the camera, once their poses have taken their share."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.tutor.checker.exercise import Case, Exercise, Property, Rng, mistakes


def camera_covariance(Jc: Array, Jp: Array) -> Array:
    """Return the covariance (c, c) of what all views share, for noise of variance 1.

    Jc (n, m, c) and Jp (n, m, p): derivatives of the m residuals of each of n views, by the
    shared unknowns and by those of the view's own pose.
    """
    S = np.zeros((Jc.shape[2], Jc.shape[2]))
    for C, P in zip(Jc, Jp, strict=True):
        S += C.T @ C - C.T @ P @ np.linalg.inv(P.T @ P) @ P.T @ C
    return np.asarray(np.linalg.inv(S))


def _views(rng: Rng) -> list[Case]:
    by_camera = np.array([[[1.0], [1], [0]], [[0.0], [1], [2]]])
    by_pose = np.array([[[1.0], [0], [0]], [[1.0], [1], [1]]])
    n, m, c, p = 4, 9, 3, 2
    return [
        Case((by_camera, by_pose)),
        Case((rounded(rng.normal(size=(n, m, c)), 1), rounded(rng.normal(size=(n, m, p)), 1))),
    ]


def _information(Jc: Array, Jp: Array) -> Array:
    """Return the Schur complement of each view, (n, c, c)."""
    own = np.linalg.inv(Jp.mT @ Jp)
    return np.asarray(Jc.mT @ Jc - Jc.mT @ Jp @ own @ Jp.mT @ Jc)


def _whole(Jc: Array, Jp: Array) -> Array:
    """Return the inverse of JᵀJ of all unknowns, camera first."""
    n, m, c = Jc.shape
    p = Jp.shape[2]
    J = np.zeros((n * m, c + n * p))
    for i in range(n):
        rows = slice(i * m, (i + 1) * m)
        J[rows, :c], J[rows, c + i * p : c + (i + 1) * p] = Jc[i], Jp[i]
    return np.asarray(np.linalg.inv(J.T @ J))


def _one_pose(Jc: Array, Jp: Array) -> Array:
    """Take all views for one view with one pose."""
    J = np.concatenate([np.concatenate(Jc), np.concatenate(Jp)], axis=1)
    return np.asarray(np.linalg.inv(J.T @ J)[: Jc.shape[2], : Jc.shape[2]])


def _steps(Jc: Array, Jp: Array) -> Any:
    CC = Jc.mT @ Jc  # what each view knows of the camera
    CP = Jc.mT @ Jp  # the mixed block of each view
    PP = np.linalg.inv(Jp.mT @ Jp)  # the inverse of each pose's own block
    share = CP @ PP @ CP.mT  # what each pose takes
    S = (CC - share).sum(axis=0)  # the sum over all views of what is left
    return np.linalg.inv(S)


_MISTAKES = mistakes(
    ("poses held fixed", "That is the covariance if every pose were given, which is too small. "
     "Who else takes a share of what is seen?",
     lambda Jc, Jp: np.linalg.inv((Jc.mT @ Jc).sum(0))),
    ("inverted view by view", "You inverted each view's share and added the inverses. "
     "Information adds up, not covariance.",
     lambda Jc, Jp: np.linalg.inv(_information(Jc, Jp)).sum(0),
     lambda Jc, Jp: np.linalg.inv(_information(Jc, Jp)).mean(0),
     lambda Jc, Jp: np.linalg.inv(_information(Jc, Jp)).mean(0) / len(Jc)),
    ("one pose for all", "You stacked all views over one pose. Each view has a pose of its own, "
     "and its derivatives stand in columns of their own.",
     _one_pose),
    ("standard deviations", "These are standard deviations; asked is the whole covariance, (c, "
     "c).",
     lambda Jc, Jp: np.sqrt(np.diag(camera_covariance(Jc, Jp)))),
    ("the first view alone", "That is what the first view knows; there are n of them.",
     lambda Jc, Jp: np.linalg.inv(_information(Jc, Jp)[0])),
    ("all unknowns", "That is the covariance of the poses, too; asked is the camera's corner, c "
     "× c.",
     _whole),
)  # fmt: skip

CAMERA_COVARIANCE = Exercise(
    name="camera_covariance",
    chapter=7,
    title="What is known of the camera when every pose is unknown too",
    task="Each of n views has m residuals. Jc (n, m, c) are their derivatives by the camera's c "
    "unknowns, which all views share, and Jp (n, m, p) those by the p unknowns of the view's own "
    "pose. Give the covariance (c, c) of the camera's unknowns for noise of variance 1: the "
    "camera's corner of (JᵀJ)⁻¹, however many views there are.",
    stub='''def my_camera_covariance(Jc, Jp):
    """Return (c, c) from Jc (n, m, c) and Jp (n, m, p)."""
    ...''',
    hints=(
        "JᵀJ is an arrow: the views meet in the camera's c × c corner only.",
        "Eliminate a view's pose within its own block: JcᵀJc − JcᵀJp (JpᵀJp)⁻¹ JpᵀJc is left.",
        "Add what is left over all views, S += …, and invert the sum once.",
    ),
    cases=_views,
    properties=(
        Property(
            "A covariance is symmetric, and no unknown has a variance below 0.",
            lambda X, c: np.allclose(X, X.T, rtol=1e-5) and bool((np.diag(X) > 0).all()),
        ),
        Property("It is the camera's corner of the inverse of the whole JᵀJ."),
    ),
    misconceptions=_MISTAKES,
    reference=camera_covariance,
    steps=_steps,
    concepts=("r",),
)
