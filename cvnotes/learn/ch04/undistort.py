"""Back through the lens."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import lens_factor, rounded, some_lens
from cvnotes.tutor import Case, Exercise, Property, mistakes_in
from cvnotes.tutor.checker.equality import close_to


def _observed_points(rng: np.random.Generator) -> list[Case]:
    k, _ = some_lens(rng)
    k_hand = np.array([-0.2, 0.05])
    cases = [(np.array([[0.5, 0.0], [0.3, 0.4]]), k_hand), (rng.uniform(-0.5, 0.5, (6, 2)), k)]
    # Near its fold, at r = 0.913 and r' = 0.609, dividing by L needs a hundred rounds.
    cases.append((np.array([[0.51, 0.68], [-0.75, 0.4]]), np.array([-0.4, 0.0])))
    strong = np.array([-0.35, 0.1])
    cases.append((np.array([[0.5, 0.5], [-0.4, 0.5], [0.3, -0.5], [-0.5, -0.3]]), strong))
    on_axis = (np.array([[0.0, 0.0], [0.3, -0.2]]), k_hand)
    return [
        *(Case((rounded(xy * lens_factor(xy, c), 4), c)) for xy, c in cases),
        Case((rounded(on_axis[0] * lens_factor(*on_axis), 4), k_hand), about="on the axis"),
    ]


def _nearly_there(xy: Array, case: Case) -> bool:
    """Return whether points are on the right rays, and near to where they belong."""
    right = case.right
    across = xy[:, 0] * right[:, 1] - xy[:, 1] * right[:, 0]
    off = np.linalg.norm(xy - right, axis=1)
    return bool(
        (np.abs(across) <= 1e-12).all()
        and off.max() < 0.03
        and not np.allclose(lens_factor(xy, case.args[1]) * xy, xy)
    )


def undistort(xy_lens: Array, k: Array) -> Array:
    """Return the ideal points (n, 2) seen at xy_lens (n, 2), to 1e-8."""
    k1, k2 = k
    s = np.linalg.norm(xy_lens, axis=1, keepdims=True)  # the radius at which each point is seen
    r = s  # the first guess of the ideal radius
    for _ in range(15):
        r = r - (r + k1 * r**3 + k2 * r**5 - s) / (1 + 3 * k1 * r**2 + 5 * k2 * r**4)  # the radius
    L = 1 + k1 * r**2 + k2 * r**4  # the radial factor L at the ideal radius
    return xy_lens / L


_L = "(1 + k1 * r**2 + k2 * r**4)"
_NEWTON = "r - (r + k1 * r**3 + k2 * r**5 - s) / (1 + 3 * k1 * r**2 + 5 * k2 * r**4)"


def _rounds(n: int, step: str) -> tuple[str, ...]:
    """Return the changes that make n rounds, r ← step, and return the points with that r."""
    by_r = "xy_lens * np.divide(r, s, out=np.ones_like(s), where=s > 0)"
    return _NEWTON, step, "range(15)", f"range({n})", by_r


_MISTAKES = mistakes_in(undistort,
    ("nothing on the axis", "Right, except for the point on the axis, where you divided 0 by 0: "
     "divide by L there too, and not by r.",
     "np.where(s > 0, xy_lens / L, np.nan)"),
    ("divided once", "You divided by L at the radius that was seen. L is a function of the ideal "
     "radius, which you now know better.",
     _rounds(1, f"s / {_L}")),
    ("distorted once more", "You distorted the points a second time: that leads on, not back.",
     _rounds(1, f"s * {_L}")),
    ("signs of k changed", "A lens with −k1 and −k2 undoes the distortion only roughly: the "
     "inverse of a polynomial is no such polynomial.",
     ("= k\n", "= -k\n", *_rounds(1, f"s * {_L}"))),
    ("divided what was divided already", "Each round divides xy_lens, what was seen, by L at the "
     "better radius. You divided the last result again, which goes on for ever.",
     *(("    L =", f"    for _ in range({n}): xy_lens = xy_lens / lens_factor(xy_lens, k)\n    L =",
        "xy_lens") for n in (2, 5, 10, 20, 30, 50, 100))),
    ("multiplied in each round",
     "In each round you multiplied, or subtracted, where a division belongs.",
     *(_rounds(n, f"s * {_L}") for n in (2, 5, 10, 20, 30, 50, 100))),
    ("r for r²", "Which powers of r does L have? You have others.",
     _rounds(100, "s / (1 + k1 * r + k2 * r**2)"), ("= k\n", "= k.sum(), 0\n")),
    ("a few rounds", "Your way is right but stops too early: some rounds leave an error that is "
     "larger than 1e-8. Go on until nothing changes.",
     *(_rounds(n, f"s / {_L}") for n in (2, 3, 4, 5, 7, 20)),
     *(_rounds(n, f"s - r * ({_L} - 1)") for n in (2, 3, 5, 10)),
     *(_rounds(n, _NEWTON) for n in (1, 2, 3, 4)), {"seen": _nearly_there}),
)  # fmt: skip


EXERCISE = Exercise(
    name="undistort",
    chapter=4,
    title="Back through the lens",
    task="Give the ideal points (n, 2) that a lens with k = (k1, k2), and no tangential terms, "
    "shows at xy_lens (n, 2). There is no closed form: iterate until nothing changes any more.",
    hints=(
        "You want xy with L(r) xy = xy_lens, where r is the radius of the xy you want.",
        "If you knew r you could divide. Guess xy = xy_lens, divide, and use the better guess.",
        "Repeat until the change is below 1e-10, near a fold a hundred times. Or use Newton's "
        "method: r ← r − (r L(r) − r') / (1 + 3 k1 r² + 5 k2 r⁴), from r = r'; then xy = xy_lens "
        "/ L(r).",
    ),
    cases=_observed_points,
    properties=(
        Property(
            "The lens takes your points to where they were seen.",
            lambda xy, c: np.allclose(
                xy * lens_factor(xy, c.args[1]), c.args[0], rtol=0, atol=1e-8 * c.slack
            ),
        ),
        Property("Of all points with this property they are the nearest to the axis."),
        Property("The point on the axis stays where it is.", about="on the axis"),
    ),
    misconceptions=_MISTAKES,
    steps=undistort,
    same=close_to(1e-8),
    concepts=("29", "34", "69", "E13"),
)
