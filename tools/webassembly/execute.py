"""Execute the cells of a notebook inside Pyodide; `run.mjs` reads this file and calls it."""

import json
import os
import sys
from contextlib import redirect_stderr, redirect_stdout
from io import TextIOBase
from typing import IO, Any

from IPython.core.displayhook import DisplayHook
from IPython.core.displaypub import DisplayPublisher
from IPython.core.interactiveshell import InteractiveShell
from PIL import Image

outputs: list[dict[str, Any]] = []  # of the cell that runs


def leave_unpacked(_image: Image.Image, file: IO[bytes], _name: str | bytes) -> None:
    """Write no photograph: texts are compared, and packing would be a fifth of the time here."""
    file.write(b"RIFF")


Image.init()
Image.SAVE["WEBP"] = leave_unpacked


class Stream(TextIOBase):
    """What a cell prints, joined to what it printed just before."""

    def __init__(self, name: str) -> None:
        self.name = name

    def write(self, text: str) -> int:
        """Keep a text."""
        last = outputs[-1] if outputs else {}
        if last.get("name") == self.name:
            last["text"] += text
        elif text:
            outputs.append({"output_type": "stream", "name": self.name, "text": text})
        return len(text)


class Published(DisplayPublisher):
    """What a cell displays."""

    def publish(self, data: dict[str, Any], **_: Any) -> None:  # type: ignore[override]
        """Keep its forms."""
        outputs.append({"output_type": "display_data", "data": dict(data)})


class Result(DisplayHook):
    """What a cell ends with."""

    def write_output_prompt(self) -> None:
        """Leave Out[n] away."""

    def write_format_data(self, data: dict[str, Any], md_dict: Any = None) -> None:  # noqa: ARG002
        """Keep its forms."""
        outputs.append({"output_type": "execute_result", "data": dict(data)})


class Shell(InteractiveShell):
    """IPython without a terminal."""

    displayhook_class = Result
    display_pub_class = Published

    def showtraceback(self, *_: Any, **__: Any) -> None:
        """Keep the error."""
        kind, value, _ = sys.exc_info()
        name = kind.__name__ if kind else ""
        outputs.append({"output_type": "error", "ename": name, "evalue": str(value)})


def execute(notebook: str) -> str:
    """Return the outputs of the code cells as JSON, from a notebook's text."""
    Shell.clear_instance()
    shell = Shell.instance()
    os.makedirs("/tmp/course", exist_ok=True)  # noqa: PTH103
    os.chdir("/tmp/course")
    found = []
    for cell in json.loads(notebook)["cells"]:
        if cell["cell_type"] == "code":
            outputs.clear()
            with redirect_stdout(Stream("stdout")), redirect_stderr(Stream("stderr")):
                shell.run_cell("".join(cell["source"]))  # type: ignore[no-untyped-call]
            found.append([dict(output) for output in outputs])
    return json.dumps(found, default=str)
