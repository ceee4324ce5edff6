"""Sliders that answer at once: an extension of the server that `cvnotes lab` starts.

A kernel's answer is several small messages in a row. TCP keeps a small message back until the one
before is acknowledged, and the browser's side waits with that up to 40 ms: of every picture that
follows a slider, half of the time. Jupyter's server leaves that as it is; here it is switched off.
"""

from typing import Any


def _jupyter_server_extension_points() -> list[dict[str, str]]:
    return [{"module": __name__}]


def _load_jupyter_server_extension(server: Any) -> None:
    settings = server.web_app.settings
    usual: Any = settings["kernel_websocket_connection_class"]
    settings["kernel_websocket_connection_class"] = prompt(usual)


def prompt(usual: Any) -> Any:
    """Return a server's class of connections to kernels with its small messages sent at once.

    Examples
    --------
    >>> class Usual:
    ...     def connect(self):
    ...         return "connected"
    >>> issubclass(prompt(Usual), Usual)
    True
    """

    class Prompt(usual):  # type: ignore[misc]
        def connect(self) -> Any:
            self.websocket_handler.set_nodelay(True)
            return super().connect()

    return Prompt
