"""A working copy of the course: what a student changed in it is never overwritten.

Each chapter is compared with what was last delivered, by its cells alone: what JupyterLab writes
about itself when it opens a notebook is no change. A record in the folder keeps what was delivered.
"""

import hashlib
import json
import platform
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cvnotes.base import FileError
from cvnotes.base.material import CLONE, is_clone
from cvnotes.base.writing import check_folder, printable
from cvnotes.files import write_whole
from cvnotes.files.ownership import numbered

FOLDER = "my_course"
RECORD = ".cvnotes-course.json"
_PAGE = re.compile(r"\]\(\.\./docs/([\w/-]+\.md)")
_FIGURE = re.compile(r"\]\((figures/[\w-]+\.\w+)\)")


@dataclass
class Delivery:
    """What came into a working copy."""

    new: list[str] = field(default_factory=list)
    updated: list[str] = field(default_factory=list)
    beside: list[tuple[str, str]] = field(default_factory=list)  # (changed chapter, newer version)

    def sentences(self) -> Iterator[str]:
        """Say it to the student."""
        if self.new:
            yield f"New chapters: {', '.join(self.new)}"
        if self.updated:
            yield f"Brought up to date, as you had not changed them: {', '.join(self.updated)}"
        for chapter, newer in self.beside:
            yield f"{chapter} is as you left it; its newer version is beside it: {newer}"


def default_folder() -> Path:
    """Return the folder of the working copy: this one if it is one; else in the clone, or here."""
    if (Path.cwd() / RECORD).is_file():
        return Path.cwd()
    return (CLONE if is_clone() else Path.cwd()) / FOLDER


def deliver(course: Path, folder: Path) -> Delivery:
    """Bring the chapters of the course, and the pages they lead to, into a working copy.

    Parameters
    ----------
    course : Path
        The folder of the course's notebooks.
    folder : Path
        The working copy; it is made if it is not there.

    Returns
    -------
    Delivery
        What chapters are new. A chapter that the student has not changed is replaced by its newer
        version; the newer version of one that was changed comes beside it, once.

    Raises
    ------
    FileError
        The folder cannot be written, or is the course's own.
    """
    if folder.resolve() == course.resolve():
        raise FileError(
            f"{printable(folder)} holds the course itself; name another folder for your copy, "
            "or open this one with --notebooks"
        )
    check_folder(folder)
    record, done = _Record.read(folder), Delivery()
    contents: dict[Path, bytes] = {}
    for chapter in sorted(course.glob("*.ipynb")):
        name, content = chapter.name, _for_the_copy(chapter.read_bytes())
        latest, there = cells_of(content), _cells_there(folder / name)
        if there in (None, latest, record.delivered.get(name)):
            record.delivered[name] = latest
            if there != latest:
                (done.new if there is None else done.updated).append(name)
                contents[folder / name] = content
        elif latest not in (record.delivered.get(name), record.offered.get(name)):
            newer = _name_beside(folder, chapter.stem, record)
            done.beside.append((name, newer))
            contents[folder / newer] = content
            record.delivered[newer] = record.offered[name] = latest
    for name, content in pages(course).items():
        latest, there = cells_of(content), _cells_there(folder / name)
        if there in (None, record.delivered.get(name)):
            record.delivered[name] = latest
            if there != latest:
                contents[folder / name] = content
    write_whole(contents | {folder / RECORD: record.encoded()})
    return done


def pages(course: Path) -> dict[str, bytes]:
    """Return the pages of the docs to which chapters lead, and their figures, by their place.

    Parameters
    ----------
    course : Path
        The folder of the course's notebooks; the docs are beside it.
    """
    docs = course.parent / "docs"
    linked = "".join(path.read_text(encoding="utf-8") for path in course.glob("*.ipynb"))
    found = {}
    for page in sorted(set(_PAGE.findall(linked))):
        found[f"docs/{page}"] = (docs / page).read_bytes()
        for figure in _FIGURE.findall(found[f"docs/{page}"].decode()):
            found[f"docs/{figure}"] = (docs / figure).read_bytes()
    return found


def start_over(course: Path, folder: Path, chapter: str) -> tuple[str, str]:
    """Put a chapter back as the course has it; gives its name, and that of the one kept.

    Parameters
    ----------
    course, folder : Path
        As for `deliver`, which must have been called.
    chapter : str
        Its file, or its number.

    Raises
    ------
    FileError
        There is no such chapter.
    """
    name = _chapter_name(course, chapter)
    content = _for_the_copy((course / name).read_bytes())
    kept = next(
        n for n in numbered(f"{Path(name).stem}-kept", ".ipynb") if not (folder / n).exists()
    )
    record = _Record.read(folder)
    record.delivered[name] = cells_of(content)
    (folder / name).rename(folder / kept)
    write_whole({folder / name: content, folder / RECORD: record.encoded()})
    return name, kept


def cells_of(content: bytes) -> str:
    """Return a fingerprint of what a notebook's cells say and show, however the file is laid out.

    Examples
    --------
    >>> one = b'{"cells": [{"cell_type": "code", "source": ["a = 1"], "metadata": {}}]}'
    >>> cells_of(one) == cells_of(one.replace(b'["a = 1"]', b'"a = 1"'))
    True
    """
    try:
        said = [
            [_joined(cell.get(key)) for key in ("cell_type", "source", "outputs")]
            for cell in json.loads(content)["cells"]
        ]
        content = json.dumps(said, sort_keys=True).encode()
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        pass  # no notebook any more: then its bytes are what it says
    return hashlib.sha256(content).hexdigest()


@dataclass
class _Record:
    """What was delivered, by file, and which newer versions were put beside, by chapter."""

    delivered: dict[str, str]
    offered: dict[str, str]

    @staticmethod
    def read(folder: Path) -> "_Record":
        """Read a folder's record; without one, everything there counts as the student's."""
        try:
            keys = json.loads((folder / RECORD).read_text(encoding="utf-8"))
            return _Record(dict(keys["delivered"]), dict(keys["offered"]))
        except (OSError, ValueError, KeyError, TypeError):
            return _Record({}, {})

    def encoded(self) -> bytes:
        """Spell it as a file."""
        return json.dumps(vars(self), indent=1, sort_keys=True).encode()


def _cells_there(path: Path) -> str | None:
    try:
        return cells_of(path.read_bytes())
    except FileNotFoundError:
        return None
    except OSError as error:
        raise FileError(f"{printable(path)} cannot be read: {error.strerror or error}") from error


def _name_beside(folder: Path, stem: str, record: _Record) -> str:
    """Name a newer version: where nothing is, or an earlier one that was not touched."""
    return next(
        name
        for name in numbered(f"{stem}-new", ".ipynb")
        if _cells_there(folder / name) in (None, record.delivered.get(name))
    )


def _chapter_name(course: Path, asked: str) -> str:
    """Find a chapter by its file or its number."""
    names = [path.name for path in sorted(course.glob("*.ipynb"))]
    wanted = Path(asked).stem.lower()
    for name in names:
        number = re.match(r"\d+", name)
        same_number = wanted.isdigit() and number and int(number[0]) == int(wanted)
        if same_number or Path(name).stem.lower() == wanted:
            return name
    raise FileError(f"{printable(asked)} is no chapter; the chapters are {', '.join(names)}")


def _for_the_copy(content: bytes) -> bytes:
    """Lead to the docs in the working copy, and say in a notebook which Python runs it.

    JupyterLab shows nothing above the folder that it opens. What it would write into a notebook
    anyway is there already, so that opening a chapter does not change it.
    """
    content = _PAGE.sub(r"](docs/\1", content.decode()).encode()
    notebook = json.loads(content)
    language = notebook.get("metadata", {}).get("language_info", {})
    if "version" not in language:
        return content
    language["version"] = platform.python_version()
    return (json.dumps(notebook, indent=1, sort_keys=True, ensure_ascii=False) + "\n").encode()


def _joined(value: Any) -> Any:
    """Join lists of lines: a notebook may hold a text either way."""
    if isinstance(value, dict):
        return {key: _joined(inner) for key, inner in value.items()}
    if isinstance(value, Iterable) and not isinstance(value, str):
        parts = [_joined(inner) for inner in value]
        return "".join(parts) if all(isinstance(part, str) for part in parts) else parts
    return value
