import numpy as np
import pytest

from cvnotes.base import CvnotesError, DegenerateError, InputTypeError, ShapeError
from cvnotes.calibration import (
    constraints,
    extrinsics,
    intrinsics_from_b,
    intrinsics_from_b_by_formulas,
    radial_distortion,
    solve_b,
    v_ij,
)
from cvnotes.calibration.zhang import focal_lengths_from_v
from cvnotes.camera import Camera, Lens, intrinsics, pose, rotation_from_vector

A = intrinsics(800, 810, 320, 240)
A_SKEW = intrinsics(800, 810, 320, 240, skew=15)
B_ORDER = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)]  # B11 B12 B22 B13 B23 B33


def random_poses(n, rng, tilt=0.5):
    T = rng.normal(size=(n, 3)) * [0.5, 0.5, 0.5] + [0, 0, 5]
    return pose(rotation_from_vector(rng.normal(size=(n, 3)) * tilt), T)


def homographies(A, G):
    """λ A [r1 r2 T] with λ and its sign different in every view."""
    H = A @ G[:, :3, [0, 1, 3]]
    return H * np.linspace(-2.1, 3.3, len(H))[:, None, None]


FROM_CENTRE = np.array([[1, 0, -320], [0, 1, -240], [0, 0, 1]])


def A_of(H, skew=False):
    """Take the three steps from homographies to A."""
    return intrinsics_from_b(solve_b(constraints(H), skew=skew))


def b_of(A):
    B = np.linalg.inv(A).T @ np.linalg.inv(A)
    return np.array([B[i] for i in B_ORDER])


def test_v_ij_turns_h_i_B_h_j_into_a_product_with_b():
    rng = np.random.default_rng(0)
    for _ in range(10):
        H, M = rng.normal(size=(2, 3, 3))
        B = M + M.T
        b = [B[i] for i in B_ORDER]
        for i in (1, 2, 3):
            for j in (1, 2, 3):
                assert v_ij(H, i, j) @ b == pytest.approx(H[:, i - 1] @ B @ H[:, j - 1], abs=1e-12)


def test_v_ij_counts_columns_from_1():
    with pytest.raises(CvnotesError, match="1 to 3; got 0 and 1"):
        v_ij(np.eye(3), 0, 1)


def test_the_true_b_satisfies_both_constraints_of_each_view():
    V = constraints(homographies(A_SKEW, random_poses(4, np.random.default_rng(1))))
    assert V.shape == (8, 6)
    assert np.abs(V @ b_of(A_SKEW)).max() < 1e-12


def test_the_scale_of_a_homography_gives_it_no_weight():
    H = homographies(A, random_poses(3, np.random.default_rng(2)))
    factors = np.array([1e-150, -1e12, 1e150])[:, None, None]
    assert np.allclose(constraints(H * factors), constraints(H), rtol=1e-9, atol=1e-12)


def test_the_columns_of_a_homography_are_scaled_to_a_product_of_norms_of_1():
    # h1 = (2, 0, 0) and h2 = (0, 8, 0) become (½, 0, 0) and (0, 2, 0)
    V = constraints(np.diag([2.0, 8, 1]))
    assert np.allclose(V, [[0, 1, 0, 0, 0, 0], [0.25, 0, -4, 0, 0, 0]], atol=1e-12)


def test_b_has_norm_1_and_the_sign_that_makes_B_positive():
    H = homographies(A_SKEW, random_poses(5, np.random.default_rng(3)))
    b = solve_b(constraints(H), skew=True)
    assert b[0] > 0
    expected = b_of(A_SKEW) / np.linalg.norm(b_of(A_SKEW))
    assert np.allclose(b, expected, atol=1e-9)


def test_cholesky_and_the_six_formulas_give_the_A_that_made_b():
    rng = np.random.default_rng(4)
    for _ in range(50):
        alpha, beta = rng.uniform(200, 3000, 2)
        truth = intrinsics(alpha, beta, *rng.uniform(-500, 2000, 2), skew=rng.normal() * 20)
        b = b_of(truth) * rng.uniform(0.1, 10)
        assert np.allclose(intrinsics_from_b(b), truth, rtol=1e-7, atol=1e-6)
        assert np.allclose(intrinsics_from_b_by_formulas(b), truth, rtol=1e-7, atol=1e-6)


def test_alpha_where_beta_belongs_is_wrong_as_soon_as_pixels_are_not_square():
    # u0 = γ v0 / β − B13 α² / s; "γ v0 / α" is often printed (erratum E31)
    truth = intrinsics(700, 900, 300, 200, skew=40)
    B11, B12, B22, B13, B23, B33 = b_of(truth)
    v0 = (B12 * B13 - B11 * B23) / (B11 * B22 - B12**2)
    s = B33 - (B13**2 + v0 * (B12 * B13 - B11 * B23)) / B11
    assert 40 * v0 / 900 - B13 * 700**2 / s == pytest.approx(300, abs=1e-6)
    assert abs(40 * v0 / 700 - B13 * 700**2 / s - 300) > 2


@pytest.mark.parametrize("give_A", [intrinsics_from_b, intrinsics_from_b_by_formulas])
@pytest.mark.parametrize("b", [[1, 0, -1, 0, 0, 1], [1, 0, 1, 1, 1, 1], [-1, 0, -1, 0, 0, -1]])
def test_a_B_that_is_not_positive_definite_is_no_camera(give_A, b):
    with pytest.raises(DegenerateError, match=r"not positive definite.*noise is too high"):
        give_A(b)


@pytest.mark.parametrize("give_A", [intrinsics_from_b, intrinsics_from_b_by_formulas])
def test_b_is_one_vector_of_six_numbers(give_A):
    with pytest.raises(ShapeError, match=r"expected one vector \(6,\), got \(2, 6\)"):
        give_A(np.ones((2, 6)))
    with pytest.raises(ShapeError, match=r"\(\.\.\., 6\), got \(5,\)"):
        give_A(np.ones(5))


@pytest.mark.parametrize(("truth", "n"), [(A, 2), (A, 3), (A, 10), (A_SKEW, 3), (A_SKEW, 10)])
def test_the_closed_form_finds_the_camera_of_exact_homographies(truth, n):
    H = homographies(truth, random_poses(n, np.random.default_rng(n)))
    found = A_of(H, skew=truth[0, 1] != 0)
    assert np.allclose(found, truth, atol=1e-5)


def test_the_6_unknown_system_on_two_views_is_refused_not_answered():
    # erratum E29: with skew free, four equations leave b open
    H = homographies(A, random_poses(2, np.random.default_rng(5)))
    with pytest.raises(DegenerateError, match="at least 3 views with skew, got 2"):
        A_of(H, skew=True)
    with pytest.raises(DegenerateError, match="at least 2 views without skew, got 1"):
        A_of(H[:1])
    with pytest.raises(DegenerateError, match="at least 2 views without skew, got 0"):
        A_of(H[:0])


def fronto_parallel(n, rng):
    T = rng.normal(size=(n, 3)) + [0, 0, 5]
    return pose(rotation_from_vector(np.outer(rng.uniform(-3, 3, n), [0, 0, 1])), T)


def parallel(n, rng):
    R = np.broadcast_to(rotation_from_vector([0.3, 0.2, 0.1]), (n, 3, 3))
    return pose(R, rng.normal(size=(n, 3)) + [0, 0, 5])


def repeated(n, rng):
    return np.repeat(random_poses(1, rng), n, axis=0)


@pytest.mark.parametrize("poses", [fronto_parallel, parallel, repeated])
@pytest.mark.parametrize("skew", [False, True])
def test_views_that_do_not_determine_the_camera_are_refused_in_words(poses, skew):
    H = homographies(A, poses(6, np.random.default_rng(6)))
    with pytest.raises(DegenerateError, match=r"rank of V too low.*tilt the board by 30 to 45"):
        A_of(H, skew=skew)


@pytest.mark.parametrize("bad", [np.zeros((3, 3)), np.ones((3, 3)), np.diag([1.0, 1, 0])])
def test_a_singular_homography_is_named_by_its_index(bad):
    H = homographies(A, random_poses(4, np.random.default_rng(7)))
    H[2] = bad
    for step in (constraints, lambda H: extrinsics(A, H)):
        with pytest.raises(DegenerateError, match="homography 2 is singular"):
            step(H)


@pytest.mark.parametrize(
    ("H", "error", "words"),
    [
        (None, InputTypeError, "H: expected numbers, got None"),
        (np.ones((3, 3, 4)), ShapeError, r"H: expected shape \(3, 3\), got \(3, 3, 4\)"),
        (np.full((3, 3, 3), np.nan), CvnotesError, "H contains NaN"),
    ],
)
def test_what_is_no_stack_of_homographies_is_refused_by_name(H, error, words):
    with pytest.raises(error, match=words):
        A_of(H)


def test_the_focal_lengths_alone_follow_from_a_known_piercing_point_and_one_view():
    H = homographies(A, random_poses(1, np.random.default_rng(8)))
    found = focal_lengths_from_v(constraints(FROM_CENTRE @ H))
    assert np.allclose(found, [A[0, 0], A[1, 1]], atol=1e-7)


def test_focal_lengths_are_refused_where_they_do_not_show():
    H = homographies(A, fronto_parallel(5, np.random.default_rng(9)))
    with pytest.raises(DegenerateError, match="not positive definite"):
        focal_lengths_from_v(constraints(FROM_CENTRE @ H))


def test_extrinsics_are_the_poses_whatever_the_scale_and_sign_of_H():
    G = random_poses(6, np.random.default_rng(10))
    found = extrinsics(A_SKEW, homographies(A_SKEW, G))
    assert np.allclose(found, G, atol=1e-10)
    assert np.allclose(extrinsics(A_SKEW, -homographies(A_SKEW, G)), G, atol=1e-10)


def test_extrinsics_of_noisy_homographies_are_rotations_in_front_of_the_camera():
    rng = np.random.default_rng(11)
    H = homographies(A, random_poses(50, rng))
    G = extrinsics(A, H * (1 + 0.02 * rng.normal(size=H.shape)))
    R = G[:, :3, :3]
    assert np.allclose(R @ R.mT, np.eye(3), atol=1e-12)
    assert np.allclose(np.linalg.det(R), 1, atol=1e-12)
    assert (G[:, 2, 3] > 0).all()


def test_the_scale_is_the_mean_of_the_two_that_noise_makes_differ():
    # λ‖r1‖ = 2 and λ‖r2‖ = 4 of the same H: T is divided by 3 (erratum E32)
    H = np.array([[2.0, 0, 3], [0, 4, 6], [0, 0, 9]])
    assert np.allclose(extrinsics(np.eye(3), H)[:3, 3], [1, 2, 3], atol=1e-12)


def seen_by(camera, W, G):
    return np.array([camera.moved(g).project(W) for g in G])


def test_k_is_exact_from_ideal_radii_and_exact_poses(board):
    camera = Camera(A, lens=Lens(k=(-0.25, 0.10, 0.03)))
    G = random_poses(3, np.random.default_rng(12), 0.3)
    W = board.points / 25 - [4, 2.5, 0]
    k = radial_distortion(A, G, W, seen_by(camera, W, G), terms=3)
    assert np.allclose(k, (-0.25, 0.10, 0.03), atol=1e-10)


def test_k_takes_other_board_points_for_every_view(board):
    camera = Camera(A, lens=Lens(k=(-0.2,)))
    G = random_poses(2, np.random.default_rng(13), 0.3)
    W = np.stack([board.points[:20], board.points[20:40]]) / 50 - [2, 1.25, 0]
    m = np.array([camera.moved(g).project(w) for g, w in zip(G, W, strict=True)])
    assert np.allclose(radial_distortion(A, G, W, m, terms=1), [-0.2], atol=1e-10)


def test_the_printed_radius_gives_wrong_coefficients_even_from_exact_data():
    # Erratum E34. A plane that fills the 1280×960 picture of a camera with α = 960.
    x, y = np.meshgrid(np.linspace(-2 / 3, 2 / 3, 41), np.linspace(-0.5, 0.5, 31))
    ideal = np.stack([x, y], -1).reshape(-1, 2)
    r2 = (ideal**2).sum(-1, keepdims=True)
    shown = ideal * (1 - 0.25 * r2 + 0.10 * r2**2)
    r2_shown = (shown**2).sum(-1, keepdims=True)  # as printed: from the observed point
    D = np.stack([ideal * r2_shown, ideal * r2_shown**2], -1).reshape(-1, 2)
    printed = np.linalg.lstsq(D, (shown - ideal).ravel(), rcond=None)[0]
    assert np.allclose(printed, (-0.263, 0.044), atol=1e-3)

    A = intrinsics(960, 960, 639.5, 479.5)
    W = np.c_[ideal, np.zeros(len(ideal))]
    in_front = pose(np.eye(3), [0, 0, 1])
    assert np.allclose(
        radial_distortion(A, in_front, W, shown * 960 + [639.5, 479.5]), (-0.25, 0.10), atol=1e-10
    )


@pytest.mark.parametrize(
    ("terms", "error", "words"),
    [
        (0, CvnotesError, "terms: .* 1 to 100, got 0"),
        (2.5, CvnotesError, "terms: .* 1 to 100, got 2.5"),
    ],
)
def test_the_number_of_coefficients_is_a_positive_whole_number(terms, error, words):
    W = np.array([[0.1, 0.2, 0], [0.3, 0.1, 0]])
    with pytest.raises(error, match=words):
        radial_distortion(np.eye(3), pose(np.eye(3), [0, 0, 1]), W, W[:, :2], terms=terms)


def test_points_that_say_nothing_about_k_are_refused():
    W = np.array([[0.1, 0.2, 0], [-0.2, 0.1, 0]])
    in_front, behind = (pose(np.eye(3), [0, 0, z]) for z in (1, -1))
    with pytest.raises(DegenerateError, match="do not determine 2 coefficients: vary the radius"):
        radial_distortion(np.eye(3), in_front, W, W[:, :2], terms=2)  # one radius only
    with pytest.raises(DegenerateError, match="does not lie in front of the camera"):
        radial_distortion(np.eye(3), behind, W, W[:, :2])
