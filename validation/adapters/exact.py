"""The truth of many digits of a rigid description, in our own coordinates and speeds."""

from __future__ import annotations

import numpy as np

from ..contract.interface import Subject
from ..engines.interface import Slot
from ..engines.proving.pieces import Layout
from ..engines.truth.arithmetic import exact, many_digits
from ..engines.truth.dynamics import Truth, digits
from ..mechanics.geometry import Array
from ..mechanics.joint_kinds import PartKind
from .charted import stated

# Simple joints -> our charts of them.
_CHARTS: dict[PartKind, str] = {
    "revolute": "angle",
    "prismatic": "length",
    "screw": "screw angle",
    "ball": "quaternion xyzw, body speeds",
    "free": "free xyzw, body speeds",
}


def accelerations(subject: Subject, q: Array, v: Array, tau: Array) -> Array:
    """Accelerations under forces (nv), of doubles as they are, rounded to doubles.

    Args:
        subject: A tree of rigid bodies without constraints and rotors.
        q: Coordinates (nq).
        v: Speeds (nv).
        tau: Forces (nv), all but the weight.
    """
    assembly, tree = subject.assembly, stated(subject, whole=False, merged=True).tree
    slots = [
        (Slot(_CHARTS[one.kind], tuple(range(one.q.start, one.q.stop)), tuple(range(one.v.start, one.v.stop))),)
        for one in assembly.movers
    ]
    fixed: list[tuple[Slot, ...]] = [()] * (len(tree.links) - len(slots))
    layout = Layout(assembly.nq, assembly.nv, (*slots, *fixed))
    with many_digits():
        return digits(Truth(tree, layout).FD(*(exact(np.asarray(x)) for x in (q, v, tau))))
