"""Simulation.state_space: a diagram linearised about a state (docs/theory/diagrams.md, section 12)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.inlets import VALUE
from symofros.diagrams.program.compiled import CompiledDiagram, Resolved
from symofros.diagrams.program.layout import Part
from symofros.diagrams.program.slopes import (
    slopes_of_memory,
    slopes_of_outputs,
    slopes_of_part,
    slopes_of_switches,
)
from symofros.diagrams.run.operating_point import OperatingPoint
from symofros.diagrams.wiring import Source
from symofros.errors import SymofrosError
from symofros.runtime.constrained import solve
from symofros.runtime.manifold import along_speeds
from symofros.runtime.methods.linear import state_matrices
from symofros.simulation.analysis.state_space import StateSpace, allowed_changes

# A kink or crossing nearer than this, in units of states and inlets, is at the state; derivatives on both sides of it
# that differ by this share are two linear models; so are values that jump by this share of the largest.
_NEAR, _DIFFERENT, _JUMP = 1e-8, 1e-5, 1e-7


@dataclass(frozen=True)
class DiagramStateSpace(StateSpace):
    """x' = A x + B u, y = C x + D u of a diagram; of a sampled one x[k + 1] = A x[k] + B u[k], y[k] = C x[k] + D u[k].

    Attributes:
        states: What x is without constraints: changes along coordinates, of speeds and of states of blocks, or of the
            memory of sampled blocks. With constraints x = S xi, and A, B, C are of xi.
        inputs: Entries of the inlets.
        outputs: Entries of the outlets.
        rates: The rates (n) of the states at this point, which are zero at an equilibrium; of a sampled diagram their
            changes over a period.
        period: Time from one sample to the next [s]; None: continuous.
    """

    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    rates: Array
    period: float | None = None


def linearised(
    compiled: CompiledDiagram,
    *,
    t: float = 0.0,
    inputs: Mapping[str, Any] | None = None,
    parameters: Mapping[str, Any] | None = None,
    starts: Mapping[str, Any] | None = None,
    outputs: Sequence[str] | None = None,
) -> DiagramStateSpace:
    """Linearise; arguments as of `Simulation.state_space`.

    Raises:
        SymofrosError: There is no linear model of the diagram, or none at this state.
    """
    resolved = compiled.resolved
    for model in compiled.parts:
        model.record.refuse_rigid_contacts("state_space")
        if model.record.sticking:
            raise _no_model(
                resolved,
                f"friction of '{model.record.sticking[0].name}' sticks",
                "what holds and what slides has no derivative between",
                "sticks=False, which is smooth",
            )
    sources = _sources(resolved, outputs)
    point = OperatingPoint.at(compiled, t, inputs or {}, parameters or {}, starts or {})
    sampled = any(piece.is_discrete for piece in resolved.pieces.values())
    kind = _Continuous if len(point.v) or not sampled else _Sampled
    linear = kind(compiled, point, sources)
    found = linear.state_space()
    for name, matrix in (("A", found.A), ("B", found.B), ("C", found.C), ("D", found.D)):
        if not np.isfinite(matrix).all():
            remedy = "a state away from singular postures, and from roots and quotients of zero"
            raise _no_model(resolved, f"{name} is not finite", "derivatives are finite", remedy)
    _refuse_switches(linear)
    return found


def _no_model(resolved: Resolved, found: str, rule: str, remedy: str) -> SymofrosError:
    return SymofrosError(f"diagram '{resolved.wired.name}': no linear model", found, rule, remedy)


def _sources(resolved: Resolved, outputs: Sequence[str] | None) -> dict[str, Source]:
    """What y stacks: the diagram's own outlets, or signals by name."""
    names = resolved.diagram.outlets if outputs is None else outputs
    return {name: resolved.wired.output(name) for name in names}


class _Continuous:
    """A diagram without samples that reach its states or outputs."""

    due: frozenset[str] = frozenset()

    def __init__(self, compiled: CompiledDiagram, point: OperatingPoint, sources: Mapping[str, Source]) -> None:
        self.resolved, self.point = compiled.resolved, point
        self._parts = [slopes_of_part(self.resolved, part, point.varied) for part in self.resolved.layout.parts]
        self._outputs = slopes_of_outputs(self.resolved, sources, point.varied)
        self._refuse_samples()
        for part in self.resolved.layout.parts:
            self._refuse_driven(part)

    def _refuse_driven(self, part: Part) -> None:
        models, layout = self.resolved.wired.models, self.resolved.layout
        mechanisms = {name: self.resolved.pieces[name].block.mechanism() for name in part.blocks if name in layout.q}
        driven = [name for name, model in mechanisms.items() if models.record(model).driven]
        if part.nc and driven:
            raise _no_model(
                self.resolved,
                f"signals prescribe motions of '{driven[0]}', beside constraints",
                "inputs that move constraints act by their rates, too, which B has no columns for",
                "force the joints by a controller in place of prescribing them",
            )

    def _refuse_samples(self) -> None:
        """Refuse held outputs and memory of samples that states or outputs depend on."""
        layout, pieces = self.resolved.layout, self.resolved.pieces
        read = frozenset[int]().union(self._outputs.entries, *(part.entries for part in self._parts))
        for (block, key), place in {**layout.held, **layout.memory}.items():
            if pieces[block].is_discrete and not read.isdisjoint(place.range):
                raise _no_model(
                    self.resolved,
                    f"block '{block}' is sampled, each {pieces[block].block.period:g} s, beside continuous states",
                    f"its '{key}' holds between samples, so that the whole has no rates in time; sampled blocks without"
                    " continuous states are linearised from sample to sample",
                    f"leave out the period of '{block}', which is the limit of fast samples; or linearise the sampled"
                    " blocks in a diagram of their own",
                )

    def motion(self, point: OperatingPoint) -> tuple[Array, list[Array], Array]:
        """Derivatives of (a; lam) by q, v, the inlets and t; a basis of each part's changes; (a; lam) (nv + nc)."""
        layout, nv, nc = self.resolved.layout, len(point.v), len(point.lam)
        by = {"by_q": nv, "by_v": nv, "by_u": len(point.varied), "by_t": 1}
        slopes_of = {name: np.zeros((nv + nc, n)) for name, n in by.items()}
        a, bases = np.append(point.a, point.lam), list[Array]()
        for part, slopes in zip(layout.parts, self._parts, strict=True):
            found = _along(self.resolved, slopes.at(point.of(part), point.par), point.q, part)
            rows, allowed = np.arange(part.v.start, part.v.stop), np.eye(2 * part.nv)
            if part.nc:
                rows = np.append(rows, nv + np.arange(part.conditions.start, part.conditions.stop))
                found, allowed = self._on_constraints(part, found)
                found["values"] += a[rows]
            a[rows] = found["values"]
            for name, into in slopes_of.items():
                columns = part.v if name in ("by_q", "by_v") else slice(None)
                into[rows, columns] = found[name]
            bases.append(allowed)
        return np.hstack(list(slopes_of.values())), bases, a

    def matrices(self, point: OperatingPoint) -> tuple[list[Array], list[Array], Array]:
        """A, B, C, D of changes along all q and of v; a basis of each part's changes; (a; lam; y)."""
        layout, nv, (J, bases, a) = self.resolved.layout, len(point.v), self.motion(point)
        by_q, by_v, by_u, _ = np.split(J, [nv, 2 * nv, 2 * nv + len(point.varied)], axis=1)
        A, B = state_matrices(layout.segments, (by_q, by_v, by_u), point.v)
        y = _along(self.resolved, self._outputs.at(point.named, point.par), point.q, layout.whole)
        through = np.hstack([y["by_a"], y["by_lam"]])  # By the chain rule (16).
        C = np.hstack([y["by_q"], y["by_v"]]) + through @ np.hstack([by_q, by_v])
        values = y["values"] + through @ (a - np.append(point.a, point.lam)) if point.lam.size else y["values"]
        return [A, B, C, y["by_u"] + through @ by_u], bases, np.append(a, values)

    def _on_constraints(self, part: Part, found: dict[str, Array]) -> tuple[dict[str, Array], Array]:
        """Derivatives of (a; lam) from those of the residuals (15), what residuals add to them; what may change."""
        nv, nc, layout = part.nv, part.nc, self.resolved.layout
        measures, solved = layout.measures_of(part), dict[str, Array]()
        for name in ("by_q", "by_v", "by_u", "by_t", "values"):
            R = found[name]
            a, lam, _ = solve(found["M"], -R[:nv], found["G"], -R[nv : nv + nc], measures)
            solved[name] = np.concatenate([a, lam])
        on_positions = np.flatnonzero(found["binds"]).tolist()
        rates = found["by_q"][nv + nc :]
        return solved, allowed_changes(found["G"], rates, on_positions, measures, layout.moving[part.v])

    def state_space(self) -> DiagramStateSpace:
        """The linear model at the point."""
        point, layout, nv = self.point, self.resolved.layout, len(self.point.v)
        (A, B, C, D), bases, values = self.matrices(point)
        kept = np.append(layout.moving, np.ones(nv, dtype=np.bool_))  # Nothing depends on idle coordinates.
        S = np.eye(2 * nv)[:, kept]
        if len(point.lam):
            S = np.zeros((2 * nv, 0))
            for part, basis in zip(layout.parts, bases, strict=True):
                columns = np.zeros((2 * nv, basis.shape[1]))
                columns[np.r_[part.v, nv + part.v.start : nv + part.v.stop]] = basis
                S = np.hstack([S, columns])
            S = S[:, (S[kept] != 0.0).any(axis=0)]
        names = (*_coordinate_names(self.resolved), *layout.speed_labels)
        rates = S.T @ np.append(point.v, values[:nv])
        stated = tuple(np.array(names, dtype=object)[kept]), _names_of(self.resolved, point.varied), self._outputs.names
        return DiagramStateSpace(S.T @ A @ S, S.T @ B, C @ S, D, S[kept], *stated, rates)


class _Sampled:
    """A diagram whose only states are the memory of sampled blocks."""

    def __init__(self, compiled: CompiledDiagram, point: OperatingPoint, sources: Mapping[str, Source]) -> None:
        self.resolved = resolved = compiled.resolved
        layout, rates = (
            resolved.layout,
            sorted({float(piece.block.period or 0.0) for piece in resolved.pieces.values()} - {0.0}),
        )
        if len(resolved.schedule.instants) > 1:
            raise _no_model(
                resolved,
                f"samples at several instants, of periods {', '.join(f'{period:g} s' for period in rates)}",
                "one step leads from each sample to the next, of all sampled blocks together",
                "give them one period and one offset, or linearise those of each rate in a diagram of their own",
            )
        (self.due,) = resolved.schedule.sets
        outside = [name for name, piece in resolved.pieces.items() if piece.is_external]
        if outside:
            remedy = "take it out, and feed what it drives from an inlet"
            raise _no_model(resolved, f"block '{outside[0]}' is no formula", "derivatives are of formulas", remedy)
        places = [
            layout.memory[name, key]
            for name, piece in resolved.pieces.items()
            if name in self.due
            for key in piece.updates
        ]
        self._memory = tuple(i for place in places for i in place.range)
        self.point, self._inlets, self._period = (
            replace(point, varied=(*self._memory, *point.varied)),
            point.varied,
            rates[0],
        )
        self._next = slopes_of_memory(resolved, self.due, self.point.varied)
        self._outputs = slopes_of_outputs(resolved, sources, self.point.varied, self.due)

    def motion(self, point: OperatingPoint) -> tuple[Array, list[Array], Array]:
        """Of no accelerations."""
        return np.zeros((0, len(point.varied) + 1)), [], point.a

    def matrices(self, point: OperatingPoint) -> tuple[list[Array], list[Array], Array]:
        """A, B, C, D; nothing; what is remembered next, and y."""
        m = len(self._memory)
        after, y = self._next.at(point.named, point.par), self._outputs.at(point.named, point.par)
        A, B = np.split(after["by_u"], [m], axis=1)
        C, D = np.split(y["by_u"], [m], axis=1)
        return [A, B, C, D], [], np.append(after["values"], y["values"])

    def state_space(self) -> DiagramStateSpace:
        """The linear model at the point."""
        (A, B, C, D), _, after = self.matrices(self.point)
        memory, inlets = (_names_of(self.resolved, entries) for entries in (self._memory, self._inlets))
        rates = after[: len(memory)] - self.point.u[list(self._memory)]
        return DiagramStateSpace(
            A, B, C, D, np.eye(len(rates)), memory, inlets, self._outputs.names, rates, self._period
        )


def _names_of(resolved: Resolved, entries: Sequence[int]) -> tuple[str, ...]:
    """Names of entries of u, of inlets by the inlet's name."""
    return tuple(resolved.layout.u_names[i].replace(f".{VALUE}", "") for i in entries)


def _coordinate_names(resolved: Resolved) -> list[str]:
    """Names of the changes along q (nv): coordinates, or turns and displacements by their speeds."""
    layout, names = resolved.layout, [f"along {name}" for name in resolved.layout.speed_labels]
    for segment in layout.segments:
        if segment.kind == "linear":
            names[segment.v : segment.v + segment.size] = layout.q_names[segment.q : segment.q + segment.size]
    return names


def _along(resolved: Resolved, found: dict[str, Array], q: Array, part: Part) -> dict[str, Array]:
    """Values and derivatives with those by the coordinates of a part as derivatives along its speeds."""
    columns = np.zeros((len(found["by_q"]), len(q)))
    columns[:, part.q] = found["by_q"]
    return {**found, "by_q": along_speeds(resolved.layout.segments, q, columns)[:, part.v]}


def _refuse_switches(linear: _Continuous | _Sampled) -> None:
    """Refuse a point at which a crossing is met, or formulas have another derivative on each side of a kink.

    Raises:
        SymofrosError: With the block.
    """
    resolved, point = linear.resolved, linear.point
    slopes = slopes_of_switches(resolved, point.varied, linear.due)
    found = _along(resolved, slopes.at(point.named, point.par), point.q, resolved.layout.whole)
    J, _, _ = linear.motion(point)
    gradients = np.hstack([found[name] for name in ("by_q", "by_v", "by_u", "by_t")])
    gradients += np.hstack([found["by_a"], found["by_lam"]]) @ J
    sizes = np.linalg.norm(gradients, axis=1)
    for i in np.flatnonzero((np.abs(found["values"]) <= _NEAR * sizes) & (sizes > 0.0)):
        block, _, crossing = slopes.names[i].partition(".")
        change = 2.0 * _NEAR * gradients[i] / sizes[i]
        beside = [linear.matrices(point.moved(resolved, s * change, J)) for s in (-2.0, -1.0, 1.0, 2.0)]
        if not crossing and _agree(beside[1][0], beside[2][0]) and not _jump([values for *_, values in beside]):
            continue
        raise _no_model(
            resolved,
            f"block '{block}' switches at this state" + (f": '{crossing}'" if crossing else ""),
            "small changes to both sides have one linear model",
            "another state, with `starts` or `inputs`, on the side that is meant",
        )


def _agree(before: Sequence[Array], after: Sequence[Array]) -> bool:
    """Whether matrices on both sides of a kink are the same, but for how derivatives change along the way."""
    return all(
        bool((np.abs(a - b) <= _DIFFERENT * max(1.0, np.abs(a).max(initial=0.0))).all())
        for a, b in zip(before, after, strict=True)
    )


def _jump(values: Sequence[Array]) -> bool:
    """Whether values at -2, -1, 1 and 2 times a change differ by what is not proportional to it."""
    jumps = 2.0 * (values[2] - values[1]) - (values[3] - values[0])
    return not bool((np.abs(jumps) <= _JUMP * max(1.0, np.abs(values).max(initial=0.0))).all())
