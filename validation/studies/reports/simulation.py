"""Times of motions, against the clock and against engines."""

from __future__ import annotations

from collections.abc import Iterable

from ...reporting.numbers import counted, formatted, times
from ...reporting.record import Data, Fact, Report, Section, Table, Topic, verdict
from ..simulation import measure

_LIMITS = """Loops in C on both sides, one thread, in turn; seconds are those of the stepping alone for us and for
MuJoCo, and of building and solving for Exudyn, whose models take milliseconds to build. Errors are against the
reference named. Exudyn has the coarsest mesh and longest step, of those tried, that err no more than ours; MuJoCo and
we step the arm by the same method, and the four-bar by steps that leave ours the more accurate. The ratio is the median
over interleaved repeats."""
_IFTOMM = """Thresholds: the library's for A01 (5e-5 J) and A02 (0.1 J); eight digits of the IVP test set for A03; for
A04 and A05 what the references are asked for. Whole motions are compared in tests/reference/test_iftomm.py.
Milliseconds are the least of the repeats, of the stepping alone."""
_RACES = """motion | seconds of motion | error of | ours | error | ms (min, median) | times real time | engine |
    its method | its error | its ms | ratio"""
_BENCHMARKS = "benchmark | seconds of motion | ours | error of | error | threshold | ms"


def compose(data: Data) -> Report:
    """The report of its JSON."""
    races, benchmarks = data["races"], data["iftomm"]
    raced = [row for row in races if row["engine_run"]]
    missed = [row for row in benchmarks if row["error"] > row["threshold"]]
    beyond = f"; {len(missed)} of the IFToMM benchmarks are beyond their thresholds" if missed else ""
    fastest = max(row["real_time"] for row in races)
    facts = [Fact(times(row["ratio"]), f"{row['engine']}'s time over ours: {row['motion']}") for row in raced]
    if benchmarks:
        said = f"IFToMM benchmarks, {len(missed)} beyond their thresholds"
        facts.append(Fact(str(len(benchmarks)), said, not missed))
    return Report(
        "Motions: times real time, and against engines at equal accuracy",
        f"Motions run up to {fastest:.0f} times real time; {counted(len(raced), 'race')} at equal accuracy{beyond}.",
        not missed if benchmarks else None,
        (f"{data['repeats']} repeats.",) if "repeats" in data else (),
        (
            Section(
                "Times real time, and against engines at equal accuracy",
                (_LIMITS, Table.of(_RACES, map(_race, races))),
            ),
            Section(
                "Multibody benchmarks of the IFToMM library",
                (_IFTOMM, Table.of(_BENCHMARKS, map(_benchmark, benchmarks))),
            ),
        ),
        facts=tuple(facts),
    )


def _race(row: Data) -> str:
    ours, other = (_run(run) for run in (row["generated"], row["engine_run"]))
    ratio = f"**{formatted(row['ratio'] or None, '.1f')}**"
    motion = f"{row['motion']} | {row['span']:g} | {row['measure']}"
    return f"{motion} | {ours} | **{row['real_time']:.0f}** | {row['engine'] or '-'} | {other} | {ratio}"


def _benchmark(row: Data) -> str:
    error = verdict(f"{row['error']:.1e}", row["error"] <= row["threshold"])
    motion = f"{row['name']} | {row['span']:g} | {row['how']} | {row['measure']}"
    return f"{motion} | {error} | {row['threshold']:.0e} | {_milliseconds(row['seconds'])}"


def _run(run: Data | None) -> str:
    """Method, error and time of one side."""
    return f"{run['how']} | {run['error']:.1e} | {_milliseconds(run['seconds'])}" if run else "- | - | -"


def _milliseconds(seconds: Iterable[float] | float) -> str:
    return formatted(seconds, lambda one: f"{1e3 * one:.3g}")


TOPIC = Topic("simulation", "Speed", "How fast are motions at equal accuracy?", compose, measure)
