"""Why a photograph is not used: objects with their numbers, and the words for each."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from textwrap import shorten
from typing import ClassVar, NamedTuple

_FEW = 80  # letters of a reason in brief
_LISTED = 5  # photographs that are named one by one


@dataclass(frozen=True)
class Reason:
    """Why a photograph is not used. ``str(reason)`` says it in words.

    Examples
    --------
    >>> str(OtherSize((480, 640), (640, 480)))
    '480×640 pixels where most photographs have 640×480; was it turned by an editor?'
    """

    words: ClassVar[str]  # its fields stand in it by their names

    def __str__(self) -> str:
        return "; ".join(filter(None, [self.said, self.question]))

    @property
    def said(self) -> str:
        """What is wrong."""
        return self.words.format(**vars(self))

    @property
    def question(self) -> str:
        """What may have gone wrong or can be done, if that is known."""
        return ""

    @property
    def brief(self) -> str:
        """What is wrong, in a line."""
        return shorten(self.said, _FEW, placeholder=" …")


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

    @property
    def said(self) -> str:
        """The two sizes."""
        whose = "the camera has" if self.of_camera else "most photographs have"
        return "{}×{} pixels where {whose} {}×{}".format(*self.size, *self.expected, whose=whose)

    @property
    def question(self) -> str:
        """What editors do."""
        return "was it turned by an editor?" if self.size == self.expected[::-1] else ""


@dataclass(frozen=True)
class Copy(Reason):
    """It has the same pixels as another, which came first."""

    of: str
    words = "the same picture as {of}"


@dataclass(frozen=True)
class MadeByUs(Reason):
    """One of the commands made it."""

    command: str

    @property
    def said(self) -> str:
        """What it is."""
        return {
            "calibrate": "a picture of results that cvnotes calibrate made, no photograph",
            "stereo": "made by cvnotes stereo: a rectified picture, no photograph",
            "undistort": "made by cvnotes undistort: the lens is out of it already",
        }[self.command]


class Rejected(NamedTuple):
    """A photograph that was not used, and why."""

    file: str
    reason: Reason


def together(rejected: Iterable[Rejected]) -> list[str]:
    """Say once for all photographs with like reasons why they are not used.

    Examples
    --------
    >>> sizes = (OtherSize((4, 3), (3, 4)), OtherSize((8, 6), (6, 8)), Copy("a.png"))
    >>> together(Rejected(*each) for each in zip("bcd", sizes))
    ['b, c: was it turned by an editor?', 'd: the same picture as a.png']
    """
    alike: dict[str, list[Rejected]] = {}
    for each in rejected:
        alike.setdefault(each.reason.question or each.reason.said, []).append(each)
    sentences = []
    for words, own in alike.items():
        names = ", ".join(each.file for each in own[:_LISTED])
        names += f" … ({len(own)} in all)" * (len(own) > _LISTED)
        same = len({each.reason.said for each in own}) == 1
        sentences.append(f"{names}: {own[0].reason if same else words}")
    return sentences


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
