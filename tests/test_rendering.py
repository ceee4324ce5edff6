from dataclasses import replace

import cv2
import numpy as np
import pytest

from cvnotes.base import CvnotesError, InputTypeError
from cvnotes.camera import (
    Camera,
    FisheyeLens,
    Lens,
    intrinsics,
    look_at,
    move,
    pose,
    rotation_from_vector,
)
from cvnotes.pictures import Scene, depth_map, radiance, render_scene, target_scene
from cvnotes.pictures.meshes import Surroundings, box, join, quads
from cvnotes.targets import Chessboard

A = intrinsics(800, 800, 319.5, 239.5)
SMALL = Camera(intrinsics(80, 80, 31.5, 23.5), size=(64, 48))
DARK = Surroundings((0, 0, 0), (0, 0, 0), ambient=1.0)


def wall(x, y, z, colour=(1, 1, 1)):
    """An upright rectangle at depth z, from x[0] to x[1] and from y[0] to y[1]."""
    corners = [[x[0], y[0], z], [x[1], y[0], z], [x[1], y[1], z], [x[0], y[1], z]]
    return quads(corners, [[0, 1, 2, 3]], colour)


def edge(profile):
    """Where a row of grey values steps from one level to the other: exact for any straight edge."""
    first, last = profile[0], profile[-1]
    return np.sum((profile - last) / (first - last)) - 0.5


def saddle(grey, guess, reach=7):
    """Intersect the two edges through a corner, fitted to where each row and column steps."""
    u, v = np.rint(guess).astype(int)
    window = grey[v - reach : v + reach + 1, u - reach : u + reach + 1].astype(float)
    t = np.arange(-reach, reach + 1)
    clear = np.abs(t) >= 3  # rows in which only one edge is crossed
    x = [edge(row) - reach for row in window[clear]]
    y = [edge(column) - reach for column in window.T[clear]]
    (b, a), (d, c) = np.polyfit(t[clear], x, 1), np.polyfit(t[clear], y, 1)
    # x = a + b y, y = c + d x
    return np.array([a + b * c, c + d * a]) / (1 - b * d) + [u, v]


@pytest.mark.slow
@pytest.mark.parametrize("lens", [Lens(), Lens((-0.25, 0.10), (0.001, -0.0005))])
@pytest.mark.parametrize("seed", [0, 1])
def test_a_rendered_corner_lies_where_the_camera_projects_it(lens, seed):
    rng = np.random.default_rng(seed)
    board, camera = Chessboard(), Camera(A, lens=lens)
    tilt = rotation_from_vector(rng.uniform(-0.25, 0.25, 3) * [1, 1, 0.4])
    world_from_board = pose(tilt, [-100, -62, 460])
    grey = render_scene(target_scene(board, world_from_board), camera, samples=64)[..., 1]
    truth = camera.project(move(world_from_board, board.points))
    found = np.array([saddle(grey, m) for m in truth])
    assert np.abs(found - truth).max() < 0.02
    assert np.abs((found - truth).mean(axis=0)).max() < 0.002


def test_a_rendered_vertex_of_a_plain_quad_is_where_its_sides_meet():
    tilt = pose(rotation_from_vector([0.2, -0.3, 0.06]), [0, 0, 0])
    square = [[-90, -80, 0], [90, -80, 0], [90, 80, 0], [-90, 80, 0]]
    quad = quads(square, [[0, 1, 2, 3]], (1, 1, 1)).moved(tilt).moved(pose(np.eye(3), [3, 4, 500]))
    camera = Camera(A)
    grey = render_scene(replace(quad, around=DARK), camera)[..., 0].astype(float)
    vertices = camera.project(quad.vertices)
    (u0, v0), (u1, v1) = vertices.min(axis=0), vertices.max(axis=0)
    rows = np.arange(int(v0) + 40, int(v1) - 40)
    columns = np.arange(int(u0) + 40, int(u1) - 40)
    middle = int((u0 + u1) / 2)
    left = np.polyfit(rows, [edge(grey[v, :middle]) for v in rows], 1)
    right = np.polyfit(rows, [edge(grey[v, middle:]) + middle for v in rows], 1)
    middle = int((v0 + v1) / 2)
    top = np.polyfit(columns, [edge(grey[:middle, u]) for u in columns], 1)
    bottom = np.polyfit(columns, [edge(grey[middle:, u]) + middle for u in columns], 1)
    for (b, a), (d, c), vertex in zip(
        (left, right, right, left), (top, top, bottom, bottom), vertices, strict=True
    ):
        found = np.array([a + b * c, c + d * a]) / (1 - b * d)
        assert np.allclose(found, vertex, atol=0.01)


@pytest.mark.slow
def test_every_grey_value_is_the_mean_over_the_pixels_square():
    board = target_scene(Chessboard(), pose(rotation_from_vector([0.4, 0.3, 0.5]), [-90, -70, 500]))
    camera = Camera(intrinsics(40, 40, 19.5, 14.5), lens=Lens((-0.2,)), size=(40, 30))
    picture = render_scene(board, camera, samples=64).astype(float)
    n = 16  # a picture of n times the size, whose pixels fill those of the small one
    A_fine = intrinsics(40 * n, 40 * n, 19.5 * n + (n - 1) / 2, 14.5 * n + (n - 1) / 2)
    fine = Camera(A_fine, lens=camera.lens, size=(40 * n, 30 * n))
    reference = render_scene(board, fine, samples=1).astype(float)
    reference = reference.reshape(30, n, 40, n, 3).mean(axis=(1, 3))
    assert np.sqrt(np.mean((picture - reference) ** 2)) < 1.2
    assert np.abs(picture - reference).max() < 15
    assert abs((picture - reference).mean()) < 0.05


def test_what_is_nearer_hides_what_is_farther():
    near = wall((0, 9), (-9, 9), 4, (1, 0, 0))
    far = wall((-9, 9), (-9, 9), 8, (0, 0, 1))
    picture = render_scene(replace(join(far, near), around=DARK), SMALL)
    assert (picture[:, :32] == [0, 0, 255]).all()
    assert (picture[:, 32:] == [255, 0, 0]).all()


def test_depth_is_z_in_the_camera_not_the_distance_and_nan_where_nothing_is():
    wide = wall((-2, 9), (-9, 9), 4)
    turned = pose(rotation_from_vector([0.1, 0.2, 0.3]), [1, 2, 3])
    depth = depth_map(wide.moved(np.linalg.inv(turned)), SMALL.moved(turned))
    # The wall ends at x / z = −½, that is 40 px left of the middle: outside of the picture.
    assert np.allclose(depth, 4, atol=1e-9)
    narrow = wall((-1, 9), (-9, 9), 4)
    seen = np.isfinite(depth_map(narrow, SMALL))
    assert seen.any(axis=0).tolist() == [u >= 12 for u in range(64)]


def test_depth_of_a_floor_falls_as_the_pixel_says():
    floor = quads(
        [[-99, 2, -9], [99, 2, -9], [99, 2, 999], [-99, 2, 999]], [[0, 1, 2, 3]], (1, 1, 1)
    )
    depth = depth_map(floor, SMALL)
    below = np.arange(26, 48)  # nearer to the horizon the floor is narrower than the picture
    assert np.allclose(depth[26:, 5], 2 * 80 / (below - 23.5), atol=1e-9)
    assert np.isnan(depth[:24]).all()


def test_the_picture_ends_where_the_lens_model_ends():
    lens = Lens((-0.9,))
    camera = Camera(intrinsics(80, 80, 31.5, 23.5), lens=lens, size=(160, 120))
    picture = render_scene(box((-99, 99), (-99, 99), (-99, 99)), camera)
    beyond = np.isnan(camera.ideal([[159, 119], [31, 23]])[:, 0])
    assert beyond.tolist() == [True, False]
    assert (picture[119, 159] == 0).all()
    assert (picture[23, 31] > 0).all()
    assert np.isnan(depth_map(box((-99, 99), (-99, 99), (-99, 99)), camera)[119, 159])


def test_a_wire_thinner_than_a_pixel_is_seen_without_gaps():
    wire = quads(
        [[-9, 0.31, 9], [9, 0.92, 9], [9, 0.93, 9], [-9, 0.32, 9]], [[0, 1, 2, 3]], (1, 1, 1)
    )
    picture = render_scene(replace(wire, around=DARK), SMALL, samples=64)[..., 0].astype(float)
    # A width of 0.01 at depth 9 is 0.089 px, through each column.
    assert np.allclose(picture.sum(axis=0), 255 * 0.0889, atol=6)


def test_a_face_is_brighter_the_more_it_looks_towards_the_light():
    crate = box((-1, 1), (-1, 1), (-1, 1), (0.5, 0.5, 0.5))
    camera = SMALL.moved(look_at([4, -5, -6], [0, 0, 0]))
    faces = {"top": [0, -1, 0], "front": [0, 0, -1], "right": [1, 0, 0]}
    for light, brightest in (((0, -1, 0), "top"), ((0, 0, -1), "front"), ((1, 0, 0), "right")):
        around = replace(DARK, light=light, ambient=0.2)
        picture = render_scene(replace(crate, around=around), camera)
        grey = {}
        for name, centre in faces.items():
            u, v = np.rint(camera.project(centre)).astype(int)
            grey[name] = int(picture[v, u, 0])
        assert max(grey, key=grey.get) == brightest
        assert grey[brightest] == 128


def test_haze_turns_what_is_far_into_the_horizon():
    black = wall((-99, 99), (-99, 99), 10, (0, 0, 0))
    around = Surroundings(horizon=(1, 1, 1), haze=10.0)
    assert render_scene(replace(black, around=around), SMALL)[23, 31, 0] == pytest.approx(
        255 * (1 - np.exp(-1)), abs=1
    )


def test_the_background_is_the_horizon_below_and_the_zenith_above():
    around = Surroundings(horizon=(1, 0, 0), zenith=(0, 0, 1))
    nothing = replace(
        quads([[0, 0, -1], [1, 0, -1], [1, 1, -1], [0, 1, -1]], [[0, 1, 2, 3]], (1, 1, 1)),
        around=around,
    )
    up = SMALL.moved(look_at([0, 0, 0], [0, -1, 0.001]))
    assert render_scene(nothing, up)[23, 31].tolist() == [0, 0, 255]
    assert (render_scene(nothing, SMALL)[24:] == [255, 0, 0]).all()


def test_a_sphere_of_many_triangles_has_the_outline_of_a_sphere():
    import trimesh

    mesh, n = trimesh.creation.icosphere(subdivisions=4, radius=100.0), 5120
    grey, plain = np.full((n, 2, 3), 0.5), np.full((n, 2), np.inf)
    ball = Scene(mesh.vertices, mesh.faces, grey, np.zeros((n, 3, 2)), plain)
    camera = Camera(intrinsics(200, 200, 79.5, 59.5), size=(160, 120))
    depth = depth_map(ball.moved(pose(np.eye(3), [0, 0, 500])), camera)
    # The tangent cone of a sphere at distance d: tan² = r² / (d² − r²).
    radius = 200 * 100 / np.sqrt(500**2 - 100**2)
    assert np.isfinite(depth).sum() == pytest.approx(np.pi * radius**2, rel=0.01)
    assert np.nanmin(depth) == pytest.approx(400, abs=0.5)


def test_light_is_unrounded_and_lamps_are_brighter_than_white():
    lamp = replace(wall((-9, 9), (-9, 9), 4, (1.4, 0.701, 0.1)), around=DARK)
    light = radiance(lamp, SMALL)
    assert np.allclose(light, [357, 178.755, 25.5], atol=1e-9)
    assert render_scene(lamp, SMALL)[20, 30].tolist() == [255, 179, 26]


@pytest.mark.parametrize(
    ("arguments", "options", "error", "words"),
    [
        ((Chessboard(), SMALL), {}, InputTypeError, "got Chessboard; .*target_scene makes one"),
        ((box((0, 1), (0, 1), (5, 6)), A), {}, InputTypeError, "expected a Camera, got ndarray"),
        (
            (box((0, 1), (0, 1), (5, 6)), SMALL),
            {"samples": 0},
            CvnotesError,
            "whole number from 1 to 10000, got 0",
        ),
    ],
)
def test_what_cannot_be_rendered_is_refused_in_words(arguments, options, error, words):
    with pytest.raises(error, match=words):
        render_scene(*arguments, **options)
    if not options:
        with pytest.raises(error, match=words):
            depth_map(*arguments)


def room_of_greys():
    """Give a cube around the camera, each of its sides of another grey."""
    colours = np.arange(1, 7)[:, None, None] / 8 * np.ones(3)
    room = box((-90, 90), (-90, 90), (-90, 90), np.repeat(colours, 2, axis=1))
    return replace(room, around=Surroundings(ambient=1.0))


def crossing(row, u):
    """Give where a row of grey levels passes from one level to the next, near u."""
    before, after = row[u - 4], row[u + 5]
    return u - 4 + np.sum((row[u - 4 : u + 6] - after) / (before - after)) - 0.5


@pytest.mark.parametrize("axis", [0, 1])
def test_a_narrow_fisheye_shows_an_edge_where_the_lens_puts_it(axis):
    # The camera is turned by 0.6 rad: it sees a part of two sides, neither from its corner on.
    turned = pose(rotation_from_vector([[0, 0.6, 0], [-0.6, 0, 0]][axis]), np.zeros(3))
    camera = Camera(intrinsics(150, 150, 120, 60), turned, FisheyeLens((-0.01,)), size=(241, 121))
    picture = render_scene(room_of_greys(), camera)[..., 0].astype(int)
    theta = np.radians(-45) + 0.6
    edge_at = [120, 60][axis] + 150 * theta * (1 - 0.01 * theta**2)
    along = picture[60] if axis == 0 else picture[:, 120]
    assert crossing(along, int(edge_at)) == pytest.approx(edge_at, abs=0.1)
    assert len(np.unique(along[: int(edge_at) - 3])) == 1
    assert len(np.unique(along[int(edge_at) + 4 :])) == 1


def test_a_rendered_fisheye_shows_each_side_of_a_room_where_the_lens_puts_its_edges():
    turned = pose(rotation_from_vector([0, 0.35, 0]), np.zeros(3))
    camera = Camera(
        intrinsics(60, 60, 199.5, 199.5), turned, FisheyeLens((-0.01,)), size=(400, 400)
    )
    picture = render_scene(room_of_greys(), camera)[..., 0]
    # upright edges at 45° and 135° on both sides, seen in the middle row, 0.35 rad further right
    row = picture[199].astype(int)
    theta = np.radians([45, 135, -45, -135]) + 0.35
    edges = 199.5 + 60 * theta * (1 - 0.01 * theta**2)
    levels = np.unique(row[[120, 199, 270, 385]])
    assert len(levels) >= 3
    for edge_at in edges:
        assert crossing(row, int(edge_at)) == pytest.approx(edge_at, abs=0.1)
    assert (picture[0, 0] == 0).all()  # 200√2/60 rad from the axis: more than there is


def test_a_box_throws_its_shadow_where_lines_along_the_light_meet_the_floor():
    """Each corner is carried along the light by hand; OpenCV tells the convex hull's inside."""
    light, camera = np.array([0.6, -1.0, -0.3]), Camera(A, look_at([1500, -2500, -4000], [0, 0, 0]))
    floor = quads([[-9e3, 500, -9e3], [9e3, 500, -9e3], [9e3, 500, 9e3], [-9e3, 500, 9e3]],
                  [[0, 1, 2, 3]], (1, 1, 1))  # fmt: skip
    turn = pose(rotation_from_vector([0, 0.4, 0]), [100, 0, 300])
    body = box((-400, 400), (-300, 100), (-200, 200), (1, 0, 0)).moved(turn)  # it hovers
    scene = replace(join(floor, body), around=replace(DARK, light=tuple(light), ambient=0.2))
    grey = render_scene(scene, camera, samples=4).astype(int)
    along = body.vertices - light * ((body.vertices[:, 1:2] - 500) / light[1])
    hull = cv2.convexHull(camera.project(along).astype(np.float32))
    pixels = np.stack(np.meshgrid(np.arange(640), np.arange(480)), -1).reshape(-1, 2).astype(float)
    inside = np.array([cv2.pointPolygonTest(hull, m, measureDist=True) for m in pixels])
    on_floor = (grey[..., 1] > 0).ravel()  # neither the red box nor the black around
    sunlit, shaded = on_floor & (inside < -1.5), on_floor & (inside > 1.5)
    assert shaded.sum() > 3000
    assert sunlit.sum() > 50_000
    cosine = -light[1] / np.linalg.norm(light)
    for pixels, c in ((sunlit, cosine), (shaded, -cosine)):
        seen = np.bincount(grey[..., 1].ravel()[pixels])
        assert seen.argmax() == np.rint(255 * (0.2 + 0.8 * (1 + c) / 2))
        assert seen.max() > 0.99 * pixels.sum()  # the rest lies along the edges of the box


@pytest.mark.parametrize("light", [(0.5, -0.4, -0.8), (-1, 0.2, 0.3), (0, 0, 1), (0.1, 1, 0.01)])
@pytest.mark.parametrize("inside", [False, True])
def test_no_lit_face_stands_in_its_own_shadow_and_a_room_is_lit_through_its_walls(light, inside):
    G = pose(rotation_from_vector([0.3, 0.5, 0.2]), [0, 0, 0 if inside else 900])
    scene = box(*[(-700, 700)] * 3 if inside else [(-99, 99)] * 3, (1, 1, 1)).moved(G)
    scene = replace(scene, around=replace(DARK, light=light, ambient=0.3))
    picture = render_scene(scene, Camera(A), samples=1)[..., 0]
    v, u = np.nonzero(picture)
    xy = Camera(A).ideal(np.stack([u, v], -1).astype(float))
    M = depth_map(scene, Camera(A))[v, u, None] * np.column_stack([xy, np.ones(len(xy))])
    where = (M - G[:3, 3]) @ G[:3, :3]  # in the frame of the box: the largest names the face
    face = np.abs(where).argmax(axis=1)
    sign = np.sign(where[np.arange(len(where)), face]) * (-1 if inside else 1)
    cosine = sign * (G[:3, :3].T @ light)[face] / np.linalg.norm(light)
    assert len(np.unique(cosine)) >= 2
    off = np.abs(picture[v, u] - 255 * (0.3 + 0.7 * (1 + cosine) / 2)) > 0.51
    assert off.mean() < 0.02  # along edges
