"""Sets of features that cover each pair of them: what is wrong of two features together shows in some set.

A set has options for all of it, and features for each of some chains. Greedily, each further set has as many pairs as
it can that no set before it has: pairs of options, of an option and a feature of a chain, and of two features of one
chain. The first sets thus have most of them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import combinations
from math import inf
from typing import Any, TypeVar

T = TypeVar("T")
Pair = frozenset[str]
# Factor -> feature -> what it means; the first is that of sets that state none, but for factors of joints.
Table = Mapping[str, Mapping[str, T]]


def levels(table: Table[Any], features: Sequence[str]) -> dict[str, str]:
    """The feature of each factor: the first, where none is stated."""
    return {
        factor: next((one for one in named if one in features), next(iter(named))) for factor, named in table.items()
    }


def covering(
    options: Table[Any],
    chain: Table[Any],
    chains: int,
    rare: Sequence[Collection[str]] = ((),),
    never: Collection[Pair] = (),
) -> Iterator[tuple[str, ...]]:
    """Features of one set after the other; those of a chain begin with its number.

    Args:
        options: Features of the whole.
        chain: Features of a chain.
        chains: Number of chains.
        rare: What the first sets, those after them and so on are without.
        never: Pairs that no set has.
    """
    there: set[Pair] = set()
    for absent in rare:
        whole, own = (
            {factor: [one for one in named if one not in absent] for factor, named in table.items()}
            for table in (options, chain)
        )
        yield from _round(whole, own, chains, never, there)


def _round(
    options: Mapping[str, list[str]],
    chain: Mapping[str, list[str]],
    chains: int,
    never: Collection[Pair],
    there: set[Pair],
) -> Iterator[tuple[str, ...]]:
    """Sets until there is each pair of features of two tables, of which some are there already."""
    pairs = combinations((*options.values(), *chain.values()), 2)
    missing = {frozenset((one, other)) for a, b in pairs for one in a for other in b} - there - set(never)
    plain = {named[0] for name, named in (*options.items(), *chain.items()) if not name.endswith("joint")}
    while missing:
        weight = Counter(one for pair in missing for one in pair)
        seed = max(missing, key=lambda pair: (sum(weight[one] for one in pair), sorted(pair)))
        shared = _filled(options, (), missing, weight, seed, never)
        features, pairs_here = [one for one in shared if one not in plain], set(map(frozenset, combinations(shared, 2)))
        for k in range(chains):
            own = _filled(chain, shared, missing - pairs_here, weight, seed if not k else frozenset(), never)
            pairs_here |= set(map(frozenset, combinations((*shared, *own), 2)))
            features += [f"{k}: {one}" for one in own if one not in plain]
        missing -= pairs_here
        there |= pairs_here
        yield tuple(features)


def _filled(
    table: Mapping[str, list[str]],
    known: Sequence[str],
    missing: set[Pair],
    weight: Counter[str],
    seed: Pair,
    never: Collection[Pair],
) -> list[str]:
    """One feature of each factor, each so that it has most of the missing pairs with those that are known already."""
    chosen: list[str] = []

    def worth(one: str) -> float:
        if any(frozenset((one, other)) in never for other in (*known, *chosen, *seed)):
            return -inf
        pairs = sum(frozenset((one, other)) in missing for other in (*known, *chosen))
        return inf if one in seed else pairs + weight[one] / 1000.0

    # What is missing most goes first.
    for named in sorted(table.values(), key=lambda named: -max(inf if one in seed else weight[one] for one in named)):
        chosen.append(max(named, key=worth))
    return chosen
