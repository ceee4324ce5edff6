"""The figure of the field of view: all in it is where geometry puts it."""

import numpy as np

from cvnotes.camera import Camera, intrinsics
from cvnotes.pictures import render_scene, room
from cvnotes.show import draw_field_of_view


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
