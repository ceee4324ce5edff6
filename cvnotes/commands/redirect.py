"""An address with a secret, opened without showing it to every user of the machine.

What a browser is started with stands in the list of processes, which anybody may read. So it is
given a file that only its owner can read, and the file leads on to the address: as Jupyter does.
"""

import contextlib
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from html import escape
from pathlib import Path

PAGE = """\
<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Opening the course</title>
<meta name="referrer" content="no-referrer">
<meta http-equiv="refresh" content="0; url={address}"></head>
<body><p><a href="{address}">Go on to the course</a></p></body></html>
"""
NAME = "open-the-course.html"


@contextmanager
def leading_to(address: str, folder: Path) -> Iterator[str]:
    """Return an address of a file that leads on to another, as long as the block lasts.

    Parameters
    ----------
    address : str
        Where it leads.
    folder : Path
        Where the file is made, if that can be: browsers that are shut in (snaps) read what lies
        open in the home folder, and nothing hidden or temporary. Else it is made where temporary
        files are.
    """
    if os.environ.get("WSL_DISTRO_NAME"):  # the browser is in Windows, and knows no file of ours
        yield address
        return
    path = _written(PAGE.format(address=escape(address)), folder)
    try:
        yield path.as_uri()
    finally:
        with contextlib.suppress(OSError):
            path.unlink()


def _written(page: str, folder: Path) -> Path:
    """Write a page that its owner alone can read, in the folder or else where it can be."""
    path = folder.resolve() / NAME
    try:
        path.unlink(missing_ok=True)
        handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    except OSError:
        handle, name = tempfile.mkstemp(prefix="cvnotes-", suffix=".html")
        path = Path(name)
    with os.fdopen(handle, "w", encoding="utf-8") as stream:
        stream.write(page)
    return path
