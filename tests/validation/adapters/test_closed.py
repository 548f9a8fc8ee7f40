"""Constraints beside joints of every kind, in every order: no adapter ends in an exception, and phi, G, gamma agree."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from itertools import permutations
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import symofros as sf
from symofros.expr.ops import FUNCTIONS
from validation.adapters import ROUTES, Missing
from validation.adapters.by_formula import _OPERATIONS, Series, motion
from validation.adapters.description import evaluate
from validation.checking import Settings, check
from validation.comparison.participants import _built
from validation.contract.interface import Engine, Subject, Unsupported
from validation.contract.quantities import CONSTRAINED, QUANTITIES
from validation.inputs.frames import chosen_frames
from validation.inputs.sampling import sample
from validation.mechanics.assembly import Assembly, assemble

SOLID = sf.Inertia(1.5, (0.1, -0.2, 0.05), (0.3, 0.4, 0.5))
KINDS = ("revolute", "ball", "free", "planar")
# Compiled by C, and so asked elsewhere; what is left builds in milliseconds.
ASKED = [name for name, route in ROUTES.items() if not route.reads and not route.beams and name != "vectors"]
# Rounding of a few products, relative to the largest entry of all states.
CLOSE = 1e-12
A, B = ("first", "e"), ("last", "e")
CONSTRAINTS: dict[str, sf.Constraint] = {
    "closure": sf.Closure("k", A, B),
    "weld": sf.Closure("k", A, B, ("x", "y", "z"), ("x", "y", "z")),
    "rod": sf.Rod("k", A, B, 1.5),
    "edge": sf.KnifeEdge("k", B),
    "rolling": sf.Rolling("k", B, 0.3),
    "coupling": sf.Coupling("k", "arm - 2*finger"),
    "coupling by functions": sf.Coupling("k", "atan2(arm, 2 + finger) + abs(arm) - max(arm, finger)*min(arm, 0.5)"),
    "coupling of a ball": sf.Coupling("k", "ball.qx*ball.qy - 0.3*arm"),
    "coupling of a free body": sf.Coupling("k", "free.px*free.qz - sin(arm)"),
    "condition on speeds": sf.Nonholonomic("k", {"darm": "1", "dfinger": "cos(arm)"}, "0.2*t"),
    "condition on speeds of all": sf.Nonholonomic(
        "k", {"ball.wx": "ball.qw", "free.vy": "free.px*free.qz", "darm": "abs(planar.angle)"}, "free.qx*t"
    ),
}


def subject(order: tuple[str, ...], constraint: sf.Constraint, in_series: bool = False) -> Subject:
    """An arm with a finger among joints in an order; the frames that constraints join are on the first and the last."""
    names = [{"revolute": "arm"}.get(kind, kind) for kind in order]
    bodies: list[sf.Body] = []
    for k, (kind, name) in enumerate(zip(order, names, strict=True)):
        body = {0: "first", len(order) - 1: "last"}.get(k, name)
        parent = bodies[-1].name if in_series and bodies else "world"
        frames = (sf.Frame("e", (0.4, 0.1 * k, -0.2), sf.Rotation.rpy(0.3, -0.5, 0.7)),)
        joint: Any = sf.Joint(name, kind, parent, position=(0.3 * k, 0.1, 0.2))  # type: ignore[arg-type]
        bodies.append(sf.RigidBody(body, joint, SOLID, frames))
        if kind == "revolute":
            finger = sf.Joint("finger", "revolute", body, position=(0.2, 0.0, 0.1), axis=(0.0, 1.0, 0.0))
            bodies.append(sf.RigidBody("finger", finger, SOLID))
    system = sf.System("joints", bodies, constraints=(constraint,))
    return Subject("joints", system, frames=chosen_frames(assemble(system)))


def engines(one: Subject, assembly: Assembly) -> dict[str, Engine]:
    built = {}
    for name in ASKED:
        if ROUTES[name].applies_to(one):
            factory = ROUTES[name].load()
            engine = Unsupported(factory.reason) if isinstance(factory, Missing) else None
            engine = engine or _built(ROUTES[name], factory, one, assembly)  # type: ignore[arg-type]
            if not isinstance(engine, Unsupported):
                built[name] = engine
    return built


@given(st.permutations(KINDS), st.sampled_from(sorted(CONSTRAINTS)), st.booleans())
@settings(max_examples=40)
def test_no_adapter_raises_whatever_the_order_of_joints(order: list[str], name: str, in_series: bool) -> None:
    one = subject(tuple(order), CONSTRAINTS[name], in_series)
    assembly = assemble(one.system)
    states = sample(assembly, 0, 12)
    found = engines(one, assembly)
    assert {"pinocchio", "mujoco", "exudyn", "interpreted", "description"} <= found.keys()
    values = {
        engine: {quantity: getattr(model, QUANTITIES[quantity].method or quantity)(states) for quantity in offered}
        for engine, model in found.items()
        if (offered := model.capabilities & QUANTITIES.keys())
    }
    ours = values["interpreted"]
    for engine in ("pinocchio", "mujoco", "exudyn"):
        for quantity in sorted(CONSTRAINED - {"multipliers"}):
            size = np.abs(ours[quantity]).max() + 1.0
            np.testing.assert_allclose(values[engine][quantity], ours[quantity], rtol=0, atol=CLOSE * size)


@pytest.mark.parametrize("last", ["ball", "free"])
@pytest.mark.parametrize("name", ["coupling", "condition on speeds"])
def test_a_condition_by_formula_beside_a_last_joint_with_a_quaternion_is_compared(last: str, name: str) -> None:
    found = check(subject(("revolute", last), CONSTRAINTS[name]), Settings(states=20))
    assert found.ok, [row for row in found.comparisons if not row.ok]
    assert {"pinocchio", "mujoco", "exudyn"} <= {row.engine for row in found.compared if row.quantity in CONSTRAINED}


@pytest.mark.parametrize("held", [(1.0, 1.0), (1.0, 0.0), (0.0, 1.0)])
def test_released_constraints_have_rows_of_zeros(held: tuple[float, float]) -> None:
    """Of engines that know trees; what closes loops by itself refuses where one is released."""
    one = subject(("revolute", "free"), CONSTRAINTS["rod"])
    names = ("taut", "geared")
    system = replace(
        one.system,
        parameters=tuple(sf.Parameter(name, value) for name, value in zip(names, held, strict=True)),
        constraints=(*one.system.constraints, sf.Closure("l", A, B)),
        switches=(sf.Switch("k", names[0], "moment"), sf.Switch("l", names[1])),
    )
    one = replace(one, system=system)
    assembly = assemble(system)
    states = sample(assembly, 0, 12)
    found = engines(one, assembly)
    assert {"pinocchio", "mujoco", "exudyn", "interpreted"} <= found.keys()
    assert ("exudyn-loops" in found) == (min(held) == 1.0)
    for quantity in sorted(CONSTRAINED - {"multipliers"}):
        ours = getattr(found["interpreted"], QUANTITIES[quantity].method or quantity)(states)
        for engine in ("pinocchio", "mujoco", "exudyn"):
            theirs = getattr(found[engine], QUANTITIES[quantity].method or quantity)(states)
            np.testing.assert_allclose(theirs, ours, rtol=0, atol=CLOSE * (np.abs(ours).max() + 1.0))
    G = found["interpreted"].constraint_jacobian(states)  # type: ignore[attr-defined]
    assert [bool(np.abs(G[:, rows]).max() > 0.0) for rows in (0, slice(1, 4))] == [share == 1.0 for share in held]


@pytest.mark.parametrize("order", list(permutations(("ball", "free", "planar"), 2)))
def test_coordinates_move_as_the_models_do(order: tuple[str, str]) -> None:
    """The third order is left: a tenth of the time leaves a thousandth."""
    one = subject(("revolute", *order), CONSTRAINTS["coupling"])
    assembly = assemble(one.system)
    model = sf.compile(one.system, sf.Options(backend="interpreter"))
    states = sample(assembly, 0, 8)
    moving = motion(assembly, states.q, states.v)
    left = []
    for time in (1e-2, 1e-3):
        wanted = np.array([model.integrate(q, time * v) for q, v in zip(states.q, states.v, strict=True)])
        left.append(np.abs(moving.value + time * moving.first + time**2 * moving.second - wanted).max())
    assert left[1] < 2e-3 * left[0]


FORMULAS = (
    *(f"{name}(x)" for name in FUNCTIONS if FUNCTIONS[name].arity == 1 and name not in ("asin", "acos", "sign")),
    *("asin(x - 1)", "acos(x - 1)", "sign(x)*x", "atan2(x, y)", "atan2(y*y, -x)", "min(x, y)", "max(x*y, 2*y)"),
    *("x/y", "x^3", "(x - 1)^2", "x^1", "x^y", "x^(-2)", "2^x", "-x - y*y/3"),
)


@pytest.mark.parametrize("formula", FORMULAS)
def test_series_of_every_function_follow_its_values(formula: str) -> None:
    """First and second derivatives of what a coupling states, against differences of its values."""
    evaluated = partial(evaluate, sf.Coupling("k", formula).residual)
    x, y, dx, dy = 1.3, 0.7, -0.4, 0.9
    series = evaluated({"x": Series(x, dx, 0.2), "y": Series(y, dy, -0.3)}, _OPERATIONS)

    def at(s: float) -> float:
        return float(evaluated({"x": x + s * dx + 0.2 * s * s, "y": y + s * dy - 0.3 * s * s}))

    h = 1e-3
    first = (8 * (at(h) - at(-h)) - at(2 * h) + at(-2 * h)) / (12 * h)
    second = (16 * (at(h) + at(-h)) - 30 * at(0) - at(2 * h) - at(-2 * h)) / (24 * h * h)
    assert tuple(map(float, series)) == pytest.approx((at(0), first, second), rel=1e-8, abs=1e-8)


def test_powers_are_differentiated_at_zero() -> None:
    for exponent, wanted in ((1, (0.0, 2.0, 0.0)), (2, (0.0, 0.0, 4.0)), (3, (0.0, 0.0, 0.0))):
        assert tuple(map(float, _OPERATIONS["pow"](Series(0.0, 2.0), exponent))) == wanted
