"""Motions by fixed steps under held inputs, and their exact derivatives (docs/theory/simulation.md, section 9)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike as Numbers

from symofros.base.arguments import checked
from symofros.base.arrays import real_array
from symofros.errors import Problem, ShapeError, SymofrosError
from symofros.runtime.calls.kernel import Array
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.input_rotations import refuse_no_rotation
from symofros.simulation.settings import vector
from symofros.simulation.stepping.methods import METHODS, method_meant
from symofros.simulation.stepping.tableaus import Tableau

_METHODS = ("euler", "semi_implicit_euler", "rk4")
_RULE = "motions of trees in coordinates whose rates are the speeds, by fixed explicit steps"


class MotionGradient(NamedTuple):
    """Derivatives of a weighted sum of states: by the first state (nv), held inputs (n, nu), parameters (npar)."""

    q0: Array
    v0: Array
    u: Array
    par: Array


class Tangents(NamedTuple):
    """Changes of a motion along k directions: of q and of v (n + 1, nv, k)."""

    q: Array
    v: Array


@dataclass(frozen=True)
class Rollout:
    """A motion by fixed steps, with what its derivatives need.

    Attributes:
        t: Times (n + 1) [s].
        q: Coordinates (n + 1, nq).
        v: Speeds (n + 1, nv).
        u: Inputs held over each step (n, nu).
        dt: Step [s].
    """

    t: Array
    q: Array
    v: Array
    u: Array
    dt: float
    _model: Model
    _method: str
    _par: Array
    _stages: tuple[Array, Array, Array]  # Times (n, s), q and v (n, s, nv) of each stage.

    def __repr__(self) -> str:
        """Model, method and sizes; the numbers are in the attributes."""
        steps = f"{len(self.u)} steps of {self.dt:.6g} s"
        return f"<Rollout of '{self._model.record.name}' by {self._method}: {steps}>"

    def gradient(self, q_bar: Numbers | None = None, v_bar: Numbers | None = None) -> MotionGradient:
        """The derivatives of sum q_bar . q + v_bar . v by first state, inputs and parameters, by the discrete adjoint.

        One sweep backwards with a vector-Jacobian product a stage: exact for the steps as they were made, at a cost
        that the number of inputs and parameters does not raise (eq. 20, 21).

        Args:
            q_bar: Weights of the coordinates (n + 1, nv), or of the last ones (nv); zero if left out.
            v_bar: Weights of the speeds (n + 1, nv), or of the last ones (nv); zero if left out.

        Raises:
            ShapeError: Weights do not fit.
        """
        weights = [self._weights(name, given) for name, given in (("q_bar", q_bar), ("v_bar", v_bar))]
        product = self._model.bind("forward_dynamics_vjp", par=self._par)
        held, out = product.inputs, product.outputs
        tableau, h, (t, q, v) = METHODS[self._method].tableau, self.dt, self._stages
        by_u, by_par = np.zeros(self.u.shape), np.zeros(len(self._par))
        x_q, x_v = (w[-1].copy() for w in weights)
        s = q.shape[1]
        y_q, y_v = np.zeros((2, s, self._model.nv))
        for n in reversed(range(len(self.u))):
            for i in reversed(range(s)):
                held["q"][:], held["v"][:], held["u"][:], held["t"][:] = q[n, i], v[n, i], self.u[n], t[n, i]
                slope_q, slope_v = h * tableau.b[i] * x_q, h * tableau.b[i] * x_v
                if self._semi_implicit:
                    slope_v += h * slope_q
                for j in range(i + 1, s):
                    slope_q += h * tableau.a[j, i] * y_q[j]
                    slope_v += h * tableau.a[j, i] * y_v[j]
                held["a_bar"][:] = slope_v
                product()
                y_q[i], y_v[i] = out["by_q"], out["by_v"] + slope_q
                by_u[n] += out["by_u"]
                by_par += out["by_par"]
            x_q += y_q.sum(axis=0) + weights[0][n]
            x_v += y_v.sum(axis=0) + weights[1][n]
        return MotionGradient(x_q, x_v, by_u, by_par)

    def tangents(
        self,
        dq0: Numbers | None = None,
        dv0: Numbers | None = None,
        du: Numbers | None = None,
        dpar: Numbers | None = None,
    ) -> Tangents:
        """Changes of the motion along k directions, by forward sensitivities (eq. 19).

        Args:
            dq0: Changes of the first coordinates (nv, k); these and all others are zero where left out.
            dv0: Changes of the first speeds (nv, k).
            du: Changes of the held inputs (n, nu, k).
            dpar: Changes of the run-time parameters (npar, k).

        Raises:
            ShapeError: Directions do not fit.
        """
        m, (t, q, v), s = self._model, self._stages, self._stages[1].shape[1]
        sizes = {"dq0": (m.nv,), "dv0": (m.nv,), "du": self.u.shape, "dpar": (m.npar,)}
        given = dict(zip(sizes, (dq0, dv0, du, dpar), strict=True))
        shapes = [np.asarray(value).shape for value in given.values() if value is not None]
        k = next((shape[-1] for shape in shapes if shape), 0)
        d = {name: _fitting(name, value, (*sizes[name], k)) for name, value in given.items()}
        u = np.repeat(self.u[:, None], s, axis=1)
        by_q, by_v, by_u = m.forward_dynamics_derivatives(q, v, u, par=self._par, t=t)
        forced = np.einsum("nsij,njk->nsik", by_u, d["du"])
        if m.npar:
            forced = forced + m.forward_dynamics_by_par(q, v, u, par=self._par, t=t) @ d["dpar"]
        tableau, h = METHODS[self._method].tableau, self.dt
        changes = Tangents(np.empty((len(self.t), m.nv, k)), np.empty((len(self.t), m.nv, k)))
        changes.q[0], changes.v[0] = d["dq0"], d["dv0"]
        slope_q, slope_v = np.zeros((2, s, m.nv, k))
        for n in range(len(self.u)):
            for i in range(s):
                at_q = changes.q[n] + h * np.tensordot(tableau.a[i, :i], slope_q[:i], 1)
                at_v = changes.v[n] + h * np.tensordot(tableau.a[i, :i], slope_v[:i], 1)
                slope_v[i] = by_q[n, i] @ at_q + by_v[n, i] @ at_v + forced[n, i]
                slope_q[i] = at_v + h * slope_v[i] if self._semi_implicit else at_v
            changes.q[n + 1] = changes.q[n] + h * np.tensordot(tableau.b[:s], slope_q, 1)
            changes.v[n + 1] = changes.v[n] + h * np.tensordot(tableau.b[:s], slope_v, 1)
        return changes

    @property
    def _semi_implicit(self) -> bool:
        return METHODS[self._method].kind == "semi_implicit"

    def _weights(self, name: str, given: Numbers | None) -> Array:
        shape = (len(self.t), self._model.nv)
        if given is not None and np.shape(given) == shape[1:]:
            weights = np.zeros(shape)
            weights[-1] = _fitting(name, given, shape[1:])
            return weights
        return _fitting(name, given, shape)


@checked
def rollout(
    model: Model,
    q0: ArrayLike,
    v0: ArrayLike,
    u: Numbers,
    dt: float,
    *,
    method: str = "rk4",
    par: ArrayLike | None = None,
    t0: float = 0.0,
) -> Rollout:
    """Move a tree through n fixed steps under inputs that are held over each, for exact derivatives of the motion.

    The steps are those of `simulate` with a `Signal(t, u, "hold")` to rounding: the inputs of a step hold for all its
    stages. Steps are not judged here: the derivatives are those of the steps that were made, however long, and of the
    beams' theory, however far they bend; `simulate` says whether steps of that length resolve the motion, and what the
    theory misses. Not for constraints, whose drift `simulate` projects away, for ball and free joints that move by
    themselves, for events, for methods that choose their steps.

    Args:
        model: Of a tree whose coordinates have the speeds as rates.
        q0: First coordinates (nq).
        v0: First speeds (nv).
        u: Inputs of each step (n, nu).
        dt: Step [s].
        method: "rk4", "semi_implicit_euler" or "euler".
        par: Run-time parameters (npar); the model's by default.
        t0: First time [s].

    Raises:
        SymofrosError: The model or the method is out of reach, a quaternion among the inputs is no rotation, or the
            motion leaves the finite numbers.
        ShapeError: An array does not fit.
    """
    model = model.with_precision("double")
    _refuse(model, method, dt, t0)
    held = real_array(u)
    if held is None or held.ndim != 2 or held.shape[1] != model.nu or not len(held) or not np.all(np.isfinite(held)):
        held_shape = type(u).__name__ if held is None else str(held.shape)
        raise ShapeError(
            Problem(
                f"model '{model.record.name}': u does not fit",
                held_shape,
                f"finite inputs of each step, of shape (n, {model.nu}), n from 1 on",
                "np.zeros((n, model.nu)) for none",
            )
        )
    held = held.copy()  # The derivatives read it later, when the caller may have moved on.
    refuse_no_rotation(model, held)
    values = model.parameter_values if par is None else vector(model, "par", model.checked_parameters(par), model.npar)
    tableau = METHODS[method].tableau
    first = vector(model, "q0", q0, model.nq), vector(model, "v0", v0, model.nv)
    return _stepped(model, method, tableau, first, held, float(dt), np.array(values), t0)


def _stepped(
    model: Model, method: str, tableau: Tableau, first: tuple[Array, Array], u: Array, h: float, par: Array, t0: float
) -> Rollout:
    n, s, nv = len(u), tableau.stages, model.nv
    t: Array = np.linspace(t0, t0 + h * n, n + 1)
    q, v = np.empty((n + 1, nv)), np.empty((n + 1, nv))
    times, at_q, at_v = t[:-1, None] + h * tableau.c[:s], np.empty((n, s, nv)), np.empty((n, s, nv))
    slope_q, slope_v = np.zeros((2, s, nv))
    dynamics = model.bind("forward_dynamics", par=par)
    held, a = dynamics.inputs, dynamics.outputs["a"]
    q[0], v[0] = first
    for k in range(n):
        held["u"][:] = u[k]
        for i in range(s):
            at_q[k, i] = held["q"][:] = q[k] + h * (tableau.a[i, :i] @ slope_q[:i])
            at_v[k, i] = held["v"][:] = v[k] + h * (tableau.a[i, :i] @ slope_v[:i])
            held["t"][:] = times[k, i]
            dynamics()
            slope_v[i] = a
            slope_q[i] = at_v[k, i] + h * a if METHODS[method].kind == "semi_implicit" else at_v[k, i]
        q[k + 1] = q[k] + h * (tableau.b[:s] @ slope_q)
        v[k + 1] = v[k] + h * (tableau.b[:s] @ slope_v)
    if not (np.all(np.isfinite(q)) and np.all(np.isfinite(v))):
        lost = int(np.argmin(np.isfinite(q).all(axis=1) & np.isfinite(v).all(axis=1)))
        raise SymofrosError(
            Problem(
                f"model '{model.record.name}': the motion leaves the finite numbers",
                f"at t = {t[lost]:g} s, step {lost} of {n}",
                "a derivative needs a motion",
                "take shorter steps, or smaller inputs",
            )
        )
    return Rollout(t, q, v, u, h, model, method, par, (times, at_q, at_v))


def _refuse(model: Model, method: str, dt: float, t0: float) -> None:
    fault = ""
    if method not in _METHODS:
        fault, remedy = f"method '{method}'", method_meant(method, _METHODS) or f"use one of {', '.join(_METHODS)}"
    elif not (np.isfinite(dt) and dt > 0.0 and np.isfinite(t0)):
        fault, remedy = f"dt = {dt}, t0 = {t0}", "give a step above zero and a finite start, in seconds"
    elif model.nc:
        fault, remedy = f"{model.nc} constraints", "cut the loops, and add their forces as springs"
    elif any(segment.kind != "linear" for segment in model.record.segments):
        fault, remedy = "a ball or free joint", "state it by three revolute joints"
    if fault:
        raise SymofrosError(Problem(f"model '{model.record.name}': no derivatives of its motion", fault, _RULE, remedy))


def _fitting(name: str, given: Numbers | None, shape: tuple[int, ...]) -> Array:
    """An array of that shape; zeros where nothing is given."""
    if given is None:
        return np.zeros(shape)
    array = real_array(given)
    if array is None or array.shape != shape:
        stated = type(given).__name__ if array is None else str(array.shape)
        raise ShapeError(Problem(f"rollout: {name} does not fit", stated, f"an array of shape {shape}", "reshape it"))
    return np.asarray(array, dtype=np.float64)
