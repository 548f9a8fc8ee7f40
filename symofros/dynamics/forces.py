"""Generalized forces of joint efforts: motors as inputs, and formulas of the description."""

from __future__ import annotations

from symofros.description.values import symbols
from symofros.expr.graph import ZERO, Edge
from symofros.kinematics.links import Motion


def joint_efforts(motion: Motion, with_inputs: bool) -> list[Edge]:
    """Q of the joints: an effort's virtual power on its own speed is the effort (docs/theory/rigid.md, eq. 23).

    Args:
        motion: The tree.
        with_inputs: False sets every input to zero.

    Returns:
        One edge a speed.
    """
    g, tree = motion.g, motion.tree
    total: list[Edge] = [ZERO] * motion.nv
    motor = len(tree.system.inputs)
    stated = {item.name for item in tree.system.inputs}
    for link in tree.links:
        start, size = link.v
        for k, value in enumerate(link.joint.effort):
            if not with_inputs and symbols(value) & stated:
                edge = motion.lowering.value_without(value, stated)
            else:
                edge = motion.lowering.value(value)
            total[start + k] = edge
        if link.joint.actuated:
            for k in range(size):
                effort = g.input("u", motor + k) if with_inputs else ZERO
                total[start + k] = g.add(total[start + k], effort)
            motor += size
    return total
