"""The site: complete, without a dead link, and whole when there is no network."""

import inspect
import re
import shutil
import subprocess
import sys
from contextlib import suppress
from html.parser import HTMLParser
from importlib import import_module
from pathlib import Path
from urllib.parse import unquote, urlsplit

import nbformat
import numpy as np
import pytest

pytestmark = [pytest.mark.slow, pytest.mark.once]

ROOT = Path(__file__).resolve().parents[1]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
# These serve the command, the build or others of the package.
INTERNAL = {"commands"}


class Page(HTMLParser):
    """What a page has in it: anchors, what it loads, where it leads, its pictures' words."""

    def __init__(self, path):
        super().__init__()
        self.ids, self.loads, self.links, self.alts, self.classes = set(), [], [], [], []
        self.feed(path.read_text())

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.ids |= {given.get("id"), given.get("name")}
        self.classes += [(tag, *(given.get("class") or "").split())]
        if tag in ("script", "img", "iframe") and given.get("src"):
            self.loads.append(given["src"])
        if tag == "link" and "stylesheet" in given.get("rel", ""):
            self.loads.append(given["href"])
        if tag == "a" and given.get("href"):
            self.links.append(given["href"])
        if tag == "img":
            self.alts.append(given.get("alt"))


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    """Build the site without Python."""
    out = tmp_path_factory.mktemp("site") / "built"
    script = ROOT / "tools" / "build_site.py"
    run = subprocess.run(
        [sys.executable, script, "--without-python", "--out", out],
        capture_output=True,
        text=True,
        cwd=ROOT,
    )
    assert run.returncode == 0, run.stdout + run.stderr  # a warning fails the build
    return out


@pytest.fixture(scope="module")
def site(request):
    """Give the site with Python in it, which is what readers print and see, or else without."""
    with suppress(pytest.skip.Exception):
        return request.getfixturevalue("live_folder")
    return request.getfixturevalue("plain")


def pages_of(site):
    made = [path.relative_to(site) for path in site.rglob("*.html")]
    # JupyterLite and Python are others' pages, and are tested where they are used.
    ours = [path for path in made if not {"_static", "lite", "python"} & set(path.parts)]
    return {path: Page(site / path) for path in ours}


@pytest.fixture(scope="module")
def pages(site):
    return pages_of(site)


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_each_notebook_is_a_page_with_its_cells_and_its_described_figures(notebook, pages):
    cells = nbformat.read(notebook, as_version=4).cells
    # What only a notebook can do, such as to turn a scene in space, is left out of its page.
    cells = [each for each in cells if "remove-cell" not in each.metadata.get("tags", [])]
    page = pages[Path("notebooks") / f"{notebook.stem}.html"]
    inputs = sum({"div", "cell_input"} <= set(classes) for classes in page.classes)
    assert inputs == sum(cell.cell_type == "code" for cell in cells)
    saved = sum(
        'alt="' in output.get("data", {}).get("text/html", "")
        for cell in cells
        for output in cell.get("outputs", [])
    )
    described = [alt for alt in page.alts if alt and len(alt) > 20]
    assert len(described) >= saved > 0


def dead_links(site, pages):
    dead = []
    for path, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (site / path.parent / unquote(parts.path)).resolve() if parts.path else None
            name = target.relative_to(site.resolve()) if target else path
            if not (site / name).is_file():
                dead.append((str(path), link))
            elif parts.fragment and name in pages:
                known = pages[name].ids
                if unquote(parts.fragment) not in known:
                    dead.append((str(path), link))
    return dead


def test_no_link_leads_nowhere(site, pages):
    assert not dead_links(site, pages)


def test_without_python_the_site_is_whole_too(plain):
    pages = pages_of(plain)
    assert sum(path.parent == Path("notebooks") for path in pages) == len(NOTEBOOKS)
    assert not dead_links(plain, pages)


def test_the_chapter_of_your_own_camera_leads_to_the_pages_that_calibrate_and_show_a_board(
    live_folder, plain
):
    """Where there are such pages; without them their names are words."""
    of_live, of_plain = (
        (folder / "notebooks/09_your_own_camera.html").read_text().split("<article")[1]
        for folder in (live_folder, plain)
    )  # beside an article the menu leads there, too
    for page in ("your_camera", "board_on_screen"):
        assert f'href="../{page}.html"' in of_live.partition("</article")[0]
        assert f"{page}.html" not in of_plain


def test_no_page_loads_anything_from_elsewhere(site, pages):
    for path, page in pages.items():
        for source in page.loads:
            parts = urlsplit(source)
            assert parts.scheme in ("", "data"), (path, source)
            assert not parts.netloc, (path, source)
            if not parts.scheme:
                assert (site / path.parent / unquote(parts.path)).is_file(), (path, source)


def test_everything_public_is_in_the_reference(pages):
    modules = {p.stem for p in (ROOT / "cvnotes").iterdir() if not p.name.startswith(("_", "py"))}
    known = {path.stem for path in pages if path.parent == Path("reference")}
    assert modules - INTERNAL <= known
    imported = {
        name
        for notebook in NOTEBOOKS
        for name in re.findall(r"from cvnotes\.([\w.]+) import", notebook.read_text())
    }
    assert imported <= known
    for name in known - {"index"}:
        module = import_module(f"cvnotes.{name}")
        public = getattr(module, "__all__", None) or [
            key
            for key, value in vars(module).items()
            if getattr(value, "__module__", "") == module.__name__ and not key.startswith("_")
        ]
        ids = pages[Path("reference") / f"{name}.html"].ids
        for key in public:
            if inspect.isfunction(getattr(module, key)) or inspect.isclass(getattr(module, key)):
                assert f"cvnotes.{name}.{key}" in ids, (name, key)


def test_each_page_has_its_mark_in_the_table_of_contents(site, pages):
    marked = re.compile(
        r'<li class="toctree-l[12] current active[^"]*"><a class="current [^>]*>(.*?)</a>'
    )
    for path in pages:
        if path.parent.parts and path.parts[0] != "_modules":
            text = (site / path).read_text()
            title = re.search(r"<title>\s*(.*?) &#8212;", text, re.DOTALL)
            assert marked.findall(text) == [title[1]], path
            assert text.count('<ul class="current nav') == 1, path


def test_formulas_are_set_without_a_network(site, chromium):
    asked = []
    page = chromium.new_page()
    page.on("request", lambda request: asked.append(request.url))
    page.goto((site / "notebooks" / "07_zhang_calibration.html").as_uri())
    page.wait_for_selector("mjx-container mjx-mo", state="attached", timeout=60_000)
    assert not page.query_selector("mjx-merror")
    assert re.match("7 · Zhang’s calibration", page.inner_text("h1"))
    page.close()
    assert all(url.startswith(("file:", "data:")) for url in asked), asked


@pytest.fixture(scope="module")
def telephone(chromium):
    """Give a page 400 px wide."""
    return chromium.new_page(viewport={"width": 400, "height": 900})


@pytest.mark.parametrize(
    "name",
    ["index", "docs/teaching", "docs/notation", "reference/homography", "reference/calibration"],
)
def test_on_a_telephone_no_page_is_wider_than_the_screen(site, telephone, name):
    telephone.goto((site / f"{name}.html").as_uri())
    assert telephone.evaluate("document.documentElement.scrollWidth") <= 400


# How many formulas have a comma or the like behind them, and where it begins another line.
LONE = """() => {
    let count = 0;
    const lone = [];
    for (const formula of document.querySelectorAll(".bd-article span.math")) {
        const behind = formula.nextSibling, letter = document.createRange();
        if (!/^[.,;:)]/.test(behind?.data)) continue;
        letter.setStart(behind, 0);
        letter.setEnd(behind, 1);
        const { top, height } = letter.getBoundingClientRect();
        if (!height) continue;
        count += 1;
        const end = formula.lastElementChild.getBoundingClientRect().bottom;
        if (top > end) lone.push(formula.parentElement.parentElement.textContent);
    }
    return [count, lone];
}"""


def test_on_a_telephone_panels_are_stacked_and_a_long_formula_begins_at_its_beginning(
    site, telephone
):
    telephone.goto((site / "notebooks" / "07_zhang_calibration.html").as_uri())
    telephone.wait_for_selector("mjx-container mjx-mo", state="attached", timeout=60_000)
    long = telephone.evaluate(
        """() => [...document.querySelectorAll("div.math")]
            .filter((box) => box.scrollWidth > box.clientWidth + 1)
            .map((box) => box.querySelector("mjx-math").getBoundingClientRect().left
                          - box.getBoundingClientRect().left)"""
    )
    assert long
    assert min(long) > -1  # px: what is left of a box cannot be scrolled to
    punctuated, lone = telephone.evaluate(LONE)
    assert punctuated > 50
    assert lone == []
    telephone.goto((site / "notebooks" / "05_calibration_targets.html").as_uri())
    telephone.wait_for_function(  # figures are fetched when they come into sight
        """() => {
            const figures = [...document.querySelectorAll("img[data-panels]")];
            figures.find((image) => !image.complete)?.parentElement.scrollIntoView();
            return figures.length === document.querySelectorAll(".panels").length;
        }""",
        timeout=60_000,
        polling=100,
    )
    stacks = telephone.evaluate(
        """() => [...document.querySelectorAll(".panels")].map((stack) =>
            [getComputedStyle(stack.nextElementSibling).display, ...[...stack.children].map(
                (c) => [c.width, c.getBoundingClientRect().width])])"""
    )
    assert len(stacks) >= 3
    for hidden, *widths in stacks:
        assert hidden == "none"
        assert len(widths) in (2, 3, 4)
        assert max(shown for _, shown in widths) > 300
        assert np.ptp([stored / shown for stored, shown in widths]) < 0.05  # all to one scale


def test_on_a_telephone_an_exploration_has_a_still_of_its_own_with_letters_as_large(
    site, telephone
):
    telephone.goto((site / "notebooks" / "10_two_pictures.html").as_uri())
    telephone.wait_for_selector(".explore-stage picture")
    shown = telephone.evaluate(
        """() => Promise.all(Array.from(document.querySelectorAll(".explore-stage"), async box => {
            const image = box.querySelector("img");
            image.loading = "eager";
            await image.decode();
            const grips = [...box.querySelectorAll("button.explore-grip")];
            const { naturalWidth, naturalHeight, clientWidth, clientHeight } = image;
            return [image.currentSrc !== image.src, naturalWidth, clientWidth,
                    naturalHeight / naturalWidth - clientHeight / clientWidth,
                    grips.map((grip) => getComputedStyle(grip).display)];
        }))"""
    )
    assert len(shown) >= 6
    for own, width, wide, bent, grips in shown:
        assert own
        assert wide > 300
        assert wide / (width / 2) > 0.75  # of 12 px, 9 are left
        assert abs(bent) < 0.02
        assert "none" not in grips


def test_each_chapter_keeps_a_guess_and_sets_it_beside_its_answer(site, chromium):
    page = chromium.new_context().new_page()
    for path in sorted((site / "notebooks").glob("*.html")):
        page.goto(path.as_uri())
        forms = page.locator(".guess")
        assert forms.count() >= (not path.stem.startswith("more")), path.stem
        assert page.locator("em", has_text="in place of the dots").count() == 0
        for form in forms.all():
            name = form.locator("input")
            name.fill("7" if path.stem[:2] != "09" else "MORE than 10")
            form.locator("button").click()
            assert form.locator("output").inner_text().startswith("Kept")
        assert page.get_by_text("You had not guessed").count() == 0, path.stem
        assert page.get_by_text(re.compile("You guessed")).count() == forms.count(), path.stem
    page.goto((site / "notebooks" / "00_start_here.html").as_uri())  # it is kept for another day
    assert page.get_by_text("You guessed 7 px; it is 2.1 px. Off by 4.9 px.").count() == 1
    page.locator(".guess input").fill("2,1")
    page.keyboard.press("Enter")
    assert page.get_by_text("You guessed 2,1 px; it is 2.1 px. Exactly.").count() == 1
    page.goto((site / "notebooks" / "09_your_own_camera.html").as_uri())
    assert page.get_by_text("it is more than 10. Right.").count() == 1
    page.context.close()


# How much room is left and right of each picture.
BESIDE = """() => [...document.querySelectorAll(".cell_output img")].map((image) => {
    const outer = image.closest(".cell_output").getBoundingClientRect();
    const inner = image.getBoundingClientRect();
    return [inner.left - outer.left, outer.right - inner.right];
})"""


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_each_picture_stands_in_the_middle(site, chromium, scheme):
    page = chromium.new_context(
        viewport={"width": 1280, "height": 900}, color_scheme=scheme
    ).new_page()
    page.goto((site / "notebooks" / "07_zhang_calibration.html").as_uri())
    beside = page.evaluate(BESIDE)
    assert len(beside) > 10
    assert [sides for sides in beside if abs(sides[0] - sides[1]) > 1] == []
    page.context.close()


def test_at_1280_px_a_line_of_100_letters_fits_and_what_is_printed_wraps(site, chromium):
    page = chromium.new_page(viewport={"width": 1280, "height": 900})
    longest = 0
    for name in ("00_start_here", "09_your_own_camera"):
        page.goto((site / "notebooks" / f"{name}.html").as_uri())
        cut = """() => [...document.querySelectorAll(".bd-article .cell pre")]
            .filter((box) => box.scrollWidth > box.clientWidth + 1).map((box) => box.innerText)"""
        assert page.evaluate(cut) == []
        code = page.locator(".cell_input pre").all_inner_texts()
        lines = [line for text in code for line in text.splitlines()]
        longest = max(longest, *map(len, lines))
    assert longest == 100
    page.close()


def test_a_chapter_shows_pictures_as_wide_as_drawn_whole_tables_and_leads_to_the_others(
    site, chromium
):
    page = chromium.new_page(viewport={"width": 1280, "height": 900})
    for path in NOTEBOOKS:
        page.goto((site / "notebooks" / f"{path.stem}.html").as_uri())
        widths = page.evaluate(
            """() => [...document.querySelectorAll(".cell_output img")]
                .map((one) => [one.getBoundingClientRect().width, +one.getAttribute("width")])"""
        )
        assert widths, path
        assert all(shown >= min(drawn, 920) - 1 for shown, drawn in widths), path
        cut = """() => [...document.querySelectorAll(".bd-article table")]
            .filter((one) => one.scrollWidth > one.parentElement.clientWidth + 1).length"""
        assert page.evaluate(cut) == 0, path
        loaded = "[...document.fonts].filter((one) => one.status === 'loaded').length"
        assert page.evaluate(f"document.fonts.ready.then(() => {loaded})") >= 3, path
        heads = page.locator(".chapters a")
        assert heads.count() == 1 + len(NOTEBOOKS)
        here = page.locator(".chapters [aria-current=page]")
        assert here.get_attribute("title") == page.inner_text("h1").strip().rstrip("#")
        assert not page.locator(".bd-sidebar-primary").is_visible()
        page.click(".primary-toggle")
        page.wait_for_selector(".bd-sidebar-primary")  # until it is visible
    page.close()


def test_on_paper_a_chapter_has_all_its_lines_and_figures(site, chromium, tmp_path):
    if not shutil.which("pdftotext"):
        pytest.skip("no pdftotext on this machine (Debian: poppler-utils)")
    (path,) = (path for path in NOTEBOOKS if path.name.startswith("07"))
    page = chromium.new_page(viewport={"width": 1280, "height": 900})
    page.goto((site / "notebooks" / f"{path.stem}.html").as_uri())
    page.wait_for_function(
        "[...document.images].every((image) => image.complete && image.naturalWidth)"
    )
    page.pdf(path=tmp_path / "chapter.pdf", format="A4")
    page.close()
    # in the order of the page's own text: by its layout a line that is wrapped can be torn apart
    read = ["pdftotext", "-raw", tmp_path / "chapter.pdf", "-"]
    text = subprocess.run(read, capture_output=True, text=True, check=True).stdout
    printed = re.sub(r"\s", "", text)
    cells = [c for c in nbformat.read(path, as_version=4).cells if c.cell_type == "code"]
    lost = [
        line
        for cell in cells
        for line in cell.source.splitlines()
        if re.sub(r"\s", "", line) not in printed
    ]
    assert lost == []
    assert not re.search("Startagain|Tabindents", printed)
    listed = subprocess.run(
        ["pdfimages", "-list", tmp_path / "chapter.pdf"], capture_output=True, text=True, check=True
    ).stdout
    # Drawings of lines are not listed.
    figures = sum(bool(re.search("image/(png|webp);", str(cell.outputs))) for cell in cells)
    assert figures > 5
    assert len(re.findall(r"\bimage\b", listed)) >= figures


def test_a_chapter_is_less_than_a_third_of_a_megabyte_and_its_figures_come_when_they_are_seen(site):
    pages = sorted((site / "notebooks").glob("*.html"))
    for page in pages:
        text = page.read_text()
        assert len(text.encode()) < 300_000, page.name
        figures = re.findall(r'<img [^>]*loading="lazy"[^>]*src="([^"]+)"', text)
        assert figures, page.name
        assert all((page.parent / figure).is_file() for figure in figures)
        assert not re.search(r"data:image/(png|webp)", text)
    assert len(pages) == len(NOTEBOOKS)


def test_references_are_not_read_as_lists(site):
    for path in (site / "reference").glob("*.html"):
        text = path.read_text()
        assert not re.search(r'<span class="label">.*?</span>\s*<ol', text, re.S), path.name
        assert "upperalpha" not in text, path.name
    assert "Z. Zhang" in (site / "reference" / "calibration.html").read_text()


@pytest.fixture(scope="module")
def reminded(site):
    """Give the words that can be pressed in each chapter, and what they say, links included."""
    pair = re.compile(
        r'class="word" popovertarget="(word-\d+)" aria-label="[^"]+">(.*?)</button>'
        r'<span popover id="\1" class="reminder"><span>(?:<span class="math[^>]*>[^<]*</span>: )?'
        r"<span>(.*?\))</span></span></span>",
        re.DOTALL,
    )
    return {
        path.stem: [
            found[1:]
            for found in pair.findall((site / "notebooks" / f"{path.stem}.html").read_text())
        ]
        for path in NOTEBOOKS
    }


def test_a_word_is_recalled_in_chapters_after_its_own_and_once_in_each(site, reminded):
    for chapter, pressed in reminded.items():
        text = (site / "notebooks" / f"{chapter}.html").read_text()
        assert text.count("popovertarget=") == text.count("<span popover") == len(pressed)
        for word, said in pressed:
            (source,) = re.findall(r'href="\.\./notebooks/(\d\d_\w+)\.html#[\w-]+"', said)
            assert source < chapter, (chapter, word)
            assert "popover" not in said
        assert len({said for _, said in pressed}) == len(pressed)


def test_each_word_of_the_table_is_recalled_somewhere(reminded):
    rows = (ROOT / "docs" / "words.md").read_text().count("](../notebooks/")
    assert rows == len({said for pressed in reminded.values() for _, said in pressed}) > 25


def test_a_word_that_is_pressed_says_what_it_is_until_escape(site, chromium):
    page = chromium.new_page(viewport={"width": 390, "height": 700})
    page.goto((site / "notebooks" / "11_board_we_believed.html").as_uri())
    word = page.locator(".word", has_text="residual")
    said = page.locator(".reminder", has_text="done its best")
    assert not said.is_visible()
    word.click()
    assert said.is_visible()
    box = said.bounding_box()
    assert box["x"] >= 0
    assert box["x"] + box["width"] <= 390
    assert box["y"] + box["height"] <= 700
    page.keyboard.press("Escape")
    assert not said.is_visible()
