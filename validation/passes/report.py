"""What each pass of the generator gains."""

from __future__ import annotations

from collections.abc import Sequence

from symofros.tools import ABLATIONS

from ..reporting.numbers import counted, formatted, times
from ..reporting.record import Data, Fact, Report, Section, Table, Topic
from .measure import ALL, APART, measure

_APART = "M, h and Q are one function with one set of kinematics; without: three functions."
_INTRO = """M, h and Q in one generated function, with all passes, and with each left out in turn. "More" is what
leaving it out adds: to the operations of a call, and to the median time of a state. One thread on one processor, loops
in C over the same random states, all variants of a model in turn; results agree within rounding, which is checked
first. What the placement of code in memory makes is seen in the row of a copy: the same library, loaded from another
file. Smaller gains are none."""
_LEFT_OUT = """Passes that were tried and left out, because they gained nothing where it was measured: common factors,
`a b + a c` as `a (b + c)` (11 of 949 operations of panda7, 124 of 6944 of talos; a fused multiply-add takes the first
form in as many instructions); balanced sums for latency (the longest path of panda7 is 37 ns of 95, of talos 56 of 830:
what limits is the number of instructions); `-ffast-math` (between 0.75 and 1.1 times as fast, and it costs the
bits)."""
_HEAD = """without | operations | more operations | ns (min, median) | more time | C text [KiB] |
    made and compiled [s]"""


def compose(data: Data) -> Report:
    """The report of its JSON."""
    rows = data["rows"]
    base = {row["model"]: row for row in rows if row["without"] == ALL}
    gain, most = max(((row["median"] / base[row["model"]]["median"], row) for row in rows), key=lambda pair: pair[0])
    what = {item.name: item.what for item in ABLATIONS} | {APART: _APART}
    tables = [_section(whole, [row for row in rows if row["model"] == label]) for label, whole in base.items()]
    return Report(
        "What each pass gains",
        f"Passes measured one by one on {counted(len(base), 'model')}.",
        None,
        (_INTRO,),
        (
            Section("What each pass does", (Table.of("pass | what it does", what.items()),)),
            *tables,
            Section("What was tried and left out", (_LEFT_OUT,)),
        ),
        facts=(Fact(times(gain), f"the time of {most['model']} without {most['without']}"),),
        digest=tuple(block for section in tables for block in (f"{section.title}:", *section.blocks)),
    )


def _section(base: Data, rows: Sequence[Data]) -> Section:
    """One model; gains are what leaving a pass out costs."""
    lines = []
    for row in rows:
        operations, median = (row[name] / base[name] - 1.0 for name in ("operations", "median"))
        more = (f"{operations:+.1%}", f"{median:+.0%}") if row is not base else ("", "")
        spans = formatted((row["minimum"], row["median"]), ".0f")
        made = f"{row['text'] / 1024:.0f} | {formatted(row['compilation'], '.2f')}"
        lines.append(f"{row['without']} | {row['operations']} | {more[0]} | {spans} | {more[1]} | {made}")
    return Section(f"{base['model']}, {base['nv']} degrees of freedom", (Table.of(_HEAD, lines),))


TOPIC = Topic("passes", "Speed", "What does each pass of the generator gain?", compose, measure)
