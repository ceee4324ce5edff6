"""Why a photograph is not used: objects with their numbers, and the words for each."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from textwrap import shorten
from typing import ClassVar, NamedTuple

_FEW = 80  # letters of a reason in brief


@dataclass(frozen=True)
class Reason:
    """Why a photograph is not used. ``str(reason)`` says it in words.

    Examples
    --------
    >>> str(OtherSize((480, 640), (640, 480)))
    '480×640 pixels where most photographs have 640×480; was it turned by an editor?'
    """

    words: ClassVar[str]  # its fields stand in it by their names
    more: ClassVar[str] = ""  # for which a line has no room

    def __str__(self) -> str:
        return self.words.format(**vars(self)) + self.more

    @property
    def brief(self) -> str:
        """The words without what is more than a line."""
        return shorten(str(self).removesuffix(self.more), _FEW, placeholder=" …")


@dataclass(frozen=True)
class Unreadable(Reason):
    """It is no photograph, or damaged; `why` comes from who tried to read it."""

    why: str
    words = "{why}"


@dataclass(frozen=True)
class OtherSize(Reason):
    """It has another (width, height) than most, or than the camera."""

    size: tuple[int, int]
    expected: tuple[int, int]
    of_camera: bool = False

    def __str__(self) -> str:
        turned = "; was it turned by an editor?" if self.size == self.expected[::-1] else ""
        return f"{self.brief}{turned}"

    @property
    def brief(self) -> str:
        """The two sizes."""
        whose = "the camera has" if self.of_camera else "most photographs have"
        return "{}×{} pixels where {whose} {}×{}".format(*self.size, *self.expected, whose=whose)


@dataclass(frozen=True)
class Copy(Reason):
    """It has the same pixels as another, which came first."""

    of: str
    words = "the same picture as {of}"


@dataclass(frozen=True)
class MadeByUs(Reason):
    """One of the commands made it."""

    command: str

    def __str__(self) -> str:
        return {
            "calibrate": "a picture of results that cvnotes calibrate made, no photograph",
            "stereo": "made by cvnotes stereo: a rectified picture, no photograph",
            "undistort": "made by cvnotes undistort: the lens is out of it already",
        }[self.command]


class Rejected(NamedTuple):
    """A photograph that was not used, and why."""

    file: str
    reason: Reason


# Endings of photographs; what else lies in a folder was not asked for.
_PICTURES = (".jpg", ".jpeg", ".png", ".tif", ".tiff", ".bmp", ".webp", ".heic", ".heif",
             ".pgm", ".ppm")  # fmt: skip


def unread(rejected: Iterable[Rejected], named: Iterable[str]) -> int:
    """Count the photographs that could not be read: by their ending, or named one by one.

    Examples
    --------
    >>> damaged = Unreadable("the file is damaged or cut off")
    >>> unread([Rejected("a.jpg", damaged), Rejected("notes.txt", damaged)], ["."])
    1
    """
    asked = set(named)
    return sum(
        isinstance(r.reason, Unreadable)
        and (r.file in asked or Path(r.file).suffix.lower() in _PICTURES)
        for r in rejected
    )
