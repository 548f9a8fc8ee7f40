"""The beams of a tree as numbers, at given parameters: what judges their bending (docs/theory/beams.md, section 6)."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, lru_cache, partial

import numpy as np

from symofros.description.beams.beam import Beam
from symofros.description.values import Value
from symofros.expr.edges import Edge
from symofros.expr.expression import evaluate
from symofros.expr.graph import Graph
from symofros.mechanics.beams.deformation import deformation_of
from symofros.mechanics.beams.elastic import beam_forms
from symofros.mechanics.beams.integrals import at_middle
from symofros.mechanics.beams.rod_plane import rod_of
from symofros.mechanics.beams.rod_shape import IntegrationError
from symofros.mechanics.beams.strains import strains_of
from symofros.mechanics.topology.tree import SpanningTree
from symofros.runtime.beams import ElasticBeam, ElasticRod
from symofros.runtime.calls.kernel import Array

# Sets of parameters whose beams are kept, with their stiffness.
_KEPT = 8
# Intervals between the stations at which a rod's turn is judged.
_INTERVALS = 16


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
    if beam.theory == "strain":
        return _rod(beam, q, v, values)
    shape = deformation_of(beam)
    xi, angles = (np.array(numbers) for numbers in shape.station_angles)
    length = evaluate(beam.length, values)

    return ElasticBeam(
        name=beam.name,
        length=length,
        q=q,
        v=v,
        counts=shape.counts,
        xi=xi,
        angles=angles,
        displacements=np.array(shape.lengths, dtype=bool),
        elastic_stiffness=cache(partial(_stiffness, beam, values)),
        EI_z=evaluate(at_middle(beam.EI_z, beam), values),
        EI_y=evaluate(at_middle(beam.EI_y, beam), values),
    )


def _rod(beam: Beam, q: int, v: int, values: dict[str, float]) -> ElasticRod:
    strains = strains_of(beam)
    xi = [k / _INTERVALS for k in range(_INTERVALS + 1)]
    return ElasticRod(
        name=beam.name,
        length=evaluate(beam.length, values),
        q=q,
        v=v,
        counts=(beam.bend_y, beam.bend_z, beam.modes - beam.bend_y - beam.bend_z),  # Stretch and shear turn nothing.
        xi=np.array(xi),
        angles=ElasticRod.REDUCED * np.array(strains.turns(xi)),
        displacements=np.zeros(beam.modes, dtype=bool),
        elastic_stiffness=cache(partial(_stiffness, beam, values)),
        EI_z=0.0,
        EI_y=0.0,
        sections=len(strains.sections.stations) - 1,  # Beside the root.
        integration_error=_integration_error(beam, values),
    )


def _integration_error(beam: Beam, values: dict[str, float]) -> Callable[[Array], float]:
    """What gives the error of a rod's shape; formed when it is first asked for."""
    shapes = cache(partial(IntegrationError, beam, values))
    return lambda elastic: shapes()(elastic)


def _stiffness(beam: Beam, values: dict[str, float]) -> Array:
    """Elastic stiffness (n, n)."""
    g = Graph()

    def lower(value: Value) -> Edge:
        return g.constant(evaluate(value, values))

    make = rod_of if beam.theory == "strain" else beam_forms
    energy = make(g, lower, beam, tuple(g.input("q", i) for i in range(beam.modes))).strain_energy
    return np.array([[g.number(edge) for edge in row] for row in energy.second_derivatives()], dtype=np.float64)
