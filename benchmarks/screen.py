"""From a key on a slider to another picture on the screen: JupyterLab in a headless Chromium."""

import importlib.util
import json
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import nbformat

from cvnotes.commands.lab import free_port, start_server, stop, wait_until_up

TOKEN = "of-this-benchmark-alone"
ARGUMENTS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking"]
RUN_ALL = """async () => {
    const app = window.jupyterapp;
    await app.restored;
    const panel = app.shell.currentWidget;
    await panel.context.ready;
    await panel.sessionContext.ready;
    await panel.sessionContext.session.kernel.info;
    await app.commands.execute('notebook:run-all-cells');
}"""
SHOW_CELL = """async i => {
    const notebook = window.jupyterapp.shell.currentWidget.content;
    notebook.activeCellIndex = i;
    await notebook.scrollToItem(i, 'start');
}"""
# Milliseconds from each key to the first frame with another picture in it.
LATENCY = """async ([handle, keys]) => {
    const frame = () => new Promise(resolve => requestAnimationFrame(resolve));
    const wait = ms => new Promise(resolve => setTimeout(resolve, ms));
    const area = handle.closest('.jp-OutputArea-output');
    const shown = () => { const i = area.querySelector('img'); return i && i.complete && i.src; };
    const waited = [];
    handle.focus();
    for (let i = 0; i < keys + 3; i++) {
        const code = i % 2 ? 'ArrowLeft' : 'ArrowRight';
        const key = {key: code, code, bubbles: true, cancelable: true};
        const before = shown(), start = performance.now();
        handle.dispatchEvent(new KeyboardEvent('keydown', key));
        do await frame();
        while ((!shown() || shown() === before) && performance.now() - start < 3000);
        waited.push(performance.now() - start);
        await wait(80 + 20 * Math.random());
    }
    return waited.slice(3);
}"""


def chromium() -> str | None:
    """Find what the measurement needs: Chromium's path, or None if anything is missing."""
    needed = ("playwright", "jupyterlab")
    if not all(importlib.util.find_spec(name) for name in needed):
        return None
    return shutil.which("chromium") or shutil.which("chromium-browser")


def waited(sources: Mapping[str, str], path: str, keys: int = 30) -> dict[str, list[float]]:
    """Press keys on the first slider that each cell shows; gives the milliseconds of each key."""
    from playwright.sync_api import sync_playwright

    with _lab(sources) as address, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=ARGUMENTS)
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.goto(address)
        page.wait_for_selector(".jp-Notebook .jp-CodeCell", timeout=60_000)
        page.evaluate(RUN_ALL)
        found = {name: _latency(page, i, keys) for i, name in enumerate(sources)}
        page.evaluate("() => window.jupyterapp.shell.currentWidget.sessionContext.shutdown()")
        browser.close()
    return found


def _latency(page: Any, cell: int, keys: int) -> list[float]:
    page.evaluate(SHOW_CELL, cell)
    output = page.locator(".jp-CodeCell.jp-mod-active .jp-OutputArea-output").first
    output.locator("img").first.wait_for(state="visible", timeout=20_000)
    handle = output.locator(".noUi-handle").first.element_handle()
    return [float(x) for x in page.evaluate(LATENCY, [handle, keys])]


@contextmanager
def _lab(sources: Mapping[str, str]) -> Iterator[str]:
    """Serve a notebook of these cells; gives its address."""
    kernel = {"name": "python3", "display_name": "Python 3"}
    notebook = nbformat.v4.new_notebook(metadata={"kernelspec": kernel})
    notebook.cells = [nbformat.v4.new_code_cell(source) for source in sources.values()]
    with tempfile.TemporaryDirectory() as folder, _environment(Path(folder)):
        nbformat.write(notebook, Path(folder, "sliders.ipynb"))
        port = free_port(0)
        server = start_server(Path(folder), port, TOKEN)
        try:
            wait_until_up(server, port, TOKEN)
            yield f"http://127.0.0.1:{port}/lab/tree/sliders.ipynb?token={TOKEN}"
        finally:
            stop(server)


@contextmanager
def _environment(folder: Path) -> Iterator[None]:
    """Keep Jupyter's files in a folder of their own, and let the page reach its application."""
    folder = folder / ".jupyter"
    folder.mkdir()
    config = {"LabApp": {"expose_app_in_browser": True}}
    (folder / "jupyter_server_config.json").write_text(json.dumps(config))
    before = dict(os.environ)
    for name in ("JUPYTER_CONFIG_DIR", "JUPYTER_RUNTIME_DIR", "JUPYTERLAB_SETTINGS_DIR",
                 "JUPYTERLAB_WORKSPACES_DIR"):  # fmt: skip
        os.environ[name] = str(folder)
    try:
        yield
    finally:
        os.environ.clear()
        os.environ.update(before)
