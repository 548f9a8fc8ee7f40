"""The beams of a tree as numbers, at given parameters: what judges their bending (docs/theory/beams.md, section 6)."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, lru_cache, partial
from typing import Any

import numpy as np

from symofros.description.beams.beam import Beam
from symofros.description.values import Value
from symofros.expr.edges import Edge
from symofros.expr.expression import evaluate
from symofros.expr.graph import Graph
from symofros.mechanics.beams.theories import theory_of
from symofros.mechanics.topology.tree import SpanningTree
from symofros.runtime.beams import ElasticBeam, ExactElasticBeam
from symofros.runtime.calls.kernel import Array

# Sets of parameters whose beams are kept, with their stiffness.
_KEPT = 8


def beams_at(tree: SpanningTree) -> Callable[[Array], tuple[ElasticBeam, ...]]:
    """A function that gives a tree's elastic beams from its run-time parameters (npar)."""
    names, constants = tree.coordinates.par, tree.coordinates.constants
    tips = [(link.tip_of, link.q[0], link.v[0]) for link in tree.links if link.tip_of is not None and link.tip_of.modes]

    @lru_cache(maxsize=_KEPT)
    def numbers_at(par: tuple[float, ...]) -> tuple[ElasticBeam, ...]:
        values = constants | dict(zip(names, par, strict=True))
        return tuple(_numbers(beam, q, v, values) for beam, q, v in tips)

    return lambda par: numbers_at(tuple(par.tolist()))


def _numbers(beam: Beam, q: int, v: int, values: dict[str, float]) -> ElasticBeam:
    judged = theory_of(beam).judged
    known: dict[str, Any] = {
        "name": beam.name,
        "length": evaluate(beam.length, values),
        "q": q,
        "v": v,
        "counts": judged.counts,
        "xi": np.array(judged.xi),
        "displacements": np.array(judged.displacements, dtype=bool),
        "elastic_stiffness": cache(partial(_stiffness, beam, values)),
        "EI_z": evaluate(judged.EI_z, values),
        "EI_y": evaluate(judged.EI_y, values),
    }
    angles = np.array(judged.angles)
    if judged.integration_error is None:
        return ElasticBeam(**known, angles=angles)
    shapes = cache(partial(judged.integration_error, values))  # Formed when an error is first asked for.
    return ExactElasticBeam(
        **known,
        angles=ExactElasticBeam.REDUCED * angles,
        sections=judged.sections,
        integration_error=lambda elastic: shapes()(elastic),
    )


def _stiffness(beam: Beam, values: dict[str, float]) -> Array:
    """Elastic stiffness (n, n)."""
    g = Graph()

    def lower(value: Value) -> Edge:
        return g.constant(evaluate(value, values))

    coordinates = tuple(g.input("q", i) for i in range(beam.modes))
    energy = theory_of(beam).equations(g, lower, coordinates).strain_energy
    return np.array([[g.number(edge) for edge in row] for row in energy.second_derivatives()], dtype=np.float64)
