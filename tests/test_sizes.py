"""Sizes: what is asked for by number is refused where it would take gigabytes or minutes.

Of each public function that takes a size (a window, a radius, a blur, a picture, a board, a number
of views) 10⁵ is asked. It answers or says in words what is wrong, at once and in little memory.
"""

import importlib
import inspect
import re
import time
import tracemalloc
import warnings

import numpy as np
import pytest
from public_face import BOARD, CAMERA, FUNCTIONS, GREY, NOISE, function
from public_figures import FIGURES

from cvnotes import camera, pictures, show, targets
from cvnotes.base import CalibrationWarning, CvnotesError, InputTypeError
from cvnotes.homography import trials_needed

pytestmark = pytest.mark.once

WINGS = ["camera", "projective", "homography", "targets", "warping", "files", "calibration"]
WINGS += ["photographs", "pictures", "stereo", "show"]
HUGE = 10**5
SECONDS, BYTES = 5, 50 * 2**20  # what is made 10⁵ times over takes minutes


def _rng():
    return np.random.default_rng(7)


def _views(call, **more):
    return function(call, {}, target=BOARD, camera=CAMERA, n=4, rng=_rng, **more)


# With good arguments, those that take no arrays and so are not in `public_face`.
MORE = [
    function(targets.Chessboard, {}, corners=(9, 6)),
    function(targets.CharucoBoard, {}, corners=(9, 6)),
    function(targets.TwoPlanes, {}),
    function(targets.ThreePlanes, {}),
    function(trials_needed, {}, inlier_fraction=0.5),
    function(pictures.render, {}, target=BOARD, camera=CAMERA),
    function(pictures.clutter, {}, size=(64, 48), rng=_rng),
    function(pictures.pixel_centres, {}, size=(64, 48)),
    function(pictures.gaussian_blur, {}, light=NOISE, sigma=1.0),
    function(pictures.compress, {}, image=GREY, quality=90),
    function(pictures.target_scene, {}, target=BOARD),
    function(
        pictures.hold_at, {}, target=BOARD, camera=CAMERA, R=np.eye(3), aim=np.array([320, 240])
    ),
    *[_views(getattr(pictures, name)) for name in pictures.__all__ if name.endswith("_views")],
    *[
        function(call, {}, scene=pictures.target_scene(BOARD), camera=CAMERA.resized((64, 48)))
        for call in (pictures.render_scene, pictures.radiance)
    ],
    function(show.panels, {}),
    function(show.show, {}, figure=show.panels(), alt="Axes."),
    function(show.one_corner, {}, chapter=1),
]
# Names of sizes that are no whole numbers, or pairs of such.
NAMES = {"blur", "sigma", "motion", "margin", "radius", "window", "size", "farther"}
# Whole numbers that are no sizes, and why.
NO_SIZES = {
    "v_ij": "i and j are columns",
    "radial_distortion": "1 or 2 terms; see test_zhang.py",
    "Calibration": "made by calibrate",
    "Detection": "made by detect",
    "Photo": "made by open_photo",
    "Picture": "made by show",
    "list_photos": "the size that photographs must have",
    "StereoCalibration.of_camera": "the number of a camera",
    "Model.of_views": "made by calibrate_photographs",
    "Photographs.without": "numbers of photographs",
}


def public_sizes():
    """Give the names of all public functions and methods with a size, and their sizes."""
    for wing in WINGS:
        module = importlib.import_module(f"cvnotes.{wing}")
        for name in module.__all__:
            thing = getattr(module, name)
            found = [(name, thing)]
            if inspect.isclass(thing):
                methods = [m for m in vars(thing) if not m.startswith("_")]
                found += [(f"{name}.{m}", getattr(thing, m)) for m in methods]
            for full, call in found:
                if not callable(call) or full in NO_SIZES or getattr(call, "_is_protocol", False):
                    continue
                try:
                    parameters = inspect.signature(call).parameters.values()
                except (TypeError, ValueError):
                    continue
                sizes = [
                    p.name
                    for p in parameters
                    if p.name in NAMES or re.search(r"(?<![\w.])int\b(?!\])", _hint(p))
                ]
                if sizes:
                    yield full, sizes


def _hint(parameter):
    hint = parameter.annotation
    words = hint.__name__ if isinstance(hint, type) else str(hint)
    return "" if "numpy" in words or "Buffer" in words else words  # arrays may be of int


SIZES = dict(public_sizes())
KNOWN = {str(f).split(".", 1)[-1]: f for f in (*FUNCTIONS, *FIGURES, *MORE)}


def known(name):
    """Give the function of this name with its good arguments."""
    return next((f for n, f in KNOWN.items() if n == name or n.endswith(f".{name}")), None)


def asked(f, name, value):
    """Give the seconds of the processor and the bytes that an answer or a refusal takes."""
    refusal = "none, it answered"
    arguments = {**f.good, name: value}
    if callable(arguments.get("rng")):
        arguments["rng"] = arguments["rng"]()
    tracemalloc.start()
    begin = time.process_time()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", CalibrationWarning)
            f.call(**arguments)
    except (CvnotesError, InputTypeError) as error:
        refusal = str(error)
    seconds, (_, peak) = time.process_time() - begin, tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert len(refusal.split()) >= 3, refusal
    return seconds, peak


@pytest.mark.parametrize("name", SIZES)
def test_a_size_of_a_hundred_thousand_is_answered_or_refused_at_once(name):
    f = known(name)
    assert f is not None, f"{name}: give it good arguments in MORE, or say in NO_SIZES why not"
    for size in SIZES[name]:
        default = inspect.signature(f.call).parameters[size].default
        good = f.good.get(size, default)
        pair = isinstance(good, tuple) or size in ("size", "motion")
        for value in ((HUGE, HUGE), (HUGE, HUGE + 1)) if pair else (HUGE, float(HUGE)):
            seconds, peak = asked(f, size, value)
            assert peak < BYTES, f"{size} = {value} takes {peak / 2**20:.0f} MB"
            assert seconds < SECONDS, f"{size} = {value} takes {seconds:.2f} s"


def test_the_largest_sizes_that_are_allowed_are_answered():
    assert targets.Chessboard((1000, 999)).points.shape == (999_000, 3)
    assert pictures.gaussian_blur(NOISE, 100.0).std() < 2
    assert pictures.render(BOARD, CAMERA.resized((64, 48)), blur=100.0).std() < 1
    assert targets.local_maxima(NOISE, radius=1000).shape == (1, 2)
    assert targets.refine_edges(GREY, [[300.0, 200.0]], window=100).shape == (1, 2)
    assert camera.Camera(np.diag([1e5, 1e5, 1]), size=(HUGE, HUGE)).size == (HUGE, HUGE)
