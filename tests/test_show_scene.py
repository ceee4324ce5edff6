import json

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

from cvnotes.base import CvnotesError, ShapeError
from cvnotes.camera import (
    Camera,
    Lens,
    intrinsics,
    look_at,
    move,
    pose,
    rotation_from_vector,
)
from cvnotes.pictures.meshes import box
from cvnotes.show import (
    CAMERA,
    ESTIMATED,
    WORLD,
    Faces,
    Label,
    Lines,
    Photo,
    axes_shapes,
    build_scene,
    camera_shapes,
    draw_scene,
    export_glb,
    panels,
    ray_shapes,
    scene_shapes,
    target_shapes,
)
from cvnotes.show.space.directions import sheet
from cvnotes.show.space.order import Part, from_far_to_near
from cvnotes.show.space.shapes import places
from cvnotes.show.space.viewer import GL_FROM_CV
from cvnotes.targets import Chessboard, ThreePlanes, TwoPlanes

A = intrinsics(800, 800, 319.5, 239.5)
POSE = look_at([330, -180, -420], [100, 62, 0])
STRAIGHT = Camera(A, POSE)
BENT = Camera(A, POSE, Lens((-0.25, 0.10), (0.001, 0.0)))
BOARD = Chessboard()


def all_shapes():
    image = np.zeros((480, 640, 3), np.uint8)
    return (
        *target_shapes(BOARD),
        *axes_shapes(),
        *camera_shapes(BENT, image=image),
        *ray_shapes(BENT, [320, 240], to=[0, 0, 0]),
        *scene_shapes(box((0, 50), (0, 50), (0, 50))),
    )


def named(shapes, kind):
    return next(shape for shape in shapes if isinstance(shape, kind))


# The flip between the two conventions.


def test_the_flip_is_half_a_turn_about_x_and_its_own_inverse():
    assert np.array_equal(GL_FROM_CV @ GL_FROM_CV, np.eye(4))
    assert np.array_equal(GL_FROM_CV @ [1, 2, 3, 1], [1, -2, -3, 1])


# What the shapes are.


def test_the_pyramid_of_a_camera_ends_in_the_corners_of_its_picture():
    ends = named(camera_shapes(STRAIGHT, 150.0), Lines).ends
    corners = np.unique(ends[:4].reshape(-1, 3).round(6), axis=0)
    pixels = {tuple(m) for m in STRAIGHT.project(corners).round(3).tolist()}
    assert pixels == {(-0.5, -0.5), (639.5, -0.5), (639.5, 479.5), (-0.5, 479.5)}
    assert np.allclose(STRAIGHT.depth(corners), 150, atol=1e-3)
    assert np.allclose(ends[4:8, 0], STRAIGHT.centre, atol=1e-9)


def test_the_tick_of_a_camera_is_above_its_picture():
    tick = named(camera_shapes(STRAIGHT, 150.0), Lines).ends[-1, 0]
    assert STRAIGHT.project(tick)[1] < -20


def test_a_picture_on_the_image_plane_has_its_first_pixel_at_the_top_left():
    image = np.arange(480 * 640 * 3, dtype=np.uint32).reshape(480, 640, 3).astype(np.uint8)
    photo = named(camera_shapes(STRAIGHT, 150.0, image=image), Photo)
    assert np.allclose(STRAIGHT.project(photo.corners[0]), [-0.5, -0.5], atol=1e-6)
    assert np.allclose(STRAIGHT.project(photo.corners[1]), [639.5, -0.5], atol=1e-6)
    assert np.array_equal(photo.image, image)
    grey = named(camera_shapes(STRAIGHT, image=image[..., 0]), Photo)
    assert np.array_equal(grey.image[..., 2], image[..., 0])


def test_rays_through_the_lens_end_in_the_points_that_the_pixels_show():
    (lines,) = ray_shapes(BENT, BENT.project(BOARD.points), to=BOARD.points)
    assert np.allclose(lines.ends[:, 0], BENT.centre, atol=1e-9)
    assert np.allclose(lines.ends[:, 1], BOARD.points, atol=1e-6)


def test_pixels_beyond_the_lens_have_no_ray():
    camera = Camera(intrinsics(200, 200, 319.5, 239.5), lens=Lens((-0.5,)))
    (lines,) = ray_shapes(camera, [[320, 240], [639, 479]], to=np.eye(2, 3))
    assert len(lines.ends) == 1


@pytest.mark.parametrize("target", [BOARD, TwoPlanes(), ThreePlanes()])
def test_every_inner_corner_is_where_four_squares_of_two_colours_meet(target):
    faces = target_shapes(target)[0]
    dark = faces.colours[:, 0] < 0.5
    for W in target.points[[0, 7, 20, -1]]:
        touching = (np.linalg.norm(faces.corners - W, axis=-1) < 1e-6).any(axis=1)
        on_face = [touching & (np.arange(len(dark)) // 108 == k) for k in range(len(target.faces))]
        assert any(np.count_nonzero(t) == 4 and np.count_nonzero(dark[t]) == 2 for t in on_face)
    # The first square, beyond the origin towards −x and −y, is dark.
    first = move(target.faces[0][0], [-12.5, -12.5, 0])
    nearest = np.linalg.norm(faces.corners.mean(axis=1) - first, axis=-1).argmin()
    assert dark[nearest]
    assert np.count_nonzero(dark) == 35 * len(target.faces)


def test_a_targets_border_is_its_paper():
    border = named(target_shapes(BOARD), Lines).ends
    assert border.shape == (4, 2, 3)
    assert border.reshape(-1, 3).min(axis=0).tolist() == [-50, -50, 0]
    assert border.reshape(-1, 3).max(axis=0).tolist() == [250, 175, 0]


def test_axes_are_as_long_as_asked_and_stand_in_their_frame():
    world_from_frame = pose(np.eye(3), [10, 20, 30])
    ends = named(axes_shapes(world_from_frame, 50.0), Lines).ends
    assert np.allclose(ends[0], [[10, 20, 30], [60, 20, 30]], atol=1e-12)
    tips = {tuple(tip) for tip in ends[:, 1].round(9).tolist()}
    assert {(60, 20, 30), (10, 70, 30), (10, 20, 80)} <= tips


def test_what_is_estimated_has_its_own_colour():
    assert named(camera_shapes(STRAIGHT), Lines).colour == CAMERA
    assert named(axes_shapes(meaning="estimated"), Lines).colour == ESTIMATED
    assert named(axes_shapes(), Lines).colour == WORLD


# Scenes and files.


def test_a_scene_holds_every_shape_with_y_up():
    scene = build_scene(*all_shapes())
    expected = {"target", "target border", "WRF axes", "camera pyramid", "camera picture", "rays"}
    expected |= {"scene"}
    assert expected <= set(scene.geometry)
    board = target_shapes(BOARD)[0].corners.reshape(-1, 3)
    low, high = build_scene(*target_shapes(BOARD)[:1]).bounds
    assert np.allclose(low, [board[:, 0].min(), -board[:, 1].max(), 0], atol=1e-9)
    assert np.allclose(high, [board[:, 0].max(), -board[:, 1].min(), 0], atol=1e-9)


@pytest.mark.parametrize("view", [(20, -40), (0, 0), (90, 0)])
def test_letters_of_a_turned_frame_are_upright_and_face_the_view_in_a_file_too(view):
    turned = pose(rotation_from_vector([2.0, -1, 0.5]), [0, 0, 0])
    scene = build_scene(*axes_shapes(turned, meaning="camera"), view=view)
    right, up, way = scene.camera_transform[:3, :3].T
    ends = 100 * (GL_FROM_CV[:3, :3] @ turned[:3, :3]).T
    for letter, end in zip("xz", ends[[0, 2]], strict=True):
        ink = scene.geometry[letter].vertices - end
        assert np.ptp(ink @ way) < 0.3 * np.ptp(ink @ right)  # its strokes have a body
        assert np.linalg.norm(ink, axis=1).max() < 10  # beside the tip of its axis
    assert np.corrcoef(ink @ right, ink @ up)[0, 1] > 0.2  # the long stroke of a z


def test_two_cameras_of_one_name_are_both_kept():
    scene = build_scene(*camera_shapes(STRAIGHT), *camera_shapes(Camera(A)))
    assert len(scene.geometry) == 2
    assert len(scene.graph.nodes_geometry) == 2


def test_lines_get_a_body_of_a_part_in_500_of_the_scene():
    bar = Lines("bar", np.array([[[0.0, 0, 0], [750, 0, 0]]]), WORLD, 2.0)
    mesh = build_scene(bar).geometry["bar"]
    assert np.allclose(np.ptp(mesh.vertices, axis=0), [750, 3, 3], atol=1e-9)


def test_a_glb_holds_everything_and_no_address_outside(tmp_path):
    export_glb(build_scene(*all_shapes()), tmp_path / "scene.glb")
    file = (tmp_path / "scene.glb").read_bytes()
    assert file[:4] == b"glTF"
    for address in (b"http", b"www.", b"//"):
        assert address not in file[: 20 + int.from_bytes(file[12:16], "little")]
    tree = json.loads(file[20 : 20 + int.from_bytes(file[12:16], "little")])
    assert all("uri" not in part for part in tree["buffers"] + tree["images"])
    assert all(m["doubleSided"] for m in tree["materials"])
    assert all(m["pbrMetallicRoughness"]["metallicFactor"] == 0 for m in tree["materials"])


def test_the_same_scene_is_the_same_file_byte_for_byte(tmp_path):
    for name in ("a.glb", "b.glb"):
        export_glb(build_scene(*all_shapes()), tmp_path / name)
    assert (tmp_path / "a.glb").read_bytes() == (tmp_path / "b.glb").read_bytes()


def test_a_glb_read_back_has_the_same_places_and_the_picture(tmp_path):
    import trimesh

    image = np.random.default_rng(0).integers(0, 255, (48, 64, 3), np.uint8)
    scene = build_scene(*camera_shapes(STRAIGHT, 150.0, image=image), *target_shapes(BOARD))
    export_glb(scene, tmp_path / "scene.glb")
    again = trimesh.load_scene(tmp_path / "scene.glb")
    assert np.allclose(again.bounds, scene.bounds, atol=1e-3)
    material = again.geometry["camera picture"].visual.material
    assert np.array_equal(np.asarray(material.baseColorTexture.convert("RGB")), image)


# Stills.


def pixels(ax):
    """Return what is drawn, (height, width, 3)."""
    canvas = FigureCanvasAgg(ax.figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].astype(int)


def colour_at(ax, W, view):
    """Return the colour with which a place of the world is seen."""
    picture = pixels(ax)
    column, row = ax.transData.transform(sheet(view) @ W)
    return picture[picture.shape[0] - 1 - int(row), int(column)]


def box_of(words):
    """Return the place (pixels) of a label, without its leader."""
    words.get_window_extent()  # puts it where it will be
    return Text.get_window_extent(words)


def square(name, z, colour):
    corners = np.array([[[-50.0, -50, z], [50, -50, z], [50, 50, z], [-50, 50, z]]])
    return Faces(name, corners, np.array([colour]))


def test_a_still_has_equal_scales_y_downwards_and_no_axes():
    ax = draw_scene(*all_shapes())
    assert ax.get_aspect() == 1
    low, high = ax.get_ylim()
    assert low > high
    assert not ax.axison


def test_a_still_names_what_it_shows():
    shapes = (*all_shapes(), *camera_shapes(STRAIGHT, name="camera 2"))
    texts = [text.get_text() for text in draw_scene(*shapes).texts]
    assert texts == ["WRF", *"XYZ", "camera", "camera 2"]


VIEWS = [(20, -40), (5, -90), (60, 10), (-20, 120), (25, -62), (89, -90), (18, 0)]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("view", "scale"), [*((view, 1) for view in VIEWS), (VIEWS[0], 0.002), (VIEWS[0], 40)]
)
def test_labels_of_a_still_meet_neither_each_other_nor_what_is_drawn_and_are_not_cut(view, scale):
    shapes = [
        *target_shapes(Chessboard((9, 6), 25.0 * scale)),
        *axes_shapes(length=80 * scale),
        *camera_shapes(Camera(A, pose(np.eye(3), [-80 * scale, 0, 600 * scale])), 150 * scale),
    ]
    unnamed = [shape for shape in shapes if not isinstance(shape, Label)]
    anchors = [Label(" ", shape.at, WORLD) for shape in shapes if isinstance(shape, Label)]
    bare = pixels(draw_scene(*unnamed, *anchors, view=view))  # as large, but without words
    ax = draw_scene(*shapes, view=view)
    boxes = [box_of(words) for words in ax.texts]
    assert len(boxes) == 5
    for i, place in enumerate(boxes):
        low, high = np.floor(place.p0).astype(int), np.ceil(place.p1).astype(int)
        assert (low >= 0).all()
        assert (high <= ax.figure.bbox.size).all()
        assert (bare[::-1][low[1] : high[1], low[0] : high[0]] > 240).all(), ax.texts[i].get_text()
        assert not any(place.overlaps(other) for other in boxes[:i])


@pytest.mark.parametrize("view", VIEWS)
def test_a_still_fills_its_place_and_stays_within(view):
    ax = draw_scene(*all_shapes(), view=view)
    seen = ax.transData.transform(places(*all_shapes()) @ sheet(view).T)
    low, high = seen.min(axis=0), seen.max(axis=0)
    size = np.array(ax.figure.bbox.size)
    assert (low > 0).all()
    assert (high < size).all()
    assert ((high - low) / size).max() > 0.8


def test_a_still_beside_others_stays_in_its_own_place():
    _, right = panels(2)
    assert draw_scene(*all_shapes(), ax=right, view=(25, -60)) is right
    assert (pixels(right)[:, :300] == 255).all(axis=-1).sum() > 0.9 * 300 * right.figure.bbox.height
    place = right.get_position(original=True).transformed(right.figure.transFigure)
    for words in right.texts:
        assert place.x0 - 1 <= box_of(words).x0


def test_a_still_leaves_no_figure_behind():
    import matplotlib.pyplot as plt

    draw_scene(*axes_shapes())
    assert plt.get_fignums() == []


def test_a_nearer_face_is_painted_over_a_farther_one():
    near, far = square("near", 0, (1, 0, 0, 1)), square("far", 200, (0, 0, 1, 1))
    for shapes in ((near, far), (far, near)):
        picture = pixels(draw_scene(*shapes, view=(0, -90)))  # looks along +z
        red = (picture[..., 0] > 200) & (picture[..., 2] < 50)
        blue = (picture[..., 2] > 200) & (picture[..., 0] < 50)
        assert np.count_nonzero(red) > 10_000
        assert np.count_nonzero(blue) == 0


@pytest.mark.parametrize("first", [0, 1])
def test_of_faces_that_pass_through_each_other_each_hides_a_part_of_the_other(first):
    """One face stands upright in the other's middle: half of it is before, half behind."""
    level = square("level", 0, (1, 0, 0, 1))
    across = Faces("across", level.corners[..., [2, 1, 0]], np.array([[0, 0, 1.0, 1]]))
    view = (0, -120)
    shapes = (level, across)[:: 1 - 2 * first]
    ax = draw_scene(*shapes, view=view)
    assert colour_at(ax, [0, 0, -40], view)[2] > 200  # the half before the level face
    assert colour_at(ax, [0, 0, 40], view)[0] > 200  # that behind it


def test_a_line_is_hidden_by_a_face_and_shows_through_only_a_little():
    wall = square("wall", 0, (1, 1, 1, 1))
    ray = Lines("ray", np.array([[[0.0, -20, -90], [0, 20, 90]]]), "#000000", 4)
    view = (0, -120)
    ax = draw_scene(wall, ray, view=view)
    before, behind = (colour_at(ax, [0, 20 * s, 90 * s], view).mean() for s in (-0.3, 0.3))
    assert before < 20
    assert 150 < behind < 230


def test_a_ray_pierces_the_picture_where_its_pixel_is_and_has_a_dot_there():
    image, m = np.full((480, 640, 3), 255, np.uint8), np.array([[100.0, 400], [900, 100]])
    view = (20, -130)
    shapes = (
        *camera_shapes(STRAIGHT, 100.0, image=image),
        *ray_shapes(STRAIGHT, m, to=STRAIGHT.centre + 400 * STRAIGHT.ray(m)),
    )
    ax = draw_scene(*shapes, view=view)
    dots = np.concatenate([line.get_xydata() for line in ax.lines if line.get_marker() == "o"])
    at = STRAIGHT.centre + 100 * STRAIGHT.R.T @ [(100 - 319.5) / 800, (400 - 239.5) / 800, 1]
    assert np.allclose(dots, [sheet(view) @ at])  # the other ray passes beside the picture


def test_a_picture_lies_on_the_image_plane_as_the_camera_sees_it():
    image = np.full((480, 640, 3), 255, np.uint8)
    image[240:, :320] = (200, 0, 0)  # its lower left quarter
    view = (15, -70)
    ax = draw_scene(*camera_shapes(STRAIGHT, 100.0, image=image), view=view)
    for u, v in ((80, 400), (240, 300), (80, 100), (500, 400)):
        ray = STRAIGHT.R.T @ [(u - 319.5) / 800, (v - 239.5) / 800, 1]
        colour = colour_at(ax, STRAIGHT.centre + 100 * ray, view)
        assert np.allclose(colour, image[v, u], atol=3), (u, v)


@pytest.mark.parametrize("towards", [[0.0, 0, -1], [0.6, -0.3, -0.8], [0.0, 0, 1]])
def test_painted_from_far_to_near_no_part_hides_a_nearer_one(towards):
    """Triangles anywhere: along lines of sight through all of them the last painted is nearest."""
    rng = np.random.default_rng(5)
    towards = np.array(towards) / np.linalg.norm(towards)
    parts = [Part(corners, i) for i, corners in enumerate(rng.normal(size=(12, 3, 3)))]
    ordered = from_far_to_near(parts, towards, 1e-9)
    assert {part.paint for part in ordered} == set(range(12))
    hit = 0
    for eye in rng.normal(scale=0.5, size=(200, 3)):
        whole = {part.paint: depth_of(part.corners, eye, towards) for part in parts}
        painted = [part.paint for part in ordered if depth_of(part.corners, eye, towards)]
        if painted:
            assert painted[-1] == max((d, i) for i, d in whole.items() if d is not None)[1]
            hit += len(painted) > 1
    assert hit > 50


def depth_of(corners, eye, towards):
    """Return how far towards the viewer a line of sight meets a convex face, or None beside it."""
    for i in range(1, len(corners) - 1):
        a, b, c = corners[[0, i, i + 1]]
        s, t, d = np.linalg.solve(np.stack([b - a, c - a, -towards], axis=1), eye - a)
        if s >= 0 and t >= 0 and s + t <= 1:
            return d
    return None


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: draw_scene(), CvnotesError, "at least one shape"),
        (lambda: build_scene(), CvnotesError, "at least one shape"),
        (lambda: axes_shapes(meaning="red"), CvnotesError, "world, camera, ideal"),
        (lambda: ray_shapes(STRAIGHT, [[1, 2]], to=np.eye(3)), ShapeError, "one point for each"),
        (lambda: camera_shapes(STRAIGHT, image=np.ones((4, 4))), CvnotesError, "expected uint8"),
    ],
)
def test_what_cannot_be_shown_is_refused_in_words(make, error, words):
    with pytest.raises(error, match=words):
        make()


def test_labels_alone_make_a_still_too():
    ax = draw_scene(Label("here", np.array([1.0, 2, 3]), WORLD), *axes_shapes(length=5.0))
    assert "here" in [text.get_text() for text in ax.texts]


def test_a_colour_is_the_same_under_the_viewers_lamp_and_seen_in_the_shade_too():
    scene = build_scene(Lines("rail", np.array([[[0.0, 0, 0], [0, 0, 9]]]), "#009e73", 2))
    [rail] = scene.geometry.values()
    paint = rail.visual.material
    lit = np.asarray(paint.baseColorFactor[:3]) / 255 + paint.emissiveFactor
    assert np.allclose(lit, np.array([0x00, 0x9E, 0x73]) / 255, atol=0.003)
    assert (paint.emissiveFactor >= 0.5 * lit).all()


@pytest.mark.parametrize("view", [(20, -40), (25, -75), (0, 0), (90, 0)])
def test_a_viewer_starts_where_the_still_is_seen_from_and_sees_everything(view):
    shapes = [*camera_shapes(Camera(intrinsics(800, 800, 320, 240)), 100), *axes_shapes(length=80)]
    scene = build_scene(*shapes, view=view)
    G = scene.camera_transform
    elevation, azimuth = np.radians(view)
    level = np.cos(elevation)  # in OpenGL's frame y points up, and z against the course's
    way = [level * np.cos(azimuth), np.sin(elevation), -level * np.sin(azimuth)]
    assert np.allclose(G[:3, 2], way)
    assert np.allclose(G[:3, :3] @ G[:3, :3].T, np.eye(3))
    assert np.linalg.det(G[:3, :3]) > 0
    assert G[1, 1] >= -1e-12  # upright
    corners = np.concatenate([mesh.vertices for mesh in scene.dump()])
    x, y, z = ((corners - G[:3, 3]) @ G[:3, :3]).T
    high = np.abs(y / z).max() / np.tan(np.radians(22.5))
    wide = np.abs(x / z).max() / np.tan(np.radians(22.5)) / 1.2
    assert 0.8 < max(high, wide) < 1  # all of it, and it fills the frame
    assert scene.camera.z_near < -z.max()
    assert -z.min() < scene.camera.z_far < 2000 * scene.camera.z_near  # depths are told apart
