"""Plug-ins of the matrix as judges of a check: charts, ours without an adapter, one of another package, faulty ones."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.validation.engines.fakes import PLUGINS, Plugin, install_toy
from tests.validation.subjects import UNIT, moved, states_of, subject_of
from validation.adapters import plugged
from validation.checking import Settings, check
from validation.contract.conventions import _MEANINGS, SLIDES_AND_BALL, Chart, Slot
from validation.engines.interface import Joint, Registry, rows, vector
from validation.engines.truth.arithmetic import exact
from validation.engines.truth.charts import CHARTS
from validation.engines.truth.dynamics import digits
from validation.mechanics.assembly import Assembly
from validation.mechanics.geometry import Placement, quaternion_matrix

ROOT = Path(__file__).parents[3]
STEP = 1e-6
# Central differences of that step leave 1e-10 of rounding, times what is differentiated.
CLOSE = 1e-6
FREE = [name for name in _MEANINGS if name.startswith("free")]
SOLVED = {"mass_matrix", "bias", "kinetic_energy", "potential_energy", "inverse_dynamics", "forward_dynamics"}
BALLS = [name for name in _MEANINGS if name not in FREE and name != SLIDES_AND_BALL]


def carried(kind: sf.JointKind) -> sf.System:
    """A ball or free joint, obliquely placed on a hinged body, or alone."""
    joint = sf.Joint("j", kind, "a", position=(0.3, -0.2, 0.5), rotation=sf.Rotation.rpy(0.4, -0.7, 1.1))
    return sf.System("carried", [sf.RigidBody("a", sf.Joint("h", "revolute"), UNIT), sf.RigidBody("b", joint, UNIT)])


@pytest.mark.parametrize(("chart", "grounded"), [*((c, False) for c in BALLS + FREE), *((c, True) for c in FREE)])
def test_a_chart_is_converted_as_the_truth_has_it(chart: str, grounded: bool) -> None:
    """The same pose, speeds that are its rates, and the rate of what turns them."""
    subject = subject_of(carried("free" if chart in FREE else "ball"))
    assembly: Assembly = subject.assembly
    mover = assembly.movers[1]
    own_q, own_v = mover.q, mover.v
    slot = Slot(mover, 0, 0, chart, grounded)
    X = Placement.identity() if grounded else mover.X_AP
    joint, states = Joint("free", rows(X.R), vector(X.p)), states_of(subject)[-5:]  # No half turns.

    def at(time: float) -> np.ndarray:
        return moved(assembly, states.q, time * states.v)[:, own_q]

    q, v = states.q[:, own_q], states.v[:, own_v]
    speeds = (slot.transform(q) @ v[:, :, None])[..., 0]
    ahead, behind = slot.coordinates(at(STEP)), slot.coordinates(at(-STEP))
    turning = (slot.transform(at(STEP)) - slot.transform(at(-STEP))) / (2 * STEP)
    assert np.abs(slot.transform_rate(q, v) - turning).max() < CLOSE
    assert slot.turns == bool(np.abs(turning).max() > CLOSE)
    for k, coordinates in enumerate(slot.coordinates(q)):
        R, p = map(digits, CHARTS[chart].pose(joint, exact(coordinates)))
        ours = Placement(quaternion_matrix(q[k, -4:]), q[k, :-4] if chart in FREE else np.zeros(3))
        ours = mover.X_AP @ ours if grounded else ours
        assert np.allclose(R, ours.R, atol=1e-14) and np.allclose(p, ours.p, atol=1e-14)
        rates = digits(CHARTS[chart].rates(joint, exact(coordinates)) @ exact(speeds[k]))
        assert np.abs(rates - (ahead[k] - behind[k]) / (2 * STEP)).max() < CLOSE


def test_a_chart_that_checks_do_not_convert_is_refused_by_its_name() -> None:
    mover = subject_of(carried("ball")).assembly.movers[1]
    with pytest.raises(ValueError, match="joint 'j': checks have no conversion of the chart 'three angles'"):
        Chart((Slot(mover, 0, 0, "three angles"),), 3, 3)


@pytest.mark.parametrize("engine", ["casadi", "exudyn-joints"])
@pytest.mark.parametrize("model", ["torque_free_body", "four_bar", "gyroscope"])
def test_plug_ins_without_an_adapter_judge(engine: str, model: str) -> None:
    result = check(subject_of(MODELS[model]), Settings(4, engines=(engine,)))
    rows = [row for row in result.comparisons if row.engine == engine]
    if engine == "exudyn-joints" and model == "four_bar":
        assert [(row.status, bool(row.note)) for row in rows] == [("unsupported", True)]
        return
    assert result.ok and {row.quantity for row in rows if row.status == "agree"} >= SOLVED


def test_an_engine_of_another_package_judges_a_model(tmp_path: Path) -> None:
    """The toy of the page knows one hinge: its mass is wrong, and so are energy and nothing else."""
    install_toy(tmp_path)
    arm = sf.RigidBody("arm", sf.Joint("h", "revolute"), sf.Inertia(2.0, (0.5, 0.0, 0.0), (0.1, 0.2, 0.3)))
    sf.save(sf.System("pendulum", [arm], gravity=(0.0, -9.81, 0.0)), tmp_path / "pendulum.yaml")
    command = [
        sys.executable,
        "-m",
        "validation",
        "check",
        "pendulum.yaml",
        "--engine",
        "toy",
        "--states",
        "5",
        "--json",
    ]
    run = subprocess.run(
        command,
        cwd=tmp_path,
        env={"PYTHONPATH": f"{tmp_path}:{ROOT}", "PATH": "/usr/bin:/bin", "HOME": str(tmp_path)},
        capture_output=True,
        text=True,
    )
    data = json.loads(run.stdout)
    judged = {row["quantity"]: row["ok"] for row in data["comparisons"] if row["engine"] == "toy"}
    assert judged == {"mass_matrix": False, "gravity": True, "kinetic_energy": False}, run.stderr
    assert run.returncode == 1 and data["independent"] == 3


def test_faults_of_a_plug_in_harm_its_own_rows_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    plugins = PLUGINS | {"right": Plugin("right")}
    monkeypatch.setattr(Plugin, "kinds", {"revolute z": "hinge"})
    monkeypatch.setattr(plugged, "registry", lambda: Registry(dict(plugins)))
    result = check(subject_of(MODELS["double_pendulum"]), Settings(4, engines=("mujoco", *plugins, "absent")))
    rows = {name: [row for row in result.comparisons if row.engine == name] for name in (*plugins, "mujoco", "absent")}
    assert all(row.ok for name in ("right", "mujoco") for row in rows[name])
    assert [(row.status, row.note) for row in rows["absent"]] == [
        ("unsupported", "no package here offers a plug-in 'absent'")
    ]
    for name in plugins.keys() - {"right"}:
        assert rows[name] and not any(row.ok for row in rows[name]), name
    assert rows["slotless"][0].note.startswith("raises ValueError: slots of 3 links for a tree of 4")
    assert {row.note for row in rows["unnumbered"]} >= {"not a finite number in some state"}
