"""Starts, guesses and states whose quaternions are off unit length: motions and analyses are those of the rotation."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.diagrams.parts import moving
from tests.interop.turning import SYSTEMS
from tests.runtime.test_unit_quaternions import with_length
from tests.simulation.mechanisms import turned

Array = np.ndarray
CLOSE = 1e-12


@cache
def model(name: str) -> sf.Model:
    return sf.compile(SYSTEMS[name]())


MOTIONS: dict[str, Callable[[sf.Model, Array, Array], Any]] = {
    "simulate": lambda m, q, v: recorded(sf.simulate(m, q, v, 0.02, dt=5e-3)),
    "simulate, adaptive": lambda m, q, v: recorded(sf.simulate(m, q, v, 0.02, method="dopri5")),
    # The lengths of its steps follow rounding.
    "simulate, implicit": lambda m, q, v: recorded(sf.simulate(m, q, v, 0.02, method="rodas4"), first=True),
    "simulate_batch": lambda m, q, v: sf.simulate_batch(m, np.stack([q, q]), v, 0.02, dt=5e-3, output=5e-3).q,
    "rollout": lambda m, q, v: sf.rollout(m, q, v, np.ones((3, m.nu)), 5e-3).q,
    "assemble": lambda m, q, v: sf.assemble(m, q, v).q,
    "state_space": lambda m, q, v: sf.state_space(m, q, v).A,
    # Sums of powers: of three times the same mode each is a root of rounding.
    "modes": lambda m, q, v: np.array([np.sum(sf.modes(m, q, v).eigenvalues ** k).real for k in (1, 2)]),
    "actuator_efforts": lambda m, q, v: sf.actuator_efforts(m, q, v, v, m.names.v).efforts,
    "inverse_kinematics": lambda m, q, v: sf.inverse_kinematics(m, {"toe": sf.Target((0.1, 0.2, -0.5))}, q).q,
    "rest": lambda m, q, v: sf.inverse_kinematics(m, {"toe": sf.Target((0.1, 0.2, -0.5))}, rest=q, starts=1).q,
}


def recorded(run: sf.Trajectory, first: bool = False) -> Array:
    """States, accelerations and energies of a run, or the first of them."""
    return np.concatenate([np.ravel(x[:1] if first else x) for x in (run.q, run.v, run.a, run.energy)])


@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("entry", MOTIONS)
def test_motions_and_analyses_depend_on_the_direction_of_quaternions_only(name: str, entry: str) -> None:
    m, call = model(name), MOTIONS[entry]
    q, v = m.random_state(np.random.default_rng(3))
    expected = call(m, q, v)
    for length in (1.0 + 1e-12, 1.0 - 9e-4):
        found = call(m, with_length(m, q, length), v)
        assert np.abs(found - expected).max() <= CLOSE * np.abs(expected).max(), length
    for length in (1.1, 0.0, 1e200):
        with pytest.raises(sf.ShapeError, match="holds a quaternion that is no rotation"):
            call(m, with_length(m, q, length), v)


@pytest.mark.parametrize("length", [1.0, 1.0 + 1e-6, 1.0 - 9e-4, 1.1, 0.0])
def test_rests_are_found_from_guesses_near_unit_length(length: float) -> None:
    body = sf.RigidBody("b", sf.Joint("j", "ball"), sf.Inertia(2.0, (0.1, 0.2, -0.4), (0.2, 0.3, 0.4)))
    m = sf.compile(sf.System("hanging", [body], gravity=(0.0, 0.0, -9.81)))
    guess = with_length(m, m.integrate(m.neutral(), np.array([0.3, 0.2, 0.1])), length)
    if abs(length - 1.0) < 1e-3:
        rest = sf.equilibrium(m, guess)
        assert rest.q @ rest.q == pytest.approx(1.0, abs=1e-14)
        assert m.bias(rest.q, np.zeros(3)) == pytest.approx(np.zeros(3), abs=1e-9)
    else:
        with pytest.raises(sf.ShapeError, match="no rotation"):
            sf.equilibrium(m, guess)


def test_starts_of_exports_are_rotations(tmp_path: Path) -> None:
    m = model("swing")
    q, _ = m.random_state(np.random.default_rng(3))
    for length in (1.0 - 9e-4, 1.1):
        start = dict(zip(m.names.q, with_length(m, q, length).tolist(), strict=True))
        if length < 1.0:
            sf.export(SYSTEMS["swing"](), "c", tmp_path / "c", start=start)
            text = "".join(file.read_text() for file in (tmp_path / "c").glob("*.c"))
            (numbers,) = re.findall(r"swing_q_start\[\] = \{(.*?)\}", text)
            assert np.array(numbers.split(","), dtype=np.float64) == pytest.approx(q, abs=1e-14)
        else:
            with pytest.raises(sf.ShapeError, match="the start holds a quaternion that is no rotation"):
                sf.export(SYSTEMS["swing"](), "c", tmp_path / "d", start=start)


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("name", SYSTEMS)
def test_starts_of_diagrams_are_rotations(name: str, compiled: bool) -> None:
    m = model(name)
    q, _ = m.random_state(np.random.default_rng(3))

    def run(length: float) -> Array:
        start = dict(zip(m.names.q, with_length(m, q, length).tolist(), strict=True))
        simulation = sf.Simulation(moving(SYSTEMS[name](), start))
        result = (simulation.run if compiled else simulation.interpret)(0.01, dt=5e-3, record=5e-3)
        return np.asarray(result["plant.q"])

    expected = run(1.0)
    for length in (1.0 + 1e-12, 1.0 + 1e-6, 1.0 - 9e-4):
        assert np.abs(run(length) - expected).max() <= CLOSE
    for length in (1.1, 0.0):
        with pytest.raises(sf.SymofrosError, match="the start holds a quaternion that is no rotation"):
            run(length)


PARTS = [0.5, -0.1, 0.7, 0.5]  # Of unit length.
RUNS: dict[str, Callable[[sf.Model, list[str], float], Array]] = {
    "numbers": lambda m, names, length: recorded(
        sf.simulate(m, [0.1], [0.2], 0.1, u={n: length * x for n, x in zip(names, PARTS, strict=True)}, dt=0.02)
    ),
    "a function": lambda m, names, length: recorded(
        sf.simulate(m, [0.1], [0.2], 0.1, u=lambda t, q, v: stated_inputs(m, names, length), dt=0.02)
    ),
    "a batch": lambda m, names, length: (
        sf.simulate_batch(m, np.full((3, 1), 0.1), [0.2], 0.1, u=stated_inputs(m, names, length), dt=0.02).v_last
    ),
    "rollout": lambda m, names, length: (
        sf.rollout(m, [0.1], [0.2], np.tile(stated_inputs(m, names, length), (5, 1)), 0.02).v
    ),
}


def stated_inputs(m: sf.Model, names: list[str], length: float) -> Array:
    u = np.array(m.record.u_default)
    u[[m.names.u.index(n) for n in names]] = length * np.array(PARTS)
    return u


@pytest.mark.parametrize("way", RUNS)
def test_prescribed_rotations_of_few_digits_are_rotations_in_runs(way: str) -> None:
    m = sf.compile(turned())
    (first,) = m.record.quaternion_inputs
    names = list(m.names.u[first : first + 4])
    expected = RUNS[way](m, names, 1.0)
    for length in (1.0 + 1e-12, 1.0 + 1e-6, 1.0 - 9e-4):
        assert np.abs(RUNS[way](m, names, length) - expected).max() <= CLOSE * np.abs(expected).max()
