"""The beams that the studies ask about, and how they are asked: linearised about rest, or moved through time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import scipy.linalg
from scipy.integrate import solve_ivp

import symofros as sf

from ..mechanics.geometry import Array

# First frequency of a uniform cantilever, in units of sqrt(EI/(rhoA L^4)).
FIRST = 3.5160152685001513
STIFFNESS = {"bend_y": "EI_z", "bend_z": "EI_y"}
LINEAR = ("mass_matrix", "inverse_dynamics_derivatives")


def cantilever(joint: sf.Joint | None = None, **changed: Any) -> sf.Beam:
    """A beam "b" with length, mass per length and bending stiffness one, clamped to the world unless said."""
    plain: dict[str, Any] = {"length": 1.0, "rhoA": 1.0, "family": "legendre"}
    plain |= {stiffness: 1.0 for direction, stiffness in STIFFNESS.items() if changed.get(direction)}
    return sf.Beam("b", joint or sf.Joint("root", "fixed"), **(plain | changed))


def interpreted(
    *bodies: sf.Body, functions: tuple[str, ...] = LINEAR, parameters: Sequence[str] = (), **more: Any
) -> sf.Model:
    """A model that is evaluated a few times only, so that it is not worth compiling; parameters are zero."""
    stated = sf.System(
        "s", bodies, parameters=tuple(sf.Parameter(name, 0.0) for name in parameters), **({"gravity": (0, 0, 0)} | more)
    )
    return sf.compile(stated, sf.Options(functions, backend="interpreter"))


def stiffness_and_mass(
    m: sf.Model, q: Array | None = None, u: Sequence[float] = (), **par: float
) -> tuple[Array, Array]:
    """K = d(h - Q)/dq and M (nv, nv) at rest in q, exactly.

    Args:
        m: Model with the functions `LINEAR`.
        q: Configuration (nq); undeformed if not given.
        u: Inputs: of prescribed motions.
        **par: Run-time parameters.
    """
    m = m.with_parameters(**par)
    q = np.zeros(m.nq) if q is None else q
    still, given = np.zeros(m.nv), np.array(u, dtype=float)
    K, _ = m.inverse_dynamics_derivatives(q, still, still, u=given)
    return K, m.mass_matrix(q, u=given)


def squares(K: Array, M: Array) -> Array:
    """Squares of the frequencies of M x'' + K x = 0, rising; coordinates are scaled first, for monomials' sake."""
    scale = 1.0 / np.sqrt(np.diag(M))
    both = np.outer(scale, scale)
    eigenvalues: Array = scipy.linalg.eigvalsh((K + K.T) / 2 * both, M * both)
    return eigenvalues


def spinning(direction: str, modes: int, *carried: sf.Body, **changed: Any) -> sf.Model:
    """A beam at radius "r" on a hub whose turn about z is given: bend_z is flap, bend_y is lag."""
    hub = sf.RigidBody("hub", sf.Joint("turn", "revolute", prescribed=True))
    root = sf.Joint("root", "fixed", "hub", position=(sf.formula("r", "radius"), 0.0, 0.0))
    return interpreted(hub, cantilever(root, **{direction: modes}, **changed), *carried, parameters=["r"])


def spinning_squares(m: sf.Model, eta: float, delta: float) -> Array:
    """Squares of the frequencies at speed eta and hub ratio delta, in units of EI/(rhoA L^4)."""
    return squares(*stiffness_and_mass(m, u=(0.0, eta, 0.0), r=delta))


def motion(
    m: sf.Model,
    q0: Array,
    v0: Array,
    times: Array,
    tolerance: float,
    drive: Callable[[float], Sequence[float]] = lambda t: (),
) -> tuple[Array, Array]:
    """Configurations (n, nq) and speeds (n, nv) at these times, by DOP853; coordinates whose rates are the speeds.

    Args:
        m: Model with the function forward_dynamics.
        q0: Configuration at the first time.
        v0: Speeds at the first time.
        times: Rising (n).
        tolerance: Relative; the absolute one is a hundredth of it.
        drive: Inputs at a time.
    """
    n = m.nv

    def rate(t: float, state: Array) -> Array:
        return np.concatenate([state[n:], m.forward_dynamics(state[:n], state[n:], drive(t))])

    start = np.concatenate([q0, v0])
    run = solve_ivp(rate, (times[0], times[-1]), start, "DOP853", times, rtol=tolerance, atol=tolerance / 100)
    if not run.success:
        raise ArithmeticError(f"model '{m.record.name}': the motion can't be followed: {run.message}")
    return run.y[:n].T, run.y[n:].T
