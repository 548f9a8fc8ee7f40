"""Times of motions, against the clock and against engines."""

from __future__ import annotations

from validation.reporting.numbers import counted, times
from validation.reporting.record import Data, Fact, Report, Section, Table, Topic
from validation.studies.simulation import measure

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
_RACES = """motion; #seconds of motion = {span:g}; error of = {measure}; ours = {generated[how]};
    #error = {generated[error]:.1e}; #ms (min, median) = {generated[seconds]:1e3*.3g};
    #times real time = **{real_time:.0f}**; engine = {by}; its method = {other[how]}; #its error = {other[error]:.1e};
    #its ms = {other[seconds]:1e3*.3g}; #ratio = **{ratio:.1f}**"""
_BENCHMARKS = """benchmark = {name}; #seconds of motion = {span:g}; ours = {how}; error of = {measure};
    #error = {error:.1e} ? ok; #threshold = {threshold:.0e}; #ms = {seconds:1e3*.3g}"""


def compose(data: Data) -> Report:
    """The report of its JSON."""
    raced = [row for row in data["races"] if row["engine_run"]]
    nobody = {"how": None, "error": None, "seconds": None}
    races = [
        row | {"by": row["engine"] or "-", "other": row["engine_run"] or nobody, "ratio": row["ratio"] or None}
        for row in data["races"]
    ]
    benchmarks = [{"ok": row["error"] <= row["threshold"], **row} for row in data["iftomm"]]
    missed = [row for row in benchmarks if not row["ok"]]
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
            Section("Times real time, and against engines at equal accuracy", (_LIMITS, Table.of(races, _RACES))),
            Section("Multibody benchmarks of the IFToMM library", (_IFTOMM, Table.of(benchmarks, _BENCHMARKS))),
        ),
        facts=tuple(facts),
    )


TOPIC = Topic("simulation", "Speed", "How fast are motions at equal accuracy?", compose, measure)
