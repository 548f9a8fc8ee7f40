"""The planar flexible robot by us and by Exudyn, each of ours with the coarsest mesh of Exudyn's that errs no more.

Error is the worst relative error of the robot's lowest elastic frequencies about a bent posture, against Exudyn's own
model on a fine mesh. All coordinates take part in them: hinges, harmonic drive with its rotor, strips, what they carry.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

import symofros as sf

from ... import references
from ...adapters.exudyn.planar import Cable, PlanarTree, planar_tree
from ...mechanics.geometry import Array
from .race import LABEL

POSTURE = {"q1": 0.3, "q2": 0.8, "q3": -0.5}
# E A of the strips, from the sections the model states: 200 GPa on 50 mm x 2.5 mm and on 40 mm x 2 mm [N].
EA = {"link1": 2.5e7, "link2": 1.6e7}
# Three hinges turn freely. As stated, harmonic drive and strips then give seven frequencies, up to 95 Hz.
RIGID, ELASTIC = 3, 7
# Halving its elements again moves none of the seven by more than 5e-7.
FINE = 32
MAX_ELEMENTS = 16
# Cruder than this, a side is no model of this robot, and its time means nothing.
SAME_ROBOT = 0.05


class NotTheSameError(ValueError):
    """The two sides are not models of one robot."""


@dataclass(frozen=True)
class Pair:
    """One of our models with the mesh of Exudyn's that matches it.

    Attributes:
        functions: Shape functions a strip.
        elements: Number of Exudyn's elements a strip.
        error: Errors of the generated C and of Exudyn.
        tree: Exudyn's model.
    """

    functions: int
    elements: int
    error: tuple[float, float]
    tree: PlanarTree


def robot(functions: int) -> sf.System:
    """The robot with so many shape functions a strip; three are what its file states."""
    stated = references.MODELS[LABEL]
    bodies = [replace(body, bend_y=functions) if isinstance(body, sf.Beam) else body for body in stated.bodies]
    return replace(stated, bodies=tuple(bodies))


def exudyn_robot(elements: int) -> PlanarTree:
    """The robot with so many elements a strip."""
    cables = {name: Cable(elements, stiffness) for name, stiffness in EA.items()}
    return planar_tree(references.MODELS[LABEL], POSTURE, cables)


def generated_frequencies(functions: int) -> Array:
    """Undamped elastic circular frequencies about the posture at rest, rising (ELASTIC,)."""
    model = sf.compile(robot(functions), sf.Options(backend="interpreter"))
    q = np.array([POSTURE.get(name, 0.0) for name in model.names.q])
    A, _ = model.linearize(q, np.zeros(model.nv), np.zeros(model.nu))
    # The lower left block is -M^-1 K: dampers and friction are in the lower right one.
    squares = np.sort(np.linalg.eigvals(-A[model.nv :, : model.nv]).real)
    return np.sqrt(squares[RIGID : RIGID + ELASTIC])


def exudyn_frequencies(tree: PlanarTree) -> Array:
    """The same of Exudyn's model."""
    return tree.frequencies(RIGID + ELASTIC)[RIGID:]


def pairs(counts: Iterable[int]) -> Iterator[Pair]:
    """Pairs of equal accuracy.

    Args:
        counts: Shape functions a strip, model by model.

    Raises:
        NotTheSameError: The frequencies of the two sides are not those of one robot.
    """
    reference = exudyn_frequencies(exudyn_robot(FINE))
    for count in counts:
        generated = _worst(generated_frequencies(count), reference)
        if not generated <= SAME_ROBOT:
            raise NotTheSameError(f"{LABEL}, {count} functions: frequencies err by {generated:.1e}: times mean nothing")
        yield _matched(count, generated, reference)


def _matched(count: int, generated: float, reference: Array) -> Pair:
    for elements in range(1, MAX_ELEMENTS + 1):
        tree = exudyn_robot(elements)
        engine = _worst(exudyn_frequencies(tree), reference)
        if engine <= generated:
            return Pair(count, elements, (generated, engine), tree)
    raise NotTheSameError(f"{LABEL}, {count} functions: no mesh of up to {MAX_ELEMENTS} elements errs {generated:.1e}")


def _worst(frequencies: Array, reference: Array) -> float:
    return float(np.abs(frequencies / reference - 1.0).max())
