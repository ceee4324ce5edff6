"""Explorations on a page without a kernel: what the page is told, and what it asks.

The page has the still of an exploration, and beside it, as data, all that its sliders need
(`page_data`). Python in a worker of the browser (``docs/static/live/worker.js``) then answers every
movement with `asked`: the same model, so that page, notebook and still cannot disagree.
"""

import json
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from cvnotes.base import CvnotesError
from cvnotes.camera import Camera
from cvnotes.files.cameras import camera_from_entry, camera_to_dict
from cvnotes.files.entry import Entry
from cvnotes.show import explorations
from cvnotes.show.explorations.model import Model, Values
from cvnotes.show.explorations.paper import Paper
from cvnotes.show.explorations.pulled import pulled_model
from cvnotes.targets import Chessboard

MAX_SHARPNESS = 3


class Shown(NamedTuple):
    """What the page shows: pixels of red, green, blue and opacity, and the rest as JSON."""

    pixels: bytes
    rest: str


def page_data(model: Model, camera: Camera | None, board: Chessboard | None, values: Values) -> str:
    """Write, as JSON, what a page has to know about an exploration before Python is there.

    Parameters
    ----------
    model : Model
        Its settings, and what it shows for `values`.
    camera, board
        As they were given for it; None for the course's.
    values : mapping
        Where the sliders stand; those that are not named stand where they start.

    Examples
    --------
    >>> json.loads(page_data(explorations.model("lens"), None, None, {}))["settings"][0]["name"]
    'k1'
    """
    values = model.values(**values)
    return json.dumps(
        {
            "name": model.name,
            "about": model.about,
            "camera": None if camera is None else camera_to_dict(camera),
            "board": None if board is None else _board_to_dict(board),
            "settings": [{**s._asdict(), "choice": s.is_choice} for s in model.settings],
            "folded": model.folded(**values),
            "values": values,
            **model.drawing(**values).as_data(),
        },
        ensure_ascii=False,
    )


def asked(question: str) -> Shown:
    """Answer a page.

    Parameters
    ----------
    question : str
        JSON with ``name``, ``values`` and, where wanted, ``camera`` and ``board`` as `page_data`
        has them, ``grip`` and ``at`` (what a hand pulls, and where to), ``sharpness`` and
        ``narrow``. Where points are pulled, ``cells`` and ``photo``, as `pulled_model` takes them.

    Returns
    -------
    Shown
        The rest has ``values``, ``size``, ``sentence``, ``matrices`` and ``grips``.

    Examples
    --------
    >>> shown = asked('{"name": "lens", "values": {"k1": 0, "k2": 0}}')
    >>> json.loads(shown.rest)["sentence"][:13]
    'An ideal lens'
    """
    given: dict[str, Any] = json.loads(question)
    if "cells" in given:
        asked_for = pulled_model(tuple(given["cells"]), given.get("photo"))
    else:
        camera, board = (json.dumps(given.get(key)) for key in ("camera", "board"))
        asked_for = _model(given["name"], camera, board)
    values = asked_for.values(**given["values"])
    if "grip" in given:
        values = asked_for.dragged(given["grip"], tuple(given["at"]), **values)
    sharpness = min(max(int(given.get("sharpness", 1)), 1), MAX_SHARPNESS)
    paper = Paper(sharpness, narrow=bool(given.get("narrow")))
    drawing = asked_for.drawn_on(paper, values)
    height, width = drawing.picture.shape[:2]
    pixels = np.full((height, width, 4), 255, np.uint8)
    pixels[..., :3] = drawing.picture
    rest = {"values": values, "sharpness": sharpness, **drawing.as_data()}
    return Shown(pixels.tobytes(), json.dumps(rest, ensure_ascii=False))


def with_photograph(cells: list[str], photo: str) -> str:
    """Write what a page has to know of points that are pulled over a photograph of the reader's.

    Parameters
    ----------
    cells, photo
        As `pulled_model` takes them.
    """
    return page_data(pulled_model(tuple(cells), photo), None, None, {})


@lru_cache(maxsize=16)
def _model(name: str, camera: str, board: str) -> Model:
    """Make a model once; camera and board are JSON, null for the course's."""
    own_camera, own_board = json.loads(camera), json.loads(board)
    return explorations.model(
        name,
        None if own_camera is None else camera_from_entry(Entry(own_camera, "the page")),
        None if own_board is None else _board_from_dict(own_board),
    )


def _board_to_dict(board: Chessboard) -> dict[str, Any]:
    return {
        "corners": list(board.corners),
        "square": board.square,
        "half_turn_symmetric": board.half_turn_symmetric,
    }


def _board_from_dict(keys: dict[str, Any]) -> Chessboard:
    try:
        symmetric = bool(keys["half_turn_symmetric"])
        return Chessboard(tuple(keys["corners"]), keys["square"], half_turn_symmetric=symmetric)
    except (KeyError, TypeError):
        raise CvnotesError("the page: its board cannot be read") from None
