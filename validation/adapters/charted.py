"""Engines of the matrix in a check: stated a description neutrally, asked in their own charts, their answers in ours.

A plug-in of `validation/engines` states no mechanics of ours, and none of the check's: it builds a `Tree` and says in
which charts it keeps the joints. Here a description becomes such a tree, and what the engine answers is turned.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..contract.conventions import Chart, Slot
from ..contract.interface import NotOffered, SolvedEngine, States, Subject, Unsupported
from ..contract.memory import LatestResults
from ..contract.quantities import ROUNDING
from ..engines.interface import (
    EngineModel,
    EnginePlugin,
    HasLayout,
    State,
    Steps,
    rows,
    vector,
)
from ..engines.plugins import OWN
from ..engines.plugins.writing.source import SourceModel
from ..engines.workers import layout_of
from ..mechanics.geometry import Array
from ..mechanics.joint_kinds import PartKind
from .reach import armature, bears_its_weight_alone, stores_energy, unrepresented
from .stated import Stated, stated

# Quantities -> the function of the matrix that states them.
FUNCTIONS = {
    "mass_matrix": "mass_matrix",
    "bias": "bias",
    "gravity": "bias",
    "kinetic_energy": "kinetic_energy",
    "potential_energy": "potential_energy",
    "inverse_dynamics": "inverse_dynamics",
    "forward_dynamics": "forward_dynamics",
    "joint_wrenches": "joint_wrenches",
    "frame_pose": "link_poses",
    "frame_velocity": "link_velocities",
    "frame_acceleration": "link_accelerations",
    "frame_jacobian": "link_jacobians",
    "frame_jacobian_rate": "link_jacobian_rates",
}
# Quantities that follow from others where an engine does not give them -> functions that they follow from.
FOLLOWING = {
    "bias": {"gravity"},  # At rest.
    "kinetic_energy": {"mass_matrix"},
    "potential_energy": {"link_poses"},
    "inverse_dynamics": {"mass_matrix", "bias"},
    "forward_dynamics": {"mass_matrix", "bias"},
}


def chart_of(model: HasLayout, described: Stated) -> Chart:
    """Where, and in which charts, an engine keeps our joints.

    Raises:
        ValueError: There is no conversion of a chart.
    """
    slots = []
    for movers, link, statement in zip(described.movers, model.slots, described.tree.links, strict=False):
        own, first = list(link), statement.joints[0]
        for mover in movers:
            several = len(own) - len(movers) + 1 if mover.kind == "free" else 1
            parts, own = own[:several], own[several:]
            chart = " + ".join(part.chart for part in parts)
            # It stands where ours does, or in the world.
            grounded = first.kind == "free" and (first.R, first.p) != (rows(mover.X_AP.R), vector(mover.X_AP.p))
            slots.append(Slot(mover, parts[0].q[0], parts[0].v[0], chart, grounded))
    return Chart(tuple(slots), model.nq, model.nv)


@dataclass(frozen=True)
class ChartedEngine(SolvedEngine):
    """A model of a plug-in behind the check's `Engine` protocol.

    Attributes:
        name: Name of the route.
        version: Version of the engine.
        answers: The engine's model, as the matrix asks it.
        chart: Map between its coordinates and ours.
        frames: Links that are the subject's frames.
        capabilities: Quantities that it offers on this route.
        most_states: Largest number of states in one call.
        without_frames: Makes the same model without links for frames: that of joint wrenches.
        joints: Links whose joint wrenches are the description's joints'.
        following: Quantities among the capabilities that the engine does not give: they follow from others.
        weights: Masses of its links, and times their mass centres (L, 4).
        gravity: Acceleration of gravity (3) [m/s^2].
        accuracy: Tolerances, relative to the largest entry, of what the engine documents as approximate: functions of
            the matrix, and quantities.
    """

    name: str
    version: str
    answers: EngineModel
    chart: Chart
    frames: tuple[int, ...] = ()
    capabilities: frozenset[str] = frozenset(FUNCTIONS)
    most_states: int = 10**9
    without_frames: Callable[[], EngineModel] | None = None
    joints: Sequence[int] = ()
    following: frozenset[str] = frozenset()
    weights: Array = field(default_factory=lambda: np.zeros((0, 4)))
    gravity: Array = field(default_factory=lambda: np.zeros(3))
    accuracy: Mapping[str, float] = field(default_factory=dict)
    _converted: LatestResults[list[State]] = field(default_factory=LatestResults)

    @property
    def names(self) -> dict[str, Any]:
        """What the text of one of our plug-ins defines."""
        assert isinstance(self.answers, SourceModel)
        return self.answers.names

    @property
    def model(self) -> Any:
        """The engine's own object, for those who step or time it."""
        return self.names["m"]

    def asked(
        self, function: str, states: States, model: EngineModel | None = None, links: Sequence[int] | None = None
    ) -> Array:
        """A function of the matrix at N states, in the engine's own coordinates and speeds (N, ...).

        Args:
            function: Its name.
            states: The states.
            model: Model to ask in place of `answers`.
            links: The links that a function of links is wanted of; all, if not given.

        Raises:
            NotOffered: The engine does not have it for this tree.
            ValueError: The engine refuses.
        """
        given = states.q, states.v, states.a, states.applied
        values = _each(model or self.answers, function, self._converted.get(given, lambda: self._own(states)), links)
        if isinstance(values, Unsupported):
            raise (ValueError if values.offered else NotOffered)(values.reason)
        return values

    def _own(self, states: States) -> list[State]:
        """The states in the engine's own coordinates and speeds, which its calls get copies of."""
        chart, none = self.chart, np.zeros(self.chart.nv)
        q, v = chart.coordinates(states.q), chart.speeds(states.q, states.v)
        a, tau = chart.accelerations(states.q, states.v, states.a), chart.forces(states.q, states.applied)
        return [State(*row, none, row[0]) for row in zip(q, v, a, tau, strict=True)]

    def _of_frames(self, function: str, states: States) -> Array:
        return self.asked(function, states, links=self.frames)

    def _jacobians(self, function: str, states: States) -> Array:
        """Jacobians of frames (N, F, 6, nv): some bindings turn a matrix of one column into a vector."""
        return self._of_frames(function, states).reshape(len(states), len(self.frames), 6, self.chart.nv)

    def mass_matrix(self, states: States) -> Array:
        """M (N, nv, nv)."""
        return self.chart.mass_matrix(states.q, self.asked("mass_matrix", states))

    def bias(self, states: States) -> Array:
        """Coriolis, centrifugal and gravity forces h (N, nv)."""
        h = self.asked("gravity" if "bias" in self.following else "bias", states)
        if not self.chart.turns:
            return self.chart.our_forces(states.q, h)
        return self.chart.bias(states.q, states.v, h, self.asked("mass_matrix", states))

    def kinetic_energy(self, states: States) -> Array:
        """Kinetic energy (N,) [J]."""
        follows = "kinetic_energy" in self.following
        return super().kinetic_energy(states) if follows else self.asked("kinetic_energy", states)

    def potential_energy(self, states: States) -> Array:
        """Gravitational potential energy (N,) [J], from the places of mass centres where the engine gives none."""
        if "potential_energy" not in self.following:
            return self.asked("potential_energy", states)
        poses = self.asked("link_poses", states)[:, : len(self.weights)]
        R = poses[..., 3:].reshape(*poses.shape[:2], 3, 3)
        moments = self.weights[:, :1] * poses[..., :3] + (R @ self.weights[:, 1:, None])[..., 0]
        return np.asarray(-moments.sum(axis=1) @ self.gravity)

    def inverse_dynamics(self, states: States) -> Array:
        """M a + h - passive (N, nv)."""
        if "inverse_dynamics" in self.following:
            return super().inverse_dynamics(states)
        return self.chart.our_forces(states.q, self.asked("inverse_dynamics", states)) - states.passive

    def forward_dynamics(self, states: States) -> Array:
        """M^-1 (applied - h) (N, nv)."""
        if "forward_dynamics" in self.following:
            return super().forward_dynamics(states)
        return self.chart.our_accelerations(states.q, states.v, self.asked("forward_dynamics", states))

    def joint_wrenches(self, states: States) -> Array:
        """Wrenches of the joints (N, joints, 6); of one that is a series of simple ones, that of the last."""
        return self.asked("joint_wrenches", states, self._bare)[:, list(self.joints)]

    @cached_property
    def _bare(self) -> EngineModel | None:
        return None if self.without_frames is None else self.without_frames()

    def frame_pose(self, states: States) -> Array:
        """p_WF and the rows of R_WF (N, F, 12)."""
        return self._of_frames("link_poses", states)

    def frame_velocity(self, states: States) -> Array:
        """Velocities of the frames' origins and angular velocities, in world axes (N, F, 6)."""
        return self._of_frames("link_velocities", states)

    def frame_acceleration(self, states: States) -> Array:
        """The time derivative of frame_velocity (N, F, 6)."""
        return self._of_frames("link_accelerations", states)

    def frame_jacobian(self, states: States) -> Array:
        """frame_velocity = J v (N, F, 6, nv)."""
        return self.chart.jacobian(states.q, self._jacobians("link_jacobians", states))

    def frame_jacobian_rate(self, states: States) -> Array:
        """dJ/dt (N, F, 6, nv)."""
        J_rate = self._jacobians("link_jacobian_rates", states)
        if not self.chart.turns:
            return J_rate @ self.chart.transform(states.q)[:, None]
        return self.chart.jacobian_rate(states.q, states.v, self._jacobians("link_jacobians", states), J_rate)


def _each(
    model: EngineModel, function: str, states: Iterable[State], links: Sequence[int] | None
) -> Array | Unsupported:
    """Values of a function at N states (N, ...), one state after the other; of links, at those that are wanted."""
    if isinstance(model, SourceModel):
        return model.each(function, states, links)
    values = []
    for state in states:
        value = model.call(function, State(*(part.copy() for part in vars(state).values())))
        if isinstance(value, Unsupported):
            return value
        values.append(np.array(value, dtype=float))
    return np.array(values) if links is None else np.array(values)[:, list(links)]


def offered(functions: Collection[str], subject: Subject) -> frozenset[str]:
    """Quantities that an engine can be compared by: of forces on bodies, and of their energy, it knows the weight."""
    names = frozenset(name for name, function in FUNCTIONS.items() if {name, function} & {*functions})
    names -= {"potential_energy"} if stores_energy(subject.system) else set()
    return names - ({"joint_wrenches"} if not bears_its_weight_alone(subject.system) else set())


def build(
    engine: str | EnginePlugin,
    subject: Subject,
    joints: Collection[PartKind],
    whole: bool,
    merged: bool,
    splits_free: bool = True,
) -> ChartedEngine | Unsupported:
    """An engine's model of a rigid description, by its plug-in.

    Args:
        engine: The plug-in, or the name of one of ours.
        subject: The subject.
        joints: Kinds of simple joints that the engine has.
        whole: See `stated`.
        merged: See `stated`.
        splits_free: See `stated`.
    """
    obstacle = unrepresented(subject.system, subject.assembly, joints)
    if obstacle is not None:
        return obstacle
    plugin = OWN[engine] if isinstance(engine, str) else engine
    described = stated(subject, whole, merged, splits_free)
    model = plugin.build(described.tree)
    if isinstance(model, Unsupported):
        return model

    def without_frames() -> EngineModel:
        bare = plugin.build(stated(replace(subject, frames=()), whole, True, splits_free).tree)
        assert not isinstance(bare, Unsupported)  # As the whole is not.
        return bare

    given = plugin.functions.keys()
    following = frozenset(name for name, needs in FOLLOWING.items() if name not in given and needs <= given)
    chart = chart_of(layout_of(described.tree, model), described)
    for slot in chart.slots:
        if slot.turns and armature(subject.system, slot.mover):
            # The rate of components along other axes is another acceleration than the rate of body components.
            return Unsupported(f"joint '{slot.mover.joint.name}': an armature along body axes")
    return ChartedEngine(
        plugin.name,
        plugin.version(),
        model,
        chart,
        described.frames,
        offered(given | (following - {"bias"}), subject),
        without_frames=without_frames,
        joints=described.joints,
        following=following,
        weights=np.array([[link.mass, *(link.mass * np.array(link.com))] for link in described.tree.links]),
        gravity=np.array(described.tree.gravity),
        accuracy=_accuracy(plugin),
    )


def _accuracy(plugin: EnginePlugin) -> dict[str, float]:
    """Tolerances of the functions that the engine documents as approximate, and of quantities that they state."""
    granted = {
        function: slack.truncation + ROUNDING / slack.step if isinstance(slack, Steps) else slack
        for function, slack in plugin.slacks.items()
    }
    return granted | {name: granted[function] for name, function in FUNCTIONS.items() if function in granted}
