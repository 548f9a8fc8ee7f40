"""The flexible robot's part of the timing report."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from ...reporting.numbers import formatted
from ...reporting.record import Section, Table
from .race import CALLS

_LIMITS = (
    """`planar_robot`: three motors with harmonic drives, the first of them elastic, and two strips that bend. Exudyn
    has it as rigid bodies of three coordinates and ANCFCable2D elements, with hinges and clamps as constraints and the
    rotors' spin as a constant mass matrix on the angles it couples, which is exact in the plane. Error is the worst
    relative error of the robot's seven lowest elastic frequencies about a bent posture, against Exudyn's model with 32
    elements a strip; each of ours (cubic splines) is set against the coarsest mesh that errs no more. Both errors are
    computed in the run.""",
    """What is not alike: friction is in our Q only, as Exudyn's law has states of its own. Exudyn's forces include the
    elastic ones in every row, ours in those with Q; M + h is two of our functions, M + h + Q is one. Exudyn's M and
    forces leave the joints to its solver; the last row of each model adds their errors and Jacobian, without which they
    say less than ours (a clamp is a GenericJoint: six equations, of which three bind). Exudyn's strips stretch, and
    stay exact at large deflections, which frequencies do not show.""",
    f"""One thread on one processor, in turn. Ours is a loop in C over {CALLS} states; Exudyn's functions are called
    from Python at one state that is set once, with dense matrices, by its module without range checks. The ratio has
    these calls in it. The net ratio has the time of the same calls on a system of one coordinate taken off, and with it
    that system's own small work, so the truth lies between the two. Both are medians over the repeats; minima are what
    a calm machine gives.""",
)
_HEAD = """ours: functions (nv) | Exudyn: elements (coordinates + equations) | error: ours, Exudyn's | quantity |
    ours [ns] | Exudyn [ns] | calls [ns] | ratio | net ratio"""
_ROW = """{functions} ({sizes[0]}) | {elements} ({sizes[1]} + {sizes[2]}) | {} | {quantity} | {} | {} | {} |
    {ratio:.1f} | {corrected:.1f}"""


def flexible_section(rows: Iterable[Mapping[str, Any]]) -> Section:
    """The section of the report."""
    lines = []
    for row in rows:
        times = (formatted(row[name], ".0f") for name in ("generated_time", "engine_time", "calls"))
        lines.append(_ROW.format(formatted(row["error"], ".1e"), *times, **row))
    title = "A flexible robot against Exudyn, at equal accuracy"
    return Section(title, (*_LIMITS, Table.of(_HEAD, lines)), "flexible")
