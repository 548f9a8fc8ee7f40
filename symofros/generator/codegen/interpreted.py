"""The other back end: a Program that is interpreted instead of compiled."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from symofros.base.arrays import Mask, rounding_of
from symofros.base.measures import Measures
from symofros.expr.edges import Edge
from symofros.expr.instants import InstantKind, Operand, instant_operands
from symofros.expr.numerics.evaluate import Evaluation, FunctionEvaluation, evaluate_edges, needed_nodes
from symofros.expr.program import Function, Program, Solver
from symofros.runtime.calls.kernel import DEFAULT_OPTIONS, Array, BatchOptions, Kernel, Numbers, Signature
from symofros.runtime.constrained import constrained, motion, project, solve
from symofros.runtime.instants import Motion, Operands, find_instants
from symofros.runtime.responses import respond

# Places in a step at which formulas of the state are looked at, and most change of an operand between two of them by
# which what it makes is seen.
_LOOKS, _RESOLVED = 4, 2.0
# Change of such an operand from one state to the next from which what it makes bends, and how large it is there.
_STEEP, _WITHIN = 0.1, 4.0


class FormulaInstants:
    """Instants of some formulas; how their operands are evaluated is found once.

    Args:
        program: Program whose graph holds the formulas.
        edges: Their edges.
        of_states: Whether they are looked at along motions, where those of states count, too.

    Attributes:
        parameters: Indices of the parameters that the instants depend on; None where there are none in any run.
    """

    def __init__(self, program: Program, edges: Sequence[Edge], of_states: bool = False) -> None:
        self._operands = instant_operands(program.graph, edges, of_states=of_states)
        self._evaluations = [Evaluation(program, [operand.edge], {}) for operand in self._operands]
        graph, edges = program.graph, [operand.edge for operand in self._operands]
        leaves = {abs(arg) for node in needed_nodes(graph, edges) for arg in graph.args[node]}.union(map(abs, edges))
        slots = [graph.slot[leaf] for leaf in leaves if leaf in graph.slot]
        counted = tuple(sorted({slot.index for slot in slots if slot.group == "par"}))
        self.parameters = counted if edges else None

    def __call__(
        self, par: Array, t0: float, t_end: float, motion: Motion | None = None, *, kinks: bool = False
    ) -> Array:
        """Instants within a span at which formulas of time, or along a motion, bend, jump or change fast.

        Args:
            par: Run-time parameters (npar).
            t0: Start of the span [s].
            t_end: End of the span [s].
            motion: Motion along which formulas of states count, where it may pass over parts of them.
            kinks: Whether bends and jumps alone count, as narrow parts depend on the span.

        Returns:
            Instants in order, after t0 and up to t_end (n) [s].
        """
        operands = self._operands
        if not operands or not t_end > t0:
            return np.zeros(0)

        def values(operand: int, t: Array) -> Array:
            at = {"t": t[:, np.newaxis], "par": par[np.newaxis]}
            return np.asarray(self._evaluations[operand](at if motion is None else {**at, **motion.states(t)})[0])

        if motion is not None and not _may_pass_over(operands, values, motion.steps):
            return np.zeros(0)
        instants = find_instants([operand.kind for operand in operands], values, t0, t_end)
        if not kinks:
            return instants
        before, behind = instants - rounding_of(instants), instants + rounding_of(instants)
        changes = [
            np.sign(values(i, before)) != np.sign(values(i, behind))
            for i, operand in enumerate(operands)
            if operand.kind == InstantKind.KINK
        ]
        return instants[np.any(changes, axis=0)] if changes else np.zeros(0)

    def bend(self, par: Array, states: Mapping[str, Array]) -> bool:
        """Whether an operand of a kink passes zero along states, or comes near to it.

        Near is what changes by as much from one state to the next, or to the one beside these. So do operands of narrow
        parts where that is a change by a tenth, and where they end: what they make is a bend between such states. A
        pulse that lies between two states, far from either, is passed over: that is another matter.

        Args:
            par: Run-time parameters (npar).
            states: States "t", "q", "v" and "u", n rows each.
        """
        at = {**states, "par": par[np.newaxis]}
        for operand, evaluation in zip(self._operands, self._evaluations, strict=True):
            value = np.broadcast_to(evaluation(at)[0], len(states["t"]))
            with np.errstate(invalid="ignore"):  # An exponential that overflows stays so.
                change = np.abs(np.diff(value, prepend=value[:1], append=value[-1:]))
            change[np.isnan(change)] = 0.0
            near = np.maximum(change[:-1], change[1:])
            if operand.kind == InstantKind.NARROW:
                passed = ~_meets(value) & (np.minimum(change[:-1], change[1:]) > 0.25 * np.abs(value))
                near[passed | (near < _STEEP)] = 0.0
            if not (np.abs(value) >= near).all():
                return True
        return False


def _meets(value: Array) -> Mask:
    """Whether states (n) lie in a narrow part, or at either side of it: a pulse that they pass over is beyond them."""
    across, within = value[:-1] * value[1:] < 0.0, np.abs(value) < _WITHIN
    met: Mask = within | np.append(across, False) | np.append(False, across)
    return met


def _may_pass_over(operands: Sequence[Operand], values: Operands, steps: Array) -> bool:
    """Whether steps that end at these times (n) may pass over a part of a formula of the state.

    What changes fast where an operand is small does so while that changes by about one; one kink alone has no length.
    """
    looked_at = np.linspace(steps[:-1], steps[1:], _LOOKS, endpoint=False, axis=1).reshape(-1)
    kinks = sum(operand.kind == InstantKind.KINK for operand in operands)
    return kinks > 1 or any(
        not np.abs(np.diff(values(i, looked_at))).max(initial=0.0) < _RESOLVED
        for i, operand in enumerate(operands)
        if operand.kind != InstantKind.KINK
    )


class InterpretedUnit:
    """The functions of a program, by NumPy."""

    def __init__(self, program: Program) -> None:
        self.kernels: dict[tuple[str, str], Kernel] = {
            (function.name, function.frame): InterpretedKernel(program, function) for function in program.functions
        }


class InterpretedKernel:
    """One function of a program."""

    def __init__(self, program: Program, function: Function) -> None:
        self._program = program
        self._function = function
        self._evaluations: dict[int, FunctionEvaluation] = {}
        self.signature = Signature(
            function.name,
            function.frame,
            tuple((name, program.sizes[name]) for name in function.inputs),
            function.returns,
        )

    def prepare(self, par: Array) -> Array:
        """The parameter-only part of the work."""
        pre = np.empty((len(par), len(self._program.init)))
        for i, column in enumerate(evaluate_edges(self._program, self._program.init, {"par": par}, {})):
            pre[:, i] = column
        return pre

    def run(
        self,
        n: int,
        pre: Array,
        inputs: list[Numbers],
        options: BatchOptions = DEFAULT_OPTIONS,
        places: Sequence[Numbers | None] = (),
    ) -> list[Numbers]:
        """Evaluate n states, none in place; in one thread, as the interpreter keeps its lock, in double precision."""
        named = dict(zip(self._function.inputs, [x.astype(np.float64, copy=False) for x in inputs], strict=True))
        outputs = self._interpret(self._function, named | {"pre": pre}, n)
        solver = self._function.solver
        results = outputs if solver is None else _TWINS[solver.routine](self, solver, named | {"pre": pre}, outputs)
        return [options.of(output) for output in results]

    def bind(self, pre: Array, inputs: list[Array], outputs: list[Array]) -> Callable[[], None]:
        """The function on fixed memory, for one state."""

        def evaluate() -> None:
            for into, result in zip(outputs, self.run(1, pre, [values[None] for values in inputs]), strict=True):
                into[...] = result[0]

        return evaluate

    def evaluate(self, function: Function, named: Mapping[str, Array]) -> list[Array]:
        """The outputs of this function, or of a part of it, for one state."""
        return [output[0] for output in self._interpret(function, named, 1)]

    def _interpret(self, function: Function, inputs: Mapping[str, Array], n: int) -> list[Array]:
        """Interpret this function or a part of it over n states; the nodes it needs are found at its first call."""
        evaluation = self._evaluations.get(id(function))
        if evaluation is None:
            evaluation = self._evaluations[id(function)] = FunctionEvaluation(self._program, function)
        return evaluation(inputs, n)

    def _motion(self, solver: Solver, named: Mapping[str, Array], outputs: list[Array]) -> list[Array]:
        """Motion by both forms, state by state: they have one solution."""
        moved = []
        for k in range(len(outputs[0])):
            state = {name: values[min(k, len(values) - 1)][None] for name, values in named.items()}
            terms, move = self._at(solver, state)
            at = [output[k] for output in outputs]
            moved.append(motion(at, terms, move, state["q"][0], Measures(*solver.tables)))
        return [np.array(values, dtype=np.float64) for values in zip(*moved, strict=True)]

    def _at(
        self, solver: Solver, state: Mapping[str, Array]
    ) -> tuple[Callable[..., list[Array]], Callable[[Array, Array], Array]]:
        """Terms of one state as functions of (q) or (q, v), and how a step moves q."""

        def terms(*place: Array) -> list[Array]:
            return self.evaluate(self._function, {**state, **{x: y[None] for x, y in zip("qv", place, strict=False)}})

        def move(q: Array, step: Array) -> Array:
            return self.evaluate(solver.parts[0], {**state, "q": q[None], "step": step[None]})[0]

        return terms, move

    def _differentiate(self, solver: Solver, named: Mapping[str, Array], outputs: list[Array]) -> list[Array]:
        """Derivatives of accelerations and multipliers, at the solution of the equations of motion."""
        M, r, G, c = outputs
        measures = Measures(*solver.tables)
        a, lam, _ = constrained(M, r, G, c, measures)
        slopes = self._interpret(solver.parts[0], {**named, "a": a, "lam": lam}, len(a))
        states = zip(M, G, zip(*slopes, strict=True), strict=True)
        derivatives = zip(*(_derivatives(m, g, list(of), measures) for m, g, of in states), strict=True)
        return [np.array(values) for values in derivatives]

    def _respond(self, solver: Solver, named: Mapping[str, Array], outputs: list[Array]) -> list[Array]:
        """Derivatives of the acceleration of a rigid tree."""
        steps, fields, direct = outputs
        return respond(steps, fields, direct, solver.tables, [shape[1] for _, shape in solver.returns])

    def _transpose(self, solver: Solver, named: Mapping[str, Array], outputs: list[Array]) -> list[Array]:
        """Vector-Jacobian products of accelerations and multipliers, by the adjoint of the equations of motion."""
        at, _ = self._with_adjoint(solver, named, outputs)
        return self._interpret(solver.parts[0], at, len(at["a"]))

    def _hessian(self, solver: Solver, named: Mapping[str, Array], outputs: list[Array]) -> list[Array]:
        """Second derivatives of the residual and first ones of the motion, at the motion that the terms determine."""
        M, _, G, c = outputs
        at, rank = self._with_adjoint(solver, named, outputs)
        (slopes,) = self._interpret(solver.parts[0], at, len(M))
        by_x, mixed = self._interpret(solver.parts[1], at, len(M))
        measures = Measures(*solver.tables)
        moved = [_derivatives(*state[:2], [state[2]], measures)[0] for state in zip(M, G, slopes, strict=True)]
        half = np.einsum("nzi,nzk->nik", mixed, np.array(moved))
        regular = rank == c.shape[1]
        return [np.where(regular[:, None, None], by_x + half + half.transpose(0, 2, 1), np.nan)]

    def _with_adjoint(
        self, solver: Solver, named: Mapping[str, Array], outputs: list[Array]
    ) -> tuple[dict[str, Array], Array]:
        """Inputs with the motion that the terms determine and the adjoint of its cotangents; the rank of G (n)."""
        M, r, G, c = outputs
        measures = Measures(*solver.tables)
        a, lam, rank = constrained(M, r, G, c, measures)
        weights = (np.broadcast_to(named[group], of.shape) for group, of in (("a_bar", a), ("lam_bar", lam)))
        mu, nu, _ = constrained(M, -next(weights), G, next(weights), measures)
        return {**named, "a": a, "lam": lam, "a_bar": mu, "lam_bar": -nu}, rank

    def _project(self, solver: Solver, named: Mapping[str, Array], outputs: list[Array]) -> list[Array]:
        """State by state."""
        projected = []
        for k in range(len(outputs[0])):
            state = {name: values[min(k, len(values) - 1)][None] for name, values in named.items()}
            terms, move = self._at(solver, state)
            projected.append(project(terms, move, state["q"][0], state["v"][0], Measures(*solver.tables)))
        return [np.array(values) for values in zip(*projected, strict=True)]


_TWINS: dict[str, Callable[[InterpretedKernel, Solver, Mapping[str, Array], list[Array]], list[Array]]] = {
    "constrained": InterpretedKernel._motion,
    "null_space": InterpretedKernel._motion,
    "project": InterpretedKernel._project,
    "differentiate": InterpretedKernel._differentiate,
    "responses": InterpretedKernel._respond,
    "transpose": InterpretedKernel._transpose,
    "hessian": InterpretedKernel._hessian,
}


def _derivatives(M: Array, G: Array, slopes: list[Array], measures: Measures) -> list[Array]:
    """The derivatives of a and lam, from those of the residual by the same arguments: -K^-1 dR/dx of each.

    Args:
        M: (nv, nv).
        G: (nc, nv).
        slopes: dR/dx (nv + nc, k) each.
        measures: Measures of the rows and columns of G.
    """
    nv = len(M)
    return [np.concatenate(solve(M, -slope[:nv], G, -slope[nv:], measures)[:2]) for slope in slopes]
