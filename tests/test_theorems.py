"""The theorems of the notes as properties: they hold for whatever hypothesis draws."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from cvnotes.camera import (
    Camera,
    Lens,
    chain,
    decompose,
    intrinsics,
    inverse,
    look_at,
    pose,
    rotation_from_vector,
)
from cvnotes.homography import dlt
from cvnotes.projective import (
    apply,
    cross_ratio,
    direction_to_homogeneous,
    join,
    meet,
    same_up_to_scale,
    to_homogeneous,
)
from cvnotes.stereo import rectify, triangulate
from cvnotes.warping import backward_warp, compose, homography_map

theorem = settings(max_examples=100)


def numbers(low, high):
    return st.floats(low, high, allow_nan=False, allow_infinity=False)


def vectors(d, size):
    return st.tuples(*[numbers(-size, size)] * d).map(np.array)


# A point, at infinity too: whatever is not zero in all coordinates.
homogeneous = vectors(3, 10).filter(lambda x: np.abs(x).max() > 1e-3)
homogeneous_in_space = vectors(4, 10).filter(lambda x: np.abs(x).max() > 1e-3)
directions = vectors(3, 1).filter(lambda d: np.linalg.norm(d) > 0.1)


@st.composite
def homographies(draw, tilt=5e-4):
    """Maps of a 640 × 480 picture whose vanishing line stays out of it."""
    a, b, c, d = (draw(numbers(-0.3, 0.3)) for _ in range(4))
    u, v = (draw(numbers(-100, 100)) for _ in range(2))
    p, q = (draw(numbers(-tilt, tilt)) for _ in range(2))
    return np.array([[1 + a, b, u], [c, 1 + d, v], [p, q, 1.0]])


IDEAL = Lens()


@st.composite
def cameras(draw, lens=IDEAL):
    """Cameras on all sides of the origin, two metres away, that look about there."""
    f = draw(numbers(400, 2000))
    A = intrinsics(
        f, f * draw(numbers(0.8, 1.25)), draw(numbers(200, 440)), draw(numbers(150, 330))
    )
    eye = 2000 * np.array(draw(directions.filter(lambda d: abs(d[1]) < 0.9 * np.linalg.norm(d))))
    eye /= np.linalg.norm(eye) / 2000
    return Camera(A, look_at(eye, draw(vectors(3, 100))), lens)


# Lenses as strong as real ones, fold radius and all.
lenses = st.builds(
    lambda k1, k2, k3, p1, p2: Lens(k=(k1, k2, k3), p=(p1, p2)),
    *(numbers(-0.4, 0.3), numbers(-0.2, 0.2), numbers(-0.1, 0.1)),
    *[numbers(-0.01, 0.01)] * 2,
)


# --- Projective space ----------------------------------------------------------------------------


def lies_on(x, line, atol=1e-12):
    """Tell whether points lie on lines or planes; `atol` is the cosine of an angle."""
    x, line = (v / np.linalg.norm(v, axis=-1, keepdims=True) for v in map(np.asarray, (x, line)))
    return np.abs((x * line).sum(-1)) <= atol


@theorem
@given(homogeneous, homogeneous)
def test_a_line_through_two_points_contains_both(a, b):
    assume(not same_up_to_scale(a, b, atol=1e-3))
    line = join(a, b)
    assert lies_on(a, line)
    assert lies_on(b, line)


@theorem
@given(homogeneous, homogeneous)
def test_two_lines_meet_in_a_point_of_both(k, m):
    assume(not same_up_to_scale(k, m, atol=1e-3))
    assert lies_on(meet(k, m), k)
    assert lies_on(meet(k, m), m)


@theorem
@given(vectors(2, 100), vectors(2, 1), homographies(), numbers(1.5, 4), numbers(5, 9))
def test_a_projective_map_keeps_the_cross_ratio(x, d, H, t2, t3):
    assume(np.linalg.norm(d) > 0.1)
    line = [to_homogeneous(x + t * d) for t in (0, 1, t2, t3)]
    by_hand = t2 * (t3 - 1) / ((t2 - 1) * t3)
    mapped = [H @ x_h for x_h in line]
    np.testing.assert_allclose(cross_ratio(*mapped), by_hand, rtol=1e-6, atol=1e-9)


# --- The camera ----------------------------------------------------------------------------------


@theorem
@given(cameras(), vectors(3, 300), vectors(3, 300), directions)
def test_parallels_meet_on_the_vanishing_point(camera, X, Y, d):
    """Also where that point is at infinity: then the images of the lines are parallel."""
    # pixels counted from the middle in half pictures, so that a difference of 1e-3 is one
    P = np.array([[1 / 320, 0, -1], [0, 1 / 320, -0.75], [0, 0, 1]]) @ camera.P
    vanishing = P @ direction_to_homogeneous(d)
    images = []
    for start in (X, Y):
        ends = to_homogeneous(np.stack([start, start + 300 * d])) @ P.T
        assume(not same_up_to_scale(*ends, atol=1e-3))  # a line of sight is seen as a point
        images.append(join(*ends))
        assert lies_on(vanishing, images[-1], atol=1e-9)
    assume(not same_up_to_scale(*images, atol=1e-3))
    assert same_up_to_scale(meet(*images), vanishing, atol=1e-8)


@theorem
@given(cameras(), numbers(-1e3, 1e3).filter(lambda s: abs(s) > 1e-3))
def test_a_projection_matrix_of_any_scale_has_one_camera(camera, scale):
    A, R, T = decompose(scale * camera.P)
    np.testing.assert_allclose(A, camera.A, atol=1e-7)
    np.testing.assert_allclose(R, camera.R, atol=1e-10)
    np.testing.assert_allclose(T, camera.T, atol=1e-6)


@theorem
@given(lenses, numbers(0, 0.999), numbers(0, 2 * np.pi))
def test_undistorting_undoes_distorting_inside_the_largest_radius(lens, fraction, angle):
    r = fraction * min(lens.max_radius, 2.0)
    xy = r * np.array([np.cos(angle), np.sin(angle)])
    # At the fold the inverse has no slope; 1e-16 of what is seen is 1e-13/(1 − fraction) of it.
    np.testing.assert_allclose(lens.undistort(lens.distort(xy)), xy, atol=1e-11)


@theorem
@given(vectors(3, 3), vectors(3, 1e3), vectors(3, 3), vectors(3, 1e3), vectors(3, 1e3))
def test_motions_chain_and_undo_each_other(w1, T1, w2, T2, W):
    G1, G2 = pose(rotation_from_vector(w1), T1), pose(rotation_from_vector(w2), T2)
    both = chain(G2, G1)
    np.testing.assert_allclose(both @ [*W, 1], G2 @ (G1 @ [*W, 1]), atol=1e-9)
    np.testing.assert_allclose(chain(inverse(G1), inverse(G2), both), np.eye(4), atol=1e-10)


# --- Homographies and warps ----------------------------------------------------------------------

CORNERS = np.array([[0.0, 0], [639, 0], [639, 479], [0, 479], [320, 240], [100, 300]])


@theorem
@given(homographies(), homographies(tilt=2e-4))
def test_the_homography_of_a_composition_is_the_composition(H1, H2):
    there = apply(H1, CORNERS)
    assume(np.abs(there).max() < 5000)
    assume((to_homogeneous(there) @ H2[2] > 0.05).all())
    onwards = apply(H2, there)
    assert same_up_to_scale(dlt(CORNERS, onwards), H2 @ H1, atol=1e-9)
    composed = compose(homography_map(H2), homography_map(H1))
    np.testing.assert_allclose(composed(CORNERS), apply(H2 @ H1, CORNERS), rtol=1e-9, atol=1e-8)


U, V = np.meshgrid(np.arange(160.0), np.arange(120.0))
SMOOTH = 128 + 50 * np.cos(U / 8) + 50 * np.sin(V / 9 + U / 20)


@st.composite
def gentle_maps(draw):
    """Homographies that move a 160 × 120 picture a little, without shrinking it much."""
    a, b, c, d = (draw(numbers(-0.15, 0.15)) for _ in range(4))
    u, v = (draw(numbers(-8, 8)) for _ in range(2))
    p, q = (draw(numbers(-5e-4, 5e-4)) for _ in range(2))
    H = np.array([[1 + a, b, u], [c, 1 + d, v], [p, q, 1.0]])
    to_middle = np.array([[1, 0, -79.5], [0, 1, -59.5], [0, 0, 1]])
    return np.linalg.inv(to_middle) @ H @ to_middle


@theorem
@given(gentle_maps())
def test_warping_by_H_and_then_by_its_inverse_gives_the_picture_back(H):
    there = backward_warp(SMOOTH, homography_map(H), fill=np.nan)
    back = backward_warp(there, homography_map(np.linalg.inv(H)), fill=np.nan)
    seen = np.isfinite(back)
    assume(seen.mean() > 0.3)
    # Twice bilinear interpolation: h²/8 (|f_uu| + |f_vv|) ≤ (50/64 + 50/400 + 50/81)/8 each time,
    # the second time on a grid at most 1.5 times as wide.
    assert np.abs(back - SMOOTH)[seen].max() < 0.2 * (1 + 1.5**2)


@theorem
@given(gentle_maps())
def test_points_come_back_exactly(H):
    m = np.stack([U, V], axis=-1)
    there_and_back = compose(homography_map(np.linalg.inv(H)), homography_map(H))
    np.testing.assert_allclose(there_and_back(m), m, atol=1e-9)


# --- Two cameras ---------------------------------------------------------------------------------


@st.composite
def rigs(draw):
    """Two cameras side by side, turned a little against each other, anywhere in the world."""
    left = draw(cameras(lens=Lens(k=(-0.1,), p=(0.001, -0.002))))
    right = draw(cameras(lens=Lens(k=(-0.15, 0.05))))
    turn = rotation_from_vector(draw(vectors(3, 0.15)))
    b = np.array([draw(numbers(-200, -50)), *draw(vectors(2, 15))])
    return left, right.moved(chain(pose(turn, b), left.G))


@theorem
@given(rigs(), st.lists(vectors(3, 200), min_size=1, max_size=20).map(np.array))
@pytest.mark.slow
def test_rectified_correspondences_share_their_row(rig, W):
    pair = rectify(*rig, size=(64, 48), keep="all")
    assume(min(pair.left.depth(W).min(), pair.right.depth(W).min()) > 500)
    m_left, m_right = pair.left.project(W), pair.right.project(W)
    np.testing.assert_allclose(m_left[:, 1], m_right[:, 1], atol=1e-9)
    assert (m_left[:, 0] > m_right[:, 0]).all()


@theorem
@given(rigs(), vectors(3, 200))
@pytest.mark.slow
def test_triangulation_undoes_projection(rig, W):
    m = np.stack([camera.project(W) for camera in rig])
    assume(np.isfinite(m).all())
    np.testing.assert_allclose(triangulate(rig, m), W, atol=1e-5)
