"""Notes where the mechanisms of a diagram left the limits of their joints, whichever way it ran."""

from __future__ import annotations

from collections.abc import Iterator

from symofros.base.arrays import Array
from symofros.diagrams.program.compiled import Resolved
from symofros.diagrams.program.layout import Part
from symofros.runtime.record import JointLimit
from symofros.simulation.analysis.kinematics.postures import limit_notes


def joint_limit_notes(resolved: Resolved, t: Array, q: Array, v: Array) -> list[str]:
    """Notes on joint limits, at most one a part and kind of limit; efforts, which are signals here, are not looked at.

    Args:
        resolved: Diagram that ran.
        t: Recorded times (n).
        q: States (n, nq).
        v: Speeds (n, nv).
    """
    layout = resolved.layout
    return [
        note
        for part in layout.parts
        for note in limit_notes(
            {"q": layout.q_names[part.q], "v": layout.v_names[part.v]},
            list(_limits(resolved, part)),
            t,
            {"q": q[:, part.q], "v": v[:, part.v]},
        )
    ]


def _limits(resolved: Resolved, part: Part) -> Iterator[JointLimit]:
    """Limits of joints of a part's mechanisms, by index in the part's q or v."""
    models, layout = resolved.wired.models, resolved.layout
    for name in part.blocks:
        if name in layout.q:
            first = {"q": layout.q[name].start - part.q.start, "v": layout.v[name].start - part.v.start}
            for limit in models.record(resolved.pieces[name].block.mechanism()).joint_limits:
                if limit.of in first:
                    yield limit._replace(entry=first[limit.of] + limit.entry)
