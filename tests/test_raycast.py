import numpy as np
import pytest

from cvnotes.base import ShapeError
from cvnotes.pictures.raycast import edge_functions, first_hits

WALL = [[-2.0, -2, 4], [2, -2, 4], [-2, 2, 4]]  # meets the rays with x + y < 0, |x|, |y| < ½


def cloud(n, rng):
    """Triangles all over the place, some of them behind the camera or across its plane."""
    return rng.uniform([-3, -3, -3], [3, 3, 6], (n, 1, 3)) + rng.normal(0, 0.7, (n, 3, 3))


def solved(corners, d):
    """The depth at which d meets each triangle, by solving s d = V0 + a (V1−V0) + b (V2−V0)."""
    V0, V1, V2 = np.moveaxis(corners, 1, 0)
    M = np.stack([np.broadcast_to(d, V0.shape), V0 - V1, V0 - V2], axis=-1)
    s, a, b = np.linalg.solve(M, V0[..., None])[..., 0].T
    return np.where((a >= 0) & (b >= 0) & (a + b <= 1) & (s > 0), s, np.inf)


def test_a_ray_meets_the_nearer_of_two_walls_whichever_comes_first():
    far = 2 * np.array(WALL)
    for walls, nearer in (([WALL, far], 0), ([far, WALL], 1)):
        hits = first_hits(walls, [[[-0.1, -0.2], [0.3, 0.4]]])
        assert hits.triangle.tolist() == [[nearer, -1]]
        assert hits.depth[0, 0] == pytest.approx(4)
        assert np.isnan(hits.depth[0, 1])


@pytest.mark.parametrize("spread", [0.6, 0.02])  # in the narrow groups a triangle hides others
def test_hits_agree_with_solving_for_each_triangle(spread):
    rng = np.random.default_rng(5)
    corners = cloud(60, rng)
    xy = rng.uniform(spread - 0.6, 0.6 - spread, (40, 1, 2))
    xy = xy + rng.uniform(-spread, spread, (40, 10, 2))
    hits = first_hits(corners, xy)
    assert 0.2 < (hits.triangle >= 0).mean() < 0.95
    for ray, triangle, depth in zip(
        xy.reshape(-1, 2), hits.triangle.ravel(), hits.depth.ravel(), strict=True
    ):
        z = solved(corners, [*ray, 1.0])
        assert triangle == (np.argmin(z) if np.isfinite(z.min()) else -1)
        assert np.allclose(depth, z.min(), atol=1e-9) or not np.isfinite(z.min())


def test_what_is_behind_the_camera_is_not_seen_and_what_reaches_past_it_is():
    behind = [[-2.0, -2, -4], [2, -2, -4], [-2, 2, -4]]
    floor = [[-50.0, 1, -50], [50, 1, -50], [0, 1, 80]]  # passes under the camera
    hits = first_hits([behind, floor], [[[0.0, -0.1], [0.0, 0.1], [0.0, 2.0]]])
    assert hits.triangle.tolist() == [[-1, 1, 1]]
    assert np.allclose(hits.depth[0, 1:], [10, 0.5], atol=1e-9)


def test_both_sides_of_a_triangle_are_seen():
    for corners in (WALL, WALL[::-1]):
        assert first_hits([corners], [[[-0.1, -0.1]]]).triangle == 0


def test_rays_beyond_the_lens_meet_nothing():
    hits = first_hits([WALL], [[[np.nan, np.nan], [-0.1, -0.1]]])
    assert hits.triangle.tolist() == [[-1, 0]]
    nothing = first_hits([WALL], np.full((2, 3, 2), np.nan))
    assert (nothing.triangle == -1).all()


def test_an_empty_world_is_empty():
    hits = first_hits(np.zeros((0, 3, 3)), [[[0.1, 0.1]]])
    assert hits.triangle.tolist() == [[-1]]
    assert np.isnan(hits.depth).all()


def test_no_ray_slips_through_the_seam_of_two_triangles():
    rng = np.random.default_rng(1)
    for _ in range(20):
        a, b = rng.normal((0, 0, 4), 1, (2, 3))
        left, right = b + np.array([[-3, 0.1, 0], [3, -0.1, 0]])
        pair = np.array([[a, b, left], [b, a, right]])
        # Rays through points of the common edge, as exactly as numbers allow.
        on = a + rng.uniform(0.01, 0.99, (1, 200, 1)) * (b - a)
        hits = first_hits(pair, on[..., :2] / on[..., 2:])
        assert (hits.triangle >= 0).all()


def test_triangles_seen_edge_on_are_not_seen():
    line = [[0.0, 0, 2], [0, 0, 4], [0, 0, 9]]
    plane_through_the_camera = [[0.0, -1, 2], [0, 1, 2], [0, 1, 5]]
    n, det = edge_functions(np.array([line, plane_through_the_camera]))
    assert np.isnan(n).all()
    assert np.isnan(det).all()
    hits = first_hits([line, plane_through_the_camera], [[[0.0, 0.0]]])
    assert hits.triangle.tolist() == [[-1]]


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        (([[0, 0, 1]], [[[0, 0]]]), ShapeError, r"triangles \(m, 3, 3\), got \(1, 3\)"),
        (([WALL], [[0, 0]]), ShapeError, r"\(groups, k, 2\), got \(1, 2\)"),
    ],
)
def test_wrong_shapes_are_named(arguments, error, words):
    with pytest.raises(error, match=words):
        first_hits(*arguments)
