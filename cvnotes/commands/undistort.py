"""``cvnotes undistort``: photographs as an ideal lens would have taken them."""

import argparse
import io
import warnings
from collections.abc import Mapping
from pathlib import Path

from cvnotes.base import CalibrationWarning, CvnotesError, FileError, text_table
from cvnotes.camera import Camera
from cvnotes.commands.console import complain, progress, say
from cvnotes.files import (
    Photo,
    Rejected,
    list_photos,
    open_photos,
    read_camera,
    write_camera,
    write_whole,
)
from cvnotes.files.writing import check_folder, printable


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describe the command's arguments."""
    parser = subparsers.add_parser(
        "undistort",
        help="take the lens distortion out of photographs",
        description="Take the lens distortion out of photographs, by a backward warp. They are "
        "written as PNG, beside camera.json: the same camera without its lens.",
        epilog="example: cvnotes undistort photos/ --camera result/calibration.json --out flat/",
    )
    add = parser.add_argument
    add("photos", nargs="+", metavar="PHOTO", help="photographs, or folders of photographs")
    add("--camera", type=Path, required=True, metavar="FILE",
        help="calibration.json, or a camera in OpenCV's or ROS's YAML")  # fmt: skip
    add("--out", type=Path, required=True, metavar="FOLDER", help="folder for the results")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Undistort; gives the exit code: 0 if any photograph could be, else 1."""
    camera = read_camera(args.camera)
    check_folder(args.out)
    files, rejected = list_photos(args.photos, size=camera.size)
    written: dict[Path, list[str]] = {}
    for photo in progress(open_photos(files), total=len(files)):
        if isinstance(photo, Rejected):
            rejected.append(photo)
            continue
        try:
            target = _target(photo.path, args.out, written)
            picture, note = straightened(photo, camera)
            write_whole({target: picture})
            written[target] = [printable(photo.path), printable(target.name), note]
        except CvnotesError as error:
            rejected.append(Rejected(printable(photo.path), str(error)))
    rows = [*written.values(), *([r.file, "–", r.reason] for r in rejected)]
    say(text_table([["photograph", "written as", "note"], *rows]))
    if not written:
        complain("undistort", "no photograph could be undistorted")
        return 1
    write_camera(Camera(camera.A, size=camera.size), args.out / "camera.json")
    say(f"Written to {printable(args.out)}, with camera.json for them")
    return 0


def straightened(photo: Photo, camera: Camera) -> tuple[bytes, str]:
    """Undistort one photograph; gives it as PNG, with its EXIF orientation, and a note."""
    from PIL import Image

    from cvnotes.warping import undistort_image

    encoded, exif = io.BytesIO(), Image.Exif()
    if photo.orientation != 1:
        exif[274] = photo.orientation
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", CalibrationWarning)
        image = undistort_image(photo.image, camera)
    Image.fromarray(image).save(encoded, "PNG", exif=exif)
    notes = [photo.note] * bool(photo.note) + [str(warning.message) for warning in caught]
    return encoded.getvalue(), "; ".join(notes)


def _target(path: Path, out: Path, taken: Mapping[Path, object]) -> Path:
    """Name the result after its photograph, without ever replacing one."""
    target = out / f"{path.stem}.png"
    if target in taken:
        target = out / f"{path.name}.png"
    if target.exists() and target.samefile(path):
        raise FileError("the result would replace the photograph itself; choose another --out")
    return target
