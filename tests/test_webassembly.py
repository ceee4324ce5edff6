"""Every notebook in real WebAssembly, under Node: the texts are those that are stored."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import nbformat
import pytest

pytestmark = [pytest.mark.slow, pytest.mark.once]

ROOT = Path(__file__).resolve().parents[1]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
IGNORED = {"no-save-output", "nbval-ignore-output"}
# What may differ, and why: a part of the cell that says it.
DIFFERS = {
    "cv2.": "there is no OpenCV in a browser",
    "found = calibrate(board.points, corners, camera.size)": "another finder: 0.003 px in v0",
}
SAID = ("no OpenCV in a browser", "can't start new thread")
NUMBER = re.compile(r"(?<![\w.])[-−+]?\d+(?:\.\d*)?(?:e[-+]?\d+)?")
SANITISE = (
    (re.compile("0x[0-9a-fA-F]{6,}"), "ADDRESS"),
    (re.compile(r"data:image/(png|webp|svg\+xml);base64,[A-Za-z0-9+/=]+"), "IMAGE"),
)


@pytest.fixture(scope="module")
def told(browser_parts, tmp_path_factory):
    """Execute all notebooks once."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("no Node on this machine: notebooks are not run in WebAssembly")
    from browser_parts import lay_out

    folder = tmp_path_factory.mktemp("webassembly")
    lay_out(browser_parts, folder / "python")
    result = folder / "told.json"
    command = [node, ROOT / "tools/webassembly/run.mjs", folder / "python", result, *NOTEBOOKS]
    run = subprocess.run(command, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr[-3000:]
    return json.loads(result.read_text())


def texts(outputs):
    """Give what of a cell's outputs is to be read: prints, results, tables, described pictures."""
    for text in _texts(outputs):
        for pattern, word in SANITISE:
            text = pattern.sub(word, text)
        yield text


def _texts(outputs):
    """Give each; what a cell prints arrives in one piece or in several."""
    printed = "".join(o["text"] for o in outputs if o["output_type"] == "stream")
    if printed:
        yield printed
    for output in outputs:
        if output["output_type"] == "stream":
            continue
        if output["output_type"] == "error":
            yield f"{output['ename']}: {output['evalue']}"
        else:
            data = output["data"]
            if "application/vnd.jupyter.widget-view+json" not in data or "text/html" in data:
                yield data.get("text/html", data.get("text/plain", ""))


def alike(here, there):
    """Tell whether two texts are the same but for one unit in the last digit of a number."""
    if NUMBER.sub("#", here).split() != NUMBER.sub("#", there).split():
        return False
    pairs = zip(NUMBER.findall(here), NUMBER.findall(there), strict=True)
    return all(_same_number(a.replace("−", "-"), b.replace("−", "-")) for a, b in pairs)


def _same_number(a, b):
    digits = len(a.partition("e")[0].partition(".")[2])
    exponent = int(a.partition("e")[2] or 0)
    unit = 10.0 ** (exponent - digits) if "." in a or "e" in a else 0.0
    return a == b or abs(float(a) - float(b)) <= max(1.01 * unit, 1e-9 * abs(float(a)))


def test_what_counts_as_alike():
    assert alike("rms 0.123 px\n", "rms 0.124 px")
    assert alike("[1.e-16 2.]", "[2.e-16 2.]")
    assert not alike("rms 0.123 px", "rms 0.125 px")
    assert not alike("12 corners", "13 corners")
    assert not alike("✓ right", "✗ not yet right")
    assert not alike("1 2", "1 2 3")


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_says_the_same_in_webassembly(path, told):
    cells = [c for c in nbformat.read(path, as_version=4).cells if c.cell_type == "code"]
    outputs = told[path.stem]["outputs"]
    assert len(outputs) == len(cells)
    different, compared = [], 0
    for cell, there in zip(cells, outputs, strict=True):
        tags = set(cell.metadata.get("tags", []))
        errors = [o for o in there if o["output_type"] == "error"]
        allowed = any(part in cell.source for part in DIFFERS)
        unexpected = [e for e in errors if not (allowed and any(w in e["evalue"] for w in SAID))]
        if unexpected and "raises-exception" not in tags:
            different.append((cell.id, unexpected))
        if tags & IGNORED or allowed:
            continue
        expected, found = list(texts(cell.outputs)), list(texts(there))
        compared += len(expected)
        if len(expected) != len(found) or not all(map(alike, expected, found)):
            different.append((cell.id, expected, found))
    assert not different, "\n".join(map(str, different))[:4000]
    assert compared > 3


def test_every_cell_that_may_differ_is_there():
    sources = "".join(path.read_text() for path in NOTEBOOKS)
    assert all(json.dumps(part)[1:-1] in sources for part in DIFFERS)
