"""Inertia of links, and its exact regrouping (docs/theory/rigid.md, section 4).

A joint can't tell whose mass it carries: matter at a joint's fixed origin, or spread evenly around a turning axis,
moves with the parent as well as with the link. Booking it on the parent leaves the motion, the energies and every
output unchanged, and makes entries of the link's inertia vanish. All of it happens among parameters, before run time.
"""

from __future__ import annotations

from dataclasses import replace

from symofros.description.system import Inertia
from symofros.expr.edges import ZERO
from symofros.expr.vector import Mat3, Sym3, Vec3
from symofros.mechanics.kinematics.links import MovingLink, TreeKinematics
from symofros.mechanics.spatial.inertia import LinkInertia, no_inertia, point_inertia, rotated, shifted
from symofros.mechanics.topology.tree import BASE


def inertia_in_parent(link: MovingLink, inertia: LinkInertia) -> LinkInertia:
    """A link's inertia about its parent's origin, in the parent's frame (eq. 14)."""
    S = link.R_AL.apply(inertia.mp_LLcm)
    J = shifted(S, link.R_AL.conjugate(inertia.I_LLo_L), link.p_AL)
    if inertia.m != ZERO:
        S = S + link.p_AL.scaled(inertia.m)
        J = J + point_inertia(inertia.m, link.p_AL)
    return LinkInertia(inertia.m, S, J)


def link_inertias(kinematics: TreeKinematics, regrouped: bool = True) -> tuple[list[LinkInertia], LinkInertia]:
    """Inertia of each link with all that is fixed to it, regrouped towards the base.

    Args:
        kinematics: Kinematics of the tree.
        regrouped: Whether every exact regrouping is made; otherwise clamped links alone are merged with their parents.

    Returns:
        One inertia a link, and the base's share: it never moves, but its weight counts in the energy.
    """
    kept = dict(enumerate(stated_inertias(kinematics)))
    kept[BASE] = no_inertia(kinematics.g)
    for i, link in reversed(list(enumerate(kinematics.links))):
        kept[i], share = _split(link, kept[i]) if regrouped else _if_clamped(link, kept[i])
        if share is not None:
            kept[link.parent] = kept[link.parent] + _share_in_parent(link, share)
    for i, link in enumerate(kinematics.links):
        kept[i].mp_LLcm.named(f"mp_LLcm[{link.name}]")
        kept[i].I_LLo_L.named(f"I_LLo_L[{link.name}]")
    base = kept.pop(BASE)
    return list(kept.values()), base


def inertia_inputs(kinematics: TreeKinematics) -> list[LinkInertia]:
    """Each link's inertia as ten inputs "pi": m, m c (3), then xx, xy, yy, xz, yz, zz about Bo, in the body frame B."""
    g, inertias = kinematics.g, []
    for i, link in enumerate(kinematics.links):
        m, sx, sy, sz, xx, xy, yy, xz, yz, zz = (g.input("pi", 10 * i + k) for k in range(10))
        S, J = Vec3(g, sx, sy, sz), Sym3(g, xx, yy, zz, xy, xz, yz)
        inertias.append(LinkInertia(m, link.R_LB.times(S), rotated(link.R_LB, J)))
    return inertias


def stated_inertias(kinematics: TreeKinematics) -> list[LinkInertia]:
    """Inertia of each link by itself, where the description puts it: what joints really carry."""
    return [_stated(kinematics, i) for i in range(len(kinematics.links))]


def _stated(kinematics: TreeKinematics, index: int) -> LinkInertia:
    """The sum of the inertias stated for a link's bodies."""
    total = no_inertia(kinematics.g)
    for beam in kinematics.beams:
        if beam.root == index:
            total = total + beam.equations.undeformed()
    for placement, inertia in kinematics.tree.links[index].inertias:
        R_LB, p_LB = kinematics.lowering.placement(placement, kinematics.links[index].R_LB)
        total = total + _one_body(kinematics, inertia, R_LB, p_LB)
    return total


def _one_body(kinematics: TreeKinematics, inertia: Inertia, R_LB: Mat3, p_LB: Vec3) -> LinkInertia:
    """One body's inertia about Lo, from its form in the description."""
    g, lowering = kinematics.g, kinematics.lowering
    m = lowering.value(inertia.mass)
    p_BC = R_LB.times(lowering.vector(inertia.center_of_mass))  # In L.
    J = Sym3(g, *map(lowering.value, inertia.moments))
    p_LC = p_LB + p_BC
    if inertia.about == "body":
        J = rotated(R_LB, J)
        if not p_LB.is_zero:
            # From Bo to Lo: remove the mass centre's part about Bo, add it about Lo.
            J = J + -point_inertia(m, p_BC) + point_inertia(m, p_LC)
    else:
        J = rotated(R_LB @ lowering.rotation(inertia.rotation), J) + point_inertia(m, p_LC)
    return LinkInertia(m, p_LC.scaled(m), J)


def _if_clamped(link: MovingLink, inertia: LinkInertia) -> tuple[LinkInertia, LinkInertia | None]:
    """A clamped link keeps nothing, any other all."""
    is_clamped = not link.partial_velocities and link.rates is None
    return (no_inertia(inertia.mp_LLcm.g), inertia) if is_clamped else (inertia, None)


def _split(link: MovingLink, inertia: LinkInertia) -> tuple[LinkInertia, LinkInertia | None]:
    """The inertia that a link keeps, and the share that its parent may carry instead (eqs. 16-18)."""
    g, S, J = inertia.mp_LLcm.g, inertia.mp_LLcm, inertia.I_LLo_L
    if not link.partial_velocities and link.rates is None:
        return _if_clamped(link, inertia)
    if link.axis is not None:
        # A rod along the axis: one transverse moment and, if it can't slide, the mass and the moment along it.
        k, i = link.axis, (link.axis + 1) % 3
        full = J.matrix()
        b = full.at((i + 1) % 3, (i + 1) % 3)
        share_J = [ZERO if axis == k else b for axis in range(3)]
        share = replace(no_inertia(g), I_LLo_L=Sym3(g, *share_J))
        if link.fixed_origin:
            along = [edge if axis == k else ZERO for axis, edge in enumerate(S)]
            share = replace(share, m=inertia.m, mp_LLcm=Vec3(g, *along))
        return LinkInertia(g.sub(inertia.m, share.m), S - share.mp_LLcm, J + -share.I_LLo_L), share
    if link.fixed_origin:
        return replace(inertia, m=ZERO), replace(no_inertia(g), m=inertia.m)
    if not any(not partial.w.is_zero for partial in link.partial_velocities):
        # A joint that does not turn: the inertia tensor turns with the parent.
        return replace(inertia, I_LLo_L=Sym3(g)), replace(no_inertia(g), I_LLo_L=J)
    return inertia, None


def _share_in_parent(link: MovingLink, share: LinkInertia) -> LinkInertia:
    """The parent's share of a link's inertia in the parent's frame.

    The joint's own rotation leaves it unchanged, so only constants act.
    """
    g = share.mp_LLcm.g
    factors = link.R_AL.factors
    constant = type(link.R_AL)(g, factors[:-1], link.R_AL.tensor_factors[:-1]) if link.axis is not None else link.R_AL
    p = link.p_AL if link.fixed_origin else Vec3(g)
    R = constant.matrix()
    S = R.times(share.mp_LLcm)
    J = shifted(S, rotated(R, share.I_LLo_L), p)
    return LinkInertia(share.m, S + p.scaled(share.m), J + point_inertia(share.m, p))
