"""The stepping methods by name."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from typing import Literal

from symofros.errors import did_you_mean
from symofros.simulation.stepping import amplification
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
        rigid_contacts: Whether it follows the modes of rigid contacts, and friction of those that slide.
        trees_only: Whether constraints and prescribed joints are out of its reach.
        amplification: Factor by which a step multiplies a mode exp(z t/h), of the tableau and z; None where past steps
            count.
    """

    functions: tuple[str, ...] = ()
    implicit: bool = False
    batched: bool = False
    multistep: bool = False
    keeps_constraints: bool = False
    rigid_contacts: bool = False
    trees_only: bool = False
    amplification: Callable[[Tableau, complex], complex] | None = None

    @property
    def judged(self) -> bool:
        """Whether its fixed steps can be judged by how they amplify a mode."""
        return self.amplification is not None


FAMILIES: dict[Kind, Family] = {
    "explicit": Family(batched=True, rigid_contacts=True, amplification=amplification.explicit),
    "semi_implicit": Family(batched=True, rigid_contacts=True, amplification=amplification.semi_implicit),
    "rosenbrock": Family(
        ("implicit_terms",), implicit=True, rigid_contacts=True, amplification=amplification.rosenbrock
    ),
    "alpha": Family(("implicit_terms", "residual"), implicit=True, amplification=amplification.alpha),
    "variational": Family(
        ("implicit_terms", "momentum"), implicit=True, trees_only=True, amplification=amplification.midpoint
    ),
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
        """What methods of its kind have in common."""
        return FAMILIES[self.kind]

    def amplification(self, z: complex) -> complex:
        """Factor by which a step of length h multiplies a mode exp(z t/h); not of methods that keep past steps."""
        factor = self.family.amplification
        assert factor is not None, f"'{self.name}' keeps past steps"
        return factor(self.tableau, z)

    @property
    def real_limit(self) -> float:
        """Largest step of a mode that decays without oscillation, in units of its time constant."""
        return stability_limit(self.name, math.pi)

    @property
    def imaginary_limit(self) -> float:
        """Largest step of an undamped oscillation, in units of 1/omega; 0: each step amplifies it."""
        return stability_limit(self.name, math.pi / 2)


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

# Names that other programs have for these methods, or for the nearest.
_ELSEWHERE = {
    **dict.fromkeys(("rk45", "ode45", "dormand_prince", "rkf45", "tsit5"), "dopri5"),
    **dict.fromkeys(("dop8", "ode113", "vern7", "rk8"), "dop853"),
    **dict.fromkeys(("ode23s", "ode23t", "radau", "rosenbrock", "rodas5"), "rodas4"),
    **dict.fromkeys(("bdf", "lsoda", "ode15s", "vode"), "cvode"),
    **dict.fromkeys(("runge_kutta", "runge-kutta", "ode4"), "rk4"),
    **dict.fromkeys(("symplectic_euler", "semi-implicit-euler", "verlet", "leapfrog"), "semi_implicit_euler"),
    **dict.fromkeys(("backward_euler", "implicit-euler", "beuler"), "implicit_euler"),
    **dict.fromkeys(("newmark", "hht", "generalized-alpha"), "generalized_alpha"),
    **dict.fromkeys(("midpoint", "symplectic"), "variational"),
}


def method_meant(name: str, known: Iterable[str] = METHODS) -> str:
    """The remedy for the name of an unknown method: its name here if other programs call it so, or the nearest name.

    Args:
        name: Name as it was written.
        known: Names of the methods that may be chosen.
    """
    known = list(known)
    meant = _ELSEWHERE.get(name.lower(), "")
    return f"it is called '{meant}' here" if meant in known else did_you_mean(name, known)


# Beyond this |z|, a method that is stable is stable everywhere; an excess of |R| below it is rounding.
_FAR, _EXCESS = 1e4, 1e-10


@cache
def stability_limit(name: str, angle: float) -> float:
    """The largest |z| up to which a method does not amplify modes with z = |z| exp(i angle); inf: none is amplified.

    Args:
        name: Name of the method.
        angle: Angle of the rate in the complex plane, from pi/2 (undamped) to pi (without oscillation).
    """
    method = METHODS[name]

    def grows(radius: float) -> bool:
        return abs(method.amplification(cmath.rect(radius, angle))) > 1.0 + _EXCESS

    below, above = 0.0, 1e-2
    while not grows(above):
        below, above = above, 1.02 * above
        if above > _FAR:
            return math.inf
    if below == 0.0:
        return 0.0
    for _ in range(50):
        middle = 0.5 * (below + above)
        below, above = (below, middle) if grows(middle) else (middle, above)
    return below
