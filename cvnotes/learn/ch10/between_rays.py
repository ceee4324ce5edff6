"""The point between two rays."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _two_rays(rng: np.random.Generator) -> list[Case]:
    C1, C2 = np.round(
        rng.uniform([[-60, -60, -40], [160, -60, -40]], [[60, 60, 40], [260, 60, 40]]), 1
    )
    W = rng.uniform([-300, -300, 700], [300, 300, 1500])
    miss = rng.uniform(4, 20, 3)
    d1, d2 = (
        rounded((W - C1) / rng.uniform(300, 600)),
        rounded((W + miss - C2) / rng.uniform(700, 900)),
    )
    meeting = (
        np.zeros(3),
        np.array([1.0, 0.0, 2.0]),
        np.array([4.0, 0, 0]),
        np.array([-1.0, 0, 2.0]),
    )
    passing = (
        np.zeros(3),
        np.array([0.0, 0.0, 3.0]),
        np.array([4.0, 2, 0]),
        np.array([-2.0, 0, 1.0]),
    )
    return [Case(passing), Case((C1, d1, C2, d2)), Case(meeting, about="meeting")]


def between_rays(C1: Array, d1: Array, C2: Array, d2: Array) -> Array:
    """Return the point (3,) midway between two rays, where they pass nearest."""
    b = C2 - C1  # from centre to centre
    n = np.cross(d1, d2)  # perpendicular to both rays
    s = np.cross(b, d2) @ n / (n @ n)  # how many d1 along the first ray
    t = np.cross(b, d1) @ n / (n @ n)  # how many d2 along the second ray
    P1 = C1 + s * d1  # the foot on the first ray
    P2 = C2 + t * d2  # the foot on the second ray
    return (P1 + P2) / 2


def _off_ray(W: Array, C: Array, d: Array) -> float:
    return float(np.linalg.norm(np.cross(W - C, d)) / np.linalg.norm(d))


def _as_near(W: Array, case: Case) -> bool:
    C1, d1, C2, d2 = case.args
    one, two = _off_ray(W, C1, d1), _off_ray(W, C2, d2)
    return bool(abs(one - two) < 1e-5 * case.slack * np.linalg.norm(C2 - C1))


def _on_both(W: Array, case: Case) -> bool:
    C1, d1, C2, d2 = case.args
    off = max(_off_ray(W, C1, d1), _off_ray(W, C2, d2))
    return bool(off < 1e-5 * case.slack * np.linalg.norm(C2 - C1))


_MISTAKES = mistakes_in(between_rays,
    ("on one ray", "That point lies on one of the rays; asked is the one midway between both.",
     "P1", "P2"),
    ("from one foot to the other", "That is the way between the two feet, not a place.",
     "P2 - P1", "P1 - P2", "(P2 - P1) / 2"),
    ("centres left out", "You went along the rays, but from the origin: each begins at its centre.",
     "(s * d1 + t * d2) / 2", ("P1 = C1 + s * d1", "P1 = s * d1"),
     ("P2 = C2 + t * d2", "P2 = t * d2")),
    ("as far along both", "You went as many steps along the one ray as along the other; each has a "
     "number of its own.",
     ("t * d2", "s * d2"), ("s * d1", "t * d1")),
    ("ends of the directions", "d1 and d2 are directions of any length, not places.",
     "(d1 + d2) / 2", "(C1 + d1 + C2 + d2) / 2"),
    ("between the centres", "That is the middle between the two centres.",
     "(C1 + C2) / 2"),
    ("special directions", "Your formula holds for directions of length 1 that are perpendicular; "
     "these have any length and angle.",
     ("np.cross(b, d2) @ n / (n @ n)", "np.cross(b, d2) @ n",
      "np.cross(b, d1) @ n / (n @ n)", "np.cross(b, d1) @ n")),
)  # fmt: skip


EXERCISE = Exercise(
    name="between_rays",
    chapter=10,
    title="The point between two rays",
    task="Two measured rays pass each other. Give the point (3,) midway between them where they "
    "are nearest. They begin at C1 and C2 and run along d1 and d2, of any length, shape (3,) each; "
    "they are not parallel.",
    hints=(
        "The points of the rays are C1 + s d1 and C2 + t d2: two numbers are unknown.",
        "Where they are nearest, the way from one to the other is as short as it can be: that is "
        "least squares for s and t.",
        "np.linalg.lstsq solves s d1 − t d2 = C2 − C1, three equations. Then take the middle.",
    ),
    cases=_two_rays,
    properties=(
        Property("Rays that meet give the point where they meet.", _on_both, about="meeting"),
        Property("The point is as far from one ray as from the other.", _as_near),
        Property("It is midway where the two rays are nearest."),
    ),
    misconceptions=_MISTAKES,
    steps=between_rays,
    concepts=("70", "j"),
)
