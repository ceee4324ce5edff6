"""The catalogue of bad input and faults: what each of its 135 rows leads to.

Rows 1 to 18 concern every public function that takes arrays. Each is a test here that asks all of
them (`public_face.FUNCTIONS`, `public_figures.FIGURES`) and names every function that fails, with
the row: an item of pytest's for each function would take longer than most of the questions.
`catalogue.ELSEWHERE` says which tests hold the other rows; that these tests exist is tested.
"""

import ast
import inspect
import re
import warnings
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from catalogue import ELSEWHERE, HERE
from matplotlib.axis import Axis
from public_face import FUNCTIONS as COMPUTING
from public_figures import FIGURES

from cvnotes.base import CalibrationWarning, CvnotesError, InputTypeError, matrix
from cvnotes.camera import AnyLens, Camera
from cvnotes.files import lens_from_opencv
from cvnotes.show import panels

TESTS = Path(__file__).parent
PACKAGE = TESTS.parent / "cvnotes"
OURS = (CvnotesError, InputTypeError)
FUNCTIONS = [*COMPUTING, *FIGURES]


class Unwilling:
    """Cannot be turned into an array."""

    def __array__(self, *args, **kwargs):
        raise RuntimeError("not today")


class Relative(np.ndarray):
    """An array that is a little more than one."""


@pytest.fixture(scope="module", autouse=True)
def axes_without_ticks():
    """Let matplotlib make no ticks: they are most of what axes cost, and none is drawn here."""
    with pytest.MonkeyPatch.context() as patch:
        for change in ("grid", "set_clip_path", "set_tick_params"):
            patch.setattr(Axis, change, lambda *_, **__: None)
        yield


def answer(function, /, **changed):
    """Call a function with good arguments but for some; doubts about the result are no matter."""
    arguments = {**function.good, **changed}
    if callable(arguments.get("rng")):
        arguments["rng"] = arguments["rng"]()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CalibrationWarning)
        return function.call(**arguments)


def numbers_of(x):
    """Give all numbers of an answer, whatever it is, as one flat array."""
    if isinstance(x, dict):
        x = list(x.values())
    if isinstance(x, (tuple, list)):
        return np.concatenate([numbers_of(item) for item in x]) if len(x) else np.zeros(0)
    if isinstance(x, AnyLens):
        return np.array([*x.k, *x.p, *x.centre, *getattr(x, "s", ()), *getattr(x, "tilt", ())])
    if isinstance(x, Camera):
        return np.concatenate([x.A.ravel(), x.G.ravel()])
    if hasattr(x, "candidates"):  # a choice of lens and board
        return numbers_of([[c.camera, c.costs] for c in x.candidates])
    if callable(x):
        return np.asarray(x([[100.0, 50.0], [320.0, 240.0]])).ravel()
    for names in (("A", "poses", "covariance"), ("W", "m"), ("m",), ("depth",), ("vertices",)):
        if all(hasattr(x, name) for name in names):
            return numbers_of([getattr(x, name) for name in names])
    if hasattr(x, "poses"):
        return numbers_of([x.poses, x.covariance])
    return np.asarray(x.image if hasattr(x, "image") else x, dtype=float).ravel()


GOOD = {}


def good_answer(function):
    """Give the numbers of the answer to good arguments, computed once for all rows."""
    if id(function) not in GOOD:
        GOOD[id(function)] = numbers_of(answer(function))
        GOOD[id(function)].setflags(write=False)
    return GOOD[id(function)]


def outcome(function, /, **changed):
    """Give the numbers of the answer, or the error of ours that took its place."""
    try:
        return numbers_of(answer(function, **changed))
    except OURS as error:
        return error


def refusal(function, name, value):
    """Give the message with which an argument is refused."""
    result = outcome(function, **{name: value})
    assert isinstance(result, OURS), f"{function}: {name} = {value!r:.80} was accepted"
    return str(result)


def with_first(x, value):
    x = np.array(x, dtype=float)
    x.flat[0] = value
    return x


def every_array(keep):
    """Give all functions, each with those of its array arguments that `keep` wants, if any."""
    for function in FUNCTIONS:
        if arrays := {name: a for name, a in function.arrays.items() if keep(a)}:
            yield function, arrays


def row(number, keep=lambda _: True):
    """Make one test of what is asked of a function and its arrays; all that fail are named."""
    return of_all(f"row {number}", list(every_array(keep)))


def of_all(what, cases):
    """Make one test that asks the same of all cases, and says which functions fail, and how."""
    assert cases

    def asking(ask):
        def test(same_chances):
            failed, first = [], None
            for function, *more in cases:
                same_chances()
                try:
                    ask(function, *more)
                except (Exception, pytest.fail.Exception) as error:
                    first = first or error
                    failed.append(f"{function}: {type(error).__name__}: {error}")
            if failed:
                text = f"{what}: {len(failed)} of {len(cases)} functions fail\n"
                raise AssertionError(text + "\n".join(failed)) from first

        test.__name__, test.__doc__ = ask.__name__, ask.__doc__
        return test

    return asking


def is_numeric(argument):
    return not argument.picture


def has_columns(argument):
    return argument.columns is not None


@of_all("good arguments", [(function,) for function in FUNCTIONS])
def test_good_arguments_are_answered_without_a_doubt_that_is_not_ours(function):
    good_answer(function)  # neither an error nor a warning, which would be one here


@row(1, is_numeric)
def test_nan_is_refused_by_the_arguments_name(function, arrays):
    for name in arrays:
        good = np.asarray(function.good[name], dtype=float)
        last = good.copy()
        last.flat[-1] = np.nan
        for x in (with_first(good, np.nan), last, np.full(good.shape, np.nan)):
            message = refusal(function, name, x)
            assert message.startswith(name), message
            assert "NaN or infinite" in message, message


@row(2, is_numeric)
def test_infinity_is_refused_by_the_arguments_name(function, arrays):
    for name in arrays:
        for value in (np.inf, -np.inf):
            message = refusal(function, name, with_first(function.good[name], value))
            assert message.startswith(name), message
            assert "NaN or infinite" in message, message


@pytest.mark.slow
@row(3)
def test_numbers_near_the_largest_never_overflow_and_never_come_out_as_garbage(function, arrays):
    # Overflow would be a RuntimeWarning, and so an error here.
    for name, argument in arrays.items():
        good = np.asarray(function.good[name], dtype=float)
        for huge in (1e100, 1e150, 7e153, 1e200, 1e308, -1e308, 1e-308, 5e-324):
            spoilt = (with_first(good, huge), np.full(good.shape, huge), good * (huge / 1e5))
            for x in {x.tobytes(): x for x in spoilt}.values():  # of one number, two are the same
                result = outcome(function, **{name: x})
                if argument.homogeneous or argument.picture or np.abs(x).max() < 1e180:
                    continue
                if function.name.startswith(SCALE_FREE):
                    continue
                assert isinstance(result, CvnotesError) or not np.isfinite(result).all(), name


# Divide by the largest number before anything else.
SCALE_FREE = ("projective.points.from_homogeneous", "projective.points.same_up_to_scale")


@row(3, lambda argument: argument.homogeneous)
def test_homogeneous_numbers_mean_the_same_in_any_scale(function, arrays):
    expected = good_answer(function)
    for name in arrays:
        for scale in (1e200, 1e-200, -1e300):
            result = numbers_of(answer(function, **{name: scale * function.good[name]}))
            largest = np.abs(result).max() or 1.0
            size = np.abs(expected).max() or 1.0
            assert np.allclose(np.abs(result / largest), np.abs(expected / size), atol=1e-12)


@row(4)
def test_empty_arrays_are_refused_or_answered_by_nothing(function, arrays):
    for name, argument in arrays.items():
        good = np.asarray(function.good[name])
        empties = ([], np.zeros((0, *good.shape)), np.zeros((0, *good.shape[1:])), np.zeros((0, 0)))
        for x in empties if good.ndim else [[]]:
            result = outcome(function, **{name: x})
            allowed = isinstance(result, Exception) or result.size == 0
            assert allowed or name in MAY_BE_EMPTY.get(str(function), ()), (name, np.shape(x))
            if argument.columns and not argument.empty and len(np.shape(x)) <= good.ndim:
                refused = isinstance(result, Exception) or np.shape(x)[0] == 0 < good.ndim - 2
                assert refused or name in MAY_BE_EMPTY.get(str(function), ()), (name, np.shape(x))


# A lens without radial terms; a scene without triangles, in which rays meet nothing; views without
# corners, which cover none of the cells.
MAY_BE_EMPTY = {
    "lens.Lens": ("k",),
    "rational.RationalLens": ("k",),
    "fisheye.FisheyeLens": ("k",),
    "pictures.raycast.first_hits": ("corners",),
    "calibration.coverage.covered_cells": ("image_points",),
}


@row(5, has_columns)
def test_points_as_columns_are_refused_and_never_turned_in_silence(function, arrays):
    for name, argument in arrays.items():
        x = np.asarray(function.good[name])
        if x.ndim > 1 and x.shape[-2] not in argument.columns:
            turned = np.swapaxes(x, -1, -2)
            assert str(turned.shape) in refusal(function, name, turned)


@row(6, has_columns)
def test_a_column_too_few_or_too_many_is_refused_with_both_shapes(function, arrays):
    for name, argument in arrays.items():
        x = np.asarray(function.good[name])
        for columns in (1, max(argument.columns) + 1):
            wrong = np.resize(x, (*x.shape[:-1], columns))
            message = refusal(function, name, wrong)
            assert str(wrong.shape) in message or "of one space" in message, message
            assert name in message or "of one space" in message, message


@of_all("row 7", [(function,) for function in FUNCTIONS if function.paired])
def test_points_without_partners_are_refused_with_both_numbers(function):
    short, full = (np.asarray(function.good[name]) for name in function.paired)
    n = full.shape[-2]
    for name, x in zip(function.paired, (short, full), strict=True):
        message = refusal(function, name, x[..., : n - 1, :])
        assert str(n) in message, message
        assert str(n - 1) in message, message


@row(8, has_columns)
def test_flattened_points_and_single_numbers_are_refused(function, arrays):
    for name, argument in arrays.items():
        x = np.asarray(function.good[name])
        assert name in refusal(function, name, 1.0)
        if x.size not in argument.columns:
            refusal(function, name, x.ravel())
        if 1 not in argument.columns:
            refusal(function, name, x[..., None])


NO_NUMBERS = {
    "text": "abc",
    "texts": ["a", "b"],
    "numbers as text": np.array([["1", "2"], ["3", "4"]]),
    "None among numbers": np.array([None, 1.0]),
    "complex": np.ones((3, 2)) + 1j,
    "dates": np.array(["2020-01-01", "2020-01-02"], dtype="M8[D]"),
    "durations": np.array([1, 2], dtype="m8[s]"),
    "dict": {1: 2},
    "set": {1.0, 2.0},
    "frozenset": frozenset([1.0]),
    "ragged": [[1, 2], [3]],
    "bytes": b"ab",
    "function": len,
    "module": np,
    "booleans": np.ones((4, 4), dtype=bool),
    "fields": np.zeros(3, dtype=[("a", float)]),
    "decimal": Decimal(1),
    "fractions": [Fraction(1, 2), Fraction(1, 3)],
}


@row(9)
def test_what_is_no_array_of_real_numbers_is_refused_as_such(function, arrays):
    for name, argument in arrays.items():
        values = {**NO_NUMBERS, "generator": (i for i in range(3)), "iterator": iter([1.0, 2.0])}
        if argument.picture:
            del values["booleans"]  # refused too, but not everywhere by type
        for what, value in values.items():
            result = outcome(function, **{name: value})
            assert isinstance(result, OURS), (name, what)
            assert name in str(result), (name, what, str(result))


@row(10)
def test_none_is_refused_by_name_where_it_does_not_mean_the_default(function, arrays):
    parameters = inspect.signature(function.call).parameters
    for name in arrays:
        if name not in parameters or parameters[name].default is not None:
            message = refusal(function, name, None)
            assert name in message, message
            assert "None" in message, message
            assert "attribute" not in message, message


@row(11)
def test_what_fails_while_becoming_an_array_is_an_error_of_type_with_its_reason(function, arrays):
    for name in arrays:
        with pytest.raises(InputTypeError, match="not today") as caught:
            answer(function, **{name: Unwilling()})
        assert isinstance(caught.value.__cause__, RuntimeError)


@pytest.mark.slow
@row(12)
def test_the_same_numbers_in_another_dress_give_the_same_answer(function, arrays):
    dressed = {name: dresses(function.good[name], arrays[name].picture) for name in arrays}
    for turn in range(max(map(len, dressed.values()))):
        # Each array wears each dress once, and another one than the array beside it.
        chosen = {}
        for place, (name, wardrobe) in enumerate(dressed.items()):
            chosen[name] = list(wardrobe)[(turn + place) % len(wardrobe)]
        worn = {name: dressed[name][dress] for name, dress in chosen.items()}
        result = numbers_of(answer(function, **worn))
        expected = good_answer(function)
        assert np.allclose(result, expected, rtol=1e-9, atol=1e-9, equal_nan=True), chosen


def dresses(good, picture):
    """Give the same numbers as other objects, by what they are."""
    x = np.asarray(good)
    worn = {"big-endian": x.astype(x.dtype.newbyteorder(">"))}
    if not picture:  # its dtype would be lost in a list
        worn["list"] = x.tolist()
    worn["tuple"] = tuple(x.tolist()) if x.ndim else float(x)
    if x.ndim:
        worn["subclass"] = x.view(Relative)
        worn["Fortran order"] = np.asfortranarray(x)
        worn["strided"] = np.repeat(x, 2, axis=0)[::2]
        worn["backwards"] = np.flip(np.flip(x).copy())
    return worn


@pytest.mark.slow
@row(13)
def test_read_only_input_is_read_and_no_input_is_written_to(function, arrays):
    before = {name: np.array(function.good[name]) for name in arrays}
    own = {name: x.copy() for name, x in before.items()}
    numbers_of(answer(function, **own))
    for name, x in own.items():
        assert np.array_equal(x, before[name]), name
        x.setflags(write=False)
    numbers_of(answer(function, **own))


@pytest.mark.slow
@row(14, is_numeric)
def test_whole_numbers_are_computed_with_like_any_others(function, arrays):
    for name in arrays:
        x = np.asarray(function.good[name])
        of_floats = {}  # most wholes are the same in 16 bits as in 64
        for dtype in (np.int64, np.int16, np.uint8, np.int8):
            info = np.iinfo(dtype)
            # a smaller picture if need be: cut off at 127, its views would be of no board
            fitting = x * min(1, info.max / np.abs(x).max(initial=1))
            whole = np.clip(np.rint(fitting), info.min, info.max).astype(dtype)
            result = outcome(function, **{name: whole})
            same = whole.astype(float)
            if same.tobytes() not in of_floats:
                of_floats[same.tobytes()] = outcome(function, **{name: same})
            expected = of_floats[same.tobytes()]
            if isinstance(expected, Exception):
                assert type(result) is type(expected)
            else:
                assert np.allclose(result, expected, 1e-9, 1e-9, equal_nan=True), (name, dtype)


@row(15)
def test_masks_are_not_dropped_in_silence_and_long_doubles_are_read(function, arrays):
    for name in arrays:
        x = np.asarray(function.good[name])
        assert "masked" in refusal(function, name, np.ma.array(x, mask=x == x.max()))
        if x.ndim:
            assert "masked" in refusal(function, name, [np.ma.array(r, mask=True) for r in x])
    good = {name: function.good[name] for name in arrays if not arrays[name].picture}
    if good:
        wide = {name: np.asarray(x).astype(np.longdouble) for name, x in good.items()}
        result = numbers_of(answer(function, **wide))
        assert np.array_equal(result, good_answer(function), equal_nan=True)


BAD_SIZES = [
    "1280x960",
    b"ab",
    (480,),
    (640, 480, 3),
    (0, 480),
    (640, -480),
    (640.5, 480),
    (np.nan, 480),
    (np.inf, 480),
    (10**400, 480),
    ("640", "480"),
    (True, True),
    (None, 480),
    {640, 480},
    {640: 1, 480: 2},
    (x for x in (640, 480)),
    [[640], [480]],
    np.ma.array([640, 480], mask=[True, False]),
    640,
]


@of_all("row 16", [(function,) for function in FUNCTIONS if function.sizes])
def test_a_size_is_width_and_height_in_whole_pixels(function):
    for name in function.sizes:
        for size in BAD_SIZES:
            message = refusal(function, name, size)
            assert message.startswith(name), message
            assert "(width, height)" in message, message


@pytest.mark.parametrize("n", [0, 1, 2, 3, 6, 7, 9, 17], ids=lambda n: f"row 17: {n} coefficients")
def test_opencvs_coefficients_are_four_or_five(n):
    with pytest.raises(CvnotesError, match="expected 4 or 5 coefficients"):
        lens_from_opencv(np.full(n, 0.1))


@of_all("row 18", [(function,) for function in FUNCTIONS])
def test_a_misspelt_keyword_is_never_swallowed(function):
    with pytest.raises(TypeError, match="unexpected keyword argument"):
        answer(function, lense="k1 k2")


def test_the_first_nan_is_shown_its_place():
    H = np.tile(np.eye(3), (4, 1, 1))
    H[2, 0, 1] = np.nan
    with pytest.raises(CvnotesError, match=r"^H contains NaN .*first at \[2, 0, 1\]"):
        matrix(H, "H", 3, 3)


def names_of_tests():
    """Give the names of all tests, as file::test, without ``test_``."""
    for path in TESTS.glob("test_*.py"):
        for name in re.findall(r"^ *def test_(\w+)\(", path.read_text("utf-8"), re.MULTILINE):
            yield f"{path.stem.removeprefix('test_')}::{name}"


def test_every_row_of_the_catalogue_has_its_tests():
    assert sorted([*HERE, *ELSEWHERE]) == list(range(1, 136))
    known = set(names_of_tests())
    missing = {n: t for n, (_, *ts) in ELSEWHERE.items() for t in ts if t not in known}
    assert not missing
    assert all(len(entry) > 1 for entry in ELSEWHERE.values())


# Functions that take arrays but are not tried, and why.
EXEMPT = {
    "AnyLens.of_rays": "abstract; those of the lenses are tried",
    "AnyLens.rays": "abstract; those of the lenses are tried",
    "bilinear": "a formula for arrays of grey levels, without a guard",
    "compress": "whole grey levels of 8 bits only; its refusals are in test_sensor.py",
    "box": "three intervals; its colours are guarded by `quads`",
    "checked_fill": "a guard",
    "coordinates": "a guard",
    "enough_views": "a guard; the choices that call it are tried",
    "hold_at": "a target and a camera; see test_views.py",
    "pushed_into_corner": "a target and a camera; see test_views.py",
    "homogeneous": "a guard",
    "homogeneous_columns": "for use inside maps",
    "homographies": "a guard",
    "joined": "for use inside; `covered_cells` is tried",
    "pairs": "a guard",
    "paired_points": "a guard; those that it serves are tried",
    "Scene.moved": "guarded by `rigid.rigid_motion`; see test_meshes.py",
    "render": "a target and a camera; see test_synthetic.py",
    "room_with": "guarded by `target_scene`",
    "target_scene": "guarded by `rigid.rigid_motion`; see test_scenes.py",
    "vectors": "a guard",
}


def public_functions():
    """Give module and name of all functions and methods that take array_like arguments."""
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(PACKAGE).with_suffix("").parts
        if parts[0] in ("learn", "commands") or parts[:2] == ("show", "explorations"):
            continue
        tree = ast.parse(path.read_text(encoding="utf-8"))
        scopes = [("", tree.body)]
        scopes += [(c.name + ".", c.body) for c in tree.body if isinstance(c, ast.ClassDef)]
        for prefix, body in scopes:
            for node in body:
                if not isinstance(node, ast.FunctionDef) or node.name.startswith("_"):
                    continue
                arguments = node.args.posonlyargs + node.args.args + node.args.kwonlyargs
                hints = " ".join(ast.unparse(a.annotation) for a in arguments if a.annotation)
                guarded = any("guarded(" in ast.unparse(d) for d in node.decorator_list)
                if guarded or "ArrayLike" in hints or "PointSets" in hints:
                    yield prefix + node.name


def test_every_public_function_that_takes_arrays_is_tried():
    tried = {str(function).split(".", 1)[1] for function in FUNCTIONS}
    for name in public_functions():
        known = any(other == name or other.endswith("." + name) for other in tried)
        assert known or name in EXEMPT, f"{name}: add it to tests/public_face.py"


TAKES_AXES = [f for f in FIGURES if "ax" in inspect.signature(f.call).parameters]


@pytest.mark.parametrize("function", TAKES_AXES, ids=str)
def test_several_panels_are_not_one(function):
    with pytest.raises(InputTypeError, match=r"ax: expected the axes of one panel.*left, right ="):
        function.call(**function.good, ax=panels(2))
