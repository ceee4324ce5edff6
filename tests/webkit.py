"""Safari's engine, WebKit, without a window: what the tests of the site need of it.

Debian has it as `webkit2gtk-driver`, with a small browser of its own; Xvfb is the screen that
nobody sees. The protocol is https://www.w3.org/TR/webdriver2.
"""

import contextlib
import json
import os
import shutil
import subprocess
import time
from http.client import HTTPConnection
from pathlib import Path

from driven import Driven

DRIVER, SCREEN = map(shutil.which, ("WebKitWebDriver", "Xvfb"))
ELEMENT = "element-6066-11e4-a52e-4f735466cecf"  # as the protocol calls a reference to one
WAIT = """const [given, done] = [arguments[0], arguments[1]];
Promise.resolve((%s)(...given)).then(
    (found) => done([JSON.stringify(found) ?? "null"]), (error) => done([null, String(error)]));"""


class WebKit(Driven):
    """A WebKit with one page; ``with WebKit() as page``."""

    name = "WebKit"

    def __enter__(self):
        self.processes, self.session = [], None
        try:
            self._start()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        if self.session:
            with contextlib.suppress(OSError, RuntimeError):
                self.send("DELETE", "")
        for process in reversed(self.processes):
            process.terminate()
            process.wait()

    def _start(self):
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        hears, tells = os.pipe()
        screen = [SCREEN, "-displayfd", str(tells), "-screen", "0", "1400x1100x24"]
        screen += ["-nolisten", "tcp"]
        self.processes.append(subprocess.Popen(screen, pass_fds=[tells], **quiet))
        os.close(tells)
        with os.fdopen(hears) as number:
            display = f":{number.readline().strip()}"
        environment = os.environ | {"DISPLAY": display, "GDK_BACKEND": "x11"}
        environment |= {"LIBGL_ALWAYS_SOFTWARE": "1", "NO_AT_BRIDGE": "1"}
        environment |= {"http_proxy": "http://127.0.0.1:9", "https_proxy": "http://127.0.0.1:9"}
        environment |= {"no_proxy": "127.0.0.1"}  # nothing but this machine can be reached
        self.port = _free_port()
        command = [DRIVER, "--host=127.0.0.1", f"--port={self.port}"]
        self.processes.append(subprocess.Popen(command, env=environment, **quiet))
        until = time.monotonic() + 60
        while True:
            try:
                made = self.send("POST", "/session", capabilities={"alwaysMatch": {}})
                break
            except ConnectionError:
                if time.monotonic() > until:
                    raise
                time.sleep(0.1)
        self.session = made["sessionId"]
        self.send("POST", "/timeouts", script=300_000, pageLoad=300_000)

    def send(self, method, path, **given):
        """Ask WebKit for something."""
        below = f"/session/{self.session}" if self.session else ""
        connection = HTTPConnection("127.0.0.1", self.port, timeout=330)
        try:
            body = json.dumps(given) if method == "POST" else None
            connection.request(method, below + path, body, {"Content-Type": "application/json"})
            answer = json.loads(connection.getresponse().read())["value"]
        finally:
            connection.close()
        if isinstance(answer, dict) and "error" in answer:
            raise RuntimeError(f"{path}: {answer['error']}: {answer.get('message')}")
        return answer

    def open(self, address):
        """Go to a page, and wait until all of it is loaded."""
        self.send("POST", "/url", url=address)

    def resize(self, width, height):
        """Set the size of the window."""
        self.send("POST", "/window/rect", width=width, height=height)

    def run(self, function, *given):
        """Call a function of JavaScript with values that JSON knows; gives such a value."""
        found, *error = self.send("POST", "/execute/async", script=WAIT % function, args=[given])
        if error:
            raise RuntimeError(error[0])
        return json.loads(found)

    def choose(self, selector, paths):
        """Choose files in an input."""
        found = self.send("POST", "/element", using="css selector", value=selector)
        text = "\n".join(str(Path(path)) for path in paths)
        self.send("POST", f"/element/{found[ELEMENT]}/value", text=text)

    def perform(self, source):
        """Do what a device of WebDriver's does, act by act."""
        self.send("POST", "/actions", actions=[source])

    def asked(self):
        """Give what this page has asked for."""
        return self.run("() => performance.getEntriesByType('resource').map(one => one.name)")


def _free_port():
    import socket

    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]
