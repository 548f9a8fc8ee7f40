"""The truth of many digits of a rigid description, in our own coordinates and speeds."""

from __future__ import annotations

import numpy as np

from ..contract.interface import Subject
from ..engines.proving.pieces import Layout
from ..engines.truth.arithmetic import exact, many_digits
from ..engines.truth.dynamics import Truth, digits
from ..mechanics.geometry import Array
from .stated import stated


def accelerations(subject: Subject, q: Array, v: Array, tau: Array) -> Array:
    """Accelerations under forces (nv), of doubles as they are, rounded to doubles.

    Args:
        subject: A tree of rigid bodies without constraints and rotors.
        q: Coordinates (nq).
        v: Speeds (nv).
        tau: Forces (nv), all but the weight.
    """
    movers, tree = subject.assembly.movers, stated(subject, whole=False, merged=True).tree
    # Links follow the movers, whose coordinates need not be in their order.
    coordinates = np.concatenate([np.arange(subject.assembly.nq)[one.q] for one in movers])
    speeds = np.concatenate([np.arange(subject.assembly.nv)[one.v] for one in movers])
    with many_digits():
        found = digits(Truth(tree, Layout.ours(tree)).FD(exact(q[coordinates]), exact(v[speeds]), exact(tau[speeds])))
    result = np.zeros_like(found)
    result[speeds] = found
    return result
