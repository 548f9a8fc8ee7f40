"""Equal limbs of a tree: subtrees on one link whose joints are of the same kinds in the same order.

Legs, arms, fingers: what generated code computes for one of them it computes for the others, with other numbers
(docs/theory/code.md, section 10).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from symofros.expr.graph import Slot
from symofros.expr.program import Limb
from symofros.mechanics.topology.tree import BASE, Link, SpanningTree


def equal_limbs(tree: SpanningTree) -> tuple[tuple[Limb, ...], ...]:
    """Groups of equal limbs: of each limb the entries of q, v and a, in an order that they share.

    Limbs that differ in numbers alone, with zeros in the same places, are grouped before those that differ in more.
    What is within a limb of a group is not grouped again.
    """
    children: dict[int, list[int]] = defaultdict(list)
    for index, link in enumerate(tree.links):
        children[link.parent].append(index)
    signatures = [_signatures(tree, children, of_link) for of_link in (_pattern, _kinds)]
    groups: list[tuple[Limb, ...]] = []
    waiting = [BASE]
    while waiting:
        remaining = children[waiting.pop()]
        for signature in signatures:
            by_signature: dict[int, list[int]] = defaultdict(list)
            for root in remaining:
                by_signature[signature[root]].append(root)
            groups += [
                tuple(_entries(tree.links[member] for member in _members(root, children)) for root in roots)
                for roots in by_signature.values()
                if len(roots) > 1
            ]
            remaining = [roots[0] for roots in by_signature.values() if len(roots) == 1]
        waiting += remaining
    return tuple(group for group in groups if group[0])


def _signatures(
    tree: SpanningTree, children: Mapping[int, Sequence[int]], of_link: Callable[[Link], object]
) -> list[int]:
    """A number for each link, the same for those that carry equal limbs, themselves among them."""
    known: dict[object, int] = {}
    numbers = [0] * len(tree.links)
    for index in reversed(range(len(tree.links))):
        limb = of_link(tree.links[index]), tuple(numbers[child] for child in children.get(index, ()))
        numbers[index] = known.setdefault(limb, len(known))
    return numbers


def _members(root: int, children: Mapping[int, Sequence[int]]) -> Iterator[int]:
    """A link and all that it carries, depth first."""
    waiting = [root]
    while waiting:
        index = waiting.pop()
        yield index
        waiting += reversed(children.get(index, ()))


def _entries(links: Iterable[Link]) -> Limb:
    return tuple(
        Slot(group, start + i)
        for link in links
        for group, (start, size) in (("q", link.q), ("v", link.v), ("a", link.v))
        for i in range(size)
    )


def _kinds(link: Link) -> object:
    """Properties of a link that decide which operations it needs at all."""
    return link.joint.kind, link.q[1], link.v[1], len(link.inertias), link.beam is None, link.is_section


def _pattern(link: Link) -> object:
    """Properties of a link that decide which operations remain after zeros are folded."""
    steps = [*link.placement, *(step for placement, _ in link.inertias for step in placement)]
    return (
        _kinds(link),
        _zeros(link.joint.axis),
        tuple((_zeros(step.position), step.rotation.kind, _sizes(step.rotation.values)) for step in steps),
        tuple(
            (_zeros((i.mass, *i.center_of_mass)), _zeros(i.moments), _sizes(i.rotation.values))
            for _, i in link.inertias
        ),
    )


def _zeros(values: Sequence[object]) -> tuple[bool, ...]:
    return tuple(value == 0 for value in values)


def _sizes(values: Sequence[object]) -> tuple[object, ...]:
    """Angles and entries of rotations without their signs: opposite quarter turns leave the same zeros."""
    return tuple(abs(value) if isinstance(value, float | int) else value for value in values)
