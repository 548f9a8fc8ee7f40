"""Speed against accuracy: which method on which model, and the races behind it."""

from __future__ import annotations

import math
from typing import Any

from validation.pareto import verdicts
from validation.pareto.catalogue import PROBLEMS
from validation.pareto.figures import figure, grouped
from validation.pareto.front import charted, front, seconds_at, usable
from validation.pareto.measure import measure
from validation.pareto.problem import BenchmarkProblem, Point
from validation.pareto.race import Result
from validation.reporting.numbers import counted, short, times
from validation.reporting.plain import restored
from validation.reporting.questions import failure_texts
from validation.reporting.record import Bullets, Data, Fact, Fold, Report, Section, Table, Text, Topic

INTRO = (
    "Error against time, both logarithmic. One thread; times are those of the processor, of the stepping alone, "
    "least of up to nine repeats; models are compiled, and engines' systems assembled, before. Both sides record at "
    "the same interval. An engine's best is the best of all its runs here. Between two steps of one method times are "
    "interpolated, between methods or models they are not. A fixed step that a solver can't finish ends its run.",
    "Accelerations in single precision are a series of their own on the rigid arm: the generated code has floats for "
    "batches alone, so a motion by itself pays for all lanes of a vector and uses one; what batches gain is in the "
    "report on timing.",
)

DECISION = (
    "**Which method, on which model.** The fastest run that keeps an error; time of the processor for the stepping "
    "alone. The next best loses by so much time."
)
_DECISIONS = """scene; #error at most = {error}; method = {best.by}; model = {best.model};
    step or tolerance = {best.setting}; #time = {best.seconds:time};
    next best method loses by = rival(); other side loses by = other()"""
_TARGETS = """scene; #at error = {error}; against = {v.target.engine}; #ours = {v.seconds:time};
    #its best = {v.engine_seconds:time}; winner = {v.winner} ? met; #asked = {v.target.ratio:short}; verdict"""


def compose(data: Data) -> Report:
    """The report of its JSON."""
    results = {name: (PROBLEMS[name], restored(Result, problem)) for name, problem in data["problems"].items()}
    failures, unfinished, quick = failure_texts(data["failures"]), tuple(data["unfinished"]), data["quick"]
    targets: list[dict[str, Any]] = [
        {"scene": f"[{one.title}](#{name})", "error": one.shown(v.target.error), "v": v, "met": v.ok is not False}
        | {"title": one.title, "verdict": {True: "ok", False: "missed", None: "not measured"}[v.ok]}
        for name, (one, result) in results.items()
        for v in verdicts.verdicts(one, result.points, quick)
    ]
    met, problems = sum(row["v"].ok is True for row in targets), counted(len(results), "problem")
    doubted = [name for name, (one, result) in results.items() if not result.agreement <= one.trust]
    said = f"{met} of {counted(len(targets), 'target')} met, in {problems}"
    said += " (quick variant: few contestants, so its ratios mean little)" if quick else ""
    said += f"; references disagree on {', '.join(doubted)}" if doubted else ""
    said += f"; {counted(len(failures), 'problem')} could not be done" if failures else ""
    said += f"; interrupted before {', '.join(unfinished)}" if unfinished else ""
    most = max((row["v"].ratio for row in targets if math.isfinite(row["v"].ratio)), default=0.0)
    choices = [
        # A scene is named once, with what its error is.
        {"scene": "" if k else f"[{one.title}](pareto.html#{name}): {one.axis.removesuffix('  [1]')}", **vars(choice)}
        for name, (one, result) in results.items()
        for k, choice in enumerate(verdicts.choices(one, result))
    ]
    decisions = Table.of(
        choices,
        _DECISIONS,
        rival=lambda row: _loses(row["best"], row["rival"], row["rival"] and row["rival"].by),
        other=lambda row: _loses(row["best"], row["other"], row["other"] and row["other"].who),
    )
    table = Table.of(targets, _TARGETS)
    return Report(
        "Speed against accuracy",
        f"{said}.",
        bool(data["ok"]),
        (*INTRO, *failures),
        (
            *(_section(name, *results[name], problem, quick) for name, problem in data["problems"].items()),
            Section("Targets", (table,), "targets"),
        ),
        facts=(
            Fact(f"{met} of {len(targets)}", "targets are met", all(row["met"] for row in targets)),
            Fact(str(sum(len(result.points) for _, result in results.values())), f"ways through {problems}"),
            Fact(times(most), "an engine's best time over ours, at equal error, where it is most"),
        ),
        digest=(table, *failures),
        unfinished=unfinished,
        decisions=(DECISION, decisions),
        missed=tuple(
            f"{row['title']} at {row['error']}: {row['v'].winner}; asked is {short(row['v'].target.ratio)} times "
            f"{row['v'].target.engine}'s speed"
            for row in targets
            if not row["met"]
        ),
    )


def _loses(best: Point, other: Point | None, name: str | None) -> str:
    if other is None:
        return "no other"
    ratio = other.seconds / best.seconds
    return f"{times(ratio) if ratio >= 2.0 else f'{100 * (ratio - 1):.0f} %'} {name}"


def _section(name: str, problem: BenchmarkProblem, result: Result, data: Data, quick: bool) -> Section:
    agree = f"They agree to {problem.shown(result.agreement)}; asked for is {problem.shown(problem.trust)}."
    command = f"python -m validation pareto --problem {name}{' --quick' if quick else ''}"
    best = front(charted(problem, result.points))
    runs = "method = {by}; model; step or tolerance = {setting}; #error = shown(); #time = {seconds:time}"
    on_front = Table.of(best, runs, shown=lambda point: problem.shown(point.error))
    ended = Bullets(tuple(verdicts.refused(result)))
    blocks = (
        f"{problem.setting} **Error:** {problem.measure}.",
        figure(problem, result),
        "Least time of each method, whatever its model and step, at errors asked for:",
        _methods(problem, result),
        Fold(f"The {len(best)} runs of the front", (on_front,)),
        f"**Tuned:** {problem.tuned}",
        Text(f"**References:** {result.references}. {agree}", "plain" if result.agreement <= problem.trust else "bad"),
        Fold(f"{len(result.points)} runs; those that did not come to their end", (ended,), page_only=True),
        Text(f"`{command}`, {result.seconds:.0f} s, {data['date']}. Sources: {'; '.join(problem.sources)}.", "soft"),
    )
    return Section(problem.title, blocks, name, bool(data["ok"]))


def _methods(problem: BenchmarkProblem, result: Result) -> Table:
    """A line a method: its times at the target errors, its least error, and the model and step that reach it."""
    groups = grouped(usable(result.points), lambda point: point.by)
    errors = sorted({target.error for target in problem.targets}, reverse=True)
    rows = []
    for name, points in groups.items():
        best = min(points, key=lambda p: p.error)
        at = [seconds_at(points, error) for error in errors]
        rows.append({"name": name, "at": at, "least": best, "shown": problem.shown(best.error)})
    rows.sort(key=lambda row: (row["at"][::-1], row["least"].error))
    at_errors = "".join(f"#{problem.shown(error)} = {{at[{k}]:time}}; " for k, error in enumerate(errors))
    least = "#least error = {shown}; by = {least.model}, {least.setting}; #in = {least.seconds:time}"
    return Table.of(rows, f"method = {{name}}; {at_errors}{least}")


TOPIC = Topic("pareto", "Accuracy against time", "Which model is the cheapest that is good enough?", compose, measure)
