"""Thousands of motions at once."""

from __future__ import annotations

from operator import itemgetter

from ...reporting.numbers import counted, formatted, times
from ...reporting.record import Data, Fact, Report, Section, Table, Topic
from ..rollouts import measure

_LIMITS = """Loops in C on both sides, in turn, from the same starts; times are the processor's, so that other programs
do not lengthen them, and the loops' alone, without compiling, loading or copying the starts. MuJoCo keeps the state
after each step, we the last one (some nanoseconds a step). The arm's joints are free of friction and of limits on both
sides, and nothing touches; springs and dampers of the joints are the PD control. The ratio is the median over
interleaved repeats of the whole times, so that of an adaptive method is one of time to the end, at the errors shown."""
_HEAD = """motion | who | how | threads | error [rad] | steps | ns a step (min, median) |
    million steps a second and core | MuJoCo's time over it"""
_ROW = "{motion} | {who} | {how} | {threads} | {error:.1e} | {steps} | {} | {rate:.2f} | **{ratio:.1f}**"


def compose(data: Data) -> Report:
    """The report of its JSON."""
    rows = [{"rate": 1e3 / row["nanoseconds"][0], **row} for row in data["rollouts"]]
    lines = (_ROW.format(formatted(row["nanoseconds"], ".0f"), **row) for row in rows)
    ours = [row for row in rows if "MuJoCo" not in row["who"]]
    fastest, best = (max(ours, key=itemgetter(name)) for name in ("rate", "ratio"))
    title = f"{counted(data['trajectories'], 'motion')} of a 7-joint arm at once"
    repeats = f"{data['repeats']} repeats; load {data['load']:.1f}."
    return Report(
        title,
        f"{title}: {fastest['rate']:.2g} million steps a second and core.",
        None,
        (_LIMITS,),
        (Section("Time of a step", (Table.of(_HEAD, lines), repeats)),),
        facts=(
            Fact(f"{fastest['nanoseconds'][0]:.0f} ns", f"a step: {fastest['motion']}, {fastest['how']}"),
            Fact(times(best["ratio"]), f"mujoco.rollout's time over ours: {best['motion']}, {best['how']}"),
        ),
    )


TOPIC = Topic("rollouts", "Speed", "How fast are thousands of motions at once?", compose, measure)
