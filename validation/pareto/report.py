"""Speed against accuracy: what is run, what is kept of it, and the report."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Annotated, Any

import typer

from validation.pareto import verdicts
from validation.pareto.catalogue import PROBLEMS
from validation.pareto.figures import figure, letters, models_chart
from validation.pareto.front import charted, front
from validation.pareto.problem import BenchmarkProblem, Point
from validation.pareto.race import Result, race
from validation.reporting.command import Done, Quick, Run, known
from validation.reporting.numbers import counted, duration, finite, short, times
from validation.reporting.provenance import machine, now
from validation.reporting.record import (
    Block,
    Bullets,
    Cell,
    Data,
    Fact,
    Fold,
    Report,
    Section,
    Table,
    Text,
    Topic,
    failure_texts,
    verdict_word,
)

ENGINES = ("mujoco", "exudyn", "pin")
INTRO = (
    "Error against time, both logarithmic. One thread; times are those of the processor, of the stepping alone, "
    "least of up to nine repeats; models are compiled, and engines' systems assembled, before. Both sides record at "
    "the same interval. An engine's best is the best of all its runs here. Between two steps of one method times are "
    "interpolated, between methods or models they are not. A fixed step that a solver can't finish ends its run.",
    "Accelerations in single precision are a series of their own on the rigid arm: the generated code has floats for "
    "batches alone, so a motion by itself pays for all lanes of a vector and uses one; what batches gain is in the "
    "report on timing.",
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
        return problem_data(PROBLEMS[name], result, now())

    def data(done: Done) -> dict[str, Any]:
        problems = kept | done.results
        whole = Done(problems, done.failures, done.unfinished)
        ok = all(problem["ok"] for problem in problems.values())
        return run.head(ok, whole, *ENGINES, quick=quick) | {
            "problems": {n: problems[n] for n in PROBLEMS if n in problems}
        }

    # Each is kept as soon as it is done.
    return data(run.each(names, raced, lambda done: run.save(data(done))))


def _kept(run: Run, quick: bool) -> dict[str, Any]:
    """What an earlier run left on this machine, in the same way: problems by name."""
    path = run.folder / "pareto.json"
    data = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    if not data or data["quick"] != quick or data["machine"] != machine():
        return {}
    return {name: problem for name, problem in data["problems"].items() if name in PROBLEMS}


def problem_data(problem: BenchmarkProblem, result: Result, date: str) -> dict[str, Any]:
    """A problem that was run, for JSON."""
    judged = verdicts.verdicts(problem, result.points)
    points = [asdict(p) | {"error": finite(p.error), "seconds": finite(p.seconds)} for p in result.points]
    return {
        "title": problem.title,
        "measure": problem.measure,
        "ok": result.agreement <= problem.trust and all(v.ok for v in judged),
        "date": date,
        "agreement": finite(result.agreement),
        "trust": problem.trust,
        "references": result.references,
        "floors": dict(result.floors),
        "seconds": round(result.seconds, 1),
        "targets": [
            asdict(v.target) | {"found": "only ours" if math.isinf(v.ratio) else finite(v.ratio), "ok": v.ok}
            for v in judged
        ],
        "words": [*verdicts.compared(problem, result.points), *verdicts.advice(problem, result)],
        "front": [point.name for point in front(charted(problem, result.points))],
        "points": points,
    }


def result_of(problem: Data) -> Result:
    """The result that `problem_data` wrote."""

    def real(x: float | None) -> float:
        return math.nan if x is None else float(x)

    points = tuple(Point(**p | {"error": real(p["error"]), "seconds": real(p["seconds"])}) for p in problem["points"])
    return Result(points, real(problem["agreement"]), problem["references"], problem["floors"], problem["seconds"])


def compose(data: Data) -> Report:
    """The report of its JSON."""
    results = {name: (PROBLEMS[name], result_of(problem)) for name, problem in data["problems"].items()}
    failures, unfinished = data["failures"], tuple(data["unfinished"])
    targets = [target for problem in data["problems"].values() for target in problem["targets"]]
    met = sum(target["ok"] for target in targets)
    runs = sum(len(result.points) for _, result in results.values())
    doubted = [name for name, (problem, result) in results.items() if not result.agreement <= problem.trust]
    said = f"{met} of {counted(len(targets), 'target')} met, in {counted(len(results), 'problem')}"
    said += " (quick variant: few contestants, so its ratios mean little)" if data["quick"] else ""
    said += f"; references disagree on {', '.join(doubted)}" if doubted else ""
    said += f"; {counted(len(failures), 'problem')} could not be done" if failures else ""
    said += f"; interrupted before {', '.join(unfinished)}" if unfinished else ""
    most = max((t["found"] for t in targets if isinstance(t["found"], float)), default=0.0)
    table = _targets(results)
    advice = tuple(
        f"**{problem.title}.** {_which(problem, result)} {verdicts.methods(problem, result)}"
        for problem, result in results.values()
    )
    which: tuple[Block, ...] = (verdicts.overall(results), table, Bullets(advice))
    first = next(iter(results.values()), None)
    return Report(
        "Speed against accuracy",
        f"{said}.",
        bool(data["ok"]),
        (*INTRO, *failure_texts(failures)),
        (
            Section("Which to use when", which, "which"),
            *(_section(name, *results[name], problem, data["quick"]) for name, problem in data["problems"].items()),
        ),
        (
            Fact(f"{met} of {len(targets)}", "targets are met", met == len(targets)),
            Fact(str(runs), f"ways through {counted(len(results), 'problem')}"),
            Fact(times(most), "an engine's best time over ours, at equal error, where it is most"),
        ),
        (models_chart(*first),) if first else (),
        (table, *failure_texts(failures)),
        unfinished,
    )


def _targets(results: Mapping[str, tuple[BenchmarkProblem, Result]]) -> Table:
    head = ("problem", "#at error", "against", "#ours", "#its best", "#ratio", "#asked", "verdict")
    rows = [
        (
            f"[{problem.title}](#{name})",
            problem.shown(v.target.error),
            v.target.engine,
            duration(v.seconds),
            duration(v.engine_seconds),
            Cell("only ours" if math.isinf(v.ratio) else f"{v.ratio:.3g}", v.ok),
            short(v.target.ratio),
            verdict_word(v.ok),
        )
        for name, (problem, result) in results.items()
        for v in verdicts.verdicts(problem, result.points)
    ]
    return Table(head, tuple(rows))


def _which(problem: BenchmarkProblem, result: Result) -> str:
    return " ".join([*verdicts.compared(problem, result.points), verdicts.below_the_floor(problem, result)]).strip()


def _section(name: str, problem: BenchmarkProblem, result: Result, data: Data, quick: bool) -> Section:
    best = front(charted(problem, result.points))
    rows = tuple(
        (letter, p.who, p.model, p.method, p.setting, problem.shown(p.error), duration(p.seconds))
        for letter, p in zip(letters(len(best)), best, strict=True)
    )
    trusted = result.agreement <= problem.trust
    agree = problem.shown(result.agreement)
    command = f"python -m validation pareto --problem {name}{' --quick' if quick else ''}"
    blocks: tuple[Block, ...] = (
        f"{problem.setting} **Error:** {problem.measure}.",
        figure(problem, result, verdicts.see(problem, result)),
        Text(f"**Which when.** {_which(problem, result)}", "advice"),
        Table(("run", "who", "model", "method", "step or tolerance", "#error", "#time"), rows),
        f"**Tuned:** {problem.tuned}",
        Text(
            f"**References:** {result.references}. They agree to {agree}; asked for is {problem.shown(problem.trust)}.",
            "plain" if trusted else "bad",
        ),
        Fold(
            f"{len(result.points)} runs; those that did not come to their end",
            (Bullets(tuple(verdicts.refused(result))),),
            page_only=True,
        ),
        Text(f"`{command}`, {result.seconds:.0f} s, {data['date']}. Sources: {'; '.join(problem.sources)}.", "soft"),
    )
    return Section(problem.title, blocks, name, bool(data["ok"]))


TOPIC = Topic("pareto", "Accuracy against time", "Which model is the cheapest that is good enough?", compose)
