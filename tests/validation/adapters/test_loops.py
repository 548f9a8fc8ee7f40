"""Engines that close loops themselves; reference models with loops are compared by `check`."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from reference_models.closed.spatial import delta
from tests.models import sampled
from validation.adapters.exudyn import loops as exudyn_loops
from validation.adapters.pinocchio import loops as pinocchio_loops
from validation.checking import Settings, check
from validation.comparison.loops import FUNCTIONS, assembled_states
from validation.contract.interface import Subject, Unsupported
from validation.contract.quantities import LOOPS
from validation.inputs.sampling import sample
from validation.mechanics.assembly import assemble

REPRESENTED = (
    "four_bar",
    "two_four_bars",
    "slider_crank",
    "andrews_squeezer",
    "parallelogram",
    "bricard",
    "stewart",
    "delta_rods",
    "grasp",
)
# With a slide, with conditions that repeat each other; in space, closures of every kind below.
SMALL = ("slider_crank", "parallelogram")
PINOCCHIO = Settings(states=40, engines=("pinocchio-loops",))
EXUDYN = Settings(states=40, engines=("exudyn-loops",))
SOLID = sf.Inertia(1.5, (0.1, -0.2, 0.05), (0.3, 0.4, 0.5))


def test_exudyn_sees_an_open_loop() -> None:
    """Its conditions at a posture that is not closed are as large as ours."""
    subject = Subject("four_bar", MODELS["four_bar"])
    engine = exudyn_loops.build(subject)
    assert isinstance(engine, exudyn_loops.JointedEngine)
    states = sample(assemble(subject.system), 0, 5)
    m = sf.compile(subject.system, sf.Options(functions=("constraint",), backend="interpreter"))
    apart = np.abs(np.array([m.constraint(q) for q in states.q]))
    # Ours are along the first frame's axes, as Exudyn's are.
    assert engine.closure_gap(states) == pytest.approx(apart.max(axis=1), abs=1e-12)


@pytest.mark.parametrize("name", sampled(REPRESENTED, SMALL))
def test_states_keep_the_constraints(name: str) -> None:
    system = MODELS[name]
    m = sf.compile(system, sf.Options(functions=FUNCTIONS))
    states = assembled_states(system, sample(assemble(system), m.nu, 60))
    assert 10 <= len(states) <= 40
    assert np.abs(m.constraint(states.q)).max() < 1e-11
    assert np.abs(m.constraint_rate(states.q, states.v)).max() < 1e-9 * (1 + np.abs(states.v).max())


def two_balls(*closures: sf.Constraint, kind: str = "ball") -> Subject:
    bodies = [
        sf.RigidBody(name, sf.Joint(f"j{name}", kind, position=(x, 0, 0)), SOLID, (sf.Frame("e", (0.5, 0, 0)),))
        for name, x in (("a", 0.0), ("b", 1.0))
    ]
    return Subject("two", sf.System("two", bodies, constraints=closures))


A, B = ("a", "e"), ("b", "e")


@pytest.mark.parametrize(
    ("constraint", "reason"),
    [
        (sf.Rod("k", A, B, 1.0), "no Rod"),
        (sf.KnifeEdge("k", A), "no KnifeEdge"),
        (sf.Closure("k", A, B, (), ("x",)), "neither a point, a hinge nor a weld"),
        (sf.Closure("k", A, B, ("x", "y"), ("x", "y", "z")), "neither a point, a hinge nor a weld"),
        (sf.Closure("k", A, B, ("x", "y")), "leaves a direction free in which the bodies do move"),
    ],
)
def test_constraints_that_pinocchio_lacks_are_named(constraint: sf.Constraint, reason: str) -> None:
    found = pinocchio_loops.build(two_balls(constraint))
    assert isinstance(found, Unsupported) and reason in found.reason


@pytest.mark.parametrize(
    ("subject", "reason"),
    [
        (two_balls(sf.KnifeEdge("k", A)), "no KnifeEdge"),
        (two_balls(sf.Closure("k", A, B, (), ("x",))), "one blocked rotation is an angle to Exudyn"),
        (two_balls(sf.Rod("k", A, B, 1.0), kind="screw"), "no screw joint"),
    ],
)
def test_models_that_exudyn_cannot_represent_are_named(subject: Subject, reason: str) -> None:
    found = exudyn_loops.build(subject)
    assert isinstance(found, Unsupported) and reason in found.reason


@pytest.mark.slow
def test_a_loop_that_cannot_close_is_not_compared() -> None:
    """The frames are a metre apart at the nearest."""
    far = sf.Closure("k", ("world", None), ("b", "e"))
    system = two_balls(far).system
    bodies = [
        system.bodies[0],
        sf.RigidBody("b", sf.Joint("jb", "ball", position=(3, 0, 0)), SOLID, (sf.Frame("e", (0.5, 0, 0)),)),
    ]
    found = check(Subject("far", sf.System("far", bodies, constraints=(far,))), PINOCCHIO)
    assert not found.ok
    assert "no random state leads to a posture" in found.comparisons[0].note


@pytest.mark.parametrize(
    "rotations",
    sampled(((), ("x", "y"), ("y", "z"), ("x", "z"), ("x", "y", "z")), [("x", "y")]),
)
@pytest.mark.parametrize("settings", [PINOCCHIO, EXUDYN], ids=["pinocchio", "exudyn"])
def test_every_kind_of_closure_agrees_with_pinocchio_and_exudyn(rotations: tuple[Any, ...], settings: Settings) -> None:
    """Between floating bodies with turned frames: no symmetry hides a sign or an axis."""
    turned = (sf.Frame("e", (0.4, 0.1, -0.2), sf.Rotation.rpy(0.3, -0.5, 0.7)),)
    bodies = [
        sf.RigidBody("a", sf.Joint("float", "free"), SOLID, turned),
        sf.RigidBody("b", sf.Joint("s", "cylindrical", "a", axis=(1, 2, 2)), SOLID),
        sf.RigidBody("c", sf.Joint("t", "free", "b", position=(0.2, 0, 0.3)), SOLID, (sf.Frame("f", (0, 0.3, 0)),)),
        sf.RigidBody("d", sf.Joint("o", "ball", "c", position=(0.1, 0.2, 0)), SOLID),
    ]
    closure = sf.Closure("k", ("a", "e"), ("c", "f"), ("x", "y", "z"), rotations)
    found = check(Subject("k", sf.System("k", bodies, constraints=(closure,))), settings)
    assert found.ok, found.comparisons
    assert {row.quantity for row in found.comparisons} <= {*LOOPS, "forward_dynamics", "multipliers"}
    assert max(row.error or 0.0 for row in found.comparisons) < 1e-10


def test_rods_without_mass_are_the_limit_of_light_ones() -> None:
    """Pinocchio has no condition on a distance; rods of 1, 2, 3 and 4 g extrapolate to none, to the fourth order."""
    in_python = sf.Options(backend="interpreter")
    massless = sf.compile(MODELS["delta"], in_python)
    rng, guess = np.random.default_rng(5), [0.2, -0.1, 0.1, 0.0, 0.0, -0.55, 0.0, 0.0, 0.0, 1.0]
    at = sf.assemble(massless, guess, rng.normal(size=massless.nv))
    torque = rng.normal(size=massless.nu)
    wanted = massless.forward_dynamics(at.q, at.v, torque)
    found = []
    for grams in (1, 2, 3, 4):
        system = delta(rod_mass=1e-3 * grams)
        m = sf.compile(system, in_python)
        same_q = [m.names.q.index(name) for name in massless.names.q]
        same_v = [m.names.v.index(name) for name in massless.names.v]
        q, v = m.neutral(), np.zeros(m.nv)
        q[same_q], v[same_v] = at.q, at.v
        here = sf.assemble(m, q, v, held=massless.names.v)
        a = _accelerations(Subject("delta_rods", system), m, here, torque)
        found.append(a[same_v])
    limit = np.array([4.0, -6.0, 4.0, -1.0]) @ found
    # A gram changes them by 1e-3, and the fourth power of that is left.
    assert np.abs(found[0] - wanted).max() > 1e-4 * np.abs(wanted).max()
    assert np.abs(limit - wanted).max() < 1e-8 * np.abs(wanted).max()


def _accelerations(subject: Subject, m: sf.Model, at: Any, torque: np.ndarray) -> np.ndarray:
    """Pinocchio's, in one state."""
    engine = pinocchio_loops.build(subject)
    assert isinstance(engine, pinocchio_loops.LoopEngine)
    states = sample(assemble(subject.system), m.nu, 1)
    force = m.generalized_force(at.q, at.v, torque)
    one = type(states)(at.q[None], at.v[None], states.a, torque[None], force[None], force[None])
    return engine.forward_dynamics(one)[0]
