"""The site with Python in it, in a real browser: nothing outside is asked, and it works offline."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from accessible import violations
from conftest import CHROMIUM, OF_CHROMIUM, taken, text_of
from PIL import Image

from cvnotes.files.ownership import maker
from cvnotes.targets import Chessboard

pytestmark = [pytest.mark.slow, pytest.mark.once]

ROOT = Path(__file__).resolve().parents[1]
VIEWS = sorted((ROOT / "data" / "views").glob("*.png"))
ANSWERED = """() => /The camera is known|No camera|found in none|stopped|wrong|missing/.test(
    document.querySelector('#camera-page .said').textContent)"""
LEFT_OUT = "() => !document.querySelector('.shots li')"
RUN_ALL = """async () => {
    const app = window.jupyterapp;
    await app.restored;
    const panel = app.shell.currentWidget;
    await panel.context.ready;
    await panel.sessionContext.ready;
    await panel.sessionContext.session.kernel.info;
    await app.commands.execute('notebook:run-all-cells');
    return panel.content.model.toJSON().cells.filter(cell => cell.cell_type === 'code')
        .map(cell => cell.outputs);
}"""
KERNEL_IS_THERE = """async () => {
    const { context, sessionContext } = window.jupyterapp.shell.currentWidget;
    await context.ready;
    await sessionContext.ready;
    await sessionContext.session.kernel.info;
}"""
SHOW_CELL = """async words => {
    const notebook = window.jupyterapp.shell.currentWidget.content;
    const sources = notebook.widgets.map(cell => cell.model.sharedModel.getSource());
    await notebook.scrollToItem(sources.findIndex(source => source.includes(words)), 'start');
}"""


@pytest.fixture(scope="module")
def watched(chromium, live_site):
    """Give what makes contexts, and whom but the site they asked and what errors they met."""
    told, ours = [], (live_site.rsplit("/", 2)[0], "data:", "blob:")

    def made():
        context = chromium.new_context(viewport={"width": 1280, "height": 900})
        context.on("request", lambda r: None if r.url.startswith(ours) else told.append(r.url))
        context.on("weberror", lambda e: told.append(str(e.error)))
        return context

    return made, told


@pytest.fixture
def page(watched):
    """Give an empty page; at its end it has asked nobody but the site, and met no error."""
    context = watched[0]()
    yield context.new_page()
    context.close()
    assert taken(watched[1]) == []


@pytest.fixture(scope="module")
def first_visit(watched, live_site, tmp_path_factory):
    """Drop photographs at a first visit, and a file that is none; gives the page and its answer."""
    foreign = tmp_path_factory.mktemp("dropped") / "foreign.jpg"
    foreign.write_text("no picture")
    context = watched[0]()
    page = context.new_page()
    said = drop(page, [*VIEWS, foreign], live_site)
    yield page, said
    context.close()


@pytest.fixture
def camera_page(first_visit, watched):
    """Give the page with Python awake; at its end it asked nobody but the site, without error."""
    yield first_visit[0]
    assert taken(watched[1]) == []


def drop(page, files, live_site=None, asked=""):
    if live_site:
        page.goto(f"{live_site}/your_camera.html{asked}")
    page.locator("#camera-page .said").evaluate("said => said.textContent = ''")
    page.set_input_files("#camera-page .drop input", files)
    page.wait_for_function(ANSWERED, timeout=240_000, polling=100)
    return page.inner_text("#camera-page .said")


def leave_all_out(page):
    for _ in range(page.locator(".shots li").count()):
        page.locator(".shots li button", has_text="Leave out").first.click()
    page.wait_for_function(LEFT_OUT, polling=100)


def test_dropped_photographs_give_the_camera_of_the_desktop(
    camera_page, first_visit, camera_of_the_views
):
    page, said = camera_page, first_visit[1]
    assert said == "The camera is known from 12 of 13 photographs."
    assert [page.input_value(f"[name={name}]") for name in ("columns", "rows")] == ["9", "6"]
    assert "✗ not used: not a picture" in page.inner_text(".shots li.refused")
    not_read = "foreign.jpg: not a picture, or in a format that is not read"
    assert page.inner_text(".reasons") == not_read
    with page.expect_download() as download:
        page.click(".files a >> text=calibration.json")
    found = json.loads(Path(download.value.path()).read_text())
    assert page.text_content(".words") == text_of(camera_of_the_views["words"])
    assert re.search(r"✓ board found: 0\.\d{3} px", page.inner_text(".shots"))
    expected = json.loads(camera_of_the_views["files"]["calibration.json"])
    ours, theirs = found["camera_matrix"], expected["camera_matrix"]
    assert str(ours)[:4] == str(theirs)[:4]
    assert found["rms"] == pytest.approx(expected["rms"], rel=1e-6)
    assert violations(page) == []


def test_a_photograph_is_kept_straightened_and_the_board_to_print(camera_page, tmp_path):
    page = camera_page
    with page.expect_download() as download:
        page.click(f"text={VIEWS[3].name} >> xpath=.. >> text=Straighten")
    assert download.value.suggested_filename == f"{VIEWS[3].stem}-straight.png"
    download.value.save_as(tmp_path / "straight.png")
    assert maker(tmp_path / "straight.png") == "undistort"
    straight, before = (Image.open(path) for path in (tmp_path / "straight.png", VIEWS[3]))
    assert straight.size == before.size
    assert np.abs(np.subtract(straight, before, dtype=float)).mean() > 1
    with page.expect_download() as download:
        page.click("text=Make a PDF of the board")
    assert download.value.suggested_filename == "board-9x6.pdf"
    assert Path(download.value.path()).read_bytes() == Chessboard((9, 6), 25.0).sheet().pdf()


def test_the_machines_own_camera_takes_photographs(camera_page):
    page = camera_page
    leave_all_out(page)
    page.click("text=Use this machine's camera")
    page.wait_for_selector("section.live video", state="visible", timeout=60_000)
    page.click("text=Take a photograph")
    page.wait_for_selector(".shots li.refused", timeout=120_000)
    assert "✗ not used: no chessboard found" in page.inner_text(".shots")
    page.click("text=Stop the camera")
    assert page.is_visible("text=Use this machine's camera")


def test_a_worker_that_dies_takes_no_photograph_with_it(camera_page):
    page = camera_page
    leave_all_out(page)
    assert "from 4 of 4" in drop(page, VIEWS[:4])
    page.evaluate(
        "() => { window.Worker = class { constructor() { setTimeout(() => "
        "this.onerror({message: 'out of memory'}), 50); } postMessage() {} terminate() {} } }"
    )
    [worker] = (each for each in page.workers if "camera_worker" in each.url)
    worker.evaluate("() => { self.onmessage = () => { throw new Error('out of memory'); }; }")
    page.fill("#camera-page [name=square]", "30")
    page.locator("#camera-page [name=square]").blur()
    page.wait_for_selector(".shots li.refused", timeout=60_000)
    assert "Python stopped at this photograph (out of memory)" in page.inner_text(".shots")
    assert page.locator(".shots li").count() == 4


def film(path, pictures, seconds):
    """Write pictures as a film of one frame a second, uncompressed, as a camera would give them."""
    height, width = pictures[0].shape
    colourless = bytes([128]) * (width * height // 2)
    with path.open("wb") as out:
        out.write(f"YUV4MPEG2 W{width} H{height} F1:1 Ip A1:1 C420jpeg\n".encode())
        for picture in pictures:
            out.write((b"FRAME\n" + picture.tobytes() + colourless) * seconds)


def test_the_machines_own_camera_takes_a_picture_by_itself_of_a_new_view_that_is_still(
    chromium, live_site, tmp_path
):
    pictures = [np.asarray(Image.open(path).convert("L")) for path in VIEWS[:3]]
    film(tmp_path / "board.y4m", pictures, 10)
    arguments = [*OF_CHROMIUM, f"--use-file-for-fake-video-capture={tmp_path / 'board.y4m'}"]
    browser = chromium.browser_type.launch(executable_path=CHROMIUM, args=arguments)
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    page.goto(f"{live_site}/your_camera.html")
    page.click("text=Use this machine's camera")
    page.wait_for_function(
        "() => document.querySelectorAll('.shots li.used').length >= 2", timeout=240_000
    )
    words = "/there is such a photograph already|another view would help more/"
    page.wait_for_function(
        f"() => {words}.test(document.querySelector('.live p').textContent)", timeout=60_000
    )
    page.uncheck(".by-itself")
    assert page.locator(".shots li").count() <= 3  # a view that stays does not come twice
    assert page.locator(".shots li.refused").count() == 0
    page.click("text=Stop the camera")
    browser.close()


def test_a_chapter_runs_in_jupyterlite_from_its_page(page, live_site):
    page.goto(f"{live_site}/notebooks/03_camera_model.html")
    page.click("text=Run this chapter in this browser")
    page.wait_for_function(
        "() => window.jupyterapp?.shell?.currentWidget?.context", timeout=120_000
    )
    outputs = page.evaluate(RUN_ALL)
    assert len(outputs) > 10
    errors = [o["evalue"] for cell in outputs for o in cell if o["output_type"] == "error"]
    assert all("no OpenCV in a browser" in words for words in errors), errors
    red = [o["text"] for cell in outputs for o in cell if o.get("name") == "stderr"]
    assert red == []
    # (what stands behind a cell that needs OpenCV is left alone when all are run)
    pictures = sum("<img" in str(cell) for cell in outputs)
    assert pictures >= 3, outputs
    grip = page.get_by_label("the camera, to carry it round the board")
    page.evaluate(SHOW_CELL, 'explore("camera"')
    grip.wait_for(state="visible", timeout=60_000)
    grip.focus()
    expect = pytest.importorskip("playwright.sync_api").expect
    box = page.locator(".cvnotes-explorer", has=grip)
    angle = box.locator(".widget-slider", has_text="angle x").locator(".widget-readout")
    before = angle.inner_text()
    for _ in range(3):
        page.keyboard.press("Shift+ArrowDown")
    expect(angle).not_to_have_text(before, timeout=20_000)
    # Saved and opened again, with another kernel: the picture, and no error in its place.
    page.evaluate("() => window.jupyterapp.shell.currentWidget.context.save()")
    page.reload()
    page.wait_for_function(
        "() => window.jupyterapp?.shell?.currentWidget?.context", timeout=120_000
    )
    page.evaluate(KERNEL_IS_THERE)
    page.evaluate(SHOW_CELL, 'explore("camera"')
    still = page.locator(".jp-OutputArea-output img[alt^='The picture that a camera takes']")
    still.first.wait_for(timeout=60_000)
    assert page.locator("text=Error displaying widget").count() == 0


def test_after_one_visit_pages_and_python_are_there_without_a_network(
    first_visit, watched, live_site
):
    context = first_visit[0].context
    page = context.new_page()
    page.goto(f"{live_site}/notebooks/07_zhang_calibration.html")
    said = drop(page, VIEWS[:4], live_site, "?corners=8x5&square=26.5")
    assert said.endswith("of 8×5 inner corners was asked for, but 4 photographs show one of 9×6.")
    page.click("text=Take 9×6")
    page.wait_for_selector(".said:has-text('from 4 of 4')", timeout=240_000)
    assert not page.is_checked("[name=counted]")
    assert page.input_value("[name=square]") == "26.5"
    context.set_offline(True)
    page.goto(f"{live_site}/notebooks/07_zhang_calibration.html")
    assert "Zhang" in page.inner_text("h1")
    assert "from 5 of 5" in drop(page, VIEWS[:5], live_site)
    page.goto(f"{live_site}/notebooks/01_projective_space.html")
    assert "no network, and this page has not been visited" in page.inner_text("body")
    assert taken(watched[1]) == []
