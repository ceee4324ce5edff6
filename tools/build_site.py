"""Build the site: notebooks, docs and the package's reference as one folder of pages.

    python tools/build_site.py                      into docs/_build/site
    python tools/build_site.py --out FOLDER
    python tools/build_site.py --parts FOLDER       Pyodide from a folder of yours
    python tools/build_site.py --without-python     the pages alone, which can only be read

Needs the extra `docs` (`python3 start.py site` sets it up). The notebooks appear as they are
committed; nothing is executed. The pages load nothing from elsewhere, formulas included.

With the parts of Python for the browser (`tools/browser_parts.py` says where they come from), the
pages also run the course's own code: they are in `python/`, and the scripts of `docs/static/live`
in `_static/live`. Without the parts the site is built plain, and says so.
"""

import argparse
import shutil
import sys
import tempfile
from importlib import import_module
from pathlib import Path

from browser_parts import PartsMissingError, gather, lay_out
from sphinx.cmd.build import build_main

ROOT = Path(__file__).resolve().parents[1]
# Whatever the README leads to, at the place where it stands in the repository.
PAGES = ("CHANGELOG.md", "CONTRIBUTING.md", "data/README.md", "docs/*.md", "notebooks/*.ipynb")
FIGURES = "docs/figures"
# Of MathJax, whose many bundles contain one another: the one in use, what it loads when a formula
# asks for it, and what its menu loads for those who listen to formulas.
MATHJAX = ("tex-chtml.js", "input", "output", "a11y", "sre")
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
    ),
    "Beside the chapters": ("pictures", "pictures.course", "show", "learn", "files", "base"),
    "Further inside": (
        "camera.lens_fold",
        "camera.lens_inverse",
        "targets.sheet",
        "calibration.starts",
        "calibration.refinement",
        "calibration.reliability",
        "pictures.raycast",
        "learn.concepts",
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


def toctree(caption: str, pages: list[str]) -> str:
    """Write a part of the table of contents."""
    lines = ["", "```{toctree}", ":hidden:", f":caption: {caption}", "", *pages, "```", ""]
    return "\n".join(lines)


def collect(source: Path) -> None:
    """Put the pages together in a folder."""
    for path in sorted(path for pattern in PAGES for path in ROOT.glob(pattern)):
        target = source / path.relative_to(ROOT)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path, target)
    shutil.copytree(ROOT / FIGURES, source / FIGURES)
    notebooks = sorted(path.stem for path in ROOT.glob("notebooks/*.ipynb"))
    contents = toctree("The course", [f"notebooks/{name}" for name in notebooks])
    docs = [f"docs/{path.stem}" for path in sorted(ROOT.glob("docs/*.md"))]
    contents += toctree("To look things up", [*docs, "data/README"])
    (source / "reference").mkdir()
    for caption, names in REFERENCE.items():
        for name in names:
            (source / "reference" / f"{name}.md").write_text(reference_page(name))
        contents += toctree(caption, [f"reference/{name}" for name in names])
    contents += toctree("The project", ["CONTRIBUTING", "CHANGELOG"])
    (source / "index.md").write_text((ROOT / "README.md").read_text() + contents)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "_build" / "site")
    parser.add_argument("--parts", type=Path, help="a folder that has the parts of Pyodide")
    parser.add_argument("--without-python", action="store_true", help="pages to be read only")
    given = parser.parse_args()
    out, parts = given.out, None
    if not given.without_python:
        try:
            parts = gather(given.parts)
        except PartsMissingError as error:
            print(f"The pages will be plain, without Python: {error}")
    with tempfile.TemporaryDirectory() as folder:
        source, made = Path(folder) / "source", Path(folder) / "site"
        source.mkdir()
        collect(source)
        options = ["--fail-on-warning", "--quiet", *(["--tag", "live"] if parts else [])]
        failed = int(build_main([*options, "-c", str(ROOT / "docs"), str(source), str(made)]))
        if failed:
            return failed
        for path in (made / "_static" / "mathjax").iterdir():
            if path.name not in MATHJAX:
                path.unlink() if path.is_file() else shutil.rmtree(path)
        if parts:
            lay_out(parts, made / "python")
        if out.exists():
            shutil.rmtree(out)
        shutil.copytree(made, out, ignore=shutil.ignore_patterns(".doctrees", ".buildinfo"))
    print(f"The site is in {out / 'index.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
