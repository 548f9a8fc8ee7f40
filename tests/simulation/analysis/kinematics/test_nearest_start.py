"""What is stated of a start and can't be kept: the nearest closed state is found, and it is what is reported."""

from __future__ import annotations

import re
from functools import cache

import numpy as np
import pytest

import symofros as sf
from symofros.simulation.analysis.kinematics.assembly import shift_scales
from symofros.simulation.analysis.kinematics.nearest_start import Instant, _Distance, _with_one_released
from symofros.simulation.analysis.kinematics.starts import ClosedStart, closed_start

FUNCTIONS = ("constraint", "constraint_rate", "constraint_jacobian", "frame_pose")
CHANGE = re.compile(r"(\w+) = (\S+) would be ([^\s,]+), ")
# Lengths of the links and of the ground: a parallelogram, and a crank and rocker.
LOOPS = {"parallelogram": ((1.0, 1.0, 1.0), 1.0), "rocker": ((0.4, 1.0, 0.8), 0.9)}


@cache
def four_bar(name: str) -> sf.Model:
    lengths, ground = LOOPS[name]
    bodies = [sf.RigidBody("base", frames=(sf.Frame("end", (ground, 0, 0)),))]
    reach = 0.0
    for k, length in enumerate(lengths):
        joint = sf.Joint(f"q{k}", "revolute", bodies[-1].name, position=(reach, 0, 0))
        inertia = sf.Inertia(1.0, (length / 2, 0, 0), (0.01, 0.1, 0.1))
        bodies.append(sf.RigidBody(f"b{k}", joint, inertia, (sf.Frame("end", (length, 0, 0)),)))
        reach = length
    shut = sf.Closure("shut", ("base", "end"), (bodies[-1].name, "end"), ("x", "y"))
    system = sf.System("loop", tuple(bodies), constraints=(shut,))
    return sf.compile(system, sf.Options(FUNCTIONS))


def reported(m: sf.Model, q: np.ndarray, v: np.ndarray, names: list[str], rates: list[str]) -> dict[str, float]:
    """What the stated values become: in the state that is found, or in the refusal."""
    try:
        found = closed_start(m, q, v, names, rates)
    except sf.AssemblyError as error:
        said = CHANGE.findall(str(error))
        assert said, str(error)
        return {name: float(new) - float(old) for name, old, new in said}
    changed = {name: float((found.q - q)[m.names.q.index(name)]) for name in names}
    return changed | {f"d{name}": float((found.v - v)[m.names.v.index(name)]) for name in rates}


def along(m: sf.Model, q: np.ndarray, step: float, count: int) -> list[np.ndarray]:
    """Closed postures along the only motion of a loop, to either side."""
    postures = [q]
    for sign in (1.0, -1.0):
        at, motion = q, sign * np.linalg.svd(m.constraint_jacobian(q))[2][-1]
        for _ in range(count):
            on = sf.assemble(m, at + step * motion).q
            motion, at = (on - at) / np.linalg.norm(on - at), on
            postures.append(at)
    return postures


@pytest.mark.parametrize("name", LOOPS)
@pytest.mark.parametrize("stated", [[0, 2], [1, 2], [0, 1, 2]])
def test_no_closed_posture_is_nearer(name: str, stated: list[int], rng: np.random.Generator) -> None:
    """Nearly closed starts, drawn, on either branch; what is not stated is neutral."""
    m = four_bar(name)
    for _ in range(2):
        turn, side = rng.uniform(0.5, 1.5), rng.choice([-1.0, 1.0])
        closed = sf.assemble(m, [side * turn, -side * turn, -side * (np.pi - turn)], held=["q0"]).q
        asked = np.zeros(3)
        asked[stated] = closed[stated] + rng.uniform(-0.03, 0.03, len(stated))
        changed = reported(m, asked, np.zeros(3), [m.names.q[k] for k in stated], [])
        distances = [np.linalg.norm((q - asked)[stated]) for q in along(m, closed, 0.008, 15)]
        assert np.linalg.norm(list(changed.values())) <= 1.1 * min(distances) + 1e-6


@pytest.mark.parametrize("reach", [0.25, 4.0])
def test_slide_speeds_are_weighted_by_the_reach_of_turning_bodies(reach: float, rng: np.random.Generator) -> None:
    """A crank and slider: a metre a second is as much as 1/reach radians a second."""
    crank = sf.Joint("q0", "revolute")
    rod = sf.Joint("q1", "revolute", "crank", "end")
    slide = sf.Joint("x", "prismatic", axis=(1, 0, 0))
    bodies = (
        sf.RigidBody("crank", crank, sf.Inertia(1.0), (sf.Frame("end", (0.5 * reach, 0, 0)),)),
        sf.RigidBody("rod", rod, sf.Inertia(1.0), (sf.Frame("end", (reach, 0, 0)),)),
        sf.RigidBody("slider", slide, sf.Inertia(1.0)),
    )
    shut = sf.Closure("shut", ("slider", None), ("rod", "end"), ("x", "y"))
    m = sf.compile(sf.System("press", bodies, constraints=(shut,)), sf.Options(FUNCTIONS, backend="interpreter"))
    closed = sf.assemble(m, [1.0, -1.4, reach]).q
    G = m.constraint_jacobian(closed)
    motion, rows = np.linalg.svd(G)[2][-1], [0, 2]
    weights = 1.0 / shift_scales(m, G)[rows]
    assert weights[0] == 1.0 and 0.5 / reach < weights[1] < 2.0 / reach
    for _ in range(5):
        v = rng.normal(size=3)
        changed = reported(m, closed, v, [], ["q0", "x"])
        along, wished = weights * motion[rows], weights * v[rows]
        nearest = np.linalg.norm(wished - along * (along @ wished) / (along @ along))
        assert np.linalg.norm(weights * [changed["dq0"], changed["dx"]]) == pytest.approx(nearest, rel=1e-3)


def start(**stated: float) -> ClosedStart:
    m = four_bar("parallelogram")
    q = np.array([stated.get(name, 0.0) for name in m.names.q])
    return closed_start(m, q, np.zeros(3), list(stated), [])


def test_digits_that_were_not_typed_are_found_on_the_branch_that_is_stated() -> None:
    """A third of a turn to six digits and to five, the third joint not stated."""
    found = start(q0=1.0472, q1=-1.047)
    assert found.q[:2] == pytest.approx([1.0472, -1.047], abs=3e-4)
    assert "start: q0 = 1.0472 was taken as 1.0471, which meets the constraints" in found.notes


@pytest.mark.parametrize("name", LOOPS)
def test_postures_with_one_value_released_are_closed(name: str) -> None:
    """Those that can't be closed with the others held are left out; there are some that can."""
    m = four_bar(name)
    closed = sf.assemble(m, [1.0, -1.0, -2.0], held=["q0"]).q
    asked = closed + np.array([0.0, 0.0, 1.5])
    distance = _Distance(Instant(m), asked, [0, 1, 2], np.ones(3))
    found = list(_with_one_released(distance, asked, ["q0", "q1", "q2"]))
    assert found and all(np.abs(m.constraint(q)).max() < 1e-9 for q in found)
    assert min(map(distance, found)) <= distance(closed) + 1e-9
