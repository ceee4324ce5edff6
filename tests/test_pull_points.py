"""Points that are pulled over a picture, and what a function of the reader's says of them."""

import html
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import nbformat
import numpy as np
import pytest
from PIL import Image

from cvnotes.base import CvnotesError, FileError
from cvnotes.show import pull_points
from cvnotes.show.explorations.hand import _clearest, hand_model
from cvnotes.show.explorations.page import asked, with_photograph
from cvnotes.show.explorations.paper import circle
from cvnotes.show.explorations.pulled import pulled_model
from cvnotes.show.style import ESTIMATED

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tools"))
from browser_parts import _shown  # noqa: E402

# Every pixel of the photograph has a colour of its own.
V, U = np.mgrid[:120, :160]
PHOTO = np.dstack([U, V, 200 + 0 * U]).astype(np.uint8)
AT = np.array([[20.0, 30], [100, 40], [90, 100]])
ORANGE = np.array([int(ESTIMATED[i : i + 2], 16) for i in (1, 3, 5)])


def triangle(photo, three):
    (a, b), (c, d) = three[1] - three[0], three[2] - three[0]
    return f"Area {abs(a * d - b * c) / 2:.1f} of {photo.shape[1]}.", [three[[0, 1, 2, 0]]]


def grip_of(drawing, name):
    return next(grip for grip in drawing.grips if grip.name == name)


def test_each_pull_calls_the_function_with_the_picture_and_the_points():
    asked = []

    def tell(photo, points):
        asked.append((photo, points))
        return "Said.", []

    model = hand_model(PHOTO, AT, tell)
    values = model.dragged("point 2", (110.2, 44.6))
    assert (values["point"], values["u2"], values["v2"]) == (2, 110.0, 44.5)
    model.drawing(**values)
    photo, points = asked[-1]
    assert photo is PHOTO
    assert points.tolist() == [[20, 30], [110, 44.5], [90, 100]]
    points[:] = 0  # the function may do with them what it likes
    assert model.drawing(**values).sentence == "Said."
    assert asked[-1][1][1].tolist() == [110, 44.5]


def test_a_function_that_changes_its_points_moves_none_of_ours():
    def tell(_, points):
        points *= 0
        return "Said.", []

    drawing = hand_model(PHOTO, AT, tell).drawing()
    assert [grip_of(drawing, f"point {i}").at for i in (1, 2, 3)] == [tuple(at) for at in AT]


def test_the_sentence_is_that_of_the_points_and_the_lines_lie_upon_them():
    model = hand_model(PHOTO, AT, triangle)
    assert model.drawing().sentence == "Area 2450.0 of 160."
    assert model.drawing(u2=20, v2=60).sentence == "Area 1050.0 of 160."
    drawing = model.drawing()
    a, b, _ = (np.array(grip_of(drawing, f"point {i}").place) for i in (1, 2, 3))
    for part in (0.2, 0.5, 0.8):
        u, v = np.rint(a + part * (b - a)).astype(int)
        around = drawing.picture[v - 2 : v + 3, u - 2 : u + 3].reshape(-1, 3).astype(int)
        assert np.abs(around - ORANGE).max(axis=-1).min() < 30
    assert [grip.label for grip in drawing.grips][-1] == "point 1, finely"


def test_the_loupe_shows_the_pixels_around_the_point_that_was_pulled_last():
    model = hand_model(PHOTO, AT, lambda *_: ("", []))
    for point, (u, v) in ((1, (20, 30)), (3, (90, 100)), (2, (159, 0))):
        drawing = model.drawing(**{"point": point, f"u{point}": u, f"v{point}": v})
        grip = grip_of(drawing, "loupe")
        assert grip.label == f"point {point}, finely"
        assert grip.at == (u, v)
        pixel = 1 / np.abs(grip.unit)  # px of the page for one of the photograph
        assert pixel.min() > 8
        for by in ((3, 0), (0, 2), (-2, 1), (-8, 8)):
            x, y = np.rint(grip.place + pixel * by).astype(int)
            seen = drawing.picture[y, x].tolist()
            inside = u + by[0] < 160 and v + by[1] >= 0
            assert seen == ([u + by[0], v + by[1], 200] if inside else [255, 255, 255])


def test_in_the_loupe_the_same_point_is_pulled_finely():
    model = hand_model(PHOTO, AT, triangle)
    start = model.dragged("point 3", (90, 100))
    loupe, photo = (grip_of(model.drawing(**start), name) for name in ("loupe", "point 3"))
    assert loupe.unit[0] < 0.35 * photo.unit[0]
    values = model.dragged("loupe", (91.5, 99.5), **start)
    assert (values["u3"], values["v3"], values["u1"]) == (91.5, 99.5, 20)


def test_a_picture_that_is_told_stands_beside():
    green = np.zeros((50, 100, 3))
    green[..., 1] = 1
    model = hand_model(PHOTO, AT, lambda *_: ("", [], green))
    picture = model.drawing().picture
    v, u = np.nonzero((picture == [0, 255, 0]).all(axis=-1))
    assert np.ptp(u) / np.ptp(v) == pytest.approx(2, rel=0.03)
    assert np.ptp(u) > 300
    alone = hand_model(PHOTO, AT, triangle).drawing()
    assert grip_of(alone, "point 1").unit[0] < grip_of(model.drawing(), "point 1").unit[0]


def test_lines_upon_the_picture_that_is_told_are_drawn_upon_it():
    def drawn(*more):
        return (
            hand_model(PHOTO, AT, lambda *_: ("", [], np.zeros((60, 90)), *more)).drawing().picture
        )

    new = (drawn([[[10, 30], [80, 30]]]) != drawn()).any(axis=-1)
    v, u = np.nonzero(new)
    assert np.ptp(u) == pytest.approx(70 * 315 / 90, abs=4)  # 210 px high
    assert np.ptp(v) < 8


@pytest.mark.parametrize(
    "photo",
    [PHOTO / 255, PHOTO[..., 0], PHOTO[..., 0] > 80, PHOTO.astype(np.uint16) * 257],
    ids=["float", "grey", "bool", "deep"],
)
def test_pictures_of_all_kinds_are_shown(photo):
    drawing = hand_model(photo, AT, triangle).drawing()
    x, y = np.rint(grip_of(drawing, "loupe").place).astype(int)
    seen = drawing.picture[y + 90, x - 90].astype(int)  # eight pixels to the left, eight down
    value = np.asarray(photo, dtype=float)[38, 12]
    white = {"f": 1, "b": 1}.get(
        np.asarray(photo).dtype.kind, np.max(photo) if photo.max() > 255 else 255
    )
    assert np.abs(seen - 255 * value / white).max() <= 1


@pytest.mark.parametrize(
    ("at", "tell", "words"),
    [
        (np.zeros((0, 2)), triangle, "expected 1 to 12 points, got 0"),
        (np.ones((13, 2)), triangle, "expected 1 to 12 points, got 13"),
        ([[160, 10]], triangle, "within the picture of 160 × 120 px"),
        ([[5, 5]], lambda *_: "no lines", "a sentence, a list of lines.*got str"),
        ([[5, 5]], lambda *_: ("", [[1, 2, 3]]), r"shape \(k, 2\)"),
        ([[5, 5]], lambda *_: ("", [], np.zeros(7)), "picture that tell returns"),
    ],
)
def test_what_cannot_be_shown_is_an_error_that_teaches(at, tell, words):
    with pytest.raises(CvnotesError, match=words):
        pull_points(PHOTO, at, tell)


def test_an_error_of_the_readers_function_is_raised_at_first_and_told_afterwards():
    def tell(_, points):
        if points[0, 0] > 50:
            raise ZeroDivisionError("that far?")
        return "Fine.", []

    with pytest.raises(ZeroDivisionError):
        pull_points(PHOTO, [[60, 10]], tell)
    widget = pull_points(PHOTO, [[10, 10]], tell)
    widget.sliders["u1"].value = 60
    assert "No answer for these points: ZeroDivisionError: that far?" in widget.sentence.value
    widget.sliders["u1"].value = 40
    assert "Fine." in widget.sentence.value
    widget.close_all()


def test_nan_where_lines_are_parallel_is_no_warning():
    def meet(_, points):
        x = 1 / (points[0, 0] - points[1, 0])
        return f"{x:.1f}", [[points[0], [x, np.nan]]]

    model = hand_model(PHOTO, [[10, 10], [20, 10]], meet)
    assert model.drawing(u1=20).sentence == "inf"


def test_of_a_photograph_of_ones_own_the_path_is_enough(tmp_path):
    path = tmp_path / "mine.png"
    Image.fromarray(np.full((300, 400, 3), 90, np.uint8)).save(path)
    for given in (path, str(path)):
        widget = pull_points(given, AT, triangle)
        assert widget.points.shape == (3, 2)
        off = widget.points - [200, 150]
        assert np.abs(off / [400, 300]).max() < 0.4
        assert np.linalg.norm(off, axis=1).min() > 50
        assert "of 400." in widget.sentence.value
        widget.close_all()
    Image.fromarray(np.zeros((3000, 4000), np.uint8)).save(path)
    widget = pull_points(path, AT, triangle)
    assert "of 1334." in widget.sentence.value  # a third
    widget.close_all()
    with pytest.raises(FileError, match="nowhere"):
        pull_points(tmp_path / "nowhere.jpg", AT, triangle)


def test_the_widget_keeps_its_points_tells_them_and_leaves_a_still():
    widget = pull_points(PHOTO, AT, triangle)
    assert widget.points.tolist() == AT.tolist()
    pulled = {"number": 1, "grip": "point 1", "at": [30, 35], "values": widget.values}
    widget._pulled.value = json.dumps(pulled)
    assert widget.points[0].tolist() == [30, 35]
    folded = widget.children[3]
    assert folded.layout.display == "none"  # until the button before it is pressed
    assert "[[30.0, 35.0], [100.0, 40.0], [90.0, 100.0]]" in folded.children[1].value
    assert set(widget.sliders.values()) == set(folded.children[0].children)
    bundle = widget._repr_mimebundle_()["text/html"]
    assert html.escape(widget.model.drawing(**widget.values).sentence) in bundle
    assert "<img" in bundle
    assert "pull its points" in bundle
    told = re.search('data-explore="(.*?)"', bundle)[1]
    assert json.loads(html.unescape(told))["settings"][1]["value"] == 20
    widget.reset_button.click()
    assert widget.points.tolist() == AT.tolist()
    widget.close_all()


def test_a_points_number_keeps_clear_of_lines_and_of_other_points():
    ring = 22 * circle(25)
    ahead = np.array([1.0, 0])
    free = _clearest(ring, ahead, [np.array([[0.0, 0], [0, 0]])], 1.0)
    assert np.allclose(free, 22 * ahead)
    line, point = np.array([[0.0, 0], [100, 0]]), np.array([[0.0, 22], [0, 22]])
    aside = _clearest(ring, ahead, [line, np.array([[np.nan, 0], [3, 3]]), point], 1.0)
    assert abs(aside[1]) > 15  # px from the line
    assert np.linalg.norm(aside - [0, 22]) > 15
    assert aside[0] > 0  # and of such places the outermost


# On a page: what the cells of a notebook need for their call, and no more.

PAGES = [
    pytest.param([c.source for c in cells[: i + 1]], cell, id=f"{path.stem[:4]} {i}")
    for path in sorted((ROOT / "notebooks").glob("*.ipynb"))
    for cells in [[c for c in nbformat.read(path, 4).cells if c.cell_type == "code"]]
    for i, cell in enumerate(cells)
    if re.search(r"^pull_points\(", cell.source, re.MULTILINE)
]


@pytest.mark.parametrize(("sources", "cell"), PAGES)
def test_on_its_page_a_call_says_what_it_said_in_the_notebook(sources, cell, monkeypatch):
    monkeypatch.chdir(ROOT / "notebooks")
    said = pulled_model(tuple(sources)).drawing().sentence
    assert html.escape(said) in cell.outputs[0]["data"]["text/html"]


def test_no_page_needs_more_for_its_call_than_it_has_loaded(tmp_path):
    """Of scipy, OpenCV and matplotlib, and of most photographs, a page has none at first."""
    run = """if True:
        import json, sys
        from pathlib import Path
        for name in ("scipy", "cv2", "matplotlib"):
            sys.modules[name] = None
        from cvnotes.pictures import course
        from cvnotes.show.explorations.pulled import pulled_model
        course.DATA = Path(sys.argv[1])
        for sources in json.load(sys.stdin):
            assert pulled_model(tuple(sources)).drawing().sentence
    """
    given = json.dumps([page.values[0] for page in PAGES])
    for path in _shown():
        target = tmp_path / path.relative_to(ROOT / "data")
        target.parent.mkdir(exist_ok=True)
        shutil.copy(path, target)
    subprocess.run([sys.executable, "-c", run, tmp_path], input=given, text=True, check=True)
    assert len(PAGES) > 8


def test_of_the_cells_of_a_page_those_statements_run_that_the_call_needs():
    cells = (
        "%pip install something",
        "import numpy as np\nfrom os import nowhere",
        "far, near = 1, 2\nslow = 1 / 0\nprint(slow)",
        "def say(far):\n    return f'{far + near + later}'",
        "near = sum([near for near in (0, 0)]) + near",  # one name, of a list and of the page
        "def told(_, points, near=0):\n    return say([x for x in points][0][0]), []",
        "later = 10\npull_points(np.zeros((30, 40)), [[near, 20]], told)",
    )
    model = pulled_model(cells)
    assert model.drawing().sentence == "14.0"
    assert model.drawing(u1=30).sentence == "42.0"
    for other in ((), ("pull_points(",), cells[:-1]):
        with pytest.raises(CvnotesError, match="does not end in a call of pull_points"):
            pulled_model(other)
    with pytest.raises(NameError, match="missing"):
        pulled_model(("pull_points(missing, [[1, 2]], print)",))


def test_on_a_page_a_photograph_of_ones_own_takes_the_place_of_the_picture(tmp_path):
    path = tmp_path / "mine.png"
    Image.fromarray(np.full((300, 400, 3), 90, np.uint8)).save(path)
    cells = [
        "import numpy as np",
        "def told(photo, points):\n    return f'{photo.shape[1]} wide, {points[0]}', []",
        "pull_points(np.zeros((30, 40)), [[7, 20]], told)",
    ]
    told = json.loads(with_photograph(cells, str(path)))
    assert told["sentence"].startswith("400 wide")
    assert [each["high"] for each in told["settings"]] == [1, 399, 299]
    question = {"name": "pull_points", "cells": cells, "photo": str(path), "values": {"u1": 50}}
    assert json.loads(asked(json.dumps(question)).rest)["sentence"].startswith("400 wide, [50.")
    del question["photo"]
    question["values"] = {"u1": 30}
    assert json.loads(asked(json.dumps(question)).rest)["sentence"].startswith("40 wide")
