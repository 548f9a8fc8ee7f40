"""`python -m validation mutants`: faults in the source before two judges, as a command and a report."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from validation.mutation.fault import KINDS
from validation.mutation.study import (
    CAUGHT,
    CHECK,
    OPEN,
    OUTPUTS,
    STILLBORN,
    SURVIVED,
    TESTS,
    UNCHANGED,
    Study,
    seen_by_check,
    seen_by_tests,
)
from validation.reporting.command import Run
from validation.reporting.numbers import counted
from validation.reporting.record import Bullets, Cell, Column, Data, Fact, Fold, Report, Section, Table, Topic

_ROOT = Path(__file__).parents[2]
BOTH, CHECK_ALONE = 0.98, 0.85  # Asked-for shares of the faults that change a result.
_COLUMNS: dict[str, Column] = {
    "#planted": "{planted}",
    "#check": "{check}",
    "#tests alone": "{tests}",
    "#neither": lambda row: Cell(str(row["survived"]), not row["survived"]),
    "#no result changed": "{unchanged}",
    "#open": "{open}",
}


def measure(
    run: Run,
    faults: Annotated[int, typer.Option(min=1, help="Number of faults, spread over all modules.")] = 600,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the draw.")] = 0,
    seconds: Annotated[float, typer.Option(min=0.0, help="Time after which no further fault is begun [s].")] = 36000.0,
    work: Annotated[
        Path, typer.Option(help="Folder of the copy of the tree, of answers; an old one is gone on with.")
    ] = Path("mutants"),
    cache: Annotated[
        Path | None, typer.Option(help="Folder of models that are compiled already, to begin with.")
    ] = None,
) -> Data:
    """Plant single faults in the source, Python and C: `check` or the tests must see each that changes a result."""
    study = Study.begun(_ROOT, work.absolute(), faults, seed, cache, lambda module: run.advance(module))
    unfinished: list[str] = []
    run.expect(len(study.faults), "planting faults")
    try:
        study.run(seconds)
    except KeyboardInterrupt:
        unfinished = [fault.id for fault in study.faults if study.fate(fault) == OPEN]
    finally:
        study.overlay.close()
    return as_data(study) | {"seed": seed, "unfinished": unfinished}


def as_data(study: Study) -> dict[str, Any]:
    """What is known of each fault, as plain data; faults that no judge was asked about are left out."""
    rows = []
    for fault in study.faults:
        answers = {stage: study.store.get(fault.id, stage) for stage in (CHECK, TESTS, OUTPUTS)}
        check = answers[CHECK]
        if check is not None:
            rows.append(
                {
                    "id": fault.id,
                    "module": fault.module,
                    "kind": fault.kind,
                    "fate": study.fate(fault),
                    "seen_by_check": seen_by_check(check),
                    "seen_by_tests": None if answers[TESTS] is None else seen_by_tests(answers[TESTS]),
                    "said": _said(answers).replace(f"{study.folder}/tree/", ""),
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
            words = [said[key] for key in ("model", "reason", "test", "where") if said.get(key)]
            return f"{stage}: {said['status']} {' '.join(map(str, words))}"
    return ""


def _scores(rows: Sequence[dict[str, Any]]) -> dict[str, float]:
    """Shares of the faults that change a result: seen by check, by tests where they were asked, by either."""
    matter = [row for row in rows if row["fate"] in (CAUGHT, SURVIVED)]
    asked = [row for row in matter if row["seen_by_tests"] is not None]
    return {
        "matter": len(matter),
        "check": _share([row["seen_by_check"] for row in matter]),
        "tests": _share([bool(row["seen_by_tests"]) for row in asked]),
        "tests_asked": len(asked),
        "both": _share([row["fate"] == CAUGHT for row in matter]),
    }


def _share(seen: Sequence[bool]) -> float:
    return sum(seen) / len(seen) if seen else 0.0


def _row(rows: Sequence[dict[str, Any]], **label: str) -> dict[str, Any]:
    fates = Counter(row["fate"] for row in rows)
    valid = [row for row in rows if row["fate"] != STILLBORN]
    check = sum(row["seen_by_check"] for row in valid)
    return {
        **label,
        "planted": len(valid),
        "check": check,
        "tests": fates[CAUGHT] - check,
        "survived": fates[SURVIVED],
        "unchanged": fates[UNCHANGED],
        "open": fates[OPEN],
    }


def compose(data: Data) -> Report:
    """The report of its JSON."""
    rows, scores = data["faults"], data["scores"]
    folders: dict[str, list[dict[str, Any]]] = {}
    modules: dict[str, list[dict[str, Any]]] = {}
    for row in rows:
        folders.setdefault(row["module"].rpartition("/")[0], []).append(row)
        modules.setdefault(row["module"], []).append(row)
    by_folder = [_row(own, folder=folder) for folder, own in sorted(folders.items())]
    by_module = [_row(own, module=module) for module, own in sorted(modules.items())]
    by_kind = [_row([row for row in rows if row["kind"] == kind], kind=kind) for kind in KINDS]
    survivors = tuple(f"`{row['id']}`: {row['said']}" for row in rows if row["fate"] == SURVIVED)
    unchanged = tuple(f"`{row['id']}`" for row in rows if row["fate"] == UNCHANGED)
    total = _row(rows)
    seconds = sum(row["seconds"] for row in rows) / max(1, len(rows))
    text = (
        "A fault is one change of a source file, in Python by the syntax tree, in C by tokens: an operator, a sign, an "
        "index, a frame or a transpose, a dropped term, the edge of a comparison, a constant, swapped arguments. The "
        "package with the fault is judged by `check` over a few small models, and by the tests of the module. **No "
        "result changed**: neither judge sees it, and the C text, the values of functions, motions and analyses of a "
        "battery are those of the sound package but for rounding. **Open**: the tests were not asked yet, "
        "or their time was over before all had run. "
        f"{counted(len(rows) - total['planted'], 'fault')} that the C compiler refuses are left out. Of the tests "
        f"alone: {scores['tests']:.1%} of the {scores['tests_asked']} faults that they were asked about."
    )
    return Report(
        "Faults planted in the source",
        f"{counted(total['planted'], 'fault')} in {counted(len(modules), 'module')}: `check` alone sees "
        f"{scores['check']:.1%} of those known to change a result, `check` and tests {scores['both']:.1%}; "
        f"{total['open']} open.",
        bool(data["ok"]),
        (text,),
        (
            Section("By folder", (Table.of(by_folder, {"folder": "{folder}"} | _COLUMNS),)),
            Section("By kind of fault", (Table.of(by_kind, {"kind of fault": "{kind}"} | _COLUMNS),)),
            Section("By module", (Fold("All modules", (Table.of(by_module, {"module": "{module}"} | _COLUMNS),)),)),
            *([Section("What survived", (Bullets(survivors),))] if survivors else []),
            *([Section("What changed no result", (Fold("All", (Bullets(unchanged),)),))] if unchanged else []),
        ),
        facts=(
            Fact(str(total["planted"]), "single faults planted"),
            Fact(f"{scores['check']:.1%}", f"seen by check alone, of at least {CHECK_ALONE:.0%}"),
            Fact(
                f"{scores['both']:.1%}",
                f"seen by check or tests, of at least {BOTH:.0%}",
                scores["both"] >= BOTH and not total["open"],
            ),
            Fact(str(total["survived"]), "change a result and are seen by neither", not total["survived"]),
            Fact(f"{seconds:.1f} s", "a fault, all judges together"),
        ),
        unfinished=tuple(data.get("unfinished", ())),
    )


TOPIC = Topic("mutants", "Correctness", "Would check or the tests see a fault in the source?", compose, measure)
