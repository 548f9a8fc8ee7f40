"""Andrews' squeezing mechanism: closed postures, accelerations and loop forces at the start.

Figures: the IVP test set (Mazzia and Magherini) for t = 0 and t = 0.03; a solution in absolute coordinates that agrees
with it for the other times. Motions between them: test_iftomm.py.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from tests.models import compiled

Array = np.ndarray
# The coordinates in the order of the literature.
ORDER = ("beta", "Theta", "gamma", "Phi", "delta", "Omega", "epsilon")
START = (
    -0.06171389001427645,
    0.0,
    0.45527981916307037,
    0.22266839016588588,
    0.48736497954384256,
    -0.22266839016588588,
    1.2305474445498212,
)
# Angles, rates, and the point F at the end of K1, by time.
MOTION = {
    float(head[0]): (angles, rates, head[1:3])
    for head, angles, rates in np.loadtxt(Path(__file__).with_name("andrews_squeezer.txt")).reshape(-1, 3, 7)
}


@cache
def model() -> sf.Model:
    return compiled("andrews_squeezer")


def ours(values: Sequence[float] | Array) -> Array:
    """Numbers in the order of the literature, in that of the model."""
    return np.array([values[ORDER.index(name)] for name in model().names.q])


def test_initial_accelerations_and_forces_match_the_reference() -> None:
    """y'' and lambda of the IVP test set: only the crank and K2 accelerate, only the loop through K3 is loaded."""
    m, q = model(), ours(START)
    assert np.abs(m.constraint(q)).max() < 1e-16
    a, lam = m.forward_dynamics(q, np.zeros(7), [], multipliers=True)
    wanted = ours((14222.4439199541138, -10666.8329399655854, 0, 0, 0, 0, 0))
    assert np.abs(a - wanted).max() < 1e-12 * 14222.0
    # Its lambda acts against ours, along the axes of the world; ours along those of K3.
    _, R = m.frame_pose("K3.end", q)
    assert -(R[:2, :2] @ lam[:2]) == pytest.approx([98.56687039624109, -6.122688344255662], rel=1e-12)
    assert np.abs(lam[2:]).max() < 1e-11


@pytest.mark.parametrize("t", MOTION)
def test_postures_are_closed(t: float) -> None:
    """At 0.03 s the solution of the test set was found with a tolerance of 1e-14 on an equation of index 3."""
    angles, rates, F = MOTION[t]
    m, q, v = model(), ours(angles), ours(rates)
    # Links of centimetres, rates of a thousand rad/s; the digits of the test set's rates are good for 2e-7 rad/s.
    assert np.abs(m.constraint(q)).max() < 1e-12
    assert np.abs(m.constraint_rate(q, v)).max() < 1e-8
    assert m.frame_pose("F", q)[0][:2] == pytest.approx(F, abs=1e-10)
