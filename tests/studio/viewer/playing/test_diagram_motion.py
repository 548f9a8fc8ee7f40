"""What is shown of a diagram's run: the mechanism of one block, with the run's own states, inputs and parameters."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros import blocks
from symofros.diagrams.result import DiagramRun
from symofros.errors import SymofrosError, UnknownNameError
from symofros.studio.viewer.drawing.poses import Mechanism
from symofros.studio.viewer.playing.diagram_motion import shown_system_and_states
from symofros.studio.viewer.playing.motion import read_motion
from symofros.studio.viewer.viewer import Viewer
from tests.studio.viewer.replays.unpacking import messages_of


def run_of(*names: str) -> DiagramRun:
    """Arms that fall, one a name, from different angles."""
    d = sf.Diagram("arms")
    for i, name in enumerate(names):
        d.add_model(f"{name}_model", MODELS["double_pendulum"], {"q1": 0.5 + i}, {"L1": 0.6 + i})
        d.add(blocks.ForwardDynamics(name=name, model=f"{name}_model"))
    return sf.Simulation(d).run(0.1, dt=1e-2)


@pytest.fixture(scope="module")
def one() -> DiagramRun:
    return run_of("plant")


@pytest.fixture(scope="module")
def two() -> DiagramRun:
    return run_of("left", "right")


def test_the_chosen_mechanism_moves_as_it_did(two: DiagramRun) -> None:
    for i, name in enumerate(("left", "right")):
        system, states = shown_system_and_states(two, name)
        assert system == MODELS["double_pendulum"] and np.array_equal(states.q, two[f"{name}.q"])
        assert states.q[0, 0] == 0.5 + i and states.par[2] == 0.6 + i


def test_a_replay_uses_the_parameters_of_the_run() -> None:
    d = sf.Diagram("arm")
    d.add_model("arm", MODELS["double_pendulum"], {"q1": 0.5})
    d.add(blocks.ForwardDynamics(name="plant", model="arm"))
    run = sf.Simulation(d).run(0.02, dt=1e-2, parameters={"arm.L1": 0.9})
    with sf.view(run, port=0, browser=False) as viewer:
        elbow = viewer._server.scene.get_handle_by_name("/mechanism/link1").position
        assert np.linalg.norm(elbow) == pytest.approx(0.9)


def test_a_replay_uses_the_prescribed_inputs_of_the_run() -> None:
    t = np.array([0.0, 1.0])
    d = sf.Diagram("spin")
    d.add_model("beam", MODELS["spinning_beam"])
    d.add(blocks.Sequence(name="hub", t=t, values=np.stack([3 * t, 3 + 0 * t, 0 * t], axis=1)))
    d.add(blocks.ForwardDynamics(name="plant", model="beam"), u="hub.y")
    run = sf.Simulation(d).run(0.2, dt=1e-3, record=0.1)
    system, states = shown_system_and_states(run)
    assert np.allclose(states.u[:, 0], [0.0, 0.3, 0.6])
    posture = Mechanism(system).posture(states.q, states.u)
    assert np.allclose(posture.R[-1, 0, :2, 0], [np.cos(0.6), np.sin(0.6)])


def test_a_mechanism_has_to_be_chosen_where_there_are_several(two: DiagramRun, one: DiagramRun) -> None:
    with pytest.raises(UnknownNameError, match=r"which mechanism\?\n  found:  2 mechanisms\n.*: left, right\n"):
        sf.view(two, port=0, browser=False)
    with pytest.raises(UnknownNameError, match=r"no mechanism 'plan'\n(.*\n)*  remedy: did you mean 'plant'"):
        sf.record(one, "r.png", block="plan")


def test_a_run_is_played(one: DiagramRun) -> None:
    with sf.view(one, port=0, browser=False, speed=0.5) as viewer:
        viewer.toggle()
        viewer.seek(0.1)
        assert np.allclose(viewer.state.q, one["plant.q"][-1])


def test_arguments_that_are_neither_motion_nor_run_are_refused(one: DiagramRun) -> None:
    system = MODELS["double_pendulum"]
    for given in ((system, (one.t, one["plant.q"])), (system, "r.png"), (one, (one.t, one["plant.q"]), "r.png")):
        with pytest.raises(SymofrosError, match="a system, its motion and a path; or a diagram's run and a path"):
            sf.record(*given)


LENGTHENED = sf.System(
    "crane",
    (
        sf.RigidBody(
            "arm",
            sf.Joint("q", "revolute", axis=(0, 1, 0)),
            sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)),
            (sf.Frame("tip", ("L", 0, 0)),),
        ),
        sf.RigidBody(
            "load",
            sf.Joint("r", "revolute", "arm", axis=(0, 1, 0), frame="tip"),
            sf.Inertia(1.0, (0.1, 0, 0), (1, 1, 1)),
        ),
    ),
    (sf.Parameter("L", 0.5),),
)
LONGER = {"longer": sf.Event("t - 0.05", action={"L": 1.5})}


def lengthened_by(way: str) -> Any:
    """The crane, whose arm an event makes longer, as a diagram or by itself."""
    if way == "simulate":
        return sf.simulate(sf.compile(LENGTHENED), t_end=0.1, dt=1e-2, method="rk4", events=LONGER)
    d = sf.Diagram("crane")
    d.add_model("crane", LENGTHENED)
    d.add(blocks.ForwardDynamics(name="plant", model="crane", events=LONGER))
    return sf.Simulation(d).run(0.1, dt=1e-2)


def reach(viewer: Viewer, time: float) -> float:
    """How far the load's joint is from the arm's in the picture at a time [m]."""
    viewer.seek(time)
    return float(np.linalg.norm(viewer._server.scene.get_handle_by_name("/mechanism/link1").position))


@pytest.mark.parametrize("way", ["simulate", "diagram"])
def test_a_replay_uses_the_parameters_that_events_set(way: str, tmp_path: Path) -> None:
    """In the picture at each time, in files and in pictures."""
    run = lengthened_by(way)
    shown: tuple[Any, ...] = (run,) if isinstance(run, DiagramRun) else (LENGTHENED, run)
    with sf.view(*shown, port=0, browser=False) as viewer:
        viewer.toggle()
        found = [reach(viewer, time) for time in (0.02, 0.08, 0.0, 0.1)]
    assert found == pytest.approx([0.5, 1.5, 0.5, 1.5])
    film = import_module("PIL.Image").open(sf.record(*shown, tmp_path / "m.gif", rate=100, size=(160, 120)))
    wide = []
    for frame in (0, film.n_frames - 1):
        film.seek(frame)
        picture = np.asarray(film.convert("RGB")).astype(int)
        wide.append(int((np.ptp(picture, axis=2) > 60).any(axis=0).sum()))
    assert wide[1] > 1.5 * wide[0]
    if isinstance(run, sf.Trajectory):
        read = read_motion(run.save(tmp_path / "run.npz"), run.model)
        assert np.array_equal(read.par, run.par_over_time)
        with pytest.raises(SymofrosError, match="found:  parameters that events set"):
            sf.record(*shown, tmp_path / "m.html", simulate=True)


def test_a_page_has_the_geometry_of_each_time(tmp_path: Path) -> None:
    """Drawn anew at the picture from which on the arm is longer."""
    page = sf.record(lengthened_by("diagram"), tmp_path / "m.html", rate=100).read_text()
    drawn = {time for time, message in messages_of(page) if message["type"] == "MeshMessage"}
    assert drawn == {0.0, 0.05}


def test_ghosts_of_diagrams_look_as_their_own_parameters_say() -> None:
    def hanging(length: float) -> DiagramRun:
        d = sf.Diagram("arm")
        d.add_model("arm", MODELS["double_pendulum"], {"q1": 0.5})
        d.add(blocks.ForwardDynamics(name="plant", model="arm"))
        return sf.Simulation(d).run(0.02, dt=1e-2, parameters={"arm.L1": length})

    with sf.view(hanging(0.9), port=0, browser=False, ghosts={"shorter": hanging(0.4)}) as viewer:
        viewer.seek(0.01)
        elbows = [
            viewer._server.scene.get_handle_by_name(f"/{name}/link1").position for name in ("mechanism", "ghosts/0")
        ]
        np.testing.assert_allclose(np.linalg.norm(elbows, axis=1), [0.9, 0.4])


def test_a_ghost_whose_shape_changes_is_refused(tmp_path: Path) -> None:
    shown = lengthened_by("diagram")
    with pytest.raises(SymofrosError, match=r"ghost 'it' changes its shape\n  found:  parameters that events set"):
        sf.record(shown, tmp_path / "m.html", ghosts={"it": shown})
