"""Power and energy don't depend on the chart; speeds and accelerations in it, engines are held to in checks."""

import numpy as np

from tests.validation.subjects import every_kind, states_of
from validation.adapters.charted import ChartedEngine
from validation.adapters.mujoco import tree
from validation.contract.conventions import times


def test_power_and_energy_do_not_depend_on_the_chart() -> None:
    subject = every_kind()
    built, states = tree.build(subject), states_of(subject, 20)
    assert isinstance(built, ChartedEngine)
    v_e = built.chart.speeds(states.q, states.v)
    Q_e = built.chart.forces(states.q, states.applied)
    assert np.allclose(np.sum(Q_e * v_e, axis=1), np.sum(states.applied * states.v, axis=1))
    assert np.allclose(built.chart.our_forces(states.q, Q_e), states.applied)
    M = built.mass_matrix(states)
    twice = np.sum(states.v * times(M, states.v), axis=1)
    assert np.allclose(twice / 2, built.kinetic_energy(states), rtol=1e-13)
