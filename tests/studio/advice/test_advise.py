"""sf.advise: what it leaves out, what it refuses to, and that the tolerance is met, simulated without its help."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.generator.passes.count import count_program
from symofros.studio.advice import scene_runner
from symofros.studio.advice.theories import simpler_theories

SCENES = Path(__file__).parents[3] / "reference_models" / "flexible" / "scenes"


def advised(name: str) -> sf.Advice:
    return sf.advise(MODELS[name], sf.load_scene(SCENES / f"{name}.yaml"))


def independent(advice: sf.Advice, system: sf.System, method: str, **settings: float) -> np.ndarray:
    """The scene's one position over time, by nothing of the advice but its scene."""
    (output,) = advice.scene.outputs
    run = sf.simulate(
        sf.compile(system),
        t_end=advice.scene.t_end,
        u=dict(advice.scene.inputs),
        method=method,
        output=advice.scene.times,
        **settings,
    )  # type: ignore[arg-type]
    assert run.outcome.ok, run.outcome
    return run.frames[output.of][0]


def operations(system: sf.System) -> int:
    return count_program(sf.program_of(system, ["forward_dynamics"]))["forward_dynamics", ""].total


def check(advice: sf.Advice, beams: dict[str, int]) -> None:
    """Tolerance met against a model of two more functions; at least three times cheaper, counted again here."""
    many = [replace(advice.full.body(name), bend_y=n) for name, n in beams.items()]
    right = independent(advice, advice.full.with_bodies(*many), "dop853", rtol=1e-9, atol=1e-12)
    found = independent(advice, advice.system, advice.stepping.method, **advice.stepping.settings)
    (allowed,) = advice.bounds.values()
    assert np.linalg.norm(found - right, axis=1).max() <= allowed
    assert advice.ok and advice.gain >= 3.0
    # What is counted: each evaluation of the reduced model is cheaper, and so is the run.
    assert 3 * operations(advice.system) <= operations(advice.full)
    assert advice.cost.total * 3 <= advice.full_cost.total
    assert advice.cost.evaluations <= 1.2 * advice.full_cost.evaluations


@pytest.mark.slow
def test_the_spin_up_keeps_foreshortening() -> None:
    """Estimator and simulation both say so, and the model that softens without stiffening runs away."""
    spin_up = advised("spinning_beam")
    check(spin_up, {"beam": 5})
    assert spin_up.system.body("beam").bend_y == 1 and spin_up.full.body("beam").bend_y == 3
    choice = spin_up.choice("foreshortening", "beam")
    assert choice.verdict == "refused" and choice.error is not None and choice.error > 5.0 and choice.estimate > 5.0
    assert choice.numbers["critical_ratio"] == pytest.approx(6.0 / 2.910758394396504, rel=1e-3)
    assert not choice.numbers["softened_error"] < 1e6
    assert "of the critical speed" in choice.why
    beam = spin_up.system.body("beam")
    assert beam.foreshortening and beam.retain == "first_order"


@pytest.mark.slow  # In every run: the rod that spins up, and beams that may be rigid or must bend.
def test_advice_for_the_planar_robot_gains_threefold() -> None:
    robot = advised("planar_robot")
    assert robot.ok and robot.gain >= 3.0
    # A slow motion needs no stiffening, and 50:1 gears no gyroscopic moments; the beams must bend.
    assert all(robot.choice("foreshortening", link).verdict == "taken" for link in ("link1", "link2"))
    assert robot.choice("rotor", "q3").verdict == "taken" and not robot.system.body("motor3").joint.rotors
    assert all(robot.choice("rigid", link).verdict == "refused" for link in ("link1", "link2"))
    assert [p.name for p in robot.system.parameters if not p.constant] == ["m_load"]


def crane(**changed: object) -> tuple[sf.System, sf.Scene]:
    """A stout boom with a spring in its joint, swung slowly: nothing bends that could be seen."""
    section = {"EI_z": 2e5, "EI_y": 2e5, "GJ": 1e5, "rhoJ": 1e-3, "rhoI_y": 5e-4, "rhoI_z": 5e-4}
    functions = {"bend_y": 2, "bend_z": 1, "twist": 1}
    swing = sf.Joint("swing", "revolute", actuated=True, axis=(0, 0, 1))
    boom = sf.Beam("boom", swing, 1.0, 2.0, **section | functions | changed)  # type: ignore[arg-type]
    wrist = sf.Joint("wrist", "revolute", "boom", "tip", axis=(0, 0, 1), elements=(sf.Spring(8e3), sf.Damper(5.0)))
    hook = sf.RigidBody(
        "hook", wrist, sf.Inertia("m", (0.1, 0, 0), (0.02, 0.02, 0.02)), (sf.Frame("eye", (0.2, 0, 0)),)
    )
    system = sf.System("crane", (boom, hook), (sf.Parameter("m", 1.5),), gravity=(0, 0, 0))
    law = "200*(0.2*(1 - cos(2*pi*t)) - swing) - 60*dswing"
    return system, sf.Scene(0.5, (sf.Output("eye", "position", "eye", absolute=2e-3),), {"swing": law})


@pytest.mark.slow
def test_a_beam_that_may_be_rigid_is_recommended_as_rigid() -> None:
    system, scene = crane()
    advice = sf.advise(system, scene)
    choice = advice.choice("rigid", "boom")
    assert choice.verdict == "taken" and choice.estimate <= 1.0 and choice.error is not None and choice.error <= 0.8
    assert "static" in choice.why and choice.numbers["bend_y.static"] > 0.0
    assert advice.system.body("boom").modes == 0
    lock = advice.choice("elastic joint", "wrist")
    assert lock.verdict == "taken" and advice.system.body("hook").joint.kind == "fixed"
    assert sf.compile(advice.system).names.v == ("swing",)


@pytest.mark.slow  # In every run: foreshortening, beams and joints that may be rigid.
def test_second_order_and_rotary_inertia_are_removed_where_negligible() -> None:
    system, scene = crane(retain="all", rotary_inertia=True, bend_z=0, twist=0)
    # Beyond rigid's error, so that the boom bends and the smaller terms are judged by themselves.
    advice = sf.advise(system, scene, 4e-5)
    assert advice.choice("rotary inertia", "boom").verdict == "taken"
    assert advice.choice("order", "boom").verdict == "taken"
    assert advice.system.body("boom").retain != "all" and not advice.system.body("boom").rotary_inertia


@pytest.mark.slow
def test_joints_that_a_controller_reads_are_not_removed() -> None:
    """The wrist's own coordinate drives an effort: locking it would take away what the law needs. By fixed steps."""
    system, scene = crane()
    law = f"{scene.inputs['swing']} + 1e-6*wrist"
    advice = sf.advise(system, replace(scene, inputs={"swing": law}, fixed_step=True))
    assert advice.stepping.dt is not None and advice.stepping.rtol is None and advice.full_stepping.dt is not None
    choice = advice.choice("elastic joint", "wrist")
    assert choice.verdict == "refused" and choice.error is not None and math.isinf(choice.error)
    assert advice.to_json()["choices"][0]["kind"]


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"outputs": (sf.Output("eye", "position", "eyes", absolute=1.0),)}, "did you mean 'eye'"),
        ({"outputs": (sf.Output("a", "coordinate", "swin", absolute=1.0),)}, "no coordinate 'swin'"),
        ({"inputs": {"swnig": 1.0}}, "no input 'swnig'"),
        ({"start": {"swnig": 1.0}}, "no coordinate or speed 'swnig'"),
        ({"keep": ("M",)}, "keep: no parameter 'M'"),
        ({"inputs": {"swing": "1e9*exp(swing^2*1e6)"}}, "can't be computed to its tolerance"),
    ],
)
def test_scenes_that_do_not_fit_their_system_are_refused(changed: dict[str, object], words: str) -> None:
    system, scene = crane()
    with pytest.raises(sf.SymofrosError) as raised:
        sf.advise(system, replace(scene, **changed))  # type: ignore[arg-type]
    assert words in str(raised.value)


def test_runs_that_end_early_are_distinguished_from_runs_that_differ(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only motions that reach the end and differ whatever their tolerance may be chaotic."""
    system, scene = crane()
    monkeypatch.setattr(scene_runner, "MOST_STEPS", 3)
    monkeypatch.setattr(scene_runner.SceneRunner.trial, "__defaults__", (3,))
    with pytest.raises(sf.SymofrosError, match="interrupted at t = .* 3 steps are done(.|\n)*within 3 steps") as raised:
        sf.advise(system, scene)
    assert "chaotic" not in str(raised.value)
    monkeypatch.undo()
    monkeypatch.setattr(scene_runner, "EXACT", -1.0)
    monkeypatch.setattr(scene_runner, "_LADDER", (1e-4, 1e-5))
    with pytest.raises(sf.SymofrosError, match="runs that reach the end differ(.|\n)*chaotic"):
        sf.advise(system, scene)


@pytest.mark.slow(minutes=5)
def test_advice_for_the_space_station_gains_threefold() -> None:
    """Fifty-seven coordinates; one boom may be rigid in a slow motion, most elastic joints may be locked."""
    advice = advised("flexible_mss")
    # By articulated bodies an evaluation costs what its coordinates do, 57 or 25; the rest is fewer evaluations.
    assert advice.ok and advice.gain >= 3.0 and 2 * operations(advice.system) <= operations(advice.full)
    assert advice.choice("rigid", "ssrms_link4").verdict == "taken"
    assert advice.choice("elastic joint", "ssrms_q3").verdict == "refused"


def soft_pendulum() -> tuple[sf.System, sf.Scene]:
    """A beam let go of: its own weight bends it by half a radian."""
    beam = sf.Beam("rope", sf.Joint("pin", "revolute", axis=(0, 0, 1)), 1.0, 1.0, EI_z=0.3, bend_y=4, family="legendre")
    outputs = (sf.Output("end", "position", "tip", absolute=5e-3),)
    return sf.System("soft", (beam,), gravity=(0, -9.81, 0)), sf.Scene(0.5, outputs, samples=50)


@pytest.mark.slow
def test_a_soft_pendulum_is_a_geometrically_exact_rod() -> None:
    """Second order errs by more than is allowed, as it says itself; as rods, fewer functions serve no longer."""
    system, scene = soft_pendulum()
    advice = sf.advise(system, scene)
    beam = advice.system.body("rope")
    assert isinstance(beam, sf.Beam) and beam.theory == "strain" and advice.ok
    assert advice.truncation > 1.0 and "and errs by" in advice.summary()[-1]
    assert all(one.verdict != "taken" for one in advice.choices if one.kind == "theory")
    assert any("judged by a geometrically exact rod" in note for note in advice.notes)
    # Stated as a rod, it stays one.
    right = independent(advice, system.with_bodies(replace(beam, bend_y=6)), "dop853", rtol=1e-9, atol=1e-12)
    found = independent(advice, advice.system, advice.stepping.method, **advice.stepping.settings)
    assert np.linalg.norm(found - right, axis=1).max() <= advice.bounds["end"]


def bowed(absolute: float) -> tuple[sf.System, sf.Scene]:
    """A rod in space that its weight bends by a quarter of a radian."""
    counts = {"bend_y": 2, "bend_z": 2, "twist": 1}
    stiffness = {"EI_z": 6.0, "EI_y": 9.0, "GJ": 6.0, "rhoJ": 1e-3}
    pin = sf.Joint("pin", "revolute", axis=(0, 1, 0))
    beam = sf.Beam("rod", pin, 1.0, 1.0, **stiffness, **counts, family="legendre", theory="strain")
    outputs = (sf.Output("end", "position", "tip", absolute=absolute),)
    return sf.System("bowed", (beam,), gravity=(0, -5.0, -8.0)), sf.Scene(0.4, outputs, samples=40)


@pytest.mark.slow  # In every run: which segments are tried.
@pytest.mark.parametrize(("absolute", "names"), [(3.5e-3, ["rod", "rod.2"]), (2e-3, ["rod"]), (1e-2, ["rod"])])
def test_two_segments_are_between_one_beam_and_the_rod(absolute: float, names: list[str]) -> None:
    """One beam of second order serves a wide tolerance, two in series a narrower one, the rod alone the narrowest."""
    system, scene = bowed(absolute)
    advice = sf.advise(system, scene)
    assert advice.ok and [body.name for body in advice.system.bodies] == names
    theories = {body.theory for body in advice.system.bodies if isinstance(body, sf.Beam)}
    assert theories == ({"strain"} if absolute == 2e-3 else {"second_order"})
    finer = replace(system.body("rod"), bend_y=3, bend_z=3, twist=2)
    right = independent(advice, system.with_bodies(finer), "dop853", rtol=1e-9, atol=1e-12)
    found = independent(advice, advice.system, advice.stepping.method, **advice.stepping.settings)
    assert np.linalg.norm(found - right, axis=1).max() <= advice.bounds["end"]


def test_simpler_theories_of_a_rod_include_segments_and_fewer_functions() -> None:
    """Of second order, of the rod itself with fewer functions each; of the rod alone where second order lacks terms."""
    system, _ = bowed(1e-3)
    rod = replace(system.body("rod"), bend_y=4, bend_z=3)
    assert isinstance(rod, sf.Beam)
    loads = SimpleNamespace(tip=1.0, gain=1.0)
    bending = SimpleNamespace(slope=0.3)

    def offered(beam: sf.Beam) -> dict[str, list[sf.Beam]]:
        stated = simpler_theories(loads, beam, bending)  # type: ignore[arg-type]
        made = {one.change: one.apply(system.with_bodies(beam)).bodies for one in stated}
        return {change: [body for body in bodies if isinstance(body, sf.Beam)] for change, bodies in made.items()}

    every = offered(rod)
    counts = {change: (len(bodies), bodies[0].theory, bodies[0].modes) for change, bodies in every.items()}
    assert counts == {
        "second order, first_order": (1, "second_order", 8),
        "second order, all": (1, "second_order", 8),
        "2 segments of second order": (2, "second_order", 8),
        "2 segments of second order, bend_y 2, bend_z 2, twist 1": (2, "second_order", 5),
        "2 segments of it, bend_y 2, bend_z 2, twist 1": (2, "strain", 5),
        "4 segments of second order": (4, "second_order", 8),
        "4 segments of second order, bend_y 1, bend_z 1, twist 1": (4, "second_order", 3),
        "4 segments of it, bend_y 1, bend_z 1, twist 1": (4, "strain", 3),
    }
    curved = offered(replace(rod, curvature_y=0.2))
    assert [*curved] == [change for change in every if "of it" in change]
    pressed = sf.BeamLoad((0.0, 1.0, 0.0), axes="body")
    assert [*offered(replace(rod, loads=(pressed,)))] == ["second order, first_order", "second order, all"]


def test_a_beam_beyond_its_theory_whose_coordinates_have_starts_is_refused() -> None:
    """Those of a rod are others; without a start, a rod takes its place."""
    beam = sf.Beam("blade", sf.Joint("root", "fixed"), 1.0, 1.0, EI_z=1.0, bend_y=2)
    scene = sf.Scene(0.2, (sf.Output("end", "position", "tip", absolute=5e-2),), samples=50)
    limp = sf.System("limp", (beam,), gravity=(0, -60, 0))
    with pytest.raises(sf.BeamTheoryError, match=r"(?s)'blade' bends by .* divide it into \d+ beams .* theory: strain"):
        sf.advise(limp, replace(scene, start={"blade.bend_y[0]": 1e-3}))


def test_events_of_the_model_end_scenes_in_words_and_keep_their_parameters() -> None:
    """Runs to an event of other steps are of other lengths; a parameter that an action sets is no constant."""
    scene = sf.Scene(2.0, (sf.Output("angle", "coordinate", "q", absolute=1e-4),), start={"q": 1.0})
    ends, sets = (
        replace(MODELS["pendulum"], events={"low": sf.Event("q - 0.3", "falling", **more)})
        for more in ({"terminal": True}, {"action": {"m": 2}})
    )
    with pytest.raises(sf.SymofrosError, match="event at t = 0.316 s: event 'low'"):
        sf.advise(ends, scene)
    advice = sf.advise(sets, scene)
    assert advice.choice("constants", "parameters").verdict == "taken"
    assert [one.name for one in advice.system.parameters if not one.constant] == ["m"]
