"""A diagram's mechanism obeys its own events, actions and friction that sticks, as `sf.simulate` does."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import Constant, ForwardDynamics, Hold, Sequence
from symofros.description.events import as_events
from symofros.diagrams.block import Crossing
from tests.simulation.mechanisms import loop, slide
from tests.simulation.rigid_scenes import ball_system, box_system, in_shell


@dataclass(frozen=True)
class Case:
    """A mechanism that events act on.

    Attributes:
        system: Its description.
        events: What acts.
        t_end: End of the run [s].
        start: Coordinates and speeds by name.
        parameters: Run-time parameters by name.
    """

    system: sf.System
    events: Mapping[str, Any]
    t_end: float
    start: Mapping[str, float] = field(default_factory=dict)
    parameters: Mapping[str, float] = field(default_factory=dict)


def _grasp() -> Case:
    """An arm takes a load in flight at the pose of the moment, locks, becomes lighter, and lets go."""
    inertia = sf.Inertia(1.0, (0.5, 0, 0), (0.01, 0.1, 0.1))
    upper = sf.RigidBody("upper", sf.Joint("q1", "revolute", axis=(0, 0, 1)), inertia, (sf.Frame("end", (1, 0, 0)),))
    elbow = sf.Joint("q2", "revolute", "upper", axis=(0, 0.1, 1), frame="end")
    lower = sf.RigidBody("lower", elbow, inertia, (sf.Frame("hand", (1, 0, 0)),))
    load = sf.RigidBody("load", sf.Joint("free", "free"), sf.Inertia("m", moments=(0.2, 0.2, 0.3)))
    system = sf.System(
        "grasping",
        (upper, lower, load),
        (sf.Parameter("grip", 0), sf.Parameter("brake", 0), sf.Parameter("m", 2.0)),
        gravity=(0, 0, 0),
        constraints=(
            sf.Closure("grasp", ("lower", "hand"), ("load", None), rotations=("x", "y", "z")),
            sf.Coupling("lock", "q2"),
        ),
        switches=(sf.Switch("grasp", "grip", "moment"), sf.Switch("lock", "brake", "moment")),
    )
    events = {
        "grasp": sf.Event("2*free.px - 1.8", "falling", once=True, action={"grip": 1}),
        "lock": sf.Event("t - 0.4003", action={"brake": 1}),
        "passes": sf.Event("free.px - 0.85"),
        "lighter": sf.Event("t - 0.5", action={"m": "m/2", "dq1": "dq1 + 0.1"}),
        "release": sf.Event("t - 0.8", action={"grip": 0, "brake": 0}),
    }
    start = {"q1": 0.3, "q2": -0.3, "free.px": 1.0003, "free.py": 0.2, "free.vx": -0.5, "free.wz": 1.0}
    return Case(system, events, 1.0, start)


def _latch() -> Case:
    """A latch that breaks at a force."""
    weight = sf.RigidBody("weight", sf.Joint("z", "prismatic", axis=(0, 0, 1)), sf.Inertia(2.0))
    system = sf.System(
        "latched",
        (weight,),
        (sf.Parameter("shut", 0),),
        constraints=(sf.Closure("latch", ("world", None), ("weight", None), ("z",)),),
        switches=(sf.Switch("latch", "shut"),),
        virtual_power=(sf.VirtualPower("pull", {"dz": "-100*t"}),),
    )
    breaks = sf.Event("wrench.latch.fz - 40", "rising", action={"shut": 0})
    return Case(system, {"breaks": breaks}, 0.5, parameters={"shut": 1})


def _bounce() -> Case:
    """A ball that bounces."""
    ball = sf.RigidBody("ball", sf.Joint("z", "prismatic", axis=(0, 0, 1)), sf.Inertia(1.0))
    floor = sf.Closure("floor", ("world", None), ("ball", None), ("z",))
    contact = (sf.Parameter("contact", 0),)
    system = sf.System("bouncing", (ball,), contact, constraints=(floor,), switches=(sf.Switch("floor", "contact"),))
    strike = sf.Event("z", "falling", action={"contact": 1}, restitution=0.7)
    return Case(system, {"strike": strike}, 1.0, {"z": 0.5})


def _rest() -> Case:
    """A ball that bounces until it rests, and is lifted by a pull that grows."""
    ball = sf.RigidBody("ball", sf.Joint("z", "prismatic", axis=(0, 0, 1)), sf.Inertia(1.0))
    system = sf.System(
        "resting",
        (ball,),
        (sf.Parameter("contact", 0),),
        constraints=(sf.Coupling("floor", "z"),),
        switches=(sf.Switch("floor", "contact"),),
        virtual_power=(sf.VirtualPower("pull", {"dz": "30*(t - 0.5)"}),),
    )
    strike = sf.Event("z", "falling", action={"contact": 1}, restitution=0.5, rests="lam.floor")
    return Case(system, {"strike": strike}, 1.0, {"z": 0.05})


def _locked_loop() -> Case:
    """A four-bar whose crank is locked in motion and let go again."""
    bars = loop([0.3, 1.0, 0.9], 1.1)
    system = sf.System(
        "bars",
        bars.bodies,
        (sf.Parameter("shut", 0.0),),
        constraints=(*bars.constraints, sf.Coupling("lock", "q1")),
        switches=(sf.Switch("lock", "shut", "moment"),),
    )
    events = {"shut": sf.Event("t - 0.1", action={"shut": 1}), "open": sf.Event("t - 0.2", action={"shut": 0})}
    model = sf.compile(system)
    q = sf.assemble(model, [0.7, 0.1, -0.9]).q
    return Case(system, events, 0.4, dict(zip(model.names.q, map(float, q), strict=True)))


def _stick() -> Case:
    """A body on a spring and dry friction that comes to rest."""
    drag = sf.Friction(0.8, static=1.0, stribeck_velocity=0.05, sticks=True)
    return Case(slide(drag, sf.Spring(40.0), mass=1.0), {}, 2.0, {"x": 0.2})


def _brake() -> Case:
    """A brake that holds an arm, is opened and stops it again."""
    parameters = (sf.Parameter("torque", 12.0), sf.Parameter("shut", 1.0))
    braked = sf.Joint("q", "revolute", axis=(0, -1, 0), elements=(sf.Brake("torque", "shut"),))
    arm = sf.RigidBody("arm", braked, sf.Inertia(2.0, (0.4, 0, 0), (0.02, 0.02, 0.02)))
    events = {"open": sf.Event("t - 0.1", action={"shut": 0}), "shut": sf.Event("t - 0.3", action={"shut": 1})}
    return Case(sf.System("brake", (arm,), parameters), events, 1.0)


def _backspin() -> Case:
    """A ball that is thrown with backspin bounces until it stays on the ground, slides, and rolls."""
    return Case(ball_system(), {}, 2.0, {"free.pz": 0.5, "free.vx": 1.0, "free.wy": -20.0})


def _slab() -> Case:
    """A slab on four feet slides to rest, and falls over an event that takes its friction away."""
    tilted = box_system(0.3, gravity=(1.0, 0, -9.8))
    parameters = (sf.Parameter("mu", 0.3),)
    (sole,) = tilted.connections
    system = replace(tilted, parameters=parameters, connections=(replace(sole, friction=sf.formula("mu")),))
    events = {"wet": sf.Event("t - 0.8", action={"mu": 0.05}), "dry": sf.Event("t - 1", action={"mu": 0.4})}
    return Case(system, events, 1.3, {"free.pz": 0.1, "free.vx": 1.0})


def _bowl() -> Case:
    """A ball in a spherical shell strikes it, slides and rolls around, past the pole of its axes."""
    return Case(in_shell(0.4), {}, 1.0, {"ball.px": 0.3, "ball.vy": 2.0, "ball.vz": 3.0})


def _moved_push() -> Case:
    """An event moves a push, and what another event looks for, to an instant that is known from then on alone."""
    push = sf.Load((sf.formula("100*max(0, 1 - abs(t - at)/0.01)"), 0, 0))
    events = {"move": sf.Event("t - 1", action={"at": 5.3}), "narrow": "exp(-((t - at)/1e-3)^2) - 0.5"}
    return Case(replace(slide(loads=(push,)), parameters=(sf.Parameter("at", 20.0),)), events, 10.0)


CASES = {
    "bowl": _bowl(),
    "backspin": _backspin(),
    "slab": _slab(),
    "grasp": _grasp(),
    "latch": _latch(),
    "bounce": _bounce(),
    "rest": _rest(),
    "locked loop": _locked_loop(),
    "stick": _stick(),
    "brake": _brake(),
}


def diagram(case: Case, **fields: Any) -> sf.Diagram:
    """A diagram of the mechanism alone."""
    of = sf.Diagram("alone")
    of.add_model("m", case.system, case.start, case.parameters)
    of.add(ForwardDynamics(name="plant", model="m", **({"events": case.events} | fields)))
    return of


def simulated(case: Case, **options: Any) -> sf.Trajectory:
    """The same mechanism by itself."""
    model = sf.compile(case.system)
    q = {name: value for name, value in case.start.items() if name in model.names.q}
    v = {name: value for name, value in case.start.items() if name not in model.names.q}
    return sf.simulate(model, q, v, case.t_end, events=case.events, par=case.parameters, **options)


@pytest.mark.parametrize("options", [{"method": "rk4", "dt": 1e-2}, {"method": "dopri5", "rtol": 1e-8, "atol": 1e-10}])
@pytest.mark.parametrize("name", CASES)
def test_a_mechanism_alone_moves_as_it_is_simulated(name: str, options: dict[str, Any]) -> None:
    """To rounding: states, instants, impulses, energies, multipliers; events have the same names."""
    case = CASES[name]
    alone, run = simulated(case, **options), sf.Simulation(diagram(case)).run(case.t_end, record=case.t_end, **options)
    assert alone.outcome.ok and run.outcome.ok, (alone.outcome, run.outcome)
    ours, theirs = run.events["plant"], alone.events
    assert ours and [one.name for one in ours] == [one.name for one in theirs]
    near = {"rtol": 1e-9, "atol": 1e-11}
    for one, other in zip(ours, theirs, strict=True):
        np.testing.assert_allclose(one.t, other.t, **near)
        for key in ("q", "v", "v_after", "impulse", "energy_lost", "energy_added"):
            a, b = getattr(one, key), getattr(other, key)
            assert (a is None) == (b is None), key
            if a is not None:
                np.testing.assert_allclose(a, b, **near, err_msg=key)
    np.testing.assert_allclose(run["plant.q"][-1], alone.q[-1], **near)
    np.testing.assert_allclose(run["plant.v"][-1], alone.v[-1], **near)
    np.testing.assert_allclose(run["plant.lam"][-1], alone.lam[-1], rtol=1e-7, atol=1e-7)
    assert list(run.outcome.notes) == [one.replace("event '", "event 'plant.") for one in alone.outcome.notes]
    assert all("persists" in one for one in alone.outcome.notes), (
        "constraints that hold bodies at rest pass over nothing"
    )


@pytest.mark.parametrize("method", ["rk4", "dopri5", "dop853"])
def test_instants_of_formulas_of_time_are_those_after_an_action(method: str) -> None:
    """Of a push of 1 N s, and of a narrow event: the search behind the action is by its parameters."""
    case = _moved_push()
    run = sf.Simulation(diagram(case)).run(case.t_end, record=case.t_end, method=method)
    assert run["plant.v"][-1] == pytest.approx(1.0, abs=1e-6) and not run.outcome.notes, run.outcome
    assert [one.name for one in run.events["plant"]] == ["move", "narrow", "narrow"]


def _handed(events: Mapping[str, Any], **model: Any) -> sf.Diagram:
    """Two slides of one model, each with a lock of its own, the second at rest."""
    body = sf.RigidBody("body", sf.Joint("x", "prismatic", axis=(1, 0, 0)), sf.Inertia("m"))
    shut, mass = sf.Parameter("shut", 0), sf.Parameter("m", 1.0)
    lock, switch = sf.Coupling("lock", "x"), sf.Switch("lock", "shut", "moment")
    pushed = sf.VirtualPower("push", {"dx": "force"})
    system = sf.System(
        "slide",
        (body,),
        (shut, mass),
        (sf.Input("force"), sf.Input("command")),
        gravity=(0, 0, 0),
        constraints=(lock,),
        switches=(switch,),
        virtual_power=(pushed,),
    )
    of = sf.Diagram("handed")
    of.add_model("slide", system, **model)
    of.add(ForwardDynamics(name="first", model="slide", events=events))
    of.add(ForwardDynamics(name="second", model="slide", events={"shut": sf.Event("x - 0.5", action={"shut": 1})}))
    return of


def test_mechanisms_of_one_model_have_modes_of_their_own() -> None:
    """What the events of one set is the other's no more than a state is."""
    of = _handed({"light": sf.Event("t - 0.3", action={"m": 0.5})}, start={"dx": 1.0})
    of.add(Constant(name="push", value=[2.0, 0.0]))
    of.connect("push.y", "first.u")
    of.connect("push.y", "second.u")
    run = sf.Simulation(of).run(1.0, dt=1e-2)
    assert [one.name for one in run.events["first"]] == ["light"] and [one.name for one in run.events["second"]] == [
        "shut"
    ]
    t = (np.sqrt(3.0) - 1.0) / 2.0
    assert run.events["second"][0].t == pytest.approx(t, abs=1e-9)
    v = 1.0 + 2.0 * 0.3 + 4.0 * 0.7
    assert run["first.v"][-1, 0] == pytest.approx(v, abs=1e-12)
    assert run["second.q"][-1, 0] == pytest.approx(0.5, abs=1e-9) and run["second.v"][-1, 0] == 0.0
    assert np.abs(run["second.lam"][run.t > t + 1e-9]).max() == pytest.approx(2.0)
    again = sf.Simulation(of).run(1.0, dt=1e-2, parameters={"slide.m": 2.0})
    assert again["first.v"][-1, 0] == pytest.approx(1.0 + 1.0 * 0.3 + 4.0 * 0.7, abs=1e-12)


def test_a_sampled_signal_commands_a_lock() -> None:
    """By an input of the mechanism that a condition asks for: the lock acts at the sample, not before."""
    events = {
        "shut": sf.Event("command - 0.5", "rising", action={"shut": 1}),
        "open": sf.Event("command - 0.5", "falling", action={"shut": 0}),
    }
    of = _handed(events, start={"dx": 1.0})
    of.add(Sequence(name="orders", t=[0.0, 0.2, 0.6], values=[[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]], kind="hold"))
    of.add(Hold(name="sampled", period=0.1), u="orders")
    of.connect("sampled.y", "first.u")
    run = sf.Simulation(of).run(1.0, dt=1e-2)
    assert [(one.name, round(one.t, 12)) for one in run.events["first"]] == [("shut", 0.2), ("open", 0.6)]
    assert run.events["first"][0].energy_lost == pytest.approx(0.5)
    assert run["first.q"][-1, 0] == pytest.approx(0.2 + 0.5 * 0.4**2, abs=1e-12)


def test_a_crossing_throws_what_friction_holds() -> None:
    """A block that resets speeds acts on coordinates that are let go; what then rests is held anew."""
    drag = sf.Friction(0.8, sticks=True)
    of = sf.Diagram("thrown")
    of.add_model("m", slide(drag, mass=1.0))
    of.add(Thrown(name="plant", model="m"))
    run = sf.Simulation(of).run(3.0, dt=1e-2)
    assert [(c.crossing, round(c.t, 9)) for c in run.crossings] == [("kick", 1.0)]
    (stop,) = run.events["plant"]
    assert stop.name == "x sticks" and stop.t == pytest.approx(2.0, abs=1e-9)
    assert run["plant.q"][-1, 0] == pytest.approx(0.4, abs=1e-9) and not run["plant.q"][run.t < 1.0].any()


@dataclass(frozen=True, kw_only=True)
class Thrown(ForwardDynamics):
    """A mechanism of one coordinate that gets a speed at t = 1 s."""

    speed: float = 0.8

    def crossings(self, context: Any) -> Mapping[str, Crossing]:
        """The instant."""
        return {"kick": Crossing(context.t - 1.0, "rising")}

    def crossed(self, context: Any, which: str) -> Mapping[str, Any]:
        """The speed."""
        return {"v": context.numbers([self.speed])}


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({"events": {"a": sf.Event("t - 0.1", action={"nothing": 1})}}, "block 'plant': event 'a': its action sets 'n"),
        ({"events": {"a": sf.Event("zz - 0.1")}}, "block 'plant', event 'a'.*unknown symbol 'zz'"),
        ({"events": {"a": sf.Event("t", action={"contact": "lam.floor.z"})}}, "what its action sets 'contact' to"),
        ({"events": {"a": "t - 0.1"}, "engaged": True}, "engaged constraints beside events"),
    ],
)
def test_impossible_switching_is_refused_by_the_name_of_the_block(fields: dict[str, Any], says: str) -> None:
    of = diagram(CASES["bounce"], **fields)
    if fields.get("engaged"):
        of.add(Constant(name="on", value=[1.0]))
        of.connect("on.y", "plant.engaged")
    with pytest.raises(sf.SymofrosError, match=says):
        sf.Simulation(of)


def test_a_run_that_an_action_ends_says_why() -> None:
    """A gap that engages; an action without an end; and a terminal event, which is none."""
    far = sf.Event("t - 0.1", action={"contact": 1})
    run = sf.Simulation(diagram(CASES["bounce"], events={"far": far})).run(1.0, dt=1e-2)
    assert run.outcome.kind == "constraints lost" and "plant.floor" in run.outcome.reason and run.t[-1] < 0.11
    down = sf.Event("z", "falling", action={"dz": "-dz"}, terminal=True)
    run = sf.Simulation(diagram(CASES["bounce"], events={"down": down})).run(1.0, dt=1e-2)
    (found,) = run.events["plant"]
    assert run.outcome.kind == "event" and run.t[-1] == found.t == pytest.approx(np.sqrt(1.0 / 9.81))
    assert run["plant.v"][-1, 0] == -found.v[0] > 0.0
    with pytest.raises(sf.SymofrosError, match="events of mechanisms"):
        sf.Simulation(diagram(CASES["bounce"])).interpret(0.1)


def test_a_loop_of_the_caller_s_acts_as_a_run_does() -> None:
    """Bit by bit, and what it has met is in its trajectory."""
    simulation = sf.Simulation(diagram(CASES["grasp"]))
    stepper = simulation.stepper(dt=1e-3, output=0.05)
    for _ in range(20):
        assert stepper.step()
    run = simulation.run(1.0, dt=1e-3, record=0.05)
    assert np.array_equal(stepper["plant.q"], run["plant.q"][-1])
    assert [one.name for one in stepper.trajectory().events["plant"]] == [one.name for one in run.events["plant"]]


def test_events_stand_in_files(tmp_path: Any) -> None:
    """What is written is read again, and acts as before."""
    of = diagram(CASES["bounce"])
    sf.save_diagram(of, tmp_path / "bounce.yaml")
    again = sf.load_diagram(tmp_path / "bounce.yaml")
    assert as_events(again.blocks["plant"].events) == as_events(of.blocks["plant"].events)
    one, other = (sf.Simulation(each).run(1.0, dt=1e-2) for each in (of, again))
    assert np.array_equal(one["plant.q"], other["plant.q"]) and one.events["plant"]


def test_a_sampled_signal_drives_a_brake_by_shares() -> None:
    """Each sample that differs sets the share, as events by the clock do."""
    stated = CASES["brake"]
    share = {"share": sf.Event("abs(command - shut) - 1e-9", "rising", action={"shut": "command"})}
    system = replace(stated.system, inputs=(sf.Input("command"),))
    of = diagram(replace(stated, system=system), events=share)
    orders = ((0.0, 1.0), (0.1, 0.0), (0.3, 0.7), (0.35, 0.9), (0.8, 0.1))
    of.add(Sequence(name="orders", t=[t for t, _ in orders], values=[[y] for _, y in orders], kind="hold"))
    of.add(Hold(name="sampled", period=0.05), u="orders")
    of.connect("sampled.y", "plant.u")
    run = sf.Simulation(of).run(1.0, dt=1e-3)
    clock = {f"{t}": sf.Event(f"t - {t}", action={"shut": y}) for t, y in orders[1:]}
    alone = simulated(replace(stated, events=clock), dt=1e-3)
    ours, theirs = run.events["plant"], alone.events
    assert [one.name for one in ours if one.name != "share"] == [one.name for one in theirs if one.name not in clock]
    np.testing.assert_allclose([one.t for one in ours], [one.t for one in theirs], rtol=0, atol=1e-9)
    np.testing.assert_allclose(run["plant.q"][-1], alone.q[-1], rtol=0, atol=1e-9)
