"""What a trajectory saves and shows."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from symofros.studio.viewer.playing.motion import read_motion
from tests.late import require
from tests.models import compiled


@pytest.fixture(scope="module")
def run() -> sf.Trajectory:
    model = compiled("double_pendulum")
    return sf.simulate(model, [0.3, 0.1], [0.0, 0.5], 0.1, dt=0.01)


def test_columns_are_selected_by_name(run: sf.Trajectory) -> None:
    first = run.model.names.q[0]
    np.testing.assert_array_equal(run[first], run.q[:, 0])
    np.testing.assert_array_equal(run[f"d{first}"], run.v[:, 0])
    with pytest.raises(KeyError):
        run["nothing"]


def test_section_forces_of_a_swing_match_the_joint_wrench(tmp_path: Path) -> None:
    """Over time and along the span; the envelope holds every instant, and figures show both."""
    joint = sf.Joint("pin", "revolute", axis=(0, 0, 1))
    swinging = sf.Beam("b", joint, 1.0, 2.0, EI_z=30.0, bend_y=2, family="legendre")
    model = sf.compile(sf.System("s", [swinging], gravity=(0, -9.81, 0)))
    run = sf.simulate(model, t_end=0.05, dt=1e-3)
    forces = run.section_forces("b")
    assert forces.values.shape == (len(run), 9, 6)
    assert forces.present == ("N", "Vy", "Mz")
    np.testing.assert_allclose(forces.x, np.linspace(0.0, 1.0, 9))
    wrenches = model.joint_wrenches(run.q, run.v, run.a, run.u, par=run.par, t=run.t)[:, 0]
    np.testing.assert_allclose(forces.values[:, 0], -wrenches, atol=1e-12 * np.abs(wrenches).max())
    low, high = forces.envelope
    assert np.all(low[:, 1] <= forces.at(0.0123)[:, 1]) and np.all(forces.at(0.0123)[:, 1] <= high[:, 1])
    np.testing.assert_allclose(forces.at(0.01), forces.values[10], atol=1e-9)
    require("matplotlib", "plots")
    forces.plot(0.02).savefig(tmp_path / "forces.png")
    with pytest.raises(sf.UnknownNameError, match="did you mean 'Mz'"):
        forces["mz"]
    with pytest.raises(sf.UnknownNameError, match="no section forces of 'c'"):
        run.section_forces("c")


def test_column_names_are_distinct_and_survive_files(tmp_path: Path) -> None:
    """Commas, quotes, the name of the time, and a name that is the rate of another."""
    names = ("t", 'a,"b', "door", "oor", "left-hip")
    bodies = [
        sf.RigidBody(name, sf.Joint(name, "revolute", axis=(0, 1, 0)), sf.Inertia(1, (0.1, 0, 0), (1, 1, 1)))
        for name in names
    ]
    model = sf.compile(sf.System("named", bodies, inputs=[sf.Input("sin")]))
    start = dict(zip(names, (0.1, 0.2, 0.3, 0.4, 0.5), strict=True))
    run = sf.simulate(model, start, {"d`oor`": 4.0, "door": 3.0, "dleft-hip": 5.0}, 0.02, dt=0.01, u={"`sin`": "`t`"})
    assert list(run.columns()) == [
        *("t", "`t`", 'a,"b', "door", "oor", "left-hip"),
        *("dt", 'da,"b', "ddoor", "d`oor`", "dleft-hip", "sin"),
    ]
    for name, index in (("door", 2), ("`left-hip`", 4), ("`t`", 0)):
        np.testing.assert_array_equal(run[name], run.q[:, index])
    for name, index in (("d`oor`", 3), ("ddoor", 2), ("d`left-hip`", 4), ("dleft-hip", 4)):
        np.testing.assert_array_equal(run[name], run.v[:, index])
    assert run.v[0].tolist() == [0.0, 0.0, 3.0, 4.0, 5.0] and run["sin"][0] == 0.1
    for suffix in (".csv", ".parquet", ".npz"):
        motion = read_motion(run.save(tmp_path / f"run{suffix}"), model)
        np.testing.assert_array_equal(motion.q, run.q)
    with open(run.save(tmp_path / "run.csv"), newline="") as stream:
        assert next(csv.reader(stream)) == list(run.columns())


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
def test_reactions_hold_the_parameters_that_events_have_set(method: str) -> None:
    """Weight and drive of a cart that takes a load on; a rod that holds a second one beside it, by its multiplier."""
    first = sf.RigidBody("first", sf.Joint("x", "prismatic", axis=(1, 0, 0), effort=("3*m",)), sf.Inertia("m"))
    second = sf.RigidBody("second", sf.Joint("y", "prismatic", axis=(1, 0, 0)), sf.Inertia("2*m"))
    rod = sf.Rod("rod", ("first", None), ("second", None), 1.0)
    model = sf.compile(sf.System("carts", (first, second), parameters=(sf.Parameter("m", 1.0),), constraints=(rod,)))
    plan = {"load": sf.Event("t - 0.1", action={"m": "5*m"}, once=True)}
    run = sf.simulate(model, {"x": 0.0, "y": 1.0}, t_end=0.2, dt=0.01, method=method, events=plan)
    m = run.par_over_time[:, model.names.par.index("m")]
    assert set(m) == {1.0, 5.0}
    np.testing.assert_allclose(run.a, 1.0, atol=1e-8)
    rod_force = 2.0 * m * run.a[:, 1]
    np.testing.assert_allclose(run.closure_wrench("rod")[:, 0], rod_force, rtol=1e-9)
    np.testing.assert_allclose(run.closure_wrench("rod", on="first")[:, 0], -rod_force, rtol=1e-9)
    held = run.joint_wrenches()
    np.testing.assert_allclose(held[:, 0, :3], np.outer(m, [3.0, 0.0, 9.81]), atol=1e-8)
    np.testing.assert_allclose(held[:, 1, :3], np.outer(m, [0.0, 0.0, 2.0 * 9.81]), atol=1e-8)


def test_contact_forces_of_a_run_are_by_its_parameters() -> None:
    """A mass that lies on a compliant ground, softer than the description says."""
    mass = sf.RigidBody("z", sf.Joint("z", "prismatic", axis=(0, 0, 1)), sf.Inertia(2.0))
    foot = sf.Contact("foot", ("z", None), ("world", None), sf.formula("k"), exponent=1.0)
    model = sf.compile(sf.System("mass", (mass,), (sf.Parameter("k", 1e6),), connections=(foot,)))
    run = sf.simulate(model, [-2.0 * 9.81 / 500.0], t_end=0.01, dt=1e-3, par=[500.0])
    np.testing.assert_allclose(run.contact_forces().push[:, 0], 2.0 * 9.81, rtol=1e-9)
