"""Times of motions, against the clock and against engines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Annotated

import typer

from validation.reporting.command import Run, known
from validation.reporting.numbers import counted, times
from validation.reporting.provenance import stamp
from validation.reporting.record import Cell, Data, Fact, Report, Section, Table, Topic
from validation.studies import simulation

_SCENES = {
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
    chosen: Annotated[list[str] | None, typer.Option("--scene", help=f"Only this: {', '.join(_SCENES)}.")] = None,
    repeats: Annotated[int, typer.Option(min=1, help="Interleaved repeats.")] = 7,
) -> Data:
    """Time motions: times real time, and against MuJoCo and Exudyn at equal accuracy."""
    scenes = known(chosen, _SCENES, "--scene", "scene")
    run.expect(len(scenes), "motions")
    races = []
    for name in scenes:
        row = _SCENES[name](repeats)
        races.append(asdict(row) | {"real_time": row.real_time})
        run.advance()
    benchmarks = [] if chosen else [asdict(row) for row in simulation.iftomm(repeats)]
    return {"races": races, "iftomm": benchmarks, "repeats": repeats, "seconds": run.seconds, **stamp()}


def compose(data: Data) -> Report:
    """The report of its JSON."""
    races, benchmarks = data["races"], data["iftomm"]
    raced = [row for row in races if row["theirs"]]
    missed = [row for row in benchmarks if not row["error"] <= row["threshold"]]
    fastest = max(row["real_time"] for row in races)
    beyond = f"; {len(missed)} of the IFToMM benchmarks are beyond their thresholds" if missed else ""
    facts = [Fact(times(row["ratio"]), f"{row['engine']}'s time over ours: {row['scene']}") for row in raced]
    sections = [Section("Times real time, and against engines at equal accuracy", (_LIMITS, _races(races)))]
    if benchmarks:
        facts.append(
            Fact(str(len(benchmarks)), f"IFToMM benchmarks, {len(missed)} beyond their thresholds", not missed)
        )
        sections.append(Section("Multibody benchmarks of the IFToMM library", (_IFTOMM, _benchmarks(benchmarks))))
    return Report(
        "Motions: times real time, and against engines at equal accuracy",
        f"Motions run up to {fastest:.0f} times real time; {counted(len(raced), 'race')} at equal accuracy{beyond}.",
        not missed if benchmarks else None,
        (f"{data['repeats']} repeats.",) if "repeats" in data else (),
        tuple(sections),
        tuple(facts),
        digest=tuple(table for section in sections for table in section.blocks if isinstance(table, Table)),
    )


def _races(rows: Sequence[Data]) -> Table:
    cells = []
    for row in rows:
        ours, theirs = row["ours"], row["theirs"]
        other = ("", "", "", "")
        if theirs:
            who = f"{row['engine']}: {theirs['how']}"
            other = (who, f"{theirs['error']:.1e}", _milliseconds(theirs["seconds"]), f"**{row['ratio']:.1f}**")
        ours_cells = (
            ours["how"],
            f"{ours['error']:.1e}",
            _milliseconds(ours["seconds"]),
            f"**{row['real_time']:.0f}**",
        )
        cells.append((row["scene"], f"{row['span']:g}", row["measure"], *ours_cells, *other))
    ours_head = ("ours", "#error", "#ms (min, median)", "#times real time")
    return Table(
        ("scene", "#seconds of motion", "error of", *ours_head, "other", "#error", "#ms (min, median)", "#ratio"),
        tuple(cells),
    )


def _benchmarks(rows: Sequence[Data]) -> Table:
    return Table(
        ("benchmark", "#seconds of motion", "ours", "error of", "#error", "#threshold", "#ms"),
        tuple(
            (
                row["name"],
                f"{row['span']:g}",
                row["how"],
                row["measure"],
                Cell(f"{row['error']:.1e}", row["error"] <= row["threshold"]),
                f"{row['threshold']:.0e}",
                f"{1e3 * row['seconds']:.3g}",
            )
            for row in rows
        ),
    )


def _milliseconds(seconds: Sequence[float]) -> str:
    return ", ".join(f"{1e3 * x:.3g}" for x in seconds)


TOPIC = Topic("simulation", "Speed", "How fast are motions at equal accuracy?", compose)
