"""Races of speed against accuracy as a command; what an earlier run left is kept."""

from __future__ import annotations

import math
from typing import Annotated, Any

import typer

from symofros.tools import stored_json

from ..reporting.command import Done, Quick, Run, known
from ..reporting.plain import plain
from ..reporting.provenance import machine, now
from ..reporting.record import Data
from . import verdicts
from .catalogue import PROBLEMS
from .problem import BenchmarkProblem
from .race import Result, race


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
