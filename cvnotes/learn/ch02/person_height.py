"""The height of a person, in a picture of which the camera is not known."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import rotation_from_angles
from cvnotes.learn.cases.cameras import rounded, some_factors, some_intrinsics
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def person_height(horizon: Array, v: Array, post: Array, h: float, person: Array) -> float:
    """Give the height of the person; post and person are foot and top, (2, 2) each."""
    foot, top = np.stack([post, person], axis=1)  # the feet, and the tops
    length = np.linalg.norm(top - foot, axis=1)  # how long both are seen
    off = np.linalg.norm(v[:2] - v[2] * top, axis=1)  # how far v is from the tops
    below = abs(foot @ horizon[:2] + horizon[2])  # how far the feet are from the horizon
    z = length / (off * below)  # the heights, up to a factor
    return float(h * z[1] / z[0])


def _streets(rng: np.random.Generator) -> list[Case]:
    up = np.array([0.0, 1, 0])  # in camera coordinates, and of any sign
    # to a level camera uprights are parallel; the second person is as far away as the post
    sky, post = np.array([0.0, 1, -200]), np.array([[100.0, 400], [100, 100]])
    people = np.array([[[300.0, 300], [300, 210]], [[250, 400], [250, 250]]])
    cases = [Case((sky, up, post, 3.0, person), about="level") for person in people]
    for _ in range(2):
        turned = rotation_from_angles(*rng.uniform([0.1, -0.4, 0.05], [0.4, 0.4, 0.3]))
        AR = some_intrinsics(rng, skew=True) @ turned
        eye = rng.uniform(1.2, 2.5)  # the height of the camera
        feet = rng.uniform([[-2, eye, 4], [0.5, eye, 7]], [[-0.5, eye, 6], [2, eye, 12]])
        h = rounded(rng.uniform([2.2, 1.3], [3.5, 2.0]))
        m_h = np.stack([feet, feet - h[:, None] * up], axis=1) @ AR.T
        m = rounded(m_h[..., :2] / m_h[..., 2:], 9)
        k = some_factors(rng, 2)
        cases.append(Case((k[0] * np.linalg.inv(AR).T @ up, k[1] * AR @ up, m[0], h[0], m[1])))
    return cases


def _carried(e: Array, post: Array, h: float, person: Array) -> float:
    """Return h by the line through e and the post's top, without the cross-ratio."""
    foot, top = np.column_stack([person, [1, 1]])
    q = np.cross(np.cross([*post[1], 1], e), np.cross(foot, top))
    return float(
        h * np.linalg.norm(person[1] - person[0]) / np.linalg.norm(q[:2] / q[2] - foot[:2])
    )


_Z = "length / (off * below)"
_MISTAKES = mistakes_in(person_height,
    ("lengths in the picture", "You compared lengths in pixels: what is farther away is seen "
     "shorter. Which line says how far away a foot is?",
     (_Z, "length")),
    ("a camera held level", "Right for a camera that is held level. If it is not, uprights are "
     "seen shorter towards v, and the cross-ratio with v says by how much.",
     (_Z, "length / below"), ("v[2] * top", "v[2] * foot"),
     "_carried( np.cross(np.cross([*post[0], 1], [*person[0], 1]), horizon), post, h, person)"),
    ("v divided", "Right where uprights meet in a pixel. To a level camera they are parallel, and "
     "v is at infinity: nothing may be divided by its last number.",
     ("v[:2] - v[2] * top", "v[:2] / v[2] - top")),
    ("carried over in parallel", "You carried the post's top over along a parallel to the line of "
     "the feet. Parallels of the world meet in the picture, these on the horizon.",
     "_carried( np.array([*person[0] - post[0], 0]), post, h, person)"),
    ("the tops and the horizon", "You measured from the tops to the horizon. Which of the two, "
     "foot or top, says how far away somebody stands?",
     ("abs(foot @", "abs(top @")),
)  # fmt: skip


EXERCISE = Exercise(
    name="person_height",
    chapter=2,
    title="A height in a single picture",
    task="A post of height h and a person stand upright on level ground. Give the person's height. "
    "Of the picture are known: the ground's horizon (3,), the vanishing point v (3,) of uprights, "
    "each homogeneous and of any scale, and the pixels of foot and top, in this order, of post and "
    "person, (2, 2) each. Held level, the camera sees v at infinity.",
    hints=(
        "Carry the post's top over to the person, as in the chapter, and compare by the "
        "cross-ratio with v. Keep all points homogeneous: e and v may be at infinity.",
        "Or without carrying: for all uprights on this ground, the cross-ratio of foot, top, v "
        "and the point on the horizon gives the height in heights of the camera.",
        "That is |top − foot| / (|v[:2] − v[2] top| · |l · foot|), foot lifted, times a number "
        "that is the same for post and person.",
    ),
    cases=_streets,
    properties=(
        Property("The person's height is the post's, by the cross-ratio."),
        Property("That is so if v is at infinity, too.", about="level"),
    ),
    misconceptions=_MISTAKES,
    steps=person_height,
    concepts=("7", "13"),
)
