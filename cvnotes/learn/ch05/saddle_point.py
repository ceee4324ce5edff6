"""The corner between the pixels."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def saddle_point(patch: Array) -> Array:
    """Return (u, v) of the saddle, shape (2,); NaN if there is none."""
    v, u = np.mgrid[: patch.shape[0], : patch.shape[1]].reshape(2, -1)  # the pixels' places
    D = np.stack([u**2, u * v, v**2, u, v, 1 + 0 * u], axis=1)  # the six terms at each pixel
    a, b, c, d, e, _ = np.linalg.solve(D.T @ D, D.T @ patch.ravel())  # the coefficients
    S = np.array([[2 * a, b], [b, 2 * c]])  # the second derivatives
    m = np.linalg.solve(S, [-d, -e])  # where both derivatives are 0
    return np.where(np.linalg.det(S) < 0, m, np.nan)


def _patches(rng: np.random.Generator) -> list[Case]:
    v, u = np.mgrid[:3, :4]
    cases = [Case((100.0 + u**2 + u * v - v**2 - 3 * u,))]
    for width, height, sign in ((7, 5, -1), (4, 6, -1), (5, 5, 1)):
        v, u = np.mgrid[:height, :width] - rng.uniform(1.2, 2.8, (2, 1, 1))
        p, q, mixed = rng.uniform([3, 2, 1], [6, 4, 3])
        grey = 120 + p * u**2 + mixed * u * v + sign * q * v**2 + rng.normal(0, 0.5, u.shape)
        cases.append(Case((rounded(grey, 1),), about="a hollow" * (sign > 0)))
    return cases


def _of_three(patch: Array) -> Array:
    """Return the level point by differences at the pixel in the middle, instead of by a fit."""
    i, j = np.array(patch.shape) // 2
    g = patch[i - 1 : i + 2, j - 1 : j + 2]
    a, c = (g[1, 0] + g[1, 2]) / 2 - g[1, 1], (g[0, 1] + g[2, 1]) / 2 - g[1, 1]
    b = (g[2, 2] + g[0, 0] - g[2, 0] - g[0, 2]) / 4
    S, slopes = [[2 * a, b], [b, 2 * c]], [g[1, 2] - g[1, 0], g[2, 1] - g[0, 1]]
    m = np.array([j, i]) - np.linalg.solve(S, slopes) / 2
    return np.where(np.linalg.det(S) < 0, m, np.nan)


_MISTAKES = mistakes_in(saddle_point,
    ("a hill is no saddle", "Hills and hollows have a level point, too. A saddle rises one way and "
     "falls another: which sign has the determinant of the second derivatives?",
     ("np.linalg.det(S) < 0", "True")),
    ("axes one by one", "You went along u and v one by one; the mixed term couples them.",
     ("np.linalg.solve(S, [-d, -e])", "-np.array([d, e]) / np.diag(S)")),
    ("counted from the middle", "You counted from the middle; the first pixel is (0, 0).",
     lambda patch: saddle_point(patch) - (np.array(patch.shape[::-1]) - 1) / 2,
     lambda patch: saddle_point(patch) - np.array(patch.shape[::-1]) // 2),
    ("the middle pixel's derivatives", "Differences at one pixel are as noisy as its few "
     "neighbours: fit the surface to all grey levels, by least squares.",
     _of_three),
)  # fmt: skip

EXERCISE = Exercise(
    name="saddle_point",
    chapter=5,
    title="The corner between the pixels",
    task="Around a chessboard corner the grey levels form a saddle. Fit "
    "a u² + b u v + c v² + d u + e v + f by least squares to all grey levels of a patch, shape "
    "(height, width), of which pixel (0, 0) is the first. Give the place (u, v), shape (2,), in "
    "which that surface is level, if it is a saddle there; else NaN twice.",
    hints=(
        "Each pixel gives one equation for (a, b, c, d, e, f): a row (u², u v, v², u, v, 1), and "
        "its grey level on the other side. np.linalg.lstsq.",
        "Level means that both derivatives are 0: 2 a u + b v + d = 0 and b u + 2 c v + e = 0.",
        "np.linalg.solve([[2a, b], [b, 2c]], [−d, −e]); it is a saddle if 4 a c − b² < 0.",
    ),
    cases=_patches,
    properties=(
        Property("The fitted surface is level there."),
        Property("A hollow, or a hill, is no saddle.", about="a hollow"),
    ),
    misconceptions=_MISTAKES,
    steps=saddle_point,
    concepts=("40", "E19"),
)
