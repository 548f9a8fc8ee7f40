"""The studies of the atlas as a command."""

from __future__ import annotations

import time
from typing import Annotated, Any

import typer

from ..reporting.command import Quick, Run, known
from ..reporting.numbers import rounded
from ..reporting.plain import plain
from ..reporting.record import Data
from .catalogue import RETIRED, STUDIES
from .study import Map, ParameterStudy, survey

# Different reasons of ends that are kept of a map.
_MAX_NOTES = 8


def measure(
    run: Run,
    chosen: Annotated[list[str] | None, typer.Option("--study", help=f"Only this; of {', '.join(STUDIES)}.")] = None,
    quick: Quick = False,
) -> Data:
    """Map where simulations fail, against closed forms and other engines.

    With --study, the report is that of these studies alone, in the subfolder stability.
    """
    wanted = known(chosen, STUDIES, "--study", "study", RETIRED)
    if chosen:  # One study must not overwrite the atlas of all of them.
        run.folder = run.folder / "stability"
    run.expect(sum(STUDIES[name].runs(quick) for name in wanted))

    def surveyed(name: str) -> dict[str, Any]:
        run.advance(name, steps=0)
        return study_data(STUDIES[name], quick, run)

    done = run.each(wanted, surveyed)
    ok = all(study["ok"] for study in done.results.values())
    return done.head(ok, quick) | {"studies": done.results}


def study_data(study: ParameterStudy, quick: bool, run: Run) -> dict[str, Any]:
    """Run and judge one study: its verdict, findings and maps as plain data."""
    start = time.perf_counter()
    maps = survey(study, quick, run.advance)
    verdict = study.judge(maps)
    return {
        "verdict": verdict.statement,
        "see": verdict.see,
        "ok": all(finding.ok for finding in verdict.findings),
        "seconds": round(time.perf_counter() - start, 1),
        "findings": plain(verdict.findings),
        "maps": {name: _map_data(study, one) for name, one in maps.items()},
    }


def _map_data(study: ParameterStudy, one: Map) -> dict[str, Any]:
    notes = sorted({c.note for row in one.cells for c in row if c.note})
    return {
        "x": [study.x.label(x) if study.x.labels else float(x) for x in one.x],
        "y": [study.y.label(y) if study.y.labels else float(y) for y in one.y],
        "values": [rounded(row) for row in one.values],
        "ended": [[c.ended for c in row] for row in one.cells],
        "said": notes[:_MAX_NOTES],
    }
