"""Why photographs of a board are not used."""

from dataclasses import dataclass

from cvnotes.base import CornersNotFound
from cvnotes.calibration.doubts import Doubt
from cvnotes.files import Reason

_ALL_THE_SAME = "--keep-all uses it all the same"


@dataclass(frozen=True)
class LeftOut(Reason):
    """Whoever asked does not want it."""

    words = "left out, as asked"


@dataclass(frozen=True)
class FramesTaken(Reason):
    """It is a video; some of its frames stand for photographs."""

    taken: int
    of: int
    words = "a video: of {of} frames {taken} that are sharp, still and different"


@dataclass(frozen=True)
class NoBoard(Reason):
    """The board was not found in it; `error` knows what was tried, and what is there instead."""

    error: CornersNotFound

    @property
    def said(self) -> str:
        """What is there instead."""
        return self.error.brief

    @property
    def question(self) -> str:
        """What probably went wrong."""
        return self.error.question

    @property
    def brief(self) -> str:
        """The same: what is there instead stands at its end."""
        return self.said


@dataclass(frozen=True)
class Misfit(Reason):
    """Its corners do not fit the camera of the others: its RMS, and that of a typical one, px."""

    rms: float
    typical: float
    words = "does not fit the others: {rms:.2f} px, a typical photograph {typical:.2f} px"
    question = f"was it moved, zoomed, rotated or badly found? {_ALL_THE_SAME}"


@dataclass(frozen=True)
class Exchanged(Reason):
    """The camera explains it better with left and right exchanged."""

    words = "left and right seem exchanged"
    question = _ALL_THE_SAME


class Mixed(Doubt):
    """No single camera took the photographs: another one of them helps nothing."""


@dataclass(frozen=True)
class NoPartner(Reason):
    """There is no photograph of the other camera that belongs to it."""

    side: str
    words = "no {side} photograph belongs to it"


@dataclass(frozen=True)
class PartnerNotUsed(Reason):
    """The photograph that belongs to it is not used; it has its own reason."""

    partner: str
    words = "its partner {partner} is not used"


@dataclass(frozen=True)
class FewInCommon(Reason):
    """It and the photograph that belongs to it show other parts of the board."""

    partner: str
    corners: int
    words = "only {corners} corners are also seen in its partner {partner}"
