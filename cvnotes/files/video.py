"""Frames of a video that are worth a photograph: sharp, still and different from each other."""

import os
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, FileError
from cvnotes.files.decoding import refuse_irregular
from cvnotes.files.photos import Photo

MOST_FRAMES = 30  # more say little more of a camera, and each takes as long as a photograph

_CHUNK = 0.4  # s, of which the best frame is a candidate
_SMALL = 160  # px wide: the copies that are compared
_MOVING = 3.0  # times as much as the stillest quarter of all candidates
_DIFFERENT = 2.0  # grey levels, mean over the picture
_FPS = (1.0, 30.0, 1000.0)  # least, usual and most frames a second that are believed


class _Candidate(NamedTuple):
    """The best frame of a short part of a video."""

    number: int
    small: Array
    motion: float


Progress = Callable[[Iterator[Any], int], Iterable[Any]]


def unseen(items: Iterator[Any], _: int) -> Iterable[Any]:
    """Show nobody how far it is."""
    return items


def frames_of(path: Path, progress: Progress = unseen) -> tuple[list[Photo], int]:
    """Take the frames of a video that are sharp, still and different from each other.

    Parameters
    ----------
    path : Path
        The video.
    progress : callable
        (frames, how many) → the same, for whoever wants to show how far it is.

    Returns
    -------
    photos : list of Photo
        Grey pictures, called "<video> frame <number>", in the order of the video.
    n : int
        How many frames it has.

    Raises
    ------
    FileError
        OpenCV cannot read it; the message is the reason alone.

    Notes
    -----
    1. Of each 0.4 s, the stillest third of the frames by the mean difference to the frame before,
    and of these the sharpest by the variance of the Laplacian; 2. of all these the still ones;
    3. from the stillest on always the one that differs most from all that are taken, until 30 are,
    or no other differs by 2 grey levels. Then they are read again.
    """
    fps, n = _rate_and_length(path)
    at_a_time = max(3, round(_CHUNK * fps))
    candidates: list[_Candidate] = []
    chunk: list[tuple[int, npt.NDArray[np.uint8]]] = []
    before: Array | None = None
    number = -1
    for number, grey in progress(_read(path), n):
        chunk.append((number, grey))
        if len(chunk) == at_a_time:
            candidate, before = _best(chunk, before)
            candidates, chunk = [*candidates, candidate], []
    if len(chunk) > 1 or not candidates:
        candidates += [_best(chunk, before)[0]] if chunk else []
    if not candidates:
        raise FileError("no frame of this video can be read")
    taken = {c.number for c in _different(_still(candidates))}
    return _numbered(path, taken), number + 1


def frames_of_both(left: Path, right: Path, progress: Progress = unseen) -> list[list[Photo]]:
    """Take the frames of the left video as `frames_of` does, and the same ones of the right."""
    photos, _ = frames_of(left, progress)
    return [photos, _numbered(right, {_number(photo.path) for photo in photos})]


def frame_again(video: Path, frame: Path) -> npt.NDArray[np.uint8]:
    """Read a frame again that was taken, by what it is called."""
    return next(grey for _, grey in _read(video, {_number(frame)}))


def frames_in(path: Path) -> int:
    """Return how many frames a video says that it has; 0 if it does not."""
    return _rate_and_length(path)[1]


def _numbered(path: Path, numbers: set[int]) -> list[Photo]:
    return [
        Photo(path.with_name(f"{path.stem} frame {number}"), grey)
        for number, grey in _read(path, numbers)
    ]


def _number(frame: Path) -> int:
    return int(frame.name.rsplit(" ", 1)[1])


def _open(path: Path) -> Any:
    refuse_irregular(path)
    os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")  # what it says, nobody could act on
    try:
        import cv2

        video = cv2.VideoCapture(str(path))
    except (ImportError, AttributeError):
        raise FileError("a video; here single frames of it are read only, as pictures") from None
    if not video.isOpened():
        raise FileError("not a video that OpenCV can read; save single frames of it")
    return video


def _rate_and_length(path: Path) -> tuple[float, int]:
    """Return frames per second, and how many there probably are."""
    import cv2

    video = _open(path)
    low, usual, high = _FPS
    fps, n = video.get(cv2.CAP_PROP_FPS), video.get(cv2.CAP_PROP_FRAME_COUNT)
    video.release()
    return fps if low <= fps <= high else usual, int(max(n, 0))


def _read(
    path: Path, numbers: set[int] | None = None
) -> Iterator[tuple[int, npt.NDArray[np.uint8]]]:
    """Read the grey frames of a video with their numbers, all of them or some."""
    import cv2

    video, number = _open(path), 0
    last = None if numbers is None else max(numbers)
    try:
        while (last is None or number <= last) and video.grab():
            if numbers is None or number in numbers:
                there, frame = video.retrieve()
                if there:
                    yield (
                        number,
                        frame if frame.ndim == 2 else cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY),
                    )
            number += 1
    finally:
        video.release()


def _best(
    chunk: list[tuple[int, npt.NDArray[np.uint8]]], before: Array | None
) -> tuple[_Candidate, Array]:
    """Return the best frame of some that follow each other, and the last one's small copy."""
    import cv2

    small = [_small(grey) for _, grey in chunk]
    others = [small[0] if before is None else before, *small]
    motion = np.array([np.abs(b - a).mean() for a, b in zip(others, small, strict=False)])
    if before is None and len(motion) > 1:
        motion[0] = motion[1]
    stillest = np.argsort(motion, kind="stable")[: max(1, len(chunk) // 3)]
    sharpness = [cv2.Laplacian(chunk[i][1], cv2.CV_16S).var() for i in stillest]
    i = int(stillest[int(np.argmax(sharpness))])
    return _Candidate(chunk[i][0], small[i], float(motion[i])), small[-1]


def _small(grey: npt.NDArray[np.uint8]) -> Array:
    import cv2

    height, width = grey.shape
    size = (_SMALL, max(1, round(_SMALL * height / width)))
    copy: Array = cv2.resize(grey, size, interpolation=cv2.INTER_AREA).astype(np.float32)
    return copy


def _still(candidates: list[_Candidate]) -> list[_Candidate]:
    """Keep those that move as little as the stillest do, or a little more."""
    usual = float(np.quantile([c.motion for c in candidates], 0.25))
    return [c for c in candidates if c.motion <= _MOVING * usual + 0.5]


def _different(candidates: list[_Candidate]) -> list[_Candidate]:
    """Take from the stillest on always the one that differs most from all that are taken."""
    small = np.array([c.small for c in candidates])
    i = int(np.argmin([c.motion for c in candidates]))
    taken, nearest = [i], np.abs(small - small[i]).mean((1, 2))
    while len(taken) < MOST_FRAMES and nearest.max() > _DIFFERENT:
        i = int(nearest.argmax())
        taken.append(i)
        nearest = np.minimum(nearest, np.abs(small - small[i]).mean((1, 2)))
    return [candidates[i] for i in taken]
