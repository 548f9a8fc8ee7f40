"""Beams without stretch whose loop holds both of their ends along the axis (docs/theory/beams.md, section 6)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from symofros.description.constraints import Closure
from symofros.mechanics.topology.tree import SpanningTree
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
