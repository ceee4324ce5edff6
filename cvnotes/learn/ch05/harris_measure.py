"""Is there a corner."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _windows(rng: np.random.Generator) -> list[Case]:
    Iu, Iv = rounded(rng.uniform(-9, 9, (2, 5, 5)), 1)
    edge = np.array([[1.0, 2.0], [3.0, 1.0]])
    return [
        Case((np.array([[1.0, 0.0], [2.0, 0.0]]), np.array([[0.0, 3.0], [1.0, 0.0]]), 0.05)),
        Case((Iu, Iv, 0.04)),
        Case((edge, 2 * edge, 0.05), about="edge"),
    ]


def harris_measure(Iu: Array, Iv: Array, k: float) -> float:
    """Return Harris' measure of the window, a number."""
    uu = (Iu * Iu).sum()  # the sum of the squares of Iu
    vv = (Iv * Iv).sum()  # the sum of the squares of Iv
    uv = (Iu * Iv).sum()  # the sum of the mixed products
    det = uu * vv - uv**2  # the determinant of S
    trace = uu + vv  # the trace of S
    return det - k * trace**2


MISTAKES = mistakes_in(harris_measure,
    ("sums before products", "You summed the gradients before multiplying. Gradients of opposite "
     "sign then cancel; multiply pixel by pixel, then sum.",
     ("(Iu * Iu).sum()", "Iu.sum() ** 2", "(Iv * Iv).sum()", "Iv.sum() ** 2", "(Iu * Iv).sum()",
      "Iu.sum() * Iv.sum()"),
     ("(Iu * Iu).sum()", "Iu.sum() ** 2", "(Iv * Iv).sum()", "Iv.sum() ** 2")),
    ("matrix product", "You multiplied rows by columns, as matrices; here it is pixel by pixel.",
     ("Iu * Iu", "Iu @ Iu", "Iv * Iv", "Iv @ Iv", "Iu * Iv", "Iu @ Iv"),
     ("(Iu * Iu).sum()", "np.trace(Iu @ Iu)", "(Iv * Iv).sum()", "np.trace(Iv @ Iv)",
      "(Iu * Iv).sum()", "np.trace(Iu @ Iv)")),
    ("pixel by pixel",
     "That measures single pixels, of which none is a corner: sum over the window first.",
     "-k * ((Iu**2 + Iv**2)**2).sum()", "harris_measure(Iu[:1, :1], Iv[:1, :1], k)",
     "harris_measure(Iu[-1:, -1:], Iv[-1:, -1:], k)"),
    ("squares of the trace's parts", "The trace is squared as a whole, not part by part.",
     ("trace**2", "(uu**2 + vv**2)")),
    ("mixed sum in the wrong place", "The mixed sum stands in the determinant alone, and once.",
     ("trace**2", "(trace + uv) ** 2"), ("- uv**2", "- 2 * uv**2"), ("- uv**2", "- 2 * uv")),
    ("trace and determinant exchanged",
     "Of determinant and trace it is the trace that is squared and multiplied by k.",
     "trace**2 - k * det", "trace - k * det**2", "det**2 - k * trace**2"),
    ("another measure",
     "That is another measure of S: an eigenvalue, the trace, or the determinant over the trace.",
     "trace / 2 - np.sqrt(trace**2 / 4 - det)", "trace / 2 + np.sqrt(trace**2 / 4 - det)",
     "det / trace", "trace"),
    ("absolute gradients", "You took absolute values: the mixed sum needs the gradients' signs.",
     lambda Iu, Iv, k: harris_measure(np.abs(Iu), np.abs(Iv), k)),
    ("mean for sum",
     "S is made of sums over the window; a mean in its place is smaller by the number of pixels.",
     "(det - k * trace**2) / Iu.size**2",
     ("(Iu * Iu).sum()", "(Iu * Iu).mean()", "(Iv * Iv).sum()", "(Iv * Iv).mean()"),
     ("(Iu * Iv).sum()", "(Iu * Iv).mean()")),
)  # fmt: skip


EXERCISE = Exercise(
    name="harris_measure",
    chapter=5,
    title="Is there a corner?",
    task="Give Harris' measure det S − k (trace S)² of a window, from the gradients Iu and Iv of "
    "its pixels (both of one shape): S = Σ [Iu², Iu Iv; Iu Iv, Iv²] over the window.",
    hints=(
        "Multiply pixel by pixel first, then sum: three sums, Σ Iu², Σ Iv² and Σ Iu Iv.",
        "det S = Σ Iu² Σ Iv² − (Σ Iu Iv)².",
        "trace S = Σ Iu² + Σ Iv².",
    ),
    cases=_windows,
    properties=(
        Property("A corner gets det S − k (trace S)²."),
        Property(
            "An edge, where all gradients are parallel, gets a negative number.",
            lambda measure, _: bool(measure < 0),
            about="edge",
        ),
        Property("It gets exactly −k (trace S)², as det S is 0 there.", about="edge"),
    ),
    misconceptions=MISTAKES,
    steps=harris_measure,
    concepts=("40", "E19"),
)
