"""The decorator of guards: the body of a function is its formula, and is what a student reads."""

import inspect

import numpy as np
import pytest

from cvnotes.base import DegenerateError, Points, ShapeError, guarded
from cvnotes.camera import Lens, px_from_xy
from cvnotes.projective import from_homogeneous, join


@guarded(a=Points(2), b=Points(2), pair=("a", "b"), at_least=2)
def middle(a, b, weight=0.5):
    """Give the points between."""
    return (1 - weight) * a + weight * b


def test_the_source_shows_guards_and_formula_and_the_signature_stays():
    source = inspect.getsource(middle)
    assert "Points(2)" in source
    assert "(1 - weight) * a" in source
    assert list(inspect.signature(middle).parameters) == ["a", "b", "weight"]
    assert middle.__doc__ == "Give the points between."
    assert middle.__wrapped__ is middle.inside


def test_arguments_are_guarded_by_place_and_by_name():
    for call in (lambda x: middle(x, [[0, 0]]), lambda x: middle(b=[[0, 0]], a=x)):
        with pytest.raises(ShapeError, match=r"^a: expected shape \(\.\.\., 2\), got \(1, 3\)"):
            call([[1, 2, 3]])
    with pytest.raises(ShapeError, match="a has 2 points but b has 3"):
        middle(np.zeros((2, 2)), np.zeros((3, 2)))
    with pytest.raises(DegenerateError, match="need at least 2 points, got 1"):
        middle([[0, 0]], [[0, 0]])


def test_a_call_that_python_refuses_is_refused_in_pythons_words():
    x = np.zeros((2, 2))
    with pytest.raises(TypeError, match=r"middle\(\) missing 1 required positional argument: 'b'"):
        middle(x)
    with pytest.raises(TypeError, match="takes from 2 to 3 positional arguments but 4 were given"):
        middle(x, x, 0.5, 1)
    with pytest.raises(TypeError, match="multiple values for argument 'a'"):
        middle(x, x, a=x)
    with pytest.raises(TypeError, match="unexpected keyword argument 'wieght'"):
        middle(x, x, wieght=1)


def test_inside_nothing_is_guarded_or_copied():
    xy = np.array([[0.1, np.nan]])
    assert np.isnan(px_from_xy.inside(np.eye(3), xy)).any()
    assert Lens.distort.inside(Lens(), xy) is xy
    with pytest.raises(TypeError, match="can't multiply sequence"):
        middle.inside([[0, 0]], [[1, 1]])


def test_a_formula_leaves_its_callers_array_alone():
    x = np.array([[4.0, 2.0], [1.0, 0.0]])
    before = x.copy()
    from_homogeneous(x)
    Lens(k=(0.1,), p=(0.01, 0.02)).distort(x)
    np.testing.assert_array_equal(x, before)


def test_what_does_not_fit_together_is_named_after_the_arguments():
    with pytest.raises(ShapeError, match=r"^a and b are not equally many"):
        join(np.ones((2, 3)), np.ones((5, 3)))
