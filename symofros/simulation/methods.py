"""The stepping methods by name."""

from __future__ import annotations

from dataclasses import dataclass
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

Kind = Literal["explicit", "semi_implicit", "rosenbrock", "alpha", "variational", "cvode"]


@dataclass(frozen=True)
class Method:
    """A stepping method.

    Attributes:
        name: As users call it.
        kind: Which loop of native/ makes its steps.
        order: Of convergence; the highest where it varies.
        adaptive: Whether it chooses its steps by an error estimate.
        tableau: Its coefficients; those of Euler's method where a loop needs none.
        says: One line for people.
    """

    name: str
    kind: Kind
    order: int
    adaptive: bool
    tableau: Tableau
    says: str


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
}
# Functions that each kind of method calls besides forward_dynamics: the slot of sym_scene, and the function's name.
NEEDS: dict[str, dict[str, str]] = {
    "rosenbrock": {"terms": "implicit_terms"},
    "alpha": {"terms": "implicit_terms", "residual": "residual"},
    "variational": {"terms": "implicit_terms", "momentum": "momentum"},
}
