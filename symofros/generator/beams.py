"""The beams of a tree as numbers, at given parameters: what judges their bending (docs/theory/beams.md, section 6)."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, lru_cache, partial

import numpy as np

from symofros.description.beam import STATION, Beam
from symofros.description.values import Value, symbols
from symofros.expr.edges import Edge
from symofros.expr.expression import Expression, evaluate
from symofros.expr.graph import Graph
from symofros.mechanics.beams.deformation import deformation_of
from symofros.mechanics.beams.elastic import beam_forms
from symofros.mechanics.beams.integrals import at_station
from symofros.mechanics.topology.tree import SpanningTree
from symofros.runtime.beams import ElasticBeam
from symofros.runtime.calls.kernel import Array

# Sets of parameters whose beams are kept, with their stiffness.
_KEPT = 8


def beams_at(tree: SpanningTree) -> Callable[[Array], tuple[ElasticBeam, ...]]:
    """What gives a tree's elastic beams from its run-time parameters (npar)."""
    names, constants = tree.coordinates.par, tree.coordinates.constants
    tips = [(link.tip_of, link.q[0], link.v[0]) for link in tree.links if link.tip_of is not None and link.tip_of.modes]

    @lru_cache(maxsize=_KEPT)
    def numbers_at(par: tuple[float, ...]) -> tuple[ElasticBeam, ...]:
        values = constants | dict(zip(names, par, strict=True))
        return tuple(_numbers(beam, q, v, values) for beam, q, v in tips)

    return lambda par: numbers_at(tuple(par.tolist()))


def _numbers(beam: Beam, q: int, v: int, values: dict[str, float]) -> ElasticBeam:
    shape = deformation_of(beam)
    xi, angles = (np.array(numbers) for numbers in shape.station_angles)
    length = evaluate(beam.length, values)

    def at_middle(stiffness: Value) -> float:
        if STATION in symbols(stiffness):
            assert isinstance(stiffness, Expression)
            stiffness = at_station(stiffness, beam.length, 0.5)
        return evaluate(stiffness, values)

    return ElasticBeam(
        name=beam.name,
        length=length,
        q=q,
        v=v,
        counts=shape.counts,
        xi=xi,
        angles=angles,
        scale=np.array([1.0 / length if displacement else 1.0 for displacement in shape.lengths]),
        elastic_stiffness=cache(partial(_stiffness, beam, values)),
        EI_z=at_middle(beam.EI_z),
        EI_y=at_middle(beam.EI_y),
    )


def _stiffness(beam: Beam, values: dict[str, float]) -> Array:
    """Elastic stiffness (n, n): second derivatives of the quadratic strain energy (7)."""
    g = Graph()

    def lower(value: Value) -> Edge:
        return g.constant(evaluate(value, values))

    energy = beam_forms(g, lower, beam, tuple(g.input("q", i) for i in range(beam.modes))).strain_energy
    stiffness = np.zeros((beam.modes, beam.modes))
    for monomial, coefficient in energy.terms.items():
        if len(monomial) == 2:
            i, j = monomial
            number = g.number(coefficient)
            assert number is not None, "a graph of constants folds"
            stiffness[i, j] += number
            stiffness[j, i] += number
    return stiffness
