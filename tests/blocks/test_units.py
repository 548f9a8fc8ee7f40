"""Units of ports: each that has a meaning has a unit or says why not, and a wire between two that differ is refused."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros import blocks as lib
from symofros.base.units import agree
from symofros.diagrams.block import Block, Port
from symofros.diagrams.wiring import draft

# Joints that turn and that slide, so that no two quantities of it have one unit.
MECHANISM = replace(MODELS["slider_crank"], constraints=())
MAKE: dict[str, dict[str, Any]] = {
    "CartesianFeedback": {"model": "m", "frame": "rod", "rows": ("x", "y"), "kp": 1.0, "kd": 1.0},
    "CartesianLinear": {"model": "m", "frame": "rod", "rows": ("x", "y"), "stiffness": 1.0, "damping": 1.0},
    "CartesianTrajectory": {"times": [0, 1], "points": np.zeros((2, 3)), "quaternions": [[0, 0, 0, 1]] * 2},
    "ComputedTorque": {"model": "m", "kp": 1.0, "kd": 1.0},
    "FrictionCompensation": {"model": "m"},
    "GravityCompensation": {"model": "m"},
    "InverseDynamics": {"model": "m"},
    "MomentumObserver": {"model": "m"},
    "ForwardDynamics": {"model": "m"},
    "ForwardKinematics": {"model": "m", "frame": "rod"},
    "Extremities": {"model": "m"},
    "StatePlot": {"model": "m"},
    "ExtremityPlot": {"model": "m", "frames": ["rod"]},
    "OrientationError": {"kind": "rotation_vector"},
    "Orientation": {"source": "rotation_vector", "target": "axis_angle"},
}
# Blocks that have vectors (linear; angular) where the user asks for them.
CHOSEN: dict[str, Block] = {
    "perturbed": lib.ForwardDynamics(name="b", model="m", perturbed=("rod",)),
    "extremities": lib.Extremities(name="b", model="m", frames=["rod", "crank"]),
    **{f"transform of a {each}": lib.Transform(name="b", quantity=each) for each in ("velocity", "wrench")},
    **{
        f"frame transform of a {each}": lib.FrameTransform(name="b", model="m", source="rod", quantity=each)
        for each in ("velocity", "wrench")
    },
}
# Ports of these blocks are of what is connected or of what the user says; no other port may be without a unit.
OF_THE_USER = {
    "Chirp", "Constant", "DeadZone", "Derivative", "Formula", "Gain", "Hold", "Integrator", "Join", "LookupTable",
    "Noise", "Pick", "Product", "Pulse", "PythonBlock", "Quantizer", "Ramp", "RateLimit", "Relay", "Reshape",
    "Saturation", "Sequence", "Sine", "StateSpace", "Step", "Store", "Sum", "Switch", "TransferFunction", "Transform",
    "FrameTransform", "UdpReceiver", "UdpTransmitter", "UnitDelay", "ZenohPublisher", "ZenohSubscriber", "Scope",
    "LivePlot", "JointTrajectory", "FMU", "KalmanFilter", "LookupTable2D", "Notch", "TransportDelay",
    "StateMachine", "BusCreator", "BusSelector", "Comment",
}  # fmt: skip
# Measured by what is connected: tests below.
BY_WIRE = {"JointPD", "JointPID"}
# Needs more than one port can say, or a model of another kind: J has a unit for each row and column.
ELSEWHERE = {"Jacobian", "ModelFunction", "LQR", "InverseKinematics", "Square", "View3D"}


def library() -> set[str]:
    members = inspect.getmembers(lib, inspect.isclass)
    return {name for name, member in members if issubclass(member, Block) and member is not Block}


def ports_of(block: Block) -> tuple[Port, ...]:
    diagram = sf.Diagram("units")
    diagram.add_model("m", MECHANISM)
    diagram.add(block)
    found = draft(diagram).ports[block.name]
    return (*found.inputs, *found.outputs)


def test_every_library_block_has_a_case_of_its_port_units() -> None:
    assert library() == set(MAKE) | OF_THE_USER | BY_WIRE | ELSEWHERE


@pytest.mark.parametrize("name", MAKE)
def test_every_physical_port_has_a_unit(name: str) -> None:
    for port in ports_of(getattr(lib, name)(name="b", **MAKE[name])):
        assert all(port.entry_units), f"{name}.{port.name}"
        assert len(port.units) in (0, (port.shape or (0,))[-1])


@pytest.mark.parametrize("how", CHOSEN)
def test_vectors_of_two_units_have_one_for_each_entry(how: str) -> None:
    """All that are linear, then all that are angular."""
    mixed = [port for port in ports_of(CHOSEN[how]) if port.shape and port.shape[-1] == 6]
    assert mixed
    for port in mixed:
        linear, angular = port.units[:3], port.units[3:]
        assert len(linear) == len(angular) == 3 and len(set(linear)) == len(set(angular)) == 1, f"{how}: {port.name}"
        assert linear[0] != angular[0]


@pytest.mark.parametrize(("kind", "lengths", "rotations"), [("free", 3, 4), ("ball", 0, 4), ("planar", 2, 0)])
def test_coordinates_of_a_rotation_have_no_unit(kind: Any, lengths: int, rotations: int) -> None:
    """Nor do entries of a quaternion; a coordinate after them has its own."""
    first = sf.RigidBody("first", sf.Joint("root", kind), sf.Inertia(1.0))
    second = sf.RigidBody("second", sf.Joint("slide", "prismatic", "first", axis=(1, 0, 0)), sf.Inertia(1.0))
    diagram = sf.Diagram("units")
    diagram.add_model("m", sf.System("s", (first, second)))
    diagram.add(lib.ForwardDynamics(name="b", model="m"))
    (port,) = (port for port in draft(diagram).ports["b"].outputs if port.name == "q")
    turns = ("1",) * rotations if rotations else ("rad",)
    assert port.units == ("m",) * lengths + turns + ("m",)


def wired(controller: Block, units: dict[str, str], model: str = "") -> list[str]:
    """What is wrong with a controller whose inputs have these units."""
    diagram = sf.Diagram("loop")
    for port, unit in units.items():
        diagram.add(lib.Constant(name=port, value=[0.0], unit=unit))
    diagram.add(controller, **{port: f"{port}.y" for port in units})
    return [f"{problem.what}; {problem.found}; {problem.rule}" for problem in draft(diagram).problems]


CONTROLLERS: list[Callable[[], Block]] = [
    lambda: lib.JointPD(name="c", kp=1.0, kd=1.0),
    lambda: lib.JointPID(name="c", kp=1.0, ki=1.0, kd=1.0),
]
RIGHT = {
    "rad": {"q_desired": "rad", "v_desired": "rad/s", "q": "rad", "v": "rad/s"},
    "deg": {"q_desired": "deg", "v_desired": "deg/s", "q": "deg", "v": "deg/s"},
    "m": {"q_desired": "m", "v_desired": "m/s", "q": "m", "v": "m/s"},
    "none": {"q_desired": "", "v_desired": "", "q": "", "v": ""},
    "some": {"q_desired": "", "q": "", "v": "rad/s"},
}
UNITS = ("rad", "deg", "m", "rad/s", "m/s", "N m", "N", "s", "rad/s^2")


@pytest.mark.parametrize("make", CONTROLLERS)
@pytest.mark.parametrize("right", RIGHT)
def test_controllers_accept_ports_of_matching_units(make: Callable[[], Block], right: str) -> None:
    assert not wired(make(), RIGHT[right])


@pytest.mark.parametrize("make", CONTROLLERS)
@pytest.mark.parametrize(("right", "unit"), [("rad", "N m"), ("deg", "N m"), ("m", "N"), ("none", "")])
def test_efforts_of_controllers_are_those_of_what_is_connected(
    make: Callable[[], Block], right: str, unit: str
) -> None:
    diagram = sf.Diagram("loop")
    for port, of in RIGHT[right].items():
        diagram.add(lib.Constant(name=port, value=[0.0], unit=of))
    diagram.add(make(), **{port: f"{port}.y" for port in RIGHT[right]})
    (effort,) = (port for port in draft(diagram).ports["c"].outputs if port.name == "effort")
    assert set(effort.entry_units) == {unit}


def test_joined_signals_keep_their_units() -> None:
    """Those of each input for as many entries as it has; where the block states one, all have that."""
    diagram = sf.Diagram("joined")
    diagram.add(lib.Constant(name="angles", value=[0.1, 0.2], unit="rad"))
    diagram.add(lib.Constant(name="length", value=0.3, unit="m"))
    diagram.add(lib.Join(name="mixed"), u1="angles.y", u2="length.y")
    diagram.add(lib.Join(name="same", unit="rad"), u1="angles.y", u2="angles.y")
    ports = draft(diagram).ports
    units = {name: [port.entry_units for port in ports[name].outputs] for name in ("mixed", "same")}
    assert units == {"mixed": [("rad", "rad", "m")], "same": [("rad",)]}


@pytest.mark.parametrize("make", CONTROLLERS)
@pytest.mark.parametrize("right", ["rad", "deg", "m"])
@pytest.mark.parametrize("port", ["q_desired", "v_desired", "q", "v"])
def test_one_wrong_wire_of_a_controller_is_refused(make: Callable[[], Block], right: str, port: str) -> None:
    """Of all units that are not those of the port."""
    for unit in UNITS:
        if not agree(unit, RIGHT[right][port]):
            problems = wired(make(), RIGHT[right] | {port: unit})
            assert any("units differ" in problem for problem in problems), unit
            assert any(unit in problem for problem in problems)


def arm() -> sf.Diagram:
    diagram = sf.Diagram("arm")
    diagram.add_model("m", MODELS["planar_robot"])
    diagram.add(lib.ForwardDynamics(name="plant", model="m"))
    return diagram


@pytest.mark.parametrize(("of", "port", "unit"), [("q", "q", "rad"), ("v", "v", "rad/s"), ("v", "a", "rad/s^2")])
def test_pick_keeps_the_unit_of_its_entries(of: str, port: str, unit: str) -> None:
    """Of a vector that also holds elastic coordinates, whose units are others."""
    diagram = arm()
    diagram.add(lib.Pick(name="p", model="m", of=of, entries=["q1", "q2"]), u=f"plant.{port}")
    diagram.add(lib.Hold(name="h", period=0.01), u="p.y")
    drafted = draft(diagram)
    assert not drafted.problems
    assert drafted.ports["p"].outputs[0].unit == drafted.ports["h"].outputs[0].unit == unit
    diagram.add(lib.Pick(name="force", model="m", of="u", entries="actuated"), u="p.y")
    assert draft(diagram).problems


def test_entries_of_mixed_vectors_are_compared_individually() -> None:
    diagram = sf.Diagram("mixed")
    diagram.add_model("m", MECHANISM)
    diagram.add(lib.ForwardDynamics(name="plant", model="m"))
    diagram.add(lib.InverseDynamics(name="id", model="m"), q="plant.v", v="plant.v", a="plant.a")
    (problem,) = draft(diagram).problems
    assert "plant.v -> id.q: units differ at entry 0" in problem.what
    assert (problem.found, problem.rule) == ("rad/s", "the input takes rad")


@pytest.mark.parametrize(("given", "taken"), [(1.5, [2.0]), ([1.5], 2.0)])
def test_a_scalar_and_a_vector_of_one_entry_are_interchangeable(given: object, taken: object) -> None:
    diagram = sf.Diagram("one")
    diagram.add(lib.Constant(name="a", value=taken))
    diagram.add(lib.Constant(name="b", value=given))
    diagram.add(lib.Sum(name="s"), u1="a", u2="b")
    diagram.add(lib.Pick(name="p", entries=[0]), u="b")
    diagram.add(lib.JointPD(name="pd", kp=[4.0], kd=0.0), q_desired="b", q="a", v="a")
    simulation = sf.Simulation(diagram)
    for run in (simulation.run(0.01, dt=0.01), simulation.interpret(0.01, dt=0.01)):
        last = {name: float(np.ravel(run[name][-1])[0]) for name in ("s", "p", "pd.effort")}
        assert last == {"s": 3.5, "p": 1.5, "pd.effort": -2.0}


@pytest.mark.parametrize("make", CONTROLLERS)
def test_a_controller_of_no_motion_at_all_is_refused(make: Callable[[], Block]) -> None:
    """Each of its wires, where all have a unit and none that of joints that turn or slide."""
    for unit in ("N m", "s"):
        problems = wired(make(), dict.fromkeys(RIGHT["rad"], unit))
        assert len(problems) == 4 and all("units differ" in problem and unit in problem for problem in problems)
