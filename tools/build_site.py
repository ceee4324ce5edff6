"""Build the site: notebooks, docs and the package's reference as one folder of pages.

    python tools/build_site.py                      into docs/_build/site
    python tools/build_site.py --out FOLDER
    python tools/build_site.py --parts FOLDER       Pyodide from a folder of yours
    python tools/build_site.py --without-python     the pages alone, which can only be read
    python tools/build_site.py --address https://…  where it will be, for previews of its links

Needs the extra `docs` (`python3 start.py site` sets it up). The notebooks appear as they are
committed; nothing is executed. The pages load nothing from elsewhere, formulas included.

With the parts of Python for the browser (`tools/browser_parts.py` says where they come from), the
pages also run the course's own code: they are in `python/`, and the scripts of `docs/static/live`
in `_static/live`. Without the parts the site is built plain, and says so.
"""

import argparse
import hashlib
import json
import re
import shutil
import sys
import tempfile
from importlib import import_module
from pathlib import Path

from browser_parts import VERSION, PartsMissingError, gather, lay_out
from build_lite import build_lite
from build_slides import slides_of
from front_page import front_page, put_pictures
from lectures import numbered
from site_figures import put_into_files
from typeface import write_typefaces

from cvnotes.targets import Chessboard
from cvnotes.targets.page import Page
from cvnotes.targets.sheet import dark_fields

ROOT = Path(__file__).resolve().parents[1]
# Whatever the README leads to, at the place where it stands in the repository.
PAGES = (
    "README.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "data/README.md",
    "docs/*.md",
    "docs/sheets/*.md",
    "notebooks/*.ipynb",
)
FIGURES = "docs/figures"
# Of MathJax, whose many bundles contain one another: the one in use, what it loads when a formula
# asks for it, and what its menu loads for those who listen to formulas.
MATHJAX = ("tex-chtml.js", "input", "output", "a11y", "sre")
# Inner corners of the boards for a screen: for one of 4:3, a long one, and a small one.
SHOWN = ((9, 6), (11, 6), (7, 4))
# The reference: the wings, in the order of the chapters, and of a wing what stands in a module of
# its own and yet is worth a page. What is not here serves those that are.
REFERENCE = {
    "Chapter by chapter": (
        "projective",
        "camera",
        "targets",
        "homography",
        "calibration",
        "warping",
        "stereo",
        "photographs",
    ),
    "Beside the chapters": (
        "pictures",
        "pictures.course",
        "show",
        "learn",
        "tutor",
        "files",
        "base",
    ),
    "Further inside": (
        "camera.lens",
        "targets.sheet",
        "calibration.starts",
        "calibration.reserve",
        "calibration.refinement",
        "calibration.reliability",
        "pictures.raycast",
    ),
}


def reference_page(name: str) -> str:
    """Write the page of one module: its docstring, and that of all that is public in it."""
    module = import_module(f"cvnotes.{name}")
    lines = [f"# cvnotes.{name}", "", "```{eval-rst}", f".. automodule:: cvnotes.{name}"]
    lines.append("   :members:")
    if hasattr(module, "__all__"):
        lines.append("   :imported-members:")
    return "\n".join([*lines, "```", ""])


def toctree(pages: list[str] | tuple[str, ...], caption: str = "") -> str:
    """Write a part of the table of contents; without a caption it is seen on its page, too."""
    options = [":hidden:", f":caption: {caption}"] if caption else [":maxdepth: 1"]
    lines = ["", "```{toctree}", *options, "", *pages, "```", ""]
    return "\n".join(lines)


def with_boards(text: str) -> str:
    """Put boards into a page, for screens that lie or stand: a unit of the drawings is a square."""
    drawn = []
    for corners in SHOWN:
        for each in (corners, corners[::-1]):
            board = Chessboard(each, 1.0)
            title = "A board of {} by {} inner corners".format(*each)
            width, height = board.squares
            drawn.append(Page(title, (width, height), (dark_fields(board, 0, 0),)).svg())
    return text.replace("{boards}", "".join(drawn))


def fold_calls(text: str) -> str:
    """Fold a notebook's cells that only ask for an exploration, which a page shows without them."""
    notebook = json.loads(text)
    for cell in notebook["cells"]:
        if re.fullmatch(r"explore\([^\n]*\)", "".join(cell["source"])):
            cell["metadata"]["tags"] = [*cell["metadata"].get("tags", ()), "hide-input"]
    return json.dumps(notebook)


def link_pages(text: str, pages: list[Path]) -> str:
    """Make links of the names of some pages, *like this*, in a chapter, which is read without too.

    The pages are those that only a site with Python for the browser has.
    """
    for page in pages:
        title = page.read_text(encoding="utf-8").splitlines()[0].removeprefix("# ")
        text = text.replace(f"*{title}*", f"[{title}](../{page.stem}.md)")
    return text


def collect(source: Path, live: bool, lite: bool) -> None:
    """Put the pages together in a folder, with those that need Python if it is there."""
    pages = sorted((ROOT / "docs" / "live").glob("*.md")) if live else []
    for path in sorted(path for pattern in PAGES for path in ROOT.glob(pattern)):
        target = source / path.relative_to(ROOT)
        target.parent.mkdir(parents=True, exist_ok=True)
        text = path.read_text(encoding="utf-8")
        if path.suffix == ".ipynb":
            text = link_pages(fold_calls(text), pages)
        target.write_text(text, encoding="utf-8")
    teaching = source / "docs" / "teaching.md"
    made = {
        path.stem: slides_of(json.loads(path.read_text(encoding="utf-8")))
        for path in sorted(ROOT.glob("notebooks/*.ipynb"))
    }
    teaching.write_text(numbered(teaching.read_text(encoding="utf-8"), made), encoding="utf-8")
    shutil.copytree(ROOT / FIGURES, source / FIGURES)
    notebooks = sorted(path.stem for path in ROOT.glob("notebooks/*.ipynb"))
    contents = toctree([f"notebooks/{name}" for name in notebooks], "The course")
    paths = [*sorted(ROOT.glob("docs/*.md")), *sorted(ROOT.glob("docs/sheets/*.md"))]
    docs = [str(path.relative_to(ROOT).with_suffix("")) for path in paths]
    if pages:
        for path in pages:
            text = with_boards(path.read_text(encoding="utf-8"))
            (source / path.name).write_text(text, encoding="utf-8")
        contents += toctree([path.stem for path in pages], "In this browser")
    contents += toctree([*docs, "data/README"], "To look things up")
    (source / "reference").mkdir()
    reference = "# Reference\n\nWhat is public in each part of the package.\n"
    for caption, names in REFERENCE.items():
        for name in names:
            (source / "reference" / f"{name}.md").write_text(reference_page(name))
        reference += f"\n## {caption}\n" + toctree(names)
    (source / "reference" / "index.md").write_text(reference)
    contents += toctree(["reference/index"], "The package")
    contents += toctree(["About <README>", "CONTRIBUTING", "CHANGELOG"], "The project")
    (source / "index.md").write_text(front_page(live, lite) + contents)


def fold_contents(made: Path) -> None:
    """Leave the list of all pages folded beside pictures, which are as wide as they were drawn."""
    for page in [made / "index.html", *(made / "notebooks").glob("*.html")]:
        text = page.read_text(encoding="utf-8")
        folded = text.replace("bd-sidebar-primary ", "bd-sidebar-primary pst-sidebar-hidden ", 1)
        page.write_text(folded, encoding="utf-8")


def add_lite(folder: Path) -> bool:
    """Put JupyterLite into the site, if it can be had; tells whether it could."""
    try:
        build_lite(folder)
    except PartsMissingError as error:
        print(f"The site will be without JupyterLite: {error}")
        return False
    return True


def keep_offline(made: Path) -> None:
    """Write the service worker, which is another one whenever anything of the site is."""
    digest = hashlib.sha256()
    for path in sorted(made.rglob("*")):
        if path.is_file() and ".doctrees" not in path.parts:
            digest.update(path.relative_to(made).as_posix().encode() + path.read_bytes())
    script = (ROOT / "docs" / "offline.js").read_text(encoding="utf-8")
    script = script.replace("@BUILD@", digest.hexdigest()[:16]).replace("@RUNTIME@", VERSION)
    (made / "offline.js").write_text(script, encoding="utf-8")
    theirs = made / "lite" / "service-worker.js"
    if theirs.is_file():  # ours comes first, and leaves to theirs what notebooks ask of the page
        theirs.write_text(f"{script}\n{theirs.read_text(encoding='utf-8')}", encoding="utf-8")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "_build" / "site")
    parser.add_argument("--parts", type=Path, help="a folder that has the parts of Pyodide")
    parser.add_argument("--address", default="", help="where it will be: https://…, for previews")
    parser.add_argument("--without-python", action="store_true", help="pages to be read only")
    given = parser.parse_args()
    out, parts = given.out, None
    if out.exists() and not (out / "_static").is_dir():
        print(f"{out} is in the way: it is no folder of a site, and is not replaced")
        return 1
    if not given.without_python:
        try:
            parts = gather(given.parts)
        except PartsMissingError as error:
            print(f"The pages will be plain, without Python: {error}")
    # With it, whatever reads notebooks first compiles the grammar of addresses in any letters.
    sys.modules.setdefault("rfc3987_syntax", None)  # type: ignore[arg-type]
    from sphinx.cmd.build import build_main  # after what may be said at once

    with tempfile.TemporaryDirectory() as folder:
        source, made = Path(folder) / "source", Path(folder) / "site"
        source.mkdir()
        lite = bool(parts) and add_lite(made / "lite")
        collect(source, bool(parts), lite)
        options = ["--fail-on-warning", "--quiet", "-D", f"html_baseurl={given.address}"]
        options += ["--tag", "live"] * bool(parts) + ["--tag", "lite"] * lite
        failed = int(build_main([*options, "-c", str(ROOT / "docs"), str(source), str(made)]))
        if failed:
            return failed
        for path in (made / "_static" / "mathjax").iterdir():
            if path.name not in MATHJAX:
                path.unlink() if path.is_file() else shutil.rmtree(path)
        write_typefaces(made / "_static" / "fonts")
        put_into_files(made)
        fold_contents(made)
        put_pictures(made)
        if parts:
            lay_out(parts, made / "python")
            keep_offline(made)
        if out.exists():
            shutil.rmtree(out)
        shutil.copytree(made, out, ignore=shutil.ignore_patterns(".doctrees", ".buildinfo"))
    print(f"The site is in {out / 'index.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
