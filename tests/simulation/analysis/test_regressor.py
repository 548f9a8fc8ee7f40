"""The regressor against Pinocchio's, and the base parameters that it reveals."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.late import require
from tests.models import sampled
from validation.adapters.pinocchio import tree as pin_adapter
from validation.contract.interface import Subject

pin = require("pinocchio", "validation")
FUNCTIONS = sf.Options(functions=("regressor", "bias", "mass_matrix"))


@pytest.mark.parametrize("name", sampled(("pendulum", "rx90", "space_arm", "mss"), ("rx90", "space_arm")))
def test_pinocchios(name: str) -> None:
    system = MODELS[name]
    m, engine = sf.compile(system, FUNCTIONS), pin_adapter.build(Subject(name, system))
    rng = np.random.default_rng(0)
    for _ in range(3):
        q, v = m.random_state(rng)
        a = rng.normal(size=m.nv)
        chart = engine.chart
        state = (chart.coordinates(q[None])[0], chart.speeds(q[None], v[None])[0])
        acceleration = chart.accelerations(q[None], v[None], a[None])[0]
        theirs = pin.computeJointTorqueRegressor(engine.model, engine.model.createData(), *state, acceleration)
        ours = m.regressor(q, v, a)
        theirs = np.reshape(theirs, ours.shape)
        assert np.abs(ours - theirs).max() < 1e-11 * np.abs(theirs).max()


@pytest.mark.parametrize(("name", "count"), [("pendulum", 3), ("rx90", 36)])
def test_base_parameters(name: str, count: int) -> None:
    """A swinging body reveals one moment and two first moments; an arm like rx90 36 combinations of 60 parameters."""
    m = sf.compile(MODELS[name], FUNCTIONS)
    base = sf.base_parameters(m)
    rng = np.random.default_rng(5)
    q, v = m.random_state(rng)
    a, pi = rng.normal(size=m.nv), rng.normal(size=base.combine.shape[1])
    Y = m.regressor(q, v, a)
    assert Y[:, base.independent] @ (base.combine @ pi) == pytest.approx(Y @ pi, rel=1e-9, abs=1e-9)
    assert len(base.independent) == count
