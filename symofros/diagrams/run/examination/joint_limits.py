"""Notes where the mechanisms of a diagram left the limits of their joints, whichever way it ran."""

from __future__ import annotations

from symofros.diagrams.program.compiled import Resolved
from symofros.diagrams.program.layout import Part
from symofros.generator.record import joint_limits
from symofros.runtime.calls.kernel import Array
from symofros.simulation.analysis.kinematics.postures import limit_notes


def joint_limit_notes(resolved: Resolved, t: Array, q: Array) -> list[str]:
    """At most one note a part.

    Args:
        resolved: Diagram that ran.
        t: Recorded times (n).
        q: States (n, nq).
    """
    layout = resolved.layout
    return [
        note
        for part in layout.parts
        for note in limit_notes(layout.q_names[part.q], _limits(resolved, part), t, q[:, part.q])
    ]


def _limits(resolved: Resolved, part: Part) -> list[tuple[int, float, float]]:
    """Limits of joints of a part's mechanisms, by index in the part's q."""
    models, layout = resolved.wired.models, resolved.layout
    return [
        (layout.q[name].start - part.q.start + i, lower, upper)
        for name in part.blocks
        if name in layout.q
        for i, lower, upper in joint_limits(models.tree(resolved.pieces[name].block.mechanism()))
    ]
