"""What went wrong, in one name and one sentence; and in which order that is sought.

The exercise's own misconceptions come first. All others are known in every exercise, and measured:
they are what stands between the answers and right ones, in all cases alike.
"""

from cvnotes.tutor.checker.difference import NOT_A_NUMBER, VAGUE, difference
from cvnotes.tutor.checker.families import slipped_step
from cvnotes.tutor.checker.foreseen import foreseen
from cvnotes.tutor.checker.inputs import slipped_input
from cvnotes.tutor.checker.raised import without_numbers
from cvnotes.tutor.checker.shapes import laid_out_otherwise, misshapen
from cvnotes.tutor.checker.twice import two_mistakes
from cvnotes.tutor.checker.wrong_answer import Found, WrongAnswer


def diagnosis(answer: WrongAnswer) -> Found | None:
    """Describe what went wrong; None if nothing is recognised.

    The sentence stands by itself: of an answer that cannot be compared it says that, too.
    """
    if (found := answer.found_by(foreseen)) is not None:
        return found
    case, outcome = answer.shown
    if outcome.value is None:
        return without_numbers(answer)
    if outcome.changed and outcome.value.shape == case.right.shape:
        return Found("an argument changed", answer.why)
    found = laid_out_otherwise(answer) or difference(answer)
    if found is None or found.name in VAGUE:
        found = _slipped(answer) or answer.found_by(slipped_step) or found or _usually(answer)
    if found is None or found.name == "a few numbers":
        found = answer.found_by(two_mistakes) or found
    return found or misshapen(answer)


def _usually(answer: WrongAnswer) -> Found | None:
    """Name what was done to right answers, where special inputs alone hide it."""
    usual = answer.on_usual_inputs
    if usual.wrong < 2 or len(usual.tried) == len(answer.tried):
        return None
    found = difference(usual)
    if found is None or found == NOT_A_NUMBER or found.name in {*VAGUE, "one answer for all"}:
        return None  # neither where nor why, nor what rounding decides
    return Found(found.name, f"Special inputs aside: {found.sentence}")


def _slipped(answer: WrongAnswer) -> Found | None:
    """Name the input that slipped, behind what is said of an answer that cannot be compared."""
    found = answer.found_by(slipped_input)
    if found is None or not answer.why:
        return found
    return Found(found.name, f"{answer.why} {found.sentence}")
