"""The spanning tree of random mechanisms: order of links, index map, what is merged; properties that always hold."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import symofros as sf
from reference_models.rigid.random_tree import MORE_KINDS, random_tree
from symofros.mechanics.topology.tree import BASE, SpanningTree, build_tree

SEEDS = range(12)


def tree_of(seed: int) -> SpanningTree:
    return build_tree(random_tree(seed, n=15, kinds=(*MORE_KINDS, "fixed")))


@pytest.mark.parametrize("seed", SEEDS)
def test_parents_come_before_their_children(seed: int) -> None:
    assert all(link.parent < i for i, link in enumerate(tree_of(seed).links))


@pytest.mark.parametrize("seed", SEEDS)
def test_whatever_a_link_carries_follows_it_without_a_gap(seed: int) -> None:
    tree = tree_of(seed)
    for i in range(len(tree.links)):
        carried = [j for j in range(len(tree.links)) if i in tree.ancestors(j)]
        assert carried == list(range(i, i + len(carried)))


@pytest.mark.parametrize("seed", SEEDS)
def test_ancestors_lead_from_parent_to_parent_to_the_base(seed: int) -> None:
    tree = tree_of(seed)
    for i in range(len(tree.links)):
        path = tree.ancestors(i)
        assert path[0] == i and tree.links[path[-1]].parent == BASE
        assert all(tree.links[outer].parent == inner for outer, inner in pairwise(path))


@pytest.mark.parametrize("seed", SEEDS)
def test_coordinates_and_speeds_are_numbered_link_by_link_without_gaps(seed: int) -> None:
    tree = tree_of(seed)
    for slices, names in (
        ([link.q for link in tree.links], tree.coordinates.q),
        ([link.v for link in tree.links], tree.coordinates.v),
    ):
        starts = [start for start, _ in slices]
        assert starts == [sum(size for _, size in slices[:i]) for i in range(len(slices))]
        assert sum(size for _, size in slices) == len(names) == len(set(names))


@pytest.mark.parametrize("seed", SEEDS)
def test_the_index_map_finds_each_name_where_it_is_numbered(seed: int) -> None:
    names = tree_of(seed).coordinates
    assert [names.symbols[name].index for name in names.q] == list(range(len(names.q)))
    assert all(names.symbols[name].group == "q" for name in names.q)
    slots = Counter((slot.group, slot.index) for slot in names.symbols.values())
    assert max(slots.values()) == 1
    assert {index for group, index in slots if group == "v"} == set(range(len(names.v)))


@pytest.mark.parametrize("seed", SEEDS)
def test_every_body_that_moves_has_its_inertia_on_one_link(seed: int) -> None:
    system = random_tree(seed, n=15, kinds=(*MORE_KINDS, "fixed"))
    tree = build_tree(system)
    moving = [body for body in system.bodies if tree.frame(body.name).link != BASE]
    carried = Counter(id(inertia) for link in tree.links for _, inertia in link.inertias)
    assert carried == Counter(id(body.inertia) for body in moving)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_fixed_body_is_part_of_the_link_that_carries_it(seed: int) -> None:
    system = random_tree(seed, n=15, kinds=(*MORE_KINDS, "fixed"))
    tree = build_tree(system)
    links = {link.name for link in tree.links}
    for body in system.bodies:
        if body.joint is not None:
            assert (body.name in links) == (body.joint.kind != "fixed")
            if body.joint.kind == "fixed":
                assert tree.frame(body.name).link == tree.frame(body.joint.parent).link


@pytest.mark.parametrize("seed", SEEDS)
def test_the_order_of_description_changes_the_numbering_and_not_the_tree(seed: int) -> None:
    system = random_tree(seed, n=15, kinds=(*MORE_KINDS, "fixed"))
    order = np.random.default_rng(seed).permutation(len(system.bodies))
    shuffled = replace(system, bodies=tuple(system.bodies[i] for i in order))

    def parents(stated: sf.System) -> dict[str, str]:
        tree = build_tree(stated)
        return {link.name: "" if link.parent == BASE else tree.links[link.parent].name for link in tree.links}

    assert parents(shuffled) == parents(system)
    before, after = build_tree(system).coordinates, build_tree(shuffled).coordinates
    assert sorted(before.q) == sorted(after.q) and sorted(before.v) == sorted(after.v)


@pytest.mark.parametrize("seed", SEEDS)
def test_frames_have_public_names_of_their_own(seed: int) -> None:
    tree = tree_of(seed)
    names = [frame.name for frame in tree.frames]
    assert len(names) == len(set(names))
    assert all(tree.frame(frame.name) is frame and tree.frame(frame.qualified) is frame for frame in tree.frames)
