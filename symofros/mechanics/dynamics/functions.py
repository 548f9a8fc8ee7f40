"""Requests for model functions -> a Program: `base/functions.py` states them, `Equations` forms their outputs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from typing import Any, NamedTuple

from symofros.base.functions import FUNCTIONS, INPUTS, ModelFunction, OutputArray, size_of
from symofros.base.routes import Choice, choose, taken
from symofros.description.constraints import acts_on_bodies
from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.instants import operands_function
from symofros.expr.program import Function, Output, Program, Solver
from symofros.expr.substitute import substitute
from symofros.mechanics.dynamics.constraints.measures import measures_of
from symofros.mechanics.dynamics.constraints.rows import retracted
from symofros.mechanics.dynamics.derivatives.differentiation import weighted_derivatives
from symofros.mechanics.dynamics.derivatives.hessians import hessian, stacked
from symofros.mechanics.dynamics.derivatives.responses import changes_tables
from symofros.mechanics.dynamics.derivatives.second_derivatives import hessian_vector_product, second_derivatives
from symofros.mechanics.dynamics.derivatives.second_derivatives import route as by_two_speeds_route
from symofros.mechanics.dynamics.equations import Equations
from symofros.mechanics.dynamics.frame_equations import FrameEquations
from symofros.mechanics.topology.formulas import timed_values
from symofros.mechanics.topology.limbs import equal_limbs
from symofros.mechanics.topology.tree import ball_names, prescribed_speeds, section_names


class Request(NamedTuple):
    """A function that is asked for; frame functions name their frame."""

    name: str
    frame: str = ""


class Methods(NamedTuple):
    """Methods of forward dynamics.

    Attributes:
        trees: Route of the acceleration of trees.
        slopes: Method asked for of its first derivatives and adjoints: "articulated", or "" for none.
        constraints: Method asked for under constraints, as in Options.
        factors: Whether factors of M are asked for.
    """

    trees: Choice = taken("acceleration of trees", "factors")
    slopes: str = ""
    constraints: str = ""
    factors: bool = False


_DEFAULT = Methods()
# Outputs with the derivatives of inertia forces by q and v.
_BY_STATE = ("residual_by_q", "residual_by_v", "inverse_dynamics_by_q", "inverse_dynamics_by_v")


def form_program(equations: Equations, requests: Sequence[Request], methods: Methods = _DEFAULT) -> Program:
    """Form the requested functions.

    Args:
        equations: Equations of one tree; what they have formed already is shared.
        requests: Functions to form, in order.
        methods: Methods of forward dynamics.

    Returns:
        A program that reads the groups q, v, a, u, par, t, lam, gains and step.

    Raises:
        KeyError: There is no such function or frame.
    """
    known = _sizes(equations)
    functions = tuple(
        replace(_function(equations, request, methods, known), summary=FUNCTIONS[request.name].summary)
        for request in requests
    )
    groups = {group: size_of(size, known) for group, (size, _) in INPUTS.items()}
    return Program(equations.tree.system.name, equations.g, groups, functions, limbs=equal_limbs(equations.tree))


def _sizes(e: Equations) -> dict[str, int]:
    """Sizes that shapes are stated in."""
    names, constraints = e.tree.coordinates, e.tree.system.constraints
    return {
        "nq": len(names.q),
        "nv": e.nv,
        "nu": e.nu,
        "nc": sum(len(constraint.conditions) for constraint in constraints),
        "npar": len(names.par),
        "nw": len(acts_on_bodies(constraints)),
        "nj": len(e.tree.links),
        "ns": len(prescribed_speeds(e.tree)),
        "nb": sum(link.tip_of is not None and link.tip_of.modes > 0 for link in e.tree.links),
        "nf": len(section_names(e.tree)),
        "nk": len(ball_names(e.tree)),
        "npi": 10 * len(e.tree.links),
    }


def _function(e: Equations, request: Request, methods: Methods, known: Mapping[str, int]) -> Function:
    """One function's inputs and outputs."""
    row = FUNCTIONS[request.name]
    if row.transposes:
        return _transposed(e, row, _function(e, Request(row.transposes, request.frame), methods, known), methods, known)
    if row.by_solver:
        return _BUILDERS[row.name](e, row, methods, known)
    # Properties are looked up by the names that the table states.
    source: Any = FrameEquations(e, e.tree.frame(request.frame)) if row.of_frame else e
    outputs = tuple(_output(array, getattr(source, array.source), known) for array in row.outputs)
    choices = (choose("inertia forces"),) if row.name == "inverse_dynamics" else _slopes_routes(e, row)
    return Function(row.name, request.frame, (*row.inputs, *_implicit(e, row)), outputs, choices=choices)


def _implicit(e: Equations, row: ModelFunction) -> tuple[str, ...]:
    """Inputs that a function has beside those of the table: prescribed motions, and states that store energy."""
    states = ("v",) if e.kinematics.states and row.name.startswith("potential_energy") else ()
    return tuple(name for name in (*e.implicit_inputs, *states) if name not in row.inputs)


def _slopes_routes(e: Equations, row: ModelFunction) -> tuple[Choice, ...]:
    """The route of the inertia forces' derivatives among a function's outputs, once these are formed."""
    return (e.slopes_route,) if any(array.source in _BY_STATE for array in row.outputs) else ()


def _transposed(e: Equations, row: ModelFunction, of: Function, methods: Methods, known: Mapping[str, int]) -> Function:
    """Vector-Jacobian products of a function; of one that the routine for constraints finishes, by its equations."""
    by = [array.source.removeprefix("by_") for array in row.outputs]
    inputs = (*row.inputs, *_implicit(e, row))
    if of.solver is not None:
        weights = [e.g.input(group, k) for group, n in (("a_bar", e.nv), ("lam_bar", known["nc"])) for k in range(n)]
        gradient = weighted_derivatives(e.kinematics, e.residual, weights, by)
        slopes = tuple(_output(array, gradient[group], known) for array, group in zip(row.outputs, by, strict=True))
        part = Function("slopes", "", (*FUNCTIONS["residual_derivatives"].inputs, "a_bar", "lam_bar"), slopes)
        solver = Solver("transpose", _returns(row, known), (part,), measures_of(e.tree))
        choices = (choose("derivatives of constrained motion"),)
        return Function(row.name, "", inputs, _constrained_terms(e, e.gamma), solver, choices=choices)
    groups = {array.name: group for group, array in FUNCTIONS[row.transposes].cotangents.items()}
    weighted = [(output, groups[output.name]) for output in of.outputs]
    weights = [e.g.input(group, k) for output, group in weighted for k in range(len(output.edges))]
    choice = choose("vector-Jacobian product")
    if of.name == "forward_dynamics":
        choice = choose("adjoint of the acceleration", e.route_figures, methods.slopes)
        gradient = _forward_gradient(e, choice.method, weights, by)
    else:
        gradient = weighted_derivatives(e.kinematics, of.edges(), weights, by)
    outputs = tuple(_output(array, gradient[group], known) for array, group in zip(row.outputs, by, strict=True))
    return Function(row.name, of.frame, inputs, outputs, choices=(choice,))


def _forward_gradient(e: Equations, method: str, weights: Sequence[Edge], by: Sequence[str]) -> dict[str, list[Edge]]:
    """Gradient of w . a of a tree, a = M^-1 (Q - h), as -mu . dR/dx of the balance R = M a + h - Q (eq. 10)."""
    if method == "articulated":
        a, mu = e.articulated, e.articulated_solution(weights)
    else:
        a, mu = e.acceleration, e.factors.solve(weights)
    return weighted_derivatives(e.kinematics, e.balance(a), [-edge for edge in mu], by)


def _output(array: OutputArray, value: Any, known: Mapping[str, int]) -> Output:
    """An edge, a vector or a matrix of edges in the shape that the table states."""
    return Output(array.name, array.sizes(known), _flattened(value))


def _flattened(value: Any) -> tuple[Edge, ...]:
    if isinstance(value, Edge):
        return (value,)
    return tuple(edge for entry in value for edge in _flattened(entry))


def _vector(name: str, edges: Sequence[Edge]) -> Output:
    return Output(name, (len(edges),), tuple(edges))


def _matrix(name: str, shape: tuple[int, int], rows: Sequence[Sequence[Edge]]) -> Output:
    return Output(name, shape, _flattened(rows))


def _returns(row: ModelFunction, known: Mapping[str, int]) -> tuple[tuple[str, tuple[int, ...]], ...]:
    """Name and shape of each array that a solver makes."""
    return tuple((array.name, array.sizes(known)) for array in row.outputs)


def _forward_dynamics(e: Equations, row: ModelFunction, methods: Methods, known: Mapping[str, int]) -> Function:
    """Forward dynamics: accelerations of a tree; under constraints the terms, for a solver that copes with any rank."""
    if not e.tree.system.constraints:
        a = e.articulated if methods.trees.method == "articulated" else e.acceleration
        inputs = tuple(group for group in row.inputs if group != "gains")
        return Function(row.name, "", inputs, (_vector("a", a),), choices=(methods.trees,))
    choice = choose("constrained motion", asked=methods.constraints)
    routine = {"multipliers": "constrained", "null_space": "null_space"}[choice.method]
    terms = (*_constrained_terms(e, e.gamma_baumgarte), *_residuals(e))
    solver = Solver(routine, _returns(row, known), (_move(e),), measures_of(e.tree))
    return Function(row.name, "", row.inputs, terms, solver, choices=(choice,))


def _constrained_terms(e: Equations, right: Sequence[Edge]) -> tuple[Output, ...]:
    """Terms of M a = r + G^T lam, G a = c."""
    M = _matrix("M", (e.nv, e.nv), e.M)
    return M, _vector("r", e.force_minus_bias), _jacobian(e), _vector("c", right)


def _jacobian(e: Equations) -> Output:
    return _matrix("G", (len(e.constraints), e.nv), e.G)


def _forward_slopes(e: Equations, row: ModelFunction, methods: Methods, known: Mapping[str, int]) -> Function:
    """Derivatives of forward dynamics: da/dx = -M^-1 dR/dx at the motion that a = M^-1 (Q - h) makes."""
    if e.constraints:
        return _forward_slopes_by_routine(e, row, choose("derivatives of constrained motion"), known)
    columns = sum(array.sizes(known)[1] for array in row.outputs)
    by_state = not methods.factors and [array.name for array in row.outputs] == ["by_q", "by_v", "by_u"]
    figures = e.response_figures(columns) | {"by_state": by_state}
    choice = choose("derivatives of the acceleration", figures, methods.slopes)
    if choice.method == "articulated":
        return replace(_articulated_slopes(e, row, known), choices=(choice,))
    if choice.method == "sweeps":
        return _forward_slopes_by_sweeps(e, row, choice, known)
    if choice.method == "routine":
        return _forward_slopes_by_routine(e, row, choice, known)
    outputs = []
    for array in row.outputs:
        solved = e.factors.solve_columns(e.slopes_in_motion(array.name))
        outputs.append(_matrix(array.name, (e.nv, array.sizes(known)[1]), [[-edge for edge in of] for of in solved]))
    return Function(row.name, "", row.inputs, tuple(outputs), choices=(choice, *_slopes_routes(e, row)))


def _articulated_slopes(e: Equations, row: ModelFunction, known: Mapping[str, int]) -> Function:
    """The same by articulated bodies, whose wrenches are differentiated link by link (linear.md, eqs. 29, 30)."""
    outputs = tuple(_matrix(a.name, (e.nv, a.sizes(known)[1]), e.articulated_slopes(a.name)) for a in row.outputs)
    return Function(row.name, "", row.inputs, outputs)


def _forward_slopes_by_sweeps(e: Equations, row: ModelFunction, choice: Choice, known: Mapping[str, int]) -> Function:
    """The same by sweeps over the speeds (linear.md, eqs. 31-35): what these need of each, for a routine."""
    of, changes = e.responses, e.direct_changes
    steps, fields = _matrix("steps", (e.nv, 16), of.steps), _matrix("fields", (e.nv, 30), of.fields)
    terms = steps, fields, _vector("direct", [change.edge for change in changes])
    solver = Solver("responses", _returns(row, known), (), (of.parents + of.firsts, *changes_tables(changes, e.nv)))
    return Function(row.name, "", row.inputs, terms, solver, choices=(choice,))


def _forward_slopes_by_routine(e: Equations, row: ModelFunction, choice: Choice, known: Mapping[str, int]) -> Function:
    """Derivatives with constraints, or where generated code would be long: terms and slopes, for a routine."""
    if not e.constraints:
        e.refuse_massless()
    slopes = tuple(_output(array, getattr(e, array.source), known) for array in row.outputs)
    # The routine calls this part with the inputs of the residual, in that order.
    part = Function("slopes", "", FUNCTIONS["residual_derivatives"].inputs, slopes)
    solver = Solver("differentiate", _returns(row, known), (part,), measures_of(e.tree))
    return Function(
        row.name, "", row.inputs, _constrained_terms(e, e.gamma), solver, choices=(choice, *_slopes_routes(e, row))
    )


def _forward_hessian(e: Equations, row: ModelFunction, methods: Methods, known: Mapping[str, int]) -> Function:
    """Second derivatives of forward dynamics: terms, first and second derivatives of the residual, for a routine."""
    if not e.constraints:
        e.refuse_massless()
    by, unknown = ("q", "v", "u", "par"), ("a", "lam")
    weights = [e.g.input(group, k) for group, n in (("a_bar", e.nv), ("lam_bar", known["nc"])) for k in range(n)]
    blocks = hessian(e.kinematics, e.residual, weights, (*by, *unknown))
    slopes = [[*chain.from_iterable(rows)] for rows in zip(*(getattr(e, f"residual_by_{x}") for x in by), strict=True)]
    shape = len(slopes), len(slopes[0])
    inputs = FUNCTIONS["residual_derivatives"].inputs
    outputs = (
        _matrix("by_x", (shape[1], shape[1]), stacked(blocks, by, by)),
        _matrix("mixed", shape, stacked(blocks, unknown, by)),
    )
    parts = (
        Function("slopes", "", inputs, (_matrix("slopes", shape, slopes),)),
        Function("curvature", "", (*inputs, "a_bar", "lam_bar"), outputs),
    )
    solver = Solver("hessian", _returns(row, known), parts, measures_of(e.tree))
    choices = (choose("second derivatives of the motion"), e.slopes_route)
    return Function(row.name, "", row.inputs, _constrained_terms(e, e.gamma), solver, choices=choices)


def _inverse_hessian(e: Equations) -> list[list[list[Edge]]]:
    """The only output: second derivatives of tau_bar . tau."""
    by, weights = ("q", "v", "a", "par"), [e.g.input("tau_bar", k) for k in range(e.nv)]
    return [stacked(hessian(e.kinematics, e.inverse_dynamics, weights, by), by, by)]


def _project(e: Equations, row: ModelFunction, methods: Methods, known: Mapping[str, int]) -> Function:
    """The nearest state on the constraints: the terms of Newton's steps, and how a step moves q."""
    rate, facing = _vector("rate", e.constraint_rate), _vector("facing", [*chain.from_iterable(e.facing)])
    outputs = [_matrix("M", (e.nv, e.nv), e.M), _jacobian(e), *_residuals(e), rate, *([facing] if facing.edges else [])]
    return Function(
        row.name,
        "",
        row.inputs,
        tuple(outputs),
        Solver("project", _returns(row, known), (_move(e),), measures_of(e.tree)),
    )


def _residuals(e: Equations) -> tuple[Output, Output]:
    """Which conditions bind coordinates, 0 for those on speeds alone, and phi."""
    return _vector("binds", [ZERO if phi == ZERO else ONE for phi in e.phi]), _vector("phi", e.phi)


def _move(e: Equations) -> Function:
    """The function "move", which moves q along a step in the coordinates' manifold."""
    return Function("move", "", ("q", "step"), (_vector("q_moved", retracted(e.kinematics)),))


def _beam_stiffness(e: Equations, row: ModelFunction, methods: Methods, known: Mapping[str, int]) -> Function:
    """Lengths and stiffnesses of the elastic beams, by the run-time parameters alone."""
    L, EI, K = e.beam_stiffness
    outputs = _vector("L", L), _matrix("EI", (len(L), 2), EI), _matrix("K", (e.nv, e.nv), K)
    return Function(row.name, "", row.inputs, outputs)


def _instant_operands(e: Equations, row: ModelFunction, methods: Methods, known: Mapping[str, int]) -> Function:
    """The function that gives the operands of the description's formulas of time, at whose instants steps end."""
    lower = e.kinematics.lowering.value
    return operands_function(row.name, e.g, [lower(value) for value in timed_values(e.tree.system)])


def _mass_matrix_values(e: Equations, row: ModelFunction, methods: Methods, known: Mapping[str, int]) -> Function:
    """The entries of M that are not zero in every state, of the lower triangle."""
    values = [e.M[i][j] for i, j in _mass_pattern(e)]
    return Function(row.name, "", (*row.inputs, *e.implicit_inputs), (_vector("values", values),))


def _mass_matrix_pattern(e: Equations, row: ModelFunction, methods: Methods, known: Mapping[str, int]) -> Function:
    """Row and column indices of the entries that `_mass_matrix_values` gives, as constants."""
    rows, columns = ([e.g.constant(entry[side]) for entry in _mass_pattern(e)] for side in (0, 1))
    return Function(row.name, "", (), (_vector("row", rows), _vector("column", columns)))


def _mass_pattern(e: Equations) -> list[tuple[int, int]]:
    return [(i, j) for i in range(e.nv) for j in range(i + 1) if e.M[i][j] != ZERO]


def _formed(
    form: Callable[[Equations], Sequence[Any]], routes: Callable[[Equations], tuple[Choice, ...]]
) -> Callable[[Equations, ModelFunction, Methods, Mapping[str, int]], Function]:
    """Builder of a function all of whose outputs are formed together."""

    def build(e: Equations, row: ModelFunction, methods: Methods, known: Mapping[str, int]) -> Function:
        outputs = tuple(_output(array, value, known) for array, value in zip(row.outputs, form(e), strict=True))
        return Function(row.name, "", (*row.inputs, *_implicit(e, row)), outputs, choices=routes(e))

    return build


def _weighted(_: Equations) -> tuple[Choice, ...]:
    return (choose("weighted second derivatives"),)


def _rest_stiffness(e: Equations, row: ModelFunction, methods: Methods, known: Mapping[str, int]) -> Function:
    """Derivative of the forces at rest by q: terms with speeds are left out before."""
    K = e.by_q(_at_rest(e, e.at_rest.rest_residual))
    return Function(row.name, "", row.inputs, (_matrix("K", (e.nv, e.nv), K),))


def _rest_forces(e: Equations, row: ModelFunction, methods: Methods, known: Mapping[str, int]) -> Function:
    """Forces at rest, without the terms of speeds."""
    return Function(
        row.name, "", row.inputs, tuple(_vector(name, _at_rest(e, getattr(e.at_rest, name))) for name in "hQ")
    )


def _rest_damping(e: Equations, row: ModelFunction, methods: Methods, known: Mapping[str, int]) -> Function:
    """Derivative of the forces by v at rest; h is quadratic in the speeds and those of prescribed motions together."""
    forces = [e.g.sub(h, Q) for h, Q in zip(e.h, e.Q, strict=True)] if e.implicit_inputs else [-Q for Q in e.Q]
    return Function(
        row.name, "", row.inputs, (Output("D", (e.nv, e.nv), tuple(_at_rest(e, _flattened(e.by_v(forces))))),)
    )


def _at_rest(e: Equations, edges: Sequence[Edge]) -> list[Edge]:
    """Edges at v = 0: formulas of loads may name speeds."""
    return substitute(e.g, edges, {e.g.input("v", i): ZERO for i in range(e.nv)})


_Builder = Callable[[Equations, ModelFunction, Methods, Mapping[str, int]], Function]
_BUILDERS: dict[str, _Builder] = {
    "forward_dynamics": _forward_dynamics,
    "forward_dynamics_derivatives": _forward_slopes,
    "forward_dynamics_by_par": _forward_slopes,
    "mass_matrix_values": _mass_matrix_values,
    "mass_matrix_pattern": _mass_matrix_pattern,
    "inverse_dynamics_second_derivatives": _formed(
        second_derivatives, lambda e: (by_two_speeds_route(e), e.slopes_route)
    ),
    "inverse_dynamics_hessian": _formed(_inverse_hessian, _weighted),
    "forward_dynamics_hessian": _forward_hessian,
    "inverse_dynamics_hvp": _formed(hessian_vector_product, _weighted),
    "project": _project,
    "rest_stiffness": _rest_stiffness,
    "rest_forces": _rest_forces,
    "rest_damping": _rest_damping,
    "beam_stiffness": _beam_stiffness,
    "instant_operands": _instant_operands,
}
