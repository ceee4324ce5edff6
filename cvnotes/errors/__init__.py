"""What can go wrong, said in sentences that teach, and the guards of every public function.

Two kinds of failure, one rule each. The whole input is unusable: an exception from this
module. A single point has no image: its row is NaN. Guards copy what they are given to
float64, so that no function can write to its input.
"""

from cvnotes.errors.arrays import (
    LARGEST,
    LARGEST_ENTRY,
    Array,
    equally_many,
    matrix,
    number,
    numbers,
    paired,
    points,
    real,
)
from cvnotes.errors.cameras import (
    MOST_PIXELS,
    image_size,
    intrinsic_matrix,
    rigid_motion,
    rotation,
    target_size,
)
from cvnotes.errors.kinds import (
    CalibrationWarning,
    ConvergenceError,
    CornersNotFound,
    CvnotesError,
    DegenerateError,
    FileError,
    InputTypeError,
    ShapeError,
)

__all__ = [
    "LARGEST",
    "LARGEST_ENTRY",
    "MOST_PIXELS",
    "Array",
    "CalibrationWarning",
    "ConvergenceError",
    "CornersNotFound",
    "CvnotesError",
    "DegenerateError",
    "FileError",
    "InputTypeError",
    "ShapeError",
    "equally_many",
    "image_size",
    "intrinsic_matrix",
    "matrix",
    "number",
    "numbers",
    "paired",
    "points",
    "real",
    "rigid_motion",
    "rotation",
    "target_size",
]

# A traceback names an error as it is imported.
for _kind in (
    CalibrationWarning,
    ConvergenceError,
    CornersNotFound,
    CvnotesError,
    DegenerateError,
    FileError,
    InputTypeError,
    ShapeError,
):
    _kind.__module__ = __name__
