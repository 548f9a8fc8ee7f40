"""Lanes of floats: sines over the whole range, functions against doubles within bounds of their depth, float32 arrays.

A sum of terms is right to eps_32 of the largest of them and of each rounding beneath; its own value does not matter.
"""

from __future__ import annotations

from functools import cache

import mpmath
import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.compiler import program_of
from symofros.expr.numerics.trigonometry import FAR
from symofros.runtime.build.toolchain import DEFAULT_FLAGS, cpu_identity
from tests.models import sampled

EPS = float(np.finfo(np.float32).eps)
# Measured: 0.83 without fused operations, 0.77 with them.
ULPS = 0.85
WIDTHS = {
    "four": ("-O2",),
    # On any processor, by the macros that choose, as in test_lanes.py.
    "eight": ("-O2", "-Wno-psabi", "-D__AVX__=1"),
    "sixteen": ("-O2", "-Wno-psabi", "-D__AVX512F__=1"),
    "avx": ("-O2", "-mavx2", "-mfma"),
    "native": DEFAULT_FLAGS,
    "strict": (*DEFAULT_FLAGS, "-ffp-contract=off"),
}


def has(width: str) -> bool:
    return "-mavx2" not in WIDTHS[width] or "avx2" in cpu_identity()


@cache
def sines(width: str) -> sf.Model:
    """Forces that are the sine and the cosine of an input."""
    bodies = [
        sf.RigidBody(f"b{i}", sf.Joint(f"x{i}", "prismatic", effort=(text,)), sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)))
        for i, text in enumerate(("sin(u0)", "cos(u0)"))
    ]
    flags = WIDTHS[width]
    return sf.compile(sf.System("sines", bodies, inputs=[sf.Input("u0")]), sf.Options(flags=flags)).with_precision(
        "single"
    )


def angles(kind: str) -> np.ndarray:
    rng = np.random.default_rng(0)
    if kind == "of a turn":
        return rng.uniform(-7.0, 7.0, 20_000)
    if kind == "next to multiples of pi/2":
        exact = np.arange(1, 63_661, 7) * (np.pi / 2)
        near = exact.astype(np.float32)
        return np.concatenate([near, np.nextafter(near, np.float32(0.0)), np.nextafter(near, np.float32(1e9))])
    if kind == "near":
        return rng.uniform(-FAR, FAR, 20_000)
    if kind == "tiny":
        return np.ldexp(rng.uniform(0.5, 1.0, 4000), rng.integers(-148, 1, 4000))
    return np.ldexp(rng.uniform(0.5, 1.0, 4000), rng.integers(16, 128, 4000))


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("kind", ["of a turn", "next to multiples of pi/2", "near", "tiny", "far"])
def test_single_precision_sines_and_cosines_are_accurate(kind: str, width: str) -> None:
    """Of floats as they are; doubles are right to 29 digits more, so that they can judge."""
    if not has(width):
        pytest.skip("a processor without these vectors")
    u = angles(kind).astype(np.float32)
    found = sines(width).generalized_force(np.zeros(2), np.zeros(2), u[:, None])
    exact = u.astype(np.float64)
    with mpmath.workdps(60):  # The system's library may be off far away.
        expected = (
            np.array([[float(f(x)) for f in (mpmath.sin, mpmath.cos)] for x in exact.tolist()])
            if kind == "far"
            else np.stack([np.sin(exact), np.cos(exact)], axis=1)
        )
    last = np.spacing(np.abs(expected).astype(np.float32)).astype(np.float64)
    assert found.dtype == np.float32
    assert np.max(np.abs(found - expected) / last) <= ULPS


def test_sine_of_non_finite_angles_is_nan() -> None:
    u = np.array([np.inf, -np.inf, np.nan, -0.0, 0.0], dtype=np.float32)[:, None]
    found = sines("native").generalized_force(np.zeros(2), np.zeros(2), u)
    assert np.isnan(found[:3]).all() and np.array_equal(found[3:], [[0.0, 1.0], [0.0, 1.0]])
    assert np.signbit(found[3, 0]) and not np.signbit(found[4, 0])


def depth(system: sf.System, function: str) -> int:
    """The longest way from an input to an output, in operations; sines and cosines count their rounding twice."""
    program = program_of(system, (function,))
    graph, reach = program.graph, dict[int, int]()
    for node in range(1, len(graph.op)):
        below = max((reach.get(abs(arg), 0) for arg in graph.args[node]), default=0)
        reach[node] = below + {"sin": 2, "cos": 2}.get(graph.op[node], 1) * bool(graph.args[node])
    return max(reach[abs(edge)] for edge in program.functions[0].edges() if abs(edge) in reach)


@pytest.mark.parametrize("name", sampled(("chain7", "rx90", "planar_robot"), ("planar_robot",)))
@pytest.mark.parametrize("function", ["mass_matrix", "bias", "inverse_dynamics", "kinetic_energy"])
def test_single_precision_errors_stay_within_the_rounding_bound(name: str, function: str) -> None:
    """Each operation on the way adds eps_32 / 2 of a term; terms are at most some times the largest result."""
    m = sf.compile(MODELS[name])
    rng = np.random.default_rng(3)
    single = {
        key: rng.uniform(-1.5, 1.5, (300, size)).astype(np.float32)
        for key, size in (("q", m.nq), ("v", m.nv), ("a", m.nv))
    }
    taken = {"mass_matrix": "q", "bias": "qv", "inverse_dynamics": "qva", "kinetic_energy": "qv"}[function]
    arguments = [single[key] for key in taken]
    found = getattr(m.with_precision("single"), function)(*arguments)
    expected = getattr(m, function)(*(x.astype(np.float64) for x in arguments))
    scale = np.abs(expected).max()
    assert found.dtype == np.float32 and found.shape == expected.shape
    error = float(np.abs(found - expected).max() / scale)
    assert EPS / 100 < error < EPS / 2 * depth(MODELS[name], function), "neither doubles nor worse than floats"


def test_single_precision_error_grows_with_the_condition_of_m() -> None:
    m = sf.compile(MODELS["chain7"])
    rng = np.random.default_rng(1)
    q, v = rng.uniform(-1.0, 1.0, (2, 400, 7)).astype(np.float32)
    found = m.with_precision("single").forward_dynamics(q, v, None)
    expected = m.forward_dynamics(q.astype(np.float64), v.astype(np.float64), None)
    condition = np.linalg.cond(m.mass_matrix(q.astype(np.float64)))
    error = np.abs(found - expected).max(axis=1) / np.abs(expected).max(axis=1)
    assert np.all(error < 10.0 * EPS * condition) and error.max() > EPS


@pytest.mark.parametrize("width", ["four", "eight", "sixteen"])
def test_single_precision_takes_and_returns_float32(width: str) -> None:
    m = sf.compile(MODELS["friction_arm"], sf.Options(("mass_matrix", "dynamics"), flags=WIDTHS[width]))
    m = m.with_precision("single")
    rng = np.random.default_rng(2)
    for n in (1, 2, 15, 16, 17, 100):
        q, v, u = (rng.uniform(-1.0, 1.0, (n, size)).astype(np.float32) for size in (m.nq, m.nv, m.nu))
        whole = m.dynamics(q, v, u)
        columns = m.dynamics(*map(np.asfortranarray, (q, v, u)))
        one_by_one = [m.dynamics(*state) for state in zip(q, v, u, strict=True)]
        for k, found in enumerate(whole):
            assert found.dtype == np.float32 and np.array_equal(columns[k], found)
            assert np.array_equal(found, np.stack([state[k] for state in one_by_one]))  # At any size of a batch.
    assert m.precision == "single" and m.with_threads(2).precision == "single"
    assert m.with_precision("double").mass_matrix(q).dtype == np.float64


def test_batches_of_motions_take_accelerations_in_floats() -> None:
    m = sf.compile(MODELS["chain7"])
    rng = np.random.default_rng(5)
    q, v = rng.uniform(-0.5, 0.5, (2, 20, 7))
    exact, coarse = (sf.simulate_batch(one, q, v, 0.2, dt=1e-3) for one in (m, m.with_precision("single")))
    error = np.abs(exact.q_last - coarse.q_last).max()
    assert coarse.q_last.dtype == np.float64 and 1e-9 < error < 1e-5
    alone = sf.simulate_batch(m.with_precision("single"), q[:1], v[:1], 0.2, dt=1e-3)
    assert np.array_equal(alone.q_last[0], coarse.q_last[0])
