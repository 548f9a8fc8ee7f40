from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import reference_models
import symofros as sf
from validation.campaigns.plan import SweepPlan, make
from validation.campaigns.sweep import DONE, Sweeper
from validation.campaigns.tasks import tasks
from validation.inputs.cases import Case

END_STATE: dict[str, Any] = {
    "kind": "sweep",
    "model": "double_pendulum",
    "quantity": "end_state",
    "design": "sobol",
    "points": 16,
    "batch": 6,
    "over": {"m1": {"low": 0.5, "high": 2.0}, "L2": {"low": 0.2, "high": 0.8, "log": True}},
    "start": {"q": {"q1": 0.4}, "v": {"q2": 0.1}},
    "inputs": {"q1": 0.2},
    "motion": {"t_end": 0.2, "dt": 0.002},
}
FREQUENCIES: dict[str, Any] = {
    "kind": "sweep",
    "model": "spinning_beam",
    "quantity": "frequencies",
    "modes": 2,
    "over": {"dhub": {"low": 0.0, "high": 6.0, "count": 3}, "L": {"low": 6.0, "high": 9.0, "count": 2}},
}


def sweeper(data: dict[str, Any]) -> Sweeper:
    plan = make(data, "plan")
    assert isinstance(plan, SweepPlan)
    return Sweeper(plan, Case(plan.model))


def test_end_states_match_single_simulations() -> None:
    rows = [row for task in tasks(make(END_STATE, "plan")) for row in task.run().to_pylist()]
    assert [row["point"] for row in rows] == list(range(16))
    model = sf.compile(reference_models.MODELS["double_pendulum"])
    for row in rows[::5]:
        changed = model.with_parameters(m1=row["over:m1"], L2=row["over:L2"])
        run = sf.simulate(changed, [0.4, 0.0], [0.0, 0.1], 0.2, dt=0.002, u={"q1": 0.2})
        found = [row["q:q1"], row["q:q2"], row["v:q1"], row["v:q2"]]
        # The same steps by vectors: rounding alone differs.
        np.testing.assert_allclose(found, [*run.q[-1], *run.v[-1]], rtol=1e-10)
        assert row["outcome"] == DONE


def test_frequencies_match_the_steady_motion() -> None:
    rows = sweeper(FREQUENCIES).table(0, 0, 6).to_pylist()
    model = sf.compile(reference_models.MODELS["spinning_beam"])
    for row in rows:
        u, par = [0.0, row["over:dhub"], 0.0], [row["over:L"], model.parameters["rhoA"], model.parameters["EI"]]
        rest = sf.equilibrium(model, u=u, par=par)
        expected = sf.modes(model, rest.q, rest.v, u, par=par).frequencies[:2]
        assert [row["frequency_1"], row["frequency_2"]] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (
            {"over": {"m9": {"low": 1.0, "high": 2.0}}},
            "over.m9: 'm9' is no parameter and no input of",
        ),
        ({"start": {"q": {"q9": 1.0}}}, "start.q: no 'q9'; there are q1, q2"),
        ({"inputs": {"motor": 1.0}}, "inputs: no 'motor'"),
        ({"held": ["q9"], "quantity": "frequencies", "motion": None}, "held: no 'q9'; there are q1, q2"),
    ],
)
def test_names_that_the_model_lacks_are_refused(change: dict[str, Any], says: str) -> None:
    with pytest.raises(sf.UnknownNameError) as caught:
        sweeper(END_STATE | change)
    assert says in str(caught.value)


UPRIGHT: dict[str, Any] = {
    "kind": "sweep",
    "model": "cart_pole",
    "quantity": "frequencies",
    "over": {"m_pole": {"low": -0.1, "high": 0.1, "count": 2}},
}


@pytest.mark.parametrize("quantity", ["frequencies", "end_state"])
def test_parameters_that_are_refused_cost_their_own_point(quantity: str) -> None:
    motion = None if quantity == "frequencies" else {"t_end": 0.1, "dt": 0.002}
    refused, row = sweeper(UPRIGHT | {"quantity": quantity, "motion": motion}).table(0, 0, 2).to_pylist()
    assert "m_pole = -0.1" in refused["outcome"] and "mass -0.1" in refused["outcome"]
    assert row["outcome"] == DONE
    result = "frequency_2" if quantity == "frequencies" else "q:q"
    assert refused[result] is None and row[result] is not None


def test_rates_of_an_unstable_equilibrium_are_no_frequencies_in_silence() -> None:
    _, upright = sweeper(UPRIGHT).table(0, 0, 2).to_pylist()
    grows, decays, rest = upright["notes"].splitlines()
    assert "grows at" in grows and "decays at" in decays and "without oscillation" in grows
    assert "this rest is unstable" in rest
    hanging = sweeper(UPRIGHT | {"start": {"q": {"q": 3.0}}}).table(0, 1, 1).to_pylist()[0]
    assert hanging["outcome"] == DONE and hanging["notes"] == ""


def test_notes_of_a_motion_are_kept() -> None:
    motion = {"t_end": 2.0, "dt": 0.2}
    data = END_STATE | {"points": 2, "motion": motion, "over": {"m1": {"low": 0.5, "high": 2.0}}}
    rows = sweeper(data).table(0, 0, 2).to_pylist()
    assert all("steps of 0.2 s" in row["notes"] for row in rows)
