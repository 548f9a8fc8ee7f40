"""Forces and moments over a run, at joints, constraints and contacts, as arrows where the mechanism is drawn."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.description import Closure, KnifeEdge, Rod, Rolling, System
from symofros.mechanics.topology import SpanningTree, frame_of
from symofros.simulation.results.trajectory import Trajectory
from symofros.studio.viewer.drawing.drawing import Drawing, LinkPoint
from symofros.studio.viewer.drawing.layers import ARROWS, Arrows, ArrowScale
from symofros.studio.viewer.drawing.poses import Posture

# Share of the records whose largest arrow is no longer than what the scale is chosen by: impacts are short and large.
_USUAL = 0.95
_ROUNDING = 1e-9
_REPEATED = (
    "constraints repeat others: how these and the joints of their loops share forces is undetermined; "
    "the least forces of the constraints are drawn"
)


class _Wrenches(NamedTuple):
    """One place's force and moment over the records of a run.

    Attributes:
        place: Point on a link that they act at; None: the points of `points`.
        turns: Whether they are along the axes of that link, not of the world.
        force: (n, 3) [N].
        moment: (n, 3) [N m].
        points: Points in the world (n, 3) [m].
    """

    place: LinkPoint | None
    turns: bool
    force: Array
    moment: Array
    points: Array | None = None


class RunForces:
    """What acts in a run: formed once, from its accelerations and multipliers.

    Of a joint, what it transmits to its body, at the origin of the body frame; of a constraint, what it exerts on its
    second frame, or the frame that touches; of a contact, the force on the ball.

    Args:
        run: Run.
        tree: Tree of the mechanism that is drawn.
        drawing: Its drawing.

    Raises:
        SymofrosError: The run's model does not tell of its reactions.
    """

    def __init__(self, run: Trajectory, tree: SpanningTree, drawing: Drawing) -> None:
        self._t = run.t
        self._all = [*_of_joints(run, tree), *_of_constraints(run, tree, drawing), *_of_contacts(run)]
        size, force, moment = drawing.size, self._usual("forces"), self._usual("moments")
        # What the other one makes over the mechanism's size by rounding alone is none.
        usual = {
            "forces": 0.0 if force * size <= _ROUNDING * moment else force,
            "moments": 0.0 if moment <= _ROUNDING * force * size else moment,
        }
        self._remarks = [_REPEATED] if _repeats(run, tree.system) else []
        self.scales = {layer: ArrowScale.of(layer, usual[layer], size) for layer in ARROWS}

    def _usual(self, layer: str) -> float:
        """Magnitude that the largest arrow of a record reaches seldom."""
        vectors = np.array([_vectors(each, layer) for each in self._all]).reshape(-1, len(self._t), 3)
        largest = np.linalg.norm(vectors, axis=-1).max(axis=0, initial=0.0)
        largest = largest[np.isfinite(largest)]
        return float(np.quantile(largest, _USUAL)) if largest.any() else 0.0

    def arrows(self, t: float, posture: Posture, layers: frozenset[str]) -> Arrows:
        """The arrows of some layers at an instant, between records linear in time.

        Args:
            t: Time [s].
            posture: Posture that is drawn.
            layers: Layers that are shown.
        """
        found: dict[str, Array] = {}
        for layer, scale in self.scales.items():
            if scale is None or layer not in layers:
                found[layer] = np.zeros((0, 2, 3))
                continue
            points, vectors = zip(*(self._placed(each, layer, t, posture) for each in self._all), strict=True)
            found[layer] = scale.arrows(np.array(points), np.array(vectors))
        return found

    def _placed(self, wrenches: _Wrenches, layer: str, t: float, posture: Posture) -> tuple[Array, Array]:
        """Where a force or moment acts, and what it is, in the world."""
        vector, place = self._at(t, _vectors(wrenches, layer)), wrenches.place
        if place is None:
            assert wrenches.points is not None
            return self._at(t, wrenches.points), vector
        return posture.point(place), posture.R[place.link] @ vector if wrenches.turns else vector

    def _at(self, t: float, values: Array) -> Array:
        """Values (n, 3) over the records at a time (3)."""
        k = int(np.clip(np.searchsorted(self._t, t, side="right"), 1, max(len(self._t) - 1, 1)))
        if len(self._t) == 1:
            return np.array(values[0])
        gap = self._t[k] - self._t[k - 1]
        share = float(np.clip((t - self._t[k - 1]) / gap, 0.0, 1.0)) if gap > 0.0 else 1.0
        return np.asarray((1.0 - share) * values[k - 1] + share * values[k])

    def legend(self, layers: frozenset[str]) -> list[str]:
        """The scales of the layers that are shown, in words."""
        texts = []
        for layer, scale in self.scales.items():
            if layer in layers:
                texts.append(f"no {layer} in this run" if scale is None else scale.legend)
        return [*texts, *self._remarks] if texts else []


def _repeats(run: Trajectory, system: System) -> bool:
    """Whether constraints repeat others in all of a run; not asked where switches or contacts take them away."""
    model = run.model
    if not model.nc or system.switches or model.names.contacts:
        return False
    at = [0, len(run.t) // 2, -1]  # A mechanism that is stretched at one of them has a lower rank there alone.
    z = run.z[at] if model.nz else None
    _, _, rank = model.constrained_dynamics(run.q[at], run.v[at], run.u[at], par=run.par, t=run.t[at], z=z)
    return 0 <= int(rank.max()) < model.nc


def _vectors(wrenches: _Wrenches, layer: str) -> Array:
    return wrenches.force if layer == "forces" else wrenches.moment


def _of_joints(run: Trajectory, tree: SpanningTree) -> list[_Wrenches]:
    wrenches = run.joint_wrenches()
    drawn = {frame.link for frame in tree.frames if not frame.placement}
    here = np.zeros(3)
    return [
        _Wrenches(LinkPoint(i, here), True, wrenches[:, i, :3], wrenches[:, i, 3:])
        for i in range(len(tree.links))
        if i in drawn  # A beam's tip without a frame carries nothing.
    ]


def _of_constraints(run: Trajectory, tree: SpanningTree, drawing: Drawing) -> list[_Wrenches]:
    places = {triad.name: LinkPoint(triad.link, triad.position) for triad in drawing.triads}
    found = []
    for name, anchor in _anchors(tree.system).items():
        wrench, place = run.closure_wrench(name), places[frame_of(tree, *anchor).name]
        found.append(_Wrenches(place, False, wrench[:, :3], wrench[:, 3:]))
    return found


def _anchors(system: System) -> dict[str, tuple[str, str | None]]:
    """Constraint with a wrench -> the frame that this acts on."""
    return {
        item.name: item.second if isinstance(item, Closure | Rod) else item.anchor
        for item in system.constraints
        if isinstance(item, Closure | Rod | KnifeEdge | Rolling)
    }


def _of_contacts(run: Trajectory) -> list[_Wrenches]:
    if not run.model.names.contacts:
        return []
    found, none = run.contact_forces(), np.zeros((len(run), 3))
    return [_Wrenches(None, False, found.force[:, k], none, found.point[:, k]) for k in range(found.force.shape[1])]
