"""The site with Python in it, in Firefox and in Safari's engine: what test_site_live.py and
test_site_offline.py hold of Chromium, in short.
"""

import json
from pathlib import Path

import pytest
from conftest import IMPATIENT, text_of
from firefox import PROGRAM, Firefox
from webkit import DRIVER, SCREEN, WebKit

from cvnotes.show import explorations

pytestmark = [pytest.mark.slow, pytest.mark.once]

ROOT = Path(__file__).resolve().parents[1]
VIEWS = sorted((ROOT / "data" / "views").glob("*.png"))
OTHERS = '.explore:not([aria-label="Exploration: homography"])'
SHOWN = """() => {
    const canvas = document.querySelector('.explore canvas');
    if (canvas.hidden) return 0;
    const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    let sum = 0;
    for (let i = 0; i < data.length; i += 4) sum = (31 * sum + data[i] + 2 * data[i + 1]) % 1000003;
    return sum;
}"""
ANOTHER = f"before => {{ const now = ({SHOWN})(); return now !== before && now; }}"
SENTENCE = "words => document.querySelector('.explore-sentence').textContent === words"
# Brought into view, and drawn there: until then Firefox takes a touch there for scrolling.
GRIP = """async label => {
    const grip = document.querySelector(`.explore-grip[aria-label^="${label}"]`);
    grip.scrollIntoView({block: 'center', behavior: 'instant'});
    for (let frame = 0; frame < 3; frame += 1) await new Promise(requestAnimationFrame);
    const {x, y, width, height} = grip.getBoundingClientRect();
    return [x + width / 2, y + height / 2];
}"""
# Where a grip is on its stage, and whether the last picture has it there.
AT = """label => {
    const grip = document.querySelector(`.explore-grip[aria-label^="${label}"]`);
    const [own, stage] = [grip, grip.parentElement].map((place) => place.getBoundingClientRect());
    return [own.x + own.width / 2 - stage.x, own.y + own.height / 2 - stage.y];
}"""
FOLLOWED = f"""(label, x, y) => {{
    const [here, there] = ({AT})(label);
    return Math.hypot(here - x, there - y) < 2;
}}"""
WRITE = """(name, text) => {
    const area = document.querySelector(`#answer-${name}`);
    area.value = text;
    area.dispatchEvent(new Event('input', {bubbles: true}));
    area.closest('.exercise').querySelector('.exercise-report').replaceChildren();
    area.closest('.exercise').querySelector('button').click();
}"""
REPORT = """name => document.querySelector(`#answer-${name}`).closest('.exercise')
    .querySelector('.exercise-report').textContent"""
# How wide the board on the screen, its squares and the card are, and what is said of them.
BOARD = """() => {
    const shown = [...document.querySelectorAll('#screen-page dialog svg')].filter(
        (svg) => svg.style.display === 'block');
    const {width, height} = shown[0].getBoundingClientRect();
    const card = document.querySelector('#screen-page .card').style.width;
    const words = document.querySelector('#screen-page dialog span').textContent;
    return [shown.length, width, height, parseFloat(card), words];
}"""
# Files that were chosen in an input of our own, dropped as if by a hand.
DROP = """() => {
    const carried = new DataTransfer();
    for (const file of document.querySelector('#carried').files) carried.items.add(file);
    document.querySelector('#camera-page .drop').dispatchEvent(
        new DragEvent('drop', {bubbles: true, cancelable: true, dataTransfer: carried}));
}"""
CARRIER = """() => {
    const input = document.createElement('input');
    Object.assign(input, {type: 'file', multiple: true, id: 'carried'});
    document.body.append(input);
}"""
IDLE = """() => {
    const panel = window.jupyterapp?.shell?.currentWidget;
    return panel?.context?.isReady && panel.sessionContext.session?.kernel?.status === 'idle';
}"""
# Run the first cells with code; `shown` is then what they show.
RUN_FIRST = """count => {
    const app = window.jupyterapp, notebook = app.shell.currentWidget.content;
    const run = async () => {
        const shown = [];
        for (let i = 0; shown.length < count; i += 1) {
            const { model } = notebook.widgets[i];
            if (model.type !== 'code') continue;
            notebook.activeCellIndex = i;
            await app.commands.execute('notebook:run-cell');
            shown.push(model.outputs.toJSON());
        }
        return shown;
    };
    run().then(shown => window.shown = shown);
}"""
RIGHT = """def my_normaliser(x):
    centre = x.mean(axis=0)
    s = 2**0.5 / np.linalg.norm(x - centre, axis=1).mean()
    return np.array([[s, 0, -s * centre[0]], [0, s, -s * centre[1]], [0, 0, 1]])"""
EXCHANGED = "def my_four_points(src, dst):\n    return my_dlt(dst, src)"
ENDLESS = "def my_normaliser(x):\n    while True:\n        pass"
DLT = """def my_dlt(src, dst):
    T, U, D = my_normaliser(src), my_normaliser(dst), []
    for (x, y), (u, v) in zip(src @ T[:2, :2] + T[:2, 2], dst @ U[:2, :2] + U[:2, 2]):
        D.append([0, 0, 0, -x, -y, -1, v * x, v * y, v])
        D.append([x, y, 1, 0, 0, 0, -u * x, -u * y, -u])
    return np.linalg.inv(U) @ np.linalg.svd(np.array(D))[2][-1].reshape(3, 3) @ T"""


@pytest.fixture(scope="module", params=[Firefox, WebKit], ids=["Firefox", "WebKit"])
def browser(request):
    if request.param is Firefox:
        if PROGRAM is None:
            pytest.skip("no Firefox on this machine")
        pytest.importorskip("websocket", reason="websocket-client is not installed (extra: lab)")
    elif not (DRIVER and SCREEN):
        pytest.skip("no WebKit on this machine (Debian: webkit2gtk-driver and xvfb)")
    with request.param() as opened:
        opened.resize(1300, 900)
        yield opened


@pytest.fixture(scope="module")
def chapter(browser, live_site):
    """Open chapter 6, on which Python is woken once, by the first who asks."""
    browser.open(f"{live_site}/notebooks/06_homography_dlt.html")
    browser.wait("() => document.readyState === 'complete' && !!document.querySelector('.explore')")
    # One exploration is tried; the others would only be drawn meanwhile.
    browser.run(f"() => document.querySelectorAll('{OTHERS}').forEach(x => x.remove())")


@pytest.fixture
def page(browser, live_site):
    """Give the page; at the end it has asked nobody but the site, and met no error."""
    yield browser
    ours = (live_site.rsplit("/", 2)[0], "data:", "blob:")
    assert [url for url in browser.asked() if not url.startswith(ours)] == []
    assert list(browser.errors) == []


def test_dropped_photographs_give_the_camera_of_the_desktop(
    page, live_site, camera_of_the_views, tmp_path
):
    foreign = tmp_path / "foreign.jpg"
    foreign.write_text("no picture")
    page.open(f"{live_site}/your_camera.html")
    page.run(CARRIER)
    page.choose("#carried", [*VIEWS, foreign])
    page.run(DROP)
    said = "() => document.querySelector('#camera-page .said').textContent"
    page.wait(f"() => /^The camera is known|No camera|found in none/.test(({said})())", seconds=240)
    assert page.run(said) == "The camera is known from 12 of 13 photographs."
    assert "not a picture" in page.run("() => document.querySelector('.reasons').textContent")
    words = page.run("() => document.querySelector('.words').textContent")
    assert words == text_of(camera_of_the_views["words"])
    found = page.run(
        "() => fetch(document.querySelector('.files a[download=\"calibration.json\"]').href)"
        ".then(answer => answer.json())"
    )
    expected = json.loads(camera_of_the_views["files"]["calibration.json"])
    assert found["rms"] == pytest.approx(expected["rms"], rel=1e-6)


def test_a_board_on_the_screen_has_squares_of_whole_pixels_as_large_as_is_said(page, live_site):
    page.open(f"{live_site}/board_on_screen.html")
    page.run("() => document.querySelector('#screen-page .show').click()")
    shown, width, height, card, words = page.run(BOARD)
    assert (shown, width % 10, width / 10) == (1, 0, height / 7)
    assert words == f"9×6 inner corners, squares of {width / 10 * 85.60 / card:.2f} mm"


def test_a_chapter_runs_in_jupyterlite(page, live_site):
    page.open(f"{live_site}/lite/notebooks/index.html?path=notebooks/04_lens_distortion.ipynb")
    # WebKit takes two minutes of the processor until Python is there.
    page.wait(IDLE, seconds=900)
    page.run(RUN_FIRST, 5)
    outputs = [output for cell in page.wait("() => window.shown", seconds=600) for output in cell]
    assert [output for output in outputs if output["output_type"] == "error"] == []
    assert [output for output in outputs if output.get("name") == "stderr"] == []
    assert sum("<img" in str(output) for output in outputs) >= 1


@pytest.mark.usefixtures("chapter")
def test_an_exploration_follows_keys_mouse_and_thumb(page):
    page.run("() => document.querySelector('.explore summary').click()")
    page.run("() => document.querySelector('.explore input').focus()")
    page.press("ArrowRight", "ArrowRight")
    page.wait(ANOTHER, 0)
    assert page.wait(SENTENCE, explorations.model("homography").drawing(du1=2).sentence)
    for number, kind in ((2, "mouse"), *([(1, "touch")] if page.touch else [])):
        corner = f"corner {number}"
        (x, y), (u, v), shown = page.run(GRIP, corner), page.run(AT, corner), page.run(SHOWN)
        page.drag([(x, y), (x - 20, y + 12), (x - 30, y + 20)], kind)
        # Until it is where the hand let go: a picture that came later would move the next grip.
        page.wait(FOLLOWED, corner, u - 30, v + 20, seconds=20)
        page.wait(ANOTHER, shown)
    page.run("() => document.querySelector('.explore-grip[aria-label^=\"corner 4\"]').focus()")
    page.press("ArrowLeft")
    page.wait("() => +document.querySelectorAll('.explore input')[6].value < 0", seconds=20)


# (the last one: in WebKit a loop without an end outlives its worker, and keeps a core busy)
@pytest.mark.usefixtures("chapter")
def test_an_exercise_is_right_wrong_by_a_known_mistake_and_endless(page):
    def checked(name, text):
        page.run(WRITE, name, text)
        return page.wait(REPORT, name, seconds=240)

    page.run(IMPATIENT)
    assert "does a loop never end?" in checked("normaliser", ENDLESS)
    page.run("() => { window.setTimeout = window.patiently; }")
    assert "normaliser: ✓ right." in checked("normaliser", RIGHT)
    assert "dlt: ✓ right." in checked("dlt", DLT)
    assert "Your answer is the inverse of the right one." in checked("four_points", EXCHANGED)
