"""A verdict on a calibration whose truth nobody knows, in words: what holds, and what to mend."""

from collections.abc import Iterator
from dataclasses import dataclass
from html import escape

import numpy as np

from cvnotes.base import CvnotesError
from cvnotes.calibration import Calibration
from cvnotes.calibration.coverage import covered_cells
from cvnotes.calibration.reliability import widest_angle

_FEW = 8  # pictures
_FLAT = 30.0  # degrees between the two boards that differ most
_LARGE = 6e-4  # RMS over the longer side of the picture
_OUT = 1.5  # worst view's RMS over the median
_OPTIMISTIC = 1.5  # deviations from the scatter of views over those of noise
_VAGUE = 0.005  # deviation of the focal length over its value


@dataclass(frozen=True)
class Verdict:
    """Sentences about a calibration, each with whether it is good news."""

    lines: tuple[tuple[bool, str], ...]

    @property
    def holds(self) -> bool:
        """Whether every line is good."""
        return all(good for good, _ in self.lines)

    def __bool__(self) -> bool:
        return self.holds

    def __repr__(self) -> str:
        return "\n".join(f"{'✓' if good else '✗'} {words}" for good, words in self.lines)

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{'✓' if good else '✗'}</td>"
            f'<td style="text-align: left">{escape(words)}</td></tr>'
            for good, words in self.lines
        )
        return f"<table>{rows}</table>"


def verdict(calibration: Calibration) -> Verdict:
    """Judge a calibration without the truth: by its pictures, residuals and error bars.

    Parameters
    ----------
    calibration : Calibration
        With its corners, as `calibrate` gives it.

    Returns
    -------
    Verdict
        One line for each question: are there enough pictures, are the boards tilted, were the
        picture's four corners reached, do the views determine the camera, is the RMS normal, does
        a picture stand out, are the residuals noise, is the focal length known? And one for each
        warning of the result.

    Notes
    -----
    A verdict teaches, and `Calibration.reliable` decides: a camera may be reliable with some lines
    that say what would make it better.

    Examples
    --------
    >>> from cvnotes.calibration import calibrate
    >>> from cvnotes.pictures import course
    >>> found = calibrate(course.board().points, course.measured_corners(), (640, 480))
    >>> print(verdict(found).lines[1][1])
    boards differ by up to 87° in tilt
    """
    if not isinstance(calibration, Calibration) or not calibration.image_points:
        raise CvnotesError(
            "verdict: expected the result of calibrate, with its corners, "
            f"got {type(calibration).__name__}"
        )
    return Verdict((*_of_pictures(calibration), *_of_fit(calibration)))


def _line(good: bool, words: str, advice: str) -> tuple[bool, str]:
    """Return a line, with advice where it is no good news."""
    return good, words if good else words + advice


def _of_pictures(found: Calibration) -> Iterator[tuple[bool, str]]:
    n, angle = len(found.poses), widest_angle(found.poses)
    yield _line(n >= _FEW, f"{n} pictures", f" only: take {_FEW} or more")
    advice = " only: tilt the board by 30° to 45°, towards every side"
    yield _line(angle >= _FLAT, f"boards differ by up to {angle:.0f}° in tilt", advice)
    seen = covered_cells(list(found.image_points), found.size)
    if missed := 4 - int(seen[[0, 0, -1, -1], [0, -1, 0, -1]].sum()):
        of = "any" if missed == 4 else missed
        yield False, f"no board in {of} of the picture's four corners: hold a small one there"
    else:
        yield True, "boards reach into all four corners of the picture"


def _of_fit(found: Calibration) -> Iterator[tuple[bool, str]]:
    if found.reliable:
        yield True, "the pictures determine the camera"
    yield from ((False, doubt) for doubt in found.warnings)
    part = found.rms / max(found.size)
    words = f"RMS {found.rms:.3f} px, {1e6 * part:.0f} millionths of the picture's longer side"
    if part < _LARGE and not found.warnings:
        words += ": normal or better"
    advice = ": look at the residuals; something moved, or the board or the lens is not the model"
    yield _line(part < _LARGE, words, advice)
    times = float(found.view_rms.max() / max(np.median(found.view_rms), 1e-12))
    words = f"the worst picture, {found.view_rms.argmax()}, has {times:.1f} times the usual RMS"
    yield _line(times < _OUT, words, ": look at it, or leave it out")
    yield from _of_error_bars(found)


def _of_error_bars(found: Calibration) -> Iterator[tuple[bool, str]]:
    if not np.isfinite([*found.std_of_views.values()]).all():
        yield False, "without one of the pictures the others do not determine the camera"
        return
    times, part = found.times_noise, found.std_of_views["alpha_u"] / found.A[0, 0]
    words = f"the scatter between pictures is {times:.1f} times what noise would give"
    untried = ', and try lens="auto"' if found.choice is None else ""
    yield _line(times < _OPTIMISTIC, words, f": believe the larger ones{untried}")
    words = f"the focal length is known to {100 * part:.2g} %"
    yield _line(part < _VAGUE, words, " only: more pictures, more tilt")
