"""The public drawing functions that take arrays, with arguments that are good.

They are tried in the same way as those of `public_face.FUNCTIONS`. What they drew is read back as
numbers, so that it can be compared; their figures are known to nobody else, and vanish with them.
"""

from functools import wraps

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.quiver import Quiver
from public_face import (
    BOARD,
    CAMERA,
    GREY,
    LINES,
    ONE,
    PICTURE,
    SEEN,
    SINGLE,
    Argument,
    G,
    M,
    W,
    function,
    rows,
    several,
)

from cvnotes.calibration import calibrate, coverage
from cvnotes.show.figures import (
    calibration,
    lines,
)
from cvnotes.show.figures import (
    images as figures,
)
from cvnotes.show.space import camera_shapes as sights
from cvnotes.show.space import shapes

# Pixels among which NaN means that a point has no image.
PIXELS = Argument((2,), empty=True, picture=True)
SMALL = GREY[:24, :32].copy()
PAIR = np.stack([SMALL, SMALL + 5])
FREE = calibrate(BOARD.points, SEEN, CAMERA.size, lens="k1 k2 p1 p2", board="free")
CLOUD = np.random.default_rng(3).normal(0, 0.2, (20, 2))


def read_back(drawn):
    """Give all numbers in axes or shapes, as a list of arrays."""
    if isinstance(drawn, Axes):
        marks = [c for c in drawn.collections if isinstance(c, PathCollection | Quiver)]
        found = [np.ravel(line.get_xydata()) for line in drawn.lines]
        found += [np.ma.filled(c.get_offsets(), np.nan).ravel() for c in marks]
        found += [c.U for c in marks if isinstance(c, Quiver)]
        return found + [np.ma.filled(image.get_array(), np.nan).ravel() for image in drawn.images]
    if isinstance(drawn, tuple | list) or np.asarray(drawn).dtype.kind == "O":
        return [x for part in drawn for x in read_back(part)]
    return [] if isinstance(drawn, str | float) else [np.ravel(drawn)]


def figure(call, arrays, name=None, **more):
    """Give a Function that answers with the numbers it drew."""

    @wraps(call)
    def numbers(*args, **kwargs):
        return read_back(call(*args, **kwargs))

    return function(numbers, arrays, name, **more)


FIGURES = [
    # calibration
    figure(
        calibration.draw_cube,
        {"side": (20.0, ONE), "origin": (np.array([5.0, 5]), several(2))},
        camera=CAMERA.moved(G),
    ),
    # figures
    figure(figures.draw_image, {"image": (SMALL, PICTURE)}),
    figure(figures.draw_points, {"m": (M, PIXELS)}, sizes=("size",), size=(640, 480)),
    figure(
        figures.draw_corners,
        {"image": (SMALL, PICTURE), "corners": (SEEN[0], several(2))},
        board=BOARD,
    ),
    # least squares
    # lines
    figure(
        lines.draw_lines,
        {"lines": (np.array([[3.0, 1, 1], [1, 0, -320]]), rows(3))},
        sizes=("size",),
        size=(640, 480),
    ),
    figure(lines.draw_segments, {"segments": (LINES, rows(2))}, sizes=("size",), size=(640, 480)),
    figure(lines.segment_ends, {"segments": (LINES, rows(2))}),
    figure(
        coverage.covered_cells,
        {"image_points": (SEEN, rows(2))},
        sizes=("size",),
        size=(640, 480),
    ),
    # what 3-D figures are made of
    figure(shapes.axes_shapes, {"world_from_frame": (G, SINGLE), "length": (100.0, ONE)}),
    figure(shapes.target_shapes, {"world_from_target": (G, SINGLE)}, target=BOARD),
    figure(sights.camera_shapes, {"depth": (100.0, ONE), "image": (SMALL, PICTURE)}, camera=CAMERA),
    figure(
        lambda m, to: sights.ray_shapes(CAMERA, m, to=to),
        {"m": (M, rows(2)), "to": (W[:3], rows(3))},
        "show.sights.ray_shapes",
    ),
]
