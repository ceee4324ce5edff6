"""Text that others wrote, read without trust: JSON and YAML down to plain values.

Nothing is ever constructed or executed: the result is made of dict, list, str, float, int, bool
and None. What a format allows but a result file never needs (NaN, repeated keys, aliases, deep
nesting, more than 16 megabytes) is refused with a sentence that names the key or the line.
"""

import json
import re
from collections.abc import Iterator
from itertools import chain
from math import isfinite
from typing import Any

from cvnotes.base import FileError
from cvnotes.base.writing import PathLike, path_of, printable
from cvnotes.files.entry import Entry

MAX_BYTES = 16_000_000  # a calibration of 6,000 photographs with all corners, in JSON
MAX_YAML_BYTES = 100_000  # a camera; and YAML is read slowly
MAX_DEPTH = 16
_DEEPER = {"[": 1, "{": 1, "]": -1, "}": -1}

_NUMBER = re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)([eE][-+]?\d+)?")
_YAML = "tag:yaml.org,2002:"
_YAML_TAGS = {None, "!", *(_YAML + t for t in ("opencv-matrix", "opencv-nd-matrix", "map", "seq"))}


def read_text(path: PathLike, largest: int = MAX_BYTES) -> str:
    """Read a regular file of UTF-8 text, up to a number of bytes.

    Raises
    ------
    FileError
        It is not there, no regular file, too large, empty or not UTF-8.
    """
    path = path_of(path)
    name = printable(path)
    try:
        if not path.is_file():
            raise FileError(f"{name}: there is no such file, or it is not a regular one")
        with path.open("rb") as stream:
            data = stream.read(largest + 1)
    except OSError as error:
        raise FileError(f"{name}: cannot be read: {error.strerror or error}") from error
    if len(data) > largest:
        raise FileError(f"{name}: larger than {largest} bytes, so it is no camera or calibration")
    if not data.strip():
        raise FileError(f"{name}: the file is empty")
    if data.startswith((b"\xef\xbb\xbf", b"\xff\xfe", b"\xfe\xff")) or b"\0" in data:
        raise FileError(
            f"{name}: not plain UTF-8 text (it holds a byte-order mark or NUL bytes); "
            "save it as UTF-8 without a byte-order mark"
        )
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise FileError(f"{name}: not UTF-8 text: byte {error.start} is no part of any") from error


def parse_json(text: str, file: str) -> Entry:
    """Parse JSON strictly: no NaN or Infinity, no key twice, no number too large, no deep nesting.

    Examples
    --------
    >>> parse_json('{"rms": 1, "rms": 2}', "a.json")
    Traceback (most recent call last):
        ...
    cvnotes.base.errors.FileError: a.json: the key 'rms' appears twice
    """
    depth = 0
    # A text takes all it can and gives nothing back (*+), so that one without an end costs as
    # much as one with: looking for its end anew from each escaped quote would take minutes.
    for token in re.finditer(r'"(?:[^"\\]|\\.)*+"?|[\[{]|[\]}]', text, re.DOTALL):
        depth += _DEEPER.get(token[0], 0)
        if depth > MAX_DEPTH:
            raise FileError(
                f"{file}: nested more than {MAX_DEPTH} deep at character {token.start()}"
            )

    def pairs(items: list[tuple[str, Any]]) -> dict[str, Any]:
        seen: dict[str, Any] = {}
        for key, value in items:
            if key in seen:
                raise FileError(f"{file}: the key {key!r} appears twice")
            seen[key] = value
        return seen

    try:
        value = json.loads(text, object_pairs_hook=pairs, parse_constant=float, parse_int=float)
    except json.JSONDecodeError as error:
        where = f"line {error.lineno}, column {error.colno}"
        raise FileError(f"{file}: not valid JSON at {where}: {error.msg}") from error
    root = Entry(value, file)
    if not _is_finite(value):
        _refuse_infinite(root)
    return root


def _is_finite(value: Any) -> bool:
    """Return whether no number is NaN, Infinity or beyond float64: of large files in a tenth."""
    level = [value]
    while level:
        numbers = [x for x in level if type(x) is float]
        if not all(map(isfinite, numbers)):
            return False
        inner = [x.values() if type(x) is dict else x for x in level if type(x) in (dict, list)]
        level = list(chain.from_iterable(inner))
    return True


def _refuse_infinite(entry: Entry) -> None:
    """Name the first such number, wherever it hides, also in unused keys."""
    if isinstance(entry.value, float):
        entry.number()
    elif isinstance(entry.value, list):
        for item in entry:
            _refuse_infinite(item)
    elif isinstance(entry.value, dict):
        for item in entry.items().values():
            _refuse_infinite(item)


def parse_yaml(text: str, file: str) -> Entry:
    r"""Parse the plain part of YAML, as OpenCV and ROS write it.

    Works on the parser's events, never on its constructors: there is nothing that a tag could
    call. OpenCV's own header and its two matrix tags are understood; any other tag, anchors,
    aliases, repeated keys, several documents and deep nesting are refused.

    Examples
    --------
    >>> parse_yaml("%YAML:1.0\n---\nK: !!opencv-matrix\n   rows: 3", "a.yml").value
    {'K': {'rows': 3.0}}
    """
    import yaml

    # OpenCV 3 and 4 write "%YAML:1.0", which is no YAML directive.
    text = re.sub(r"\A%YAML[^\n]*", "", text)
    try:
        events = yaml.parse(text, Loader=yaml.SafeLoader)
        next(events)  # the stream starts
        if not isinstance(next(events), yaml.DocumentStartEvent):
            raise FileError(f"{file}: the file is empty")
        value = _yaml_value(next(events), events, file)
        next(events)  # the document ends
        if not isinstance(next(events), yaml.StreamEndEvent):
            raise FileError(f"{file}: more than one document; one is expected")
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f" at line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        problem = getattr(error, "problem", None) or getattr(error, "reason", "unreadable")
        raise FileError(f"{file}: not valid YAML{where}: {problem}") from error
    return Entry(value, file)


def _yaml_value(event: Any, events: Iterator[Any], file: str, depth: int = 0) -> Any:
    """Turn the events of one YAML node into a plain value."""
    import yaml

    where = f"{file}: line {event.start_mark.line + 1}"
    if isinstance(event, yaml.AliasEvent) or event.anchor is not None:
        raise FileError(f"{where}: anchors and aliases are not read")
    if event.tag not in _YAML_TAGS:
        raise FileError(f"{where}: the tag {event.tag!r} is not read")
    if depth > MAX_DEPTH:
        raise FileError(f"{where}: nested more than {MAX_DEPTH} deep")
    if isinstance(event, yaml.ScalarEvent):
        return _yaml_scalar(event.value) if event.implicit[0] else event.value
    if isinstance(event, yaml.SequenceStartEvent):
        items = []
        while not isinstance(event := next(events), yaml.SequenceEndEvent):
            items.append(_yaml_value(event, events, file, depth + 1))
        return items
    mapping: dict[str, Any] = {}
    while not isinstance(event := next(events), yaml.MappingEndEvent):
        _yaml_value(event, events, file, depth + 1)  # a key may not be more than a value may
        if not isinstance(event, yaml.ScalarEvent) or event.value in mapping:
            where = f"{file}: line {event.start_mark.line + 1}"
            raise FileError(f"{where}: a key that is repeated, or is no plain text")
        mapping[event.value] = _yaml_value(next(events), events, file, depth + 1)
    return mapping


def _yaml_scalar(text: str) -> Any:
    if _NUMBER.fullmatch(text):
        return float(text)
    return {"": None, "~": None, "null": None, "true": True, "false": False}.get(text, text)
