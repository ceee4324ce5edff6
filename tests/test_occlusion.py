"""Ambient occlusion: what a face dims, and what it leaves alone."""

from dataclasses import replace

import numpy as np
import pytest

from cvnotes.base import CvnotesError, InputTypeError
from cvnotes.camera import Camera, intrinsics, look_at, pose, rotation_from_vector
from cvnotes.pictures import course, depth_map, radiance, room, room_with
from cvnotes.pictures.meshes import Surroundings, box, join, quads

EVEN = Surroundings((0, 0, 0), (0, 0, 0), ambient=1.0, occlusion=500)
FLOOR = quads([[-4000, 0, -4000], [4000, 0, -4000], [4000, 0, 4000], [-4000, 0, 4000]],
              [[0, 1, 2, 3]], (1, 1, 1))  # fmt: skip
ABOVE = Camera(
    intrinsics(400, 400, 199.5, 149.5), look_at([0, -3000, -10], [0, 0, 0]), size=(400, 300)
)


def on_the_floor(*bodies, x, z=0.0, camera=ABOVE, around=EVEN):
    """Grey of the floor at (x, 0, z) from 0 to 1, white where nothing dims it."""
    seen = radiance(replace(join(FLOOR, *bodies), around=around), camera)[..., 0] / 255
    M = np.stack(np.broadcast_arrays(x, 0.0, z), axis=-1)
    u, v = np.rint(camera.project(M)).astype(int).T
    return seen[v, u]


def wall(height, x=0):
    return box((x - 1000, x), (-height, 0), (-3000, 3000), (0.5, 0.5, 0.5))


def test_a_wall_dims_the_floor_beside_it_the_less_the_farther_and_no_farther_than_the_reach():
    x = np.arange(15.0, 700, 50)
    left = on_the_floor(wall(1000), x=x)
    assert left[0] == pytest.approx(0.68, abs=0.03)
    assert (np.diff(left[x < 500]) > 0).all()
    assert (left[x > 520] == 1).all()
    # Half the reach away a quarter of what is hidden at the foot is hidden still.
    (half,) = on_the_floor(wall(1000), x=[250.0])
    assert (1 / half - 1) / (1 / 0.68 - 1) == pytest.approx(0.25, abs=0.02)


def test_a_low_step_dims_no_farther_than_it_is_high():
    x = np.arange(15.0, 450, 30)
    left = on_the_floor(wall(200), x=x)
    assert (left[x < 170] < 1).all()
    assert (left[x > 240] == 1).all()  # a step of the grid is 40 mm


def test_two_walls_dim_more_than_one_and_never_all():
    one = on_the_floor(wall(900, -200), x=[-100.0])
    two = on_the_floor(wall(900, -200), box((0, 100), (-900, 0), (-3000, 3000)), x=[-100.0])
    many = [wall(900, -200 - i) for i in range(8)]
    assert 0.1 < on_the_floor(*many, x=[-100.0]) < two < one < 1


def test_a_post_dims_less_far_than_a_wall():
    def beside(half):
        return on_the_floor(box((-200, 0), (-900, 0), (-half, half)), x=[20.0, 200.0])

    post, wide = beside(30), beside(3000)
    assert 1 - post[0] > 0.2
    assert 1 - post[1] < 0.6 * (1 - wide[1])


def test_round_the_corner_of_a_body_two_faces_dim_as_one():
    body = box((-600, 0), (-400, 0), (0, 600))
    beside, off_its_corner = (on_the_floor(body, x=[40.0], z=z) for z in (300.0, -40.0))
    assert off_its_corner == pytest.approx(beside, abs=0.05)
    before = on_the_floor(body, x=[-40.0], z=-200.0)
    assert before == pytest.approx(on_the_floor(wall(400), x=[200.0]), abs=0.06)


def test_behind_itself_a_face_dims_nothing():
    for front in (0, -3000):  # of the body: its plane is 100 mm before the place, or far away
        body = box((-600, 0), (-400, 0), (front, 3000))
        assert on_the_floor(body, x=[40.0], z=100.0) == pytest.approx(0.726, abs=0.005)


def test_what_hangs_below_a_plane_or_lies_along_it_dims_nothing():
    leg = box((-100, 100), (1, 800), (-100, 100))
    sheet = box((-1500, 1500), (-1, -0.5), (-1500, 1500), (1, 1, 1))
    assert (on_the_floor(leg, x=np.arange(0.0, 600, 50)) == 1).all()
    assert (on_the_floor(sheet, x=np.arange(0.0, 600, 50)) == 1).all()


def test_the_same_place_is_as_dim_from_wherever_one_looks():
    turned = pose(rotation_from_vector([0, 0, 0.8]), [0, 0, 0])
    aside = look_at([1500, -2500, -800], [200, 0, 0])
    x = np.array([80.0, 200, 320])
    want = on_the_floor(wall(800), x=x)
    for G in (turned @ ABOVE.G, aside):
        camera = Camera(ABOVE.A, G, size=ABOVE.size)
        assert on_the_floor(wall(800), x=x, camera=camera) == pytest.approx(want, abs=0.01)


def test_a_board_in_the_middle_of_the_room_is_as_bright_as_without_occlusion():
    held = room_with(course.board(), course.poses()[6])
    plain = replace(held, around=replace(held.around, occlusion=0))
    camera = course.camera()
    board = course.board()
    inner = np.rint(camera.moved(course.poses()[6]).project(board.points)).astype(int)
    (u0, v0), (u1, v1) = inner.min(axis=0), inner.max(axis=0)
    with_, without = (radiance(scene, camera, samples=4) for scene in (held, plain))
    assert np.array_equal(*(x[v0:v1, u0:u1] for x in (with_, without)))
    assert (with_ < without - 20).any()  # elsewhere


def test_the_corners_of_the_room_are_dimmer_than_the_middle_of_its_walls():
    camera = Camera(intrinsics(300, 300, 159.5, 119.5), size=(320, 240))
    seen = radiance(room(), camera, samples=1)
    z = depth_map(room(), camera)
    back = np.isclose(z, 10_000)
    row = seen[100, :, 2][back[100]]
    assert row[:3].mean() < 0.85 * np.median(row)
    corner, level = (camera.project(M) for M in ([-3000.0, -1600, 10_000], [-3000.0, 0, 10_000]))
    grey = [seen[tuple(np.rint(m[::-1] + (2, 2)).astype(int))][2] for m in (corner, level)]
    assert grey[0] < grey[1]


def test_faces_that_are_no_rectangles_of_two_triangles_are_refused_in_words():
    some = box((-1, 1), (-1, 1), (3, 5))
    odd = replace(
        some,
        **{n: getattr(some, n)[1:] for n in ("triangles", "colours", "uv", "extent")},
        around=EVEN,
    )
    with pytest.raises(CvnotesError, match="two triangles each"):
        radiance(odd, ABOVE)
    with pytest.raises(CvnotesError, match="occlusion"):
        Surroundings(occlusion=-1)
    with pytest.raises(InputTypeError, match="occlusion"):
        Surroundings(occlusion="far")
