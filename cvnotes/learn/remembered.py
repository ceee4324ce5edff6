"""What was solved, remembered over kernels and days in a small file beside the notebooks.

The file holds names of exercises and days, nothing else; it is never sent anywhere. It is written
where somebody works interactively (a notebook, IPython), not by scripts and tests. Whoever
deletes it starts anew.
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
from cvnotes.files import write_whole

FILE = "cvnotes-progress.json"
# Another place for the file; empty for none.
VARIABLE = "CVNOTES_PROGRESS"
_LARGEST = 100_000  # bytes


def place() -> Path | None:
    """Tell where the file is: beside the notebook; None where nothing is remembered.

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
    """Give the interactive shell that runs this; None in scripts."""
    ipython = sys.modules.get("IPython")
    return ipython.get_ipython() if ipython is not None else None


def solved_before() -> dict[str, str]:
    """Read what was solved, and on which day; nothing if the file is not there or not readable."""
    path = place()
    try:
        if path is None or path.stat().st_size > _LARGEST:
            return {}
        solved = json.loads(path.read_text(encoding="utf-8"))["solved"]
        return {str(name): str(day)[:10] for name, day in solved.items()}
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return {}


def remember(names: Iterable[str]) -> None:
    """Write down what was solved, with what another notebook wrote down in the meantime.

    Where the file cannot be written nothing happens: the notebook still knows, until it ends.
    """
    path = place()
    known = solved_before()
    new = [name for name in names if name not in known]
    if path is None or not new:
        return
    today = datetime.date.today().isoformat()
    text = json.dumps({"solved": known | dict.fromkeys(new, today)}, indent=1, sort_keys=True)
    with contextlib.suppress(OSError, CvnotesError):
        write_whole({path: f"{text}\n".encode()})
