"""Names in words: what docstrings put in backticks is there, under that name."""

import ast
import builtins
import re
from functools import cache
from pathlib import Path

import pytest

pytestmark = pytest.mark.once

PACKAGE = Path(__file__).resolve().parents[1] / "cvnotes"
FILES = sorted(PACKAGE.rglob("*.py"))
WINGS = {path.name for path in PACKAGE.iterdir() if path.is_dir()}


@cache
def tree(path):
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def met_in(path):
    """Give all names that a file uses, defines or spells as a short string, like a key."""
    found = set()
    for node in ast.walk(tree(path)):
        names = [getattr(node, key, None) for key in ("id", "attr", "arg", "name", "asname")]
        found.update(*(name.split(".") for name in names if isinstance(name, str)))
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and len(node.value) < 80:
            found.update(re.findall(r"\w+", node.value))
    return found


@cache
def offered_by(wing):
    """Give the modules of a wing, and what they define."""
    found = set()
    for path in wing.rglob("*.py"):
        found |= {path.stem, path.parent.name}
        for node in tree(path).body:
            if isinstance(node, ast.FunctionDef | ast.ClassDef):
                found.add(node.name)
            elif isinstance(node, ast.Assign | ast.AnnAssign):
                targets = node.targets if isinstance(node, ast.Assign) else [node.target]
                found |= {target.id for target in targets if isinstance(target, ast.Name)}
    return found


@cache
def met_anywhere():
    """Give all names of the package, and those that need no wing: of its faces, and of Python."""
    wings = [offered_by(PACKAGE / wing) for wing in WINGS]
    faces = [met_in(path) for path in FILES if path.name == "__init__.py"]
    known = set().union(*faces, WINGS, ["cvnotes"], dir(builtins))
    return set().union(*map(met_in, FILES), *wings), known


def is_there(name, path):
    """Tell whether a reader of a file finds a name: there, in its wing, or on a face."""
    first, *inside = name.removeprefix("cvnotes.").split(".")
    wing = PACKAGE / path.relative_to(PACKAGE).parts[0]
    near = met_in(path) | (offered_by(wing) if wing.is_dir() else set())
    everywhere, faces = met_anywhere()
    return first in near | faces and set(inside) <= everywhere


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_what_stands_in_backticks_is_there(path):
    described = (ast.Module, ast.ClassDef, ast.FunctionDef)
    docs = [ast.get_docstring(n) or "" for n in ast.walk(tree(path)) if isinstance(n, described)]
    named = re.findall(r"(?<!`)`([A-Za-z_][\w.]*)`(?!`)", "\n".join(docs))
    assert [name for name in named if not is_there(name, path)] == []
