"""What the order of a beam leaves out is said, as large as it is (docs/theory/beams.md, 26g to 26i)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros import blocks

L, MASS, EI = 2.0, 0.8, 400.0
EULER = math.pi**2 * EI / (4.0 * L**2)
ACROSS, ALONG, GJ = 10.0, 1000.0, 8.0
LATERAL = 4.0126 * math.sqrt(ACROSS * GJ) / L**2


def system(joint: sf.Joint, **entries: Any) -> sf.System:
    beam = sf.Beam("b", joint, **{"length": L, "rhoA": MASS, **entries})
    return sf.System("s", (beam,), gravity=(0.0, 0.0, 0.0))


def column(share: float, retain: Any, segments: int = 1) -> sf.System:
    load = sf.BeamLoad((-share * EULER, 0.0, 1e-3), at=1.0, axes="world")
    return system(sf.Joint("clamp"), EI_y=EI, bend_z=3, retain=retain, segments=segments, loads=(load,))


def strip(share: float, **entries: Any) -> sf.Model:
    load = sf.BeamLoad((0.0, -share * LATERAL, 0.0), at=1.0, axes="world")
    stiffness = {"EI_y": ACROSS, "EI_z": ALONG, "GJ": GJ, "rhoJ": 1e-4, "bend_z": 4, "bend_y": 3, "twist": 3}
    return sf.compile(system(sf.Joint("clamp"), loads=(load,), **(stiffness | entries)))


INTERPRETED = sf.Options(backend="interpreter")


def turning(axis: tuple[float, float, float], spin: float, tip: float, **entries: Any) -> tuple[sf.Equilibrium, Any]:
    """A beam of unit length, mass and stiffness with a mass on its tip, in a steady spin, and its modes there."""
    beam = sf.Beam("b", sf.Joint("hub", "revolute", axis=axis), 1.0, 1.0, EI_y=1.0, EI_z=1.0, **entries)
    mass = sf.Inertia(tip + 1e-9, moments=(1e-3, 6e-4, 6e-4))
    carried = sf.RigidBody("m", sf.Joint("j", "fixed", parent="b", frame="tip"), mass)
    model = sf.compile(sf.System("s", (beam, carried), gravity=(0.0, 0.0, 0.0)), INTERPRETED)
    steady = sf.equilibrium(model, v={"hub": spin}, held=["hub"])
    return steady, sf.modes(model, steady.q, steady.v)


@pytest.mark.parametrize(
    ("axis", "spin", "tip", "planes", "said"),
    [
        ((1, 0, 0), 2.0, 0.0, (2, 2), "frequencies"),
        ((1, 0, 0), 1.0, 0.5, (2, 2), "frequencies"),
        ((1, 0, 0), 0.01, 0.0, (2, 2), ""),
        ((1, 0, 0), 2.0, 0.0, (0, 2), "stiffness"),
        ((0, 0, 1), 1.0, 0.0, (2, 0), "stiffness"),
        ((0, 0, 1), 1.0, 0.5, (2, 0), "stiffness"),
        ((0, 0, 1), 0.5, 0.0, (2, 0), ""),
    ],
)
def test_what_rotation_does_to_a_bent_beam_is_said(axis: Any, spin: float, tip: float, planes: Any, said: str) -> None:
    """In the plane of rotation, and about the beam's axis: shafts of the lowest order know no critical speed."""
    found = {
        retain: turning(axis, spin, tip, bend_y=planes[0], bend_z=planes[1], retain=retain)
        for retain in ("zeroth_order", "first_order")
    }
    ratio = np.divide(*(min(f for f in found[retain][1].frequencies if f > 1e-3) for retain in reversed(found)))
    change = ratio - 1.0 if planes == (2, 2) else ratio**2 - 1.0
    rel = 1.0 if tip and said == "frequencies" else 0.03  # Equations of what the tip carries keep Coriolis forces.
    steady, modes = found["zeroth_order"]
    for result in (steady, modes):
        parts = [part for bending in result.bendings for part in bending.left_out]
        assert [abs(part.change) for part in parts] == (pytest.approx([abs(change)], rel=rel) if said else [])
        assert all(part.of_frequency == (said == "frequencies") for part in parts)
    assert [said in note for note in modes.notes if "leaves out" in note] == [True] * bool(said)
    assert abs(change) < 0.01 or said
    assert not any("leaves out" in note for note in found["first_order"][1].notes)


def rotor(**entries: Any) -> sf.Model:
    return sf.compile(system(sf.Joint("hub", "revolute"), EI_y=EI, bend_z=3, **entries))


def changes(bendings: tuple[Any, ...]) -> list[float]:
    return [part.change for bending in bendings for part in bending.left_out]


@pytest.mark.parametrize("entries", [{"retain": "zeroth_order"}, {"retain": "all", "foreshortening": False}])
@pytest.mark.parametrize("spin", [1.0, 20.0, 60.0])
def test_spin_stiffens_by_what_is_said(entries: dict[str, Any], spin: float) -> None:
    """Against the frequency of a beam that has it, across the plane of rotation."""
    found = {}
    for name, stated in {"less": entries, "more": {"retain": "first_order"}}.items():
        model = rotor(**stated)
        steady = sf.equilibrium(model, v={"hub": spin}, held=["hub"])
        modes = sf.modes(model, steady.q, steady.v)
        found[name] = steady, modes, min(f for f in modes.frequencies if f > 1e-3)
    steady, modes, frequency = found["less"]
    gained = (found["more"][2] / frequency) ** 2 - 1.0
    entry = "foreshortening: false" if "foreshortening" in entries else "retain: zeroth_order"
    for result in (steady, modes):
        assert changes(result.bendings) == (pytest.approx([gained], rel=0.05) if gained > 0.01 else [])
        forces = "axial forces" if "foreshortening" in entries else "axial forces and rotation"
        said = [note for note in result.notes if f"leaves out what {forces} do to its stiffness ({entry})" in note]
        # The steady motion leaves the beam straight, whatever its stiffness.
        assert len(said) == int(gained > 0.01 and result is modes)
    assert not any("leaves out" in note for result in found["more"][:2] for note in result.notes)


@pytest.mark.parametrize("segments", [1, 3])
@pytest.mark.parametrize("share", [0.005, 0.05, 0.5, 0.97, 1.03])
def test_columns_soften_by_what_is_said(share: float, segments: int) -> None:
    rest = sf.equilibrium(sf.compile(column(share, "zeroth_order", segments)), beam_limit=math.inf)
    if share < 0.01:
        assert not rest.notes
        return
    expected = -share if share < 1.0 else -1.0
    assert changes(rest.bendings) == pytest.approx([expected] * segments, rel=0.02)
    words = "softer" if share < 1.0 else "with which its loads are past a critical one"
    assert any("leaves out what axial forces" in note and words in note for note in rest.notes)


@pytest.mark.parametrize(
    ("share", "words"), [(0.5, ""), (-0.5, ""), (1.03, "with which its loads are past a critical")]
)
def test_a_straight_column_bears_no_note_but_of_a_critical_load(share: float, words: str) -> None:
    """Its rest and its run are those of any order; its modes are not."""
    load = sf.BeamLoad((-share * EULER, 0.0, 0.0), at=1.0, axes="world")
    model = sf.compile(system(sf.Joint("clamp"), EI_y=EI, bend_z=3, retain="zeroth_order", loads=(load,)))
    rest, modes = sf.equilibrium(model), sf.modes(model, model.neutral())
    for notes in (rest.notes, sf.simulate(model, t_end=0.01, dt=1e-3).outcome.notes):
        said = [note for note in notes if "leaves out" in note]
        assert len(said) == bool(words) and all(words in note for note in said)
    assert changes(rest.bendings) == pytest.approx([-share if share < 1.0 else -1.0], rel=0.02)
    assert sum("leaves out what axial forces and rotation do" in note for note in modes.notes) == 1


@pytest.mark.parametrize("retain", ["zeroth_order", "first_order"])
@pytest.mark.parametrize("tip", [0.01, 0.1])
def test_at_rest_under_small_loads_the_note_is_the_error(tip: float, retain: Any) -> None:
    """Of a slanted beam with a mass at its tip, against a rod; what is below 1 % bears none."""

    def rest(**entries: Any) -> tuple[float, sf.Equilibrium]:
        beam = sf.Beam("b", sf.Joint("clamp"), 1.0, 0.05, EI_z=1.0, bend_y=3, **entries)
        mass = sf.RigidBody("m", sf.Joint("j", "fixed", parent="b", frame="tip"), sf.Inertia(tip))
        slanted = sf.System("s", (beam, mass), gravity=(0.7, -0.7, 0.0))
        model = sf.compile(slanted, sf.Options(backend="interpreter"))
        found = sf.equilibrium(model)
        return float(model.frame_pose("tip", found.q)[0][1]), found

    (exact, _), (deflection, found) = rest(theory="strain"), rest(retain=retain)
    error, said = deflection / exact - 1.0, changes(found.bendings)
    assert len(found.notes) == len(said) == (error > 0.01)
    if said:
        assert said == pytest.approx([error], rel=0.05)


@pytest.mark.parametrize(("sides", "turns", "first"), [(("z",), (), 4.493409), (("z",), ("y",), 2.0 * math.pi)])
def test_a_loop_that_holds_the_tip_of_a_column_counts(sides: Any, turns: Any, first: float) -> None:
    """The tip slides along the axis, turns or not: Euler's other loads, (first/L)^2 EI."""
    load = sf.BeamLoad((-0.5 * first**2 * EI / L**2, 0.0, 0.0), at=1.0, axes="world")
    clamp = sf.Joint("clamp")
    beam = sf.Beam("b", clamp, L, MASS, EI_y=EI, bend_z=5, retain="zeroth_order", loads=(load,))
    wall = sf.RigidBody("wall", sf.Joint("fixed", position=(L, 0.0, 0.0)), sf.Inertia(1.0))
    held = sf.Closure("held", ("wall", None), ("b", "tip"), sides, turns)
    model = sf.compile(sf.System("s", (beam, wall), gravity=(0.0, 0.0, 0.0), constraints=(held,)))
    assert changes(sf.equilibrium(model).bendings) == pytest.approx([-0.5], rel=0.02)
    assert changes(sf.modes(model, model.neutral()).bendings) == pytest.approx([-0.5], rel=0.02)


def test_a_torque_couples_both_planes_where_twist_is_rigid() -> None:
    """What its moment is said to do is what the strain energy of a beam that hardly twists does."""
    load = sf.BeamLoad((0.0, 0.0, 1e-3), (0.5, 0.0, 0.0), at=1.0, axes="world")
    stiffness = {"EI_y": 1.0, "EI_z": 2.0, "GJ": 1e4, "rhoJ": 1e-6, "bend_y": 2, "bend_z": 2, "family": "polynomial"}
    said = {}
    for twist, retain in ((0, "all"), (1, "first_order")):
        beam = sf.Beam("b", sf.Joint("c"), 1.0, 1.0, twist=twist, retain=retain, loads=(load,), **stiffness)
        rest = sf.equilibrium(sf.compile(sf.System("s", (beam,), gravity=(0.0, 0.0, 0.0)), INTERPRETED))
        (said[twist],) = changes(rest.bendings)
        assert sum("leaves out how its loads couple bending" in note for note in rest.notes) == 1
    assert said[0] == pytest.approx(said[1], rel=0.02) and -0.2 < said[0] < -0.02


def test_runs_batches_diagrams_and_efforts_say_it_too() -> None:
    described = column(0.5, "zeroth_order")
    model = sf.compile(described)
    run = sf.simulate(model, t_end=0.02, dt=1e-3)
    batch = sf.simulate_batch(model, np.zeros((2, model.nq)), t_end=0.02, dt=1e-3)
    diagram = sf.Diagram("d")
    diagram.add_model("plant", described)
    diagram.add(blocks.ForwardDynamics(name="beam", model="plant"))
    drawn = sf.Simulation(diagram).run(0.02, dt=1e-3)
    still = np.zeros(model.nv)
    efforts = sf.actuator_efforts(model, run.q[-1], still, still, model.names.v)
    for notes in (run.outcome.notes, batch.outcome(1).notes, drawn.outcome.notes, efforts.notes):
        assert sum("leaves out what axial forces and rotation do to its stiffness" in note for note in notes) == 1
    assert changes(run.bendings) == pytest.approx([-0.5], rel=0.02)


@pytest.mark.parametrize("entries", [{}, {"bend_y": 0}, {"bend_y": 0, "retain": "all"}])
@pytest.mark.parametrize("share", [0.02, 0.5, 0.9, 0.97, 1.03])
def test_strips_soften_sideways_by_what_is_said(entries: dict[str, Any], share: float) -> None:
    """Buckling of a strip that bends in its stiff plane, at 4.0126 of the root of EI GJ over L^2."""
    model = strip(share, **entries)
    rest = sf.equilibrium(model)
    notes, modes = (
        [note for note in found.notes if "beam 'b' leaves out how its loads couple bending and twist" in note]
        for found in (rest, sf.modes(model, rest.q))
    )
    assert len(modes) == int(share > 0.05)
    # Below the critical load, one that cannot bend sideways is where any order leaves it.
    assert len(notes) == len(modes) * int(share > 1.0 or not entries)
    if share > 1.0:
        assert "its loads are past a critical one" in notes[0]
    elif notes:
        # The couple of a moment and twist falls on the softer plane with the square of the load.
        assert changes(rest.bendings) == pytest.approx([-(share**2)], abs=0.06)


@pytest.mark.parametrize("share", [0.5, 0.9])
def test_beams_that_leave_nothing_out_say_nothing(share: float) -> None:
    models = strip(share, retain="all"), sf.compile(column(share, "first_order"))
    rests = [sf.equilibrium(model, beam_limit=math.inf) for model in models]
    assert not any(bending.left_out for rest in rests for bending in rest.bendings)
