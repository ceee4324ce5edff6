"""Run a notebook, and each of its checks once more with a step undone: does the check notice?

    python tests/undoing.py notebooks/04_lens_distortion.ipynb

The table of what is undone is `tests/undone/04.toml`. A row says what is replaced (`step`, which
stands in exactly one cell of code), by what (`undone`), and which cell is to fail (`noticed`, words
of its code; left out: the cell of the step itself). All between the two runs in a copy of the
process, so that nothing comes back. A check notices if its `assert` or its `verify` fails.

A row with `expected = "nothing"` is what a page asks a reader to change and run again: the cell
must run through, for an answer that ends in a red traceback is none.
"""

import ast
import json
import os
import sys
import tomllib
from pathlib import Path

import nbformat

from cvnotes.learn.truth.verification import NotVerified
from cvnotes.tutor.course import short_name

TABLES = Path(__file__).with_name("undone")


def checks(source):
    """Return whether a cell checks something."""
    return any(
        isinstance(node, ast.Assert)
        or (isinstance(node, ast.Call) and ast.unparse(node.func) == "verify")
        for node in ast.walk(ast.parse(source))
    )


def place(sources, words):
    """Return the number of the one cell with these words."""
    found = [i for i, source in enumerate(sources) if words in source]
    if len(found) != 1:
        raise SystemExit(f"{len(found)} cells have {words!r}; a row of the table needs exactly one")
    return found[0]


def run(source, names):
    exec(compile(source, "<cell>", "exec"), names)


def noticed(sources, first, last, row, names):
    """Run the cells from the undone step to the check in a copy of the process; say what came."""
    reading, writing = os.pipe()
    if child := os.fork():
        os.close(writing)
        with os.fdopen(reading) as answer:
            said = answer.read()
        os.waitpid(child, 0)
        return said
    said = "nothing"
    for at in range(first, last + 1):
        source = sources[at]
        try:
            run(source.replace(row["step"], row["undone"]) if at == first else source, names)
        except (AssertionError, NotVerified):  # those before it may notice, too
            said = "noticed" if at == last else said
        except BaseException as error:
            said = f"{type(error).__name__} in cell {at} of the code: {error}"
            break
    os.write(writing, said.encode()[:4000])
    os._exit(0)


def main():
    notebook = Path(sys.argv[1]).resolve()
    rows = tomllib.loads((TABLES / f"{short_name(notebook.name)}.toml").read_text())["row"]
    cells = nbformat.read(notebook, as_version=4).cells
    sources = [cell.source for cell in cells if cell.cell_type == "code"]
    os.chdir(notebook.parent)
    names = {"__name__": "__main__", "display": print}
    results = [""] * len(rows)
    places = [place(sources, row["step"]) for row in rows]
    lasts = [place(sources, row.get("noticed", row["step"])) for row in rows]
    out, sys.stdout = sys.stdout, Path(os.devnull).open("w")  # noqa: SIM115
    for i in range(max(lasts, default=-1) + 1):
        for k, row in enumerate(rows):
            if places[k] == i:
                results[k] = noticed(sources, i, lasts[k], row, names)
        run(sources[i], names)
    asked = {last for row, last in zip(rows, lasts, strict=True) if "expected" not in row}
    unasked = [source for i, source in enumerate(sources) if checks(source) and i not in asked]
    json.dump({"results": results, "unasked": unasked}, out)


if __name__ == "__main__":
    main()
