"""Image formation and camera calibration, after the course notes.

Each wing is a chapter; import what a chapter needs from the face of its wing, for example
``from cvnotes.camera import Lens``. ``docs/house.md`` is the plan.
"""

from importlib import import_module
from typing import Any

__version__ = "0.1.0"


def __getattr__(name: str) -> Any:
    if name == "study":
        return import_module("cvnotes.base.study").study
    raise AttributeError(f"module 'cvnotes' has no attribute {name!r}")
