"""The place of OpenCV where there is none: chapters that compare with it can be run, but for that.

In the browser this is `cv2`; see tools/browser_parts.py.
"""

from typing import NoReturn


def __getattr__(name: str) -> NoReturn:
    if name.startswith("__"):  # asked by Python itself
        raise AttributeError(name)
    raise ImportError(
        f"cv2.{name}: there is no OpenCV in a browser. This cell compares with it, and runs where "
        "the course is installed; the others go on without."
    )
