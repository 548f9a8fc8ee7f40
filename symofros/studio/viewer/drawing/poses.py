"""Where everything drawn is, for given coordinates: the model's own frame poses, and its beams' own axes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from symofros.base.arrays import Array, real_array
from symofros.base.options import Options
from symofros.compiler import compile_system
from symofros.description import Closure, Rolling, System
from symofros.errors import AssemblyError, ShapeError
from symofros.mechanics.topology import Numbers, SpanningTree, build_tree, frame_of
from symofros.runtime.beams import BeamBending
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.beam_theory import bendings_in_motion
from symofros.simulation.analysis.kinematics.assembly import assemble
from symofros.studio.viewer.drawing.drawing import Drawing, DrawnBeam, DrawnConnector, LinkPoint
from symofros.studio.viewer.drawing.geometry import draw, landmarks
from symofros.studio.viewer.drawing.inertia_box import longest_edges
from symofros.studio.viewer.drawing.meshes import axes_along
from symofros.studio.viewer.drawing.tracks import Track, track_part

_MIN_SIZE = 1e-6  # [m]; what is smaller is drawn as if it were a metre, for want of anything to go by.


@dataclass(frozen=True)
class Posture:
    """Poses of all links, with any leading dimensions.

    Attributes:
        p: p_WL of every link, the world last, so that index -1 is the world (..., links + 1, 3) [m].
        R: R_WL of every link, the unit matrix of the world last (..., links + 1, 3, 3).
        q: The coordinates drawn, elastic ones exaggerated (..., nq).
    """

    p: Array
    R: Array
    q: Array

    def __getitem__(self, index: int) -> Posture:
        """The posture at an index of the leading dimension."""
        return Posture(self.p[index], self.R[index], self.q[index])

    def point(self, place: LinkPoint) -> Array:
        """A point in the world (..., 3) [m]."""
        position: Array = self.p[..., place.link, :] + self.R[..., place.link, :, :] @ place.position
        return position


class State(NamedTuple):
    """What is shown: coordinates (nq), inputs (nu) for prescribed motions, run-time parameters (npar)."""

    q: Array
    u: Array
    par: Array


class Mechanism:
    """A system with what it takes to draw it: its tree, and its frame poses compiled (cached, as every model is).

    Args:
        system: System as the user stated it.
        tracks: Tracks to draw beside it.

    Raises:
        DescriptionError: The system can't be a mechanism.
    """

    def __init__(self, system: System, tracks: tuple[Track, ...] = ()) -> None:
        self.system, self.tracks = system, tracks
        self.tree: SpanningTree = build_tree(system)
        frames = self.tree.frames
        # A beam's tip without a frame moves nothing that is drawn, and has no name.
        self._names = [
            next((f.name for f in frames if f.link == i and not f.placement), None) for i in range(len(self.tree.links))
        ]
        wanted = {name for name in self._names if name is not None}
        functions: tuple[str, ...] = ("frame_pose",)
        if self.tree.system.constraints:  # Those of rigid contacts and of friction that sticks, too.
            functions += ("constraint", "constraint_jacobian", "constraint_rate")
            ends = [
                end for item in system.constraints if isinstance(item, Closure) for end in (item.first, item.second)
            ]
            wanted |= {frame_of(self.tree, *end).name for end in ends}
        asked = tuple(frame.name for frame in frames if frame.name in wanted)
        self.model: Model = compile_system(system, Options(functions, asked, batch="loop"))
        self._elastic = np.zeros(self.model.nq, dtype=bool)
        for link in self.tree.links:
            if link.tip_of is not None:
                self._elastic[link.q[0] : sum(link.q)] = True

    def bendings(self, state: State) -> tuple[BeamBending, ...]:
        """Bending of each beam in a state, amplified by the axial loads under which it starts to move from there."""
        if not self.is_flexible:
            return ()
        q, u, par = state
        return bendings_in_motion(self.moving, q, np.zeros(self.moving.nv), u, par)

    @cached_property
    def moving(self) -> Model:
        """The model with all of its functions, made when it is first asked for: for bent beams, or forces of a run."""
        return compile_system(self.system)

    @property
    def is_flexible(self) -> bool:
        """Whether it has elastic coordinates."""
        return bool(self._elastic.any())

    @property
    def elastic(self) -> tuple[bool, ...]:
        """Which coordinates are elastic (nq)."""
        return tuple(self._elastic.tolist())

    def state(self, q: ArrayLike | None = None, u: ArrayLike | None = None, par: ArrayLike | None = None) -> State:
        """A state to show; omitted arrays are neutral or default.

        Raises:
            ShapeError: An array does not fit the model.
            ParameterError: The description refuses the parameters.
        """
        model = self.model
        return State(
            model.neutral() if q is None else self._vector("q", q, model.nq),
            np.array(model.record.u_default) if u is None else self._vector("u", u, model.nu),
            np.array(model.checked_parameters(self._vector("par", par, model.npar)))
            if par is not None
            else np.array(model.parameter_values),
        )

    def _vector(self, what: str, given: Any, size: int) -> Array:
        array = real_array(given)
        if array is None or array.shape != (size,):
            raise ShapeError(
                f"view of '{self.system.name}': {what} has the wrong shape",
                f"{given!r:.60}" if array is None else str(array.shape),
                f"{what} has shape ({size},)",
                "one state is shown at a time; motions are played",
            )
        return np.array(array)

    def posture(
        self, q: ArrayLike, u: ArrayLike | None = None, par: ArrayLike | None = None, exaggeration: float = 1.0
    ) -> Posture:
        """Poses of the links for coordinates (..., nq)."""
        drawn = np.array(q, dtype=np.float64)
        drawn[..., self._elastic] *= exaggeration
        shape = (*drawn.shape[:-1], len(self._names) + 1)
        p, R = np.zeros((*shape, 3)), np.broadcast_to(np.eye(3), (*shape, 3, 3)).copy()
        for i, name in enumerate(self._names):
            if name is not None:
                p[..., i, :], R[..., i, :, :] = self.model.frame_pose(name, drawn, u=u, par=par)
        return Posture(p, R, drawn)

    def drawing(self, par: ArrayLike | None = None) -> Drawing:
        """Drawing of the mechanism and its tracks at run-time parameters (npar)."""
        state = self.state(par=par)
        values = dict(zip(self.model.names.par, state.par.tolist(), strict=True))
        neutral = self.posture(state.q, state.u, state.par)
        numbers = Numbers(self.system, values)
        places = [neutral.point(place) for place in landmarks(self.tree, numbers)]
        points = np.concatenate([places, *(track.points for track in self.tracks)])
        low, high = points.min(axis=0), points.max(axis=0)
        # A body on its own has no other size than its inertia's; a typical one, as files have placeholders.
        size = max(
            float(np.linalg.norm(high - low)),
            float(np.median(longest_edges(self.system, numbers) or [0.0])),
            *(2 * numbers.value(item.radius) for item in self.system.constraints if isinstance(item, Rolling)),
        )
        size = size if size > _MIN_SIZE else 1.0
        drawing = draw(self.tree, values, size, (low + high) / 2)
        return replace(drawing, parts=(*drawing.parts, *(track_part(track, size) for track in self.tracks)))

    def closed(self, state: State, held: tuple[str, ...] = ()) -> tuple[State, str]:
        """The nearest state whose loops are closed, and why there is none: "" where there is.

        Args:
            state: A guess.
            held: Names of speeds whose coordinates stay as they are.
        """
        if not self.model.nc:
            return state, ""
        try:
            assembly = assemble(self.model, state.q, held=held, u=state.u, par=state.par)
        except AssemblyError as error:
            return state, str(error)
        return state._replace(q=assembly.q), ""


class Sweep(NamedTuple):
    """A section that goes along a line: p_WS (S, 3) and R_WS (S, 3, 3) of its stations."""

    points: Array
    axes: Array


def beam_sweep(beam: DrawnBeam, posture: Posture) -> Sweep:
    """A beam's sections in the world."""
    start, size = beam.q
    q, p, R = posture.q[start : start + size], posture.p[beam.link], posture.R[beam.link]
    return Sweep(p + beam.line.points(beam.length, q) @ R.T, R @ beam.line.axes(beam.length, q))


def connector_sweep(connector: DrawnConnector, posture: Posture) -> Sweep:
    """A connector's ends in the world."""
    first, second = posture.point(connector.first), posture.point(connector.second)
    R = axes_along(second - first)
    return Sweep(np.stack([first, second]), np.stack([R, R]))
