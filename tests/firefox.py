"""Firefox without a window, spoken to in WebDriver BiDi: what the tests of the site need of it.

Playwright drives a Firefox of its own making. Students have the other one, which listens on a
socket when it is asked to; the protocol is https://w3c.github.io/webdriver-bidi/.
"""

import contextlib
import itertools
import json
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

from driven import Driven

PROGRAM = next(filter(None, map(shutil.which, ("firefox", "firefox-esr"))), None)
# Nothing but this machine can be reached, and Firefox asks for nothing by itself.
PREFERENCES = {
    "network.proxy.type": 1,
    "network.proxy.http": "127.0.0.1",
    "network.proxy.http_port": 9,
    "network.proxy.ssl": "127.0.0.1",
    "network.proxy.ssl_port": 9,
    "app.update.disabledForTesting": True,
    "browser.shell.checkDefaultBrowser": False,
    "browser.startup.page": 0,
    "datareporting.policy.dataSubmissionEnabled": False,
    "toolkit.telemetry.enabled": False,
    "remote.active-protocols": 1,
    "dom.disable_open_during_load": False,
}


class Firefox(Driven):
    """A Firefox with one page; ``with Firefox() as page``."""

    name = "Firefox"

    def __enter__(self):
        import websocket

        self.folder = tempfile.TemporaryDirectory(prefix="firefox", ignore_cleanup_errors=True)
        lines = [f"user_pref({json.dumps(k)}, {json.dumps(v)});\n" for k, v in PREFERENCES.items()]
        (Path(self.folder.name) / "user.js").write_text("".join(lines))
        command = [PROGRAM, "--headless", "--no-remote", "--remote-debugging-port", "0"]
        command += ["--profile", self.folder.name]
        self.socket, nowhere = None, subprocess.DEVNULL
        self.process = subprocess.Popen(command, stdout=nowhere, stderr=nowhere)
        self.numbers, self.requests, self.errors = itertools.count(1), [], []
        try:
            address = f"ws://127.0.0.1:{self._port()}/session"
            self.socket = websocket.create_connection(address, timeout=180, suppress_origin=True)
            self.send("session.new", capabilities={})
            self.context = self.send("browsingContext.getTree")["contexts"][0]["context"]
            events = ["network.beforeRequestSent", "log.entryAdded"]
            self.send("session.subscribe", events=events, contexts=[self.context])
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        if self.socket:
            self.socket.close()
        self.process.terminate()
        self.process.wait()
        self.folder.cleanup()

    def _port(self):
        """Wait until Firefox has written down where it listens."""
        place = Path(self.folder.name) / "WebDriverBiDiServer.json"
        for _ in range(600):
            with contextlib.suppress(OSError, ValueError):
                return json.loads(place.read_text())["ws_port"]
            time.sleep(0.1)
        raise TimeoutError("Firefox does not listen")

    def send(self, method, **params):
        """Ask Firefox for something, and note what else it tells meanwhile."""
        number = next(self.numbers)
        self.socket.send(json.dumps({"id": number, "method": method, "params": params}))
        while True:
            message = json.loads(self.socket.recv())
            if message.get("id") == number:
                if message["type"] == "error":
                    raise RuntimeError(f"{method}: {message['message']}")
                return message["result"]
            event, told = message.get("method"), message.get("params", {})
            if event == "network.beforeRequestSent":
                self.requests.append(told["request"]["url"])
            if event == "log.entryAdded" and told["level"] == "error":
                self.errors.append(told["text"])

    def open(self, address):
        """Go to a page, and wait until all of it is loaded."""
        self.send("browsingContext.navigate", context=self.context, url=address, wait="complete")

    def resize(self, width, height):
        """Set the size of the window's inside."""
        size = {"width": width, "height": height}
        self.send("browsingContext.setViewport", context=self.context, viewport=size)

    def run(self, function, *given):
        """Call a function of JavaScript with values that JSON knows; gives such a value."""
        told = self.send(
            "script.evaluate",
            expression=f"Promise.resolve(({function})(...{json.dumps(given)})).then(JSON.stringify)",
            target={"context": self.context},
            awaitPromise=True,
            userActivation=True,
        )
        if told["type"] == "exception":
            raise RuntimeError(told["exceptionDetails"]["text"])
        return json.loads(told["result"].get("value", "null"))

    def choose(self, selector, paths):
        """Choose files in an input."""
        found = self.send(
            "browsingContext.locateNodes",
            context=self.context,
            locator={"type": "css", "value": selector},
        )
        element = {"sharedId": found["nodes"][0]["sharedId"]}
        files = [str(path) for path in paths]
        self.send("input.setFiles", context=self.context, element=element, files=files)

    def perform(self, source):
        """Do what a device of WebDriver's does, act by act."""
        self.send("input.performActions", context=self.context, actions=[source])

    def asked(self):
        """Give what was asked for since the last time, and forget it."""
        self.run("() => 0")  # what came last is heard
        found, self.requests = self.requests, []
        return found
