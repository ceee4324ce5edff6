"""The machine's own camera, watched: a picture is taken when the board is still, where it helps."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from cvnotes.commands.dropped import Dropped
from cvnotes.commands.watching import Watch
from cvnotes.pictures import render

ROOT = Path(__file__).resolve().parents[1]
VIEWS = sorted((ROOT / "data" / "views").glob("*.png"))
SIZE = (640, 480)


@pytest.fixture
def watch():
    return Watch(Dropped(9, 6, 25.0))


def frame(path):
    return np.asarray(Image.open(path).convert("L"))


def seen(watch, picture):
    return watch.see(picture.tobytes(), SIZE, SIZE)


def test_a_picture_is_taken_of_a_board_that_is_still_and_only_once(watch):
    one = frame(VIEWS[0])
    nothing = seen(watch, np.full_like(one, 90))
    assert nothing == {"corners": [], "take": False, "words": "the board is not seen whole"}
    first = seen(watch, one)
    assert len(first["corners"]) == 108
    assert (first["take"], first["words"]) == (False, "hold the board still: a picture helps here")
    assert not seen(watch, np.roll(one, 1, axis=1))["take"]  # moved by a pixel
    assert not seen(watch, one)["take"]
    assert seen(watch, one)["take"]
    watch.dropped.look(str(VIEWS[0]))
    again = seen(watch, one)
    assert not again["take"]
    assert "there is such a photograph already" in again["words"]
    seen(watch, frame(VIEWS[1]))
    assert seen(watch, frame(VIEWS[1]))["take"]


def test_corners_are_those_of_the_photograph_though_the_frame_is_small(watch):
    watch.dropped.look(str(VIEWS[3]))
    small = np.asarray(Image.open(VIEWS[3]).convert("L").resize((480, 360)))
    words = watch.see(small.tobytes(), (480, 360), SIZE)["words"]
    assert "there is such a photograph already" in words


def test_once_there_is_a_camera_only_views_that_teach_much_are_taken(watch):
    for path in VIEWS[:6]:
        watch.dropped.look(str(path))
    watch.dropped.calibrate("k1 k2")
    found = watch.dropped.found
    board, camera, proposal = watch.dropped.board, found.camera, found.next_view
    best = render(board, camera.moved(proposal.G)).astype(np.uint8)
    seen(watch, best)
    assert seen(watch, best)["take"]
    flat = np.eye(4)  # far away and straight on, in the middle: teaches next to nothing
    flat[:3, 3] = [-100.0, -62.5, 1400.0]
    dull = render(board, camera.moved(flat)).astype(np.uint8)
    seen(watch, dull)
    shown = seen(watch, dull)
    assert len(shown["corners"]) == 108
    assert not shown["take"]
    assert shown["words"] == f"another view would help more: {proposal.words}"


def test_a_photograph_that_is_left_out_may_be_taken_again(watch):
    watch.dropped.look(str(VIEWS[0]))
    watch.dropped.forget(VIEWS[0].name)
    seen(watch, frame(VIEWS[0]))
    assert seen(watch, frame(VIEWS[0]))["take"]
