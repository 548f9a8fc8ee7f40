"""What is known of a model besides its functions: sizes, names, defaults, the shape of its configuration space."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.base.events import Event, Named
from symofros.base.manifold import ManifoldKind
from symofros.base.measures import Measures
from symofros.errors import SymofrosError


class Segment(NamedTuple):
    """A run of coordinates of one kind.

    Attributes:
        kind: "linear" (q' = v), "quaternion" (ball joint) or "pose" (free joint: position and quaternion).
        q: First index in q.
        v: First index in v.
        size: Number of coordinates.
    """

    kind: ManifoldKind
    q: int
    v: int
    size: int

    @property
    def constant(self) -> str:
        """The kind's constant in native/stepping/symofros_stepper.h."""
        return f"SYM_SEGMENT_{self.kind.upper()}"

    @property
    def speeds(self) -> int:
        """Number of speeds."""
        return {"linear": self.size, "quaternion": 3, "pose": 6}[self.kind]

    @property
    def translations(self) -> int:
        """Number of coordinates, and of speeds, before the quaternion, or of all where there is none."""
        return {"linear": self.size, "quaternion": 0, "pose": 3}[self.kind]


class ClosureRecord(NamedTuple):
    """A closure as far as it matters after compilation.

    Attributes:
        name: Name.
        first: Public name of the reference frame.
        second: Second of the other frame.
        rotations: Blocked axes of rotation, 0 to 2.
    """

    name: str
    first: str
    second: str
    rotations: tuple[int, ...]

    @property
    def parallel(self) -> tuple[int, ...]:
        """Axes that stay parallel in the closed posture: all three, or the one that may turn; of one blocked, none."""
        free = tuple(k for k in range(3) if k not in self.rotations)
        return {3: self.rotations, 2: free}.get(len(self.rotations), ())


class SwitchRecord(NamedTuple):
    """A constraint that engages and releases.

    Attributes:
        name: Name of the constraint.
        engaged: Formula of parameters: 1 where it holds, 0 where it is released.
        moment: Whether it holds the pose of the moment in which it engages.
        offsets: Row of G, and parameter that is the offset of its condition; of those that hold a position.
        rotation: Parameters (x, y, z, w) of the rotation that it holds; none where it holds none.
        frames: Public names of the frames that it joins, of a closure.
    """

    name: str
    engaged: str
    moment: bool
    offsets: tuple[tuple[int, int], ...]
    rotation: tuple[int, ...]
    frames: tuple[str, ...]


# Mode of a coordinate that friction holds; 1 and -1 are those in which it slides.
HELD = 2.0


class StickingRecord(NamedTuple):
    """A coordinate with friction that sticks.

    Attributes:
        name: Name of the coordinate.
        q: Its index in q.
        v: Index of its rate in v.
        mode: Run-time parameter that is its mode: 1, -1 slides forwards, backwards; 2 held; 0 smooth friction.
        row: Row of G that holds it.
        breakaway: Formula of parameters: most that friction takes at rest.
        watch: Formula of speeds, parameters and multipliers that falls to zero where the mode ends.
    """

    name: str
    q: int
    v: int
    mode: int
    row: int
    breakaway: str
    watch: str


# What chooses modes.
_CHOOSE = "`simulate`, batches, steppers, diagrams, C packages, MEX, FMUs and WebAssembly choose them"

# Modes of a ball of a rigid contact.
OPEN, SLIDES, STICKS = 0.0, 1.0, 2.0


class RigidContactRecord(NamedTuple):
    """A ball of a rigid contact.

    Attributes:
        name: Name of the ball.
        mode: Run-time parameter that is its mode: 0 open, 1 slides, 2 sticks.
        pushes: Parameters that are a further force on the ball, along the axes of contact.
        way: Parameters that are the direction in which it has begun to slide (2), and its speed then.
        apart: Parameter that is how far it may pass the surface, open, by rounding.
        pole: Parameter that is the sign of the pole; -1 on a plane.
        rows: Rows of G that hold it along the axes of contact.
        constraints: Names of the constraints of these rows.
        friction: Formula of parameters: coefficient of friction.
        restitution: Formula of parameters: energetic coefficient of restitution.
        watched: Formulas that fall to zero where the mode ends: distance or normal force; slip, or what is left of
            friction.
    """

    name: str
    mode: int
    pushes: tuple[int, ...]
    way: tuple[int, ...]
    apart: int
    pole: int
    rows: tuple[int, ...]
    constraints: tuple[str, str]
    friction: str
    restitution: str
    watched: tuple[str, str]

    @property
    def state(self) -> tuple[str, ...]:
        """Formulas: distance, velocity against the surface (3), friction, restitution, normal's tilt, sine of rims."""
        quantities = ("gap", "vx", "vy", "vz", "nz", "sine")
        gap, vx, vy, vz, *angles = (f"`contact.{self.name}.{quantity}`" for quantity in quantities)
        return (gap, vx, vy, vz, self.friction, self.restitution, *angles)


class JointLimit(NamedTuple):
    """Limit of a joint, which no force keeps.

    Attributes:
        of: What is limited: "q" a coordinate, "v" a speed, "u" the effort that an input is.
        entry: Its index in that vector.
        lower: Least value; infinite where there is none.
        upper: Greatest value; infinite where there is none.
    """

    of: Literal["q", "v", "u"]
    entry: int
    lower: float
    upper: float


@dataclass(frozen=True)
class ModelRecord:
    """The description of a compiled model that needs no symbols.

    Attributes:
        name: Name of the system.
        hash: Hash of description, options and generator.
        q_names: Coordinates, as v_names are speeds, u_names inputs, par_names run-time parameters.
        frame_aliases: Qualified name -> public name of a frame.
        u_default: Inputs where none are given: zeros, and prescribed quaternions of no rotation.
        par_default: Values of the run-time parameters.
        q_neutral: A configuration on the manifold.
        q_lower: Lower bounds to sample within (nq); infinite where there are none.
        q_upper: Upper bounds to sample within (nq); infinite where there are none.
        segments: The configuration manifold, in order.
        periodic: Coordinates that are angles, so that unbounded ones are sampled in one turn.
        constraint_names: One a condition: the constraint's name, and which of its conditions.
        constraint_owners: One a condition: the constraint's name.
        speed_conditions: Names of the conditions that bind speeds only.
        wrench_names: Constraints that act on bodies by a wrench: all but conditions by formula.
        joint_names: Joints that transmit wrenches, and tips of beams: one a link.
        link_names: Bodies that joints move, with what is fixed to them: one a link.
        section_names: Sections of elastic beams whose forces can be asked for: name of the beam, and station x/L.
        prescribed_names: Speeds of prescribed motions.
        closures: Closures of frames, for checks of their rotations.
        driven: Inputs that prescribe motion, the last of u.
        quaternion_inputs: First index in u of each quaternion among these.
        measures: Measures of the rows and columns of the constraint Jacobian.
        timed: Whether a formula depends on the time t.
        joint_limits: Limits of joints that state them: of coordinates, speeds and inputs.
        friction_speeds: Indices of the speeds that have friction.
        contact_names: Balls of compliant contacts: the contact's name, of several with their numbers.
        switches: Constraints that engage and release.
        sticking: Coordinates with friction that sticks.
        rigid_contacts: Balls of rigid contacts.
        state_names: States of forces, carried as the last speeds, each beside an idle coordinate, the last ones.
        events: Name -> event that the description states, its formulas as texts.
    """

    name: str
    hash: str
    q_names: tuple[str, ...]
    v_names: tuple[str, ...]
    u_names: tuple[str, ...]
    par_names: tuple[str, ...]
    frame_names: tuple[str, ...]
    frame_aliases: dict[str, str]
    u_default: tuple[float, ...]
    par_default: tuple[float, ...]
    q_neutral: tuple[float, ...]
    q_lower: tuple[float, ...]
    q_upper: tuple[float, ...]
    segments: tuple[Segment, ...]
    periodic: tuple[bool, ...]
    constraint_names: tuple[str, ...] = ()
    constraint_owners: tuple[str, ...] = ()
    speed_conditions: tuple[str, ...] = ()
    wrench_names: tuple[str, ...] = ()
    joint_names: tuple[str, ...] = ()
    link_names: tuple[str, ...] = ()
    section_names: tuple[tuple[str, float], ...] = ()
    prescribed_names: tuple[str, ...] = ()
    closures: tuple[ClosureRecord, ...] = ()
    driven: int = 0
    quaternion_inputs: tuple[int, ...] = ()
    measures: Measures = Measures()
    timed: bool = False
    joint_limits: tuple[JointLimit, ...] = ()
    friction_speeds: tuple[int, ...] = ()
    contact_names: tuple[str, ...] = ()
    switches: tuple[SwitchRecord, ...] = ()
    sticking: tuple[StickingRecord, ...] = ()
    rigid_contacts: tuple[RigidContactRecord, ...] = ()
    state_names: tuple[str, ...] = ()
    events: Mapping[str, Event] = field(default_factory=dict)

    @property
    def set_by_actions(self) -> Named:
        """What actions of events may name."""
        places = ((switch, (*switch.rotation, *(at for _, at in switch.offsets))) for switch in self.switches)
        held = {place: (switch.name, switch.engaged) for switch, of in places for place in of}
        return Named(self.par_names, self.q_names, self.v_names, held)

    @cached_property
    def quaternions(self) -> dict[str, tuple[int, ...]]:
        """First index of each quaternion among the coordinates, "q", and among the inputs, "u"; empty without any."""
        of_q = tuple(segment.q + segment.translations for segment in self.segments if segment.kind != "linear")
        return {group: firsts for group, firsts in (("q", of_q), ("u", self.quaternion_inputs)) if firsts}

    @property
    def has_compliant_contacts(self) -> bool:
        """Whether balls of contacts push where they penetrate a surface, which no event finds."""
        return len(self.contact_names) > len(self.rigid_contacts)

    @property
    def facing_conditions(self) -> tuple[int, ...]:
        """A condition of the closure of each pair of axes that is to be parallel, in the order of "facing" in C."""
        owners = self.constraint_owners
        return tuple(owners.index(closure.name) for closure in self.closures for _ in closure.parallel)

    @property
    def vectors(self) -> dict[str, tuple[str, ...]]:
        """Names of the entries of q, v and u."""
        return {"q": self.q_names, "v": self.v_names, "u": self.u_names}

    @property
    def nc(self) -> int:
        """Number of constraints."""
        return len(self.constraint_names)

    def without_states(self) -> ModelRecord:
        """Sizes and names of the mechanism alone: no states among the speeds, no idle coordinates beside them."""
        n = len(self.state_names)
        if not n:
            return self
        return replace(
            self,
            segments=self.segments[:-1],
            measures=self.measures._replace(speed=self.measures.speed[:-n]),
            q_names=self.q_names[:-n],
            v_names=self.v_names[:-n],
            q_neutral=self.q_neutral[:-n],
            q_lower=self.q_lower[:-n],
            q_upper=self.q_upper[:-n],
            periodic=self.periodic[:-n],
        )

    def own_entries(self, size: str, total: int) -> list[int]:
        """Entries of the mechanism alone along an axis of an output.

        Args:
            size: The axis as the table of functions states it: "nq", "nv", "nv + nc".
            total: Its length, with the states of forces and idle coordinates.

        Raises:
            SymofrosError: The states are in the middle of it.
        """
        first, *others = size.split(" + ")
        if not self.state_names or "nv" not in size and "nq" not in size:
            return list(range(total))
        if first not in ("nq", "nv"):
            self.refuse_states(f"a function of {size} values")
        end, nz = len(self.q_names if first == "nq" else self.v_names), len(self.state_names)
        return [*range(end - nz), *(range(end, total) if others else ())]

    def smooth_friction_notes(self, v: Array, par: Array) -> tuple[str, ...]:
        """Notes on friction that sticks in runs and is smooth in functions, at speeds v (..., nv), parameters par."""
        return tuple(
            f"friction of '{one.name}' sticks in runs and is smooth here, by which the joint creeps from rest; with"
            f" par={{'{self.par_names[one.mode]}': 2}} it is held"
            for one in self.sticking
            if np.any((par[..., one.mode] == 0.0) & (v[..., one.v] == 0.0))
        )

    def refuse_sticking(self, what: str) -> None:
        """Refuse friction that sticks where nothing chooses its modes.

        Raises:
            SymofrosError: There is some.
        """
        if self.sticking:
            found = f"friction of '{self.sticking[0].name}' sticks"
            remedy = "sticks=False: friction that is smooth, and creeps"
            raise _no_modes(f"{what}: friction that sticks", found, _CHOOSE, remedy)

    def refuse_rigid_contacts(self, what: str, *, by_method: bool = False) -> None:
        """Refuse rigid contacts where nothing chooses their modes.

        Args:
            what: What does not.
            by_method: Whether it does by other methods.

        Raises:
            SymofrosError: There are some.
        """
        if self.rigid_contacts:
            found = f"contact of '{self.rigid_contacts[0].name}' is rigid"
            method = "rodas4 or implicit_euler, which are implicit, dopri5 or rk4; or " if by_method else ""
            remedy = f"{method}a compliant contact: stiffness in place of restitution"
            raise _no_modes(f"{what}: rigid contact", found, f"{_CHOOSE}, by explicit and Rosenbrock methods", remedy)

    def refuse_actions(self, what: str) -> None:
        """Refuse events of the description that change the motion, where nothing looks for them.

        Raises:
            SymofrosError: There are some.
        """
        if acting := [name for name, event in self.events.items() if event.acts or event.terminal]:
            rule, remedy = "runs and steppers look for events", "leave them out: replace(system, events={})"
            raise SymofrosError(f"{what}: events of model '{self.name}'", ", ".join(acting), rule, remedy)

    def refuse_states(self, what: str, remedy: str = "leave out LuGre, Hysteresis, bristles, ForceState") -> None:
        """Refuse states of forces where nothing takes them; a remedy may be `model.carried`.

        Raises:
            SymofrosError: There are some.
        """
        if self.state_names:
            found, rule = ", ".join(self.state_names[:8]), f"{what} is of coordinates and speeds alone"
            title = f"model '{self.name}' has states of forces: {what} takes none"
            raise SymofrosError(title, found, rule, remedy)

    def sampling_bounds(self) -> list[tuple[float, float]]:
        """Finite bounds a coordinate: its own, one turn for an angle, one unit otherwise."""
        bounds = []
        for low, high, periodic in zip(self.q_lower, self.q_upper, self.periodic, strict=True):
            reach = math.pi if periodic else 1.0
            if math.isinf(low) and math.isinf(high):
                low, high = -reach, reach
            elif math.isinf(low):
                low = high - 2 * reach
            elif math.isinf(high):
                high = low + 2 * reach
            bounds.append((low, high))
        return bounds


def _no_modes(what: str, found: str, choose: str, remedy: str) -> SymofrosError:
    """Joints with modes, where nothing chooses them."""
    return SymofrosError(what, found, f"it has modes: {choose}", remedy)
