"""Figures: what they say is where it should be, nothing is cut off, each has its text."""

import base64
import io
import re
import subprocess
import sys

import numpy as np
import pytest
from fontTools.ttLib import TTFont
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image

from cvnotes.base import CvnotesError, InputTypeError, ShapeError
from cvnotes.camera import Camera, look_at
from cvnotes.pictures import chart_room, course, render_scene
from cvnotes.show import (
    chain,
    draw_corners,
    draw_image,
    draw_lines,
    draw_points,
    eight_projects,
    exercise_map,
    one_corner,
    panels,
    show,
)
from cvnotes.show.explorations.lettering import stamp
from cvnotes.show.picture import encode, packed, pixels_of, with_palette
from cvnotes.show.style import COLOURS, ESTIMATED, INK, MARKERS
from cvnotes.targets import Chessboard

RNG = np.random.default_rng(7)
GREY = RNG.integers(0, 255, (48, 64), dtype=np.uint8)
BOARD = Chessboard((4, 3), 10.0)
CORNERS = BOARD.points[:, :2] + 12.0


DRAWN = {
    "image": lambda ax: draw_image(GREY, ax=ax, title="a picture", ticks=True),
    "points": lambda ax: draw_points(CORNERS, size=(64, 48), ax=ax),
    "corners": lambda ax: draw_corners(GREY, CORNERS, BOARD, ax=ax),
}


# --- what holds for every figure ------------------------------------------------------------


@pytest.mark.parametrize("name", DRAWN)
def test_a_figure_is_drawn_on_the_axes_it_is_given_and_on_no_others(name):
    left, right = panels(2)
    assert DRAWN[name](left) is left
    assert not right.has_data()
    new = DRAWN[name](None)
    assert new.figure is not left.figure


@pytest.mark.parametrize("name", [name for name in DRAWN if DRAWN[name](None).get_xticks().size])
def test_every_axis_with_numbers_has_a_label_with_its_unit(name):
    ax = DRAWN[name](None)
    assert ax.get_ylabel().endswith(("(px)", "(px per point)", "(mm)"))
    assert ax.get_xlabel().endswith(("(px)", "(mm)")) or ax.get_xlabel() == "view"


def texts_of(ax):
    """List the texts that are really drawn: ticks outside of the limits are not."""
    texts = [ax.title, ax.xaxis.label, ax.yaxis.label, *ax.texts]
    texts += ax.get_legend().get_texts() if ax.get_legend() else []
    for axis in (ax.xaxis, ax.yaxis):
        low, high = sorted(axis.get_view_interval())
        texts += [t.label1 for t in axis.get_major_ticks() if low <= t.get_loc() <= high]
    return [text for text in texts if text.get_text().strip()]


@pytest.mark.parametrize("name", DRAWN)
def test_no_text_is_cut_off_and_no_two_texts_overlap(name):
    ax = DRAWN[name](None)
    canvas = FigureCanvasAgg(ax.figure)
    canvas.draw()
    texts = texts_of(ax)
    boxes = [text.get_window_extent(canvas.get_renderer()) for text in texts]
    assert len(boxes) >= {"corners": 6, "residuals": 1}.get(name, 8)
    for i, box in enumerate(boxes):
        assert ax.figure.bbox.count_contains(box.get_points()) == 2, texts[i]
        assert not box.count_overlaps(boxes[:i]), texts[i]


@pytest.mark.parametrize("name", ["image", "points", "corners"])
def test_pixels_have_v_downwards_equal_scales_and_centres_at_integers(name):
    ax = DRAWN[name](None)
    assert ax.get_xlim() == (-0.5, 63.5)
    assert ax.get_ylim() == (47.5, -0.5)
    assert ax.get_aspect() == 1


@pytest.mark.slow
def test_drawing_touches_no_global_state():
    code = (
        "import sys, numpy as np, matplotlib\n"
        "before = matplotlib.rcParams.copy()\n"
        "from cvnotes.show import *\n"
        "show(draw_image(np.zeros((9, 9), np.uint8)), alt='black')\n"
        "assert matplotlib.rcParams.copy() == before\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


# --- pictures and points --------------------------------------------------------------------


@pytest.mark.parametrize(
    ("image", "grey", "shown"),
    [
        (np.array([[0, 255, 51]], np.uint8), True, [0, 1, 0.2]),
        (np.array([[0, 500, 100]], np.uint16), True, [0, 1, 0.2]),
        (np.array([[0.0, 1.0, 0.2]]), True, [0, 1, 0.2]),
        (np.array([[False, True, False]]), True, [0, 1, 0]),
        (np.full((1, 3, 3), 255, np.uint8), False, None),
    ],
)
def test_black_is_black_and_white_is_white_whatever_the_type(image, grey, shown):
    drawn = draw_image(image).images[0]
    if grey:
        assert drawn.norm(drawn.get_array().astype(float)).tolist() == [pytest.approx(shown)]
    else:
        assert drawn.get_array().shape == (1, 3, 3)


@pytest.mark.parametrize("shape", [(3,), (0, 5), (2, 2, 4), (1, 2, 3, 4)])
def test_what_is_no_picture_is_refused(shape):
    with pytest.raises(ShapeError, match=r"image: expected \(height, width\) or"):
        draw_image(np.zeros(shape))


def test_a_picture_of_text_is_refused():
    with pytest.raises(InputTypeError, match="image: expected a numeric array"):
        draw_image([["a", "b"]])


def test_points_lie_where_they_were_given_and_nan_rows_are_left_out():
    drawn = draw_points([[[1, 2], [np.nan, np.nan]], [[3, 4], [5, 6]]], meaning="lens").collections
    kept = drawn[0].get_offsets()
    assert kept[~np.ma.getmaskarray(kept).any(1)].tolist() == [[1, 2], [3, 4], [5, 6]]


def test_a_wrong_meaning_or_shape_is_said():
    with pytest.raises(CvnotesError, match="meaning: expected one of world, camera, ideal, lens"):
        draw_points([[1, 2]], meaning="guess")
    with pytest.raises(ShapeError, match=r"m: expected positions .*2\), got \(1, 3\)"):
        draw_points([[1, 2, 3]])
    for nothing in (None, "abc", [[1, 2], [3]], [[1, 2j]]):
        with pytest.raises(InputTypeError, match="m: expected"):
            draw_points(nothing)


def test_the_order_of_the_corners_can_be_seen():
    ax = draw_corners(GREY, CORNERS, BOARD)
    rows = [line.get_xydata() for line in ax.lines if len(line.get_xydata()) == 4]
    assert np.array_equal(np.concatenate(rows), CORNERS)
    arrows = [a for a in ax.texts if getattr(a, "arrow_patch", None)]
    assert [tuple(a.xyann) for a in arrows] == [(12.0, 12.0)] * 2
    assert [tuple(a.xy) for a in arrows] == [(32.0, 12.0), (12.0, 32.0)]  # x, then y
    places = {t.get_text(): t.get_position() for t in ax.texts if t.get_text()}
    assert list(places) == ["x", "y", "0", "3", "8", "11"]
    assert places["x"] == pytest.approx((30, 6))  # beside the tips, on the white margin
    assert places["y"] == pytest.approx((6, 30))
    assert places["0"] < (12, 12)
    assert places["11"] > (42, 32)


def test_numbers_stay_inside_a_picture_that_the_board_fills():
    ax = draw_corners(GREY, CORNERS * [1.55, 1.45] - [18, 17], BOARD)
    for text in ax.texts:
        if text.get_text():
            u, v = text.get_position()
            assert 2 < u < 62
            assert 2 < v < 46


def test_corners_of_another_board_are_refused():
    with pytest.raises(ShapeError, match=r"a board of 4×3 has 12, got \(11, 2\)"):
        draw_corners(GREY, CORNERS[:-1], BOARD)


# --- style ----------------------------------------------------------------------------------

# Machado, Oliveira and Fernandes (2009): how linear RGB looks without red or green cones.
SEEN_BY = {
    "most": np.eye(3),
    "the red-blind": [[0.152, 1.053, -0.205], [0.115, 0.786, 0.099], [-0.004, -0.048, 1.052]],
    "the green-blind": [[0.367, 0.861, -0.228], [0.280, 0.673, 0.047], [-0.012, 0.043, 0.969]],
}
XYZ_OF_RGB = np.array(
    [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
)


def lab(colour, seen_by):
    rgb = np.array([int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)])
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    t = XYZ_OF_RGB @ np.clip(SEEN_BY[seen_by] @ linear, 0, 1) / [0.9505, 1, 1.089]
    f = np.where(t > 0.008856, np.cbrt(t), 7.787 * t + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("seen_by", SEEN_BY)
def test_the_five_colours_stay_apart_on_white(seen_by):
    colours = [lab(c, seen_by) for c in [*COLOURS.values(), "#FFFFFF"]]
    apart = [np.linalg.norm(a - b) for i, a in enumerate(colours) for b in colours[:i]]
    assert min(apart) > 20  # ten times what a trained eye just notices


def test_each_meaning_has_a_marker_of_its_own():
    assert COLOURS.keys() == MARKERS.keys()
    assert len(set(MARKERS.values())) == 5


def test_panels_come_one_in_a_row_or_in_rows():
    assert panels(3).shape == (3,)
    assert panels(2, 3).shape == (3, 2)
    figure = panels(2, width=800, height=300).flat[0].figure
    assert figure.get_size_inches().tolist() == [8.0, 3.0]


# --- the page -------------------------------------------------------------------------------


def decoded(picture):
    html = picture._repr_html_()
    return Image.open(io.BytesIO(base64.b64decode(html.split("base64,")[1].split('"')[0])))


def test_a_picture_carries_its_text_and_twice_the_pixels_of_its_width():
    picture = show(draw_image(GREY), alt='Noise, "grey" & <fine>.')
    assert repr(picture) == 'Noise, "grey" & <fine>.'
    html = picture._repr_html_()
    assert '<img alt="Noise, &quot;grey&quot; &amp; &lt;fine&gt;." width="640"' in html
    assert decoded(picture).size[0] == 1280
    assert 'width="320"' in show(draw_image(GREY), alt="noise", width=320)._repr_html_()


def test_a_picture_is_white_behind_its_labels():
    for ax in (draw_points(CORNERS, size=(64, 48)), draw_image(GREY)):
        picture = decoded(show(ax, alt="x"))
        assert picture.convert("RGB").getpixel((0, 0)) == (255, 255, 255)


@pytest.mark.slow
def test_line_drawings_are_small_png_and_photographs_webp():
    figure = draw_points(CORNERS, size=(64, 48)).figure
    data, mime = encode(figure)
    assert mime == "image/png"
    assert len(data) < 30_000
    photograph = RNG.integers(0, 255, (480, 640, 3), dtype=np.uint8)
    assert encode(draw_image(photograph).figure)[1] == "image/webp"
    shade = np.linspace(0.6, 1, 900)[:, None, None] * [[[207, 112, 53], [230, 220, 200]]]
    shaded = shade.astype(np.uint8).repeat(40, axis=1)  # few colours, and a palette would band them
    assert len(np.unique(shaded.reshape(-1, 3), axis=0)) < 500
    steps = shaded + np.arange(8, dtype=np.uint8)[None, :, None].repeat(10, axis=1).reshape(
        1, 80, 1
    )
    assert packed(steps)[1] == "image/webp"


def test_small_dots_on_large_pixels_are_packed_without_loss_and_smaller():
    blocks = RNG.integers(0, 255, (60, 180, 3), dtype=np.uint8).repeat(10, axis=0)
    dotted = blocks.repeat(10, axis=1)
    dotted[::9, ::11] = 0
    data, mime = packed(dotted)
    assert mime == "image/webp"
    assert len(data) < 100_000
    assert (np.asarray(Image.open(io.BytesIO(data))) == dotted).all()


def test_the_colours_of_a_drawing_go_to_its_edges_and_not_to_its_paper():
    """Against Pillow's own choice, in which each pixel counts the same."""
    ax = panels()
    for k in range(20):
        line = np.array([[0.05 * k, 0], [1 - 0.05 * k, 1]])
        ax.plot(*line.T, color=(list(COLOURS.values()) * 4)[k], linewidth=1 + 0.3 * k)
    drawn = Image.fromarray(pixels_of(ax.figure)).convert("RGB")
    plain = drawn.quantize(256, dither=Image.Dither.NONE)
    assert len(drawn.getcolors(4096)) > 1000
    ours, pillows = (
        np.square(np.subtract(few.convert("RGB"), drawn, dtype=float)).mean()
        for few in (with_palette(drawn), plain)
    )
    assert ours < 0.7 * pillows


def test_a_small_thing_keeps_its_colour_beside_lines_of_a_colour_like_it():
    """The switch of chapter 6, which was as orange as the lines."""
    camera = Camera(course.camera().A, look_at([1180, 150, -760], [-60, 340, 0]))
    ax = draw_image(render_scene(chart_room(), camera), ax=panels(height=395))
    ax = draw_lines([[-0.05, -0.3, 30], [-0.5, -1, 700]], ax=ax)
    drawn = pixels_of(ax.figure)[..., :3].astype(int)
    shown = np.asarray(with_palette(Image.fromarray(drawn.astype(np.uint8))).convert("RGB"), int)
    assert np.abs(shown - drawn).max() < 25
    switch = np.abs(drawn - [183, 107, 82]).max(axis=-1) < 12
    assert switch.sum() > 300
    assert np.abs((shown - drawn)[switch].mean(axis=0)).max() < 8


def test_few_colours_are_kept_as_they_are_and_of_many_none_is_lost():
    steps = np.arange(256, dtype=np.uint8)
    few = Image.fromarray(np.stack([steps, steps, 255 - steps], axis=-1)[None].repeat(3, axis=0))
    assert np.array_equal(with_palette(few).convert("RGB"), few)
    many = Image.fromarray(np.random.default_rng(0).integers(0, 256, (80, 80, 3), dtype=np.uint8))
    assert with_palette(many) is None


def test_the_same_figure_gives_the_same_bytes():
    assert encode(draw_points(CORNERS, size=(64, 48)).figure) == encode(
        draw_points(CORNERS, size=(64, 48)).figure
    )


def test_a_figure_is_afterwards_what_it_was():
    figure = draw_points(CORNERS, size=(64, 48)).figure
    figure.set_facecolor("yellow")
    before = figure.canvas, figure.dpi, figure.get_facecolor(), tuple(figure.get_size_inches())
    picture = decoded(show(figure, alt="x")).convert("RGB")
    assert picture.getpixel((0, 0)) == (255, 255, 255)
    now = figure.canvas, figure.dpi, figure.get_facecolor(), tuple(figure.get_size_inches())
    assert now == before


def test_axes_rows_of_axes_and_figures_can_be_shown():
    axes = panels(2)
    for thing in (axes, axes[0], axes[0].figure):
        assert repr(show(thing, alt="two")) == "two"


def test_a_figure_of_pyplot_is_closed():
    pyplot = pytest.importorskip("matplotlib.pyplot")
    figure, _ = pyplot.subplots()
    show(figure, alt="a figure of pyplot")
    assert not pyplot.fignum_exists(figure.number)


def test_a_picture_without_a_text_is_refused():
    with pytest.raises(CvnotesError, match="alt: say in a sentence what the picture shows"):
        show(panels(), alt=" ")


def test_the_head_of_a_chapter_follows_one_corner_and_lights_the_steps_of_the_chapter():
    from xml.etree import ElementTree

    for chapter, lit, forwards in (
        (0, 4, True),
        (4, 1, True),
        (5, 0, True),
        (7, 4, False),
        (10, 1, False),
        (11, 0, True),
    ):
        picture = one_corner(chapter)
        drawn = ElementTree.fromstring(picture.data)
        steps = [text for text in drawn.findall(".//{*}text") if text.get("class") == "s"]
        assert sum(INK[ESTIMATED] in text.get("style") for text in steps) == lit
        ends = [path.get("d") for path in drawn.findall(".//{*}path") if "H" in path.get("d")]
        begin, tip = (float(re.search(rf"{letter}([\d.]+)", ends[0])[1]) for letter in "MH")
        assert (tip > begin) == forwards
        assert "(523, 327)" in picture.alt  # chapter 4 works it out, step by step
    for chapter in (2, 3):  # no lens: 800 · 0.25197 + 325 and 804 · 0.11329 + 238
        bare = one_corner(chapter)
        assert "no lens (0.252, 0.113), pixel (527, 329)" in bare.alt
        assert bare.data.count(b"line-through") == 1
    assert one_corner(4).data.count(b"line-through") == 0
    boxes = [one_corner(chapter).data.count(b"h-144z") for chapter in (4, 5, 11)]
    assert boxes == [0, 1, 1]
    with pytest.raises(CvnotesError, match="0 to 11"):
        one_corner(12)


def test_each_step_of_the_head_can_be_checked_with_the_numbers_that_are_written():
    A, lens = course.camera().A, course.camera().lens
    for chapter in (0, 2):
        said = re.findall(r"\(([-\d., ]+)\)", one_corner(chapter).alt)
        world, camera, plane, behind, pixel = (
            np.array(one.split(","), dtype=float) for one in said
        )
        assert world.tolist() == [200, 125, 0]
        assert (np.round(camera[:2] / camera[2], 3) == plane).all()
        assert (np.round(plane if chapter else lens.distort(plane), 3) == behind).all()
        assert (np.round(A[:2, :2] @ behind + A[:2, 2]) == pixel).all()


def test_the_head_of_chapter_6_leads_from_the_pixel_to_the_board_in_one_orange_step():
    from xml.etree import ElementTree

    drawn = ElementTree.fromstring(one_corner(6).data)
    ways = [path for path in drawn.findall(".//{*}path") if path.get("stroke") == ESTIMATED]
    (texts,) = (t for t in drawn.findall(".//{*}text") if (t.text or "").startswith("H⁻¹"))
    (way,) = ways
    start, end = (float(re.search(rf"{letter}([\d.]+)", way.get("d"))[1]) for letter in "MH")
    middle = {t.text: float(t.get("x")) for t in drawn.findall(".//{*}text")}
    assert (start, end) == (middle["pixel"], middle["world"])
    assert INK[ESTIMATED] in texts.get("style")
    assert float(texts.get("y")) < float(drawn.get("height"))


def test_the_strip_of_chapter_7_shows_the_numbers_that_its_photographs_give():
    from cvnotes.calibration import (
        calibrate,
        constraints,
        extrinsics,
        intrinsics_from_b,
        radial_distortion,
        solve_b,
    )
    from cvnotes.homography import dlt
    from cvnotes.pictures import course

    board, camera, m = course.board(), course.camera(), course.measured_corners()
    H = dlt(board.points[:, :2], m)
    A = intrinsics_from_b(solve_b(constraints(H)))
    rays = np.linalg.solve(camera.A, H)[:, :, :2]
    lengths = np.prod(np.linalg.norm(rays, axis=1), axis=-1)
    angles = np.degrees(np.arccos(np.prod(rays, axis=-1).sum(axis=-1) / lengths))
    G = extrinsics(A, H)
    off = np.linalg.norm(G[:, :3, 3] - course.poses()[:, :3, 3], axis=-1)
    k1, _ = radial_distortion(A, G, board.points, m, terms=2)
    found = calibrate(board.points, m, camera.size)
    rms = np.sqrt(np.mean(np.sum((m - course.exact_corners()) ** 2, axis=-1)))
    for number in (
        f"corners {rms:.3f} px",
        f"H {min(angles):.0f}° to {max(angles):.0f}°",
        f"B {len(constraints(H))} rows 4 unknowns",
        f"A {np.hypot(*(A - camera.A)[:2, 2]):.0f} px off",
        f"poses up to {max(off):.0f} mm off",
        f"lens k₁ = {k1:+.2f} true: −{abs(camera.lens.k[0])}",
        f"all at once {found.rms:.3f} px",
        f"± {found.A[0, 0]:.2f} ± {found.std['alpha_u']:.2f} αᵤ, true: {camera.A[0, 0]:.0f}",
    ):
        assert number in chain().alt


def test_a_link_of_chapter_7_has_its_number_once_its_section_is_read():
    from xml.etree import ElementTree

    for lit, numbers, pale in (
        (("corners",), 0, 7), (("B", "A"), 2, 4), (("±",), 7, 0), ((), 8, 0),
    ):  # fmt: skip
        picture = chain(*lit)
        for drawing, widest in ((picture.data, 920), (picture.narrow, 400)):
            drawn = ElementTree.fromstring(drawing)
            assert int(drawn.get("width")) <= widest
            under = [t.text for t in drawn.findall(".//{*}text") if t.get("class") == "n"]
            assert under[:numbers].count(None) == 0
            assert under[numbers:] == ["?"] * len(lit) + [None] * pale
            faint = [g for g in drawn.findall(".//{*}g") if g.get("opacity") == "0.35"]
            names = [t for t in drawn.findall(".//{*}text") if t.get("class") == "s"]
            assert len(faint) == pale
            assert [t.text for t in names if INK[ESTIMATED] in t.get("style")] == list(lit)
    with pytest.raises(CvnotesError, match="corners, H, B, A, poses"):
        chain("K")


def test_the_sheets_of_projects_and_exercises_have_tiles_each_with_a_part_of_an_exploration():
    from xml.etree import ElementTree

    for picture, names, wide in (
        (eight_projects(), [*"12345678"], 4), (exercise_map(), [*"PVTLCHZWMIYT"], 6),
    ):  # fmt: skip
        for drawing, columns in ((picture.data, wide), (picture.narrow, 2)):
            tiles = ElementTree.fromstring(drawing).findall("{*}g")
            places = [re.findall(r"[\d.]+", tile.get("transform")) for tile in tiles]
            assert len({x for x, _ in places}) == columns
            assert [tile.find("{*}text").text[0] for tile in tiles] == names
            shown = {tile.find("{*}g/{*}image").get("href").split(",")[1] for tile in tiles}
            assert len(shown) == len(tiles)
            for part in shown:
                pixels = np.asarray(Image.open(io.BytesIO(base64.b64decode(part))).convert("RGB"))
                height, width = pixels.shape[:2]
                assert width == 3 * 856 // (2 * wide)  # three pixels for two of the page
                assert abs(width / height - 200 / 140) < 0.02  # as a tile is
                # within the exploration: beyond it all would be black, as Pillow crops
                assert (pixels[[0, -1]].max(axis=(1, 2)) > 60).all()
                assert (pixels[:, [0, -1]].max(axis=(0, 2)) > 60).all()
                assert pixels.std() > 8


def test_on_a_telephone_the_head_of_a_chapter_has_two_rows_in_which_no_words_meet():
    from xml.etree import ElementTree

    picture = one_corner(7)
    drawn = ElementTree.fromstring(picture.narrow)
    assert int(drawn.get("width")) <= 390
    letter = {"t": 7.5, "n": 6.7, "s": 7.5}  # px, the widest mean of a word's letters at its size
    boxes = []
    for text in drawn.findall(".//{*}text"):
        half = letter[text.get("class")] * len(text.text) / 2
        x, y = float(text.get("x")), float(text.get("y"))
        boxes.append((x - half, x + half, y - 11, y + 2))
    rows = {y for *_, y in boxes}
    assert len(boxes) == 14
    assert max(rows) - min(rows) > 150
    for i, (left, right, top, bottom) in enumerate(boxes):
        assert left > -4 - 12
        for other in boxes[:i]:
            apart = right <= other[0] or other[1] <= left or bottom <= other[2] or other[3] <= top
            assert apart
    html = picture._repr_html_()
    narrow = re.search(r'<source media="([^"]+)" srcset="data:image/svg\+xml;base64,([^"]+)"', html)
    assert base64.b64decode(narrow[2]) == picture.narrow
    assert narrow[1] == "(max-width: 600px)"


def _contrast_with_white(colour):
    r, g, b = (int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
    linear = [x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4 for x in (r, g, b)]
    return 1.05 / (0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2] + 0.05)


def test_words_of_every_colour_can_be_read_on_white():
    ax = panels()
    words = [ax.text(0, 0, meaning, color=colour) for meaning, colour in COLOURS.items()]
    lines = [ax.plot([0, 1], color=colour)[0] for colour in COLOURS.values()]
    show(ax, alt="words")
    assert [line.get_color() for line in lines] == list(COLOURS.values())
    assert min(_contrast_with_white(text.get_color()) for text in words) >= 4.5
    assert _contrast_with_white("#767676") == pytest.approx(4.54, abs=0.005)  # as WCAG has it


def test_a_photograph_has_ticks_only_where_pixels_are_read_off():
    assert draw_image(GREY).get_xlabel() == ""
    assert list(draw_image(GREY).get_xticks()) == []
    assert draw_image(GREY, ticks=True).get_xlabel() == "u (px)"


# --- the type ------------------------------------------------------------------------------------


def test_an_index_stands_lower_than_its_letter_and_an_exponent_higher():
    tops = {}
    for words in ("x", "xᵤ", "x²"):
        _, ink, (_, top) = stamp(words, "ls", 40, 0)
        v, u = np.nonzero(np.asarray(ink))
        last = v[u > u.max() - 8] + top  # of the part that stands behind
        tops[words] = last.min(), last.max()
    assert tops["xᵤ"][1] > tops["x"][1] + 4
    assert tops["x²"][0] < tops["x"][0] - 4
    assert tops["x²"][1] < tops["x"][1] - 4


@pytest.mark.parametrize("picture", [one_corner(6), chain("H"), eight_projects(), exercise_map()])
def test_a_strip_brings_the_letters_that_it_shows_in_both_weights(picture):
    for svg in (picture.data.decode(), picture.narrow.decode()):
        texts = re.findall(r"<text([^>]*)>([^<]+)", svg)
        kinds = {"600" if 'class="s"' in how else "400" for how, _ in texts}
        fonts = re.findall(r"font-weight:(\d+);src:url\(data:font/woff;base64,([^)]+)\)", svg)
        assert {weight for weight, _ in fonts} == kinds
        for weight, code in fonts:
            strong = weight == "600"
            shown = "".join(words for how, words in texts if ('class="s"' in how) == strong)
            font = TTFont(io.BytesIO(base64.b64decode(code)))
            lacking = {*map(ord, shown)} - {*font.getBestCmap()}
            assert lacking <= {*map(ord, "ᵤᵥ⁻★")}, (weight, lacking)  # any system has them
            assert font["OS/2"].usWeightClass == int(weight)
