"""Speed against accuracy: what is run, what is kept of it, and the report."""

from __future__ import annotations

import json
import math
from typing import Annotated, Any

import typer

from validation.pareto import verdicts
from validation.pareto.catalogue import PROBLEMS
from validation.pareto.figures import figure, front_drawing, grouped
from validation.pareto.front import charted, front, seconds_at, usable
from validation.pareto.problem import OURS, BenchmarkProblem, Point
from validation.pareto.race import Result, race
from validation.reporting.command import Done, Quick, Run, known
from validation.reporting.numbers import counted, duration, short, times
from validation.reporting.plain import plain, restored
from validation.reporting.provenance import machine, now
from validation.reporting.questions import failure_texts
from validation.reporting.record import Bullets, Cell, Column, Data, Fact, Fold, Report, Section, Table, Text, Topic

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


def measure(
    run: Run,
    chosen: Annotated[list[str] | None, typer.Option("--problem", help=f"Only this; of {', '.join(PROBLEMS)}.")] = None,
    quick: Quick = False,
    resume: Annotated[bool, typer.Option("--resume", help="Leave out problems that pareto.json has.")] = False,
) -> Data:
    """Compare speed at equal accuracy: our models and methods, and engines with their own integrators.

    Problems that are not run again keep the results that pareto.json has of them; those of --quick have a subfolder.
    """
    names = known(chosen, PROBLEMS, "--problem", "problem")
    if quick:
        run.folder = run.folder / "pareto_quick"
    kept = _kept(run, quick)
    names = [name for name in names if not (resume and name in kept)]

    def raced(name: str) -> dict[str, Any]:
        run.expect(1, f"{name}: references")
        result = race(PROBLEMS[name], quick, lambda count: run.expect(count, name), run.advance)
        return problem_data(PROBLEMS[name], result, now(), quick)

    def data(done: Done) -> dict[str, Any]:
        problems = kept | done.results
        whole = Done(problems, done.failures, done.unfinished)
        ok = all(problem["ok"] for problem in problems.values())
        return whole.head(ok, quick) | {"problems": {name: problems[name] for name in PROBLEMS if name in problems}}

    # Each is kept as soon as it is done.
    return data(run.each(names, raced, lambda done: run.save(data(done))))


def _kept(run: Run, quick: bool) -> dict[str, Any]:
    """What an earlier run left on this machine, in the same way: problems by name."""
    path = run.folder / "pareto.json"
    data = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    if not data or data["quick"] != quick or data["machine"] != machine():
        return {}
    return {name: problem for name, problem in data["problems"].items() if name in PROBLEMS}


def problem_data(problem: BenchmarkProblem, result: Result, date: str, quick: bool = False) -> dict[str, Any]:
    """A problem that was run, for JSON: what was measured, and the verdicts on it."""
    judged = verdicts.verdicts(problem, result.points, quick)
    return {
        **plain(result),
        "title": problem.title,
        "ok": result.agreement <= problem.trust and all(v.ok is not False for v in judged),
        "date": date,
        "targets": [
            {**vars(v.target), "found": "only ours" if math.isinf(v.ratio) else plain(v.ratio), "ok": v.ok}
            for v in judged
        ],
    }


_DECISIONS: dict[str, Column] = {
    "scene": lambda row: f"[{row[1].title}]({row[0]})",
    "#error at most": lambda row: row[2].error,
    "method": lambda row: _method(row[2].best),
    "model": lambda row: row[2].best.model,
    "step or tolerance": lambda row: row[2].best.setting,
    "#time": lambda row: duration(row[2].best.seconds),
    "next best method loses by": lambda row: _loses(row[2].best, row[2].rival, _method(row[2].rival)),
    "other side loses by": lambda row: _loses(row[2].best, row[2].other, row[2].other.who if row[2].other else ""),
}
_TARGETS: dict[str, Column] = {
    "scene": lambda row: f"[{row[1].title}](#{row[0]})",
    "#at error": lambda row: row[1].shown(row[2].target.error),
    "against": lambda row: row[2].target.engine,
    "#ours": lambda row: duration(row[2].seconds),
    "#its best": lambda row: duration(row[2].engine_seconds),
    "winner": lambda row: Cell(row[2].winner, row[2].ok),
    "#asked": lambda row: short(row[2].target.ratio),
    "verdict": lambda row: {True: "ok", False: "missed", None: "not measured"}[row[2].ok],
}


def compose(data: Data) -> Report:
    """The report of its JSON."""
    results = {name: (PROBLEMS[name], restored(Result, problem)) for name, problem in data["problems"].items()}
    failures, unfinished = failure_texts(data["failures"]), tuple(data["unfinished"])
    quick = data["quick"]
    judged = [(name, *one, v) for name, one in results.items() for v in verdicts.verdicts(one[0], one[1].points, quick)]
    met, problems = sum(row[3].ok is True for row in judged), counted(len(results), "problem")
    runs = sum(len(result.points) for _, result in results.values())
    doubted = [name for name, (problem, result) in results.items() if not result.agreement <= problem.trust]
    said = f"{met} of {counted(len(judged), 'target')} met, in {problems}"
    said += " (quick variant: few contestants, so its ratios mean little)" if quick else ""
    said += f"; references disagree on {', '.join(doubted)}" if doubted else ""
    said += f"; {counted(len(failures), 'problem')} could not be done" if failures else ""
    said += f"; interrupted before {', '.join(unfinished)}" if unfinished else ""
    most = max((v.ratio for *_, v in judged if math.isfinite(v.ratio)), default=0.0)
    targets = Table.of(((name, problem, v) for name, problem, _, v in judged), _TARGETS)
    chosen = ((name, *one, choice) for name, one in results.items() for choice in verdicts.choices(*one))
    return Report(
        "Speed against accuracy",
        f"{said}.",
        bool(data["ok"]),
        (*INTRO, *failures),
        (
            *(_section(name, *results[name], problem, data["quick"]) for name, problem in data["problems"].items()),
            Section("Targets", (targets,), "targets"),
        ),
        facts=(
            Fact(f"{met} of {len(judged)}", "targets are met", all(v.ok is not False for *_, v in judged)),
            Fact(str(runs), f"ways through {problems}"),
            Fact(times(most), "an engine's best time over ours, at equal error, where it is most"),
        ),
        highlights=tuple(front_drawing(*first) for first in list(results.values())[:1]),
        digest=(targets, *failures),
        unfinished=unfinished,
        decisions=(
            DECISION,
            Table.of(((f"pareto.html#{name}", problem, choice) for name, problem, _, choice in chosen), _DECISIONS),
        ),
        missed=tuple(
            f"{problem.title} at {problem.shown(v.target.error)}: {v.winner}; asked is {short(v.target.ratio)} times "
            f"{v.target.engine}'s speed"
            for _, problem, _, v in judged
            if v.ok is False
        ),
    )


def _method(point: Point | None) -> str:
    return "" if point is None else point.method if point.who == OURS else f"{point.who}: {point.method}"


def _loses(best: Point, other: Point | None, name: str) -> str:
    if other is None:
        return "no other"
    ratio = other.seconds / best.seconds
    return f"{times(ratio) if ratio >= 2.0 else f'{100 * (ratio - 1):.0f} %'} {name}"


def _section(name: str, problem: BenchmarkProblem, result: Result, data: Data, quick: bool) -> Section:
    runs: dict[str, Column] = {
        "method": _method,
        "model": "{model}",
        "step or tolerance": "{setting}",
        "#error": lambda point: problem.shown(point.error),
        "#time": "{seconds:time}",
    }
    agree = f"They agree to {problem.shown(result.agreement)}; asked for is {problem.shown(problem.trust)}."
    command = f"python -m validation pareto --problem {name}{' --quick' if quick else ''}"
    best = front(charted(problem, result.points))
    ended = Bullets(tuple(verdicts.refused(result)))
    blocks = (
        f"{problem.setting} **Error:** {problem.measure}.",
        figure(problem, result),
        "Least time of each method, whatever its model and step, at errors asked for:",
        _methods(problem, result),
        Fold(f"The {len(best)} runs of the front", (Table.of(best, runs),)),
        f"**Tuned:** {problem.tuned}",
        Text(f"**References:** {result.references}. {agree}", "plain" if result.agreement <= problem.trust else "bad"),
        Fold(f"{len(result.points)} runs; those that did not come to their end", (ended,), page_only=True),
        Text(f"`{command}`, {result.seconds:.0f} s, {data['date']}. Sources: {'; '.join(problem.sources)}.", "soft"),
    )
    return Section(problem.title, blocks, name, bool(data["ok"]))


def _methods(problem: BenchmarkProblem, result: Result) -> Table:
    """A line a method: its times at the target errors, its least error, and the model and step that reach it."""
    groups = grouped(usable(result.points), _method)
    errors = sorted({target.error for target in problem.targets}, reverse=True)
    least = {name: min(points, key=lambda p: p.error) for name, points in groups.items()}
    order = sorted(
        groups, key=lambda name: ([seconds_at(groups[name], e) for e in reversed(errors)], least[name].error)
    )

    def at(error: float) -> Column:
        return lambda name: duration(seconds_at(groups[name], error)).replace("no time", "-")

    columns: dict[str, Column] = {
        "method": str,
        **{f"#{problem.shown(error)}": at(error) for error in errors},
        "#least error": lambda name: problem.shown(least[name].error),
        "by": lambda name: f"{least[name].model}, {least[name].setting}",
        "#in": lambda name: duration(least[name].seconds),
    }
    return Table.of(order, columns)


TOPIC = Topic("pareto", "Accuracy against time", "Which model is the cheapest that is good enough?", compose, measure)
