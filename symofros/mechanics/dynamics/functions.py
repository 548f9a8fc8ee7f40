"""Which function returns what: requests -> a Program."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

from symofros.expr.graph import ONE, ZERO, Edge
from symofros.expr.ops import HELD
from symofros.expr.packs import WIDTH
from symofros.expr.program import Function, Output, Program, Solver
from symofros.mechanics.dynamics.constraints import moved
from symofros.mechanics.dynamics.derivatives import by_configuration, by_inputs
from symofros.mechanics.dynamics.equations import Equations
from symofros.mechanics.dynamics.frame_derivatives import frame_derivatives
from symofros.mechanics.dynamics.wrenches import closure_wrenches
from symofros.mechanics.topology.tree import NamedFrame, SpanningTree


class Request(NamedTuple):
    """A function that is asked for; frame functions name their frame."""

    name: str
    frame: str = ""


_Parts = tuple[tuple[str, ...], tuple[Output, ...]]


def _vector(name: str, edges: Sequence[Edge]) -> Output:
    return Output(name, (len(edges),), tuple(edges))


def _matrix(name: str, rows: Sequence[Sequence[Edge]]) -> Output:
    return _sized(name, (len(rows), len(rows[0]) if rows else 0), rows)


def _sized(name: str, shape: tuple[int, int], rows: Sequence[Sequence[Edge]]) -> Output:
    return Output(name, shape, tuple(edge for row in rows for edge in row))


def _dynamics(e: Equations) -> _Parts:
    return ("q", "v", "u", "t"), (_matrix("M", e.M), _vector("h", e.h), _vector("Q", e.Q))


def _wrenches(e: Equations) -> _Parts:
    on_second, on_first = closure_wrenches(e.frames, e.constraints)
    return ("q", "lam", "t"), (_matrix("on_second", on_second), _matrix("on_first", on_first))


def _inverse_derivatives(e: Equations) -> _Parts:
    by_q = by_configuration(e.motion, e.required)
    by_v = by_inputs(e.motion, e.required, "v", e.nv)
    return ("q", "v", "a", "t"), (_matrix("dtau_dq", by_q), _matrix("dtau_dv", by_v))


def _residual_derivatives(e: Equations) -> _Parts:
    return _AT_MOTION, _by_state(e, e.residual)


def _by_state(e: Equations, residual: Sequence[Edge]) -> tuple[Output, ...]:
    """The slopes of a residual by q, v and u."""
    by_q = by_configuration(e.motion, residual)
    by_v = by_inputs(e.motion, residual, "v", e.nv)
    by_u = by_inputs(e.motion, residual, "u", len(e.tree.coordinates.u))
    # Sizes are stated, because a matrix without rows or columns does not show them.
    rows, nu = len(residual), len(e.tree.coordinates.u)
    return (
        _sized("by_q", (rows, e.nv), by_q),
        _sized("by_v", (rows, e.nv), by_v),
        _sized("by_u", (rows, nu), by_u),
    )


def _rate_derivative(e: Equations) -> _Parts:
    by_q = by_configuration(e.motion, [row.rate for row in e.constraints])
    return ("q", "v", "t"), (_sized("by_q", (len(e.constraints), e.nv), by_q),)


def _by_par(e: Equations, residual: Sequence[Edge]) -> tuple[Output, ...]:
    """The slopes of a residual by the run-time parameters."""
    npar = len(e.tree.coordinates.par)
    return (_sized("by_par", (len(residual), npar), by_inputs(e.motion, residual, "par", npar)),)


def _inverse_by_par(e: Equations) -> _Parts:
    npar = len(e.tree.coordinates.par)
    by_par = _sized("dtau_dpar", (e.nv, npar), by_inputs(e.motion, e.required, "par", npar))
    return ("q", "v", "a", "t"), (by_par,)


# The motion at which the residual is differentiated; the order is that of templates/differentiate.c.in.
_AT_MOTION = ("q", "v", "a", "u", "lam", "t")
# Functions that differentiate forward dynamics -> the slopes of the residual they need.
_SLOPES: dict[str, Callable[[Equations, Sequence[Edge]], tuple[Output, ...]]] = {
    "forward_dynamics_derivatives": _by_state,
    "forward_dynamics_by_par": _by_par,
}
# Steps of elimination, eight columns each, up to which the derivatives are solved for by generated code.
_MOST_STEPS = 12000


def _implicit_terms(e: Equations) -> _Parts:
    """What an implicit step needs of the residual at a state: docs/theory/simulation.md, section 3."""
    slopes, rate = _residual_derivatives(e)[1], _rate_derivative(e)[1][0]
    return _AT_MOTION, (_matrix("M", e.M), _G(e), *slopes, replace(rate, name="rate_by_q"))


def _residual(e: Equations) -> _Parts:
    """M a + h - Q - G^T lam, phi and G v - b."""
    phi = _vector("phi", [row.phi for row in e.constraints])
    rate = _vector("phi_rate", [row.rate for row in e.constraints])
    return ("q", "v", "a", "u", "lam", "t"), (_vector("R", e.residual[: e.nv]), phi, rate)


_FUNCTIONS: dict[str, Callable[[Equations], _Parts]] = {
    "mass_matrix": lambda e: (("q",), (_matrix("M", e.M),)),
    "bias": lambda e: (("q", "v"), (_vector("h", e.h),)),
    "generalized_force": lambda e: (("q", "v", "u", "t"), (_vector("Q", e.Q),)),
    "dynamics": _dynamics,
    "inverse_dynamics": lambda e: (("q", "v", "a", "t"), (_vector("tau", e.required),)),
    "kinetic_energy": lambda e: (("q", "v"), (Output("T", (), (e.T,)),)),
    "potential_energy": lambda e: (("q", "t"), (Output("V", (), (e.V,)),)),
    "regressor": lambda e: (("q", "v", "a"), (_matrix("Y", e.regressor),)),
    "inverse_dynamics_derivatives": _inverse_derivatives,
    "inverse_dynamics_by_par": _inverse_by_par,
    "residual_derivatives": _residual_derivatives,
    "residual": _residual,
    "implicit_terms": _implicit_terms,
    "momentum": lambda e: (
        ("q", "v", "u", "t"),
        (_vector("p", e.momentum), _vector("F", e.momentum_force), _matrix("M", e.M)),
    ),
    "constraint_rate_derivative": _rate_derivative,
    "constraint": lambda e: (("q", "t"), (_vector("phi", [row.phi for row in e.constraints]),)),
    "constraint_rate": lambda e: (("q", "v", "t"), (_vector("phi_rate", [row.rate for row in e.constraints]),)),
    "constraint_jacobian": lambda e: (("q", "t"), (_matrix("G", [row.G for row in e.constraints]),)),
    "closure_wrenches": _wrenches,
    "constraint_bias": lambda e: (("q", "v", "t"), (_vector("gamma", [row.gamma for row in e.constraints]),)),
}


def _pose(e: Equations, frame: NamedFrame) -> _Parts:
    pose = e.frames.pose(frame)
    return ("q",), (_vector("p", tuple(pose.p)), Output("R", (3, 3), pose.R.entries))


def _frame_derivatives(e: Equations, frame: NamedFrame) -> _Parts:
    found = frame_derivatives(e.frames, frame, e.v_rate, len(e.tree.coordinates.u))
    return ("q", "v", "a", "u"), tuple(_sized(name, (6, size), rows) for name, (size, rows) in found.items())


_FRAME_FUNCTIONS: dict[str, Callable[[Equations, NamedFrame], _Parts]] = {
    "frame_pose": _pose,
    "frame_velocity": lambda e, f: (("q", "v"), (_vector("V", e.frames.velocity(f)),)),
    "frame_acceleration": lambda e, f: (("q", "v", "a"), (_vector("A", e.frames.acceleration(f, e.v_rate)),)),
    "frame_derivatives": _frame_derivatives,
    "frame_jacobian": lambda e, f: (("q",), (_matrix("J", e.frames.jacobian(f)),)),
    "frame_jacobian_rate": lambda e, f: (("q", "v"), (_matrix("dJ", e.frames.jacobian_rate(f)),)),
}


def _function(e: Equations, request: Request, form: str, method: str) -> Function:
    """One function's inputs and outputs.

    Raises:
        KeyError: There is no such function or frame.
    """
    if request.name == "forward_dynamics":
        return _constrained(e, form) if e.tree.system.constraints else _free(e, method)
    if request.name == "project":
        return _project(e)
    if request.name in _SLOPES:
        return _differentiated(e, request.name)
    if request.name in _FRAME_FUNCTIONS:
        inputs, outputs = _FRAME_FUNCTIONS[request.name](e, e.tree.frame(request.frame))
    else:
        inputs, outputs = _FUNCTIONS[request.name](e)
    more = tuple(name for name in e.always if name not in inputs)
    return Function(request.name, request.frame, (*inputs, *more), outputs)


def _free(e: Equations, method: str) -> Function:
    """Forward dynamics of a tree."""
    a = e.articulated if method == "articulated" else e.acceleration
    return Function("forward_dynamics", "", ("q", "v", "u", "t"), (_vector("a", a),))


def _constrained(e: Equations, form: str) -> Function:
    """Forward dynamics under constraints: the terms, for a solver that copes with any rank."""
    outputs = _terms(e, e.stabilised)
    solved = (("a", (e.nv,)), ("lam", (len(e.constraints),)), ("rank", ()))
    routine = {"multipliers": "constrained", "null_space": "null_space"}[form]
    return Function("forward_dynamics", "", ("q", "v", "u", "gains", "t"), outputs, Solver(routine, solved))


def _terms(e: Equations, right: Sequence[Edge]) -> tuple[Output, ...]:
    """M a = r + G^T lam, G a = c."""
    return _matrix("M", e.M), _vector("r", e.net), _G(e), _vector("c", right)


def _G(e: Equations) -> Output:
    return _sized("G", (len(e.constraints), e.nv), [row.G for row in e.constraints])


def _differentiated(e: Equations, name: str) -> Function:
    """Derivatives of forward dynamics: da/dx = -M^-1 dR/dx at the motion that a = M^-1 (Q - h) makes."""
    if e.constraints:
        return _differentiated_by_routine(e, name)
    # For the slopes of R(x, a), a is a value of its own.
    a = [e.g.call(HELD, edge) for edge in e.acceleration]
    slopes = _SLOPES[name](e, e.unbalanced(a))
    if e.factors.entries * sum(output.shape[1] for output in slopes) > _MOST_STEPS * WIDTH:
        return _differentiated_by_routine(e, name)
    outputs = [_sized(output.name, (e.nv, output.shape[1]), _solved(e, output)) for output in slopes]
    return Function(name, "", ("q", "v", "u", "t"), tuple(outputs))


def _solved(e: Equations, slopes: Output) -> list[list[Edge]]:
    """-M^-1 times a matrix."""
    rows, columns = slopes.shape
    found = e.factors.solve_columns([list(slopes.edges[i * columns : (i + 1) * columns]) for i in range(rows)])
    return [[-edge for edge in row] for row in found]


def _differentiated_by_routine(e: Equations, name: str) -> Function:
    """The same with constraints, or where generated code would be long: terms and slopes, for a routine."""
    if not e.constraints:
        e.refuse_massless()
    slopes = _SLOPES[name](e, e.residual)
    part = Function("slopes", "", _AT_MOTION, slopes)
    solved = tuple((output.name, output.shape) for output in slopes)
    outputs = _terms(e, [row.gamma for row in e.constraints])
    return Function(name, "", ("q", "v", "u", "t"), outputs, Solver("differentiate", solved, (part,)))


def _project(e: Equations) -> Function:
    """The nearest state on the constraints: the terms of Newton's steps, and how a step moves q."""
    rows, nq = e.constraints, len(e.tree.coordinates.q)
    binds = [ZERO if row.phi == ZERO else ONE for row in rows]
    outputs = (
        _matrix("M", e.M),
        _G(e),
        _vector("binds", binds),
        _vector("phi", [row.phi for row in rows]),
        _vector("rate", [row.rate for row in rows]),
    )
    move = Function("move", "", ("q", "step"), (_vector("q_moved", moved(e.motion)),))
    solved = (("q_on", (nq,)), ("v_on", (e.nv,)), ("residual", ()), ("rank", ()))
    return Function("project", "", ("q", "v", "u", "t"), outputs, Solver("project", solved, (move,)))


def methods(tree: SpanningTree) -> tuple[str, ...]:
    """The ways to form forward dynamics, the most accurate first; under constraints there is one."""
    if tree.system.constraints:
        return ("factors",)
    return ("articulated", "factors") if Equations(tree).is_articulated else ("factors",)


def write_program(
    tree: SpanningTree, requests: Sequence[Request], form: str = "multipliers", method: str = "factors"
) -> Program:
    """Form the requested functions of a tree.

    Args:
        tree: The mechanism.
        requests: What to form, in order.
        form: Of forward dynamics under constraints: "multipliers" or "null_space".
        method: Of forward dynamics of a tree: "articulated" or "factors".

    Returns:
        A program that reads the groups q, v, a, u, par, t.
    """
    return formed(Equations(tree), requests, form, method)


def formed(
    equations: Equations, requests: Sequence[Request], form: str = "multipliers", method: str = "factors"
) -> Program:
    """As `write_program`, of equations that may have been formed in part already."""
    tree = equations.tree
    functions = tuple(_function(equations, request, form, method) for request in requests)
    names = tree.coordinates
    sizes = {
        "q": len(names.q),
        "v": len(names.v),
        "a": len(names.v),
        "u": len(names.u),
        "par": len(names.par),
        "t": 1,
        "step": len(names.v),
        "lam": sum(len(constraint.conditions) for constraint in tree.system.constraints),
        "gains": 2 * sum(len(constraint.conditions) for constraint in tree.system.constraints),
    }
    return Program(tree.system.name, equations.g, sizes, functions)
