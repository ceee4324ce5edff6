"""The design of the package: who may import whom, and what an import costs."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "cvnotes"

# A module imports only from layers strictly below its own. A folder is one layer, inside which
# modules may use each other as long as nothing goes round in a circle.
LAYERS = [
    ["errors", "page"],
    ["radial"],
    ["projective", "rigid", "optimise", "lens", "sheet", "sensor", "coverage", "_cv"],
    [
        "camera",
        "incidence",
        "targets",
        "correspondences",
        "faces",
        "meshes",
        "raycast",
        "interpolate",
    ],
    ["files", "vanishing", "homography", "projection", "warp", "sampling", "edges", "placing"],
    ["zhang", "refine", "subpixel", "robust", "scenes", "rendering", "synthetic"],
    ["corners", "reliability", "steps", "views", "result"],
    ["calibration"],
    ["stereo", "resection", "course", "uncertainty"],
    ["show", "learn"],
    ["commands"],
    ["cli"],
    ["__main__"],
]
LAYER = {name: i for i, layer in enumerate(LAYERS) for name in layer}
# Where each heavy library may be used; elsewhere it would slow down the geometry.
ONLY_IN = {
    "cv2": {"_cv", "corners", "synthetic", "warp", "files", "sensor"},
    "matplotlib": {"show"},
    "ipywidgets": {"show.explore"},
    "trimesh": {"scenes", "meshes", "raycast", "rendering", "show.scene"},
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


@pytest.mark.parametrize("path", FILES, ids=_name)
def test_a_module_imports_only_from_layers_below_its_own(path):
    own = _name(path).split(".")[0]
    if own == "__init__":
        assert not list(_imports(path))
        return
    assert own in LAYER, f"{own} has no layer; give it one in tests/test_layers.py"
    for imported in _imports(path):
        head, _, rest = imported.partition(".")
        if head != "cvnotes" or not rest:
            continue
        other = rest.split(".")[0]
        if other != own:
            assert LAYER[other] < LAYER[own], f"{own} imports {other}"


@pytest.mark.parametrize("path", FILES, ids=_name)
def test_heavy_libraries_are_used_only_where_they_belong(path):
    name = _name(path)
    used = {imported.split(".")[0] for imported in _imports(path)}
    for library in used & ONLY_IN.keys():
        inside = any(f"{name}.".startswith(f"{place}.") for place in ONLY_IN[library])
        assert inside, f"{name} uses {library}"


def test_learning_does_not_draw():
    for path in (PACKAGE / "learn").glob("*.py"):
        assert not any(i.startswith("cvnotes.show") for i in _imports(path)), path.name


def test_importing_the_geometry_loads_numpy_only():
    script = (
        "import sys, numpy; before = set(sys.modules)\n"
        "import cvnotes, cvnotes.camera, cvnotes.zhang, cvnotes.calibration\n"
        "heavy = {'scipy', 'cv2', 'matplotlib', 'trimesh', 'ipywidgets', 'PIL', 'yaml', 'tqdm'}\n"
        "print(sorted(heavy & {m.split('.')[0] for m in set(sys.modules) - before}))"
    )
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


def test_nothing_in_the_package_prints_or_seeds_globally():
    for path in FILES:
        if _name(path).split(".")[0] in ("cli", "commands"):
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call):
                assert ast.unparse(node.func) not in ("print", "np.random.seed"), path.name
