"""Derivatives of motions: adjoint, forward sensitivities and complex steps agree to rounding."""

from __future__ import annotations

import math

import numpy as np
import pytest

import symofros as sf
from symofros.runtime import manifold
from symofros.runtime.record import ModelRecord, Segment
from symofros.simulation.analysis.chart_derivatives import chart_slopes
from tests.models import model
from tests.simulation.mechanisms import turned

METHODS = ("euler", "semi_implicit_euler", "rk4")
N, H = 60, 0.02


@pytest.fixture(params=METHODS)
def method(request: pytest.FixtureRequest) -> str:
    return request.param


def pendulum() -> sf.Model:
    """Mass m at the distance L of a driven, damped hinge: m L^2 a = u - d v - m g L sin(q + pi/2), by hand."""
    joint = sf.Joint("j", "revolute", axis=(0, 1, 0), actuated=True, elements=(sf.Damper("d"),))
    body = sf.RigidBody("b", joint, sf.Inertia("m", ("L", 0, 0)))
    parameters = [sf.Parameter("m", 1.3), sf.Parameter("L", 0.7), sf.Parameter("d", 0.2)]
    return sf.compile(sf.System("p", [body], parameters=parameters))


def by_hand(x: np.ndarray, u: np.ndarray, par: np.ndarray, method: str) -> np.ndarray:
    """The state (2) after the steps, of complex numbers as well."""
    m, L, d = par

    def slope(x: np.ndarray, force: complex) -> np.ndarray:
        return np.array([x[1], (force - d * x[1] + 9.81 * m * L * np.cos(x[0])) / (m * L * L)])

    for force in u:
        k1 = slope(x, force)
        if method == "euler":
            x = x + H * k1
        elif method == "semi_implicit_euler":
            v = x[1] + H * k1[1]
            x = np.array([x[0] + H * v, v])
        else:
            k2 = slope(x + 0.5 * H * k1, force)
            k3 = slope(x + 0.5 * H * k2, force)
            k4 = slope(x + H * k3, force)
            x = x + H / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return x


def test_the_gradient_matches_complex_steps(method: str, rng: np.random.Generator) -> None:
    m, u = pendulum(), rng.normal(size=N)
    names = {name: m.names.par.index(name) for name in ("m", "L", "d")}
    given = u[:, None].copy()
    run = sf.rollout(m, [0.4], [-0.3], given, H, method=method)
    given[:] = 1e3  # Inputs that are changed after the motion change no derivative.
    z = np.concatenate([[0.4, -0.3], [1.3, 0.7, 0.2], u]).astype(complex)
    w = np.array([0.8, -1.1])
    np.testing.assert_allclose([run.q[-1, 0], run.v[-1, 0]], by_hand(z[:2], z[5:], z[2:5], method).real, rtol=1e-12)
    expected = []
    for k in range(len(z)):
        moved = z.copy()
        moved[k] += 1e-30j
        expected.append((w @ by_hand(moved[:2], moved[5:], moved[2:5], method)).imag / 1e-30)
    g = run.gradient([w[0]], [w[1]])
    got = np.concatenate([g.q0, g.v0, g.par[[names[name] for name in ("m", "L", "d")]], g.u[:, 0]])
    np.testing.assert_allclose(got, expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max())


# Trees with balls and free joints: at the base, alone, and beyond other joints; derivatives of the last are long in C.
FLOATING = ("heavy_top", "torque_free_body", "parametrised1")


def of(case: str) -> sf.Model:
    return model(case, "interpreter" if case == "parametrised1" else "c")


@pytest.mark.parametrize("case", ["double_pendulum", *FLOATING])
def test_adjoint_and_forward_sensitivities_are_transposes(method: str, case: str, rng: np.random.Generator) -> None:
    m, n = of(case), 20
    u = rng.normal(size=(n, m.nu))
    q0 = m.integrate(m.neutral(), 0.3 * rng.normal(size=m.nv))
    run = sf.rollout(m, q0, 0.1 * rng.normal(size=m.nv), u, 0.005, method=method)
    sizes = {"dq0": (m.nv, 2), "dv0": (m.nv, 2), "du": (n, m.nu, 2), "dpar": (m.npar, 2)}
    d = {name: rng.normal(size=shape) for name, shape in sizes.items()}
    q_bar, v_bar = rng.normal(size=(2, n + 1, m.nv))
    changes = run.tangents(**d)
    forward = np.einsum("ni,nik->k", q_bar, changes.q) + np.einsum("ni,nik->k", v_bar, changes.v)
    g = run.gradient(q_bar, v_bar)
    backward = g.q0 @ d["dq0"] + g.v0 @ d["dv0"] + np.einsum("ni,nik->k", g.u, d["du"]) + g.par @ d["dpar"]
    terms = sum(np.abs(part).sum() for part in g)
    np.testing.assert_allclose(backward, forward, rtol=1e-12, atol=1e-12 * terms)


@pytest.mark.parametrize("case", FLOATING)
def test_the_gradient_of_turning_bodies_matches_differences(method: str, case: str, rng: np.random.Generator) -> None:
    """With weights of the quaternions' coordinates, along a random change of start, speeds, inputs and parameters."""
    m, n = of(case), 10
    q0, v0 = m.random_state(rng)
    u, par = rng.normal(size=(n, m.nu)), m.parameter_values
    q_bar, v_bar = rng.normal(size=(n + 1, m.nq)), rng.normal(size=(n + 1, m.nv))
    d = [rng.normal(size=size) for size in (m.nv, m.nv, (n, m.nu), m.npar)]
    d[3] *= 0.01

    def weighed(s: float) -> float:
        moved = m.integrate(q0, s * d[0]), v0 + s * d[1], u + s * d[2]
        run = sf.rollout(m, *moved, H, method=method, par=par + s * d[3])
        return float((q_bar * run.q).sum() + (v_bar * run.v).sum())

    g = sf.rollout(m, q0, v0, u, H, method=method).gradient(q_bar, v_bar)
    slope = sum(float((part * change).sum()) for part, change in zip(g, d, strict=True))
    coarse, fine = ((weighed(h) - weighed(-h)) / (2 * h) for h in (4e-4, 2e-4))
    terms = sum(float(np.abs(part * change).sum()) for part, change in zip(g, d, strict=True))
    # Errors of second order cancel; those of fourth and the rounding of differences remain.
    assert (4 * fine - coarse) / 3 == pytest.approx(slope, abs=1e-8 * terms)


@pytest.mark.parametrize("scale", [1e-3, 0.05, 1.0])
def test_chart_derivatives_match_differences(scale: float, rng: np.random.Generator) -> None:
    """On both sides of the angle where a series takes over."""
    segments = (Segment("linear", 0, 0, 1), Segment("pose", 1, 1, 7), Segment("quaternion", 8, 7, 4))
    nv, h = 10, 1e-5
    q0, _ = manifold.random_state(record_of(segments), rng)
    theta, v = scale * rng.normal(size=nv), rng.normal(size=nv)
    q = manifold.retract(segments, q0, theta)

    def moved(start: np.ndarray, chart: np.ndarray) -> np.ndarray:
        return manifold.difference(
            segments, q, manifold.retract(segments, manifold.integrate(segments, q0, start), theta + chart)
        )

    zero = np.zeros(nv)
    functions = (
        lambda x: moved(x, zero),
        lambda x: moved(zero, x),
        lambda x: manifold.chart_rate(segments, theta + x, v),
        lambda x: manifold.chart_rate(segments, theta, v + x),
    )
    for found, f in zip(chart_slopes(segments, theta, v), functions, strict=True):
        right = np.column_stack([(f(h * e) - f(-h * e)) / (2 * h) for e in np.eye(nv)])
        np.testing.assert_allclose(found.times((), np.eye(nv)), right, atol=1e-9)
        x = rng.normal(size=nv)
        np.testing.assert_allclose(found.transposed_times((), x), found.times((), np.eye(nv)).T @ x, atol=1e-13)


def record_of(segments: tuple[Segment, ...]) -> ModelRecord:
    """The record of a model with a given manifold, and nothing else."""
    q, v = (("",) * sum(each) for each in ((s.size for s in segments), (s.speeds for s in segments)))
    free = (math.inf,) * len(q)
    lower = tuple(-x for x in free)
    return ModelRecord("m", "", q, v, (), (), (), {}, (), (), (0.0,) * len(q), lower, free, segments, (False,) * len(q))


@pytest.mark.parametrize(
    ("case", "changes", "words"),
    [
        ("double_pendulum", {"method": "dopri5"}, "method 'dopri5'"),
        ("double_pendulum", {"dt": 0.0}, "dt = 0.0"),
        ("slider_crank", {}, "constraints"),
        ("heavy_top", {"q0": [0.0, 0.0, 0.0, 2.0]}, "length 2"),
        ("double_pendulum", {"u": [1.0]}, "u does not fit"),
        ("double_pendulum", {"v0": [1e200, 1e200]}, "leaves the finite numbers"),
    ],
)
def test_rollouts_without_derivatives_and_invalid_starts_are_refused(
    case: str, changes: dict[str, object], words: str
) -> None:
    m = model(case, "c")
    given = {"q0": m.neutral(), "v0": np.zeros(m.nv), "u": np.zeros((3, m.nu)), "dt": 0.01} | changes
    with pytest.raises(sf.SymofrosError, match=words):
        sf.rollout(m, **given)


def test_invalid_quaternions_among_the_inputs_are_refused() -> None:
    m = sf.compile(turned())
    u = np.zeros((5, m.nu))
    u[:, m.names.u.index("p.qw")] = 1.0
    sf.rollout(m, [0.1], [0.0], u, 0.01)
    u[3, m.names.u.index("p.qw")] = 3.0
    with pytest.raises(sf.SymofrosError, match="u holds a quaternion that(.|\n)*length 3 of .* in row 3"):
        sf.rollout(m, [0.1], [0.0], u, 0.01)
