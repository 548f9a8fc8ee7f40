"""Faults before two judges as a command: what is known of each, and the scores."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Any

import typer

from ..reporting.command import Run
from ..reporting.record import Data
from .study import (
    CAUGHT,
    CHECK,
    OPEN,
    OUTPUTS,
    SURVIVED,
    TESTS,
    Study,
    seen,
)

_ROOT = Path(__file__).parents[2]
BOTH, CHECK_ALONE = 0.98, 0.85  # Asked-for shares of the faults that change a result.


def measure(
    run: Run,
    faults: Annotated[int, typer.Option(min=1, help="Number of faults, spread over all modules.")] = 600,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the draw.")] = 0,
    seconds: Annotated[float, typer.Option(min=0.0, help="Time after which no further fault is begun [s].")] = 36000.0,
    work: Annotated[
        Path, typer.Option(help="Folder of the copy of the tree, of answers; an old one is gone on with.")
    ] = Path("mutants"),
    since: Annotated[
        str,
        typer.Option(help="A revision, or a day: faults only in code that is new since then, moved code not counted."),
    ] = "",
    cache: Annotated[
        Path | None, typer.Option(help="Folder of models that are compiled already, to begin with.")
    ] = None,
) -> Data:
    """Plant single faults in the source, Python and C: `check` or the tests must see each that changes a result."""
    if find_spec("pytest") is None:
        raise typer.BadParameter("the tests are one of the judges: pip install 'symofros[test]'")
    try:
        study = Study.begun(_ROOT, work.absolute(), faults, seed, cache, lambda module: run.advance(module), since)
    except LookupError as error:
        raise typer.BadParameter(str(error), param_hint="--since") from None
    unfinished: list[str] = []
    run.expect(len(study.faults), "planting faults")
    try:
        study.run(seconds)
    except KeyboardInterrupt:
        unfinished = [fault.id for fault in study.faults if study.fate(fault) == OPEN]
    finally:
        study.overlay.close()
    origin = {"copied": study.overlay.revision, "digest": study.overlay.digest}
    return as_data(study) | {"seed": seed, "since": since, **origin, "unfinished": unfinished}


def as_data(study: Study) -> dict[str, Any]:
    """The report's data: results of each fault, and scores; faults neither judged nor argued are left out."""
    rows = []
    for fault in study.faults:
        answers = {stage: study.store.get(fault.id, stage) for stage in (CHECK, OUTPUTS)} | {TESTS: study.tested(fault)}
        check = answers[CHECK]
        if any(answer is not None for answer in answers.values()) or fault.id in study.argued:
            rows.append(
                {
                    "id": fault.id,
                    "module": fault.module,
                    "kind": fault.kind,
                    "fate": study.fate(fault),
                    "argued": study.argued.get(fault.id, ""),
                    "sampled": study.sampled(fault),
                    "seen_by_check": None if check is None else seen(check),
                    "seen_by_tests": None if answers[TESTS] is None else seen(answers[TESTS]),
                    "said": _said(answers).replace(f"{study.folder}/tree/", "").replace(f"{study.folder}/", ""),
                    "seconds": sum(answer["seconds"] for answer in answers.values() if answer is not None),
                }
            )
    fates = Counter(row["fate"] for row in rows)
    judged = _scores(rows)
    met = judged["both"] >= BOTH and judged["check"] >= CHECK_ALONE and not fates[OPEN]
    return {"ok": met, "faults": rows, "scores": judged}


def _said(answers: dict[str, Any]) -> str:
    """The first judge's word on a fault."""
    for stage in (CHECK, TESTS, OUTPUTS):
        answer = answers[stage]
        if answer is None:
            continue
        if answer["answer"] is None:
            return f"{stage}: {answer['fate']}"
        said = answer["answer"]
        if said.get("status") != "passed":
            details = [said[key] for key in ("model", "reason", "test", "where") if said.get(key)]
            return f"{stage}: {said['status']} {' '.join(map(str, details))}"
    return ""


def _scores(rows: Sequence[dict[str, Any]]) -> dict[str, float]:
    """Shares of the faults that change a result: of the sample those seen by check, and by tests; of all, by either."""
    matter = [row for row in rows if row["fate"] in (CAUGHT, SURVIVED)]
    asked = [row for row in matter if row["sampled"] and row["seen_by_tests"] is not None]
    checked = [row for row in matter if row["sampled"]]
    return {
        "matter": len(matter),
        "check": _share([bool(row["seen_by_check"]) for row in checked]),
        "check_asked": len(checked),
        "tests": _share([bool(row["seen_by_tests"]) for row in asked]),
        "tests_asked": len(asked),
        "both": _share([row["fate"] == CAUGHT for row in matter]),
    }


def _share(verdicts: Sequence[bool]) -> float:
    return sum(verdicts) / len(verdicts) if verdicts else 0.0
