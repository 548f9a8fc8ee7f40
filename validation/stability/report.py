"""The atlas: where simulations fail, as maps with verdicts; the studies as a command."""

from __future__ import annotations

import math
import time
from collections import Counter
from typing import Annotated, Any

import numpy as np
import typer

from ..program import PROGRAM
from ..reporting.command import Quick, Run, known
from ..reporting.figures import Figure
from ..reporting.findings import Finding
from ..reporting.numbers import counted, rounded, short
from ..reporting.plain import plain, restored
from ..reporting.questions import answers_in_short, findings_fold, judged
from ..reporting.record import Bullets, Data, Fact, Report, Section, Text, Topic
from . import heatmap
from .closed_loops import baumgarte, long_loops, redundant, singular
from .contact import bounces, impact, incline, motions, strikes
from .flexible import beams
from .rigid import energy, euler_angles, light_bodies, mass_ratio, stick_slip
from .study import FINISHED, Cell, Map, ParameterStudy, survey

STUDIES: dict[str, ParameterStudy] = {
    "baumgarte": baumgarte.STUDY,
    "singular": singular.STUDY,
    "long_loops": long_loops.STUDY,
    "redundant": redundant.STUDY,
    "stiff_beam": beams.STUDY,
    "damped_beam": beams.DAMPED_STUDY,
    "light_link": light_bodies.STUDY,
    "massless_cross": light_bodies.CROSS_STUDY,
    "mass_ratio": mass_ratio.STUDY,
    "stick_slip": stick_slip.STUDY,
    "incline": incline.STUDY,
    "impact": impact.STUDY,
    "bounces": bounces.STUDY,
    "touching": motions.STUDY,
    "strikes": strikes.STUDY,
    "energy": energy.STUDY,
    "euler_angles": euler_angles.STUDY,
}

# Study that is gone -> what answers its question.
RETIRED = {
    "soft_closures": "stability --study singular",
    "spin": "accuracy --study spinning",
    "shape_functions": "accuracy --study conditioning",
    "deflection": "accuracy --study pendulum",
}


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


INTRO = """Where simulations fail, and what to use instead. Each map runs one study over two parameters: a cell is a
run, blue where it meets the criterion, orange where it comes to its end and misses it, red where it ended before with
an outcome in words, grey where it was refused before it began. The black line is the edge between good and bad as
measured; a dashed line is a closed form. Numbers in cells are decades. Every claim comes back with the command under
its study."""


def maps_of(study: ParameterStudy, data: Data) -> dict[str, Map]:
    """The maps that a report holds, with the closed forms of the study's subjects."""
    subjects, maps = {subject.name: subject for subject in study.subjects}, {}
    for name, one in data["maps"].items():
        x, y = (
            np.array([grid.labels.index(value) if grid.labels else value for value in stated], float)
            for grid, stated in ((study.x, one["x"]), (study.y, one["y"]))
        )
        rows = (zip(*row, strict=True) for row in zip(one["values"], one["ended"], strict=True))
        cells = tuple(tuple(Cell(math.nan if at is None else at, ended) for at, ended in row) for row in rows)
        maps[name] = Map(subjects[name], x, y, cells, study.bound)
    return maps


def compose(data: Data) -> Report:
    """The report of its JSON."""
    studies = {name: study for name, study in data["studies"].items() if name in STUDIES}  # Of older reports as well.
    findings = {name: restored(tuple[Finding, ...], study["findings"]) for name, study in studies.items()}
    runs = sum(len(row) for study in studies.values() for one in study["maps"].values() for row in one["values"])
    draft = Report(
        "Stability atlas",
        f"about {counted(len(studies), 'study')}, {counted(runs, 'run')}",
        None,
        (INTRO,),
        tuple(_section(name, study, findings[name], data["quick"]) for name, study in studies.items()),
        facts=(Fact(str(len(studies)), "studies"), Fact(str(runs), "runs")),
        decisions=answers_in_short(
            ((name, STUDIES[name].question, STUDIES[name].advice) for name in studies), "what to use"
        ),
    )
    return judged(draft, data, findings, "study", "claim")


def _section(name: str, data: Data, findings: tuple[Finding, ...], quick: bool) -> Section:
    study = STUDIES[name]
    maps = maps_of(study, data)
    pictures = tuple(heatmap.draw(one, study.x, study.y, study.quantity) for one in maps.values())
    ends = Bullets(tuple(f"{who}: {_ends(one, data['maps'][who]['said'])}." for who, one in maps.items()))
    command = f"{PROGRAM} stability --study {name}{' --quick' if quick else ''}"
    sources = f" Sources: {'; '.join(study.sources)}." if study.sources else ""
    blocks = (
        f"{study.setting} **Criterion:** {study.quantity} at most {short(study.bound)}.",
        data["verdict"],
        Figure(data["see"], pictures),
        Text(f"**Instead:** {study.advice}", "advice"),
        findings_fold(findings, "claim", ", and how the runs ended", ends),
        Text(f"`{command}`, {data['seconds']:.0f} s.{sources}", "soft"),
    )
    return Section(study.question, blocks, name, bool(data["ok"]))


def _ends(one: Map, notes: list[str]) -> str:
    """Summary, as text, of how the runs of a map ended."""
    cells = [c for row in one.cells for c in row]
    said = [f"{int(one.good.sum())} of {len(cells)} meet the criterion"]
    said += [f"{one.wrong} come to their end and miss it"] if one.wrong else []
    said += [f"{count} {kind}" for kind, count in Counter(c.ended for c in cells if c.ended not in FINISHED).items()]
    return ", ".join(said) + (f" (such as “{notes[0]}”)" if notes else "")


TOPIC = Topic("stability", "Stability", "Where do simulations fail?", compose, measure)
