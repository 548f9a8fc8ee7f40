"""Events of FMUs: Co-Simulation looks for them and does what they do; Model Exchange is not offered."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.simulation import instantiate_fmu

import symofros as sf
from reference_models import MODELS
from tests.diagrams.run.test_switching import CASES
from tests.exports.c.test_events import BALL, STRIKE
from tests.exports.c.test_rigid_contacts import SCENES, first
from tests.exports.fmi.logs import heard
from tests.exports.fmi.units import Unit, exported
from tests.simulation.rigid_scenes import WITHOUT_ANSWER, ball_system, rod_system, three_feet

STRIKES = {**STRIKE, "heavy": sf.Event("t - 0.1", action={"dz": "dz - 1"}, once=True)}
RESTS = CASES["rest"]


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize(
    ("ball", "events", "z", "t_end", "met", "bound"),
    [(BALL, STRIKES, 0.8, 0.9, "strike", 1e-9), (RESTS.system, RESTS.events, 0.05, 1.0, "strike opens", 1e-11)],
    ids=["bounces", "rests and is lifted"],
)
def test_a_ball_moves_in_co_simulation_as_in_a_run(
    tmp_path: Path, version: int, ball: sf.System, events: Any, z: float, t_end: float, met: str, bound: float
) -> None:
    """Whatever the communication step; kept states know which events have acted for good, thresholds are the run's."""
    unit = str(exported(ball, version, tmp_path, events=events, start={"z": z}))
    assert fmpy.read_model_description(unit).modelExchange is None
    done = fmpy.simulate_fmu(unit, stop_time=t_end, output_interval=0.01, output=["q.z", "v.z"])
    run = sf.simulate(sf.compile(ball), [z], t_end=t_end, events=events, dt=1e-3)
    assert len(run.events) >= 3 and run.events[-1].name == met
    assert met == "strike" or abs(done["q.z"][50]) < 1e-12
    assert done["q.z"][-1] == pytest.approx(run.q[-1, 0], abs=bound)
    assert done["v.z"][-1] == pytest.approx(run.v[-1, 0], abs=10 * bound)


def test_units_act_as_their_description_states(tmp_path: Path) -> None:
    """A part slips from a hand, and a rope catches it."""
    system = MODELS["docking"]
    first = dict(zip(sf.compile(system).names.q, sf.assemble(sf.compile(system)).q.tolist(), strict=True))
    unit = str(exported(system, 3, tmp_path, start=first, dt=1e-3))
    said = fmpy.read_model_description(unit)
    names = [variable.name for variable in said.modelVariables if variable.name.startswith("q.")]
    assert said.modelExchange is None and len(names) == len(first)
    done = fmpy.simulate_fmu(unit, stop_time=2.4, output_interval=0.01, output=names)
    run = sf.simulate(sf.compile(system), first, t_end=2.4, dt=1e-3, method="rk4")
    assert {"slips", "catches"} < {found.name for found in run.events}
    assert [done[name][-1] for name in names] == pytest.approx(run.q[-1], abs=1e-9)


@pytest.mark.parametrize("version", [2, 3])
def test_serialised_states_know_which_events_have_acted(tmp_path: Path, version: int) -> None:
    """A ball that bounces, and is struck once for good, goes on in another unit by the same bits."""
    path = exported(BALL, version, tmp_path, events=STRIKES, start={"z": 0.8})
    first, other = (Unit(path, version, True, tmp_path / name) for name in ("first", "other"))
    for it in (first, other):
        it.start()
    for k in range(45):
        first.fmu.doStep(0.01 * k, 0.01)
    other.restore(other.unpack(first.pack(first.save())))
    names = (*first.named("q."), *first.named("v."))
    ends = [moved[-1] for it in (first, other) for moved in it.twice(45, 0.01, *names)]
    assert all(np.array_equal(ends[0], end) for end in ends[1:])


def test_importers_get_the_end_of_a_motion(tmp_path: Path) -> None:
    """Who repeats a step that is discarded asks whether that makes sense: a start below the floor never moves on."""
    unit = str(exported(RESTS.system, 2, tmp_path, events=RESTS.events, start=RESTS.start))
    with heard() as (logger, log):
        done = fmpy.simulate_fmu(
            unit, stop_time=1.0, output_interval=0.01, start_values={"q.z": -0.1}, output=["q.z"], logger=logger
        )
    assert done["time"][-1] == 0.0 and len(log) < 20
    assert "a contact that rests is penetrated" in "".join(log)


@pytest.mark.parametrize("scene", ["box", "rims"])
@pytest.mark.parametrize(("version", "method"), [(2, "rk4"), (3, "rk4"), (3, "rodas4")])
def test_bodies_slide_in_co_simulation(tmp_path: Path, version: int, method: Any, scene: str) -> None:
    """As in sf.simulate; a state that is gone back to knows how its balls slide, and moves on by the same bits.

    The box spins so fast that slips turn away from where they began.
    """
    system, start = SCENES[scene]
    start = start | ({"free.pz": 0.11} if scene == "rims" else {"free.wz": 15.0})
    options: dict[str, Any] = {"method": method} | ({"rtol": 1e-9, "atol": 1e-12} if method == "rodas4" else {})
    path = exported(system, version, tmp_path, start=start, **options)
    unit = Unit(path, version, True, tmp_path / "unit")
    assert unit.description.modelExchange is None
    unit.start()
    names = unit.named("q.")
    for k in range(10):
        unit.fmu.doStep(0.01 * k, 0.01)
    other = Unit(path, version, True, tmp_path / "other")
    other.start()
    other.restore(other.unpack(unit.pack(unit.save())))
    ends = [moved[-1] for it in (unit, other) for moved in it.twice(10, 0.01, *names)]
    model = sf.compile(system)
    q, v = first(model, start)
    # To 1 s, for the package's threshold of what accumulates.
    run = sf.simulate(model, q, v, t_end=1.0, output=[0.0, 0.2, 1.0], dt=1e-3, **options)
    # Steps that adapt begin anew with each communication step.
    bound = 1e-11 if method == "rk4" else 1e-6
    assert all(np.array_equal(ends[0], end) for end in ends[1:])
    assert ends[0] == pytest.approx(run.q[1], abs=bound) and len(run.events) > 2


def test_a_ball_strikes_as_co_simulation_begins(tmp_path: Path) -> None:
    """It leaves the ground at half of its speed."""
    unit = str(exported(ball_system(0.5), 2, tmp_path, start={"free.pz": 0.1, "free.vz": -1.0}))
    done = fmpy.simulate_fmu(unit, stop_time=0.05, output_interval=0.01, output=["q.'free.pz'"])
    assert done["q.'free.pz'"][-1] == pytest.approx(0.1 + 0.5 * 0.05 - 0.5 * 9.81 * 0.05**2, abs=1e-12)


def test_importers_get_a_warning_of_painleves_paradox(tmp_path: Path) -> None:
    """A rod that leans against its slide, with too much friction."""
    start = {"z": float(np.cos(0.5)), "angle": 0.5, "dx": -2.0}
    unit = str(exported(rod_system(1.6), 2, tmp_path, start=start))
    with heard() as (logger, log):
        fmpy.simulate_fmu(unit, stop_time=0.1, output_interval=0.01, logger=logger)
    assert "Painleve's paradox" in "".join(log)


@pytest.mark.parametrize("version", [2, 3])
def test_importers_get_one_warning_a_run_of_strikes_in_sequence(tmp_path: Path, version: int) -> None:
    """After a reset again; a run without spin, after one that had such a strike, has none."""
    names = [f"free.{name}" for name in ("vx", "vy", "vz", "wx", "wy", "wz")]
    start = {"free.pz": 0.1} | dict(zip(names, WITHOUT_ANSWER, strict=True))
    path = str(exported(three_feet(), version, tmp_path, start=start))
    about, said = fmpy.read_model_description(path), list[int]()
    with heard() as (logger, log):
        unit = instantiate_fmu(fmpy.extract(path), about, fmi_type="CoSimulation", logger=logger)
        for share in (1.0, 0.0, 1.0):
            log.clear()
            given = {f"v.'{name}'": share * start[name] for name in names[3:]}
            fmpy.simulate_fmu(
                path, stop_time=0.05, output_interval=0.01, start_values=given, fmu_instance=unit, logger=logger
            )
            said.append("".join(log).count("struck one after the other at t = 0 s"))
            unit.reset()
        unit.freeInstance()
    assert said == [1, 0, 1]
