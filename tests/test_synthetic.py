"""Pictures of known cameras, held against a supersampler that shares no code with the renderer."""

from functools import cache

import cv2
import numpy as np
import pytest

from cvnotes.base import CvnotesError, InputTypeError, ShapeError
from cvnotes.camera import Camera, Lens, intrinsics, look_at, pose, rotation_from_vector
from cvnotes.pictures import clutter, gaussian_blur, render
from cvnotes.targets import Chessboard, ThreePlanes, TwoPlanes

BOARD = Chessboard((9, 6), 25.0)
CAMERA = Camera(intrinsics(800, 804, 325, 238), lens=Lens(k=(-0.25, 0.10)), size=(640, 480))
SMALL = Camera(intrinsics(100, 101, 41, 29), lens=Lens(k=(-0.25, 0.10)), size=(80, 60))
PAPER, INK, BEHIND = 220.0, 30.0, 110.0


class Scene:
    """Some faces, as a target."""

    def __init__(self, *faces):
        self.faces = faces


def scene_grey(target, G, xy, margin=1.0):
    """What a ray through the ideal point `xy` meets: direct look-up in the pattern of each face."""
    x, y = xy[..., 0], xy[..., 1]
    nearest, grey = np.full(xy.shape[:-1], np.inf), np.full(xy.shape[:-1], BEHIND)
    for world_from_board, board in target.faces:
        cam_from_board = G @ world_from_board
        with np.errstate(all="ignore"):
            a, b, c = np.linalg.inv(cam_from_board[:3, [0, 1, 3]])
            depth = 1 / (c[0] * x + c[1] * y + c[2])
            scale = depth / board.square
            i, j = (a[0] * x + a[1] * y + a[2]) * scale, (b[0] * x + b[1] * y + b[2]) * scale
            columns, rows = board.corners
            on_paper = (i > -1 - margin) & (i < columns + margin)
            on_paper &= (j > -1 - margin) & (j < rows + margin) & (depth > 0) & (depth < nearest)
            dark = (i > -1) & (i < columns) & (j > -1) & (j < rows)
            dark &= (np.floor(i) + np.floor(j)) % 2 == 0
        if np.linalg.det(cam_from_board[:3, [0, 1, 3]]) < 0:  # seen from behind
            dark[...] = False
        grey = np.where(on_paper, np.where(dark, INK, PAPER), grey)
        nearest = np.where(on_paper, depth, nearest)
    return grey


def supersampled(target, camera, margin=1.0, everywhere=False):
    """The mean over 32 × 32 samples: in pixels whose corners, sides or centre differ, or in all.

    Of such a pixel's 8 × 8 parts those with equal corners are of one grey, which is theirs.
    """
    (w, h), G = camera.size, camera.G
    half = half_pixels(camera.A.tobytes(), camera.lens, w, h)
    lattice = np.concatenate(
        [scene_grey(target, G, xy, margin) for xy in np.array_split(half, h // 8)]
    )
    nine = [lattice[i : i + 2 * h : 2, j : j + 2 * w : 2] for i in range(3) for j in range(3)]
    picture = nine[4].copy()
    mixed = np.argwhere(everywhere | differ(nine))
    for part in np.array_split(mixed, len(mixed) // (100 if everywhere else 400) + 1):
        v, u = part.T[..., None, None]
        if everywhere:
            xy = samples(camera, u, v, (np.arange(32) + 0.5) / 32 - 0.5)
            grey = scene_grey(target, G, xy, margin)
        else:
            xy = samples(camera, u, v, np.linspace(-0.5, 0.5, 9))
            met = scene_grey(target, G, xy, margin)
            grey = met[:, :-1, :-1].copy()
            k, i, j = np.nonzero(differ([grey, met[:, 1:, :-1], met[:, :-1, 1:], met[:, 1:, 1:]]))
            i, j = i[:, None, None] + [[0], [1]], j[:, None, None] + [0, 1]
            fine = bilinear(xy[k[:, None, None], i, j], (np.arange(4) + 0.5) / 4)
            grey[k, i[:, 0, 0], j[:, 0, 0]] = scene_grey(target, G, fine, margin).mean((1, 2))
        picture[part[:, 0], part[:, 1]] = grey.mean((1, 2))
    return picture


def differ(greys):
    return np.any([grey != greys[0] for grey in greys[1:]], axis=0)


@cache
def half_pixels(A, lens, w, h):
    """Ideal coordinates of the corners, middles of the sides and centres of all pixels."""
    u, v = np.meshgrid(np.arange(-0.5, w, 0.5), np.arange(-0.5, h, 0.5))
    return Camera(np.frombuffer(A).reshape(3, 3), lens=lens).ideal(np.stack([u, v], -1))


def samples(camera, u, v, sub):
    """Ideal coordinates of the samples in pixels; linear within a pixel unless the lens folds."""
    if camera.lens.max_radius < np.inf:
        return camera.ideal(np.stack(np.broadcast_arrays(u + sub, v + sub[:, None]), -1))
    corner = np.stack(np.broadcast_arrays(u + [[-0.5, 0.5]], v + [[-0.5], [0.5]]), -1)
    return bilinear(camera.ideal(corner), 0.5 + sub)


def bilinear(corners, at):
    """Points (n, k, k, 2) at fractions (k,) of the sides of squares of corners (n, 2, 2, 2)."""
    a = np.stack([1 - at, at], -1)
    return np.einsum("ri,sj,pijc->prsc", a, a, corners, optimize=True)


@pytest.fixture(scope="module")
def pictures():
    """Twenty tilted boards, all over the picture: camera, picture, reference."""
    rng, shots = np.random.default_rng(7), []
    while len(shots) < 20:
        R = rotation_from_vector(rng.uniform(-0.7, 0.7, 3))
        camera = CAMERA.moved(pose(R, [*rng.uniform(-150, 0, 2), rng.uniform(400, 700)]))
        m = camera.project(BOARD.points)
        if (m > 12).all() and (m < [627, 467]).all():
            shots.append((camera, render(BOARD, camera), supersampled(BOARD, camera)))
    return shots


def rms(a, b):
    return float(np.sqrt(np.mean((np.asarray(a, float) - b) ** 2)))


def refined(image, m, window=5):
    """OpenCV's corners, started at the truth; pixel centres are integers there too."""
    start = m.astype(np.float32).reshape(-1, 1, 2).copy()
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 100, 1e-5)
    return cv2.cornerSubPix(image, start, (window, window), (-1, -1), stop)[:, 0]


@pytest.mark.slow
def test_every_grey_value_is_the_mean_over_its_pixel(pictures):
    errors = [rms(image, reference) for _, image, reference in pictures]
    assert max(errors) < 0.15
    assert np.mean(errors) < 0.08  # of which most is the reference's


@pytest.mark.slow
def test_corners_are_found_where_the_camera_projects_them(pictures):
    errors = []
    for camera, image, _ in pictures:
        m = camera.project(BOARD.points)
        errors.append(refined(image, m) - m)
    np.testing.assert_allclose(np.concatenate(errors).mean(axis=0), 0, atol=0.005)


def test_a_corner_at_pixel_100_50_is_drawn_around_that_pixels_centre():
    camera = Camera(intrinsics(300, 300, 100, 50), pose(np.eye(3), [0, 0, 250]), size=(200, 120))
    image = render(BOARD, camera)
    around = image[40:61, 90:111].astype(int)
    assert around[10, 10] == (PAPER + INK) / 2
    np.testing.assert_array_equal(around, around[::-1, ::-1])
    np.testing.assert_array_equal(around + around[:, ::-1], PAPER + INK)
    np.testing.assert_allclose(refined(image, np.array([[100.4, 49.7]]))[0], [100, 50], atol=1e-3)


@pytest.mark.parametrize("du", [-0.4, -0.1, 0.25])
def test_an_edge_within_a_pixel_gives_the_part_of_ink_in_it(du):
    camera = Camera(
        intrinsics(300, 300, 100 + du, 50), pose(np.eye(3), [0, 0, 250]), size=(200, 120)
    )
    row = render(BOARD, camera)[40]  # ink to the left of the corner, paper to its right
    ink = 0.5 + du
    assert row[99] == INK
    assert row[101] == PAPER
    assert row[100] == np.rint(ink * INK + (1 - ink) * PAPER)


HARD = {
    "tiny squares": (BOARD, SMALL, look_at([100, 60, -3000], [100, 60, 0]), 1.0),
    "a grazing view": (BOARD, SMALL, look_at([100, 250, -25], [100, 60, 0]), 1.0),
    "in the midst of the squares": (BOARD, SMALL, look_at([100, 60, -20], [130, 60, 0]), 1.0),
    "behind": (BOARD, SMALL, look_at([60, 50, 500], [100, 60, 0], [0.4, -1, 0]), 1.0),
    "no paper": (BOARD, SMALL, look_at([20, 10, -350], [100, 60, 0], [0.3, -1, 0]), 0.0),
    "two planes": (
        TwoPlanes(Chessboard((5, 4))),
        SMALL,
        look_at([330, -150, -420], [50, 40, -40]),
        1.0,
    ),
    "two planes, more paper": (
        TwoPlanes(Chessboard((5, 4))),
        SMALL,
        look_at([330, -150, -420], [50, 40, -40]),
        2.3,
    ),
    "three planes": (
        ThreePlanes(Chessboard((5, 4))),
        SMALL,
        look_at([330, -350, -520], [40, -40, -40]),
        1.0,
    ),
    "boards through each other": (
        Scene(
            (np.eye(4), BOARD),
            (pose(rotation_from_vector([0, 0.7, 0.1]), [20, 20, 40]), BOARD),
            (pose(rotation_from_vector([0.3, 0, 0]), [120, 70, -60]), Chessboard((4, 3), 10.0)),
        ),
        SMALL,
        pose(rotation_from_vector([0.4, 0.3, 0.1]), [-95, -60, 430]),
        1.0,
    ),
    "two boards in one plane": (
        Scene((np.eye(4), BOARD), (pose(np.eye(3), [105, 40, 0]), BOARD)),
        SMALL,
        look_at([300, 10, -600], [150, 60, 0]),
        1.0,
    ),
    "the lens ends within the picture": (
        BOARD,
        Camera(SMALL.A, lens=Lens(k=(-1.6,)), size=(80, 60)),
        pose(rotation_from_vector([0.5, 0.2, 0]), [-95, -60, 200]),
        1.0,
    ),
    "a lens of many terms": (
        BOARD,
        Camera(
            intrinsics(100, 101, 41, 29, 3.0),
            size=(80, 60),
            lens=Lens(k=(-0.25, 0.1), p=(0.01, -0.02), centre=(0.03, -0.02)),
        ),
        pose(rotation_from_vector([0.4, 0.3, 0.1]), [-95, -60, 400]),
        1.0,
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", HARD)
def test_hard_scenes_agree_with_the_supersampler_too(name):
    target, camera, G, margin = HARD[name]
    reference = supersampled(target, camera.moved(G), margin, everywhere=True)
    image = render(target, camera.moved(G), margin=margin)
    assert len(np.unique(reference)) > 30
    assert rms(image, reference) < 0.6
    assert np.abs(image - reference).max() < 4


def test_a_fold_between_two_planes_shows_nothing_of_what_is_behind():
    target = TwoPlanes(Chessboard((5, 4)))
    camera = CAMERA.moved(look_at([330, -150, -420], [50, 40, -40]))
    u, v = camera.project([0, 30, 0]).round().astype(int)  # on the common edge
    patch = render(target, camera, background=0.0)[v - 20 : v + 20, u - 4 : u + 5]
    np.testing.assert_array_equal(patch, PAPER)


def test_an_edge_on_board_and_one_behind_the_camera_show_only_background():
    for G in (look_at([0, 0, 0], [1, 0, 0]), pose(np.eye(3), [0, 0, -400])):
        np.testing.assert_array_equal(render(BOARD, SMALL.moved(G)), BEHIND)


def test_where_the_lens_does_not_reach_there_is_background():
    camera = Camera(intrinsics(800, 800, 320, 240), lens=Lens(k=(-1.6,)))
    image = render(BOARD, camera.moved(look_at([100, 60, -40], [100, 60, 0])))
    u, v = np.meshgrid(np.arange(640), np.arange(480))
    end = 800 * camera.lens.max_radius * float(camera.lens.L(camera.lens.max_radius))
    r = np.hypot(u - 320, v - 240)
    assert (image[r > end + 1] == BEHIND).all()
    assert np.isin(image[r < end - 1], [PAPER, INK]).mean() > 0.9


def test_the_margin_is_so_many_squares_wide():
    camera = CAMERA.moved(look_at([100, 62.5, -1500], [100, 62.5, 0]))
    for margin in (0.0, 0.5, 2.0):
        white_or_black = render(BOARD, camera, margin=margin, background=255.0) < 250
        area = (10 + 2 * margin) * (7 + 2 * margin) * (25 / 1500) ** 2 * 800 * 804
        assert white_or_black.sum() == pytest.approx(area, rel=0.03)


# ---- what happens on the way to the picture


def near(**effects):
    """A small picture of the first corners."""
    camera = SMALL.moved(pose(rotation_from_vector([0.3, 0.2, 0.1]), [-40, -30, 200]))
    return render(BOARD, camera, **effects), camera


@pytest.mark.slow
def test_blur_is_that_of_the_scene_before_the_pixels_average_it():
    _, camera = near()
    w, h, n, sigma = *camera.size, 16, 0.7
    pad = 6  # pixels of the scene beyond the border that are blurred into it
    fine = (np.arange((w + 2 * pad) * n) + 0.5) / n - 0.5 - pad
    u, v = np.meshgrid(fine, fine[: (h + 2 * pad) * n])
    scene = scene_grey(BOARD, camera.G, camera.ideal(np.stack([u, v], -1)))
    blurred = gaussian_blur(scene, n * sigma).reshape(h + 2 * pad, n, w + 2 * pad, n).mean((1, 3))
    image, _ = near(blur=sigma)
    assert rms(image, blurred[pad:-pad, pad:-pad]) < 0.4  # 0.29 is the rounding
    assert (
        np.abs(image - blurred[pad:-pad, pad:-pad]).max() < 2.5
    )  # the samples are 12 grey levels apart


@pytest.mark.parametrize("blur", [0.3, 0.7, 4.0])
def test_blur_moves_no_corner(blur):
    camera = Camera(intrinsics(300, 300, 100, 50), pose(np.eye(3), [0, 0, 75]), size=(200, 120))
    around = render(BOARD, camera, blur=blur)[30:71, 80:121].astype(int)
    np.testing.assert_array_equal(around, around[::-1, ::-1])
    np.testing.assert_allclose(around + around[:, ::-1], PAPER + INK, atol=1)
    assert around[20, 20] == (PAPER + INK) / 2


def test_motion_draws_an_edge_out_over_its_length_and_leaves_it_in_place():
    camera = Camera(intrinsics(300, 300, 99.5, 50), pose(np.eye(3), [0, 0, 120]), size=(200, 120))
    row = render(BOARD, camera, motion=(8, 0))[40, 90:110].astype(float)
    ramp = INK + (PAPER - INK) * np.clip((np.arange(90, 110) - 95.5) / 8, 0, 1)
    np.testing.assert_allclose(row, ramp, atol=4)
    still = render(BOARD, camera, motion=(0, 8))[40, 90:110]
    np.testing.assert_array_equal(still, render(BOARD, camera)[40, 90:110])


def test_light_grows_from_side_to_side_by_the_given_fractions():
    flat = Camera(SMALL.A, pose(np.eye(3), [0, 0, -1]), size=(81, 61))  # nothing but background
    image = render(BOARD, flat, background=100.0, light=(0.4, -0.2)).astype(float)
    assert image[30, 40] == 100
    assert image[30, -1] == pytest.approx(100 * (1 + 0.4 * 80 / 81), abs=0.5)
    assert image[30, 0] == pytest.approx(100 * (1 - 0.4 * 80 / 81), abs=0.5)
    assert image[-1, 40] == pytest.approx(100 * (1 - 0.2 * 60 / 61), abs=0.5)


def test_vignetting_takes_light_with_the_square_of_the_distance():
    flat = Camera(intrinsics(100, 100, 30, 20), pose(np.eye(3), [0, 0, -1]), size=(81, 61))
    image = render(BOARD, flat, background=200.0, vignetting=0.5)
    assert image[20, 30] == 200
    assert image[60, 80] == 100
    assert image[40, 55] == pytest.approx(200 * (1 - 0.5 / 4), abs=0.5)


def test_gain_multiplies_and_clips():
    image, _ = near(gain=2.0)
    once, _ = near()
    assert image.max() == 255
    np.testing.assert_allclose(image[once < 127], 2.0 * once[once < 127], atol=1)


def test_the_same_seed_gives_the_same_picture_and_another_seed_another():
    def shoot(seed):
        return near(noise=5.0, blur=0.7, rng=np.random.default_rng(seed))[0]

    np.testing.assert_array_equal(shoot(3), shoot(3))
    assert (shoot(3) != shoot(4)).mean() > 0.8
    assert np.std(shoot(3) - near(blur=0.7)[0].astype(float)) == pytest.approx(5, rel=0.05)


def test_jpeg_changes_a_picture_a_little():
    image, _ = near()
    fine, coarse = (rms(near(jpeg=quality)[0], image) for quality in (95, 20))
    assert 0 < fine < 6 < coarse


def test_the_background_shows_exactly_where_no_paper_is():
    behind = clutter((80, 60), rng=np.random.default_rng(0))
    image, _ = near(background=behind, margin=0.5)
    flat, _ = near(background=0.0, margin=0.5)
    nowhere = flat == 0
    assert nowhere.sum() > 300
    np.testing.assert_array_equal(image[nowhere], np.rint(behind[nowhere]))
    everywhere = near(background=255.0, margin=0.5)[0] == flat
    np.testing.assert_array_equal(image[everywhere], flat[everywhere])
    part = ~nowhere & ~everywhere  # where the edge of the paper cuts a pixel
    share = (near(background=255.0, margin=0.5)[0][part].astype(float) - flat[part]) / 255
    mixed = flat[part] + share * behind[part]
    np.testing.assert_allclose(image[part], mixed, atol=1.5)


def test_clutter_has_edges_and_lies_between_its_grey_levels():
    picture = clutter((80, 60), rng=np.random.default_rng(1))
    assert picture.shape == (60, 80)
    assert picture.std() > 20
    assert 20 <= picture.min() <= picture.max() <= 200


WRONG = {
    "no camera": ({"camera": "mine"}, InputTypeError, "expected a Camera, got str"),
    "no target": ({"target": 3}, InputTypeError, "expected a Chessboard or the like, got int"),
    "negative blur": ({"blur": -1}, CvnotesError, "blur = -1 but must be at least 0"),
    "NaN blur": ({"blur": np.nan}, CvnotesError, "blur contains NaN"),
    "negative margin": ({"margin": -1}, CvnotesError, "margin = -1"),
    "noise without rng": ({"noise": 2}, CvnotesError, "noise needs an rng"),
    "negative noise": ({"noise": -2}, CvnotesError, "noise = -2"),
    "a seed for an rng": ({"noise": 2, "rng": 7}, InputTypeError, "rng: expected a numpy.random"),
    "light of three": ({"light": (1, 0, 0)}, CvnotesError, r"light: expected \(right, down\)"),
    "too much gradient": ({"light": (0.8, 0.8)}, CvnotesError, "together at most 1"),
    "too much vignetting": ({"vignetting": 1.5}, CvnotesError, "no more than all light"),
    "motion of one": ({"motion": 3}, ShapeError, r"motion: expected \(du, dv\)"),
    "quality 0": ({"jpeg": 0}, CvnotesError, "from 1 to 100, got 0"),
    "transposed background": ({"background": np.zeros((80, 60))}, ShapeError, r"\(60, 80\)"),
    "a colour": ({"background": (1, 2, 3)}, ShapeError, "expected a grey level"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_argument_is_refused_in_words(name):
    changed, error, words = WRONG[name]
    arguments = {"target": BOARD, "camera": SMALL} | changed
    with pytest.raises(error, match=words):
        render(arguments.pop("target"), arguments.pop("camera"), **arguments)


def test_clutter_wants_an_rng():
    with pytest.raises(InputTypeError, match=r"rng: expected a numpy\.random\.Generator, got int"):
        clutter((8, 6), rng=3)
