"""The cross-check as a command: what is asked of which models, against which stored run; its result in JUnit files."""

from __future__ import annotations

import contextlib
import os
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

import symofros as sf
from symofros.commands.reading import ReadingOptions, reads_models
from symofros.tools import write_atomically

from ..adapters import ROUTES, require_engines
from ..checking import ModelResult, Settings
from ..comparison.errors import Comparison
from ..inputs.cases import Case, named
from ..inputs.sampling import DEFAULT_STATES
from ..reporting.command import Exit, Run
from ..reporting.record import Data
from ..worker_pool import longest_first
from ..worker_pool import run as run_cases
from .baseline import Baseline, BaselineError, Regression, machine_of, slowest
from .record import Record, as_data
from .speed import Speed, YardstickError
from .speed import measure as measure_speed

# What XML 1.0 has no way to write; messages may quote anything.
_ILLEGAL = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def to_junit(models: Sequence[ModelResult], seconds: float, regressions: Sequence[Regression] = ()) -> str:
    """One suite a model, one case a comparison; a suite of what is worse than in a stored run.

    Args:
        models: Outcomes; the time of a suite is that of all stages of its check.
        seconds: Time of the whole run [s].
        regressions: What is worse than in a stored run.
    """
    root = ElementTree.Element("testsuites", name="symofros cross-check", time=f"{seconds:.1f}")
    for model in models:
        _suite(root, model)
    if regressions:
        count = str(len(regressions))
        suite = ElementTree.SubElement(root, "testsuite", name="baseline", tests=count, failures=count)
        suite.attrib |= {"errors": "0", "skipped": "0"}
        for worse in regressions:
            cell = {
                "classname": f"baseline.{worse.model}",
                "name": " ".join(filter(None, (worse.quantity, worse.engine))),
            }
            ElementTree.SubElement(
                ElementTree.SubElement(suite, "testcase", cell), "failure", message=f"{worse.kind}: {worse.text}"
            )
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode")
    return '<?xml version="1.0" encoding="utf-8"?>\n' + _ILLEGAL.sub("?", text) + "\n"


def _suite(root: ElementTree.Element, model: ModelResult) -> None:
    rows = model.comparisons
    counts = {
        "tests": len(rows),
        "failures": sum(row.status == "disagree" for row in rows),
        "errors": sum(row.status == "failed" for row in rows),
        "skipped": sum(row.status == "unsupported" for row in rows),
    }
    stated = {"name": model.label, **{key: str(value) for key, value in counts.items()}}
    suite = ElementTree.SubElement(root, "testsuite", stated, time=f"{sum(model.seconds.values()):.3f}")
    for row in rows:
        case = ElementTree.SubElement(suite, "testcase", classname=f"{row.model}.{row.engine}", name=row.quantity)
        _verdict(case, row)


def _verdict(case: ElementTree.Element, row: Comparison) -> None:
    if row.status == "disagree":
        message = f"error {row.error} exceeds {row.tolerance} in state {row.worst_state} of {row.states}"
        ElementTree.SubElement(case, "failure", message=f"{message}; {row.note}" if row.note else message)
    elif row.status == "failed":
        ElementTree.SubElement(case, "error", message=row.note)
    elif row.status == "unsupported":
        ElementTree.SubElement(case, "skipped", message=row.note)


# Times that speeds are taken again where they seem lower than in a stored run.
_EXTRA_TIMINGS = 2
# Models checked at the same time.
WORKERS = min(os.cpu_count() or 1, 4)


@reads_models
def measure(
    run: Run,
    models: Annotated[
        list[str] | None,
        typer.Argument(help="URDF, MJCF, SDF, USD or YAML files, or names of the standard set; none: all of it."),
    ] = None,
    *,
    reading: ReadingOptions,
    states: Annotated[int, typer.Option(min=1, help="Random states a model.")] = DEFAULT_STATES,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random states.")] = 0,
    engine: Annotated[
        list[str] | None,
        typer.Option("--engine", help=f"Only this engine; repeatable. {', '.join(ROUTES)}, or a plug-in of `engines`."),
    ] = None,
    junit: Annotated[Path | None, typer.Option(help="Also write a JUnit file.")] = None,
    workers: Annotated[int, typer.Option(min=1, help="Models checked at the same time.")] = WORKERS,
    full: Annotated[bool, typer.Option("--full", help="Also ask what takes long on large models.")] = False,
    speed: Annotated[bool, typer.Option("--speed", help="Also time our functions, against a fixed program.")] = False,
    baseline: Annotated[
        Path | None, typer.Option(help="A stored check.json: fail where this run is less accurate or slower.")
    ] = None,
) -> Data:
    """Compare our C of each MODEL with every engine that can represent it."""
    try:
        require_engines(engine or ())
    except LookupError as error:
        raise typer.BadParameter(str(error), param_hint="--engine") from None
    settings = Settings(states, seed, tuple(engine) if engine else None, full=full)
    stored = _baseline(baseline, settings)
    cases = _cases(models or [], reading)
    first = ", ".join(case.label for case in longest_first(cases)[:workers])
    run.expect(len(cases), f"cross-checking {first}")
    results: dict[str, ModelResult] = {}

    def done(result: ModelResult) -> None:
        results[result.label] = result
        count = len(result.compared)
        wrong = [row for row in result.comparisons if not row.ok]
        differs, unjudged = any(row.status == "disagree" for row in wrong), all(row.unconfirmed for row in wrong)
        verdict = "DISAGREES" if differs else f"{count} agree, judged by no engine" if unjudged else "FAILED"
        verdict = f"{count} agree" if result.ok else verdict
        run.advance(f"{result.label}: {verdict}, {sum(result.seconds.values()):.1f} s")

    with contextlib.suppress(KeyboardInterrupt):  # What was finished is reported.
        run_cases(cases, settings, workers, done)
    finished = [results[case.label] for case in cases if case.label in results]
    unfinished = [case.label for case in cases if case.label not in results]
    # The report of the standard set is not replaced by one of some models or engines, unless that is asked for.
    run.writes = run.asked or not (models or engine)
    compiled = [case for case in cases if case.label in results and results[case.label].sizes]
    wanted = (speed or (stored is not None and bool(stored.record.speeds))) and not unfinished
    speeds = _speeds(run, compiled, stored) if wanted else []
    data: Data = as_data(settings, finished, run.seconds, unfinished, speeds)
    regressions: list[Regression] = []
    if stored is not None:
        data, regressions = _with_baseline(stored, data)
    if junit is not None:
        junit.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(junit, to_junit(finished, run.seconds, regressions))
    return data


def _with_baseline(stored: Baseline, data: Data) -> tuple[Data, list[Regression]]:
    """A run's data with the results of its comparison with a baseline, and the regressions."""
    regressions, notes = stored.judge(Record.of(data), machine_of(data))
    origin = {"file": stored.name, "revision": stored.revision, "date": stored.date, "notes": notes}
    baseline = origin | {"regressions": [asdict(worse) for worse in regressions]}
    return {**data, "ok": data["ok"] and not regressions, "baseline": baseline}, regressions


def _cases(models: list[str], reading: ReadingOptions) -> list[Case]:
    """The models that are named.

    Raises:
        typer.BadParameter: There is none of a name.
        typer.Exit: The only file is missing.
    """
    try:
        cases = named(models, reading)
        files = [case.path for case in cases if case.path is not None]
        if len(files) == len(cases) and not any(path.exists() for path in files):
            sf.load(files[0])  # Says that it is missing, and what is there; beside others it is one that fails.
    except (LookupError, FileNotFoundError) as error:
        raise typer.BadParameter(str(error.args[0]), param_hint="MODEL") from None
    except sf.SymofrosError as error:
        typer.echo(error.in_shell(), err=True)
        raise typer.Exit(Exit.BAD_INPUT) from None
    return cases


def _baseline(path: Path | None, settings: Settings) -> Baseline | None:
    """The stored run, before anything is computed in vain."""
    if path is None:
        return None
    try:
        stored = Baseline.read(path)
        stored.require(settings.states, settings.seed)
    except BaselineError as error:
        raise typer.BadParameter(str(error), param_hint="--baseline") from None
    return stored


def _speeds(run: Run, cases: Sequence[Case], stored: Baseline | None) -> list[Speed]:
    """Speeds, one model after the other; what looks slower than in the stored run is timed again, and its best kept."""
    before = {} if stored is None else {(row.model, row.function): row for row in stored.record.speeds}
    run.expect(len(cases), "timing")
    speeds: list[Speed] = []
    for case in cases:
        try:
            subject = case.load()
            timed = measure_speed(subject)
            for _ in range(_EXTRA_TIMINGS):
                if not any(_is_slower(before.get((row.model, row.function)), row) for row in timed):
                    break
                timed = [
                    min(pair, key=lambda row: row.ratio) for pair in zip(timed, measure_speed(subject), strict=True)
                ]
            speeds += timed
        except (YardstickError, sf.SymofrosError) as error:
            run.say(f"{case.label}: not timed: {error}", bad=True)
        run.advance(case.label)
    return speeds


def _is_slower(stored: Speed | None, fresh: Speed) -> bool:
    return stored is not None and fresh.ratio > slowest(stored, fresh)
