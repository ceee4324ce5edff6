"""What was handed in: the notebooks of a folder, and what lies there in place of one."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from cvnotes.base import FileError
from cvnotes.files.writing import printable

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
    theirs = sorted(path for path in folder.iterdir() if not _is_ours(path, ours))
    found: list[Handin] = []
    for path in theirs:
        if path.is_dir() and not path.is_symlink() and path.suffix != ".ipynb":
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
    notebooks = sorted(p for p in path.rglob("*.ipynb") if ".ipynb_checkpoints" not in p.parts)
    yield from (_read(notebook, folder) for notebook in notebooks)
    if not notebooks:
        others = sorted(p for p in path.rglob("*") if not (p.is_dir() or p.name.startswith(".")))
        yield Handin(printable(path.name), "", _no_notebook(others) if others else NOTHING)


def _no_notebook(paths: list[Path]) -> str:
    names = ", ".join(printable(path.name) for path in paths[:3])
    return f"wrong file type: {names} {'are no notebooks' if len(paths) > 1 else 'is no notebook'}"


def _is_ours(path: Path, ours: Collection[Path]) -> bool:
    """Tell whether something is one of ours, or holds it."""
    hidden = path.name.startswith(".")
    return hidden or any(own.resolve().is_relative_to(path.resolve()) for own in ours)


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
