"""The first page: what README says, in ten seconds, and nothing on it that is not so."""

import json
import re
import sys
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from cvnotes.learn.page import answered
from cvnotes.show import explorations
from cvnotes.show.explorations.paper import Paper

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tools"))
CHAPTERS = sorted(ROOT.glob("notebooks/[0-9]*.ipynb"))
front_page = pytest.importorskip("front_page", reason="the extra docs is not installed")


def test_the_picture_is_the_exploration_before_it_is_touched():
    model = explorations.model(front_page.EXPLORED)
    drawn = model.drawn_on(Paper(2), model.values()).picture.astype(int)
    kept = np.asarray(Image.open(front_page.PICTURE).convert("RGB")).astype(int)
    assert drawn.shape == kept.shape
    assert np.abs(drawn - kept).mean() < 1  # else: python tools/draw_front.py
    # one changed word is some 600 pixels, which a mean does not see
    assert np.sum(np.abs(drawn - kept).max(axis=2) > 64) < 50


def test_it_says_what_readme_says_and_its_buttons_follow_what_there_is():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert "docs/figures/front.png" in readme.split("\n\n")[2]
    alone, live, whole = (front_page.front_page(*has) for has in ((0, 0), (1, 0), (1, 1)))
    for page in (alone, live, whole):
        assert front_page.sentence(readme) in page
        assert front_page.whom(readme) in page
        assert page.count('<li><a href="notebooks/') == len(CHAPTERS)
        assert page.count('<p class="front-beyond"><a href="notebooks/more_exercises.html">') == 1
        assert (
            len(re.findall(r'<nav class="front-buttons".*?</nav>', page, re.S)[0].split("<a ")) == 4
        )
        assert not re.search(r"@[A-Z]+@", page)
    assert "data-explore" not in alone
    assert "lite/" not in live
    cost = re.search(r"JupyterLite, (\d+ MB once)", readme)[1]
    assert [cost in page for page in (alone, live, whole)] == [False, False, True]
    assert "your_camera.html" in live
    opened = re.search(r"lite/notebooks/index.html\?path=(\S+?)\"", whole)[1]
    assert (ROOT / opened).is_file()  # JupyterLite has them in the repository's places


def test_it_counts_its_questions_and_its_chapters():
    page = front_page.front_page(live=True, lite=True)
    numbers = dict(enumerate(("Ten", "Eleven", "Twelve", "Thirteen"), 10))
    assert f"## {numbers[len(CHAPTERS)]} questions" in page
    assert f"{numbers[len(CHAPTERS)]} chapters find all this" in page


def test_the_hours_it_names_are_those_of_all_chapters():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    said = "".join(path.read_text(encoding="utf-8") for path in CHAPTERS)
    minutes = re.findall(r"(\d+) min", "".join(re.findall(r"\*\*Time\*\*(.+?)\.", said)))
    assert len(minutes) == 2 * len(CHAPTERS) + 1  # chapter 9 has photographs, too
    assert f"some {round(sum(map(int, minutes)) / 60)} hours." in front_page.whom(readme)


def test_its_first_button_says_how_long_chapter_0_is_read():
    said = re.search(r"running (\d+) min", CHAPTERS[0].read_text(encoding="utf-8"))[1]
    assert f"chapter 0, {said} minutes" in front_page.front_page(live=True, lite=True)


def test_the_mistake_in_the_box_is_named_before_it_is_checked_and_without_python_too():
    page = front_page.front_page(live=True, lite=True)
    cell = unescape(re.search(r'class="cell_input"><pre>(.*?)</pre>', page, re.S)[1])
    assert "return T\n" in cell
    said = front_page.check("camera_centre", front_page.camera_centre)
    assert said.misconception
    reply = answered(json.dumps({"exercise": "camera_centre", "cell": cell}))
    assert said.message in unescape(json.loads(reply)["html"])
    for shown in (page, front_page.front_page(live=False, lite=False)):
        assert unescape(shown).count(said.message) == 1


def test_a_card_tells_how_long_its_chapter_takes():
    page = front_page.front_page(live=True, lite=True)
    assert "<small>1¾ h</small> <strong>1 · Projective space</strong>" in page
    assert "<small>50 min</small> <strong>0 · Start here</strong>" in page
    assert page.count(" h</small>") == len(CHAPTERS) - 1


@pytest.mark.slow
@pytest.mark.once
@pytest.mark.parametrize("path", sorted(ROOT.glob("notebooks/*.ipynb")), ids=lambda path: path.stem)
def test_the_card_of_each_chapter_is_a_picture_and_not_paper(path):
    card = np.asarray(front_page.card_of(path))
    assert card.shape[:2] == front_page.CARD[::-1]
    assert (card.min(axis=2) < 245).mean() > 0.4


def test_a_card_shows_what_is_drawn_without_the_numbers_along_its_axes():
    figure = np.full((300, 400, 3), 255, np.uint8)
    figure[20:240, 60:380] = (0, 90, 200)
    figure[250:260, 100:110] = 0  # a number below the axis
    card = np.asarray(front_page.fitted(Image.fromarray(figure)))
    assert card.shape == (320, 480, 3)
    assert (card == (0, 90, 200)).all()


@pytest.mark.parametrize("name", front_page.PARTS)
def test_no_word_is_written_on_a_card_that_is_cut_out_of_an_exploration(name, monkeypatch):
    def refuse(*_, **__):
        raise AssertionError("a word on a card")

    monkeypatch.setattr(front_page.Panel, "text", refuse)
    assert front_page.card_of(ROOT / "notebooks" / f"{name}.ipynb").size == front_page.CARD
