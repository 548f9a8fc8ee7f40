"""Times of motions, against the clock and against engines."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

import typer

from validation.reporting.command import Run, known
from validation.reporting.numbers import Form, counted, times
from validation.reporting.record import Cell, Column, Data, Fact, Report, Section, Table, Topic
from validation.studies import simulation

_MOTIONS = {
    "arm": simulation.arm,
    "four_bar": simulation.four_bar,
    "planar_robot": simulation.planar_robot,
    "spinning_beam": simulation.spinning_beam,
}
_LIMITS = (
    "Loops in C on both sides, one thread, in turn; seconds are those of the stepping alone for us and for MuJoCo, and "
    "of building and solving for Exudyn, whose models take milliseconds to build. Errors are against the reference "
    "named. Exudyn has the coarsest mesh and longest step, of those tried, that err no more than ours; MuJoCo and we "
    "step the arm by the same method, and the four-bar by steps that leave ours the more accurate. The ratio is the "
    "median over interleaved repeats."
)
_IFTOMM = (
    "Thresholds: the library's for A01 (5e-5 J) and A02 (0.1 J); eight digits of the IVP test set for A03; for A04 and "
    "A05 what the references are asked for. Whole motions are compared in tests/reference/test_iftomm.py. Milliseconds "
    "are the least of the repeats, of the stepping alone."
)


def measure(
    run: Run,
    chosen: Annotated[list[str] | None, typer.Option("--motion", help=f"Only this: {', '.join(_MOTIONS)}.")] = None,
    repeats: Annotated[int, typer.Option(min=1, help="Interleaved repeats.")] = 7,
) -> Data:
    """Time motions: times real time, and against MuJoCo and Exudyn at equal accuracy."""
    motions = known(chosen, _MOTIONS, "--motion", "motion")
    run.expect(len(motions), "motions")
    races = []
    for name in motions:
        row = _MOTIONS[name](repeats)
        races.append(asdict(row) | {"real_time": row.real_time})
        run.advance()
    benchmarks = [] if chosen else [asdict(row) for row in simulation.iftomm(repeats)]
    return {"races": races, "iftomm": benchmarks, "repeats": repeats}


def compose(data: Data) -> Report:
    """The report of its JSON."""
    races, benchmarks = data["races"], data["iftomm"]
    raced = [row for row in races if row["engine_run"]]
    missed = [row for row in benchmarks if not row["error"] <= row["threshold"]]
    fastest = max(row["real_time"] for row in races)
    beyond = f"; {len(missed)} of the IFToMM benchmarks are beyond their thresholds" if missed else ""
    facts = [Fact(times(row["ratio"]), f"{row['engine']}'s time over ours: {row['motion']}") for row in raced]
    sections = [Section("Times real time, and against engines at equal accuracy", (_LIMITS, Table.of(races, _RACES)))]
    if benchmarks:
        facts.append(
            Fact(str(len(benchmarks)), f"IFToMM benchmarks, {len(missed)} beyond their thresholds", not missed)
        )
        sections.append(
            Section("Multibody benchmarks of the IFToMM library", (_IFTOMM, Table.of(benchmarks, _BENCHMARKS)))
        )
    return Report(
        "Motions: times real time, and against engines at equal accuracy",
        f"Motions run up to {fastest:.0f} times real time; {counted(len(raced), 'race')} at equal accuracy{beyond}.",
        not missed if benchmarks else None,
        (f"{data['repeats']} repeats.",) if "repeats" in data else (),
        tuple(sections),
        facts=tuple(facts),
    )


def _of_other(column: str) -> Column:
    """A column that is empty where there is no other engine."""
    return lambda row: Form().vformat(column, (), row) if row["engine_run"] else ""


_RACES: dict[str, Column] = {
    "motion": "{motion}",
    "#seconds of motion": "{span:g}",
    "error of": "{measure}",
    "ours": "{generated[how]}",
    "#error": "{generated[error]:.1e}",
    "#ms (min, median)": "{generated[seconds]:1e3*.3g}",
    "#times real time": "**{real_time:.0f}**",
    "other": _of_other("{engine}: {engine_run[how]}"),
    "#its error": _of_other("{engine_run[error]:.1e}"),
    "#its ms": _of_other("{engine_run[seconds]:1e3*.3g}"),
    "#ratio": _of_other("**{ratio:.1f}**"),
}
_BENCHMARKS: dict[str, Column] = {
    "benchmark": "{name}",
    "#seconds of motion": "{span:g}",
    "ours": "{how}",
    "error of": "{measure}",
    "#error": lambda row: Cell(f"{row['error']:.1e}", row["error"] <= row["threshold"]),
    "#threshold": "{threshold:.0e}",
    "#ms": "{seconds:1e3*.3g}",
}
TOPIC = Topic("simulation", "Speed", "How fast are motions at equal accuracy?", compose, measure)
