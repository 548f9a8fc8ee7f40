"""Stated starts of loops: what is stated is kept, and what can't be is said with its size."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from reference_models.closed.spatial import delta_guess
from symofros.simulation.analysis.kinematics.starts import ClosedStart, _holding, closed_start, stated_names

FUNCTIONS = ("constraint", "constraint_rate", "constraint_jacobian", "frame_pose")
GUESSES = {"four_bar": [1.2, -1.0, 1.3], "slider_crank": [0.5, -0.7, 0.4], "delta": delta_guess()}


@cache
def model(name: str) -> sf.Model:
    return sf.compile(MODELS[name], sf.Options(FUNCTIONS))


def start(m: sf.Model, guess: list[float] | None = None, **stated: float) -> ClosedStart:
    """The start from a guess (the neutral configuration), with some values by name, speeds with a d before."""
    q, v = np.array(m.neutral() if guess is None else guess, dtype=float), np.zeros(m.nv)
    coordinates, speeds = stated_names(m.names.q, m.names.v, stated)
    for name in coordinates:
        q[m.names.q.index(name)] = stated[name]
    for name in speeds:
        v[m.names.v.index(name)] = stated.get(f"d{name}", stated.get(name, 0.0))
    return closed_start(m, q, v, coordinates, speeds)


def test_stated_start_values_are_kept() -> None:
    m = model("four_bar")
    found = start(m, q1=1.0, dq1=1.0)
    assert found.q[0] == 1.0 and found.v[0] == 1.0 and not found.notes
    assert np.abs(m.constraint(found.q)).max() < 1e-12
    assert np.abs(m.constraint_rate(found.q, found.v)).max() < 1e-12


@pytest.mark.parametrize("name", GUESSES)
def test_stated_coordinates_and_speeds_are_kept_where_possible(name: str, rng: np.random.Generator) -> None:
    """One coordinate near a closed posture and the speed of another one, drawn."""
    m = model(name)
    closed = sf.assemble(m, GUESSES[name]).q
    for _ in range(6):
        i, j = rng.integers(0, m.nv, size=2)
        asked = {m.names.q[i]: closed[i] + rng.uniform(-0.02, 0.02), f"d{m.names.v[j]}": rng.normal()}
        try:
            found = start(m, list(closed), **asked)
        except sf.AssemblyError as error:  # Such as a passive joint of a spatial loop that hardly turns.
            assert "off" in str(error)
            continue
        assert found.q[i] == pytest.approx(asked[m.names.q[i]], abs=1e-6) and not found.notes
        assert found.v[j] == pytest.approx(asked[f"d{m.names.v[j]}"], abs=1e-6)


def test_values_that_cannot_be_kept_are_refused_with_nearby_ones() -> None:
    """With the size of the change; the numbers that the refusal names are taken as they are."""
    m = model("four_bar")
    with pytest.raises(sf.AssemblyError, match=r"dq1 = 1 would be 0, 1 off; dq2 = 1 would be 0, 1 off"):
        start(m, q1=1.2, q2=-1.2, q3=1.2, dq1=1.0, dq2=1.0)
    with pytest.raises(
        sf.AssemblyError, match=r"q2 = -0\.5 would be -\S+, \S+ off(.|\n)*state what is near: q1 = "
    ) as refused:
        start(m, q1=1.0, q2=-0.5, q3=0.3)
    near = str(refused.value).partition("what is near: ")[2].splitlines()[0]
    stated = {name: float(value) for name, value in (part.split(" = ") for part in near.split(", "))}
    assert not start(m, **stated).notes


@pytest.mark.parametrize(
    ("stated", "held", "of_joints"),
    [
        (["x", "hip.qx"], ["x", "hip.wx", "hip.wy", "hip.wz"], ["x"]),
        (["base.py"], ["base.vx", "base.vy", "base.vz"], []),
        (["base.qw"], ["base.wx", "base.wy", "base.wz"], []),
        (["base.px", "base.qx"], ["base.vx", "base.vy", "base.vz", "base.wx", "base.wy", "base.wz"], []),
    ],
)
def test_rotations_and_places_are_held_as_wholes(stated: list[str], held: list[str], of_joints: list[str]) -> None:
    bodies = [
        sf.RigidBody("a", sf.Joint("base", "free"), sf.Inertia(1.0, (0, 0, 0), (1, 1, 1))),
        sf.RigidBody("b", sf.Joint("hip", "ball", "a"), sf.Inertia(1.0, (0, 0, 0), (1, 1, 1))),
        sf.RigidBody("c", sf.Joint("x", "prismatic", "b", axis=(1, 0, 0)), sf.Inertia(1.0)),
    ]
    m = sf.compile(sf.System("free", bodies), sf.Options(("mass_matrix",), backend="interpreter"))
    assert _holding(m, stated) == tuple(dict.fromkeys([tuple(held), tuple(of_joints)]))
