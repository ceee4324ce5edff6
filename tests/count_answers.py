"""Count what the tutor says of answers: ``python tests/count_answers.py [MUTANTS] [exercise …]``.

The answers are those of the tests: the references and second answers in all styles (right), the
listed misconceptions, right answers changed as a whole, and slips of the second answers (wrong). A
wrong answer is

* accepted, or raises out of `check`;
* wrongly named: by another of the list than its own, or on other inputs by another name
  (where an answer is wrong is measured on the inputs at hand, and NaN has many causes: neither is
  a name);
* named, by the list or by a rule that says what was done;
* precise, where what is said is in which entries, rows or columns it is wrong, or how little;
* placed, where it has none of these, but a place of its code is shown that, put right, makes the
  rest come out right (the others but slips have no source of their own);
* probed, where it is none of these, but is right on simpler inputs, does not depend on something,
  or changes where it should not;
* generic, where nothing of all that is said.

Located are all whose place is shown, whatever their name.
"""

import ast
import linecache
import sys
import time
from collections import Counter

import numpy as np
import test_exercises_mutations as mutations
from test_exercises_second import solution_of, written

from cvnotes.learn import EXERCISES
from cvnotes.tutor.checker import in_process
from cvnotes.tutor.checker.attempt import attempt
from cvnotes.tutor.checker.difference import VAGUE
from cvnotes.tutor.checker.judge import judge
from cvnotes.tutor.checker.probes import probed
from cvnotes.tutor.checker.repairs import pointed

SEED, OTHERS = 2024, (11, 12)
# How the files of answers are called that have a source of their own.
OWN = "<answer"
COLUMNS = ("right", "refused", "wrong", "accepted", "raised", "wrong name", "named", "precise",
           "placed", "probed", "generic", "located", "ms")  # fmt: skip
# What is done to a right answer as a whole.
CHANGES = {
    "sign": np.negative, "twice": lambda x: 2 * x, "0.1 % more": lambda x: 1.001 * x,
    "plus 1": lambda x: x + 1, "transposed": np.transpose, "reversed": np.flip,
    "moved on": lambda x: np.roll(x, 1), "sizes": np.abs, "squared": np.square,
    "rounded to 1": np.round, "rounded to 3": lambda x: np.round(x, 3),
    "rounded to 4": lambda x: np.round(x, 4), "half precision": lambda x: np.float16(x),
    "noise of 1e-3": lambda x: x * (1 + 1e-3 * np.random.default_rng(x.size).normal(size=x.shape)),
    "noise of 1e-5": lambda x: x * (1 + 1e-5 * np.random.default_rng(x.size).normal(size=x.shape)),
    "first only": lambda x: x[:1] if x.ndim else [x], "in a row": np.ravel,
}  # fmt: skip


def judged(exercise, function, seed=SEED):
    """Give the report on a function of which nobody knows the source."""
    return judge(exercise, in_process.run_here(function, exercise.inputs(seed), 2.0), seed)


def right_answers(names):
    for name in names:
        for function in (EXERCISES[name].reference, solution_of(name)):
            for _, answer in written(EXERCISES[name], function):
                yield name, answer


def listed(names):
    for name in names:
        for mistake in EXERCISES[name].misconceptions:
            for gives in (mistake.gives, *mistake.variants):
                yield name, gives, mistake.name


def changed(names):
    for name in names:
        for change in CHANGES.values():
            reference = EXERCISES[name].reference
            yield name, lambda *args, f=reference, c=change: c(np.asarray(f(*args))), None


def mutated(names, wanted):
    found = [(name, i) for name in names for i in range(len(mutations.slips(name)[1]))]
    for k in np.random.default_rng(5).permutation(len(found))[:wanted]:
        name, i = found[k]
        right, slips = mutations.slips(name)
        function = with_source(ast.unparse(mutations.mutant(right, *slips[i])), name)
        if function is not None:
            yield name, function, None


def with_source(source, name):
    """Give a function whose source is to be had, as that of a notebook's cell is."""
    file = f"{OWN} {len(linecache.cache)}>"
    linecache.cache[file] = (len(source), None, source.splitlines(keepends=True), file)
    names = {"np": np}
    try:
        exec(compile(source, file, "exec"), names)
    except (SyntaxError, ValueError, TypeError):
        return None
    return names[f"my_{name}"]


def has_source(function):
    code = getattr(function, "__code__", None)
    return code is not None and code.co_filename.startswith(OWN)


def finite(report):
    return report.yours is not None and np.isfinite(np.asarray(report.yours, float)).all()


def counted(answers):
    """Count what is said of wrong answers: (exercise, function, own name or None)."""
    counts, times = Counter(), []
    for name, function, own in answers:
        exercise = EXERCISES[name]
        started = time.process_time()
        try:
            report = judged(exercise, function)
        except Exception:
            counts["raised"] += 1
            continue
        times.append(time.process_time() - started)
        if report.passed and own is None and all(judged(exercise, function, s) for s in OTHERS):
            continue  # it is right, however it was written
        counts["wrong"] += 1
        if report.passed:
            counts["accepted"] += 1
            continue
        said = report.misconception
        own_code = has_source(function)
        found = pointed(function, exercise, said) if own_code else None
        placed = found is not None and bool(found.exact)
        counts["located"] += placed
        if said is not None:
            counts["precise" if said in VAGUE else "named"] += 1
        else:
            found = found.name if own_code else probed(function, exercise)
            counts["placed" if placed else "probed" if found else "generic"] += 1
        if own is not None and said != own:
            counts["wrong name"] += 1
        elif own is None and said not in (None, *VAGUE) and finite(report):
            again = [judged(exercise, function, seed) for seed in OTHERS]
            names = {r.misconception for r in again if not r.passed and finite(r)}
            counts["wrong name"] += not names <= {said}
    counts["ms"] = round(1e3 * float(np.median(times)), 1) if times else 0
    return counts


def main(arguments):
    """Print the table."""
    wanted = int(arguments[0]) if arguments else 400
    names = arguments[1:] or mutations.NAMES
    np.seterr(all="ignore")
    rows = {"right answers": Counter()}
    for name, function in right_answers(names):
        rows["right answers"]["right"] += 1
        outcomes = [attempt(function, args) for args in EXERCISES[name].inputs(SEED)]
        rows["right answers"]["refused"] += not judge(EXERCISES[name], outcomes, SEED).passed
    rows["listed"] = counted(listed(names))
    rows["changed as a whole"] = counted(changed(names))
    rows[f"slips ({wanted})"] = counted(mutated(names, wanted))
    sys.stdout.write(f"{'':<20}" + "".join(f"{c:>11}" for c in COLUMNS) + "\n")
    for what, counts in rows.items():
        sys.stdout.write(f"{what:<20}" + "".join(f"{counts[c]:>11}" for c in COLUMNS) + "\n")


if __name__ == "__main__":
    import warnings

    warnings.simplefilter("ignore")
    main(sys.argv[1:])
