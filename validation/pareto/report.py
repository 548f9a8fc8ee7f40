"""Speed against accuracy: which method on which model; the races behind it, as a command that keeps earlier runs."""

from __future__ import annotations

import math
from typing import Annotated, Any

import typer

from symofros.tools import stored_json

from ..program import PROGRAM
from ..reporting.command import Done, Quick, Run, known
from ..reporting.numbers import counted, duration, short, times
from ..reporting.plain import plain, restored
from ..reporting.provenance import machine, now
from ..reporting.questions import failure_texts
from ..reporting.record import Bullets, Data, Fact, Report, Section, Table, Text, Topic, verdict
from .figures import figure, grouped
from .front import charted, front, seconds_at, usable
from .problem import BenchmarkProblem, Point
from .problems import andrews, arm, four_bar, pendulum, robot, soft_pendulum, spin_up, walls
from .race import Result, race
from .verdicts import choices, refused, verdicts

PROBLEMS: dict[str, BenchmarkProblem] = {
    "spin_up": spin_up.PROBLEM,
    "robot": robot.PROBLEM,
    "soft_pendulum": soft_pendulum.PROBLEM,
    "arm": arm.PROBLEM,
    "four_bar": four_bar.PROBLEM,
    "andrews": andrews.PROBLEM,
    "pendulum": pendulum.PROBLEM,
    "walls": walls.PROBLEM,
}


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
    """Problems by name from an earlier run on this machine with the same settings; none without one."""

    def kept(data: Any) -> dict[str, Any]:
        if data["quick"] != quick or data["machine"] != machine():
            return {}
        return {name: dict(problem) for name, problem in data["problems"].items() if name in PROBLEMS}

    return stored_json(run.folder / "pareto.json", kept) or {}


def problem_data(problem: BenchmarkProblem, result: Result, date: str, quick: bool = False) -> dict[str, Any]:
    """A problem that was run, for JSON: what was measured, and the verdicts on it."""
    judged = verdicts(problem, result.points, quick)
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


INTRO = (
    """Error against time, both logarithmic. One thread; times are those of the processor, of the stepping alone, least
    of up to nine repeats; models are compiled, and engines' systems assembled, before. Both sides record at the same
    interval. An engine's best is the best of all its runs here. Between two steps of one method times are interpolated,
    between methods or models they are not. A fixed step that a solver can't finish ends its run.""",
    """Accelerations in single precision are a series of their own on the rigid arm: the generated code has floats for
    batches alone, so a motion by itself pays for all lanes of a vector and uses one; what batches gain is in the report
    on timing.""",
)
DECISION = "**Which method, on which model:** the fastest run that keeps the error, in each scene."
_EXPLAINED = """Time is the processor's for the stepping alone; the next best method, and the best engine of the other
side, take so much more of it."""
_CHOICES = """scene | error at most | method | model | step or tolerance | time | next best method | other side"""
_TARGETS = "scene | at error | against | ours | its best | winner | asked | verdict"


def compose(data: Data) -> Report:
    """The report of its JSON."""
    results = {name: (PROBLEMS[name], restored(Result, problem)) for name, problem in data["problems"].items()}
    failures, unfinished, quick = failure_texts(data["failures"]), tuple(data["unfinished"]), data["quick"]
    judged = [(name, one, v) for name, (one, result) in results.items() for v in verdicts(one, result.points, quick)]
    met, problems = sum(v.ok is True for _, _, v in judged), counted(len(results), "problem")
    doubted = [name for name, (one, result) in results.items() if not result.agreement <= one.trust]
    asked = sum(v.ok is not None for _, _, v in judged)
    said = f"{met} of {counted(asked, 'target')} met" if asked else "no target could be judged"
    said += f", {len(judged) - asked} not measured" if 0 < asked < len(judged) else ""
    said += f", in {problems}"
    said += " (quick variant: few contestants, so its ratios mean little)" if quick else ""
    said += f"; references disagree on {', '.join(doubted)}" if doubted else ""
    said += f"; {counted(len(failures), 'problem')} could not be done" if failures else ""
    said += f"; interrupted before {', '.join(unfinished)}" if unfinished else ""
    most = max((v.ratio for _, _, v in judged if math.isfinite(v.ratio)), default=0.0)
    labels = {True: "ok", False: "missed", None: "not measured"}
    rows = (
        f"[{one.title}](#{name}) | {one.shown(v.target.error)} | {v.target.engine} | {duration(v.seconds)} | "
        f"{duration(v.engine_seconds)} | {verdict(v.winner, v.ok)} | {short(v.target.ratio)} | {labels[v.ok]}"
        for name, one, v in judged
    )
    targets = Table.of(_TARGETS, rows)
    return Report(
        "Speed against accuracy",
        f"{said}.",
        bool(data["ok"]),
        (*INTRO, *failures),
        (
            *(_section(name, *results[name], problem, quick) for name, problem in data["problems"].items()),
            Section("Targets", (targets,), "targets"),
        ),
        facts=(
            Fact(f"{met} of {len(judged)}", "targets are met", all(v.ok is not False for _, _, v in judged)),
            Fact(str(sum(len(result.points) for _, result in results.values())), f"ways through {problems}"),
            Fact(times(most), "an engine's best time over ours, at equal error, where it is most"),
        ),
        digest=(targets, *failures),
        unfinished=unfinished,
        decisions=(
            DECISION,
            Table.of(_CHOICES, (row for name, pair in results.items() for row in _chosen(name, *pair)), grouped=True),
            Text(_EXPLAINED, "soft"),
        ),
        missed=tuple(
            f"{one.title} at {one.shown(v.target.error)}: {v.winner}; asked is {short(v.target.ratio)} times "
            f"{v.target.engine}'s speed"
            for _, one, v in judged
            if v.ok is False
        ),
        aims=not failures,
    )


def _chosen(name: str, problem: BenchmarkProblem, result: Result) -> list[str]:
    """Table rows of the best choice at each error; the first one names the scene and its error."""

    def loss(best: Point, other: Point | None, who: str) -> str:
        if other is None:
            return "no other"
        ratio = other.seconds / best.seconds
        return f"{who} takes {f'{times(ratio)} the time' if ratio >= 2.0 else f'{100 * (ratio - 1):.0f} % more'}"

    scene = f"[{problem.title}](pareto.html#{name}): {problem.axis.removesuffix('  [1]')}"
    rows: list[str] = []
    for one in choices(problem, result):
        best, rival, other = one.best, one.rival, one.other
        losses = f"{loss(best, rival, rival.by if rival else '')} | {loss(best, other, other.who if other else '')}"
        run = f"{best.by} | {best.model} | {best.setting} | {duration(best.seconds)}"
        rows.append(f"{'' if rows else scene} | {one.error} | {run} | {losses}")
    return rows


def _section(name: str, problem: BenchmarkProblem, result: Result, data: Data, quick: bool) -> Section:
    agree = f"They agree to {problem.shown(result.agreement)}; asked for is {problem.shown(problem.trust)}."
    command = f"{PROGRAM} pareto --problem {name}{' --quick' if quick else ''}"
    best, ended = front(charted(problem, result.points)), Bullets(tuple(refused(result)))
    runs = (f"{p.by} | {p.model} | {p.setting} | {problem.shown(p.error)} | {duration(p.seconds)}" for p in best)
    blocks = (
        f"{problem.setting} **Error:** {problem.measure}.",
        figure(problem, result),
        "Least time of each method, whatever its model and step, at errors asked for:",
        _methods(problem, result),
        Section(
            f"The {len(best)} runs of the front", (Table.of("method | model | step or tolerance | error | time", runs),)
        ),
        f"**Tuned:** {problem.tuned}",
        Text(f"**References:** {result.references}. {agree}", "plain" if result.agreement <= problem.trust else "bad"),
        Section(f"{len(result.points)} runs; those that did not come to their end", (ended,), page_only=True),
        Text(f"`{command}`, {result.seconds:.0f} s, {data['date']}. Sources: {'; '.join(problem.sources)}.", "soft"),
    )
    return Section(problem.title, blocks, name, bool(data["ok"]))


def _methods(problem: BenchmarkProblem, result: Result) -> Table:
    """A line a method: its times at the target errors, its least error, and the model and step that reach it."""
    errors = sorted({target.error for target in problem.targets}, reverse=True)
    ranked = []
    for name, points in grouped(usable(result.points), lambda point: point.by).items():
        least, at = min(points, key=lambda p: p.error), [seconds_at(points, error) for error in errors]
        reached = problem.shown(least.error), f"{least.model}, {least.setting}", duration(least.seconds)
        ranked.append((at[::-1], least.error, (name, *map(duration, at), *reached)))
    ranked.sort(key=lambda row: row[:2])
    head = " | ".join(["method", *map(problem.shown, errors), "least error | by | in"])
    return Table.of(head, (row for *_, row in ranked))


TOPIC = Topic("pareto", "Accuracy against time", "Which model is the cheapest that is good enough?", compose, measure)
