"""All problems of a description, collected and reported together."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from itertools import chain
from weakref import WeakValueDictionary

import numpy as np

from symofros.base.names import TIME, symbol_of
from symofros.description.beams.beam import STATION, Beam, BeamLoad
from symofros.description.forces import Connection, Load
from symofros.description.joints.joint import WORLD, Joint
from symofros.description.system import Body, RigidBody, System
from symofros.errors import Argument, DescriptionError, Problem, did_you_mean, first_of
from symofros.expr.expression import CONSTANTS
from symofros.mechanics.topology.beams import beam_conditions, beam_number_problems, beam_problems
from symofros.mechanics.topology.conditions import violations
from symofros.mechanics.topology.constraints import (
    anchor_problems,
    constraint_conditions,
    constraint_problems,
    same_body_problems,
)
from symofros.mechanics.topology.coordinates import coordinate_symbols, rate_symbols, speed_symbols, state_names
from symofros.mechanics.topology.forces import contact_conditions, element_conditions
from symofros.mechanics.topology.formulas import formula_problems, power_problems
from symofros.mechanics.topology.frames import derived_name_problems, frame_remedy, frames_of
from symofros.mechanics.topology.joints import joint_number_problems, joint_problems
from symofros.mechanics.topology.numbers import Numbers
from symofros.mechanics.topology.physics import inertia_problems, massless_tip_conditions
from symofros.mechanics.topology.rigid_contacts import rigid_contact_problems
from symofros.mechanics.topology.run_time import rotations_of, value_conditions
from symofros.mechanics.topology.switches import switch_conditions, switch_problems

# Systems in which no problem was found, by identity: nothing in a system can change, and `replace` makes another one.
_sound: WeakValueDictionary[int, System] = WeakValueDictionary()
_MAX_NAME = 200
_FLOATING = Argument("floating_base")
_SHOWN = 12  # Names listed in a message.


def check(system: System) -> None:
    """Refuse a system that can't be a mechanism.

    Raises:
        DescriptionError: With every problem found.
    """
    problems = description_problems(system)
    if problems:
        raise DescriptionError(problems)


def description_problems(system: System, broken: Collection[str] = ()) -> list[Problem]:
    """Every problem of a description but those of its events.

    Args:
        system: The system as described.
        broken: Names of bodies, parameters and inputs that exist but could not be read; that something refers to
            them is not reported again.

    Returns:
        The problems; a system that has none is looked at once.
    """
    if _sound.get(id(system)) is system:
        return []
    problems = _collect_problems(system, frozenset(broken))
    if not problems and not broken:
        _sound[id(system)] = system
    return problems


def name_problems(system: System) -> list[Problem]:
    """Names that no file holds: of a newline or other characters that can't be printed, empty, or too long."""
    return first_of(_Checker(system, frozenset()).unusable_names())


@np.errstate(all="ignore")  # Numbers that overflow are found as numbers that are not finite.
def _collect_problems(system: System, broken: frozenset[str]) -> list[Problem]:
    checker = _Checker(system, broken)
    formulas = formula_problems(system, checker.broken)
    problems = first_of(chain(checker.names(), checker.structure(), checker.acting(), formulas))
    if not problems and not broken:
        numbers = Numbers(system)
        problems = first_of(checker.values(numbers))
        if not problems:
            problems = first_of(
                chain(inertia_problems(system, numbers), violations(massless_tip_conditions(system), numbers))
            )
    elif not any("cycle" in p.what for p in problems):
        # Physics of single bodies can be judged even where the tree can't.
        problems += first_of(inertia_problems(system, Numbers(system)))
    # Two joints of one name, for instance, have the same fault in the same place.
    return list(dict.fromkeys(problems))


def listed(names: Sequence[str]) -> str:
    """The first few names, each in quotes."""
    return ", ".join(f"'{name}'" for name in names[:_SHOWN]) + (", …" if len(names) > _SHOWN else "")


class _Checker:
    def __init__(self, system: System, broken: frozenset[str]) -> None:
        self.system = system
        self.broken = broken
        self.bodies = {body.name: body for body in system.bodies}
        self.joints = [body.joint for body in system.bodies if body.joint is not None]
        bases = [body for body in system.bodies if body.joint is None]
        self.base: Body = bases[0] if bases else RigidBody(WORLD)
        self.extra_bases = bases[1:]

    def where(self, *key: str) -> str:
        return self.system.origin.get(key, "")

    # Names.

    def names(self) -> Iterator[Problem]:
        yield from self._unique("body", [body.name for body in self.system.bodies])
        yield from self._joints_unique()
        for body in self.system.bodies:
            yield from self._unique("frame", [frame.name for frame in body.frames], body.name)
            if body.name == WORLD and body.joint is not None:
                yield Problem(
                    f"body '{WORLD}' has a joint",
                    f"joint '{body.joint.name}'",
                    f"'{WORLD}' is the ground's own name",
                    "choose another name",
                    self.where("body", WORLD),
                )
        yield from derived_name_problems(self.system)
        yield from self._symbols_unique()
        yield from self.unusable_names()

    def unusable_names(self) -> Iterator[Problem]:
        """Names that no file holds and no message shows."""
        for kind, name in self._all_names():
            if not name or len(name) > _MAX_NAME or not name.isprintable():
                yield Problem(
                    f"{kind} with an unusable name",
                    f"{name!r:.60}",
                    f"1 to {_MAX_NAME} printable characters",
                    "rename it",
                    self.where(kind, name),
                )

    def _all_names(self) -> Iterator[tuple[str, str]]:
        yield "system", self.system.name
        yield from (("parameter", item.name) for item in self.system.parameters)
        yield from (("input", item.name) for item in self.system.inputs)
        yield from (("state", item.name) for item in self.system.states)
        yield from (("event", name) for name in self.system.events)
        for body in self.system.bodies:
            yield "body", body.name
            for frame in body.frames:
                yield "frame", frame.name
        for joint in self.joints:
            yield "joint", joint.name
            yield from (("coordinate", name) for name in joint.coordinates)

    def _joints_unique(self) -> Iterator[Problem]:
        bodies: dict[str, list[str]] = {}
        for body in self.system.bodies:
            if body.joint is not None:
                bodies.setdefault(body.joint.name, []).append(body.name)
        for name, owners in bodies.items():
            if len(owners) > 1:
                yield Problem(
                    f"joint '{name}' appears {len(owners)} times",
                    f"it carries bodies {listed(owners)}",
                    "names of joints are unique",
                    "rename all but one",
                    self.where("joint", name),
                )

    def _unique(self, kind: str, names: list[str], owner: str = "") -> Iterator[Problem]:
        on = f" on body '{owner}'" if owner else ""
        for name, count in Counter(names).items():
            if count > 1:
                yield Problem(
                    f"{kind} '{name}' appears {count} times{on}",
                    f"{count} of them",
                    f"names of {kind}s are unique{on}",
                    "rename all but one",
                    self.where(kind, *([owner] if owner else []), name),
                )

    def _symbols_unique(self) -> Iterator[Problem]:
        """Parameters, inputs, coordinates and speeds share the name space of formulas."""
        taken: dict[str, str] = {TIME: "the time", **dict.fromkeys(CONSTANTS, "a constant")}
        if self.system.beams:
            taken[STATION] = "the station along a beam"
        # Inputs and joints of files may be called t or pi; a parameter is its author's own, and has no other symbol.
        stated = [("parameter", item.name, item.name) for item in self.system.parameters]
        stated += [("input", item.name, symbol_of(item.name)) for item in self.system.inputs]
        stated += [("state", item.name, symbol_of(item.name)) for item in self.system.states]
        stated += [("state", name, symbol_of(name)) for joint in self.joints for name in state_names(joint)]
        balls = (names for contact in self.system.contacts for names in contact.state_names)
        stated += [("state", name, symbol_of(name)) for names in balls for name in names]
        for kind, name, symbol in stated:
            if symbol in taken:
                yield Problem(
                    f"{kind} '{name}': the name is taken",
                    f"'{name}' is also {taken[symbol]}",
                    "names that formulas use are unique",
                    "rename one of them",
                    self.where(kind, name),
                )
            taken.setdefault(symbol, "an input" if kind == "input" else f"a {kind}")
        for joint in self.joints:
            yield from self._taken(joint, "coordinate", coordinate_symbols(joint), taken)
        for joint in self.joints:
            rates = speed_symbols(joint) + (rate_symbols(joint) if joint.prescribed else ())
            yield from self._taken(joint, "speed", rates, taken)

    def _taken(self, joint: Joint, role: str, symbols: Sequence[str], taken: dict[str, str]) -> Iterator[Problem]:
        """Problems of a joint's symbols that others have already; the free ones are marked as taken.

        A coordinate door may have the name of the rate of one called oor, which formulas alone could confuse; they are
        refused where they do. Inputs, which rates of prescribed joints are, and their own speeds are listed by names.
        """
        shared = role == "speed" and not joint.prescribed and not joint.traits.quasi_velocities
        for symbol in symbols:
            owner = taken.get(symbol, "")
            if owner and f"joint '{joint.name}'" not in owner and not (shared and " of joint " in owner):
                yield Problem(
                    f"joint '{joint.name}': the name of its {role} is taken",
                    f"'{symbol}' is also {owner}",
                    "names that formulas use are unique",
                    "rename the joint or the other",
                    self.where("joint", joint.name),
                )
            taken.setdefault(symbol, f"a {role} of joint '{joint.name}'")

    # The tree.

    def structure(self) -> Iterator[Problem]:
        if self.extra_bases:
            bases = [body.name for body in [self.base, *self.extra_bases]]
            yield Problem(
                f"two bases: bodies {listed(bases)} have no joint",
                f"{len(bases)} bodies without a joint",
                "one body at most has no joint, and is the base; every other is connected by its joint",
                "give the others a joint (kind: free for one that floats)",
                self.where("body", self.extra_bases[0].name),
            )
        for body in self.system.bodies:
            if body.joint is not None:
                yield from self._joint(body, body.joint)
        yield from self._cycles()
        moving = any(joint.kind != "fixed" for joint in self.joints)
        moving = moving or any(body.modes for body in self.system.beams)
        if not moving and not self.broken:
            yield Problem(
                f"system '{self.system.name}': nothing moves",
                f"{len(self.system.bodies)} bodies, no moving joint",
                "a model has at least one joint that is not fixed",
                f"add a joint; of a URDF, {_FLOATING.call} frees the root",
                argument=_FLOATING,
            )

    def _joint(self, body: Body, joint: Joint) -> Iterator[Problem]:
        where = self.where("joint", joint.name)
        parent = self.base if joint.parent in (WORLD, self.base.name) else self.bodies.get(joint.parent)
        if parent is None:
            if joint.parent not in self.broken:
                yield Problem(
                    f"body '{body.name}' is disconnected: joint '{joint.name}' names a parent that does not exist",
                    f"parent '{joint.parent}'",
                    "a joint's parent is a body of the system, or 'world'",
                    did_you_mean(joint.parent, [WORLD, *self.bodies]),
                    where,
                )
        elif joint.frame is not None and joint.frame not in {frame.name for frame in parent.frames}:
            yield Problem(
                f"joint '{joint.name}': frame '{joint.frame}' is not on body '{parent.name}'",
                frames_of(parent),
                "a joint sits in a named frame of its parent, or in its body frame",
                frame_remedy(self.system.bodies, parent, joint.frame, "parent: ") or "add the frame, or drop the entry",
                where,
            )
        yield from joint_problems(joint, self.bodies, where)
        if isinstance(body, Beam):
            yield from beam_problems(body, self.where("body", body.name))

    def _cycles(self) -> Iterator[Problem]:
        """Follow each body's parents; a body met again on the same walk is on a cycle."""
        done: set[str] = {self.base.name, WORLD}
        for start in self.bodies:
            walk: dict[str, None] = {}  # In order; a list would take square time on a long chain.
            name = start
            while name in self.bodies and name not in done and name not in walk:
                walk[name] = None
                joint = self.bodies[name].joint
                name = joint.parent if joint is not None else WORLD
            if name in walk:
                loop = list(walk)[list(walk).index(name) :]
                shown = [*loop, name] if len(loop) <= _SHOWN else [*loop[:_SHOWN], "…", name]
                joints = [joint.name for body in loop if (joint := self.bodies[body].joint) is not None]
                is_one = len(loop) == 1
                yield Problem(
                    f"body '{name}' carries itself"
                    if is_one
                    else f"cycle of joints: bodies {' -> '.join(shown)} carry each other",
                    f"its joint {listed(joints)}"
                    if is_one
                    else f"{len(loop)} bodies; their joints are {listed(joints)}",
                    "joints form a tree that starts at the base",
                    "give one of these joints a parent that none of the bodies carries, such as 'world'; "
                    "a loop of the mechanism itself is cut at one joint and closed by a closure (sf.Closure)",
                    self.where("body", name),
                )
            done.update(walk)

    # Forces.

    def acting(self) -> Iterator[Problem]:
        """Problems of loads, connections, constraints and powers: references to missing elements, names given twice."""
        for body in self.system.bodies:
            for load in body.loads:
                yield from self._load(body, load)
        for kind, named in (
            ("connection", self.system.connections),
            ("virtual power", self.system.virtual_power),
            ("potential", self.system.potentials),
            ("state", self.system.states),
        ):
            yield from self._unique(kind, [item.name for item in named])
        for connection in self.system.connections:
            kind = "connection" if isinstance(connection, Connection) else "contact"
            where, what = self.where("connection", connection.name), f"{kind} '{connection.name}'"
            anchors = (connection.first, connection.second)
            for anchor in anchors:
                yield from anchor_problems(what, anchor, self.bodies, self.base, self.broken, where)
            # A beam deforms: its frames move against each other, as a bowstring's ends do.
            bends = isinstance(connection, Connection) and isinstance(self.bodies.get(anchors[0][0]), Beam)
            if anchors[0] == anchors[1] or not bends:
                yield from same_body_problems(what, anchors, self.base, where)
        yield from rigid_contact_problems(self.system)
        yield from self._unique("constraint", [item.name for item in self.system.constraints])
        yield from constraint_problems(self.system, self.bodies, self.base, self.broken)
        yield from switch_problems(self.system)
        yield from power_problems(self.system, self.broken)

    def _load(self, body: Body, load: Load | BeamLoad) -> Iterator[Problem]:
        where = self.where("body", body.name)
        if isinstance(body, Beam) or isinstance(load, BeamLoad):
            if isinstance(body, Beam) != isinstance(load, BeamLoad):
                yield Problem(
                    f"body '{body.name}': a {type(load).__name__} on a {type(body).__name__}",
                    type(load).__name__,
                    "a BeamLoad acts on a Beam, a Load on a RigidBody",
                    "use the other kind",
                    where,
                )
            return
        frames = ["body", "center_of_mass", *(frame.name for frame in body.frames)]
        if load.at not in frames:
            yield Problem(
                f"body '{body.name}': load at '{load.at}', which is not on it",
                frames_of(body),
                "a load acts at 'body', 'center_of_mass' or a frame of its body",
                did_you_mean(load.at, frames),
                where,
            )
        if load.at == "center_of_mass" and body.inertia is None:
            yield Problem(
                f"body '{body.name}': load at the mass centre of a massless body",
                "no inertia",
                "a mass centre needs a mass",
                "use at: body",
                where,
            )

    # Numbers.

    def values(self, numbers: Numbers) -> Iterator[Problem]:
        """Problems of numbers: formulas not finite, rotations and axes that are none, values out of their ranges."""
        yield from violations(value_conditions(self.system), numbers)
        for body in self.system.bodies:
            for what, rotation, where in rotations_of(self.system, body):
                yield from numbers.rotation_problems(what, rotation, where)
            if body.joint is not None:
                yield from joint_number_problems(body.joint, numbers, self.where("joint", body.joint.name))
        for beam in self.system.beams:
            where = self.where("body", beam.name)
            sections = list(violations(beam_conditions(beam, where), numbers))
            yield from sections or beam_number_problems(beam, numbers, where)
        others = (constraint_conditions, switch_conditions, element_conditions, contact_conditions)
        yield from violations(chain.from_iterable(of(self.system) for of in others), numbers)
