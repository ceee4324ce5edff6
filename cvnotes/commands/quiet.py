"""JupyterLab without words that nobody needs: settings for `cvnotes lab` and the builder."""

import json
import logging
import os
from pathlib import Path

# A kernel's socket is <runtime folder>/kernel-<36 letters>-ipc-<n>; macOS takes 103 bytes.
_LONGEST_FOLDER = 103 - len("/kernel--ipc-5") - 36


class WithoutFarewell(logging.Filter):
    """Drops the critical remark that the server was told to end, which it was, by us."""

    def filter(self, record: logging.LogRecord) -> bool:
        """Return whether a record is worth a line."""
        return not record.getMessage().startswith("received signal")


def transport(runtime: Path | str) -> str:
    """Return how a kernel is spoken to: by files of its owner where the system has such sockets.

    Over TCP any user of the machine could listen, and every kernel warns of that.

    Parameters
    ----------
    runtime : Path or str
        Folder of the sockets, as ``jupyter_core.paths.jupyter_runtime_dir`` gives it.
    """
    fits = len(os.fsencode(runtime)) <= _LONGEST_FOLDER
    return "ipc" if os.name == "posix" and fits else "tcp"


def options(runtime: Path | str) -> list[str]:
    """Return JupyterLab's options that keep it quiet."""
    name = f"{__name__}.{WithoutFarewell.__name__}"
    logs = {
        "filters": {"farewell": {"()": name}},
        "handlers": {"console": {"filters": ["farewell"]}},
    }
    return [
        "--ServerApp.log_level=ERROR",
        "--LabApp.log_level=ERROR",
        "--ServerApp.log_format=%(message)s",
        f"--ServerApp.logging_config={json.dumps(logs)}",
        f"--KernelManager.transport={transport(runtime)}",
    ]
