"""Scenes of contact: Newton's cradle, a part handed over, a bearing with clearance, a peg in a hole."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.models import bounds

BALLS = 5
LINK = sf.Inertia(1.0, (0.3, 0.02, 0.0), (0.01, 0.1, 0.11))


@cache
def cradle() -> sf.Model:
    """Five balls of 1 kg on a line, each touched by the next where their coordinates are equal."""
    bodies = [
        sf.RigidBody(f"ball{i}", sf.Joint(f"x{i}", "prismatic", axis=(1, 0, 0)), sf.Inertia(1.0)) for i in range(BALLS)
    ]
    pairs = range(BALLS - 1)
    return sf.compile(
        sf.System(
            "cradle",
            bodies,
            [sf.Parameter(f"s{i}", 0) for i in pairs],
            gravity=(0, 0, 0),
            constraints=[sf.Coupling(f"pair{i}", f"x{i + 1} - x{i}") for i in pairs],
            switches=[sf.Switch(f"pair{i}", sf.formula(f"s{i}")) for i in pairs],
        )
    )


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
@pytest.mark.parametrize("e", [1.0, 0.5])
def test_the_cradle_as_a_sequence_of_pairs_and_all_at_once(e: float, method: str) -> None:
    """In sequence speeds pass on, of each strike (1 + e)/2; at once all that touch rebound from their common speed."""
    start, thrown = -0.1 * np.eye(BALLS)[0] + 1e-3 * np.arange(BALLS), np.eye(BALLS)[0]
    pairs = {
        f"strike{i}": sf.Event(f"x{i + 1} - x{i}", "falling", action={f"s{i}": 1}, restitution=e)
        for i in range(BALLS - 1)
    }
    run = sf.simulate(cradle(), start, thrown, t_end=0.13, dt=0.01, method=method, events=pairs)
    met = [(found.name, found.t) for found in run.events[: BALLS - 1]]
    passed, time, known = 1.0, 0.101, []
    for i in range(BALLS - 1):
        known.append((f"strike{i}", time))
        passed *= (1 + e) / 2
        time += 1e-3 / passed
    assert [name for name, _ in met] == [name for name, _ in known]
    assert [t for _, t in met] == pytest.approx([t for _, t in known], abs=1e-12)
    assert run.v[-1, -1] == pytest.approx(passed, abs=1e-12) and run.v[-1].sum() == pytest.approx(1.0, abs=1e-12)
    if e == 1.0:
        assert run.v[-1] == pytest.approx(np.eye(BALLS)[-1], abs=1e-12)

    together = {"strike": sf.Event("x1 - x0", "falling", action={f"s{i}": 1 for i in range(BALLS - 1)}, restitution=e)}
    level = -0.1 * np.eye(BALLS)[0]
    once = sf.simulate(cradle(), level, thrown, t_end=0.13, dt=0.01, method=method, events=together)
    common = np.full(BALLS, 1 / BALLS)
    assert once.v[-1] == pytest.approx(common + e * (common - thrown), abs=1e-12)
    assert once.events[0].energy_lost == pytest.approx((1 - e**2) * 0.5 * (1 - 1 / BALLS), abs=1e-12)


@cache
def two_arms() -> sf.Model:
    """Two arms on a free base, and a free part with a handle for either; the first hands it over to the second."""
    end = sf.Frame("end", (0.6, 0, 0))
    shoulders = sf.Frame("left", (0.2, 0.1, 0)), sf.Frame("right", (0.2, -0.1, 0))
    bodies = [sf.RigidBody("base", sf.Joint("root", "free"), sf.Inertia(8.0, (0.1, 0, 0), (1, 2, 3)), shoulders)]
    for side in ("left", "right"):
        joints = (
            sf.Joint(f"{side}1", "revolute", "base", axis=(0, 0, 1), frame=side),
            sf.Joint(f"{side}2", "revolute", f"{side}_upper", axis=(0, 1, 0), frame="end"),
        )
        bodies += [
            sf.RigidBody(f"{side}_{part}", joint, LINK, (end,))
            for part, joint in zip(("upper", "fore"), joints, strict=True)
        ]
    handles = sf.Frame("one", (0, 0.1, 0)), sf.Frame("two", (0, -0.1, 0.05), sf.Rotation.rpy(0.2, 0.1, 0.4))
    bodies.append(sf.RigidBody("part", sf.Joint("f", "free"), sf.Inertia(2.0, (0.1, 0, 0), (0.3, 0.2, 0.25)), handles))
    grips = {"left": "one", "right": "two"}
    held = [
        sf.Closure(f"{side}_grip", (f"{side}_fore", "end"), ("part", handle), rotations=("x", "y", "z"))
        for side, handle in grips.items()
    ]
    switches = [sf.Switch(f"{side}_grip", sf.formula(side), "moment") for side in grips]
    parameters = [sf.Parameter(side, 0.0) for side in grips]
    system = sf.System("handover", bodies, parameters, gravity=(0, 0, 0), constraints=held, switches=switches)
    return sf.compile(system)


@pytest.mark.parametrize("method", ["dopri5", "rodas4"])
def test_a_part_is_handed_over_from_arm_to_arm(method: str) -> None:
    """Momentum of the free system stays over grasp, second grasp and release; each grasp loses Carnot's energy."""
    model = two_arms()
    q, v = model.random_state(np.random.default_rng(3))
    events = {
        "takes": sf.Event("t - 0.1", action={"left": 1}),
        "gives": sf.Event("t - 0.2", action={"right": 1}),
        "lets go": sf.Event("t - 0.3", action={"left": 0}),
    }
    run = sf.simulate(model, q, v, 0.4, events=events, method=method, dt=1e-3, **bounds(method, 1e-11, 1e-13))
    assert run.outcome.ok and [found.name for found in run.events] == ["takes", "gives", "lets go"]
    for found, lost in zip(run.events, (True, True, False), strict=True):
        moved = [model.centroidal_momentum(found.q, speeds) for speeds in (found.v, found.v_after)]
        assert np.abs(moved[1] - moved[0]).max() <= 1e-12 * np.abs(moved[0]).max()
        dv = found.v_after - found.v
        carnot = 0.5 * dv @ model.mass_matrix(found.q) @ dv
        assert found.energy_lost == pytest.approx(carnot, rel=1e-10, abs=1e-12) and (carnot > 1e-3) == lost
    momenta = model.centroidal_momentum(run.q, run.v)
    assert np.abs(momenta - momenta[0]).max() < 1e-8 * np.abs(momenta).max()

    def grips(k: int) -> list[Any]:
        """Poses of the part's handles as the arms see them."""
        at = run.q[k]
        seen = []
        for side, handle in (("left", "one"), ("right", "two")):
            (p, R), (o, S) = model.frame_pose(f"{side}_fore.end", at), model.frame_pose(handle, at)
            seen.append(np.c_[R.T @ (o - p), R.T @ S])
        return seen

    t = run.t
    between = np.flatnonzero((t > 0.2) & (t < 0.3))
    assert np.abs(np.array(grips(between[0])) - np.array(grips(between[-1]))).max() < 1e-8, "both hold"
    after = np.flatnonzero(t > 0.3)
    moved = np.abs(np.array(grips(after[0])) - np.array(grips(after[-1]))).max(axis=(1, 2))
    assert moved[1] < 1e-8 < 1e-3 < moved[0], "the second holds, the first has let go"


CRANK, ROD, PIN, CLEARANCE = 0.1, 0.3, 0.01, 5e-4


def slider_crank(clearance: float | None) -> sf.System:
    """A crank, a rod, and a slider whose bearing is ideal, or a hollow cylinder about the rod's pin, with clearance."""
    end = sf.Frame("end", (CRANK, 0, 0))
    tip = sf.Frame("tip", (ROD, 0, 0))
    bodies = (
        sf.RigidBody("crank", sf.Joint("a", "revolute", axis=(0, 0, 1)), sf.Inertia(2.0, moments=(0.1,) * 3), (end,)),
        sf.RigidBody(
            "rod", sf.Joint("b", "revolute", "crank", axis=(0, 0, 1), frame="end"),
            sf.Inertia(0.3, (ROD / 2, 0, 0), (1e-4, 2.5e-3, 2.5e-3)), (tip,),
        ),
        sf.RigidBody("slider", sf.Joint("x", "prismatic", axis=(1, 0, 0)), sf.Inertia(0.2)),
    )  # fmt: skip
    pair: Any = ("rod", "tip"), ("slider", None)
    if clearance is None:
        closed = (sf.Closure("pin", *pair, ("x", "y")),)
        return sf.System("slider_crank", bodies, gravity=(0, 0, 0), constraints=closed)
    bearing: dict[str, Any] = {
        "exponent": 1.0,
        "surface": "cylinder",
        "inside": True,
        "surface_radius": PIN + clearance,
        "radius": PIN,
    }
    touch = sf.Contact("pin", *pair, 1e7, dissipation=2.0, friction=0.05, minimum_velocity=1e-2, **bearing)
    return sf.System("with_clearance", bodies, gravity=(0, 0, 0), connections=(touch,))


def test_a_bearing_with_clearance_follows_the_ideal_one_within_it() -> None:
    """Two methods agree on the motion; the pin stays in its hole, and the energy falls by what the bearing loses."""
    start = [0.0, 0.0, CRANK + ROD]
    speeds = [20.0, -20.0 * (1.0 + CRANK / ROD), 0.0]
    ideal = sf.compile(slider_crank(None))
    loose = sf.compile(slider_crank(CLEARANCE))
    options: dict[str, Any] = {"t_end": 0.35, "output": 1e-3}
    run = sf.simulate(loose, start, speeds, method="rodas4", rtol=1e-8, atol=1e-11, **options)
    fine = sf.simulate(loose, start, speeds, method="dop853", rtol=1e-11, atol=1e-13, **options)
    assert np.abs(run.q - fine.q).max() < 1e-5 and run.outcome.ok and fine.outcome.ok
    gaps = loose.contact_forces(fine.q, fine.v).gap[:, 0]
    assert gaps.max() <= CLEARANCE * (1 + 1e-9) and gaps.min() > -0.1 * CLEARANCE
    assert (gaps < 0.0).any() and (gaps > 0.0).any(), "it rattles"
    assert np.all(np.diff(fine.energy) < 1e-9) and fine.energy[-1] < fine.energy[0] - 1e-3
    exact = sf.simulate(ideal, start, speeds, method="dop853", rtol=1e-11, atol=1e-13, **options)
    along = np.interp(fine.q[:, 0], exact.q[:, 0], exact.q[:, 2])
    far = np.abs(fine.q[:, 2] - along)
    # The rod's tip is off the axis by the clearance at most, and the slider from it by as much.
    assert 0.1 * CLEARANCE < far.max() < 2.0 * CLEARANCE


def test_a_peg_slides_into_its_hole_and_lies_on_three_points() -> None:
    """Three points of its lower rim meet the wall and the ground; at rest forces and moments balance to rounding."""
    rim = [(0.02 * np.cos(a), 0.02 * np.sin(a), -0.05) for a in (0.0, 2 * np.pi / 3, 4 * np.pi / 3)]
    losses: dict[str, Any] = {"dissipation": 20.0, "friction": 0.3, "bristle_stiffness": 1e5, "bristle_damping": 100.0}
    peg = sf.RigidBody("peg", sf.Joint("free", "free"), sf.Inertia(0.4, moments=(4e-4, 4e-4, 8e-5)))
    common: dict[str, Any] = {"stiffness": 1e6, "exponent": 1.0, "points": rim, "radius": 2e-3} | losses
    wall = sf.Contact(
        "wall", ("peg", None), ("world", None), surface="cylinder", inside=True, surface_radius=0.0225, **common
    )
    ground = sf.Contact("ground", ("peg", None), ("world", None), **common)
    upper = [(x, y, 0.05) for x, y, _ in rim]
    guide = sf.Contact("guide", ("peg", None), ("world", None), surface="cylinder", inside=True, surface_radius=0.0225,
                       **common | {"points": upper})  # fmt: skip
    model = sf.compile(sf.System("peg_in_hole", (peg,), connections=(wall, ground, guide)))
    start = model.integrate(model.neutral(), np.array([0.0003, -0.0002, 0.1, 0.004, 0.003, 0.2]))
    run = sf.simulate(model, start, {"free.vx": 0.05}, t_end=3.0, method="rodas4", rtol=1e-8, atol=1e-11)
    found = model.contact_forces(run.q, run.v, z=run.z)
    names = model.names.contacts
    assert run.outcome.ok and len(names) == 9
    walls = [i for i, name in enumerate(names) if not name.startswith("ground")]
    assert (found.gap[:, walls] < 0.0).any(axis=0).sum() >= 3, "it met the wall on its way"
    assert found.gap[:, walls].min() > -1e-4, "and stayed in the hole"
    force, point = found.force[-1], found.point[-1]
    weight = np.array([0.0, 0.0, -0.4 * 9.81])
    total = force.sum(axis=0) + weight
    moment = np.cross(point, force).sum(axis=0) + np.cross(run.q[-1, :3], weight)
    assert np.abs(total).max() < 1e-6 * 3.924 and np.abs(moment).max() < 1e-8
    assert np.abs(run.v[-1]).max() < 1e-6
    assert (found.gap[-1][[i for i in range(9) if i not in walls]] < 0.0).all(), "it lies on three points"
