"""symoSFunction against a stand-in for Simulink's header (simulink/): compiled and run, but not in Simulink itself."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from tests.exports.cases import MODELS, STARTS, STEP, build, first_state, relative, run, system_of, trajectory
from tests.models import sampled

HEADERS = Path(__file__).parent / "simulink"
SAME = 1e-12


def compiled(folder: Path, name: str) -> None:
    build(folder, "../block", "symoSFunction.c", f"{name}.c", f"{name}_plant.c", "symofros_stepper.c", include=HEADERS)


@pytest.fixture(scope="module", params=sampled(MODELS, ("four_bar", "spatial_rod")))
def block(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Path]:
    name = request.param
    folder = tmp_path_factory.mktemp("block") / name
    sf.export(system_of(name), "sfunction", folder, start=STARTS[name])
    compiled(folder, name)
    return name, folder.parent


def ports(text: str) -> list[np.ndarray]:
    return [np.array(list(map(float, line.split()))) for line in text.splitlines()]


def test_integrated_direct_dynamics_match_the_trajectory(block: tuple[str, Path]) -> None:
    name, folder = block
    found = ports(run("./block", name, "direct_dynamics", "0.2", str(STEP[name]), cwd=folder))
    wanted = trajectory(name, 0.2)
    # A loop is held by gains here, and projected after each step there.
    bound = 1e-9 if name == "four_bar" else SAME
    assert relative(found[0], wanted.q[-1]) < bound
    assert relative(found[1], wanted.v[-1]) < bound
    assert len(found) == (4 if name == "four_bar" else 3)


def test_s_function_outputs_match_the_model(block: tuple[str, Path]) -> None:
    name, folder = block
    model = sf.compile(system_of(name))
    q, v = first_state(model, name)
    a, u = np.linspace(-1.0, 1.0, model.nv), np.full(model.nu, 0.3)

    def call(function: str, *inputs: np.ndarray) -> list[np.ndarray]:
        words = [repr(float(x)) for part in inputs for x in part]
        return ports(run("./block", name, function, "0", "1", *words, cwd=folder))

    (tau,) = call("inverse_dynamics", q, v, a)
    M, gnl = call("dynamics", q, v, u)
    places, speeds = call("kinematics", q, v)
    T, V = call("energy", q, v)
    M_, h, Q = model.dynamics(q, v, u)
    wanted_tau = model.inverse_dynamics(q, v, a)
    assert np.abs(tau - wanted_tau).max() < SAME * max(1.0, np.abs(wanted_tau).max())
    assert relative(M, M_.ravel()) < SAME
    assert np.abs(gnl - (Q - h)).max() < SAME * max(1.0, np.abs(h).max())
    for i, frame in enumerate(model.names.frames):
        assert np.abs(places[3 * i : 3 * i + 3] - model.frame_pose(frame, q)[0]).max() < SAME
        assert np.abs(speeds[6 * i : 6 * i + 6] - model.frame_velocity(frame, q, v)).max() < SAME * 10
    assert T[0] == pytest.approx(float(model.kinetic_energy(q, v)), rel=SAME)
    assert V[0] == pytest.approx(float(model.potential_energy(q)), rel=SAME, abs=SAME)


def test_the_block_accepts_parameters_in_their_order(tmp_path: Path) -> None:
    """In their order, for every function; none are the defaults."""
    system = system_of("four_bar")
    folder = tmp_path / "four_bar"
    sf.export(system, "sfunction", folder, start=STARTS["four_bar"])
    compiled(folder, "four_bar")
    model = sf.compile(system)
    q, v = first_state(model, "four_bar")
    words = [repr(float(x)) for x in (*q, *v)]

    def energies(*parameters: float) -> list[float]:
        stated = f"BLOCK_PARAMETERS={' '.join(map(repr, parameters))}"
        found = ports(run("env", stated, "./block", "four_bar", "energy", "0", "1", *words, cwd=tmp_path))
        return [float(port[0]) for port in found]

    other = {name: 1.5 * value + 0.1 * i for i, (name, value) in enumerate(model.parameters.items())}
    for parameters, wanted in (((), model), (other.values(), model.with_parameters(**other))):
        T, V = energies(*parameters)
        assert pytest.approx(float(wanted.kinetic_energy(q, v)), rel=SAME) == T
        assert pytest.approx(float(wanted.potential_energy(q)), rel=SAME) == V
    for wrong in ((1.0,) * (model.npar + 1), (1.0,) * (model.npar - 1)):
        with pytest.raises(AssertionError, match="Parameters has one number a parameter of the model, or is"):
            energies(*wrong)


@pytest.mark.parametrize("words", [("nothing", "direct_dynamics"), ("MODEL", "fly")])
def test_unknown_model_names_or_functions_of_the_block_are_refused(
    block: tuple[str, Path], words: tuple[str, str]
) -> None:
    name, folder = block
    with pytest.raises(AssertionError, match="no such ModelName or ModelFunction"):
        run("./block", words[0].replace("MODEL", name), words[1], "0", "1", cwd=folder)


def test_the_start_keeps_constraints_of_other_parameters(tmp_path: Path) -> None:
    """Two cranks joined by a rod: another length moves the start, which stood 0.07 m off the condition."""
    link, axis = sf.Inertia(1.0, (0.5, 0, 0), (0.1, 0.1, 0.1)), (0, 1, 0)
    end = [sf.Frame("end", (1, 0, 0))]
    bodies = [
        sf.RigidBody("left", sf.Joint("q1", "revolute", axis=axis), link, end),
        sf.RigidBody("right", sf.Joint("q2", "revolute", axis=axis, position=(2, 0, 0)), link, end),
    ]
    rod = sf.Rod("rod", ("left", "end"), ("right", "end"), length="R")
    system = sf.System("cranks", bodies, [sf.Parameter("R", 2.0)], constraints=[rod])
    sf.export(system, "sfunction", tmp_path / "cranks", start={"q1": 0.3})
    compiled(tmp_path / "cranks", "cranks")
    model = sf.compile(system).with_parameters(R=1.9)
    q, v, *_ = ports(run("env", "BLOCK_PARAMETERS=1.9", "./block", "cranks", "direct_dynamics", "0", "1", cwd=tmp_path))
    assert np.abs(model.constraint(q)).max() < 1e-12
    assert np.abs(q - 0.3).max() < 0.3 and not v.any()


def test_a_beam_bent_beyond_its_theory_ends_the_simulation(tmp_path: Path) -> None:
    boom = sf.Beam("boom", sf.Joint("clamp", "fixed"), length=1.0, rhoA=1.0, EI_z="EI", bend_y=3)
    system = sf.System("falling", [boom], [sf.Parameter("EI", 50.0)], gravity=(0, -9.81, 0))
    sf.export(system, "sfunction", tmp_path / "falling")
    compiled(tmp_path / "falling", "falling")
    words = ("./block", "falling", "direct_dynamics", "0.5", "1e-3")
    assert len(ports(run("env", "BLOCK_PARAMETERS=50", *words, cwd=tmp_path))) == 3
    with pytest.raises(AssertionError, match="a beam bends beyond its theory"):
        run("env", "BLOCK_PARAMETERS=1", *words, cwd=tmp_path)


def test_kinematics_without_frames_are_refused(tmp_path: Path) -> None:
    sf.export(system_of("four_bar"), "sfunction", tmp_path / "four_bar", start=STARTS["four_bar"], frames=[])
    compiled(tmp_path / "four_bar", "four_bar")
    with pytest.raises(AssertionError, match="exported with frames=.."):
        run("./block", "four_bar", "kinematics", "0", "1", *["0"] * 6, cwd=tmp_path)
