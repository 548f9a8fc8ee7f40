"""Lengths of zero that take the mass from a motion are named, wherever accelerations are asked for."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import symofros as sf
from symofros.simulation.analysis.singular_mass import singular_mass

LINKS = 3


def chain(length: float = 1.0) -> sf.System:
    """Point masses at the ends of rods without mass."""
    bodies = [
        sf.RigidBody(
            f"link{i}",
            sf.Joint(f"q{i}", "revolute", *((f"link{i - 1}", "end") if i > 1 else ())),
            sf.Inertia(1.0, (sf.formula(f"L{i}"), 0, 0)),
            (sf.Frame("end", (sf.formula(f"L{i}"), 0, 0)),),
        )
        for i in range(1, LINKS + 1)
    ]
    parameters = [sf.Parameter(f"L{i}", length if i == 2 else 1.0) for i in range(1, LINKS + 1)]
    return sf.System("chain", bodies, parameters, gravity=(0, -9.81, 0))


@cache
def model() -> sf.Model:
    return sf.compile(chain())


Q = np.array([0.3, -0.4, 0.5])


@pytest.mark.parametrize("zero", [1, 2])
@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_a_length_of_zero_inside_a_chain_is_named_by_speeds_and_parameter(zero: int, scale: float) -> None:
    lengths = {f"L{i}": scale * (i != zero) for i in range(1, LINKS + 1)}
    m = model().with_parameters(**lengths)
    words = singular_mass(m, Q)
    assert f"'q{zero}', 'q{zero + 1}' together move no mass" in words and f"zero: L{zero}" in words
    by_values = sf.simulate(model(), Q, t_end=0.1, par=lengths).outcome
    batch = sf.simulate_batch(m, Q[None], t_end=0.1).outcome(0)
    for outcome in (sf.simulate(m, Q, t_end=0.1).outcome, by_values, batch):
        assert outcome.kind == "singular" and outcome.reason == words and "length" in outcome.advice
    with pytest.raises(sf.SymofrosError, match=f"together move no mass; parameters that are zero: L{zero}"):
        sf.modes(m, Q)
