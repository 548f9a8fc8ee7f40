"""Checks of inertia: each is physical, and every joint moves some mass."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import lru_cache, partial
from itertools import chain

import numpy as np

from symofros.base.arrays import Array
from symofros.description.beams.beam import STATION, Beam
from symofros.description.system import Body, Inertia, RigidBody, System
from symofros.description.values import Term, Value, substituted, symbols
from symofros.errors import Argument, Problem
from symofros.mechanics.topology.conditions import Condition, Formulas, violations
from symofros.mechanics.topology.numbers import Numbers

# What the remedy for a speed that moves no mass ends with, where functions are chosen.
OTHER_FUNCTIONS = "; or ask for other functions, such as frame_pose"
# A thin rod or plate meets the triangle inequality with equality; its file's digits may miss it by rounding.
PHYSICAL_TOLERANCE = 1e-6
# Moments below this are nothing [kg m^2].
_MIN_MOMENT = 1e-12
_ZERO, _HALF = Term(0.0), Term(0.5)


def inertia_problems(system: System, numbers: Numbers) -> Iterator[Problem]:
    """Bodies whose inertia no distribution of mass can have, unless they waive the check."""
    where = system.origin.get
    stated = [_body_conditions(body, where(("body", body.name), ""), numbers) for body in system.bodies]
    return violations(chain(*stated, rotor_conditions(system)), numbers)


def inertia_conditions(system: System) -> Iterator[Condition]:
    """Each body has an inertia that some distribution of mass has, unless it waives the check."""
    for body in system.bodies:
        yield from _body_conditions(body, system.origin.get(("body", body.name), ""))


def rotor_conditions(system: System) -> Iterator[Condition]:
    """No armature, and no inertia of a rotor, is negative, unless the body that they move waives the check."""
    for body in system.bodies:
        if body.joint is None or "nonphysical_inertia" in body.waive:
            continue
        joint, where = body.joint, system.origin.get(("joint", body.joint.name), "")
        stated = [("armature", joint.armature), *(("inertia of a rotor", rotor.inertia) for rotor in joint.rotors)]
        for label, value in stated:
            if value != 0.0:
                yield Condition((value,), "not negative", partial(_negative_rotor, joint.name, label, value, where))


def _negative_rotor(joint: str, label: str, value: Value, where: str, numbers: Numbers) -> Problem:
    return Problem(
        f"joint '{joint}': {label} {numbers.value(value):g}",
        f"'{value}'",
        "no inertia is negative: the mass matrix would not be positive definite",
        f"mend the number, or {_waived('nonphysical_inertia')}",
        where,
        Argument("waive", "nonphysical_inertia"),
    )


def has_physical_inertia(body: Body, numbers: Numbers) -> bool:
    """Whether some distribution of mass has a body's inertia, or the check is waived."""
    return next(violations(_body_conditions(body, "", numbers), numbers), None) is None


def _body_conditions(body: Body, where: str, numbers: Numbers | None = None) -> Iterator[Condition]:
    """Conditions of one body; with numbers, in these: a hundred operations a body that need not become formulas."""
    if isinstance(body, RigidBody) and body.inertia is not None and "nonphysical_inertia" not in body.waive:
        problem, inertia = partial(_nonphysical, body, where), body.inertia
        stated = _stated(inertia)
        if numbers is not None and all(symbols(value) <= numbers.parameters.keys() for value in stated):
            stated = tuple(map(numbers.value, stated))
        yield Condition(stated[:1], "not negative", problem)
        yield Condition(_physical_margins(stated, inertia.about), "positive", problem)


@lru_cache(maxsize=1 << 12)  # Bodies that an edit of a file leaves as they are.
def _physical_margins(stated: tuple[Value, ...], about: str) -> tuple[Value, ...]:
    """Margins, all positive if moments are physical, and zero without mass; of mass, mass centre and moments (10).

    The second moments E = tr(J)/2 - J of a mass distribution are positive semidefinite, which is the triangle
    inequality of the principal moments of J. With a slack on the diagonal the leading minors tell (Sylvester).
    """
    mass, J = Term(stated[0]), _central_moments(stated, about)
    size = sum((entry * entry for row in J for entry in row), _ZERO).sqrt()
    slack = _HALF * Term(PHYSICAL_TOLERANCE) * size.maximum(Term(_MIN_MOMENT))
    half_trace = _HALF * (J[0][0] + J[1][1] + J[2][2])
    (a, d, e), (_, b, f), (_, _, c) = [
        [half_trace - J[i][i] + slack if i == j else _ZERO - J[i][j] for j in range(3)] for i in range(3)
    ]
    minor = a * b - d * d
    third = c * minor - a * f * f - b * e * e + Term(2.0) * d * e * f
    # A mass, or moments too small to count.
    some_mass = mass.maximum(Term(PHYSICAL_TOLERANCE * _MIN_MOMENT) - size)
    return tuple(term.value for term in (some_mass, a, minor, third))


def _nonphysical(body: RigidBody, where: str, numbers: Numbers) -> Problem:
    return Problem(
        f"body '{body.name}': non-physical inertia",
        _fault(body, numbers),
        "mass >= 0; principal moments about the mass centre >= 0, none above the sum of the other two",
        f"mend the numbers (is the matrix about the mass centre?), or {_waived('nonphysical_inertia')}",
        where,
        Argument("waive", "nonphysical_inertia"),
    )


def _fault(body: RigidBody, numbers: Numbers) -> str:
    """Text that says what is not physical about a body's inertia."""
    assert body.inertia is not None
    mass, J = numbers.value(body.inertia.mass), moments_about_center(body, numbers)
    if not mass >= 0.0 or not np.all(np.isfinite(J)):
        return f"mass {mass:g}" if not mass >= 0.0 else "moments that are not finite"
    moments = np.linalg.eigvalsh(J)
    shown = f"principal moments {', '.join(f'{moment:.6g}' for moment in moments)}"
    if moments[0] < -PHYSICAL_TOLERANCE * float(np.abs(moments).max()):
        return f"{shown}: one is negative"
    return f"{shown}: the largest exceeds the sum of the others" if mass > 0.0 else f"{shown} without mass"


def _stated(inertia: Inertia) -> tuple[Value, ...]:
    """Mass, mass centre and moments (10)."""
    return inertia.mass, *inertia.center_of_mass, *inertia.moments


def _central_moments(stated: tuple[Value, ...], about: str) -> list[list[Term]]:
    """The inertia matrix about the mass centre, along the axes it was stated in [kg m^2].

    Args:
        stated: Mass, mass centre and moments (10).
        about: Reference point of the moments, as in Inertia.
    """
    mass, *c = map(Term, stated[:4])
    xx, yy, zz, xy, xz, yz = map(Term, stated[4:])
    J = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    if about != "body":
        return J
    square = c[0] * c[0] + c[1] * c[1] + c[2] * c[2]
    return [
        [J[i][j] - mass * (square - c[i] * c[i] if i == j else _ZERO - c[i] * c[j]) for j in range(3)] for i in range(3)
    ]


def moments_about_center(body: RigidBody, numbers: Numbers) -> Array:
    """The inertia matrix about the mass centre, along the axes it was stated in (3, 3) [kg m^2]."""
    assert body.inertia is not None
    entries = [entry.value for row in _central_moments(_stated(body.inertia), body.inertia.about) for entry in row]
    return np.array(Formulas(entries)(numbers.parameters)).reshape(3, 3)


def _weight(body: Body) -> tuple[Term, Term]:
    """Absolute mass [kg] and sum of absolute moments of inertia [kg m^2] of a body."""
    if isinstance(body, Beam):
        length = Term(body.length)
        return (Term(substituted(body.rhoA, STATION, (_HALF * length).value)) * length).absolute(), _ZERO
    if body.inertia is None:
        return _ZERO, _ZERO
    return Term(body.inertia.mass).absolute(), sum((Term(x).absolute() for x in body.inertia.moments), _ZERO)


def massless_tip_conditions(system: System) -> Iterator[Condition]:
    """Each joint moves some mass, or the mass matrix would be singular at every configuration."""
    mass: dict[str, Term] = {}
    turning: dict[str, Term] = {}
    parent_of = {body.name: body.joint.parent for body in system.bodies if body.joint is not None}
    for body in system.bodies:
        own, moments = _weight(body)
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
        where = system.origin.get(("body", body.name), "")
        yield Condition((inertia[body.name].value,), "positive", partial(_massless_tip, body.name, joint.name, where))


def moment_conditions(system: System) -> Iterator[Condition]:
    """Each tip of the tree has a moment of inertia about the axis that it turns about.

    Descriptions may lack it: kinematics needs none. Run-time parameters may not take it away.
    """
    parents = {body.joint.parent for body in system.bodies if body.joint is not None}
    for body in system.bodies:
        joint = body.joint
        if joint is None or not isinstance(body, RigidBody) or body.inertia is None or body.name in parents:
            continue
        if joint.traits.turns_about != "axis" or joint.traits.translates or joint.rotors:
            continue
        a, c = ([Term(value) for value in vector] for vector in (joint.axis, body.inertia.center_of_mass))
        arm = [a[i - 2] * c[i - 1] - a[i - 1] * c[i - 2] for i in range(3)]
        moment = _weight(body)[1] + Term(joint.armature).absolute()
        if body.inertia.about != "body":
            # Not the moment itself, but zero where that is; a product of the two overflows where each is large.
            moment += Term(body.inertia.mass).absolute().minimum(sum((x.absolute() for x in arm), _ZERO))
        where = system.origin.get(("body", body.name), "")
        yield Condition((moment.value,), "positive", partial(_massless_tip, body.name, joint.name, where))


def _massless_tip(body: str, joint: str, where: str, numbers: Numbers) -> Problem:
    return Problem(
        f"body '{body}': joint '{joint}' moves no mass",
        "no inertia on this body or on anything it carries, as the joint moves it",
        "each moving joint carries some inertia, or the mass matrix is singular",
        f"give an inertia, make the joint fixed, or {_waived('massless_tip')}",
        where,
        Argument("waive", "massless_tip"),
    )


def _waived(check: str) -> str:
    """How to waive a check: by an entry of a body in Python or a native file, or for all bodies that are read."""
    return f"waive: [{check}] or {Argument('waive', check).call}"


def _tips_first(parent_of: Mapping[str, str]) -> list[str]:
    """The bodies that have a parent, each before its parent."""
    children: dict[str, list[str]] = {}
    for name, parent in parent_of.items():
        children.setdefault(parent, []).append(name)
    order = [name for parent, names in children.items() if parent not in parent_of for name in names]
    for name in order:
        order.extend(children.get(name, ()))
    return order[::-1]
