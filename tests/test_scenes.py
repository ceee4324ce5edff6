from dataclasses import replace

import numpy as np
import pytest

from cvnotes.camera import Camera, intrinsics, look_at, move, pose, rotation_from_vector
from cvnotes.pictures import (
    blocks,
    corridor,
    depth_map,
    rails,
    render_scene,
    room,
    target_scene,
)
from cvnotes.pictures.meshes import join
from cvnotes.pictures.scenes import GROUND
from cvnotes.targets import Chessboard, ThreePlanes, TwoPlanes

CAMERA = Camera(intrinsics(400, 400, 159.5, 119.5), size=(320, 240))


def brightness(picture, camera, W):
    """Grey values at the pixels nearest to world points."""
    u, v = np.rint(camera.project(W)).astype(int).T
    return picture[v, u].mean(axis=-1)


def pole():
    """The corners (8, 3) of the railway's first pole, that nearest to the origin."""
    return np.array(
        [[x, y, z] for x in (-4090, -3910) for y in (-4050, 1950) for z in (14910, 15090)]
    )


@pytest.mark.parametrize(("scene", "body"), [(blocks(), blocks().vertices[:8]), (rails(), pole())])
def test_a_shadow_begins_at_the_foot_of_what_throws_it(scene, body):
    away = -np.array(scene.around.light) * [1, 0, 1]
    away /= np.linalg.norm(away)
    feet = body[np.isclose(body[:, 1], body[:, 1].max())]
    # 3 mm beyond the last foot it is as dark as 100 mm beyond; towards the light it is bright.
    grey = []
    for W in feet[(feet @ away).argmax()] + np.outer([3, 100, -900], away):
        camera = Camera(CAMERA.A, look_at(W + [0, -300, 0] + 200 * away, W), size=CAMERA.size)
        grey += [*brightness(render_scene(scene, camera), camera, W[None])]
    near, far, lit = grey
    assert near == pytest.approx(far, abs=1)
    assert near < 0.8 * lit


@pytest.mark.parametrize(("azimuth", "elevation"), [(-150, 14), (150, 14), (30, 20), (90, 40)])
def test_a_plain_that_reaches_the_horizon_throws_no_shadow_on_itself(azimuth, elevation):
    a, e = np.radians([azimuth, elevation])
    whole = rails().lit_from((np.sin(a), -np.tan(e), np.cos(a)))
    parts = ("triangles", "colours", "uv", "extent")
    scene = replace(whole, **{name: getattr(whole, name)[: -20 * 12] for name in parts})  # no poles
    camera = Camera(CAMERA.A, pose(np.eye(3), [0, 0, -13_000]), size=CAMERA.size)
    # The ballast, farther out than the shadows of the rails reach.
    W = np.array(
        [[x, 1770, z] for x in (-2200, -1900, 1900, 2200) for z in range(22_000, 40_000, 2000)]
    )
    assert np.ptp(brightness(render_scene(scene, camera, samples=1), camera, W)) < 2


@pytest.mark.parametrize("target", [Chessboard(), TwoPlanes(), ThreePlanes()])
def test_the_squares_of_a_target_are_dark_and_light_as_its_boards_say(target):
    scene = target_scene(target)
    camera = CAMERA.moved(look_at([650, -420, -900], target.points.mean(axis=0)))
    picture = render_scene(scene, camera)
    for world_from_board, board in target.faces:
        i, j = np.meshgrid(np.arange(-1, 9), np.arange(-1, 6))
        centres = np.stack([i + 0.5, j + 0.5, 0 * i], axis=-1).reshape(-1, 3) * board.square
        grey = brightness(picture, camera, move(world_from_board, centres))
        dark = ((i + j) % 2 == 0).ravel()
        assert grey[dark].max() < 40
        assert grey[~dark].min() > 150


def test_white_paper_surrounds_the_squares_and_the_margin_can_be_chosen():
    board = Chessboard((4, 3), 20.0)
    for margin in (0.5, 1.0, 2.0):
        vertices = target_scene(board, margin=margin).vertices
        assert np.allclose(
            vertices.min(axis=0), [-20 - 20 * margin, -20 - 20 * margin, 0], atol=1e-9
        )
        assert np.allclose(vertices.max(axis=0), [80 + 20 * margin, 60 + 20 * margin, 3], atol=1e-9)
    camera = CAMERA.moved(pose(np.eye(3), [-30, -20, 200]))
    picture = render_scene(target_scene(board), camera)
    around = [[-30, y, 0] for y in (-30, 10, 50)] + [[90, y, 0] for y in (-30, 30, 70)]
    assert brightness(picture, camera, around).min() > 150


def test_a_board_seen_from_behind_is_a_grey_plate():
    board = target_scene(Chessboard((4, 3), 20.0))
    camera = CAMERA.moved(look_at([30, 20, 250], [30, 20, 0]))
    plate = render_scene(board, camera)[100:140, 140:180]
    assert np.ptp(plate.astype(int), axis=(0, 1)).max() <= 1


def test_several_boards_stand_where_they_are_put_and_hide_one_another():
    board = Chessboard((4, 3), 20.0)
    near = pose(np.eye(3), [-30, -20, 300])
    far = pose(rotation_from_vector([0, 0.3, 0]), [60, -20, 500])
    both = join(target_scene(board, near), target_scene(board, far))
    depth = depth_map(both, CAMERA)
    assert np.nanmin(depth) == pytest.approx(300)
    assert np.nanmax(depth) > 480
    u, v = np.rint(CAMERA.project([0, 0, 300])).astype(int)
    assert depth[v, u] == pytest.approx(300)


def test_the_rails_meet_in_the_vanishing_point_of_their_direction():
    camera = CAMERA.moved(look_at([0, 0, 0], [200, 100, 1000]))
    picture = render_scene(rails(), camera)
    assert picture.shape == (240, 320, 3)
    meeting = camera.vanishing_point([0, 0, 1])
    for x in (-750, 750):
        assert np.allclose(camera.project([x, 1600, 1e8]), meeting, atol=0.02)
    # The rail heads shine: brighter than what lies half a metre beside them.
    on = brightness(picture, CAMERA.moved(camera.G), [[750, 1600, 6000], [-750, 1600, 8000]])
    off = brightness(picture, CAMERA.moved(camera.G), [[1250, 1750, 6000], [-1250, 1750, 8000]])
    assert (on > off + 30).all()


def test_sleepers_are_300_mm_wide_with_gaps_of_the_same_width():
    down = CAMERA.moved(look_at([0, 1750 - 2000, 3000], [0, 1750, 3000], up=[0, 0, 1]))
    picture = render_scene(rails(), down)
    z = 3000 + np.arange(-500, 500, 10.0)
    grey = brightness(picture, down, np.stack([0 * z, 0 * z + 1750, z], axis=-1))
    edges = z[:-1][np.abs(np.diff(grey)) > 10]
    assert np.allclose(np.diff(edges), 300, atol=15)


@pytest.mark.parametrize("place", [room, corridor])
def test_a_place_is_closed_around_the_camera_and_keeps_to_three_directions(place):
    scene = place()
    for target in ([0, 0, 1], [1, 0, 0.1], [0.1, 1, 0.1], [0.1, -1, 0.1], [-1, 0.2, -1]):
        camera = CAMERA.moved(look_at([0, 0, 0], target, up=(0.1, -1, 0.3)))
        assert np.isfinite(depth_map(scene, camera)).all()
    assert np.allclose(np.sort(np.abs(scene.normals), axis=1), [0, 0, 1], atol=1e-12)


def test_the_blocks_keep_to_the_three_directions_that_are_promised():
    scene, turn = blocks(), np.deg2rad(35)
    directions = np.array(
        [[np.cos(turn), 0, -np.sin(turn)], [0, 1, 0], [np.sin(turn), 0, np.cos(turn)]]
    )
    edges = np.diff(scene.vertices[scene.edges][:36], axis=1)[:, 0]
    along = np.abs(edges @ directions.T) / np.linalg.norm(edges, axis=1, keepdims=True)
    assert np.allclose(np.sort(along, axis=1), [0, 0, 1], atol=1e-9)
    size = np.ptp(scene.vertices[:8] @ directions.T, axis=0)
    assert np.allclose(size, [4000, 5000, 4000], atol=1e-6)
    assert scene.vertices[:, 1].max() == pytest.approx(GROUND)
    # Two vanishing points on the horizon, the third far from it.
    camera = CAMERA.moved(look_at([0, 0, 0], [0, -200, 3000]))
    left, upright, right = (camera.vanishing_point(d) for d in directions)
    assert left[1] == pytest.approx(right[1], abs=1e-6)
    assert abs(upright[1] - left[1]) > 1000


@pytest.mark.parametrize("place", [room, corridor])
def test_the_tiles_of_a_floor_are_square_and_fit_its_walls(place):
    scene = place()
    side = 500 if place is room else 600
    floor = scene.corners[10:12].reshape(-1, 3)
    assert (floor[:, 1] == GROUND).all()
    lengths = np.ptp(floor, axis=0)[[0, 2]]
    assert np.allclose(lengths % side, 0, atol=1e-9)
    assert np.allclose(
        np.sort(np.ptp(scene.uv[10:12].reshape(-1, 2), axis=0)), np.sort(lengths / side)
    )


def test_every_scene_is_drawn_without_a_warning_and_is_not_flat():
    for scene in (rails(), room(), corridor(), blocks()):
        picture = render_scene(scene, CAMERA)
        assert picture.std() > 20


@pytest.mark.parametrize("scene", [blocks(), rails()])
def test_a_landscape_that_is_moved_away_with_its_camera_looks_the_same(scene):
    away = pose(np.eye(3), [2e7, 0, 3e7])
    camera = Camera(CAMERA.A, look_at([1200, -4000, 2000], [700, -500, 12_800]), size=CAMERA.size)
    here = render_scene(scene, camera).astype(int)
    beside = Camera(camera.A, camera.G @ np.linalg.inv(away), size=camera.size)
    there = render_scene(scene.moved(away), beside).astype(int)
    assert (np.abs(here - there) > 8).mean() < 1e-3
