"""Packages look for events and do what they do, as sf.simulate."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.simulation.stepping.status import Status
from tests.diagrams.run.test_switching import CASES
from tests.exports.cases import packaged, run
from tests.models import bounds
from tests.simulation.grasping import grabbing
from tests.simulation.mechanisms import slide

MAIN = Path(__file__).with_name("events.c").read_text()
# A ball that bounces as a body that strikes a constraint does, and is caught at its third contact.
_FLOOR = sf.Closure("floor", ("world", None), ("body", None), ("z",))
_BALL = slide(
    name="z",
    axis=(0, 0, 1),
    gravity=(0, 0, -10),
    parameters=(sf.Parameter("contact", 0.0),),
    constraints=(_FLOOR,),
)
BALL = sf.System(
    "ball", _BALL.bodies, _BALL.parameters, _BALL.inputs, _BALL.gravity, constraints=_BALL.constraints,
    switches=(sf.Switch("floor", "contact"),),
)  # fmt: skip
STRIKE = {"strike": sf.Event("z", "falling", action={"contact": 1}, restitution=0.5)}


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
@pytest.mark.parametrize("span", [1e-3, 0.06])
def test_packages_grasp_and_release_as_runs_do(tmp_path: Path, method: str, span: float) -> None:
    """In calls of any length, and again after a reset."""
    plan: dict[str, Any] = {
        "grab": sf.Event("t - 0.0203", action={"grip": 1}, once=True),
        "drop": sf.Event("t - 0.04", action={"grip": "1 - grip", "dq1": 0.1}),
        "light": sf.Event("t - 0.05", action={"m": "m/2"}),
    }
    start = {"q1": 0.3, "q2": -0.4, "dq1": 0.5, "f.px": 1.2, "f.py": 0.2, "f.wz": 1.0}
    options: dict[str, Any] = {"method": method} | bounds(method, 1e-9, 1e-11)
    given = {"name": "plan", "events": plan, "start": start, "dt": 1e-3, **options}
    program = packaged(grabbing("moment"), tmp_path / "c", MAIN, **given)
    *met, status, state = run(program, repr(span), "0.06", cwd=tmp_path).splitlines()
    model = sf.compile(grabbing("moment"))
    q0 = model.neutral()
    q0[[model.names.q.index(name) for name in ("q1", "q2", "f.px", "f.py")]] = 0.3, -0.4, 1.2, 0.2
    again = sf.simulate(model, q0, {"q1": 0.5, "f.wz": 1.0}, 0.06, events=plan, dt=1e-3, **options)
    assert status == f"status {Status.FINISHED}" and [line.split()[0] for line in met] == ["grab", "drop", "light"]
    assert [float(line.split()[1]) for line in met] == pytest.approx([found.t for found in again.events], abs=1e-12)
    numbers = np.array(state.split()[1:], dtype=float)
    assert numbers == pytest.approx(
        np.concatenate([again.q[-1], again.v[-1]]), abs=1e-8 if method == "dopri5" else 1e-12
    )


@pytest.mark.parametrize(("method", "span"), [("rk4", 1e-3), ("rk4", 0.05), ("dopri5", 0.05)])
def test_a_contact_rests_and_opens_in_packages(tmp_path: Path, method: str, span: float) -> None:
    """At the instants of the run, the last strike among them, where both have the thresholds (32c)."""
    stated = CASES["rest"]
    options: dict[str, Any] = {"events": stated.events, "dt": 1e-3, "method": method}
    options |= bounds(method, 1e-10, 1e-12)
    program = packaged(stated.system, tmp_path / "c", MAIN, name="plan", start=stated.start, **options)
    *met, status, state = run(program, repr(span), "1.0", cwd=tmp_path).splitlines()
    again = sf.simulate(sf.compile(stated.system), [stated.start["z"]], t_end=1.0, **options)
    assert status == f"status {Status.FINISHED}" and met[-1].startswith("strike opens 0.827")
    assert [line.rsplit(maxsplit=1)[0] for line in met] == [found.name for found in again.events]
    assert [float(line.split()[-1]) for line in met] == pytest.approx([found.t for found in again.events], abs=1e-12)
    numbers = np.array(state.split()[1:], dtype=float)
    assert numbers == pytest.approx([again.q[-1, 0], again.v[-1, 0]], abs=1e-10)


def test_a_package_does_not_start_within_a_floor(tmp_path: Path) -> None:
    """It says so by its status, as a run does."""
    stated = CASES["rest"]
    given = {"name": "plan", "start": {"z": -1e-3}, "events": stated.events}
    program = packaged(stated.system, tmp_path / "c", MAIN, **given)
    assert f"status {Status.WRONG_CONTACT}" in run(program, "0.01", "0.1", cwd=tmp_path)


def test_a_body_that_begins_on_its_floor_rests_in_packages(tmp_path: Path) -> None:
    """The event acts at the start, as in runs (simulation.md, (4f)): twice, until the contact stays."""
    strike = {"strike": sf.Event("z", "falling", action={"contact": 1}, restitution=0.5, rests="lam.floor.z")}
    program = packaged(BALL, tmp_path / "c", MAIN, name="plan", start={"z": 0.0}, events=strike, dt=1e-3)
    *met, status, state = run(program, "0.01", "0.05", cwd=tmp_path).splitlines()
    assert status == f"status {Status.FINISHED}" and met == ["strike 0", "strike 0"]
    assert np.array(state.split()[1:], dtype=float) == pytest.approx([0.0, 0.0], abs=1e-14)


def test_a_package_ends_where_an_event_does_or_an_action_fails(tmp_path: Path) -> None:
    """With the state that is there; targets that look for none refuse them."""
    ends = {**STRIKE, "rest": sf.Event("t - 0.9", terminal=True)}
    for t_end, expected in ((0.95, Status.TERMINAL_EVENT), (3.0, Status.ACTS_WITHOUT_END)):
        given = {"name": "plan", "events": ends if t_end < 1.0 else STRIKE, "start": {"z": 0.8}}
        program = packaged(BALL, tmp_path / str(t_end) / "c", MAIN, **given)
        *met, status, state = run(program, "0.01", repr(t_end), cwd=tmp_path).splitlines()
        assert status == f"status {expected}" and met[0].startswith("strike 0.4")
        assert abs(float(state.split()[1])) < 0.2
    for target in ("sfunction", "cuda"):
        with pytest.raises(sf.ExportError, match=f"'{target}' looks for no events"):
            sf.export(BALL, target, tmp_path / target, events=STRIKE)
    with pytest.raises(sf.ExportError, match="'rest' ends the motion"):
        sf.export(BALL, "fmu2", tmp_path / "fmu", events=ends)


def test_conditions_and_actions_of_one_package_take_sines(tmp_path: Path) -> None:
    """Formulas of both are files of the same source."""
    event = {"swings": sf.Event("sin(x) - 0.1", "rising", action={"dx": "-sin(x)*dx"})}
    system = slide(name="x", axis=(1, 0, 0), gravity=(1, 0, 0))
    program = packaged(system, tmp_path / "c", MAIN, name="plan", events=event, dt=1e-3)
    *met, _, state = run(program, "0.1", "1.0", cwd=tmp_path).splitlines()
    known = sf.simulate(sf.compile(system), t_end=1.0, dt=1e-3, events=event)
    assert len(met) == len(known.events) > 0
    assert np.array(state.split()[1:], dtype=float) == pytest.approx([*known.q[-1], *known.v[-1]], abs=1e-12)
