"""Slides made of the notebooks: nothing that a class must see is lost, nothing from elsewhere."""

import functools
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import QuietHandler, serving

pytestmark = pytest.mark.once

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    out = tmp_path_factory.mktemp("slides") / "out"
    command = [sys.executable, ROOT / "tools/build_slides.py", "--out", out, "--without-python"]
    run = subprocess.run(command, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
    return out


@pytest.mark.slow
def test_every_figure_heading_and_trap_of_the_notebooks_is_on_a_slide(made):
    for path in sorted((ROOT / "notebooks").glob("*.ipynb")):
        cells = json.loads(path.read_text())["cells"]
        page = (made / f"{path.stem}.html").read_text()
        alts = [
            alt
            for cell in cells
            for output in cell.get("outputs", [])
            for alt in re.findall(
                r'<img alt="([^"]*)"', "".join(output.get("data", {}).get("text/html", ""))
            )
            if not re.search(r"^(check|guess)\(", "".join(cell["source"]), re.M)
        ]
        assert len(re.findall('class="slide picture"', page)) >= 0.9 * len(alts)
        assert [alt for alt in alts if alt not in page] == []
        prose = "\n".join("".join(c["source"]) for c in cells if c["cell_type"] == "markdown")
        open_prose = re.sub(r"<details>.*?</details>", "", prose, flags=re.S)  # the rest: in notes
        traps = len(re.findall(r"^\*\*Careful", open_prose, re.M))
        assert len(re.findall('class="slide careful"', page)) == traps
        headings = re.findall(r"^## (.+)$", prose, re.M)
        assert len(set(re.findall(r"<h2>(.*?)</h2>", page))) >= 0.7 * len(headings)


@pytest.mark.parametrize("name", ["Answer", "Proof", "More exactly"])
def test_what_is_folded_is_in_the_notes_and_not_shown(monkeypatch, name):
    monkeypatch.syspath_prepend(ROOT / "tools")
    from build_slides import slides_of

    asked = f"# A\n\nHow far?\n\n<details><summary>{name}</summary>\n\nTen\n\nmetres.\n\n</details>"
    (slide,) = slides_of({"cells": [{"cell_type": "markdown", "source": asked}]})
    assert slide.shown == ['<p class="question">How far?</p>']
    assert slide.notes == ["How far?", f"{name}: Ten metres."]


def test_each_chapter_has_a_lecture_of_90_minutes_whose_sections_and_exercises_there_are(
    monkeypatch,
):
    monkeypatch.syspath_prepend(ROOT / "tools")
    from build_slides import slides_of
    from lectures import numbered, plan

    notebooks = {path.stem: path.read_text() for path in (ROOT / "notebooks").glob("*.ipynb")}
    made = {name: slides_of(json.loads(text)) for name, text in sorted(notebooks.items())}
    teaching = (ROOT / "docs" / "teaching.md").read_text()
    lectures = plan(teaching, made)
    chapters = [str(int(name[:2])) for name in sorted(notebooks) if name[0].isdigit()]
    assert list(lectures) == chapters[1:]
    for number, lecture in lectures.items():
        shown, _, exercises = lecture.partition("; exercises: ")
        ranges = re.findall(r"\((\d+)(?:–(\d+))?\)", shown.partition("; explore: ")[0])
        assert 15 <= sum(int(last or first) - int(first) + 1 for first, last in ranges) <= 32, (
            number
        )
        names = re.findall(r"`(\w+)`", exercises)
        (page,) = (text for name, text in notebooks.items() if name.startswith(f"{number:0>2}_"))
        assert [name for name in names if f'check(\\"{name}\\"' in page] == names, number
        assert len(names) == 2
    slides = made["01_projective_space"]
    at = next(i for i, slide in enumerate(slides, 1) if slide.title == "Points at infinity")
    assert f"Points at infinity ({at}" in numbered(teaching, made)


@pytest.mark.slow
def test_code_is_shown_whole(made, chromium):
    page = chromium.new_page(viewport={"width": 1280, "height": 720})
    page.goto((made / "07_zhang_calibration.html").as_uri())
    page.wait_for_selector("mjx-container", state="attached", timeout=60_000)
    page.keyboard.press("c")
    cut, shown = [], 0
    for number in range(1, page.locator(".slide").count() + 1):
        page.evaluate(f"go({number - 1})")
        for code in page.locator(".slide.now pre.code:visible").all():
            shown += 1
            sizes = "c => [c.scrollHeight - c.clientHeight, c.scrollWidth - c.clientWidth]"
            if max(code.evaluate(sizes)) > 1:
                cut.append(number)
    page.close()
    assert shown > 10
    assert cut == []


@pytest.mark.slow
def test_the_slides_load_nothing_from_elsewhere(made):
    for path in made.glob("*.html"):
        text = re.sub(r"<pre.*?</pre>|<aside.*?</aside>", "", path.read_text(), flags=re.S)
        assert re.findall(r'(?:src|href)="(?!data:|#)([^"]*//[^"]*)"', text) == []
        for link in re.findall(r'<(?:link|script)[^>]*(?:src|href)="(?!data:)([^"]+)"', text):
            assert (made / link).exists(), link


@pytest.mark.slow
def test_keys_move_the_slides_and_formulas_are_set(made, chromium):
    page = chromium.new_page(viewport={"width": 1280, "height": 720})
    wrong = []
    page.on("console", lambda m: wrong.append(m.text) if m.type == "error" else None)
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.goto((made / "07_zhang_calibration.html").as_uri())
    page.wait_for_selector("mjx-math", state="attached")
    shown = page.locator(".slide.now")
    first = shown.inner_text()
    page.keyboard.press("ArrowRight")
    assert shown.inner_text() != first
    assert page.url.endswith("#2")
    page.keyboard.press("End")
    n = page.locator(".slide").count()
    assert page.url.endswith(f"#{n}")
    for number in range(1, n + 1):  # no picture is cut, no formula wider than the room
        page.evaluate(f"go({number - 1})")
        widest = page.evaluate(
            "Math.max(0, ...[...document.querySelectorAll('.slide.now img, "
            '.slide.now mjx-container[display="true"] mjx-math\')]'
            ".map(e => e.getBoundingClientRect().right))"
        )
        assert widest <= 1280, f"slide {number}"
    page.close()
    assert wrong == []


@pytest.mark.slow
def test_an_exploration_moves_where_the_slides_are_served_and_is_a_picture_in_a_file(
    browser_parts, chromium, tmp_path
):
    out, chapter = tmp_path / "out", "04_lens_distortion"
    command = [sys.executable, ROOT / "tools/build_slides.py", "--out", out, "--parts"]
    command += [browser_parts, ROOT / f"notebooks/{chapter}.ipynb"]
    run = subprocess.run(command, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
    page = chromium.new_page(viewport={"width": 1280, "height": 720})
    wrong = []
    page.on("console", lambda m: wrong.append(m.text) if m.type == "error" else None)
    page.on("pageerror", lambda error: wrong.append(str(error)))
    with serving(functools.partial(QuietHandler, directory=out)) as address:
        page.goto(f"{address}/{chapter}.html")
        page.wait_for_selector(".explore", state="attached")
        number = page.evaluate("slides.findIndex(slide => slide.querySelector('.explore'))")
        page.evaluate(f"go({number})")
        said = page.locator(".slide.now .explore-sentence")
        before = said.inner_text()
        page.locator(".slide.now .explore input[type=range]").first.focus()
        page.keyboard.press("ArrowRight")
        page.wait_for_selector(".slide.now .explore-stage.live", timeout=120_000)
        assert said.inner_text() != before
        assert page.evaluate("now") == number  # the key was the slider's
    page.goto((out / f"{chapter}.html").as_uri() + f"#{number + 1}")
    assert page.locator(".slide.now img").is_visible()
    assert page.locator(".explore").count() == 0
    page.close()
    assert wrong == []


@pytest.mark.slow
@pytest.mark.parametrize("tool", ["build_slides.py", "build_site.py"])
def test_a_folder_of_somebody_else_is_not_replaced(tool, tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    command = [sys.executable, ROOT / "tools" / tool, "--out", tmp_path]
    run = subprocess.run(command, capture_output=True, text=True)
    assert run.returncode == 1
    assert "is in the way" in run.stdout
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]
