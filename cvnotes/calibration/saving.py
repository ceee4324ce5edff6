"""Calibrations as files: the camera, how far it can be trusted, and what it was made of."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cvnotes.base import Array, CvnotesError
from cvnotes.base.writing import PathLike, path_of, printable
from cvnotes.calibration.board_shape import BOARDS, BoardShape
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.camera import Camera
from cvnotes.camera.model import SENSOR
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

FORMAT = "cvnotes calibration"
_ROUNDED = 1e-6  # numbers that agree to so much, whoever rounded them, are the same


def write_calibration(result: Mapping[str, Any], path: PathLike) -> None:
    """Write a calibration as JSON, whole or not at all.

    Parameters
    ----------
    result : mapping
        What to write, from ``Calibration.as_mapping``. Its corners go into the file too, unless
        that would make it larger than `read_calibration` accepts.
    path : path
        Where to; an existing file is replaced.
    """
    write_whole({path_of(path): calibration_json(result).encode()})


def calibration_json(
    result: Mapping[str, Any],
    *,
    files: Sequence[PathLike] = (),
    rejected: Sequence[Rejected] = (),
    note: str = "",
) -> str:
    """Spell a calibration as JSON, with photographs, and a note to whoever opens it."""
    if files and len(files) != len(result["poses"]):
        raise CvnotesError(f"files: expected {len(result['poses'])} names, got {len(files)}")
    names, shape = result["names"], result.get("shape")
    of_views = result.get("_covariance_of_views")
    keys: dict[str, Any] = {
        "format": FORMAT,
        "version": VERSION,
        **({"note": note} if note else {}),
        "reliable": bool(result["reliable"]),
        "converged": bool(result["converged"]),
        "warnings": list(result["warnings"]),
        **camera_to_dict(Camera(result["A"], lens=result["lens"], size=result["size"])),
        "lens": _of_lens(names),
        "rms": float(result["rms"]),
        **_bars(names, result["covariance"]),
    }
    if of_views is not None and np.isfinite(of_views).all():
        keys |= _bars(names, of_views, "_of_views")
    if shape is not None:
        arrays = {"given": shape.given, "points": shape.points, "standard_deviations": shape.std}
        lists = {name: array.tolist() for name, array in arrays.items()}
        keys["board_shape"] = {"kind": shape.kind, **lists}
    keys["rejected"] = [{"file": r.file, "reason": str(r.reason)} for r in rejected]
    given = zip(result["poses"], result["view_rms"], strict=True)
    views: list[dict[str, Any]] = [{"rms": float(rms), **pose_to_dict(G)} for G, rms in given]
    for view, file in zip(views, files, strict=False):
        view["file"] = printable(file)
    text = dump(keys | _with_corners(views, result["_data"]))
    if len(text.encode()) > MAX_BYTES:
        text = dump(keys | {"views": views})
    if (size := len(text.encode())) > MAX_BYTES:
        raise CvnotesError(
            f"a calibration of {len(views)} views and {len(rejected)} photographs that were "
            f"not used takes {size} bytes as a file; at most {MAX_BYTES} are read"
        )
    return text


def _of_lens(names: Sequence[str]) -> str:
    """Name a lens by those of its coefficients that were estimated."""
    return " ".join(name for name in names if name not in SENSOR) or "none"


def _bars(names: Sequence[str], covariance: Array, of: str = "") -> dict[str, Any]:
    """Spell a covariance, and the deviations of its diagonal by name."""
    std = np.sqrt(np.diag(covariance)).tolist()
    return {
        f"standard_deviations{of}": dict(zip(names, std, strict=True)),
        f"covariance{of}": covariance.tolist(),
    }


def _with_corners(views: list[dict[str, Any]], data: Correspondences | None) -> dict[str, Any]:
    """Return each view its corners, and its board unless all views share one."""
    if data is None:
        return {"views": views}
    corners = [{"corners": m.tolist(), "board": W.tolist()} for W, m in data.given()]
    one_board = corners[0]["board"]
    if any(view["board"] != one_board for view in corners):
        return {"views": [a | b for a, b in zip(views, corners, strict=True)]}
    views = [a | {"corners": b["corners"]} for a, b in zip(views, corners, strict=True)]
    return {"board": one_board, "views": views}


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
    lens, said = _of_lens(names), entry.get("lens")
    if said is not None and said.text() != lens:
        raise said.error(f"{said.text()!r}, but what has error bars is {lens}")
    of_views = None
    if entry.get("covariance_of_views") is not None:
        same, of_views = _error_bars(entry, camera, "_of_views")
        if same != names:
            raise entry["standard_deviations_of_views"].error("other parameters than before")
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
        "_covariance_of_views": of_views,
        "shape": _shape(entry.get("board_shape")),
    }


def _shape(entry: Entry | None) -> BoardShape | None:
    """Read the shape of the board, if it was estimated."""
    if entry is None:
        return None
    kind = entry["kind"].text()
    if kind not in BOARDS[1:]:
        raise entry["kind"].error(f"expected one of {', '.join(BOARDS[1:])}, got {kind!r}")
    given = entry["given"].array(None, 3)
    points, std = (entry[key].array(len(given), 3) for key in ("points", "standard_deviations"))
    if std.min(initial=0.0) < 0:
        raise entry["standard_deviations"].error("a standard deviation is not negative")
    return BoardShape(kind, given, points, std)


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


def _error_bars(entry: Entry, camera: Camera, of: str = "") -> tuple[tuple[str, ...], Array]:
    """Read parameters' names and covariance: of this camera, and such as a covariance can be."""
    listed, C = entry["standard_deviations" + of], entry["covariance" + of]
    std = {name: item.number() for name, item in listed.items().items()}
    known = {*camera.parameters, "p1", "p2"}
    for name in std:
        if name not in known:
            count = sum(key[0] == "k" for key in camera.lens.parameters)
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
