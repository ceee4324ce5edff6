"""Figures of the field of view, of a sensor, and arrows: they are where geometry puts them."""

import numpy as np
import pytest

from cvnotes.base import CvnotesError
from cvnotes.camera import Camera, intrinsics
from cvnotes.pictures import render_scene, room
from cvnotes.show import (
    arrow_shapes,
    draw_field_of_view,
    draw_sensor,
)


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
    whole = render_scene(room(), cameras[1200])
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
