"""phi, G and gamma of every kind of constraint against differences of the configuration, and the rates they imply."""

from __future__ import annotations

from functools import cache
from typing import Any, Literal

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS

SOLID = sf.Inertia(1.5, (0.1, -0.2, 0.05), (0.3, 0.4, 0.5))
FUNCTIONS = ("constraint", "constraint_rate", "constraint_jacobian", "constraint_bias")
A, B = ("one", "e"), ("two", "e")


def tree(*constraints: sf.Constraint, beam: bool = False, **more: Any) -> sf.System:
    """A floating body with an arm, a second arm on the ground, each with a turned frame at its end."""
    turned = (sf.Frame("e", (0.4, 0.1, -0.2), sf.Rotation.rpy(0.3, -0.5, 0.7)),)
    bodies: list[sf.Body] = [
        sf.RigidBody("base", sf.Joint("float", "free"), SOLID),
        sf.RigidBody("one", sf.Joint("s", "screw", "base", axis=(1, 2, 2), pitch=0.1), SOLID, turned),
        sf.RigidBody("two", sf.Joint("c", "cylindrical", position=(0.2, 0, 0.3), axis=(0, 1, 0)), SOLID, turned),
    ]
    if beam:
        root = sf.Joint("hub", "revolute", axis=(0, 0, 1))
        section = {"EI_z": 4.0, "EI_y": 3.0, "GJ": 2.0, "rhoJ": 0.01}
        bodies.append(sf.Beam("rod", root, 1.2, 0.8, **section, bend_y=2, bend_z=1, twist=1))
    return sf.System("s", tuple(bodies), constraints=constraints, **more)


def switched(*constraints: sf.Constraint, pose: Literal["stated", "moment"] = "stated") -> sf.System:
    """All of them engaged by a parameter."""
    switches = tuple(sf.Switch(constraint.name, "engaged", pose) for constraint in constraints)
    return tree(*constraints, parameters=(sf.Parameter("engaged", 1.0),), switches=switches)


ROTATIONS = ("x", "y", "z", "xy", "xz", "yz", "xyz")
CASES: dict[str, sf.System] = {
    "translations": tree(sf.Closure("k", A, B)),
    "some translations": tree(sf.Closure("k", A, B, ("x", "z"))),
    **{f"rotations {axes}": tree(sf.Closure("k", A, B, (), tuple(axes))) for axes in ROTATIONS},
    "to the world": tree(sf.Closure("k", ("world", None), B, ("y",), ("x",))),
    "rod": tree(sf.Rod("k", A, B, 0.7)),
    "knife edge": tree(sf.KnifeEdge("k", A, "x")),
    "disc": tree(sf.Rolling("k", A, 0.3)),
    "sphere": tree(sf.Rolling("k", B, 0.3, "sphere", 0.1)),
    "coupling": tree(sf.Coupling("k", "s*sin(c.length) + float.qx*cos(c.angle) - 0.2*float.px^2")),
    "formula": tree(sf.Nonholonomic("k", {"ds": "sin(c.angle)*s", "dc.length": "1 + c.length^2"}, "cos(s)")),
    "two at once": tree(sf.Closure("k", A, B), sf.Rod("l", ("base", None), B, 1.0)),
    "switched closure": switched(sf.Closure("k", A, B, ("x", "y", "z"), ("x", "y", "z"))),
    "switched rod and coupling, as they are": switched(
        sf.Rod("k", A, B, 0.7), sf.Coupling("l", "s*sin(c.length)"), pose="moment"
    ),
    "a beam's tip": tree(sf.Closure("k", ("rod", "tip"), B, ("x", "y", "z"), ("x", "y", "z")), beam=True),
}


@cache
def model(case: str) -> sf.Model:
    return sf.compile(CASES[case], sf.Options(functions=FUNCTIONS, backend="interpreter"))


def sixth(function, step: float = 1e-3) -> np.ndarray:  # type: ignore[no-untyped-def]
    """The derivative at 0 by a central difference of sixth order."""
    weights = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))
    return np.asarray(sum(w * (function(k * step) - function(-k * step)) for k, w in weights) / step)


def state(m: sf.Model, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    q, _ = m.random_state(rng)
    return q, rng.normal(size=m.nv)


@pytest.mark.parametrize("case", CASES)
def test_rates_of_conditions_are_their_derivatives_along_the_motion(case: str) -> None:
    m = model(case)
    q, v = state(m)
    G, gamma = m.constraint_jacobian(q), m.constraint_bias(q, v)
    binding = [i for i, name in enumerate(m.names.constraints) if name not in m.record.speed_conditions]
    along = sixth(lambda s: m.constraint(m.integrate(q, s * v)))
    assert np.abs(along - G @ v)[binding].max(initial=0.0) < 1e-9
    # The rate of the rate at v' = 0 is -gamma, for conditions on speeds as well.
    drift = sixth(lambda s: m.constraint_rate(m.integrate(q, s * v), v))
    assert np.abs(drift + gamma).max() < 1e-8 * max(1.0, np.abs(gamma).max())


SURFACES: dict[str, dict[str, Any]] = {
    "plane": {},
    "rim": {"rim": 0.3},
    "sphere": {"surface": "sphere", "surface_radius": 0.3},
    "rim on a cylinder": {"surface": "cylinder", "surface_radius": 0.2, "rim": 0.3},
    "ring around a cylinder": {"surface": "cylinder", "surface_radius": 0.2, "rim": 9.0},
    "hollow sphere": {"surface": "sphere", "surface_radius": 0.9, "inside": True},
    "cylinder": {"surface": "cylinder", "surface_radius": 0.2},
    **{
        f"{part} of a segment, {surface}": {"surface": surface, "surface_radius": 0.1, "segment": length} | sizes
        for part, length in (("middle", 9.0), ("end", 0.1))
        for surface, sizes in (("sphere", {}), ("cylinder", {}), ("capsule", {"length": 9.0}))
    },
    "segment, end of a capsule": {"surface": "capsule", "surface_radius": 0.1, "length": 0.1, "segment": 9.0},
    "end of a segment, end of a capsule": {"surface": "capsule", "surface_radius": 0.1, "length": 0.1, "segment": 0.1},
    "hollow cylinder": {"surface": "cylinder", "surface_radius": 0.9, "inside": True},
    "shank of a capsule": {"surface": "capsule", "surface_radius": 0.1, "length": 9.0},
    "end of a capsule": {"surface": "capsule", "surface_radius": 0.1, "length": 0.1},
    "face of a box": {"surface": "box", "size": (9.0, 0.05, 9.0)},
    "edge of a box": {"surface": "box", "size": (9.0, 0.05, 0.1)},
    "corner of a box": {"surface": "box", "size": (0.02, 0.05, 0.1)},
}


@pytest.mark.parametrize(
    ("surface", "pole"), [("plane", None), ("rim", None), *((x, s) for x in list(SURFACES)[2:] for s in (1, -1))]
)
def test_rows_of_rigid_contacts_are_derivatives_along_the_motion(surface: str, pole: float | None) -> None:
    """A ball that sticks: its distance twice, and the rates of the velocities along axes that turn (38a) to (38l)."""
    contact = sf.Contact("k", A, B, restitution=0.0, radius=0.1, points=[(0.05, 0.1, -0.1)], **SURFACES[surface])
    m = sf.compile(
        tree(connections=(contact,)),
        sf.Options(functions=(*FUNCTIONS, "contact_forces", "closure_wrenches"), backend="interpreter"),
    )
    given = {"par": {"k.mode": 2.0} | ({} if pole is None else {"k.pole": pole})}
    q, v = state(m)
    G, gamma = m.constraint_jacobian(q, **given), m.constraint_bias(q, v, **given)
    rate = m.constraint_rate(q, v, **given)
    assert rate == pytest.approx(G @ v, abs=1e-12) and m.names.constraints[0] == "k.normal"
    for distance in (m.constraint, lambda q, **x: m.contact_forces(q, v, **x).gap):
        along = sixth(lambda s, distance=distance: distance(m.integrate(q, s * v), **given))
        assert along[0] == pytest.approx(rate[0], abs=1e-9)
    drift = sixth(lambda s: m.constraint_rate(m.integrate(q, s * v), v, **given))
    assert np.abs(drift + gamma).max() < 1e-8 * max(1.0, np.abs(gamma).max())
    # The axes are at right angles: those of a wrench on the ball by each multiplier, of the unit length.
    pushes = np.concatenate([m.closure_wrench("k.across", q, x, **given)[..., :3] for x in np.eye(3)[1:]])
    pushes = np.vstack([m.closure_wrench("k.normal", q, [1, 0, 0], **given)[:3], pushes.reshape(2, 3)])
    assert pushes @ pushes.T == pytest.approx(np.eye(3), abs=1e-14)


def test_rates_at_the_closed_posture_are_the_blocked_spins() -> None:
    """Both frames of a ball on the ground: G is the identity in the blocked directions."""
    for axes in ROTATIONS:
        ball = sf.RigidBody("b", sf.Joint("j", "ball"), SOLID)
        closure = sf.Closure("k", ("world", None), ("b", None), (), tuple(axes))
        m = sf.compile(sf.System("s", (ball,), constraints=(closure,)), sf.Options(FUNCTIONS, backend="interpreter"))
        rows = np.eye(3)[["xyz".index(axis) for axis in axes]]
        assert np.array_equal(m.constraint_jacobian(m.neutral()), rows)


def test_time_and_prescribed_motion_enter_b() -> None:
    slide = sf.RigidBody("cart", sf.Joint("x", "prismatic", axis=(1, 0, 0)), SOLID)
    turn = sf.RigidBody("arm", sf.Joint("turn", "revolute", prescribed=True), SOLID, (sf.Frame("e", (0.5, 0, 0)),))
    closure = sf.Closure("k", ("cart", None), ("arm", "e"), ("x",))
    formula = sf.Nonholonomic("n", {"dx": 2.0}, "t^2")
    stated = sf.System("s", (slide, turn), constraints=(closure, formula))
    m = sf.compile(stated, sf.Options(FUNCTIONS, backend="interpreter"))
    u = np.array([0.3, 2.0, -1.0])
    rate = m.constraint_rate([0.1], [0.4], u=u, t=3.0)
    assert rate == pytest.approx([-0.5 * np.sin(0.3) * 2.0 - 0.4, 2 * 0.4 - 9.0])
    gamma = m.constraint_bias([0.1], [0.4], u=u, t=3.0)
    arm = -0.5 * (np.cos(0.3) * 4.0 - np.sin(0.3))
    assert gamma == pytest.approx([-arm, 6.0])


class TestMultipliers:
    """Repeated, contradicting and missing conditions, in C and in NumPy."""

    @pytest.mark.parametrize("backend", ["c", "interpreter"])
    def test_redundant_conditions_are_met_by_the_least_multipliers(self, backend: str) -> None:
        m = sf.compile(MODELS["parallelogram"], sf.Options(functions=_SOLVED, backend=backend))  # type: ignore[arg-type]
        at = sf.assemble(m, [1.0, -1.0, 1.0, 1.0], np.ones(4))
        a, lam, rank = m.constrained_dynamics(at.q, at.v, [0.7])
        G, M = m.constraint_jacobian(at.q), m.mass_matrix(at.q)
        force = m.generalized_force(at.q, at.v, [0.7]) - m.bias(at.q, at.v)
        assert rank == 3 and np.abs(G @ a - m.constraint_bias(at.q, at.v)).max() < 1e-10
        least = np.linalg.pinv(G.T, rcond=1e-8) @ (M @ a - force)
        assert lam == pytest.approx(least, rel=1e-8, abs=1e-9)

    @pytest.mark.parametrize("drift", [0.0, 1e-9, 1e-8])
    def test_slight_drift_changes_accelerations_only_slightly(self, drift: float) -> None:
        m = sf.compile(MODELS["parallelogram"], sf.Options(functions=_SOLVED))
        at = sf.assemble(m, [1.0, -1.0, 1.0, 1.0], np.ones(4))
        there = m.forward_dynamics(at.q, at.v, [0.7])
        near = m.forward_dynamics(at.q + drift * np.array([1.0, -0.3, 0.8, -0.5]), at.v, [0.7])
        assert np.abs(near - there).max() <= 100 * drift

    @pytest.mark.parametrize("backend", ["c", "interpreter"])
    def test_a_massless_body_held_by_a_loop_accelerates(self, backend: str) -> None:
        """The last bar of a four-bar without mass: M is singular, the mechanism is not."""
        bars = [
            sf.RigidBody("a", sf.Joint("q1", "revolute"), SOLID, (sf.Frame("e", (1, 0, 0)),)),
            sf.RigidBody(
                "b", sf.Joint("q2", "revolute", "a", "e"), None, (sf.Frame("e", (1, 0, 0)),), ("massless_tip",)
            ),
        ]
        rail = sf.Closure("rail", ("world", None), ("b", "e"), ("y",))
        m = sf.compile(sf.System("s", tuple(bars), constraints=(rail,)), sf.Options(functions=_SOLVED, backend=backend))  # type: ignore[arg-type]
        at = sf.assemble(m, [0.6, -1.2], [1.0, 0.0])
        a, lam, rank = m.constrained_dynamics(at.q, at.v, [])
        M, G = m.mass_matrix(at.q), m.constraint_jacobian(at.q)
        assert np.linalg.cond(M) > 1e12 and rank == 1
        assert np.abs(M @ a + m.bias(at.q, at.v) - G.T @ lam).max() < 1e-9
        assert np.abs(G @ a - m.constraint_bias(at.q, at.v)).max() < 1e-9

    @pytest.mark.parametrize("form", ["multipliers", "null_space"])
    @pytest.mark.parametrize("backend", ["c", "interpreter"])
    def test_a_massless_body_that_no_constraint_holds_gives_nan_accelerations(self, backend: str, form: str) -> None:
        bars = [
            sf.RigidBody("a", sf.Joint("q1", "revolute"), SOLID, (sf.Frame("e", (1, 0, 0)),)),
            sf.RigidBody("b", sf.Joint("q2", "revolute", "a", "e"), None, (), ("massless_tip",)),
        ]
        rail = sf.Closure("rail", ("world", None), ("a", "e"), ("y",))
        options = sf.Options(functions=_SOLVED, backend=backend, constraints=form)  # type: ignore[arg-type]
        m = sf.compile(sf.System("s", tuple(bars), constraints=(rail,)), options)
        a, _, rank = m.constrained_dynamics([0.0, 0.3], [0.0, 0.0], [])
        assert np.all(np.isnan(a)) and rank == -1

    def test_baumgarte_terms_are_added(self) -> None:
        m = sf.compile(MODELS["four_bar"], sf.Options(functions=_SOLVED))
        q, v, alpha, beta = np.array([1.2, -1.1, 1.3]), np.array([0.5, -0.2, 0.1]), 3.0, 5.0
        a = m.forward_dynamics(q, v, [], gains=(alpha, beta))
        wanted = m.constraint_bias(q, v) - 2 * alpha * m.constraint_rate(q, v) - beta**2 * m.constraint(q)
        assert m.constraint_jacobian(q) @ a == pytest.approx(wanted, rel=1e-9)


_SOLVED = (*FUNCTIONS, "forward_dynamics", "mass_matrix", "bias", "generalized_force")


@pytest.mark.parametrize("engaged", [0.0, 1.0])
def test_rows_of_a_switched_constraint_are_shares_of_its_own(engaged: float) -> None:
    """None of it where it is released, all of it where it holds; conditions that are not switched stay whole."""
    closure, other = sf.Closure("k", A, B), sf.Rod("l", ("base", None), B, 1.0)
    switch = (sf.Switch("k", "engaged"),)
    rows = []
    for switches in ((), switch):
        system = tree(closure, other, parameters=(sf.Parameter("engaged", engaged),), switches=switches)
        m = sf.compile(system, sf.Options(functions=FUNCTIONS, backend="interpreter"))
        rng = np.random.default_rng(5)
        q = m.normalized(rng.uniform(-1.0, 1.0, m.nq))
        v = rng.uniform(-1.0, 1.0, m.nv)
        rows.append([m.evaluate(name, q=q, v=v)[0] for name in FUNCTIONS])
    share = np.where(np.arange(rows[0][0].shape[0]) < len(closure.conditions), engaged, 1.0)
    for whole, part in zip(*rows, strict=True):
        np.testing.assert_allclose(part, (whole.T * share).T, rtol=0, atol=1e-14)
