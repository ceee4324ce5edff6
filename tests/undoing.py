"""Run a notebook, each check once more with its step undone, and each change that a page asks for.

    python tests/undoing.py notebooks/04_lens_distortion.ipynb

The table is `tests/undone/04.toml`. A row says what is replaced (`step`, which stands in exactly
one cell of code), by what (`undone`), and up to which cell one runs then (`noticed`, words of its
code; left out: the cell of the step itself). Both may be lists, for what stands in several places.
All runs in a copy of the process, so that nothing comes back.

* A row without `holds` undoes the step of a check. It is noticed if the last cell's `assert` or
  `verify` fails.
* A row with `holds` is what a page asks a reader to change and run again. `said` are words of the
  answer, and `holds` is what they promise, in Python: true after the change, and false without it.
  `printed` in it is what the cells have printed. Without a `step` it is a number of the prose.
"""

import ast
import contextlib
import io
import json
import os
import signal
import sys
import tomllib
from pathlib import Path

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


def as_list(value):
    return value if isinstance(value, list) else [value]


class Row:
    """A row of the table, with the cells from the first that is changed to the last that is run."""

    def __init__(self, row, sources):
        self.row = row
        steps, undone = as_list(row.get("step", [])), as_list(row.get("undone", []))
        self.changes = list(zip(steps, undone, strict=True))
        changed = [place(sources, step) for step in steps]
        last = place(sources, row["noticed"]) if "noticed" in row else max(changed)
        self.cells = range(min([*changed, last]), last + 1)

    def changed(self, source):
        for step, undone in self.changes:
            source = source.replace(step, undone)
        return source

    def held(self, names, printed):
        """Return whether what was said holds after the cells have printed `printed`."""
        return bool(eval(f"({self.row['holds']})", {**names, "printed": printed}))


def run(source, names):
    """Run a cell, and return what it printed."""
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(source, "<cell>", "exec"), names)
    return out.getvalue()


def tried(row, sources, names):
    """Run the cells of a row with its change; say what came."""
    printed = ""
    for at in row.cells:
        try:
            printed += run(row.changed(sources[at]), names)
        except (AssertionError, NotVerified) as error:  # those before the last may notice, too
            if at == row.cells[-1]:
                return "noticed" if "holds" not in row.row else f"the answer is red: {error}"
        except BaseException as error:
            return f"{type(error).__name__} in cell {at} of the code: {error}"
    if "holds" not in row.row:
        return "nothing"
    return (
        "held" if row.held(names, printed) else f"false after the change, which printed {printed}"
    )


def in_a_copy(function, *given):
    """Return what a function returns in a copy of this process, from which nothing comes back."""
    reading, writing = os.pipe()
    if child := os.fork():
        os.close(writing)
        with os.fdopen(reading) as answer:
            said = answer.read()
        os.waitpid(child, 0)
        return said or "it died, or did not come to an end"
    signal.alarm(300)
    try:
        said = function(*given)
    except BaseException as error:
        said = f"{type(error).__name__}: {error}"
    os.write(writing, said.encode()[:4000])
    os._exit(0)


def main():
    notebook = Path(sys.argv[1]).resolve()
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    sources = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    table = tomllib.loads((TABLES / f"{short_name(notebook.name)}.toml").read_text())["row"]
    rows = [Row(row, sources) for row in table]
    os.chdir(notebook.parent)
    names = {"__name__": "__main__", "display": print}
    results, printed = [""] * len(rows), []
    for i, source in enumerate(sources):
        for k, row in enumerate(rows):
            if row.cells[0] == i and row.changes:
                results[k] = in_a_copy(tried, row, sources, names)
        printed.append(run(source, names))
        for k, row in enumerate(rows):
            if row.cells[-1] == i and "holds" in row.row:
                held = row.held(names, "".join(printed[at] for at in row.cells))
                if not row.changes:
                    results[k] = "held" if held else "false"
                elif held:
                    results[k] = "true without the change as well, so it says nothing"
    asked = {row.cells[-1] for row in rows if "holds" not in row.row}
    unasked = [source for i, source in enumerate(sources) if checks(source) and i not in asked]
    json.dump({"results": results, "unasked": unasked}, sys.stdout)


if __name__ == "__main__":
    main()
