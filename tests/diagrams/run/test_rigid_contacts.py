"""Rigid contacts of a diagram's mechanisms (docs/theory/diagrams.md, section 9; constraints.md, section 15)."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import ForwardDynamics, Hold, ModelFunction, Sequence
from symofros.diagrams.program.compiled import resolve
from symofros.simulation.events import CONTACT_WORDS, FRICTION_WORDS, ModeEvent
from tests.diagrams.run.test_switching import CASES, Case, Thrown, diagram, simulated
from tests.simulation.contacts.test_landing import BOX, DISC
from tests.simulation.contacts.test_rigid_solids import RADIUS, SOLIDS, system_against
from tests.simulation.rigid_scenes import G, box_system, in_shell


def hopper() -> sf.Diagram:
    """A mass of 2 kg falls from 0.1 m; a sampled force presses it on the ground, and lifts it from 0.5 s to 0.8 s."""
    mass = sf.RigidBody("z", sf.Joint("z", "prismatic", axis=(0, 0, 1)), sf.Inertia(2.0))
    system = sf.System(
        "hopper",
        (mass,),
        inputs=(sf.Input("force"),),
        virtual_power=(sf.VirtualPower("push", {"dz": "force"}),),
        connections=(sf.Contact("foot", ("z", None), ("world", None), restitution=0.0, friction=0.5),),
    )
    of = sf.Diagram("hopping")
    of.add_model("m", system, {"z": 0.1})
    of.add(Sequence(name="force", t=[0.0, 0.5, 0.8], values=[[-10.0], [30.0], [0.0]], kind="hold"))
    of.add(Hold(name="hold", period=0.1), u="force")
    of.add(ForwardDynamics(name="plant", model="m", functions=("contact_forces",)))
    of.connect("hold.y", "plant.u")
    return of


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
def test_a_sampled_force_lifts_a_mass_off_the_ground(method: str) -> None:
    """It lands, is pressed on, opens at the sample, flies, and lands again: closed forms."""
    run = sf.Simulation(hopper()).run(2.0, dt=1e-3, record=0.01, method=method)
    assert run.outcome.ok
    landed, opens, again = run.events["plant"]
    pressed, lifted = G + 5.0, 15.0 - G
    assert landed.name == "foot sticks" and landed.t == pytest.approx(np.sqrt(0.2 / pressed), abs=1e-9)
    assert landed.energy_lost == pytest.approx(0.1 * 2.0 * pressed, abs=1e-9)
    assert (opens.name, opens.t) == ("foot opens", 0.5)
    height, speed = 0.5 * lifted * 0.3**2, lifted * 0.3
    fall = (speed + np.sqrt(speed**2 + 2.0 * G * height)) / G
    assert again.t == pytest.approx(0.8 + fall, abs=1e-9)
    push = run["plant.contact_forces_push"][:, 0]
    pressing, flying = (run.t > landed.t) & (run.t < 0.5), (run.t > 0.5) & (run.t < again.t)
    np.testing.assert_allclose(push[pressing], 2.0 * pressed, rtol=1e-12)
    assert not push[flying].any() and np.count_nonzero(pressing) > 20
    np.testing.assert_allclose(run["plant.contact_forces_force"][pressing, 0], [[0, 0, 2.0 * pressed]] * pressing.sum())


def test_forces_are_those_of_a_run_by_itself() -> None:
    """Sliding friction included: by the mechanism, and by a block that is given its multipliers."""
    case = CASES["slab"]
    of = diagram(case, functions=("contact_forces",))
    of.add(ModelFunction(name="felt", model="m", function="contact_forces"))
    for signal in ("q", "v", "lam"):
        of.connect(f"plant.{signal}", f"felt.{signal}")
    options = {"method": "rk4", "dt": 1e-2}
    run, alone = sf.Simulation(of).run(0.7, record=0.05, **options), simulated(case, output=0.05, **options)
    forces = alone.contact_forces()
    for t in (0.05, 0.3, 0.65):
        i, k = (int(np.flatnonzero(np.isclose(times, t))[-1]) for times in (run.t, alone.t))
        for block in ("plant.contact_forces_", "felt."):
            np.testing.assert_allclose(run[f"{block}force"][i], forces.force[k], atol=1e-10)
            np.testing.assert_allclose(run[f"{block}push"][i], forces.push[k], atol=1e-10)
    assert (forces.force[1, :, 0] < -0.1).all(), "friction is seen"


def test_no_record_of_a_ball_that_leaves_at_the_edge_at_once_says_that_it_is_drawn() -> None:
    """As of a run by itself: at the edge its force jumps from m g to zero."""
    top, end, _, _, sizes = SOLIDS["box"]
    of = sf.Diagram("edge")
    of.add_model("m", system_against("box", 0.0, **sizes), {"ball.pz": top + RADIUS, "ball.vx": 1.5})
    of.add(ForwardDynamics(name="plant", model="m", functions=("contact_forces",)))
    run = sf.Simulation(of).run(0.5, dt=7e-4, method="rk4")
    (leaves,) = run.events["plant"]
    assert leaves.name == "top opens" and leaves.t == pytest.approx(end / 1.5, abs=1e-5)
    push = run["plant.contact_forces_push"][:, 0]
    assert push == pytest.approx(np.where(run.t < leaves.t, G, 0.0), abs=1e-6)


def test_forces_of_rigid_contacts_are_of_multipliers() -> None:
    of = diagram(CASES["slab"])
    of.add(ModelFunction(name="felt", model="m", function="contact_forces"), q="plant.q", v="plant.v")
    with pytest.raises(sf.DescriptionError, match=r"felt.*lam"):
        sf.Simulation(of)


FINE = {"method": "dopri5", "rtol": 1e-9, "atol": 1e-11}


# A ball goes round in a free shell, past the poles of its surface.
SHELL = Case(
    in_shell(0.1, (1, 2, 3), 2.5),
    {},
    2.0,
    {"ball.px": 0.4, "ball.vy": 1.2, "ball.vz": 0.4, "ball.wx": 3.0, "ball.wy": -1.0, "ball.wz": 2.0, "shell.wx": 0.4},
)


@pytest.mark.parametrize("order", [("ball", "held", "shell", "other"), ("held", "other", "shell", "ball")])
def test_modes_of_mechanisms_are_chosen_each_by_its_own_rule(order: tuple[str, ...]) -> None:
    """A ball bounces, one goes round in a shell, a slab slides, a brake holds an arm: each as without the others."""
    cases = {"ball": CASES["backspin"], "held": CASES["brake"], "other": CASES["slab"], "shell": SHELL}
    of = sf.Diagram("several")
    for name in order:
        of.add_model(f"m_{name}", cases[name].system, cases[name].start, cases[name].parameters)
        of.add(ForwardDynamics(name=name, model=f"m_{name}", events=cases[name].events))
    resolved = resolve(of)
    (part,) = resolved.layout.parts
    switching = resolved.switching(part)
    assert switching is not None
    kinds = [event.words for event in switching.events if isinstance(event, ModeEvent)]
    assert kinds == [FRICTION_WORDS] + 12 * [CONTACT_WORDS], "as native/stepping/events/actions.c counts them"
    run = sf.Simulation(of).run(2.0, record=0.1, **FINE)
    for name in order:
        alone, here = simulated(cases[name], **FINE), run.events[name]
        # Of feet that stick at one instant rounding says which of them an event names.
        instants, wanted = (sorted({round(one.t, 7) for one in met}) for met in (here, alone.events))
        # Turns in the last microseconds of a slip's spiral, (46a), are as uncertain as what is left of it: 9e-7 s.
        np.testing.assert_allclose(instants, wanted, atol=2e-6 if name == "shell" else 2e-7)
        last = int(np.flatnonzero(np.isclose(run.t, alone.t[-1]))[-1])
        np.testing.assert_allclose(run[f"{name}.q"][last], alone.q[-1], atol=1e-7)


@pytest.mark.parametrize("speed", [2.0, -2.0])
def test_a_crossing_throws_what_stands_on_the_ground(speed: float) -> None:
    """A block resets speeds: upwards the mass flies; downwards it strikes, and rebounds by its restitution."""
    mass = sf.RigidBody("z", sf.Joint("z", "prismatic", axis=(0, 0, 1)), sf.Inertia(2.0))
    foot = sf.Contact("foot", ("z", None), ("world", None), restitution=0.5, friction=0.5)
    of = sf.Diagram("thrown")
    of.add_model("m", sf.System("mass", (mass,), connections=(foot,)))
    of.add(Thrown(name="plant", model="m", speed=speed))
    run = sf.Simulation(of).run(1.3, dt=1e-3)
    assert run.outcome.ok and [(c.crossing, round(c.t, 9)) for c in run.crossings] == [("kick", 1.0)]
    leaves = speed if speed > 0.0 else -0.5 * speed
    flying = (run.t > 1.0) & (run.t < 1.0 + 2.0 * leaves / G)
    since = run.t[flying] - 1.0
    np.testing.assert_allclose(run["plant.q"][flying, 0], leaves * since - 0.5 * G * since**2, atol=1e-9)
    assert np.abs(run["plant.q"][run.t < 1.0]).max() < 1e-12 and flying.sum() > 100


@pytest.mark.parametrize(("feet", "restitution", "seed"), [(DISC, 0.5, 3), (BOX, 0.0, 2)])
def test_strikes_are_no_errors_of_steps(feet: list[tuple[float, float, float]], restitution: float, seed: int) -> None:
    """Finer steps strike a little earlier, or end by rounding after what the records end with: no note says so."""
    sole = sf.Contact("sole", ("thing", None), ("world", None), restitution=restitution, friction=1.1, points=feet)
    thing = sf.RigidBody("thing", sf.Joint("free", "free"), sf.Inertia(2.0, moments=(0.02, 0.03, 0.04)))
    draw = np.random.default_rng(seed)
    speeds = [*draw.normal(size=3), *3.0 * draw.normal(size=3)]
    start = dict(zip(("vx", "vy", "vz", "wx", "wy", "wz"), speeds, strict=True)) | {"pz": 0.35}
    of = sf.Diagram("thrown")
    of.add_model("m", sf.System("thrown", (thing,), connections=(sole,)), {f"free.{k}": x for k, x in start.items()})
    of.add(ForwardDynamics(name="plant", model="m"))
    run = sf.Simulation(of).run(0.8, record=0.8, dt=1e-3, method="rk4")
    assert len(run.events["plant"]) >= 4 and run.outcome.ok
    assert all("persists" in note for note in run.outcome.notes), run.outcome.notes


def test_a_start_below_the_ground_is_refused() -> None:
    of = sf.Diagram("sunk")
    of.add_model("m", box_system(0.5), {"free.pz": 0.09})
    of.add(ForwardDynamics(name="plant", model="m"))
    with pytest.raises(sf.SymofrosError, match="penetrated here"):
        sf.Simulation(of).run(0.1)


def test_it_is_not_interpreted() -> None:
    with pytest.raises(sf.SymofrosError, match="modes of friction that sticks, or of rigid contacts"):
        sf.Simulation(diagram(CASES["backspin"])).interpret(0.1)
