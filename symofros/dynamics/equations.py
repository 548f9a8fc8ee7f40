"""Which function returns what: requests -> a Program."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import NamedTuple

from symofros.dynamics.applied.forces import generalized_forces, stored_energy
from symofros.dynamics.constraints import Constraints, Row, moved
from symofros.dynamics.derivatives import by_configuration, by_inputs
from symofros.dynamics.energy import kinetic_energy, potential_energy
from symofros.dynamics.forward import SingularMassMatrixError, solve
from symofros.dynamics.frame_derivatives import frame_derivatives
from symofros.dynamics.inertia import LinkInertia, inertia_inputs, link_inertias
from symofros.dynamics.jourdain import inertia_forces
from symofros.dynamics.mass_matrix import Matrix, mass_matrix
from symofros.dynamics.momentum import coadjoint, momentum_rate
from symofros.dynamics.rotors import MovingRotor, rotors_of
from symofros.dynamics.wrenches import closure_wrenches
from symofros.errors import DescriptionError, Problem
from symofros.expr.graph import ONE, ZERO, Edge, Graph
from symofros.expr.program import Function, Output, Program, Solver
from symofros.expr.substitute import substitute
from symofros.expr.vector import Vec3
from symofros.kinematics.frames import FrameKinematics
from symofros.kinematics.links import Motion, set_in_motion
from symofros.topology.tree import NamedFrame, SpanningTree

_DIVIDES = "forward dynamics divides by the inertia that each speed moves"


class Request(NamedTuple):
    """A function that is asked for; frame functions name their frame."""

    name: str
    frame: str = ""


class Equations:
    """The equations of motion of one tree: M v' + h = Q, its energies and its frames.

    Each property is formed when it is first needed, in one graph, so functions share what they have in common.
    """

    def __init__(self, tree: SpanningTree, form: str = "multipliers") -> None:
        self.tree = tree
        self.form = form
        self.g = Graph()
        self.nv = len(tree.coordinates.v)
        self.efforts = tree.coordinates.efforts
        # Prescribed motions are inputs that every function may depend on.
        self.always = ("u",) if len(tree.coordinates.u) > self.efforts else ()

    @cached_property
    def motion(self) -> Motion:
        """The tree in motion."""
        return set_in_motion(self.g, self.tree)

    @cached_property
    def _inertias(self) -> tuple[list[LinkInertia], LinkInertia]:
        return link_inertias(self.motion)

    @cached_property
    def rotors(self) -> list[MovingRotor]:
        """Rotors and armatures."""
        return rotors_of(self.motion)

    @cached_property
    def gravity(self) -> Vec3:
        """Acceleration of gravity in the world."""
        return self.motion.lowering.vector(self.tree.system.gravity)

    @cached_property
    def M(self) -> Matrix:
        """Mass matrix (nv x nv)."""
        return mass_matrix(self.motion, self._inertias[0], self.rotors)

    @cached_property
    def h(self) -> list[Edge]:
        """Coriolis, centrifugal and gravity terms (nv)."""
        return inertia_forces(self.motion, self._inertias[0], self.rotors, [ZERO] * self.nv, self.gravity)

    @cached_property
    def Q(self) -> list[Edge]:
        """Generalized forces (nv)."""
        return generalized_forces(self.motion, self.frames)

    @cached_property
    def v_rate(self) -> list[Edge]:
        """The input a, as edges (nv)."""
        return [self.g.input("a", i) for i in range(self.nv)]

    @cached_property
    def acceleration(self) -> list[Edge]:
        """V' = M^-1 (Q - h).

        Raises:
            DescriptionError: A speed moves no mass whatever the state, and so has no acceleration.
        """
        self._refuse_massless()
        try:
            return solve(self.g, self.M, self.net)
        except SingularMassMatrixError as error:
            name = self.tree.coordinates.v[error.speed]
            raise DescriptionError(
                Problem(f"system '{self.tree.system.name}': speed '{name}' moves nothing that those after it do not"
                        " move alike", "M is singular in every state", f"{_DIVIDES} alone",
                        "give the bodies between mass, turn one of the axes, or bind it by a constraint")
            ) from None  # fmt: skip

    def _refuse_massless(self) -> None:
        for k, name in enumerate(self.tree.coordinates.v):
            if self.M[k][k] == ZERO:
                raise DescriptionError(
                    Problem(f"system '{self.tree.system.name}': speed '{name}' moves no mass", "its row of M is zero",
                            _DIVIDES, "give it an inertia, or bind it by a constraint")
                )  # fmt: skip

    @cached_property
    def net(self) -> list[Edge]:
        """Q - h (nv)."""
        return [self.g.sub(Q, h) for Q, h in zip(self.Q, self.h, strict=True)]

    @cached_property
    def constraints(self) -> list[Row]:
        """One row a condition."""
        return Constraints(self.frames).rows()

    @cached_property
    def stabilised(self) -> list[Edge]:
        """What G v' must equal, with Baumgarte's terms: gamma - 2 alpha (G v - b) - beta^2 phi (nc)."""
        g, nc = self.g, len(self.constraints)
        found = []
        for i, row in enumerate(self.constraints):
            alpha, beta = g.input("gains", i), g.input("gains", nc + i)
            damped = g.mul(g.add(alpha, alpha), row.rate)
            found.append(g.sub(g.sub(row.gamma, damped), g.mul(g.mul(beta, beta), row.phi)))
        return found

    @cached_property
    def required(self) -> list[Edge]:
        """M a + h - Q(q, v, 0): what the inputs must supply for an acceleration a."""
        total = inertia_forces(self.motion, self._inertias[0], self.rotors, self.v_rate, self.gravity)
        passive = substitute(self.g, self.Q, {self.g.input("u", i): ZERO for i in range(self.efforts)})
        return [self.g.sub(needed, given) for needed, given in zip(total, passive, strict=True)]

    @cached_property
    def residual(self) -> list[Edge]:
        """M a + h - Q - G^T lam, then G a - gamma: zero for the motion that the inputs produce (nv + nc)."""
        g, a = self.g, self.v_rate
        total = inertia_forces(self.motion, self._inertias[0], self.rotors, a, self.gravity)
        found = [g.sub(needed, given) for needed, given in zip(total, self.Q, strict=True)]
        for i, row in enumerate(self.constraints):
            lam = g.input("lam", i)
            found = [g.sub(one, g.mul(lam, entry)) for one, entry in zip(found, row.G, strict=True)]
        bound = [
            g.sub(g.sum(g.mul(x, y) for x, y in zip(row.G, a, strict=True)), row.gamma) for row in self.constraints
        ]
        return found + bound

    @cached_property
    def momentum(self) -> list[Edge]:
        """P = M v (nv)."""
        return [self.g.sum(self.g.mul(m, self.g.input("v", k)) for k, m in enumerate(row)) for row in self.M]

    @cached_property
    def momentum_force(self) -> list[Edge]:
        """F with p' = F + ad_v^T p, for which the equations of motion give F = dM/dt v + Q - h - ad_v^T p (nv)."""
        g = self.g
        rate = momentum_rate(self.motion, self.momentum)
        turning = coadjoint(self.motion, self.momentum)
        total = [g.sub(g.add(r, Q), g.add(h, c)) for r, Q, h, c in zip(rate, self.Q, self.h, turning, strict=True)]
        return total

    @cached_property
    def regressor(self) -> list[list[Edge]]:
        """Y with M a + h = Y pi for rigid links: the sum is linear in their inertial parameters (nv x 10 links)."""
        own = inertia_inputs(self.motion)
        total = inertia_forces(self.motion, own, [], self.v_rate, self.gravity)
        return by_inputs(self.motion, total, "pi", 10 * len(own))

    @cached_property
    def T(self) -> Edge:
        """Kinetic energy."""
        return kinetic_energy(self.motion, self._inertias[0], self.rotors)

    @cached_property
    def V(self) -> Edge:
        """Potential energy: of the weight, and what forces store."""
        weight = potential_energy(self.frames.motion, *self._inertias, self.gravity)
        return self.g.add(weight, stored_energy(self.motion, self.frames))

    @cached_property
    def frames(self) -> FrameKinematics:
        """Kinematics of the frames, at their deflected places."""
        as_stated = all(beam.forms.order > 0 for beam in self.motion.beams)
        return FrameKinematics(self.motion if as_stated else set_in_motion(self.g, self.tree, as_seen=True))

    def function(self, request: Request) -> Function:
        """One function's inputs and outputs.

        Raises:
            KeyError: There is no such function or frame.
        """
        if request.name == "forward_dynamics" and self.tree.system.constraints:
            return self._constrained(request)
        if request.name == "project":
            return self._project(request)
        if request.name in _SLOPES:
            return self._differentiated(request)
        if request.name in _FRAME_FUNCTIONS:
            inputs, outputs = _FRAME_FUNCTIONS[request.name](self, self.tree.frame(request.frame))
        else:
            inputs, outputs = _FUNCTIONS[request.name](self)
        more = tuple(name for name in self.always if name not in inputs)
        return Function(request.name, request.frame, (*inputs, *more), outputs)

    def _constrained(self, request: Request) -> Function:
        """Forward dynamics under constraints: the terms, for a solver that copes with any rank."""
        outputs = self._terms(self.stabilised)
        solved = (("a", (self.nv,)), ("lam", (len(self.constraints),)), ("rank", ()))
        routine = {"multipliers": "constrained", "null_space": "null_space"}[self.form]
        return Function(request.name, "", ("q", "v", "u", "gains", "t"), outputs, Solver(routine, solved))

    def _terms(self, right: Sequence[Edge]) -> tuple[Output, ...]:
        """M a = r + G^T lam, G a = c."""
        return _matrix("M", self.M), _vector("r", self.net), self._G, _vector("c", right)

    @cached_property
    def _G(self) -> Output:
        return _sized("G", (len(self.constraints), self.nv), [row.G for row in self.constraints])

    def _differentiated(self, request: Request) -> Function:
        """Derivatives of forward dynamics: its terms, and the slopes of its residual."""
        if not self.constraints:
            self._refuse_massless()
        inputs, slopes = _SLOPES[request.name](self)
        part = Function("slopes", "", inputs, slopes)
        solved = tuple((output.name, output.shape) for output in slopes)
        outputs = self._terms([row.gamma for row in self.constraints])
        return Function(request.name, "", ("q", "v", "u", "t"), outputs, Solver("differentiate", solved, (part,)))

    def _project(self, request: Request) -> Function:
        """The nearest state on the constraints: the terms of Newton's steps, and how a step moves q."""
        rows, nq = self.constraints, len(self.tree.coordinates.q)
        binds = [ZERO if row.phi == ZERO else ONE for row in rows]
        outputs = (
            _matrix("M", self.M), self._G, _vector("binds", binds), _vector("phi", [row.phi for row in rows]),
            _vector("rate", [row.rate for row in rows]),
        )  # fmt: skip
        move = Function("move", "", ("q", "step"), (_vector("q_moved", moved(self.motion)),))
        solved = (("q_on", (nq,)), ("v_on", (self.nv,)), ("residual", ()), ("rank", ()))
        return Function(request.name, "", ("q", "v", "u", "t"), outputs, Solver("project", solved, (move,)))


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
    by_q = by_configuration(e.motion, e.residual)
    by_v = by_inputs(e.motion, e.residual, "v", e.nv)
    by_u = by_inputs(e.motion, e.residual, "u", len(e.tree.coordinates.u))
    # Sizes are stated, because a matrix without rows or columns does not show them.
    rows, nu = len(e.residual), len(e.tree.coordinates.u)
    outputs = (
        _sized("by_q", (rows, e.nv), by_q), _sized("by_v", (rows, e.nv), by_v), _sized("by_u", (rows, nu), by_u),
    )  # fmt: skip
    return _AT_MOTION, outputs


def _rate_derivative(e: Equations) -> _Parts:
    by_q = by_configuration(e.motion, [row.rate for row in e.constraints])
    return ("q", "v", "t"), (_sized("by_q", (len(e.constraints), e.nv), by_q),)


def _residual_by_par(e: Equations) -> _Parts:
    npar = len(e.tree.coordinates.par)
    return _AT_MOTION, (_sized("by_par", (len(e.residual), npar), by_inputs(e.motion, e.residual, "par", npar)),)


def _inverse_by_par(e: Equations) -> _Parts:
    npar = len(e.tree.coordinates.par)
    by_par = _sized("dtau_dpar", (e.nv, npar), by_inputs(e.motion, e.required, "par", npar))
    return ("q", "v", "a", "t"), (by_par,)


# The motion at which the residual is differentiated; the order is that of templates/differentiate.c.in.
_AT_MOTION = ("q", "v", "a", "u", "lam", "t")
# Functions that differentiate forward dynamics -> the slopes of the residual they need.
_SLOPES: dict[str, Callable[[Equations], _Parts]] = {
    "forward_dynamics_derivatives": _residual_derivatives,
    "forward_dynamics_by_par": _residual_by_par,
}


def _implicit_terms(e: Equations) -> _Parts:
    """What an implicit step needs of the residual at a state: docs/theory/simulation.md, section 3."""
    G = _sized("G", (len(e.constraints), e.nv), [row.G for row in e.constraints])
    slopes, rate = _residual_derivatives(e)[1], _rate_derivative(e)[1][0]
    return _AT_MOTION, (_matrix("M", e.M), G, *slopes, replace(rate, name="rate_by_q"))


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
    "forward_dynamics": lambda e: (("q", "v", "u", "t"), (_vector("a", e.acceleration),)),
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


def write_program(tree: SpanningTree, requests: Sequence[Request], form: str = "multipliers") -> Program:
    """Form the requested functions of a tree.

    Args:
        tree: The mechanism.
        requests: What to form, in order.
        form: Of forward dynamics under constraints: "multipliers" or "null_space".

    Returns:
        A program that reads the groups q, v, a, u, par, t.
    """
    equations = Equations(tree, form)
    functions = tuple(equations.function(request) for request in requests)
    names = tree.coordinates
    sizes = {
        "q": len(names.q), "v": len(names.v), "a": len(names.v), "u": len(names.u), "par": len(names.par), "t": 1,
        "step": len(names.v),
        "lam": sum(len(constraint.conditions) for constraint in tree.system.constraints),
        "gains": 2 * sum(len(constraint.conditions) for constraint in tree.system.constraints),
    }  # fmt: skip
    return Program(tree.system.name, equations.g, sizes, functions)
