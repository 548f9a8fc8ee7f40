"""The nouns of a description: System, RigidBody, Joint, Frame, Inertia, Parameter, Input. No computation.

Each is a frozen dataclass; numbers may be floats, formulas ("L1/2") or SymPy expressions. That a description makes
sense as a whole (names exist, the tree is connected, inertias are physical) is checked by `topology`, all at once.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any, Literal

from symofros.base.arguments import entries_of, shown
from symofros.description.beams.beam import Beam
from symofros.description.beams.segments import SegmentAnchors, segment_names, segments_of
from symofros.description.constraints import Constraint, Switch, section_order
from symofros.description.contacts import Contact
from symofros.description.entries import refuses_unknown_entries, shown_entries
from symofros.description.events import as_events
from symofros.description.forces import Connection, ForceState, Load, Potential, VirtualPower
from symofros.description.frames import Frame
from symofros.description.joints.joint import Joint
from symofros.description.values import IDENTITY, ORIGIN, Rotation, Value, Vector, as_value, as_vector
from symofros.description.visual import Visual
from symofros.errors import DescriptionError, did_you_mean

# The checks a body may waive, each with what it lets pass.
WAIVERS: dict[str, str] = {
    "nonphysical_inertia": "an inertia that no distribution of mass can have",
    "massless_tip": "a joint that moves no mass, so that the mass matrix is singular",
}


@refuses_unknown_entries
@dataclass(frozen=True)
class Parameter:
    """A named number: given at run time, or hard-coded in the C code if constant.

    Attributes:
        name: Identifier, used in formulas.
        value: Value, the default one of a run-time parameter.
        unit: Unit, such as "kg m^2", shown to people.
        constant: Whether the value is hard-coded in the C code rather than given at run time.
        description: Text for people.
    """

    name: str
    value: float
    unit: str = ""
    constant: bool = False
    description: str = ""


@refuses_unknown_entries
@dataclass(frozen=True)
class Input:
    """A named input u, used in formulas of efforts and forces.

    Attributes:
        name: Identifier, used in formulas.
        unit: Unit, such as "N m", shown to people.
        description: Text for people.
    """

    name: str
    unit: str = ""
    description: str = ""


@refuses_unknown_entries
@dataclass(frozen=True)
class Inertia:
    """Mass, mass centre and inertia matrix of a rigid body.

    Attributes:
        mass: Mass [kg].
        center_of_mass: Position p_BC of the mass centre in the body frame [m].
        moments: Ixx, Iyy, Izz and, if not zero, Ixy, Ixz, Iyz [kg m^2]; products with the sign they have in the matrix.
        about: Reference point: "center_of_mass", along the axes of frame C; or "body", about Bo along the axes of B.
        rotation: Rotation R_BC from the body frame to the axes of the moments; only about the center_of_mass.
    """

    mass: Value = 0.0
    center_of_mass: Vector = ORIGIN
    moments: tuple[Value, ...] = (0.0,) * 6
    about: Literal["center_of_mass", "body"] = "center_of_mass"
    rotation: Rotation = IDENTITY

    def __post_init__(self) -> None:
        """Convert numbers and check the choice of reference point."""
        object.__setattr__(self, "mass", as_value(self.mass, "mass"))
        object.__setattr__(self, "center_of_mass", as_vector(self.center_of_mass, "center_of_mass"))
        listed = entries_of(self.moments) or []
        moments = tuple(as_value(value, f"inertia[{i}]") for i, value in enumerate(listed))
        if len(moments) == 3:
            moments = (*moments, 0.0, 0.0, 0.0)
        if len(moments) != 6:
            raise DescriptionError(
                "inertia: wrong number of entries",
                f"{len(moments)} entries" if listed else shown(self.moments),
                "three (Ixx, Iyy, Izz) or six (then Ixy, Ixz, Iyz)",
                "give three, or all six, zeros included",
            )
        object.__setattr__(self, "moments", moments)
        if self.about not in ("center_of_mass", "body"):
            raise DescriptionError(
                f"inertia: about '{self.about}'", self.about, "about is 'center_of_mass' or 'body'", "choose one"
            )
        if self.about == "body" and not self.rotation.is_identity:
            raise DescriptionError(
                "inertia: a rotation is given with about='body'",
                f"rotation {self.rotation.kind}",
                "an inertia about the body origin is along the body's axes",
                "drop the rotation, or give the inertia about the center_of_mass",
            )


@refuses_unknown_entries
@dataclass(frozen=True)
class RigidBody:
    """A rigid body with the joint that carries it. Without a joint it is the base, and its frame is the world frame.

    Attributes:
        name: Unique; also the name of its body frame.
        joint: Joint between the body and its parent; None for the base.
        inertia: Inertia; None for a massless body.
        frames: Extremity frames.
        loads: Forces and torques on it.
        waive: Names of checks this body is allowed to fail (see WAIVERS).
    """

    name: str
    joint: Joint | None = None
    inertia: Inertia | None = None
    frames: tuple[Frame, ...] = ()
    waive: tuple[str, ...] = ()
    loads: tuple[Load, ...] = ()

    def __post_init__(self) -> None:
        """Freeze the collections and check the waivers."""
        object.__setattr__(self, "frames", tuple(self.frames))
        for frame in self.frames:
            if frame.at is not None:
                raise DescriptionError(
                    f"body '{self.name}': frame '{frame.name}' at a station",
                    f"at {frame.at!r}",
                    "beams alone have stations: a rigid body's frame is placed by its position",
                    "state the position instead",
                )
        object.__setattr__(self, "loads", tuple(self.loads))
        object.__setattr__(self, "waive", tuple(sorted(set(self.waive))))
        for unknown in sorted(set(self.waive) - WAIVERS.keys()):
            raise DescriptionError(
                f"body '{self.name}': unknown waiver",
                f"'{unknown}'",
                f"one of {', '.join(WAIVERS)}",
                did_you_mean(unknown, WAIVERS),
            )


Body = RigidBody | Beam


@refuses_unknown_entries
@dataclass(frozen=True)
class System:
    """A mechanism as the user stated it.

    Attributes:
        name: Name of the model, from which C functions take theirs.
        bodies: Bodies in the order of description; a beam in segments becomes the beams that it stands for.
        parameters: Run-time parameters and constants.
        inputs: Named inputs, in order; actuated joints add theirs after these.
        gravity: Acceleration of gravity in the world frame [m/s^2].
        connections: Springs and dampers between frames, and compliant contacts.
        virtual_power: Internal forces by their virtual power.
        potentials: Potential energies by formula.
        constraints: Closures of loops, rods and couplings; after them, conditions on speeds.
        notes: Remarks of an importer on what it ignored or changed.
        origin: "file:line" of objects, keyed by ("body", name), ("joint", name), …; not part of equality.
        visuals: Body -> how it looks, as an importer read it; not part of equality, nor of what is compiled.
        switches: Constraints that can be released and engaged while a mechanism moves.
        states: States of forces.
        events: Name -> formula or Event: what runs of the model look for, and do there. Who runs it may add others, or
            replace them by name. They count in equality, but no code that is compiled depends on them.
    """

    name: str
    bodies: tuple[Body, ...] = ()
    parameters: tuple[Parameter, ...] = ()
    inputs: tuple[Input, ...] = ()
    gravity: Vector = (0.0, 0.0, -9.81)
    connections: tuple[Connection | Contact, ...] = ()
    virtual_power: tuple[VirtualPower, ...] = ()
    potentials: tuple[Potential, ...] = ()
    constraints: tuple[Constraint, ...] = ()
    notes: tuple[str, ...] = field(default=(), compare=False, repr=False)
    origin: Mapping[tuple[str, ...], str] = field(default_factory=dict, compare=False, repr=False)
    visuals: Mapping[str, tuple[Visual, ...]] = field(default_factory=dict, compare=False, repr=False)
    switches: tuple[Switch, ...] = ()
    states: tuple[ForceState, ...] = ()
    events: Mapping[str, Any] = field(default_factory=dict, hash=False, repr=False)

    def __post_init__(self) -> None:
        """Freeze the collections and convert the gravity."""
        for name in (
            "bodies",
            "parameters",
            "inputs",
            "connections",
            "virtual_power",
            "potentials",
            "constraints",
            "notes",
            "switches",
            "states",
        ):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        if any(body.segments > 1 for body in self.beams):
            self._divide_beams()
        # What binds coordinates comes first, and contacts after connections, as they do in files.
        springs_first = sorted(self.connections, key=lambda item: isinstance(item, Contact))
        object.__setattr__(self, "connections", tuple(springs_first))
        ordered = sorted(self.constraints, key=section_order)
        object.__setattr__(self, "constraints", tuple(ordered))
        object.__setattr__(self, "gravity", as_vector(self.gravity, f"system '{self.name}': gravity"))
        object.__setattr__(self, "origin", MappingProxyType(dict(self.origin)))
        object.__setattr__(self, "visuals", MappingProxyType(dict(self.visuals)))
        object.__setattr__(self, "events", MappingProxyType(as_events(self.events)))

    @property
    def beams(self) -> tuple[Beam, ...]:
        """The bodies that are beams, in their order."""
        return tuple(body for body in self.bodies if isinstance(body, Beam))

    @property
    def springs(self) -> tuple[Connection, ...]:
        """The connections that are springs and dampers, in their order."""
        return tuple(item for item in self.connections if isinstance(item, Connection))

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """The connections that are compliant contacts, in their order."""
        return tuple(item for item in self.connections if isinstance(item, Contact))

    def _divide_beams(self) -> None:
        """Put the segments of beams in their places, and what is fixed to a beam's tip on the last of them."""
        divided = [body for body in self.beams if body.segments > 1]
        anchors, bodies, origin = SegmentAnchors(divided), list[Body](), dict(self.origin)
        for body in self.bodies:
            placed = body if body.joint is None else replace(body, joint=anchors.joint(body.joint))
            if isinstance(placed, Beam) and placed.segments > 1:
                bodies += segments_of(placed)
                origin |= {("body", name): origin.get(("body", body.name), "") for name in segment_names(placed)}
            else:
                bodies.append(placed)
        object.__setattr__(self, "bodies", tuple(bodies))
        object.__setattr__(self, "origin", origin)
        for label in ("connections", "constraints"):
            object.__setattr__(self, label, tuple(map(anchors.anchored, getattr(self, label))))

    def __reduce__(self) -> Any:
        """Pickle without the read-only views, which can't be pickled."""
        return System, (
            self.name,
            self.bodies,
            self.parameters,
            self.inputs,
            self.gravity,
            self.connections,
            self.virtual_power,
            self.potentials,
            self.constraints,
            self.notes,
            dict(self.origin),
            dict(self.visuals),
            self.switches,
            self.states,
            dict(self.events),
        )

    def __repr__(self) -> str:
        """Each field that counts, as hashes of descriptions are made of this text; what came later if there is some."""
        return shown_entries(self, [name for name in ("switches", "states") if not getattr(self, name)])

    def body(self, name: str) -> Body:
        """The body of that name.

        Raises:
            DescriptionError: There is none.
        """
        for body in self.bodies:
            if body.name == name:
                return body
        raise DescriptionError(
            f"system '{self.name}': no body '{name}'",
            ", ".join(b.name for b in self.bodies),
            "a body is found by its name",
            did_you_mean(name, [b.name for b in self.bodies]),
        )

    def with_bodies(self, *bodies: Body) -> System:
        """The system with these bodies added; a body of the same name is replaced in its place."""
        merged = {body.name: body for body in self.bodies} | {body.name: body for body in bodies}
        return replace(self, bodies=tuple(merged.values()))

    def without_bodies(self, *names: str) -> System:
        """The system without these bodies.

        Raises:
            DescriptionError: There is no such body.
        """
        for name in names:
            self.body(name)
        return replace(self, bodies=tuple(body for body in self.bodies if body.name not in names))

    def parameter_values(self) -> dict[str, float]:
        """Name -> value of every parameter, constants included."""
        return {parameter.name: parameter.value for parameter in self.parameters}
