"""Masses, lengths and inertias from 1e-9 to 1e9: forward dynamics under constraints against fifty digits."""

from __future__ import annotations

from functools import cache

import mpmath
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import symofros as sf

DIGITS = mpmath.MPContext()
DIGITS.dps = 50

NAMES = ("mass", "plate", "disc", "arm", "crank", "turning", "rod", "slide", "wheel", "pinion", "radius")
FORMS = ("multipliers", "null_space")
# Of the bound of rounding errors: Gram-Schmidt in the metric of M may lose the four digits of SYM_POOR.
ROUNDING = 1e-11


def workshop(*, repeated: bool) -> sf.System:
    """Mechanisms of unlike sizes: a weight that is held, a plate on a pin, a slider-crank, a gear and rack.

    Args:
        repeated: Whether the slider-crank's loop is closed in space, with conditions that repeat others.
    """
    rod_end = sf.Frame("end", ("crank", 0, 0))
    bodies = (
        sf.RigidBody("weight", sf.Joint("z", "prismatic", axis=(0, 0, 1)), sf.Inertia("mass")),
        sf.RigidBody(
            "plate",
            sf.Joint("pl", "planar"),
            sf.Inertia("plate", (0, 0, 0), ("disc", "disc", "disc")),
            (sf.Frame("pin", ("arm", 0, 0)),),
        ),
        sf.RigidBody("crank", sf.Joint("q1", "revolute"), sf.Inertia("mass", (0, 0, 0), ("turning",) * 3), (rod_end,)),
        sf.RigidBody(
            "rod",
            sf.Joint("q2", "revolute", "crank", "end"),
            sf.Inertia("rod", (0, 0, 0), ("turning",) * 3),
            (rod_end,),
        ),
        sf.RigidBody("slider", sf.Joint("x", "prismatic", axis=(1, 0, 0)), sf.Inertia("slide")),
        sf.RigidBody("wheel", sf.Joint("q3", "revolute"), sf.Inertia("mass", (0, 0, 0), ("wheel",) * 3)),
        sf.RigidBody("rack", sf.Joint("y", "prismatic", axis=(0, 1, 0)), sf.Inertia("pinion")),
    )
    constraints = (
        sf.Closure("held", ("world", None), ("weight", None), ("z",)),
        sf.Closure("pin", ("world", None), ("plate", "pin"), ("x", "y")),
        sf.Closure(
            "loop", ("slider", None), ("rod", "end"), ("x", "y", "z") if repeated else ("x", "y"), ("x",) * repeated
        ),
        sf.Nonholonomic("rack", {"dy": 1.0, "dq3": "-radius"}),
    )
    parameters = tuple(sf.Parameter(name, 1.0) for name in NAMES)
    # Gravity is along no coordinate axis, so that each mechanism feels it.
    return sf.System("workshop", bodies, parameters, constraints=constraints, gravity=(1.0, -2.0, -9.81))


@cache
def model(form: str, repeated: bool) -> sf.Model:
    return sf.compile(workshop(repeated=repeated), sf.Options(constraints=form))  # type: ignore[arg-type]


def state(scales: dict[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """Closed, and moving: plate, crank and wheel turn."""
    at = {"pl.px": 0.0, "q1": 0.7, "q2": -1.4, "x": 2 * scales["crank"] * np.cos(0.7)}
    m = model("multipliers", False)
    q = np.array([at.get(name, 0.0) for name in m.names.q])
    turn, arm = 0.4, scales["arm"]
    for name, value in zip([n for n in m.names.q if n.startswith("pl")], (0.0, 0.0, turn), strict=True):
        q[m.names.q.index(name)] = value
    first = next(i for i, n in enumerate(m.names.q) if n.startswith("pl"))
    q[first], q[first + 1] = -arm * np.cos(turn), -arm * np.sin(turn)
    return q, np.zeros(m.nv)


def extended(M: np.ndarray, r: np.ndarray, G: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(a; lam) of M a = r + G^T lam, G a = c, and the size of rounding errors of each, by Skeel's bound."""
    n, m = len(r), len(c)
    K = DIGITS.matrix(np.block([[M, -G.T], [G, np.zeros((m, m))]]).tolist())
    right = DIGITS.matrix([*r.tolist(), *c.tolist()])
    inverse = DIGITS.inverse(K)
    x = inverse * right
    sizes = [sum(abs(K[i, j] * x[j]) for j in range(n + m)) + abs(right[i]) for i in range(n + m)]
    bound = [float(sum(abs(inverse[i, j]) * sizes[j] for j in range(n + m))) for i in range(n + m)]
    return np.array([float(value) for value in x]), np.array(bound)


exponents = st.fixed_dictionaries({name: st.floats(-9.0, 9.0) for name in NAMES})
ONES = dict.fromkeys(NAMES, 0.0)


@pytest.mark.parametrize("repeated", [False, True], ids=["independent", "repeated"])
@pytest.mark.parametrize("form", FORMS)
@settings(max_examples=12)
@example(exponents=ONES)
@example(exponents=ONES | {"mass": 4.0, "turning": -9.1, "disc": -9.1})  # Rows of 1e-2 beside rows of 3e4.
@example(exponents=ONES | {"plate": 9.0, "disc": -9.0})  # Rows that are parallel in the metric of M, but not in G.
@example(exponents=ONES | {"plate": -9.0, "disc": 9.0, "arm": -9.0})
@example(exponents=ONES | {"crank": -9.0, "arm": 9.0, "radius": -9.0})
@given(exponents=exponents)
def test_accelerations_and_multipliers_match_extended_precision_at_any_scale(
    form: str, repeated: bool, exponents: dict[str, float]
) -> None:
    scales = {name: 10.0**exponent for name, exponent in exponents.items()}
    m, plain = (model(f, w).with_parameters(**scales) for f, w in ((form, repeated), ("multipliers", False)))
    q, v = state(scales)
    a, lam, rank = m.constrained_dynamics(q, v, [])
    M, h, Q = plain.dynamics(q, v, [])
    expected, bound = extended(M, Q - h, plain.constraint_jacobian(q), plain.constraint_bias(q, v))
    kept = [m.names.constraints.index(name) for name in plain.names.constraints]
    assert rank == plain.nc
    # By multipliers, rounding of the accelerations that forces alone would give stays in those of the constraints.
    bound[: m.nv] += np.abs(Q - h) / np.diag(M)
    error = np.abs(np.concatenate([a, lam[kept]]) - expected)
    assert np.all(error <= ROUNDING * bound), np.column_stack([expected, error, bound]).tolist()


@pytest.mark.parametrize("exponent", [-9, -6, -3, 0, 3, 6, 9])
def test_loops_close_to_the_digits_of_their_own_size(exponent: int) -> None:
    """A slider-crank whose rod is turned by 1e-3 rad closes as one of a metre does."""
    m = model("multipliers", False).with_parameters(crank=10.0**exponent)
    q, v = state(dict.fromkeys(NAMES, 1.0) | {"crank": 10.0**exponent})
    q[m.names.q.index("q2")] += 1e-3
    for closed in (m.project(q, v)[0], sf.assemble(m, q, v).q):
        q1, q2, x = (closed[m.names.q.index(name)] for name in ("q1", "q2", "x"))
        assert q2 == pytest.approx(-2 * q1, abs=1e-9) and abs(q1 - 0.7) < 2e-3
        assert x == pytest.approx(2 * 10.0**exponent * np.cos(q1), rel=1e-9)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("far", [0.0, 1e4])
def test_a_planar_loop_closed_in_space_keeps_its_freedom_whatever_its_axis(form: str, far: float) -> None:
    """Bars about parallel oblique axes, near the origin or far away: one of three conditions repeats the others."""
    n, e, away = (2 / 7, 3 / 7, 6 / 7), (0.6, -0.8, 0.0), (far, -far, far)
    side = np.cross(n, e)
    along = np.array(e) - np.dot(e, n) * np.array(n)
    end = tuple((along + 0.3 * side).tolist())
    solid = sf.Inertia(1.5, tuple(0.5 * x for x in end), (0.3, 0.4, 0.5))
    frames = (sf.Frame("e", end),)
    bodies = (
        sf.RigidBody("a", sf.Joint("q1", "revolute", position=away, axis=n), solid, frames),
        sf.RigidBody("b", sf.Joint("q2", "revolute", "a", "e", axis=n), solid, frames),
        sf.RigidBody("c", sf.Joint("q3", "revolute", "b", "e", axis=n), solid, frames),
        sf.RigidBody("d", sf.Joint("q4", "revolute", position=away, axis=n), solid, frames),
    )
    loop = sf.Closure("loop", ("d", "e"), ("c", "e"), ("x", "y", "z"))
    options = sf.Options(constraints=form, backend="interpreter")  # type: ignore[arg-type]
    m = sf.compile(sf.System("s", bodies, constraints=(loop,)), options)
    q = np.array([0.3, 1.2, -2.4, 0.3])
    q = sf.assemble(m, q, held=("q1",)).q
    a, lam, rank = m.constrained_dynamics(q, np.zeros(4), [])
    assert rank == 2
    M, h, Q = m.dynamics(q, np.zeros(4), [])
    G = m.constraint_jacobian(q)
    Z = np.linalg.svd(G)[2][2:].T
    assert a == pytest.approx(Z @ np.linalg.solve(Z.T @ M @ Z, Z.T @ (Q - h)), rel=1e-9, abs=1e-9)
    assert np.linalg.norm(lam) < 1e3
