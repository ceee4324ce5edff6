"""Build what is published, if nothing is left to be filled in.

    python tools/release.py            build dist/*, or say what is missing
    python tools/release.py --notes    print the release notes of this version

Uploading is left to whoever has the right to: `python -m twine upload dist/*`.
"""

import argparse
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PLACEHOLDER = "repository.invalid"  # until the course has a home; no such place can exist
FILLED_IN = ("pyproject.toml", "CITATION.cff")


def version(root: Path) -> str:
    """Return the version of the package."""
    text = (root / "cvnotes" / "__init__.py").read_text(encoding="utf-8")
    found = re.search(r'__version__ = "(.+)"', text)
    return found[1] if found else ""


def notes(root: Path) -> tuple[str, str]:
    """Return the heading and the text of this version's release notes; empty if there are none."""
    text = (root / "CHANGELOG.md").read_text(encoding="utf-8")
    name = re.escape(version(root))
    found = re.search(rf"^## ({name}\b[^\n]*)\n(.*?)(?=^## |\Z)", text, re.M | re.S)
    return (found[1], found[2].strip()) if found else ("", "")


def missing(root: Path) -> list[str]:
    """Describe what keeps this version from being released."""
    found = [
        f"{name} names {PLACEHOLDER}: put the address of the repository there"
        for name in FILLED_IN
        if PLACEHOLDER in (root / name).read_text(encoding="utf-8")
    ]
    if not found and "/actions/workflows/tests.yml" not in (root / "README.md").read_text("utf-8"):
        found.append("README.md has no badges: tools/badges.py --write puts them there")
    heading, text = notes(root)
    if not text:
        found.append(f"CHANGELOG.md has no notes of version {version(root)}")
    elif "unreleased" in heading:
        found.append(f"CHANGELOG.md calls {version(root)} unreleased: put the day there")
    if f"version: {version(root)}\n" not in (root / "CITATION.cff").read_text(encoding="utf-8"):
        found.append(f"CITATION.cff is not of version {version(root)}")
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--notes", action="store_true", help="print this version's release notes")
    if parser.parse_args().notes:
        print(notes(ROOT)[1])
        return 0
    if problems := missing(ROOT):
        print("Not released:", *problems, sep="\n  ", file=sys.stderr)
        return 1
    build = [sys.executable, "-m", "build", "--outdir", str(ROOT / "dist"), str(ROOT)]
    return subprocess.run(build, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
