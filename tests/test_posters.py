import numpy as np
import pytest

from cvnotes.camera import Camera, intrinsics, pose
from cvnotes.pictures import chart_room, poster_room, render_scene
from cvnotes.pictures.posters import ROWS, SIZE, SWITCH, letter


@pytest.fixture(scope="module")
def front():
    """The chart from straight ahead, a pixel for each millimetre; (u, v) is (x + 400, y)."""
    camera = Camera(intrinsics(900, 900, 619.5, 299.5), pose(np.eye(3), [-220, -300, 900]))
    return render_scene(chart_room(), Camera(camera.A, camera.G, size=(860, 600)))


def test_every_cell_of_every_letter_is_as_dark_as_it_should_be(front):
    dark = front.mean(axis=2) < 128
    for word, top, height in ROWS[:5]:
        cell = height / 5
        left = (SIZE[0] - (6 * len(word) - 1) * cell) / 2
        for k, name in enumerate(word):
            for j, row in enumerate(letter(name)):
                for i, wanted in enumerate(row):
                    u = left + (6 * k + i + 0.5) * cell + 399.5
                    v = top + (j + 0.5) * cell - 0.5
                    assert dark[round(v), round(u)] == wanted, (word, name, j, i)


def test_the_switch_is_where_it_is_said_to_be(front):
    x, y = SWITCH
    red, _, blue = front[round(y), round(x + 400)].astype(int)
    assert red > blue + 40
    assert np.ptp(front[round(y), round(x + 400 + 90)].astype(int)) < 40  # the wall beside it


def test_words_fit_onto_the_chart_one_below_the_other():
    bottoms = [top + height for _, top, height in ROWS]
    assert all(below[1] > bottom for below, bottom in zip(ROWS[1:], bottoms, strict=False))
    assert bottoms[-1] < SIZE[1]
    assert all((6 * len(word) - 1) * height / 5 < SIZE[0] for word, _, height in ROWS)


def test_the_sun_of_the_poster_is_round_and_its_sheet_as_large_as_it_is_said_to_be():
    # From the middle of the room straight at the left wall, two millimetres to the pixel.
    A = intrinsics(500, 500, 749.5, 399.5)
    camera = Camera(
        A, pose([[0, 0, 1], [0, 1, 0], [-1, 0, 0]], [-7600, 300, -1979]), size=(1500, 800)
    )
    sheet = camera.project(poster_room().vertices[:4])
    assert np.ptp(sheet, axis=0) == pytest.approx([1300, 600], rel=2e-3)
    assert sheet[0] == pytest.approx([99.5, 99.5], abs=2)  # the upper left corner
    seen = render_scene(poster_room(), camera).astype(int)
    red = seen[..., 0] > 2 * seen[..., 1]
    v, u = np.nonzero(red)
    assert [np.ptp(u) + 1, np.ptp(v) + 1] == pytest.approx([300, 300], abs=2)
    assert red.sum() == pytest.approx(np.pi * 150**2, rel=0.01)
    sea = seen[640, 749]
    assert sea[2] > sea[0] + 40
