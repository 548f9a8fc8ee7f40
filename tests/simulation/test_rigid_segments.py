"""Capsules that meet spheres, cylinders and capsules, as rigid contacts (docs/theory/constraints.md, section 15)."""

from __future__ import annotations

from math import cos, pi, sin, sqrt
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import symofros as sf
from tests.simulation.rigid_scenes import FINE, G

HALF, RADIUS = 0.4, 0.05
SURFACES: dict[str, dict[str, Any]] = {
    "sphere": {"surface_radius": 0.2},
    "cylinder": {"surface_radius": 0.2},
    "capsule": {"surface_radius": 0.2, "length": 0.6},
}


def stick(name: str) -> sf.RigidBody:
    """A free body of 1 kg along its z axis."""
    return sf.RigidBody(name, sf.Joint(name, "free"), sf.Inertia(1.0, moments=(0.05, 0.05, 0.001)))


def two(surface: str, e: float = 0.0) -> sf.Model:
    """Two free bodies without weight, the first one a capsule."""
    sizes: dict[str, Any] = {"radius": RADIUS, "segment": 2 * HALF} | SURFACES[surface]
    contact = sf.Contact("pair", ("a", None), ("b", None), surface=surface, restitution=e, **sizes)  # type: ignore[arg-type]
    return sf.compile(sf.System("two", [stick("a"), stick("b")], gravity=(0, 0, 0), connections=[contact]))


@pytest.mark.parametrize("surface", SURFACES)
def test_gaps_are_the_least_distances(surface: str) -> None:
    """Of all points of the two lines, by a search: in any posture, between middles and ends."""
    model, rng = two(surface), np.random.default_rng(3)
    reach = {"sphere": 0.0, "cylinder": 1e3, "capsule": 0.3}[surface]
    for _ in range(12):
        q, _v = model.random_state(rng)
        (p1, R1), (p2, R2) = (model.frame_pose(name, q) for name in "ab")

        def distance(s: float, p1: Any = p1, R1: Any = R1, p2: Any = p2, R2: Any = R2) -> float:
            d = p1 + s * R1[:, 2] - p2
            return float(np.linalg.norm(d - np.clip(R2[:, 2] @ d, -reach, reach) * R2[:, 2]))

        # Convex: the distance of two convex sets along a line.
        least = minimize_scalar(distance, bounds=(-HALF, HALF), method="bounded", options={"xatol": 1e-12}).fun
        least = min(least, distance(-HALF), distance(HALF))
        assert model.contact_forces(q, np.zeros(model.nv)).gap[0] == pytest.approx(least - 0.2 - RADIUS, abs=1e-12)


@pytest.mark.parametrize("e", [0.0, 0.8])
def test_crossed_capsules_strike_along_their_common_normal(e: float) -> None:
    """Without friction: by the inertia of both points of contact, at the instant at which the axes are near enough."""
    model, turn, along, beside = two("capsule", e), 0.9, 0.1, 0.2
    q, v = model.neutral(), np.zeros(12)
    q[1], q[2], q[3], q[6] = 0.2, beside, sin(turn / 2), cos(turn / 2)  # Turned about x, at rest; the other one comes.
    q[7], q[9], v[6] = -0.6, along, 2.0
    run = sf.simulate(model, q, v, t_end=0.3, **FINE)
    # The axis of the first one, (0, -sin, cos), crosses that of the second, z, at its own coordinate s, seen along x.
    s = q[1] / sin(turn)
    arms = abs(s), abs(beside + s * cos(turn) - along)
    impulse = (1 + e) * 2.0 / (2.0 + sum(arm**2 / 0.05 for arm in arms))
    strike = run.events[0]
    assert strike.t == pytest.approx((0.6 - 0.2 - RADIUS) / 2.0, abs=1e-12) and arms[0] < HALF and arms[1] < 0.3
    assert strike.impulse[0] == pytest.approx(impulse, rel=1e-10)
    after, before = (np.array([model.frame_velocity(n, strike.q, x) for n in "ab"]) for x in (strike.v_after, strike.v))
    changes = after - before
    assert changes[:, 0] == pytest.approx([impulse, -impulse], rel=1e-10)
    assert np.linalg.norm(changes[:, 3:], axis=1) == pytest.approx([arm * impulse / 0.05 for arm in arms], rel=1e-10)


@pytest.mark.parametrize("surface", ["cylinder", "capsule"])
def test_a_stick_rocks_across_a_log(surface: str) -> None:
    """It rolls without slip: where its middle is follows from its angle, and the energy stays."""
    log = sf.Frame("log", rotation=sf.Rotation.axis_angle((1, 0, 0), pi / 2))
    base = sf.RigidBody("base", sf.Joint("base", "fixed"), frames=[log])
    sizes: dict[str, Any] = {"radius": RADIUS, "segment": 2 * HALF} | SURFACES[surface]
    laws: dict[str, Any] = {"restitution": 0.0, "friction": 5.0}
    contact = sf.Contact("log", ("stick", None), ("base", "log"), surface=surface, **sizes, **laws)  # type: ignore[arg-type]
    model = sf.compile(sf.System("rocks", [base, stick("stick")], connections=[contact]))
    big, angle = 0.2, 0.5

    def middle(x: Any) -> Any:
        c, s, top = np.cos(x), np.sin(x), big + RADIUS
        return np.array([top * s - big * x * c, top * c + big * x * s])

    q = model.neutral()
    q[[0, 2]], q[4], q[6] = middle(angle), sin(pi / 4 + angle / 2), cos(pi / 4 + angle / 2)
    run = sf.simulate(model, q, t_end=1.5, **FINE)
    assert run.events == ()
    turned = 2 * np.arctan2(run.q[:, 4], run.q[:, 6]) - pi / 2
    np.testing.assert_allclose(run.q[:, [0, 2]], middle(turned).T, atol=1e-9)
    rate = np.array([model.frame_velocity("stick", *x)[4] for x in zip(run.q, run.v, strict=True)])
    fall = G * (middle(angle)[1] - middle(turned)[1])
    np.testing.assert_allclose(rate**2 * (0.05 + RADIUS**2 + (big * turned) ** 2) / 2, fall, atol=1e-9)
    assert turned.min() == pytest.approx(-angle, abs=1e-3) and sqrt(turned.var()) > 0.2


def along(shift: float) -> sf.Model:
    """A capsule that lies along another one, `shift` beside it, and may tilt: points at both ends of both touch."""
    moves = sf.RigidBody("moves", sf.Joint("x", "prismatic", axis=(1, 0, 0), position=(0, 0, shift)))
    inertia = sf.Inertia(1.0, moments=(0.05, 0.05, 0.001))
    lies = sf.RigidBody("lies", sf.Joint("tilt", "revolute", axis=(0, 1, 0), parent="moves"), inertia)
    base = sf.RigidBody("base", sf.Joint("base", "fixed"))
    contacts = [
        sf.Contact(
            f"ends of {first}",
            (first, None),
            (second, None),
            restitution=0.0,
            radius=radius,
            points=((0, 0, -half), (0, 0, half)),
            surface="capsule",
            surface_radius=surface,
            length=length,
        )
        for first, second, radius, half, surface, length in (
            ("lies", "base", RADIUS, HALF, 0.2, 0.6),
            ("base", "lies", 0.2, 0.3, RADIUS, 2 * HALF),
        )
    ]
    return sf.compile(sf.System("along", [base, moves, lies], gravity=(-G, 0, 0), connections=contacts))


def test_capsules_that_lie_along_each_other_touch_by_points_at_their_ends() -> None:
    """At the two ends of their overlap, -0.2 and 0.3, as on a flat face: they carry what statics says."""
    model = along(0.2)
    start = [0.2 + RADIUS, 0.0]
    run = sf.simulate(model, start, t_end=0.2, **FINE)
    assert run.events == () and np.abs(run.q - start).max() < 1e-12
    # Ends of the one that lies, of the base: 0.4 and 0.1 from its middle on either side.
    assert run.contact_forces().push[-1] == pytest.approx([0.2 * G, 0.0, 0.0, 0.8 * G], abs=1e-9)


def test_a_capsule_tips_over_the_end_of_the_one_below() -> None:
    """Its middle is 0.05 beyond that end: it turns about that end at once, and its energy stays."""
    model, arm = along(0.35), 0.05
    run = sf.simulate(model, [0.2 + RADIUS, 0.0], t_end=0.15, **FINE)
    force = run.contact_forces().push
    assert force[0] == pytest.approx([0.0, 0.0, 0.0, G / (1 + arm**2 / 0.05)], abs=1e-9)
    assert np.ptp(run.kinetic_energy + run.potential_energy) < 1e-9 and abs(run.q[-1, 1]) > 0.05
    # On the line that touches the base's end, 0.2 + 0.05 from its centre.
    x, tilt = run.q.T
    assert (x * np.cos(tilt) + arm * np.sin(tilt) * np.sign(tilt[-1])) == pytest.approx(0.2 + RADIUS, abs=1e-9)


def test_segments_that_lie_along_a_surface_are_said() -> None:
    """Parallel capsules touch along a line; and what segments do not meet is refused."""
    model = two("capsule")
    q = model.neutral()
    q[0] = 0.2 + RADIUS
    run = sf.simulate(model, q, t_end=0.1)
    assert run.outcome.kind == "beyond theory" and "a segment along its surface" in str(run.outcome)
    for stated in ({"surface": "plane"}, {"surface": "cylinder", "surface_radius": 1.0, "inside": True}):
        with pytest.raises(sf.DescriptionError, match="its two ends as points"):
            sf.Contact("c", ("a", None), ("b", None), segment=1.0, restitution=0.0, **stated)  # type: ignore[arg-type]
