"""Execute the notebooks in place, the one way in which committed notebooks are made.

    python tools/build_notebooks.py                    all notebooks
    python tools/build_notebooks.py notebooks/00*      some
    python tools/build_notebooks.py --check            only tell which are not as built

Cells with the tag ``no-save-output`` (3-D viewers) run, but their output is not kept: it would be
large, and an untrusted notebook does not show it. Of a widget its still is kept, not the view,
which means nothing without its kernel. A cell with the tag ``hide-input`` is plumbing: it gets the
key by which JupyterLab folds its code, as the site does by the tag. Ids, metadata and execution
counts are set so that two runs give the same file.
"""

import argparse
import re
import sys
import uuid
from pathlib import Path

import nbformat
from jupyter_core.paths import jupyter_runtime_dir
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError
from traitlets.config import Config

from cvnotes.commands.quiet import transport

ROOT = Path(__file__).resolve().parents[1]
METADATA = {
    "kernelspec": {"display_name": "Python 3 (ipykernel)", "language": "python", "name": "python3"},
    "language_info": {  # what JupyterLab writes: it need not be changed by opening
        "codemirror_mode": {"name": "ipython", "version": 3},
        "file_extension": ".py",
        "mimetype": "text/x-python",
        "name": "python",
        "nbconvert_exporter": "python",
        "pygments_lexer": "ipython3",
        "version": "3.11.0",  # cvnotes lab puts the version there that opens it
    },
}
FOLDED = "hide-input"
WIDGET_VIEW = "application/vnd.jupyter.widget-view+json"


def tidy(notebook: nbformat.NotebookNode) -> None:
    """Set everything that is not content, and drop the outputs that are not kept."""
    notebook.metadata = nbformat.from_dict(METADATA)
    notebook.nbformat, notebook.nbformat_minor = 4, 5
    count = 0
    for i, cell in enumerate(notebook.cells):
        tags = cell.metadata.get("tags", [])
        folded = {"jupyter": {"source_hidden": True}} if FOLDED in tags else {}
        cell.metadata = nbformat.from_dict({"tags": tags, **folded} if tags else {})
        cell.id = f"cell-{i:02d}"
        if cell.cell_type == "code":
            count += 1
            cell.execution_count = count
            kept = [] if "no-save-output" in tags else cell.outputs
            cell.outputs = [output for output in kept if not _is_widget_alone(output)]
            for output in cell.outputs:
                output.get("data", {}).pop(WIDGET_VIEW, None)
                output.pop("execution_count", None)
                if output.output_type == "execute_result":
                    output.execution_count = count
                if "metadata" in output:
                    output.metadata = nbformat.from_dict({})


def _is_widget_alone(output: nbformat.NotebookNode) -> bool:
    """Return whether nothing would be left of an output but the words that replace a widget."""
    data = output.get("data", {})
    return WIDGET_VIEW in data and not data.keys() - {WIDGET_VIEW, "text/plain"}


def problems(notebook: nbformat.NotebookNode) -> list[str]:
    """Describe what an executed notebook must not contain."""
    found = []
    for cell in notebook.cells:
        tags = cell.metadata.get("tags", [])
        for output in cell.get("outputs", []):
            if output.output_type == "stream" and output.name == "stderr":
                found.append(f"{cell.id} writes to stderr: {output.text[:200]}")
            if output.output_type == "error" and "raises-exception" not in tags:
                found.append(f"{cell.id} raises {output.ename}: {output.evalue}")
    return found + _unseen(notebook)


def _unseen(notebook: nbformat.NotebookNode) -> list[str]:
    """Describe which widgets and viewers leave nothing to see on a page without a kernel."""
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    seen = ["<img" in str(cell.outputs) for cell in cells]
    found = []
    for i, cell in enumerate(cells):
        if re.search(r"^explore\(", cell.source, re.M) and not seen[i]:
            found.append(f"{cell.id} shows no still of its exploration")
        if "no-save-output" in cell.metadata.get("tags", []) and not any(
            seen[max(0, i - 1) : i + 2]
        ):
            found.append(f"{cell.id} has no picture beside its viewer")
    return found


def build(path: Path) -> list[str]:
    """Execute one notebook and write it back; give what is wrong with it."""
    notebook = nbformat.read(path, as_version=4)
    client = NotebookClient(
        notebook,
        timeout=120,
        kernel_name="python3",
        resources={"metadata": {"path": str(path.parent)}},
        record_timing=False,
        config=Config({"KernelManager": _connection()}),
        store_widget_state=False,
        coalesce_streams=True,
    )
    try:
        client.execute()
    except CellExecutionError as error:
        return [str(error)]
    tidy(notebook)
    partial = path.with_suffix(".partial")
    nbformat.write(notebook, partial)
    partial.replace(path)
    return problems(notebook)


def _connection() -> dict[str, str]:
    """Return the way to a kernel; over files it needs a name that both sides know beforehand."""
    runtime = Path(jupyter_runtime_dir())
    runtime.mkdir(parents=True, exist_ok=True)
    name = runtime / f"kernel-{uuid.uuid4()}.json"
    return {"transport": transport(runtime), "connection_file": str(name)}


def check(path: Path) -> list[str]:
    """Return whether a notebook is as `build` leaves it, without executing it."""
    notebook = nbformat.read(path, as_version=4)
    before = nbformat.writes(notebook)
    tidy(notebook)
    found = problems(notebook)
    if nbformat.writes(notebook) != before or path.read_text().rstrip() != before.rstrip():
        found.append("ids, metadata or kept outputs are not those of tools/build_notebooks.py")
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("notebooks", nargs="*", type=Path)
    parser.add_argument("--check", action="store_true", help="execute nothing, change nothing")
    arguments = parser.parse_args()
    failed = False
    for path in arguments.notebooks or sorted((ROOT / "notebooks").glob("*.ipynb")):
        found = check(path) if arguments.check else build(path)
        print(f"{path.name}: {'not as built' if found else 'ok'}", *found, sep="\n  ")
        failed |= bool(found)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
