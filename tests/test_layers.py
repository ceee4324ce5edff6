"""The design of the package: who may import whom, and what an import costs."""

import ast
import importlib.util
import os
import re
import subprocess
import sys
import warnings
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import numpy as np
import pytest

from cvnotes.calibration import calibrate
from cvnotes.camera import Camera, Lens, intrinsics, pose, rotation_from_vector
from cvnotes.pictures import good_views
from cvnotes.show.explorations import NAMES
from cvnotes.show.typeface import font_file
from cvnotes.targets import Chessboard

pytestmark = pytest.mark.once

PACKAGE = Path(__file__).resolve().parents[1] / "cvnotes"

_spec = importlib.util.spec_from_file_location("draw_house", PACKAGE.parent / "tools/draw_house.py")
draw_house = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(draw_house)
# A wing imports only from the floors below its own, and those on one floor do not know each other.
# Inside a wing nothing goes round in a circle.
WINGS = [[wing for wing, _ in floor] for floor in draw_house.FLOORS] + [["__main__"]]
FLOOR = {wing: i for i, floor in enumerate(WINGS) for wing in floor}
# Where each heavy library may be used; elsewhere it would slow down the geometry.
ONLY_IN = {
    "cv2": {
        "files.decoding",
        "files.video",
        "pictures.exposure",
        "targets.harris_corners",
        "targets.markers",
        "targets.saddle_points",
        "warping",
    },
    "matplotlib": {"show"},
    "ipywidgets": {"show.explorations"},
    "trimesh": {"show.space.viewer"},
    "jupyter_server": {"commands.lab"},
}
FILES = sorted(PACKAGE.rglob("*.py"))


def _name(path):
    return ".".join(path.relative_to(PACKAGE).with_suffix("").parts).removesuffix(".__init__")


@cache
def _nodes(path):
    return tuple(ast.walk(ast.parse(path.read_text())))


@cache
def _imports(path):
    """All that a module imports, inside functions too, except for type checkers only."""
    return tuple(_imported(path))


def _imported(path):
    skipped = {
        id(child)
        for node in _nodes(path)
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        for child in ast.walk(node)
    }
    for node in _nodes(path):
        if id(node) in skipped:
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            submodules = [f"{base}.{alias.name}" for alias in node.names]
            known = [s for s in submodules if _is_module(s)]
            yield from known or [base]


@cache
def _is_module(dotted):
    path = PACKAGE.parent / Path(*dotted.split("."))
    return path.with_suffix(".py").exists() or (path / "__init__.py").exists()


def _ours(path):
    """The modules of ours that one imports, as dotted names below the package."""
    return {i.removeprefix("cvnotes.") for i in _imports(path) if i.startswith("cvnotes.")}


def test_at_most_fifteen_rooms_open_on_the_corridor():
    rooms = {path.relative_to(PACKAGE).parts[0] for path in FILES}
    assert rooms == {"__init__.py", "__main__.py"} | set(FLOOR) - {"__main__"}
    assert len(set(FLOOR) - {"__main__"}) <= 15


def test_the_page_of_the_house_shows_the_floors_that_are_held_here():
    page = (PACKAGE.parent / "docs/house.md").read_text()
    table = page.split("| wing | |")[1].split("\n\n")[0]
    assert set(re.findall(r"^\| `(\w+)` \|", table, re.M)) == set(FLOOR) - {"__main__"}
    assert f"![{draw_house.in_words()}]" in page
    assert draw_house.OUT.read_text() == draw_house.plan(), "python tools/draw_house.py"


def test_the_tutor_knows_nothing_of_the_course():
    leaning = {i.split(".")[0] for p in (PACKAGE / "tutor").rglob("*.py") for i in _ours(p)}
    assert leaning == {"base", "tutor"}


def test_a_wing_imports_only_from_wings_below_it():
    upwards = []
    for path in FILES:
        own = _name(path).split(".")[0]
        for imported in _ours(path):
            other = imported.split(".")[0]
            if other != own and FLOOR[other] >= FLOOR.get(own, -1):
                upwards.append(f"{_name(path)} imports {imported}")
    assert not upwards


def test_inside_a_wing_nothing_goes_round_in_a_circle():
    # A face hands on what the modules define; it is no step of a way.
    modules = {_name(path): path for path in FILES if path.name != "__init__.py"}
    order = TopologicalSorter({name: _ours(path) & set(modules) for name, path in modules.items()})
    order.prepare()  # raises CycleError, which names the circle


def test_heavy_libraries_are_used_only_where_they_belong():
    elsewhere = []
    for path in FILES:
        name = _name(path)
        for library in {imported.split(".")[0] for imported in _imports(path)} & ONLY_IN.keys():
            if not any(f"{name}.".startswith(f"{place}.") for place in ONLY_IN[library]):
                elsewhere.append(f"{name} uses {library}")
    assert not elsewhere


def test_learning_does_not_draw():
    drawing = [
        _name(path)
        for path in (PACKAGE / "learn").rglob("*.py")
        if any(f"{i}.".startswith("show.") for i in _ours(path))
    ]
    assert not drawing


def test_importing_the_geometry_loads_numpy_only():
    script = (
        "import sys, numpy; before = set(sys.modules)\n"
        "import cvnotes, cvnotes.calibration, cvnotes.stereo, cvnotes.camera\n"
        "cvnotes.camera.Lens((-0.1, 0.1))\n"
        "heavy = {'scipy', 'cv2', 'matplotlib', 'trimesh', 'ipywidgets', 'PIL', 'yaml', 'tqdm'}\n"
        "loaded = set(sys.modules) - before\n"
        "heavy |= {'numpy.polynomial', 'cvnotes.files', 'html', 'json', 'pathlib'} - before\n"
        "heavy |= {'numpy.ma'} - before\n"
        "print(sorted(heavy & (loaded | {m.split('.')[0] for m in loaded})))"
    )
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


def test_explorations_and_exercises_need_nothing_but_numpy_and_pillow():
    # A page that runs them in the browser fetches each library over the network, and of the
    # course's photographs one.
    script = (
        "import importlib.abc, sys\n"
        "class Absent(importlib.abc.MetaPathFinder):\n"
        "    def find_spec(self, name, path, target=None):\n"
        "        if name.split('.')[0] in {'scipy', 'cv2', 'matplotlib', 'trimesh', 'ipywidgets',\n"
        "                                  'mpl_toolkits', 'yaml', 'tqdm', 'IPython'}:\n"
        "            raise ImportError(name)\n"
        "sys.meta_path.insert(0, Absent())\n"
        "import cvnotes.learn\n"
        "from cvnotes.pictures import course\n"
        "course.photos = None\n"
        "from cvnotes.show.explorations import NAMES, model\n"
        "print([model(name).drawing().picture.shape[2] for name in NAMES])"
    )
    named = {**os.environ, "CVNOTES_FONT": str(font_file())}
    run = subprocess.run([sys.executable, "-c", script], env=named, capture_output=True, text=True)
    assert run.stdout.strip() == str([3] * len(NAMES)), run.stderr


def test_nothing_in_the_package_prints_or_seeds_globally():
    for path in FILES:
        if _name(path).startswith("commands") or "__main__" in path.read_text():
            continue  # whoever is run on a command line speaks to it
        for node in _nodes(path):
            if isinstance(node, ast.Call):
                assert ast.unparse(node.func) not in ("print", "np.random.seed"), path.name


def test_places_in_arrays_are_of_the_machines_own_size():
    # `take` refuses int64 where the machine counts in 32 bits, as in a browser.
    found = [
        _name(path)
        for path in FILES
        for node in _nodes(path)
        if isinstance(node, ast.Attribute) and node.attr == "int64"
    ]
    assert not found


def test_one_place_alone_relies_on_numpy_to_refuse_a_singular_matrix():
    # Without flags of floating-point errors it cannot; `solved` looks for its NaN too.
    found = {
        _name(path)
        for path in FILES
        for node in _nodes(path)
        if isinstance(node, ast.ExceptHandler)
        and node.type is not None
        and ast.unparse(node.type) == "np.linalg.LinAlgError"
    }
    assert found == {"base.numerics"}


# To read how `calibrate` computes, one need not open guards, nor what only judges the result.
NO_STEPS = {
    "base/guarded.py",
    "base/guards.py",
    "calibration/reliability.py",
    "calibration/doubts.py",
}
BOARD = Chessboard((9, 6), 25.0)


def _came_by(board_points, m, **options):
    """The (file, function) of ours that one `calibrate` of flat boards comes by."""
    seen = set()

    def look(frame, event, _):
        code = frame.f_code
        if event == "call" and code.co_filename.startswith(f"{PACKAGE}{os.sep}"):
            file = Path(code.co_filename).relative_to(PACKAGE).as_posix()
            seen.add((file, code.co_qualname))

    before = sys.getprofile()
    sys.setprofile(look)
    try:
        with warnings.catch_warnings(action="ignore"):
            calibrate(board_points, m, (640, 480), **options)
    finally:
        sys.setprofile(before)
    guard = ("calibration/board_shape.py", "is_board")
    return {(file, name) for file, name in seen - {guard} if file not in NO_STEPS}


def _corners(camera, poses, rng):
    m = np.array([camera.moved(G).project(BOARD.points) for G in poses])
    return m + rng.normal(0, 0.5, m.shape)


def test_to_read_calibrate_down_to_numpy_one_opens_thirteen_files_and_one_in_reserve():
    rng = np.random.default_rng(1)
    camera = Camera(intrinsics(800, 804, 325, 238), lens=Lens((-0.25, 0.1)))
    few, some, many = (
        _corners(camera, good_views(BOARD, camera, n, rng=rng), rng) for n in (5, 10, 160)
    )
    came_by = _came_by(BOARD.points, some)
    on_the_straight_way = {file for file, _ in came_by}
    # what is in reserve: for parts of boards, for many of them, for small ones in either pose
    came_by |= _came_by([BOARD.points[i:] for i in range(5)], [x[i:] for i, x in enumerate(few)])
    came_by |= _came_by(BOARD.points, many)
    turns = rotation_from_vector(rng.normal(0, 0.4, (4, 3)))
    far = [
        pose(R, [-100 + x, -60 + y, 2500])
        for R, (x, y) in zip(turns, rng.normal(0, 200, (4, 2)), strict=True)
    ]
    came_by |= _came_by(BOARD.points, _corners(camera, far, rng))
    functions = {name for _, name in came_by}
    assert {"Start._homography", "resumed", "flipped_pose", "autocorrelation"} <= functions
    files = {file for file, _ in came_by}
    page = (PACKAGE.parent / "docs/house.md").read_text().split("How to read")[1].split("## ")[0]
    assert files == set(re.findall(r"`((?!tests/)[a-z]+/[a-z_]+\.py)`", page))
    assert files - on_the_straight_way == {"calibration/reserve.py"}
    assert len(on_the_straight_way) == 13
