"""Is there a corner."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.tutor.checker.exercise import Case, Exercise, Property, Rng, mistakes


def harris_measure(Iu: Array, Iv: Array, k: float) -> float:
    """Return det M − k (trace M)², where M sums the products of gradients over a window."""
    uu, vv, uv = (Iu * Iu).sum(), (Iv * Iv).sum(), (Iu * Iv).sum()
    return float(uu * vv - uv**2 - k * (uu + vv) ** 2)


def _windows(rng: Rng) -> list[Case]:
    Iu, Iv = rounded(rng.uniform(-9, 9, (2, 5, 5)), 1)
    edge = np.array([[1.0, 2.0], [3.0, 1.0]])
    return [
        Case((np.array([[1.0, 0.0], [2.0, 0.0]]), np.array([[0.0, 3.0], [1.0, 0.0]]), 0.05)),
        Case((Iu, Iv, 0.04)),
        Case((edge, 2 * edge, 0.05), about="edge"),
    ]


def _sums(Iu: Array, Iv: Array) -> Array:
    return np.array([(Iu * Iu).sum(), (Iv * Iv).sum(), (Iu * Iv).sum()])


def _det_trace(Iu: Array, Iv: Array) -> tuple[float, float]:
    uu, vv, uv = _sums(Iu, Iv)
    return uu * vv - uv**2, uu + vv


def _measure(uu: Array, vv: Array, uv: Array, k: float) -> Array:
    return uu * vv - uv**2 - k * (uu + vv) ** 2


def _steps(Iu: Array, Iv: Array, k: float) -> Any:
    uu = (Iu * Iu).sum()  # the sum of the squares of Iu
    vv = (Iv * Iv).sum()  # the sum of the squares of Iv
    uv = (Iu * Iv).sum()  # the sum of the mixed products
    det = uu * vv - uv**2  # the determinant of M
    trace = uu + vv  # the trace of M
    return det - k * trace**2


MISTAKES = mistakes(
    ("sums before products",
     "You summed the gradients before multiplying. Gradients of opposite sign then cancel; "
     "multiply pixel by pixel, then sum.",
     lambda Iu, Iv, k: harris_measure(Iu.sum(keepdims=True), Iv.sum(keepdims=True), k),
     lambda Iu, Iv, k: _measure(Iu.sum() ** 2, Iv.sum() ** 2, (Iu * Iv).sum(), k)),
    ("matrix product",
     "You multiplied rows by columns, as matrices; here it is pixel by pixel.",
     lambda Iu, Iv, k: _measure((Iu @ Iu).sum(), (Iv @ Iv).sum(), (Iu @ Iv).sum(), k),
     lambda Iu, Iv, k: _measure(np.trace(Iu @ Iu), np.trace(Iv @ Iv), np.trace(Iu @ Iv), k)),
    ("pixel by pixel",
     "That measures single pixels, of which none is a corner: sum over the window first.",
     lambda Iu, Iv, k: -k * ((Iu ** 2 + Iv ** 2) ** 2).sum(),
     lambda Iu, Iv, k: harris_measure(Iu[:1, :1], Iv[:1, :1], k),
     lambda Iu, Iv, k: harris_measure(Iu[-1:, -1:], Iv[-1:, -1:], k)),
    ("squares of the trace's parts", "The trace is squared as a whole, not part by part.",
     lambda Iu, Iv, k: _det_trace(Iu, Iv)[0] - k * (_sums(Iu, Iv)[:2] ** 2).sum()),
    ("mixed sum in the wrong place", "The mixed sum stands in the determinant alone, and once.",
     lambda Iu, Iv, k: _det_trace(Iu, Iv)[0] - k * _sums(Iu, Iv).sum() ** 2,
     lambda Iu, Iv, k: np.prod(_sums(Iu, Iv)[:2]) - 2 * _sums(Iu, Iv)[2] ** 2 - k * _det_trace(Iu,
         Iv)[1] ** 2,
     lambda Iu, Iv, k: np.prod(_sums(Iu, Iv)[:2]) - 2 * _sums(Iu, Iv)[2] - k * _det_trace(Iu,
         Iv)[1] ** 2),
    ("trace and determinant exchanged",
     "Of determinant and trace it is the trace that is squared and multiplied by k.",
     lambda Iu, Iv, k: _det_trace(Iu, Iv)[1] ** 2 - k * _det_trace(Iu, Iv)[0],
     lambda Iu, Iv, k: _det_trace(Iu, Iv)[1] - k * _det_trace(Iu, Iv)[0] ** 2,
     lambda Iu, Iv, k: _det_trace(Iu, Iv)[0] ** 2 - k * _det_trace(Iu, Iv)[1] ** 2),
    ("another measure",
     "That is another measure of M: an eigenvalue, the trace, or the determinant over the "
     "trace.",
     lambda Iu, Iv, k: _det_trace(Iu, Iv)[1] / 2 - np.sqrt(_det_trace(Iu, Iv)[1] ** 2 / 4 -
         _det_trace(Iu, Iv)[0]),
     lambda Iu, Iv, k: _det_trace(Iu, Iv)[1] / 2 + np.sqrt(_det_trace(Iu, Iv)[1] ** 2 / 4 -
         _det_trace(Iu, Iv)[0]), lambda Iu, Iv, k: _det_trace(Iu, Iv)[0] / _det_trace(Iu, Iv)[1],
     lambda Iu, Iv, k: _det_trace(Iu, Iv)[1]),
    ("absolute gradients",
     "You took absolute values: a gradient's sign tells its direction, and the mixed sum "
     "needs it.",
     lambda Iu, Iv, k: harris_measure(np.abs(Iu), np.abs(Iv), k)),
    ("mean for sum",
     "M is made of sums over the window; a mean in its place is smaller by the number of "
     "pixels.",
     lambda Iu, Iv, k: harris_measure(Iu, Iv, k) / Iu.size ** 2,
     lambda Iu, Iv, k: _measure((Iu ** 2).mean(), (Iv ** 2).mean(), (Iu * Iv).sum(), k),
     lambda Iu, Iv, k: _measure((Iu ** 2).sum(), (Iv ** 2).sum(), (Iu * Iv).mean(), k)),
)  # fmt: skip


HARRIS = Exercise(
    name="harris_measure",
    chapter=5,
    title="Is there a corner?",
    task="Give Harris' measure det M − k (trace M)² of a window, from the gradients Iu and Iv of "
    "its pixels (both of one shape): M = Σ [Iu², Iu Iv; Iu Iv, Iv²] over the window.",
    stub='''def my_harris_measure(Iu, Iv, k):
    """Return Harris' measure of the window, a number."""
    ...''',
    hints=(
        "Multiply pixel by pixel first, then sum: three sums, Σ Iu², Σ Iv² and Σ Iu Iv.",
        "det M = Σ Iu² Σ Iv² − (Σ Iu Iv)².",
        "trace M = Σ Iu² + Σ Iv².",
    ),
    cases=_windows,
    properties=(
        Property("A corner gets det M − k (trace M)²."),
        Property(
            "An edge, where all gradients are parallel, gets a negative number.",
            lambda measure, _: bool(measure < 0),
            about="edge",
        ),
        Property("It gets exactly −k (trace M)², as det M is 0 there.", about="edge"),
    ),
    misconceptions=MISTAKES,
    reference=harris_measure,
    steps=_steps,
    concepts=("40", "E19"),
)
