"""Beams of a tree as numbers, which judge their bending; beams without stretch that a loop holds (beams.md, 6)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from fractions import Fraction
from functools import cache, lru_cache, partial
from typing import Any

import numpy as np

from symofros.description.beams.beam import Beam
from symofros.description.constraints import Closure
from symofros.description.values import Value
from symofros.expr.edges import Edge
from symofros.expr.expression import Expression, evaluate
from symofros.expr.graph import Graph
from symofros.mechanics.beams.fields import Form
from symofros.mechanics.beams.integrals import at_station
from symofros.mechanics.beams.strain.section_law import section_law
from symofros.mechanics.beams.theories import theory_of
from symofros.mechanics.topology.tree import SpanningTree
from symofros.runtime.beam_orders import OmittedStiffness
from symofros.runtime.beams import ElasticBeam, ExactElasticBeam, StationLaw
from symofros.runtime.calls.kernel import Array
from symofros.runtime.model import Model

# Coefficients of G below the first are rounding; beams are bent by elastic coordinates of the second, and what phi
# changes by then, of the second order, is above the third.
_VOID, _BENT, _CHANGED = 1e-9, 1e-3, 1e-12


def may_be_held(tree: SpanningTree) -> bool:
    """Whether there are closures, and elastic beams that do not stretch."""
    has_loops = any(isinstance(item, Closure) and item.translations for item in tree.system.constraints)
    return has_loops and any(True for _ in _unstretched(tree))


def held_beams(tree: SpanningTree, model: Model) -> Iterator[str]:
    """In words, each condition that holds a beam along an axis that it can't shorten but by bending.

    Such a condition has no coefficient in the straight posture, where nothing that moves reaches it to the first order,
    and it changes with the square of what beams bend by. That its loop has no joint that gives way is the rank of the
    joints' columns at drawn positions.

    Args:
        tree: Tree.
        model: Its constraint and constraint_jacobian; driven inputs are at their defaults.
    """
    names, rng = model.names.constraints, np.random.default_rng(0)
    beams = dict(_unstretched(tree))
    elastic = np.zeros(model.nv, dtype=bool)
    for link in tree.links:
        if link.tip_of is not None:
            elastic[link.v[0] : link.v[0] + link.v[1]] = True
    q = model.neutral()
    G, phi = model.constraint_jacobian(q), model.constraint(q)
    drawn = model.constraint_jacobian(model.integrate(q, np.where(elastic, 0.0, rng.uniform(-1.0, 1.0, model.nv))))
    for closure in (item for item in tree.system.constraints if isinstance(item, Closure)):
        rows = [names.index(name) for name in closure.conditions]
        joints = drawn[rows][:, ~elastic]
        moving = joints[:, np.abs(joints).max(axis=0, initial=0.0) > _VOID] if joints.size else joints
        if moving.shape[1] > np.linalg.matrix_rank(moving):
            continue  # A joint of the loop gives way.
        for row in rows[: len(closure.translations)]:
            if np.abs(G[row]).max(initial=0.0) > _VOID or abs(phi[row]) > _CHANGED:
                continue
            for name, (first, count) in beams.items():
                bent = np.zeros(model.nv)
                bent[first : first + count] = _BENT * rng.uniform(0.5, 1.0, count)
                if abs(model.constraint(model.integrate(q, bent))[row] - phi[row]) > _CHANGED:
                    yield (
                        f"closure '{closure.name}': '{names[row]}' holds both ends of beam '{name}' along its axis, "
                        "and the beam does not stretch: it can't bend without giving way there, linear results (modes, "
                        "equilibria near the straight posture) take the axis as free, and runs need steps beyond reason"
                        f". Give '{name}' functions of stretch (theory: strain, stretch: 1 or more, EA), or leave "
                        "the axis free."
                    )
                    break


def _unstretched(tree: SpanningTree) -> Iterator[tuple[str, tuple[int, int]]]:
    """Elastic beams without functions of stretch: name, first speed and number of elastic coordinates."""
    for link in tree.links:
        if link.tip_of is not None and link.tip_of.modes and not link.tip_of.stretch:
            yield link.tip_of.name, link.v


# Sets of parameters whose beams are kept, with their stiffness.
_KEPT = 8


def beams_at(tree: SpanningTree) -> Callable[[Array], tuple[ElasticBeam, ...]]:
    """A function that gives a tree's elastic beams from its run-time parameters (npar)."""
    names, constants = tree.coordinates.par, tree.coordinates.constants
    tips = [(link.tip_of, link.q[0], link.v[0]) for link in tree.links if link.tip_of is not None and link.tip_of.modes]
    clamped = _beams_in_series(beam for beam, _, _ in tips)

    @lru_cache(maxsize=_KEPT)
    def numbers_at(par: tuple[float, ...]) -> tuple[ElasticBeam, ...]:
        values = constants | dict(zip(names, par, strict=True))
        return tuple(_numbers(beam, q, v, values, clamped[beam.name]) for beam, q, v in tips)

    return lambda par: numbers_at(tuple(par.tolist()))


def _beams_in_series(beams: Iterable[Beam]) -> dict[str, int]:
    """How many beams are clamped to one another, by the name of each."""
    roots: dict[str, str] = {}
    for beam in beams:  # Parents first.
        clamped = beam.joint.kind == "fixed" and beam.joint.parent in roots
        roots[beam.name] = roots[beam.joint.parent] if clamped else beam.name
    counts = Counter(roots.values())
    return {name: counts[root] for name, root in roots.items()}


def _numbers(beam: Beam, q: int, v: int, values: dict[str, float], in_series: int) -> ElasticBeam:
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
        "omitted": _omitted(beam, values, in_series),
        "station_law": cache(partial(_station_law, beam, values)),
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


def _omitted(beam: Beam, values: dict[str, float], in_series: int) -> OmittedStiffness | None:
    """What the order of a beam's equations leaves out of its stiffness under loads (beams.md, 6)."""
    axial = not beam.foreshortening or beam.retain == "zeroth_order"
    lacking = [axis for axis, n in (("y", beam.bend_y), ("z", beam.bend_z), ("x", beam.twist)) if not n]
    rigid = lacking[0] if len(lacking) == 1 else ""
    couples = not lacking and beam.retain != "all"
    if beam.elastic.is_exact or not (axial or couples or rigid):
        return None
    # What the tip carries turns with it but in the lowest order, where beams in series lack this together.
    count = in_series if beam.retain == "zeroth_order" else 1
    order = (
        f"retain: {beam.retain}" if beam.foreshortening or beam.retain == "zeroth_order" else "foreshortening: false"
    )
    coupling = cache(partial(_coupling, replace(beam, retain="all"), values)) if couples else None
    return OmittedStiffness(order, axial, rigid, coupling, count, turning=beam.retain == "zeroth_order")


def _strain_energy(beam: Beam, values: dict[str, float]) -> tuple[Graph, Form]:
    g = Graph()

    def lower(value: Value) -> Edge:
        return g.constant(evaluate(value, values))

    coordinates = tuple(g.input("q", i) for i in range(beam.modes))
    return g, theory_of(beam).equations(g, lower, coordinates).strain_energy


def _stiffness(beam: Beam, values: dict[str, float]) -> Array:
    """Elastic stiffness (n, n)."""
    g, energy = _strain_energy(beam, values)
    return np.array([[g.number(edge) for edge in row] for row in energy.second_derivatives()], dtype=np.float64)


def _station_law(beam: Beam, values: dict[str, float]) -> StationLaw:
    """The elastic law of the strains with functions (33), in axes of the section that it does not couple."""
    length, xi, fields = evaluate(beam.length, values), np.array(beam.stations), theory_of(beam).strains
    order = {axis: k for k, axis in enumerate(fields)}

    def at(value: Value, x: float) -> float:
        return evaluate(at_station(value, beam.length, x) if isinstance(value, Expression) else value, values)

    strains = np.zeros((len(xi), len(fields), beam.modes))
    stiffness, forces = np.zeros((len(xi), len(fields), len(fields))), np.zeros((len(xi), len(fields), _FORCES))
    law = section_law(beam, fields)
    for axis, k in order.items():
        for mono, function in fields[axis].terms.items():
            if len(mono) == 1:
                shape = np.array([float(function(Fraction(x))) for x in beam.stations])
                strains[:, k, mono[0]] = length ** fields[axis].exponent(mono) * shape
        forces[:, k, _force_of(axis)] = 1.0
    for (a, b), value in law.stiffness.items():  # Of two strains once for both orders.
        shared = np.array([at(value, x) for x in beam.stations]) * (1.0 if a == b else 0.5)
        stiffness[:, order[a], order[b]] = stiffness[:, order[b], order[a]] = shared
    for (follower, axis), value in law.following.items():
        forces[:, order[axis], _force_of(follower)] = [at(value, x) for x in beam.stations]
    parts = length * np.diff([0.0, *(0.5 * (xi[1:] + xi[:-1])), 1.0])
    sizes, axes = np.linalg.eigh(stiffness)
    roots, shares = np.sqrt(np.maximum(sizes, 0.0))[..., np.newaxis], np.sqrt(parts)[:, np.newaxis, np.newaxis]
    across = shares * axes.swapaxes(1, 2)
    # A strain times the length of its part, by what is weighed: half of its own part is before a station.
    turns = np.divide(shares * axes, roots.swapaxes(1, 2), out=np.zeros_like(axes), where=roots.swapaxes(1, 2) > 0.0)
    before = np.tril(np.ones((len(xi), len(xi)))) - 0.5 * np.eye(len(xi))
    bends = [k for axis, k in order.items() if axis in _BENDS]
    slopes = np.einsum("s,sr,rbk->sbrk", np.sqrt(parts), before, turns[:, bends])
    return StationLaw(
        np.divide(across @ forces, roots, out=np.zeros_like(forces), where=roots > 0.0),
        roots * (across @ strains),
        slopes,
        evaluate(beam.damping, values),
    )


# Places of the strains that turn the axis, about y and z, among all.
_BENDS = (1, 2)
# Number of section forces: N, Vy, Vz, T, My, Mz.
_FORCES = 6


def _force_of(axis: int) -> int:
    """Place of the section force that works on a strain."""
    return (axis + _FORCES // 2) % _FORCES


def _coupling(beam: Beam, values: dict[str, float]) -> Array:
    """Third derivatives of the strain energy (n, n, n)."""
    g, energy = _strain_energy(beam, values)
    rows = [[[g.number(edge) for edge in row] for row in part.second_derivatives()] for part in energy.gradient]
    return np.array(rows, dtype=np.float64)
