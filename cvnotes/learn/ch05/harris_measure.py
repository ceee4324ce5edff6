"""Is there a corner."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng


def harris_measure(Iu: Array, Iv: Array, k: float) -> float:
    """Give det M − k (trace M)², where M sums the products of gradients over a window."""
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


def _matrix(Iu: Array, Iv: Array) -> Array:
    uu, vv, uv = _sums(Iu, Iv)
    return np.array([[uu, uv], [uv, vv]])


HARRIS = Exercise(
    name="harris_measure",
    chapter=5,
    title="Is there a corner?",
    task="Give Harris' measure det M − k (trace M)² of a window, from the gradients Iu and Iv of "
    "its pixels (both of one shape): M = Σ [Iu², Iu Iv; Iu Iv, Iv²] over the window.",
    stub='''def my_harris_measure(Iu, Iv, k):
    """Give Harris' measure of the window, a number."""
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
    misconceptions=(
        Misconception(
            "sums before products",
            "You summed the gradients before multiplying. Gradients of opposite sign then cancel; "
            "multiply pixel by pixel, then sum.",
            lambda Iu, Iv, k: harris_measure(Iu.sum(keepdims=True), Iv.sum(keepdims=True), k),
        ),
        Misconception(
            "trace not squared",
            "det M grows with the fourth power of the gradients, so the trace is squared.",
            lambda Iu, Iv, k: _det_trace(Iu, Iv)[0] - k * _det_trace(Iu, Iv)[1],
        ),
        Misconception(
            "trace added",
            "The term k (trace M)² is subtracted: it punishes edges.",
            lambda Iu, Iv, k: _det_trace(Iu, Iv)[0] + k * _det_trace(Iu, Iv)[1] ** 2,
        ),
        Misconception(
            "k left out",
            "k is missing before (trace M)²; without it no corner ever gets a positive measure.",
            lambda Iu, Iv, k: _det_trace(Iu, Iv)[0] - _det_trace(Iu, Iv)[1] ** 2,
        ),
        Misconception(
            "mixed sum left out",
            "The determinant is Σ Iu² Σ Iv² − (Σ Iu Iv)²: without the last term slanted edges "
            "pass for corners.",
            lambda Iu, Iv, k: np.prod(_sums(Iu, Iv)[:2]) - k * _det_trace(Iu, Iv)[1] ** 2,
        ),
        Misconception(
            "mixed sum not squared",
            "You did not square the mixed sum: the determinant is Σ Iu² Σ Iv² − (Σ Iu Iv)².",
            lambda Iu, Iv, k: (
                np.prod(_sums(Iu, Iv)[:2]) - _sums(Iu, Iv)[2] - k * _det_trace(Iu, Iv)[1] ** 2
            ),
        ),
        Misconception(
            "determinant only",
            "det M is a measure too, but large on strong edges with a little noise; subtract "
            "k (trace M)².",
            lambda Iu, Iv, k: _det_trace(Iu, Iv)[0],
        ),
        Misconception(
            "mean for sum",
            (
                "M is the sum over the window; with the mean, det M is smaller by n², and (trace "
                "M)² too."
            ),
            lambda Iu, Iv, k: harris_measure(Iu, Iv, k) / Iu.size**2,
        ),
        Misconception(
            "squares of the trace's parts",
            "(trace M)² is (Σ Iu² + Σ Iv²)², not the sum of the squares.",
            lambda Iu, Iv, k: _det_trace(Iu, Iv)[0] - k * (_sums(Iu, Iv)[:2] ** 2).sum(),
        ),
        Misconception(
            "sign in the determinant",
            "You added in the determinant: det M = Σ Iu² Σ Iv² − (Σ Iu Iv)², with a minus.",
            lambda Iu, Iv, k: (
                np.prod(_sums(Iu, Iv)[:2]) + _sums(Iu, Iv)[2] ** 2 - k * _det_trace(Iu, Iv)[1] ** 2
            ),
        ),
        Misconception(
            "the smaller eigenvalue",
            (
                "That is the smaller eigenvalue of M, Shi and Tomasi's measure; asked is det M − "
                "k (trace M)²."
            ),
            lambda Iu, Iv, k: (
                _det_trace(Iu, Iv)[1] / 2
                - np.sqrt(_det_trace(Iu, Iv)[1] ** 2 / 4 - _det_trace(Iu, Iv)[0])
            ),
        ),
        Misconception(
            "determinant over trace",
            "det M / trace M is another measure; asked is det M − k (trace M)².",
            lambda Iu, Iv, k: _det_trace(Iu, Iv)[0] / _det_trace(Iu, Iv)[1],
        ),
        Misconception(
            "pixel by pixel",
            "You took the determinant of each pixel before summing: there it is 0. Sum first.",
            lambda Iu, Iv, k: -k * ((Iu**2 + Iv**2) ** 2).sum(),
        ),
        Misconception(
            "trace alone",
            "The determinant is missing: det M − k (trace M)².",
            lambda Iu, Iv, k: -k * _det_trace(Iu, Iv)[1] ** 2,
        ),
        Misconception(
            "squares of the sums",
            "You have (Σ Iu)² and (Σ Iv)²: square pixel by pixel first, then sum.",
            lambda Iu, Iv, k: _measure(Iu.sum() ** 2, Iv.sum() ** 2, (Iu * Iv).sum(), k),
        ),
        Misconception(
            "matrix product",
            "Iu @ Iv multiplies rows by columns; pixel by pixel it is Iu * Iv.",
            lambda Iu, Iv, k: _measure((Iu @ Iu).sum(), (Iv @ Iv).sum(), (Iu @ Iv).sum(), k),
            variants=(
                lambda Iu, Iv, k: _measure(
                    np.trace(Iu @ Iu), np.trace(Iv @ Iv), np.trace(Iu @ Iv), k
                ),
            ),
        ),
        Misconception(
            "the larger eigenvalue",
            "That is the larger eigenvalue of M: an edge has a large one too.",
            lambda Iu, Iv, k: (
                _det_trace(Iu, Iv)[1] / 2
                + np.sqrt(_det_trace(Iu, Iv)[1] ** 2 / 4 - _det_trace(Iu, Iv)[0])
            ),
        ),
        Misconception(
            "the trace",
            "That is trace M, the sum of all squared gradients: det M − k (trace M)² is asked.",
            lambda Iu, Iv, k: _det_trace(Iu, Iv)[1],
        ),
        Misconception(
            "M itself",
            "That is the matrix M; asked is a number made of it.",
            lambda Iu, Iv, k: _matrix(Iu, Iv),
        ),
        Misconception(
            "a measure for each pixel",
            "You gave a number for each pixel: M sums over the window.",
            lambda Iu, Iv, k: _measure(Iu**2, Iv**2, Iu * Iv, k),
            variants=(lambda Iu, Iv, k: Iu**2 * Iv**2 - k * (Iu**2 + Iv**2) ** 2,),
        ),
        Misconception(
            "mixed sum in the trace",
            "trace M = Σ Iu² + Σ Iv²: the mixed sum is not in it.",
            lambda Iu, Iv, k: _det_trace(Iu, Iv)[0] - k * _sums(Iu, Iv).sum() ** 2,
        ),
        Misconception(
            "trace and determinant exchanged",
            "det M comes first, k multiplies the square of the trace: you exchanged them.",
            lambda Iu, Iv, k: _det_trace(Iu, Iv)[1] ** 2 - k * _det_trace(Iu, Iv)[0],
            variants=(lambda Iu, Iv, k: _det_trace(Iu, Iv)[1] - k * _det_trace(Iu, Iv)[0] ** 2,),
        ),
        Misconception(
            "determinant squared",
            "You squared the determinant; only the trace is squared.",
            lambda Iu, Iv, k: _det_trace(Iu, Iv)[0] ** 2 - k * _det_trace(Iu, Iv)[1] ** 2,
        ),
        Misconception(
            "mixed sum doubled",
            "You doubled the mixed sum: the determinant is Σ Iu² Σ Iv² − (Σ Iu Iv)², without a 2.",
            lambda Iu, Iv, k: (
                np.prod(_sums(Iu, Iv)[:2])
                - 2 * _sums(Iu, Iv)[2] ** 2
                - k * _det_trace(Iu, Iv)[1] ** 2
            ),
            variants=(
                lambda Iu, Iv, k: (
                    np.prod(_sums(Iu, Iv)[:2])
                    - 2 * _sums(Iu, Iv)[2]
                    - k * _det_trace(Iu, Iv)[1] ** 2
                ),
            ),
        ),
        Misconception(
            "difference of the sums in the trace",
            "You subtracted in the trace: trace M = Σ Iu² + Σ Iv², with a plus.",
            lambda Iu, Iv, k: (
                _det_trace(Iu, Iv)[0] - k * (_sums(Iu, Iv)[0] - _sums(Iu, Iv)[1]) ** 2
            ),
        ),
        Misconception(
            "absolute gradients",
            "You took absolute values: a gradient's sign tells its direction, and Σ Iu Iv needs "
            "it.",
            lambda Iu, Iv, k: harris_measure(np.abs(Iu), np.abs(Iv), k),
        ),
        Misconception(
            "gradients not squared",
            "M has Σ Iu² and Σ Iv²: you have sums of the gradients themselves.",
            lambda Iu, Iv, k: _measure(Iu.sum(), Iv.sum(), (Iu * Iv).sum(), k),
        ),
        Misconception(
            "first pixel only",
            "That is the measure of a single pixel: sum over the window.",
            lambda Iu, Iv, k: harris_measure(Iu[:1, :1], Iv[:1, :1], k),
            variants=(lambda Iu, Iv, k: harris_measure(Iu[-1:, -1:], Iv[-1:, -1:], k),),
        ),
        Misconception(
            "mean for sum in part",
            "You took the mean in one place and the sum in another: all entries of M are sums.",
            lambda Iu, Iv, k: _measure((Iu**2).mean(), (Iv**2).mean(), (Iu * Iv).sum(), k),
            variants=(
                lambda Iu, Iv, k: _measure((Iu**2).sum(), (Iv**2).sum(), (Iu * Iv).mean(), k),
            ),
        ),
    ),
    reference=harris_measure,
    concepts=("40", "E19"),
)
