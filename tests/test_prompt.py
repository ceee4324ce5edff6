"""The lab's connection to its kernels keeps no small message back."""

import json
from pathlib import Path

import pytest

from cvnotes.commands import prompt

pytestmark = pytest.mark.once


class Handler:
    def __init__(self):
        self.done = []

    def set_nodelay(self, value):
        self.done.append(("nodelay", value))


class Usual:
    def __init__(self, websocket_handler):
        self.websocket_handler = websocket_handler

    def connect(self):
        self.websocket_handler.done.append("connected")
        return "what the usual one gives"


class Server:
    def __init__(self):
        self.web_app = self
        self.settings = {"kernel_websocket_connection_class": Usual, "other": 1}


def test_connections_switch_the_delay_off_and_are_the_usual_ones_otherwise():
    server = Server()
    prompt._load_jupyter_server_extension(server)
    connection = server.settings["kernel_websocket_connection_class"](Handler())
    assert isinstance(connection, Usual)
    assert connection.connect() == "what the usual one gives"
    assert connection.websocket_handler.done == [("nodelay", True), "connected"]
    assert server.settings["other"] == 1


def test_the_lab_loads_it():
    folder = Path(prompt.__file__).parent / "jupyter" / "jupyter_server_config.d"
    extensions = json.loads((folder / "cvnotes.json").read_text())["ServerApp"]
    assert extensions == {"jpserver_extensions": {prompt.__name__: True}}
    assert prompt._jupyter_server_extension_points() == [{"module": prompt.__name__}]


def test_jupyters_own_connection_has_what_is_asked_of_it():
    channels = pytest.importorskip("jupyter_server.services.kernels.connection.channels")
    usual = channels.ZMQChannelsWebsocketConnection
    assert callable(usual.connect)
    assert usual.websocket_handler.klass.set_nodelay
    assert issubclass(prompt.prompt(usual), usual)
