"""A ruler along a line that runs away from us."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def measure_along(t: Array, m: Array, q: Array) -> Array:
    """Return (n,): metres along the line of what is seen at q (n, 2)."""
    d = m[2] - m[0]  # the direction of the line in the picture
    s = (m - m[0]) @ d  # where the known points are along it
    x = (q - m[0]) @ d  # where the others are along it
    r = (s[2] - s[0]) * (x - s[1]) / ((s[2] - s[1]) * (x - s[0]))  # the cross-ratios
    p = r * (t[2] - t[1]) / (t[2] - t[0])  # the distances from t[1], by those from t[0]
    return np.asarray((t[1] - p * t[0]) / (1 - p))


def _roads(rng: np.random.Generator) -> list[Case]:
    by_hand = np.array([[100.0, 300], [148, 264], [164, 252]])
    cases = [Case((np.array([0.0, 10, 20]), by_hand, np.array([[180.0, 240]])))]
    for about in ("", "upright"):
        start, end = rounded(rng.uniform([[60, 400], [330, 60]], [[240, 470], [580, 190]]), 1)
        end = np.where([about == "upright", False], start, end)  # the point where it vanishes
        t = rounded(rng.permutation(rng.uniform([8, 22, 38], [16, 30, 46])), 1)
        asked = rounded(rng.uniform([2, 17, 50], [6, 21, 60]), 1)
        far = rng.uniform(20, 40)
        m, q = (rounded(start + (end - start) * (x / (x + far))[:, None], 9) for x in (t, asked))
        cases.append(Case((t, m, q), about=about))
    return cases


_S, _X = "(m - m[0]) @ d", "(q - m[0]) @ d"
_MISTAKES = mistakes_in(measure_along,
    ("a ruler on the picture", "Equal lengths become shorter and shorter in the picture, and "
     "neither a straight line nor a parabola says how. What does a picture leave as it is?",
     "np.polyval(np.polyfit(m @ (m[2] - m[0]), t, 1), q @ (m[2] - m[0]))",
     "np.polyval(np.polyfit(m @ (m[2] - m[0]), t, 2), q @ (m[2] - m[0]))",
     "t[0] + (t[2] - t[0]) * ((q - m[0]) @ (m[2] - m[0])) / sum((m[2] - m[0])**2)",
     "np.interp(-q[:, 1], *np.sort([-m[:, 1], t], axis=1))"),
    ("lengths without a sign", "A length does not say on which side of a point another one lies: "
     "measure along one direction, with a sign.",
     (_S, "np.linalg.norm(m - m[0], axis=1)", _X, "np.linalg.norm(q - m[0], axis=1)")),
    ("one coordinate", "Right, unless the line is upright: then u is the same. Measure along it.",
     (_S, "m[:, 0]", _X, "q[:, 0]")),
)  # fmt: skip

EXERCISE = Exercise(
    name="measure_along",
    chapter=1,
    title="A ruler that runs away from us",
    task="Three points of a straight line of the world are t metres along it, shape (3,), and are "
    "seen at m, shape (3, 2); they come in any order. Give how many metres along it the points of "
    "this line are that are seen at q, shape (n, 2). Nothing is known of the camera, nor where the "
    "line vanishes.",
    hints=(
        "Three known points and one that is asked for have a cross-ratio: once in pixels, along "
        "the line in the picture, and once in metres. Both are the same number.",
        "Positions in pixels need a sign: s = (m − m[0]) · d, with d = m[2] − m[0], and the same "
        "for q.",
        "With p = (T − t1)/(T − t0), which is the cross-ratio times (t2 − t1)/(t2 − t0), "
        "T = (t1 − p t0)/(1 − p).",
    ),
    cases=_roads,
    properties=(
        Property("The cross-ratio in metres is the one in pixels."),
        Property("An upright line is measured as any other.", about="upright"),
    ),
    misconceptions=_MISTAKES,
    steps=measure_along,
    concepts=("9", "12"),
)
