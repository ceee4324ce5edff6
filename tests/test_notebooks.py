"""The anatomy of the notebooks: what CONTRIBUTING.md and docs/teaching.md promise of each."""

import ast
import io
import re
import statistics
import subprocess
import sys
import tokenize
from itertools import pairwise
from pathlib import Path

import nbformat
import pytest

from cvnotes import show
from cvnotes.learn import EXERCISES, exercises
from cvnotes.tutor.course import MORE, short_name

pytestmark = pytest.mark.once

ROOT = Path(__file__).resolve().parents[1]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
CHAPTERS = [path for path in NOTEBOOKS if re.match(r"(?!00)\d\d_", path.name)]
FURTHER = ROOT / f"notebooks/{MORE}.ipynb"
each_notebook = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
each_chapter = pytest.mark.parametrize("path", CHAPTERS, ids=lambda p: p.stem)
MAX_LINES, MAX_FOLDED, MEDIAN_LINES, IMPORT_LINES, MAX_BYTES = 12, 16, 5, 8, 1_500_000
KEY = ROOT / "docs/teacher/answers"  # the lecturer's answers to the questions in the prose
# What is folded: the answers, and what only some readers want.
ANSWER = re.compile(
    r"^ *<details><summary>(?:Answer|Proof|More exactly)</summary>\n\n.+?\n\n *</details>$",
    re.M | re.S,
)
# Names of the library that open cells ask for: in all, of a chapter's student, for one figure.
MAX_IN_ALL, MAX_NAMES, MAX_IN_A_FIGURE = 120, 25, 4
WINGS = {"cvnotes", *(f"cvnotes.{file.parent.name}" for file in ROOT.glob("cvnotes/*/__init__.py"))}
# Sections of a chapter that tell rather than show.
TELLING = (
    "summary",
    "further reading",
    "what comes next",
    "exercises",
    "explore",
    "careful",
    "now yours",
)


def _read(path):
    return nbformat.read(path, as_version=4)


def _code(notebook):
    return [c for c in notebook.cells if c.cell_type == "code"]


def _folded(cell):
    return "hide-input" in cell.metadata.get("tags", [])


def _lines(cell):
    return [line for line in cell.source.splitlines() if line.strip()]


def _html(notebook):
    for cell in _code(notebook):
        for output in cell.outputs:
            yield cell, "".join(output.get("data", {}).get("text/html", ""))


@pytest.mark.slow
def test_the_notebooks_are_committed_as_the_builder_leaves_them():
    run = subprocess.run(
        [sys.executable, ROOT / "tools/build_notebooks.py", "--check", *NOTEBOOKS],
        capture_output=True, text=True,
    )  # fmt: skip
    assert run.returncode == 0, run.stdout + run.stderr
    assert [path.name for path in NOTEBOOKS if path.stat().st_size >= MAX_BYTES] == []


@each_notebook
def test_code_cells_are_short_and_follow_prose(path):
    notebook = _read(path)
    imports, *lengths = [len(_lines(cell)) for cell in _code(notebook) if not _folded(cell)]
    assert imports <= IMPORT_LINES
    assert max(lengths) <= MAX_LINES
    assert max([len(_lines(cell)) for cell in _code(notebook)]) <= MAX_FOLDED
    assert statistics.median(lengths) <= MEDIAN_LINES
    for before, cell in zip(notebook.cells, notebook.cells[1:], strict=False):
        if cell.cell_type == "code":
            assert before.cell_type == "markdown", f"{cell.id} has no prose before it"


@each_notebook
def test_figures_that_the_prose_names_exist(path):
    named = set(re.findall(r"`(draw_\w+|explore\w*)`", _prose(_read(path))))
    assert named <= set(show.__all__), named - set(show.__all__)


def _names(source):
    """Return the names in code, those within its strings too, but not in comments."""
    found = set()
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type != tokenize.COMMENT:
            found.update(re.findall(r"\w+", token.string))
    return found


@each_notebook
def test_what_the_prose_names_is_in_the_next_cell_at_the_latest(path):
    """Let no sentence speak of what a chapter has no longer, or has later, without saying so."""
    cells, there, strange = _read(path).cells, set(), []
    for i, cell in enumerate(cells):
        following = next((c.source for c in cells[i:] if c.cell_type == "code"), "")
        there |= _names(following)
        if cell.cell_type != "markdown" or "## The same in OpenCV" in cell.source:
            continue
        for paragraph in cell.source.split("\n\n"):
            if re.search("OpenCV|cv2|exercise|[Bb]elow", paragraph):
                continue
            named = re.findall(r"`([A-Za-z_]\w*)`", paragraph)
            strange += [(i, n) for n in named if n not in there and "_from_" not in n]
    assert strange == []


@each_notebook
def test_no_code_installs_anything(path):
    assert not re.search(r"pip install", "\n".join(c.source for c in _code(_read(path))))


@each_notebook
def test_what_only_draws_is_folded_and_says_what_it_draws(path):
    """The key folds it in JupyterLab, which shows the first line; the tag does on the site."""
    for cell in _code(_read(path)):
        folded = cell.metadata.get("jupyter", {}).get("source_hidden", False)
        assert folded == _folded(cell), f"{cell.id}: the tag and the key go together"
        acts = re.search(r"\bassert\b|\b(verify|print|guess|answer|check)\(", cell.source)
        if folded:
            assert re.match(r"# \w.{10,}", cell.source), f"{cell.id} does not say what it draws"
            assert not re.search(r"\bassert\b|\bverify\(", cell.source), f"{cell.id} hides a check"
        elif sum("import" not in line for line in _lines(cell)) > 5 and not acts:
            assert not re.search(r"^show\(", cell.source, re.M), f"{cell.id} is plumbing, and open"


def _asked(path):
    """Give each open cell with the names of the library that are used in it."""
    ours = set()
    for cell in _code(_read(path)):
        tree = ast.parse(cell.source)
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.module.startswith("cvnotes"):
                ours |= {alias.asname or alias.name for alias in node.names}
        if not _folded(cell):
            yield cell, ours & {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}


@each_notebook
def test_few_names_of_the_library_are_asked_of_a_student(path):
    asked = set()
    for cell, used in _asked(path):
        asked |= used
        few = "show" not in used or len(used) <= MAX_IN_A_FIGURE
        assert few, f"for its figure {cell.id} calls {sorted(used)}"
    assert len(asked) <= MAX_NAMES, sorted(asked)


def test_few_names_of_the_library_are_asked_in_the_whole_course():
    asked = set().union(*(used for path in NOTEBOOKS for _, used in _asked(path)))
    assert 50 < len(asked) <= MAX_IN_ALL, sorted(asked)


def _reading(notebook):
    """Return the minutes of reading: words, open lines, figures and questions, weighed."""
    prose = _prose(notebook)
    cells = [cell for cell in _code(notebook) if not _folded(cell)]
    lines = sum(len(_lines(cell)) for cell in cells if not cell.source.count("check("))
    figures = sum("<img" in html for _, html in _html(notebook))
    return _words(prose) / 100 + (8 * lines + 45 * figures + 30 * prose.count("?")) / 60


@each_notebook
def test_the_time_that_is_claimed_is_that_of_its_parts(path):
    prose = _prose(_read(path))
    if claimed := re.search(r"\*\*Time\*\* reading(?: and running)? (\d+) min", prose):
        needed = _reading(_read(path))
        assert abs(int(claimed[1]) - needed) <= 0.1 * needed, f"{needed:.0f} minutes are needed"


def test_the_hours_of_the_first_page_are_those_of_the_chapters():
    rows = re.findall(r"\((\d\d_\w+\.ipynb)\)\|[^|]*\|(\d)([¼½¾]?)\|", _prose(_read(NOTEBOOKS[0])))
    assert [name for name, *_ in rows] == [path.name for path in CHAPTERS]
    for (_, whole, part), path in zip(rows, CHAPTERS, strict=True):
        (line,) = re.findall(r"\*\*Time\*\*.*", _prose(_read(path)))
        minutes = sum(map(int, re.findall(r"(\d+) min", line)))
        hours = int(whole) + (" ¼½¾".index(part) / 4 if part else 0)
        assert abs(hours - minutes / 60) <= 1 / 8, f"{path.name}: {minutes} minutes"


@each_notebook
def test_imports_are_a_few_lines_where_they_are_needed(path):
    imported, used = {}, {}
    for i, cell in enumerate(_code(_read(path))):
        for node in ast.walk(ast.parse(cell.source)):
            if isinstance(node, ast.Name):
                used.setdefault(node.id, i)
            elif isinstance(node, ast.Import | ast.ImportFrom):
                if getattr(node, "module", "").startswith("cvnotes"):
                    assert node.module in WINGS, f"{cell.id} imports from {node.module}"
                for alias in node.names:
                    name = alias.asname or alias.name
                    assert name not in imported, f"{cell.id} imports {name} once more"
                    imported[name] = i
    early = [name for name, i in imported.items() if used.get(name, i) < i]
    assert early == [], "these are used in a cell above their import"
    assert sum(i > 0 for i in imported.values()) > 3


def _prose(notebook):
    """Return what is read; the answers are folded."""
    prose = "\n\n".join(c.source for c in notebook.cells if c.cell_type == "markdown")
    return ANSWER.sub("", prose)


def _words(prose):
    """Count what is read: a formula is one word, and bars, rules, stars and arrows are none."""
    text = re.sub(r"\$\$.+?\$\$|\$[^$]+\$", "formula", prose, flags=re.S).replace("|", " ")
    return sum(bool(re.search(r"\w", word)) for word in text.split())


def test_bars_of_a_table_are_no_words():
    assert _words("|here|`cv2`|\n|--|:-:|\n|`f(x)`|none → $a = b$|\n\n* ★ two words") == 7


@each_notebook
def test_prose_and_code_keep_a_balance(path):
    notebook = _read(path)
    lines = sum(len(_lines(cell)) for cell in _code(notebook))
    words = _words(_prose(notebook))
    # Of the further exercises the tasks and projects, which begin with a bold number, are no prose.
    tasks = (
        re.findall(r"^\*\*(?:\d+|[A-I])\. .*$", _prose(notebook), re.M) if path == FURTHER else []
    )
    told = words - sum(map(_words, tasks))
    assert words / lines >= 8, f"{words / lines:.1f} words of prose for a line of code"
    # What a hand works through takes the place of the code that drew it.
    pulled = sum(
        bool(re.search(r"^(explore|pull_points)\(", c.source, re.M)) for c in _code(notebook)
    )
    done = lines + 4 * pulled
    assert told / done <= 15, f"{told / done:.1f} words of prose for a line of code"


@each_notebook
def test_every_comparison_says_how_exact_it_is(path):
    """A default of one in 100,000 would be far beyond what is seen, or far below it."""
    vague = [
        f"{cell.id}: {ast.unparse(node)}"
        for cell in _code(_read(path))
        for node in ast.walk(ast.parse(cell.source))
        if isinstance(node, ast.Call)
        and ast.unparse(node.func) in ("np.allclose", "np.isclose")
        and not {"rtol", "atol"} & {keyword.arg for keyword in node.keywords}
    ]
    assert vague == []


@each_notebook
def test_epigraphs_are_few(path):
    assert len(re.findall(r"^> ", _prose(_read(path)), re.M)) <= 4


def _only_defines(source):
    kinds = (ast.Import, ast.ImportFrom, ast.FunctionDef, ast.ClassDef)
    return all(isinstance(statement, kinds) for statement in ast.parse(source).body)


@each_notebook
def test_every_cell_that_does_something_shows_something(path):
    silent = [
        cell.source[:200]
        for cell in _code(_read(path))
        if not cell.outputs
        and not _only_defines(cell.source)
        and "no-save-output" not in cell.metadata.get("tags", [])
    ]
    assert silent == []


def _plain(text):
    return " ".join(re.sub(r"[*_>`]", "", text).split())


def _answers(block):
    return block.lstrip().startswith("<details><summary>Answer</summary>\n")


def _blocks(source):
    """Cut prose into paragraphs and items of lists; an answer is one block."""
    whole = ANSWER.sub(lambda found: re.sub(r"\n\s*\n", "\n", found[0]), source)
    parts = (part for part in re.split(r"\n\s*\n|\n(?=\* )", whole) if part.strip())
    return [part.strip("\n") for part in parts]


@each_notebook
def test_a_paragraph_can_be_read_in_one_go(path):
    prose = "\n\n".join(c.source for c in _read(path).cells if c.cell_type == "markdown")
    words = re.sub(r"\$\$.+?\$\$|\$[^$]+\$", " x ", prose, flags=re.S)
    paragraphs = re.split(r"\n\s*\n|\n(?=(?:\* |\d+\. ))", words)
    assert [part for part in paragraphs if len(part.split()) > 105 and part[0] not in "|#<"] == []


def test_the_map_of_the_further_exercises_names_each_with_its_stars_and_section():
    there, section = {}, ""
    for line in _prose(_read(FURTHER)).split("## Eight projects")[0].splitlines():
        section = line[3:].replace("'", "’") if line.startswith("## ") else section
        if task := re.match(r"\*\*(\w+)\. (★+)", line):
            there.setdefault(section, []).append(f"{task[1]} {task[2]}")
    said = re.findall(r"(\w[\w’ ]+): ((?:\w+ ★+(?:, )?)+)", show.exercise_map().alt)
    # Numbers, which are checked, stand before letters, which are for paper.
    assert said == [(name, ", ".join(sorted(tasks, key=lambda task: task[0].isalpha())))
                    for name, tasks in there.items()]  # fmt: skip


def test_projects_and_exercises_are_numbered_as_they_stand():
    prose = _prose(_read(FURTHER))
    before, after = prose.split("## Eight projects")
    numbers = re.findall(r"^\*\*(\w+)\. ★", before, re.M)
    assert [n for n in numbers if n.isdigit()] == [str(n) for n in range(1, 15)]
    assert [n for n in numbers if n.isalpha()] == list("ABCDEFG")
    assert re.findall(r"^\*\*(\d)\. ★+ .*?\*\* \((?:chapters )?[\d, ]+\)", after, re.M) == [
        *"12345678"
    ]


@each_notebook
def test_every_question_has_its_answer_folded_under_it(path):
    """Or under its picture. What is guessed has none; under three stars are idea and result."""
    missing = []
    cells = _read(path).cells
    for i, cell in enumerate(cells):
        if cell.cell_type != "markdown":
            continue
        guessed = i + 1 < len(cells) and re.search(r"^guess\(", cells[i + 1].source, re.M)
        checked = i + 1 < len(cells) and re.search(r"^check\(", cells[i + 1].source, re.M)
        blocks = [*_blocks(cell.source), ""]
        for k, block in enumerate(blocks[:-1]):
            by_hand = re.match(r"(\* |\*\*\d+\. |### )?(\*\*)?★", block) and path != FURTHER
            prompt = block.startswith("**Change this and run again")
            asked = "?" in re.sub(r"\$\$.+?\$\$|`[^`]*`|\]\([^)]*\)", " ", block, flags=re.S)
            last = k == len(blocks) - 2
            project = (
                "★★★" in block and "deriv" not in block.lower() and (path == FURTHER or not asked)
            )
            if _answers(block) or block.startswith(("#", "|")) or project:
                continue
            judged = checked and (last or "★★★" not in block)
            if not (asked or by_hand or prompt) or (last and guessed) or judged:
                continue
            below = _blocks(cells[i + 2].source)[0] if last and _is_picture(cells, i + 1) else ""
            if not _answers(blocks[k + 1]) and not _answers(below):
                missing.append(block)
    assert missing == []


def _is_picture(cells, i):
    """Tell whether there is such a cell, it shows a picture, and another follows."""
    shows = r"^(explore|show|pull_points)\("
    code = i + 1 < len(cells) and cells[i].cell_type == "code"
    return code and re.search(shows, cells[i].source, re.M)


@each_notebook
def test_one_looks_at_the_picture_before_the_answer(path):
    cells = _read(path).cells
    early = [
        cell.source[-200:]
        for i, cell in enumerate(cells)
        if cell.cell_type == "markdown"
        and _is_picture(cells, i + 1)
        and _answers(_blocks(cell.source)[-1])
    ]
    assert early == []


@each_notebook
def test_of_three_stars_the_lecturer_has_the_whole_answer(path):
    prose = "\n\n".join(c.source for c in _read(path).cells if c.cell_type == "markdown")
    key = _plain((KEY / f"{short_name(path.name)}.md").read_text())
    for block in _blocks(prose):
        if re.match(r"(\* |\*\*\w+\. )?(\*\*)?★★★", block) and "?" in block:
            last = re.findall(r"[^.!?:;\n]*\?", block)[-1]
            assert _plain(last) in key, last


@each_notebook
def test_no_traceback_is_announced(path):
    prose = "\n".join(c.source for c in _read(path).cells if c.cell_type == "markdown")
    assert (
        re.findall(r"[^.\n]*\b(?:assert\w* (?:fails|stops)|stops at its assert\w*)[^.\n]*", prose)
        == []
    )


@each_notebook
def test_whoever_can_check_can_ask_for_a_hint(path):
    code = "\n".join(cell.source for cell in _code(_read(path)))
    if re.search(r"^check\(", code, re.M):
        assert re.search(r"^from cvnotes.learn import .*\bhint\b", code, re.M)


@each_chapter
def test_a_chapter_of_the_second_edition_has_all_its_parts(path):
    notebook = _read(path)
    prose, code = _prose(notebook), "\n".join(c.source for c in _code(notebook))
    for part in ("**Time**", "The same in OpenCV", "★ ", "★★", "★★★", "by hand"):
        assert part in prose, f"no {part!r}"
    assert prose.lower().count("change this and run again") >= 3
    guessed = re.findall(r"^guess\(\"([^\"]+)\"", code, re.M)
    assert guessed
    assert set(guessed) <= set(re.findall(r"^answer\(\"([^\"]+)\"", code, re.M))


@each_notebook
def test_every_picture_has_a_text_for_those_who_cannot_see_it(path):
    notebook = _read(path)
    for cell in _code(notebook):
        for output in cell.outputs:
            kinds = {k for k in output.get("data", {}) if k.startswith("image/")}
            assert not kinds, f"{cell.id} shows {kinds} without show(…, alt=…)"
    pictures = [img for _, html in _html(notebook) for img in re.findall(r"<img[^>]*>", html)]
    assert pictures
    for img in pictures:
        alt = re.search(r'alt="([^"]*)"', img)
        assert len((alt.group(1) if alt else "").split()) >= 5, img[:120]


@each_notebook
def test_nothing_of_this_machine_or_of_a_bad_run_is_left(path):
    text = path.read_text()
    homes = [f"/{folder}/" for folder in ("home", "root", "Users")]
    for pattern in (*homes, "Traceback", "Warning:", "<Axes", "object at 0x"):
        assert not re.search(pattern, re.sub(r"base64,[A-Za-z0-9+/=]+", "", text)), pattern


class _Names(ast.NodeVisitor):
    """Which names a cell reads from above, and which it binds anew, in the order of its run.

    To read the name of a function is to read what the function reads.
    """

    def __init__(self, functions, here=()):
        self.functions, self.here = functions, set(here)
        self.read, self.bound = set(), set()

    def _reads(self, name):
        if name not in self.here:
            self.read.add(name)
        for used in self.functions.get(name, ()):
            self._reads(used)

    def _binds(self, name):
        self.here.add(name)
        self.bound.add(name)

    def visit_Name(self, node):
        (self._reads if isinstance(node.ctx, ast.Load) else self._binds)(node.id)

    def visit_alias(self, node):  # imported once more it is the same
        self.here.add((node.asname or node.name).split(".")[0])

    def visit_Subscript(self, node):
        self.generic_visit(node)
        if isinstance(node.ctx, ast.Store) and isinstance(node.value, ast.Name):
            self._binds(node.value.id)

    visit_Attribute = visit_Subscript  # noqa: N815

    def visit_Assign(self, node):
        for part in (node.value, *node.targets):
            self.visit(part)

    def visit_AugAssign(self, node):
        self.visit(node.value)
        for name in [each.id for each in ast.walk(node.target) if isinstance(each, ast.Name)][:1]:
            self._reads(name)
            self._binds(name)

    def visit_For(self, node):
        for part in (node.iter, node.target, *node.body, *node.orelse):
            self.visit(part)

    def visit_ExceptHandler(self, node):
        self.here.add(node.name)
        self.generic_visit(node)

    def visit_FunctionDef(self, node):
        local = {each.arg for each in ast.walk(node) if isinstance(each, ast.arg)}
        local |= {
            each.id
            for each in ast.walk(node)
            if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Store)
        }
        inside = _Names(self.functions, {node.name, *local})
        for part in node.body:
            inside.visit(part)
        self._binds(node.name)
        self.functions[node.name] = inside.read

    def visit_Lambda(self, node):
        self._apart(
            [node.body], [each.arg for each in ast.walk(node.args) if isinstance(each, ast.arg)]
        )

    def visit_ListComp(self, node):
        parts = [part for each in node.generators for part in (each.iter, each.target, *each.ifs)]
        results = [node.key, node.value] if isinstance(node, ast.DictComp) else [node.elt]
        self._apart([*parts, *results])

    visit_SetComp = visit_GeneratorExp = visit_DictComp = visit_ListComp  # noqa: N815

    def _apart(self, parts, names=()):
        inside = _Names(self.functions, {*self.here, *names})
        for part in parts:
            inside.visit(part)
        self.read |= inside.read


@each_notebook
def test_a_cell_can_be_run_again_after_later_ones(path):
    """What a cell reads from above is bound anew neither in it nor below."""
    functions, cells = {}, []
    for cell in _code(_read(path)):
        cells.append(_Names(functions))
        cells[-1].visit(ast.parse(cell.source))
    above, stale = set(), []
    for i, cell in enumerate(cells):
        anew = set().union(*(later.bound for later in cells[i:]))
        stale += [f"code cell {i}: {name}" for name in sorted(cell.read & above & anew)]
        above |= cell.bound
    assert stale == []


@each_notebook
def test_what_an_open_cell_takes_from_a_folded_one_is_named_before(path):
    """In backticks in the prose, or in a comment: on a page nobody sees the folded cell."""
    functions, said, folded, named = {}, "", set(), set()
    for cell in _read(path).cells:
        if cell.cell_type == "markdown":
            said += cell.source
            continue
        names = _Names(functions)
        names.visit(ast.parse(cell.source))
        if _folded(cell):
            folded |= names.bound - named
            continue
        comments = " ".join(re.findall("#.*", cell.source))
        for name in sorted(names.read & folded):
            spoken_of = f"`{name}`" in said or re.search(rf"\b{name}\b", comments)
            assert spoken_of, f"{cell.id}: what is {name}?"
        named |= names.bound | names.read
        folded -= named


@each_notebook
def test_links_to_other_files_lead_somewhere(path):
    for cell in _read(path).cells:
        for target in re.findall(r"\]\(([^)#\s]+)", cell.source):
            if not target.startswith(("http", "#")):
                assert (path.parent / target).exists(), target


@each_chapter
def test_every_section_of_a_chapter_checks_what_it_says(path):
    heading, checked, has_code = "", True, False
    for cell in [*_read(path).cells, nbformat.v4.new_markdown_cell("## Summary")]:
        if cell.cell_type == "markdown" and (found := re.findall(r"^## (.+)$", cell.source, re.M)):
            assert checked or not has_code, f"section {heading!r} verifies nothing"
            heading = found[-1]
            checked, has_code = heading.lower().startswith(TELLING), False
        elif cell.cell_type == "code":
            has_code = True
            checked |= bool(re.search(r"\bassert\b|\bverify\(", cell.source))


@each_chapter
def test_a_chapter_has_all_its_parts(path):
    notebook = _read(path)
    prose = "\n".join(c.source for c in notebook.cells if c.cell_type == "markdown")
    code = "\n".join(c.source for c in _code(notebook))
    for part in ("You will learn", "Notes", "Needs", "**Verify", "## Exercises", "## Summary",
                 "## Further reading", "## What comes next"):  # fmt: skip
        assert part in prose, f"no {part!r}"
    assert 2 <= len(re.findall(r"^check\(", code, re.M)) <= 6
    assert re.search(r"^explore\(", code, re.M), "no explore widget"
    assert 30 <= sum(not _folded(cell) for cell in notebook.cells) <= 75
    assert "import" in _code(notebook)[0].source


def test_there_is_a_first_page_then_the_chapters_in_turn_and_further_exercises():
    numbers = [chapter.removeprefix("ch") for chapter in exercises.CHAPTERS]
    assert numbers == [f"{n:02d}" for n in range(len(numbers))]
    assert [short_name(path.name) for path in NOTEBOOKS] == [*numbers, MORE]
    assert NOTEBOOKS[-1] == FURTHER


def test_whoever_looks_for_a_chapter_finds_it():
    count = ("eleven", "twelve", "thirteen")[len(NOTEBOOKS) - 11]
    for name in ("README.md", "docs/teaching.md"):
        assert f"{count} notebooks" in (ROOT / name).read_text().lower()
    first = _prose(_read(NOTEBOOKS[0]))
    for path in NOTEBOOKS[1:]:
        assert f"](notebooks/{path.name})" in (ROOT / "README.md").read_text()
        assert f"]({path.name})" in first
        assert re.search(rf"\b{short_name(path.name)}\b", (ROOT / "docs/teaching.md").read_text())


def test_the_further_exercises_stand_below_the_chapter_they_go_with():
    names, chapter = [], 0
    for cell in _read(FURTHER).cells:
        if found := re.search(r"^## .*\n+After \[chapter (\d+)\]", cell.source, re.M):
            chapter = int(found[1])
        for name in re.findall(r"^check\(\"(\w+)\"", cell.source, re.M):
            assert EXERCISES[name].chapter == chapter, name
            names.append(name)
    assert len(names) == len(set(names)) >= 9


def test_the_further_exercises_have_their_parts():
    cells = _read(FURTHER).cells
    prose = "\n".join(c.source for c in cells if c.cell_type == "markdown")
    for part in ("You will learn", "Notes", "Needs", "## Summary", "## Further reading",
                 "## What comes next"):  # fmt: skip
        assert part in prose, f"no {part!r}"
    for before, cell in pairwise(cells):
        if cell.cell_type == "code" and "check(" in cell.source:
            assert len(re.findall(r"^check\(", cell.source, re.M)) == 1
            assert re.match(r"\*\*\d+\. .+\*\* \S", before.source), f"{cell.id} has no task"
