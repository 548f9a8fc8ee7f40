"""Capsules that meet spheres, cylinders, capsules and boxes, as rigid contacts (docs/theory/constraints.md, 15)."""

from __future__ import annotations

from math import cos, pi, sin, sqrt
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.spatial.transform import Rotation

import symofros as sf
from tests.simulation.rigid_scenes import FINE, G

HALF, RADIUS = 0.4, 0.05
SURFACES: dict[str, dict[str, Any]] = {
    "sphere": {"surface_radius": 0.2},
    "cylinder": {"surface_radius": 0.2},
    "capsule": {"surface_radius": 0.2, "length": 0.6},
    "box": {"size": (0.5, 0.3, 0.7)},
}
CORES = {"sphere": (0, 0, 0), "cylinder": (0, 0, 1e3), "capsule": (0, 0, 0.3), "box": (0.25, 0.15, 0.35)}


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
    """Of all points of the line and the core, by a search: in any posture, between middles and ends."""
    model, rng, half = two(surface), np.random.default_rng(3), np.array(CORES[surface])
    for _ in range(40 if surface == "box" else 12):
        q, _v = model.random_state(rng)
        (p1, R1), (p2, R2) = (model.frame_pose(name, q) for name in "ab")

        def distance(s: float, p1: Any = p1, R1: Any = R1, p2: Any = p2, R2: Any = R2) -> float:
            d = R2.T @ (p1 + s * R1[:, 2] - p2)
            return float(np.linalg.norm(d - np.clip(d, -half, half)))

        # Convex: the distance of two convex sets along a line.
        least = minimize_scalar(distance, bounds=(-HALF, HALF), method="bounded", options={"xatol": 1e-12}).fun
        least = min(least, distance(-HALF), distance(HALF)) - SURFACES[surface].get("surface_radius", 0.0)
        gap = model.contact_forces(q, np.zeros(model.nv)).gap[0]
        assert gap == pytest.approx(least - RADIUS, abs=1e-12) or (least == 0.0 and gap <= -RADIUS)


@pytest.mark.parametrize("surface", ["sphere", "capsule", "box"])
def test_gaps_are_those_of_mujoco(surface: str) -> None:
    """By its `mj_geomDistance`, whose own iteration ends at some 1e-6 for boxes."""
    mujoco = pytest.importorskip("mujoco")
    sizes = {"sphere": "0.2", "capsule": "0.2 0.3", "box": "0.25 0.15 0.35"}
    engine = mujoco.MjModel.from_xml_string(
        f"""<mujoco><worldbody><body><freejoint/><geom type="capsule" size="{RADIUS} {HALF}"/></body>
        <body><freejoint/><geom type="{surface}" size="{sizes[surface]}"/></body></worldbody></mujoco>"""
    )
    data, model, rng, apart = mujoco.MjData(engine), two(surface), np.random.default_rng(5), 0
    for _ in range(40):
        q, _v = model.random_state(rng)
        data.qpos[:] = q[[0, 1, 2, 6, 3, 4, 5, 7, 8, 9, 13, 10, 11, 12]]
        mujoco.mj_kinematics(engine, data)
        known = mujoco.mj_geomDistance(engine, data, 0, 1, 10.0, np.zeros(6))
        gap = model.contact_forces(q, np.zeros(model.nv)).gap[0]
        apart += known > 0.0
        assert known < 0.0 or gap == pytest.approx(known, abs=1e-5 if surface == "box" else 1e-12)
    assert apart >= 15


@pytest.mark.parametrize("surface", SURFACES)
def test_rows_are_rates_and_do_not_depend_on_the_world(surface: str) -> None:
    """The speed of the gap and of the slip's rows by differences along a motion; and both bodies moved as one."""
    model, rng, h, checked = two(surface).with_parameters(**{"pair.mode": 2}), np.random.default_rng(6), 1e-5, 0
    turned = Rotation.from_rotvec([0.4, -0.8, 0.3])
    for _ in range(12):
        q, v = model.random_state(rng)
        if model.contact_forces(q, v).gap[0] < 0.0:
            continue
        ahead, behind = (model.integrate(q, k * h * v) for k in (1.0, -1.0))
        G = model.constraint_jacobian(q)
        rate = (model.constraint(ahead) - model.constraint(behind))[0] / (2 * h)
        bend = (model.constraint_jacobian(ahead) - model.constraint_jacobian(behind)) @ v / (2 * h)
        near = [model.contact_forces(one, v).gap[0] for one in (ahead, behind)]
        assert rate == pytest.approx((near[0] - near[1]) / (2 * h), abs=1e-9)
        assert (G @ v)[0] == pytest.approx(rate, abs=1e-7)
        assert -model.constraint_bias(q, v) == pytest.approx(bend, abs=1e-5)
        other = q.copy()
        for k in (0, 7):
            other[k : k + 3] = turned.apply(q[k : k + 3]) + [0.3, 0.2, -0.5]
            other[k + 3 : k + 7] = (turned * Rotation.from_quat(q[k + 3 : k + 7])).as_quat()
        assert model.constraint(other) == pytest.approx(model.constraint(q), abs=1e-13)
        assert model.constraint_jacobian(other) == pytest.approx(G, abs=1e-12)
        checked += 1
    assert checked >= 6


def test_capsules_are_exchanged_without_a_change() -> None:
    """Either one as the segment of the contact: the same gap, and the same force on each body."""
    rng, sizes = np.random.default_rng(7), {"radius": RADIUS, "segment": 2 * HALF}
    other = {"surface": "capsule", "surface_radius": 0.2, "length": 0.6}
    swapped = {"radius": 0.2, "segment": 0.6, "surface": "capsule", "surface_radius": RADIUS, "length": 2 * HALF}
    models = [
        sf.compile(
            sf.System(
                "two",
                [stick("a"), stick("b")],
                connections=[sf.Contact("pair", (first, None), (second, None), restitution=0.0, **stated)],
            )
        ).with_parameters(**{"pair.mode": 1})
        for first, second, stated in (("a", "b", sizes | other), ("b", "a", swapped))
    ]
    for _ in range(10):
        q, v = models[0].random_state(rng)
        gaps = [model.contact_forces(q, v).gap[0] for model in models]
        assert gaps[0] == pytest.approx(gaps[1], abs=1e-14)
        rows = [model.constraint_jacobian(q)[np.abs(model.constraint_jacobian(q)).sum(axis=1) > 0] for model in models]
        assert gaps[0] < 0.0 or rows[0] == pytest.approx(rows[1], abs=1e-12)


def test_a_stick_tips_over_the_edge_of_a_box() -> None:
    """Without slip it turns about the edge as about a hinge, and its energy stays."""
    base = sf.RigidBody("base", sf.Joint("base", "fixed"))
    laws: dict[str, Any] = {"restitution": 0.0, "friction": 50.0, "radius": RADIUS, "segment": 2 * HALF}
    edge = sf.Contact("edge", ("stick", None), ("base", None), surface="box", size=(1, 1, 1), **laws)
    model, angle, beyond = sf.compile(sf.System("tips", [base, stick("stick")], connections=[edge])), 0.3, 0.1

    def middle(x: Any) -> Any:
        return np.array([RADIUS * np.sin(x) + beyond * np.cos(x), RADIUS * np.cos(x) - beyond * np.sin(x)])

    q = model.neutral()
    q[[0, 2]], q[4], q[6] = 0.5 + middle(angle), sin(pi / 4 + angle / 2), cos(pi / 4 + angle / 2)
    for given in (FINE, {"method": "rodas4", "rtol": 1e-10, "atol": 1e-12}):
        run = sf.simulate(model, q, t_end=0.3, **given)
        assert run.events == () and run.outcome.ok
        turned = 2 * np.arctan2(run.q[:, 4], run.q[:, 6]) - pi / 2
        np.testing.assert_allclose(run.q[:, [0, 2]] - 0.5, middle(turned).T, atol=1e-8)
        rate = np.array([model.frame_velocity("stick", *x)[4] for x in zip(run.q, run.v, strict=True)])
        fall = G * (middle(angle)[1] - middle(turned)[1])
        np.testing.assert_allclose(rate**2 * (0.05 + RADIUS**2 + beyond**2) / 2, fall, atol=1e-8)
        assert turned[-1] > 0.7


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


def test_edges_of_two_boxes_strike() -> None:
    """A leading edge along z of one, rounded, crosses one along y of the other: both turn."""
    big, moments = (0.4, 0.3, 0.6), np.array([0.05, 0.06, 0.03])
    boxes = [sf.RigidBody(n, sf.Joint(n, "free"), sf.Inertia(1.0, moments=tuple(moments))) for n in "ab"]
    upright = tuple((x, y, 0.0) for x in (-0.19, 0.19) for y in (-0.14, 0.14))
    sizes: dict[str, Any] = {"radius": 0.01, "points": upright, "segment": 0.58, "surface": "box", "size": big}
    edges = sf.Contact("edges", ("a", None), ("b", None), restitution=0.5, **sizes)
    model = sf.compile(sf.System("boxes", boxes, gravity=(0, 0, 0), connections=[edges]))
    q, v = model.neutral(), np.zeros(12)
    q[[0, 1, 2]], q[[5, 6]] = (-0.8, 0.05, 0.1), (sin(pi / 8), cos(pi / 8))  # About z by 45 degrees.
    q[[11, 13]] = sin(pi / 8), cos(pi / 8)  # About y, at the origin.
    v[[0, 1]] = 2 * cos(pi / 4), -2 * cos(pi / 4)  # By 2 m/s along x, in its own axes.
    run = sf.simulate(model, q, v, t_end=0.3, **FINE)
    strike = run.events[0]
    # From the middles to the middle of the edge of a, and to the edge of b.
    (R_a, R_b), turn = (Rotation.from_euler(axis, 45, degrees=True) for axis in "zy"), np.array([1.0, 0.0, 0.0])
    leads, meets = R_a.apply([0.19, -0.14, 0.0]), R_b.apply([-0.2, 0.0, -0.3])
    arm_a = np.array([leads[0] + 0.01, leads[1], meets[2] - 0.1])
    arm_b = np.array([meets[0], 0.05 + leads[1], meets[2]])
    give = 2.0 + sum(
        (R.inv().apply(np.cross(arm, turn)) ** 2 / moments).sum() for R, arm in ((R_a, arm_a), (R_b, arm_b))
    )
    assert strike.name == "edges.2 strikes"
    assert strike.t == pytest.approx((meets[0] - arm_a[0] + 0.8) / 2.0, abs=1e-12)
    after = [model.frame_velocity(name, strike.q, strike.v_after)[0] for name in "ab"]
    assert after == pytest.approx([2.0 - 1.5 * 2.0 / give, 1.5 * 2.0 / give], rel=1e-10)


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


def test_capsules_in_line_strike_by_their_ends() -> None:
    """Their axes are parallel, but they touch at one point: a cue and another one, and a blow beside the axis."""
    model = two("capsule", e=0.5)
    q, v = model.neutral(), np.zeros(12)
    q[2], v[2] = -1.0, 2.0
    run = sf.simulate(model, q, v, t_end=0.3, **FINE)
    assert run.outcome.ok and run.v[-1, [2, 8]] == pytest.approx([0.5, 1.5], abs=1e-12)
    assert run.events[0].t == pytest.approx((1.0 - HALF - 0.3 - RADIUS - 0.2) / 2.0, abs=1e-12)


def test_segments_that_lie_along_a_surface_are_refused_in_words() -> None:
    """Parallel capsules touch along a line; and what segments do not meet is refused."""
    model = two("capsule")
    q = model.neutral()
    q[0] = 0.2 + RADIUS
    run = sf.simulate(model, q, t_end=0.1)
    assert run.outcome.kind == "beyond theory" and "a segment along its surface" in str(run.outcome)
    for stated in ({"surface": "plane"}, {"surface": "cylinder", "surface_radius": 1.0, "inside": True}):
        with pytest.raises(sf.DescriptionError, match="its two ends as points"):
            sf.Contact("c", ("a", None), ("b", None), segment=1.0, restitution=0.0, **stated)  # type: ignore[arg-type]
