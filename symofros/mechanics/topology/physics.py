"""Checks of inertia: each is physical, and every joint moves some mass."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from symofros.base.rotations import Array, skew
from symofros.description.beam import STATION, Beam
from symofros.description.system import Body, RigidBody, System
from symofros.errors import Problem
from symofros.mechanics.topology.numbers import Numbers

# A thin rod or plate meets the triangle inequality with equality; its file's digits may miss it by rounding.
PHYSICAL_TOLERANCE = 1e-6


def inertia_problems(system: System, numbers: Numbers) -> Iterator[Problem]:
    """Bodies whose inertia no distribution of mass can have, unless they waive the check."""
    for body in system.bodies:
        fault = inertia_fault(body, numbers)
        if fault:
            yield Problem(
                f"body '{body.name}': non-physical inertia",
                fault,
                "mass >= 0; principal moments about the mass centre >= 0, none above the sum of the other two",
                "mend the numbers (is the matrix about the mass centre?), or waive: [nonphysical_inertia]",
                system.origin.get(("body", body.name), ""),
            )


def inertia_fault(body: Body, numbers: Numbers) -> str:
    """What no distribution of mass can have of a body's inertia; "" for none, and where the check is waived."""
    if isinstance(body, Beam) or body.inertia is None or "nonphysical_inertia" in body.waive:
        return ""
    mass = numbers.value(body.inertia.mass)
    if mass < 0.0:
        return f"mass {mass:g}"
    J = moments_about_center(body, numbers)
    if not (np.isfinite(mass) and np.all(np.isfinite(J))):
        return ""  # Reported as a value that is not finite.
    moments = np.linalg.eigvalsh(J)
    slack = PHYSICAL_TOLERANCE * max(float(np.abs(moments).max()), 1e-12)
    shown = ", ".join(f"{moment:.6g}" for moment in moments)
    if moments[0] < -slack:
        return f"principal moments {shown}: one is negative"
    if moments[2] > moments[0] + moments[1] + slack:
        return f"principal moments {shown}: the largest exceeds the sum of the others"
    if mass == 0.0 and moments[2] > slack:
        return f"principal moments {shown} without mass"
    return ""


def moments_about_center(body: RigidBody, numbers: Numbers) -> Array:
    """The inertia matrix about the mass centre, along the axes it was stated in (3, 3) [kg m^2]."""
    assert body.inertia is not None
    xx, yy, zz, xy, xz, yz = numbers.values(body.inertia.moments)
    J = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if body.inertia.about == "body":
        cross = skew(numbers.values(body.inertia.center_of_mass))
        J = J + numbers.value(body.inertia.mass) * cross @ cross
    return J


def _weight(body: Body, numbers: Numbers) -> tuple[float, float]:
    """Absolute mass [kg] and largest moment of inertia [kg m^2] of a body."""
    if isinstance(body, Beam):
        middle = numbers.extended({STATION: 0.5 * numbers.value(body.length)})
        return abs(middle.value(body.rhoA) * middle.value(body.length)), 0.0
    if body.inertia is None:
        return 0.0, 0.0
    return abs(numbers.value(body.inertia.mass)), float(np.abs(numbers.values(body.inertia.moments)).max())


def massless_tip_problems(system: System, numbers: Numbers) -> Iterator[Problem]:
    """Joints that move no mass at all: the mass matrix would be singular at every configuration."""
    mass: dict[str, float] = {}
    turning: dict[str, float] = {}
    parent_of = {body.name: body.joint.parent for body in system.bodies if body.joint is not None}
    for body in system.bodies:
        own, moments = _weight(body, numbers)
        mass[body.name], turning[body.name] = own, own + moments
    for name in _tips_first(parent_of):
        parent = parent_of[name]
        if parent in mass:
            mass[parent] += mass[name]
            turning[parent] += turning[name]
    for body in system.bodies:
        joint = body.joint
        if joint is None or joint.kind == "fixed" or "massless_tip" in body.waive:
            continue
        inertia = mass if joint.traits.translates else turning
        if inertia[body.name] == 0.0:
            yield Problem(
                f"body '{body.name}': joint '{joint.name}' moves no mass",
                "no inertia on this body or on anything it carries",
                "each moving joint carries some inertia, or the mass matrix is singular",
                "give an inertia, make the joint fixed, or waive: [massless_tip] or load(…, waive=['massless_tip'])",
                system.origin.get(("body", body.name), ""),
            )


def _tips_first(parent_of: Mapping[str, str]) -> list[str]:
    """The bodies that have a parent, each before its parent."""
    children: dict[str, list[str]] = {}
    for name, parent in parent_of.items():
        children.setdefault(parent, []).append(name)
    order = [name for parent, names in children.items() if parent not in parent_of for name in names]
    for name in order:
        order.extend(children.get(name, ()))
    return order[::-1]
