"""Calibrations as files: the camera, how far it can be trusted, and what it was made of."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from cvnotes.base import Array, CvnotesError
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.camera import Camera
from cvnotes.files import Rejected, write_whole
from cvnotes.files.cameras import (
    VERSION,
    camera_from_entry,
    camera_to_dict,
    dump,
    pose_from_entry,
    pose_to_dict,
)
from cvnotes.files.entry import Entry
from cvnotes.files.strict import MAX_BYTES, parse_json, read_text
from cvnotes.files.writing import PathLike, printable

FORMAT = "cvnotes calibration"
_ROUNDED = 1e-6  # numbers that agree to so much, whoever rounded them, are the same


class Result(Protocol):
    """What a calibration has to offer to be written: see `cvnotes.calibration.Calibration`."""

    @property
    def camera(self) -> Camera:
        """Sensor, lens and size."""

    @property
    def poses(self) -> Array:
        """CRF ← board, (n_views, 4, 4)."""

    @property
    def rms(self) -> float:
        """Root mean square distance of the corners, per point, in pixels."""

    @property
    def view_rms(self) -> Array:
        """The same for each view, (n_views,)."""

    @property
    def std(self) -> Mapping[str, float]:
        """Standard deviations by parameter name."""

    @property
    def covariance(self) -> Array:
        """Covariance of these parameters, in that order."""

    @property
    def board_points(self) -> Sequence[Array]:
        """The corners on the board, (n_i, 3) for each view, or nothing."""

    @property
    def image_points(self) -> Sequence[Array]:
        """The corners in the pictures, (n_i, 2) for each view, or nothing."""

    @property
    def warnings(self) -> Sequence[str]:
        """What is doubtful."""

    @property
    def reliable(self) -> bool:
        """Whether the views determine the answer."""

    @property
    def converged(self) -> bool:
        """Whether the refinement reached it."""


def write_calibration(
    result: Result,
    path: PathLike,
    *,
    files: Sequence[PathLike] = (),
    rejected: Sequence[Rejected] = (),
) -> None:
    """Write a calibration as JSON, whole or not at all.

    Parameters
    ----------
    result : Calibration
        What to write. Its corners go into the file too, unless that would make it larger than
        `read_calibration` accepts.
    path : path
        Where to; an existing file is replaced.
    files : sequence of paths
        The photograph of each view.
    rejected : sequence of Rejected
        The photographs that were not used, with their reasons.
    """
    text = calibration_json(result, files=files, rejected=rejected)
    write_whole({Path(path): text.encode()})


def calibration_json(
    result: Result,
    *,
    files: Sequence[PathLike] = (),
    rejected: Sequence[Rejected] = (),
    note: str = "",
) -> str:
    """Spell a calibration as JSON, with a note for whoever opens it; see `write_calibration`."""
    if files and len(files) != len(result.poses):
        raise CvnotesError(f"files: expected {len(result.poses)} names, got {len(files)}")
    keys = {
        "format": FORMAT,
        "version": VERSION,
        **({"note": note} if note else {}),
        "reliable": bool(result.reliable),
        "converged": bool(result.converged),
        "warnings": list(result.warnings),
        **camera_to_dict(result.camera),
        "lens": " ".join(name for name in result.std if name[0] in "kp") or "none",
        "rms": float(result.rms),
        "standard_deviations": dict(result.std),
        "covariance": result.covariance.tolist(),
        "rejected": [{"file": r.file, "reason": r.reason} for r in rejected],
    }
    text = dump(keys | _views(result, files, with_corners=bool(result.image_points)))
    if len(text.encode()) > MAX_BYTES:
        text = dump(keys | _views(result, files, with_corners=False))
    if (size := len(text.encode())) > MAX_BYTES:
        raise CvnotesError(
            f"a calibration of {len(result.poses)} views and {len(rejected)} photographs that were "
            f"not used takes {size} bytes as a file; at most {MAX_BYTES} are read"
        )
    return text


def _views(result: Result, files: Sequence[PathLike], *, with_corners: bool) -> dict[str, Any]:
    """Give what belongs to each view, and the board if all views share it."""
    views: list[dict[str, Any]] = []
    for G, rms in zip(result.poses, result.view_rms, strict=True):
        views.append({"rms": float(rms), **pose_to_dict(G)})
    for view, file in zip(views, files, strict=False):
        view["file"] = printable(file)
    if not with_corners:
        return {"views": views}
    boards = result.board_points
    for view, corners, board in zip(views, result.image_points, boards, strict=True):
        view["corners"], view["board"] = corners.tolist(), board.tolist()
    if any(not np.array_equal(boards[0], board) for board in boards):
        return {"views": views}
    for view in views:
        del view["board"]
    return {"board": boards[0].tolist(), "views": views}


def read_calibration(path: PathLike) -> dict[str, Any]:
    """Read a calibration's JSON as the arguments that make a Calibration.

    Raises
    ------
    FileError
        The file is no calibration; the message names the key or the position.
    """
    entry = parse_json(read_text(path), printable(path))
    camera = camera_from_entry(entry)
    views = list(entry["views"])
    if not views:
        raise entry.error("the list of views is empty")
    rms, view_rms = _rms(entry, views)
    names, covariance = _error_bars(entry, camera)
    return {
        "A": camera.A,
        "lens": camera.lens,
        "size": camera.size,
        "poses": np.stack([pose_from_entry(view) for view in views]),
        "rms": rms,
        "view_rms": view_rms,
        "names": names,
        "covariance": covariance,
        "warnings": tuple(item.text() for item in entry["warnings"]),
        "reliable": entry["reliable"].flag(),
        "converged": entry["converged"].flag(),
        "_data": _corners(entry, views),
    }


def _rms(entry: Entry, views: list[Entry]) -> tuple[float, Array]:
    """Read the RMS of all views together, which lies between those of single ones."""
    rms, each = entry["rms"].number(), np.array([view["rms"].number() for view in views])
    if each.min() < 0:
        raise views[int(each.argmin())]["rms"].error(f"an RMS is not negative, got {each.min():g}")
    if not each.min() * (1 - _ROUNDED) <= rms <= each.max() * (1 + _ROUNDED):
        raise entry["rms"].error(
            f"{rms:g} does not lie between the smallest ({each.min():g}) and the largest "
            f"({each.max():g}) of the views, so one of them was changed"
        )
    return rms, each


def _error_bars(entry: Entry, camera: Camera) -> tuple[tuple[str, ...], Array]:
    """Read parameters' names and covariance: of this camera, and such as a covariance can be."""
    listed, C = entry["standard_deviations"], entry["covariance"]
    std = {name: item.number() for name, item in listed.items().items()}
    known = ("alpha_u", "alpha_v", "skew", "u0", "v0", "p1", "p2")
    known += tuple(f"k{i}" for i in range(1, len(camera.lens.k) + 1))
    for name in std:
        if name not in known:
            count = len(camera.lens.k)
            few = f"; the lens has {count or 'no'} radial coefficients" if name[:1] == "k" else ""
            raise listed.error(f"{name!r} is no parameter of this camera{few}")
    covariance = C.array(len(std), len(std))
    variance = np.diag(covariance)
    if (variance < 0).any():
        name = list(std)[int(variance.argmin())]
        raise C.error(f"the variance of {name} is negative: {variance.min():g}")
    if not np.allclose(np.sqrt(variance), list(std.values()), rtol=_ROUNDED, atol=0):
        raise listed.error("they are not the roots of the covariance's diagonal")
    scale = np.sqrt(np.outer(variance, variance)) * (1 + _ROUNDED)
    if (np.abs(covariance) > scale).any():
        raise C.error("a covariance is larger than both variances allow")
    if (np.abs(covariance - covariance.T) > scale * _ROUNDED).any():
        raise C.error("it is not symmetric")
    return tuple(std), covariance


def _corners(entry: Entry, views: list[Entry]) -> Correspondences | None:
    """Read the corners of all views, or none at all."""
    one_board = entry.get("board")
    image_points, board_points = [], []
    for view in views:
        corners = view.get("corners")
        if corners is None:
            return None
        image_points.append(corners.array(None, 2))
        board_points.append((one_board or view["board"]).array(len(image_points[-1]), 3))
    try:
        return Correspondences.of(board_points, image_points, flat=False)
    except CvnotesError as error:
        raise entry.error(str(error)) from error
