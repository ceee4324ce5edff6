"""The report of a calibration: one page with all words and pictures, complete in itself."""

from collections.abc import Iterable, Iterator, Sequence
from html import escape
from importlib.resources import files
from typing import TYPE_CHECKING

import numpy as np

from cvnotes.base.writing import printable
from cvnotes.commands.drawing import LENS, Drawing
from cvnotes.commands.pictures import boards, photograph, residuals, uncertainty
from cvnotes.commands.report import Block, camera_report, notes_of

if TYPE_CHECKING:
    from cvnotes.photographs import CalibratedPhotographs

_LONG = 16  # letters that stay on one line in a table


def report_page(found: "CalibratedPhotographs", *, note: str = "") -> str:
    """Return the report of a calibration as HTML, with a note for whoever reads its source."""
    title, *blocks = camera_report(found.calibration)
    return page(str(title), [words(found, blocks), *figures(found), *photographs(found)], note)


def page(title: str, parts: Iterable[str], note: str) -> str:
    """Put the parts of a page together."""
    style = files("cvnotes.commands").joinpath("page.css").read_text("utf-8")
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8">\n<!-- {note} -->\n'
        f'<meta name="viewport" content="width=device-width">\n<title>{escape(title)}</title>\n'
        f"<style>\n{style}</style></head>\n<body><h1>{escape(title)}</h1>\n"
        + "\n".join(parts)
        + "\n</body></html>\n"
    )


def words(found: "CalibratedPhotographs", blocks: Sequence[Block]) -> str:
    """Return what is to be said of a calibration as HTML: the verdict, and blocks of its report."""
    said = [f"Next photograph: {found.next_view}"] if found.next_view else []
    judged = verdict("camera", found.reliable, found.doubts)
    return "\n".join([judged, *map(block_of, [*said, *blocks])])


def verdict(what: str, reliable: bool, doubts: Sequence[str]) -> str:
    """Say whether it is to be believed, and what whoever uses it should know."""
    judged = f"<p>The photographs determine this {what}.</p>"
    if not reliable:
        judged = f'<p class="bad">This {what} is not reliable.</p>'
    items = "".join(f"<li>{escape(sentence)}</li>" for sentence in doubts)
    return judged + (f"<ul>{items}</ul>" if items else "")


def figures(found: "CalibratedPhotographs") -> Iterator[str]:
    """Return the drawings of a calibration as HTML, each with its heading and its words."""
    result, proposal = found.calibration, found.next_view
    picture, colours = uncertainty(result, proposal)
    key = [(words, f"background: {colour}") for words, colour in colours.items()]
    if proposal is not None:
        key.append(("the next photograph", f"border: 3px solid {LENS}"))
    shown = (f'<span><i style="{look}"></i>{words}</span>' for words, look in key)
    words = (
        "How far off a predicted pixel may be: 1 σ, both coordinates together, of a camera that "
        f'may turn a little. Dots: the corners.<br><span class="key">{" ".join(shown)}</span>'
    )
    for heading, drawn in (
        ("How well the picture is known", (picture, words)),
        ("What is left at the corners", residuals(result)),
        ("Where the boards were", boards(result, found.photographs.board)),
    ):
        yield f"<section><h2>{heading}</h2>{figure(*drawn)}</section>"


def photographs(found: "CalibratedPhotographs") -> Iterator[str]:
    """Return all photographs as HTML, each with its corners and what there is to say of it."""
    every, rms = found.photographs, found.calibration.view_rms
    names, rejected = every.named()
    notes = notes_of(every, found.calibration)
    part = np.nan_to_num(rms) / max(float(np.nan_to_num(rms).max()), 1e-12)
    yield "<h2>The photographs, with the RMS of their corners</h2>"
    yield '<div class="wall">'
    for i, (name, photo) in enumerate(zip(names, every.used, strict=True)):
        bar = f'<div class="bar" style="width: {part[i]:.0%}"></div>{escape(notes[i])}'
        words = f"{i + 1}. {escape(name)}: {rms[i]:.3f} px{bar}"
        yield figure(photograph(photo, every.board), words)
    yield "</div>"
    if not rejected:
        return
    seen = {printable(photo.path): photo for photo in every.looked_at}
    yield '<h2>Not used</h2>\n<div class="wall">'
    for lost, short in zip(every.rejected, rejected, strict=True):
        words = f"{escape(short.file)}: {escape(str(short.reason))}"
        photo = seen.get(lost.file)
        yield figure(photograph(photo, every.board) if photo else "", words)
    yield "</div>"


def figure(picture: Drawing | str, words: str) -> str:
    """Return a drawing with its words, which are HTML."""
    return f"<figure>{picture}<figcaption>{words}</figcaption></figure>"


def block_of(block: Block) -> str:
    """Spell a block of the report."""
    if isinstance(block, str):
        return f"<p>{escape(block)}</p>" if block else ""
    if isinstance(block, dict):
        items = (f"<dt>{escape(name)}</dt><dd>{escape(text)}</dd>" for name, text in block.items())
        return f"<dl>{''.join(items)}</dl>"
    header, *rows = (
        "".join(f"<td{' class=long' * (len(cell) > _LONG)}>{escape(cell)}</td>" for cell in row)
        for row in block
    )
    header = header.replace("<td class=long>", "<td>").replace("td>", "th>")
    return f"<table>{''.join(f'<tr>{row}</tr>' for row in (header, *rows))}</table>"
