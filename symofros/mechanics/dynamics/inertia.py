"""Inertia of links, and its exact regrouping (docs/theory/rigid.md, section 4).

A joint can't tell whose mass it carries: matter at a joint's fixed origin, or spread evenly around a turning axis,
moves with the parent as well as with the link. Booking it on the parent leaves the motion, the energies and every
output unchanged, and makes entries of the link's inertia vanish. All of it happens among parameters, before run time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from symofros.description.system import Inertia
from symofros.expr.edges import ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3, Sym3, Vec3
from symofros.mechanics.beams.fields import Form
from symofros.mechanics.kinematics.links import Motion, MovingBeam, MovingLink
from symofros.mechanics.kinematics.rotations import MatrixTurn
from symofros.mechanics.topology.tree import BASE


@dataclass(frozen=True)
class LinkInertia:
    """Mass m, first moment S = m p_LC and second moment J about Lo, all in the link frame L."""

    m: Edge
    S: Vec3
    J: Sym3

    def __add__(self, other: LinkInertia) -> LinkInertia:
        return LinkInertia(self.S.g.add(self.m, other.m), self.S + other.S, self.J + other.J)

    def second_moment(self) -> Sym3:
        """The integral of r r^T dm about Lo: 1/2 tr(J) 1 - J."""
        g, J = self.S.g, self.J
        half = g.mul(g.constant(0.5), g.add(g.add(J.xx, J.yy), J.zz))
        return Sym3(g, g.sub(half, J.xx), g.sub(half, J.yy), g.sub(half, J.zz), -J.xy, -J.xz, -J.yz)


def no_inertia(g: Graph) -> LinkInertia:
    """The inertia of nothing."""
    return LinkInertia(ZERO, Vec3(g), Sym3(g))


def point_moments(m: Edge, p: Vec3) -> Sym3:
    """Second moment of a point mass: m (p.p 1 - p p^T)."""
    mp = p.scaled(m)
    return _shift_form(mp, p)


def _shift_form(a: Vec3, b: Vec3) -> Sym3:
    """The symmetric matrix (a.b) 1 - a b^T for parallel a, b."""
    g = a.g
    xx, yy, zz = (g.mul(i, j) for i, j in zip(a, b, strict=True))
    return Sym3(g, g.add(yy, zz), g.add(xx, zz), g.add(xx, yy), -g.mul(a.x, b.y), -g.mul(a.x, b.z), -g.mul(a.y, b.z))


def shifted(S: Vec3, J: Sym3, p: Vec3) -> Sym3:
    """Second moment about a new origin, for matter of first moment S and no net mass (eq. 15).

    Args:
        S: First moment about the old origin.
        J: Second moment about the old origin.
        p: From the new origin to the old.
    """
    g = S.g
    twice = p + p
    xx, yy, zz = (g.mul(a, b) for a, b in zip(twice, S, strict=True))

    def off(a: Edge, Sb: Edge, b: Edge, Sa: Edge) -> Edge:
        return -g.add(g.mul(a, Sb), g.mul(b, Sa))

    moved = Sym3(
        g,
        g.add(yy, zz),
        g.add(xx, zz),
        g.add(xx, yy),
        off(p.x, S.y, p.y, S.x),
        off(p.x, S.z, p.z, S.x),
        off(p.y, S.z, p.z, S.y),
    )
    return J + moved


def carried_to_parent(link: MovingLink, inertia: LinkInertia) -> LinkInertia:
    """A link's inertia about its parent's origin, in the parent's frame (eq. 14)."""
    S = link.R_AL.apply(inertia.S)
    J = shifted(S, link.R_AL.conjugate(inertia.J), link.p_AL)
    if inertia.m != ZERO:
        S = S + link.p_AL.scaled(inertia.m)
        J = J + point_moments(inertia.m, link.p_AL)
    return LinkInertia(inertia.m, S, J)


def link_inertias(motion: Motion, regrouped: bool = True) -> tuple[list[LinkInertia], LinkInertia]:
    """Inertia of each link with all that is fixed to it, regrouped towards the base.

    Args:
        motion: The tree.
        regrouped: Otherwise only clamped links give theirs to what they are clamped to.

    Returns:
        One inertia a link, and what the base was given: it never moves, but its weight counts in the energy.
    """
    own = {i: _stated(motion, i) for i in range(len(motion.links))}
    own[BASE] = no_inertia(motion.g)
    for i, link in reversed(list(enumerate(motion.links))):
        own[i], give = _split(link, own[i]) if regrouped else _if_clamped(link, own[i])
        if give is not None:
            own[link.parent] = own[link.parent] + _given(link, give)
    for i, link in enumerate(motion.links):
        own[i].S.named(f"mp_LLcm[{link.name}]")
        own[i].J.named(f"I_LLo_L[{link.name}]")
    base = own.pop(BASE)
    return list(own.values()), base


def inertia_inputs(motion: Motion) -> list[LinkInertia]:
    """Each link's inertia as ten inputs "pi": m, m c (3), then xx, xy, yy, xz, yz, zz about Bo, in the body frame B."""
    g, found = motion.g, []
    for i, link in enumerate(motion.links):
        m, sx, sy, sz, xx, xy, yy, xz, yz, zz = (g.input("pi", 10 * i + k) for k in range(10))
        S, J = Vec3(g, sx, sy, sz), Sym3(g, xx, yy, zz, xy, xz, yz)
        found.append(LinkInertia(m, link.R_LB.times(S), _turned(link.R_LB, J)))
    return found


def _stated(motion: Motion, index: int) -> LinkInertia:
    """The sum of the inertias stated for a link's bodies."""
    total = no_inertia(motion.g)
    for beam in motion.beams:
        if beam.root == index:
            total = total + undeformed(motion, beam)
    for placement, inertia in motion.tree.links[index].inertias:
        R_LB, p_LB = motion.lowering.placement(placement, motion.links[index].R_LB)
        total = total + _one_body(motion, inertia, R_LB, p_LB)
    return total


def undeformed(motion: Motion, beam: MovingBeam) -> LinkInertia:
    """The inertia of a straight beam; what deformation adds changes with time and is not regrouped."""
    return _from_forms(motion, beam, lambda form: form.terms.get((), ZERO), beam.forms.mass)


def deformed(motion: Motion, beam: MovingBeam) -> LinkInertia:
    """What deformation adds to the inertia of a beam, to the beam's order."""
    order = beam.forms.order

    def change(form: Form) -> Edge:
        return form.without_constant().value(order)

    return _from_forms(motion, beam, change, ZERO)


def first_moment_change(motion: Motion, beam: MovingBeam) -> Vec3:
    """What deformation adds to the first moment, one order further: its gradient is the weight's force."""
    upto = beam.forms.order + 1
    S = Vec3(motion.g, *(form.without_constant().value(upto) for form in beam.forms.first_moment))
    return motion.links[beam.root].R_LB.times(S)


def _from_forms(motion: Motion, beam: MovingBeam, value: Callable[[Form], Edge], m: Edge) -> LinkInertia:
    """Moments of a beam about its root, from its frame B to the link frame."""
    g, R = motion.g, motion.links[beam.root].R_LB
    S = R.times(Vec3(g, *map(value, beam.forms.first_moment)))
    xx, yy, zz, xy, xz, yz = map(value, beam.forms.second_moment)
    J = Sym3(g, g.add(yy, zz), g.add(xx, zz), g.add(xx, yy), -xy, -xz, -yz)
    return LinkInertia(m, S, _turned(R, J))


def _one_body(motion: Motion, inertia: Inertia, R_LB: Mat3, p_LB: Vec3) -> LinkInertia:
    """One body's inertia about Lo, from its form in the description."""
    g, lowering = motion.g, motion.lowering
    m = lowering.value(inertia.mass)
    p_BC = R_LB.times(lowering.vector(inertia.center_of_mass))  # In L.
    J = Sym3(g, *map(lowering.value, inertia.moments))
    p_LC = p_LB + p_BC
    if inertia.about == "body":
        J = _turned(R_LB, J)
        if not p_LB.is_zero:
            # From Bo to Lo: remove the mass centre's part about Bo, add it about Lo.
            J = J + -point_moments(m, p_BC) + point_moments(m, p_LC)
    else:
        J = _turned(R_LB @ lowering.rotation(inertia.rotation), J) + point_moments(m, p_LC)
    return LinkInertia(m, p_LC.scaled(m), J)


def _turned(R: Mat3, J: Sym3) -> Sym3:
    return MatrixTurn(R).conjugate(R.g, J) if R != Mat3.identity(R.g) else J


def _if_clamped(link: MovingLink, inertia: LinkInertia) -> tuple[LinkInertia, LinkInertia | None]:
    """A clamped link keeps nothing, any other all."""
    is_clamped = not link.columns and link.rates is None
    return (no_inertia(inertia.S.g), inertia) if is_clamped else (inertia, None)


def _split(link: MovingLink, inertia: LinkInertia) -> tuple[LinkInertia, LinkInertia | None]:
    """What a link keeps, and what its parent may carry instead (eqs. 16-18)."""
    g, S, J = inertia.S.g, inertia.S, inertia.J
    if not link.columns and link.rates is None:
        return _if_clamped(link, inertia)
    if link.axis is not None:
        # A rod along the axis: one transverse moment and, if it can't slide, the mass and the moment along it.
        k, i = link.axis, (link.axis + 1) % 3
        full = J.matrix()
        b = full.at((i + 1) % 3, (i + 1) % 3)
        give_J = [ZERO if axis == k else b for axis in range(3)]
        give = replace(no_inertia(g), J=Sym3(g, *give_J))
        if link.fixed_origin:
            along = [edge if axis == k else ZERO for axis, edge in enumerate(S)]
            give = replace(give, m=inertia.m, S=Vec3(g, *along))
        return LinkInertia(g.sub(inertia.m, give.m), S - give.S, J + -give.J), give
    if link.fixed_origin:
        return replace(inertia, m=ZERO), replace(no_inertia(g), m=inertia.m)
    if not any(not column.w.is_zero for column in link.columns):
        # A joint that does not turn: the second moment turns with the parent.
        return replace(inertia, J=Sym3(g)), replace(no_inertia(g), J=J)
    return inertia, None


def _given(link: MovingLink, give: LinkInertia) -> LinkInertia:
    """The given part in the parent's frame; the joint's own turn leaves it unchanged, so only constants act."""
    g = give.S.g
    factors = link.R_AL.factors
    constant = type(link.R_AL)(g, factors[:-1], link.R_AL.tensor_factors[:-1]) if link.axis is not None else link.R_AL
    p = link.p_AL if link.fixed_origin else Vec3(g)
    R = constant.matrix()
    S = R.times(give.S)
    J = shifted(S, _turned(R, give.J), p)
    return LinkInertia(give.m, S + p.scaled(give.m), J + point_moments(give.m, p))
