"""Motions by fixed steps under held inputs, and their exact derivatives (docs/theory/simulation.md, section 9)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike as Numbers

from symofros.base.arguments import checked
from symofros.base.arrays import Array, real_array
from symofros.errors import ShapeError, SymofrosError
from symofros.runtime import manifold
from symofros.runtime.manifold import at_unit_length
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.chart_derivatives import ChartSlopes, chart_slopes
from symofros.simulation.results.examination.creep import creep_note_at
from symofros.simulation.results.examination.state_notes import state_notes
from symofros.simulation.settings import first_configuration, vector
from symofros.simulation.stepping.methods import METHODS, method_meant
from symofros.simulation.stepping.tableaus import Tableau

_METHODS = ("euler", "semi_implicit_euler", "rk4")
_RULE = "motions of trees, by fixed explicit steps"


class MotionGradient(NamedTuple):
    """Derivatives of a weighted sum of states: by the first state (nv), held inputs (n, nu), parameters (npar).

    Those by the first configuration are along its manifold, one a speed, as those of `Model` are.
    """

    q0: Array
    v0: Array
    u: Array
    par: Array


class Tangents(NamedTuple):
    """Changes of a motion along k directions: of q along its manifold and of v (n + 1, nv, k)."""

    q: Array
    v: Array


class _Stages(NamedTuple):
    """The stages of all steps, and the steps in their charts (docs/theory/simulation.md, (1)).

    Attributes:
        t: Times (n, s).
        q: Configurations (n, s, nq).
        theta: The same in the chart of the step (n, s, nv).
        v: Speeds (n, s, nv).
        ends: The step in its chart (n, nv).
    """

    t: Array
    q: Array
    theta: Array
    v: Array
    ends: Array


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
    _stages: _Stages

    def __repr__(self) -> str:
        """Model, method and sizes; the numbers are in the attributes."""
        steps = f"{len(self.u)} steps of {self.dt:.6g} s"
        return f"<Rollout of '{self._model.record.name}' by {self._method}: {steps}>"

    @property
    def notes(self) -> tuple[str, ...]:
        """What its states show: limits left, contacts too deep, joints that creep at its end. Steps are not judged."""
        m, par, last = self._model, self._par, (self.t[-1], self.q[-1], self.v[-1], self.u[-1])

        def acceleration() -> Array:
            return np.asarray(m.forward_dynamics(*last[1:], par=par, t=last[0]))

        creeping = creep_note_at(m, last, par, acceleration)
        u = np.concatenate([self.u, self.u[-1:]])
        return (*state_notes(m, (self.t, self.q, self.v, u), par), *([creeping] if creeping else []))

    def gradient(self, q_bar: Numbers | None = None, v_bar: Numbers | None = None) -> MotionGradient:
        """The derivatives of a sum of weighted states by first state, inputs and parameters, by the discrete adjoint.

        One sweep backwards with a vector-Jacobian product a stage: exact for the steps as they were made, at a cost
        that the number of inputs and parameters does not raise (eq. 20 to 25).

        Args:
            q_bar: Derivatives of the sum by q, along its manifold (n + 1, nv) or by the coordinates (n + 1, nq), which
                differ where there are quaternions; or those by the last q alone (nv) or (nq). Zero if left out.
            v_bar: Derivatives by the speeds (n + 1, nv), or by the last ones (nv); zero if left out.

        Raises:
            ShapeError: Weights do not fit.
        """
        weights_q, weights_v = self._along_manifold(q_bar), self._weights("v_bar", v_bar, self._model.nv)
        product = self._model.bind("forward_dynamics_vjp", par=self._par)
        held, out = product.inputs, product.outputs
        tableau, h, stages = METHODS[self._method].tableau, self.dt, self._stages
        chart, ends = self._charts()
        by_u, by_par = np.zeros(self.u.shape), np.zeros(len(self._par))
        x_q, x_v = weights_q[-1].copy(), weights_v[-1].copy()
        s = tableau.stages
        y_theta, y_v = np.zeros((2, s, self._model.nv))
        for n in reversed(range(len(self.u))):
            end_theta, x_q = ends.by_theta.transposed_times(n, x_q), ends.by_start.transposed_times(n, x_q)
            for i in reversed(range(s)):
                held["q"][:], held["v"][:] = stages.q[n, i], stages.v[n, i]
                held["u"][:], held["t"][:] = self.u[n], stages.t[n, i]
                slope_theta, slope_v = h * tableau.b[i] * end_theta, h * tableau.b[i] * x_v
                if self._semi_implicit:
                    slope_v += h * slope_theta
                for j in range(i + 1, s):
                    slope_theta += h * tableau.a[j, i] * y_theta[j]
                    slope_v += h * tableau.a[j, i] * y_v[j]
                held["a_bar"][:] = slope_v
                product()
                y_v[i] = out["by_v"] + chart.rate_by_v.transposed_times((n, i), slope_theta)
                y_theta[i] = chart.by_theta.transposed_times((n, i), out["by_q"])
                y_theta[i] += chart.rate_by_theta.transposed_times((n, i), slope_theta)
                x_q = x_q + chart.by_start.transposed_times((n, i), out["by_q"])
                by_u[n] += out["by_u"]
                by_par += out["by_par"]
            x_q = x_q + weights_q[n]
            x_v += y_v.sum(axis=0) + weights_v[n]
        return MotionGradient(x_q, x_v, by_u, by_par)

    def tangents(
        self,
        dq0: Numbers | None = None,
        dv0: Numbers | None = None,
        du: Numbers | None = None,
        dpar: Numbers | None = None,
    ) -> Tangents:
        """Changes of the motion along k directions, by forward sensitivities (eq. 19, 24).

        Args:
            dq0: Changes of the first configuration along its manifold (nv, k); these and all others are zero where
                left out.
            dv0: Changes of the first speeds (nv, k).
            du: Changes of the held inputs (n, nu, k).
            dpar: Changes of the run-time parameters (npar, k).

        Raises:
            ShapeError: Directions do not fit.
        """
        m, (t, q, _, v, _), s = self._model, self._stages, self._stages.t.shape[1]
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
        chart, ends = self._charts()
        slope_theta, slope_v = np.zeros((2, s, m.nv, k))
        for n in range(len(self.u)):
            for i in range(s):
                at_theta = h * np.tensordot(tableau.a[i, :i], slope_theta[:i], 1)
                at_v = changes.v[n] + h * np.tensordot(tableau.a[i, :i], slope_v[:i], 1)
                at_q = chart.by_start.times((n, i), changes.q[n]) + chart.by_theta.times((n, i), at_theta)
                slope_v[i] = by_q[n, i] @ at_q + by_v[n, i] @ at_v + forced[n, i]
                moving = at_v + h * slope_v[i] if self._semi_implicit else at_v
                slope_theta[i] = chart.rate_by_theta.times((n, i), at_theta) + chart.rate_by_v.times((n, i), moving)
            end_theta = h * np.tensordot(tableau.b[:s], slope_theta, 1)
            changes.q[n + 1] = ends.by_start.times(n, changes.q[n]) + ends.by_theta.times(n, end_theta)
            changes.v[n + 1] = changes.v[n] + h * np.tensordot(tableau.b[:s], slope_v, 1)
        return changes

    def _charts(self) -> tuple[ChartSlopes, ChartSlopes]:
        """Derivatives of the charts at the stages (n, s) and at the ends of the steps (n)."""
        segments, stages = self._model.record.segments, self._stages
        return chart_slopes(segments, stages.theta, stages.v), chart_slopes(segments, stages.ends, self.v[1:])

    @property
    def _semi_implicit(self) -> bool:
        return METHODS[self._method].kind == "semi_implicit"

    def _along_manifold(self, given: Numbers | None) -> Array:
        """Weights of the configurations along their manifold (n + 1, nv): N^T of those of the coordinates."""
        m, shape = self._model, np.shape(given) if given is not None else ()
        if m.nq == m.nv or not shape or shape[-1] != m.nq:
            return self._weights("q_bar", given, m.nv)
        by_coordinates = self._weights("q_bar", given, m.nq)
        return manifold.along_speeds(m.record.segments, self.q, by_coordinates)

    def _weights(self, name: str, given: Numbers | None, size: int) -> Array:
        shape = (len(self.t), size)
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
    theory misses; `Rollout.notes` has what states show. Not for
    constraints, whose drift `simulate` projects away, for events, for methods that choose their
    steps. Balls and free joints move on their manifold, and derivatives by q are along it (`Model.integrate`).

    Args:
        model: Of a tree.
        q0: First coordinates (nq); quaternions are taken at unit length.
        v0: First speeds (nv).
        u: Inputs of each step (n, nu).
        dt: Step [s].
        method: "rk4", "semi_implicit_euler" or "euler".
        par: Run-time parameters (npar); the model's by default.
        t0: First time [s].

    Raises:
        SymofrosError: The model or the method is out of reach, a quaternion of q0 or among the inputs is no rotation,
            or the motion leaves the finite numbers.
        ShapeError: An array does not fit.
    """
    model.record.refuse_rigid_contacts("rollout")
    model.record.refuse_sticking("rollout")
    model.record.refuse_actions("rollout")
    if model.carried is not model:
        model.record.refuse_states(
            "rollout", "sf.rollout(model.carried, ...), q with idle coordinates, v with the states at its end"
        )
    model = model.with_precision("double")
    _refuse(model, method, dt, t0)
    held = real_array(u)
    if held is None or held.ndim != 2 or held.shape[1] != model.nu or not len(held) or not np.all(np.isfinite(held)):
        held_shape = type(u).__name__ if held is None else str(held.shape)
        raise ShapeError(
            f"model '{model.record.name}': u does not fit",
            held_shape,
            f"finite inputs of each step, of shape (n, {model.nu}), n from 1 on",
            "np.zeros((n, model.nu)) for none",
        )
    # A copy: the derivatives read it later, when the caller may have moved on.
    held = at_unit_length(model.record, "u", held.copy())
    values = model.parameter_values if par is None else vector(model, "par", model.checked_parameters(par), model.npar)
    tableau = METHODS[method].tableau
    first = first_configuration(model, q0), vector(model, "v0", v0, model.nv)
    return _stepped(model, method, tableau, first, held, float(dt), np.array(values), t0)


def _stepped(
    model: Model, method: str, tableau: Tableau, first: tuple[Array, Array], u: Array, h: float, par: Array, t0: float
) -> Rollout:
    n, s, segments = len(u), tableau.stages, model.record.segments
    t: Array = np.linspace(t0, t0 + h * n, n + 1)
    q, v = np.empty((n + 1, model.nq)), np.empty((n + 1, model.nv))
    at_q, theta_v, ends = np.empty((n, s, model.nq)), np.empty((2, n, s, model.nv)), np.empty((n, model.nv))
    stages = _Stages(t[:-1, None] + h * tableau.c[:s], at_q, theta_v[0], theta_v[1], ends)
    slope_theta, slope_v = np.zeros((2, s, model.nv))
    dynamics = model.bind("forward_dynamics", par=par)
    held, a = dynamics.inputs, dynamics.outputs["a"]
    q[0], v[0] = first
    for k in range(n):
        held["u"][:] = u[k]
        for i in range(s):
            theta = stages.theta[k, i] = h * (tableau.a[i, :i] @ slope_theta[:i])
            stages.q[k, i] = held["q"][:] = manifold.retract(segments, q[k], theta)
            at_v = stages.v[k, i] = held["v"][:] = v[k] + h * (tableau.a[i, :i] @ slope_v[:i])
            held["t"][:] = stages.t[k, i]
            dynamics()
            slope_v[i] = a
            moving = at_v + h * a if METHODS[method].kind == "semi_implicit" else at_v
            slope_theta[i] = manifold.chart_rate(segments, theta, moving)
        stages.ends[k] = h * (tableau.b[:s] @ slope_theta)
        q[k + 1] = manifold.retract(segments, q[k], stages.ends[k])
        v[k + 1] = v[k] + h * (tableau.b[:s] @ slope_v)
    if not (np.all(np.isfinite(q)) and np.all(np.isfinite(v))):
        lost = int(np.argmin(np.isfinite(q).all(axis=1) & np.isfinite(v).all(axis=1)))
        raise SymofrosError(
            f"model '{model.record.name}': the motion leaves the finite numbers",
            f"at t = {t[lost]:g} s, step {lost} of {n}",
            "a derivative needs a motion",
            "take shorter steps, or smaller inputs",
        )
    return Rollout(t, q, v, u, h, model, method, par, stages)


def _refuse(model: Model, method: str, dt: float, t0: float) -> None:
    fault = ""
    if method not in _METHODS:
        fault, remedy = f"method '{method}'", method_meant(method, _METHODS) or f"use one of {', '.join(_METHODS)}"
    elif not (np.isfinite(dt) and dt > 0.0 and np.isfinite(t0)):
        fault, remedy = f"dt = {dt}, t0 = {t0}", "give a step above zero and a finite start, in seconds"
    elif model.nc:
        fault, remedy = f"{model.nc} constraints", "cut the loops, and add their forces as springs"
    if fault:
        raise SymofrosError(f"model '{model.record.name}': no derivatives of its motion", fault, _RULE, remedy)


def _fitting(name: str, given: Numbers | None, shape: tuple[int, ...]) -> Array:
    """An array of that shape; zeros where nothing is given."""
    if given is None:
        return np.zeros(shape)
    array = real_array(given)
    if array is None or array.shape != shape:
        stated = type(given).__name__ if array is None else str(array.shape)
        raise ShapeError(f"rollout: {name} does not fit", stated, f"an array of shape {shape}", "reshape it")
    return np.asarray(array, dtype=np.float64)
