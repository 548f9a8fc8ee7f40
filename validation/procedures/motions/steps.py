"""Steps of every method, repeated by coefficients of SciPy, by matrix exponentials and by general solvers.

A run of ours is compared with a run of the same step sizes' rules: what chooses the steps is repeated_run, too
(docs/theory/simulation.md, sections 1 to 5).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import DOP853, RK45
from scipy.optimize import root

from symofros.tools import METHODS

from ...mechanics.geometry import Array
from ..scene import POSE, Scene, derivative, tangent

# Of equation (4): safety, damping, bounds of a step's growth; the smallest error that steers the next step.
SAFETY, DAMPING, GROWTH, SHRINK, LUCKY = 0.9, 0.04, 8.0, 0.2, 1e-4
SPECTRAL_RADIUS = 0.8
# Steps of a run repeated_run: ours are some ten, or none.
MOST = 2000


# Bounds of errors of y at the end of a step; None where steps are fixed.
Scale = Callable[[Array], Array] | None


@dataclass
class Step:
    """One step: its end in the chart, the error norm, and the path between.

    Attributes:
        y: (theta, v) at its end.
        error: Error norm; 0 where none is estimated.
        within: (theta, v) at a share x of the step.
    """

    y: Array
    error: float
    within: Callable[[float], Array]


@dataclass(frozen=True)
class Explicit:
    """An explicit Runge-Kutta method by its tableau.

    Attributes:
        A: Stage weights.
        b: Weights of the step.
        c: Nodes.
        errors: Weights of the error estimates, all stages and the end's slope.
        order: Order of the estimate and one more.
        path: Dense output by stages, the step's end, and x; None: a cubic.
    """

    A: Array
    b: Array
    c: Array
    errors: tuple[Array, ...] = ()
    order: int = 1
    path: Callable[[Scene, float, float, list[Array], Array], Callable[[float], Array]] | None = None

    def step(self, scene: Scene, t: float, h: float, scale: Scale) -> Step:
        """One step from the scene's state."""
        y0 = np.concatenate([np.zeros(scene.model.nv), scene.v])
        k: list[Array] = []
        for row, c in zip(self.A, self.c, strict=True):
            k.append(scene.slope(t + c * h, y0 + h * sum((w * one for w, one in zip(row, k, strict=False)), 0 * y0)))
        y = y0 + h * np.tensordot(self.b, k, 1)
        end = scene.slope(t + h, y)
        error = 0.0
        if self.errors and scale is not None:
            estimates = [h * np.tensordot(e, [*k, end], 1) / scale(y) for e in self.errors]
            squares = [float(np.mean(one**2)) for one in estimates]
            error = squares[0] ** 0.5
            if len(squares) > 1:
                error = squares[0] / (squares[0] + 0.01 * squares[1]) ** 0.5
        within = self.path(scene, t, h, [*k, end], y) if self.path else cubic(y0, h * k[0], y, h * end)
        return Step(y, error, within)


Stepping = Callable[[Scene, float, float, Scale], Step]


def cubic(y0: Array, f0: Array, y1: Array, f1: Array) -> Callable[[float], Array]:
    """The cubic through both ends with their slopes times h."""

    def within(x: float) -> Array:
        s = 1 - x
        return (1 + 2 * x) * s**2 * y0 + x**2 * (3 - 2 * x) * y1 + x * s**2 * f0 - x**2 * s * f1

    return within


def _dopri5_path(scene: Scene, _t: float, h: float, k: list[Array], _y: Array) -> Callable[[float], Array]:
    y0 = np.concatenate([np.zeros(scene.model.nv), scene.v])
    return lambda x: y0 + h * np.array(k).T @ RK45.P @ x ** np.arange(1, 5)


def _dop853_path(scene: Scene, t: float, h: float, k: list[Array], y: Array) -> Callable[[float], Array]:
    y0 = np.concatenate([np.zeros(scene.model.nv), scene.v])
    k = list(k)
    for row, c in zip(DOP853.A_EXTRA, DOP853.C_EXTRA, strict=True):
        k.append(scene.slope(t + c * h, y0 + h * np.array(k).T @ row[: len(k)]))
    F = [y - y0, h * k[0] - (y - y0), 2 * (y - y0) - h * (k[12] + k[0]), *(h * DOP853.D @ np.array(k))]

    def within(x: float) -> Array:
        total = np.zeros_like(y0)
        for i, one in reversed(list(enumerate(F))):
            total = (total + one) * (x if i % 2 == 0 else 1 - x)
        return np.asarray(y0 + total)

    return within


_RK4 = np.array([[0, 0, 0, 0], [0.5, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 1.0, 0]])
EXPLICIT = {
    "euler": Explicit(np.zeros((1, 1)), np.ones(1), np.zeros(1)),
    "rk4": Explicit(_RK4, np.array([1, 2, 2, 1]) / 6, np.array([0, 0.5, 0.5, 1])),
    "dopri5": Explicit(RK45.A, RK45.B, RK45.C, (RK45.E,), 5, _dopri5_path),
    "dop853": Explicit(DOP853.A, DOP853.B, DOP853.C, (DOP853.E5, DOP853.E3), 8, _dop853_path),
}


def _semi_implicit(scene: Scene, t: float, h: float, _scale: Scale) -> Step:
    nv = scene.model.nv
    y0 = np.concatenate([np.zeros(nv), scene.v])
    k = scene.slope(t, y0)
    v = scene.v + h * k[nv:]
    y = np.concatenate([h * v, v])
    return Step(y, 0.0, cubic(y0, h * k, y, h * scene.slope(t + h, y)))


def _rosenbrock(name: str) -> Stepping:
    """Rosenbrock methods by Jacobians of finite differences and the full matrix of 2 nv rows."""

    def step(scene: Scene, t: float, h: float, scale: Scale) -> Step:
        table = METHODS[name].tableau
        y0 = np.concatenate([np.zeros(scene.model.nv), scene.v])
        J = derivative(lambda y: scene.slope(t, y), y0)
        by_time = derivative(lambda at: scene.slope(float(at[0]), y0), np.array([t]))[:, 0]
        matrix = np.eye(len(y0)) / (h * table.gamma) - J
        U: list[Array] = []
        for i in range(table.stages):
            y = y0 + sum((table.a[i, j] * U[j] for j in range(i)), 0 * y0)
            right = scene.slope(t + table.c[i] * h, y) + h * table.d[i] * by_time
            right = right + sum((table.coupling[i, j] / h * U[j] for j in range(i)), 0 * y0)
            U.append(np.linalg.solve(matrix, right))
        y = y0 + np.tensordot(table.b, U, 1)
        error = 0.0
        if scale is not None:
            error = float(np.mean((np.tensordot(table.errors[0], U, 1) / scale(y)) ** 2)) ** 0.5
        return Step(y, error, cubic(y0, h * scene.slope(t, y0), y, h * scene.slope(t + h, y)))

    return step


STEPS: dict[str, Stepping] = {
    **{name: method.step for name, method in EXPLICIT.items()},
    "semi_implicit_euler": _semi_implicit,
    "implicit_euler": _rosenbrock("implicit_euler"),
    "rodas4": _rosenbrock("rodas4"),
}


@dataclass(frozen=True)
class Path:
    """A run repeated_run.

    Attributes:
        t: Ends of the steps (n); q, v: states there.
        within: States (q, v) at a time, on the way.
    """

    t: Array
    q: Array
    v: Array
    within: Callable[[float], tuple[Array, Array]]


def repeated_run(
    scene: Scene, method: str, t0: float, t_end: float, h: float = 0.0, tolerances: tuple[float, float] = (0.0, 0.0)
) -> Path:
    """A run by one of STEPS, with fixed steps h, or with adaptive ones from h (0: by Hairer's rule) on.

    Args:
        scene: Model and first state.
        method: Name of the method.
        t0: Start [s].
        t_end: End [s].
        h: Step, or the first one [s].
        tolerances: rtol and atol; zeros: steps are fixed.
    """
    rtol, atol = tolerances
    adaptive, step = rtol > 0.0, STEPS[method]
    order = EXPLICIT[method].order if method in EXPLICIT else 4
    t, previous = t0, 1.0
    if adaptive and h == 0.0:
        h = _first_step(scene, order, (t0, t_end), _scale(scene, rtol, atol))
    times, states, pieces = [t], [(scene.q, scene.v)], []
    tried = 0
    while t < t_end:
        tried += 1
        if tried > MOST:
            raise ArithmeticError(f"{method}: {MOST} steps do not reach the end")
        t1 = t + h if adaptive else t0 + len(times) * h
        t1 = t_end if t1 >= t_end - 1e-9 * h else t1
        taken = step(scene, t, t1 - t, _scale(scene, rtol, atol) if adaptive else None)
        if adaptive:
            factor = GROWTH
            if taken.error > 0.0:
                factor = SAFETY * taken.error ** (0.75 * DAMPING - 1 / order) * previous**DAMPING
            h = (t1 - t) * min(GROWTH, max(SHRINK, factor))
            if taken.error > 1.0:
                continue
            previous = max(taken.error, LUCKY)
        pieces.append((t, t1, scene, taken.within))
        q, v = _at(scene, t1, taken.y)
        scene, t = replace(scene, q=q, v=v), t1
        times.append(t)
        states.append((q, v))

    def within(at: float) -> tuple[Array, Array]:
        start, end, origin, path = next(piece for piece in pieces if at <= piece[1])
        return _at(origin, at, path((at - start) / (end - start)))

    return Path(np.array(times), np.array([q for q, _ in states]), np.array([v for _, v in states]), within)


def _at(scene: Scene, t: float, y: Array) -> tuple[Array, Array]:
    nv = scene.model.nv
    return scene.projected(t, scene.manifold.retract(scene.q, y[:nv]), y[nv:])


def _scale(scene: Scene, rtol: float, atol: float) -> Callable[[Array], Array]:
    """Bounds of errors of y, by magnitudes at both ends."""
    nv = scene.model.nv
    magnitude = np.ones(nv)
    for at, to, size in scene.manifold.segments:
        translations = 3 if size == POSE else size if size < 4 else 0
        magnitude[to : to + translations] = np.abs(scene.q[at : at + translations])

    def scale(y: Array) -> Array:
        speeds = np.maximum(np.abs(scene.v), np.abs(y[nv:]))
        return atol + rtol * np.concatenate([magnitude, speeds])

    return scale


def _first_step(scene: Scene, order: int, span: tuple[float, float], scale: Callable[[Array], Array]) -> float:
    """Hairer, Norsett, Wanner I, II.4; y counts with its magnitude, angles of rotations with 1."""
    y0 = np.concatenate([np.zeros(scene.model.nv), scene.v])
    bound, f = scale(y0), scene.slope(span[0], y0)
    size = _scale(scene, 1.0, 0.0)(y0)
    d0, d1 = (float(np.mean((x / bound) ** 2)) ** 0.5 for x in (size, f))
    h0 = min(1e-6 if min(d0, d1) < 1e-5 else 0.01 * d0 / d1, span[1] - span[0])
    d2 = float(np.mean(((scene.slope(span[0] + h0, y0 + h0 * f) - f) / bound) ** 2)) ** 0.5 / h0
    largest = max(d1, d2)
    h1 = max(1e-6, 1e-3 * h0) if largest <= 1e-15 else (0.01 / largest) ** (1 / order)
    return float(min(100 * h0, h1))


def _solution(residual: Callable[[Array], Array], start: Array) -> Array:
    """Root of equations, as close as rounding lets it come: the comparison judges how close that is."""
    return np.asarray(root(residual, start, tol=1e-13).x)


def alpha_run(scene: Scene, h: float, steps: int) -> tuple[Array, Array]:
    """Generalised alpha, (6) and (7), by MINPACK; q and v at the ends of the steps."""
    rho, nv = SPECTRAL_RADIUS, scene.model.nv
    alpha_m, alpha_f = (2 * rho - 1) / (rho + 1), rho / (rho + 1)
    gamma = 0.5 + alpha_f - alpha_m
    beta = 0.25 * (gamma + 0.5) ** 2
    nc, model = scene.model.nc, scene.model
    smooth = a0 = scene.acceleration(0.0, scene.q, scene.v)
    q, v, states = scene.q, scene.v, [(scene.q, scene.v)]
    lam, positions = np.zeros(nc), nc > 0 and _on_positions(scene)
    for n in range(steps):
        t1 = (n + 1) * h

        def end(a: Array) -> tuple[Array, Array, Array]:
            s = ((1 - alpha_f) * a + alpha_f * a0 - alpha_m * smooth) / (1 - alpha_m)  # noqa: B023
            theta = h * v + h * h * ((0.5 - beta) * smooth + beta * s)  # noqa: B023
            return scene.manifold.retract(q, theta, True), v + h * ((1 - gamma) * smooth + gamma * s), s  # noqa: B023

        def residual(x: Array) -> Array:
            q1, v1, _ = end(x[:nv])
            u = scene.law(t1, q1, v1)  # noqa: B023
            M, h1, Q = model.dynamics(q1, v1, u)
            rows = M @ x[:nv] + h1 - Q
            if not nc:
                return rows
            kept = model.constraint(q1) / h**2 if positions else model.constraint_rate(q1, v1) / h
            return np.concatenate([rows - model.constraint_jacobian(q1).T @ x[nv:], kept])

        x = _solution(residual, np.concatenate([a0, lam]))
        q1, v1, smooth = end(x[:nv])
        a0, lam = x[:nv], x[nv:]
        q, v = scene.projected(t1, q1, v1)
        states.append((q, v))
    return np.array([q for q, _ in states]), np.array([v for _, v in states])


def _on_positions(scene: Scene) -> bool:
    """Whether conditions are on positions: phi does not vanish everywhere."""
    q = scene.manifold.retract(scene.q, np.full(scene.model.nv, 0.1))
    return bool(np.abs(scene.model.constraint(q)).max() > 0.0)


def variational_run(scene: Scene, h: float, steps: int) -> tuple[Array, Array]:
    """The variational midpoint rule, (8), with tangent maps by matrix exponentials."""
    manifold, model, q, v = scene.manifold, scene.model, scene.q, scene.v
    states = [(q, v)]

    def momenta(theta: Array, sign: float, t: float) -> Array:
        """mu_0 for the sign 1, mu_1 for -1."""
        middle, w = manifold.retract(q, 0.5 * theta, True), theta / h  # noqa: B023
        M, bias, Q = model.dynamics(middle, w, scene.law(t, middle, w))

        def momentum_ahead(s: Array) -> Array:
            return np.asarray(model.mass_matrix(manifold.retract(middle, s[0] * w))) @ w

        p = M @ w
        F = derivative(momentum_ahead, np.zeros(1), 1e-2)[:, 0] + Q - bias - manifold.adjoint(w).T @ p
        halved = tangent(sign * manifold.adjoint(0.5 * theta)).T @ F
        return np.asarray(np.linalg.solve(tangent(sign * manifold.adjoint(theta)).T, p - sign * 0.5 * h * halved))

    for n in range(steps):
        t = (n + 0.5) * h
        start = model.mass_matrix(q) @ v

        def left(x: Array, t: float = t, start: Array = start) -> Array:
            return momenta(x, 1.0, t) - start

        theta = _solution(left, h * v)
        end = momenta(theta, -1.0, t)
        q = manifold.retract(q, theta, True)
        v = np.asarray(np.linalg.solve(model.mass_matrix(q), end), dtype=np.float64)
        states.append((q, v))
    return np.array([q for q, _ in states]), np.array([v for _, v in states])
