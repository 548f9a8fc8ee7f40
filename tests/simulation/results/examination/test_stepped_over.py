"""What acts within a step of an adaptive method is met, or the run says that it was passed over."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.simulation.inputs import plan_inputs
from symofros.simulation.options import SimulationOptions
from symofros.simulation.results.examination.paths import path_within
from symofros.simulation.results.examination.stepped_over import _largest_sums
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.methods import METHODS
from symofros.simulation.stepping.stepper import Stepper
from tests.models import compiled
from tests.simulation.mechanisms import slide

ADAPTIVE = ("dopri5", "dop853", "rodas4")
CART = slide(actuated=True)


def noted(run: Any) -> list[str]:
    return [note for note in run.outcome.notes if "passes over what acts within it" in note]


@pytest.mark.parametrize("method", ADAPTIVE)
@pytest.mark.parametrize("seed", range(4))
def test_a_narrow_force_is_met_or_noted(method: str, seed: int) -> None:
    """A coasting cart meets a force on a small part of its way, which no one knows beforehand, whatever the date."""
    t0, rng = 1e4 * (seed % 2), np.random.default_rng(seed)
    at, width, force = rng.uniform(0.5, 8.0), 10 ** rng.uniform(-1.7, -0.5), rng.choice([-1, 1]) * rng.uniform(1, 20)
    law, cart = {"x": f"{force}*exp(-((x - {at})/{width})^2)"}, sf.compile(CART)
    truth = sf.simulate(cart, [0.0], [1.0], 10.0, u=law, method="rk4", dt=1e-3, output=1.0)
    run = sf.simulate(cart, [0.0], [1.0], t0 + 10.0, t0=t0, u=law, method=method)
    off = abs(run.v[-1, 0] - truth.v[-1, 0])
    assert (off < 1e-3) != bool(noted(run)), (at, width, force, off, str(run.outcome))


PULSE = "20*exp(-((t - 6.3)/0.05)^2)"


@pytest.mark.parametrize("law", [PULSE, "function"])
@pytest.mark.parametrize("method", ["dopri5", "dop853", "cvode"])
def test_a_pulse_that_a_body_at_rest_sleeps_through_is_noted(method: str, law: str) -> None:
    given: Any = {"x": law}
    if law == "function":
        given = lambda t, q, v: np.array([20.0 * np.exp(-(((t - 6.3) / 0.05) ** 2))])  # noqa: E731
    run = sf.simulate(sf.compile(CART), t_end=10.0, u=given, method=method)
    exact = 20.0 * 0.05 * np.sqrt(np.pi)
    assert (abs(run.v[-1, 0] - exact) < 1e-3) != bool(noted(run)), str(run.outcome)
    if noted(run):
        cure = float(noted(run)[0].split("max_step=")[1])
        again = sf.simulate(sf.compile(CART), t_end=10.0, u=given, method=method, max_step=cure)
        assert abs(again.v[-1, 0] - exact) < 1e-3 and not again.outcome.notes


@pytest.mark.parametrize("method", ["dopri5", "rk4", "cvode"])
def test_a_run_that_records_only_its_start_gives_no_note(method: str) -> None:
    """A record is no interval: there is nothing to look into, and no division by its length."""
    if method == "cvode":
        pytest.importorskip("sksundae")
    run = sf.simulate(sf.compile(CART), None, [1.0], 1e-3, u={"x": "t"}, method=method, output=[0.0])
    assert run.outcome.kind == "finished" and len(run.t) == 1 and not run.outcome.notes


def test_a_run_of_a_batch_is_noted_where_its_steps_miss_the_pulse() -> None:
    many = sf.simulate_batch(sf.compile(CART), np.zeros((2, 1)), [[0.0], [0.1]], 10.0, u={"x": PULSE}, method="dopri5")
    exact = 20.0 * 0.05 * np.sqrt(np.pi)
    for i, first in enumerate((0.0, 0.1)):
        assert (abs(many.v[i, -1, 0] - first - exact) < 1e-3) != bool(noted(many[i])), str(many.outcome(i))


@pytest.mark.parametrize("name", ["torque_free_body", "slider_crank"])
def test_a_path_between_records_is_the_motion(name: str) -> None:
    """Of rotations and loops as well: the states within steps are those of a run with short steps, to h^4."""
    model = compiled(name)
    if model.nc:
        start = sf.assemble(model, {"crank": 0.6} if "crank" in model.names.q else model.neutral())
        q, v = start.q, start.v
    else:
        q, v = model.random_state(np.random.default_rng(4))
    errors = []
    for dt in (0.02, 0.01):
        fine = sf.simulate(model, q, v, 0.1, method="rk4", dt=dt / 10)
        coarse = [x[::10] for x in (fine.t, fine.q, fine.v, fine.u)]
        settings = Settings.of(model, SimulationOptions(method="rk4", dt=dt / 10), 0.1)
        stepper = Stepper(model, METHODS["rk4"], plan_inputs(model, None), (), model.parameter_values)
        settings.apply(stepper)
        stepper.start(q, v, 16)
        path = path_within(stepper, coarse, np.full(len(coarse[0]) - 1, 5))
        assert path is not None
        rows = np.rint(path.states[0] / (dt / 10)).astype(int)
        np.testing.assert_allclose(path.states[0], fine.t[rows], atol=1e-12)
        a = model.forward_dynamics(fine.q[rows], fine.v[rows], fine.u[rows], t=fine.t[rows])
        errors.append([np.abs(model.difference(fine.q[rows], path.states[1])).max(), np.abs(path.a - a).max()])
    assert np.all(np.array(errors[1]) < 0.1 * np.array(errors[0]) + 1e-10), errors


def test_largest_sums_are_those_of_each_interval_in_its_own_metric(rng: np.random.Generator) -> None:
    for counts in (np.array([4]), np.array([4, 7, 8, 5, 9, 33, 4])):
        roots = rng.normal(size=(len(counts), 3, 3))
        metric, changes = roots @ roots.transpose(0, 2, 1), rng.normal(size=(counts.sum(), 3))
        found = _largest_sums(changes, counts, metric)
        for k, own in enumerate(np.split(changes, np.cumsum(counts)[:-1])):
            sums = np.cumsum(own, axis=0)
            assert found[k] == pytest.approx(np.sqrt((sums @ metric[k] * sums).sum(axis=1)).max(), rel=1e-12)
