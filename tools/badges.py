"""Badges for the README: the tests, the site, and where the course opens without installation.

    python tools/badges.py            print them
    python tools/badges.py --write    put them below the README's title

They need the address of the repository, which is in pyproject.toml once the course has a home.
"""

import argparse
import re
import sys
import tomllib
from pathlib import Path

from release import PLACEHOLDER

ROOT = Path(__file__).resolve().parents[1]
FIRST = "notebooks/00_start_here.ipynb"


def badges(address: str) -> str:
    """Return the badges of a repository on GitHub.

    Raises
    ------
    ValueError
        It has no home yet, or one elsewhere.
    """
    found = re.fullmatch(r"https://github\.com/([\w.-]+)/([\w.-]+?)/?", address)
    if PLACEHOLDER in address or found is None:
        raise ValueError(
            f"{address} is no repository on GitHub: put its address into pyproject.toml"
        )
    owner, name = found.groups()
    workflow = f"https://github.com/{owner}/{name}/actions/workflows/tests.yml"
    site = f"https://{owner.lower()}.github.io/{name}"
    binder = f"https://mybinder.org/v2/gh/{owner}/{name}/main?urlpath=lab/tree/{FIRST}"
    colab = f"https://colab.research.google.com/github/{owner}/{name}/blob/main/{FIRST}"
    shown = {
        "tests": (f"{workflow}/badge.svg", workflow),
        "read and run in the browser": (_shield("in_the_browser"), f"{site}/"),
        "Binder": ("https://mybinder.org/badge_logo.svg", binder),
        "Colab": ("https://colab.research.google.com/assets/colab-badge.svg", colab),
        "Codespaces": (_shield("Codespaces"), f"https://codespaces.new/{owner}/{name}"),
    }
    return "\n".join(f"[![{words}]({image})]({link})" for words, (image, link) in shown.items())


def _shield(words: str) -> str:
    return f"https://img.shields.io/badge/open-{words}-1d6fa5"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--write", action="store_true", help="put them into the README")
    write = parser.parse_args().write
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    try:
        made = badges(project["urls"]["Repository"])
    except ValueError as error:
        print(error, file=sys.stderr)
        return 1
    if not write:
        print(made)
        return 0
    path = ROOT / "README.md"
    title, rest = path.read_text(encoding="utf-8").split("\n\n", 1)
    rest = re.sub(r"\A(\[!\[.*\n)+\n", "", rest)
    path.write_text(f"{title}\n\n{made}\n\n{rest}", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
