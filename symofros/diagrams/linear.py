"""Simulation.state_space: a diagram linearised about a state (docs/theory/diagrams.md, section 12)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.base.exponential import matrix_exponential
from symofros.diagrams.inlets import VALUE
from symofros.diagrams.program.compiled import CompiledDiagram, Resolved
from symofros.diagrams.program.layout import Part
from symofros.diagrams.program.slopes import (
    entries_of_samples,
    is_constant_between_steps,
    rounded,
    slopes_of_outputs,
    slopes_of_part,
    slopes_of_samples,
    slopes_of_switches,
)
from symofros.diagrams.rates import schedule
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
        states: What x is without constraints: changes along coordinates, of speeds and of states of blocks, and of what
            sampled blocks remember. With constraints x = S xi, and A, B, C are of xi.
        inputs: Entries of the inlets; of a sampled diagram they stay as they are over a period.
        outputs: Entries of the outlets; of a sampled diagram once its first samples are taken.
        rates: The rates (n) of the states at this point, which are zero at an equilibrium; of a sampled diagram their
            changes over a period.
        period: Time from x[k] to x[k + 1] [s], the least common multiple of the sample times; None: continuous.
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
    linear = _Linear(compiled, point, sources)
    with np.errstate(invalid="ignore", over="ignore"):  # What is not finite is refused in words.
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


class _Linear:
    """A diagram's equations about a point: x' = f(x, z, w) between samples, z+ = k(x, z, w) at them.

    z is what sampled blocks hold and remember.
    """

    def __init__(self, compiled: CompiledDiagram, point: OperatingPoint, sources: Mapping[str, Source]) -> None:
        self.resolved = resolved = compiled.resolved
        pieces, layout = resolved.pieces, resolved.layout
        self.held = {key: place for key, place in layout.held.items() if pieces[key[0]].is_discrete}
        self.memory = {
            (name, key): layout.memory[name, key]
            for name, piece in pieces.items()
            for key, value in piece.updates.items()
            if piece.is_discrete and not is_constant_between_steps(piece, value)  # A mode stays as it is.
        }
        self.inlets = point.varied
        self.stored = tuple(i for of in (self.held, self.memory) for place in of.values() for i in place.range)
        point = replace(point, varied=(*self.stored, *point.varied))
        self._parts = [slopes_of_part(resolved, part, point.varied) for part in layout.parts]
        self._outputs = slopes_of_outputs(resolved, sources, point.varied)
        for part in layout.parts:
            self._refuse_driven(part)
        self.counted = self._counted(len(point.v) > 0)
        blocks = [pieces[name].block for name in self.counted]
        rates = [(block.name, float(block.period or 0.0), block.offset) for block in blocks]
        self.schedule = schedule(rates, resolved.wired.name)
        for name in rounded(resolved, sources, self.counted, point.varied):
            raise _no_model(
                resolved,
                f"block '{name}' rounds what it gives",
                "a derivative says what an output follows: of this one it is zero, though it follows its input",
                f"take '{name}' out, or a gain of 1 in its place: rounding errs by half a step at most",
            )
        self._samples = [slopes_of_samples(resolved, due, self.memory, point.varied) for due in self.schedule.sets]
        self.point = self._settled(compiled, point)

    def _counted(self, moves: bool) -> tuple[str, ...]:
        """Sampled blocks that rates and outlets depend on; where some do or nothing moves, all that remember, too."""
        pieces = self.resolved.pieces
        of = {i: key[0] for held in (self.held, self.memory) for key, place in held.items() for i in place.range}
        read = frozenset[int]().union(self._outputs.entries, *(part.entries for part in self._parts))
        more, counted = {of[i] for i in read if i in of}, set[str]()
        if more or not moves:
            more |= {name for name, _ in self.memory}
            behind = entries_of_samples(self.resolved)
        while more:
            counted |= more
            more = {of[i] for name in more for i in behind[name] if i in of} - counted
        for name in pieces:
            if name in counted and pieces[name].is_external:
                remedy = "take it out, and feed what it drives from an inlet"
                raise _no_model(self.resolved, f"block '{name}' is no formula", "derivatives are of formulas", remedy)
        return tuple(name for name in pieces if name in counted)

    def _read_before(self) -> npt.NDArray[np.int_]:
        """Which of z a cycle begins with: memory, and held outputs that the first samples do not give, or read."""
        (_, first), *_ = self.schedule.instants
        due, read = self.schedule.sets[first], self._samples[first].entries
        kept = [place for (block, _), place in self.memory.items() if block in self.counted]
        held = [place for (block, _), place in self.held.items() if block in self.counted]
        kept += [place for (block, _), place in self.held.items() if block in self.counted and block not in due]
        entries = {i for place in kept for i in place.range} | {i for place in held for i in place.range if i in read}
        return np.array([row for row, i in enumerate(self.stored) if i in entries], dtype=np.int_)

    def _refuse_motion(self, matrices: Sequence[Array], change: Array) -> None:
        """Refuse a point that a cycle of the samples leaves for one with other matrices."""
        point, resolved = self.point, self.resolved
        if not all(np.isfinite(matrix).all() for matrix in matrices):
            return  # Refused as no number after the cycle, in any case.
        moved = point.moved(resolved, change, self.motion(point)[0])
        if _agree(matrices, self.matrices(moved)[0]):
            return
        names = [*_coordinate_names(resolved), *resolved.layout.speed_labels]
        names += _names_of(resolved, point.varied)
        most = int(np.argmax(np.abs(change[:-1])))
        raise _no_model(
            resolved,
            f"the state moves while samples hold: '{names[most]}' by {change[most]:.3g} in {change[-1]:g} s",
            "from sample to sample a model is linear about an equilibrium, or where the motion changes no matrix",
            "an equilibrium, by `starts` and `inputs`, with what delays and integrators remember there",
        )

    def _rows(self, which: int) -> list[int]:
        """Entries of u that the samples of a set give, in order."""
        due = self.schedule.sets[which]
        held = [place for (block, _), place in self.held.items() if block in due]
        memory = [place for (block, _), place in self.memory.items() if block in due]
        return [i for place in (*held, *memory) for i in place.range]

    def _settled(self, compiled: CompiledDiagram, point: OperatingPoint) -> OperatingPoint:
        """The point at which sampled blocks hold what they give there, whenever they were sampled last."""
        remembered = [i for place in self.memory.values() for i in place.range]
        for _ in self.schedule.sets:  # Outputs of one set may depend on those that another one holds.
            for which, slopes in enumerate(self._samples):
                before = point.u[remembered]
                point.u[self._rows(which)] = slopes.at(point.named, point.par)["values"]
                point.u[remembered] = before
        if self.schedule.sets:
            point.accelerate(compiled)
        return point

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

    def matrices(self, point: OperatingPoint) -> tuple[list[Array], list[Array], list[Array]]:
        """Derivatives of x', of y and of the z+ of each set by (x, z, w); a basis of each part's x; (a; lam), y, z+."""
        layout, nv, (J, bases, a) = self.resolved.layout, len(point.v), self.motion(point)
        by_q, by_v, by_u, _ = np.split(J, [nv, 2 * nv, 2 * nv + len(point.varied)], axis=1)
        found, values = [np.hstack(state_matrices(layout.segments, (by_q, by_v, by_u), point.v))], [a]
        for slopes in (self._outputs, *self._samples):
            y = _along(self.resolved, slopes.at(point.named, point.par), point.q, layout.whole)
            through = np.hstack([y["by_a"], y["by_lam"]])  # By the chain rule (16).
            found.append(np.hstack([y["by_q"], y["by_v"], y["by_u"]]) + through @ J[:, :-1])
            values.append(y["values"] + (through @ (a - np.append(point.a, point.lam)) if point.lam.size else 0.0))
        return found, bases, values

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
        matrices, bases, values = self.matrices(point)
        kept = np.append(layout.moving, np.ones(nv, dtype=np.bool_))  # Nothing depends on idle coordinates.
        S = np.eye(2 * nv)[:, kept]
        if len(point.lam):
            S = np.zeros((2 * nv, 0))
            for part, basis in zip(layout.parts, bases, strict=True):
                columns = np.zeros((2 * nv, basis.shape[1]))
                columns[np.r_[part.v, nv + part.v.start : nv + part.v.stop]] = basis
                S = np.hstack([S, columns])
            S = S[:, (S[kept] != 0.0).any(axis=0)]
        names = tuple(np.array((*_coordinate_names(self.resolved), *layout.speed_labels), dtype=object)[kept])
        n, others = S.shape[1], np.eye(len(point.varied) + 1)
        lift = np.block([[S, np.zeros((2 * nv, len(others)))], [np.zeros((len(others), n)), others]])
        changes = [np.append(point.v, values[0][:nv]), np.zeros(len(values[1]))]
        changes += [after - point.u[self._rows(which)] for which, after in enumerate(values[2:])]
        of_x, y, *of_z = (np.column_stack(pair) @ lift for pair in zip(matrices, changes, strict=True))
        x, states, period = S.T @ of_x, np.arange(n), None
        if self.schedule.instants:
            x, y = self._over_a_cycle(x, y, of_z)
            period, before = float(self.schedule.cycle * self.schedule.base), self._read_before()
            self._refuse_motion(matrices, np.append(lift[:-1, :-1] @ x[:-1, -1], period))
            states = np.append(states, n + before)
            names += _names_of(self.resolved, [self.stored[i] for i in before])
        inlets = np.arange(n + len(self.stored), len(lift[0]) - 1)
        A, B, C, D = x[np.ix_(states, states)], x[np.ix_(states, inlets)], y[:, states], y[:, inlets]
        basis = lift[np.append(np.flatnonzero(kept), 2 * nv - n + states[n:])][:, states]
        stated = names, _names_of(self.resolved, self.inlets), self._outputs.names, x[states, -1], period
        return DiagramStateSpace(A, B, C, D, basis, *stated)

    def _over_a_cycle(self, x: Array, y: Array, of_z: Sequence[Array]) -> tuple[Array, Array]:
        """X after a cycle of the samples, and y after its first ones, by X before (18).

        Args:
            x: Rates of xi by X = (xi, z, w, 1).
            y: Outputs by X.
            of_z: What the samples of each set add to z, by X.
        """
        n, flow, P = len(x), np.zeros((x.shape[1], x.shape[1])), np.eye(x.shape[1])
        flow[:n], jumps, flows = x, [np.eye(len(P)) for _ in of_z], dict[int, Array]()
        for which, rows in enumerate(of_z):
            jumps[which][[n + self.stored.index(i) for i in self._rows(which)]] = rows
        at, sets = zip(*self.schedule.instants, strict=True)
        for i, (k, after) in enumerate(zip(at, (*at[1:], at[0] + self.schedule.cycle), strict=True)):
            P = jumps[sets[i]] @ P
            y = y @ P if i == 0 else y
            if after - k not in flows:
                flows[after - k] = matrix_exponential(flow * float((after - k) * self.schedule.base))
            P = flows[after - k] @ P
        return P, y


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


def _refuse_switches(linear: _Linear) -> None:
    """Refuse a point at which a crossing is met, or formulas have another derivative on each side of a kink.

    Raises:
        SymofrosError: With the block.
    """
    resolved, point = linear.resolved, linear.point
    J, _, _ = linear.motion(point)
    for due in (frozenset[str](), *linear.schedule.sets):
        slopes = slopes_of_switches(resolved, point.varied, due)
        found = _along(resolved, slopes.at(point.named, point.par), point.q, resolved.layout.whole)
        gradients = np.hstack([found[name] for name in ("by_q", "by_v", "by_u", "by_t")])
        gradients += np.hstack([found["by_a"], found["by_lam"]]) @ J
        sizes = np.linalg.norm(gradients, axis=1)
        for i in np.flatnonzero((np.abs(found["values"]) <= _NEAR * sizes) & (sizes > 0.0)):
            block, _, crossing = slopes.names[i].partition(".")
            change = 2.0 * _NEAR * gradients[i] / sizes[i]
            beside = [linear.matrices(point.moved(resolved, s * change, J)) for s in (-2.0, -1.0, 1.0, 2.0)]
            jumps = _jump([np.concatenate(values) for *_, values in beside])
            if not crossing and _agree(beside[1][0], beside[2][0]) and not jumps:
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
