"""Figures of image formation: what they show is where the camera puts it."""

import numpy as np
import pytest

from cvnotes.base import CvnotesError, ShapeError
from cvnotes.camera import Camera, Lens, intrinsics, look_at
from cvnotes.pictures import render_scene, room
from cvnotes.show import (
    arrow_shapes,
    box_lines,
    draw_field_of_view,
    draw_formation,
    draw_sensor,
)

CAMERA = Camera(intrinsics(400, 402, 325, 238), look_at([240, 90, -140], [95, 60, 10]))
BOX = box_lines((0, 200), (0, 125), (0, 80))


def crosses(ax):
    """Where the axes have a cross."""
    return [line.get_xydata()[0] for line in ax.lines if line.get_marker() == "x"]


def test_a_box_has_twelve_edges_of_three_lengths():
    length = np.linalg.norm(BOX[:, -1] - BOX[:, 0], axis=-1)
    assert sorted(length) == pytest.approx([80] * 4 + [125] * 4 + [200] * 4)


@pytest.mark.parametrize("lens", [Lens(), Lens((-0.35, 0.08))])
def test_each_panel_of_the_chain_shows_the_point_after_its_step(lens):
    camera = Camera(CAMERA.A, CAMERA.G, lens)
    W = np.array([200.0, 0, 80])
    axes = draw_formation(camera, BOX, W)
    x, y, z = M = camera.R @ W + camera.T
    xy = np.array([x / z, y / z])
    steps = [W[[0, 2]], M[[0, 2]], xy]
    if lens.k:
        steps.append(xy * (1 - 0.35 * (xy @ xy) + 0.08 * (xy @ xy) ** 2))
    steps.append(camera.project(W))
    assert len(axes) == len(steps)
    numbered = ["1. G", "2. ÷ z", "3. lens", "4. A"] if lens.k else ["1. G", "2. ÷ z", "3. A"]
    assert [ax.texts[-1].get_text() for ax in axes[1:]] == numbered
    assert axes[0].texts[-1].get_text() == "(200, 0, 80)"
    for ax, expected in zip(axes, steps, strict=True):
        (found,) = crosses(ax)
        np.testing.assert_allclose(found, expected, rtol=1e-9)


@pytest.mark.parametrize("lens", [Lens(), Lens((-0.35, 0.08))])
def test_the_pale_wedge_is_what_the_camera_sees_through_its_lens(lens):
    axes = draw_formation(Camera(CAMERA.A, CAMERA.G, lens), BOX, [200, 125, 0])
    (cone,) = [patch.get_xy() for patch in axes[1].patches if len(patch.get_xy()) == 4]
    x, z = cone[1]
    # That border of the picture, sought: where the lens shows x at its first column.
    r = x / z
    seen = 325 + 400 * r * (1 + sum(k * r ** (2 * i) for i, k in enumerate(lens.k, 1)))
    assert seen == pytest.approx(-0.5, abs=1e-6)


def polygons(ax):
    """The corners of each filled polygon, whose edges are in pieces of a sixteenth."""
    return [patch.get_xy()[:-1:16] for patch in ax.patches if len(patch.get_xy()) > 60]


def test_of_the_box_only_faces_that_the_camera_sees_are_drawn():
    axes = draw_formation(Camera(CAMERA.A, CAMERA.G), BOX, [200, 125, 0])
    # The camera, at (240, 90, −140), is beyond the right side and before the front; y is within.
    sides = [
        [[0, 0, 0], [200, 0, 0], [200, 125, 0], [0, 125, 0]],
        [[200, 0, 80], [200, 0, 0], [200, 125, 0], [200, 125, 80]],
    ]
    for face, W in zip(polygons(axes[2])[1:], sides, strict=True):
        x, y, z = CAMERA.R @ np.transpose(W) + CAMERA.T[:, None]
        expected = np.column_stack([x / z, y / z])
        assert all(np.isclose(face, corner).all(1).any() for corner in expected)
    (top,) = polygons(axes[0])
    assert np.ptp(top, axis=0).tolist() == [200, 80]


def test_the_last_panel_is_a_photograph_of_the_box_where_the_camera_sees_it():
    bent = Camera(CAMERA.A, CAMERA.G, Lens((-0.35, 0.08)))
    photograph = np.asarray(draw_formation(bent, BOX, [200, 125, 0])[-1].images[0].get_array())
    (u, v), (u_beside, v_beside) = bent.project([[100, 62, 0], [-170, 62, 80]]).round().astype(int)
    red, green, blue = photograph[v, u].astype(int)
    assert min(green - red, green - blue) > 20
    assert np.ptp(photograph[v_beside, u_beside].astype(int)) < 40  # the table


def test_lines_that_are_points_are_refused():
    with pytest.raises(ShapeError, match=r"expected \(12, n, 3\)"):
        draw_formation(CAMERA, BOX[0], [0, 0, 0])


def test_the_angles_that_two_cameras_see_are_written_beside_them():
    cameras = {f: Camera(intrinsics(f, f, 319.5, 239.5)) for f in (320, 1200)}
    ax = draw_field_of_view({f"{f} px": camera for f, camera in cameras.items()})
    angles = [t.get_text() for t in ax.texts if "°" in t.get_text()]
    assert angles == ["320 px: 90.0°", "1200 px: 29.9°"]
    # Where the sides of the wide angle are is 45° from the axis; the wall of the room is 10 m away.
    sides = [line.get_xydata() for line in ax.lines if line.get_xydata().shape == (3, 2)]
    np.testing.assert_allclose(sides[0], [[10e3, -10e3], [0, 0], [10e3, 10e3]])
    np.testing.assert_allclose(sides[1][2], [10e3, 10e3 * 320 / 1200])
    # The pictures below are the middle rows of what these cameras take of the room.
    whole = render_scene(room(), cameras[1200], samples=16)
    strip = np.asarray(ax.images[1].get_array())
    assert strip.shape == (240, 640, 3)
    assert np.abs(strip.astype(int) - whole[120:360]).mean() < 0.5
    # And the red box is drawn from above where it stands.
    *_, box = [p for p in ax.patches if np.allclose(p.get_facecolor()[:3], (0.78, 0.33, 0.28))]
    assert sorted(box.get_xy()[:4].tolist()) == [
        [7450, 450], [7450, 850], [7850, 450], [7850, 850]]  # fmt: skip


def test_the_columns_of_a_leaning_sensor_lean_and_see_the_same_room():
    A = intrinsics(800, 800, 320, 240, -80.0)
    cells = draw_sensor(A).collections[0]
    first, *_, last = cells.get_coordinates()[:, 0]  # the border at u = −½
    across, along = last - first
    assert along == pytest.approx(480 / 800)
    assert across == pytest.approx(0.1 * along)  # 80 px of 800 for each unit of y
    # What the room shows at one place of the plane z = 1, both sensors have there.
    straight = draw_sensor(intrinsics(800, 800, 320, 240)).collections[0].get_array()
    x, y = cells.get_coordinates()[15:17, 29:31].mean((0, 1))
    upright = straight[int((800 * y + 240.5) / 20), int((800 * x + 320.5) / 20)]
    np.testing.assert_allclose(cells.get_array()[15, 29], upright, atol=0.05)


def test_an_arrow_leads_from_its_start_to_its_end():
    lines, label = arrow_shapes([1, 2, 3], [1, 2, 9], "T")
    np.testing.assert_array_equal(lines.ends[0], [[1, 2, 3], [1, 2, 9]])
    assert (lines.ends[1:, 0] == [1, 2, 9]).all()
    assert label.name == "T"
    with pytest.raises(CvnotesError, match="coincide"):
        arrow_shapes([1, 2, 3], [1, 2, 3])
    with pytest.raises(CvnotesError, match="coincide"):
        arrow_shapes([1e-300, 2e-300, 3e-300], [4e-300, 2e-300, 9e-300])
