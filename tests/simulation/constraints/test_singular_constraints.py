"""Motions that lead where constraints have no direction end in words, or keep their energy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import symofros as sf
from tests.models import GUESSES
from tests.models import compiled as model

# Ways of stepping that must not fail in silence, with their options.
WAYS: tuple[tuple[str, dict[str, object]], ...] = (
    ("rk4", {"dt": 1e-3}),
    ("rk4", {"dt": 1e-3, "stabilisation": "none"}),
    ("rk4", {"dt": 1e-3, "stabilisation": "baumgarte"}),
    ("dopri5", {}),
    ("rodas4", {}),
    ("generalized_alpha", {"dt": 1e-3}),
)


def disc(tilt: float, spin: float, turn: float) -> tuple[np.ndarray, np.ndarray]:
    """A disc that rolls: its axle is the tilt away from the vertical; it spins about the axle, and turns."""
    m = model("rolling_disc")
    q = np.array([0, 0, np.sin(tilt), np.sin(tilt / 2), 0, 0, np.cos(tilt / 2)])
    wish = np.array([0, 0, 0, 0, turn * np.sin(tilt), turn * np.cos(tilt) + spin])
    at = sf.assemble(m, q, wish, held=("body.wx", "body.wy", "body.wz"))
    return at.q, at.v


def change_of_energy(run: sf.Trajectory) -> float:
    return float(np.abs(run.energy - run.energy[0]).max() / max(run.kinetic_energy.max(), 1e-300))


@pytest.mark.parametrize("method, options", WAYS, ids=[f"{m} {o.get('stabilisation', '')}" for m, o in WAYS])
def test_a_disc_that_falls_flat_ends_with_its_contact_named(method: str, options: dict[str, object]) -> None:
    q, v = disc(0.5, 0.0, 0.0)
    run = sf.simulate(model("rolling_disc"), q, v, t_end=1.0, method=method, max_steps=20_000, **options)  # type: ignore[arg-type]
    assert not run.outcome.ok and "contact" in run.outcome.reason
    assert 0.3 < run.outcome.t < 0.5, str(run.outcome)


def test_a_disc_falling_flat_in_a_batch_ends_as_singular() -> None:
    q, v = disc(0.5, 0.0, 0.0)
    runs = sf.simulate_batch(model("rolling_disc"), np.array([q, q]), v, t_end=1.0, dt=1e-3)
    assert not runs.ok.any() and runs.outcome(0).kind == "singular"


@settings(max_examples=12)
@example(tilt=0.5, spin=0.01, turn=0.0, way=0)
@example(tilt=1.2, spin=0.1, turn=0.0, way=3)
@example(tilt=0.5, spin=0.0, turn=1.0, way=0)
@example(tilt=0.5, spin=0.0, turn=1.5, way=5)
@example(tilt=0.25, spin=0.25, turn=0.0, way=1)
@given(
    tilt=st.floats(0.15, 1.4), spin=st.floats(-3.0, 3.0), turn=st.floats(-2.0, 2.0), way=st.integers(0, len(WAYS) - 1)
)
def test_a_rolling_disc_keeps_its_energy_or_gets_a_note(tilt: float, spin: float, turn: float, way: int) -> None:
    q, v = disc(tilt, spin, turn)
    method, options = WAYS[way]
    run = sf.simulate(model("rolling_disc"), q, v, t_end=1.0, method=method, max_steps=5000, **options)  # type: ignore[arg-type]
    said = ("energy changes by", "steps of")  # The second: of steps that half of them contradicts.
    noted = any(note.startswith(said) for note in run.outcome.notes)
    assert noted or not run.outcome.ok or change_of_energy(run) < 0.1, str(run.outcome)


@pytest.mark.parametrize("name", ["four_bar", "parallelogram", "slider_crank", "delta", "rolling_disc"])
@pytest.mark.parametrize("method, options", [WAYS[0], WAYS[3]], ids=["rk4", "dopri5"])
def test_motions_through_postures_near_singular_ones_go_on(name: str, method: str, options: dict[str, object]) -> None:
    m = model(name)
    at = sf.assemble(m, GUESSES[name], np.random.default_rng(0).normal(size=m.nv))
    run = sf.simulate(m, at.q, at.v, t_end=2.0, method=method, **options)  # type: ignore[arg-type]
    assert run.outcome.kind == "finished" and change_of_energy(run) < 1e-4


def test_a_condition_on_speeds_that_vanishes_in_one_posture_takes_no_energy_in_silence() -> None:
    """x x' = 0 leaves x' free at x = 0 alone: what moves there is stopped a step later."""
    slide = sf.RigidBody("b", sf.Joint("x", "prismatic", axis=(1, 0, 0)), sf.Inertia(1.0))
    other = sf.RigidBody("c", sf.Joint("y", "prismatic", axis=(1, 0, 0)), sf.Inertia(1.0))
    stop = sf.Nonholonomic("stop", {"dx": "x"})
    m = sf.compile(sf.System("s", (slide, other), constraints=(stop,)))
    run = sf.simulate(m, [0.0, 0.0], [1.0, 0.5], t_end=0.1, dt=1e-3)
    assert not run.outcome.ok and run.outcome.kind == "constraints lost"


def test_speed_jumps_from_prescribed_motion_are_not_faults_of_the_run() -> None:
    slide = sf.RigidBody("cart", sf.Joint("x", "prismatic", axis=(1, 0, 0)), sf.Inertia(1.0))
    lead = sf.RigidBody("lead", sf.Joint("s", "prismatic", axis=(1, 0, 0), prescribed=True), sf.Inertia(1.0))
    tied = sf.Closure("tied", ("lead", None), ("cart", None), ("x",))
    m = sf.compile(sf.System("s", (slide, lead), constraints=(tied,)))

    def law(t, q, v):  # type: ignore[no-untyped-def]
        return [0.0, 0.0, 0.0] if t < 0.05 else [t - 0.05, 1.0, 0.0]

    run = sf.simulate(m, [0.0], [0.0], t_end=0.1, dt=1e-3, u=law)
    assert run.outcome.kind == "finished", str(run.outcome)


@pytest.mark.parametrize("method", ["dopri5", "rodas4"])
def test_a_singular_posture_of_a_rejected_step_is_none_of_the_motion(method: str) -> None:
    """A wall turns back what glides, before the condition would have no direction; steps that are tried go on there."""
    x = sf.RigidBody("x", sf.Joint("x", "prismatic", axis=(1, 0, 0), actuated=True), sf.Inertia(1.0))
    y = sf.RigidBody("y", sf.Joint("y", "prismatic", axis=(0, 1, 0)), sf.Inertia(1.0))
    line = sf.Coupling("line", "max(0, 2 - x)*y")
    glides = sf.compile(sf.System("wall", (x, y), gravity=(0, 0, 0), constraints=(line,)))
    run = sf.simulate(glides, [0, 0], [1, 0], 8.0, u={"x": "-1000*max(0, x - 1.5)"}, method=method)  # type: ignore[arg-type]
    assert run.statistics.rejected > 0 and run.q[:, 0].max() < 1.6
    assert run.statistics.rank_min == 1 and not run.outcome.notes
