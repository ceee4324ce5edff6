import tracemalloc

import numpy as np
import pytest
from scipy.optimize import least_squares

from cvnotes.base import CvnotesError, DegenerateError, InputTypeError, ShapeError
from cvnotes.homography import (
    design_matrix,
    dlt,
    four_points_h9_one,
    four_points_unit_norm,
    geometric_error,
    normaliser,
    refine_homography,
)

SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
QUAD = np.array([[102.0, 55], [410, 80], [390, 300], [90, 260]])
THREE_ON_A_LINE = np.array([[0.0, 0], [1, 1], [2, 2], [0, 3]])
LINE = np.array([[i, 2.0 * i + 1] for i in range(6)])
GRID = np.stack(np.meshgrid(np.arange(9.0), np.arange(6.0)), -1).reshape(-1, 2)


def unit(H):
    """‖H‖ = 1, so that two homographies can be compared."""
    H = np.asarray(H, float)
    return H / np.linalg.norm(H, axis=(-2, -1), keepdims=True)


def mapped(H, x):
    """π(H x), written out."""
    u, v, w = np.moveaxis(np.einsum("...ij,...nj->...ni", H, np.c_[x, np.ones(len(x))]), -1, 0)
    return np.stack([u / w, v / w], -1)


def random_homographies(n, rng):
    """Boards of 8×5 units seen in a picture of about 640×480, each in front of the camera."""
    H = np.array([[50.0, 0, 120], [0, 50, 100], [0, 0, 1]])
    H = H + rng.normal(size=(n, 3, 3)) * [[10, 10, 40], [10, 10, 40], [0.01, 0.01, 0]]
    return H


def test_normalised_points_have_centroid_0_and_mean_distance_root_2():
    x = np.random.default_rng(0).normal(size=(4, 7, 2)) * [300, 2] + [1e4, -5]
    n = np.stack([mapped(N, points) for N, points in zip(normaliser(x), x, strict=True)])
    assert np.allclose(n.mean(1), 0, atol=1e-9)
    assert np.allclose(np.linalg.norm(n, axis=-1).mean(1), np.sqrt(2), atol=1e-9)


def test_the_design_matrix_holds_two_rows_of_the_cross_product():
    rng = np.random.default_rng(1)
    (x, y), (u, v) = src, dst = rng.normal(size=(2, 2))
    W = [x, y, 1]
    # m̃ × (H W̃') with h1, h2, h3 the rows of H
    cross = np.array(
        [
            [0, 0, 0, *(-c for c in W), *(v * c for c in W)],
            [*W, 0, 0, 0, *(-u * c for c in W)],
            [*(-v * c for c in W), *(u * c for c in W), 0, 0, 0],
        ]
    )
    D = design_matrix([src], [dst])
    assert np.allclose(D, cross[:2], atol=1e-12)
    assert np.allclose(cross[2], -u * D[0] - v * D[1], atol=1e-12)  # says nothing new


def test_the_true_h_is_a_null_vector_of_the_design_matrix():
    H = random_homographies(1, np.random.default_rng(2))[0]
    assert np.allclose(design_matrix(GRID, mapped(H, GRID)) @ H.ravel(), 0, atol=1e-9)


@pytest.mark.parametrize("n", [4, 5, 54])
def test_dlt_gives_back_the_map_that_made_exact_points(n):
    rng = np.random.default_rng(n)
    for H in random_homographies(20, rng):
        src = SQUARE * 5 if n == 4 else rng.uniform(0, 8, (n, 2))
        assert np.allclose(dlt(src, mapped(H, src)), unit(H), atol=1e-11)


def test_dlt_has_norm_1_and_the_sign_of_points_in_front_of_the_camera():
    rng = np.random.default_rng(3)
    for H in random_homographies(10, rng):
        found = dlt(GRID, mapped(-3 * H, GRID))
        assert np.linalg.norm(found) == pytest.approx(1, abs=1e-12)
        assert (np.c_[GRID, np.ones(54)] @ found[2] > 0).all()


def test_one_board_serves_a_stack_of_views_and_a_stack_is_each_one_by_itself():
    rng = np.random.default_rng(4)
    seen = mapped(random_homographies(6, rng), GRID) + rng.normal(size=(6, 54, 2))
    stack = dlt(GRID, seen.reshape(2, 3, 54, 2))
    assert stack.shape == (2, 3, 3, 3)
    assert np.allclose(stack.reshape(6, 3, 3), [dlt(GRID, m) for m in seen], atol=1e-12)


def test_dlt_needs_no_h9():
    # the origin of the board is seen at infinity: T_z = 0
    H = np.array([[400.0, 30, 100], [20, 380, 50], [1, 0.5, 0]])
    src = GRID + [1, 1]
    assert np.allclose(dlt(src, mapped(H, src)), unit(H), atol=1e-11)


@pytest.mark.parametrize(
    "H",
    [
        np.diag([-1.0, 1, 1]),  # a mirror
        np.diag([1e-3, 1e3, 1]),  # squeezed
        [[1, 0, 1e7], [0, 1, -1e7], [0, 0, 1]],  # far away
        np.diag([1e6, 1e6, 1]),
        np.diag([1e-6, 1e-6, 1]),
        [[1, 0, 0], [0, 1, 0], [0.1, 0.2, 1]],  # strong perspective
    ],
)
def test_unusual_homographies_are_found_not_refused(H):
    H = np.array(H, float)
    scale = np.ptp(mapped(H, GRID), axis=0).max()
    error = np.abs(mapped(dlt(GRID, mapped(H, GRID)), GRID) - mapped(H, GRID)).max()
    assert error <= 1e-9 * scale + 1e-15 * np.abs(mapped(H, GRID)).max()


def similarity(angle, scale, shift):
    c, s = scale * np.cos(angle), scale * np.sin(angle)
    return np.array([[c, -s, shift[0]], [s, c, shift[1]], [0, 0, 1]])


def test_moving_and_scaling_the_data_moves_and_scales_the_answer():
    rng = np.random.default_rng(5)
    seen = mapped(random_homographies(1, rng)[0], GRID) + rng.normal(size=(54, 2))
    S1, S2 = similarity(0.3, 25, (1000, -400)), similarity(-1.1, 0.01, (3, 5))
    H = dlt(GRID, seen)
    moved = dlt(mapped(S1, GRID), mapped(S2, seen))
    back = np.linalg.inv(S2) @ moved @ S1
    assert np.abs(mapped(back, GRID) - mapped(H, GRID)).max() < 1e-11


def test_without_normalisation_the_answer_depends_on_where_the_origin_is():
    rng = np.random.default_rng(5)
    seen = mapped(random_homographies(1, rng)[0], GRID) + rng.normal(size=(54, 2))

    def plain(src, dst):
        return np.linalg.svd(design_matrix(src, dst))[2][-1].reshape(3, 3)

    away = np.array([1000.0, -400])
    back = plain(GRID, seen + away)
    shift = np.abs(mapped(back, GRID) - away - mapped(plain(GRID, seen), GRID)).max()
    assert shift > 1e-3  # pixels; erratum E26


def test_many_points_need_no_square_of_their_number():
    rng = np.random.default_rng(6)
    src = rng.uniform(0, 8, (20_000, 2))
    H = random_homographies(1, rng)[0]
    dst = mapped(H, src)
    tracemalloc.start()
    found = dlt(src, dst)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert np.allclose(found, unit(H), atol=1e-11)
    assert peak < 2_000 * 20_000  # bytes: a (2n, 2n) matrix would take 12.8 GB


def test_points_close_to_a_line_are_looked_at_more_closely_at_no_greater_cost():
    rng = np.random.default_rng(16)
    src = np.c_[rng.uniform(0, 8, 5_000), rng.uniform(0, 1e-5, 5_000)]
    H = random_homographies(1, rng)[0]
    tracemalloc.start()
    found = dlt(src, mapped(H, src))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert np.abs(mapped(found, src) - mapped(H, src)).max() < 1e-6
    assert peak < 2_000 * 5_000


COLLINEAR = "all but one of the points lie on a line"


@pytest.mark.parametrize(
    ("src", "dst", "words"),
    [
        (SQUARE[:3], QUAD[:3], "at least 4 points, got 3"),
        (THREE_ON_A_LINE, QUAD, COLLINEAR),
        (SQUARE, THREE_ON_A_LINE, COLLINEAR),
        (THREE_ON_A_LINE, THREE_ON_A_LINE, COLLINEAR),
        (LINE, GRID[:6], "all points of src are collinear"),
        (GRID[[0, 3, 9, 22, 31, 40]], LINE, "all points of dst are collinear"),
        (GRID[:9], GRID[:9], "all points of src are collinear"),  # one row of the board
        (np.r_[LINE[:4], [[5, 0]]], np.r_[LINE[:4], [[5, 0]]], COLLINEAR),
        (SQUARE[[0, 1, 2, 2]], QUAD, "src has only 3 distinct points"),
        (SQUARE, QUAD[[0, 1, 1, 3]], "dst has only 3 distinct points"),
        (SQUARE[[0, 1, 2] * 3], QUAD[[0, 1, 2] * 3], "src has only 3 distinct points"),
        (np.ones((5, 2)), np.ones((5, 2)), "all points coincide"),
        (np.zeros((5, 2)), np.zeros((5, 2)), "all points coincide"),
    ],
)
def test_points_that_fix_no_homography_are_refused_in_words(src, dst, words):
    with pytest.raises(DegenerateError, match=words):
        dlt(src, dst)


def test_collinear_up_to_rounding_is_collinear():
    rng = np.random.default_rng(7)
    almost = LINE + rng.normal(size=LINE.shape) * 1e-13
    with pytest.raises(DegenerateError, match="collinear"):
        dlt(almost, almost)
    enough = LINE + rng.normal(size=LINE.shape) * 1e-4
    assert np.allclose(mapped(dlt(enough, enough), enough), enough, atol=1e-8)


def test_the_bad_set_of_a_stack_is_named():
    with pytest.raises(DegenerateError, match=r"^set 1, 2: dst has only 3 distinct points"):
        dlt(SQUARE, np.stack([[QUAD] * 3, [QUAD, QUAD, QUAD[[0, 1, 2, 2]]]]))


@pytest.mark.parametrize(
    ("src", "dst", "error", "words"),
    [
        (SQUARE, [[np.nan, 0]] * 4, CvnotesError, "dst contains NaN"),
        (None, QUAD, InputTypeError, "src: expected numbers, got None"),
        (GRID.T, GRID.T, ShapeError, "points are rows here, so transpose it"),
        (SQUARE, GRID, ShapeError, "src has 4 points but dst has 54"),
        ([1, 2], [3, 4], ShapeError, "several points"),
        (SQUARE, QUAD * 1e100, CvnotesError, "cannot be computed with"),
        (SQUARE * 1e-200, QUAD, DegenerateError, "all points coincide"),
    ],
)
def test_what_is_no_pair_of_point_sets_is_refused_by_name(src, dst, error, words):
    with pytest.raises(error, match=words):
        dlt(src, dst)


def test_any_kind_of_number_array_gives_the_same_answer_and_is_not_written_to():
    seen = mapped(random_homographies(1, np.random.default_rng(8))[0], GRID).round()
    H = dlt(GRID, seen)
    src = np.asfortranarray(GRID)
    src.setflags(write=False)
    for dst in (seen.tolist(), seen.astype(np.int16), seen.astype(">f4"), seen[::-1][::-1]):
        assert np.allclose(dlt(src, dst), H, atol=1e-12)


def test_refinement_fits_pixels_better_than_the_dlt_does():
    rng = np.random.default_rng(9)
    for H in random_homographies(20, rng):
        seen = mapped(H, GRID) + rng.normal(size=(54, 2)) * 2
        start = dlt(GRID, seen)
        refined = refine_homography(start, GRID, seen)
        cost = [np.sum(np.square(mapped(h, GRID) - seen)) for h in (start, refined, H)]
        assert cost[1] < cost[0]
        assert cost[1] < cost[2]


def test_refinement_reaches_the_minimum_that_another_optimiser_finds():
    rng = np.random.default_rng(10)
    H = random_homographies(1, rng)[0]
    seen = mapped(H, GRID) + rng.normal(size=(54, 2))

    def residuals(h):
        return (mapped(np.append(h, 1).reshape(3, 3), GRID) - seen).ravel()

    best = least_squares(
        residuals, (H / H[2, 2]).ravel()[:8], x_scale="jac", xtol=1e-15, ftol=1e-15, gtol=1e-15
    )
    refined = refine_homography(dlt(GRID, seen), GRID, seen)
    other = mapped(np.append(best.x, 1).reshape(3, 3), GRID)
    assert np.abs(mapped(refined, GRID) - other).max() < 1e-6
    cost = np.sum(np.square(mapped(refined, GRID) - seen))
    assert cost <= 2 * best.cost * (1 + 1e-12)


def test_refinement_of_exact_points_and_of_h9_0_stays_exact():
    H = np.array([[400.0, 30, 100], [20, 380, 50], [1, 0.5, 0]])
    src = GRID + [1, 1]
    near = H * (1 + 0.01 * np.random.default_rng(11).normal(size=(3, 3)))
    assert np.allclose(refine_homography(near, src, mapped(H, src)), unit(H), atol=1e-10)


def test_refinement_keeps_the_sign_and_ignores_the_scale_of_its_start():
    rng = np.random.default_rng(12)
    H = random_homographies(1, rng)[0]
    seen = mapped(H, GRID) + rng.normal(size=(54, 2))
    once = refine_homography(H, GRID, seen)
    for factor in (1e150, 1e-150):
        assert np.allclose(refine_homography(factor * H, GRID, seen), once, atol=1e-9)
    assert np.allclose(refine_homography(-H, GRID, seen), -once, atol=1e-9)


def test_refinement_takes_stacks():
    rng = np.random.default_rng(13)
    seen = mapped(random_homographies(3, rng), GRID) + rng.normal(size=(3, 54, 2))
    H = dlt(GRID, seen)
    one_by_one = [refine_homography(h, GRID, m) for h, m in zip(H, seen, strict=True)]
    assert np.allclose(refine_homography(H, GRID, seen), one_by_one, atol=1e-12)
    assert refine_homography(H[0], GRID, seen).shape == (3, 3, 3)


@pytest.mark.parametrize("start", [np.zeros((3, 3)), np.ones((3, 3)), np.diag([1.0, 1, 0])])
def test_a_singular_start_is_refused(start):
    with pytest.raises(DegenerateError, match="H is singular"):
        refine_homography(start, SQUARE, QUAD)


def test_refinement_says_when_the_points_leave_something_open():
    with pytest.raises(DegenerateError, match="do not determine every parameter"):
        refine_homography(np.eye(3), LINE, LINE)
    with pytest.raises(DegenerateError, match="at least 4 points, got 3"):
        refine_homography(np.eye(3), SQUARE[:3], QUAD[:3])


@pytest.mark.parametrize("solve", [four_points_h9_one, four_points_unit_norm])
def test_the_two_4_point_solutions_agree_with_the_dlt(solve):
    rng = np.random.default_rng(14)
    for H in random_homographies(10, rng):
        src = SQUARE * 5 + rng.normal(size=(4, 2)) * 0.3
        assert np.allclose(unit(solve(src, mapped(H, src))) * np.sign(H[2, 2]), unit(H), atol=1e-9)


def test_the_two_4_point_solutions_are_scaled_as_the_notes_say():
    assert four_points_h9_one(SQUARE, QUAD)[2, 2] == 1
    assert np.linalg.norm(four_points_unit_norm(SQUARE, QUAD)) == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("solve", [four_points_h9_one, four_points_unit_norm])
def test_both_4_point_solutions_fail_where_h9_is_0_and_the_dlt_does_not(solve):
    H = np.array([[400.0, 30, 100], [20, 380, 50], [1, 0.5, 0]])
    src = SQUARE * 4 + [1, 1]
    with pytest.raises(DegenerateError, match="the true h9 is zero"):
        solve(src, mapped(H, src))
    assert np.allclose(dlt(src, mapped(H, src)), unit(H), atol=1e-11)


@pytest.mark.parametrize("solve", [four_points_h9_one, four_points_unit_norm])
def test_the_4_point_solutions_take_four_points_of_which_no_three_are_collinear(solve):
    with pytest.raises(DegenerateError, match="three of the four points lie on a line"):
        solve(THREE_ON_A_LINE, QUAD)
    with pytest.raises(ShapeError, match=r"\(4, 2\) and \(4, 2\), got \(54, 2\)"):
        solve(GRID, GRID)


def test_the_geometric_error_is_a_distance_in_the_picture():
    H = np.diag([2.0, 2, 1])
    assert np.allclose(geometric_error(H, [[1, 1], [2, 0]], [[5, 6], [4, 0]]), [5, 0], atol=1e-12)
    assert np.isnan(geometric_error([[1, 0, 0], [0, 1, 0], [1, 0, 0]], [[0, 1]], [[0, 1]])).all()
