"""What several test files share: a board, its views by a known camera, where photographs lie."""

import gc
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from contextlib import contextmanager
from functools import cache, partial
from html import unescape
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

# Before NumPy is loaded, here and in every process that a test starts: threads of two workers that
# wait for each other burn a third of the time, and most of it on a busy machine.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, settings

from cvnotes.calibration import Calibration, extrinsics, radial_distortion
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.refinement import Problem, minimise
from cvnotes.calibration.starts import Search
from cvnotes.camera import pose, rotation_from_vector
from cvnotes.homography import dlt
from cvnotes.targets import Chessboard

# The same examples each time, and no verdict on how long a busy machine takes to draw them.
# What is found is shown as found: to make it small takes half an hour where a try is a calibration.
settings.register_profile(
    "course",
    derandomize=True,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
    phases=[Phase.explicit, Phase.generate],
)
settings.load_profile("course")

# What one process has compiled, the others read: hundreds of them are started.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False
# A shell has what it runs in the background ignore Ctrl-C, and with it all that tests start there.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, lambda *_: None)

ROOT = Path(__file__).resolve().parents[1]
# The files that take longest, and begin: what is short fills the gaps at the end. Where two use
# one site, another stands between, so that no worker waits while the other builds it.
LONG = (
    "site_live", "webassembly", "grade", "undone", "browser", "catalogue", "site_offline",
    "site_engines", "site", "site_access", "quality", "command_calibrate", "jackknife", "cli",
    "grade_safety", "corners", "grade_class", "explore", "wheel", "build_notebooks",
    "board_shape", "synthetic", "executors", "start", "charuco", "exercises_sandbox",
)  # fmt: skip
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)
# A browser that saves data, where Python waits until it is touched.
SPARING = "Object.defineProperty(navigator, 'connection', {value: {saveData: true}})"
OF_CHROMIUM = [
    "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--disable-quic", "--no-first-run",
    "--disable-sync", "--disable-background-networking", "--disable-component-update",
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
    "--use-fake-ui-for-media-stream", "--use-fake-device-for-media-stream",
]  # fmt: skip

# On a page of the site: the ten seconds that an endless loop is given, made one.
IMPATIENT = """() => {
    const own = window.patiently = window.setTimeout;
    window.setTimeout = (act, ms, ...more) => own(act, ms === 10000 ? 1000 : ms, ...more);
}"""

# Photographs of others are not part of the project. Where they lie beside it, the finder is held
# against them too; the corners measured in them are committed, and everybody tests with those.
PHOTOGRAPHS = ROOT.parent / "shared" / "data" / "left_right"
collect_ignore = [] if PHOTOGRAPHS.is_dir() else ["test_photographs.py"]


def taken(told):
    """Empty a list; gives what was in it, for one test to answer for."""
    found, told[:] = told[:], []
    return found


def processor_time():
    """Give the seconds that this process and its ended children computed: others do not count."""
    return sum(os.times()[:4])


def wait_for(condition, seconds=300.0, of=None):
    """Wait until something holds that comes by itself, the later the busier the machine is."""
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, of
        time.sleep(0.05)


def pytest_collection_modifyitems(items):
    """Let long files begin."""
    order = {f"test_{name}.py": place for place, name in enumerate(LONG)}
    items.sort(key=lambda item: order.get(item.path.name, len(order)))


def pytest_collection_finish():
    """Let no search for garbage go through thousands of tests, and through libraries, each time."""
    gc.freeze()
    gc.set_threshold(10_000, 10, 10)


@pytest.fixture(autouse=True)
def same_chances():
    """Let OpenCV's finders draw the same, whichever tests ran before; give what does so again."""

    def again():
        if hasattr(cv2 := sys.modules.get("cv2"), "setRNGSeed"):
            cv2.setRNGSeed(0)

    again()
    return again


@pytest.fixture(scope="module")
def worked_out_once():
    """Let a file of tests work out each exercise's cases once for a seed, and each mistake on them.

    A check does so again for every answer; a thousand answers to one exercise need not.
    """
    # The functions are asked by other modules, which look for them where they are.
    from cvnotes.learn import EXERCISES
    from cvnotes.tutor.checker import foreseen, inputs
    from cvnotes.tutor.checker.exercise import Exercise

    every = [*EXERCISES.values(), *(part for e in EXERCISES.values() for part in e.parts)]
    ways = {way for e in every for m in e.misconceptions for way in (m.gives, *m.variants)}
    solve, give = Exercise.solved_cases, foreseen.what_it_gives
    slip, slipped = inputs.slips_of, inputs.with_inputs
    cases, known, given, slips = {}, {}, {}, {}

    def solved_cases(exercise, seed):
        if (exercise, seed) not in cases:
            solved = list(solve(exercise, seed))
            for args in (case.args for case in solved):
                known[id(args)] = args
                for array in (x for x in args if isinstance(x, np.ndarray)):
                    array.flags.writeable = False
            cases[exercise, seed] = solved
        return iter(cases[exercise, seed])

    def arguments(exercise, seed):
        return [case.args for case in exercise.solved_cases(seed)]

    def what_it_gives(function, args):
        if function not in ways or known.get(id(args)) is not args:
            return give(function, args)
        if (function, id(args)) not in given:
            given[function, id(args)] = give(function, args)
        return given[function, id(args)]

    def slips_of(names, args):
        if known.get(id(args)) is not args:
            return slip(names, args)
        if (names, id(args)) not in slips:
            slips[names, id(args)] = list(slip(names, args))
        return iter(slips[names, id(args)])

    @cache
    def with_inputs(change, reference):
        gives = slipped(change, reference)
        ways.add(gives)
        return gives

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(inputs, "slips_of", slips_of)
        patch.setattr(inputs, "with_inputs", with_inputs)
        patch.setattr(Exercise, "solved_cases", solved_cases)
        patch.setattr(Exercise, "inputs", arguments)
        patch.setattr(foreseen, "what_it_gives", what_it_gives)
        yield


@pytest.fixture
def course_again():
    """Let a test add exercises: afterwards the course has its own ones again."""
    from cvnotes.learn.exercises import COURSE, EXERCISES

    before = dict(EXERCISES)
    yield
    EXERCISES.clear()
    EXERCISES.update(before)
    COURSE.added.clear()


@pytest.fixture(scope="session")
def shared(tmp_path_factory):
    """Give what lets one worker of a run in at a time, into a folder that all of them share."""
    folder = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        folder = folder.parent

    @contextmanager
    def alone(name):
        lock = folder / f"{name}.lock"
        while True:
            try:
                lock.mkdir()
                break
            except FileExistsError:
                time.sleep(0.5)
        try:
            yield folder
        finally:
            lock.rmdir()

    return alone


@pytest.fixture(scope="session")
def browser_parts(shared):
    """Give the folder with the checked parts of Python for the browser, or skip for want of it."""
    sys.path.insert(0, str(ROOT / "tools"))
    from browser_parts import PartsMissingError, gather

    try:
        with shared("parts"):
            return gather()
    except PartsMissingError as error:
        pytest.skip(f"no Python for the browser: {error}")


@pytest.fixture(scope="session")
def live_folder(request, shared):
    """Build the site with Python for the browser, once for all workers; give its folder.

    CVNOTES_SITE names one that is built already.
    """
    if given := os.environ.get("CVNOTES_SITE"):
        return Path(given).resolve()
    parts = request.getfixturevalue("browser_parts")
    with shared("site") as place:
        folder = place / "live_site" / "some" / "folder"
        if not folder.is_dir():
            command = [sys.executable, ROOT / "tools/build_site.py"]
            command += ["--parts", parts, "--out", folder]
            run = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
            assert run.returncode == 0, run.stdout + run.stderr
    return folder


@pytest.fixture(scope="session")
def live_site(live_folder):
    """Serve the site with Python in it below a folder; give its address."""
    below, name = live_folder.parents[1], live_folder.parent.name
    with serving(partial(QuietHandler, directory=below)) as address:
        yield f"{address}/{name}/{live_folder.name}"


@pytest.fixture(scope="module")
def chromium():
    """Give a browser that knows no other machine and whose camera is a test picture that moves."""
    if CHROMIUM is None:
        pytest.skip("no Chromium on this machine")
    sync_api = pytest.importorskip("playwright.sync_api", reason="Playwright is not installed")
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=OF_CHROMIUM)
        yield browser
        browser.close()


@contextmanager
def serving(handler):
    """Serve on loopback while it is needed; give the address."""
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


@pytest.fixture(scope="session")
def camera_of_the_views():
    """Calibrate with the rendered photographs as a page does, here: without OpenCV."""
    from cvnotes.commands.dropped import Dropped

    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "cv2", None)
        here = Dropped(9, 6, 25.0)
        for path in sorted((ROOT / "data" / "views").glob("*.png")):
            here.look(str(path))
        return here.calibrate()


def text_of(html):
    """Give the text of a piece of HTML, as browsers do."""
    return unescape(re.sub("<[^>]*>", "", html))


class QuietHandler(SimpleHTTPRequestHandler):
    """What `python -m http.server` serves, without its log."""

    def log_message(self, *_):
        """Say nothing."""


@pytest.fixture(scope="session")
def board():
    return Chessboard((9, 6), 25.0)


@pytest.fixture(scope="session")
def views_of(board):
    """Give a function that poses the board at random where the camera sees all of it."""

    def views(camera, n, rng, *, tilt=45.0, roll=180.0, fill=(0.35, 0.9)):
        """Give n poses (n, 4, 4) and the exact corners (n, 54, 2).

        Angles are in degrees; `fill` is the part of the picture's width that the board would
        take up in front of the camera.
        """
        W, middle = board.points, board.points.mean(0)
        width, height = camera.size
        poses, corners = [], []
        while len(poses) < n:
            a, angle = rng.uniform(0, 2 * np.pi), np.radians(tilt) * np.sqrt(rng.uniform())
            turn = rotation_from_vector([0, 0, np.radians(rng.uniform(-roll, roll))])
            R = rotation_from_vector([angle * np.cos(a), angle * np.sin(a), 0]) @ turn
            z = camera.A[0, 0] * W[:, 0].max() / (width * rng.uniform(*fill))
            m = rng.uniform([0.1, 0.1], [0.9, 0.9]) * camera.size
            T = np.linalg.solve(camera.A, [*m, 1]) * z
            G = pose(R, T - R @ middle)
            seen = camera.moved(G).project(W)
            if np.isfinite(seen).all() and (seen >= 0).all() and (seen <= [width, height]).all():
                poses.append(G)
                corners.append(seen)
        return np.array(poses), np.array(corners)

    return views


@pytest.fixture(scope="session")
def first_start():
    """Give a function that takes steps 1 to 4 once, as `calibrate` does: what it refines first."""

    def state_of(problem, intrinsics=None):
        start = next(Search(problem).starts())
        H = start.homographies(dlt)
        A = start.intrinsics(intrinsics, H)
        G = start.extrinsics(extrinsics, A, H)
        return start.state(A, G, start.distortion(radial_distortion, A, G))

    return state_of


@pytest.fixture(scope="session")
def refined():
    """Give a function that calibrates by step 5 alone, from a camera and poses near the answer.

    Where a test repeats calibrations whose search for a start is not what it asks about.
    """

    def calibration(board_points, image_points, near, poses, *, lens="k1 k2", skew=False):
        data = Correspondences.of(board_points, image_points)
        problem = Problem.of(data, near.size, lens, skew)
        start = problem.state(near, data.pose_in_scaled_units(np.asarray(poses)))
        found = Calibration.of(problem, data, minimise(problem, start))
        assert found.converged
        return found

    return calibration
