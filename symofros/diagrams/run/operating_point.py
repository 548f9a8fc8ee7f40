"""The state about which a diagram is linearised: mechanisms on their constraints, inlets, and samples over time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from symofros.base.arrays import Array, numeric
from symofros.diagrams.inlets import VALUE, are_finite, not_finite, open_inlets
from symofros.diagrams.program.compiled import CompiledDiagram, Resolved
from symofros.diagrams.program.layout import Part
from symofros.diagrams.program.point import AFTER
from symofros.diagrams.run.parts import place_parts
from symofros.diagrams.run.starts import Start
from symofros.diagrams.run.values import parameter_values, part_settings
from symofros.errors import ShapeError, SymofrosError, UnknownNameError, did_you_mean
from symofros.runtime.manifold import retract
from symofros.simulation.analysis.sliding import contact_dynamics
from symofros.simulation.inputs import held_sample
from symofros.simulation.options import SimulationOptions


@dataclass(frozen=True)
class OperatingPoint:
    """The state about which a diagram is linearised.

    Attributes:
        t: Time [s].
        q: Configuration (nq).
        v: Speeds and states (nv).
        u: Inputs, held between samples (nu).
        a: Accelerations (nv), and `lam` multipliers (nc), of parts with constraints.
        lam: Multipliers of the constraints (nc).
        par: Run-time parameters (npar).
        varied: Entries of u that vary: the inlets; before them what sampled blocks hold and remember.
    """

    t: float
    q: Array
    v: Array
    u: Array
    a: Array
    lam: Array
    par: Array
    varied: tuple[int, ...]

    @classmethod
    def at(
        cls,
        compiled: CompiledDiagram,
        t: float,
        inputs: Mapping[str, Any],
        parameters: Mapping[str, Any],
        starts: Mapping[str, Any],
    ) -> OperatingPoint:
        """The point that is stated, mechanisms on their constraints."""
        resolved, layout = compiled.resolved, compiled.resolved.layout
        par = parameter_values(resolved, parameters)
        begin = Start.of(resolved, t, par, starts)
        for index, times, values, is_linear in layout.signals:
            begin.u[index] = np.interp(t, times, values) if is_linear else values[held_sample(times, t)]
        inlets = {inlet.name: layout.samples[inlet.name, VALUE] for inlet in open_inlets(resolved.wired.blocks)}
        for name, value in inputs.items():
            if name not in inlets:
                what, rule = f"state_space: no inlet '{name}'", f"inlets: {', '.join(inlets) or 'none'}"
                remedy = did_you_mean(name, inlets) or "leave it out"
                raise UnknownNameError(what, f"'{name}'", rule, remedy)
            array, place = numeric(f"inlet '{name}'", value), inlets[name]
            if array.shape not in ((), place.shape):
                what, rule = f"state_space: inlet '{name}' does not fit", f"numbers of shape {place.shape}"
                raise ShapeError(what, str(array.shape), rule, "give it that shape")
            if not are_finite(array):
                raise SymofrosError(not_finite(name, value))
            begin.u[place.slice] = array.reshape(-1)
        options = SimulationOptions(t0=t)
        placed = place_parts(compiled, lambda model: part_settings(options, model, t + 1.0), par, begin)
        par = layout.present(par, begin.u)
        q, v, a, lam = begin.q, begin.v, np.zeros_like(begin.v), np.zeros(len(layout.condition_names))
        for part, one in zip(layout.parts, placed, strict=True):
            q[part.q], v[part.v] = one.q, one.v
        entries = tuple(i for place in inlets.values() for i in place.range)
        point = cls(t, q, v, begin.u, a, lam, par, entries)
        kernel = compiled.instants.kernels.get(("begun", ""))
        if kernel is not None:
            point.accelerate(compiled)
            groups = [point.named[group].reshape(1, -1) for group in AFTER]
            point.u[:] = kernel.run(1, kernel.prepare(par.reshape(1, -1)), groups)[0][0]
        point.accelerate(compiled)
        return point

    def accelerate(self, compiled: CompiledDiagram) -> None:
        """Set (a, lam) of parts with constraints by the rest."""
        for part, model in zip(compiled.resolved.layout.parts, compiled.parts, strict=True):
            if model.nc:
                states = np.array([self.t]), self.q[None, part.q], self.v[None, part.v], self.u[None]
                (a,), (lam,) = contact_dynamics(model, states, self.par)
                self.a[part.v], self.lam[part.conditions] = a, lam

    @property
    def named(self) -> dict[str, Array]:
        """The inputs of functions of the whole diagram."""
        return {"q": self.q, "v": self.v, "u": self.u, "t": np.array([self.t]), "a": self.a, "lam": self.lam}

    def of(self, part: Part) -> dict[str, Array]:
        """The inputs of functions of a part."""
        a, lam = self.a[part.v], self.lam[part.conditions]
        return {**self.named, "q": self.q[part.q], "v": self.v[part.v], "a": a, "lam": lam}

    def moved(self, resolved: Resolved, change: Array, J: Array) -> OperatingPoint:
        """Another point nearby, by changes along q, of v, of what varies of u, and of t; (a; lam) by J of these."""
        a, lam = np.split(np.append(self.a, self.lam) + J @ change, [len(self.a)])
        nv, u = len(self.v), self.u.copy()
        u[list(self.varied)] += change[2 * nv : -1]
        q = retract(resolved.layout.segments, self.q, change[:nv])
        return replace(self, t=self.t + float(change[-1]), q=q, v=self.v + change[nv : 2 * nv], u=u, a=a, lam=lam)
