"""Make the files of data/ again, byte for byte.

    python tools/make_data.py              make them
    python tools/make_data.py --check      only tell which differ

The corners in real photographs are measured again only where the photographs are found
(--photographs FOLDER); without them the committed numbers stay.
"""

import argparse
import io
import json
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from cvnotes.camera import Camera, Lens, intrinsics
from cvnotes.files import read_photo, write_camera, write_whole
from cvnotes.learn import personal_camera
from cvnotes.pictures import good_views, render, scenes
from cvnotes.show import build_scene, export_glb, scene_shapes
from cvnotes.targets import Chessboard, find_corners

ROOT = Path(__file__).resolve().parents[1]
CAMERA = Camera(
    intrinsics(alpha_u=800, alpha_v=804, u0=325, v0=238),
    lens=Lens(k=(-0.25, 0.10)),
    size=(640, 480),
)
BOARD = Chessboard(corners=(9, 6), square=25.0)
N_VIEWS, BLUR, NOISE = 12, 0.7, 2.0
# Pairs of the example photographs of Debian's package opencv-doc; 10 does not exist.
PAIRS = ("01", "02", "03", "04", "05", "06", "07", "08", "09", "11", "12", "13", "14")


def text(value: Any) -> bytes:
    return (json.dumps(value, indent=1) + "\n").encode()


def rounded(x: Any, digits: int) -> Any:
    return np.asarray(x).round(digits).tolist()


def png(image: Any) -> bytes:
    stream = io.BytesIO()
    Image.fromarray(image).save(stream, "PNG", optimize=True)
    return stream.getvalue()


def views() -> dict[str, bytes]:
    """The twelve pictures, their poses, and their corners, true and measured."""
    rng = np.random.default_rng(2026)
    # Later digits depend on the machine; 1e-12 of a rotation moves no corner by 1e-9 px.
    poses = good_views(BOARD, CAMERA, N_VIEWS, rng=rng).round(12)
    poses[:, :3, 3] = poses[:, :3, 3].round(9)  # mm, of hundreds
    cameras = [CAMERA.moved(G) for G in poses]
    photos = [render(BOARD, c, blur=BLUR, noise=NOISE, rng=rng) for c in cameras]
    files = {f"views/view_{i:02d}.png": png(photo) for i, photo in enumerate(photos)}
    files["views.json"] = text(
        {
            "about": f"poses, CRF <- board (mm); corners in px; blur {BLUR} px, noise {NOISE} grey",
            "poses": [G.tolist() for G in poses],
            "exact_corners": [rounded(c.project(BOARD.points), 9) for c in cameras],
            "measured_corners": [rounded(find_corners(photo, BOARD), 3) for photo in photos],
        }
    )
    return files


def first_corners() -> dict[str, bytes]:
    """The corners of chapter 0's twelve photographs, by its own cells."""
    chapter = json.loads((ROOT / "notebooks" / "00_start_here.ipynb").read_text(encoding="utf-8"))
    names: dict[str, Any] = {}
    for cell in [c for c in chapter["cells"] if c["cell_type"] == "code"]:
        if "corners" not in names:
            exec("".join(cell["source"]), names)
    about = "corners in px that find_corners finds in the twelve photographs of chapter 0"
    return {"first_corners.json": text({"about": about, "corners": rounded(names["corners"], 3)})}


def meshes() -> dict[str, bytes]:
    """The rooms and rails of chapters 1 and 2, as GLB files that any 3-D viewer opens."""
    files = {}
    with tempfile.TemporaryDirectory() as folder:
        for scene in (scenes.rails, scenes.blocks, scenes.corridor, scenes.room):
            path = Path(folder) / f"{scene.__name__}.glb"
            export_glb(build_scene(*scene_shapes(scene()), view=None), path)
            files[f"meshes/{path.name}"] = path.read_bytes()
    return files


def personal() -> dict[str, bytes]:
    """The cameras of a few ids, so that a test can hold them over versions and systems."""
    people = {
        student: rounded(personal_camera(student).truth().A[[0, 1, 0, 1], [0, 1, 2, 2]], 9)
        for student in ("ada", "grace", "emmy")
    }
    return {"personal.json": text({"about": "alpha_u, alpha_v, u0, v0 (px) by id", **people})}


def real_corners(folder: Path) -> dict[str, bytes]:
    """What `find_corners` measures in the real photographs."""
    board = Chessboard((9, 6), 30.0)
    measured = {
        side: [
            rounded(find_corners(read_photo(folder / f"{side}{n}.jpg").image, board), 3)
            for n in PAIRS
        ]
        for side in ("left", "right")
    }
    about = (
        "corners in px that cvnotes.targets.find_corners measures in the stereo example "
        "photographs of OpenCV (Debian package opencv-doc), 640x480, squares of 30 mm"
    )
    values = {"about": about, "corners": [9, 6], "square": 30.0, "size": [640, 480]}
    return {"real_corners.json": text({**values, "names": PAIRS, **measured})}


def same(path: Path, data: bytes) -> bool:
    """Compare bytes, and pixels where compression may differ between versions of zlib."""
    if not path.exists():
        return False
    old = path.read_bytes()
    if path.suffix == ".png" and old != data:
        before, after = (np.asarray(Image.open(io.BytesIO(x))) for x in (old, data))
        return bool(np.array_equal(before, after))
    return old == data


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--check", action="store_true", help="write nothing")
    parser.add_argument("--photographs", type=Path, help="folder with left01.jpg … right14.jpg")
    arguments = parser.parse_args()
    files = views() | first_corners() | meshes() | personal()
    if arguments.photographs:
        files |= real_corners(arguments.photographs)
    if not arguments.check:
        for folder in ("views", "meshes"):
            (ROOT / "data" / folder).mkdir(parents=True, exist_ok=True)
        write_camera(CAMERA, ROOT / "data" / "camera.json")
        write_whole({ROOT / "data" / name: data for name, data in files.items()})
    different = [name for name, data in files.items() if not same(ROOT / "data" / name, data)]
    print("\n".join([f"{name} differs" for name in different] or ["all as made"]))
    return bool(different)


if __name__ == "__main__":
    sys.exit(main())
