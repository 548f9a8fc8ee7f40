"""Mechanisms whose forces have states, in diagrams: as `sf.simulate` has them (docs/theory/states.md)."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros import blocks
from symofros.diagrams.program.compiled import resolve
from symofros.diagrams.run.examination import interpreted as interpreted_runs
from tests.models import bounds

_LUGRE = sf.LuGre(2.0, 3e3, 20.0, static=3.0, stribeck_velocity=0.05, viscous=0.3)
_FLOOR = sf.Contact("floor", ("ball", None), ("world", None), 1e4, exponent=1.0, dissipation=2.0, friction=0.5,
                    bristle_stiffness=1e4, bristle_damping=50.0)  # fmt: skip
_PUSH = "4*sin(3*t)"


def slide(*elements: Any, **fields: Any) -> sf.System:
    """A block on a level slide, with a force as input."""
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=elements, actuated=True)
    return sf.System("slide", (sf.RigidBody("block", joint, sf.Inertia(1.5)),), **fields)


@cache
def system(kind: str) -> sf.System:
    """A mechanism with an actuated joint x and the elements of that kind."""
    if kind == "lugre":
        return slide(_LUGRE)
    if kind == "hysteresis":
        return slide(sf.Hysteresis(300.0, 1.0, 2.0), sf.Hysteresis(100.0, 2.0), sf.Friction(0.1))
    if kind == "formula":
        drag: Any = {"dx": "-0.5*(1 + T)*dx"}
        heat: Any = "dx*dx - 2*T"
        return slide(states=(sf.ForceState("T", heat),), virtual_power=(sf.VirtualPower("drag", drag),))
    along, fall = (
        sf.Joint("x", "prismatic", axis=(1, 0, 0), actuated=True),
        sf.Joint("z", "prismatic", parent="cart", axis=(0, 0, 1)),
    )
    cart, ball = sf.RigidBody("cart", along, sf.Inertia(0.5)), sf.RigidBody("ball", fall, sf.Inertia(1.0))
    return sf.System("bouncing", (cart, ball), connections=(_FLOOR,), gravity=(0.0, 0.0, -9.81))


STARTS: dict[str, dict[str, float]] = {
    "lugre": {"x": 0.1, "x.bristle": 1e-4},
    "hysteresis": {"x": 0.1, "dx": 0.2, "x.slip2": 2e-3},
    "formula": {"dx": 0.3, "T": 0.4},
    "bristles": {"z": 5e-3, "dx": 0.1},
}


def driven(kind: str, **fields: Any) -> sf.Diagram:
    d = sf.Diagram("driven")
    d.add_model("m", system(kind), STARTS[kind])
    d.add(blocks.Formula(name="push", formulas=[_PUSH]))
    d.add(blocks.ForwardDynamics(name="plant", model="m", **fields), u="push.y")
    return d


def simulated(kind: str, **settings: Any) -> sf.Trajectory:
    """The same by `sf.simulate`."""
    model, start = sf.compile(system(kind)), STARTS[kind]
    first: dict[str, Any] = {
        "q0": [start.get(name, 0.0) for name in model.names.q],
        "v0": [start.get(f"d{name}", 0.0) for name in model.names.v],
        "z0": [start.get(name, 0.0) for name in model.names.z],
    }
    return sf.simulate(model, u={"x": _PUSH}, **first, **settings)


def same(found: np.ndarray, expected: np.ndarray) -> None:
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
@pytest.mark.parametrize("kind", STARTS)
def test_a_diagram_moves_as_simulate_does(kind: str, method: str) -> None:
    settings: dict[str, Any] = {"dt": 5e-4, "method": method, "t_end": 0.25, "record": 0.25}
    settings |= bounds(method, 1e-9, 1e-11)
    run, plain = sf.Simulation(driven(kind)).run(realtime=False, **settings), simulated(kind, **settings)
    assert run.outcome.kind == "finished"
    for port, expected in (("q", plain.q), ("v", plain.v), ("z", plain.z)):
        assert run[f"plant.{port}"].shape == expected.shape
        same(run[f"plant.{port}"][-1], expected[-1])
    q, v = run.motion("plant")
    assert np.array_equal(q, run["plant.q"]) and np.array_equal(v, run["plant.v"])


def test_a_file_states_where_they_begin(tmp_path: Path) -> None:
    first = driven("lugre")
    sf.save_diagram(first, tmp_path / "d.yaml")
    assert "x.bristle" in (tmp_path / "d.yaml").read_text()
    again = sf.load_diagram(tmp_path / "d.yaml")
    runs = [sf.Simulation(of).run(0.05, dt=1e-3, realtime=False) for of in (first, again)]
    assert runs[0]["plant.z"][0] == [1e-4] and np.array_equal(runs[0]["plant.z"], runs[1]["plant.z"])


@pytest.mark.parametrize("kind", STARTS)
def test_functions_of_the_block_know_them(kind: str) -> None:
    """Told by the plant, and by ModelFunction given z, they are those of the model at q, v and z."""
    diagram = driven(kind, functions=("potential_energy", "generalized_force"))
    diagram.add(blocks.ModelFunction(name="load", model="m", function="generalized_force"),
                q="plant.q", v="plant.v", u="push.y", z="plant.z")  # fmt: skip
    run, model = sf.Simulation(diagram).run(0.02, dt=5e-4, realtime=False), sf.compile(system(kind))
    given = run["plant.q"], run["plant.v"]
    z, u = run["plant.z"], run["push.y"]
    same(run["plant.potential_energy"], model.potential_energy(given[0], z=z))
    force = model.generalized_force(*given, u, z=z)
    same(run["plant.generalized_force"], force)
    same(run["load.Q"], force)
    same(run["plant.a"], model.forward_dynamics(*given, u, z=z))
    friction = -0.1 * np.tanh(given[1] / 1e-3) if kind == "hysteresis" else np.zeros_like(given[1])
    assert run["plant.friction"] == pytest.approx(friction, abs=0.02)


@pytest.mark.parametrize(
    ("block", "words"),
    [
        (
            blocks.InverseDynamics(name="b", model="m"),
            r"inverse_dynamics of model 'm'.*found:  x\.bristle.*connect its input z.*without these",
        ),
        (blocks.LQR(name="b", model="m", state_weights=1.0, input_weights=1.0), r"has states of forces.*linear"),
    ],
)
def test_blocks_that_have_no_states_refuse_them(block: Any, words: str) -> None:
    diagram = driven("lugre")
    wires = ("q", "v") if isinstance(block, blocks.LQR) else ("q", "v", "a")
    diagram.add(block, **{name: f"plant.{name}" for name in wires})
    with pytest.raises(sf.SymofrosError, match=f"(?s){words}"):
        sf.Simulation(diagram)


@pytest.mark.parametrize("kind", STARTS)
def test_inverse_dynamics_takes_them(kind: str) -> None:
    """Efforts of the plant's own motion are what drives it; without friction that has no states, more by that."""
    diagram = driven(kind)
    wires = {name: f"plant.{name}" for name in "qvaz"}
    for name, friction in (("efforts", True), ("rest", False)):
        diagram.add(blocks.InverseDynamics(name=name, model="m", with_friction=friction), **wires)
    run = sf.Simulation(diagram).run(0.02, dt=5e-4, realtime=False)
    given = zip(*(run[f"plant.{name}"] for name in "qvaz"), strict=True)
    model = sf.compile(system(kind))
    wanted = [model.inverse_dynamics(q, v, a, z=z) for q, v, a, z in given]
    same(run["efforts.tau"], np.array(wanted))
    assert run["efforts.tau"][1:, 0] == pytest.approx(run["push.y"][1:, 0], abs=1e-9)
    assert run["rest.tau"] == pytest.approx(run["efforts.tau"] + run["plant.friction"], abs=1e-12)


def test_inverse_dynamics_that_no_state_changes_needs_none() -> None:
    """A counter of the way, which no force reads."""
    diagram = sf.Diagram("d")
    diagram.add_model("m", slide(states=(sf.ForceState("way", "abs(dx)"),)), {"dx": 0.3})
    diagram.add(blocks.Formula(name="push", formulas=[_PUSH]))
    diagram.add(blocks.ForwardDynamics(name="plant", model="m"), u="push.y")
    diagram.add(blocks.InverseDynamics(name="b", model="m"), **{name: f"plant.{name}" for name in "qva"})
    run = sf.Simulation(diagram).run(0.02, dt=1e-3, realtime=False)
    assert run["b.tau"] == pytest.approx(1.5 * run["plant.a"], rel=1e-12)


def test_idle_coordinates_are_not_stated() -> None:
    diagram = driven("lugre")
    diagram.models["m"] = replace(diagram.models["m"], start={"x.bristle.integral": 1.0})
    with pytest.raises(sf.DescriptionError, match="no coordinate or speed 'x.bristle.integral'"):
        sf.Simulation(diagram)


def test_a_loop_has_them_beside_its_constraints() -> None:
    """Closed from a start that states a bend: q and v are moved onto the constraints, z is not."""
    four_bar = MODELS["four_bar"]
    first, *others = four_bar.bodies
    assert isinstance(first, sf.RigidBody) and first.joint is not None
    rubbing = replace(first, joint=replace(first.joint, elements=(_LUGRE,)))
    system_ = replace(four_bar, bodies=(rubbing, *others))
    model = sf.compile(system_)
    state = f"{model.names.v[0]}.bristle"
    begin = sf.assemble(model, [0.7, 0.1, -0.9], np.full(model.nv, 0.5))
    stated = dict(zip(model.names.q, map(float, begin.q), strict=True))
    stated |= {f"d{name}": float(x) for name, x in zip(model.names.v, begin.v, strict=True)}
    diagram = sf.Diagram("loop")
    diagram.add_model("m", system_, {**stated, state: 2e-4})
    diagram.add(blocks.ForwardDynamics(name="plant", model="m"))
    settings: dict[str, Any] = {"dt": 1e-3, "record": 0.02}
    run = sf.Simulation(diagram).run(0.2, realtime=False, **settings)
    plain = sf.simulate(model, begin.q, begin.v, 0.2, z0=[2e-4], **settings)
    for port, expected in (("q", plain.q), ("v", plain.v), ("z", plain.z)):
        same(run[f"plant.{port}"][-1], expected[-1])
    interpreted = sf.Simulation(diagram).interpret(0.02, **settings)
    same(interpreted["plant.z"][-1], run["plant.z"][1])


def test_events_know_them() -> None:
    """A formula names a state, an action sets one; friction by a factor of a state, an output, too."""
    fades: Any = "exp(-T)"
    warm = sf.Friction(1.0, viscous=0.1, factor=fades)
    rate: Any = "dx*dx - 0.2*T"
    mechanism = slide(_LUGRE, warm, states=(sf.ForceState("T", rate),))
    events = {"hot": sf.Event("T - 0.02", "rising", action={"T": -0.01})}
    diagram = sf.Diagram("warm")
    diagram.add_model("m", mechanism, {"dx": 1.0, "T": 0.005})
    diagram.add(blocks.ForwardDynamics(name="plant", model="m", events=events))
    settings: dict[str, Any] = {"dt": 1e-3, "record": 0.1}
    run, model = sf.Simulation(diagram).run(0.1, realtime=False, **settings), sf.compile(mechanism)
    plain = sf.simulate(model, [0.0], [1.0], 0.1, z0={"T": 0.005}, events=events, **settings)
    assert len(plain.events) == len(run.events["plant"]) > 1
    for port, expected in (("q", plain.q), ("v", plain.v), ("z", plain.z)):
        same(run[f"plant.{port}"][-1], expected[-1])
    v, z = plain.v[-1], plain.z[-1]
    alone = sf.compile(slide(_LUGRE, states=(sf.ForceState("T", rate),)))
    drag = model.generalized_force([0.0], v, [0.0], z=z) - alone.generalized_force([0.0], v, [0.0], z=z)
    assert run["plant.friction"][-1] == pytest.approx(drag, rel=1e-9)


def test_speeds_of_mechanisms_are_motion_and_states_of_forces_and_blocks_are_none() -> None:
    """Whatever stands before them, as a free body, which has more coordinates than speeds."""
    body = sf.RigidBody("body", sf.Joint("free", "free"), sf.Inertia(1.0, moments=(1.0, 1.0, 1.0)))
    of = sf.Diagram("several")
    of.add_model("b", sf.System("body", (body,)))
    of.add(blocks.ForwardDynamics(name="flies", model="b"))
    of.add(blocks.Constant(name="one", value=1.0))
    of.add(blocks.Integrator(name="sum"), u="one")
    of.add_model("m", system("formula"))
    of.add(blocks.ForwardDynamics(name="plant", model="m"), u="one")
    layout = resolve(of).layout
    moving = {block: layout.moving[place.slice].tolist() for block, place in layout.v.items()}
    assert moving == {"flies": [True] * 6, "plant": [True, False]}
    assert len(layout.moving) == 9 and layout.moving.sum() == 7


def test_the_linearised_step_of_an_interpreted_run_is_of_displacements_speeds_and_states(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """h times the rates of (x, h v), and of a state by itself: m x'' + c x' + k x = 0, T' = -3 T."""
    h, m, k, c, decay = 1e-3, 1.5, 50.0, 2.0, 3.0
    found, resolution = list[Any](), interpreted_runs.resolution

    def heard(*given: Any, **named: Any) -> Any:
        found.append(given[4](0))
        return resolution(*given, **named)

    monkeypatch.setattr(interpreted_runs, "resolution", heard)
    rate: Any = f"-{decay}*T"
    of = sf.Diagram("oscillator")
    of.add_model(
        "m", slide(sf.Spring(k), sf.Damper(c), states=(sf.ForceState("T", rate),)), {"x": 0.2, "dx": 0.3, "T": 0.01}
    )
    of.add(blocks.ForwardDynamics(name="plant", model="m"))
    sf.Simulation(of).interpret(0.1, dt=h)
    ((_, matrix, motion),) = found
    wanted = np.zeros((4, 4))
    wanted[0, 2], wanted[2, 0], wanted[2, 2], wanted[3, 3] = 1.0, -h * h * k / m, -h * c / m, -h * decay
    np.testing.assert_allclose(matrix, wanted, atol=1e-9)
    np.testing.assert_allclose(motion[[0, 2]], [0.3 * h, -h * h * (c * 0.3 + k * 0.2) / m], rtol=1e-9)
