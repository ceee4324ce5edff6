"""Zhang's last step: all unknowns at once, downhill."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import rotation_from_vector
from cvnotes.learn.cases.cameras import board_grid, rounded
from cvnotes.tutor import Case, Exercise, Property, mistakes_in
from cvnotes.tutor.checker.equality import close_to


def misses(x: Array, W: Array, m: Array) -> Array:
    """Return where the corners were seen minus where x, or each row of x, predicts them."""
    poses = x[..., 3:].reshape(*x.shape[:-1], -1, 6)
    M = W @ rotation_from_vector(poses[..., :3]).mT + poses[..., None, 3:]
    seen = x[..., None, None, 1:3] + x[..., None, None, :1] * M[..., :2] / M[..., 2:]
    return np.asarray((m - seen).reshape(*x.shape[:-1], -1))


def derivatives(x: Array, W: Array, m: Array) -> Array:
    """Return J: the derivatives of the misses by each number of x, a column for each."""
    h = 1e-6 * (1 + abs(x))
    ahead, behind = misses(np.stack([x + np.diag(h), x - np.diag(h)]), W, m)
    return np.asarray((ahead - behind).T / (2 * h))


def levenberg_marquardt(x: Array, W: Array, m: Array) -> Array:
    """Give A (3, 3) at the minimum; x (3 + 6v,) is where to start."""
    mu, r = 1e-3, misses(x, W, m)  # the damping at the start, and the misses there
    for _ in range(14):
        J = derivatives(x, W, m)
        N = J.T @ J
        step = np.linalg.solve(N + mu * np.diag(np.diag(N)), J.T @ r)
        new = misses(x - step, W, m)
        downhill = new @ new < r @ r
        mu = mu / 10 if downhill else mu * 10
        x, r = (x - step, new) if downhill else (x, r)  # all unknowns at the minimum
    return np.array([[x[0], 0, x[1]], [0, x[0], x[2]], [0, 0, 1]])


def _boards(rng: np.random.Generator) -> list[Case]:
    W = np.column_stack([board_grid(3, 3, 60) - 60, np.zeros(9)])
    cases = []
    for noise in (0.0, 0.4):
        camera = rng.uniform([700, 290, 210], [900, 350, 270])
        turns = rng.uniform(0.5, 0.8, (2, 3)) * [[1, -1, 0.2], [-1, -1, -0.3]]
        poses = np.hstack([turns, rng.uniform([-40, -30, 500], [40, 30, 700], (2, 3))])
        x = np.concatenate([camera, poses.ravel()])
        m = (noise * rng.standard_normal(36) - misses(x, W, np.zeros((2, 9, 2)))).reshape(2, 9, 2)
        # it begins with boards that are too flat and too far away: Gauss and Newton leap from there
        start = x * [1.3, 1, 1, *2 * [0.3, 0.3, 0.3, 1, 1, 1.3]]
        about = "noisy" if noise else ""
        cases.append(Case((rounded(start), W, rounded(m, 2 if noise else 9)), about=about))
    return cases


def _leapt(A: Array, case: Case) -> bool:
    return not 0.3 < A[0, 0] / case.right[0, 0] < 3.0


_STEP = "np.linalg.solve(N + mu * np.diag(np.diag(N)), J.T @ r)"
_MISTAKES = mistakes_in(levenberg_marquardt,
    ("the start", "No step of yours leads downhill. Which sign has J, and which the step?",
     ("range(14)", "range(0)")),
    ("stopped too early", "Those are the first steps. Go on until nothing changes any more.",
     *(("range(14)", f"range({n})") for n in (5, 6, 7))),
    ("the camera alone", "You held the poses; all numbers come from the same corners.",
     (_STEP, "np.append(np.linalg.solve(N[:3, :3], (J.T @ r)[:3]), 0 * x[3:])")),
    ("every step taken", "You leapt far away: take a step only if the sum of squares becomes "
     "smaller, and try a shorter one if not.",
     (_STEP, "np.linalg.lstsq(J, r)[0]", "= new @ new < r @ r", "= True"), {"seen": _leapt}),
)  # fmt: skip

EXERCISE = Exercise(
    name="levenberg_marquardt",
    chapter=7,
    title="Your own Levenberg–Marquardt",
    task="A camera with square pixels and no lens saw a board's corners W (n, 3) at m (v, n, 2). "
    "Give A (3, 3) where the sum of the squared misses is least, over all x: f, u0, v0, then "
    "ω and T of each view, with R = rotation_from_vector(ω). You get a start x (3 + 6v,); undamped "
    "steps lead away from there.",
    hints=(
        "A function of x for the misses r, all in one vector. For J change one number of x after "
        "the other by ±h, and divide the differences by 2h.",
        "A step is x − (JᵀJ + μ diag(JᵀJ))⁻¹ Jᵀr. If it makes the sum smaller, take it, and "
        "divide μ by 10; if not, stay, and multiply μ by 10.",
        "Begin with μ = 0.001 and r = misses(x). for _ in range(30): J, N = J.T @ J, "
        "step = np.linalg.solve(N + μ np.diag(np.diag(N)), J.T @ r), compare, and at the end A "
        "from x[:3].",
    ),
    cases=_boards,
    properties=(
        Property("On exact corners A is the camera that saw them."),
        Property("With noise the sum of the squared misses is least.", about="noisy"),
    ),
    misconceptions=_MISTAKES,
    steps=levenberg_marquardt,
    same=close_to(2e-5),
    sources=(levenberg_marquardt, misses, derivatives),
    concepts=("64", "65", "e"),
)
