"""The design of the package: who may import whom, and what an import costs."""

import ast
import os
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

from cvnotes.show.explore.lettering import font_file

PACKAGE = Path(__file__).resolve().parents[1] / "cvnotes"

# A wing is a chapter. It imports only from wings above it in this list, and those that share a
# line do not know each other. Inside a wing nothing goes round in a circle.
WINGS = [
    ["base"],
    ["projective"],
    ["camera", "homography"],
    ["targets", "warping", "files"],
    ["calibration", "pictures"],
    ["stereo"],
    ["show", "learn"],
    ["commands"],
    ["__main__"],
]
FLOOR = {wing: i for i, floor in enumerate(WINGS) for wing in floor}
# Where each heavy library may be used; elsewhere it would slow down the geometry.
ONLY_IN = {
    "cv2": {
        "files.decoding",
        "pictures.exposure",
        "targets.finding",
        "targets.opencv_finders",
        "warping",
    },
    "matplotlib": {"show"},
    "ipywidgets": {"show.explore"},
    "trimesh": {"show.space.viewer"},
    "jupyter_server": {"commands.lab"},
}
FILES = sorted(PACKAGE.rglob("*.py"))


def _name(path):
    return ".".join(path.relative_to(PACKAGE).with_suffix("").parts).removesuffix(".__init__")


def _imports(path):
    """All that a module imports, inside functions too, except for type checkers only."""
    tree = ast.parse(path.read_text())
    skipped = {
        id(child)
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        for child in ast.walk(node)
    }
    for node in ast.walk(tree):
        if id(node) in skipped:
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            submodules = [f"{base}.{alias.name}" for alias in node.names]
            known = [s for s in submodules if _is_module(s)]
            yield from known or [base]


def _is_module(dotted):
    path = PACKAGE.parent / Path(*dotted.split("."))
    return path.with_suffix(".py").exists() or (path / "__init__.py").exists()


def _ours(path):
    """The modules of ours that one imports, as dotted names below the package."""
    return {i.removeprefix("cvnotes.") for i in _imports(path) if i.startswith("cvnotes.")}


def test_at_most_sixteen_rooms_open_on_the_corridor():
    rooms = {path.relative_to(PACKAGE).parts[0] for path in FILES}
    assert rooms == {"__init__.py", "__main__.py"} | set(FLOOR) - {"__main__"}
    assert len(rooms) <= 16


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
        "import cvnotes, cvnotes.calibration, cvnotes.stereo\n"
        "heavy = {'scipy', 'cv2', 'matplotlib', 'trimesh', 'ipywidgets', 'PIL', 'yaml', 'tqdm'}\n"
        "loaded = set(sys.modules) - before\n"
        "heavy |= {'numpy.polynomial', 'cvnotes.files', 'html', 'json', 'pathlib'} - before\n"
        "print(sorted(heavy & (loaded | {m.split('.')[0] for m in loaded})))"
    )
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


def test_explorations_and_exercises_need_nothing_but_numpy_and_pillow():
    # A page that runs them in the browser fetches each library over the network.
    script = (
        "import importlib.abc, sys\n"
        "class Absent(importlib.abc.MetaPathFinder):\n"
        "    def find_spec(self, name, path, target=None):\n"
        "        if name.split('.')[0] in {'scipy', 'cv2', 'matplotlib', 'trimesh', 'ipywidgets',\n"
        "                                  'mpl_toolkits', 'yaml', 'tqdm', 'IPython'}:\n"
        "            raise ImportError(name)\n"
        "sys.meta_path.insert(0, Absent())\n"
        "import cvnotes.learn\n"
        "from cvnotes.show.explore import NAMES, model\n"
        "print([model(name).sight().picture.shape[2] for name in NAMES])"
    )
    named = {**os.environ, "CVNOTES_FONT": str(font_file())}
    run = subprocess.run([sys.executable, "-c", script], env=named, capture_output=True, text=True)
    assert run.stdout.strip() == str([3] * 7), run.stderr


def test_nothing_in_the_package_prints_or_seeds_globally():
    for path in FILES:
        if _name(path).startswith("commands") or "__main__" in path.read_text():
            continue  # whoever is run on a command line speaks to it
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call):
                assert ast.unparse(node.func) not in ("print", "np.random.seed"), path.name


def test_places_in_arrays_are_of_the_machines_own_size():
    # `take` refuses int64 where the machine counts in 32 bits, as in a browser.
    found = [
        _name(path)
        for path in FILES
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Attribute) and node.attr == "int64"
    ]
    assert not found


def test_one_place_alone_relies_on_numpy_to_refuse_a_singular_matrix():
    # Without flags of floating-point errors it cannot; `solved` looks for its NaN too.
    found = {
        _name(path)
        for path in FILES
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.ExceptHandler)
        and node.type is not None
        and ast.unparse(node.type) == "np.linalg.LinAlgError"
    }
    assert found == {"base.optimise"}
