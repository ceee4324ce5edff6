import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cvnotes.base import CvnotesError, InputTypeError, ShapeError
from cvnotes.projective import (
    apply,
    direction_to_homogeneous,
    from_homogeneous,
    same_up_to_scale,
    to_homogeneous,
)

coordinates = st.floats(-1e6, 1e6)
factors = st.floats(1e-6, 1e6) | st.floats(-1e6, -1e-6)


def test_lifting_appends_a_one_and_keeps_the_point():
    # the notes' printed form puts k in the place of z: erratum E1
    assert to_homogeneous([2, 3, 4]).tolist() == [2, 3, 4, 1]
    assert to_homogeneous([[2, 3], [4, 5]]).tolist() == [[2, 3, 1], [4, 5, 1]]


def test_a_direction_is_lifted_with_a_zero_and_has_no_place():
    assert direction_to_homogeneous([0, 0, 1]).tolist() == [0, 0, 1, 0]
    assert np.isnan(from_homogeneous([0, 0, 1, 0])).all()


@given(x=st.lists(coordinates, min_size=1, max_size=4), k=factors)
def test_any_factor_stands_for_the_same_point(x, k):
    np.testing.assert_allclose(from_homogeneous(k * to_homogeneous(x)), x, rtol=1e-14, atol=1e-12)
    assert same_up_to_scale(to_homogeneous(x), k * to_homogeneous(x))


def test_the_origin_is_a_point_but_the_zero_vector_is_not():
    assert from_homogeneous([0, 0, 0, 7]).tolist() == [0, 0, 0]
    assert np.isnan(from_homogeneous([0, 0, 0, 0])).all()
    with pytest.raises(CvnotesError, match="zero vector stands for no point"):
        same_up_to_scale([0, 0, 0], [1, 2, 3])


def test_only_an_exact_zero_is_at_infinity_and_the_other_rows_do_not_notice():
    x = from_homogeneous([[1, 2, 0.0], [1, 2, -0.0], [1, 2, 1e-300], [1, 2, 5e-324], [6, 4, 2]])
    assert np.isnan(x[:2]).all()
    np.testing.assert_allclose(x[2], [1e300, 2e300], rtol=1e-15)
    assert np.isinf(x[3]).all()
    assert x[4].tolist() == [3, 2]


def test_equality_up_to_scale_needs_one_factor_for_all_entries():
    assert same_up_to_scale([1, 0, 0], [-1e200, 0, 0])
    assert same_up_to_scale(np.diag([1.0, 2, 3]), np.diag([1e-9, 2e-9, 3e-9]))
    assert not same_up_to_scale([1, 2, 3], [1, 2, -3])
    assert not same_up_to_scale([1, 0, 0], [0, 1, 0])
    assert same_up_to_scale([1, 2, 3], [1, 2, 3.001], atol=1e-3)
    assert not same_up_to_scale([1, 2, 3], [1, 2, 3.1], atol=1e-3)


def test_a_map_by_hand():
    H = [[2, 0, 1], [0, 3, 0], [1, 0, 1]]
    # (1, 2, 1) → (3, 6, 2)
    assert apply(H, [1, 2]).tolist() == [1.5, 3.0]
    # (−1, 2, 1) → (−1, 6, 0): at infinity
    assert np.isnan(apply(H, [[-1, 2], [1, 2]])).all(axis=1).tolist() == [True, False]


@given(
    H=st.lists(st.floats(-1, 1), min_size=9, max_size=9),
    K=st.lists(st.floats(-1, 1), min_size=9, max_size=9),
    x=st.tuples(st.floats(-2, 2), st.floats(-2, 2)),
)
def test_the_map_of_a_composition_is_the_composition_of_the_maps(H, K, x):
    H, K = (np.reshape(m, (3, 3)) + 5 * np.eye(3) for m in (H, K))
    np.testing.assert_allclose(apply(H @ K, x), apply(H, apply(K, x)), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(apply(np.linalg.inv(H), apply(H, x)), x, rtol=1e-9, atol=1e-9)


def test_the_factor_of_H_does_not_matter():
    H, x = np.array([[1, 0.1, 5], [0.2, 1, -3], [1e-3, 2e-3, 1]]), np.array([[10.0, 20], [-5, 7]])
    for k in (-1, 1e-12, 1e12):
        np.testing.assert_allclose(apply(k * H, x), apply(H, x), rtol=1e-13)


def test_a_stack_of_maps_maps_a_stack_of_point_sets():
    rng = np.random.default_rng(0)
    H, x = rng.normal(size=(4, 3, 3)), rng.normal(size=(4, 6, 2))
    for i in range(4):
        np.testing.assert_allclose(apply(H, x)[i], apply(H[i], x[i]), atol=1e-12)
    assert apply(rng.normal(size=(3, 4)), rng.normal(size=(5, 3))).shape == (5, 2)  # P³ → P²


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: apply(np.eye(3), [1, 2, 3]), ShapeError, "one column more than a point"),
        (lambda: apply([1, 2, 3], [1, 2]), ShapeError, "cannot map"),
        (lambda: apply(np.eye(3), [np.nan, 0]), CvnotesError, "x contains NaN"),
        (lambda: apply(np.full((3, 3), np.inf), [0, 0]), CvnotesError, "H contains NaN"),
        (lambda: to_homogeneous(5), ShapeError, "got a single number"),
        (lambda: to_homogeneous("12"), InputTypeError, "numeric"),
        (lambda: to_homogeneous([[1, 2], [3]]), InputTypeError, "numeric array"),
        (lambda: from_homogeneous(None), InputTypeError, "got None"),
        (lambda: same_up_to_scale([1, 2], [1, 2, 3]), ShapeError, r"\(2,\) but b has \(3,\)"),
    ],
)
def test_unusable_input_is_refused_in_words(call, error, words):
    with pytest.raises(error, match=words):
        call()
