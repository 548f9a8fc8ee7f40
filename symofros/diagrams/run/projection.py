"""Interpreted diagrams: the state back onto the constraints, at ends of steps and where constraints engage."""

from __future__ import annotations

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.program.layout import Part
from symofros.diagrams.run.block_functions import Blocks
from symofros.runtime.constrained import project
from symofros.runtime.manifold import retract
from symofros.simulation.results.engaging import ENGAGE_TOLERANCE, EngagedApartError


def project_all(blocks: Blocks) -> float:
    """The parts back onto their constraints; returns the largest |phi| by weight before."""
    parts = [part for part in blocks.resolved.layout.parts if part.nc]
    return max((_project(blocks, part) for part in parts), default=0.0)


def _project(blocks: Blocks, part: Part) -> float:
    """The state of a part back onto its constraints, as C does it; returns |phi| by weight before."""
    layout, pieces = blocks.resolved.layout, blocks.resolved.pieces
    nv, nc = part.nv, part.nc

    def terms(q: Array, v: Array) -> list[Array]:
        blocks.q[part.q], blocks.v[part.v] = q, v
        blocks.signals()
        M, G, phi, rate, binds = np.eye(nv), np.zeros((nc, nv)), np.zeros(nc), np.zeros(nc), np.zeros(nc)
        facing = [np.zeros(0)]
        for name in part.blocks:
            if name not in layout.v or pieces[name].terms.G is None:
                continue
            call, outputs = blocks.calls[name, "motion"]
            call()
            i, n = layout.v[name].start - part.v.start, layout.v[name].size
            c = layout.lam[name].start - part.conditions.start
            M[i : i + n, i : i + n] = outputs["t_M"]
            rows = slice(c, c + pieces[name].nc)
            G[rows, i : i + n], phi[rows], rate[rows] = outputs["t_G"], outputs["t_phi"], outputs["t_rate"]
            facing.append(outputs.get("t_facing", np.zeros(0)))
            edges = pieces[name].terms.phi
            assert edges is not None
            binds[rows] = [float(edge != 0) for edge in edges.flat]
        return [M, G, binds, phi, rate, np.concatenate(facing)]

    def move(q: Array, theta: Array) -> Array:
        whole, along = blocks.q.copy(), np.zeros(len(blocks.v))
        whole[part.q], along[part.v] = q, theta
        return retract(layout.segments, whole, along)[part.q]

    start = blocks.q[part.q].copy(), blocks.v[part.v].copy()
    q_on, v_on, *_, gap = project(terms, move, *start, layout.measures_of(part))
    blocks.q[part.q], blocks.v[part.v] = q_on, v_on
    return gap


def engage(blocks: Blocks, before: Array) -> float:
    """Project the state onto constraints that have changed: a plastic impact.

    Args:
        blocks: The diagram's blocks.
        before: What said which constraints hold, before.

    Returns:
        The |phi| that was closed.

    Raises:
        EngagedApartError: It is more than bodies may be moved by; the state stays.
    """
    on = blocks.q.copy(), blocks.v.copy()
    gap = project_all(blocks)
    if gap > ENGAGE_TOLERANCE:
        blocks.q[:], blocks.v[:] = on
        rises = np.flatnonzero(blocks.engaged() > before)
        names = blocks.resolved.layout.lock_names
        raise EngagedApartError(gap, names[int(rises[-1])] if len(rises) else ", ".join(names))
    return gap
