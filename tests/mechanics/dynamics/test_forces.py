"""Every form of force against its definition: a formula, a Jacobian, or the energy it stores."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import symofros as sf
from reference_models.rigid.random_tree import MORE_KINDS, random_tree
from symofros.description.forces import Connection, Load, Potential, Spring, Stop
from tests.models import interpreted, sampled

# Central differences with step 1e-5 of functions of size 1 to 100: error h^2 and eps/h.
DIFFERENCE = 1e-6
STEP = 1e-5
SOLID = sf.Inertia(2.0, (0.1, 0, 0), (1, 1, 1))


def slider(*elements: object, **more: object) -> sf.Model:
    body = sf.RigidBody("b", sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=elements), SOLID)  # type: ignore[arg-type]
    return interpreted(sf.System("s", [body], **more))  # type: ignore[arg-type]


def force(model: sf.Model, x: float, v: float) -> float:
    return float(model.generalized_force([x], [v], np.zeros(model.nu))[0])


def test_stop_pushes_only_beyond_and_never_pulls() -> None:
    m = slider(Stop(100.0, damping=5.0, lower=-1.0, upper=1.0))
    assert force(m, 0.99, 10.0) == 0.0 and force(m, -0.99, -10.0) == 0.0
    assert force(m, 1.1, 2.0) == pytest.approx(-10.0 - 10.0)
    assert force(m, 1.1, -2.0) == pytest.approx(-10.0)
    assert force(m, -1.2, -1.0) == pytest.approx(20.0 + 5.0)
    assert m.potential_energy([1.1]) == pytest.approx(0.5) and m.potential_energy([0.5]) == 0.0


@pytest.mark.parametrize("seed", sampled(range(6), (0, 3)))
@pytest.mark.parametrize("at", ["body", "tip", "center_of_mass"])
@pytest.mark.parametrize("axes", ["body", "world"])
def test_loads_are_jacobian_times_wrench(seed: int, at: str, axes: str, rng: np.random.Generator) -> None:
    stated = random_tree(300 + seed, kinds=MORE_KINDS)
    body = stated.bodies[-1]
    assert body.inertia is not None
    # A frame where the load acts, with the axes it is stated in.
    center = sf.Frame("center", body.inertia.center_of_mass)
    load = Load((1.0, -2.0, "3*u1"), ("u1", 0.5, -0.25), at, axes)  # type: ignore[arg-type]
    loaded = replace(body, frames=(*body.frames, center), loads=(load,))
    m = interpreted(replace(stated.with_bodies(loaded), inputs=(sf.Input("u1"),)))
    plain = interpreted(replace(stated, inputs=(sf.Input("u1"),)))
    frame = {"body": body.name, "tip": f"{body.name}.tip", "center_of_mass": "center"}[at]
    u = rng.standard_normal(m.nu)
    q, v = m.random_state(rng)
    wrench = np.array([1.0, -2.0, 3 * u[0], u[0], 0.5, -0.25])
    _, R = m.frame_pose(frame, q)
    turn = R if axes == "body" else np.eye(3)
    in_world = np.concatenate([turn @ wrench[:3], turn @ wrench[3:]])
    expected = m.frame_jacobian(frame, q).T @ in_world
    got = m.generalized_force(q, v, u) - plain.generalized_force(q, v, u)
    np.testing.assert_allclose(got, expected, atol=1e-12)


@pytest.mark.parametrize("seed", sampled(range(6), (1, 2)))
def test_conservative_forces_conserve_energy(seed: int, rng: np.random.Generator) -> None:
    """Springs, stops, connections and potentials, all at once: d(T + V)/dt is the power of the inputs alone."""
    stated = random_tree(400 + seed, kinds=MORE_KINDS)
    bodies = []
    for body in stated.bodies:
        joint = body.joint
        if joint is not None and joint.kind in ("revolute", "prismatic", "screw", "continuous"):
            elements = (Spring(5.0, 0.1, 2.0), Stop(30.0, 0.0, -0.3, 0.4))
            body = replace(body, joint=replace(joint, elements=elements))
        bodies.append(body)
    name = bodies[-1].name
    stated = replace(
        stated,
        bodies=tuple(bodies),
        connections=(
            Connection("a", ("base", "mount"), (name, "tip"), 4.0, 0.3),
            Connection("b", ("b0", None), (name, None), 3.0),
        ),
    )
    first = interpreted(stated)
    usable = [n for n in first.names.q if n.replace(".", "").isalnum()]
    energy = " + ".join(["0", *(f"sin({n})*{n}" for n in usable[:3]), *(f"{n}^2" for n in usable[-2:])])
    m = interpreted(replace(stated, potentials=(Potential("user", energy),)))
    q, v = (np.array(x) for x in zip(*(m.random_state(rng) for _ in range(10)), strict=True))
    u = rng.standard_normal((10, m.nu))
    a = m.forward_dynamics(q, v, u)

    def total(h: float) -> np.ndarray:
        q_h = m.integrate(q, h * v)
        return m.kinetic_energy(q_h, v + h * a) + m.potential_energy(q_h)

    rate = (total(STEP) - total(-STEP)) / (2 * STEP)
    inputs = m.generalized_force(q, v, u) - m.generalized_force(q, v, 0 * u)
    np.testing.assert_allclose(rate, np.sum(v * inputs, axis=-1), atol=DIFFERENCE * np.abs(total(0.0)).max() * 10)


@pytest.mark.parametrize("seed", sampled(range(6), (1, 2)))
def test_prescribed_motion_is_a_partition_of_the_free_model(seed: int, rng: np.random.Generator) -> None:
    """Free speeds f and driven speeds d: M_ff v_f' + (h_f + M_fd v_d') is what the driven model has."""
    stated = random_tree(600 + seed, kinds=MORE_KINDS)
    index = next(i for i, body in enumerate(stated.bodies) if body.joint is not None and body.joint.kind != "fixed")
    body = stated.bodies[index]
    assert body.joint is not None
    driven = stated.with_bodies(replace(body, joint=replace(body.joint, prescribed=True, actuated=False)))
    whole, part = interpreted(stated), interpreted(driven)
    free = [whole.names.v.index(name) for name in part.names.v]
    held = [i for i in range(whole.nv) if i not in free]
    q_free = [whole.names.q.index(name) for name in part.names.q]
    q_held = [i for i in range(whole.nq) if i not in q_free]
    for _ in range(10):
        q, v = whole.random_state(rng)
        a = rng.standard_normal(whole.nv)
        u = part.record.u_default + np.zeros(part.nu)
        u[len(u) - len(q_held) - 2 * len(held) :] = np.concatenate([q[q_held], v[held], a[held]])
        M, h = whole.mass_matrix(q), whole.bias(q, v)
        given = {"u": u}
        np.testing.assert_allclose(part.mass_matrix(q[q_free], **given), M[np.ix_(free, free)], atol=1e-11)
        expected = h[free] + M[np.ix_(free, held)] @ a[held]
        scale = max(1.0, np.abs(expected).max())
        np.testing.assert_allclose(part.bias(q[q_free], v[free], **given), expected, atol=1e-12 * scale)
        assert part.kinetic_energy(q[q_free], v[free], **given) == pytest.approx(float(whole.kinetic_energy(q, v)))
        assert part.potential_energy(q[q_free], **given) == pytest.approx(float(whole.potential_energy(q)))
        frame = whole.names.frames[-1]
        np.testing.assert_allclose(
            part.frame_acceleration(frame, q[q_free], v[free], a[free], **given),
            whole.frame_acceleration(frame, q, v, a),
            atol=1e-11,
        )
        np.testing.assert_allclose(
            part.inverse_dynamics(q[q_free], v[free], a[free], **given), (M @ a + h)[free], atol=1e-11 * scale
        )


def test_prescribed_coordinates_are_named_inputs_and_default_to_rest() -> None:
    cart = sf.RigidBody("cart", sf.Joint("x", "prismatic", axis=(1, 0, 0), prescribed=True), SOLID)
    rod = sf.RigidBody("rod", sf.Joint("q", "revolute", "cart", axis=(0, 1, 0), actuated=True), SOLID)
    m = interpreted(sf.System("s", [cart, rod]))
    assert m.names.q == ("q",) and m.names.u == ("q", "x", "dx", "ddx")
    assert np.array_equal(m.bias([0.3], [0.0]), m.bias([0.3], [0.0], u=[0, 0, 0, 0]))
    # An accelerated support is a slanted gravity.
    slanted = interpreted(sf.System("s", [cart, rod], gravity=(-4.0, 0.0, -9.81)))
    np.testing.assert_allclose(m.bias([0.3], [0.0], u=[0, 0, 0, 4.0]), slanted.bias([0.3], [0.0]), rtol=1e-14)
