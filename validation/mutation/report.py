"""Faults in the source before two judges: the command, what each saw, by folder, kind and module, and the scores."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Any

import typer

from ..reporting.command import Run
from ..reporting.numbers import counted
from ..reporting.record import Bullets, Data, Fact, Report, Section, Table, Topic, verdict
from .fault import KINDS
from .study import ARGUED, CAUGHT, CHECK, HALTED, OPEN, OUTPUTS, STILLBORN, SURVIVED, TESTS, UNCHANGED, Study, seen

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


_TEXT = """A fault is one change of a source file, in Python by the syntax tree, in C by tokens: an operator, a sign, an
index, a frame or a transpose, a dropped term, the edge of a comparison, a constant, swapped arguments. The package with
the fault is judged by `check` over a few small models, and by the tests of the module. **No result changed**: neither
judge sees it, and the C text, the values of functions, motions and analyses of a battery are those of the sound package
but for rounding; or a person has argued that no result depends on it, with the reason below. A judge whose process
crashes has seen the fault: `check` reports that as a failed row. **Does not end**: the process of `check` runs on,
which is no verdict; such faults count neither as seen nor as missed. **Open**:
the tests were not asked yet, or their time was over before all had run. The tests are asked first, and `check` about
what they do not see; of a sample of the faults, {} that change a result, `check` is asked first, and its score is of
these. **tests**: seen by the tests, `check` blind or not asked. {} that the C compiler refuses are left out. Of the
tests alone: {:.1%} of the {} of the sample that they were asked about."""
# What `check` is for, in parts: its score of each. The first folder that fits counts.
_PARTS = {
    "mechanics, formulas, generator": (
        "symofros/mechanics/",
        "symofros/expr/",
        "symofros/generator/",
        "symofros/native/model/",
    ),
    "stepping": ("symofros/native/", "symofros/simulation/stepping/"),
    "analyses, inputs and results of motions": ("symofros/simulation/",),
    "descriptions and files": ("symofros/description/",),
}
_HEAD = "planted | check | tests | neither | no result changed | does not end | open"


def _counts(rows: Sequence[Data]) -> tuple[int, ...]:
    """Numbers of faults under the names of `_HEAD`."""
    fates = Counter(row["fate"] for row in rows)
    valid = [row for row in rows if row["fate"] != STILLBORN]
    check = sum(bool(row["seen_by_check"]) for row in valid)
    unchanged = fates[UNCHANGED] + fates[ARGUED]
    return len(valid), check, fates[CAUGHT] - check, fates[SURVIVED], unchanged, fates[HALTED], fates[OPEN]


def _table(title: str, rows: Sequence[Data], group: Callable[[Data], str], labels: Iterable[str] = ()) -> Table:
    """A line a group of faults."""
    lines = []
    for label in labels or sorted({group(row) for row in rows}):
        planted, check, tests, survived, *rest = _counts([row for row in rows if group(row) == label])
        lines.append((label, *map(str, (planted, check, tests, verdict(survived, not survived), *rest))))
    return Table.of(f"{title} | {_HEAD}", lines)


def _by_part(rows: Sequence[Data]) -> Table:
    """Which share of the faults that change a result `check` alone sees, by part of the source."""
    sample = [row for row in rows if row["sampled"] and row["fate"] in (CAUGHT, SURVIVED)]
    lines, left = [], sample
    for part, folders in _PARTS.items():
        of_part = [row for row in left if row["module"].startswith(folders)]
        left = [row for row in left if row not in of_part]
        seen = sum(bool(row["seen_by_check"]) for row in of_part)
        lines.append((part, str(len(of_part)), str(seen), f"{seen / max(1, len(of_part)):.0%}"))
    return Table.of("part of the source | change a result | seen by check alone | share", lines)


def compose(data: Data) -> Report:
    """The report of its JSON."""
    rows, scores = data["faults"], data["scores"]
    planted, _, _, survived, *_, still_open = _counts(rows)
    seconds = sum(row["seconds"] for row in rows) / max(1, len(rows))

    def listed(fate: str, reason: str) -> tuple[str, ...]:
        return tuple(f"`{row['id']}`: {row[reason]}" for row in rows if row["fate"] == fate)

    unchanged = tuple(f"`{row['id']}`: the same outputs" for row in rows if row["fate"] == UNCHANGED)
    seen = f"{scores['check']:.1%} of those known to change a result, `check` and tests {scores['both']:.1%}"
    modules = counted(len({row["module"] for row in rows}), "module")
    refused = counted(len(rows) - planted, "fault")
    copied = str(data.get("copied", ""))
    origin = f" They stand in a copy of revision `{copied}`." if copied else ""
    since = str(data.get("since", ""))
    origin += f" They are in code whose tokens are new since {since}." if since else ""
    text = _TEXT.format(scores["check_asked"], refused, scores["tests"], scores["tests_asked"]) + origin
    return Report(
        "Faults planted in the source",
        f"{counted(planted, 'fault')} in {modules}: `check` alone sees {seen}; {still_open} open.",
        bool(data["ok"]),
        (text,),
        (
            Section("What check alone sees", (_by_part(rows),)),
            Section("By folder", (_table("folder", rows, lambda row: str(row["module"].rpartition("/")[0])),)),
            Section("By kind of fault", (_table("kind of fault", rows, lambda row: str(row["kind"]), KINDS),)),
            Section("By module", (Section("All modules", (_table("module", rows, lambda row: str(row["module"])),)),)),
            Section("What survived", (Bullets(listed(SURVIVED, "said")),)),
            Section("What makes check run on", (Bullets(listed(HALTED, "said")),)),
            Section("What changed no result", (Section("All", (Bullets(unchanged + listed(ARGUED, "argued")),)),)),
        ),
        facts=(
            Fact(str(planted), "single faults planted"),
            Fact(f"{scores['check']:.1%}", f"seen by check alone, of at least {CHECK_ALONE:.0%}"),
            Fact(f"{scores['both']:.1%}", f"seen by check or tests, of at least {BOTH:.0%}", scores["both"] >= BOTH),
            Fact(str(still_open), "open: a judge is still to be asked", not still_open),
            Fact(str(survived), "change a result and are seen by neither", not survived),
            Fact(f"{seconds:.1f} s", "a fault, all judges together"),
        ),
        unfinished=tuple(data.get("unfinished", ())),
        aims=True,
    )


QUESTION = "Would the tests see a fault in the source?"
TOPIC = Topic("mutants", "Correctness", QUESTION, compose, measure, beside=("tests",))
