"""Where the course's notebooks, data and docs are, in a clone and in an installed package."""

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parents[1]
CLONE = _PACKAGE.parent  # of the repository, unless the package was installed


def material(name: str) -> Path:
    """Return the folder ``notebooks``, ``data`` or ``docs`` of the course.

    In a clone they stand beside the package; a package that was installed brings them along.

    Examples
    --------
    >>> (material("data") / "camera.json").is_file()
    True
    """
    return CLONE / name if is_clone() else _PACKAGE / "course" / name


def is_clone() -> bool:
    """Return whether the package runs from a clone of the repository."""
    return (CLONE / "notebooks").is_dir() and (CLONE / "pyproject.toml").is_file()
