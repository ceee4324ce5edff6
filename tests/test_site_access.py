"""The site for everybody: an automated checker of WCAG 2.2 AA, and the keyboard alone.

Pages on which Python is awake are checked where they are: with exercises answered in
test_site_live.py, with photographs dropped in test_site_offline.py.
"""

import io
import re
from pathlib import Path

import nbformat
import numpy as np
import pytest
from accessible import violations
from conftest import SPARING, wait_for
from PIL import Image

from cvnotes.show.explorations import model
from cvnotes.show.explorations.pulled import pulled_model
from cvnotes.targets import Chessboard, find_corners

CHAPTER = Path(__file__).parents[1] / "notebooks" / "06_homography_dlt.ipynb"
pytestmark = [pytest.mark.slow, pytest.mark.once]

# What has the focus: its kind and its name, how it is seen to have it, and whether it can be seen.
FOCUSED = """() => {
    const e = document.activeElement, style = getComputedStyle(e), box = e.getBoundingClientRect();
    const name = e.getAttribute('aria-label') || e.labels?.[0]?.textContent || e.textContent;
    const [x, y] = [box.left + box.width / 2, box.top + Math.min(box.height / 2, 300)];
    const seen = document.elementFromPoint(x, y);
    return {
        kind: e.type || e.tagName.toLowerCase(), name: name.trim(),
        marked: style.outlineStyle !== 'none' || style.boxShadow !== 'none',
        hidden: !e.classList.contains('skip-link') && !e.closest('#pst-skip-link')
            && !(seen && (e.contains(seen) || seen.contains(e) || seen.control === e)),
    };
}"""


@pytest.fixture(scope="module")
def page(chromium):
    context = chromium.new_context(viewport={"width": 1400, "height": 900})
    context.add_init_script(SPARING)
    yield context.new_page()
    context.close()


@pytest.mark.parametrize("name", ["index", "reference/homography"])
def test_a_checker_of_wcag_has_nothing_to_say(page, live_site, name):
    page.set_viewport_size({"width": 1400, "height": 900})
    page.goto(f"{live_site}/{name}.html")
    page.wait_for_load_state()
    assert violations(page) == []


@pytest.mark.parametrize("name", ["notebooks/06_homography_dlt", "your_camera", "board_on_screen"])
def test_nor_has_it_on_a_telephone(page, live_site, name):
    page.set_viewport_size({"width": 400, "height": 900})
    page.goto(f"{live_site}/{name}.html")
    page.wait_for_load_state()
    page.wait_for_timeout(1000)  # formulas that are too wide are found when they are set
    assert violations(page, colours=False) == []


def test_the_keyboard_alone_reaches_all_and_is_held_nowhere(page, live_site):
    page.set_viewport_size({"width": 1400, "height": 900})
    page.goto(f"{live_site}/notebooks/06_homography_dlt.html")
    page.wait_for_selector("mjx-container mjx-mo", state="attached", timeout=30_000)
    reached, moved = [], 0
    for _ in range(400):
        page.keyboard.press("Tab")
        focused = page.evaluate(FOCUSED)
        if focused["kind"] == "body":
            break
        reached.append((focused["kind"], focused["name"]))
        assert focused["marked"], focused
        # What lay over it leaves: the link that skips to the text, the last button's bubble.
        wait_for(lambda: not page.evaluate(FOCUSED)["hidden"], seconds=10, of=focused)
        folded = "document.activeElement.matches('.explore details:not([open]) > summary')"
        if page.evaluate(folded):
            page.keyboard.press("Enter")
        if focused["kind"] == "range":
            before = page.evaluate("document.activeElement.value")
            page.keyboard.press("ArrowRight")
            page.keyboard.press("ArrowRight")
            page.keyboard.press("ArrowLeft")  # which moves one that stands at its right end
            moved += page.evaluate("document.activeElement.value") != before
        if focused["kind"] == "textarea":  # as the line below it says
            page.keyboard.press("Escape")
    assert focused["kind"] == "body", reached[-5:]  # and goes on at the browser's own buttons
    kinds = [kind for kind, _ in reached]
    cells = nbformat.read(CHAPTER, as_version=4).cells
    code = [cell.source for cell in cells if cell.cell_type == "code"]
    explored = [model(name) for name in re.findall(r'explore\("(\w+)"', "\n".join(code))]
    pulled = [i for i, source in enumerate(code, 1) if "\npull_points(" in source]
    explored += [pulled_model(tuple(code[:i])) for i in pulled]
    assert len(explored) >= 6
    assert (
        kinds.count("range")
        == moved
        == sum(not setting.is_choice for one in explored for setting in one.settings)
    )
    assert kinds.count("textarea") == 5
    corners = [name for _, name in reached if "move it with the arrow keys" in name]
    assert len(corners) == sum(len(one.drawing().grips) for one in explored)
    assert [name for _, name in reached].count("Your own photograph") == len(pulled) == 1
    for name in ("Check", "Hint", "Solution", "Start again", "Save as a notebook"):
        assert [n for _, n in reached].count(name) == 5, name
    assert "mjx-container" not in kinds  # a hundred formulas are no stops


def test_the_first_page_leads_to_the_question_and_the_box_for_its_answer(page, live_site):
    page.set_viewport_size({"width": 1280, "height": 900})
    page.goto(f"{live_site}/index.html")
    page.get_by_role("link", name="finds the right answer").click()
    page.wait_for_function("document.activeElement?.id === 'answer-camera_centre'")
    page.wait_for_load_state()
    question = page.get_by_text("Where the camera stands.")
    wait_for(lambda: 50 < question.bounding_box()["y"] < 500, seconds=20)  # below the bar


def test_photographs_are_chosen_with_the_keyboard_alone(page, live_site):
    # Playwright asks for choosers without waiting until they come to it: before the page does.
    page.on("filechooser", lambda _: None)
    page.goto(f"{live_site}/your_camera.html")
    page.locator("#camera-page [name=paper]").focus()
    page.keyboard.press("Tab")
    focused = page.evaluate(FOCUSED)
    assert (focused["kind"], focused["name"]) == ("file", "Choose photographs")
    style = "getComputedStyle(document.activeElement.closest('label')).outlineStyle"
    assert page.evaluate(style) == "solid"
    with page.expect_file_chooser() as chooser:
        page.keyboard.press("Space")
    assert chooser.value.is_multiple()


def test_a_board_on_the_screen_is_as_large_as_is_said_by_the_keyboard_alone(page, live_site):
    page.set_viewport_size({"width": 1280, "height": 800})
    page.goto(f"{live_site}/board_on_screen.html")
    page.locator("#card-size").focus()
    for _ in range(30):
        page.keyboard.press("ArrowRight")
    card = page.locator(".card").bounding_box()
    assert card["width"] / card["height"] == pytest.approx(85.60 / 53.98, abs=0.01)
    for key in ("Tab", "Tab", "Enter"):
        page.keyboard.press(key)
    words = page.locator("#screen-page dialog span")
    words.filter(has_text="mm").wait_for()
    page.wait_for_timeout(300)  # the full screen has another size
    mm = re.fullmatch(r"9×6 inner corners, squares of (.+) mm", words.inner_text())[1]
    seen = np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("L"))
    m = find_corners(seen, Chessboard((9, 6), 1.0)).reshape(6, 9, 2)
    side = np.median(np.diff(m[..., 0], axis=1))
    assert float(mm) == pytest.approx(side * 85.60 / card["width"], abs=0.01)
    assert np.abs(np.diff(m[..., 0], axis=1) - side).max() < 0.1
    assert np.abs(np.diff(m[..., 1], axis=0) - side).max() < 0.1
    white = np.array([m.min((0, 1)) - 1.4 * side, m.max((0, 1)) + 1.4 * side])
    assert ((white > 0) & (white < seen.shape[::-1])).all()
    assert violations(page) == []
    page.keyboard.press("Escape")
    page.wait_for_selector("#screen-page dialog", state="hidden")
    assert page.evaluate("document.activeElement.className") == "show"
    link = page.locator("#screen-page .said a").get_attribute("href")
    assert link == f"your_camera.html?corners=9x6&square={mm}"


@pytest.mark.parametrize("width", [1280, 390])
def test_the_first_page_shows_its_sentence_its_ways_in_and_a_grip_at_once(page, live_site, width):
    page.set_viewport_size({"width": width, "height": 800})
    page.goto(f"{live_site}/index.html")
    page.wait_for_selector(".explore-grip")
    for shown in (".front-sentence", ".front-buttons a >> nth=2", ".explore-grip >> nth=0"):
        box = page.locator(shown).bounding_box()
        assert 0 < box["y"] < box["y"] + box["height"] < 800, shown
        assert 0 <= box["x"] < box["x"] + box["width"] <= width, shown
    assert page.evaluate("document.documentElement.scrollWidth") == width
    picture = page.locator(".front picture img")
    assert picture.evaluate("img => img.complete && img.naturalWidth") > 600
    page.locator(".explore-grip").first.focus()
    page.keyboard.press("ArrowDown")
    page.wait_for_selector(".front .explore-stage.live", timeout=120_000)
    assert violations(page, colours=False) == []


def test_the_picture_stands_above_its_sliders(page, live_site):
    page.goto(f"{live_site}/notebooks/04_lens_distortion.html")
    explored = page.locator(".explore").first
    stage, sliders = explored.locator(".explore-stage"), explored.locator(".explore-controls")
    for width in (390, 1280):
        page.set_viewport_size({"width": width, "height": 844})
        assert stage.bounding_box()["y"] < sliders.bounding_box()["y"], width
