"""Pinocchio's articulated-body algorithm in integrators from elsewhere: it has none of its own."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
from scipy.integrate import solve_ivp

from ...mechanics.geometry import Array


class Held:
    """A tree of hinges with a spring and a damper on each joint, as a right-hand side."""

    def __init__(self, engine: Any, targets: Array, stiffness: float, damping: float) -> None:
        self.model, self.data = engine.model, engine.model.createData()
        self.targets, self.stiffness, self.damping = targets, stiffness, damping

    def acceleration(self, q: Array, v: Array) -> Array:
        """Accelerations of the joints (nv)."""
        force = self.stiffness * (self.targets - q) - self.damping * v
        return np.asarray(pin.aba(self.model, self.data, q, v, force))

    def rate(self, _: float, y: Array) -> Array:
        """Time derivative of the state y = (q, v)."""
        q, v = np.split(y, 2)
        return np.concatenate([v, self.acceleration(q, v)])

    def rk4(self, h: float, q0: Array, times: int, between: int) -> tuple[Array, float]:
        """The classical Runge-Kutta method from rest: positions (times + 1, nq), seconds of the processor."""
        y, configurations = np.concatenate([q0, np.zeros_like(q0)]), [q0]
        began = time.thread_time()
        for _ in range(times):
            for _ in range(between):
                k1 = self.rate(0.0, y)
                k2 = self.rate(0.0, y + h / 2 * k1)
                k3 = self.rate(0.0, y + h / 2 * k2)
                y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + self.rate(0.0, y + h * k3))
            configurations.append(y[: len(q0)])
        return np.array(configurations), time.thread_time() - began

    def motion(self, rtol: float, q0: Array, end: float) -> Callable[[Array], Array]:
        """SciPy's DOP853 from rest to an end, as times (n) -> positions (n, nq)."""
        y0 = np.concatenate([q0, np.zeros_like(q0)])
        run = solve_ivp(self.rate, (0.0, end), y0, "DOP853", rtol=rtol, atol=1e-2 * rtol, dense_output=True)
        return lambda times: np.asarray(run.sol(times)[: len(q0)].T)

    def solved(self, method: str, rtol: float, q0: Array, times: Array) -> tuple[Array, float]:
        """One of SciPy's methods from rest: positions (n, nq) at times, seconds of the processor."""
        y0 = np.concatenate([q0, np.zeros_like(q0)])
        began = time.thread_time()
        run = solve_ivp(self.rate, (0.0, times[-1]), y0, method, times, rtol=rtol, atol=1e-2 * rtol)
        return np.asarray(run.y[: len(q0)].T), time.thread_time() - began
