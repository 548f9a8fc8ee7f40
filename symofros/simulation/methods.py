"""The stepping methods by name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from symofros.simulation.tableaus import (
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
        functions: Model functions called besides forward_dynamics: slot of the C system -> name of the function.
        implicit: Whether each step solves equations with derivatives of the model and of its inputs.
        batched: Whether many trajectories can be stepped at once in the lanes of vectors.
        multistep: Whether past steps are kept, so that a state must not be changed between steps.
        keeps_constraints: Whether the constraints are among the equations it solves, so that nothing else keeps them.
        trees_only: Whether constraints and prescribed joints are out of its reach.
    """

    functions: Mapping[str, str] = field(default_factory=dict)
    implicit: bool = False
    batched: bool = False
    multistep: bool = False
    keeps_constraints: bool = False
    trees_only: bool = False


FAMILIES: dict[Kind, Family] = {
    "explicit": Family(batched=True),
    "semi_implicit": Family(batched=True),
    "rosenbrock": Family({"terms": "implicit_terms"}, implicit=True),
    "alpha": Family({"terms": "implicit_terms", "residual": "residual"}, implicit=True),
    "variational": Family({"terms": "implicit_terms", "momentum": "momentum"}, implicit=True, trees_only=True),
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

# Which loop of native/, as C numbers them.
KIND_CODES: dict[Kind, int] = {
    "explicit": 0,
    "semi_implicit": 1,
    "rosenbrock": 2,
    "alpha": 3,
    "variational": 4,
    "cvode": 0,
    "ida": 0,
}
