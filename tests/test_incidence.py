import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from test_theorems import lies_on

from cvnotes.base import CvnotesError, DegenerateError, InputTypeError, ShapeError
from cvnotes.camera import Camera, intrinsics, look_at
from cvnotes.projective import (
    PLANE_AT_INFINITY,
    cross_ratio,
    direction_to_homogeneous,
    from_homogeneous,
    join,
    line_through,
    meet,
    meet_plane,
    same_up_to_scale,
)

RNG = np.random.default_rng(7)
whole = st.integers(-50, 50)
plane_vectors = st.tuples(whole, whole, whole).filter(any)
space_vectors = st.tuples(whole, whole, whole, whole).filter(any)
H2 = np.array([[1.0, 0.2, 5], [-0.1, 0.9, 3], [0.01, 0.02, 1]])


def space_map():
    return RNG.normal(size=(4, 4)) + 4 * np.eye(4)


# --- in the plane --------------------------------------------------------------------------------


@given(a=plane_vectors, b=plane_vectors)
def test_a_line_through_two_points_contains_both(a, b):
    assume(np.cross(a, b).any())
    line = join(a, b)
    assert line @ a == 0  # whole numbers leave nothing to rounding
    assert line @ b == 0
    assert lies_on([a, b], line).all()


@given(k=plane_vectors, m=plane_vectors)
def test_the_point_of_two_lines_lies_on_both(k, m):
    assume(np.cross(k, m).any())
    assert lies_on(meet(k, m), [k, m]).all()


def test_lines_and_points_by_hand():
    # x + y = 3 and y = 2x meet in (1, 2)
    assert from_homogeneous(meet([1, 1, -3], [2, -1, 0])).tolist() == [1, 2]
    assert same_up_to_scale(join([0, 3, 1], [3, 0, 1]), [1, 1, -3])


def test_parallel_lines_meet_at_infinity_in_their_direction():
    point = meet([3, 4, -5], [3, 4, 70])
    assert point[2] == 0
    assert same_up_to_scale(point, [4, -3, 0])


@pytest.mark.parametrize("factor", [1, -1, np.pi, 1e-9, -1e12, 1e-250, 1e250])
def test_what_coincides_up_to_a_factor_is_found_out(factor):
    for x in ([1, 2, 3], [123.4, 567.8, 1], [1e6, -3e5, 1]):
        with pytest.raises(DegenerateError, match="points coincide"):
            join(x, factor * np.array(x))
        with pytest.raises(DegenerateError, match="lines coincide"):
            meet(factor * np.array(x), x)


def test_neighbours_far_from_the_origin_do_not_coincide():
    for step in (1.0, 2.0**-16):
        assert same_up_to_scale(join([1e6, 2e6, 1], [1e6 + step, 2e6, 1]), [0, 1, -2e6])


@pytest.mark.parametrize("factor", [-1, 1e-200, 1e300])
def test_factors_do_not_matter_however_large(factor):
    a, b = np.array([1.0, 2, 1]), np.array([4.0, 3, 1])
    assert same_up_to_scale(join(factor * a, b), join(a, factor * b))
    assert same_up_to_scale(join(factor * a, factor * b), join(a, b))


def test_stacks_are_joined_row_by_row():
    a, b = RNG.normal(size=(2, 5, 7, 3))
    lines = join(a, b)
    assert lines.shape == (5, 7, 3)
    np.testing.assert_allclose((lines * a).sum(-1), 0, atol=1e-14)
    infinity = np.array([0.0, 0, 1])
    assert lies_on(meet(lines, infinity), infinity).all()


# --- in space ------------------------------------------------------------------------------------


@given(a=space_vectors, b=space_vectors, p=space_vectors)
def test_a_line_of_space_meets_a_plane_in_a_point_of_both(a, b, p):
    assume(np.linalg.matrix_rank([a, b]) == 2)
    L = line_through(a, b)
    assert (L == -L.T).all()
    if np.any([np.dot(p, a), np.dot(p, b)]):
        point = meet_plane(L, p)
        assert lies_on(point, p)
        assert np.linalg.matrix_rank(np.array([a, b, point]) / np.abs(point).max()) <= 2


def test_a_line_at_infinity_meets_other_planes_there():
    L = line_through([2, -1, 0, 0], [3, 0, -1, 0])  # of all planes (1, 2, 3, d)
    with pytest.raises(DegenerateError, match="lies in the plane"):
        meet_plane(L, PLANE_AT_INFINITY)
    x = meet_plane(L, [1, 0, 0, 0])
    assert x[3] == 0
    assert x[:3] @ [1, 2, 3] == 0


def test_parallel_lines_of_space_meet_on_the_plane_at_infinity():
    d = np.array([1.0, -2, 0.5])
    ends = [meet_plane(line_through([*a, 1], [*(a + d), 1]), PLANE_AT_INFINITY)
            for a in RNG.normal(size=(3, 3))]  # fmt: skip
    for end in ends:
        assert same_up_to_scale(end, direction_to_homogeneous(d))
        assert lies_on(end, PLANE_AT_INFINITY)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: line_through([1, 2, 3, 4], [-2, -4, -6, -8]), "points coincide"),
    ],
)
def test_what_is_not_determined_is_refused_in_words(call, words):
    with pytest.raises(DegenerateError, match=words):
        call()


# --- under a map ---------------------------------------------------------------------------------


def test_a_pixels_line_spans_a_plane_through_the_camera():
    camera = Camera(intrinsics(800, 805, 320, 240), look_at([30, -20, -90], [5, 4, 0]))
    W = np.concatenate([RNG.normal(scale=5, size=(2, 3)), np.ones((2, 1))], axis=1)
    plane = join(*(W @ camera.P.T)) @ camera.P  # p = Pᵀ l
    assert lies_on([*W, [*camera.centre, 1]], plane).all()


# --- cross-ratio ---------------------------------------------------------------------------------


def test_the_cross_ratio_by_hand():
    # t = 0, 1, 3, 6: (3 − 0)(6 − 1) / ((3 − 1)(6 − 0)) = 15/12
    points = [[2 + t, 5 - 2 * t, 1] for t in (0, 1, 3, 6)]
    assert cross_ratio(*points) == pytest.approx(1.25, abs=1e-13)


def test_with_a_point_at_infinity_it_is_a_simple_ratio():
    a, b, c = ([2 + t, 5 - 2 * t, 1] for t in (0, 1, 3))
    assert cross_ratio(a, b, c, [1, -2, 0]) == pytest.approx(3 / 2, abs=1e-13)


def test_no_projective_map_changes_the_cross_ratio():
    for d, H in ((3, H2), (4, space_map())):
        a, b = RNG.normal(size=(2, d))
        points = [np.cos(t) * a + np.sin(t) * b for t in (0.1, 0.5, 1.4, 2.2)]
        before = cross_ratio(*points)
        assert cross_ratio(*(H @ x for x in points)) == pytest.approx(before, rel=1e-9)
        assert cross_ratio(*(k * x for k, x in zip((-1, 1e6, 1e-6, 3), points, strict=True))) == (
            pytest.approx(before, rel=1e-9)
        )


def test_a_camera_does_not_change_the_cross_ratio_but_does_change_ratios():
    camera = Camera(intrinsics(800, 805, 320, 240), look_at([30, -20, -90], [5, 4, 0]))
    W = np.array([[0.0, 0, 0], [10, 5, 20], [20, 10, 40], [30, 15, 60]])
    m = camera.project(W)
    lifted = [[*x, 1] for x in m]
    assert cross_ratio(*lifted) == pytest.approx(4 / 3, rel=1e-9)
    steps = np.linalg.norm(np.diff(m, axis=0), axis=1)
    assert steps[0] / steps[2] > 1.2


def test_coinciding_points_give_0_or_1_or_infinity_and_three_of_them_nothing():
    a, b, c = [0, 0, 1], [1, 0, 1], [2, 0, 1]
    assert cross_ratio(a, b, a, c) == pytest.approx(0, abs=1e-15)
    assert cross_ratio(a, a, b, c) == pytest.approx(1, abs=1e-15)
    assert abs(cross_ratio(a, b, b, c)) > 1e12
    with pytest.raises(DegenerateError, match="three of the four"):
        cross_ratio(a, b, a, a)
    with pytest.raises(DegenerateError, match="do not lie on one line"):
        cross_ratio(a, b, c, [3, 1e-3, 1])


# --- guards --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: join([0, 0, 0], [1, 2, 3]), CvnotesError, "a: the zero vector is not a point"),
        (lambda: meet([1, 2, 3], [0, 0, 0]), CvnotesError, "m: the zero vector is not a line"),
        (lambda: join([1, 2], [1, 2, 3]), ShapeError, r"a: expected .*\(\.\.\., 3\), got \(2,\)"),
        (lambda: join([1, np.nan, 3], [1, 2, 3]), CvnotesError, "a contains NaN"),
        (lambda: join("abc", [1, 2, 3]), InputTypeError, "numeric"),
    ],
)
def test_unusable_input_is_refused_in_words(call, error, words):
    with pytest.raises(error, match=words):
        call()
