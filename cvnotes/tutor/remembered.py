"""What was solved and guessed, remembered over kernels and days in a file beside the notebooks.

The file holds names of exercises, days and guesses, nothing else; it is never sent anywhere. It
is written where somebody works interactively (a notebook, IPython), not by scripts and tests.
Whoever deletes it starts anew.
"""

import contextlib
import datetime
import json
import os
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from cvnotes.base import CvnotesError
from cvnotes.base.writing import write_whole

FILE = "cvnotes-progress.json"
# Another place for the file; empty for none.
VARIABLE = "CVNOTES_PROGRESS"
_LARGEST = 100_000  # bytes


def place() -> Path | None:
    """Return where the file is: beside the notebook; None where nothing is remembered.

    Examples
    --------
    >>> place() is None  # in a script, as this one
    True
    """
    asked = os.environ.get(VARIABLE)
    if asked is not None:
        return Path(asked).expanduser() if asked else None
    return Path(FILE) if shell() is not None else None


def shell() -> Any:
    """Return the interactive shell that runs this; None in scripts."""
    ipython = sys.modules.get("IPython")
    return ipython.get_ipython() if ipython is not None else None


def solved_before() -> dict[str, str]:
    """Read what was solved, and on which day; nothing if the file is not there or not readable."""
    return {str(name): str(day)[:10] for name, day in _read("solved").items()}


def guessed_before() -> dict[str, Any]:
    """Read what was guessed: numbers, words, or lists of numbers."""
    return _read("guesses")


def remember(names: Iterable[str]) -> None:
    """Write down what was solved, with what another notebook wrote down in the meantime.

    Where the file cannot be written nothing happens: the notebook still knows, until it ends.
    """
    known = solved_before()
    today = datetime.date.today().isoformat()
    if new := {name: today for name in names if name not in known}:
        _write(solved=known | new, guesses=guessed_before())


def remember_guess(name: str, value: Any) -> None:
    """Write down a guess in place of an earlier one of that name."""
    _write(solved=solved_before(), guesses=guessed_before() | {name: value})


def _read(part: str) -> dict[str, Any]:
    path = place()
    try:
        if path is None or path.stat().st_size > _LARGEST:
            return {}
        return dict(json.loads(path.read_text(encoding="utf-8")).get(part, {}))
    except (OSError, ValueError, TypeError, AttributeError, RecursionError):
        return {}


def _write(**parts: dict[str, Any]) -> None:
    path = place()
    if path is None:
        return
    text = json.dumps(
        {part: known for part, known in parts.items() if known}, indent=1, sort_keys=True
    )
    with contextlib.suppress(OSError, CvnotesError):
        write_whole({path: f"{text}\n".encode()})
