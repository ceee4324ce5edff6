"""A Jacobian by differences, to hold analytic ones against."""

import numpy as np


def numerical_jacobian(f, x, step=1e-6):
    """Differentiate f at x by central differences: about 1e-9 relative.

    Steps are relative to each parameter (absolute below 1).
    """
    columns = []
    for i in range(x.size):
        h = step * max(1.0, abs(float(x[i])))
        e = np.zeros_like(x)
        e[i] = h
        columns.append((f(x + e) - f(x - e)).ravel() / (2 * h))
    return np.stack(columns, axis=-1)
