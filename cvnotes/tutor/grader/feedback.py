"""A page for each student, and one for the class: HTML that a telephone shows, no scripts."""

import re
from collections.abc import Sequence
from html import escape
from importlib.resources import files

from cvnotes.tutor.checker.exercise import Exercise
from cvnotes.tutor.checker.report import marked
from cvnotes.tutor.course import Course
from cvnotes.tutor.grader.assignment import Item
from cvnotes.tutor.grader.marks import Mark, Verdict
from cvnotes.tutor.grader.tables import counted, misconceptions, number
from cvnotes.tutor.grader.totals import Total

# Okabe's and Ito's blue and vermilion stay apart for every eye; each has a sign of its own, too.
_STATES = (
    ("right", "#0072B2", "✓ right"),
    ("wrong", "#D55E00", "✗ not yet right"),
    ("open", "#8C8C8C", "– not solved yet"),
    ("open", "#E3E3E3", "– not handed in"),
)
# By these words the command knows its own files, which it may replace.
MADE_BY = "made by cvnotes grade"


def file_name(total: Total, taken: Sequence[str]) -> str:
    """Return a student's page a name that any file system can hold, and that nobody else has.

    Examples
    --------
    >>> from cvnotes.tutor.grader.assignment import Student
    >>> file_name(Total(Student("../Zoë Ö."), {}), ["Zoë_Ö.html"])
    'Zoë_Ö_2.html'
    """
    stem = re.sub(r"[^\w-]+", "_", total.student.student).strip("_")[:80] or "student"
    names = (f"{stem}{f'_{n}' * (n > 1)}.html" for n in range(1, len(taken) + 2))
    return next(name for name in names if name not in taken)


def student_page(total: Total, course: Course, title: str) -> str:
    """Write a student's page: each exercise, what held, what did not, and what to do next.

    Parameters
    ----------
    total : Total
        What the student earned.
    course : Course
        Whose exercises were answered.
    title : str
        Of the assignment.

    Returns
    -------
    str
        HTML. What is for the teacher alone (equal functions, ids) is not in it.
    """
    who = total.student.name or total.student.student
    parts = [f"<h1>{escape(title)}</h1>", f"<p>{escape(who)}</p>"]
    parts.append(f'<p class="sum"><strong>{number(total.points)}</strong> of {number(total.of)}')
    parts[-1] += " points</p>"
    for mark in total.marks:
        if mark.remark:
            named = f"{mark.notebook}: " if mark.notebook else ""
            parts.append(f"<p>{escape(named + mark.remark)}.</p>")
    if not total.marks:
        parts.append("<p>Nothing was handed in.</p>")
    parts += [_section(course, name, item, total) for name, item in total.items.items()]
    others = [n for n, v in total.verdicts.items() if n not in total.items and not v.is_open]
    if others:
        parts.append(f'<p class="quiet">Answered beyond what was asked: {", ".join(others)}.</p>')
    return _page(f"{title}: {who}", parts)


def _section(course: Course, name: str, item: Item, total: Total) -> str:
    verdict = total.verdicts.get(name)
    exercise, (kind, _, words) = course.exercises[name], _STATES[_state(verdict)]
    earned = f"{number(total.earned(name))} of {number(item.points)}"
    lines = [
        f'<div class="head"><h2>{escape(exercise.title)}</h2><span class="points">{earned}</span>',
        f'</div><p class="quiet"><code>{name}</code>, {_place(exercise, course)}</p>',
        f'<p><span class="{kind}">{words[:2]}{words[2:].capitalize()}</span></p>',
    ]
    if verdict is not None:
        lines += _found(verdict)
    lines.append(_next_step(exercise, verdict))
    return f"<section>{''.join(lines)}</section>"


def _place(exercise: Exercise, course: Course) -> str:
    notebook = course.notebook_of(exercise)
    return f"chapter {exercise.chapter}" + ("" if notebook.isdigit() else f", {notebook}")


def _state(verdict: Verdict | None) -> int:
    """Return which of the states an answer is in."""
    if verdict is None:
        return 3
    return 0 if verdict.passed else 2 if verdict.is_open else 1


def _found(verdict: Verdict) -> list[str]:
    """Write the answer beside a right one, what held, what did not, and on which input."""
    lines = []
    if verdict.compared:
        lines.append(marked(f"<pre>{escape(chr(10).join(verdict.compared))}</pre>"))
    held = [f"<li>✓ {escape(sentence)}</li>" for sentence in verdict.holds]
    held += [f"<li>✗ {escape(verdict.fails)}</li>"] * bool(verdict.fails)
    lines += [f"<ul>{''.join(held)}</ul>"] * bool(held)
    if verdict.example:
        lines.append("<p>On this input:</p>")
        lines.append(f"<pre>{escape(chr(10).join(verdict.example))}</pre>")
    lines += [f"<p>{escape(text)}</p>" for text in verdict.remarks]
    return lines


def _next_step(exercise: Exercise, verdict: Verdict | None) -> str:
    """Describe what to do: what the checker says of a mistake, or the first hint."""
    if verdict is not None and verdict.passed:
        return ""
    hint = exercise.hints[0]
    if verdict is None:
        handed = f"check(“{exercise.name}”, …)"
        text = f"Next: write it, hand it to {handed}, and hand the notebook in again."
    elif verdict.is_open:
        text = f"Next: {hint}"
    elif verdict.misconception or "hint(" not in verdict.message:
        text = f"Next: {verdict.message}"
    else:
        text = f"Next: try your function on the input above. {hint}"
    return f'<p class="next">{escape(text)}</p>'


def class_page(marks: Sequence[Mark], sums: Sequence[Total], course: Course, title: str) -> str:
    """Write the page for the class: the picture, the sums, and what the next session begins with.

    Parameters
    ----------
    marks : sequence of Mark
        Of the notebooks.
    sums : sequence of Total
        Of the students.
    course : Course
        Whose exercises were answered.
    title : str
        Of the assignment.
    """
    points, of = sum(t.points for t in sums), sum(t.of for t in sums)
    parts = [f"<h1>{escape(title)}</h1>"]
    parts.append(
        f'<p class="sum">{counted(len(sums), "student")}, '
        f"{number(points)} of {number(of)} points</p>"
    )
    parts.append(class_picture(sums, course))
    met = misconceptions(marks).most_common(12)
    if met:
        rows = "".join(
            f"<tr><td>{escape(name)}: {escape(what)}</td><td>{count}</td></tr>"
            for (name, what), count in met
        )
        parts.append(f"<section><h2>Misconceptions met</h2><table>{rows}</table></section>")
    rows = "".join(
        f"<tr><td>{escape(t.student.name or t.student.student)}"
        + "".join(f'<br><span class="quiet">{escape(text)}</span>' for text in t.remarks)
        + f"</td><td>{number(t.points)} of {number(t.of)}</td></tr>"
        for t in sums
    )
    parts.append(f"<section><h2>Students</h2><table>{rows}</table></section>")
    return _page(title, parts)


def class_picture(sums: Sequence[Total], course: Course) -> str:
    """Draw the progress of the class as SVG: a bar for each exercise, of all who were asked.

    Parameters
    ----------
    sums : sequence of Total
        Of the students.
    course : Course
        Whose exercises were answered.
    """
    asked = {name for total in sums for name in total.items}
    names = [name for name in course.exercises if name in asked]
    left = 20 + 7 * max(map(len, names), default=0)
    width, row, top = 332 - left, 22, 60
    height = top + row * len(names) + 8
    shapes = []
    for i, (_, colour, text) in enumerate(_STATES):
        x, y = 8 + 160 * (i % 2), 6 + 22 * (i // 2)
        shapes.append(f'<rect x="{x}" y="{y}" width="14" height="14" fill="{colour}"/>')
        shapes.append(f'<text x="{x + 20}" y="{y + 12}">{text}</text>')
    for i, name in enumerate(names):
        states = [_state(total.verdicts.get(name)) for total in sums if name in total.items]
        y, start, n = top + row * i, float(left), len(states)
        shapes.append(f'<text x="{left - 8}" y="{y + 13}" text-anchor="end">{name}</text>')
        for state, (_, colour, _) in enumerate(_STATES):
            if part := width * states.count(state) / n:
                shapes.append(
                    f'<rect x="{start:.1f}" y="{y}" width="{part:.1f}" height="{row - 5}" '
                    f'fill="{colour}"/>'
                )
            start += part
        label = f"{states.count(0)} of {n}"
        shapes.append(f'<text x="{left + width + 8}" y="{y + 13}">{label}</text>')
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 400 {height}" role="img" '
        'font-family="system-ui, sans-serif" font-size="13" fill="currentColor">'
        f"<!-- {MADE_BY} --><title>Progress of the class, exercise by exercise</title>"
        f"{''.join(shapes)}</svg>"
    )


def _page(title: str, parts: Sequence[str]) -> str:
    style = files("cvnotes.tutor.grader").joinpath("feedback.css").read_text("utf-8")
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><!-- {MADE_BY} -->'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(title)}</title><style>\n{style}</style></head>\n<body>\n"
        + "\n".join(parts)
        + "\n</body></html>\n"
    )
