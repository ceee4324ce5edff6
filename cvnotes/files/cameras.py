"""Cameras as files: our JSON, OpenCV's YAML, ROS's YAML."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from cvnotes.base import CvnotesError, FileError, intrinsic_matrix
from cvnotes.camera import Camera, FisheyeLens, Lens, RationalLens, pose
from cvnotes.camera.model import AnyLens
from cvnotes.files.entry import Entry
from cvnotes.files.exchange import CameraInfo, camera_info, opencv_yaml, ros_yaml
from cvnotes.files.strict import MAX_YAML_BYTES, parse_json, parse_yaml, read_text
from cvnotes.files.writing import PathLike, printable, write_whole

FORMAT = "cvnotes camera"
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
    write_whole({Path(path): text.encode()})


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


def write_camera_info(info: CameraInfo, path: PathLike) -> None:
    """Write a camera as the ``camera_info`` YAML of ROS, whole or not at all."""
    write_whole({Path(path): ros_yaml(info).encode()})


def read_camera_info(path: PathLike) -> CameraInfo:
    """Read the ``camera_info`` YAML of ROS, or OpenCV's.

    Raises
    ------
    FileError
        The file does not describe a camera; the message names the key or the line.
    """
    return camera_info(parse_yaml(read_text(path, MAX_YAML_BYTES), printable(path)))


def camera_to_dict(camera: Camera) -> dict[str, Any]:
    """Give a camera as plain values under the keys of our JSON.

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
    """Spell a lens as its model, unless that is the polynomial, and its coefficients."""
    match lens:
        case FisheyeLens():
            return {"model": "equidistant", "k": list(lens.k)}
        case RationalLens():
            keys = {"k": lens.k, "p": lens.p, "s": lens.s, "tilt": lens.tilt}
            return {"model": "rational", **{name: list(values) for name, values in keys.items()}}
    centre = {"centre": list(lens.centre)} if any(lens.centre) else {}
    return {"k": list(lens.k), "p": list(lens.p), **centre}


def _lens_from_entry(entry: Entry) -> AnyLens:
    """Make the lens that `_lens_to_dict` spelt."""
    model, k = entry.get("model"), tuple(entry["k"].array(None))
    name = "polynomial" if model is None else model.text()
    if name == "equidistant":
        return FisheyeLens(k)
    p = tuple(entry["p"].array(2))
    if name == "rational":
        return RationalLens(k, p, tuple(entry["s"].array(4)), tuple(entry["tilt"].array(2)))
    if model is not None and name != "polynomial":
        raise model.error(f"expected polynomial, rational or equidistant, got {name!r:.40}")
    centre = entry.get("centre")
    return Lens(k, p, (0.0, 0.0) if centre is None else tuple(centre.array(2)))


def pose_to_dict(G: Any) -> dict[str, Any]:
    """Give a rigid motion as R and T."""
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
    suffix = Path(path).suffix.lower()
    if suffix not in (".json", ".yml", ".yaml"):
        raise FileError(f"{printable(path)}: a camera's file ends in .json, .yml or .yaml")
    return suffix != ".json"
