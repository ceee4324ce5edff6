"""One verdict for the notebook and for the class: both judge the notebook's own inputs.

Whoever sees "✓ right" in the notebook must get the point, and whoever gets the point must have
seen it. So a grader tries an answer on the inputs that the notebook tried it on, with the words
that the notebook said, and then on inputs that nobody could know before.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from cvnotes.tutor.checker.exercise import Exercise
from cvnotes.tutor.checker.judge import judge
from cvnotes.tutor.checker.outcome import Outcome
from cvnotes.tutor.checker.report import WRONG, Report

# The inputs in a notebook are the same each time, so that a counterexample stays where it is.
NOTEBOOK_SEED = 2024

RIGHT_THERE_NOT_HERE = "right in the notebook, not here"


def verdict(exercise: Exercise, outcomes: Mapping[int, Sequence[Outcome]]) -> Report:
    """Judge an answer by what it gave on the inputs of one or more seeds.

    Parameters
    ----------
    exercise : Exercise
        What was asked.
    outcomes : mapping
        What `ask` gave, by seed; that of the notebook, `NOTEBOOK_SEED`, is judged first.

    Returns
    -------
    Report
        Passed only if it is right for every seed. What the notebook says is what the student
        saw. If it is right there and not for another seed, a remark says so, and the report
        tells why.
    """
    seeds = sorted(outcomes, key=lambda seed: seed != NOTEBOOK_SEED)
    reports = [judge(exercise, outcomes[seed], seed) for seed in seeds]
    report = next((r for r in reports if not r.passed), reports[0])
    if seeds[0] != NOTEBOOK_SEED or report is reports[0]:
        return report
    return replace(report, verdict=WRONG, remarks=(RIGHT_THERE_NOT_HERE, *report.remarks))
