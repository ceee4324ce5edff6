"""The register of concepts: complete, and every name in it leads to what it names."""

import ast
import pkgutil
from functools import cache
from pathlib import Path
from string import ascii_lowercase

import nbformat
import pytest
from concepts import Concept, concepts, find

from cvnotes.base import CvnotesError
from cvnotes.learn import EXERCISES

pytestmark = pytest.mark.once

ROOT = Path(__file__).resolve().parents[1]
each_concept = pytest.mark.parametrize("concept", concepts().values(), ids=concepts().keys())


@cache
def cells_of(notebook):
    path = ROOT / "notebooks" / f"{notebook}.ipynb"
    assert path.exists(), f"no notebook {path.name}"
    return [cell.source for cell in nbformat.read(path, as_version=4).cells]


def names_met_in(source):
    """All names that a piece of code uses; those imported under another name, by their own."""
    tree = ast.parse(source)
    aliases = {
        alias.asname: alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    return {aliases.get(name, name) for name in used_in(tree)}


@cache
def met_in_notebook(notebook):
    cells = nbformat.read(ROOT / "notebooks" / f"{notebook}.ipynb", as_version=4).cells
    return names_met_in("\n".join(cell.source for cell in cells if cell.cell_type == "code"))


@cache
def met_in_exercises(row):
    files = [
        ROOT / f"cvnotes/learn/ch{exercise.chapter:02}/{name.lower()}.py"
        for name, exercise in EXERCISES.items()
        if row in exercise.concepts
    ]
    return set().union(*(names_met_in(file.read_text(encoding="utf-8")) for file in files))


@cache
def parts_of(file):
    """What a test file is made of: for each name that it defines, all names used in doing so."""
    parts = {}
    for node in ast.parse((ROOT / file).read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ClassDef):
            parts |= {f"{node.name}::{n.name}": used_in(n) for n in node.body if is_function(n)}
        elif is_function(node):
            parts[node.name] = used_in(node)
        elif isinstance(node, ast.Assign):
            parts |= {name: used_in(node.value) for t in node.targets for name in used_in(t)}
    return parts


def used_in(tree):
    names = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name)}
    names |= {n.attr for n in ast.walk(tree) if isinstance(n, ast.Attribute)}
    return names | {n.arg for n in ast.walk(tree) if isinstance(n, ast.arg)}


def is_function(node):
    return isinstance(node, ast.FunctionDef)


@cache
def used_by(pointer):
    """All names that a test uses, itself or through what its file defines."""
    file, _, test = pointer.partition("::")
    parts, names, new = parts_of(file), set(), {test}
    while new:
        names |= new
        new = set().union(*(parts.get(name, ()) for name in new)) - names
    return names


def last_part(name):
    return name.rpartition(".")[2]


def test_every_row_of_the_notes_is_there_and_in_order():
    assert list(concepts()) == [*map(str, range(1, 78)), *ascii_lowercase[:19]]


def test_the_rows_of_the_notes_follow_their_sections():
    sections = [concepts()[str(row)].notes for row in range(1, 78)]
    assert sections == sorted(sections)
    assert set(sections) == {"2b.1", "2b.2", "2b.3", "2b.4", "2b.5"}


@each_concept
def test_no_concept_is_an_orphan(concept):
    assert concept.what
    assert concept.functions
    assert concept.cells
    assert concept.tests


@each_concept
def test_its_functions_exist_and_are_public(concept):
    for name in concept.functions:
        assert name.startswith("cvnotes.")
        assert not any(part.startswith("_") for part in name.split("."))
        pkgutil.resolve_name(name)


@each_concept
def test_its_tests_exist(concept):
    for pointer in concept.tests:
        file, _, name = pointer.partition("::")
        assert (ROOT / file).exists(), f"no file {file}"
        assert name.rpartition("::")[2].startswith("test_")
        assert name in parts_of(file), f"no test {name} in {file}"


@each_concept
def test_its_tests_and_its_functions_belong_together(concept):
    functions = {last_part(name) for name in concept.functions}
    used = {pointer: used_by(pointer) & functions for pointer in concept.tests}
    assert functions <= set().union(*used.values()), "a function that no test of the row uses"
    assert all(used.values()), "a test that uses no function of the row"


@each_concept
def test_its_places_in_the_notebooks_exist(concept):
    for notebook, words in concept.cells:
        found = sum(words in source for source in cells_of(notebook))
        assert found == 1, f"{words!r} stands in {found} cells of {notebook}, not in exactly one"


def test_a_learner_meets_every_function_of_the_register():
    """In a cell of the chapter that a row names, or in an exercise that practises the row."""
    unmet = []
    for row, concept in concepts().items():
        met = met_in_exercises(row).union(*(met_in_notebook(name) for name, _ in concept.cells))
        unmet += [f"{row}: {name}" for name in concept.functions if last_part(name) not in met]
    assert not unmet


def test_every_chapter_about_the_notes_has_its_rows():
    chapters = {path.stem for path in (ROOT / "notebooks").glob("[01]?_*.ipynb")}
    chapters = {name for name in chapters if name[:2] not in ("00", "09", "11")}
    assert len(chapters) == 9
    rows_of_the_notes = [c for row, c in concepts().items() if row.isdecimal()]
    assert {notebook for c in rows_of_the_notes for notebook, _ in c.cells} == chapters


def test_exercises_practise_concepts_and_errata_that_exist():
    known = concepts().keys() | {f"E{i}" for i in range(1, 47)}
    for name, exercise in EXERCISES.items():
        assert set(exercise.concepts) <= known, name


def test_concepts_are_found_by_words_of_any_case():
    rows = [concept.row for concept in find("Levenberg")]
    assert rows == ["65"]
    assert "47" in [concept.row for concept in find("homography.DLT")]
    assert find("photosynthesis") == ()
    with pytest.raises(CvnotesError, match="at least one word"):
        find("  ")


def test_a_concept_reads_well_in_a_terminal():
    concept = Concept("8", "Back", "2b.1", ("cvnotes.f",), (("01_x", "## Back"),), ("tests/t.py",))
    assert str(concept).splitlines() == [
        "8. Back (notes 2b.1)",
        "   function  cvnotes.f",
        "   notebook  01_x: ## Back",
        "   test      tests/t.py",
    ]
