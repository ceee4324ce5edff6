"""Cameras as files: our JSON, OpenCV's YAML, ROS's YAML."""

import json
from dataclasses import Field, fields
from typing import Any, cast

import numpy as np

from cvnotes.base import CvnotesError, FileError, intrinsic_matrix
from cvnotes.base.writing import PathLike, path_of, printable, write_whole
from cvnotes.camera import AnyLens, Camera, Lens, pose
from cvnotes.camera.any_lens import MODELS
from cvnotes.files.entry import Entry
from cvnotes.files.exchange import CameraInfo, camera_info, opencv_yaml
from cvnotes.files.strict import MAX_YAML_BYTES, parse_json, parse_yaml, read_text

FORMAT, RIG = "cvnotes camera", "cvnotes rig"
VERSION = 1


def write_camera(camera: Camera, path: PathLike, *, note: str = "") -> None:
    """Write a camera, whole or not at all: ``.json`` is ours, ``.yml`` or ``.yaml`` OpenCV's.

    OpenCV's form holds sensor, lens and size but no pose. A note for whoever opens the file goes
    to its beginning.

    Examples
    --------
    >>> import tempfile
    >>> from cvnotes.camera import intrinsics
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_camera(Camera(intrinsics(800, 805, 320, 240)), f"{folder}/camera.json")
    ...     read_camera(f"{folder}/camera.json").A[1, 1]
    np.float64(805.0)
    """
    if _is_yaml(path):
        text = opencv_yaml(camera, note=note)
    else:
        remark = {"note": note} if note else {}
        text = dump({"format": FORMAT, "version": VERSION, **remark, **camera_to_dict(camera)})
    write_whole({path_of(path): text.encode()})


def read_camera(path: PathLike) -> Camera:
    """Read a camera: our JSON (also a whole calibration), OpenCV's YAML or ROS's.

    Nothing in the file is executed. OpenCV's and ROS's cameras stand in the world's origin.

    Raises
    ------
    FileError
        The file does not describe a camera; the message names the key or the line.
    """
    if _is_yaml(path):
        return read_camera_info(path).camera
    return camera_from_entry(parse_json(read_text(path), printable(path)))


def read_camera_info(path: PathLike) -> CameraInfo:
    """Read the ``camera_info`` YAML of ROS, or OpenCV's.

    Raises
    ------
    FileError
        The file does not describe a camera; the message names the key or the line.
    """
    return camera_info(parse_yaml(read_text(path, MAX_YAML_BYTES), printable(path)))


def read_rig(path: PathLike) -> tuple[Camera, Camera]:
    """Read the two cameras of a ``rig.json``; the WRF is the left camera's frame.

    Raises
    ------
    FileError
        The file does not describe a rig; the message names the key or the position.

    Examples
    --------
    >>> left, right = read_rig("rig/rig.json")
    Traceback (most recent call last):
    cvnotes.base.errors.FileError: rig/rig.json: there is no such file, or it is not a regular one
    """
    entry: Any = parse_json(read_text(path), printable(path))
    form = entry["format"]
    if form.text() != RIG:
        raise form.error(f"expected a {RIG!r}, got {form.text()!r:.40}")
    left, right = (camera_from_entry(entry[side]) for side in ("left", "right"))
    return left, right


def camera_to_dict(camera: Camera) -> dict[str, Any]:
    """Return a camera as plain values under the keys of our JSON.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> camera_to_dict(Camera(intrinsics(800, 800, 320, 240)))["image_size"]
    [640, 480]
    """
    keys: dict[str, Any] = {
        "image_size": list(camera.size),
        "camera_matrix": camera.A.tolist(),
        "distortion": _lens_to_dict(camera.lens),
    }
    if not np.array_equal(camera.G, np.eye(4)):
        keys["pose"] = pose_to_dict(camera.G)
    return keys


def camera_from_entry(entry: Entry) -> Camera:
    """Make a camera of the keys of our JSON; others are left to whoever knows them."""
    check_version(entry)
    size = (entry["image_size"].array(2)).tolist()
    A = entry["camera_matrix"].array(3, 3)
    where = entry.get("pose")
    try:
        lens = _lens_from_entry(entry["distortion"])
        G = np.eye(4) if where is None else pose_from_entry(where)
        return Camera(intrinsic_matrix(A, "camera_matrix"), G, lens, size)
    except FileError:
        raise
    except CvnotesError as error:
        raise entry.error(str(error)) from error


def _lens_to_dict(lens: AnyLens) -> dict[str, Any]:
    """Spell a lens as its model, unless that is the polynomial, and the fields of its class."""
    keys: dict[str, Any] = {} if lens.model == Lens.model else {"model": lens.model}
    for f in fields(cast(Any, lens)):
        value = getattr(lens, f.name)
        if f.name not in lens.seldom or value != f.default:
            keys[f.name] = list(value) if isinstance(value, tuple) else value
    return keys


def _lens_from_entry(entry: Entry) -> AnyLens:
    """Make the lens that `_lens_to_dict` spelt."""
    model = entry.get("model")
    name = Lens.model if model is None else model.text()
    if model is not None and name not in MODELS:
        *some, last = MODELS
        raise model.error(f"expected {', '.join(some)} or {last}, got {name!r:.40}")
    lens = MODELS[name]
    given = [f for f in fields(cast(Any, lens)) if f.name not in lens.seldom or entry.get(f.name)]
    return lens(**{f.name: _coefficients(entry[f.name], f) for f in given})


def _coefficients(entry: Entry, f: "Field[Any]") -> Any:
    """Read the number or the numbers of a field; of the radial ones there may be fewer."""
    if not isinstance(f.default, tuple):
        return entry.number()
    return tuple(entry.array(None if f.name == "k" else len(f.default)))


def pose_to_dict(G: Any) -> dict[str, Any]:
    """Return a rigid motion as R and T."""
    G = np.asarray(G)
    return {"R": G[:3, :3].tolist(), "T": G[:3, 3].tolist()}


def pose_from_entry(entry: Entry) -> Any:
    """Make the rigid motion G (4, 4) of R and T."""
    try:
        return pose(entry["R"].array(3, 3), entry["T"].array(3))
    except FileError:
        raise
    except CvnotesError as error:
        raise entry.error(str(error)) from error


def check_version(entry: Entry) -> None:
    """Refuse a JSON file that says it is something else, or something newer."""
    form, version = entry.get("format"), entry.get("version")
    if form is not None and not form.text().startswith("cvnotes "):
        raise form.error(f"expected a cvnotes camera or calibration, got {form.text()!r:.40}")
    if version is not None and version.whole() != VERSION:
        raise version.error(
            f"this cvnotes reads version {VERSION}, the file has {version.whole()}; "
            "install the cvnotes that wrote it"
        )


def dump(keys: dict[str, Any]) -> str:
    """Lay out JSON for the eye: a key per line, a small matrix a row per line."""
    return _lay_out(keys, "") + "\n"


def _lay_out(value: Any, indent: str) -> str:
    inner = indent + "  "
    if isinstance(value, dict) and value:
        lines = [f"{json.dumps(k)}: {_lay_out(v, inner)}" for k, v in value.items()]
        return "{\n" + ",\n".join(inner + line for line in lines) + f"\n{indent}}}"
    nested = isinstance(value, list) and any(isinstance(v, dict | list) for v in value)
    if nested and (len(value) <= 12 or any(isinstance(v, dict) for v in value)):
        lines = [_lay_out(v, inner) for v in value]
        return "[\n" + ",\n".join(inner + line for line in lines) + f"\n{indent}]"
    return json.dumps(value, allow_nan=False)


def _is_yaml(path: PathLike) -> bool:
    suffix = path_of(path).suffix.lower()
    if suffix not in (".json", ".yml", ".yaml"):
        raise FileError(f"{printable(path)}: a camera's file ends in .json, .yml or .yaml")
    return suffix != ".json"
