"""Many states and many trajectories at once against one after the other, and what a step makes of a mode."""

from __future__ import annotations

import cmath
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

import symofros as sf
from symofros.tools import METHODS

from ...mechanics.geometry import Array
from ..scene import Cell, Scene, off
from .steps import EXPLICIT

# Trajectories: more than are stepped at once, and no multiple of a vector's lanes.
COUNT = 67
ROUNDING = 1e-11


def trajectories(scene: Scene, threads: int = 2) -> Iterator[Cell]:
    """Each trajectory of a batch is that of a run by itself; inputs differ from one to the next."""
    model, rng = scene.model, np.random.default_rng(1)
    moved = [scene.manifold.retract(scene.q, 0.1 * x) for x in rng.standard_normal((COUNT, model.nv))]
    v = scene.v * rng.uniform(0.5, 1.5, (COUNT, 1))
    q = np.array(moved)
    if model.nc:
        starts = [sf.assemble(model, one, speeds) for one, speeds in zip(q, v, strict=True)]
        q, v = np.array([one.q for one in starts]), np.array([one.v for one in starts])
    t = np.linspace(0.0, 0.3, 4)
    samples = rng.standard_normal((COUNT, 4, model.nu))
    u = sf.Signal(t, samples) if model.nu else None
    par = np.asarray(model.parameter_values) * rng.uniform(0.99, 1.01, (COUNT, model.npar))  # Within what is physical.
    ends = (0, 1, COUNT // 2, COUNT - 1)
    cases: tuple[tuple[str, dict[str, float]], ...] = (
        ("euler", {"dt": 0.01}),
        ("semi_implicit_euler", {"dt": 0.01}),
        ("rk4", {"dt": 0.013}),
        ("dopri5", {"rtol": 1e-5, "atol": 1e-7}),
        ("dop853", {"rtol": 1e-7, "atol": 1e-9}),
    )
    for method, options in cases:
        given: dict[str, Any] = {"method": method, "output": 0.05, **options}
        runs = sf.simulate_batch(model, q, v, 0.3, u=u, par=par, threads=threads, **given)
        error = float(not runs.ok.all())
        for i in ends:
            own = sf.Signal(t, samples[i]) if model.nu else None
            one = sf.simulate(model, q[i], v[i], 0.3, u=own, par=par[i], **given)
            shown = runs[i]
            error = max(error, off(shown.q, one.q), off(shown.v, one.v), off(shown.u, one.u), off(shown.t, one.t))
            error += float(int(runs.steps[i]) != one.statistics.steps)
            error += float(int(runs.rejected[i]) != one.statistics.rejected)
            error = max(error, off(runs.q_last[i], one.q[-1]), off(runs.t_last[i], one.t[-1]))
        yield Cell(f"a batch by {method}", error, 1e-8)
    if model.nu:
        first, *others = model.names.u
        per_name: dict[str, Any] = {first: samples[:, 0, 0]}
        per_name |= {name: sf.Signal(t, samples[0, :, i]) for i, name in enumerate(others, 1)}
        constants = sf.simulate_batch(model, q, v, 0.1, u=per_name, method="rk4", dt=0.01)
        stated = per_name | {first: float(samples[1, 0, 0])}
        one = sf.simulate(model, q[1], v[1], 0.1, u=stated, method="rk4", dt=0.01)
        yield Cell("a batch whose inputs are given by name", off(constants.q[1, -1], one.q[-1]), ROUNDING)
        own_samples = {name: sf.Signal(t, samples[:, :, i : i + 1]) for i, name in enumerate(model.names.u)}
        each = sf.simulate_batch(model, q, v, 0.1, u=own_samples, method="rk4", dt=0.01)
        one = sf.simulate(model, q[3], v[3], 0.1, u=sf.Signal(t, samples[3]), method="rk4", dt=0.01)
        yield Cell("a batch whose samples differ by name", off(each.q[3, -1], one.q[-1]), ROUNDING)
        rows = sf.simulate_batch(model, q, v, 0.1, u=samples[:, 0], method="rk4", dt=0.01)
        one = sf.simulate(model, q[2], v[2], 0.1, u=samples[2, 0], method="rk4", dt=0.01)
        yield Cell("a batch of constant inputs", off(rows.q[2, -1], one.q[-1]), ROUNDING)


def lost(scene: Scene) -> Iterator[Cell]:
    """Trajectories that start from no motion are lost alone, at once; the others are runs by themselves."""
    model = scene.model
    q, v = np.tile(scene.q, (COUNT, 1)), scene.v * np.linspace(0.5, 1.5, COUNT)[:, None]
    v[3, 0], v[20, 0] = np.nan, 1e200
    for method in ("rk4", "dopri5"):
        given: dict[str, Any] = {"method": method, "dt": 0.01, "output": 0.05}
        runs = sf.simulate_batch(model, q, v, 0.1, **given)
        # What is no state is recorded nowhere.
        error = float(np.flatnonzero(~runs.ok).tolist() != [3, 20] or any(len(runs[i]) for i in (3, 20)))
        for i in (0, 2, 4, 21, COUNT - 1):
            one = sf.simulate(model, q[i], v[i], 0.1, **given)
            error = max(error, off(runs[i].q, one.q), off(runs[i].v, one.v))
        yield Cell(f"a batch by {method} that loses two", error, 1e-8)


def states(scene: Scene) -> Iterator[Cell]:
    """Functions of many states by vectors, in double and single precision, against one state at a time."""
    model, rng = scene.model, np.random.default_rng(2)
    n = 1031
    q = np.array([model.random_state(rng)[0] for _ in range(n)])
    q[0] *= 1e3  # Angles of many turns.
    q[1] = 0.0 * q[1]
    q = np.array([scene.manifold.retract(one, np.zeros(model.nv)) for one in q]) if scene.manifold.nq == model.nv else q
    v, u = rng.standard_normal((n, model.nv)), rng.standard_normal((n, model.nu))
    some = [*range(9), n // 2, *range(n - 9, n)]
    calls: tuple[tuple[str, Callable[[sf.Model, Any], Array]], ...] = (
        ("mass matrix", lambda m, i: m.mass_matrix(q[i])),
        ("bias", lambda m, i: m.bias(q[i], v[i])),
        ("forward dynamics", lambda m, i: m.forward_dynamics(q[i], v[i], u[i])),
        ("forward dynamics by state", lambda m, i: m.forward_dynamics_derivatives(q[i], v[i], u[i])[0]),
    )
    for name, call in calls:
        whole = np.asarray(call(model, slice(None)))[some]
        single = np.array([call(model, i) for i in some])
        error = max(off(one, other) for one, other in zip(whole, single, strict=True))
        yield Cell(f"{name} of many states", error, 1e-9)
        low = np.asarray(call(model.with_precision("single"), slice(None)), dtype=float)[some[1:]]
        error = max(off(one, other) for one, other in zip(low, single[1:], strict=True))
        yield Cell(f"{name} in single precision", error, 2e-2 if "forward" in name else 2e-4)


def oscillator() -> sf.Model:
    """A mass on a spring with a damper, both given at run time."""
    joint = sf.Joint("x", "prismatic", axis=(1.0, 0.0, 0.0), effort=(sf.formula("-k*x - c*dx"),))
    body = sf.RigidBody("mass", joint, sf.Inertia(1.0))
    return sf.compile(sf.System("oscillator", (body,), (sf.Parameter("k", 1.0), sf.Parameter("c", 0.1))))


def amplified(model: sf.Model) -> Iterator[Cell]:
    """Steps in C amplify modes by the method's factor, and limits of stability agree with it."""
    h, n = 0.1, 12
    modes = [0.3j, 2.3j, 0.9 * cmath.exp(2.0j), 1.4 * cmath.exp(1.7j), complex(-0.4), complex(-1.1)]
    for name, method in METHODS.items():
        if not method.family.judged:
            continue
        adaptive = False if method.adaptive else None
        worst = 0.0
        for z in modes:
            rate = z / h
            k, c = (abs(rate) ** 2, -2 * rate.real) if z.imag else (0.0, -rate.real)
            run = sf.simulate(model, [1.0], [0.5], n * h, par=[k, c], method=name, dt=h, adaptive=adaptive)
            factor = method.amplification(z)
            # The steps of a linear system obey a linear recursion, of order three for generalised alpha.
            x = run.q[:, 0] if z.imag else run.v[:, 0]
            past = np.stack([x[2:-1], x[1:-2], x[:-3]], axis=1)
            fit = np.linalg.lstsq(past, x[3:], rcond=1e-13)[0]
            roots = np.roots([1.0, *-fit])
            worst = max(worst, float(np.abs(roots - factor).min()), float(np.abs(roots - factor.conjugate()).min()))
        yield Cell(f"modes by {name}", worst, 1e-6)
        ends = [] if name not in EXPLICIT and name != "semi_implicit_euler" else list(_missed(name, method))
        for limit, direction in ((method.real_limit, -1.0), (method.imaginary_limit, 1.0j)):
            radii = np.array([0.3, 0.9, 0.999]) * min(limit, 1e3)
            grown = [abs(method.amplification(complex(r * direction))) for r in radii if r > 0.0]
            ends.append(max([0.0, *(one - 1.0 for one in grown)]))
            if np.isfinite(limit):
                ends.append(max(0.0, 1.0 - abs(method.amplification(complex(1.05 * max(limit, 0.1) * direction)))))
        yield Cell(f"limits of {name}", max(ends), 1e-9)


def _missed(name: str, method: Any) -> Iterator[float]:
    """Distance of limits of stability from those of the growth that the formulas of a step have."""
    for limit, direction in ((method.real_limit, -1.0 + 0.0j), (method.imaginary_limit, 1.0j)):
        if limit > 0.0:
            yield max(0.0, _growth(name, 0.999 * limit * direction) - 1.0 - 1e-9)
            yield max(0.0, 1.0 - _growth(name, 1.001 * limit * direction))
        else:
            yield max(0.0, 1.0 - _growth(name, 0.01 * direction))


def _growth(name: str, z: complex) -> float:
    """Largest factor of a mode in a step, by coefficients of SciPy or the matrix of semi-implicit Euler."""
    if name in EXPLICIT:
        A, b = EXPLICIT[name].A, EXPLICIT[name].b
        n = len(b)
        A = np.pad(A, ((0, 0), (0, n - A.shape[1])))
        return float(abs(1.0 + z * b @ np.linalg.solve(np.eye(n) - z * A, np.ones(n))))
    k, c = (abs(z) ** 2, -2 * z.real) if z.imag else (0.0, -z.real)
    matrix = np.array([[1.0 - k, 1.0 - c], [-k, 1.0 - c]]) if k else np.array([[1.0 - c]])
    return float(np.abs(np.linalg.eigvals(matrix)).max())


def remarks(model: sf.Model) -> Iterator[Cell]:
    """Steps that resolve a mode pass; steps that do not, or that amplify it, are noted or end the run."""
    for name in ("rk4", "semi_implicit_euler", "implicit_euler"):
        fine, coarse, wild = (
            sf.simulate(model, [1.0], [0.0], 2.0, par=[k, 0.0], method=name, dt=0.01) for k in (1.0, 60.0**2, 400.0**2)
        )
        wrong = [bool(fine.outcome.notes) and name == "rk4", not coarse.outcome.notes, not wild.outcome.notes]
        yield Cell(f"remarks on steps of {name}", float(sum(wrong)), 0.5)
