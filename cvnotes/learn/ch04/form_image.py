"""The four steps of image formation."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, Lens, px_from_xy
from cvnotes.learn.cases.cameras import photographed, some_lens
from cvnotes.tutor import Case, Exercise, Property, mistakes_in
from cvnotes.tutor.checker.equality import close_to


def _photographs(rng: np.random.Generator) -> list[Case]:
    tidy, *others = ((A, R, T, some_lens(rng)[0], W) for A, R, T, W in photographed(rng))
    return [Case((*tidy[:3], np.array([-0.2, 0.1]), tidy[4])), *map(Case, others)]


def form_image(A: Array, R: Array, T: Array, k: Array, W: Array) -> Array:
    """Return the pixels (n, 2) of world points W (n, 3)."""
    M = W @ R.T + T  # the points in the camera's frame
    xy = M[:, :2] / M[:, 2:]  # the ideal points, in the plane z = 1
    r2 = (xy**2).sum(axis=1, keepdims=True)  # r²
    L = 1 + k[0] * r2 + k[1] * r2**2  # the radial factor L
    bent = L * xy  # the points as the lens bends them
    return bent @ A[:2, :2].T + A[:2, 2]


MISTAKES = mistakes_in(form_image,
    ("lens before the division",
     "You distorted before dividing by z: r is then in millimetres. The lens acts on x/z and y/z.",
     ("(xy**2)", "(M[:, :2]**2)")),
    ("lens after the pixels",
     "You distorted the pixels themselves, about pixel (0, 0). The lens acts before the sensor.",
     ("M[:, :2] /", "(M @ A.T)[:, :2] /", "bent @ A[:2, :2].T + A[:2, 2]", "bent")),
    ("radius in pixels", "You distorted about (u0, v0), which is right, but with r in pixels. k1 "
     "and k2 belong to the r of the plane z = 1.",
     ("(xy**2)", "((xy @ A[:2, :2].T)**2)")),
    ("the way back", "You undid the lens, as a correction does. Image formation distorts.",
     ("L * xy", "xy / L"), ("L * xy", "Lens(tuple(k)).undistort(xy)")),
    ("T taken for the camera's position", "You used R and T as if they said where the camera "
     "stands; they lead from the world to the camera.",
     ("+ T", "- R @ T"), ("R.T + T", "R - R.T @ T")),
    ("T with the wrong sign or in the wrong place",
     "Which way does T lead? It is added after the rotation, in the camera's frame.",
     ("+ T", "- T"), ("+ T", "+ R @ T")),
    ("pose left out",
     "You took W as if it were given in the camera's frame; R and T take it there.",
     ("W @ R.T + T", "W")),
    ("no division",
     "The division by the depth is missing, or comes too late: the lens acts on ideal points.",
     (" / M[:, 2:]", ""), (" / M[:, 2:]", "", "L * xy", "xy")),
    ("divided by the distance",
     "You divided by the distance; depth is the z of the camera's frame.",
     ("M[:, 2:]", "np.linalg.norm(M, axis=1, keepdims=True)")),
    ("another radius",
     "That is not the radius of the lens: it takes r² of the ideal point, on the plane z = 1.",
     ("r2 + k[1] * r2**2", "np.sqrt(r2) + k[1] * r2"), ("(xy**2)", "(W[:, :2]**2)"),
     ("(xy**2)", "((M / M[:, 2:])**2)")),
    ("lens twice", "You applied the lens twice.",
     ("bent = L * xy",
      "bent = L * xy; r2 = (bent**2).sum(axis=1, keepdims=True); "
      "bent = bent * (1 + k[0] * r2 + k[1] * r2**2)")),
)  # fmt: skip


EXERCISE = Exercise(
    name="form_image",
    chapter=4,
    title="The four steps of image formation",
    task="Give the pixels (n, 2) of world points W (n, 3), through a lens with k = (k1, k2), for a "
    "camera with A, R and T. All points are in front of it.",
    hints=(
        "Four steps, in this order: into the camera's frame, divide by z, lens, sensor.",
        "The lens acts on x/z and y/z, before there are pixels.",
        "The last step is A (x', y', 1)ᵀ: u = α_u x' + u0, v = α_v y' + v0.",
    ),
    cases=_photographs,
    properties=(Property("Every point is where the four steps, in their order, put it."),),
    misconceptions=MISTAKES,
    same=close_to(2e-7),  # a ten-thousandth of a pixel
    steps=form_image,
    concepts=("34", "35", "E13", "E16"),
    sources=(Camera.project, Lens.distort, px_from_xy),
)
