"""A weld half a turn off fulfils its conditions, too: whatever takes a posture refuses it."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.runtime.calls.kernel import Array


@cache
def welded(backend: str = "c") -> sf.Model:
    """Two free bodies that a closure of six conditions holds together."""
    inertia = sf.Inertia(2.0, (0, 0, 0), (0.3, 0.4, 0.5)), sf.Inertia(1.0, (0, 0, 0), (0.1, 0.2, 0.25))
    bodies = tuple(sf.RigidBody(n, sf.Joint(n, "free"), m) for n, m in zip("ab", inertia, strict=True))
    weld = sf.Closure("weld", ("a", None), ("b", None), ("x", "y", "z"), ("x", "y", "z"))
    system = sf.System("welded", bodies, constraints=(weld,), gravity=(0, 0, 0))
    return sf.compile(system, sf.Options(backend=backend))


@cache
def hinged() -> sf.Model:
    """The same by a hinge: the axes that stay parallel are the third ones of two blocked rotations."""
    mass = sf.Inertia(1.0, (0.1, 0, 0), (0.1, 0.2, 0.25))
    bodies = tuple(sf.RigidBody(n, sf.Joint(n, "free"), mass) for n in "ab")
    hinge = sf.Closure("hinge", ("a", None), ("b", None), ("x", "y", "z"), ("x", "y"))
    return sf.compile(sf.System("hinged", bodies, constraints=(hinge,)))


def half_turn(axis: Array) -> Array:
    """Body a anywhere, b half a turn about an axis of a from it."""
    q = np.zeros(14)
    q[6], q[10:13] = 1.0, axis / np.linalg.norm(axis)
    return q


ENTRIES: dict[str, Callable[[sf.Model, Array], Any]] = {
    "simulate": lambda model, q: sf.simulate(model, q, t_end=0.01),
    "baumgarte": lambda model, q: sf.simulate(model, q, t_end=0.01, stabilisation="baumgarte"),
    "assemble": sf.assemble,
    "equilibrium": sf.equilibrium,
    "modes": sf.modes,
    "state_space": sf.state_space,
    "actuator_efforts": lambda model, q: sf.actuator_efforts(model, q, np.zeros(12), np.zeros(12), actuators=["a.vx"]),
}


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("entry", ENTRIES)
def test_every_entry_refuses_a_weld_half_a_turn_off(entry: str, seed: int) -> None:
    """About any axis, exactly and with noise."""
    rng = np.random.default_rng(seed)
    q = half_turn(rng.normal(size=3))
    assert np.abs(welded().constraint(q)).max() < 1e-12  # That is why phi alone can't tell.
    with pytest.raises(sf.AssemblyError, match="'weld' is closed the wrong way round"):
        ENTRIES[entry](welded(), q)


def test_a_hinge_may_turn_and_may_not_face_the_other_way() -> None:
    """Half a turn about its own axis is a posture as good as any; one across it is not."""
    sf.simulate(hinged(), half_turn(np.array([0.0, 0.0, 1.0])), t_end=0.01)
    with pytest.raises(sf.AssemblyError, match="wrong way round"):
        sf.simulate(hinged(), half_turn(np.array([1.0, 0.5, 0.0])), t_end=0.01)


def test_wrongly_facing_members_of_a_batch_are_found() -> None:
    """One among others, as one that starts off the constraints otherwise."""
    good = np.zeros(14)
    good[[6, 13]] = 1.0
    q = np.array([good, half_turn(np.array([0.3, -0.2, 0.9]))])
    runs = sf.simulate_batch(welded(), q, t_end=0.01)
    assert "finished" in str(runs.outcome((0,)))
    assert "finished" not in str(runs.outcome((1,)))


@pytest.mark.parametrize("backend", ["c", "interpreter"])
def test_projection_reports_a_half_turn_residual(backend: str) -> None:
    """The residual of the function that packages and functional mock-up units step with, too."""
    model = welded(backend)
    rng = np.random.default_rng(1)
    for _ in range(5):
        _, _, residual = model.project(half_turn(rng.normal(size=3)), np.zeros(12))
        assert residual >= 1.0
    good = np.zeros(14)
    good[[6, 13]] = 1.0
    assert model.project(good, np.zeros(12))[2] == 0.0


def test_inverse_kinematics_of_many_targets_close_welds_the_right_way() -> None:
    """From guesses half a turn off, as one by one: a posture that is closed the wrong way round is not reached."""
    model, rng = welded(), np.random.default_rng(5)
    q = np.array([half_turn(rng.normal(size=3)) for _ in range(3)])
    p = rng.normal(size=(3, 3))
    many = sf.inverse_kinematics_batch(model, {"a": sf.Target(p)}, q)
    for i in range(3):
        one = sf.inverse_kinematics(model, {"a": sf.Target(p[i])}, q[i])
        assert bool(many.converged[i]) == one.converged
        np.testing.assert_allclose(many.q[i], one.q, atol=1e-9)
        if one.converged:
            assert model.project(many.q[i], np.zeros(12))[2] < 1e-6
