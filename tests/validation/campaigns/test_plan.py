from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML

from validation.campaigns.errors import PlanError
from validation.campaigns.plan import CheckPlan, cases, identities, make, plan_hash, read
from validation.campaigns.tasks import CheckTask, tasks

CHECK: dict[str, Any] = {
    "kind": "check",
    "models": ["pendulum", "cart_pole", "heavy_top"],
    "states": 1000,
    "batch": 150,
}
SWEEP: dict[str, Any] = {
    "kind": "sweep",
    "model": "double_pendulum",
    "quantity": "end_state",
    "motion": {"t_end": 0.1},
    "over": {"m1": {"low": 1.0, "high": 2.0, "count": 3}},
}


def test_the_same_plan_falls_into_the_same_batches() -> None:
    assert tasks(make(CHECK, "a")) == tasks(make(dict(reversed(CHECK.items())), "b"))


def test_batches_share_all_states_without_gap_or_overlap() -> None:
    batches = [task for task in tasks(make(CHECK, "plan")) if isinstance(task, CheckTask)]
    assert [task.number for task in batches] == list(range(len(batches)))
    for label, states in (("pendulum", 334), ("cart_pole", 333), ("heavy_top", 333)):
        own = [task.settings for task in batches if task.case.label == label]
        assert [own_part.first for own_part in own] == [0, 150, 300]
        assert sum(own_part.states for own_part in own) == states
    assert sum(task.size for task in batches) == 1000


def test_the_hash_tells_plans_and_models_apart(tmp_path: Path) -> None:
    plan = make(CHECK, "plan")
    models = identities(cases(plan))
    same = plan_hash(plan, models)
    assert same == plan_hash(make(CHECK, "again"), identities(cases(plan)))
    assert same != plan_hash(make(CHECK | {"seed": 1}, "plan"), models)
    assert same != plan_hash(plan, models | {"pendulum": "edited"})


BAD = YAML(typ="safe").load(Path(__file__).with_name("bad_plans.yaml"))


@pytest.mark.parametrize("bad", BAD, ids=lambda bad: f"{bad['of']}: {bad['says']}")
def test_a_bad_plan_is_refused(bad: dict[str, Any]) -> None:
    with pytest.raises(PlanError, match="remedy") as caught:
        tasks(make({"check": CHECK, "sweep": SWEEP}[bad["of"]] | bad["change"], "plan.toml"))
    assert bad["says"] in str(caught.value)


def test_a_file_of_a_plan_is_read(tmp_path: Path) -> None:
    path = tmp_path / "plan.toml"
    path.write_text('kind = "check"\nmodels = ["pendulum", "cart_pole", "heavy_top"]\nstates = 1000\nbatch = 150\n')
    assert read(path) == make(CHECK, "plan")


@pytest.mark.parametrize("text", ["kind = ", "\udcff", "a = " + "[" * 100_000, "#" * (2 << 20)])
def test_invalid_toml_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "plan.toml"
    path.write_bytes(text.encode("utf-8", "surrogateescape"))
    with pytest.raises(PlanError, match="plan.toml"):
        read(path)


def test_a_batch_is_reproducible_and_reports_its_position() -> None:
    plan = make({"kind": "check", "models": ["pendulum"], "states": 40, "batch": 20, "engines": ["pinocchio"]}, "plan")
    first, second = tasks(plan)
    rows = second.run()
    assert rows.equals(second.run()) and not rows.equals(replace(first, number=1).run())  # type: ignore[type-var]
    assert set(rows["first_state"].to_pylist()) == {20} and set(rows["agree"].to_pylist()) == {True}
    # What does not depend on the number of states is found once.
    assert "energy_drift" in first.run()["quantity"].to_pylist() and "energy_drift" not in rows["quantity"].to_pylist()


def test_a_model_that_cannot_be_compared_is_a_row(tmp_path: Path) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text("nonsense: 1")
    plan = make({"kind": "check", "models": [str(path)], "states": 5}, "plan")
    (task,) = tasks(plan)
    assert isinstance(plan, CheckPlan)
    (row,) = task.run().to_pylist()
    assert row["status"] == "failed" and row["agree"] is None and row["quantity"] == "load"
