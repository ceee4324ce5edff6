"""Any arguments: an error of the course's family or an answer, and no warning of another's.

Good arguments of a public function are spoilt, one to three at a time, by what hypothesis draws:
other numbers (tiny, huge, none), other shapes, other types. `CVNOTES_EXAMPLES` says how many sets
of arguments are drawn, 30 a second; 12,000 were once. The same ones are drawn each time.
"""

import inspect
import os
import warnings

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from public_face import SEEN, W
from test_sizes import FIGURES, FUNCTIONS, MORE

from cvnotes.base import CalibrationWarning, CvnotesError, InputTypeError
from cvnotes.calibration import calibrate, v_ij
from cvnotes.camera import Camera, FisheyeLens, Lens, intrinsics, pose
from cvnotes.homography import trials_needed
from cvnotes.stereo import triangulate

EXAMPLES = int(os.environ.get("CVNOTES_EXAMPLES", "300"))

NUMBERS = st.sampled_from(
    [0.0, -0.0, 1.0, -1.0, 0.5, 2.0, 1e-300, 5e-324, 1e-30, 1e-8, 1e8, 1e30, 1e150, -1e300, 1e308]
    + [np.nan, np.inf, -np.inf, 1e5, -1e5, 7.0, 3.0]
)
THINGS = st.sampled_from(
    [None, "abc", b"ab", [], (), {}, [[]], True, [None], ["1"], [1, [2]], {1: 2}, object(), 1j]
    + [10**400, -3, np.array("x"), np.zeros((0, 2)), np.zeros((2, 0)), len, [1.0], [2.0, 3.0]]
)


@st.composite
def spoilt(draw, x):
    """Draw another argument in place of a good one: like it, or nothing like it."""
    if isinstance(x, bool):
        return draw(st.sampled_from([True, False, None, 0, 1, "abc", [], [True], {1: 2}]))
    try:
        array = np.asarray(x)
    except ValueError:
        array = np.asarray(None)
    if array.dtype.kind not in "iuf" or not array.size:
        return draw(THINGS)
    how = draw(st.sampled_from(["thing", "one", "all", "scaled", "shape", "noise", "sign", "part"]))
    flat = np.array(array, dtype=float)
    if how == "thing":
        return draw(THINGS)
    if how == "one":
        flat.flat[draw(st.integers(0, flat.size - 1))] = draw(NUMBERS)
    elif how == "all":
        flat[...] = draw(NUMBERS)
    elif how == "scaled":
        with np.errstate(all="ignore"):
            flat *= draw(NUMBERS)
    elif how == "noise":
        rng = np.random.default_rng(draw(st.integers(0, 999)))
        flat += rng.normal(0, draw(st.sampled_from([1e-12, 1e-3, 1.0, 100.0])), flat.shape)
    elif how == "sign":
        flat = -flat
    elif how == "part" and flat.ndim:
        flat = flat[: draw(st.integers(0, len(flat)))]
    elif how == "shape":
        flat = draw(st.sampled_from([flat[None], flat.ravel(), flat.T, np.resize(flat, 4)]))
    return flat if flat.ndim else float(flat)


def numeric_of(function):
    """Give the arguments of a function that are numbers, sizes, flags or arrays."""
    numeric = {}
    for name, p in inspect.signature(function.call).parameters.items():
        x = function.good.get(name, p.default)
        plain = isinstance(x, int | float | tuple | np.ndarray) and name not in OTHERS
        if name in function.arrays or name in function.sizes or plain:
            numeric[name] = x
    return numeric


OTHERS = ("cameras", "lenses", "boards")  # tuples of other things
ALL = [f for f in (*FUNCTIONS, *FIGURES, *MORE) if numeric_of(f)]


@st.composite
def calls(draw):
    """Draw a function, and good arguments of it with some spoilt."""
    function = draw(st.sampled_from(ALL))
    numeric = numeric_of(function)
    chosen = draw(st.lists(st.sampled_from(sorted(numeric)), min_size=1, max_size=3, unique=True))
    return function, {name: draw(spoilt(numeric[name])) for name in chosen}


@pytest.mark.sampling
@settings(max_examples=EXAMPLES, suppress_health_check=list(HealthCheck), report_multiple_bugs=True)
@given(calls())
def test_any_arguments_lead_to_an_answer_or_to_an_error_of_the_family(call):
    function, changed = call
    arguments = {**function.good, **changed}
    if "rng" not in changed and callable(arguments.get("rng")):
        arguments["rng"] = arguments["rng"]()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", CalibrationWarning)
        try:
            function.call(**arguments)
        except (CvnotesError, InputTypeError) as error:
            assert str(error).strip()  # noqa: PT017 - any of them is an answer


A = intrinsics(800, 800, 320, 240)


@pytest.mark.parametrize(("side", "axis"), [("left_points", 0), ("right_points", 1)])
def test_a_corner_far_beside_the_picture_is_refused_or_doubted_and_no_overflow(side, axis):
    function = next(f for f in ALL if side in f.good)
    far = function.good[side].copy()
    far[-1, -1, axis] = 1e5
    # Which of the two depends on the machine's last digits: the search goes far in either case.
    with pytest.raises((CvnotesError, CalibrationWarning)):
        function.call(**{**function.good, side: far})


def test_points_that_no_lens_shows_are_nowhere():
    barrel = Camera(A, lens=Lens(k=(-0.3,)))  # shows nothing beyond a radius of 0.7
    pair = [barrel, barrel.moved(pose(np.eye(3), [-80.0, 0, 0]))]
    assert np.isnan(triangulate(pair, np.full((2, 5, 2), 5000.0))).all()


@pytest.mark.parametrize("skew", [[1.0], "yes", None, 1, np.ones(3)])
@pytest.mark.parametrize("lens", ["k1 k2", "auto"])
def test_skew_is_true_or_false(skew, lens):
    with pytest.raises(InputTypeError, match="skew: expected True or False"):
        calibrate(W, SEEN, (640, 480), lens=lens, skew=skew)


@pytest.mark.parametrize("bad", [[1], "1", 1.5, None, 0, 4, np.ones(2)])
def test_columns_of_a_homography_and_samples_are_whole_numbers(bad):
    with pytest.raises(CvnotesError, match="number the columns of H"):
        v_ij(np.eye(3), bad, 2)
    if not np.array_equal(bad, 4):
        with pytest.raises((CvnotesError, InputTypeError), match="sample"):
            trials_needed(0.5, sample=bad)


def test_coefficients_of_a_fisheye_may_be_next_to_nothing():
    tiny, none = FisheyeLens((1e-300, -1e-300, 5e-324, 1e-300)), FisheyeLens()
    assert tiny.max_angle == none.max_angle
    assert np.array_equal(tiny.distort([[0.3, 0.2]]), none.distort([[0.3, 0.2]]))
    assert np.allclose(tiny.undistort([[0.3, 0.2]]), none.undistort([[0.3, 0.2]]), rtol=1e-14)
