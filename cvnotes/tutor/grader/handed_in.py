"""What was handed in: the notebooks of a folder, and what lies there in place of one.

The one door for what comes from students: no link to a folder is followed, nothing but a regular
file is opened, and what cannot be read is said in place of a notebook.
"""

import os
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from cvnotes.base import FileError
from cvnotes.base.writing import printable

_MAX_NOTEBOOK = 100 * 2**20
NOTHING = "nothing handed in"
# What students hand in for a notebook.
_MISTAKEN = {".py", ".html", ".pdf", ".doc", ".docx", ".odt", ".rtf", ".txt", ".md"}
_MISTAKEN |= {".zip", ".7z", ".rar", ".tar", ".gz", ".tgz", ".json"}


@dataclass(frozen=True)
class Handin:
    """One file, or a folder without a notebook, as it was handed in.

    Attributes
    ----------
    student, notebook : str
        Its folder below the graded one, and its file name.
    content : bytes or str
        The file; or why there is none.
    """

    student: str
    notebook: str
    content: bytes | str

    @property
    def hash(self) -> str:
        """A fingerprint of the file; empty without one."""
        return sha256(self.content).hexdigest() if isinstance(self.content, bytes) else ""


def listed(folder: Path, ours: Collection[Path] = ()) -> list[Handin]:
    """List what was handed in below a folder, all of it read at once.

    Parameters
    ----------
    folder : Path
        Where it lies, in folders of the students or not.
    ours : collection of Path
        Files and folders that nobody handed in.

    Raises
    ------
    FileError
        There is no such folder, or no notebook in it.
    """
    if not folder.is_dir():
        raise FileError(f"{printable(folder)} is not a folder")
    try:
        theirs = sorted(path for path in folder.iterdir() if not _is_ours(path, ours))
    except OSError as error:
        raise FileError(f"{printable(folder)} cannot be read: {error.strerror}") from None
    found: list[Handin] = []
    for path in theirs:
        if path.suffix != ".ipynb" and not path.is_symlink() and path.is_dir():
            found += _in_folder(path, folder)
        elif path.suffix == ".ipynb":
            found.append(_read(path, folder))
        elif path.suffix.lower() in _MISTAKEN and path.is_file():
            found.append(Handin("", printable(path.name), _no_notebook([path])))
    if not any(one.notebook.endswith(".ipynb") for one in found):
        raise FileError(f"{printable(folder)} holds no notebooks (*.ipynb)")
    return found


def _in_folder(path: Path, folder: Path) -> Iterator[Handin]:
    """Yield the notebooks of a student, or what there is instead."""
    inside, closed = _below(path)
    notebooks = sorted(p for p in inside if p.suffix == ".ipynb")
    yield from (_read(notebook, folder) for notebook in notebooks)
    for there, why in closed:
        yield Handin(printable(there.relative_to(folder)), "", why)
    if not notebooks and not closed:
        others = sorted(p for p in inside if not p.name.startswith("."))
        yield Handin(printable(path.name), "", _no_notebook(others) if others else NOTHING)


def _below(folder: Path) -> tuple[list[Path], list[tuple[Path, str]]]:
    """Return all files below a folder, and the folders that cannot be looked into, with why.

    ``Path.rglob`` calls itself for each folder in a folder, and fails in a deep one.
    """
    files: list[Path] = []
    closed: list[tuple[Path, str]] = []
    waiting = [folder]
    while waiting:
        here = waiting.pop()
        try:
            with os.scandir(here) as entries:
                for entry in entries:
                    inner = entry.is_dir(follow_symlinks=False)
                    if inner and entry.name != ".ipynb_checkpoints":
                        waiting.append(here / entry.name)
                    if not inner or entry.name.endswith(".ipynb"):
                        files.append(here / entry.name)
        except OSError as error:
            closed.append((here, f"cannot be read: {error.strerror}"))
    return files, closed


def _no_notebook(paths: list[Path]) -> str:
    names = ", ".join(printable(path.name) for path in paths[:3])
    return f"wrong file type: {names} {'are no notebooks' if len(paths) > 1 else 'is no notebook'}"


def _is_ours(path: Path, ours: Collection[Path]) -> bool:
    """Return whether something is one of ours, or holds it."""
    hidden = path.name.startswith(".")
    real = Path(os.path.realpath(path))  # Path.resolve raises where a link leads to itself
    return hidden or any(own.resolve().is_relative_to(real) for own in ours)


def _read(path: Path, folder: Path) -> Handin:
    parent = path.relative_to(folder).parent
    student = "" if parent == Path() else printable(parent)
    return Handin(student, printable(path.name), _content(path))


def _content(path: Path) -> bytes | str:
    """Read a notebook, or say why that cannot be done."""
    try:
        if not path.is_file():
            return "not a regular file"
        if path.stat().st_size > _MAX_NOTEBOOK:
            return "larger than 100 MB"
        return path.read_bytes()
    except OSError as error:
        return f"cannot be read: {error.strerror}"
