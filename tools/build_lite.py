"""The whole course in JupyterLite: JupyterLab in a browser tab, with Python in the tab too.

    python tools/build_lite.py --out SITE/lite      beside SITE/python (tools/browser_parts.py)

JupyterLite comes from PyPI, in the versions below, into an environment of its own in the cache: the
project's environment keeps its own. The notebooks are put in as they are; the kernel loads Python
from ../python, whose lock knows `cvnotes`, and nothing from elsewhere.
"""

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

from browser_parts import PartsMissingError, cache_folder

from cvnotes.commands.working_copy import pages

ROOT = Path(__file__).resolve().parents[1]
# 0.7 and later need a newer Pyodide, which switches on what Safari and Firefox do not have.
PINNED = (
    "jupyterlite-core==0.6.4",
    "jupyterlite-pyodide-kernel==0.6.1",
    "jupyterlab_widgets==3.0.17",
    "jupyter_server>=2",  # reads the notebooks' list
)
KERNEL = "@jupyterlite/pyodide-kernel-extension:kernel"
CONFIG = {
    "jupyter-lite-schema-version": 0,
    "jupyter-config-data": {
        "appName": "cvnotes",
        "exposeAppInBrowser": True,  # for the tests
        "cvnotesSerif": "../../../../_static/fonts/serif-*.woff",  # the site's: see course.js
        "cvnotesSans": "../../../../_static/fonts/sans-*.woff",
        "litePluginSettings": {
            KERNEL: {
                "pyodideUrl": "./../python/pyodide.js",
                "disablePyPIFallback": True,
                # On by itself in this version, and needs what Safari and Firefox do not have.
                "loadPyodideOptions": {"enableRunUntilComplete": False},
            }
        },
    },
}
OURS = ROOT / "cvnotes" / "commands" / "jupyter"  # as `cvnotes lab` has it
APPS = ("lab", "notebooks", "tree")
# As `python -m jupyterlite_core`, without the grammar of addresses that checks no notebook: a third
# of the time.
RUN = "import sys; sys.modules['rfc3987_syntax'] = None; import jupyterlite_core.app as a; a.main()"


def environment() -> Path:
    """Return the Python of an environment with JupyterLite, making it if need be.

    Raises
    ------
    PartsMissingError
        It cannot be installed.
    """
    folder = cache_folder() / f"lite-{PINNED[0].rpartition('=')[2]}"
    python = folder / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
    stamp = folder / "installed"
    recipe = "\n".join(PINNED)
    if stamp.is_file() and stamp.read_text() == recipe:
        return python
    print(f"Installing JupyterLite into {folder}: about 100 MB, once.", flush=True)
    try:
        venv.create(folder, with_pip=True, clear=folder.is_dir())
        command = [str(python), "-m", "pip", "install", "--quiet", *PINNED]
        subprocess.run(command, check=True, capture_output=True, text=True)
        stamp.write_text(recipe)
    except subprocess.CalledProcessError as error:
        said = str(error.stderr or error.output or error).strip().splitlines()
        reason = said[-1] if said else "pip gives no reason"
        raise PartsMissingError(f"JupyterLite cannot be installed: {reason}") from None
    except OSError as error:
        raise PartsMissingError(f"JupyterLite cannot be installed: {error}") from None
    return python


def build_lite(out: Path) -> None:
    """Write JupyterLite with all notebooks into a folder of the site, beside `python`.

    Raises
    ------
    PartsMissingError
        JupyterLite cannot be installed, or does not build.
    """
    python = environment()
    with tempfile.TemporaryDirectory() as name:
        source, made = Path(name) / "source", Path(name) / "lite"
        (source / "files" / "notebooks").mkdir(parents=True)
        for path in sorted(ROOT.glob("notebooks/*.ipynb")):
            shutil.copy(path, source / "files" / "notebooks" / path.name)
        for page, content in pages(ROOT / "notebooks").items():
            (source / "files" / page).parent.mkdir(parents=True, exist_ok=True)
            (source / "files" / page).write_bytes(content)
        (source / "jupyter-lite.json").write_text(json.dumps(CONFIG))
        settings = OURS / "labconfig" / "default_setting_overrides.json"
        shutil.copy(settings, source / "overrides.json")
        command = [str(python), "-c", RUN, "build", "--no-sourcemaps"]
        command += ["--lite-dir", str(source), "--output-dir", str(made)]
        command += ["--contents", str(source / "files"), "--no-libarchive"]
        ours = OURS / "labextensions"
        command += [f"--FederatedExtensionAddon.extra_labextensions_path={ours}"]
        command += [part for app in APPS for part in ("--apps", app)]
        ran = subprocess.run(command, cwd=source, capture_output=True, text=True)
        if ran.returncode or not (made / "lab" / "index.html").is_file():
            raise PartsMissingError(f"JupyterLite does not build: {ran.stderr.strip()[-300:]}")
        shutil.copytree(made, out)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help="the folder to write")
    try:
        build_lite(parser.parse_args().out)
    except PartsMissingError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
