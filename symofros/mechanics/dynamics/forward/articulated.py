"""Forward dynamics by articulated bodies: from the tips to the base, and back (docs/theory/rigid.md, section 7).

Operations grow with the number of links. M is never formed: what a heavy load and light links exchange cancels link by
link, not among sums over all of them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from symofros.expr.edges import ZERO, Edge
from symofros.expr.vector import Vec3
from symofros.mechanics.dynamics.acceleration import Acceleration, base_to_tip, velocities
from symofros.mechanics.dynamics.bodies.rotors import MovingRotor
from symofros.mechanics.dynamics.forward.articulated_inertia import (
    ArticulatedInertia,
    Rows,
    acceleration_from_parent,
    wrench_in_parent,
)
from symofros.mechanics.dynamics.forward.free_joint import ArticulatedBody, FreeJoint
from symofros.mechanics.dynamics.jourdain import link_wrenches, subtree_wrenches
from symofros.mechanics.kinematics.links import MovingLink, TreeKinematics
from symofros.mechanics.spatial.across import PartialVelocity
from symofros.mechanics.spatial.inertia import LinkInertia
from symofros.mechanics.spatial.wrench import Wrench, no_wrench
from symofros.mechanics.topology.tree import BASE


def is_local(kinematics: TreeKinematics, rotor: MovingRotor) -> bool:
    """Whether a rotor couples no third body with the joint that drives it: the carrier is the parent, or rests."""
    return rotor.k is None or rotor.carrier in (BASE, kinematics.links[rotor.link].parent)


def articulated_acceleration(
    kinematics: TreeKinematics, inertias: list[LinkInertia], rotors: list[MovingRotor], gravity: Vec3, Q: Sequence[Edge]
) -> list[Edge]:
    """Solution v' of M v' + h = Q (eqs. 39-46).

    Args:
        kinematics: Kinematics of the tree.
        inertias: Inertia of each link, not regrouped: light links would bear the moments of a heavy load.
        rotors: Rotors that spin in links; each `is_local`.
        gravity: Acceleration of gravity in the world.
        Q: Generalized forces (nv).

    Returns:
        v', one edge a speed (nv).

    Raises:
        SingularMatrixError: A pivot is the number zero.
    """
    motions, biases = velocities(kinematics)
    wrenches, direct = link_wrenches(kinematics, inertias, rotors, motions, [ZERO] * kinematics.nv)
    forces = [kinematics.g.sub(inertial, applied) for inertial, applied in zip(direct, Q, strict=True)]
    base = Acceleration(Vec3(kinematics.g), -gravity)
    return _rates(kinematics, inertias, rotors, _Driven(wrenches, biases, forces, base))


def articulated_solution(
    kinematics: TreeKinematics, inertias: list[LinkInertia], rotors: list[MovingRotor], right: Sequence[Edge]
) -> list[Edge]:
    """Solution x of M x = right: rates from rest without gravity; what is eliminated is that of the acceleration.

    Args:
        kinematics: Kinematics of the tree.
        inertias: Inertia of each link, as of `articulated_acceleration`, like the rotors.
        rotors: Rotors that spin in links.
        right: Right-hand side (nv).

    Returns:
        x (nv).

    Raises:
        SingularMatrixError: A pivot is the number zero.
    """
    g, zero = kinematics.g, Vec3(kinematics.g)
    still = [Acceleration(zero, zero) for _ in kinematics.links]
    wrenches = [no_wrench(g) for _ in kinematics.links]
    return _rates(kinematics, inertias, rotors, _Driven(wrenches, still, [-edge for edge in right], still[0]))


def balances_by_link(
    kinematics: TreeKinematics,
    inertias: list[LinkInertia],
    rotors: list[MovingRotor],
    gravity: Vec3,
    Q: Sequence[Edge],
    a: Sequence[Edge],
    hold: Callable[[Sequence[Edge]], list[Edge]],
) -> list[Edge]:
    """Wrenches and balances whose derivatives, at held F and a, drive those of the acceleration (linear.md, eq. 29).

    Args:
        kinematics: Kinematics of the tree.
        inertias: Inertia of each link, as of `articulated_acceleration`, like the rotors.
        rotors: Rotors that spin in links.
        gravity: Acceleration of gravity in the world.
        Q: Generalized forces (nv).
        a: Acceleration v' that the forces make, which derivatives take for a constant (nv).
        hold: Makes constants for derivatives of edges.

    Returns:
        Of each link the wrench of its own inertia and of what it carries, f then n (6); then the forces on the speeds
        (nv). The wrenches that joints transmit, and a, are held.
    """
    g = kinematics.g
    own, forces = link_wrenches(kinematics, inertias, rotors, base_to_tip(kinematics, a, gravity), a)
    beyond = dict(subtree_wrenches(kinematics, own))
    for i, link in enumerate(kinematics.links):
        f_x, f_y, f_z, *n = hold([*beyond[i].f, *beyond[i].n])
        held = Wrench(Vec3(g, f_x, f_y, f_z), Vec3(g, *n))
        if link.parent != BASE:
            own[link.parent] = own[link.parent] + wrench_in_parent(link, held)
        for k, partial in enumerate(link.free_partial_velocities, link.first_speed):
            forces[k] = g.add(forces[k], _power(partial, held))
    wrenches = [edge for wrench in own for edge in (*wrench.f, *wrench.n)]
    return wrenches + [g.sub(force, applied) for force, applied in zip(forces, Q, strict=True)]


def articulated_joints(
    kinematics: TreeKinematics, inertias: list[LinkInertia], rotors: list[MovingRotor]
) -> list[FreeJoint]:
    """Each joint of a rigid tree with everything beyond it articulated, base to tip."""
    g, zero = kinematics.g, Vec3(kinematics.g)
    still = [Acceleration(zero, zero) for _ in kinematics.links]
    wrenches = [no_wrench(g) for _ in kinematics.links]
    links = [*map(ArticulatedBody, _inertias(kinematics, inertias), wrenches)]
    joints = _tip_to_base(kinematics, links, rotors, _Driven(wrenches, still, [ZERO] * kinematics.nv, still[0]))
    return [joint for joint in joints if joint is not None]


def articulated_response(
    kinematics: TreeKinematics, inertias: list[LinkInertia], rotors: list[MovingRotor], change: Sequence[Edge]
) -> list[Edge]:
    """Change of v' where the balances of `balances_by_link` change by so much (nv; linear.md, eq. 30)."""
    g, links = kinematics.g, len(kinematics.links)
    still = Acceleration(Vec3(g), Vec3(g))
    wrenches = [
        Wrench(Vec3(g, *change[at : at + 3]), Vec3(g, *change[at + 3 : at + 6])) for at in range(0, 6 * links, 6)
    ]
    return _rates(kinematics, inertias, rotors, _Driven(wrenches, [still] * links, change[6 * links :], still))


class _Driven(NamedTuple):
    """Forces and prescribed motions that drive the bodies.

    Attributes:
        wrenches: Wrench on each link by itself at v' = 0.
        biases: Bias acceleration of each joint: what it adds to that of its parent at v' = 0.
        forces: Inertia forces that act on speeds directly, less generalized forces (nv).
        base: Acceleration of the base.
    """

    wrenches: Sequence[Wrench]
    biases: Sequence[Acceleration]
    forces: Sequence[Edge]
    base: Acceleration


def _rates(
    kinematics: TreeKinematics, inertias: list[LinkInertia], rotors: list[MovingRotor], driven: _Driven
) -> list[Edge]:
    """Rates v' of all speeds (nv): from the tips to the base, and back (eqs. 39-46)."""
    links = [*map(ArticulatedBody, _inertias(kinematics, inertias), driven.wrenches)]
    joints = _tip_to_base(kinematics, links, rotors, driven)
    v_rate = [ZERO] * kinematics.nv
    for k in kinematics.states:
        v_rate[k] = -driven.forces[k]
    accelerations: list[Acceleration] = []
    for i, (link, joint) in enumerate(zip(kinematics.links, joints, strict=True)):
        parent = driven.base if link.parent == BASE else accelerations[link.parent]
        x = acceleration_from_parent(link, parent) + driven.biases[i]
        if joint is None:  # A section of a beam: the rates are those of the tip, which comes before it.
            rates = list(link.speed_rates(v_rate))
        else:
            rates = joint.rates(parent if joint.in_parent else x)
            v_rate[link.first_speed : link.first_speed + len(rates)] = rates
        for partial, rate in zip(link.free_partial_velocities, rates, strict=True):
            x = x + Acceleration(partial.w.scaled(rate), partial.v.scaled(rate))
        accelerations.append(x)
    return v_rate


def _inertias(kinematics: TreeKinematics, inertias: list[LinkInertia]) -> list[ArticulatedInertia]:
    """Inertia of the links by themselves, beams as they are bent."""
    articulated = [ArticulatedInertia.of(inertia) for inertia in inertias]
    for beam in kinematics.beams:
        if beam.tip is not None:
            articulated[beam.root] = articulated[beam.root] + ArticulatedInertia.of(beam.equations.deformed())
    return articulated


def _tip_to_base(
    kinematics: TreeKinematics,
    links: list[ArticulatedBody],
    rotors: list[MovingRotor],
    driven: _Driven,
) -> list[FreeJoint | None]:
    """Each joint with everything beyond it articulated, base to tip; none of a section before a beam's tip.

    Args:
        kinematics: Kinematics of the tree.
        links: Links by themselves, with their wrenches at v' = 0.
        rotors: Rotors that spin in links.
        driven: What moves them.
    """
    g, biases, forces = kinematics.g, driven.biases, driven.forces
    bodies = dict(enumerate(links)) | {BASE: ArticulatedBody(ArticulatedInertia.none(g), no_wrench(g))}
    joints: list[FreeJoint | None] = []
    # What is carried by sections of a beam before its tip acts on the speeds of the tip, which comes after them.
    carried: dict[int, _Coupling] = {}
    for i, link in reversed(list(enumerate(kinematics.links))):
        body, parent = bodies[i], bodies[link.parent]
        partials = link.free_partial_velocities
        if link.tip is not None:
            body = body.with_acceleration(biases[i])
            at_station = _carried(link, bodies[i], body)
            carried[link.tip] = carried[link.tip] + at_station if link.tip in carried else at_station
            bodies[link.parent] = body.added_to_parent(link, parent)
            joints.insert(0, None)
            continue
        coupling = _coupling(kinematics, rotors, i)
        if i in carried:
            coupling = coupling + carried[i]
        U = [body.inertia.times(Acceleration(partial.w, partial.v)) for partial in partials]
        D = [
            [g.add(_power(partial, U_k), direct) for U_k, direct in zip(U, row, strict=True)]
            for partial, row in zip(partials, coupling.direct, strict=True)
        ]
        if coupling.in_parent:
            body = body.with_acceleration(biases[i])
        d = [
            g.add(g.add(forces[link.first_speed + k], coupling.forces[k]), _power(partial, body.bias))
            for k, partial in enumerate(partials)
        ]
        if coupling.in_parent:
            U = [wrench_in_parent(link, U_k) + on_parent for U_k, on_parent in zip(U, coupling.wrenches, strict=True)]
            joint = FreeJoint(g, body.added_to_parent(link, parent), U, D, d, True, link.first_speed)
            bodies[link.parent] = joint.body
        else:
            joint = FreeJoint(g, body, U, D, d, False, link.first_speed)
            bodies[link.parent] = joint.body.with_acceleration(biases[i]).added_to_parent(link, parent)
        joints.insert(0, joint)
    return joints


@dataclass(frozen=True)
class _Coupling:
    """Inertia that couples a joint's speeds apart from the acceleration of its link (eq. 46).

    Attributes:
        direct: Forces on the speeds per rate of each (n x n).
        wrenches: Wrenches on the parent per rate of each speed (n).
        forces: Forces on the speeds at v' = 0 (n).
    """

    direct: Rows
    wrenches: list[Wrench]
    forces: list[Edge]

    @property
    def in_parent(self) -> bool:
        """Whether any wrench acts on the parent."""
        return not all(wrench.f.is_zero and wrench.n.is_zero for wrench in self.wrenches)

    def __add__(self, other: _Coupling) -> _Coupling:
        g = self.wrenches[0].f.g
        return _Coupling(
            [[g.add(a, b) for a, b in zip(*rows, strict=True)] for rows in zip(self.direct, other.direct, strict=True)],
            [a + b for a, b in zip(self.wrenches, other.wrenches, strict=True)],
            [g.add(a, b) for a, b in zip(self.forces, other.forces, strict=True)],
        )


def _carried(link: MovingLink, body: ArticulatedBody, moving: ArticulatedBody) -> _Coupling:
    """Coupling of the speeds that move a section of a beam, by the articulated body it carries (rods.md, eq. 19)."""
    partials = link.partial_velocities
    U = [body.inertia.times(Acceleration(partial.w, partial.v)) for partial in partials]
    direct = [[_power(partial, U_k) for U_k in U] for partial in partials]
    forces = [_power(partial, moving.bias) for partial in partials]
    return _Coupling(direct, [wrench_in_parent(link, U_k) for U_k in U], forces)


def _coupling(kinematics: TreeKinematics, rotors: Sequence[MovingRotor], index: int) -> _Coupling:
    """Coupling by the beam that ends in a link, and by rotors that its joint drives."""
    g = kinematics.g
    n = range(len(kinematics.links[index].free_partial_velocities))
    direct, wrenches = [[ZERO for _ in n] for _ in n], [no_wrench(g) for _ in n]
    for beam in kinematics.beams:
        if beam.tip == index:
            direct = [[beam.equations.modal_mass(i, j) for j in n] for i in n]
            wrenches = [Wrench(*beam.equations.momentum(i)) for i in n]
    for rotor in rotors:
        if rotor.link == index and rotor.k is not None:
            c, per_spin = rotor.coordinate, g.mul(rotor.inertia, rotor.ratio)
            direct[c][c] = g.add(direct[c][c], g.mul(per_spin, rotor.ratio))
            if rotor.carrier != BASE:
                wrenches[c] = wrenches[c] + Wrench(Vec3(g), rotor.axis.scaled(per_spin))
    return _Coupling(direct, wrenches, [ZERO for _ in n])


def _power(partial: PartialVelocity, wrench: Wrench) -> Edge:
    return wrench.f.g.add(partial.w.dot(wrench.n), partial.v.dot(wrench.f))
