"""The explorations: what they show is right, quick, and survives every position of the sliders."""

import base64
import html
import io
import itertools
import json
import re
import subprocess
import sys
import time
import warnings
from dataclasses import replace

import numpy as np
import pytest
from fontTools.ttLib import TTFont
from PIL import Image
from scipy import ndimage
from scipy.optimize import brentq, least_squares, minimize
from scipy.signal import fftconvolve
from scipy.spatial import Delaunay
from scipy.spatial.transform import Rotation, Slerp
from scipy.special import erf, j1

from cvnotes.base import CalibrationWarning, CvnotesError, DegenerateError, ShapeError, luma
from cvnotes.base.png import pack_png
from cvnotes.calibration import (
    calibrate,
    calibrate_one_view,
    constraints,
    intrinsics_from_b,
    solve_b,
)
from cvnotes.camera import (
    Camera,
    Lens,
    intrinsics,
    intrinsics_from_vanishing_points,
    inverse,
    look_at,
    move,
    pose,
    rotation_from_angles,
    rotation_from_vector,
    vanishing_point,
    vector_from_rotation,
    xy_from_px,
)
from cvnotes.homography import dlt
from cvnotes.pictures import (
    blocks,
    course,
    desk,
    expose,
    gaussian_blur,
    pixel_centres,
    radiance,
    rails,
    render_scene,
    room,
    room_with,
)
from cvnotes.pictures.meshes import box, join
from cvnotes.projective import apply, from_homogeneous, to_homogeneous
from cvnotes.show import CAMERA, ESTIMATED, IDEAL, LENS, WORLD, explorations
from cvnotes.show.explorations import (
    asks,
    clicks,
    clouds,
    cube,
    eleventh,
    epipolar,
    folds,
    formation,
    forty,
    frame,
    gimbal,
    hinge,
    horizon,
    maps,
    meet,
    moved,
    nails,
    plane,
    poster,
    protractor,
    push,
    rodrigues,
    subpixel,
    thirteen,
    triangle,
    twins,
    zoom,
)
from cvnotes.show.explorations import depth as swept
from cvnotes.show.explorations.boards import on_sheet as from_afar
from cvnotes.show.explorations.boards import pinhole, squares_between
from cvnotes.show.explorations.depth import pair
from cvnotes.show.explorations.disparity import columns, triangulated
from cvnotes.show.explorations.epipolar import cameras, seen_by_the_second
from cvnotes.show.explorations.finding import Finding, alike, rms
from cvnotes.show.explorations.fold import (
    _SHOWN,
    angles,
    circle_of,
    on_sheet,
    photographs,
    vanishing_points,
)
from cvnotes.show.explorations.folds import _SHOWN as FOLDS_SHOWN
from cvnotes.show.explorations.lens import polynomial, seen_radius
from cvnotes.show.explorations.lettering import LETTERS, SMALL
from cvnotes.show.explorations.model import Drawing, Model, Setting
from cvnotes.show.explorations.moved import between, stands
from cvnotes.show.explorations.origin import believed as believed_from
from cvnotes.show.explorations.origin import corners as corners_of_origin
from cvnotes.show.explorations.origin import place as hung_at
from cvnotes.show.explorations.origin import plain
from cvnotes.show.explorations.page import asked
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.explorations.pinhole import spread_out
from cvnotes.show.explorations.ransac import drawn_pairs
from cvnotes.show.explorations.rectification import turned
from cvnotes.show.explorations.rod import at_height
from cvnotes.show.explorations.ruler import behind_the_first
from cvnotes.show.explorations.seam import scene as scene_of_the_seam
from cvnotes.show.explorations.sheets import Believed
from cvnotes.show.explorations.strokes import cut
from cvnotes.show.explorations.subpixel import neighbourhood
from cvnotes.show.explorations.swing import nets, weights
from cvnotes.show.explorations.triangle import camera_of
from cvnotes.show.explorations.votes import slopes, window_at
from cvnotes.show.explorations.whose import CULPRITS, Suspects, wave
from cvnotes.show.space.shapes import target_shapes
from cvnotes.show.style import MUTED, mixed
from cvnotes.show.typeface import font_file
from cvnotes.stereo import calibrate_stereo, triangulate
from cvnotes.targets import Chessboard, TwoPlanes, refine_edges, refine_subpixel
from cvnotes.warping import backward_warp, zoom_map

# Where a panel begins within its picture, and how wide the course's picture is drawn, in px.
MARGIN, TITLE, WIDTH = 3, 22, 440
MODELS = {name: explorations.model(name) for name in explorations.NAMES}
STORIES = tuple(explorations._STORIES)
each_model = pytest.mark.parametrize("name", explorations.NAMES)


@pytest.fixture(scope="module", autouse=True)
def packed_once():
    """Let each picture be packed as small as it gets only once: many tests ask for the same."""
    module = sys.modules[Model.__module__]  # `explorations.model` is a function
    pack, known = module.packed, {}

    def packed(picture, level):
        key = (picture.shape, picture.tobytes())
        if key not in known:
            known[key] = pack(picture, level)
        return known[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "packed", packed)
        yield


@pytest.fixture(autouse=True)
def without_rings(request, monkeypatch):
    """Leave out the rings of what can be pulled: what lies beneath them is looked at here."""
    if "rings" not in request.node.name:
        monkeypatch.setattr(Panel, "_ring", lambda *_: None)


def colour(text):
    return np.array([int(text[i : i + 2], 16) for i in (1, 3, 5)])


def count(picture, text, atol=40):
    return int((np.abs(picture.astype(int) - colour(text)).max(-1) < atol).sum())


def numbers(sentence):
    return [float(x.replace("−", "-")) for x in re.findall(r"[-−+]?\d+\.?\d*", sentence)]


def random_values(model, rng):
    values = {}
    for s in model.settings:
        steps = rng.integers(0, round((s.high - s.low) / s.step) + 1)
        values[s.name] = min(s.low + steps * s.step, s.high)
    return values


def check_sight(name, values):
    drawing = MODELS[name].drawing(**values)
    assert drawing.picture.dtype == np.uint8
    assert drawing.picture.ndim == 3
    assert np.ptp(drawing.picture) > 100
    assert not drawing.sentence.startswith("No answer") or name == "homography"
    assert not re.search(r"\b(nan|inf)\b", drawing.sentence)
    return drawing


# Every exploration.


@pytest.mark.once
@each_model
def test_each_slider_may_stand_at_zero(name):
    for s in MODELS[name].settings:
        if s.low < 0 < s.high:  # else it is an end, which the next test asks for
            check_sight(name, {s.name: 0})


@pytest.mark.once
@pytest.mark.slow
@each_model
def test_all_sliders_may_stand_at_their_ends_in_every_combination(name):
    """Of more than five, in 32 that hold each combination of any two of them."""
    settings = MODELS[name].settings
    ends = np.array([*itertools.product(*((s.low, s.high) for s in settings))])
    if len(ends) > 2**5:
        ends = np.random.default_rng(7).permutation(ends)[: 2**5]
        for two in itertools.combinations(ends.T, 2):
            assert len(set(zip(*two, strict=True))) == 4
    for values in ends.tolist():
        check_sight(name, dict(zip((s.name for s in settings), values, strict=True)))


@pytest.mark.once
@each_model
def test_a_dozen_random_settings_each_give_a_picture_of_the_same_size(name):
    rng = np.random.default_rng(7)
    shapes = {check_sight(name, random_values(MODELS[name], rng)).picture.shape for _ in range(12)}
    assert shapes == {MODELS[name].picture().shape}


@pytest.mark.once
@each_model
def test_every_slider_moves_something(name):
    """From the start; or from where the others stand at an end: some only act with another."""
    model = MODELS[name]
    starts = [model.values(), {s.name: s.high for s in model.settings}]
    for s in model.settings:
        by = max(s.step, (s.high - s.low) / 8)
        for start in starts:
            value = start[s.name]
            moved = {**start, s.name: min(value + by, s.high) if value < s.high else value - by}
            if not np.array_equal(model.picture(**moved), model.picture(**start)):
                break
        else:
            raise AssertionError(s.name)


@each_model
def test_the_same_values_give_the_same_picture(name):
    model = explorations.model(name)
    assert np.array_equal(model.picture(), MODELS[name].picture())


def fastest(run):
    times = []
    for _ in range(4):
        start = time.process_time()
        run()
        times.append(time.process_time() - start)
    return min(times)


@pytest.fixture(scope="module")
def seconds_of_matplotlib():
    """Give what an empty figure with two panels takes."""
    from cvnotes.show import panels

    def pack():
        panels(2).flat[0].figure.savefig(io.BytesIO(), format="png", dpi=200)

    return fastest(pack)


@pytest.mark.once
@pytest.mark.slow
@each_model
def test_a_picture_is_made_and_packed_sooner_than_an_empty_figure_of_matplotlib(
    name, seconds_of_matplotlib
):
    assert fastest(lambda: pack_png(MODELS[name].picture())) < seconds_of_matplotlib


@pytest.mark.once
@each_model
def test_all_that_is_written_is_among_the_letters_that_a_page_brings(name, monkeypatch):
    written = set()

    def note(_self, _xy, words, *_, **__):
        written.update(words)

    finish = Panel.finish
    monkeypatch.setattr(Panel, "text", note)
    monkeypatch.setattr(
        Panel, "finish", lambda self, *page: written.update(self.title) or finish(self, *page)
    )
    rng = np.random.default_rng(3)
    for _ in range(5):
        MODELS[name].picture(**random_values(MODELS[name], rng))
    assert set("".join(written).translate(SMALL)) <= set(LETTERS)


def test_the_type_has_every_letter_that_a_page_brings():
    assert set(map(ord, LETTERS)) <= set(TTFont(font_file()).getBestCmap())


@pytest.mark.once
@each_model
def test_no_figure_is_left_open(name):
    import matplotlib.pyplot as plt

    MODELS[name].picture()
    assert plt.get_fignums() == []


@pytest.mark.once
@each_model
def test_a_still_shows_what_the_widget_shows_at_twice_the_resolution(name):
    s = MODELS[name].settings[0]
    picture = MODELS[name].still(**{s.name: s.high})
    live = MODELS[name].drawing(**{s.name: s.high})
    assert picture.alt.endswith(live.sentence)
    assert picture.alt.startswith(MODELS[name].about)
    sharp = Image.open(io.BytesIO(picture.data)).convert("RGB")
    height, width = live.picture.shape[:2]
    assert (picture.width, sharp.size) == (width, (2 * width, 2 * height))
    small = np.asarray(sharp.reduce(2)).astype(float)
    assert np.abs(small - live.picture).mean() < 6
    assert len(picture.data) < 150_000
    assert base64.b64encode(picture.data).decode() in picture._repr_html_()


def test_values_no_slider_could_say_are_refused_in_words():
    with pytest.raises(CvnotesError, match="lens: 'k9' is none of k1, k2"):
        MODELS["lens"].still(k9=0)
    with pytest.raises(CvnotesError, match=r"k1: expected a number from -1\.5 to 1\.5, got 7"):
        MODELS["lens"].still(k1=7)
    with pytest.raises(CvnotesError, match="got nan"):
        MODELS["lens"].still(k1=float("nan"))
    with pytest.raises(CvnotesError, match="expected one of camera, lens, tilt"):
        explorations.model("zoo")


def test_where_there_is_no_answer_the_sentence_says_why():
    def draw(_paper, _values):
        raise DegenerateError("three points are collinear; move one")

    model = Model("x", "Nothing.", (Setting("a", "a", 0, 1, 1, 0, ""),), draw)
    drawing = model.drawing()
    assert drawing.sentence == "No answer: three points are collinear; move one."
    assert count(drawing.picture, ESTIMATED) > 50


def test_another_camera_and_another_board_may_be_given():
    camera = Camera(intrinsics(500, 505, 250, 190), lens=Lens(k=(-1.7, 0.2)), size=(500, 400))
    board = course.Chessboard((6, 5), 40.0)
    for name in explorations.NAMES:
        if name in STORIES:
            with pytest.raises(CvnotesError, match=f"{name}: shows photographs of the course"):
                explorations.model(name, camera)
            continue
        model = explorations.model(name, camera, board)
        rng = np.random.default_rng(1)
        assert model.picture(**random_values(model, rng)).any()
    assert explorations.model("lens", camera).settings[0].value == -1.7


# What each of them shows.


def test_T_is_not_where_the_camera_stands():
    turned = {"angle_x": 0, "angle_y": 0, "angle_z": 90, "T_x": 100, "T_y": 0, "T_z": 500}
    said = numbers(MODELS["camera"].drawing(**turned).sentence)
    # R carries x to y, so Rᵀ carries it to −y: C = −Rᵀ (100, 0, 500) = (0, 100, −500).
    assert said == [100, 0, 500, 0, 100, -500]


def test_the_board_is_drawn_where_the_camera_sees_it():
    picture = MODELS["camera"].picture(angle_x=0, angle_y=0, angle_z=0, T_x=-100, T_y=-60, T_z=500)

    def grey_at(X, Y):
        m = np.array([325 + 800 * (X - 100) / 500, 238 + 804 * (Y - 60) / 500])
        u, v = (m + 0.5) * WIDTH / 640 + [MARGIN, TITLE]
        return picture[round(v), round(u)].mean()

    for i in range(-1, 9):
        for j in range(-1, 6):
            dark = (i + j) % 2 == 0
            grey = grey_at(25 * (i + 0.5), 25 * (j + 0.3))
            assert grey < 60 if dark else grey > 230, (i, j)


def test_numbers_below_zero_have_a_minus_sign_and_no_hyphen():
    for name, values in (("camera", {}), ("ring", {"angle": 135})):
        sentence = MODELS[name].drawing(**values).sentence
        assert re.search(r"−\d", sentence)
        assert not re.search(r"-\d", sentence)


def test_from_behind_a_board_is_plain_paper():
    turned = {"T_x": -190, "T_y": -80, "T_z": 650}
    front, behind = (MODELS["camera"].drawing(**turned, angle_y=angle) for angle in (60, 75))
    black = [count(each.picture[TITLE:, :WIDTH], "#262629", 12) for each in (front, behind)]
    assert black[0] > 300 > 50 > black[1]
    assert "behind the board" in behind.sentence
    assert "behind the board" not in front.sentence


def test_the_small_picture_lies_on_the_rays_and_T_is_walked_in_the_cameras_own_steps(
    written, monkeypatch
):
    lines, line = [], Panel.line

    def kept(panel, xy, colour, width=1.5, dash=0, rim=0):
        lines.append((np.array(xy), dash))
        line(panel, xy, colour, width, dash, rim)

    monkeypatch.setattr(Panel, "line", kept)
    board = course.board()
    for values in (
        {},
        {"T_x": 20, "T_y": -90, "angle_y": 5, "T_z": 450},
        {"T_x": -60, "angle_z": 8},
    ):
        written.clear()
        lines.clear()
        drawing, v = MODELS["camera"].drawing(**values), MODELS["camera"].values(**values)
        grip = grip_of(drawing, "camera")
        R = rotation_from_angles(*np.radians([v["angle_x"], v["angle_y"], v["angle_z"]]))
        T = np.array([v["T_x"], v["T_y"], v["T_z"]])
        C = -R.T @ T

        def place(W, grip=grip, C=C):
            return from_afar(W - C) / grip.unit + grip.place

        # 125 mm before the camera a ray from a square's middle pierces the small picture.
        i, j = np.indices((10, 7)).reshape(2, -1) - 1
        M = board.square * np.column_stack([i + 0.5, j + 0.5, 0 * i]) @ R.T + T
        seen = [325, 238] + 800 * M[:, :2] / M[:, 2:] * [1, 1.005]
        shown = ((seen > 10) & (seen < [630, 470])).all(axis=1)
        b, a = np.rint(place(C + 125 / M[shown, 2:] * M[shown] @ R)).astype(int).T[::-1]
        ink, dark = drawing.picture[b, a].astype(int), (i + j)[shown] % 2 == 0
        across = (place(np.zeros(3)) - place(C)) @ [[0, 1], [-1, 0]]  # across T
        off = np.abs((np.column_stack([a, b]) - place(C)) @ across) / np.linalg.norm(across)
        bare = (np.ptp(ink, axis=1) < 40) & (off > 6)  # neither under an axis nor under T
        assert bare.mean() > 0.5
        grey = ink.mean(axis=1)
        assert np.mean(grey[dark & bare] < 138) > 0.9 < np.mean(grey[~dark & bare] > 138), values
        panel, at = written["T"]
        assert np.linalg.norm(at - from_afar(C + R.T @ T / 2)) < 12 * panel.pixel
        words = ", ".join(f"{step:.0f}" for step in T)
        assert panel.title == f"space, T = ({words}) mm: pull the camera"
        (steps,) = (xy for xy, dash in lines if dash == 5)
        corners = [np.zeros(3), *np.cumsum(np.diag(T), axis=0)]
        assert np.allclose(steps, from_afar(C + np.array(corners) @ R))
        of_z, at = written[f"z {T[2]:.0f}"]
        middle = from_afar(C + (np.array([T[0], T[1], T[2] / 2])) @ R)
        assert np.linalg.norm(at - middle) < 18 * of_z.pixel


def test_a_board_beside_the_picture_is_missed_in_words():
    assert "All inner corners are outside" in MODELS["camera"].drawing(T_y=236).sentence
    assert "outside" not in MODELS["camera"].drawing(T_x=-236).sentence


def test_a_board_behind_the_camera_has_no_image():
    drawing = MODELS["camera"].drawing(T_z=0)
    assert "behind the camera" in drawing.sentence
    assert count(drawing.picture[TITLE + 2 :, MARGIN + 2 : WIDTH], "#262629", 10) < 200


def test_a_lens_with_k1_of_minus_four_thirds_folds_at_one_half():
    drawing = MODELS["lens"].drawing(k1=-4 / 3, k2=0)
    assert "folds at r = 0.500" in drawing.sentence
    assert count(drawing.picture, ESTIMATED) > 500
    # On the axes the fold lies at r L(r) = 1/3; the grid panel shows 1.68 in 360 px.
    middle, reach = np.array([MARGIN + 215, TITLE + 180]), 360 / 1.68 / 3
    for direction in ([1, 0], [-1, 0], [0, 1], [0, -1]):
        u, v = np.rint(middle + reach * np.array(direction)).astype(int)
        assert count(drawing.picture[v - 2 : v + 3, u - 2 : u + 3], ESTIMATED) > 0


def test_no_exploration_needs_scipy_which_a_page_does_not_load_for_it():
    block = "import sys; sys.modules['scipy'] = sys.modules['cv2'] = None; "
    modules = ", ".join(f"cvnotes.show.explorations.{name}" for name in explorations.NAMES)
    subprocess.run([sys.executable, "-c", f"{block}import {modules}"], check=True)


@pytest.mark.parametrize("name", ["warp"])
def test_without_scipy_a_photograph_has_the_same_digits(name, monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy.special", None)
    assert np.array_equal(explorations.model(name).picture(), MODELS[name].picture())


def test_where_the_lens_folds_is_told_as_it_is_seen_beside_the_pictures_corners():
    said = numbers(MODELS["lens"].drawing(k1=-1, k2=0).sentence.replace("r'", ""))
    r = 1 / np.sqrt(3)  # where 1 − 3 r² = 0
    far = np.hypot((639.5 - 325) / 800, 241.5 / 804), np.hypot(325.5 / 800, 241.5 / 804)
    assert np.allclose(said[:4], [r, r - r**3, max(far), 4], atol=6e-4)


def test_a_lens_that_does_nothing_moves_nothing_and_folds_nowhere():
    drawing = MODELS["lens"].drawing(k1=0, k2=0)
    assert "folds" not in drawing.sentence
    assert "from the centre, this one there too. What is seen" in drawing.sentence
    assert numbers(drawing.sentence)[-1] == 0
    assert count(drawing.picture, ESTIMATED) == 0
    assert count(drawing.picture, LENS) > 1000


def test_the_drawn_polynomial_is_the_lens_wherever_that_is_valid():
    lens = Lens((-0.3, 0.2, -0.1))
    xy = np.random.default_rng(0).uniform(-0.4, 0.4, (50, 2))
    assert np.allclose(polynomial(lens, xy), lens.distort(xy), atol=1e-14)
    assert np.isfinite(polynomial(lens, 100 * xy)).all()


def test_the_sentence_tells_how_far_an_ideal_lens_would_show_the_corners_elsewhere():
    said = numbers(MODELS["lens"].drawing(k1=-0.25, k2=0).sentence)[-1]
    # The farthest corner is the lower left one; r − 0.25 r³ = r' has the ideal r as smallest root.
    x, y = (-0.5 - 325) / 800, (479.5 - 238) / 804
    seen = np.hypot(x, y)
    roots = np.roots([-0.25, 0, 1, -seen])
    r = roots[roots > 0].min()
    assert abs(said - (r / seen - 1) * np.hypot(800 * x, 804 * y)) < 0.06


def test_the_wall_is_measured_by_the_four_corners_that_are_given():
    model, mm = MODELS["homography"], np.array([-330, 470])
    camera = Camera(course.camera().A, look_at([1180, 150, -760], [-60, 340, 0]))
    corners = np.array([[0, 0, 0], [420, 0, 0], [420, 594, 0], [0, 594, 0]])
    read = np.array([grip.at for grip in model.drawing().grips if "corner" in grip.name])
    assert np.abs(read - camera.project(corners)).max() < 1  # whole pixels were read off
    for nudge in ({}, {"du4": 2}, {"du1": 5, "dv3": -3}):
        m = read.copy()
        for name, by in nudge.items():
            m[int(name[2]) - 1, "uv".index(name[1])] += by
        matrix = np.concatenate([[[*W, 1, 0, 0, 0, *(-u * W)], [0, 0, 0, *W, 1, *(-v * W)]]
                                 for W, (u, v) in zip(corners[:, :2], m, strict=True)])  # fmt: skip
        H = np.append(np.linalg.solve(matrix, m.ravel()), 1).reshape(3, 3)
        x, y, w = np.linalg.solve(H, [259, 285, 1])
        at = np.array([x, y]) / w
        said = numbers(model.drawing(**nudge, u=259, v=285).sentence)
        assert np.abs(at - said[:2]).max() < 0.51
    # Straight on, the switch's plate is a square of 80 mm about (−330, 470).
    straight = model.picture()[TITLE:, 372 + 6 + MARGIN :].astype(int)
    u, v = np.rint((mm - [-440, -70]) * 346 / 900).astype(int)
    wall, around = straight[v - 60, u], straight[v - 24 : v + 25, u - 24 : u + 25]
    rows, columns = np.nonzero((around - wall).min(axis=-1) > 4)  # paler than wall and line
    assert np.ptp(columns) == pytest.approx(80 * 346 / 900, abs=2.5)
    assert np.ptp(rows) == pytest.approx(80 * 346 / 900, abs=2.5)


def test_a_switch_that_runs_away_is_seen_straight_on_until_it_is_a_metre_off():
    """On the left until the horizon comes near, and then on the right: 2 m are shown."""
    model = MODELS["homography"]
    for by, seen in ((40, True), (60, False), (90, False), (100, True)):
        drawing = model.drawing(du1=by, dv1=by, u=259, v=285)
        mm = np.array(numbers(drawing.sentence)[:2])
        u, v = np.rint((mm - [-1000, -513.5]) * 346 / 2000).astype(int)
        straight = drawing.picture[TITLE : TITLE + 279, 372 + 6 + MARGIN : 372 + 6 + MARGIN + 346]
        assert (0 <= u < 346) == seen
        assert not seen or count(straight[v - 2 : v + 3, u - 2 : u + 3], IDEAL) > 4
        if not seen:  # an arrow at the side where it has left
            side = straight[:, 8:60] if u < 0 else straight[:, -60:-8]
            assert count(side, IDEAL) > 60


def test_a_picture_left_alone_has_neither_holes_nor_folds():
    for angle in (0, 90, -90, 180, -180):
        said = numbers(MODELS["warp"].drawing(angle=angle, zoom=1).sentence)
        assert said[0] == said[2] == 0
        assert said[1] == (105 * 79 if angle % 180 == 0 else 79 * 79)


def test_zoomed_by_two_three_quarters_of_the_picture_are_holes():
    drawing = MODELS["warp"].drawing(angle=0, zoom=2)
    holes, covered, folds = numbers(drawing.sentence)[:3]
    assert covered == 105 * 79
    assert folds == 0
    assert abs(holes / covered - 0.75) < 0.01
    assert "; 75 % stay empty." in drawing.sentence
    left, right = drawing.picture[:, :426], drawing.picture[:, 426:]
    assert count(left, ESTIMATED) / (420 * 316) > 0.65
    assert count(right, ESTIMATED) == 0


def test_forward_and_backward_show_the_same_but_for_the_holes():
    for values in ({"angle": 30, "zoom": 1}, {"angle": -50, "zoom": 0.7}):
        picture = MODELS["warp"].picture(**values).astype(int)[TITLE + 4 : 334]
        left, right = picture[:, 4:422], picture[:, 430:848]
        hole = np.abs(left - colour(ESTIMATED)).max(-1) < 60
        fold = left[..., 2] > left[..., 0] + 40
        assert (np.abs(left - right).max(-1) < 30)[~hole & ~fold].mean() > 0.9


def test_a_smaller_picture_has_no_holes_for_there_is_nothing_to_show_around_it():
    holes, covered, folds = numbers(MODELS["warp"].drawing(angle=0, zoom=0.5).sentence)[:3]
    assert holes == 0
    assert abs(covered - 52.5 * 39.5) < 60
    assert folds > 0.9 * covered


def test_partners_stand_where_both_turned_cameras_see_them_and_at_the_end_in_one_row():
    first, second = cameras()
    W = np.array([1900.0, -450, 7600])  # on the cupboard's front
    u, v = first.project(W).round()
    W = first.ray([u, v]) / first.ray([u, v])[2] * 7600
    step = second.centre - first.centre
    for part in (0, 30, 60, 100):
        drawing = MODELS["rectification"].drawing(turned=part, u=u, v=v)
        rows, expected = numbers(drawing.sentence)[:2], []
        e2 = np.cross(first.R[2] + second.R[2], step)
        R = np.array([e / np.linalg.norm(e) for e in (step, e2, np.cross(step, e2))])
        for start, centre in ((first.R, first.centre), (second.R, second.centre)):
            ends = Rotation.from_matrix([start, R])  # and the shortest way between them
            m = first.A @ Slerp([0, 100], ends)(part).as_matrix() @ (W - centre)
            expected.append(m[1] / m[2])
        assert rows == pytest.approx(expected, abs=0.06)
    assert rows[0] == rows[1]
    assert "infinity" in drawing.sentence


def test_a_turned_camera_shows_what_it_would_see_and_grey_where_nothing_was_taken():
    picture = MODELS["rectification"].picture(turned=100, slid=0).astype(int)
    for k, camera in enumerate(turned(1)):
        photo = render_scene(room(), camera)
        seen = np.asarray(Image.fromarray(photo).resize((400, 300))).astype(int)
        panel = picture[TITLE : TITLE + 300, MARGIN + k * 406 :][:, :400]
        off = np.abs(panel - seen).max(axis=2)
        grey = (panel == 110).all(axis=2)
        assert 0.05 < grey.mean() < 0.4
        assert np.median(off[~grey]) <= 2
        assert (off[~grey] < 30).mean() > 0.88  # but for the lines, the mark and the names


@pytest.mark.parametrize("values", [{"slid": 0}, {"turned": 50}, {"turned": 100, "slid": 60}])
def test_epipolar_lines_cross_both_pictures_from_border_to_border(values):
    picture = MODELS["rectification"].picture(**values).astype(int)[TITLE : TITLE + 300]
    orange = np.abs(picture - colour(ESTIMATED)).max(axis=2) < 60
    for k in (0, 1):
        panel = orange[:, MARGIN + k * 406 :][:, :400]
        for border in (panel[:, 3:40], panel[:, -40:-3]):
            assert ndimage.label(border)[1] >= 5


def test_the_lenses_differ_by_so_many_times_what_noise_makes_of_a_corner():
    _, _, _, misfit, times, *_ = numbers(MODELS["tilt"].drawing(tilt=30).sentence)
    assert times == pytest.approx(misfit / np.hypot(0.1, 0.1), rel=0.03)


def test_no_more_pixels_are_folds_than_are_covered():
    for angle in (0, 30):
        holes, covered, folds = numbers(MODELS["warp"].drawing(angle=angle, zoom=0.5).sentence)[:3]
        assert holes == 0
        assert 0.95 * covered < folds <= covered


def test_holes_are_orange_and_folds_are_blue():
    drawing = MODELS["warp"].drawing(angle=20, zoom=1)
    holes, _, folds = numbers(drawing.sentence)[:3]
    left = drawing.picture[TITLE : TITLE + 316, MARGIN : MARGIN + 420].astype(int)
    blue = (left[..., 2] > left[..., 0] + 100).sum() / 16  # pixels of 4 × 4
    orange = (np.abs(left - colour(ESTIMATED)).max(axis=-1) < 10).sum() / 16
    assert blue == pytest.approx(folds, rel=0.05)
    assert folds == pytest.approx(holes, rel=0.1)  # what is missing here is stacked there
    assert orange == pytest.approx(holes, rel=0.05)
    # Opaque, and light where the room is: at the smallest zoom it is still seen.
    small = (
        MODELS["warp"].drawing(angle=20, zoom=0.25).picture[TITLE : TITLE + 316, :430].astype(int)
    )
    blues = small[small[..., 2] > small[..., 0] + 100]
    assert len(blues) / 16 == pytest.approx(519, abs=2)
    assert np.ptp(np.quantile(blues[:, 1], [0.05, 0.95])) > 30


@pytest.fixture(scope="module")
def finding():
    return Finding()


def test_the_way_of_the_finding_begins_at_the_closed_form_and_ends_at_the_calibration(finding):
    board, m = course.board(), course.measured_corners()
    start, _ = finding.at(0)
    assert np.allclose(start.A[0, 2], 313.93, atol=0.01)
    assert np.allclose(start.lens.k, (0.0891, -0.8532), atol=1e-4)
    end, misses = finding.at(3)
    found = calibrate(board.points, m, course.camera().size)
    assert abs(rms(misses) / found.rms - 1) < 1e-3
    for name, std in found.std.items():
        assert abs(end.parameters[name] - found.parameters[name]) < 0.05 * std
    fell = [rms(finding.at(step)[1]) for step in (0, 1, 2, 3)]
    assert np.allclose(fell, (3.7317, 0.3742, 0.0278, 0.0081), rtol=0.005)


def test_on_the_way_of_the_finding_each_part_of_a_step_is_nearer(finding):
    assert (np.diff(finding.way[::3, 1]) < 0).all()


def test_boards_are_found_nearer_to_where_they_stood_step_by_step(finding):
    off = []
    for step in (0, 1, 2, 3):
        G = finding.poses(step)
        assert np.allclose(np.linalg.det(G[:, :3, :3]), 1, rtol=1e-9)
        off.append(np.linalg.norm(G[:, :3, 3] - course.poses()[:, :3, 3], axis=1).max())
        said = numbers(MODELS["finding"].drawing(step=step).sentence)
        assert said[2] == pytest.approx(off[-1], rel=0.06)
    assert np.allclose(off, [31.1, 7.6, 0.22, 0.05], rtol=0.2)


def test_the_arrows_of_the_finding_are_its_misses_so_enlarged_as_is_said(finding, monkeypatch):
    drawn, titles = [], []
    monkeypatch.setattr(Panel, "arrows", lambda _, *arrows: drawn.append(arrows[:2]))
    make = Paper.panel
    monkeypatch.setattr(Paper, "panel", lambda *a: titles.append(a[-1]) or make(*a))
    for step in (0, 1.5, 3):
        MODELS["finding"].drawing(step=step, photograph=2)
        starts, ways = drawn[-1]
        times = next(int(title.split()[-1]) for title in titles[::-1] if "misses" in title)
        assert np.allclose(starts, finding.m[2])
        assert np.allclose(ways, -times * finding.at(step)[1][2], rtol=1e-9)
        assert 20 < np.linalg.norm(ways, axis=1).max() < 80


@pytest.fixture(scope="module")
def believed():
    real = course.real_corners()
    return Believed(real.left), Believed(real.right)


def test_the_misses_of_the_real_board_are_those_of_whole_calibrations(believed):
    real = course.real_corners()
    W = real.board.points
    sides = zip(believed, (real.left, real.right), believed[::-1], strict=True)
    for one, m, other in sides:
        in_the_sheet = other.off["all of it"] * [1, 1, 0]
        for off in (np.zeros((54, 3)), in_the_sheet):
            with warnings.catch_warnings(action="ignore", category=CalibrationWarning):
                found = calibrate(W + off, m, real.size, lens="k1 k2 p1 p2")
            assert abs(rms(one.misses(off)) / found.rms - 1) < 0.01
        free = calibrate(W, m, real.size, lens="k1 k2 p1 p2", board="free")
        assert abs(rms(one.misses(one.off["all of it"])) / free.rms - 1) < 0.02
        assert np.allclose(one.off["all of it"], free.board_points[0] - W, atol=0.03)


def test_both_cameras_find_the_same_sheet_and_each_one_serves_the_other(believed):
    left, right = believed
    for axis in range(3):
        assert (
            np.corrcoef(left.off["all of it"][:, axis], right.off["all of it"][:, axis])[0, 1]
            > 0.94
        )
    for one, other in (believed, believed[::-1]):
        flat = rms(one.misses(0 * other.off["all of it"]))
        assert rms(one.misses(other.off["all of it"])) < 0.55 * flat
        assert rms(one.misses(other.off["all of it"][::-1])) > 1.2 * flat
        best = min(range(41), key=lambda k: rms(one.misses(k / 20 * other.off["all of it"])))
        assert abs(best - 20) <= 1


def test_shifts_within_the_sheet_explain_more_than_heights_and_each_is_the_best_of_its_kind(
    believed,
):
    left, _ = believed
    flat = rms(left.misses(np.zeros((54, 3))))
    own = {part: rms(left.misses(off)) for part, off in left.off.items()}
    assert own["all of it"] < own["its shifts"] < 0.7 * flat < own["its heights"] < 0.95 * flat
    for part, axes in {"its shifts": [0, 1], "its heights": [2]}.items():
        off = left.off[part]
        assert not np.delete(off, axes, axis=1).any()
        for step in np.random.default_rng(0).normal(0, 0.02, (20, 54, len(axes))):
            moved = off.copy()
            moved[:, axes] += step
            assert rms(left.misses(moved)) > own[part]


@pytest.mark.parametrize("amount", [0, 0.5, 1, 2])
def test_the_orange_sheet_is_the_blue_one_once_and_the_bar_is_the_left_cameras(believed, amount):
    left, right = believed
    drawing = MODELS["sheets"].drawing(amount=amount)
    after = rms(left.misses(amount * right.off["all of it"]))
    said = [
        rms(left.misses(0 * left.off["all of it"])),
        *([after] if amount else []),
        rms(left.misses(left.off["all of it"])),
    ]
    assert np.allclose(
        [float(x) for x in re.findall(r"by (0\.\d+)", drawing.sentence)], said, atol=6e-4
    )
    bar = drawing.picture[TITLE:, -150 - MARGIN :].astype(int)
    filled = (np.abs(bar - colour(ESTIMATED)).max(axis=-1) < 40).sum(axis=0).max()
    assert filled / 240 * 1.14 * 0.19 == pytest.approx(after, abs=0.003)
    coloured = np.ptp(drawing.picture[TITLE + 3 : TITLE + 235].astype(int), axis=2) > 40
    blue, orange = (coloured[:, at + 3 : at + 330] for at in (MARGIN, MARGIN + 346))
    alike = (blue & orange).sum() / (blue | orange).sum()
    assert (alike > 0.7) == (amount == 1), alike


def test_a_bad_lens_tells_another_sheet_at_every_turn_and_a_bad_board_the_same():
    suspects = Suspects()
    assert np.allclose(suspects.pixels(90)[0], (319.5 + 75 * 1.55, 239.5 - 120 * 1.55))
    assert np.allclose(suspects.pixels(0, -40)[-1], (279.5 + 120 * 1.55, 239.5 + 75 * 1.55))
    for culprit in CULPRITS:  # what is left of a fault shifts, turns and stretches nothing
        W = np.column_stack([suspects.corners, np.ones(54)])
        left = suspects.shifts(culprit, 130, 30)
        assert np.abs(np.linalg.lstsq(W, left)[0]).max() < 1e-9
    for turn in (0, 30, 90, 180):
        assert np.allclose(suspects.agreement("the board", turn, 90), 1, rtol=0, atol=1e-6)
        # Rings are alike all round, so only moving the board betrays them.
        assert np.allclose(suspects.agreement("a lens, in rings", turn), 1, rtol=0, atol=1e-6)
        assert suspects.agreement("a lens, in rings", turn, -100).min() < 0.05
    assert all(abs(suspects.agreement("a lens", turn)).max() < 0.25 for turn in range(45, 181, 5))
    assert (suspects.agreement("a lens", 10) > 0.6).all()
    # The lens does the same to a pixel whatever lies there; by hand, at the first corner.
    u, v = suspects.pixels(60)[0] - (319.5, 239.5)
    by_hand = 0.2 * np.sin([-0.008 * u - 0.023 * v + np.pi / 4, 0.007 * u + 0.02 * v + np.pi / 4])
    assert np.allclose(wave("a lens", suspects.pixels(60)[0]), by_hand)
    assert np.allclose(
        wave("a lens, in rings", [349.5, 279.5]), 0.2 * np.sin(50 / 45) * np.array([0.6, 0.8])
    )
    said = MODELS["whose"].drawing(turn=90, culprit=1).sentence
    along = [float(x) for x in re.findall(r"(-?0\.\d+) along", said.replace("−", "-"))]
    assert np.allclose(along, suspects.agreement("a lens", 90), atol=0.006)


@pytest.mark.parametrize("culprit", [1, 3])
def test_the_orange_sheet_follows_the_board_only_if_the_lens_is_bad(culprit):
    one, other = (
        MODELS["whose"].drawing(turn=turn, culprit=culprit).picture[:, -320:].astype(int)
        for turn in (0, 90)
    )
    half = len(one) // 2
    changed = [(np.abs(a - b).max(axis=-1) > 60).mean() for a, b in
               ((one[:half], other[:half]), (one[half:], other[half:]))]  # fmt: skip
    assert changed[0] == 0  # the upright picture's
    assert (changed[1] > 0.1) == (culprit == 1)


def test_a_window_on_a_ramp_votes_along_it_and_one_on_a_corner_for_the_corner():
    gradients = np.zeros((40, 40, 2)) + [3.0, 4.0]  # everywhere: 5 grey levels a pixel
    ramp = window_at(gradients, (20, 20))
    assert np.allclose(ramp.eigenvalues, [0, 49 * 25])
    assert np.isclose(ramp.R, -0.05 * (49 * 25) ** 2)
    assert np.isnan(ramp.crossing).all()
    gradients = np.zeros((40, 40, 2))
    gradients[:, 18, 0], gradients[22, :, 1] = 60, 80  # an upright edge, and a level one
    gradients[22, 18] = 0
    corner = window_at(gradients, (20, 20))
    assert np.allclose(corner.eigenvalues, [6 * 60**2, 6 * 80**2])
    assert np.allclose(corner.crossing, [18, 22])


def test_a_corner_beside_the_window_is_not_in_it():
    said = {
        at: MODELS["votes"].drawing(u=at[0], v=at[1]).sentence for at in ((350, 213), (348, 217))
    }
    assert ["this is a corner" in sentence for sentence in said.values()] == [True, False]
    assert ["outside of the window" in sentence for sentence in said.values()] == [False, True]


def test_the_votes_of_the_photograph_cross_at_the_true_corner_and_nowhere_else(monkeypatch):
    inks, line = [], Panel.line

    def kept(panel, xy, colour, *rest, **how):
        inks.append(colour)
        line(panel, xy, colour, *rest, **how)

    monkeypatch.setattr(Panel, "line", kept)
    strength = np.hypot(*np.gradient(course.photo(6).astype(float)))
    for (u, v), said in (
        ((337, 205), "both are small: flat, nothing changes here."),
        ((352, 201), "this is an edge."),
    ):
        inks.clear()
        assert MODELS["votes"].drawing(u=u, v=v).sentence.endswith(said)
        window = strength[v - 3 : v + 4, u - 3 : u + 4]
        weak = int(((window > 0) & (window < 33)).sum())
        assert inks.count("#BBBBBB") == weak > 9  # the noise votes, too
    truth = course.exact_corners()[6, 22]
    for u, v in itertools.product((351, 352, 353), (212, 213)):
        *_, crossing_u, crossing_v, _ = numbers(MODELS["votes"].drawing(u=u, v=v).sentence)
        assert np.allclose([crossing_u, crossing_v], truth, atol=0.15)


@pytest.mark.parametrize("far", [310, 400, 500])
def test_in_the_bowl_the_ellipse_is_what_the_circle_of_the_noise_becomes(far, monkeypatch):
    """The corners are seen by a camera that is 1 px longer, or whose board is 1 mm farther."""
    X, Z = 0.3 * np.array([300, far]), np.array([300, far])

    def outwards(alpha, T_z):
        return (800 + alpha) * X / (Z + T_z)

    J = np.stack([(outwards(*(h)) - outwards(*(-h))) / 2e-3 for h in 1e-3 * np.eye(2)], axis=1)
    curves, line = [], Panel.line

    def kept(panel, xy, colour, width=1.5, **how):
        curves.append((panel.title[:6], np.array(xy), width))
        line(panel, xy, colour, width, **how)

    arrows = []
    monkeypatch.setattr(Panel, "line", kept)
    monkeypatch.setattr(Panel, "arrows", lambda _, *both: arrows.append(both[:2]))
    said = MODELS["bowl"].drawing(far=far, alpha=1.2, T_z=-0.4).sentence
    in_picture, arrows = np.array(arrows)[:4, 1] / 220, arrows[4:]  # the right corner's, the left's
    (circle,) = [xy for title, xy, _ in curves if title == "→ righ"]
    wide, ellipse, bar = [xy for title, xy, _ in curves if title == "errors"]
    assert np.allclose(np.linalg.norm(circle, axis=1), 0.1, rtol=1e-9)
    assert np.allclose(np.linalg.norm(ellipse @ J.T, axis=1), 0.1, rtol=1e-4)
    assert np.allclose(wide, 2 * ellipse, rtol=1e-9)
    std = np.sqrt(0.01 * np.linalg.inv(J.T @ J)[0, 0])
    alone = 0.1 / np.linalg.norm(J[:, 0])
    assert np.isclose(ellipse[:, 0].max(), std, rtol=1e-3)
    assert np.allclose(bar, [[-alone, 0], [alone, 0]], rtol=1e-6)
    assert said.endswith(f"α has ± {std:.2f} px, and ± {alone:.2f} px at a known distance.")
    (start, longer), (then, farther) = arrows
    outs = np.transpose([longer, farther]).ravel() * [1, 1, -1, -1]
    assert np.allclose(in_picture, np.column_stack([outs, 0 * outs]), rtol=1e-9)
    assert np.allclose([*start, *(then - longer)], 0)
    assert np.allclose(longer, 1.2 * J[:, 0], rtol=1e-5)
    assert np.allclose(farther, -0.4 * J[:, 1], rtol=1e-5)
    right, left = outwards(1.2, -0.4) - outwards(0, 0)
    assert np.allclose(numbers(said)[2:4], [right, left], atol=0.012)  # no line, but nearly


def test_a_board_that_faces_the_camera_leaves_the_bowl_a_valley_and_no_throw_in_it():
    drawing, tilted = MODELS["bowl"].drawing(far=300), MODELS["bowl"].drawing(far=400)
    said = "α has no ±: a camera longer by 1 px, 0.375 mm farther, sees the same."
    assert drawing.sentence.endswith(said)
    assert np.isclose(801 / (300 + 0.375), 800 / 300, rtol=1e-5)
    dots = np.array([230, 158, 102])  # orange, paler

    def seen(picture):
        return int((np.abs(picture[TITLE:, -330:].astype(int) - dots).max(axis=-1) < 12).sum())

    assert seen(drawing.picture) < 5 < 500 < seen(tilted.picture)


def test_the_sum_of_squares_is_least_where_the_votes_cross_and_twice_on_the_first_ellipse():
    photo = course.photo(6).astype(float)
    g_v, g_u = np.gradient(photo)
    window = window_at(np.stack([g_u, g_v], axis=-1), (352, 213))

    def total(m):
        return sum(
            (g_u[v, u] * (u - m[0]) + g_v[v, u] * (v - m[1])) ** 2
            for u in range(349, 356)
            for v in range(210, 217)
        )

    lowest = minimize(total, [352, 213], tol=1e-12)
    assert np.allclose(window.crossing, lowest.x, atol=1e-4)
    said = MODELS["votes"].drawing(m_u=-1, m_v=2).sentence
    times = total([351, 215]) / lowest.fun
    assert f"at m the sum of squares is {times:.1f} times as large as there" in said
    drawing = MODELS["votes"].drawing(m_u=3, m_v=3)
    middle = np.array([MARGIN + 424 + 6, TITLE]) + 424 * (window.crossing - [348.5, 209.5]) / 7
    for a in np.arange(0.2, 6.2, 0.6):
        way = np.array([np.cos(a), np.sin(a)])
        far = brentq(lambda k, way=way: total(window.crossing + k * way) - 2 * lowest.fun, 0, 5)
        u, v = np.rint(middle + 424 / 7 * far * way).astype(int)
        near = drawing.picture[v - 9 : v + 10, u - 9 : u + 10]  # dashes of 3 px, and gaps
        assert count(near, IDEAL, 90) > 3, a


def test_a_stroke_is_the_thicker_the_more_its_square_counts(monkeypatch):
    drawn, line = [], Panel.line

    def noted(panel, xy, colour, width=1.5, dash=0, rim=0):
        if colour == WORLD:
            drawn.append((np.linalg.norm(np.subtract(*xy)), width))
        line(panel, xy, colour, width, dash, rim)

    monkeypatch.setattr(Panel, "line", noted)
    MODELS["votes"].drawing(m_u=-2, m_v=1)
    window = window_at(slopes(), (352, 213))
    steep = np.linalg.norm(window.g, axis=1)
    missed = np.abs(np.sum(window.g * (window.p - [350, 214]), axis=1)) / steep
    strong = steep > 33
    far, width = np.transpose(drawn)
    assert far == pytest.approx(missed[strong])
    assert (np.diff(width[np.argsort(steep[strong])]) >= 0).all()
    assert width.max() > 2 * width.min()


@pytest.mark.parametrize("place", ["edge", "corner"])
def test_a_pushed_window_changes_as_its_gradients_say_and_its_sums_end_at_the_eigenvalues(place):
    photo, (u, v) = course.photo(6).astype(float), push._PLACES[place]
    rows, columns = np.mgrid[v - 3 : v + 4, u - 3 : u + 4]
    for angle, (du, dv) in ((0, (1, 0)), (90, (0, 1)), (180, (-1, 0)), (45, (1, 1))):
        far = np.hypot(du, dv)  # a pixel there and one back: half of the difference
        there, back = (photo[rows + k * dv, columns + k * du] for k in (1, -1))
        off = push.changes_at(place)[:, angle] - (there - back).ravel() / 2 / far
        assert np.abs(off).max() < (1e-9 if far == 1 else 26)
        assert np.std(off) < 0.15 * np.std(there - back)
    told = numbers(MODELS["push"].drawing(place=1 + (place == "corner"), angle=180).sentence)
    eigenvalues = window_at(slopes(), (u, v)).eigenvalues
    assert np.allclose(told[-2:], eigenvalues[::-1], rtol=1e-3, atol=4)


def test_the_squares_of_the_changes_have_the_area_that_is_their_sum():
    for angle in (0, 40, 85, 180):
        squares = MODELS["push"].picture(angle=angle)[TITLE : TITLE + 275, 281 + MARGIN :][:, :275]
        change = push.changes_at("edge")[:, angle]
        for ink, shown in (("#FFFFFF", change > 0), ("#000000", change < 0)):
            wanted = np.sum(change[shown] ** 2) / 84**2 * (275 / 7) ** 2
            assert abs(count(squares, ink) - wanted) < 0.15 * wanted + 60, (angle, ink)


def test_of_the_pushed_window_only_the_way_that_d_went_is_traced():
    size = [count(MODELS["push"].picture(angle=a)[:, 2 * 281 :], MUTED, 25) for a in (0, 40, 180)]
    assert size[0] < size[1] - 100 < size[2] - 400


def test_the_square_on_what_is_left_is_smallest_where_least_squares_say():
    m = np.arange(2, 4.21, 0.05).round(2)
    told = np.array([numbers(MODELS["wishes"].drawing(m=each).sentence)[-1] for each in m])
    assert np.allclose(told, (6 - 2 * m) ** 2 + (4 - m) ** 2, atol=0.006)
    assert m[told.argmin()] == 3.2
    tint = mixed("#FFFFFF", ESTIMATED, 0.25)
    unit = 399 / 9.5, 336 / 8
    for each, area in zip(m, told, strict=True):
        seen = count(MODELS["wishes"].picture(m=each)[:, 342:], tint, 12)
        assert 0.7 * area < seen / np.prod(unit) < 1.02 * area, each


def test_the_smallest_square_has_its_number_beside_it(written):
    for m, area in ((3.2, "0.80"), (2.4, "4.00"), (4.2, "5.80")):
        drawing = MODELS["wishes"].drawing(m=m)
        _, at = written[area]
        foot, b = np.array([2 * m, m]), np.array([6, 4])
        side = b - foot
        along = np.array([side, [-side[1], side[0]]]) @ (at - foot) / (side @ side)
        assert ((along > 0) & (along < 1)).all() == (m != 3.2), m
        assert drawing.sentence


def test_a_class_goes_through_infinity_and_its_dot_once_round_the_ring():
    ring = MODELS["ring"]
    for angle in (-60, 0, 45, 89, 91, 180, 250):
        drawing = ring.drawing(angle=angle)
        assert np.isclose(numbers(drawing.sentence)[2], np.tan(np.radians(angle)), rtol=1e-3)
        dot = next(grip for grip in drawing.grips if grip.name == "dot")
        (a, b), x = dot.at, np.tan(np.radians(angle))
        assert np.isclose(a**2 + (b - 0.5) ** 2, 0.25, rtol=1e-4)  # on the ring,
        assert np.isclose(a, x * (1 - b), atol=1e-4)  # and seen from its top over its number
    assert "point at infinity" in ring.drawing(angle=90).sentence
    assert ring.dragged("dot", (-0.05, 0.99), angle=89)["angle"] > 90
    assert ring.dragged("line", (-1, 1), angle=89)["angle"] == 135
    assert ring.dragged("line", (-1, 1), angle=-20)["angle"] == -45


def test_the_join_on_the_ring_is_dashed_green_and_no_angle_but_that_of_the_line_is_written(written):
    picture = MODELS["ring"].drawing(angle=45).picture
    assert [words for words in written if words.endswith("°")] == ["45°"]
    panel, _ = written["∞"]
    part = np.linspace(0.1, 0.4, 200)[:, None]  # from the top of the ring towards its mark
    places = (1 - part) * [0, 1] + part * [1, 0]
    off = (places - [panel.x[0], panel.y[0]]) * [1, -1] / panel.pixel
    u, v = np.rint(off + [picture.shape[1] - MARGIN - 500, TITLE]).astype(int).T
    green = np.abs(picture[v, u].astype(int) - colour(WORLD)).max(axis=-1) < 60
    assert 0.3 < green.mean() < 0.8  # dashes, and gaps
    assert count(picture[v.min() : v.max(), u.min() : u.max()], IDEAL) == 0


def test_the_marks_of_the_ring_carry_their_numbers_outside_of_it(written):
    MODELS["ring"].drawing(angle=30)
    for number in (1, 2, 4, 8, -1, -2, -4, -8):
        panel, at = written[f"{number}"]
        off = at - [0, 0.5]
        assert np.hypot(*off) > 0.5 + 6 * panel.pixel  # the words' middle, beyond the rim
        mark = np.array([number, number**2]) / (number**2 + 1) - [0, 0.5]
        assert np.allclose(off / np.hypot(*off), mark / np.hypot(*mark))


def test_two_lines_meet_where_their_equations_say_and_parallels_at_infinity():
    rng, model = np.random.default_rng(4), MODELS["meet"]
    for a1, b1, a2, b2 in rng.integers(-10, 11, (40, 4)).tolist():
        values = {"a1": a1 / 10, "b1": b1 / 10, "a2": a2 / 10, "b2": b2 / 10}
        drawing = model.drawing(**values)
        said = drawing.sentence.rpartition("m = ")[2]
        assert drawing.sentence.startswith(
            "Both lines are v = " if said.startswith("[0 0 0]") else "v = "
        )
        turn = (b2 - a2) - (b1 - a1)  # by which one line climbs more, over all of the square
        if turn == 0:
            word = "no point" if a1 == a2 else f"direction ±(1, {(b1 - a1) / 20:g})"
            assert word.replace("-", "−") in said
            continue
        # From the gap of the lines at the left edge, by similar triangles.
        x = 2 * (a1 - a2) / turn - 1
        y = (a1 + (b1 - a1) * (x + 1) / 2) / 10
        assert numbers(said)[-2:] == pytest.approx([x, y], rel=6e-3, abs=1e-9)
        place = meet.on_sheet(np.array([x, y, 1]))
        (left, right), (top, _) = meet._SHOWN
        u, v = (place - [left, top]) * [1, -1] * meet._SPACE[0] / (right - left)
        if 12 < u < meet._SPACE[0] - 12 and 12 < v < meet._SPACE[1] - 12:
            u, v = round(u) + MARGIN, round(v) + TITLE
            assert count(drawing.picture[v - 4 : v + 5, u - 4 : u + 5], WORLD) > 20


def test_the_ray_of_two_parallels_is_level_and_both_arrows_are_perpendicular_to_every_ray():
    model = MODELS["meet"]
    level = model.drawing(a2=-0.5, b2=-0.5).picture
    for x in (-1.2, -0.5, 0.5, 1.2):  # along the ray [1 0 0], on both sides of the origin
        place = meet.on_sheet(np.array([x, 0, 0])) - [meet._SHOWN[0][0], meet._SHOWN[1][0]]
        u, v = np.rint(place / [0.0065385, -0.0065385] + [MARGIN, TITLE]).astype(int)
        assert count(level[v - 2 : v + 3, u - 2 : u + 3], IDEAL, 90) > 3
    for values in ({}, {"b2": -1}, {"a1": -0.4, "b1": 0.7}):
        given = model.values(**values)
        for n in "12":
            ends = [[-1, given[f"a{n}"], 1], [1, given[f"b{n}"], 1]]
            assert np.allclose(np.array(ends) @ meet.triple(given, n), 0, atol=1e-12)


@pytest.mark.parametrize("row", [[1, 0, 0], [0, 3, 0], [1, -1, 0.3], [-2, 1, 1]])
def test_the_arrows_of_all_lines_are_as_long_where_they_are_seen(row):
    arrow = meet.arrow_along(np.array(row, float))
    assert np.allclose(np.cross(arrow, row), 0)
    assert arrow @ row > 0
    assert np.linalg.norm(meet.on_sheet(arrow)) == pytest.approx(0.62)


@pytest.mark.parametrize("b", [0.5, 0.2, -0.4])
def test_the_arrow_of_a_line_leads_to_its_triple_and_stands_upright_on_its_rays(b):
    given = {"a1": -0.3, "b1": b, "a2": 1, "b2": 1}
    normal = np.cross([-1, -0.3, 1], [1, b, 1]) / 2  # of two points of the line
    assert np.allclose(meet.triple(MODELS["meet"].values(**given), "1"), normal, atol=1e-12)
    tip = meet.on_sheet(0.97 * meet.arrow_along(normal))
    (left, right), (top, bottom) = meet._SHOWN
    u, v = (tip - [left, top]) / [right - left, bottom - top] * meet._SPACE + [MARGIN, TITLE]
    picture = MODELS["meet"].picture(**given)
    assert count(picture[round(v) - 3 : round(v) + 4, round(u) - 3 : round(u) + 4], ESTIMATED) > 4


def test_a_line_of_sight_climbs_with_its_point_and_ends_parallel_to_the_rails():
    model, camera = MODELS["rail"], course.camera().A
    x, y = 0.75, 1.6  # m: the right rail from the camera
    for part, away in ((0.375, 12), (0.5, 20), (0.8, 80)):
        u, v, w = camera @ [x, y, away]
        angle = np.degrees(np.arcsin(np.hypot(x, y) / np.hypot(np.hypot(x, y), away)))
        said = numbers(model.drawing(part=part).sentence)
        assert said == pytest.approx([away, angle, u / w, v / w], rel=0.03)
    end = model.drawing(part=1)
    assert numbers(end.sentence) == [325, 238]
    assert "parallel" in end.sentence
    # From the side, too, the end is the image of the rails' direction, and each place its own.
    eye = look_at([3.6, -1.7, -4.6], [0.7, 0.4, 4])
    for part, place in ((1, eye[:3, 2]), (0.5, eye[:3] @ [x, y, 20, 1])):
        seen = 740 * place[:2] / place[2] + [284.5, 199.5]
        grip = grip_of(model.drawing(part=part), "rail")
        assert grip.at == pytest.approx(seen, abs=0.1)
        u, v = np.rint(grip.place).astype(int)
        square = model.picture(part=part)[v - 4 : v + 5, u - 4 : u + 5]
        assert count(square, WORLD) > 40
        assert model.dragged("rail", tuple(seen), part=0.3)["part"] == pytest.approx(part)
    assert model.dragged("rail", (589, 0))["part"] == 1
    beside = [model.picture(part=part)[:, 600:] for part in (0.375, 1)]
    assert count(beside[0], LENS) > count(beside[1], LENS) + 100  # 100 px of gap, and none


def test_the_ruler_reads_what_the_camera_photographed_and_errs_as_far_as_a_click():
    P = Camera(course.camera().A).P
    for t in (10, 25, 50, 75, 200):  # m behind the first pole
        _, v, w = P @ [-4000, 1950, 15000 + 1000 * t, 1]
        assert np.isclose(behind_the_first(v / w), t, rtol=1e-9)
    row = Camera(course.camera().A).project([-4, 1.95, 15 + 75])[1]
    clicked = row + np.random.default_rng(3).normal(0, 0.3, 4000)
    said = numbers(MODELS["ruler"].drawing(row=round(float(row), 1)).sentence)
    assert abs(said[2] - behind_the_first(clicked).std()) < 0.08


def test_the_bar_over_the_plan_is_four_times_as_long_as_a_click_errs():
    c = 258

    def t(v):  # m behind the first pole, by the true camera
        return 804 * 1.95 / (v - 238) - 15

    near, far = t(c + 0.3), t(c - 0.3)
    assert abs(t(c) - 63.4) < 0.1
    plan = MODELS["ruler"].picture(row=c)[TITLE : TITLE + 330, 440 + 3 * MARGIN :]
    column = plan[:, round((-4 - 0.26 + 8.5) / 11.2 * 310)]
    pale = np.abs(column.astype(int) - [238, 190, 153]).max(axis=-1) < 12
    assert (np.ptp(np.flatnonzero(pale)) + 1) / 330 * 124 == pytest.approx(
        4 * (far - near), abs=0.8
    )


@pytest.mark.parametrize(("part", "turn"), [(0.375, 0), (0.5, -12), (0.7, 9), (0.8, 0)])
def test_the_yellow_cell_is_where_the_camera_sees_it_and_as_far_as_the_map_says(part, turn):
    drawing = MODELS["horizon"].drawing(part=part, turn=turn)
    away = 20 * part / (1 - part)
    x, z = away * np.sin(np.radians(turn)), away * np.cos(np.radians(turn))
    near, far = ([[x - 2, 1.95, at], [x + 2, 1.95, at]] for at in (z, z + 4))
    corners = Camera(course.camera().A).project([*near, *far])
    yellow = np.abs(drawing.picture.astype(int) - colour("#F0E442")).max(axis=-1) < 60
    rows, columns = np.nonzero(yellow[:, 330 + 2 * MARGIN :])
    seen = np.array([columns - MARGIN, rows - TITLE]).T * 640 / 440
    # Within its black outline, whose acute corners are long.
    assert (np.abs(seen.min(axis=0) - corners.min(axis=0)) < [11, 4]).all()
    assert (np.abs(seen.max(axis=0) - corners.max(axis=0)) < [11, 4]).all()
    said = numbers(drawing.sentence)
    *place, w = said[2:6]  # the quadruple, whose third number is 1
    assert [*said[:2], said[4], said[6]] == [round(z), round(away), 1, 4]
    assert np.array([*place, w]) / w == pytest.approx([x, 1.95, z, 1], rel=0.06, abs=1e-9)
    assert said[-1] == pytest.approx(corners[0, 1] - corners[2, 1], rel=0.06)


@pytest.mark.parametrize(("part", "places"), [(0.5, 1), (1, 2)])
def test_the_small_disc_shows_both_ends_of_a_direction_only_at_the_rim(part, places, monkeypatch):
    drawn = []
    for name, middle in (("polygons", lambda at: np.mean(at[0], axis=0)), ("mark", np.asarray)):
        draw = getattr(Panel, name)

        def note(self, at, *how, draw=draw, middle=middle):
            drawn.extend(np.atleast_2d(middle(at)))
            draw(self, at, *how)

        monkeypatch.setattr(Panel, name, note)
    MODELS["horizon"].drawing(part=part, turn=12)
    way = 0.16 * part * np.array([np.sin(np.radians(12)), np.cos(np.radians(12))])
    ends = [[-0.38, 0.19] + way, [-0.38, 0.19] - way]
    assert sum(any(np.allclose(at, end, atol=2e-3) for at in drawn) for end in ends) == places


def test_a_cell_that_is_pulled_to_the_rim_or_into_the_sky_is_a_direction_of_the_horizon():
    model, camera = MODELS["horizon"], Camera(course.camera().A)
    for turn in (-15, 0, 21):
        way = np.array([np.sin(np.radians(turn)), 0, np.cos(np.radians(turn))])
        u, v = camera.vanishing_point(way)
        for grip, at in (("map", 1.2 * way[[0, 2]]), ("picture", (u, v - 40))):
            pulled = model.dragged(grip, tuple(at))
            assert pulled == {"part": 1, "turn": turn}
        drawing = model.drawing(**pulled)
        assert "is at infinity" in drawing.sentence
        told = numbers(drawing.sentence)
        assert np.allclose(told, [way[0] / way[2], 0, 1, 0, u, v], atol=0.05)
        on_map, in_picture = (grip_of(drawing, name) for name in ("map", "picture"))
        assert np.allclose(on_map.at, way[[0, 2]], atol=1e-5)
        assert np.allclose(in_picture.at, [u, v], atol=1e-3)
    near = camera.project([3, 1.95, 20])
    pulled = model.dragged("picture", tuple(near))
    away = np.hypot(3, 20)
    assert pulled["part"] == pytest.approx(away / (away + 20), abs=0.003)
    assert pulled["turn"] == round(np.degrees(np.arctan2(3, 20)))


def test_lines_along_the_rails_meet_at_the_rim_of_the_map():
    far = horizon.pressed([[x, 1e7] for x in (-6, -0.75, 2, 40)])
    assert np.allclose(far, [0, 1], atol=1e-4)
    assert np.allclose(horizon.pressed([[12, 16], [0, 20], [-15, 0]]),
                       [[0.3, 0.4], [0, 0.5], [-3 / 7, 0]], atol=1e-12)  # fmt: skip


def eye_of(tilt, roll):
    """Return A and R of a camera so tilted and rolled, in degrees."""
    A = np.array([[800, 0, 325], [0, 800, 238], [0, 0, 1]])
    turns = [0, 0, np.radians(roll)], [np.radians(tilt), 0, 0], [0, 0.05, 0]
    return A, np.linalg.multi_dot([rotation_from_angles(*turn) for turn in turns])


@pytest.mark.parametrize("height", [0.5, 1.95, 4, 6, 8])
def test_the_horizon_stays_and_cuts_the_poles_as_high_as_the_eye(height):
    drawing = MODELS["eye"].drawing(height=height)
    A, R = eye_of(3.4, 7.8)
    a, b, c = np.linalg.inv(A).T @ R[:, 1]

    def around(x, y, z, reach=2):
        """Return the drawn pixels around what is y m over the grass."""
        u, v, w = A @ R @ [x, height - y, z]
        u, v = (np.array([u, v]) / w + 0.5) * WIDTH / 640 + [MARGIN, TITLE]
        return drawing.picture[round(v) - reach : round(v) + reach + 1, round(u) - 3 : round(u) + 4]

    for u in (400, 600):  # the line is where the formula has it, whatever the height
        at = (np.array([u, -(a * u + c) / b]) + 0.5) * WIDTH / 640 + [MARGIN, TITLE]
        row, column = np.rint(at[::-1]).astype(int)
        # Black is one row of three, or half of two; below and above it is bright.
        assert drawing.picture[row - 1 : row + 2, column].max(axis=-1).mean() < 170
    for z in (15, 40):
        # Where it begins there are no marks: where they will be is asked.
        assert (count(around(-4, height, z), WORLD) > 15) == (height <= 6 and height != 1.95)
        if 2 <= height < 6 and z == 40:
            assert count(around(-4, 5.7, z), "#5C4A3D") > 3  # the pole reaches to its 6 m
            assert count(around(-4, 6.3, z, 1), "#5C4A3D") == 0
    said = f": the horizon cuts every pole {height:.2f} m above its foot"
    if height > 6:
        said = ": the horizon passes over all poles"
    if height == 1.95:  # where it begins; the page asks what happens
        said = ". The poles are 6 m high."
    assert f"{height:.2f} m above the grass{said}" in drawing.sentence


@pytest.mark.parametrize("height", [0.5, 2, 6, 8])
def test_the_grass_reaches_up_to_the_horizon_however_high_the_eye(height):
    picture = MODELS["eye"].drawing(height=height).picture.astype(int)
    A, R = eye_of(3.4, 7.8)
    a, b, c = np.linalg.inv(A).T @ R[:, 1]
    for u in (20, 60, 540, 630):
        column, row = (np.array([u, -(a * u + c) / b]) + 0.5) * WIDTH / 640 + [MARGIN, TITLE]
        _, green, blue = picture[TITLE:, round(column)].T
        assert abs(TITLE + np.argmax(green > blue + 20) - row) < 2


def test_a_rod_is_as_high_in_the_picture_as_one_that_is_photographed():
    street = Camera(course.camera().A, look_at([12500, -1200, -2500], [1200, -2300, 12500]))
    for x, z in ((0, 9000), (5000, 12000), (-9000, 20000)):
        feet = street.project([[x, 1600, z], [x, 1600 - 1000, z], [x, 1600 - 6500, z]])
        assert np.allclose(at_height(feet[0], [0, 1, 6.5]), feet, atol=1e-6)
    drawing = MODELS["rod"].drawing(u=140, v=448, height=4)
    top = next(grip for grip in drawing.grips if grip.name == "top")
    assert np.allclose(top.at, at_height(np.array([140, 448]), 4), atol=1e-3)
    horizon = street.vanishing_point([1, 0, 0])[1]  # crossed at the height of the camera, 2.8 m
    assert abs(at_height(np.array([140, 448]), 2.8)[1] - horizon) < 1e-6


def test_the_band_that_the_horizon_crosses_has_a_mark_for_each_tenth_of_a_metre(lines):
    MODELS["rod"].drawing(u=140, v=448, height=4)
    marks = [
        xy for _, xy, ink, _ in lines if ink == IDEAL and len(xy) == 2 and np.ptp(xy[:, 0]) < 30
    ]
    rows = at_height(np.array([140, 448]), np.arange(2.1, 2.95, 0.1))[:, 1]
    assert np.allclose([xy[0, 1] for xy in marks], rows, atol=1e-6)
    assert int(np.argmax([np.ptp(xy[:, 0]) for xy in marks])) == 4  # the half metre is the longest


@pytest.mark.parametrize(("u", "v"), [(190, 388), (250, 400), (600, 360), (140, 448)])
def test_the_rod_gets_its_two_metres_from_the_box_by_a_vanishing_point(u, v):
    street = Camera(course.camera().A, look_at([12500, -1200, -2500], [1200, -2300, 12500]))
    box_foot, box_top = blocks().vertices[[19, 17]]
    ray = street.R.T @ np.linalg.solve(street.A, [u, v, 1])
    foot = street.centre + ray * (box_foot[1] - street.centre[1]) / ray[1]
    e = street.vanishing_point(foot - box_foot)
    drawing = MODELS["rod"].drawing(u=u, v=v)
    assert np.allclose(numbers(drawing.sentence)[-2:], e.round(), atol=1)
    q = at_height(np.array([u, v]), 2)
    assert abs(np.linalg.det(to_homogeneous([e, q, street.project(box_top)]))) < 1e-5 * abs(e[0])
    if -440 < e[0] < 639:  # where the lines meet, and between the rod and the box, they are drawn
        photo = drawing.picture[22:322, 3:813].astype(int)
        for at in (e, (street.project(box_foot) + [u, v]) / 2, (street.project(box_top) + q) / 2):
            i, j = ((at - [-440.5, 79.5]) * 0.75).astype(int)[::-1]
            near = photo[i - 1 : i + 2, j - 1 : j + 2].reshape(-1, 3)
            assert (np.abs(near - [213, 94, 0]).max(axis=1) < 100).any()


def test_a_tower_stands_where_the_photographed_board_has_its_squares():
    tower, photo = MODELS["cube"], np.asarray(cube.photo()).mean(axis=2)
    for x, y, lens in ((0, 0, 1), (200, 125, 1), (100, 50, 0)):
        drawing = tower.drawing(x=x, y=y, lens=lens, height=150)
        grips = {grip.name: np.array(grip.at) for grip in drawing.grips}
        corner = refine_subpixel(photo, grips["foot"].round()[None] + 1)[0]
        assert np.linalg.norm(grips["foot"] - corner) < (0.1 if lens else 1)  # of the pixels
        moved = tower.dragged("foot", tuple(grips["foot"]), x=99, y=99, lens=lens)
        assert (moved["x"], moved["y"]) == (x, y)
    *_, off = numbers(drawing.sentence)
    assert 3 < off < 8


def test_a_wrong_camera_draws_the_tower_where_its_own_lines_of_sight_meet_its_picture():
    tower, right = MODELS["cube"], cube.found(lens=True)
    for away, alpha in ((0, 1150), (-120, 1150), (40, 700), (-200, 1700)):
        values = tower.values(away=away, alpha=alpha)
        camera, drawing = cube.believed(values), tower.drawing(**values)
        assert np.allclose(camera.centre, right.centre - away * right.R[2], atol=1e-9)
        ends = np.array([[50.0, 25, 0], [50, 25, -100]])
        bare = Camera(camera.A, camera.G, size=camera.size).project(ends)
        back, far = inverse(camera.G), 130 * alpha / 1150
        pane = move(back, far * to_homogeneous(xy_from_px(camera.A, bare)))
        for one, two, place in zip(ends, pane, camera.project(ends), strict=True):
            assert np.linalg.norm(np.cross(one - camera.centre, two - camera.centre)) < 1e-6
            place = np.clip(place, -0.5, [1279.5, 959.5])  # a grip is held at the border
            assert any(np.allclose(grip.at, place, atol=0.01) for grip in drawing.grips[:2])
        marks = [cube._BESIDE.project(at) for at in (camera.centre, *pane)]
        seen = drawing.picture[TITLE:, MARGIN + 540 + 6 :].astype(int)
        for (u, v), ink in zip(marks, (CAMERA, ESTIMATED, ESTIMATED), strict=True):
            j, i = round(u / 2) - 80, round(v / 2)  # 160 of its pixels are cut off on the left
            near = seen[i - 2 : i + 3, j - 2 : j + 3].reshape(-1, 3)
            assert (np.abs(near - colour(ink)).max(axis=1) < 60).any(), (away, alpha, ink)
    assert "corners is where it belongs, to 0.0" in tower.drawing().sentence
    off = [numbers(tower.drawing(away=away).sentence)[-1] for away in (0, -50, -100, -200, 60)]
    assert off[0] < 0.05
    assert 20 < off[1] < off[2] < off[3]
    assert off[4] > 20
    assert numbers(tower.drawing(away=-100, alpha=920).sentence)[-1] > 10


def test_the_net_of_the_six_numbers_lies_where_another_library_sees_it():
    cv2 = pytest.importorskip("cv2")
    from cvnotes.show.explorations import six

    for values in ({}, {"alpha_u": 500, "alpha_v": 520, "u0": 300, "v0": 270, "k1": -0.1}):
        values = MODELS["six"].values(**values)
        _, camera = six.cameras(values)
        places = np.array([[-0.4, -0.2, 1]])
        lens = np.array([values["k1"], 0.1, 0, 0, 0])
        (crossing,) = cv2.projectPoints(places, np.zeros(3), np.zeros(3), camera.A, lens)[0][0]
        drawing = MODELS["six"].drawing(**values)
        at = {grip.name: np.array(grip.at) for grip in drawing.grips}
        assert np.allclose(at["net"], crossing, atol=0.01)
        assert np.allclose(at["cross"], [values["u0"], values["v0"]])
        size = np.array([values["alpha_u"], -values["alpha_v"]]) / 5
        assert np.allclose(at["square"] - at["cross"], size, atol=0.01)
        picture = drawing.picture[TITLE : TITLE + 480, MARGIN : MARGIN + 640].astype(int)
        whole = Camera(camera.A, lens=camera.lens, size=(640, 480))
        on_net = whole.project([[-0.2, 0.1, 1], [0.1, 0.2, 1], [-0.3, -0.2, 1]]).round().astype(int)
        for u, v in on_net:
            near = picture[v - 1 : v + 2, u - 1 : u + 2].reshape(-1, 3)
            assert (np.abs(near - colour(LENS)).max(axis=1) < 70).any()
        room_there = render_scene(room(), whole, samples=1).astype(int)
        light = 255 - 0.55 * (255.0 - room_there)
        assert np.median(np.abs(light - picture)) < 4


@pytest.mark.parametrize(("t", "mu"), [(200, 0), (600, 0), (-150, 0), (600, 0.65), (-100, 3)])
def test_the_parabola_touches_the_cost_and_its_lowest_point_is_the_next_step(t, mu, monkeypatch):
    drawn, draw = [], Panel.line
    monkeypatch.setattr(
        Panel, "line", lambda *how, **so: (drawn.append(np.array(how[1])), draw(*how, **so))
    )
    drawing = MODELS["parabola"].drawing(t=t, mu=mu)
    Y = np.array([450, 600, 900, 1500, 3000, 6000])
    noise = np.random.default_rng(6).normal(size=(42, 2))[3::7, 1]

    def misses(t):
        return 804 * 300 / (Y + t) - 804 * 300 / Y - noise

    def cost(t):
        return np.sum(misses(t) ** 2)

    ground, *undamped, parabola = (line for line in drawn if len(line) in (600, 400))
    shown = ground[ground[:, 1] < 2.1e5]
    assert np.allclose(shown[:, 1], [cost(x) for x in shown[:, 0]])
    a, b, c = np.polyfit(*parabola.T, 2)
    assert np.allclose(np.polyval([a, b, c], parabola[:, 0]), parabola[:, 1], rtol=1e-6)
    assert np.polyval([a, b, c], t) == pytest.approx(cost(t), rel=1e-6)
    assert 2 * a * t + b == pytest.approx((cost(t + 0.01) - cost(t - 0.01)) / 0.02, rel=1e-4)
    slope = (misses(t + 0.01) - misses(t - 0.01)) / 0.02
    assert a == pytest.approx((1 + mu) * slope @ slope, rel=1e-4)
    for other in undamped:
        narrower = mu * (slope @ slope) * (other[:, 0] - t) ** 2
        assert np.allclose(parabola[:, 1] - other[:, 1], narrower, rtol=1e-4, atol=1e-3)
    assert len(undamped) == (mu > 0)
    said = numbers(drawing.sentence.replace(f" and μ = {mu:.2f}", ""))
    assert said[:2] == [t, round(-b / 2 / a)]
    assert ("behind the camera" in drawing.sentence) == (-b / 2 / a < -450)
    if t < 300 or mu:
        assert said[2:4] == pytest.approx(
            [np.sqrt(cost(x) / 6) for x in (t, -b / 2 / a)], abs=0.05001
        )
    assert np.allclose(grip_of(drawing, "t").at, [t, cost(t)])


def test_the_tower_and_its_shadow_lie_where_the_renderer_puts_them(monkeypatch):
    """The same desk with the tower's boxes on it, ray by ray."""
    for paint in ("_BRICK", "_STONE", "_FRAME", "_PANES"):  # like nothing that lies on the desk
        monkeypatch.setattr(cube, paint, np.array([40.0, 200, 255]))
    monkeypatch.setattr(cube, "_outline", lambda _: [])
    camera, on_desk = cube._CAMERA.resized((540, 405)), desk(course.board())
    sides = cube.tower(np.array([75, 50]), 75).transpose(0, 2, 1).tolist()
    tower = join(*(box(*ends, (0.16, 0.78, 1.0)) for ends in sides))
    even = replace(on_desk.around, occlusion=0)
    scenes = on_desk, *(replace(scene, around=even) for scene in (on_desk, join(on_desk, tower)))
    bare, empty, full = (render_scene(scene, camera, samples=4).astype(int) for scene in scenes)
    panel = slice(TITLE, TITLE + 405), slice(MARGIN, MARGIN + 540)
    drawn = MODELS["cube"].picture(x=75, y=50, height=75)[panel].astype(int)
    true, ours = (np.abs(one - two).sum(-1) > 60 for one, two in ((full, empty), (drawn, bare)))
    around = list(itertools.product((-1, 0, 1), repeat=2))
    true, ours = (  # without the edges of squares, where two sizes of pixels differ
        np.logical_and.reduce([np.roll(part, by, (0, 1)) for by in around]) for part in (true, ours)
    )
    ours[:5], ours[-5:], ours[:, :5], ours[:, -5:] = 0, 0, 0, 0  # the frame
    assert true.sum() > 5000
    assert (true & ours).sum() > 0.95 * (true | ours).sum()  # the rest: the shadow's soft edge


def test_four_right_pairs_far_apart_find_all_the_others_and_one_wrong_one_hardly_any():
    true = Camera(course.camera().A, course.poses()[6]).project(course.board().points)
    pairs, fours, put, said = drawn_pairs(16)
    right = np.linalg.norm(pairs - true, axis=1) < 3
    assert right.sum() == 38
    assert np.array_equal(said, right)
    assert [np.isnan(put[59]).all(), np.isnan(put[44]).any()] == [True, False]
    for draw in (44, 55):
        assert np.array_equal(np.linalg.norm(put[draw] - pairs, axis=1) < 1.5, right)
    sound = [all(np.linalg.norm(true - m, axis=1).min() < 1.5 for m in four) for four in fours]
    for draw in np.flatnonzero(np.logical_not(sound[1:])) + 1:
        agree = numbers(MODELS["ransac"].drawing(draw=draw).sentence)[1]
        assert agree <= 6
    assert "0 agree" in MODELS["ransac"].drawing(draw=0).sentence
    setting = next(one for one in MODELS["ransac"].settings if one.name == "wrong")
    for wrong in np.arange(setting.low, setting.high + 1, setting.step).astype(int):
        changed = np.linalg.norm(drawn_pairs(int(wrong))[0] - true, axis=1) > 3
        assert changed.sum() == wrong  # one pair alone has none to change places with
    assert numbers(MODELS["ransac"].drawing(draw=0, wrong=0).sentence)[2] == 54


def test_wrong_pairs_that_agree_with_each_other_win_against_the_right_ones():
    true = Camera(course.camera().A, course.poses()[6]).project(course.board().points)
    pairs, _, put, _ = drawn_pairs(40)
    agree = np.linalg.norm(put[20] - pairs, axis=1) < 1.5
    assert agree.sum() == 27
    assert np.linalg.norm(pairs - true, axis=1)[agree].min() > 10  # not one of them is right
    net, shifted = put[20].reshape(6, 9, 2)[:, 1:], true.reshape(6, 9, 2)[:, :-1]
    assert np.abs(net - shifted).max() < 2  # the board, one square aside
    said = numbers(MODELS["ransac"].drawing(draw=20, wrong=40).sentence)
    assert said == [20, 27, 54, 20, 27, 0, 54, 14]


def test_two_lenses_take_the_same_picture_of_a_board_that_faces_them_and_no_other():
    said = [numbers(MODELS["tilt"].drawing(tilt=tilt).sentence)[3] for tilt in (0, 10, 20, 30, 45)]
    assert said == [0.0, 0.6, 2.2, 3.9, 6.0]


@pytest.mark.parametrize("tilt", [10, 45])
def test_the_valley_of_a_tilt_is_as_deep_as_opencv_finds_it_and_closes_on_the_first_lens(
    tilt, written
):
    import cv2

    board, R = course.board(), rotation_from_vector([np.radians(tilt), 0, 0])
    W = board.points.astype(np.float64)
    first = Camera(intrinsics(800, 800, 319.5, 239.5), size=(640, 480))
    away = 2.1625 * np.hypot(*W[-1, :2])
    m = first.moved(pose(R, [0, 0, away] - R @ W.mean(axis=0))).project(W)
    said = {}
    for alpha in (300, 550, 800, 1000):
        A = intrinsics(alpha, alpha, 319.5, 239.5)
        _, omega, T = cv2.solvePnP(W, m, A, None)
        omega, T = cv2.solvePnPRefineLM(W, m, A, None, omega, T)
        off = cv2.projectPoints(W, omega, T, A, None)[0].reshape(-1, 2) - m
        said[alpha] = np.sqrt((off**2).sum(axis=1).mean())
        drawing = MODELS["tilt"].drawing(tilt=tilt, alpha=alpha)
        assert numbers(drawing.sentence)[3] == pytest.approx(said[alpha], abs=0.06)
        turned = np.degrees(np.arctan2(*cv2.Rodrigues(omega)[0][2, 1:]))
        words = [name for name in written if name.startswith(f"α = {alpha} px")]
        assert any(name.endswith(f"tilted {turned:.0f}°") for name in words)
    assert said[800] < 1e-6
    # At 990 px, 0.96 of the way from 1/800 to 1/1000, the curve is as high as it should be.
    picture = MODELS["tilt"].picture(tilt=tilt, alpha=500).astype(int)
    orange = np.abs(picture - colour(ESTIMATED)).max(axis=-1) < 60
    column = np.flatnonzero(orange[TITLE + 2 : TITLE + 328, 446 + round(410 * 760 / 860)])
    assert column.mean() == pytest.approx(330 * (10 - said[1000] * 0.96) / 11.5, abs=4)


def test_the_edge_that_is_pulled_tilts_the_board_by_as_much_as_it_went_round():
    model = MODELS["tilt"]
    upright, pulled = (np.array(grip_of(model.drawing(tilt=tilt), "board").at) for tilt in (0, 45))
    assert model.dragged("board", tuple(pulled))["tilt"] == 45
    assert model.dragged("board", tuple(upright))["tilt"] == 0
    # By half a board to the left and down, as seen from where both its ends are upright.
    half = 0.64 * 640 / (2.1625 * np.hypot(200, 125)) * 125 / 2
    assert pulled - upright == pytest.approx(
        half * np.array([-np.sqrt(0.5), 1 - np.sqrt(0.5)]), abs=0.01
    )


def test_every_place_of_the_half_circle_sees_both_right_angles_and_one_those_of_two_pictures():
    W, true = course.board().points, np.array([319.5, 239.5, 400])
    one, two = (dlt(W[:, :2], camera.project(W)) for camera in photographs())
    circles = circle_of(one), circle_of(two)
    assert abs(circles[0].radius - 465.9) < 0.05
    for fold in range(20, 131, 10):
        eye = circles[0].place(fold)
        assert np.allclose(angles(one, eye), 90, rtol=1e-9)
        assert not np.allclose(angles(two, eye), 90, atol=0.05)
    for h, circle in zip((one, two), circles, strict=True):
        fold = np.degrees(np.arcsin(400 / circle.radius))
        assert np.allclose(circle.place(fold), true, rtol=1e-9)
        assert np.allclose(angles(h, true), 90, rtol=1e-9)
        assert np.allclose(_on_paper(circle, range(181)), 0.5, atol=0.49)  # not cut off


def test_the_photograph_of_the_fold_is_no_mirror_image_and_all_its_points_are_on_the_sheet():
    corner, right, below = on_sheet(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]]))
    assert np.linalg.det([right - corner, below - corner]) > 0  # y of the sheet runs downwards
    W, low_high = course.board().points, np.transpose(_SHOWN)
    points = vanishing_points(dlt(W[:, :2], photographs()[0].project(W)))
    seen = (on_sheet(np.column_stack([points, np.zeros(4)])) - low_high[0]) / np.ptp(
        low_high, axis=0
    )
    assert np.allclose(seen, 0.5, atol=0.45)


def test_face_on_the_eye_of_the_fold_is_where_the_half_circles_of_thales_cross():
    W = course.board().points
    v = vanishing_points(dlt(W[:, :2], photographs()[0].project(W)))
    a, b, c, d = s = (v - v[0]) @ (v[1] - v[0]) / np.linalg.norm(v[1] - v[0])
    at = (a * b - c * d) / (a + b - c - d)
    x = (770 + 0.62 * (at - (s.min() + s.max()) / 2)) / 1540 * 350 + 500 + 6 + MARGIN
    y = (590 - 0.62 * np.sqrt((at - a) * (b - at))) / 660 * 150 + TITLE
    for fold in (30, 90):  # nothing in this plane turns with the fold
        eye = MODELS["fold"].drawing(fold=fold).picture[round(y), round(x)]
        assert eye.tolist() == [0x56, 0xB4, 0xE9]


def test_from_the_side_the_two_half_circles_cross_in_one_place():
    W = course.board().points
    one, two = (circle_of(dlt(W[:, :2], camera.project(W))) for camera in photographs())
    way = two.place(np.arange(0.1, 180, 0.1))[:, 1:]
    inside = np.hypot(way[:, 0] - one.foot[1], way[:, 1]) < one.radius
    (crossing,) = np.flatnonzero(np.diff(inside))
    assert np.allclose(way[crossing], [239.5, 400], atol=1)


def _on_paper(circle, folds):
    """Give where on its panel a circle is drawn, from 0 to 1."""
    low, high = np.transpose(_SHOWN)
    return (on_sheet(circle.place(folds)) - low) / (high - low)


def test_twelve_half_circles_meet_in_the_camera_where_its_lens_is_undone():
    camera = course.camera()
    exact = [camera.moved(G).project(course.board().points) for G in course.poses()]
    eye = np.array([325, 238 * 800 / 804, 800])
    for m, measured in zip(exact, course.measured_corners(), strict=True):
        straight = camera.ideal(m) * [800, 800] + [325, 238 * 800 / 804]
        circle = circle_of(dlt(course.board().points[:, :2], straight))
        assert circle.distance(eye) < 1e-6
        assert np.abs(m - measured).max() < 0.1
        # Beside it: against a search along the circle.
        aside = eye + [30, -20, 50]
        arc = circle.place(np.linspace(0, 180, 20_001))
        searched = np.linalg.norm(arc - aside, axis=1).min()
        assert np.isclose(circle.distance(aside), searched, rtol=1e-4)
    (left, right), (top, low) = FOLDS_SHOWN
    for k1 in (-0.4, -0.2, 0.1):
        seen = xy_from_px(camera.A, course.measured_corners())
        straight = Lens(k=(k1, 1.6 * k1**2)).undistort(seen)
        for m in straight * 800 + eye[:2]:
            arc = on_sheet(circle_of(dlt(course.board().points[:, :2], m)).place(range(181)))
            assert (arc > [left, top]).all()
            assert (arc < [right, low]).all()
    said = {k1: numbers(MODELS["folds"].drawing(k1=k1).sentence) for k1 in (-0.25, -0.2, 0)}
    assert said[-0.25][1] < 0.5
    assert said[-0.25][2:] == [325, 238, 800]  # the camera that the equations find
    assert said[-0.2][2] > 10
    assert said[0][1:] == [21, 91, 314, 243, 803]  # as on the page, eleven pixels aside


@pytest.mark.parametrize(("r", "ink"), [(0.3, LENS), (0.68, ESTIMATED), (0.82, ESTIMATED)])
def test_a_disc_is_folded_at_the_rim_over_what_the_lens_shows(r, ink):
    model = MODELS["rim"]
    drawing = model.drawing(k1=-1.2, ring=r)
    seen = r - 1.2 * r**3
    turn = np.random.default_rng(0).uniform(0, 2 * np.pi, 400)
    at = np.column_stack([np.cos(turn), np.sin(turn)]) * 430 / 0.834

    def shown(radius):
        u, v = np.rint([MARGIN + 234.5, TITLE + 214.5] + radius * at).astype(int).T
        return drawing.picture[v, u].astype(int)

    def inked(radius):
        return (np.abs(shown(radius) - colour(ink)).max(axis=1) < 60).mean()

    assert inked(abs(seen)) > 0.8
    assert inked(1.15 * abs(seen)) < 0.1 > inked(0.85 * abs(seen))
    top = 2 / 3 * np.sqrt(1 / 3.6)
    said = numbers(drawing.sentence)
    assert np.allclose(said[:4], [np.sqrt(1 / 3.6), top, r, seen], atol=6e-3)
    red_over_blue = [np.median(shown(x) @ [1, 0, -1]) for x in ((seen + top) / 2, 0.8 * seen)]
    if r == 0.68:  # cells are filled orange from the edge to the rim, and are none within
        assert red_over_blue[0] > 60 > 20 > red_over_blue[1]
        # the other root of r − 1.2 r³
        roots = np.roots([-1.2, 0, 1, -seen])
        assert abs(said[4] - np.sort(roots[roots > 0])[0]) < 6e-3
    assert grip_of(drawing, "ring").at == (r, 0)
    assert model.dragged("ring", (0.36, -0.48), k1=-1)["ring"] == 0.6


@pytest.mark.parametrize(("p1", "p2"), [(0.05, 0), (-0.03, 0.04), (0.02, 0.01)])
def test_beside_p_a_decentred_lens_moves_points_by_r2_p_and_along_p_three_times_as_far(
    p1, p2, written, monkeypatch
):
    drawn, draw = [], Panel.arrows
    monkeypatch.setattr(Panel, "arrows", lambda *how: (drawn.append(how[1:]), draw(*how)))
    MODELS["decentred"].drawing(down=4 * p1, right=4 * p2)
    starts, ways = next(
        (np.array(at), np.array(way)) for at, way, *_ in drawn if np.shape(at) == (3, 2)
    )
    p, r2 = np.array([p2, p1]), (starts**2).sum(axis=1)
    assert np.allclose(starts[:2] @ p, 0)
    assert np.allclose(starts[2] @ [p[1], -p[0]], 0)
    assert np.allclose(ways, 3 * r2[:, None] * p * [[1], [1], [3]])  # all are drawn 3 times as far
    assert {"r²p", "3r²p"} <= set(written)


def test_the_glass_is_shifted_by_four_times_p_and_pulls_two_rays_towards_its_own_middle():
    from cvnotes.show.explorations.decentred import _AXIS, _FOCAL, side_ray

    assert MODELS["decentred"].dragged("glass", (0.12, -0.16)) == {"down": -0.16, "right": 0.12}
    drawing = MODELS["decentred"].drawing(down=-0.16, right=0.12)
    assert drawing.sentence.startswith("δ = (0.12, −0.16), p₁ = −0.040, p₂ = 0.030")
    # All around the grip is the light blue of the glass, up to its radius, and white beyond.
    place = np.array(grip_of(drawing, "glass").place)
    turn = np.linspace(0, 2 * np.pi, 200)
    for reach, tint in ((0.44, "#E4F2FB"), (0.75, "#FFFFFF")):
        ring = place + reach * 470 / 1.52 * np.stack([np.cos(turn), np.sin(turn)], -1)
        ring = ring[(ring > 30).all(1) & (ring < 470).all(1)]
        at = np.rint(ring).astype(int)
        assert count(drawing.picture[at[:, 1], at[:, 0]], tint, 6) > 0.4 * len(at)
    # A round lens seen from beside its centre, but for the shift of the whole picture.
    small = 1e-4
    for slope in (-0.36, 0.36, 0.0):
        round_lens = [slope - 0.75 * (slope - delta) ** 3 - slope for delta in (0, small)]
        met = [(side_ray(slope, delta)[-1, 1] - _AXIS) / _FOCAL for delta in (0, small)]
        assert np.isclose(met[0] - slope, round_lens[0])
        assert np.isclose(met[1] - met[0], round_lens[1] - round_lens[0], rtol=1e-3, atol=1e-12)


@pytest.mark.parametrize(("right", "down", "side"), [(0, 0.2, 1), (0.1, -0.1, -1), (-0.2, 0, -1)])
def test_from_the_side_a_glass_shifted_upwards_is_drawn_upwards(right, down, side, monkeypatch):
    from cvnotes.show.explorations import decentred

    drawn, draw = [], Panel.line
    monkeypatch.setattr(
        Panel, "line", lambda *how, **so: (drawn.append(np.array(how[1])), draw(*how, **so))
    )
    MODELS["decentred"].drawing(right=right, down=down)
    for slope in (-decentred._SLOPE, decentred._SLOPE):
        way = decentred.side_ray(slope, side * float(np.hypot(right, down)))
        assert any(xy.shape == way.shape and np.allclose(xy, way) for xy in drawn)


@pytest.mark.parametrize(("p1", "p2"), [(0.05, 0), (-0.03, 0.04), (0.02, 0.01)])
def test_a_decentred_lens_bows_the_line_across_p_and_a_tilted_sensor_does_not(p1, p2):
    """By the terms written out for x and y, and by a division by the tilted coordinate."""
    drawing = MODELS["decentred"].drawing(down=4 * p1, right=4 * p2)
    assert numbers(drawing.sentence)[-2:] == [round(200 * np.hypot(p1, p2), 1), 0]
    x, y = np.stack(np.meshgrid(np.linspace(-0.5, 0.5, 11), np.linspace(-0.5, 0.5, 11)))
    P1, P2, r2 = 3 * p1, 3 * p2, x * x + y * y
    lens = x + 2 * P1 * x * y + P2 * (r2 + 2 * x * x), y + P1 * (r2 + 2 * y * y) + 2 * P2 * x * y
    w = 1 - 2 * (P2 * x + P1 * y)
    for left, top, unit, (u, v) in (
        (235, 235, 470 / 1.52, lens),
        (476 + 165, 182 + 6 + TITLE + 130, 330 / 1.52, (x / w, y / w)),
    ):
        inside = (np.abs(u) < 0.7) & (np.abs(v) < 0.56)
        at = np.rint([MARGIN + left - 0.5 + unit * u, TITLE + top - 0.5 + unit * v])
        near = [
            drawing.picture[b - 1 : b + 2, a - 1 : a + 2].astype(int)
            for a, b in at.astype(int)[:, inside].T
        ]
        met = [(np.abs(around - colour(LENS)).max(-1) < 70).any() for around in near]
        assert np.mean(met) > 0.8  # the rest lies under arrows, words and the ruler
    assert grip_of(drawing, "glass").at == pytest.approx((4 * p2, 4 * p1))


def behind_two_faces(stop, slope):
    """Trace a ray from a stop before the lens by angles; return its place and slope behind it.

    At each face sin I = (l − R) sin U / R and sin I' = n sin I / n', with the distance l from the
    face to where the ray meets the axis under the angle U: Conrady's way.
    """
    after, U = stop + 5, np.arctan(slope)  # l from the first face, and the angle to the axis
    for R, n, n_next, thick in ((100, 1, 1.5, 10), (-100, 1.5, 1, 0)):
        met = np.arcsin((after - R) / R * np.sin(-U))
        left = np.arcsin(n / n_next * np.sin(met))
        U_next = -U + met - left
        after = R + R * np.sin(left) / np.sin(U_next) - thick
        U = -U_next
    return after + 5, np.tan(U)


@pytest.mark.parametrize("stop", [5.5, 10, 15])
def test_a_stop_before_a_lens_makes_a_barrel_and_one_behind_it_a_pincushion(stop):
    """The lens is the same from both sides: a ray to a stop behind it is one that goes back."""
    from cvnotes.show.explorations.stop import FOCAL, SENSOR, lens_of, radii

    f = 1 / (0.5 * (2 / 100 - 0.5 * 10 / (1.5 * 100 * 100)))  # the lens maker's
    sensor = 5 + f * (1 - 0.5 * 10 / (1.5 * 100))
    assert np.allclose([FOCAL, SENSOR], [f, sensor])
    slopes = np.linspace(0.02, 0.8, 40)
    at, behind = np.transpose([behind_two_faces(-stop, slope) for slope in slopes])
    r, seen = radii(-stop, slopes)
    assert np.allclose([r, seen], [slopes, (sensor - at) * behind / f], rtol=1e-9)
    assert (np.diff(seen / r) < 0).all()
    assert np.allclose(r * lens_of(-stop).L(r), seen, atol=1e-3)
    r, seen = radii(stop, slopes)
    assert np.allclose([r, seen], [behind, (sensor - stop) * slopes / f], rtol=1e-9)
    assert (np.diff(seen / r) > 0).all()
    assert np.allclose(r * lens_of(stop).L(r), seen, atol=1e-3)


def test_a_stop_within_the_glass_leaves_lines_nearly_straight():
    from cvnotes.show.explorations.stop import radii

    slopes = np.linspace(0.01, 0.5, 30)
    r, seen = radii(0, slopes)
    assert np.allclose(r, 1.5 * slopes / np.sqrt(1 - 1.25 * slopes**2), rtol=0.04)  # as of a plate
    assert np.abs(seen / r - 1).max() < 0.005
    for outside, inside in ((-5.001, -5), (5.001, 5)):  # it passes the faces without a leap
        ways = [np.interp(0.4, *radii(at, np.linspace(0, 0.6, 200))) for at in (outside, inside)]
        assert abs(ways[0] - ways[1]) < 1e-4


@pytest.mark.parametrize(("stop", "shape"), [(-15, "barrel"), (0, "straight"), (15, "pincushion")])
def test_the_rays_through_a_stop_are_drawn_to_where_they_are_told_to_arrive(stop, shape):
    from cvnotes.show.explorations.stop import SENSOR

    drawing = MODELS["stop"].drawing(stop=stop)
    assert f"{shape}, k" in drawing.sentence
    meant, seen = numbers(drawing.sentence)[-3:-1]
    assert round(seen - meant) == {-15: -3, 0: 0, 15: 5}[stop]
    u = MARGIN + (SENSOR + 62) / 174 * 520 - 0.5
    for side in (-1, 1):
        v = TITLE + (66 + side * seen) / 132 * 394 - 0.5
        near = drawing.picture[round(v) - 2 : round(v) + 3, round(u) - 2 : round(u) + 3]
        assert (np.abs(near.astype(int) - colour(LENS)).max(axis=-1) < 60).any()
    assert grip_of(drawing, "stop").at[0] == stop


@pytest.mark.parametrize("stop", [-15, 4, 15])
def test_the_factor_of_the_traced_rays_is_drawn_with_its_polynomial_and_that_with_k1_alone(
    stop, monkeypatch
):
    dots, lines, mark, line = [], [], Panel.mark, Panel.line
    monkeypatch.setattr(Panel, "mark", lambda *how: (dots.append(how[:2]), mark(*how)))
    monkeypatch.setattr(
        Panel, "line", lambda *how, **more: (lines.append((how[0], how[1])), line(*how, **more))
    )
    drawing = MODELS["stop"].drawing(stop=stop)
    panel, five = dots[-1]
    assert panel.title.startswith("L over r")
    r, factor = np.transpose(five)
    assert np.allclose(r, [-0.5, -0.25, 0, 0.25, 0.5], atol=1e-3)
    meant, seen = numbers(drawing.sentence)[-3:-1]
    assert np.allclose(factor[[0, 2, 4]], [seen / meant, 1, seen / meant], atol=2e-3)
    whole, bend = (np.array(at) for where, at in lines[-2:])
    assert np.allclose(np.interp(r, *whole.T), factor, atol=2e-3)
    assert np.allclose((bend[:, 1] - 1), numbers(drawing.sentence)[-1] * bend[:, 0] ** 2, atol=2e-3)


@pytest.mark.parametrize("hole", [0.02, 0.074, 0.3])
def test_the_light_behind_a_hole_is_drawn_as_wide_as_it_is_told_to_be(hole):
    drawing = MODELS["pinhole"].drawing(hole=hole)
    _, patch, spread, *_ = numbers(drawing.sentence)
    top, sensor = TITLE + 197 + 6 + TITLE, MARGIN + 440 + 6 + 330
    inked = np.abs(drawing.picture[top : top + 105, sensor] - [213.0, 94, 0]).max(axis=-1) < 60
    assert abs(inked.sum() - 0.85 * (patch + spread)) <= 3
    lit = drawing.picture[top : top + 105, sensor - 300]  # before the hole
    assert abs((np.abs(lit - [215.0, 231, 243]).max(axis=-1) < 8).sum() - 0.85 * patch) <= 3


@pytest.mark.parametrize("focus", [4, 0.2, 0.1])
def test_rays_meet_on_the_sensor_from_what_is_sharp_and_before_it_from_what_is_farther(focus):
    picture = MODELS["pinhole"].picture(lens=1, focus=focus).astype(int)
    top, left = TITLE + 197 + 6 + TITLE, MARGIN + 440 + 6

    def apart(x, ink):
        """How far apart the outermost strokes of a colour are in a column."""
        near = picture[top : top + 105, left + x - 1 : left + x + 2]
        warm = (near[..., 0] - near[..., 2]) * (1 if ink == ESTIMATED else -1)
        return np.ptp(np.flatnonzero((warm > 50).any(axis=1)))

    for ink, s in ((ESTIMATED, 5), (CAMERA, 0.2)):
        disc = 1.6 * abs(1 / s - 1 / focus)  # px: 2 mm · 4 mm / 5 µm, and metres
        assert abs(apart(330, ink) - 3 * disc) <= 4
        expected = 34 + (np.sign(focus - s) * 1.5 * disc - 34) * 2 / 3  # two thirds of the way
        assert abs(apart(270, ink) - 2 * abs(expected)) <= 4


@pytest.mark.parametrize(
    ("a", "b", "kind"),
    [(0.3, 0.4, "ellipse"), (0.6, 0.8, "parabola"), (0.9, -1.0, "hyperbola"), (0, 0, "a circle")],
)
def test_the_picture_of_a_circle_is_the_conic_that_its_matrix_says(a, b, kind):
    drawing = MODELS["conic"].drawing(a=a, b=b)
    told = {"ellipse": "passes", "parabola": "touches", "hyperbola": "cuts", "a circle": "identity"}
    assert told[kind] in drawing.sentence
    assert kind not in drawing.sentence  # that is asked of the reader
    inverse = np.linalg.inv([[1, 0, 0], [0, 1, 0], [a, b, 1]])
    C = inverse.T @ np.diag([1, 1, -1]) @ inverse
    disc = np.linalg.det(C[:2, :2])  # of a parabola 0, of a hyperbola negative
    assert np.sign(round(disc, 9)) == {"parabola": 0, "hyperbola": -1}.get(kind, 1)
    left = MARGIN + 400 + 6
    picture = drawing.picture[TITLE + 4 : TITLE + 336, left + 4 : left + 396].astype(int)
    for ink, side in ((LENS, 1), (ESTIMATED, -1)):
        v, u = np.nonzero((np.abs(picture - colour(ink)) < 40).all(axis=-1))
        if side < 0 and kind != "hyperbola":
            assert len(u) < 5
            continue
        x = np.column_stack([(u + 4.5) / 42.5 - 80 / 17, 4 - (v + 4.5) / 42.5, np.ones(len(u))])
        assert len(x) > 100
        gradient = np.linalg.norm((2 * x @ C)[:, :2], axis=1)
        assert np.median(np.abs(np.sum(x @ C * x, axis=1)) / gradient) < 1.5 / 42.5  # px off
        # Back on the plane these are on their side of the line, where 1 / w is.
        assert np.mean(np.sign(x @ inverse[2]) == side) > 0.98


@pytest.mark.parametrize(("a", "b"), [(0.5, 0.4), (0.9, -1.0), (0, 0.4)])
def test_the_net_beside_a_conic_runs_to_the_horizon_and_is_one_of_squares_on_the_plane(a, b):
    left = MARGIN + 400 + 6
    picture = MODELS["conic"].picture(a=a, b=b)[TITLE : TITLE + 340, left : left + 400].astype(int)
    inverse = np.linalg.inv([[1, 0, 0], [0, 1, 0], [a, b, 1]])
    for ink, side in (("#80B8D8", 1), ("#EAAE80", -1), ("#000000", 0)):
        v, u = np.nonzero((np.abs(picture - colour(ink)) < 25).all(axis=-1))
        x = np.column_stack([(u + 0.5) / 42.5 - 80 / 17, 4 - (v + 0.5) / 42.5, np.ones(len(u))])
        beyond = (1 - x[:, :2] @ [a, b]) / np.hypot(a, b)  # in units of the plane's picture
        assert len(x) > 100
        if not side:
            assert np.abs(beyond).max() < 0.05
            continue
        assert (side * beyond).min() > -0.05
        assert min(side * beyond) < 0.15  # up to the horizon
        C = x @ inverse.T @ np.diag([1, 1, -1]) @ inverse  # the rim of the circle is as pale
        from_circle = np.abs(np.sum(C * x, axis=1)) / np.linalg.norm(2 * C[:, :2], axis=1)
        clear = (side * beyond > 1) & (from_circle > 6 / 42.5)
        shifts = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]]) / 42.5  # by no pixel, and by one
        back = (x[clear] + shifts[:, None]) @ inverse.T
        on_plane, *beside = back[..., :2] / back[..., 2:]
        wide = np.abs(beside - on_plane).sum(axis=0)
        off = np.abs(2 * on_plane - np.round(2 * on_plane)) / 2
        assert np.mean((off < 1.2 * wide).any(axis=1)) > 0.98
        assert np.mean(wide < 0.1) > 0.2  # (of wide ones it says nothing)


@pytest.mark.parametrize(
    ("a", "b", "points"),
    [(0.75, 0.75, True), (-0.9, 0.5, True), (0, 1.02, True), (0.9, -1.0, False), (0.6, 0.8, False)],
)
def test_an_arrow_points_to_the_piece_of_a_conic_that_is_outside(monkeypatch, a, b, points):
    arrows = []
    monkeypatch.setattr(Panel, "arrows", lambda _, *drawn: arrows.append(drawn[:2]))
    MODELS["conic"].drawing(a=a, b=b)
    assert len(arrows) == points
    for start, way in arrows:
        vertex = -np.array([a, b, 0]) / np.hypot(a, b) + [0, 0, 1]
        x, y, w = np.array([[1, 0, 0], [0, 1, 0], [a, b, 1]]) @ vertex
        ahead = np.array([x, y]) / w - start
        assert abs(x / w) > 80 / 17 or abs(y / w) > 4  # out of the frame
        assert max(abs((start + way) * [17 / 80, 1 / 4])) < 1  # and the arrow in it
        assert np.allclose(way / np.linalg.norm(way), ahead / np.linalg.norm(ahead), atol=1e-9)


def test_the_line_that_goes_to_infinity_is_held_at_its_foot():
    model = MODELS["conic"]
    for foot in ((0.8, -0.3), (-1, 1), (0.5, 0.5)):
        values = model.dragged("horizon", foot)
        assert np.dot([values["a"], values["b"]], foot) == pytest.approx(-1, abs=0.01)
        assert np.allclose(grip_of(model.drawing(**values), "horizon").at, foot, atol=0.02)
    assert not model.drawing(a=0, b=0).grips


def test_two_photographs_join_to_that_of_one_wide_camera_at_its_focal_length():
    wide = Camera(intrinsics(200, 200, 143.3, 163.3), size=(480, 309))  # as the sheet shows it
    whole = radiance(scene_of_the_seam(), wide).clip(0, 255)
    apart, off = {}, {}
    for alpha in (460, 490, 500, 510, 540):
        drawing = MODELS["seam"].drawing(alpha=alpha)
        apart[alpha] = numbers(drawing.sentence)[-1]
        sheet = drawing.picture[TITLE : TITLE + 309, MARGIN : MARGIN + 480].astype(int)
        inside = np.s_[90:250, 25:370]  # where both are, or one of them
        off[alpha] = np.abs(sheet[inside] - whole[inside]).mean()
    assert off[500] < 0.4 * min(off[460], off[540]), off
    assert off[500] < min(off[490], off[510])
    assert apart[500] < 1.5
    assert min(apart[490], apart[510]) > 4


def test_after_a_step_aside_what_is_near_closes_at_another_focal_length_than_what_is_far():
    """In the enlarged part: the post is green where it closes, and the board on the wall dark."""

    def seen(**values):
        close = MODELS["seam"].drawing(**values).picture[TITLE : TITLE + 150, -219:-3].astype(int)
        red, green, blue = np.moveaxis(close, -1, 0)
        return ((green - red > 60) & (green - blue > 40)).sum(), ((red < 70) & (blue > 80)).sum()

    on_the_spot = seen(alpha=500)
    far, near = seen(alpha=560, aside=400), seen(alpha=695, aside=400)
    assert on_the_spot[0] > 2000
    assert near[0] > 5 * max(far[0], 1)  # the post is whole here, and there pale and twice
    assert far[1] > 2 * near[1]


def test_a_step_aside_leaves_the_seam_open_at_every_focal_length():
    lowest = {}
    for aside in (0, 200, 400):
        off = [numbers(MODELS["seam"].drawing(alpha=a, aside=aside).sentence)[-1]
               for a in range(460, 620, 10)]  # fmt: skip
        lowest[aside] = min(off)
    assert lowest[0] < 1
    assert 10 < lowest[200] < lowest[400] - 3


def test_the_curve_of_a_seam_is_what_is_said_at_each_focal_length(monkeypatch):
    drawn, line = [], Panel.line

    def kept(panel, xy, *rest, **how):
        drawn.append(np.array(xy))
        line(panel, xy, *rest, **how)

    monkeypatch.setattr(Panel, "line", kept)
    MODELS["seam"].drawing()
    (curve,) = (xy for xy in drawn if len(xy) > 20)
    assert curve[curve[:, 1].argmin(), 0] == 500
    for alpha in (220, 480, 500, 900):
        said = numbers(MODELS["seam"].drawing(alpha=alpha).sentence)[-1]
        assert curve[curve[:, 0] == alpha, 1] == pytest.approx(said, abs=0.06)


def test_each_photographs_angles_stand_in_its_row(monkeypatch):
    """Of a hinge too flat: what the sentence says of the first photograph, and of the second."""
    placed, write = [], Panel.text

    def note(self, xy, words, *rest, **how):
        placed.append((np.array(xy), words))
        write(self, xy, words, *rest, **how)

    monkeypatch.setattr(Panel, "text", note)
    said = re.findall(r"[\d.]+(?=°)", MODELS["fold"].drawing(fold=70, second=1).sentence)
    rows = {words: xy[1] for xy, words in placed if words.startswith("photograph") and ":" in words}
    for i, row in enumerate((rows["photograph 1:"], rows["photograph 2:"])):
        shown = [words for xy, words in placed if xy[1] == row and words.endswith("°")]
        assert shown == [f"{float(angle):.1f}°" for angle in said[2 * i : 2 * i + 2]]


def test_the_box_is_seen_through_the_glass_before_it():
    drawing = MODELS["triangle"].drawing()
    glass, side = np.array([0xD5, 0xEA, 0xF7]), np.array([0xF4, 0xEF, 0xEB])
    for behind in (side, np.full(3, 255)):
        through = np.abs(drawing.picture.astype(int) - (glass + behind) / 2).max(axis=-1) < 1.5
        assert through.sum() > 300


def test_the_lenss_curve_has_its_top_where_the_lens_folds():
    r = np.linspace(0, 1.3, 2000)
    top = r[seen_radius(Lens(k=(-0.9, 0.1)), r).argmax()]
    said = MODELS["lens"].drawing(k1=-0.9, k2=0.1).sentence
    assert numbers(said)[0] == pytest.approx(top, abs=2e-3)


@pytest.mark.parametrize(
    ("values", "kept"),
    [
        ({"turn": 50}, {0, 1, 2, 3, 4, 5}),
        ({"turn": 50, "size": 0.7}, {1, 2, 3, 4, 5}),
        ({"size": 0.7, "shear": -0.6}, {3, 4, 5}),
        ({"size": 0.7, "stretch": 1.2}, {1, 3, 4, 5}),  # the ratio of two sides alone
        ({"shear": 0.4, "along": -0.3, "up": 0.35}, {5}),
    ],
)
def test_each_kind_of_map_keeps_what_its_row_of_the_table_says(values, kept):
    names = [
        "length",
        "angle at corner 3",
        "blue side : bottom",
        "angle of opp",
        "ab : bd",
        "cross-ratio",
    ]
    said = MODELS["maps"].drawing(**values).sentence
    assert {i for i, name in enumerate(names) if name not in said} == kept
    kinds = {6: "Euclidean", 5: "similar", 4: "affine", 3: "affine", 1: "projective"}
    assert kinds[len(kept)] in said
    # By hand: where the corners go, of which the first three make a parallelogram.
    given = MODELS["maps"].values(**values)
    a, b, c, d = (complex(x, y) for x, y in apply(maps.matrix(given), maps._SQUARE[:4]))
    side = given["size"] * np.exp(1j * np.radians(given["turn"]))
    down = side * complex(given["shear"], given["stretch"])
    assert np.isclose(c - d, 2 * side)
    assert np.isclose(d - a, 2 * down)
    assert np.isclose(b - a, (2 + given["along"]) * side - given["up"] * down)
    assert maps.measured(maps.matrix(given))[0] == pytest.approx(abs(c - b))
    assert maps.measured(maps.matrix(given))[2] == pytest.approx(abs(c - b) / abs(d - c))


@pytest.mark.parametrize("moved", [-0.5, -0.2, 0.1, 0.3, 0.5])
def test_a_corner_that_is_pulled_along_the_diagonal_leaves_the_cross_ratio_alone(moved):
    said = MODELS["maps"].drawing(along=moved, up=moved).sentence
    assert "cross-ratio" not in said
    assert said.endswith("ab : bd.")


def test_what_a_map_changes_stands_inside_the_frame_of_its_kind_and_the_rest_is_kept():
    heights = []
    for values in ({}, {"size": 1.3}, {"shear": 0.4}, {"up": 0.3, "along": 0.2}):
        picture = MODELS["maps"].picture(turn=20, **values)[TITLE : TITLE + 380, 380 + 2 * MARGIN :]
        lit, _ = np.nonzero(np.abs(picture.astype(int) - colour(WORLD)).max(axis=-1) < 30)
        orange, _ = np.nonzero(np.abs(picture.astype(int) - colour("#BC5200")).max(axis=-1) < 60)
        heights.append(np.ptp(lit))
        assert (len(orange) > 0) == bool(values)
        assert ((lit.min() < orange) & (orange < lit.max())).all()
    assert (np.diff(heights) > 40).all(), heights  # each kind in the next
    assert orange.min() > lit.min() + 90  # under the cross-ratio, which stays


def test_four_letters_stand_inside_the_square_beside_the_points_of_the_cross_ratio():
    for values in ({}, {"size": 0.6, "shear": 0.5}, {"along": 0.3, "up": 0.2}):
        picture, H = MODELS["maps"].picture(**values), maps.matrix(MODELS["maps"].values(**values))
        wide = max(2.5, 1.2 * float(np.abs(apply(H, maps._SQUARE)).max()))
        for place, away in zip(maps._SIDE, (25, 25, 14, 14), strict=True):
            there, inner = (
                380 * (apply(H, place - [by, 0]) + wide) / (2 * wide) for by in (0, 0.5)
            )
            at = there + away * (inner - there) / np.linalg.norm(inner - there)
            x, y = np.rint(at + [MARGIN, TITLE]).astype(int)
            assert count(picture[y - 7 : y + 8, x - 5 : x + 6], LENS, 90) > 8


def test_a_hand_reaches_all_four_kinds_of_maps_though_it_is_not_exact():
    model = MODELS["maps"]
    turn = np.radians(20)
    right, up = np.array([np.cos(turn), np.sin(turn)]), np.array([np.sin(turn), -np.cos(turn)])
    kinds = [
        ("Euclidean", "right side", 1.05 * np.array([np.cos(1), np.sin(1)])),
        ("similar", "right side", 1.3 * right),
        ("affine", "top", up + 0.4 * right + 0.05 * up),
        ("affine", "top", 1.3 * up + 0.05 * right),
        ("projective", "corner", 1.3 * up + 1.2 * right),
    ]
    for kind, grip, at in kinds:
        pulled = model.dragged(grip, at)
        assert kind in model.drawing(**pulled).sentence.split(". It has")[0]


def test_no_hand_pulls_a_corner_of_the_square_out_of_its_panel():
    rng, model = np.random.default_rng(8), MODELS["maps"]
    values = model.values()
    for at in rng.uniform(-4, 4, (150, 2)):
        held = rng.choice(["right side", "top", "corner"])
        values = model.dragged(held, tuple(at), **values)
        assert np.abs(apply(maps.matrix(values), maps._SQUARE)).max() < 2.5


def test_h_is_shortest_where_the_smaller_singular_value_says():
    for parallel in (0, 0.4, 0.9):
        said = [
            numbers(MODELS["ellipse"].drawing(angle=a, parallel=parallel).sentence)
            for a in range(0, 181, 2)
        ]
        lengths = np.array([row[0] for row in said])
        _, longest, shortest = said[0]
        assert abs(lengths.max() - longest) < 0.011
        assert abs(lengths.min() - shortest) < 0.02
    assert "D v₂ = 0" in MODELS["ellipse"].drawing(parallel=1).sentence
    at_0 = numbers(MODELS["ellipse"].drawing(angle=0).sentence)[0]
    assert at_0 == pytest.approx(np.hypot(1.6, 0.5), abs=0.006)  # the first column of D


def test_what_the_next_picture_leaves_is_what_a_calibration_with_it_leaves():
    of, W = eleventh.known(), course.board().points
    for values in ({"u": 160, "v": 120, "tilt": 30}, {"u": 640, "v": 480, "tilt": -45}):
        G = eleventh.held(**values)
        seen = of.found.camera.moved(G).project(W)
        assert np.linalg.norm(seen.mean(axis=0) - [values["u"], values["v"]]) < 40
        noise = np.random.default_rng(6).normal(scale=0.1, size=seen.shape)
        more = calibrate(W, np.array([*of.seen, seen + noise]), (1280, 960), lens="k1 k2")
        said = numbers(MODELS["eleventh"].drawing(**values).sentence)
        for name, left in (("k2", said[0]), ("alpha_u", said[1])):
            came = more.std[name] / more.rms / of.found.std[name] * of.found.rms
            assert came == pytest.approx(left, abs=0.02)


def test_the_curve_of_k2_is_what_is_said_at_each_tilt_and_marks_where_the_board_faces_its_ray():
    model = MODELS["eleventh"]
    for u, v in ((160, 120), (1120, 840)):
        for tilt, left in zip(eleventh._TILTS, eleventh.left_of_k2(u, v), strict=True):
            drawing = model.drawing(u=u, v=v, tilt=tilt)
            assert numbers(drawing.sentence)[0] == pytest.approx(left, abs=0.006)
            assert grip_of(drawing, "left").at == pytest.approx((tilt, left), abs=1e-5)
        faces = eleventh.faces_its_ray(u, v)
        G = eleventh.held(u, v, faces)
        normal, middle = G[:3, 2], (G @ [100, 62.5, 0, 1])[:3]
        assert np.degrees(np.arccos(normal @ middle / np.linalg.norm(middle))) < 1
    assert model.dragged("left", (31.0, 0.3))["tilt"] == 30


def test_the_five_pictures_are_those_of_the_chapter_and_so_are_the_errors():
    light, truth = course.photos()[6].astype(float), course.exact_corners()[6]
    sharpened = (2 * light - gaussian_blur(light, 1.5)).clip(0, 255)
    shaken = expose(light, motion=(5, 0), noise=2, rng=np.random.default_rng(3))
    inner = np.s_[10:-10, 10:-10]  # at the border they differ
    assert np.abs(clouds.changed(2) - sharpened)[inner].max() < 1e-3
    assert (clouds.changed(4) != shaken).mean() < 1e-3
    seen = render_scene(room_with(course.board(), course.poses()[6]), course.camera(), samples=64)
    assert np.abs(clouds.changed(5) - luma(seen.astype(float))).max() < 1e-9
    for picture, which in ((sharpened, 2), (shaken, 4)):
        off = refine_subpixel(picture, np.rint(truth), window=8) - truth
        edges = refine_edges(picture, np.rint(truth), grid=(9, 6), window=8) - truth
        sentence = MODELS["clouds"].drawing(picture=which).sentence
        said = numbers(sentence)
        expected = [np.sqrt(np.mean(np.sum(e**2, axis=1))) for e in (off, edges)]
        np.testing.assert_allclose(said[-3:-1], expected, atol=6e-4)
        assert said[-1] == pytest.approx(max(expected) / min(expected), abs=0.06)
        larger = "blue" if expected[0] > expected[1] else "orange"
        assert f"the {larger} cloud is" in sentence
    u, v = np.rint(truth[22]).astype(int)  # what is shown of each is a part of what is measured
    for k, cutout in enumerate(clouds.cutouts(), 1):
        part = clouds.changed(k)[v - 14 : v + 15, u - 14 : u + 15]
        assert np.abs(cutout - part.clip(0, 255)).max() <= 0.5


def test_a_ring_is_as_large_as_the_rms_of_a_point():
    off = refine_subpixel(course.photos()[6], np.rint(course.exact_corners()[6]), window=8)
    far = np.linalg.norm(off - course.exact_corners()[6], axis=1)
    radius = 360 / 0.2 * np.sqrt(np.mean(far**2))
    drawn = MODELS["clouds"].picture(picture=1)
    middle = np.array([MARGIN + 298, TITLE + 180])
    for a in np.radians([10, 100, 190, 280]):
        u, v = np.rint(middle + radius * np.array([np.cos(a), np.sin(a)])).astype(int)
        assert count(drawn[v - 1 : v + 2, u - 1 : u + 2], LENS, 60) >= 2


def test_it_is_told_when_errors_lie_outside_of_their_panel(written):
    for which, words in ((1, []), (3, ["4 of 54 go beyond"])):
        written.clear()
        MODELS["clouds"].drawing(picture=which)
        assert [w for w in written if w.endswith("beyond")] == words


def test_forty_noisy_photographs_scatter_by_the_noise_over_the_root_of_the_eigenvalue(written):
    photo, (u, v) = course.photos()[6].astype(float), np.rint(course.exact_corners()[6][22])
    near = np.s_[int(v) - 22 : int(v) + 11, int(u) - 16 : int(u) + 17]
    left = photo[near] - forty.quiet()  # the course's own photograph is one of them
    assert abs(left.mean()) < 0.1
    assert left.std() == pytest.approx(2, rel=0.05)
    for up in (0, 9, 10):
        eigenvalues, axes, places = forty.found(up)
        written.clear()
        told = numbers(MODELS["forty"].drawing(up=up, noise=3).sentence)
        expected = 3 / np.sqrt(eigenvalues)
        assert [told[2], told[5]] == pytest.approx(expected, abs=6e-5)
        assert {f"{one:.4f}" for one in expected} <= set(written)  # the ellipse's half axes
        assert np.std(3 * places @ axes, axis=0) == pytest.approx(expected, rel=0.25)  # of 40


def test_a_pushed_picture_is_found_where_it_was_pushed_to(monkeypatch):
    pushed = forty.quiet(0.1, 0) - forty.quiet(), forty.quiet(0, 0.2) - forty.quiet()
    monkeypatch.setattr(forty, "noises", lambda: np.repeat(pushed, forty._PHOTOS // 2, axis=0))
    for up in (0, 9):
        _, _, places = forty.found(up)
        np.testing.assert_allclose(places[0], [0.1, 0], atol=0.02)
        np.testing.assert_allclose(places[-1], [0, 0.2], atol=0.02)


def test_squares_between_corners_are_dark_where_those_of_the_printed_board_are():
    board = Chessboard((9, 6), 25.0)
    squares, _ = target_shapes(board)
    printed = {tuple(c.mean(axis=0).round(3)) for c in squares.corners[squares.colours[:, 0] < 0.5]}
    drawn, dark = squares_between(board.points.reshape(6, 9, 3))
    middles = drawn.mean(axis=1).round(3)
    assert [tuple(middle) in printed for middle in middles] == dark.tolist()
    assert 0 < dark.sum() < len(dark)


def test_boards_on_a_hinge_tell_alpha_as_a_calibration_of_their_photograph_finds_it():
    noise = np.random.default_rng(0).normal(scale=0.1, size=(40, 168))
    for angle in (90, 150, 165):
        target = TwoPlanes(Chessboard((7, 6), 25.0), np.radians(angle))
        exact = hinge._VIEW.project(target.points)
        told = numbers(MODELS["hinge"].drawing(angle=angle).sentence)[-1]
        drawn = MODELS["hinge"].picture(angle=angle)
        for k in (0, 13, 39):
            result = calibrate_one_view(
                target.points, exact + noise[k].reshape(2, 84).T, (640, 480)
            )
            scatter = result.rms * np.sqrt(84 / (168 - 10))  # px of a coordinate, from residuals
            assert result.std["alpha_u"] * 0.1 / scatter == pytest.approx(told, rel=0.1)
            found = hinge.found()[angle - 90, k]
            assert found == pytest.approx(result.A[[0, 1], [0, 1]], abs=0.1)
            u = MARGIN + 526 + 340 * (result.A[0, 0] - 740) / 120
            v = TITLE + 200 - 340 * (result.A[1, 1] - 804) / 120
            at = np.rint([u, v]).astype(int)
            assert count(drawn[at[1] - 1 : at[1] + 2, at[0] - 1 : at[0] + 2], ESTIMATED, 60) >= 4
        assert hinge.found()[angle - 90, :, 0].std() == pytest.approx(told, rel=0.25)


def test_dots_that_leave_the_panel_of_the_hinge_are_counted(written):
    for angle in (120, 179):
        off = np.abs(hinge.found()[angle - 90] - [800, 804]) > [60, 60 * 400 / 340]
        beyond = int(off.any(axis=1).sum())
        written.clear()
        MODELS["hinge"].drawing(angle=angle)
        assert [w for w in written if w.endswith("beyond")] == [f"{beyond} of 40 go beyond"][
            :beyond
        ]


def test_half_the_bend_is_worth_half_and_none_is_worth_nothing():
    told = {a: numbers(MODELS["hinge"].drawing(angle=a).sentence)[-1] for a in (176, 178, 179)}
    assert told[178] / told[176] == pytest.approx(2, rel=0.02)
    assert told[179] / told[178] == pytest.approx(2, rel=0.02)
    assert MODELS["hinge"].drawing(angle=180).sentence.endswith("does not determine αᵤ.")
    flat = TwoPlanes(Chessboard((7, 6), 25.0), np.pi)
    with pytest.raises(DegenerateError):
        calibrate_one_view(flat.points, hinge._VIEW.project(flat.points), (640, 480))


def test_the_rings_axes_are_those_about_which_their_angles_turn():
    rng = np.random.default_rng(2)
    for _ in range(5):
        values = random_values(MODELS["gimbal"], rng)
        angles = np.radians([values[name] for name in "xyz"])
        R = rotation_from_angles(*angles)
        turned = gimbal.axes(values)
        for axis, name in zip(turned, "zyx", strict=True):
            more = np.radians([values[n] + 0.01 * (n == name) for n in "xyz"])
            turn = vector_from_rotation(rotation_from_angles(*more) @ R.T) / np.radians(0.01)
            assert np.allclose(turn, axis, atol=1e-3)
        volume = abs(np.linalg.det(turned))
        assert volume == pytest.approx(np.cos(angles[1]), abs=1e-9)
        said = MODELS["gimbal"].drawing(**values).sentence
        apart = np.degrees(np.arccos(min(abs(turned[0] @ turned[2]), 1)))
        assert "one line" in said if volume < 1e-9 else abs(numbers(said)[-1] - apart) < 0.51
    # Then two angles do the same to what is drawn.
    locked = [MODELS["gimbal"].picture(x=x, y=90, z=z) for x, z in ((40, 0), (10, -30))]
    dart = [(p[TITLE:].max(axis=-1) < 40) for p in locked]
    assert (dart[0] & dart[1]).sum() > 0.9 * (dart[0] | dart[1]).sum() > 1000


@pytest.fixture
def written(monkeypatch):
    """Note where the words of a drawing are written, each with the panel and the place."""
    write, noted = Panel.text, {}

    def note(self, xy, words, *rest, **how):
        noted[words] = self, np.array(xy, dtype=float)
        write(self, xy, words, *rest, **how)

    monkeypatch.setattr(Panel, "text", note)
    return noted


def test_each_axis_of_the_rings_has_its_letter_beside_its_end(written):
    for values in ({}, {"y": 90, "z": -40}, {"x": 70, "y": -30, "z": 100}):
        drawing = MODELS["gimbal"].drawing(**values)
        end = np.array(grip_of(drawing, "orange axis").at)  # on the axis of the last ring
        assert np.allclose(written["x"][1] - end, [0.14, 0], atol=1e-6)
        assert np.allclose(written["z"][1], [0.14, -1.3 * np.cos(np.radians(22))])  # up
        at = written["y"][1]  # outside of the ring, on either side
        assert np.linalg.norm(at - [0.14 if at[0] > -0.2 else -0.14, 0]) < 1.1


def test_the_word_sharp_is_not_written_over_that_of_a_pixel(written):
    for focus in (0.1, 1, 1.95, 2, 5, 10):
        MODELS["pinhole"].drawing(lens=1, focus=focus)
        panel, (sharp, _) = written["sharp"]
        assert abs(sharp - written["1 px"][1][0]) > 0.15 + 0.1  # half of "sharp", and "1 px"
        assert sharp < panel.x[1] - 0.1


def test_close_to_level_the_number_on_the_other_side_is_told():
    for angle in (88, 92):
        x, beyond = numbers(MODELS["ring"].drawing(angle=angle).sentence)[2:4]
        assert (x, beyond) == pytest.approx(np.tan(np.radians([angle, -angle])), rel=0.01)


def test_no_finder_is_said_to_be_exact():
    for corner in range(54):
        sentence = MODELS["subpixel"].drawing(corner=corner, finders=1).sentence
        assert re.search(
            r"gradients (\S+|less than \S+), edge model (\S+|less than \S+) px", sentence
        )
        assert "0.000" not in sentence


def test_the_shadows_of_board_and_camera_lie_on_the_floor(monkeypatch):
    shadows, fill = [], Panel.polygons

    def note(self, corners, ink):
        shadows.extend([corners] * (ink == moved._SHADOW))
        fill(self, corners, ink)

    monkeypatch.setattr(Panel, "polygons", note)
    for photo in (0, 6, 11):
        MODELS["moved"].drawing(photo=photo)
    floor = Delaunay(moved.on_sheet(moved._room().floor).reshape(-1, 2))
    assert len(shadows) == 6
    places = np.concatenate([shadow.reshape(-1, 2) for shadow in shadows])
    assert (floor.find_simplex(places) >= 0).all()


def test_the_picture_of_the_next_view_is_as_wide_as_it_would_be():
    grip = grip_of(MODELS["eleventh"].drawing(), "board")
    assert grip.unit[0] == pytest.approx(grip.unit[1], rel=0.01)  # its pixels are square


def test_what_is_behind_the_camera_is_cut_off_along_every_edge():
    square = np.array([[0, 0, 110], [1, 0, 110], [1, 0, -40], [0, 0, -40]], float)
    for turn in range(4):
        turned = np.roll(square, turn, 0)
        before = cut(turned, turned[:, 2] - 10).round(9)
        assert sorted(before.tolist()) == [[0, 0, 10], [0, 0, 110], [1, 0, 10], [1, 0, 110]]


def test_both_ways_back_through_the_lens_take_as_many_rounds_as_by_hand(monkeypatch):
    lines, line = [], Panel.line
    monkeypatch.setattr(
        Panel, "line", lambda *told, **how: (lines.append(told[1:]), line(*told, **how))
    )
    model = MODELS["uphill"]
    for seen in (0.5136, 0.6056, 0.6084):
        ideal = min(root.real for root in np.roots([-0.4, 0, 1, -seen]) if root.real > 0)
        counts = []
        for way in ("Newton", "dividing"):
            r, n = seen, 0
            while abs(r - ideal) * 800 > 0.1:
                slope = 1 - 1.2 * r * r if way == "Newton" else 1 - 0.4 * r * r
                r, n = r + (seen - r + 0.4 * r**3) / slope, n + 1
            counts.append(n)
        lines.clear()
        drawing = model.drawing(seen=seen)
        told = numbers(drawing.sentence)
        assert told == pytest.approx([seen, ideal, 800, *counts], abs=6e-4)
        # Each step is straight up to the height, then straight down to the curve.
        steps = [np.array(xy) for xy, ink, *width in lines if ink == ESTIMATED and width == [2.4]]
        assert len(steps) == 16  # in both panels
        for start, top, foot in steps:
            slope = 1 - 1.2 * start[0] ** 2
            assert top == pytest.approx([start[0] + (seen - start[1]) / slope, seen])
            assert foot == pytest.approx([top[0], top[0] - 0.4 * top[0] ** 3])
    assert "both fail" in model.drawing(seen=0.6086).sentence  # the top is at 0.60858
    assert model.dragged("point", (0.36, -0.48))["seen"] == 0.6
    assert model.dragged("height", (0.9, 0.55))["seen"] == 0.55


def test_a_ball_is_divided_by_its_depth_on_the_glass_and_hangs_on_its_line():
    """The picture is 330 px for 1.6 of the plane z = 1; from outside by hand, at 430 px."""
    model = MODELS["glass"]
    eye = look_at([3, -1.1, -1.7], [0.48, 0.33, 2])[:3]
    for x, z in ((0.8, 2), (0.8, 4), (1.2, 5), (0.5, 1.6)):
        drawing = model.drawing(x=x, z=z)
        assert numbers(drawing.sentence) == pytest.approx(
            [x, 0.2, z, z, x / z, 0.2 / z, 1], abs=6e-4
        )
        seen = drawing.picture[TITLE : TITLE + 248, 476 + MARGIN : 806 + MARGIN].astype(int)
        ball = (seen[..., 0] - seen[..., 2] > 160).nonzero()
        places = np.array([[ball[1].min(), ball[1].max()], [ball[0].min(), ball[0].max()]])
        middle = np.array([x, 0.2]) / z * 330 / 1.6 + [165, 124]
        assert places.mean(axis=1) == pytest.approx(middle, abs=2)
        assert np.ptp(places, axis=1) == pytest.approx(2 * 0.16 / z * 330 / 1.6, abs=2.5)
        u, v, w = eye @ [x, 0.2, z, 1]
        there = 430 * np.array([u, v]) / w + [234.5, 179.5]
        assert grip_of(drawing, "ball").at == pytest.approx(there, abs=0.1)
        assert model.dragged("ball", tuple(there), x=x)["z"] == pytest.approx(z)


def test_a_vector_is_turned_about_n_on_the_circle_of_its_part_across(monkeypatch):
    draw, arrows = Panel.arrows, []

    def kept(panel, start, way, colour, width):
        arrows.append((colour, width, *np.array(start, float), *np.array(way, float)))
        draw(panel, start, way, colour, width)

    monkeypatch.setattr(Panel, "arrows", kept)
    n, w, sheet = np.array([0.0, 0, 1]), np.array([3.0, 0, 2]), rodrigues._SHEET
    q = np.cross(n, w)
    for theta in (-120, -35, 50, 165):
        arrows.clear()
        drawing = MODELS["rodrigues"].drawing(theta=theta)
        turned = Rotation.from_rotvec(np.radians(theta) * n).apply(w)
        assert np.allclose(numbers(drawing.sentence)[-3:], turned, atol=0.0051)
        assert np.allclose(grip_of(drawing, "tip from above").at, turned[:2], atol=1e-6)
        assert np.allclose(grip_of(drawing, "tip in space").at, sheet @ turned, atol=1e-6)
        # Both pictures have p, n × w and the turned vector as arrows; the part along n stays.
        for colour_, width, start, way in (
            (IDEAL, 2, sheet @ n * 2, sheet @ [3, 0, 0]),
            (LENS, 2, sheet @ n * 2, sheet @ q),
            (ESTIMATED, 3, [0, 0], sheet @ turned),
            (WORLD, 4, [0, 0], sheet @ n * 2),
            (LENS, 1.5, [0, 0], q[:2]),
            (ESTIMATED, 3, [0, 0], turned[:2]),
        ):
            wanted = np.array([width, *start, *way])
            assert any(c == colour_ and np.allclose(r, wanted, atol=1e-6) for c, *r in arrows)
        # The steps to the tip: cos θ p in black, then sin θ (n × w) in blue, thick.
        grip = grip_of(drawing, "tip from above")
        for step, ink in (((turned[0] / 2, 0), IDEAL), ((turned[0], turned[1] / 2), LENS)):
            at = (np.array(step) - grip.at) / grip.unit + grip.place
            u, v = np.rint(at).astype(int)
            assert count(drawing.picture[v - 3 : v + 4, u - 3 : u + 4], ink) > 10
    # Seen against n a turn goes anticlockwise, on the page, in both pictures.
    assert np.linalg.det(np.column_stack([sheet @ [3, 0, 0], sheet @ q])) < 0 > grip.unit[1]


def test_at_the_end_of_the_way_the_box_is_one_line_on_the_plane():
    values = MODELS["formation"].values(way=2)
    camera, (X, Y, Z) = formation.camera_of(values), formation._CORNER
    corners = np.array([*itertools.product((0, X), (Y, 0), (Z, formation._BACK))])
    M = corners @ camera.R.T + camera.G[:3, 3]
    low, high = formation._FRAME[0]
    first, last = ((M[:, 0] / M[:, 2] * formation._PLANE - low) / (high - low) * 400)[
        (M[:, 0] / M[:, 2]).argsort()[[0, -1]]
    ]
    left = 400 + 6 + MARGIN
    strip = MODELS["formation"].picture(way=2)[TITLE : TITLE + 300, left : left + 400].astype(int)
    rows = (np.abs(strip - colour(WORLD)).max(-1) < 40)[110:]  # the box itself is above
    assert rows.any(axis=0).nonzero()[0][[0, -1]] == pytest.approx([first, last], abs=12)
    middle = rows[:, round((first + last) / 2) - 4]
    assert 3 <= np.ptp(middle.nonzero()[0]) + 1 == middle.sum()  # nothing is drawn through it


def test_words_on_the_wall_keep_clear_of_corner_3_and_of_the_chart(written):
    for pulled, side in ((60, 1), (110, -1)):
        MODELS["homography"].drawing(du1=pulled, dv1=pulled)
        m = np.array([[343.0 + pulled, 44 + pulled], [522, 13], [508, 462], [342, 381]])
        line = np.linalg.inv(dlt([[0, 0], [420, 0], [420, 594], [0, 594]], m))[2]
        foot = -(480 * line[1] + line[2]) / line[0]  # where it leaves the picture
        assert written["the wall's horizon"][1][0] == pytest.approx(foot + 8 * side, abs=1)
    MODELS["homography"].drawing(du1=80, dv1=80, u=259, v=285)
    assert written["X = 20515 mm"][1][1] > 594  # below the frame of the chart


def test_the_singular_vectors_and_the_half_axes_have_their_right_angle_marked():
    drawing = MODELS["ellipse"].drawing(angle=0)  # h and D h lie elsewhere
    D = np.array([[1.6, 0.9], [0.5, 1.1]])
    v = np.linalg.svd(D)[2]
    v = v * np.where(v[:, 1:] < 0, -1, 1)
    second = MARGIN + 325 + 2 * MARGIN  # where the second panel begins
    for middle, ends in ((MARGIN + 130, v), (second + 195, v @ D.T)):
        one, other = ends / np.linalg.norm(ends, axis=1, keepdims=True)
        assert abs(one @ other) < 1e-9
        for side in (one + 0.5 * other, 0.5 * one + other):
            x, y = np.rint(0.13 * side * [100, -100] + [middle, TITLE + 144]).astype(int)
            assert count(drawing.picture[y - 1 : y + 2, x - 1 : x + 2], MUTED, 90) > 0


def test_circle_and_ellipse_have_one_scale_and_the_rows_lie_at_right_angles_to_v2(written):
    apart, along = {"r₁": [1.6, 0.9], "r₂": [0.5, 1.1]}, {"r₁, r₂": [1.6, 0.8], "": [0.8, 0.4]}
    for parallel, rows in ((0, apart), (1, along)):
        written.clear()
        drawing = MODELS["ellipse"].drawing(parallel=parallel)
        assert [name for name in written if "r" in name or not name] == list(rows)
        for name, row in rows.items():
            end, word = np.array(row), written[name][1] * [1, -1]
            assert np.linalg.norm(word - end) < 0.2
            # The dashes run to the row's end: half way some of them are seen.
            at = np.outer(np.linspace(0.4, 0.95, 40), end * [100, -100]) + [
                MARGIN + 130,
                TITLE + 144,
            ]
            u, v = np.rint(at).astype(int).T
            assert (np.abs(drawing.picture[v, u].astype(int) - colour(MUTED)).max(-1) < 60).any()
        assert written["v₁"][0].pixel == pytest.approx(written["D v₁"][0].pixel)


def test_what_is_not_there_is_said_where_one_looks_for_it(written):
    for name, values, words in (
        ("folds", {"k1": 0, "turned": 0.4}, "farther out"),
        ("folds", {"k1": -0.25, "turned": 0}, "no camera"),
    ):
        MODELS[name].drawing()
        assert words not in written
        MODELS[name].drawing(**values)
        assert words in written
        written.clear()


def test_three_times_the_focal_length_is_three_times_the_blackboard_and_no_third_of_the_angle():
    shown = MODELS["zoom"].drawing
    for alpha in (300, 520, 1200, 1500):
        angle, width = 2 * np.degrees(np.arctan(320 / alpha)), 1400 * alpha / 9950
        first = 2 * np.degrees(np.arctan(320 / 400))
        ratios = [400, alpha / 400, alpha / 400, first / angle]
        drawing = shown(alpha=alpha)
        said = numbers(drawing.sentence)
        np.testing.assert_allclose(said[:3], [alpha, angle, width], atol=0.5)
        np.testing.assert_allclose(said[3:], ratios, atol=0.006)
        # In the plan a px of the sensor is 5 mm: the room from -1.1 to 10 m is 516 px wide.
        scale, eye = 516 / 11_100, (MARGIN + 1100 * 516 / 11_100, TITLE + 279 / 2)
        plan = drawing.picture[:, :516].astype(int)
        sensor = np.argwhere(np.abs(plan - colour(LENS)).max(-1) < 30)
        (top, left), (bottom, right) = sensor.min(axis=0), sensor.max(axis=0)
        assert abs((left + right) / 2 - eye[0] - 5 * alpha * scale) < 1.5
        assert abs(bottom - top - 640 * 5 * scale) < 2
        # The sides of the angle go on through both ends, and what they enclose is tinted.
        z, x = 0.6 * 5 * alpha, 0.6 * 5 * 320
        for part, tinted in ((0.85, True), (1.25, False)):
            u, v = round(eye[0] + z * scale), round(eye[1] - part * x * scale)
            assert (plan[v, u, 0] < 250) == tinted, alpha
    taken = MODELS["zoom"].drawing(alpha=1000).picture[TITLE + 40 : TITLE + 270, 530:880]
    expected, other = (
        render_scene(room(), zoom.camera_at(alpha, (372, 279)), samples=4)[40:270]
        for alpha in (1000, 950)
    )
    first = 530 - (516 + 6 + MARGIN)
    off = [np.abs(taken - e[:, first : first + 350].astype(int)).mean() for e in (expected, other)]
    assert off[0] < 2 < 0.4 * off[1]


def test_a_sensor_pushed_sideways_moves_the_picture_and_one_number_of_a():
    for alpha, u0 in ((300, 239.5), (400, 399.5), (1200, 359.5)):
        drawing = MODELS["zoom"].drawing(alpha=alpha, u0=u0)
        left, right = (np.degrees(np.arctan(x / alpha)) for x in (u0 + 0.5, 639.5 - u0))
        assert numbers(drawing.sentence)[1] == pytest.approx(left + right, abs=0.06)
        told = re.findall(r"<td[^>]*>([^<]*)</td>", drawing.matrices)
        assert told == [f"{alpha}", "0", f"{u0}", "0", f"{alpha}", "239.5", "0", "0", "1"]
        sensor = grip_of(drawing, "sensor").at  # x runs down the plan, 5 mm for a pixel
        assert sensor == pytest.approx((5 * alpha, 5 * (319.5 - u0)))
        assert MODELS["zoom"].dragged("sensor", sensor) == {"alpha": alpha, "u0": u0}
        first = 530 - (516 + 6 + MARGIN)
        taken = drawing.picture[TITLE + 60 : TITLE + 270, 530:880].astype(int)
        expected, middle = (
            render_scene(room(), zoom.camera_at(alpha, (372, 279), at), samples=4)[60:270]
            for at in (u0, 319.5)
        )
        at = slice(first, first + 350)
        off = [np.abs(taken - other[:, at].astype(int)).mean() for other in (expected, middle)]
        assert off[0] < 3 < 0.4 * off[1]
    # The sensor is pushed to the right, downwards in the plan: the axis meets it farther left.
    pulled = MODELS["zoom"].dragged("sensor", (2000, 300))
    assert pulled == {"alpha": 400, "u0": 259.5}


def test_the_pixel_of_the_followed_corner_is_written_beside_the_box(written):
    for values in ({}, {"alpha": 1000}, {"turn": -20}):
        MODELS["formation"].drawing(**values)
        panel, at = next((p, at) for w, (p, at) in written.items() if p.x == (-0.5, 639.5))
        sheet, (u, v) = np.asarray(panel._image), np.rint(panel.place(at)).astype(int)
        around = sheet[v - 14 : v + 15, u - 90 : u + 91]
        green = (around[..., 1] > around[..., 0].astype(int) + 60).mean()
        assert green < 0.02
        written.clear()


def test_both_walks_are_as_long_and_a_turn_on_the_spot_leaves_one_of_them_alone():
    shown = MODELS["walks"].drawing
    for turn in (-60, -32, 0, 45):
        C_x, C_z, T_x, T_z, _ = numbers(shown(turn=turn).sentence)
        assert (C_x, C_z) == (300, -400)
        assert np.hypot(T_x, T_z) == pytest.approx(np.hypot(C_x, C_z), abs=1)
        # As the library has it, in space: right by `turn` about the y axis, which points down.
        R = rotation_from_vector([0, -np.radians(turn), 0])
        camera = Camera(intrinsics(500, 500, 250, 190), pose(R, -R @ [300, 0, -400]))
        assert np.abs(camera.T[[0, 2]] - [T_x, T_z]).max() < 0.51
        ahead = camera.centre + camera.R.T @ [0, 0, 100]
        grip = np.array(grip_of(shown(turn=turn), "line of sight").at) - [300, -400]
        assert np.allclose(grip / 150, (ahead - camera.centre)[[0, 2]] / 100, atol=1e-3)


@pytest.mark.parametrize("turn", [-150, -37, 0, 90])
def test_the_shadows_of_a_cameras_axes_on_the_worlds_are_the_rows_of_R(turn, written, monkeypatch):
    thick, line = [], Panel.line
    monkeypatch.setattr(
        Panel, "line", lambda *told, **how: (thick.append(told[1:]), line(*told, **how))
    )
    drawing = MODELS["rows"].drawing(turn=turn)
    # As the library has it, in space: right by `turn` about the y axis, which points down.
    R = rotation_from_vector([0, -np.radians(turn), 0])[np.ix_([0, 2], [0, 2])]
    shadows = [np.diff(ends, axis=0)[0] for ends, _, *width in thick if width == [7]]
    assert np.allclose(np.reshape(shadows, (2, 2, 2)), R[:, :, None] * np.eye(2))
    assert np.allclose(numbers(drawing.sentence)[1:], R.ravel(), atol=0.006)
    grip = grip_of(drawing, "line of sight")
    assert np.allclose((np.array(grip.at) - [2.3, 2]) / 1.75, R[1])
    assert {"x", "z", "X", "Z"} <= set(written)


def test_the_followed_corner_is_where_each_step_puts_it_and_the_box_where_a_camera_sees_it():
    values = {"X": 200, "Z": -320, "turn": -20, "alpha": 700}
    drawing = MODELS["formation"].drawing(**values)
    # Turned by 20° to the left about the vertical, then nodding down as much (Y points down).
    turn = rotation_from_vector([0, np.radians(20), 0])
    R = rotation_from_vector([np.radians(20), 0, 0]) @ turn
    assert R[2, 1] > 0  # the axis points down
    x, y, z = M = R @ (np.array([200, -125, 0]) - [200, -255, -320])
    xy = np.array([x, y]) / z
    m = xy * [700, 1.005 * 700] + [325, 238]
    said = numbers(drawing.sentence)
    expected = [200, -125, 0, *M, *xy, *m]
    assert said == pytest.approx(expected, abs=0.5)
    assert said[-2:] == pytest.approx(m, abs=0.051)
    assert said[6:8] == pytest.approx(xy, abs=0.00051)
    # The last panel, beside the third, against a photograph of the same box.
    photo = render_scene(
        box((0, 200), (-125, 0), (0, 80), (0, 1, 0)),
        Camera(
            intrinsics(700, 1.005 * 700, 325, 238),
            pose(R, -R @ [200, -255, -320]),
            size=(640, 480),
        ),
    ).astype(int)
    seen = np.asarray(Image.fromarray((photo[..., 1] - photo[..., 0]) > 60).resize((400, 300)))
    top, left = 300 + TITLE + 6 + TITLE, 400 + 6 + MARGIN
    panel = drawing.picture[top : top + 300, left : left + 400].astype(int)
    green = panel[..., 1] - panel[..., 0] > 60
    assert (green & seen).sum() > 0.93 * (green | seen).sum() > 1000  # cross and words lie on it


def test_whoever_moved_the_picture_stays_and_both_motions_are_those_of_the_poses():
    poses = course.poses()
    for photo, who in ((6, 0), (3, 40), (11, 100), (4.5, 70)):
        board_far, board_turn, far, turn = numbers(
            MODELS["moved"]
            .drawing(photo=photo, who=who)
            .sentence.partition("since photograph 0")[2]
        )
        if who == 0:
            assert far == turn == 0 < min(board_far, board_turn)
        if photo == int(photo):
            relative = poses[0] @ np.linalg.inv(poses[photo])
            angle = np.degrees(Rotation.from_matrix(relative[:3, :3]).magnitude())
            whole = np.array([np.linalg.norm(relative[:3, 3]), angle])
            assert [far, turn] == pytest.approx(who / 100 * whole, abs=0.51)
        if who == 100:
            assert board_far == board_turn == 0
        G = between(photo)
        camera, of_board = stands(G, who / 100)
        assert np.allclose(np.linalg.inv(camera) @ of_board, G, atol=1e-9)
        if photo == int(photo):
            assert np.allclose(G, poses[photo], atol=1e-9)
    pictures = [MODELS["moved"].picture(photo=6, who=who) for who in (0, 50, 100)]
    assert (pictures[0][:, 449:] == np.array(pictures)[:, :, 449:]).all()
    # The floor stands still, whoever moves; boards, cameras and the shadow hide little of it.
    tiles = [picture[:, :446, 0].astype(int) - picture[:, :446, 2] > 14 for picture in pictures]
    assert np.logical_and.reduce(tiles).sum() > 0.85 * max(tile.sum() for tile in tiles) > 1000
    # With the wall in it the photograph does tell.
    walls = [MODELS["moved"].picture(photo=6, who=who, wall=1)[:, 449:] for who in (0, 50, 100)]
    assert min((walls[0] != other).any(axis=-1).mean() for other in walls[1:]) > 0.02


def test_another_camera_takes_the_same_picture_of_a_board_and_not_of_a_box():
    """The other camera is sought without circles: an angle, and what makes all corners agree."""
    W, first = course.board().points, twins.one()
    square = 25 * np.array([[0, 1], [2, 1], [2, 2], [0, 2.0]])
    for alpha, height in ((300, 60), (960, 80), (1000, 0)):

        def camera(x, alpha=alpha):
            A = np.array([[alpha, 0, x[0]], [0, alpha, x[1]], [0, 0, 1]])
            return Camera(A, pose(rotation_from_vector(x[2:5]), x[5:]))

        other = twins.other(alpha)
        assert other.size == first.size
        start = np.concatenate(
            [[319.5, 239.5], vector_from_rotation(first.R), first.T * alpha / 600]
        )
        found = least_squares(
            lambda x, camera=camera: (camera(x).project(W) - first.project(W)).ravel(),
            start, x_scale="jac", xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=2000,
        )  # fmt: skip
        assert np.abs(found.fun).max() < 1e-6
        assert np.allclose(camera(found.x).centre, other.centre, atol=1e-3)
        assert np.abs(other.project(W) - first.project(W)).max() < 1e-9
        drawing = MODELS["twins"].drawing(alpha=alpha, height=height)
        top = np.column_stack([square, np.full(4, -height)])
        off = np.linalg.norm(camera(found.x).project(top) - first.project(top), axis=1).max()
        apart = np.linalg.norm(camera(found.x).centre - first.centre)
        said = numbers(drawing.sentence)
        assert np.allclose(
            said, [alpha, *found.x[:2], apart, *([height, off] * (height > 0))], atol=0.51
        )
    # Whoever takes it: the board in the picture stays; the orange box, alone, moves.
    still, pulled = (MODELS["twins"].picture(alpha=alpha, height=80) for alpha in (1000, 300))
    changed = (still != pulled).any(axis=-1)[:, 449:]
    assert 0.001 < changed.mean() < 0.02
    assert count(still[:, 449:], ESTIMATED) > 200
    top = first.project([[*(0.3 * square[0] + 0.7 * square[2]), -80]])[0]
    u, v = np.rint([449 + top[0] * 400 / 640, TITLE + top[1] * 300 / 480]).astype(int)
    assert np.abs(still[v, u] - colour("#C4E0F6")).max() < 12  # of the box one sees the top
    assert count(still[:, :440], "#8DBFE8", 12) > 100  # the box in space: blue, as in the picture
    flat = [MODELS["twins"].picture(alpha=alpha, height=0)[:, 449:] for alpha in (1000, 300)]
    assert np.abs(flat[0].astype(int) - flat[1]).max() < 30


@pytest.mark.parametrize(("k1", "side"), [(-0.2, 1), (0.2, -1)])
def test_the_edge_is_named_on_the_side_to_which_it_bows_off_the_ruler(k1, side, written):
    MODELS["lens"].drawing(k1=k1, k2=0)
    (_, edge), (_, ruler) = written["edge"], written["ruler"]
    assert edge[0] == pytest.approx(ruler[0], abs=1e-9)
    assert 0.02 < side * (edge[1] - ruler[1]) < 0.2


def test_a_question_mark_stands_where_an_ideal_lens_shows_the_point_of_the_guess(monkeypatch):
    put, write = [], Panel.text
    monkeypatch.setattr(Panel, "text", lambda *how, **so: (put.append(how), write(*how, **so)))
    MODELS["lens"].drawing(k1=-0.2)
    in_the_room, at_the_arrow = [how[1] for how in put if how[2] == "?"]
    assert np.allclose(in_the_room, [0.8, 0], atol=0.04)
    assert np.allclose(at_the_arrow, [0.8, 0.72], atol=0.04)  # from 0.8 to 0.8 L(0.8) = 0.67


def test_the_end_of_the_edge_goes_along_its_ray_and_the_arrows_to_where_the_lens_shows(monkeypatch):
    arrows, draw = [], Panel.arrows

    def kept(panel, starts, ways, colour, width):
        arrows.append((np.atleast_2d(starts), np.atleast_2d(ways)))
        draw(panel, starts, ways, colour, width)

    monkeypatch.setattr(Panel, "arrows", kept)
    model, end = MODELS["lens"], np.array([2500, 1600]) / 3500
    assert model.dragged("edge", tuple(0.9 * end), k2=0)["k1"] == round(-0.1 / (end @ end), 2)
    drawing = model.drawing(k1=-0.2, k2=0.1)
    r2 = end @ end
    assert grip_of(drawing, "edge").at == pytest.approx(
        end * (1 - 0.2 * r2 + 0.1 * r2**2), abs=1e-5
    )
    on_the_curve = np.hypot(*end), np.hypot(*grip_of(drawing, "edge").at)  # the same point
    assert grip_of(drawing, "curve").at == pytest.approx(on_the_curve, abs=1e-5)
    low, high = (model.dragged("curve", (0, y), k2=0)["k1"] for y in (0.6, 0.7))
    assert high - low == pytest.approx(0.1 / np.hypot(*end) ** 3, abs=0.011)
    starts, ways = arrows[0]
    r2 = (starts**2).sum(axis=1, keepdims=True)
    assert len(starts) > 12
    assert np.allclose(ways, starts * (-0.2 * r2 + 0.1 * r2**2))


@pytest.mark.parametrize(("k1", "word"), [(-0.25, "nearer"), (0.1, "farther out")])
def test_how_far_the_lens_moves_the_end_of_the_edge_is_told_in_pixels(k1, word):
    camera = Camera(intrinsics(400, 400, 319.5, 239.5))
    drawing = explorations.model("lens", camera).drawing(k1=k1, k2=0.05)
    ideal = 400 * np.hypot(2500, 1600) / 3500
    r2 = (ideal / 400) ** 2
    told = numbers(drawing.sentence.split("this one")[0])[-1]
    moved = numbers(drawing.sentence.split("this one")[1])[0]
    assert told == round(ideal)
    assert moved == round(ideal * abs(k1 * r2 + 0.05 * r2**2), 1)
    assert f"px {word}. " in drawing.sentence


def test_on_its_way_the_box_turns_with_the_world_and_then_runs_along_its_rays():
    draw = MODELS["formation"].picture
    ways = {way: draw(way=way).astype(int) for way in (0, 1, 1.5, 2)}
    top, left = TITLE, 400 + 6 + MARGIN
    panels = {way: picture[top : top + 300, left : left + 400] for way, picture in ways.items()}
    # At the start it is the first panel, but for the axes and what is pulled.
    first = ways[0][top : top + 300, MARGIN : MARGIN + 400]
    green = [(panel[..., 1] - panel[..., 0] > 120).nonzero() for panel in (first, panels[0])]
    assert np.allclose(*(np.median(each, axis=1) for each in green), atol=1)
    # The camera of the start, by hand: turned by 30° to the left, then down by 20°.
    turn = rotation_from_vector([0, np.radians(30), 0])
    R = rotation_from_vector([np.radians(20), 0, 0]) @ turn
    x, _, z = R @ (np.array([200, -125, 0]) - [340, -255, -420])
    for way, (at_x, at_z) in {
        1: (x, z),
        1.5: np.array([x, z]) * (1 + 250 / z) / 2,
        2: (250 * x / z, 250),
    }.items():
        u, v = (at_x + 608) / 1216 * 400, (760 - at_z) / 912 * 300
        cross = panels[way][round(v) - 4 : round(v) + 5, round(u) - 4 : round(u) + 5]
        assert (cross[..., 0] - cross[..., 2] > 100).sum() > 25


def test_what_is_still_to_come_is_pale_and_the_sentence_ends_where_the_steps_do():
    full = MODELS["formation"].drawing()
    rows = slice(2 * TITLE + 300 + 6, 2 * TITLE + 600 + 6)  # of the plane z = 1 and the picture
    for way, inks, told in (
        (0, (0.15, 0.15), 3), (1, (0.15, 0.15), 6), (2, (1, 0.15), 8), (2.5, (1, 0.575), 8)
    ):  # fmt: skip
        drawing = MODELS["formation"].drawing(way=way)
        ink = [255 - picture[rows].astype(float) for picture in (drawing.picture, full.picture)]
        for part, side in zip(inks, (slice(10, 150), slice(420, 560)), strict=True):
            pale, whole = (each[:, side].mean() for each in ink)
            assert pale / whole == pytest.approx(part, abs=0.06)
        assert full.sentence.startswith(drawing.sentence[:-1])
        assert len(numbers(drawing.sentence)) == told


@pytest.mark.parametrize(
    "values",
    [
        {"X": 200, "Z": -120, "turn": 60, "alpha": 600},  # partly behind the camera
        {"X": 200, "Z": -250, "turn": -25, "alpha": 600},
    ],
)
def test_a_box_of_which_a_corner_has_no_image_is_drawn_as_far_as_it_is_seen(values, monkeypatch):
    monkeypatch.setattr(formation, "_CORNER", np.array([400.0, -125, 0]))  # a longer one
    turn = np.radians(values["turn"])
    R = rotation_from_vector([np.radians(20), 0, 0]) @ rotation_from_vector([0, -turn, 0])
    A, centre = intrinsics(600, 603, 325, 238), [values["X"], -255, values["Z"]]
    camera = Camera(A, pose(R, -R @ centre))
    photo = render_scene(box((0, 400), (-125, 0), (0, 80), (0, 1, 0)), camera).astype(int)
    seen = np.asarray(Image.fromarray(photo[..., 1] - photo[..., 0] > 30).resize((400, 300)))
    top, left = 300 + TITLE + 6 + TITLE, 400 + 6 + MARGIN
    panel = MODELS["formation"].picture(**values)[top : top + 300, left : left + 400].astype(int)
    green = panel[..., 1] - panel[..., 0] > 30
    assert (green & seen).sum() > 0.93 * (green | seen).sum() > 5000


def test_between_four_pixels_each_is_drawn_as_large_as_it_weighs():
    grey = np.array([60, 90, 110, 200])
    nearest = "110", "90", "60, or 90, or 110, or 200"  # in the middle all are equally near
    for (du, dv), near in zip(((0.35, 0.6), (0.8, 0.25), (0.5, 0.5)), nearest, strict=True):
        drawing = MODELS["between"].drawing(du=du, dv=dv)
        assert drawing.sentence.endswith(f"alone says {near}.")
        value = ndimage.map_coordinates(grey.reshape(2, 2).astype(float), [[dv], [du]], order=1)[0]
        assert numbers(drawing.sentence.partition("=")[2])[0] == pytest.approx(value, abs=0.051)
        # The square between the centres begins 0.36 of 1.72 from the border of its panel.
        low, high = round(400 * 0.36 / 1.72), round(400 * 1.36 / 1.72)
        square = drawing.picture[TITLE + low : TITLE + high, MARGIN + low : MARGIN + high, 0]
        weights = [(1 - du) * (1 - dv), du * (1 - dv), (1 - du) * dv, du * dv]
        # Lines, words and the pixels themselves cover some of it.
        seen = np.array([(square == g).mean() for g in grey])
        assert np.abs(seen / seen.sum() - weights).max() < 0.05


def test_the_values_on_both_edges_between_four_pixels_are_named_as_in_the_formula(monkeypatch):
    written, draw = {}, Panel.text

    def text(self, at, words, *rest, **how):
        written[words] = np.array(at, float)
        draw(self, at, words, *rest, **how)

    monkeypatch.setattr(Panel, "text", text)
    for du, dv, upper, lower in ((0.35, 0.6, 70.5, 141.5), (0.8, 0.25, 84.0, 182.0)):
        written.clear()
        MODELS["between"].drawing(du=du, dv=dv)
        above, below = written[f"upper {upper:.1f}"], written[f"lower {lower:.1f}"]
        assert above[0] == below[0] == du
        assert above[1] < 0 < 1 < below[1]


def test_shrunken_rings_are_those_of_the_library_blurred_or_not():
    x, y = pixel_centres((240, 240)).transpose(2, 0, 1) - 119.5
    old = 127.5 + 127.5 * np.cos(0.0036 * np.pi * (x**2 + y**2))
    for blur in (0, 0.5):
        drawing = MODELS["rings"].drawing(blur=blur, place=0)
        new = backward_warp(gaussian_blur(old, 3 * blur), zoom_map(3), size=(80, 80))
        left = MARGIN + 366
        shown = drawing.picture[TITLE : TITLE + 360, left : left + 360, 0].astype(float)
        at = np.rint(4.5 * (np.arange(80) + 0.5) - 0.5).astype(int)
        off = np.abs(shown[np.ix_(at, at)] - new)[10:-10, 10:-10]
        assert np.quantile(off, 0.9) < 5  # every eighth grey level is drawn; and a frame
    drawing = MODELS["rings"].drawing(place=30)  # the handle covers no ring that is true
    u, v = grip_of(drawing, "place").at
    assert (u, v) == (149.5, pytest.approx(229.5))
    assert drawing.picture[TITLE + 270, MARGIN + 225].tolist() == [213, 94, 0]  # on its stick
    far = numbers(MODELS["rings"].drawing(place=92).sentence)
    assert far[:2] == [0.99, 0.01]  # rings: once around, from one new pixel to the next


def test_the_epipolar_plane_cuts_the_second_picture_in_its_line():
    first, second = plane.cameras()
    epipole, shown = second.project(first.centre), MODELS["plane"].drawing
    for u, v in ((190, 150), (120, 55), (260, 200)):
        line = plane.epipolar_line(u, v) / np.linalg.norm(plane.epipolar_line(u, v)[:2])
        assert abs(line @ [*epipole, 1]) < 1e-6
        for depth in (1500, 6000):
            point = plane.on_the_ray(u, v, depth)
            assert np.allclose(first.project(point), [u, v])
            assert abs(line @ [*second.project(point), 1]) < 1e-6
        said = numbers(shown(u=u, v=v, depth=3500).sentence)
        partner = second.project(plane.on_the_ray(u, v, 3500))
        assert np.allclose(said[1:3], partner, atol=0.51)
        u2, v2 = partner * 276 / 320
        below = shown(u=u, v=v, depth=3500).picture[2 * TITLE + 207 + 6 :, MARGIN : MARGIN + 276]
        assert count(below[round(v2) - 6 :][:12, round(u2) - 6 :][:, :12], ESTIMATED) > 10


def test_the_normal_is_T_cross_d_and_the_strip_is_the_second_picture_along_the_line(monkeypatch):
    arrows, images, arrow, image = [], [], Panel.arrows, Panel.image
    monkeypatch.setattr(Panel, "arrows", lambda *how: (arrows.append(how), arrow(*how)))
    monkeypatch.setattr(
        Panel, "image", lambda *how, **more: (images.append(how[1]), image(*how, **more))
    )
    MODELS["plane"].drawing()
    first, second = (camera.centre for camera in plane.cameras())
    point, seen = plane.on_the_ray(190, 150, 3500.0), plane.onlooker().project
    n = np.cross(first - second, point - first)
    rim, within = arrows[-2:]  # black, and orange on it
    assert np.allclose(rim[1], seen(first))
    assert np.allclose(rim[2], seen(first + 210 * n / np.linalg.norm(n)) - seen(first))
    assert np.allclose(within[2], 0.9 * rim[2])
    T = arrows[0]  # from the second centre to the first
    assert np.allclose([T[1], T[1] + T[2]], [seen(second), seen(first)])
    MODELS["epipolar"].drawing(u=320, v=420)  # a tile
    (strip,) = (each for each in images if each.shape[:2] == (22, 205))
    nearness = np.linspace(0.52, 0.02, 205)[::8]  # 1/m, and even along the strip
    u, v = np.rint(seen_by_the_second(np.array([320.0, 420]), 1000 / nearness)).astype(int).T
    off = np.abs(strip[10:12, ::8].mean(axis=0) - epipolar.photographs()[1][v, u]).max(axis=1)
    assert np.mean(off < 25) > 0.8, off


def test_the_partner_lies_on_the_epipolar_line_and_agrees_where_its_depth_is_right():
    first, second = cameras()
    for W in ([1900, -500, 7600], [-500, 1600, 6000], [400, -800, 9990]):
        m, partner = first.project(W), second.project(W)
        line = seen_by_the_second(m, np.linspace(2000, 20_000, 50))
        along = line[-1] - line[0]
        off = (partner - line[0]) @ [-along[1], along[0]] / np.linalg.norm(along)
        assert abs(off) < 1e-9
        assert np.allclose(seen_by_the_second(m, np.array([W[2]])), partner)
    shown = MODELS["epipolar"].drawing
    for (u, v), depth in {(449, 205): 7.6, (320, 400): 5.18, (389, 301): 7.4}.items():
        said = shown(u=u, v=v).sentence
        assert "agree best" in said
        assert numbers(said)[-1] == pytest.approx(depth, rel=0.03)
    assert "nothing here tells" in shown(u=250, v=230).sentence  # on the plain wall
    *_, nearest, farthest = numbers(shown(u=330, v=206).sentence)  # along the blackboard's edge
    assert nearest < 10 < farthest
    assert farthest > 1.2 * nearest
    assert re.search(r"as well from [\d.]+ m on", shown(u=240, v=215).sentence)  # not near by
    assert numbers(shown(u=449, v=205, depth=7600).sentence)[1] < 8
    # A valley of six grey levels is drawn on the scale of 80, and looks as shallow as it is.
    blue = np.argwhere(np.abs(shown(u=250, v=180).picture[-184:, -410:].astype(int)
                              - colour(LENS)).max(axis=-1) < 60)  # fmt: skip
    assert np.ptp(blue[:, 0]) < 184 / 1.2 * 6.5 / 80 + 6
    # The dashed line ends where the second camera sees the direction of the ray.
    x, y, w = second.A @ second.R @ np.linalg.inv(first.A) @ [449, 205, 1]
    u, v = (np.array([x, y]) / w + 0.5) * 392 / 640 + [MARGIN + 398, TITLE]
    part = shown().picture[round(v) - 5 : round(v) + 9]
    before, beyond = part[:, round(u) - 72 : round(u) - 36], part[:, round(u) + 36 : round(u) + 72]
    assert count(before, LENS, 95) > 15 > 5 * count(beyond, LENS, 95)


def test_the_half_circles_of_parallel_boards_are_one():
    shown = MODELS["folds"].drawing
    assert "they are one" in shown(k1=-0.25, turned=0).sentence
    assert "they meet" in shown(k1=-0.25, turned=1).sentence
    red, _, blue = np.array(
        [shown(k1=-0.25, turned=t).picture[:, :510] for t in (0, 0.2, 1)], dtype=int
    ).transpose(3, 0, 1, 2)
    blue = (blue - red > 30).sum(axis=(1, 2))  # pale where they are far
    assert 3 * blue[0] < blue[1] < 3 * blue[2]  # one curve, a fan, twelve


def test_what_lies_at_the_chosen_depth_has_no_fringe_and_all_else_has():
    left, right = pair()
    for W in ([-900, 0, 10_000], [2400, 600, 7600]):  # on the wall behind, on the cupboard
        seen = left.project(W) - right.project(W)
        assert np.allclose(seen, [520 * 400 / W[2], 0])
    (u, v), scale = left.project([900, -900, 9990]), 400 / 640  # the frame of the blackboard
    here = np.s_[
        TITLE + round(v * scale) : TITLE + round((v + 60) * scale),
        MARGIN + round((u - 60) * scale) : MARGIN + round((u + 10) * scale),
    ]

    def fringe(Z):
        picture = MODELS["depth"].drawing(depth=Z).picture[here].astype(int)
        return int((np.abs(picture[..., 0] - picture[..., 1]) > 40).sum())  # red or cyan

    assert fringe(10_000) < 10
    assert fringe(7450) > 60
    assert fringe(4000) > 180


def test_each_pixel_keeps_the_depth_whose_patches_agree_best_up_to_the_line():
    def patch(picture, u, v, d=0):  # 7 × 7 pixels of the halved picture
        part = picture[2 * v - 6 : 2 * v + 8, 2 * u - 6 - d : 2 * u + 8 - d]
        return (part[::2, ::2] + part[1::2, ::2] + part[::2, 1::2] + part[1::2, 1::2]) / 4

    rng = np.random.default_rng(5)
    pixels = np.stack([rng.integers(60, 310, 60), rng.integers(10, 230, 60)], axis=-1)
    for Z, dots in ((4000, True), (7500, False), (12_000, False)):
        found, kept = swept.depths_so_far(Z, dots), 0
        left, right = swept.photographs(dots)
        for u, v in pixels:
            own, tried = patch(left, u, v), np.arange(104, 208_000 / Z - 1e-9, -1).astype(int)
            apart = [np.abs(own - patch(right, u, v, d)).mean() for d in tried]
            beside = np.abs(own - patch(left, u + 1, v)).mean()
            there = u - (tried[np.argmin(apart)] + 1) // 2  # and what its partner finds
            asked = [(there + (d + 1) // 2, d) for d in tried]
            back = [
                np.abs(patch(left, c, v) - patch(right, c, v, d)).mean() if c < 317 else 255
                for c, d in asked
            ]
            again = abs(int(np.argmin(back)) - int(np.argmin(apart))) <= 1
            if min(apart) < beside and beside >= 2 and again:
                assert abs(208_000 / found[v, u] - tried[np.argmin(apart)]) < 0.501
                kept += 1
            else:
                assert np.isnan(found[v, u])
        assert 3 < kept < 60


def test_the_depths_that_pixels_keep_are_those_of_the_room_and_dots_lie_where_things_stand():
    drawing = MODELS["depth"].drawing
    found = swept.depths_so_far(12_000)
    v, u = np.mgrid[200:236:3, 100:220:3]  # on the floor, 1600 mm below the cameras
    floor = 1600 * 520 / (2 * v + 0.5 - 239.5)
    assert np.nanmedian(np.abs(found[v, u] - floor)) < 60
    camera, plan = pair()[0], np.array([MARGIN + 406, TITLE])
    for W in ([1900, 0, 7600], [700, 0, 9950], [-700, 0, 9950], [-1300, 830, 6400]):
        u, v = np.rint((camera.project(W) - 0.5) / 2).astype(int)
        assert abs(np.nanmedian(found[v - 4 : v + 5, u - 3 : u + 4]) / W[2] - 1) < 0.04

        # From above 8800 mm are 409 px, and 13,520 mm 628.
        x, y = np.rint(plan + [(W[0] + 4150) / 21.516, (12_900 - W[2]) / 21.529]).astype(int)
        near = [
            drawing(depth=Z).picture[y - 8 : y + 9, x - 8 : x + 9] for Z in (12_000, W[2] - 400)
        ]
        dots, before = ((np.ptp(part.astype(int), axis=-1) > 40).sum() for part in near)
        assert dots > 12 > 3 * before
    part = drawing(depth=12_000).picture[TITLE + 149 : TITLE + 181, plan[0] + 37 : plan[0] + 69]
    on_wall = np.nonzero(np.ptp(part.astype(int), axis=-1) > 40)[
        1
    ]  # the left one, 9.0 to 9.7 m away
    assert on_wall.size > 30
    assert np.median(on_wall) + 37 == pytest.approx((4150 - 3000) / 21.516, abs=4)
    said = numbers(drawing(depth=12_000).sentence)
    assert said[2] == pytest.approx(
        208_000 / (208 / 12 - 0.5) - 208_000 / (208 / 12 + 0.5), abs=0.5
    )
    depths = found[np.isfinite(found)]
    assert said[3:5] == [round(depths.size / 768), 100]


def test_the_plan_has_no_dots_of_floor_and_ceiling_however_wrong_their_depths(monkeypatch):
    v, u = np.mgrid[:240, :320]
    x, y = (u - 159.5) / 260, (v - 119.5) / 260  # of the room 3000 mm to a side and 1600 in height
    level = 1600 / np.abs(y) < np.minimum(10_000, 3000 / np.abs(x))
    floor, ceiling = level & (v > 180), level & (v < 120)  # in front of all things, and above them
    wall = np.s_[100:112, 122:134]

    def coloured():
        picture = MODELS["depth"].drawing(depth=12_000).picture
        part = picture[TITLE + 400 : TITLE + 440, MARGIN + 406 + 150 : MARGIN + 406 + 260]
        return int((np.ptp(part.astype(int), axis=-1) > 40).sum())  # 3.4 to 4.3 m away

    for here, dots in ((floor, False), (ceiling, False), (wall, True)):
        found = np.full((240, 320), np.nan)
        found[here] = 3850
        monkeypatch.setattr(swept, "depths_so_far", lambda *_, found=found: found)
        assert (coloured() > 12) == dots


def test_thrown_dots_lie_on_the_room_and_give_plain_walls_a_depth():
    wall = np.s_[100:112, 122:134]  # plain, left of the blackboard, 10 m away
    assert np.isnan(swept.depths_so_far(12_000)[wall]).mean() > 0.9
    assert np.nanmedian(swept.depths_so_far(12_000, True)[wall]) == pytest.approx(10_000, rel=0.01)
    without, thrown = (numbers(MODELS["depth"].drawing(dots=on).sentence)[3] for on in (0, 1))
    assert thrown > 3 * without
    # A dot on the back wall is seen 20.8 px farther left by the right camera, 400 mm aside.
    left, right = (swept.dots_on(camera) for camera in pair())
    there = np.s_[180:230, 240:320]
    assert np.corrcoef(left[there].ravel(), np.roll(right, 21, axis=1)[there].ravel())[0, 1] > 0.6
    assert abs(np.corrcoef(left[there].ravel(), right[there].ravel())[0, 1]) < 0.1


def test_stepping_back_and_zooming_keeps_the_box_and_enlarges_what_is_behind_it():
    shown = MODELS["dolly"].drawing
    for distance in (1500, 4000, 7000):
        alpha = 0.25 * distance
        angle = 2 * np.degrees(np.arctan(320 / alpha))
        box, board = 400 * alpha / distance, 1400 * alpha / (distance + 2500)
        expected = [distance / 1000, alpha, angle, box, board]
        np.testing.assert_allclose(numbers(shown(distance=distance).sentence), expected, atol=0.5)
    # The red front of the box is where its corners are seen: 0.25 px a millimetre, always.
    for distance in (1500, 7000):
        picture = shown(distance=distance).picture
        (u, v), scale = (319.5 + 0.25 * 100, 239.5 + 0.25 * 200), WIDTH / 640
        left, top = MARGIN + round((u + 0.5) * scale), TITLE + round((v + 0.5) * scale)
        side = round(100 * scale)
        front = picture[top + 3 : top + side - 3, left + 3 : left + side - 3].reshape(-1, 3)
        assert np.ptp(front[:, 1] / front[:, 0]) < 0.04  # one colour, dimmer at its foot
        assert np.abs(front[0].astype(int) - picture[top + side // 2, left + side + 4]).max() > 40


def test_explore_fold_turns_the_eye_to_where_it_is_pulled_and_two_photographs_say_which_is_it():
    for fold in range(30, 121, 15):
        drawing = MODELS["fold"].drawing(fold=fold)
        assert numbers(drawing.sentence)[-2:] == [90, 90]
        grip = grip_of(drawing, "eye")
        for by in ((0, 0), (3, -3)):  # px: a hand is not exact
            at = tuple(np.add(grip.at, np.multiply(grip.unit, by)))
            assert abs(MODELS["fold"].dragged("eye", at, fold=50)["fold"] - fold) <= 2
    explorer = explorations.explore("fold", second=1)
    for fold, said in ((59.15, "this is the camera"), (50, "this is not the camera")):
        explorer.sliders["fold"].value = fold
        assert said in explorer.sentence.value
    explorer.close_all()


@pytest.mark.parametrize("noise", [0.2, 0.8])
def test_clicks_scatter_as_the_derivatives_of_the_librarys_answer_say(noise):
    """First order: each of the 36 numbers that are clicked moves the answer by its derivative."""
    camera = Camera(course.camera().A, look_at([1200, -8000, 2000], [700, -1000, 12800]))
    W, stretch = blocks().vertices[:8], np.array([1, 800 / 804])
    ways = ((0, 1, 4, 5, 2, 3), (0, 2, 1, 3, 5, 7), (0, 4, 1, 5, 3, 7))
    ends = np.array([camera.project(W[list(way)]) for way in ways]).reshape(3, 3, 2, 2)

    def answer(clicked):
        v = [vanishing_point(family) for family in clicked.reshape(ends.shape) * stretch]
        v = from_homogeneous(np.array(v))
        A = intrinsics_from_vanishing_points(v)
        return np.concatenate([(v / stretch).ravel(), A[:2, 2] / stretch, [A[0, 0]]])

    J = np.array([answer(ends.ravel() + e) - answer(ends.ravel() - e) for e in np.eye(36) / 10])
    covariance = noise**2 * (5 * J.T) @ (5 * J)
    v, c, f = clicks.found(noise)
    seen = np.cov(np.column_stack([v.reshape(-1, 6), c, f]).T)
    assert np.sqrt(np.diag(seen) / np.diag(covariance)) == pytest.approx(1, abs=0.2)
    for i in (0, 2, 4):  # and the clouds of X, Y and Z point the same way
        a, b = (np.linalg.eigh(one[i : i + 2, i : i + 2])[1][:, 1] for one in (seen, covariance))
        assert abs(a @ b) > 0.999
    radius = grip_of(MODELS["clicks"].drawing(noise=noise), "circle").at[0] - 325
    assert radius == pytest.approx(np.sqrt(np.diag(covariance)[6:8].mean()), rel=0.12)
    said = numbers(MODELS["clicks"].drawing(noise=noise).sentence)
    assert said == pytest.approx([noise, radius, np.std(f)], abs=0.051)


def test_a_block_hides_the_lines_of_the_rod_behind_it_and_no_others(monkeypatch):
    """Walk from the camera to each place of a line: does the way lead through a block?"""
    drawn, line = [], Panel.line

    def kept(panel, xy, colour, width=1.5, dash=0, rim=0):
        drawn.append((np.array(xy), width, dash))
        line(panel, xy, colour, width, dash, rim)

    monkeypatch.setattr(Panel, "line", kept)
    camera = Camera(course.camera().A, look_at([12500, -1200, -2500], [1200, -2300, 12500]))
    corners = blocks().vertices[:24].reshape(3, 8, 3)
    MODELS["rod"].drawing()
    ways = [xy for xy, width, dash in drawn if width == 1 and len(xy) > 60 and dash in (0, 3)]
    for seen, hidden, y in zip(ways[::2], ways[1::2], (-400, 1600), strict=True):
        dashed = np.isfinite(hidden[:, 0])
        m = np.where(dashed[:, None], hidden, seen[:-1])
        assert (dashed & np.isfinite(seen[:-1, 0])).any()  # line and dashes meet
        rays = np.linalg.solve(camera.A, to_homogeneous(m).T).T @ camera.R
        rays *= ((y - camera.centre[1]) / rays[:, 1])[:, None]
        places = camera.centre + np.linspace(0, 0.995, 800)[:, None, None] * rays
        inside = np.zeros(len(m), bool)
        for block in corners:
            sides = (block[[1, 2, 4]] - block[0]).T
            part = np.linalg.solve(sides, (places - block[0])[..., None])[..., 0]
            inside |= ((part > 0) & (part < 1)).all(-1).any(0)
        assert 10 < inside.sum() < 100
        assert (inside != dashed).sum() <= 6  # at the edges of blocks


def test_three_vanishing_points_of_a_box_are_those_of_the_camera_that_took_it():
    assert [*camera_of(np.array([[0.0, 0], [4, 0], [1, 3]]))[0]] == pytest.approx([1, 1])
    said = numbers(MODELS["triangle"].drawing().sentence)
    assert said[1:] == [325, 238, 800]
    # Another camera, turned at random: its axes vanish in a triangle that is always acute.
    rng = np.random.default_rng(4)
    for R in rotation_from_vector(rng.uniform(-3, 3, (20, 3))):
        v = 600 * R[:2].T / R[2, :, None] + [300, 200]
        c, square = camera_of(v)
        assert np.allclose([*c, square], [300, 200, 600**2], rtol=1e-6)


def test_the_focal_length_vanishes_where_the_triangle_of_vanishing_points_becomes_obtuse():
    flat = {"X_u": -400, "X_v": 0, "Z_u": 600, "Z_v": 0, "Y_u": 0}
    foot = 400 * 600  # the square of the height at which the angle at Y is right, by Thales
    for height in (489, 490):
        drawing = MODELS["triangle"].drawing(Y_v=height, **flat)
        obtuse = height**2 < foot
        assert ("No camera sees a box so" in drawing.sentence) == obtuse
    assert "f = 10 px" in MODELS["triangle"].drawing(Y_v=490, **flat).sentence
    right = {"X_u": -300, "X_v": 0, "Z_u": 300, "Z_v": 0, "Y_u": 0, "Y_v": 300}
    assert MODELS["triangle"].drawing(**right).sentence.endswith("f = 0.")
    on_a_line = MODELS["triangle"].drawing(**{**right, "Y_v": 0})
    assert "no triangle" in on_a_line.sentence
    assert {grip.name for grip in on_a_line.grips} == {
        *"XYZ",
        "turn",
    }  # and can be pulled apart again


def test_beyond_an_obtuse_triangle_the_half_circle_ends_before_c_and_no_rods_are_drawn(monkeypatch):
    arcs, rods = [], []
    line, segments = Panel.line, Panel.segments

    def a_line(panel, xy, *rest, **how):
        arcs.extend([1] * (len(xy) == 61))
        line(panel, xy, *rest, **how)

    def some(panel, ends, colour, *rest, **how):
        rods.extend([1] * (colour == CAMERA))
        segments(panel, ends, colour, *rest, **how)

    monkeypatch.setattr(Panel, "line", a_line)
    monkeypatch.setattr(Panel, "segments", some)
    for height, eyes in ((700, 1), (400, 0)):
        for turn, halves in ((40, 0), (60, 1), (-80, 1)):  # the half circle is seen from aside
            arcs.clear()
            rods.clear()
            MODELS["triangle"].drawing(Y_v=height, turn=turn)
            assert (len(arcs), len(rods)) == (halves, eyes)


def test_in_space_the_eye_stands_where_the_camera_stood_before_its_picture(monkeypatch):
    marks, texts = {}, []
    monkeypatch.setattr(Panel, "mark", lambda _, xy, kind, *_a, **_k: marks.update({kind: xy}))
    monkeypatch.setattr(Panel, "text", lambda _, _xy, words, *_a, **_k: texts.append(words))
    R = look_at([3, -4, -5], [0, 0, 0])[:3, :3]
    f, centre = 560, np.array([200, 330])
    v = f * R[:2].T / R[2, :, None] + centre  # the axes of the world vanish there
    corners = {
        f"{name}_{axis}": v[i, j] for i, name in enumerate("XYZ") for j, axis in enumerate("uv")
    }
    places = np.column_stack([np.vstack([v, centre]), [0, 0, 0, f]])
    for turn in (-40, 0, 25, 90):
        MODELS["triangle"].drawing(**corners, turn=turn)
        # The map from space to the sheet that takes all four there is that of a view from afar.
        drawn = np.vstack([marks["estimated"][:3], marks["camera"]])
        view = np.linalg.solve(places[1:] - places[0], drawn[1:] - drawn[0]).T
        assert np.allclose(view @ view.T, np.eye(2), atol=1e-9)
        t = np.radians(turn)
        assert np.allclose(view[0], [np.cos(t), 0, -np.sin(t)], atol=1e-9)
    assert "no camera" not in texts
    marks.clear()
    MODELS["triangle"].drawing(Y_v=600)
    assert "no camera" in texts
    assert "camera" not in marks
    MODELS["triangle"].drawing(Y_v=-280)
    assert texts[-1] == "no triangle, no camera"


def test_the_box_behind_the_glass_has_the_shape_of_the_box_that_was_photographed(monkeypatch):
    draw, boxes = triangle._seen, []
    monkeypatch.setattr(triangle, "_seen", lambda *box: boxes.append(box) or draw(*box))
    MODELS["triangle"].drawing()
    (_, edges, _), W = boxes[0], blocks().vertices[[1, 0, 3, 5]]
    assert np.allclose(edges @ edges.T / (edges[0] @ edges[0]), np.diag([1, 25 / 16, 1]), atol=5e-3)
    nearest = [1200, -8000, 2000] - W[0]
    along = np.array([700, -1000, 12800]) - [1200, -8000, 2000]
    depth = -nearest @ along / np.linalg.norm(along)
    assert np.linalg.norm(edges[0]) == pytest.approx(1.25 * 800 / depth * 4000, rel=2e-3)


def test_the_foot_of_the_altitude_from_y_has_its_letter_and_its_right_angle(monkeypatch):
    marks, letters = [], []
    monkeypatch.setattr(
        Panel, "line", lambda _, xy, *_a, **_k: marks.append(xy) if len(xy) == 3 else None
    )
    monkeypatch.setattr(Panel, "text", lambda _, _xy, words, *_a, **_k: letters.append(words))
    for X, Z, Y in (((-900, 0), (300, 0), (-200, 700)), ((-600, -200), (400, 300), (-400, 1200))):
        marks.clear()
        letters.clear()
        corners = {"X": X, "Y": Y, "Z": Z}
        MODELS["triangle"].drawing(
            turn=80, **{f"{name}_{axis}": at[i] for name, at in corners.items()
                       for i, axis in enumerate("uv")}
        )  # fmt: skip
        side, down = np.subtract(Z, X), np.array([-(Z[1] - X[1]), Z[0] - X[0]])
        foot = X + side * (np.subtract(Y, X) @ side) / (side @ side)
        on_altitude, corner, on_side = marks[0]
        assert np.allclose([down @ (on_side - foot), side @ (on_altitude - foot)], 0, atol=1e-6)
        assert np.allclose(corner - on_side, on_altitude - foot, atol=1e-9)
        assert (on_altitude - foot) @ (np.array(Y) - foot) > 0
        assert letters.count("H") == 2  # in the photograph, and in space


def test_letters_of_the_triangle_give_way_to_each_other(monkeypatch):
    write, places = Panel.text, {}

    def note(self, xy, words, *rest, **how):
        places[self, words] = self.place(xy) / self.scale
        write(self, xy, words, *rest, **how)

    monkeypatch.setattr(Panel, "text", note)
    for height in (600, 640, 673, 700, 800, 1474):
        for turn in (-90, -20, 0, 60, 90):
            places.clear()
            MODELS["triangle"].drawing(Y_v=height, turn=turn)
            for (panel, one), (other, two) in itertools.combinations(places, 2):
                off = np.abs(places[panel, one] - places[other, two])
                apart = off[0] > 5 * (len(one) + len(two)) or off[1] > 13
                assert apart or panel is not other, (height, turn, one, two)


def test_a_bent_row_is_straight_with_the_k1_that_bent_it_and_with_no_other():
    model = MODELS["straighten"]
    titles = [model.picture(k1=k1)[:TITLE].tobytes() for k1 in (0, -0.2)]
    assert titles[0] != titles[1]  # they tell the number
    assert "straight, and so are" in model.drawing(k1=-0.2).sentence
    assert "bends up" in model.drawing(k1=-0.19).sentence
    assert "bends down" in model.drawing(k1=-0.21).sentence
    middle = grip_of(model.drawing(), "row")
    assert model.dragged("row", (middle.at[0], 0))["k1"] == -0.2


@pytest.mark.parametrize("k1", [0, -0.25, -0.4])
def test_the_bar_under_the_residuals_is_as_long_as_it_says(k1, monkeypatch):
    said, bars, write, rule = [], [], Panel.text, Panel.line

    def text(panel, at, words, *args, **kwargs):
        said.append(words)
        return write(panel, at, words, *args, **kwargs)

    def line(panel, points, ink, *args, **kwargs):
        bars.append((panel, np.ptp(np.array(points)[:, 0]) / panel.pixel, ink))
        return rule(panel, points, ink, *args, **kwargs)

    monkeypatch.setattr(Panel, "text", text)
    monkeypatch.setattr(Panel, "line", line)
    arrows, titles = [], []

    def draw(panel, _, by, *__):
        arrows.append(by)
        titles.append(panel.title)

    monkeypatch.setattr(Panel, "arrows", draw)
    drawing = MODELS["residuals"].drawing(k1=k1)
    (length,) = [float(words[:-3]) for words in said if words.endswith(" px")]
    (long,) = [long for _, long, ink in bars if ink == IDEAL]
    shown = np.sqrt(np.mean(np.sum(arrows[0] ** 2, axis=-1)))  # px of the photographs
    missed = numbers(drawing.sentence)[1]
    times = float(titles[0].partition("× ")[2].replace(",", ""))
    assert times == pytest.approx(shown / missed, rel=5e-3)
    assert long / length == pytest.approx(500 / 640 * times, rel=5e-3)  # px of the panel
    assert 20 < long < 61


def test_the_sun_is_seen_where_trigonometry_puts_it_and_its_rays_end_opposite_if_it_is_behind():
    model = MODELS["shadows"]
    for azimuth, behind in ((30, 0), (-150, 1)):  # opposite points of the sky
        drawing = model.drawing(azimuth=azimuth, elevation=20)
        up = np.tan(np.radians(20)) / np.cos(np.radians(30))
        at = 319.5 + 400 * np.tan(np.radians(30)), 239.5 + 400 * up * (1 if behind else -1)
        np.testing.assert_allclose(grip_of(drawing, "sun").at, at, atol=1e-3)
        assert ("behind the camera" in drawing.sentence) == bool(behind)
        assert model.dragged("sun", at)["azimuth"] == azimuth
        assert model.dragged("sun", at)["elevation"] == 20
    # What ends outside has its ring whole within the picture, and its place in words beside it.
    for azimuth, corner in ((90.5, (16, 463)), (60, (623, 16))):
        assert grip_of(model.drawing(azimuth=azimuth, elevation=20), "sun").at == corner
    abeam = model.drawing(azimuth=90, elevation=20)
    assert "stay parallel" in abeam.sentence
    assert not abeam.grips


def test_each_shadow_lies_where_the_renderer_throws_it():
    """The same railway under the same sun, ray by ray, with its poles and without them."""
    model, poles = MODELS["shadows"], 20 * 12  # the last triangles of the scene
    azimuth, elevation = np.radians([-151.5, 14.5])
    whole = rails().lit_from((np.sin(azimuth), -np.tan(elevation), np.cos(azimuth)))
    parts = ("triangles", "colours", "uv", "extent")
    bare = replace(whole, **{name: getattr(whole, name)[:-poles] for name in parts})
    camera = Camera(
        intrinsics(275, 275, 219.5, 164.5), pose(np.eye(3), [0, 0, -13_000]), size=(440, 330)
    )
    with_poles, without = (radiance(scene, camera) for scene in (whole, bare))
    panel = slice(TITLE, TITLE + 330), slice(MARGIN, MARGIN + 440)
    drawn, elsewhere = (
        model.picture(azimuth=degrees, elevation=14.5)[panel].astype(float)
        for degrees in (-151.5, 151.5)
    )
    near = slice(200, 325), slice(8, 325)  # the ground, left of the shadow of the camera
    thrown = (without - with_poles)[near].sum(-1) > 20
    strip = (elsewhere - drawn)[near].sum(-1) > 100
    assert thrown.sum() > 800
    assert (thrown & strip).sum() > 0.7 * (thrown | strip).sum()  # the rest: on rails, sleepers
    # The shadow of a pole begins at its foot, and leads away from the sun.
    foot, away = np.array([-4000, 1950, 40_000]), np.array([np.sin(azimuth), 0, np.cos(azimuth)])
    for by, dark in ((-4000, True), (4000, False)):
        u, v = np.rint(camera.project(foot + by * away)).astype(int)
        assert ((elsewhere - drawn)[v - 1 : v + 2, u].sum(-1).max() > 60) == dark


@pytest.mark.parametrize(("azimuth", "elevation"), [(160, 20), (-145, 16)])
def test_the_cameras_shadow_falls_where_the_rays_of_the_sun_end(azimuth, elevation):
    picture, other = (
        MODELS["shadows"].picture(azimuth=a, elevation=elevation).astype(int)
        for a in (azimuth, -azimuth)
    )
    u = 319.5 + 400 * np.tan(np.radians(azimuth))
    v = 239.5 - 400 * np.tan(np.radians(elevation)) / np.cos(np.radians(azimuth))
    away = -1.95 / np.tan(np.radians(elevation)) * np.cos(np.radians(azimuth))  # m, along the axis
    half = 0.15 * 400 / away * 440 / 640  # px of the page: half of a box 0.3 m wide, or more
    x, y = MARGIN + (u + 0.5) * 440 / 640, TITLE + (v + 0.5) * 440 / 640
    y = round(y) + 8  # below the cross
    for by, dark in ((-0.8, True), (0.8, True), (-2.2, False), (2.2, False)):
        at = y, round(x + by * half)
        assert ((other - picture)[at].sum() > 60) == dark, by


@pytest.fixture
def lines(monkeypatch):
    """Note each curve that is drawn: its title, its points, its colour and whether it is dashed."""
    drawn, line = [], Panel.line

    def kept(panel, xy, colour, *rest, **how):
        drawn.append((panel.title, np.array(xy), colour, bool(how)))
        line(panel, xy, colour, *rest, **how)

    monkeypatch.setattr(Panel, "line", kept)
    return drawn


@pytest.mark.parametrize(("azimuth", "elevation"), [(15, 2), (-165, 8), (15, 8), (-120, 3)])
def test_four_poles_have_their_ray_also_when_the_tip_of_the_shadow_is_behind(
    azimuth, elevation, lines
):
    sun = np.radians([azimuth, elevation])
    d = np.array([np.sin(sun[0]), -np.tan(sun[1]), np.cos(sun[0])])
    MODELS["shadows"].drawing(azimuth=azimuth, elevation=elevation)
    rays = [xy for _, xy, ink, dashed in lines if ink == ESTIMATED and not dashed]
    assert len(rays) == 4
    for ray, z in zip(rays, (27, 52, 77, 102), strict=True):
        a, b = ray[0], ray[-1]
        for x, y, ahead in ([-4, -4.05, z], d):  # its pole's top, and the sun
            at = 400 * np.array([x, y]) / ahead + [319.5, 239.5]
            assert abs(np.linalg.det([b - a, at - a])) / np.linalg.norm(b - a) < 1e-6
        top = 400 * np.array([-4, -4.05]) / z + [319.5, 239.5]
        inside = (ray[0] >= -0.5).all() and (ray[0] <= [639.5, 479.5]).all()
        # It ends in the shadow's tip, or leaves the picture: it never stops at the top.
        tip = np.array([-4, -4.05, z]) - 6 / np.tan(sun[1]) * d / np.hypot(d[0], d[2])
        assert np.linalg.norm(ray[0] - top) > 30
        assert not inside or tip[2] > 0.2


def test_beside_the_camera_the_drawn_rays_stay_parallel(lines):
    for azimuth, elevation in ((90, 20), (-90, 35)):
        lines.clear()
        MODELS["shadows"].drawing(azimuth=azimuth, elevation=elevation)
        rays = [xy for _, xy, ink, dashed in lines if ink == ESTIMATED and not dashed]
        slopes = [(ray[-1] - ray[0])[1] / (ray[-1] - ray[0])[0] for ray in rays]
        assert len(slopes) == 4
        assert np.allclose(np.abs(slopes), np.tan(np.radians(elevation)), atol=1e-6)


@pytest.mark.parametrize(("heading", "slope"), [(17, 6), (-30, -12), (0, 0), (60, 12), (90, 6)])
def test_the_ray_is_parallel_to_the_rods_and_pierces_the_glass_where_their_pictures_meet(
    heading, slope, lines
):
    drawing = MODELS["parallel"].drawing(heading=heading, slope=slope)
    h, s = np.radians([heading, slope])
    d = np.array([np.sin(h) * np.cos(s), -np.sin(s), np.cos(h) * np.cos(s)])
    seen = [xy for title, xy, ink, _ in lines if (title, ink) == ("the picture", ESTIMATED)]
    ways = np.array([xy[1] - xy[0] for xy in seen])
    if heading == 90:
        assert np.allclose(np.abs(ways[:, 1] / ways[:, 0]), np.tan(s) * 804 / 800, atol=1e-9)
        assert "are parallel, too" in drawing.sentence
    else:
        end = np.array([800 * d[0], 804 * d[1]]) / d[2] + [325, 238]
        off = [np.linalg.det([end - xy[0], way]) for xy, way in zip(seen, ways, strict=True)]
        assert np.abs(off / np.linalg.norm(ways, axis=1)).max() < 1e-6
        assert numbers(drawing.sentence)[3:] == [round(x) for x in end.tolist()]
    there = [(xy[-1] - xy[0], ink) for title, xy, ink, _ in lines if title.startswith("in space")]
    rods, (ray,) = (
        [way for way, colour in there if colour in inks and np.linalg.norm(way) > least]
        for inks, least in (({WORLD, mixed(WORLD, "#FFFFFF", 0.6)}, 0), ({IDEAL}, 1.2))
    )
    assert len(rods) == 12
    assert np.allclose([np.linalg.det([ray, way]) for way in rods], 0, atol=1e-9)


@pytest.mark.parametrize(("tilt", "roll"), [(3.4, 7.8), (10, -25), (0.5, 20)])
def test_a_horizon_is_pulled_to_where_a_camera_so_tilted_and_rolled_sees_it(tilt, roll, lines):
    drawing = MODELS["eye"].drawing(tilt=tilt, roll=roll)
    near = np.array(grip_of(drawing, "horizon").at)
    A, R = eye_of(tilt, roll)
    camera = Camera(A, pose(R, [0, 0, 0]))
    ends = camera.vanishing_point(np.array([[0.3, 0, 1.0], [-0.2, 0, 1]]))
    skyline = next(xy for _, xy, ink, _ in lines if ink == IDEAL)
    for at in (near, *skyline):
        assert abs(np.linalg.det([*(at - ends[:1]), ends[1] - ends[0]])) < 0.5
    assert np.linalg.norm(near - [325, 238]) == pytest.approx(
        800 * np.tan(np.radians(tilt)), rel=1e-4
    )
    pulled = MODELS["eye"].dragged("horizon", tuple(near))
    assert [pulled["tilt"], pulled["roll"]] == [tilt, roll]


def test_the_pale_tree_tells_its_height_when_the_green_one_has_come_there(monkeypatch):
    written, text = [], Panel.text

    def kept(panel, xy, words, *rest, **how):
        written.append(words)
        text(panel, xy, words, *rest, **how)

    monkeypatch.setattr(Panel, "text", kept)
    for z, words in ((5, ["?", "2.56"]), (10, ["1.28", "1.28"])):
        written.clear()
        MODELS["similar"].drawing(z=z)
        assert sorted(written[-2:], reverse=z == 5) == words


@pytest.mark.parametrize(("left", "right"), [(-475, 725), (-1275, 725), (-1360, 940), (-200, 420)])
def test_walls_that_are_photographed_vanish_where_the_protractor_says(left, right, monkeypatch):
    """A level camera turned by some angle sees two walls, whose angle in the world is known."""
    drawn, line = [], Panel.line

    def kept(panel, xy, *rest, **how):
        drawn.append(np.array(xy))
        line(panel, xy, *rest, **how)

    painted, polygons = [], Panel.polygons

    def paint(panel, corners, ink):
        if ink in protractor._WALLS:
            painted.extend(np.array(corners, dtype=float))
        polygons(panel, corners, ink)

    monkeypatch.setattr(Panel, "line", kept)
    monkeypatch.setattr(Panel, "polygons", paint)
    sentence = MODELS["protractor"].drawing(left=left, right=right).sentence
    turned = Camera(
        intrinsics(800, 800, 325, 238), pose(rotation_from_vector([0, 0.3, 0]), [0, 0, 0])
    )
    a, b = (np.degrees(np.arctan2(u - 325, 800)) - np.degrees(0.3) for u in (left, right))
    for degrees, u in ((a, left), (b, right)):
        d = [np.sin(np.radians(degrees)), 0, np.cos(np.radians(degrees))]
        assert np.allclose(turned.vanishing_point(d), [u, 238], atol=1e-6)
    said = numbers(sentence)
    assert said[-1] == pytest.approx(b - a, abs=0.051)
    assert ("90.0°" in sentence) == (left == -1275)
    # Seen from above, each wall is parallel to the ray to where it vanishes.
    walls = [xy for xy in drawn if len(xy) == 2 and np.allclose(xy[0], [295, 900])]
    for (near, far), u in zip(walls, (left, right), strict=True):
        assert abs(np.linalg.det([far - near, [u - 325, 800]])) < 1e-6 * 800 * 300
        assert (far - near) @ [u - 325, 800] > 0
    # In the picture, the edges of the walls lead to the points that are pulled.
    edges = [xy for xy in drawn if len(xy) == 2 and (xy[1] == [left, 238]).all()]
    assert len(edges) == 2
    for wall, u in zip(painted, (left, right), strict=True):
        near, far = wall[0, 0], wall[1, 0]
        assert min(near, u) < far < max(near, u)  # a wall runs towards its vanishing point


@pytest.mark.parametrize(("z", "f"), [(5, 8), (4, 9), (9.7, 4.1)])
def test_a_tree_is_as_high_on_the_plane_as_a_true_camera_sees_it_and_upside_down_on_the_film(z, f):
    camera = Camera(np.diag([f, f, 1.0]))
    foot, top, far = camera.project([[0, 1.6, z], [0, -1.4, z], [2.2, 1.6, 10]])
    drawing = MODELS["similar"].drawing(z=z, f=f)
    said = [f, 1600, 1e3 * z, foot[1]]
    assert numbers(drawing.sentence) == pytest.approx(said, abs=0.0051)
    plane = drawing.picture[TITLE : TITLE + 336, 569 : 569 + 244].astype(int)
    left = plane[:, : round((2 + far[0] / 2) / 5.88 * 244)]  # without the pale tree
    crown, dot = (
        np.flatnonzero((np.abs(left - colour(ink)).max(-1) < 12).any(1))
        for ink in ("#44975C", LENS)
    )
    rows = np.array([crown.min(), dot.max() - 4.5]) / 336 * 8.1 - 3.8  # mm; the dot's middle
    assert rows == pytest.approx([top[1], foot[1]], abs=0.05)
    # From the side, foot, hole and both pictures lie on one line, at their distances.
    film, tree = (np.array(grip_of(drawing, name).at) for name in ("film", "tree"))
    assert abs(np.linalg.det([film, tree])) < 1e-6 * np.linalg.norm(tree) ** 2
    assert film[0] / 12 == pytest.approx(-f)
    assert tree[0] / 33 == pytest.approx(z)
    for at in (film, -film):
        x, y = np.rint(at + [MARGIN + 150, TITLE + 152]).astype(int)
        assert count(drawing.picture[y - 2 : y + 3, x - 2 : x + 3], LENS) > 12


def test_the_best_hole_is_where_its_patch_and_diffraction_are_equal():
    model = MODELS["pinhole"]
    widths = [grip_of(model.drawing(hole=d), "hole").at[1] for d in np.arange(0.06, 0.09, 0.001)]
    best = np.sqrt(2.44 * 0.00055 * 4)  # mm: the least of d + a / d
    assert abs(0.06 + 0.001 * np.argmin(widths) - best) <= 0.001
    assert "its patch of light is 14.6 px wide, and diffraction adds 14.7 px" in (
        model.drawing(hole=0.073).sentence
    )
    assert model.dragged("hole", (0.1, 50), lens=1) == {"hole": 0.1, "lens": 0, "focus": 4}


def test_a_lens_focused_near_by_blurs_the_whole_room():
    shown = MODELS["pinhole"].drawing
    for focus in (0.2, 1, 4):
        f = 1 / (1 / 4 + 1 / (1000 * focus))  # mm: of the lens, by its law, for 4 mm to the sensor
        image = [1 / (1 / f - 1 / s) for s in (2500, 10_000)]  # mm: where these depths are sharp
        discs = [2 * abs(4 - i) / i / 0.005 for i in image]  # px: similar triangles
        said = numbers(shown(lens=1, focus=focus).sentence)
        assert said[-2] == pytest.approx(max(discs), abs=0.0051)
        assert said[-1] == pytest.approx(2.44 * 0.00055 * 4 / 2 / 0.005, abs=0.05)
    near, far = (
        np.abs(np.diff(shown(lens=1, focus=s).picture[:, 9:430].astype(float), axis=1)).max(-1)
        for s in (0.2, 4)
    )
    for part, ahead, behind in (
        (np.s_[200:330, 30:120], near, far),
        (np.s_[40:330, 160:], far, near),
    ):
        assert ahead[part].max() > 2 * behind[part].max()  # the card on the left, and the room
    card = shown(lens=1, focus=0.2).picture[200:330, 30:120]
    assert card.min() < 60  # its ink hides the room


@pytest.mark.parametrize(("fov", "right", "up"), [(60, 0, 0), (70, 40, -15), (120, -10, 5)])
def test_a_view_out_of_the_fisheyes_picture_is_what_a_pinhole_camera_sees(fov, right, up):
    drawing = MODELS["fisheye"].drawing(fov=fov, right=right, up=up)
    seen = drawing.picture[TITLE + 1 : TITLE + 349, 360:778]
    f = 210 / np.tan(np.radians(fov / 2))
    a, b = np.radians([right, up])
    ahead = np.array([np.sin(a) * np.cos(b), -np.sin(b), np.cos(a) * np.cos(b)])
    eye = np.array([-300.0, -100, 6900])
    there = Camera(intrinsics(f, f, 209.5, 174.5), look_at(eye, eye + ahead), size=(420, 350))
    off = seen.astype(int) - render_scene(room(), there, samples=4)[1:349, 1:419]
    assert np.abs(off).mean() < 3  # grey levels: edges are less sharp
    assert np.median(np.abs(off)) == 0


@pytest.mark.parametrize(("fov", "right", "black"), [(60, 78, False), (70, 78, True)])
def test_a_view_says_when_it_reaches_beyond_what_the_fisheye_sees(fov, right, black):
    """That is 110° to all sides: 78° and half of the view at the middle of its border."""
    said = MODELS["fisheye"].drawing(fov=fov, right=right, up=0).sentence
    assert ("beyond the 220°" in said) == black


@pytest.mark.parametrize("f", [318, 279, 340])
def test_a_new_frame_shows_what_a_pinhole_camera_sees_and_is_black_beyond_the_lenss_picture(f):
    """By a camera that photographs the street anew, and by r L(r) of each pixel's own radius."""
    drawing, u0, v0 = MODELS["frame"].drawing(f=f), 319.5, 239.5
    seen = drawing.picture[TITLE + 1 : TITLE + 287, -MARGIN - 383 : -MARGIN - 1].astype(int)
    A = intrinsics(0.6 * f, 0.6 * f, 0.6 * (u0 + 0.5) - 0.5, 0.6 * (v0 + 0.5) - 0.5)
    street = look_at([-600, 0, 6200], [-600, -900, 14_000])
    there = Camera(A, street, size=(384, 288))
    anew = render_scene(blocks(), there, samples=4)[1:287, 1:383]
    x, y = np.moveaxis(pixel_centres((640, 480)) - [u0, v0], -1, 0) / f
    bent = 400 * (1 - 0.25 * (x**2 + y**2) + 0.05 * (x**2 + y**2) ** 2)
    black = (np.abs(bent * x) > 319.5) | (np.abs(bent * y) > 239.5)
    dark = np.pad(seen.max(axis=-1) < 40, 1, mode="edge")  # under the panel's own border, too
    assert dark.mean() == pytest.approx(black.mean(), abs=0.01)
    assert (
        np.abs(seen - anew)[~dark[1:-1, 1:-1]].mean() < 4
    )  # grey levels: edges, and the black's border
    # Where the frame lies in the photograph, by the same numbers: what is around it is lost.
    r = np.linspace(0, 1.6, 4001)
    radius = np.hypot(*np.moveaxis((pixel_centres((640, 480)) - [319.5, 239.5]) / 400, -1, 0))
    back = np.interp(radius, r * (1 - 0.25 * r**2 + 0.05 * r**4), r) / radius
    m = f * back[..., None] * (pixel_centres((640, 480)) - [319.5, 239.5]) / 400 + [u0, v0]
    lost = ((m < 0) | (m > [639, 479])).any(axis=-1).mean()
    wide = np.degrees(np.arctan((639 - u0) / f) + np.arctan(u0 / f))
    said = numbers(drawing.sentence.replace("nothing", "0"))
    assert said == pytest.approx([f, wide, 100 * black.mean(), 100 * lost], abs=0.51)
    assert np.abs(said[2:] - 100 * np.array([black.mean(), lost])).max() < 0.11
    # On the plane, away from lines and marks: black, pale, or white as the paper.
    plane = drawing.picture[TITLE : TITLE + 440, MARGIN : MARGIN + 480].astype(int)
    beside = [[0, 0], [5, 0], [-5, 0], [0, 5], [0, -5]]
    x, y = np.moveaxis(pixel_centres((480, 440))[..., None, :] - [239.5, 219.5] + beside, -1, 0)
    x, y = x * 2.76 / 480, y * 2.76 / 480
    bent = 400 * (1 - 0.25 * (x**2 + y**2) + 0.05 * (x**2 + y**2) ** 2)
    shown = (np.abs(bent * x) < 319.5) & (np.abs(bent * y) < 239.5) & (np.hypot(x, y) < 1.5)
    framed = (x > -u0 / f) & (x < (639 - u0) / f) & (y > -v0 / f) & (y < (479 - v0) / f)
    for place, low, high in (
        (framed & ~shown, 0, 8),
        (~framed & shown, 150, 254),
        (~framed & ~shown, 255, 255),
    ):
        there = plane[place.all(axis=-1)].min(axis=-1)
        assert ((low <= there) & (there <= high)).sum() >= 0.97 * len(there)


def test_a_frame_has_no_gaps_from_where_a_side_no_longer_leaves_the_border_and_loses_all_else():
    """The longest and the shortest focal length that the four sides of the picture ask for."""
    r = np.linspace(0, 1.6, 400_001)
    seen = r * (1 - 0.25 * r**2 + 0.05 * r**4)
    side, top, corner = np.interp([319.5 / 400, 239.5 / 400, np.hypot(319.5, 239.5) / 400], seen, r)
    full, every = max(319.5 / side, 239.5 / top), np.hypot(319.5, 239.5) / corner
    assert [every, full] == pytest.approx(frame.ends(), abs=0.01)
    for f in range(260, 431, 5):
        sentence = MODELS["frame"].drawing(f=f).sentence
        assert ("nothing is black" in sentence) == (f >= full), f
        assert ("nothing is lost" in sentence) == (f <= every), f


def test_the_outline_of_a_view_grows_towards_180_degrees_and_never_reaches_them():
    for fov in (40, 110, 150):
        drawing = MODELS["fisheye"].drawing(fov=fov, right=0, up=0)
        ink = np.abs(drawing.picture[:, :356].astype(int) - list(bytes.fromhex(ESTIMATED[1:])))
        orange = np.argwhere((ink < 12).all(axis=-1))[:, 1]
        px_for_a_degree = 0.97 * 350 / 220
        assert abs(np.ptp(orange) - fov * px_for_a_degree) < 5, fov
    assert "sensor 1,320 px wide" in drawing.sentence  # 2 · 0.97 · 700 px / 220° · tan 75°


@pytest.mark.parametrize("d", [0.02, 0.073, 0.4])
def test_behind_a_hole_a_point_is_its_patch_spread_by_airys_disc(d):
    """The same in space, as a convolution, where the model works with waves."""
    r = np.hypot(*np.mgrid[-160:161, -160:161]) * 0.005 * 640 / 440 + 1e-9  # mm on the sensor
    q = np.pi * d * r / (0.00055 * 4)
    blot = fftconvolve(r < d / 2, (2 * j1(q) / q) ** 2, "same")
    scene = np.zeros((330, 440))
    scene[120:210, 150:290] = 255
    seen = spread_out(d, d, np.fft.rfft2(np.pad(scene, ((105, 105), (100, 100)))))
    expected = fftconvolve(scene, blot / blot.sum(), "same")
    assert np.abs(seen - expected).max() < 6
    assert np.sqrt(np.mean((seen - expected) ** 2)) < 1.5  # of rings that are cut off


def test_what_is_taken_off_a_photograph_puts_its_squares_under_the_row_of_corners():
    model = MODELS["straighten"]
    for k1 in (-0.2, 0):
        left = model.picture(k1=k1)[TITLE:, MARGIN : MARGIN + WIDTH].astype(int)
        blue = np.abs(left - colour(LENS)).max(-1) < 40
        across = np.flatnonzero(blue.any(axis=0))
        middles = [
            part.mean() for part in np.split(across, np.flatnonzero(np.diff(across) > 8) + 1)
        ]
        assert len(middles) == 9
        for u in middles:
            x, y = round(u), round(np.flatnonzero(blue[:, round(u)]).mean())
            # Four squares meet there: diagonal neighbours have one colour, the others another.
            one, two, three, four = (left[y + j, x + i].mean() for i in (-9, 9) for j in (-9, 9))
            assert abs(one - four) < 60 > abs(two - three)
            assert abs(one - two) > 120


# Paper and packing.


def test_a_packed_picture_is_unpacked_by_others_as_it_was():
    picture = np.random.default_rng(0).integers(0, 256, (37, 53, 3), np.uint8)
    assert np.array_equal(np.asarray(Image.open(io.BytesIO(pack_png(picture)))), picture)


@pytest.mark.parametrize("bad", [np.zeros((4, 4), np.uint8), np.zeros((4, 4, 3))])
def test_only_pictures_are_packed(bad):
    with pytest.raises(ShapeError, match="expected uint8"):
        pack_png(bad)


@pytest.mark.once
@each_model
def test_what_can_be_pulled_has_rings_around_it_and_nothing_else_has(name, monkeypatch):
    drawing = MODELS[name].drawing()
    monkeypatch.setattr(Panel, "_ring", lambda *_: None)
    changed = (MODELS[name].drawing().picture != drawing.picture).any(axis=2)
    height, width = changed.shape
    v, u = np.mgrid[:height, :width]
    near = np.zeros_like(changed)
    for grip in drawing.grips:
        far = np.hypot(u + 0.5 - grip.place[0], v + 0.5 - grip.place[1])
        ring = (far > 10) & (far < 14)
        near |= ring
        assert changed[ring].mean() > 0.15, grip.name  # some of it may be cut off, or be on white
    assert not changed[~near].any()


def test_a_line_is_cut_at_the_border_and_interrupted_by_nan():
    panel = Paper().panel((100, 100), (0, 100), (0, 100))
    panel.line([[-1e9, 50], [1e9, 50]], WORLD, 3)
    panel.line([[20, 80], [np.nan, 80], [80, 80], [1e300, 80]], CAMERA, 3)
    picture = panel.finish()[TITLE:]
    assert count(picture[50], WORLD) > 95
    assert count(picture[80], CAMERA) == 0
    assert count(picture, WORLD) < 500


@pytest.mark.parametrize("anchor", ["lm", "mm", "rm"])
@pytest.mark.parametrize("at", [(0, 25), (200, 25), (100, 0), (199, 50)])
def test_words_at_the_border_are_written_whole(at, anchor):
    def written(xy):
        panel = Paper().panel((200, 50), (0, 200), (0, 50))
        panel.text(xy, "second", "#000000", anchor=anchor)
        return np.sum(255 - panel.drawn().astype(int))

    assert abs(written(at) / written((100, 25)) - 1) < 0.02
    assert written((-30, 25)) < 0.5 * written((100, 25))  # whose point is not seen


def test_a_dashed_line_is_drawn_by_half_in_one_rhythm_around_corners():
    panel = Paper().panel((200, 50), (0, 200), (0, 50))
    panel.line([[0, 25], [33, 25], [66, 25], [200, 25]], WORLD, 2, dash=10)
    row = panel.finish()[TITLE + 25]
    green = np.abs(row.astype(int) - colour(WORLD)).max(-1) < 60
    assert 0.4 < green[3:203].mean() < 0.6
    edges = np.flatnonzero(np.diff(green[5:200].astype(int)))
    assert np.allclose(np.diff(edges), 10, atol=2)


def test_points_far_away_or_without_a_place_are_not_marked():
    panel = Paper().panel((50, 50), (0, 50), (0, 50))
    panel.mark([[1e12, 3], [np.nan, np.nan]], "world")
    panel.text([np.nan, 0], "nowhere")
    assert count(panel.finish(), WORLD) == 0


# The shell.


def counting(model):
    calls = []

    def draw(paper, values):
        calls.append(dict(values))
        return model.draw(paper, values)

    return Model(model.name, model.about, model.settings, draw), calls


@each_model
def test_a_slider_that_is_moved_changes_the_picture_and_reset_brings_it_back(name):
    widget = explorations.explore(name)
    start = widget.image.value
    assert np.array_equal(np.asarray(Image.open(io.BytesIO(start))), MODELS[name].picture())
    first = MODELS[name].settings[0]
    slider = widget.sliders[first.name]
    way = 9 * first.step * (1 if first.value < first.high else -1)
    slider.value = min(max(first.value + way, first.low), first.high)
    assert widget.image.value != start
    values = widget.values
    assert MODELS[name].drawing(**values).sentence in html.unescape(widget.sentence.value)
    widget.reset_button.click()
    assert widget.values == {s.name: s.value for s in MODELS[name].settings}
    assert widget.image.value == start
    widget.reset_button.click()
    assert widget.image.value == start
    widget.close_all()


@pytest.mark.once
@each_model
def test_sliders_say_what_they_are_and_can_be_moved_by_keys(name):
    widget = explorations.explore(name)
    for s in MODELS[name].settings:
        slider = widget.sliders[s.name]
        assert len(slider.tooltip) > 4
        if s.is_choice:
            assert type(slider).__name__ == "Checkbox"
            continue
        if s.names:
            values = np.arange(s.low, s.high + 1)
            assert slider.options == tuple(zip(s.names, values, strict=True))
            continue
        assert type(slider).__name__ in ("IntSlider", "FloatSlider")
        assert (slider.min, slider.max, slider.step) == (s.low, s.high, s.step)
        assert slider.continuous_update
    assert MODELS[name].about in html.unescape(widget.sentence.value)
    assert 'aria-live="polite"' in widget.sentence.value
    assert not any("Output" in type(w).__name__ for w in widget.children)
    widget.close_all()


def test_what_has_names_is_chosen_from_a_list_and_follows_the_hand():
    widget = explorations.explore("asks")
    widget.sliders["warp"].label = "lens"
    assert widget.values["warp"] == 4
    assert MODELS["asks"].drawing(warp=4).sentence in html.unescape(widget.sentence.value)
    widget.reset_button.click()
    assert widget.sliders["warp"].label == "rotation"
    assert not set(MODELS["asks"].folded()) & {"warp"}
    assert MODELS["clouds"].dragged("picture", (2.5, 0))["picture"] == 3
    widget.close_all()


def test_a_choice_is_a_switch_that_changes_the_picture_and_goes_back_with_the_rest():
    widget = explorations.explore("cube")
    start = widget.image.value
    assert widget.values["lens"] == 1
    widget.sliders["lens"].value = False
    assert widget.values["lens"] == 0
    assert widget.image.value != start
    widget.reset_button.click()
    assert widget.sliders["lens"].value is True
    assert widget.image.value == start
    widget.close_all()


def test_reset_draws_once_and_unchanged_values_are_not_drawn_again():
    from cvnotes.show.explorations.shell import Explorer

    model, calls = counting(MODELS["lens"])
    widget = Explorer(model)
    for name in ("k1", "k2"):
        widget.sliders[name].value = 0.05
    assert len(calls) == 3
    widget.reset()
    assert len(calls) == 4
    widget.reset()
    widget.redraw()
    assert len(calls) == 4
    widget.close_all()


@pytest.mark.once
@pytest.mark.slow
@each_model
def test_where_no_kernel_runs_the_still_of_the_same_values_is_seen(name):
    widget = explorations.explore(name)
    bundle = widget._repr_mimebundle_()
    assert bundle["application/vnd.jupyter.widget-view+json"]["model_id"] == widget.model_id
    assert bundle["text/html"].startswith(MODELS[name].still()._repr_html_())
    assert html.escape(MODELS[name].drawing().sentence) in bundle["text/html"].partition(">")[2]
    assert len(bundle["text/html"]) < 160_000  # three bytes as four letters: 120 kB of picture
    first = MODELS[name].settings[0]
    widget.sliders[first.name].value = first.high
    still = MODELS[name].still(**widget.values)._repr_html_()
    assert widget._repr_mimebundle_()["text/html"].startswith(still)
    widget.close_all()


def test_a_sentence_cannot_smuggle_markup_into_the_page():
    from cvnotes.show.explorations.shell import Explorer

    def draw(paper, _):
        return Drawing(paper.join((paper.panel((50, 50), (0, 1), (0, 1)),)), "1 < 2 & <b>no</b>")

    widget = Explorer(Model("x", "x", (Setting("a", "a", 0, 1, 0.5, 0.5, "a value"),), draw))
    assert "1 &lt; 2 &amp; &lt;b&gt;no" in widget.sentence.value
    assert "<b>" not in widget._repr_mimebundle_()["text/html"]
    widget.close_all()


@pytest.mark.parametrize("looks", [(1, 0), (-3, 0), (0, 2), (0, -1), (1, 1)])
def test_a_cameras_triangle_points_to_where_it_looks(looks):
    panel = Paper().panel((101, 101), (-50.5, 50.5), (-50.5, 50.5))
    panel.mark([0, 0], "camera", 30, looks)
    v, u = np.nonzero(np.abs(panel.finish().astype(int) - colour(CAMERA)).max(axis=-1) < 40)
    along = (np.column_stack([u, v]) - [MARGIN + 50, TITLE + 50]) @ looks / np.hypot(*looks)
    assert along.max() == pytest.approx(30, abs=2)  # its tip
    assert along.min() == pytest.approx(-24, abs=2)
    assert along.mean() < -3  # it is wide behind


# Taken hold of by hand.

PULLED = [(name, grip) for name in explorations.NAMES for grip in MODELS[name].drags]


FREE_TO_MOVE = {
    "entries": {"h7": 0.4},
    "origin": {"out": 100},  # where the hand may pull to either side
    "meet": {"b2": 0.4},
    "finding": {"step": 1.5},
    "triangle": {"Z_u": 900, "turn": 40},
    "tilt": {"tilt": 30},
    "stands": {"alpha": 800},
    "straighten": {"k1": -0.1},
    "folds": {"k1": -0.15},
    "sheets": {"amount": 1},
    "whose": {"turn": 20},
    "ransac": {"draw": 20},
    "decentred": {"down": 0.08},
    "rings": {"place": 50},
    "depth": {"depth": 8000},
    "walks": {"X": 200},
    "six": {"alpha_u": 600, "alpha_v": 600},
    "formation": {"X": 200},
    "homography": {"dv2": 40, "dv3": -40},
    "moved": {"who": 50},
    ("pinhole", "focus"): {"lens": 1, "focus": 1},
    ("swing", "row 5"): {"row": 5},
    "similar": {"f": 7},
    "clicks": {"noise": 0.4},
    "eye": {"tilt": 9, "roll": 0},
    "thirteen": {"pair": 3},
    "stop": {"stop": 0},
    "imitation": {"turn": -60},
}
ON_A_WAY = {  # along a curve, by its x
    *(("entries", f"h{k}") for k in range(1, 10)),
    ("residuals", "k1"),
    ("finding", "step"),
    ("tilt", "lens"),
    ("fold", "fold"),
    ("triangle", "turn"),
    ("folds", "k1"),
    ("pinhole", "hole"),
    ("pinhole", "focus"),
    ("ruler", "foot"),
    ("rail", "rail"),
    ("glass", "ball"),
    ("ransac", "draw"),
    ("rings", "place"),
    ("epipolar", "depth"),
    ("stands", "plane"),
    ("zoom", "sensor"),
    ("stands", "alpha"),
    ("similar", "tree"),
    ("similar", "film"),
    ("clicks", "circle"),
    ("protractor", "left"),
    ("protractor", "right"),
    ("stop", "stop"),
    ("eleventh", "left"),
    ("wishes", "m"),
    ("parabola", "t"),
    ("poster", "width"),
    ("thirteen", "number"),
    ("rectification", "seam"),
    ("subpixel", "upper end"),
    ("subpixel", "lower end"),
    ("whose", "middle"),
}
ROUND = {
    ("rim", "ring"),
    ("uphill", "point"),
    ("camera", "camera"),
    ("gimbal", "orange axis"),
    ("rodrigues", "tip in space"),
    ("walks", "line of sight"),
    ("formation", "line of sight"),
    ("rows", "line of sight"),
    ("tilt", "board"),
    ("imitation", "pose"),
    *(("nails", f"nail {i}") for i in range(1, 5)),
}
ON_A_CURVE = {  # its nearest place
    ("sheets", "corner"),
    ("seam", "middle"),
    ("bowl", "far"),
    ("twins", "other"),
    ("twins", "box"),
    ("plane", "depth"),
    ("frame", "corner"),
    ("cube", "camera"),
    ("cube", "pane"),
    ("six", "net"),
    ("lens", "edge"),
    ("moved", "camera"),
    ("moved", "board"),
    ("hinge", "board"),
    ("door", "hinge"),
    ("wishes", "foot"),
    ("origin", "hinge"),
    ("parallel", "ray"),
    ("thirteen", "dot"),
    ("whose", "corner"),
    *(("meet", end) for end in ("a1", "b1", "a2", "b2")),
}
FROM_ONE_TO_ONE = {("clouds", "picture"): 4}  # from picture to picture; the last
TURNS_ABOUT = {
    "rails": (0, 0),
    "line": (0, 0),
    "h": (0, 0),
    "d": (0, 0),
    "dot": (0, 0.5),
    "tip from above": (0, 0),
}  # its length stays
UP_AND_DOWN = {
    "curve",
    "row",
    "depth",
    "eye",
    "top",
    "walk",
    "height",
    "sensor",
    "left end",
    "right end",
}  # the eye to the nearest place of its half circle


def grip_of(drawing, name):
    return next(grip for grip in drawing.grips if grip.name == name)


@pytest.mark.once
@pytest.mark.parametrize(("name", "held"), PULLED)
@pytest.mark.parametrize("by", [(40, 0), (0, -30), (-25, 20)])
def test_what_is_pulled_follows_the_hand(name, held, by):
    model = MODELS[name]
    start = model.values(**FREE_TO_MOVE.get((name, held), FREE_TO_MOVE.get(name, {})))
    before = grip_of(model.drawing(**start), held)
    wanted = np.array(before.at) + np.array(by) * before.unit
    after = grip_of(model.drawing(**model.dragged(held, tuple(wanted), **start)), held)
    off = np.abs(after.at - wanted) / np.abs(before.unit)
    if (name, held) in ROUND:  # on a sphere, see below, or on a circle
        assert after.at != before.at
    elif (name, held) in ON_A_WAY:
        assert off[0] < 9
    elif (name, held) in ON_A_CURVE:
        far = np.linalg.norm((wanted - [before.at, after.at]) / before.unit, axis=1)
        assert far[1] < far[0]
    elif (name, held) in FROM_ONE_TO_ONE:
        assert int(after.at[0]) == min(max(int(wanted[0]), 0), FROM_ONE_TO_ONE[name, held])
    elif held in UP_AND_DOWN:
        assert off[1] < 9 or held == "eye"
    elif held in TURNS_ABOUT:  # its direction follows
        (a, b), (c, d) = wanted - TURNS_ABOUT[held], np.array(after.at) - TURNS_ABOUT[held]
        turned = np.arctan2(a * d - b * c, a * c + b * d)
        assert abs(np.degrees(turned)) <= 0.5 + 1e-9
    else:
        assert off.max() < 9, off  # px; whole degrees are up to 8 px apart


@pytest.mark.once
@pytest.mark.parametrize(("name", "held"), PULLED)
def test_what_is_pulled_far_away_stops_where_the_sliders_do(name, held):
    model = MODELS[name]
    for at in ((1e9, -1e9), (0, 0), (-1e4, 3)):
        check_sight(name, model.dragged(held, at))
    with pytest.raises(CvnotesError, match="two finite numbers"):
        model.dragged(held, (np.nan, 0))


def test_a_camera_carried_round_the_board_keeps_its_middle_where_it_is_in_the_picture():
    model, board = MODELS["camera"], course.board()
    middle = board.points.mean(axis=0)

    def seen(values):
        angles = np.radians([values["angle_x"], values["angle_y"], values["angle_z"]])
        G = pose(rotation_from_angles(*angles), [values["T_x"], values["T_y"], values["T_z"]])
        camera = pinhole(course.camera()).moved(G)
        x, y, z = camera.centre - middle
        radius = np.linalg.norm([x, y, z])
        return radius, np.array([np.arctan2(x, -z), np.arcsin(y / radius)]), camera.project(middle)

    radius, before, pixel = seen(model.values())
    grip = grip_of(model.drawing(), "camera")
    for by in ((30, 10), (-60, 0), (0, -40)):
        at = tuple(np.array(grip.at) + np.array(by) * grip.unit)
        distance, after, now = seen(model.dragged("camera", at))
        assert abs(distance / radius - 1) < 0.01
        assert np.abs(after - before - 2 * np.array(by) * grip.unit / radius).max() < np.radians(
            1.5
        )
        assert np.linalg.norm(now - pixel) < 12  # px; T is in whole millimetres, R in degrees


@pytest.mark.once
@each_model
def test_on_a_narrow_page_panels_come_below_each_other_and_letters_stay_large(name):
    model = MODELS[name]
    wide = model.drawing()
    narrow = model.drawn_on(Paper(narrow=True), model.values())
    assert narrow.picture.shape[1] <= 446  # of 358 px on a telephone: 12 px of a letter are 9.6
    if name not in ("gimbal", "clouds", "six"):  # these have one panel
        assert narrow.picture.shape[1] < 0.7 * wide.picture.shape[1]
    assert narrow.sentence == wide.sentence
    inked = [np.abs(drawing.picture.astype(int) - 255).sum() for drawing in (wide, narrow)]
    assert 0.3 * inked[0] < inked[1] <= inked[0]  # nothing is lost, panels may be smaller
    for grip in narrow.grips:
        assert 0 <= grip.place[0] <= narrow.picture.shape[1]
        assert grip.at == grip_of(wide, grip.name).at


def test_grips_are_where_the_picture_shows_their_marks():
    for narrow in (False, True):
        drawing = MODELS["homography"].drawn_on(
            Paper(2, narrow=narrow), MODELS["homography"].values()
        )
        for grip in drawing.grips:
            u, v = np.rint(2 * np.array(grip.place)).astype(int)
            ink = IDEAL if grip.name == "plus" else ESTIMATED
            assert count(drawing.picture[v - 3 : v + 4, u - 3 : u + 4], ink) > 10, grip.name


# Matrices beside the camera.


def test_beside_the_camera_stands_its_pose_on_the_colours_of_their_sliders():
    moved = {"angle_z": 12, "T_x": -70}
    drawing = MODELS["camera"].drawing(**moved)
    tables = [
        [[cell.replace("−", "-") for cell in re.findall(r">([^<]+)</td>", row)] for row in rows]
        for rows in (re.findall(r"<tr>(.*?)</tr>", t) for t in drawing.matrices.split("<table")[1:])
    ]
    (G,) = (np.array(table, dtype=float) for table in tables)
    assert np.allclose(np.linalg.det(G[:3, :3]), 1, atol=0.05)
    assert G[0, 3] == -70
    tints = {s.name: s.tint for s in MODELS["camera"].settings}
    for name, number in (("angle_x", f"{G[1, 1]:.2f}"), ("T_x", "−70")):
        assert f'background:{tints[name]};color:#000">{number}</td>' in drawing.matrices


# On a page without a kernel.


def data_of(explorer):
    shown = explorer._repr_mimebundle_()["text/html"]
    return json.loads(html.unescape(re.search(r'data-explore="([^"]*)"', shown)[1]))


@pytest.mark.once
@each_model
def test_a_page_is_told_what_its_sliders_need_and_is_answered_with_the_same_picture(name):
    told = data_of(explorations.explore(name))
    model = MODELS[name]
    assert [s["name"] for s in told["settings"]] == [s.name for s in model.settings]
    assert told["sentence"] == model.drawing().sentence
    held = [n for grip in told["grips"] for key in ("place", "at", "unit") for n in grip[key]]
    assert all(float(f"{number:.6g}") == number for number in held)  # no hand holds more digits
    drawn = random_values(model, np.random.default_rng(5))
    values = {key: float(value) for key, value in drawn.items()}
    shown = asked(json.dumps({**told, "values": values}))
    rest = json.loads(shown.rest)
    width, height = rest["size"]
    pixels = np.frombuffer(shown.pixels, np.uint8).reshape(height, width, 4)
    assert np.array_equal(pixels[..., :3], model.picture(**values))
    assert (pixels[..., 3] == 255).all()
    assert rest["values"] == values


def test_a_page_shows_the_camera_and_the_board_that_were_given():
    camera = Camera(intrinsics(500, 505, 250, 190), lens=Lens(k=(-1.7, 0.2)), size=(500, 400))
    told = data_of(explorations.explore("lens", camera=camera))
    own = explorations.model("lens", camera)
    assert json.loads(asked(json.dumps(told)).rest)["sentence"] == own.drawing().sentence
    board = course.Chessboard((6, 5), 40.0)
    told = data_of(explorations.explore("camera", camera=camera, board=board))
    own = explorations.model("camera", camera, board)
    assert json.loads(asked(json.dumps(told)).rest)["sentence"] == own.drawing().sentence


def test_a_page_may_pull_a_grip():
    told = data_of(explorations.explore("homography"))
    grip = told["grips"][0]
    at = [grip["at"][0] + 12, grip["at"][1] - 7]
    rest = json.loads(asked(json.dumps({**told, "grip": grip["name"], "at": at})).rest)
    assert (rest["values"]["du1"], rest["values"]["dv1"]) == (12, -7)


# A corner between the pixels, and what was found in readers' hands.


@pytest.mark.parametrize("corner", [22, 12, 40])
def test_the_pixels_around_a_corner_are_those_of_the_board_through_the_lens(corner):
    # Sampled anew: how much of each small square is light, by the edges of the exact board.
    middle, G = np.rint(course.exact_corners()[6, corner]), course.poses()[6]
    fine = (np.arange(41 * 8) + 0.5) / 8 - 20.5
    xy = course.camera().ideal(np.stack(np.meshgrid(fine, fine), axis=-1) + middle)
    on_board = np.concatenate([xy, np.ones((*xy.shape[:2], 1))], -1)
    x, y, w = np.moveaxis(on_board @ np.linalg.inv(G[:3, [0, 1, 3]]).T, -1, 0)
    light = ((np.floor(x / w / 25) + np.floor(y / w / 25)) % 2).astype(float)
    kernel = np.exp(-0.5 * (np.arange(-40, 41) / (8 * 0.7)) ** 2)
    kernel /= kernel.sum()
    for axis in (0, 1):
        light = np.apply_along_axis(np.convolve, axis, light, kernel, "same")
    share = light.reshape(41, 8, 41, 8).mean(axis=(1, 3))[12:29, 12:29]
    off = neighbourhood(corner) - (30 + 190 * share)  # ink and paper
    assert np.abs(off).max() < 10
    assert off.std() < 2.5  # its noise is 2 grey levels


def test_the_edge_model_that_beats_the_hand_is_that_of_two_blurred_edges():
    y, x = np.mgrid[-8:9, -8:9]
    for corner in (22, 12, 40):
        grey = neighbourhood(corner).astype(float)

        def left_over(p, grey=grey):
            t = p[:3] @ [x.ravel(), y.ravel(), 0 * x.ravel() + 1]
            s = p[3:6] @ [x.ravel(), y.ravel(), 0 * x.ravel() + 1]
            return p[6] + p[7] * erf(t) * erf(s) - grey.ravel()

        sign = -1 if grey[0, 0] < 128 else 1
        p = least_squares(left_over, [1, 0, 0, 0, 1, 0, 125, sign * 80]).x
        m = np.linalg.solve([p[:2], p[3:5]], [-p[2], -p[5]])
        truth = course.exact_corners()[6, corner]
        said = numbers(MODELS["subpixel"].drawing(corner=corner, finders=1).sentence)
        assert np.linalg.norm(m + np.rint(truth) - truth) == pytest.approx(said[4], abs=0.002)


def _true_ends(corner):
    """Give where the board's own lines through a corner pass the borders, 7.5 px from its pixel."""
    m = course.exact_corners()[6].reshape(6, 9, 2)
    row, column = divmod(corner, 9)
    at = m[row, column] - np.rint(m[row, column])
    down, right = m[row + 1, column] - m[row - 1, column], m[row, column + 1] - m[row, column - 1]
    top, bottom = (at[0] + (v - at[1]) * down[0] / down[1] for v in (-7.5, 7.5))
    left, right = (at[1] + (u - at[0]) * right[1] / right[0] for u in (-7.5, 7.5))
    return {"top": top, "bottom": bottom, "left": left, "right": right}


def test_pixels_beside_the_true_edges_lie_on_the_curve_of_a_blurred_edge_up_to_the_noise():
    for corner in (22, 31, 12, 40):
        ends = _true_ends(corner)
        for t, grey in (dots.T for dots in subpixel.dots(corner, subpixel.lines(ends))):
            assert len(t) > 100
            assert 95 * np.std(grey - erf(t / (0.757 * np.sqrt(2)))) < 2.6  # its noise is 2
        said = numbers(MODELS["subpixel"].drawing(corner=corner, finders=1, **ends).sentence)
        assert max(said[:2]) < 2.6
        assert said[2] < 0.02  # the lens bends the board's lines a little
        off = {**ends, "top": ends["top"] + 0.5}
        worse = numbers(MODELS["subpixel"].drawing(corner=corner, finders=1, **off).sentence)
        assert worse[0] > 5 > worse[1]
        slope = np.array([ends["bottom"] - ends["top"], ends["right"] - ends["left"]]) / 15
        middle = subpixel.place_of(corner)[1]
        there = 0.5 * (7.5 - middle) / 15 / (1 - slope[0] * slope[1])
        assert worse[2] == pytest.approx(there * np.hypot(1, slope[1]), abs=0.03)


def test_who_pulls_an_edge_sees_no_finders():
    model = MODELS["subpixel"]
    assert len(numbers(model.drawing().sentence)) == 2
    for held, by, name in (("upper end", (1, 0), "top"), ("right end", (0, 1), "right")):
        grip = grip_of(model.drawing(finders=1), held)
        moved = model.dragged(held, tuple(np.array(grip.at) + by), finders=1)
        assert moved == pytest.approx({**model.values(), name: model.values()[name] + 1})
        assert moved["finders"] == 0


def test_with_the_lens_undone_the_equations_find_the_camera_and_for_parallel_boards_none():
    close, left = folds._CLOSE, folds._SPACE[0] + 6  # panels, side by side
    middle = np.array([MARGIN + close[0] / 2, TITLE + close[1] / 2])  # of the ring
    scale = 0.93 * close[1] / 200  # 100 px to every side of the camera

    def seen(ink, **values):
        """Give places (n, 2) of a colour within the ring, in px from its middle."""
        picture = MODELS["folds"].drawing(**values).picture[: TITLE + close[1], left:]
        v, u = np.nonzero(np.abs(picture.astype(int) - colour(ink)).max(-1) < 60)
        at = (np.column_stack([u, v]) + 0.5 - middle) / scale
        return at[np.hypot(*at.T) < 98]

    W = course.board().points[:, :2]
    A = intrinsics_from_b(solve_b(constraints(dlt(W, course.measured_corners()))))  # the page's
    off = (A[:2, 2] - [325, 238]) * [1, 800 / 804]
    assert np.linalg.norm(off) > 11
    orange = seen(ESTIMATED, k1=0)
    assert (orange.min(0) + orange.max(0)) / 2 == pytest.approx(off - [0, 0.15 * 9 / scale], abs=1)
    assert len(seen(ESTIMATED, k1=-0.25)) > 20
    assert len(seen(ESTIMATED, k1=-0.25, turned=0)) == 0
    # The half circles: lines square to the horizon, which lead past the camera, or through it.
    for k1, near in ((0, False), (-0.25, True)):
        seen_by = xy_from_px(course.camera().A, course.measured_corners())
        straight = Lens(k=(k1, 1.6 * k1**2)).undistort(seen_by)
        blue = seen(LENS, k1=k1)
        assert len(blue) > 60
        off = np.full(len(blue), np.inf)
        for m in straight * 800:  # px from the camera's principal point
            a, b, c, d = vanishing_points(dlt(W, m))
            way = (b - a) / np.linalg.norm(b - a)
            s = [(p - a) @ way for p in (a, b, c, d)]
            foot = a + (s[0] * s[1] - s[2] * s[3]) / (s[0] + s[1] - s[2] - s[3]) * way
            off = np.minimum(off, np.abs((blue - foot) @ way))
            if near:  # through the camera, and as far as 100 px to either side: a chord from above
                assert abs(foot @ way) < 1
                reach = 100 * 800 / np.hypot(800, np.linalg.norm(foot))
                picture = MODELS["folds"].picture(k1=k1)[:, left:]
                for part in (-0.9, -0.4, 0.4, 0.9):
                    at = part * reach * np.array([-way[1], way[0]])
                    u, v = (middle + scale * at).astype(int)
                    assert picture[v - 1 : v + 2, u - 1 : u + 2].min() < 200
        assert off.max() < 2.5


def test_the_horizon_of_the_wall_is_drawn_where_its_parallels_meet():
    values = {"du1": 80, "dv1": 80}
    drawing = MODELS["homography"].drawing(**values)
    m = np.array([grip_of(drawing, f"corner {i}").at for i in range(1, 5)])
    sides = [np.cross([*m[i], 1], [*m[(i + 1) % 4], 1]) for i in range(4)]
    line = np.cross(np.cross(sides[0], sides[2]), np.cross(sides[1], sides[3]))
    dark = drawing.picture[TITLE + 4 : 296, MARGIN + 4 : 370].max(axis=-1) < 60
    hits = 0
    for v in range(20, 440, 3):
        u = -(line[1] * v + line[2]) / line[0]
        x, y = round((u + 20) * 372 / 680), round((v + 15) * 279 / 510)  # white is around it
        hits += 8 < x < 360 and dark[y - 6 : y - 1, max(x - 4, 0) : x + 4].any()
    assert hits > 40  # dashes


def test_a_depth_is_where_the_rays_of_both_columns_meet_and_its_error_grows_with_the_square():
    for X, Z in ((330, 3000), (0, 1500), (440, 4500)):
        left, right = 520 * X / Z, 520 * (X - 200) / Z
        # x = z left / α and x = 200 + z right / α, as two linear equations.
        place = np.linalg.solve([[1, -left / 520], [1, -right / 520]], [0, 200])
        assert place == pytest.approx([X, Z])
        assert columns(X, Z) == pytest.approx((left, right))
        assert triangulated(*np.array([[left], [right]]))[0] == pytest.approx([X, Z])
        said = numbers(MODELS["disparity"].drawing(X=X, Z=Z, sigma=0.25).sentence)
        d = left - right
        near, far = 520 * 200 / (d + 0.25), 520 * 200 / (d - 0.25)
        assert said == pytest.approx([d, Z, 0.25, near, far], abs=0.51)
        assert (far - near) / 2 == pytest.approx(0.25 * Z**2 / (520 * 200), rel=2e-3)


@pytest.mark.parametrize("sigma", [0.05, 0.25, 0.3])
@pytest.mark.parametrize("Z", [1500, 3000, 4500])
def test_diamonds_are_as_long_as_the_square_of_their_depth_and_stay_in_their_panel(
    sigma, Z, monkeypatch
):
    drawn, draw = [], Panel.polygons
    monkeypatch.setattr(Panel, "polygons", lambda *a: (drawn.append(a), draw(*a)))
    MODELS["disparity"].drawing(Z=Z, sigma=sigma)
    count = 1 + sum(abs(z - Z) > 700 for z in (1000, 2000, 4000))
    bars, diamonds = drawn[-2 * count : -count], drawn[-count:]
    for (panel, (bar,), _), (_, (diamond,), _) in zip(bars, diamonds, strict=True):
        depth = bar[:, 1].mean()
        assert np.ptp(bar[:, 1]) == pytest.approx(2 * 20 * 0.01 * depth)
        assert np.ptp(diamond[:, 1]) == pytest.approx(2 * 20 * sigma * depth**2 / 104_000, rel=2e-3)
        for corners in (bar, diamond):
            assert (panel.y[1] < corners[:, 1]).all()
            assert (corners[:, 1] < panel.y[0]).all()
    assert depth == Z


def test_neighbours_that_are_alike_agree_and_noise_does_not():
    noise = np.random.default_rng(3).normal(size=(12, 54, 2))
    assert alike(np.ones((12, 54, 2))) == pytest.approx(1)
    assert abs(alike(noise)) < 0.05
    turned = np.tile([[1.0], [-1.0]], (3, 1)).ravel()  # not along the rows, only from row to row
    assert alike(np.repeat(turned, 9)[None, :, None] * np.ones((12, 1, 2))) == pytest.approx(1)
    shown = MODELS["finding"].drawing
    for step, agreement in ((2, "0.91"), (2.5, "0.72"), (3, "−0.04")):
        said = shown(step=step).sentence.replace("-", "−")
        assert f"photographs agree by {agreement} of 1" in said


def test_a_facing_board_fits_every_focal_length_and_a_tilted_one_its_own_alone():
    """Another way to the best pose: scipy's, over a rotation vector and a place."""
    model, board, c = MODELS["stands"], course.board(), np.array([325, 238])
    held = {"facing": ([0, 0, 0], 394.87), "tilted": ([0, 0.8, 0], 416.49)}  # mm to the middle
    W = board.points - board.points.mean(axis=0)

    def seen(pose_of, alpha):
        x, y, z = (Rotation.from_rotvec(pose_of[:3]).apply(W) + pose_of[3:]).T
        return c + np.column_stack([alpha * x / z, 1.005 * alpha * y / z])

    for alpha in (400, 780, 800, 1200):
        said = numbers(model.drawing(alpha=alpha).sentence)
        assert said[0] == alpha
        for (vector, away), miss in zip(held.values(), (said[2], said[-1]), strict=True):
            m = seen(np.array([*vector, 0, 0, away]), 800)
            start = np.array([*vector, 0, 0, away * alpha / 800])
            least = least_squares(lambda p, m=m, a=alpha: (seen(p, a) - m).ravel(), start)
            if alpha != 800 or vector[1] == 0:
                assert miss == pytest.approx(np.sqrt(2 * least.cost / len(W)), abs=0.051)
        assert said[1] == round(394.87 * alpha / 800)
        assert ("fits, too" in model.drawing(alpha=alpha).sentence) == (alpha == 800)


def test_the_misses_are_drawn_as_far_as_the_focal_length_was_pulled():
    model = MODELS["stands"]
    for alpha in (400, 600, 1000):
        drawing = model.drawing(alpha=alpha)
        grip = grip_of(drawing, "alpha")
        u, v = np.rint(grip.place).astype(int)
        graph = drawing.picture[:, MARGIN + 406 :].astype(int)
        top = TITLE + 260 + 6 + TITLE
        beyond = graph[top : v - 14, u - 406 - MARGIN + 12 :]
        assert count(beyond, ESTIMATED, 60) == 0  # the curve has not been there, nor its words
        before = graph[top : top + 240, : u - 406 - MARGIN - 12]
        assert (count(before, ESTIMATED, 60) > 100) == (alpha > 400)
        assert count(drawing.picture[v - 2 : v + 3, u - 2 : u + 3], ESTIMATED) > 10
    assert model.dragged("plane", (176, 0), alpha=400)["alpha"] == 800
    assert model.dragged("alpha", (811, 9), alpha=400)["alpha"] == 820


@pytest.mark.parametrize(
    ("row", "column", "du", "dv"), [(6, 1, 0, 10), (1, 7, -20, 5), (5, 4, 9, 30)]
)
def test_the_dlts_net_is_that_of_a_plain_svd_and_the_other_has_the_least_error_in_pixels(
    row, column, du, dv
):
    """The floor by two similar triangles: 300 mm below a camera whose horizon is at v = 598."""
    Y = np.repeat([450.0, 600, 900, 1500, 3000, 6000], 7)
    X = np.tile(np.arange(-300.0, 301, 100), 6)
    m = np.column_stack([805 + 800 * X / Y, 598 + 804 * 300 / Y])
    true = m.reshape(6, 7, 2).copy()
    m[7 * (row - 1) + column - 1] += du, dv
    (x, y), (u, v) = (
        ((xy - xy.mean(1, keepdims=True)) * np.sqrt(2)
         / np.hypot(*(xy - xy.mean(1, keepdims=True))).mean())
        for xy in (np.stack([X, Y]), m.T)
    )  # fmt: skip
    o, i = np.zeros(42), np.ones(42)
    D = np.concatenate(
        [[x, y, i, o, o, o, -u * x, -u * y, -u], [o, o, o, x, y, i, -v * x, -v * y, -v]], 1
    ).T
    h = np.linalg.svd(D)[2][8]

    def net(h):
        a, b, c = h.reshape(3, 3) @ [x, y, i]
        size = np.hypot(*(m - m.mean(0)).T).mean() / np.sqrt(2)
        return np.column_stack([a / c, b / c]) * size + m.mean(0)

    least = least_squares(lambda h: (net(h) - m).ravel(), h, xtol=1e-12, ftol=1e-12).x
    both = nets(row, column, du, dv)
    assert np.allclose(both[0], net(h).reshape(6, 7, 2), atol=1e-6)
    assert np.allclose(both[1], net(least).reshape(6, 7, 2), atol=1e-3)
    moved = [np.hypot(*(one - true)[0].T).max() for one in both]
    far, row_1 = np.hypot(du, dv), "row 1 moves by up to {:.1f} px (DLT), {:.1f} px (refined)."
    said = MODELS["swing"].drawing(row=row, column=column, du=du, dv=dv).sentence
    assert said == f"Dot of row {row} pulled by {far:.0f} px: {row_1.format(*moved)}"


def test_arrows_lead_where_row_1_goes_and_each_row_has_its_weight_beside_it(written):
    drawing = MODELS["swing"].drawing(row=5, du=0, dv=40)
    panel = drawing.picture[TITLE : TITLE + 369, MARGIN : MARGIN + 754]
    X = np.arange(-300, 301, 100)
    true = np.column_stack([805 + 800 * X / 450, 0 * X + 598 + 804 * 300 / 450])
    for net, ink, which in zip(
        nets(5, 1, 0, 40), (LENS, ESTIMATED), ((0, 1, 3), (0,)), strict=True
    ):
        for k in which:  # half way along the arrow, which is seven times as long
            at = true[k] + 3.5 * (net[0, k] - true[k])
            u, v = np.rint((at - [115, 525]) * [754 / 1380, 369 / 675]).astype(int)
            assert count(panel[v - 1 : v + 2, u - 1 : u + 2], ink, 90) > 2, (k, ink)
    assert weights() == pytest.approx((np.array([450, 600, 900, 1500, 3000, 6000]) / 450) ** 2)
    beside = {"1": 450, "1.8": 600, "11": 1500, "44": 3000, "weight 178": 6000}
    for words, depth in beside.items():
        assert written[words][1][1] == pytest.approx(598 + 804 * 300 / depth, abs=1)


@pytest.mark.parametrize("out", [540, 0, -400])
def test_the_plain_svd_of_many_pictures_is_where_it_is_drawn(out):
    """The rows of D are written out here, with the noise of half a pixel in 400 pictures."""
    W = np.array([[25.0 * i, 25.0 * j] for j in range(6) for i in range(9)])
    G = course.poses()[6]
    x = np.column_stack([W, 0 * W[:, 0]]) @ G[:3, :3].T + 6 * G[:3, 3]
    x = x @ course.camera().A.T
    m, rng, at = x[:, :2] / x[:, 2:], np.random.default_rng(3), hung_at(out)
    R, (X, Y), o, i = np.zeros((0, 9)), (W - at).T, np.zeros(54), np.ones(54)
    for _ in range(400):
        u, v = (m + rng.normal(scale=0.5, size=m.shape)).T
        D = np.concatenate(
            [[X, Y, i, o, o, o, -u * X, -u * Y, -u], [o, o, o, X, Y, i, -v * X, -v * Y, -v]], 1
        )
        R = np.linalg.qr(np.concatenate([R, D.T]))[1]
    H = np.linalg.svd(R)[2][8].reshape(3, 3)
    a, b, c = H @ [X, Y, i]
    net, drawn = np.column_stack([a / c, b / c]), apply(plain(at), W - at)
    assert np.abs(net - drawn).max() < 0.1
    off = np.sqrt(np.square(net - m).sum(axis=1).mean())
    drawing = MODELS["origin"].drawing(out=out)
    said = numbers(drawing.sentence)
    assert said[3] == pytest.approx(off, abs=0.03)
    assert said[4] == 0.02
    below = drawing.picture[TITLE + 300 + MARGIN + TITLE + MARGIN :]
    places = (m + 10 * (drawn - m) - [190, 161.8]) * 374 / 79
    for k in (0, 8, 53, 27):  # corners of the net that is enlarged, and one within it
        u, v = np.rint(places[k]).astype(int) + [MARGIN, 0]
        near = below[max(v - 2, 0) : v + 3, max(u - 2, 0) : u + 3]
        assert count(near, LENS, 90) + count(near, IDEAL, 90) > 1


@pytest.mark.parametrize("at", [(-300, -300), (100, 60), (500, 300)])
def test_the_board_that_the_plain_svd_believes_in_is_seen_by_the_same_pixels_but_nearer(at):
    origin, true, blue = believed_from(np.array(at, float))
    A = course.camera().A
    for place, seen in (
        (true, corners_of_origin()[1]),
        (blue, apply(plain(np.array(at, float)), corners_of_origin()[0] - at)),
    ):
        m = place @ A.T
        assert np.allclose(m[:, :2] / m[:, 2:], seen, atol=1e-6)
    X = np.column_stack([corners_of_origin()[0] - at, np.ones(54)])
    for place in (true, blue):  # both are plane, and their origin has one depth
        to_space = np.linalg.lstsq(X, place, rcond=None)[0]
        assert np.allclose(X @ to_space, place, atol=1e-6)
        assert to_space[2, 2] == pytest.approx(origin[2], rel=1e-9)
    assert blue[:, 2].mean() < true[:, 2].mean() + 10


@pytest.mark.parametrize("out", [540, 0, -400])
def test_the_door_is_drawn_where_the_plain_svd_has_the_board_and_hangs_on_the_origin(out):
    origin, true, blue = believed_from(hung_at(out))
    drawing = MODELS["origin"].drawing(out=out)
    told = numbers(drawing.sentence)[1:3][::-1]
    assert told == pytest.approx(
        [true[:, 2].mean() / origin[2], blue[:, 2].mean() / origin[2]], abs=5e-3
    )
    scale = 754 / 1650  # px for each mm
    side = drawing.picture[TITLE:, MARGIN:]

    def near(place):
        u, v = np.rint(scale * (place[[2, 1]] - [2100, -530])).astype(int)
        return side[v - 2 : v + 3, u - 2 : u + 3]

    for place, inks in ((true, (IDEAL, LENS)), (blue, (LENS,))):
        for k in (0, 20, 53):
            assert sum(count(near(place[k]), ink, 140) for ink in inks) > 1
    assert count(near(origin), WORLD, 9) > 9
    (grip,) = drawing.grips
    assert np.allclose(grip.at, origin[[2, 1]])
    assert MODELS["origin"].dragged("hinge", tuple(grip.at), out=100) == {"out": out}
    assert (abs(told[0] - told[1]) < 0.005) == (out == 0)  # hung in its middle it does not turn


@pytest.mark.parametrize("given", [{"h8": 0.5}, {"h7": -0.4, "h8": 0.6, "h2": 0.3, "h3": 0.2}])
def test_the_charts_edges_meet_where_the_columns_of_the_nine_entries_say(given):
    drawing = MODELS["entries"].drawing(**given)
    H = np.array(
        [*({f"h{k}": float(k in (1, 5, 9)) for k in range(1, 10)} | {"h7": 0.8} | given).values()]
    )
    x = np.array([[0, 0, 1], [420 / 594, 0, 1], [420 / 594, 1, 1], [0, 1, 1]]) @ H.reshape(3, 3).T
    a, b, c, d = x
    meet = np.array(
        [np.cross(np.cross(a, b), np.cross(d, c)), np.cross(np.cross(a, d), np.cross(b, c)), a]
    )
    assert numbers(drawing.sentence) == pytest.approx(
        (meet[:, :2] / meet[:, 2:]).ravel(), abs=0.006
    )
    assert "stay parallel" in MODELS["entries"].drawing(h7=0).sentence
    middle = (x[:, :2] / x[:, 2:]).mean(axis=0)  # on the paper or on a letter
    u, v = np.rint((middle - [-0.5, -0.3]) * 215 + [MARGIN, TITLE]).astype(int)
    assert count(drawing.picture[v - 1 : v + 2, u - 1 : u + 2], "#D5DADB", 9) == 0


@pytest.mark.parametrize(
    ("k", "corner"),  # where the entry puts a corner of the square of side 1, by hand
    [(2, (0.6, 1)), (3, (0.4, 0)), (4, (1, 0.45)), (6, (0, 0.4)), (7, (1 / 1.9, 0)),
     (8, (0, 1 / 1.9))],
)  # fmt: skip
def test_the_net_of_an_entry_shows_what_this_entry_does(k, corner):
    picture = MODELS["entries"].picture()
    row, column = divmod(k - 1, 3)
    left = MARGIN + 430 + 6  # of the panel with the nets
    at = [left + 106 * column + 27, TITLE + 114 * row + 24] + 42 * np.array(corner)
    u, v = np.rint(at).astype(int)
    ink = (ESTIMATED, LENS, WORLD)[column]
    assert count(picture[v - 2 : v + 3, u - 2 : u + 3], ink, 90) > 3


@pytest.mark.parametrize("draw", [0, 12, 44])
def test_each_wrong_pair_has_a_diamond_and_no_right_one_has(draw):
    true = Camera(course.camera().A, course.poses()[6]).project(course.board().points)
    pairs, picture = drawn_pairs(16)[0], MODELS["ransac"].picture(draw=draw)
    for m, wrong in zip(pairs, np.linalg.norm(pairs - true, axis=1) > 3, strict=True):
        u, v = np.rint([MARGIN, TITLE] + (m - [159.5, 77.5]) * 1.2).astype(int)
        assert (count(picture[v - 1 : v + 2, u - 1 : u + 2], "#FFFFFF", 20) == 9) == wrong, m
        if wrong:
            rim = [count(picture[v - 1 : v + 2, w - 1 : w + 2], IDEAL, 90) for w in (u - 7, u + 7)]
            assert min(rim) > 0, m


LYING = {f"{way}{i}": 0 for way in ("right", "down") for i in range(1, 5)}  # to the camera
HELD = ({}, {"right2": 0, "right3": -12, "down4": 7}, LYING | {"down4": 15, "lens": 1}, {"lens": 1})


@pytest.mark.parametrize("given", HELD)
def test_the_bars_of_four_photographs_are_those_of_all_derivatives_by_differences(given):
    values = MODELS["nails"].values(**given)
    W, G, c = course.board().points, nails.held(values), 2 * int(values["lens"])
    camera = nails.camera_of(values)
    turns = Rotation.from_matrix(G[:, :3, :3])

    def seen(x):
        """Photograph by hand: nothing of the exploration, and nothing of the library."""
        shots = []
        for R, T, step in zip(turns, G[:, :3, 3], x[4 + c :].reshape(4, 6), strict=True):
            X, Y, Z = (Rotation.from_rotvec(step[:3]) * R).apply(W).T + (T + step[3:])[:, None]
            r2 = (X**2 + Y**2) / Z**2
            L = 1 + (x[4] * r2 + x[5] * r2**2 if c else 0)
            shots += [x[0] * L * X / Z + x[2], x[1] * L * Y / Z + x[3]]
        return np.concatenate(shots)

    x = np.concatenate([[800, 804, 325, 238], [-0.25, 0.1][:c], np.zeros(24)])
    u, v = seen(x).reshape(4, 2, 54).transpose(1, 0, 2)
    assert np.allclose([camera.moved(one).project(W) for one in G], np.stack([u, v], -1))
    steps = np.diag(np.where(np.arange(len(x)) < 4, 1e-3, 1e-5))
    J = np.column_stack([(seen(x + h) - seen(x - h)) / (2 * h.max()) for h in steps])
    std = 0.1 * np.sqrt(np.diag(np.linalg.inv(J.T @ J)))[:4]
    ours, rms = nails.known(values)
    assert ours == pytest.approx(std, rel=1e-3)
    assert rms == pytest.approx(0.1 * np.sqrt((432 - len(x)) / 216))
    said = numbers(MODELS["nails"].drawing(**given).sentence.replace("₀", ""))
    assert said == pytest.approx([*std, rms], abs=0.0501)


@pytest.mark.filterwarnings("ignore::cvnotes.base.CalibrationWarning")
@pytest.mark.parametrize("given", HELD)
def test_noisy_photographs_scatter_as_the_bars_say_and_leave_always_the_same_rms(given):
    values = MODELS["nails"].values(**given)
    W, rng = course.board().points, np.random.default_rng(8)
    seen = [nails.camera_of(values).moved(G).project(W) for G in nails.held(values)]
    lens = "k1 k2" if values["lens"] else "none"
    runs = [calibrate(W, rng.normal(seen, 0.1), (640, 480), lens=lens) for _ in range(60)]
    std, rms = nails.known(values)
    found = np.array([[*run.A[[0, 1], [0, 1]], *run.A[:2, 2]] for run in runs])
    assert found.std(axis=0) / std == pytest.approx(1, abs=4 / np.sqrt(2 * 60))
    assert np.mean([run.rms for run in runs]) == pytest.approx(rms, rel=0.02)


def test_boards_that_all_face_the_camera_leave_no_end_to_the_bars_of_the_focal_length():
    *_, u0, v0 = nails.known(MODELS["nails"].values(**LYING, lens=1))[0]
    drawing = MODELS["nails"].drawing(**LYING, lens=1)
    assert drawing.sentence.count("undetermined") == 2
    assert "RMS is 0.14 px" in drawing.sentence
    bars = drawing.picture[TITLE : TITLE + 378, MARGIN + 504 + 2 * MARGIN :]
    unit = 350 / np.log10(3000 / 0.04)  # px for a power of ten
    for i, std in enumerate((3000, 3000, u0, v0)):  # arrows beyond the scale, and dots
        row = bars[round((i + 0.14 + 0.85) * 378 / 5)].astype(int)
        blue = np.flatnonzero(np.abs(row - colour(CAMERA)).max(axis=-1) < 30)
        reach = [-0.4 * unit, 0] if std == 3000 else [-8, 8]
        ends = unit * np.log10(std / 0.04) + np.array(reach)
        assert [blue.min(), blue.max()] == pytest.approx(ends, abs=5)
    assert MODELS["nails"].drawing(**LYING).sentence.count("undetermined") == 4  # without a lens


@pytest.mark.parametrize("i", [1, 2, 3, 4])
def test_a_nail_stands_upright_on_its_board_and_its_head_comes_to_where_it_is_pulled(i):
    model, (w, h) = MODELS["nails"], (640 + 16, 480 + 16)
    for lens in (0, 1):
        for tilt, side in ((0, 0), (25, 70), (38, 200), (12, 300)):
            right, down = tilt * np.cos(np.radians(side)), tilt * np.sin(np.radians(side))
            lean = {f"right{i}": round(right), f"down{i}": round(down), "lens": lens}
            values = model.values(**lean)
            grip = grip_of(model.drawing(**lean), f"nail {i}")
            of_board = nails.held(values)[i - 1]
            x, y = (of_board[:3, :3] @ np.array(one) for one in ([1, 0, 0], [0, 1, 0]))
            head = of_board[:3, :3] @ [100, 62.5, 0] + of_board[:3, 3] - 130 * np.cross(x, y)
            lens_of = Lens(k=(-0.25, 0.1)) if lens else Lens()
            u, v = Camera(course.camera().A, lens=lens_of).project(head)
            assert grip.at == pytest.approx([u + (i - 1) % 2 * w, v + (i - 1) // 2 * h], abs=0.01)
            there = model.dragged(f"nail {i}", grip.at, lens=lens)
            assert [there[f"right{i}"], there[f"down{i}"]] == [round(right), round(down)]
    grip = grip_of(model.drawing(**{f"right{i}": 1, f"down{i}": -1}), f"nail {i}")
    there = model.dragged(f"nail {i}", grip.at, **{f"right{i}": 20, f"down{i}": 9})
    assert there[f"right{i}"] == there[f"down{i}"] == 0  # it springs upright


def test_what_is_left_with_a_believed_k1_is_what_a_library_leaves_that_finds_the_rest():
    cv2 = pytest.importorskip("cv2")
    from cvnotes.show.explorations.residuals import fitted

    W = course.board().points.astype(np.float32)
    m = course.first_corners()
    start = course.camera().A.copy()
    for k1 in (0.0, -0.15, -0.25):
        flags = cv2.CALIB_USE_INTRINSIC_GUESS | cv2.CALIB_FIX_K1 | cv2.CALIB_FIX_K3
        flags |= cv2.CALIB_ZERO_TANGENT_DIST
        missed, A, lens, R, T = cv2.calibrateCamera(
            len(m) * [W],
            list(m.astype(np.float32)),
            course.camera().size,
            start.copy(),
            np.array([k1, 0.0, 0, 0, 0]),
            flags=flags,
            criteria=(cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 200, 1e-14),
        )
        assert lens.ravel()[0] == k1
        seen = [cv2.projectPoints(W, r, t, A, lens)[0][:, 0] for r, t in zip(R, T, strict=True)]
        assert np.abs(fitted(k1) - (np.array(seen) - m)).max() < 2e-3
        assert numbers(MODELS["residuals"].drawing(k1=k1).sentence)[1] == pytest.approx(
            missed, rel=6e-3
        )


def asked_by_hand(warp, u, v):
    """Where pixel (u, v) of a new picture has to ask, by the formulas of the chapter."""
    middle = np.array([29.5, 22])
    if warp == 1:  # turned back, anticlockwise on the screen
        c, s = np.cos(np.radians(20)), np.sin(np.radians(20))
        x, y = np.array([u, v]) - middle
        return middle + [c * x + s * y, c * y - s * x]
    if warp == 2:  # the middle of nine
        return np.array([3.0 * u + 1, 3.0 * v + 1])
    if warp == 3:  # its place on the wall is photographed
        Z, Y = 7600 + (u - 29.5) * 2840 / 60, -300 + (v - 22) * 2840 / 60
        return asks.camera().project([-2979.0, Y, Z])
    x, y = (np.array([u, v]) - middle) / 58
    return middle + 58 * (1 - 0.3 * (x**2 + y**2)) * np.array([x, y])


@pytest.mark.parametrize("warp", [1, 2, 3, 4])
def test_a_new_pixel_asks_where_the_formula_says_and_takes_the_mix_of_four(warp):
    wide, left = (18, 3) if warp == 2 else (6, 1)  # px of the page; of the photograph
    photo = asks.photograph(warp == 4).astype(float)
    for u, v in ((31, 18), (5, 40), (33, 30), (50, 20), (0, 0)):
        drawing = MODELS["asks"].drawing(warp=warp, u=u, v=v)
        at = asked_by_hand(warp, u // left, v // left)
        said = numbers(drawing.sentence)
        assert said[:2] == [u // left, v // left]
        assert said[2:4] == pytest.approx(at, abs=0.0051)
        assert ("beside" in drawing.sentence) == (not ((at > -1) & (at < [60, 45])).all())
        how = {"order": 1, "mode": "grid-constant", "cval": 255}
        taken = [ndimage.map_coordinates(photo[..., k], at[::-1, None], **how)[0] for k in range(3)]
        # Its colour where another is framed, whose line is short; and the lower half of the mix.
        model = MODELS["asks"].drawing(warp=warp, u=59, v=(v + 22) % 45).picture
        corner = np.array([TITLE + wide * (v // left), MARGIN + wide * (u // left)]) + wide // 2
        assert np.abs(model[tuple(corner)] - taken).max() <= 1
        mix = drawing.picture[2 * TITLE + 180 + 6 + 45, 2 * 366 + MARGIN + 90]
        assert np.abs(mix - taken).max() <= 1


def test_a_new_pixel_mixes_four_colours_as_wide_as_they_weigh_and_they_are_lit():
    drawing = MODELS["asks"].drawing(warp=1, u=31, v=18)
    photo, (x, y) = asks.photograph(False), asked_by_hand(1, 31, 18)
    du, dv = x % 1, y % 1
    bar = drawing.picture[2 * TITLE + 180 + 6 + 15, 2 * 366 + MARGIN : 2 * 366 + MARGIN + 180]
    for (i, j), weight in (
        ((0, 0), (1 - du) * (1 - dv)),
        ((1, 0), du * (1 - dv)),
        ((0, 1), (1 - du) * dv),
        ((1, 1), du * dv),
    ):
        ink = photo[int(y) + j, int(x) + i].astype(int)
        assert (np.abs(bar - ink).max(axis=-1) <= 1).mean() == pytest.approx(weight, abs=0.02)
        # Its own pixel of the enlarged piece, and the one beyond it, which is pale.
        place = TITLE + 45 * (1 + j) + 36 - 27 * j, 2 * 366 + MARGIN + 45 * (1 + i) + 9 + 27 * i
        assert np.abs(drawing.picture[place] - ink).max() <= 1
        far = TITLE + 45 * 3 * j + 22, 2 * 366 + MARGIN + 45 * 3 * i + 22
        assert drawing.picture[far].min() > 185


@pytest.mark.parametrize(("u", "v", "tip"), [(0, 0, (0, 11)), (59, 0, (49, 0)), (58, 44, (59, 33))])
def test_what_asks_beside_the_photograph_points_out_of_it_and_weighs_no_pixel(u, v, tip):
    drawing = MODELS["asks"].drawing(warp=1, u=u, v=v)
    x, y = (6 * (np.array(tip) + 0.5)).astype(int) + [366 + MARGIN, TITLE]
    assert count(drawing.picture[y - 12 : y + 13, x - 12 : x + 13], ESTIMATED) > 12
    near = drawing.picture[TITLE + 3 : TITLE + 177, 2 * 366 + MARGIN + 3 : 2 * 366 + MARGIN + 177]
    assert count(near, IDEAL) == 0
    assert count(near, ESTIMATED) > 20


@pytest.mark.parametrize(("u", "v"), [(31, 18), (40, 25), (20, 10)])
def test_the_square_between_the_four_centres_is_cut_where_a_pixel_asks(u, v, monkeypatch):
    drawn, marked = [], []
    for name, noted in (("line", drawn), ("segments", drawn), ("mark", marked)):
        draw = getattr(Panel, name)

        def note(self, at, ink, *rest, draw=draw, noted=noted, **how):
            noted.append((np.array(at, float), ink))
            draw(self, at, ink, *rest, **how)

        monkeypatch.setattr(Panel, name, note)
    x, y = asked_by_hand(1, u, v)
    MODELS["asks"].drawing(warp=1, u=u, v=v)
    low = np.floor([x, y])
    square = low + [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]
    cuts = [[[x, low[1]], [x, low[1] + 1]], [[low[0], y], [low[0] + 1, y]]]
    for shape in (square, cuts):
        assert any(
            ink == ESTIMATED and at.shape == np.shape(shape) and np.allclose(at, shape)
            for at, ink in drawn
        )
    assert any(ink == "lens" and {*map(tuple, at)} == {*map(tuple, square)} for at, ink in marked)


@pytest.mark.parametrize("warp", [1, 2, 3, 4])
def test_each_new_pixel_has_a_dot_and_its_neighbours_are_as_far_off_as_is_said(warp, monkeypatch):
    marked, dots, draw, fill = {}, [], Panel.mark, Panel.polygons

    def mark(self, at, meaning, size=5, *rest):
        marked[(meaning, size)] = np.array(at, float)
        draw(self, at, meaning, size, *rest)

    def polygons(self, corners, ink):
        if not isinstance(ink, str):
            dots.append((np.array(corners).mean(axis=1), np.array(ink)))
        fill(self, corners, ink)

    monkeypatch.setattr(Panel, "mark", mark)
    monkeypatch.setattr(Panel, "polygons", polygons)
    wide, high, left = (20, 15, 3) if warp == 2 else (60, 45, 1)
    for u, v in ((7, 9), (wide - 1, high - 1)):
        said = MODELS["asks"].drawing(warp=warp, u=left * u, v=left * v).sentence
        by_hand = [asked_by_hand(warp, i, j) for j in range(high) for i in range(wide)]
        places, inks = dots.pop()
        np.testing.assert_allclose(places, by_hand, atol=1e-6)
        inner = np.array(by_hand).reshape(high, wide, 2)
        steps = inner[:-1, 1:] - inner[:-1, :-1], inner[1:, :-1] - inner[:-1, :-1]
        skips = np.max([np.hypot(*step.transpose(2, 0, 1)) for step in steps], axis=0) > 1.000001
        assert ((inks.reshape(high, wide)[:-1, :-1] == ESTIMATED) == skips).all()
        at, i, j = asked_by_hand(warp, u, v), min(u + 1, wide - 2), min(v + 1, high - 2)
        apart = [np.hypot(*(asked_by_hand(warp, *one) - at)) for one in ((i, v), (u, j))]
        assert numbers(said)[-5:-3] == pytest.approx(apart, abs=0.0051)
        if warp != 1 or u == 7:  # else it asks beside the photograph
            near = [asked_by_hand(warp, i, j) for j in (v - 1, v, v + 1) for i in (u - 1, u, u + 1)
                    if i < wide and j < high]  # fmt: skip
            np.testing.assert_allclose(marked["estimated", 4], near, atol=1e-6)


def test_a_lens_draws_each_pixel_nearer_to_the_middle_by_a_line():
    for u, v in ((1, 1), (58, 25), (10, 43)):
        drawing = MODELS["asks"].drawing(warp=4, u=40, v=20)
        own, at = np.array([u, v]), asked_by_hand(4, u, v)
        half = np.rint(6 * ((own + at) / 2 + 0.5)).astype(int) + [366 + MARGIN, TITLE]
        beside = drawing.picture[half[1] - 2 : half[1] + 3, half[0] - 2 : half[0] + 3]
        assert count(beside, LENS, atol=110)  # the line is one pixel wide
        said = numbers(MODELS["asks"].drawing(warp=4, u=u, v=v).sentence)
        assert said[4] == pytest.approx(np.hypot(*(own - at)), abs=0.0051)


def test_a_shrunken_picture_reads_one_old_pixel_of_nine_and_a_sun_seen_straight_on_is_round():
    for warp, size in ((1, (60, 45)), (2, (20, 15)), (3, (60, 45)), (4, (60, 45))):
        read = set()
        for u, v in itertools.product(range(size[0]), range(size[1])):
            x, y = asked_by_hand(warp, u, v).round(9)
            for i in {int(np.floor(x)), int(np.ceil(x))}:
                read |= {(i, j) for j in {int(np.floor(y)), int(np.ceil(y))}}
        inside = sum(0 <= i < 60 and 0 <= j < 45 for i, j in read)
        assert numbers(MODELS["asks"].drawing(warp=warp).sentence)[-3:] == [
            size[0] * size[1], inside, 2700,
        ]  # fmt: skip
        assert warp != 2 or inside == 300
    spread = []
    for picture in (asks.photograph(False), asks.answered(3)[0]):
        red = (picture[:35, :, 0].astype(float) - picture[:35, :, 1] - 25).clip(0)
        v, u = np.indices(red.shape)
        spread += [np.sqrt(np.cov(x.ravel(), aweights=red.ravel())) for x in (u, v)]
    assert spread[1] > 1.7 * spread[0]  # in the photograph it is an ellipse
    assert spread[3] == pytest.approx(spread[2], rel=0.1)  # straight on


# What can be pulled in the picture is not asked for by sliders too.


def pulled_by(names, drag):
    """Make a model of three sliders and a switch, of which a hand pulls some."""
    settings = [Setting(name, name, 0, 1, 0.01, 0.5, "a number") for name in "xyz"]

    def draw(paper, values):
        panel = paper.panel((200, 100), (0, 1), (0, 1))
        panel.grip("dot", "the dot", (values["x"], values["y"]))
        return Drawing(paper.join((panel,)), "A dot.")

    choice = Setting("switch", "switch", 0, 1, 1, 0, "yes or no")
    drags = {"dot": lambda values, at: drag(values, at)}
    return Model("dot", "A dot.", (*settings[: len(names)], choice), draw, drags)


def everything(values, at):
    z = {"z": at[0] - at[1]} if "z" in values else {}
    return {**values, "x": at[0], "y": at[1], **z}


def all_but_z(values, at):
    return {**values, "x": at[0], "y": at[1]}


def one_way(values, at):  # a hand that only moves to the right, and down, says all three
    return {**values, "x": max(at[0], 0.5), "y": max(at[1], 0.5), "z": min(at[1], 0.5)}


@pytest.mark.parametrize(
    ("names", "drag", "folded"),
    [
        ("xyz", everything, ("x", "y", "z")),
        ("xyz", one_way, ("x", "y", "z")),
        ("xyz", all_but_z, ()),
        ("xy", everything, ()),  # one row of sliders is as low as the line that opens it
    ],
)
def test_sliders_are_folded_where_a_hand_can_pull_all_that_they_set(names, drag, folded):
    from cvnotes.show.explorations.shell import Explorer

    model = pulled_by(names, drag)
    assert model.folded() == folded
    tinted = replace(model, settings=(model.settings[0]._replace(tint="#FFF0B3"), *model.settings))
    assert tinted.folded() == ()  # its colours are the legend of a matrix
    widget = Explorer(model)
    assert data_of(widget)["folded"] == list(folded)
    controls, *rest = widget.children[2:-1]
    seen = [each for each in controls.children if each in widget.sliders.values()]
    assert seen == [slider for name, slider in widget.sliders.items() if name not in folded]
    assert len(rest) == bool(folded)
    widget.close_all()


def test_a_button_that_the_keyboard_reaches_opens_the_folded_sliders_and_closes_them():
    widget = explorations.explore("homography")
    controls, below = widget.children[2:4]
    fold = controls.children[0]
    assert type(fold).__name__ == "ToggleButton"
    assert list(below.children[0].children) == list(widget.sliders.values())
    for opened, sign, display in ((True, "▾", None), (False, "▸", "none")):
        fold.value = not opened
        fold.value = opened
        assert fold.description == f"{sign} sliders"
        assert below.layout.display == display
    slider = widget.sliders["du1"]  # folded or not, it stands where the corner was pulled to
    pulled = {"number": 1, "grip": "corner 1", "at": [12, -7], "values": widget.values}
    start = widget.image.value
    widget._pulled.value = json.dumps(pulled)
    assert slider.value != 0
    assert widget.image.value != start
    widget.close_all()


@pytest.mark.once
@each_model
def test_what_is_folded_can_be_pulled_from_where_it_stands_and_switches_stay(name):
    model = MODELS[name]
    folded = model.folded()
    switches = {s.name for s in model.settings if s.is_choice}
    assert not switches & set(folded)
    assert set(folded) in (set(), {s.name for s in model.settings} - switches)
    assert not folded or len(folded) > 2
    assert bool(folded) == (name in FOLDED)


# Where six and more sliders stood under a picture that says them all, and some with fewer.
FOLDED = {
    "eye",
    "bowl",
    "cube",
    "entries",
    "six",
    "homography",
    "nails",
    "triangle",
    "maps",
    "votes",
    "meet",
    "walks",
    "rod",
    "epipolar",
    "plane",
    "eleventh",
    "poster",
}


@pytest.mark.parametrize("name", MODELS)
def test_coefficients_have_small_digits_wherever_a_reader_meets_them(name, written):
    drawing, model = MODELS[name].drawing(), MODELS[name]
    met = [drawing.sentence, model.about, *written, *(panel.title for panel, _ in written.values())]
    met += [words for s in model.settings for words in (s.label, s.help)]
    met += [grip.label for grip in drawing.grips]
    assert [words for words in met if re.search(r"\b(k[1-6]|p[12]|[uv]0)\b", words)] == []


def test_what_a_pincushion_shows_in_the_corners_comes_from_farther_in():
    sides = {k1: MODELS["lens"].drawing(k1=k1, k2=0).sentence[-4:-1] for k1 in (-0.2, 0.2)}
    assert sides == {-0.2: "out", 0.2: " in"}


@pytest.mark.parametrize("turn", [0, -45, -15, 99, -165])
def test_the_bars_below_the_bowls_are_what_one_view_and_four_know_of_the_camera(turn):
    drawing, way = MODELS["imitation"].drawing(turn=turn), np.radians(turn)
    for views, ink, row in ((1, "#EAAE7F", -0.76), (4, ESTIMATED, -1.38)):
        poses = np.kron(np.eye(views), [[np.cos(way)], [np.sin(way)]])
        J = np.column_stack([np.ones(2 * views), poses])
        std = np.sqrt(np.linalg.inv(J.T @ J)[0, 0])
        assert numbers(drawing.sentence)[-2 + (views > 1)] == pytest.approx(std, abs=6e-3)
        bar = drawing.picture[TITLE + round((4.3 - row) / 6.05 * 392)][MARGIN + 420 + 120 :]
        assert count(bar, ink, atol=12) == pytest.approx(2 * std * 440 / 5.9, abs=5)


def test_the_pose_of_the_bowl_points_to_the_hand_and_imitates_the_camera_along_its_arrow():
    for at, turn in (((1, 1), 45), ((-9, -9), -135), ((0.1, -2), -87), ((-1, 0), 180)):
        assert MODELS["imitation"].dragged("pose", at)["turn"] == turn
        assert ("unknown" in MODELS["imitation"].drawing(turn=turn).sentence) == (
            turn in (45, -135)
        )


def test_the_sun_of_the_width_that_A_gives_is_round_in_its_circle_and_the_guessed_one_is_not():
    exact = poster.camera().project(poster.poster_room().vertices[:4])
    assert poster.wide_by_high(exact) == pytest.approx(2600 / 1200, rel=1e-9)
    top, bottom = exact[[0, 1]], exact[[3, 2]]
    for part in (1, 0.85):  # of the print, from the left: the four stay corners of a rectangle
        half = poster.camera().project([[-2979.0, Y, 6300 + part * 2600] for Y in (-900, 300)])
        at = np.rint([top[0], *half, bottom[0]]).ravel().astype(int).tolist()
        names = [f"{axis}{i}" for i in range(1, 5) for axis in "uv"]
        drawing = MODELS["poster"].drawing(**dict(zip(names, at, strict=True)))
        _, wide, high, ratio, across, down = numbers(drawing.sentence)
        assert ratio == pytest.approx(part * 2600 / 1200, rel=0.015)
        assert across == pytest.approx(down, abs=2)
        assert wide < 0.82 * high
        red = np.abs(drawing.picture.astype(int) - [188, 54, 36]).max(axis=2) < 25
        v, u = np.nonzero(red[:, MARGIN + 446 :])
        below = v > 2 * TITLE + 151 + 6
        for which, round_ in ((~below, wide / high), (below, 1)):
            shown = np.ptp(u[which]) / np.ptp(v[which])
            assert shown == pytest.approx(round_, abs=0.04)


def test_the_corners_of_the_print_stop_before_its_sun_and_a_frame_that_cuts_it_is_told():
    model, low = MODELS["poster"], {s.name: s.low for s in MODELS["poster"].settings}
    for u in (low["u2"], 390, 415):  # along the edges of the print
        v2, v3 = round(70 + (u - 170) * 86 / 245), round(389 - (u - 172) * 84 / 242)
        said = model.drawing(u2=u, v2=v2, u3=u, v3=v3).sentence
        *_, across, down = numbers(said)
        assert across == pytest.approx(down, abs=2)
        assert "cut" not in said
    for pulled in ({"v1": 180, "v2": 215}, {"v3": 240, "v4": 240}):  # edges across the sun
        assert model.drawing(**pulled).sentence.endswith("and the sun is cut by the frame.")


@pytest.mark.parametrize("pulled", [{}, {"v4": 379}, {"u1": 180, "v2": 170}])
def test_a_small_print_has_false_lines_until_each_pixel_blurs_as_much_as_it_shrinks(pulled):
    draw = MODELS["poster"].drawing
    sky = []
    for blur in (0, 1):
        drawing = draw(guess=519, small=1, blur=blur, **pulled)
        panel = drawing.picture[2 * TITLE + 151 + 6 :, MARGIN + 446 :]
        sky.append(panel[14:80, 20:100].std(axis=0).mean())
    assert sky[0] > 20 > 6 > sky[1]
    four = np.array([[170.0, 70], [415, 156], [414, 305], [172, 389]])
    at = poster.asked(four, 86)
    assert at.shape == (40, 86, 2)
    far = [np.hypot(*(at[-1, u] - at[0, u])) / 39 for u in (10, 75)]
    said = draw(guess=519, small=1).sentence
    assert numbers(said) == pytest.approx(far, abs=0.051)


def test_a_board_in_the_air_is_what_both_photographs_say_and_its_rows_are_measured(monkeypatch):
    marked, mark = [], Panel.mark
    monkeypatch.setattr(
        Panel,
        "mark",
        lambda *how, **more: (marked.append((how[0].title, how[2], how[1])), mark(*how, **more)),
    )
    real = course.real_corners()
    for i in (0, 7, 12):
        marked.clear()
        drawing = MODELS["thirteen"].drawing(pair=i + 1)
        by_title = {(title.split(",")[-1].strip(), meaning): at for title, meaning, at in marked}
        for name, m in (("left", real.left[i]), ("right", real.right[i])):
            assert np.allclose(by_title[f"the {name} camera", "lens"], m)
            assert np.allclose(by_title[f"the {name} camera", "estimated"], m[[0, 8]])
        rest = np.arange(13) != i
        rig = calibrate_stereo(
            real.board.points, real.left[rest], real.right[rest], real.size, lens="k1 k2 p1 p2"
        )
        W = triangulate(rig.cameras, [real.left[i], real.right[i]])
        assert np.allclose(by_title["from above", "estimated"], W[[0, 8]][:, [2, 0]], atol=1e-6)
        long = np.linalg.norm(W[8::9] - W[::9], axis=1)
        rows = [at for title, _, at in marked if title == "its six rows (mm)"]
        assert np.allclose(rows, np.column_stack([long, range(1, 7)]), atol=1e-6)
        said = numbers(drawing.sentence)
        assert said[:4] == pytest.approx(
            [i + 1, W[:, 2].mean(), *(long.min(), long.max())], abs=0.5
        )
        dot = grip_of(drawing, "dot").at
        assert MODELS["thirteen"].dragged("dot", dot, pair=5)["pair"] == i + 1


def test_the_number_of_a_pair_stands_on_no_other_dot_and_the_first_is_not_the_worst(monkeypatch):
    told, text = [], Panel.text
    monkeypatch.setattr(
        Panel, "text", lambda *how, **more: (told.append(how[:3]), text(*how, **more))
    )
    every = thirteen.all_measured()
    dots = np.array([[one.promised, one.scatter] for one in every])
    for i in range(1, 14):
        told.clear()
        MODELS["thirteen"].drawing(pair=i)
        (at,) = (
            at for panel, at, words in told
            if panel.title.startswith("scatter") and words == str(i)
        )  # fmt: skip
        away = np.linalg.norm((at - dots) * np.divide([250, 177], [0.7, 0.68]), axis=1)
        assert np.delete(away, i - 1).min() > 15
        assert (np.array(at) < 0.59).all()
    worst = dots[:, 1].argmax(), np.argmax([one.apart for one in every])
    assert MODELS["thirteen"].values()["pair"] - 1 not in worst


def test_two_patches_differ_by_the_rms_of_the_grey_levels_of_15_by_15_pixels():
    depth, at = 4600.0, np.array([320, 420])
    (place,) = seen_by_the_second(at.astype(float), np.array([depth]))
    v, u = np.mgrid[-7:8, -7:8]
    one, other = (np.asarray(photo) for photo in epipolar.in_grey())
    first = one[at[1] + v, at[0] + u]
    x, y = place[0] + u, place[1] + v
    i, j = np.floor(y).astype(int), np.floor(x).astype(int)
    a, b = y - i, x - j
    second = (
        (1 - a) * ((1 - b) * other[i, j] + b * other[i, j + 1])
        + a * ((1 - b) * other[i + 1, j] + b * other[i + 1, j + 1])
    )  # fmt: skip
    rms = np.sqrt(np.mean((second - first) ** 2))
    said = numbers(MODELS["epipolar"].drawing(u=320, v=420, depth=depth).sentence)
    assert said[1] == pytest.approx(rms, abs=0.051)


def test_how_far_a_lens_has_moved_a_pixel_is_said_and_drawn_and_no_line_crosses():
    for u, v in ((4, 4), (55, 40)):
        drawing = MODELS["asks"].drawing(warp=4, u=u, v=v)
        (words,) = [words for words in drawing.sentence.split(", ") if "nearer to the" in words]
        own, at = np.array([u, v]), asked_by_hand(4, u, v)
        assert float(words.split()[0]) == pytest.approx(np.hypot(*(own - at)), abs=0.0051)
        middle = np.rint(6 * ((own + at) / 2 + 0.5)).astype(int) + [366 + MARGIN, TITLE]
        beside = drawing.picture[middle[1] - 3 : middle[1] + 4, middle[0] - 3 : middle[0] + 4]
        assert count(beside, ESTIMATED) > 12  # thick
        between = drawing.picture[TITLE + 10 : TITLE + 260, MARGIN + 180 : MARGIN + 300]
        assert count(between, ESTIMATED) == 0


def test_the_blue_frame_holds_the_waves_that_are_two_new_pixels_long():
    picture = MODELS["rings"].drawing(blur=1, place=20).picture[TITLE:, MARGIN + 366 :]
    blue = np.abs(picture[:360, :360].astype(int) - colour(LENS)).max(axis=2) < 60
    v, u = np.nonzero(blue)
    reach = 240 / 360 * np.ptp(u[v > 180]) / 2
    assert 0.0036 * reach == pytest.approx(1 / 6, rel=0.03)
