"""``cvnotes undistort``: photographs as an ideal lens would have taken them."""

import argparse
import warnings
from collections.abc import Iterator
from itertools import chain
from pathlib import Path

from cvnotes.base import CalibrationWarning, CvnotesError, target_size, text_table
from cvnotes.base.writing import check_folder, printable
from cvnotes.camera import Camera
from cvnotes.commands.console import complain, progress, say, shortfall
from cvnotes.commands.drawing import encoded
from cvnotes.commands.target import length
from cvnotes.files import Photo, Rejected, open_photos, read_camera, write_camera, write_whole
from cvnotes.files.ownership import free_name, made_by, marked, numbered, photographs
from cvnotes.files.reasons import OtherSize, Unreadable, unread
from cvnotes.warping.framing import ideal_camera


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describe the command's arguments."""
    parser = subparsers.add_parser(
        "undistort",
        help="take the lens distortion out of photographs",
        description="Take the lens distortion out of photographs, by a backward warp. They are "
        "written as PNG, beside camera.json: the same camera without its lens. No file but this "
        "command's own is ever replaced.",
        epilog="example: cvnotes undistort photos/ --camera result/calibration.json --out flat/",
    )
    add = parser.add_argument
    add("photos", nargs="+", metavar="PHOTO", help="photographs, or folders of photographs")
    add("--camera", type=Path, required=True, metavar="FILE",
        help="calibration.json, or a camera in OpenCV's or ROS's YAML")  # fmt: skip
    add("--out", type=Path, required=True, metavar="FOLDER", help="folder for the results")
    add("--keep-all", action="store_true",
        help="show all that the photographs show, with black around it")  # fmt: skip
    add("--zoom", type=length, default=1.0, metavar="0.8",
        help="how much larger to show things; below 1 more is seen")  # fmt: skip
    add("--size", type=size, metavar="1280x960",
        help="pixels of what is written (default: as the photographs)")  # fmt: skip


def run(args: argparse.Namespace) -> int:
    """Undistort; gives the exit code: 0 done, 3 if only some could be, 1 if none."""
    camera = read_camera(args.camera)
    ideal = ideal_camera(camera, zoom=args.zoom, size=args.size, keep_all=args.keep_all)
    check_folder(args.out)
    files, rejected = photographs(args.photos, size=camera.size, straightened=False)
    written: list[list[str]] = []
    taken: set[str] = set()
    for photo in progress(open_photos(files), total=len(files)):
        if isinstance(photo, Rejected):
            rejected.append(photo)
            continue
        try:
            picture, note = straightened(photo, camera, ideal)
            target = free_name(_names(photo.path), args.out, "undistort", taken)
            write_whole({target: picture})
            written.append([printable(photo.path), printable(target.name), note])
        except CvnotesError as error:
            rejected.append(Rejected(printable(photo.path), Unreadable(str(error))))
    rows = [*written, *([r.file, "–", str(r.reason)] for r in rejected)]
    say(text_table([["photograph", "written as", "note"], *rows]))
    if not written:
        complain("undistort", "no photograph could be undistorted")
        return 1
    names = chain(["camera.json"], numbered("camera-straight", ".json"))
    target = free_name(names, args.out, "undistort", taken)
    write_camera(ideal, target, note=made_by("undistort"))
    say(f"Written to {printable(args.out)}, with {target.name} for them")
    missing = sum(isinstance(r.reason, OtherSize) for r in rejected) + unread(rejected, args.photos)
    return shortfall("undistort", missing, missing + len(written), "were not undistorted")


def straightened(photo: Photo, camera: Camera, ideal: Camera) -> tuple[bytes, str]:
    """Show a photograph as another camera would; gives PNG, oriented as before, and a note."""
    from PIL import Image

    from cvnotes.warping import undistort_image

    exif = Image.Exif()
    if photo.orientation != 1:
        exif[274] = photo.orientation
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", CalibrationWarning)
        image = undistort_image(photo.image, camera, ideal.A, size=ideal.size)
    notes = [photo.note] * bool(photo.note) + [str(warning.message) for warning in caught]
    return marked(encoded(image, exif=exif), "undistort"), "; ".join(notes)


def size(text: str) -> tuple[int, int]:
    """Read a picture's size as ``1280x960``.

    Examples
    --------
    >>> size("1280x960")
    (1280, 960)
    """
    try:
        width, height = map(int, text.lower().replace("×", "x").split("x"))
        return target_size((width, height))
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"expected a size such as 1280x960, got {text!r}"
        ) from None


def _names(path: Path) -> Iterator[str]:
    """Return the names that the result for a photograph may have, the best first."""
    yield f"{path.stem}.png"
    if path.suffix.lower() != ".png":
        yield f"{path.name}.png"
    yield from numbered(f"{path.stem}-straight", ".png")
