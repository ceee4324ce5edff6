"""The site's pages with Python in them, in a real browser: explorations, exercises, bad luck.

Without the parts of Pyodide all is skipped.
"""

import csv
import functools
import io
import re
from pathlib import Path

import nbformat
import numpy as np
import pytest
from accessible import violations
from conftest import IMPATIENT, SPARING, QuietHandler, serving, taken
from PIL import Image

from cvnotes.commands.cli import main as cvnotes
from cvnotes.show.explorations import NAMES, explore, model
from cvnotes.show.explorations.pulled import pulled_model

ROOT = Path(__file__).resolve().parents[1]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
pytest.importorskip("sphinx", reason="the extra docs is not installed")
pytestmark = [pytest.mark.slow, pytest.mark.once]

AWAKE = 120_000  # ms; Python is compiled anew for each page
MODELS = {name: model(name) for name in NAMES}
ARTICLE = re.compile(r'(<article class="bd-article"[^>]*>)')
# What the canvas shows, as a number that changes with the picture.
SHOWN = """box => {
    const canvas = box.querySelector('canvas[role=img]');
    if (canvas.hidden) return 0;
    const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    let sum = 0;
    for (let i = 0; i < data.length; i += 4) sum = (31 * sum + data[i] + 2 * data[i + 1]) % 1000003;
    return sum;
}"""
OVERHEARD = """box => {
    box.overheard = [];
    const state = box.querySelector('.explore-state');
    new MutationObserver(() => box.overheard.push(state.textContent)).observe(
        state, {childList: true, characterData: true, subtree: true});
}"""
MEGABYTES = r"() => /[1-9]\d*\.\d of 1\d\.\d MB/.test(document.body.innerText)"
PIXELS = """canvas => {
    const all = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    return Array.from(all.data);
}"""
CHECKED = """box => {
    const done = box.querySelector('.exercise-report').textContent;
    return done && !box.querySelector('button').disabled;
}"""


@pytest.fixture(scope="module")
def address(live_folder):
    """Serve the site with one more page, on which are all explorations."""
    page = (live_folder / "notebooks" / "04_lens_distortion.html").read_text()
    outputs = "".join(_output(name) for name in NAMES)
    page = ARTICLE.sub(lambda found: found[1] + outputs, page).encode()

    class Handler(QuietHandler):
        def send_head(self):
            if self.path != "/notebooks/all_explorations.html":
                return super().send_head()
            self.send_response(200)
            self.send_header("Content-Type", "text/html; charset=utf-8")
            self.send_header("Content-Length", str(len(page)))
            self.end_headers()
            return io.BytesIO(page)

    with serving(functools.partial(Handler, directory=live_folder)) as at:
        yield at


def _output(name):
    shown = explore(name)._repr_mimebundle_()["text/html"]
    return f'<div class="cell"><div class="cell_output"><div>{shown}</div></div></div>'


@pytest.fixture(scope="module")
def watched(chromium, address):
    """Give what opens pages of the site, and what they asked of others and complained of."""
    contexts, told = [], []

    def opened(name, script="", sparing=True, **how):
        context = chromium.new_context(**{"viewport": {"width": 1400, "height": 900}, **how})
        if sparing:
            context.add_init_script(SPARING)
        contexts.append(context)
        page = context.new_page()
        ours = (address, "data:", "blob:")
        context.on("request", lambda r: r.url.startswith(ours) or told.append(r.url))
        page.on("console", lambda m: told.append(m.text) if m.type == "error" else None)
        page.on("pageerror", lambda error: told.append(str(error)))
        if script:
            page.add_init_script(script)
        page.goto(f"{address}/notebooks/{name}.html")
        return page

    yield opened, contexts, told
    for context in contexts:
        context.close()


@pytest.fixture
def open_page(watched):
    """Open pages of the site; hold at the end that all went well and nobody else was asked."""
    opened, contexts, told = watched
    before = len(contexts)
    yield opened
    while len(contexts) > before:
        contexts.pop().close()
    assert taken(told) == []


@pytest.fixture(scope="module")
def page_of_all(watched):
    """Open the page with all explorations, on which Python is woken once."""
    return watched[0]("all_explorations")


@pytest.fixture
def all_explorations(page_of_all, watched):
    """Give the page with all explorations; hold that all went well with it."""
    yield page_of_all
    assert taken(watched[2]) == []


@pytest.fixture(scope="module")
def page_of_exercises(watched):
    """Open the page of chapter 6, on which Python is woken once."""
    return watched[0]("06_homography_dlt")


@pytest.fixture
def exercises(page_of_exercises, watched):
    """Give the page of chapter 6; hold that all went well with it."""
    yield page_of_exercises
    assert taken(watched[2]) == []


def explorations(page):
    page.wait_for_selector(".explore")
    boxes = page.locator(".explore")
    return {name: boxes.nth(i) for i, name in enumerate(NAMES)}


def becomes_another(page, box, before):
    """Wait for another picture."""
    for _ in range(AWAKE // 50):
        now = box.evaluate(SHOWN)
        if now not in (0, before):
            return now
        page.wait_for_timeout(50)
    raise AssertionError(box.locator(".explore-state").inner_text())


def comes(page, holds, *given):
    """Wait until something holds that comes by itself, the later the busier the machine is."""
    for _ in range(AWAKE // 50):
        if holds(*given):
            return True
        page.wait_for_timeout(50)
    return False


def says(box, sentence):
    return box.locator(".explore-sentence").inner_text() == sentence


def all_differ(box, labels, before):
    after = [value(box, label) for label in labels]
    return all(a != b for a, b in zip(after, before, strict=True))


def is_at(grip, place):
    return np.hypot(*np.subtract(middle(grip), place)) < 8


def middle(grip):
    grip.scroll_into_view_if_needed()
    box = grip.bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def value(box, label):
    number = box.locator(".explore-control", has=box.page.get_by_text(label, exact=True))
    return float(number.locator("output").text_content().replace("−", "-"))  # folded or not


def unfold(box):
    """Open the sliders of what can be pulled, if they are folded, by the keyboard."""
    fold = box.locator(".explore-controls > details")
    if fold.count():
        assert not fold.locator("input").first.is_visible()
        fold.locator("summary").focus()
        box.page.keyboard.press("Enter")
        assert fold.locator("input").first.is_visible()
    return fold.count()


# Explorations.


def test_a_page_is_read_at_once_and_python_comes_with_the_first_touch(all_explorations):
    page = all_explorations
    box = explorations(page)["lens"]
    assert box.locator("img").evaluate("img => img.naturalWidth") > 1000
    assert box.locator("canvas[role=img]").is_hidden()
    assert box.locator(".explore-sentence").inner_text() == MODELS["lens"].drawing().sentence
    assert not page.workers
    box.locator("input").first.focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_function(MEGABYTES, timeout=AWAKE)
    becomes_another(page, box, 0)
    assert box.locator("img").is_hidden()
    box.locator("button", has_text="Reset").click()
    assert comes(page, says, box, MODELS["lens"].drawing().sentence)


def test_what_has_been_in_view_for_a_moment_is_computed_before_it_is_pulled(open_page, address):
    listen = """globalThis.asked = [];
    const post = Worker.prototype.postMessage;
    Worker.prototype.postMessage = function (one) {
        asked.push(one.question ? JSON.parse(one.question).name : one.kind);
        post.call(this, one);
    }"""
    page = open_page("04_lens_distortion", listen, sparing=False)
    page.set_viewport_size({"width": 1400, "height": 600})
    box = page.locator(".explore:has(canvas)").nth(1)
    box.scroll_into_view_if_needed()
    name = box.get_attribute("aria-label").removeprefix("Exploration: ")
    assert comes(page, lambda: name in page.evaluate("asked") and len(page.workers) == 1)
    assert len(page.evaluate("asked")) < page.locator(".explore").count()  # not those out of view
    assert box.locator("img").is_visible()
    assert set(page.locator(".explore-state").all_inner_texts()) == {""}
    page.locator(".exercise textarea").first.scroll_into_view_if_needed()
    assert comes(page, lambda: "wake" in page.evaluate("asked"))
    page.goto(f"{address}/notebooks/05_calibration_targets.html#further-reading")
    page.wait_for_timeout(2000)
    assert not page.workers  # nothing that asks is in view


def test_once_python_is_awake_nothing_more_is_said_that_would_move_the_picture(all_explorations):
    page = all_explorations
    box = explorations(page)["lens"]
    shown = box.evaluate(SHOWN)
    box.evaluate(OVERHEARD)
    box.locator("input").first.focus()
    page.keyboard.press("ArrowRight")
    becomes_another(page, box, shown)
    assert box.evaluate("box => box.overheard") == []
    box.locator("button", has_text="Reset").click()
    assert comes(page, says, box, MODELS["lens"].drawing().sentence)


def test_every_exploration_follows_the_keyboard_as_the_notebook_would(all_explorations):
    page = all_explorations
    for name, box in explorations(page).items():
        shown = box.evaluate(SHOWN)
        setting = MODELS[name].settings[0]
        assert unfold(box) == bool(MODELS[name].folded()), name
        slider = box.get_by_label(setting.label, exact=True)
        slider.focus()
        way = -1 if setting.value - 3 * setting.step >= setting.low else 1
        for _ in range(3):
            page.keyboard.press("ArrowLeft" if way < 0 else "ArrowRight")
        shown = becomes_another(page, box, shown)
        page.wait_for_function("() => !document.querySelector('.explore-state').textContent")
        values = {setting.name: float(slider.input_value())}
        pressed = min(setting.value + 3 * way * setting.step, setting.high)
        assert values[setting.name] == pytest.approx(pressed)
        drawing = MODELS[name].drawing(**values)
        assert comes(page, says, box, drawing.sentence)
        assert (
            box.locator("canvas[role=img]").get_attribute("aria-label").endswith(drawing.sentence)
        )
        box.locator("button", has_text="Reset").click()
        assert comes(page, says, box, MODELS[name].drawing().sentence)


def test_the_browsers_picture_is_the_notebooks(all_explorations):
    page = all_explorations
    box = explorations(page)["camera"]
    shown = box.evaluate(SHOWN)
    slider = box.locator("input").nth(3)  # T x, and the fourth entry of G
    slider.focus()
    page.keyboard.press("ArrowRight")
    becomes_another(page, box, shown)
    entry = box.locator(".explore-matrices td").nth(3)
    assert comes(page, lambda: entry.inner_text() == "−86")
    seen = box.locator("canvas[role=img]").evaluate(PIXELS)
    expected = MODELS["camera"].picture(T_x=float(slider.input_value()))
    pixels = np.array(seen, np.uint8).reshape(*expected.shape[:2], 4)[..., :3]
    # Two versions of Pillow draw some lines and letters in other shades.
    turned = MODELS["camera"].picture(angle_x=-13.1)
    off, by_a_degree = (np.abs(pixels - other.astype(float)).mean() for other in (expected, turned))
    assert off < min(1, 0.5 * by_a_degree)


def test_points_are_pulled_on_their_page_and_over_a_photograph_of_ones_own(
    chromium, live_site, tmp_path
):
    path = tmp_path / "street.png"
    Image.fromarray(np.full((300, 400, 3), 90, np.uint8)).save(path)
    cells = nbformat.read(NOTEBOOKS[1], as_version=4).cells
    code = [cell.source for cell in cells if cell.cell_type == "code"]
    code = tuple(code[: 1 + next(i for i, each in enumerate(code) if "\npull_points(" in each)])
    page = chromium.new_page()
    page.goto(f"{live_site}/notebooks/{NOTEBOOKS[1].stem}.html")
    box = page.locator('.explore[aria-label="Exploration: pull_points"]')
    for photo in (None, str(path)):
        model = pulled_model(code, photo)
        if photo:
            box.locator("input[type=file]").set_input_files(photo)
            assert comes(page, says, box, model.drawing().sentence)
        assert unfold(box)
        slider = box.get_by_label("u1", exact=True)
        slider.focus()
        for _ in range(40):  # half a pixel each
            page.keyboard.press("ArrowRight")
        u1 = model.values()["u1"] + 20
        assert float(slider.input_value()) == u1
        assert comes(page, says, box, model.drawing(u1=u1).sentence)
    none = tmp_path / "words.png"
    none.write_text("no picture")
    box.locator("input[type=file]").set_input_files(none)
    state = box.locator(".explore-state")
    why = "words.png: not a picture, or in a format that is not read"
    assert comes(page, lambda: state.inner_text().startswith(why))
    assert says(box, model.drawing(u1=u1).sentence)
    page.close()


@pytest.mark.parametrize(("name", "buttons"), [("08_image_warping", 1), ("more_exercises", 0)])
def test_a_photograph_of_ones_own_is_asked_for_where_the_notebook_has_a_place_for_it(
    open_page, name, buttons
):
    page = open_page(name)
    assert page.locator('.explore[aria-label="Exploration: pull_points"]').count() > 0
    assert page.get_by_role("button", name="Your own photograph").count() == buttons


def test_a_mouse_pulls_corners_directions_and_the_camera(all_explorations):
    page = all_explorations
    boxes = explorations(page)
    for name, grip, labels in (
        ("homography", "corner 1, top left", ["corner 1 u", "corner 1 v"]),
        ("parallel", "the vanishing point", ["heading (°)", "slope (°)"]),
        ("camera", "the camera, to carry it round the board", ["angle x (°)", "angle y (°)"]),
    ):
        box = boxes[name]
        before = [value(box, label) for label in labels]
        shown = box.evaluate(SHOWN)
        handle = box.get_by_label(grip)
        x, y = middle(handle)
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x - 20, y - 15, steps=4)
        page.mouse.move(x - 40, y - 30, steps=4)
        becomes_another(page, box, shown)
        moved = (box, labels, before)
        assert comes(page, all_differ, *moved), (name, before)
        there = (handle, (x - 40, y - 30))
        assert name == "camera" or comes(page, is_at, *there)  # it stays under the hand
        page.mouse.up()
        assert all_differ(*moved), (name, before)
        assert name == "camera" or is_at(*there)


def test_arrow_keys_move_what_a_hand_would_pull(all_explorations):
    page = all_explorations
    box = explorations(page)["homography"]
    shown = box.evaluate(SHOWN)
    box.get_by_label("corner 3, bottom right").focus()
    page.keyboard.press("ArrowRight")
    becomes_another(page, box, shown)
    assert comes(page, lambda: value(box, "corner 3 u") > 0)
    first = value(box, "corner 3 u")
    assert first < 5
    for _ in range(4):  # quicker than pictures are drawn
        page.keyboard.press("ArrowRight")
    assert comes(page, lambda: value(box, "corner 3 u") > 3 * first)
    assert value(box, "corner 3 v") == 0


def test_a_thumb_on_a_telephone_moves_slider_and_corner(open_page):
    page = open_page(
        "all_explorations", viewport={"width": 400, "height": 800}, has_touch=True, is_mobile=True
    )
    box = explorations(page)["homography"]
    box.locator("summary").tap()
    slider = box.locator("input[type=range]").first
    slider.scroll_into_view_if_needed()
    place = slider.bounding_box()
    assert place["height"] >= 24
    page.touchscreen.tap(place["x"] + 0.8 * place["width"], place["y"] + place["height"] / 2)
    becomes_another(page, box, 0)
    assert value(box, "corner 1 u") > 20
    canvas = box.locator("canvas[role=img]")
    stands = "canvas => canvas.width < canvas.height"
    assert comes(page, lambda: canvas.evaluate(stands))  # panels below each other
    assert page.evaluate("document.documentElement.scrollWidth") <= 400
    handle = box.get_by_label("corner 2, top right")
    x, y = middle(handle)
    assert handle.bounding_box()["width"] >= 44
    touch = page.context.new_cdp_session(page)

    def finger(kind, *points):
        at = [{"x": px, "y": py} for px, py in points]
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": at})

    before = page.evaluate("scrollY")
    finger("touchStart", (x, y))
    for i in range(1, 6):
        finger("touchMove", (x - 4 * i, y + 6 * i))
        page.wait_for_timeout(60)
    finger("touchEnd")
    assert comes(page, lambda: value(box, "corner 2 u") < -5)
    assert comes(page, lambda: value(box, "corner 2 v") > 10)
    assert page.evaluate("scrollY") == before


@pytest.fixture(scope="module")
def telephone(watched):
    """Give a page 400 px wide."""
    return watched[0](NOTEBOOKS[0].stem, viewport={"width": 400, "height": 800})


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_each_chapter_has_its_explorations_and_its_exercises_on_any_width(
    notebook, telephone, address, watched
):
    cells = nbformat.read(notebook, as_version=4).cells
    sources = [cell.source for cell in cells if cell.cell_type == "code"]
    wanted = [
        sum(bool(re.search(call, source, re.MULTILINE)) for source in sources)
        for call in (r"^(?:explore|pull_points)\(", r'^check\("\w+", ')
    ]
    telephone.goto(f"{address}/notebooks/{notebook.stem}.html")
    telephone.wait_for_load_state()
    assert [telephone.locator(kind).count() for kind in (".explore", ".exercise")] == wanted
    assert telephone.evaluate("document.documentElement.scrollWidth") <= 400
    assert taken(watched[2]) == []


# Exercises.

ANSWERS = {
    "normaliser": """def my_normaliser(x):
    centre = x.mean(axis=0)
    s = 2**0.5 / np.linalg.norm(x - centre, axis=1).mean()
    return np.array([[s, 0, -s * centre[0]], [0, s, -s * centre[1]], [0, 0, 1]])""",
    "four_points": "def my_four_points(src, dst):\n    return my_dlt(dst, src)",
    "dlt": """def my_dlt(src, dst):
    T, U, D = my_normaliser(src), my_normaliser(dst), []
    for (x, y), (u, v) in zip(src @ T[:2, :2] + T[:2, 2], dst @ U[:2, :2] + U[:2, 2]):
        D.append([0, 0, 0, -x, -y, -1, v * x, v * y, v])
        D.append([x, y, 1, 0, 0, 0, -u * x, -u * y, -u])
    return np.linalg.inv(U) @ np.linalg.svd(np.array(D))[2][-1].reshape(3, 3) @ T""",
}
ENDLESS = "def my_normaliser(x):\n    while True:\n        pass"


def write(page, name, text):
    box = page.locator(".exercise", has=page.locator(f"#answer-{name}"))
    area = box.locator("textarea")
    area.fill(text)
    return box


def checked(page, name, text):
    box = write(page, name, text)
    box.get_by_role("button", name="Check").click()
    page.wait_for_function(CHECKED, arg=box.element_handle(), timeout=AWAKE, polling=100)
    return box.locator(".exercise-report").inner_text()


def test_the_keyboard_alone_writes_checks_and_leaves(exercises):
    page = exercises
    area = page.locator("#answer-normaliser")
    area.focus()
    page.keyboard.press("Control+a")
    page.keyboard.type("def my_normaliser(x):\nreturn 1")
    assert area.input_value() == "def my_normaliser(x):\n    return 1"
    page.keyboard.press("Shift+Tab")
    assert area.input_value() == "def my_normaliser(x):\nreturn 1"
    page.keyboard.press("Tab")
    assert area.input_value().endswith("return 1    ")
    page.keyboard.press("Control+z")
    assert not area.input_value().endswith(" ")
    area.fill("def my_normaliser(x):\nreturn 1")
    page.keyboard.press("Escape")
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.textContent") == "Check"
    area.focus()
    page.keyboard.press("Control+Enter")
    said = ".exercise-report:has-text('Line 2, `return 1`, cannot be read')"
    page.wait_for_selector(said, timeout=AWAKE)


def test_exercises_answer_right_wrong_and_endless_and_can_be_handed_in(exercises, tmp_path):
    page = exercises
    page.evaluate(IMPATIENT)
    first = checked(page, "normaliser", ENDLESS)
    assert "Your function was stopped after 10 seconds: does a loop never end?" in first
    page.evaluate("() => { window.setTimeout = window.patiently; }")  # others may take their time
    assert "normaliser: ✓ right." in checked(page, "normaliser", ANSWERS["normaliser"])
    said = checked(page, "dlt", ANSWERS["dlt"])
    assert "dlt: ✓ right." in said
    assert re.search(r"Chapter 6: 2 of \d+ solved", said)
    wrong = checked(page, "four_points", ANSWERS["four_points"])
    assert "four_points: ✗ not yet right." in wrong
    assert "Your answer is the inverse of the right one." in wrong
    assert re.search(r"yours +wanted", wrong)
    box = page.locator(".exercise", has=page.locator("#answer-four_points"))
    box.get_by_role("button", name="Hint").click()
    page.wait_for_selector(".exercise-help:has-text('hint 1 of')")
    box.get_by_role("button", name="Hint").click()
    page.wait_for_selector(".exercise-help:has-text('hint 2 of')")
    box.get_by_role("button", name="Solution").click()
    page.wait_for_selector(".exercise-help:has-text('one solution, from')")
    assert violations(page, within=".explore, .exercise") == []
    with page.expect_download() as loading:
        box.get_by_role("button", name="Save as a notebook").click()
    saved = tmp_path / "handed_in" / loading.value.suggested_filename
    loading.value.save_as(saved)
    assert saved.name == "06_homography_dlt.ipynb"
    cells = [cell.source for cell in nbformat.read(saved, as_version=4).cells]
    assert f'{ANSWERS["dlt"]}\n\n\ncheck("dlt", my_dlt)' in cells
    page.reload()
    assert page.locator("#answer-dlt").input_value() == ANSWERS["dlt"]
    assert page.locator("label[for=answer-dlt]").inner_text().endswith("✓ solved")
    marks = tmp_path / "marks.csv"
    assert cvnotes(["grade", str(saved.parent), "--out", str(marks)]) == 0
    with marks.open(newline="", encoding="utf-8") as table:
        [row] = csv.DictReader(table)
    assert [row[name] for name in ("normaliser", "dlt", "four_points")] == ["1", "1", "0"], row


# Bad luck.


def test_without_webassembly_a_sentence_says_so_and_the_page_is_read(open_page):
    page = open_page("all_explorations", "delete globalThis.WebAssembly")
    box = explorations(page)["lens"]
    box.locator("input").first.focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_selector(".explore-state:has-text('This browser has no WebAssembly')")
    assert box.locator("img").is_visible()


def test_without_storage_exercises_work_and_a_sentence_says_that_nothing_is_kept(open_page):
    refuse = """const own = Storage.prototype.setItem;
    Storage.prototype.setItem = function (key, text) {
        if (key.startsWith('cvnotes')) throw new DOMException('full');
        own.call(this, key, text);
    }"""
    page = open_page("06_homography_dlt", refuse)
    page.wait_for_selector(".exercise-state:has-text('This browser keeps nothing')")
    box = write(page, "normaliser", ANSWERS["normaliser"])
    assert "save it as a notebook" in box.locator(".exercise-state").inner_text()


def test_a_worker_that_dies_takes_nothing_with_it(open_page):
    die = """const Own = Worker; let first = true;
    globalThis.Worker = class extends Own {
        constructor(...given) {
            super(...given);
            const event = {preventDefault() {}, message: 'out of memory'};
            if (first) setTimeout(() => this.onerror(event), 50);
            first = false;
        }
    };"""
    page = open_page("all_explorations", die)
    box = explorations(page)["lens"]
    box.locator("input").first.focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_selector(".explore-state:has-text('Python ended (out of memory)')")
    page.keyboard.press("ArrowRight")
    becomes_another(page, box, 0)


def test_a_broken_line_is_said_and_tried_again(open_page):
    page = open_page("all_explorations")
    page.context.route("**/numpy-*.whl", lambda route: route.fulfill(status=503, body=""))
    box = explorations(page)["lens"]
    box.locator("input").first.focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_selector(".explore-state:has-text('Python could not be loaded')", timeout=AWAKE)
    page.context.unroute("**/numpy-*.whl")
    page.keyboard.press("ArrowRight")
    becomes_another(page, box, 0)


def test_two_tabs_keep_what_was_written_last(open_page):
    page = open_page("06_homography_dlt")
    other = page.context.new_page()
    other.goto(page.url)
    write(page, "dlt", "def my_dlt(src, dst):\n    return 1")
    other.wait_for_function("document.querySelector('#answer-dlt').value.includes('return 1')")
    other.locator("#answer-dlt").focus()
    write(page, "dlt", "def my_dlt(src, dst):\n    return 2")
    other.wait_for_selector(".exercise-state:has-text('Another tab has written into this box too')")
    assert "return 1" in other.locator("#answer-dlt").input_value()
