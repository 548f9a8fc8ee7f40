"""Singular postures on the way are found between the states that are looked at, however many loops there are."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

import symofros as sf
from reference_models.closed.four_bars import n_four_bar
from symofros import blocks
from symofros.simulation.analysis.kinematics import postures
from symofros.simulation.analysis.kinematics.postures import MAX_CHANGE, jump_ahead, nearest_to_singular
from tests.diagrams.parts import moving
from tests.simulation.mechanisms import loop, slide


@pytest.fixture(scope="module")
def row() -> sf.Model:
    return sf.compile(n_four_bar(24), sf.Options(functions=("constraint_jacobian",)))


def swept(m: sf.Model, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    signs = np.array([-1.0 if name.startswith("coupler") or name == "q2" else 1.0 for name in m.names.q])
    return np.linspace(0.0, 1.0, len(angles)), angles[:, None] * signs


def recorded(m: sf.Model, t: np.ndarray, q: np.ndarray) -> list[np.ndarray]:
    return [t, q, np.zeros((len(t), m.nv)), np.zeros((len(t), m.nu))]


def nothing_between(first: int, last: int) -> None:
    return None


def test_the_weakest_of_many_states_is_found(row: sf.Model) -> None:
    """A dip of a hundredth of the run, that lies between any ninety states spread over it."""
    lowest = 0.004
    t = np.linspace(0.0, 1.0, 4001)
    angles = 1.0 - (1.0 - lowest) * np.exp(-(((t - 0.4567) / 0.02) ** 2))
    times, q = swept(row, angles)
    close = nearest_to_singular(row, recorded(row, times, q), row.parameter_values, row.nc, nothing_between)
    assert close is not None
    when, share = close
    assert when == pytest.approx(0.4567, abs=1e-3)
    assert share == pytest.approx(np.sin(lowest), rel=0.5)


@pytest.mark.parametrize(("lowest", "is_near"), [(0.9, False), (0.3, False), (0.03, True), (0.02, True)])
def test_few_singular_values_stand_for_many_states_only_where_they_prove_it(
    row: sf.Model, lowest: float, is_near: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A short run of many loops, by the proof and without it."""
    times, q = swept(row, np.concatenate([np.linspace(1.0, lowest, 9), np.linspace(lowest, 1.0, 9)[1:]]))
    at = row, recorded(row, times, q), row.parameter_values, row.nc, nothing_between
    close = nearest_to_singular(*at)
    monkeypatch.setattr(postures, "MANY", 10**6)
    assert close == nearest_to_singular(*at)
    assert (close is not None) == is_near


def test_the_proof_bounds_what_it_does_not_evaluate() -> None:
    """Conditions of one speed each, the weakest of which dips at one state between others."""
    strengths = np.ones((9, 20))
    assert postures._stay_regular(strengths[:, :, None] * np.eye(20), 20)
    strengths[5, 3] = 0.04
    assert not postures._stay_regular(strengths[:, :, None] * np.eye(20), 20)
    strengths[5, 3] = 0.06
    assert postures._stay_regular(strengths[:, :, None] * np.eye(20), 20)
    strengths[:, 7] = 0.0
    assert postures._stay_regular(strengths[:, :, None] * np.eye(20), 19), "a condition that repeats others"
    assert not postures._stay_regular(np.full((3, 20, 20), np.nan), 20)


def parallelogram(size: float) -> sf.Model:
    """Four bars of one length [m], which all lie along the ground where the cranks' angle is zero."""
    options = sf.Options(functions=("constraint_jacobian",), backend="interpreter")
    return sf.compile(loop((size, size, size), size, inertia=lambda _: sf.Inertia(1.0)), options)


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_near_singular_postures_between_records_are_found_in_any_unit_of_length(size: float) -> None:
    """The motion is asked for where the straight way comes near; it turns back there."""
    m, lowest = parallelogram(size), 0.02
    times, q = swept(m, np.array([1.0, -0.98]))

    def along(first: int, last: int) -> list[np.ndarray]:
        angles = np.concatenate([np.linspace(1.0, lowest, 60), np.linspace(lowest, 0.5, 60)])
        return recorded(m, *swept(m, angles))

    close = nearest_to_singular(m, recorded(m, times, q), m.parameter_values, m.nc, along)
    assert close is not None and close[1] == pytest.approx(np.sin(lowest), rel=0.7)
    assert nearest_to_singular(m, recorded(m, times, q), m.parameter_values, m.nc, nothing_between) is None
    stands = nearest_to_singular(
        m, recorded(m, times, q), m.parameter_values, m.nc, lambda first, last: [x[:0] for x in along(first, last)]
    )
    assert stands is not None and stands[1] < 0.05, "where short steps can't follow, the straight way counts"


def test_a_run_that_ends_near_a_singular_posture_is_found(row: sf.Model) -> None:
    m = parallelogram(1.0)
    times, q = swept(m, np.array([1.0, 0.5, 0.02]))
    close = nearest_to_singular(m, recorded(m, times, q), m.parameter_values, m.nc, nothing_between)
    assert close is not None and close == pytest.approx((1.0, np.sin(0.02)), rel=0.7)


@pytest.mark.parametrize("speed", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("way", [-2.0, -0.5, 0.5, 2.0])
def test_a_row_that_jumps_is_found_as_far_ahead_at_any_speed(speed: float, way: float) -> None:
    """Or behind; beyond MAX_CHANGE of the coordinate nothing is looked at."""
    place = way * MAX_CHANGE

    def jacobian(q: np.ndarray, **_: Any) -> np.ndarray:
        return np.stack([np.where(q < place, 1.0, -1.0)[..., None], np.ones((*q.shape, 1))], axis=-2)[..., 0, :, :]

    fake = SimpleNamespace(
        integrate=lambda q, dq: q + dq, constraint_jacobian=jacobian, names=SimpleNamespace(constraints=("edge", "pin"))
    )
    fake.with_precision = lambda _: fake
    none: Any = np.zeros(0)
    found = jump_ahead(cast(Any, fake), 0.0, np.zeros(1), np.array([speed]), none, none)
    assert (found is not None) == (abs(way) < 1.0)
    assert found is None or found[:2] == ("edge", pytest.approx(2.0))


A, B, SPEED = 0.3, 1.0, 20.0


@pytest.fixture(scope="module")
def driven_crank() -> sf.Model:
    """A crank whose angle is prescribed, a rod and a slide: det G = B cos(angle of the rod), 1 to 0.954."""
    crank = sf.Joint("q1", "revolute", axis=(0, -1, 0), prescribed=True)
    link = sf.Joint("q2", "revolute", "crank", "e", axis=(0, -1, 0))
    bodies = (
        sf.RigidBody("crank", crank, sf.Inertia(1, (A / 2, 0, 0), (0, 0.01, 0.01)), (sf.Frame("e", (A, 0, 0)),)),
        sf.RigidBody("rod", link, sf.Inertia(1, (B / 2, 0, 0), (0, 0.08, 0.08)), (sf.Frame("e", (B, 0, 0)),)),
        sf.RigidBody("slide", sf.Joint("x", "prismatic", axis=(1, 0, 0)), sf.Inertia(2, (0, 0, 0), (1, 1, 1))),
    )
    pin = sf.Closure("pin", ("slide", None), ("rod", "e"), ("x", "z"))
    return sf.compile(sf.System("driven_crank", bodies, constraints=(pin,)))


@pytest.mark.parametrize("options", [{"method": "dop853"}, {"dt": 0.01}])
def test_records_radians_apart_cause_no_note_of_a_singular_posture(driven_crank: sf.Model, options: dict) -> None:
    """Records are radians apart, and the driven crank moves between them as well."""
    start = sf.assemble(driven_crank, {"q2": 0.0, "x": A + B}, u=[0.0, SPEED, 0.0])
    run = sf.simulate(driven_crank, start.q, start.v, 20.0, u={"q1": f"{SPEED}*t"}, output=0.01, **options)
    exact = A * np.cos(SPEED * run.t) + np.sqrt(B * B - (A * np.sin(SPEED * run.t)) ** 2)
    assert np.abs(run["x"] - exact).max() < 1e-9 and not run.outcome.notes, run.outcome


def falling(*limits: float) -> sf.System:
    """A mass that falls along z, between limits."""
    return slide(name="s", axis=(0, 0, 1), limits=sf.Limits(*limits), gravity=(0, 0, -9.81))


@pytest.mark.parametrize(("t_end", "left"), [(0.1, False), (0.2, True)])
def test_exceeded_joint_limits_are_reported_with_time_and_amount(t_end: float, left: bool) -> None:
    # It falls through 0.1 m in 0.1428 s.
    system = falling(-0.1, 0.15)
    m = sf.compile(system)
    alone = sf.simulate(m, t_end=t_end).outcome
    batch = sf.simulate_batch(m, np.zeros((2, 1)), t_end=t_end, output=1e-3).outcome(1)
    diagram = sf.Simulation(moving(system))
    drawn = diagram.run(t_end, dt=1e-3, record=1e-3).outcome
    interpreted = diagram.interpret(t_end, dt=1e-3, record=1e-3).outcome
    for outcome in (alone, batch, drawn, interpreted):
        said = [note for note in outcome.notes if "leaves its limits" in note]
        assert len(said) == left
        assert not left or "-0.1 to 0.15, at t = 0.143 s, by up to 0.096" in said[0]


def driven(**limits: float) -> sf.System:
    """A mass of 1 kg on a slide without gravity, driven by a force."""
    return slide(name="s", axis=(0, 0, 1), actuated=True, limits=sf.Limits(**limits))


@pytest.mark.parametrize(
    ("limits", "said"),
    [
        ({"effort": 5.0}, "the effort of 's' exceeds its limits, -5 to 5, at t = 0.5"),
        ({"velocity": 1.0}, "the speed of 's' exceeds its limits, -1 to 1, at t = 0.4"),
        ({"effort": 10.0, "velocity": 5.0}, ""),
        ({"effort": 0.0, "velocity": 0.0}, ""),  # As files of kinematics alone state it.
        ({}, ""),
    ],
)
def test_exceeded_speed_and_effort_limits_are_reported(limits: dict[str, float], said: str) -> None:
    """A force of 10 t N: it passes 5 N at 0.5 s and 1 m/s at 0.447 s, and ends at 10 N and 5 m/s."""
    m = sf.compile(driven(**limits))
    alone = sf.simulate(m, t_end=1.0, u={"s": "10*t"}, dt=1e-2, method="rk4").outcome
    batch = sf.simulate_batch(m, np.zeros((2, 1)), t_end=1.0, u={"s": "10*t"}, dt=1e-2, output=1e-2).outcome(1)
    for outcome in (alone, batch):
        reported = [note for note in outcome.notes if "exceeds its limits" in note]
        assert len(reported) == bool(said) and all(said in note for note in reported), reported


def test_speeds_in_diagrams_are_held_against_limits() -> None:
    diagram = moving(driven(velocity=1.0, effort=1.0), u="force.y")
    diagram.add(blocks.Constant(name="force", value=[5.0]))
    for run in (sf.Simulation(diagram).run, sf.Simulation(diagram).interpret):
        notes = run(1.0, dt=1e-2, record=1e-2).outcome.notes
        assert ["the speed of" in note for note in notes if "exceeds" in note] == [True]
