import numpy as np
import pytest

from cvnotes.camera import Camera, Lens, intrinsics
from cvnotes.pictures.antialiasing import (
    changing,
    crossed,
    in_tiles,
    out_of_tiles,
    pixel_centres,
    tile_order,
    within_pixel,
)

SIZE = (64, 48)
CAMERA = Camera(intrinsics(80, 80, 31.5, 23.5), size=SIZE)


def pixels_crossed(camera, *segments):
    mask = crossed(camera, np.array(segments, float), camera.ideal(pixel_centres(camera.size)))
    return {(int(u), int(v)) for v, u in np.argwhere(mask)}


def test_samples_lie_in_the_pixel_and_are_evenly_spread_along_u_and_along_v():
    for n in (1, 16, 64):
        offsets = within_pixel(n)
        assert offsets.shape == (n, 2)
        assert (np.abs(offsets) <= 0.5).all()
        assert np.allclose(np.sort(offsets[:, 0]), (np.arange(n) + 0.5) / n - 0.5, atol=1e-12)
        # Along v no gap is wider than twice the even one.
        gaps = np.diff(np.r_[-0.5, np.sort(offsets[:, 1]), 0.5])
        assert gaps.max() <= 2 / n


@pytest.mark.parametrize(("degrees", "error"), [(0, 1 / 64), (90, 1 / 32), (37, 0.06), (140, 0.06)])
def test_an_edge_through_a_pixel_is_measured_to_a_few_samples(degrees, error):
    offsets, direction = within_pixel(64), np.deg2rad(degrees)
    fine = (np.indices((500, 500)).reshape(2, -1).T + 0.5) / 500 - 0.5
    for shift in np.linspace(-0.6, 0.6, 13):
        covered, truth = (
            (points @ [np.cos(direction), np.sin(direction)] < shift).mean()
            for points in (offsets, fine)
        )
        assert covered == pytest.approx(truth, abs=error)


def test_samples_are_symmetric_about_the_pixels_centre():
    offsets = within_pixel(64)
    assert np.allclose(offsets, -offsets[::-1], atol=1e-12)


@pytest.mark.parametrize("size", [(64, 48), (61, 47), (1, 1), (15, 40)])
def test_tiles_hold_neighbours_and_can_be_put_together_again(size):
    m = pixel_centres(size)
    tiles = in_tiles(m)
    spread = np.fmax.reduce(tiles, axis=1) - np.fmin.reduce(tiles, axis=1)
    assert spread.max() <= 15
    assert np.array_equal(out_of_tiles(tiles, size), m)
    assert np.array_equal(out_of_tiles(in_tiles(m[..., 0]), size), m[..., 0])


def test_sorted_pixels_stay_within_their_tiles():
    m = pixel_centres((64, 48)).reshape(-1, 2)
    m = np.random.default_rng(0).permutation(m)
    tiles = (m[tile_order(m)] // 16).reshape(-1, 256, 2)
    assert (tiles == tiles[:, :1]).all()


def test_a_change_marks_both_sides_of_it_and_diagonal_neighbours_too():
    picture = np.zeros((6, 6, 2))
    picture[2, 3, 1] = -1.5
    marked = {tuple(p) for p in np.argwhere(changing(picture)).tolist()}
    assert marked == {(v, u) for v in (1, 2, 3) for u in (2, 3, 4)}
    assert not changing(picture * 0.5).any()


def test_a_segment_marks_every_pixel_that_it_passes_through():
    a, b = np.array([3.2, 5.4]), np.array([55.3, 40.1])
    marked = pixels_crossed(CAMERA, [[*CAMERA.ideal(m) * 7, 7] for m in (a, b)])
    way = a + np.linspace(0, 1, 5001)[:, None] * (b - a)
    inner = np.abs(way - np.rint(way)).max(axis=1) < 0.3  # well inside of a pixel
    assert {tuple(m) for m in np.rint(way[inner]).astype(int).tolist()} <= marked
    assert len(marked) <= 2 * 53


def test_a_segment_that_begins_behind_the_camera_is_cut_where_it_comes_into_view():
    floor_line = [[0.0, 1, -50], [0, 1, 1000]]
    assert pixels_crossed(CAMERA, floor_line) == {(32, v) for v in range(24, 48)}


@pytest.mark.parametrize(
    "segment",
    [
        [[0, 0, -1], [0, 0, -5]],  # behind
        [[9, 0, 5], [9, 1, 5]],  # beside
        [[9, 0, 5], [0, 9, 5]],  # past the corner
        [[-1, 0, 0], [1, 0, 0]],  # through the camera itself
    ],
)
def test_a_segment_out_of_view_marks_nothing(segment):
    assert pixels_crossed(CAMERA, segment) == set()


def test_a_segment_is_as_curved_as_the_lens_shows_it():
    camera = Camera(intrinsics(60, 60, 31.5, 23.5), lens=Lens((-0.5,)), size=SIZE)
    ends = np.array([[-2.0, -1.4, 4], [2, -1.4, 4]])
    marked = pixels_crossed(camera, ends)
    way = camera.project(ends[0] + np.linspace(0, 1, 20_000)[:, None] * (ends[1] - ends[0]))
    assert {tuple(m) for m in np.rint(way).astype(int).tolist()} >= marked
    assert len({v for _, v in marked}) >= 3


def test_no_segments_mark_nothing():
    assert not crossed(CAMERA, np.zeros((0, 2, 3)), CAMERA.ideal(pixel_centres(SIZE))).any()
