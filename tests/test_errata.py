"""The errata: the printed form fails a check that the corrected form passes, for each A-row.

The rows are those of docs/errata.md. Truth is a known camera or a case worked by hand.
"""

import re
from pathlib import Path

import numpy as np

from cvnotes.calibration import constraints, intrinsics_from_b, radial_distortion, solve_b
from cvnotes.camera import Camera, Lens, intrinsics, look_at, pose, rotation_from_vector
from cvnotes.homography import geometric_error
from cvnotes.projective import apply, from_homogeneous, same_up_to_scale
from cvnotes.targets import Chessboard

CAMERA = Camera(
    intrinsics(800, 804, 325, 238), look_at([60, 40, -500], [80, 60, 0]), Lens(k=(-0.25, 0.10))
)
PINHOLE = Camera(CAMERA.A, CAMERA.G)
BOARD = Chessboard((9, 6), 25.0)


def refused(check, printed, corrected):
    """Run one check on both forms."""
    assert check(corrected)
    assert not check(printed)


def test_E1_scaling_all_four_coordinates_leaves_the_point_where_it_is():
    point, k = np.array([1.0, 2, 3]), 5.0

    def check(lifted):
        return np.allclose(from_homogeneous(lifted), point)

    refused(check, printed=np.append(k * (k * point), k), corrected=np.append(k * point, k))


def test_E4_the_pixel_is_only_up_to_scale_equal_to_fx_fy_z():
    f, (x, y, z) = 2.0, (1.0, 3.0, 4.0)
    pixel = np.array([0.5, 1.5, 1])  # f x / z and f y / z by hand
    refused(lambda same: same(pixel, [f * x, f * y, z]), np.allclose, same_up_to_scale)


def test_E8_the_offset_of_the_piercing_point_belongs_to_every_form_of_the_equation():
    du, f, u0 = 0.01, 8.0, 325.0
    M = np.array([0.3, 0.0, 2.0])
    seen = Camera(intrinsics(f / du, f / du, u0, 238)).project(M)[0]
    refused(
        lambda u: np.isclose(u, seen),
        printed=1 / du * f / M[2] * M[0],
        corrected=1 / du * f / M[2] * M[0] + u0,
    )


def test_E14_the_lens_acts_on_the_offset_from_its_own_centre():
    centre, k1, xy = np.array([0.1, -0.05]), -0.2, np.array([0.4, 0.3])
    r2 = ((xy - centre) ** 2).sum()
    L = 1 + k1 * r2

    def check(distort):
        # whatever the coefficients, a radial lens moves no point off its ray from the centre
        moved = distort(xy) - centre
        along = xy - centre
        return abs(moved[0] * along[1] - moved[1] * along[0]) < 1e-12

    refused(check, printed=lambda x: L * x, corrected=lambda x: centre + L * (x - centre))
    np.testing.assert_allclose(
        Lens(k=(k1,), centre=tuple(centre)).distort(xy), centre + L * (xy - centre), atol=1e-15
    )


def test_E21_a_plane_is_seen_through_columns_1_2_4_of_a_3_by_4_matrix():
    assert PINHOLE.P.shape == (3, 4)
    W = BOARD.points

    def check(H):
        return H.shape == (3, 3) and geometric_error(H, W[:, :2], PINHOLE.project(W)).max() < 1e-9

    printed = np.vstack([PINHOLE.P, [0, 0, 0, 1]])[:, [0, 1, 3]]  # 4 × 3, as printed
    refused(check, printed=printed, corrected=PINHOLE.P[:, [0, 1, 3]])


def test_E25_only_after_dividing_do_differences_of_pixels_mean_anything():
    W, H = BOARD.points[:, :2], PINHOLE.P[:, [0, 1, 3]]
    m = PINHOLE.project(BOARD.points)
    W_h, m_h = np.column_stack([W, np.ones(54)]), np.column_stack([m, np.ones(54)])

    def printed(H):
        return ((m_h - W_h @ H.T) ** 2).sum()

    def corrected(H):
        return ((m - from_homogeneous(W_h @ H.T)) ** 2).sum()

    # the truth, at any scale, has no error
    refused(lambda error: error(H) < 1e-12 and error(3 * H) < 1e-12, printed, corrected)


def test_E29_three_views_give_all_six_entries_and_two_suffice_without_skew():
    tilts = [rotation_from_vector(w) for w in ([0.5, 0.1, 0], [-0.1, 0.6, 0.2], [0.3, -0.4, 0])]
    A = np.array([[2.5, 0, 0.1], [0, 2.6, -0.1], [0, 0, 1]])
    H = np.array([A @ np.column_stack([R[:, :2], [0.1, 0.2, 5]]) for R in tilts])

    def check(b):
        try:
            return np.allclose(intrinsics_from_b(b), A, atol=1e-8)
        except ValueError:
            return False

    assert check(solve_b(constraints(H)))  # as printed: three views, six entries
    two = constraints(H[:2])
    six_entries = np.linalg.svd(two)[2][-1]  # four equations: a plane of solutions
    refused(check, printed=six_entries, corrected=solve_b(two, skew=False))


def test_E34_r_is_the_radius_of_the_ideal_point():
    views = [
        CAMERA.moved(pose(rotation_from_vector(w), [-100, -65, 330]))
        for w in ([0.4, 0, 0], [0, 0.4, 0], [-0.3, 0.2, 0.1])
    ]
    G = np.array([view.G for view in views])
    m = np.array([view.project(BOARD.points) for view in views])

    def printed():
        ideal = np.array([Camera(v.A, v.G).project(BOARD.points) for v in views]).reshape(-1, 2)
        centre, alpha = CAMERA.A[:2, 2], np.diag(CAMERA.A)[:2]
        seen = m.reshape(-1, 2)
        r2 = (((seen - centre) / alpha) ** 2).sum(1, keepdims=True)
        D = np.stack([(ideal - centre) * r2, (ideal - centre) * r2**2], -1).reshape(-1, 2)
        return np.linalg.lstsq(D, (seen - ideal).ravel(), rcond=None)[0]

    refused(
        lambda k: np.allclose(k, CAMERA.lens.k, atol=1e-9),
        printed=printed(),
        corrected=radial_distortion(CAMERA.A, G, BOARD.points, m, terms=2),
    )


def test_E39_the_third_coordinate_is_divided_out():
    H = np.array([[1.0, 0.2, 10], [0.1, 0.9, 5], [0.001, 0.002, 1]])
    # [48, 44, 1.11] by hand: the pixel is (48, 44) / 1.11
    np.testing.assert_allclose(apply(H, [30.0, 40]), [48 / 1.11, 44 / 1.11], atol=1e-12)


def test_E40_nearest_rounds_both_and_bilinear_floors_both():
    u, v = 10.7, 20.7
    refused(
        lambda k: abs(k[0] - u) <= 0.5 and abs(k[1] - v) <= 0.5,  # no pixel is closer
        printed=(np.floor(u), np.rint(v)),
        corrected=(np.rint(u), np.rint(v)),
    )
    refused(
        lambda k: 0 <= u - k[0] < 1 and 0 <= v - k[1] < 1,  # the point lies in the cell
        printed=(np.floor(u), np.rint(v)),
        corrected=(np.floor(u), np.floor(v)),
    )


def test_E42_the_mixed_term_has_plus_I1():
    I1, I2, I3, I4 = 10.0, 20.0, 40.0, 90.0

    def surface(c):
        return lambda du, dv: (I2 - I1) * du + (I3 - I1) * dv + c * du * dv + I1

    def check(interpolated):  # it must pass through the four pixels
        return [interpolated(du, dv) for dv in (0, 1) for du in (0, 1)] == [I1, I2, I3, I4]

    refused(check, printed=surface(I4 - I3 - I2 - I1), corrected=surface(I4 - I3 - I2 + I1))
    assert (
        surface(I4 - I3 - I2 - I1)(0.5, 0.5) - surface(I4 - I3 - I2 + I1)(0.5, 0.5) == -2 * I1 / 4
    )


def test_E47_turning_R_leaves_the_worlds_origin_where_it_is_and_moves_the_camera():
    R = rotation_from_vector([0.1, -0.2, 0.3])
    T = PINHOLE.T

    def check(turned):
        return np.allclose(turned.centre, PINHOLE.centre)

    about_the_centre = Camera(CAMERA.A, pose(R @ PINHOLE.R, -R @ PINHOLE.R @ PINHOLE.centre))
    about_the_origin = Camera(CAMERA.A, pose(R @ PINHOLE.R, T))
    refused(check, printed=about_the_origin, corrected=about_the_centre)
    np.testing.assert_allclose(about_the_origin.project([0, 0, 0]), PINHOLE.project([0, 0, 0]))


def test_E48_a_homography_is_linear_in_homogeneous_coordinates_only():
    H = PINHOLE.P[:, [0, 1, 3]]
    a, b = np.array([0.0, 0.0]), np.array([200.0, 125.0])
    np.testing.assert_allclose(
        H @ np.append(a + b, 2), H @ np.append(a, 1) + H @ np.append(b, 1), atol=1e-9
    )
    middle = apply(H, (a + b) / 2)
    assert np.linalg.norm(middle - (apply(H, a) + apply(H, b)) / 2) > 1  # px


def test_the_errata_page_and_these_tests_name_the_same_rows():
    page = (Path(__file__).parents[1] / "docs" / "errata.md").read_text()
    rows = dict(re.findall(r"^\| (E\d+) \| ([ABC]) \| (?:–|yes|perhaps) \|", page, re.M))
    assert list(rows) == [f"E{i}" for i in range(1, 49)]
    tested = re.findall(r"^def test_(E\d+)_", Path(__file__).read_text(), re.M)
    assert set(tested) >= {row for row, severity in rows.items() if severity == "A"}
    assert tested == [row for row in rows if row in tested]  # each once, in the page's order
