"""No numbers at all: what was raised or returned in their place, by name."""

import re

from cvnotes.tutor.checker.wrong_answer import Found, WrongAnswer


def without_numbers(answer: WrongAnswer) -> Found | None:
    """Name what came in place of numbers, on the case that the student sees."""
    _, outcome = answer.shown
    if outcome.kind == "raised":
        # The student's own line, quoted behind it, has words of its own.
        said = outcome.words.partition(", in the line `")[0]
        for pattern, name, sentence in RAISED:
            if re.search(pattern, said):
                return Found(name, f"{answer.why} {sentence}")
    names = {
        "other": "no array of numbers",
        "text": "none of the choices" if answer.exercise.choices else "a text for numbers",
        "none": "nothing returned",
        "late": "never ends",
    }
    if outcome.kind == "other" and "not called" in outcome.words:
        names["other"] = "not called"
    elif outcome.kind == "other" and "complex" in outcome.words:
        names["other"] = "complex numbers"
    return Found(names[outcome.kind], answer.why) if outcome.kind in names else None


# What Python and NumPy say of a slip that has a name; the first that fits counts.
RAISED: tuple[tuple[str, str, str], ...] = (
    (r"truth value of an array", "if on arrays", "An if decides once, for a single number: for "
     "arrays there are np.where, masks such as x[x > 0], and & in place of and."),
    (r"ufunc 'bitwise", "& or | between numbers", "& and | are for truth values, and need "
     "brackets: (a > 0) & (b > 0)."),
    (r"only (length-1|size-1|0-dimensional) arrays", "one number wanted, an array given",
     "Functions of math, float() and int() take a single number; those of NumPy take arrays."),
    (r"not positive definite", "not positive definite", "Cholesky needs a symmetric matrix with "
     "positive eigenvalues: look at its sign and order."),
    (r"[Ss]ingular matrix", "a singular system", "The equations depend on each other, so they have "
     "no single solution: is a row wrong, or is this input special?"),
    (r"matmul|shapes .* not aligned", "shapes that do not fit", "In A @ B each row of A is as long "
     "as each column of B: points are rows here, so x @ M.T."),
    (r"broadcast", "shapes that do not fit", "Shapes are compared from the right: a column (n, 1) "
     "fits rows (n, d), (n,) does not."),
    (r"cannot reshape", "shapes that do not fit", "A reshape keeps how many numbers there are."),
    (r"core dimension|Incompatible dimensions", "shapes that do not fit", "A system of equations "
     "needs as many numbers on its right as the matrix has rows."),
    (r"must match exactly|must have same number|must have the same shape|inhomogeneous",
     "shapes that do not fit", "What is joined into one array must have the same length in all "
     "other axes."),
    (r"must be square", "shapes that do not fit", "This function needs a square matrix."),
    (r"must be (at least )?two-dimensional", "shapes that do not fit", "This function needs a "
     "matrix, an array with rows and columns."),
    (r"cross product", "shapes that do not fit", "np.cross takes vectors of three numbers."),
    (r"data type", "a shape without brackets", "A shape is a tuple, in brackets of its own: "
     "np.zeros((3, 3))."),
    (r"to unpack", "unpacked into too few or too many names", "On the left there must be as many "
     "names as values on the right: look at the shape."),
    (r"is not callable", "round brackets after a value", "Round brackets call a function: an entry "
     "is x[0], and a product needs its *."),
    (r"Cannot cast", "decimals into an integer array", "An array of whole numbers takes no "
     "decimals: begin with dtype=float."),
    (r"cannot convert float", "NaN or infinity made an integer", "NaN and infinity are no whole "
     "numbers: leave them out before int()."),
    (r"NoneType", "None used as a value", "Something that is used there is None: is a return "
     "missing, or is a function not solved yet?"),
    (r"'list' object has no attribute|can't multiply sequence|'list' and|list indices.* tuple",
     "a list for an array", "Lists do not calculate: np.array makes an array of one."),
    (r"only integers, slices|indices must be integers|cannot be interpreted as an integer",
     "an index that is no whole number", "An index, or a count, is a whole number: round it, then "
     "make it an int."),
    (r"AxisError", "an axis that is not there",
     "The array has fewer axes than that: look at its shape."),
    (r"too many indices", "too many indices", "The array has fewer axes than the brackets have "
     "indices: look at its shape."),
    (r"IndexError", "an index too large", "Indices go from 0 to the length − 1."),
    (r"ZeroDivisionError", "division by zero", "Python's own numbers cannot be divided by 0; "
     "NumPy's give inf or nan."),
    (r"positional argument", "other arguments", "A function was called with other arguments than "
     "it takes; yours is called with those of the stub."),
    (r"NameError|UnboundLocalError", "an unknown name", "Everything that is used has to be defined "
     "or imported before."),
    (r"(ModuleNotFound|Import)Error", "an import that fails", "NumPy is all that is needed."),
    (r"has no attribute", "no such function", "There is no function or attribute of this name: "
     "look at its spelling."),
    (r"math domain error", "math domain error", "math.sqrt takes no negative number, math.acos "
     "none beyond 1: look at the sign."),
)  # fmt: skip
