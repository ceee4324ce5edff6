"""Figures of chapter 7: what of a cube is seen, how the arrow is made."""

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from scipy import ndimage

from cvnotes.base import DegenerateError, ShapeError
from cvnotes.camera import Camera, Lens, intrinsics, look_at
from cvnotes.show import draw_cube, draw_image

CENTRE = np.array([320.0, 240])
SENSOR = intrinsics(400, 400, *CENTRE)
DESK = look_at([226, 345, -185], [100, 62, 0], up=(0, 0, -1))


# The cube.

SIDE = 50.0


def seen(camera):
    """The faces drawn, as the corners of their polygons, without the shadow."""
    ax = draw_cube(camera, SIDE, origin=(25, 0))
    return [patch.get_xy()[:-1][::16] for patch in ax.patches[1:]]


def same_face(face, expected):
    return all(np.isclose(face, corner, atol=1e-9).all(1).any() for corner in expected)


def test_from_above_only_the_top_is_seen():
    camera = Camera(SENSOR, look_at([50, 25, -600], [50, 25, 0]))
    (top,) = seen(camera)
    corners = [[25, 0, -50], [75, 0, -50], [75, 50, -50], [25, 50, -50]]
    assert same_face(top, camera.project(corners))


@pytest.mark.parametrize(
    ("eye", "x", "y"),
    [([400, 400], 75, 50), ([-300, 400], 25, 50), ([-300, -300], 25, 0), ([400, -300], 75, 0)],
)
def test_from_aside_the_top_and_the_two_sides_towards_the_eye_are_seen(eye, x, y):
    camera = Camera(SENSOR, look_at([*eye, -300], [50, 25, 0], up=(0, 0, -1)))
    faces = seen(camera)
    assert len(faces) == 3
    wall_x = camera.project([[x, 0, 0], [x, 50, 0], [x, 50, -50], [x, 0, -50]])
    wall_y = camera.project([[25, y, 0], [75, y, 0], [75, y, -50], [25, y, -50]])
    for wall in (wall_x, wall_y):
        assert sum(same_face(face, wall) for face in faces) == 1


def test_the_lens_bends_the_edges():
    G = look_at([150, 100, -250], [50, 25, 0])
    straight, bent = (
        draw_cube(Camera(SENSOR, G, Lens(k=k)), SIDE).patches[1].get_xy() for k in ((), (-0.3,))
    )
    edge = straight[16] - straight[0]
    off = [
        abs(np.linalg.det([edge, outline[8] - outline[0]])) / np.linalg.norm(edge)
        for outline in (straight, bent)
    ]
    assert off[0] < 1e-9
    assert np.linalg.norm(bent[8] - (bent[0] + bent[16]) / 2) > 0.02


def test_a_cube_behind_the_camera_is_refused():
    with pytest.raises(DegenerateError, match="no image"):
        draw_cube(Camera(SENSOR), SIDE)


def test_a_cubes_sides_are_as_bright_as_the_light_falls_on_them_and_flat_light_throws_no_shadow():
    camera = Camera(SENSOR, look_at([400, 400, -300], [50, 25, 0], up=(0, 0, -1)))
    cubes = {light: draw_cube(camera, SIDE, light=light) for light in ((1, 0, -1), (0, 1, -0.2))}
    (steep, flat) = cubes.values()
    assert len(steep.patches) == 4
    assert len(flat.patches) == 3  # top and two sides: no shadow
    top, right, low = (np.array(p.get_facecolor()[:3]) for p in steep.patches[1:])
    assert np.allclose(top, right)  # both are lit under 45°
    assert low.max() < right.max()
    # The shadow of the corner at the top left falls 50 mm to the left of its foot.
    shadow = steep.patches[0].get_xy()
    assert np.abs(shadow - camera.project([-50, 0, 0])).sum(axis=1).min() < 0.5
    with pytest.raises(ShapeError):
        draw_cube(camera, SIDE, light=(0, 1))


def test_a_shadow_darkens_what_it_falls_on_be_it_black_or_white():
    bare, drawn = [], []
    for grey in (15, 128, 242):
        ax = draw_image(np.full((480, 640), grey, np.uint8))
        bare.append(_pixels(ax))
        drawn.append(_pixels(draw_cube(Camera(SENSOR, DESK), SIDE, ax=ax)))
    cube = np.abs(drawn[0] - drawn[2]).max(axis=-1) < 10  # it hides the ground, and so does a frame
    ground = ~ndimage.binary_dilation(cube, iterations=2)
    for before, after in zip(bare, drawn, strict=True):
        assert (after <= before + 1)[ground].all()
        assert (after.max(axis=-1) < 0.6 * before.max(axis=-1))[ground].sum() > 300


def _pixels(ax):
    canvas = FigureCanvasAgg(ax.figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].astype(int)


def test_each_face_that_is_seen_has_its_own_number_of_spots_around_its_middle():
    camera = Camera(SENSOR, look_at([226, 345, -185], [50, 25, 0], up=(0, 0, -1)))
    faces = draw_cube(camera, SIDE, origin=(25, 0)).collections[1:]  # after the shade of the foot
    spots = [np.array([path.vertices.mean(axis=0) for path in face.get_paths()]) for face in faces]
    assert [len(each) for each in spots] == [5, 4, 6]  # the top, high x, high y
    middles = camera.project([[50, 25, -50], [75, 25, -25], [50, 50, -25]])
    for each, middle in zip(spots, middles, strict=True):
        assert np.abs(each.mean(axis=0) - middle).max() < 2
