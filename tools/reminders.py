"""Words that a chapter takes from an earlier one: pressed, the first of each says what it is.

`docs/words.md` is the table. A word there begins to be marked in the chapter after the one to which
its row leads; a formula in the row is found within formulas of the text.
"""

import re
from html import escape
from itertools import count
from typing import Any, NamedTuple

from docutils import nodes

TABLE = "docs/words"
CHAPTER = re.compile(r"notebooks/(\d+|more)_")
LAST = 99  # where the further exercises stand
# A word is pressed; its sentence stands over the page until one presses elsewhere, or Escape.
BUTTON = '<button type="button" class="word" popovertarget="{id}" aria-label="{label}">'
SENTENCE = '</button><span popover id="{id}" class="reminder">'


class Reminder(NamedTuple):
    """A row of the table: words, formulas, what they mean, and the chapter they are from."""

    words: re.Pattern[str] | None
    formulas: tuple[str, ...]
    meaning: nodes.inline
    chapter: int


def chapter_of(address: str) -> int:
    """Return the number of the chapter to which a page or a link belongs; -1 if to none."""
    found = CHAPTER.search(address)
    if not found:
        return -1
    return LAST if found[1] == "more" else int(found[1])


def reminders(table: nodes.Node) -> list[Reminder]:
    """Read the table of words."""
    read = []
    for row in next(table.findall(nodes.tbody)).findall(nodes.row):
        names, meaning, source = (cell.children[0] for cell in row.children)
        link = next(source.findall(nodes.reference))
        # Neither a comma within a formula nor one behind it ends a name.
        formulas = tuple(each.astext() for each in names.findall(nodes.math))
        text = "".join(each.astext() for each in names.children if isinstance(each, nodes.Text))
        words = sorted((word for word in re.split(r"\s*,\s*", text) if word), key=len)
        pattern = "|".join(map(re.escape, reversed(words)))
        said = nodes.inline("", "", *meaning.children, nodes.Text(" ("), link, nodes.Text(")"))
        read.append(
            Reminder(
                re.compile(rf"\b(?:{pattern})s?\b", re.IGNORECASE) if words else None,
                formulas,
                said,
                chapter_of(link["refuri"]),
            )
        )
    return read


def is_prose(node: nodes.Node) -> bool:
    """Return whether a text or a formula stands in a sentence below a title of the chapter.

    Links, code, what is printed bold and the reminders themselves are none.
    """
    above = []
    while node := node.parent:
        above.append(node)
    no_prose = (nodes.reference, nodes.literal, nodes.title, nodes.strong, nodes.inline)
    sections = sum(isinstance(each, nodes.section) for each in above)
    paragraph = any(isinstance(each, nodes.paragraph) for each in above)
    return paragraph and sections > 1 and not any(isinstance(each, no_prose) for each in above)


def mark(page: nodes.Node, reminder: Reminder, name: str) -> None:
    """Let the first of the words of a reminder on a page be pressed."""
    for node in page.findall(lambda node: isinstance(node, (nodes.Text, nodes.math))):
        text = node.astext()
        if not is_prose(node):
            continue
        if isinstance(node, nodes.math):
            letter = next((each for each in reminder.formulas if each in text), None)
            if letter is None:
                continue
            before, pressed, after = "", node.deepcopy(), ""
            # Of a longer formula one letter is meant; a button is named by words, and it has none.
            named = [nodes.math("", letter), nodes.Text(": ")]
            label = re.split("[:.,]", reminder.meaning.children[0].astext())[0]
        else:
            found = reminder.words.search(text) if reminder.words else None
            if not found:
                continue
            before, after = text[: found.start()], text[found.end() :]
            pressed, label, named = nodes.Text(found[0]), found[0], []
        button, sentence, end = (
            nodes.raw("", html.format(id=name, label=escape(label)), format="html")
            for html in (BUTTON, SENTENCE, "</span>")
        )
        said = nodes.inline("", "", *named, reminder.meaning.deepcopy())
        marked = [button, nodes.inline("", "", pressed), sentence, said, end]
        node.parent.replace(node, [nodes.Text(before), *marked, nodes.Text(after)])
        return


def remind(app: Any, page: nodes.document, name: str) -> None:
    """Mark in a chapter the words that come from earlier ones."""
    chapter = chapter_of(name)
    if chapter < 0:
        return
    if not hasattr(app, "cvnotes_reminders"):
        app.cvnotes_reminders = reminders(app.env.get_and_resolve_doctree(TABLE, app.builder))
    numbers = count()
    for reminder in app.cvnotes_reminders:
        if reminder.chapter < chapter:
            mark(page, reminder, f"word-{next(numbers)}")
