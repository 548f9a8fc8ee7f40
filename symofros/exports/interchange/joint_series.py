"""Bodies that only carry, gathered on the next one: MuJoCo wants mass of whatever moves, and takes joints in series."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from symofros.base.arrays import Array
from symofros.base.rotations import matrix_product
from symofros.exports.interchange.rigid import RigidLink

# Axes of the joints of one body, which MuJoCo takes no more of.
_MAX_AXES = 6


@dataclass(frozen=True)
class JointPlace:
    """A joint of a body, as it stands in the body's frame.

    Attributes:
        link: The link that the joint carries by itself.
        position: Position of that link's frame in the body's frame while all joints are at zero (3) [m].
        rotation: R (3, 3).
    """

    link: RigidLink
    position: Array
    rotation: Array


@dataclass(frozen=True)
class GatheredBody:
    """A link with the joints of the bodies before it that only carry.

    Attributes:
        link: The link; its parent and place are those of the first of these bodies.
        carriers: Their joints, from the base on.
    """

    link: RigidLink
    carriers: tuple[JointPlace, ...] = ()


def gathered(links: Sequence[RigidLink], kept: Collection[str]) -> list[GatheredBody]:
    """Links without those that only carry one other link by joints of single axes.

    With T_A, T_L the places of A in its parent and of L in A, J_A and J_L the motions of their joints in own frames,
    L stands at T_A J_A T_L J_L = (T_A T_L) (T_L^-1 J_A T_L) J_L: the joint of A keeps its motion, seen from L at zero.

    Args:
        links: Links, parents first.
        kept: Names of bodies that something is attached to.
    """
    children = Counter(link.parent for link in links)
    following = {link.parent: link for link in links}
    waiting: dict[str, GatheredBody] = {}
    bodies = []
    for link in links:
        body = GatheredBody(link)
        before = waiting.get(link.parent or "")
        if before is not None:
            body = _carried_on(before, link)
        only_carries = link.mass == 0.0 and not link.inertia.any() and link.name not in kept and link.axes
        if only_carries and children[link.name] == 1 and _can_take(following[link.name], body):
            waiting[link.name] = body
        else:
            bodies.append(body)
    return bodies


def _is_single(link: RigidLink) -> bool:
    """Whether a link is fixed, or moves by turns and slides."""
    return bool(link.axes) or (link.joint is not None and link.joint.traits.mjcf is None)


def _can_take(link: RigidLink, before: GatheredBody) -> bool:
    """Whether a link can have the joints of a body before it, too."""
    axes = sum(len(place.link.axes) for place in before.carriers) + len(before.link.axes) + len(link.axes)
    return _is_single(link) and axes <= _MAX_AXES


def _carried_on(before: GatheredBody, link: RigidLink) -> GatheredBody:
    """A link whose parent is a carrier."""
    back = link.rotation.T
    carrier = JointPlace(before.link, -matrix_product(back, link.position), back)
    earlier = [
        JointPlace(
            place.link,
            matrix_product(back, place.position - link.position),
            matrix_product(back, place.rotation),
        )
        for place in before.carriers
    ]
    position = before.link.position + matrix_product(before.link.rotation, link.position)
    rotation = matrix_product(before.link.rotation, link.rotation)
    placed = replace(link, parent=before.link.parent, position=position, rotation=rotation)
    return GatheredBody(placed, (*earlier, carrier))
