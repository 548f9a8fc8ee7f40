"""The stepping methods by name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from symofros.simulation.stepping.tableaus import (
    DOP853,
    DORMAND_PRINCE,
    EXPLICIT_EULER,
    LINEAR_EULER,
    RK4,
    RODAS,
    Tableau,
)

Kind = Literal["explicit", "semi_implicit", "rosenbrock", "alpha", "variational", "cvode", "ida"]


@dataclass(frozen=True)
class Family:
    """What methods of one kind have in common.

    Attributes:
        functions: Model functions called besides forward_dynamics.
        implicit: Whether each step solves equations with derivatives of the model and of its inputs.
        batched: Whether many trajectories can be stepped at once in the lanes of vectors.
        multistep: Whether past steps are kept, so that a state must not be changed between steps.
        keeps_constraints: Whether the constraints are among the equations it solves, so that nothing else keeps them.
        trees_only: Whether constraints and prescribed joints are out of its reach.
    """

    functions: tuple[str, ...] = ()
    implicit: bool = False
    batched: bool = False
    multistep: bool = False
    keeps_constraints: bool = False
    trees_only: bool = False


FAMILIES: dict[Kind, Family] = {
    "explicit": Family(batched=True),
    "semi_implicit": Family(batched=True),
    "rosenbrock": Family(("implicit_terms",), implicit=True),
    "alpha": Family(("implicit_terms", "residual"), implicit=True),
    "variational": Family(("implicit_terms", "momentum"), implicit=True, trees_only=True),
    "cvode": Family(multistep=True),
    "ida": Family(multistep=True, keeps_constraints=True),
}


@dataclass(frozen=True)
class Method:
    """A stepping method.

    Attributes:
        name: Name by which users call it.
        kind: Kind of loop that makes its steps.
        order: Order of convergence; the highest where it varies.
        adaptive: Whether it chooses its steps by an error estimate.
        tableau: Coefficients; those of Euler's method where a loop needs none.
        summary: One line for people.
    """

    name: str
    kind: Kind
    order: int
    adaptive: bool
    tableau: Tableau
    summary: str

    @property
    def constant(self) -> str:
        """The method's constant in native/stepping/symofros_stepper.h; to C, runs of SUNDIALS are explicit ones."""
        return "SYM_METHOD_EXPLICIT" if self.family.multistep else f"SYM_METHOD_{self.kind.upper()}"

    @property
    def family(self) -> Family:
        """What it has in common with methods of its kind."""
        return FAMILIES[self.kind]


METHODS: dict[str, Method] = {
    method.name: method
    for method in (
        Method("euler", "explicit", 1, False, EXPLICIT_EULER, "explicit Euler; for studies"),
        Method("semi_implicit_euler", "semi_implicit", 1, False, EXPLICIT_EULER, "one evaluation a step; real time"),
        Method("rk4", "explicit", 4, False, RK4, "classical Runge-Kutta; fixed step, real time"),
        Method("dopri5", "explicit", 5, True, DORMAND_PRINCE, "Dormand-Prince 5(4); adaptive"),
        Method("dop853", "explicit", 8, True, DOP853, "Hairer's 8(5,3); adaptive, for tight tolerances"),
        Method("implicit_euler", "rosenbrock", 1, False, LINEAR_EULER, "one linear solve a step; stiff, real time"),
        Method("rodas4", "rosenbrock", 4, True, RODAS, "Rosenbrock 4(3) with exact Jacobians; adaptive, stiff"),
        Method("generalized_alpha", "alpha", 2, False, EXPLICIT_EULER, "constraints met by each step's equations"),
        Method("variational", "variational", 2, False, EXPLICIT_EULER, "symplectic midpoint rule; long runs"),
        Method("cvode", "cvode", 5, True, EXPLICIT_EULER, "SUNDIALS, BDF of order 1 to 5; stiff"),
        Method("cvode_adams", "cvode", 12, True, EXPLICIT_EULER, "SUNDIALS, Adams of order 1 to 12; smooth"),
        Method("ida", "ida", 5, True, EXPLICIT_EULER, "SUNDIALS, BDF of order 1 to 5; constraints in its equations"),
    )
}
