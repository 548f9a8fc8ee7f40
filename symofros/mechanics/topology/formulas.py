"""Every value of a description with what it may depend on, and the check that it depends on nothing else."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, NamedTuple

from symofros.base.names import RESERVED, TIME, name_of, quoted, symbol_of
from symofros.description.beams.beam import STATION, Beam, BeamLoad
from symofros.description.beams.elastic import MATRIX_ORDER, STRAINS
from symofros.description.beams.shapes import Samples
from symofros.description.constraints import Constraint, Coupling, Nonholonomic, Rod
from symofros.description.contacts import Contact
from symofros.description.entry_units import units_of
from symofros.description.forces import Connection, Friction, Load, Rotor, numbers_of
from symofros.description.frames import Frame
from symofros.description.joints.joint import Joint
from symofros.description.joints.joint_kinds import CONSTANT_ENTRIES
from symofros.description.quoting import two_meanings, unknown_symbol_remedy, without_quotes
from symofros.description.system import Inertia, RigidBody, System
from symofros.description.values import Value, symbols
from symofros.errors import Problem, did_you_mean
from symofros.expr.expression import Expression, spelled
from symofros.mechanics.topology.coordinates import (
    coordinate_symbols,
    joint_units,
    rate_keys,
    rate_symbols,
    speed_keys,
    speed_symbols,
    state_names,
)

# What a formula may use: parameters alone; also coordinates; also t, in conditions on speeds and in energies, in these
# states of forces too; also speeds and inputs; a general joint's own coordinates; parameters and the station x of a
# beam; everything and x; the station xi = x/L alone.
Scope = Literal[
    "parameters", "coordinates", "configuration", "condition", "energy", "motion", "joint", "section", "spread", "shape"
]


class Stated(NamedTuple):
    """A value of the description.

    Attributes:
        what: The object it belongs to, for messages.
        value: The number or formula.
        key: Key in System.origin.
        scope: Names that the value may depend on.
        joint: The joint whose coordinates it may use, with scope "joint".
        units: Units that it may have; none where any will do.
        remedy: What to do in place of what the scope forbids, where that is more than the scope's own remedy.
    """

    what: str
    value: Value
    key: tuple[str, ...]
    scope: Scope = "parameters"
    joint: Joint | None = None
    units: tuple[str, ...] = ()
    remedy: str = ""


# A force along a line, one-sided or with a length that changes, has no noun; formulas have it.
_LINE_BY_FORMULA = (
    "state the force by formula: that of a cable which only pulls and is wound up is T = max(0, k*(d - length)), d the "
    "distance of its ends in terms of coordinates; as a load, (-T*x/d, -T*y/d, -T*z/d) in world axes on a body at "
    "(x, y, z) from the winch, or as virtual power, -T times the derivative of d by a coordinate on its speed"
)


# A length that is given in time has no noun; joints have it.
_GIVEN_LENGTH = (
    "declare a parameter for it; a length that is given in time is a prescribed prismatic joint, between a ball or "
    "universal joint and a closure"
)


def timed_values(system: System) -> tuple[Value, ...]:
    """The values of a description that depend on time."""
    return tuple(stated.value for stated in stated_values(system) if TIME in symbols(stated.value))


def stated_values(system: System) -> Iterator[Stated]:
    """Every value of a description."""
    for value in system.gravity:
        yield Stated(f"system '{system.name}': gravity", value, ("system",), units=units_of(System, "gravity"))
    for body in system.bodies:
        if body.joint is not None:
            yield from _joint_values(body.joint)
        yield from _beam_values(body) if isinstance(body, Beam) else _body_values(body)
    for connection in system.connections:
        yield from _connection_values(connection)
    for power, speed, value in ((one, *force) for one in system.virtual_power for force in one.forces):
        key = ("virtual_power", power.name)
        yield Stated(f"virtual power '{power.name}': force on {speed}", value, key, "motion")
    for constraint in system.constraints:
        yield from _constraint_values(constraint)
    for switch in system.switches:
        yield Stated(f"switch of '{switch.constraint}': engaged", switch.engaged, ("switch", switch.constraint))
    for potential in system.potentials:
        key = ("potential", potential.name)
        yield Stated(f"potential '{potential.name}'", potential.energy, key, "energy")
    for state in system.states:
        yield Stated(f"state '{state.name}': rate", state.rate, ("state", state.name), "motion")


def _connection_values(connection: Connection | Contact) -> Iterator[Stated]:
    if isinstance(connection, Contact):
        values, remedy = [*connection.values()], ""
    else:
        values = [(label, getattr(connection, label)) for label in ("stiffness", "length", "damping")]
        remedy = _LINE_BY_FORMULA
    what, key = f"{type(connection).__name__.lower()} '{connection.name}'", ("connection", connection.name)
    for label, value in values:
        yield Stated(f"{what}: {label}", value, key, units=units_of(type(connection), label), remedy=remedy)


def _constraint_values(constraint: Constraint) -> Iterator[Stated]:
    what, key = f"constraint '{constraint.name}'", ("constraint", constraint.name)
    for label in ("length", "radius", "height"):
        if hasattr(constraint, label):
            units, remedy = units_of(type(constraint), label), _GIVEN_LENGTH if isinstance(constraint, Rod) else ""
            yield Stated(f"{what}: {label}", getattr(constraint, label), key, units=units, remedy=remedy)
    if isinstance(constraint, Coupling):
        yield Stated(what, constraint.residual, key, "coordinates")
    if isinstance(constraint, Nonholonomic):
        for speed, value in constraint.coefficients:
            yield Stated(f"{what}: coefficient of {speed}", value, key, "condition")
        yield Stated(f"{what}: right", constraint.right, key, "condition")


def _joint_values(joint: Joint) -> Iterator[Stated]:
    what, key = f"joint '{joint.name}'", ("joint", joint.name)
    for entry in ("position", "rotation", *CONSTANT_ENTRIES, "armature"):
        stated = getattr(joint, entry)
        units = _of_coordinate(joint, 0, units_of(Joint, entry))
        for value in (stated,) if isinstance(stated, Value) else stated:
            yield Stated(f"{what}: {entry}", value, key, units=units)
    for element in joint.elements:
        label = type(element).__name__.lower()
        for name, value in numbers_of(element):
            units = _of_coordinate(joint, element.coordinate, units_of(type(element), name))
            scope: Scope = "motion" if isinstance(element, Friction) and name == "factor" else "parameters"
            yield Stated(f"{what}: {label} {name}", value, key, scope, units=units)
    for rotor in joint.rotors:
        yield Stated(f"{what}: rotor", rotor.inertia, key, units=units_of(Rotor, "inertia"))
        for value in (rotor.ratio, *(rotor.axis or ())):
            yield Stated(f"{what}: rotor", value, key)
    for label, values in (("moving_position", joint.moving_position), ("moving_rotation", joint.moving_rotation)):
        for value in values:
            yield Stated(f"{what}: {label}", value, key, "joint", joint, units_of(Joint, label))
    for k, value in enumerate(joint.effort):
        yield Stated(f"{what}: effort", value, key, "motion", units=_of_coordinate(joint, k, units_of(Joint, "effort")))


def _of_coordinate(joint: Joint, number: int, units: tuple[str, ...]) -> tuple[str, ...]:
    """Unit of one coordinate of a joint, selected from a pair of units for rotation and for translation."""
    known = joint_units(joint)
    if len(units) != 2 or not 0 <= number < len(known):
        return units
    return {"rad": units[:1], "m": units[1:]}.get(known[number], units)


def _body_values(body: RigidBody) -> Iterator[Stated]:
    what, key = f"body '{body.name}'", ("body", body.name)
    if body.inertia is not None:
        inertia = body.inertia
        yield Stated(f"{what}: mass", inertia.mass, key, units=units_of(Inertia, "mass"))
        for label, values, units in (
            ("center_of_mass", inertia.center_of_mass, units_of(Inertia, "center_of_mass")),
            ("inertia", inertia.moments, units_of(Inertia, "moments")),
            ("inertia rotation", inertia.rotation, ()),
        ):
            for value in values:
                yield Stated(f"{what}: {label}", value, key, units=units)
    for frame in body.frames:
        for entry in ("position", "rotation"):
            for value in getattr(frame, entry):
                where = ("frame", body.name, frame.name)
                yield Stated(f"frame '{frame.name}' of {what}", value, where, units=units_of(Frame, entry))
    for load in body.loads:
        for entry in ("force", "torque"):
            for value in getattr(load, entry):
                yield Stated(f"{what}: load", value, key, "motion", units=units_of(Load, entry))


def _beam_values(beam: Beam) -> Iterator[Stated]:
    what, key = f"beam '{beam.name}'", ("body", beam.name)
    for label in ("length", "damping"):
        yield Stated(f"{what}: {label}", getattr(beam, label), key, units=units_of(Beam, label))
    for label, value in beam.along_axis():
        yield Stated(f"{what}: {label}", value, key, "section", units=_units_along_axis(label))
    for load in beam.loads:
        for entry in ("force", "torque"):
            for value in getattr(load, entry):
                scope: Scope = "spread" if load.at is None else "motion"
                units = (units_of(BeamLoad, entry)[load.at is None],)
                yield Stated(f"{what}: load", value, key, scope, units=units)
    for direction in STRAINS:
        for shape in beam.user_shapes(direction):
            if not isinstance(shape, Samples):
                yield Stated(f"{what}: shapes of {direction}", shape, key, "shape")


def _units_along_axis(label: str) -> tuple[str, ...]:
    """Unit of a property of a section, an entry of a matrix of stiffness among them."""
    entry, *indices = label.replace("]", "").split("[")
    if entry != "stiffness":
        return units_of(Beam, entry)
    return (("N", "N m", "N m^2")[sum(int(index) >= len(MATRIX_ORDER) // 2 for index in indices)],)


@dataclass(frozen=True)
class _Scopes:
    """The names that exist, by what they are; `both` are those of a coordinate and of another's rate as well."""

    parameters: frozenset[str]
    coordinates: frozenset[str]
    configuration: frozenset[str]
    energy: frozenset[str]
    motion: frozenset[str]
    both: frozenset[str]

    def of(self, stated: Stated) -> frozenset[str]:
        if stated.scope == "joint":
            assert stated.joint is not None
            return self.parameters | frozenset(coordinate_symbols(stated.joint))
        if stated.scope == "section":
            return self.parameters | {STATION}
        if stated.scope == "spread":
            return self.motion | {STATION}
        if stated.scope == "shape":
            return frozenset({"xi"})
        if stated.scope == "condition":
            return self.configuration
        return frozenset(getattr(self, stated.scope))


def _known(system: System) -> _Scopes:
    parameters = frozenset(item.name for item in system.parameters)
    joints = [body.joint for body in system.bodies if body.joint is not None]
    coordinates = frozenset(name for joint in joints for name in coordinate_symbols(joint))
    rates = {name for joint in joints for name in speed_symbols(joint)}
    rates |= {name for joint in joints if joint.prescribed for name in rate_symbols(joint)}
    keys = {name for joint in joints for name in (*speed_keys(joint), *(rate_keys(joint) if joint.prescribed else ()))}
    inputs = {symbol_of(item.name) for item in system.inputs}
    placed = parameters | coordinates
    timed = placed | {TIME}
    states = {symbol_of(state.name) for state in system.states}
    states |= {symbol_of(name) for joint in joints for name in state_names(joint)}
    states |= {symbol_of(name) for contact in system.contacts for names in contact.state_names for name in names}
    motion = timed | inputs | rates | keys | states
    return _Scopes(parameters, placed, timed, timed | states, motion, coordinates & rates)


_RULES: dict[Scope, str] = {
    "parameters": "geometry, inertia, gravity and the constants of forces depend on parameters only",
    "coordinates": "a coupling depends on coordinates and parameters only",
    "configuration": "it depends on coordinates, parameters and t only",
    "energy": "a potential depends on coordinates, states of forces, parameters and t only",
    "condition": "a condition on speeds is linear in them: its coefficients and its right side depend on coordinates, "
    "parameters and t only",
    "motion": "a formula uses names that the description declares",
    "section": "a section property depends on parameters and on the station x only",
    "spread": "a spread load uses names that the description declares, and the station x",
    "shape": "a shape function depends on xi = x/L only",
    "joint": "a joint's own R_PD and p_PD depend on its coordinates and on parameters only",
}


_REMEDIES: dict[Scope, str] = {
    "parameters": "declare a parameter for it; what moves acts through loads, efforts, virtual power and potentials",
    "coordinates": "what binds speeds is a condition on speeds; a motion that is given in time is a prescribed joint",
    "configuration": "",
    "energy": "state forces that depend on speeds or inputs as loads, efforts or virtual power",
    "condition": "state it as the sum of coefficient times speed = right; one that is not linear in speeds, such as a "
    "product of two of them, has no equations of motion by virtual power and can't be stated",
    "motion": "",
    "joint": "name it under the joint's coordinates, or use a parameter",
    "section": "use parameters and x; what moves acts through loads",
    "spread": "",
    "shape": "use xi alone; lengths belong to the beam",
}


def formula_problems(system: System, broken: frozenset[str]) -> Iterator[Problem]:
    """Formulas that use unknown names, names that exist but may not be used there, or that could mean two things."""
    known = _known(system)
    for stated in stated_values(system):
        if not isinstance(stated.value, Expression):
            continue
        allowed = known.of(stated)
        where = system.origin.get(stated.key, "")
        unknown = sorted(symbols(stated.value) - allowed - broken)
        for name in unknown:
            if name in known.motion:
                remedy = stated.remedy or _REMEDIES[stated.scope]
                if symbol_of(name) in allowed:
                    remedy = f"the coordinate of that name is written {symbol_of(name)}"
                rule = _RULES[stated.scope]
                yield Problem(f"{stated.what}: '{name}' may not be used here", f"'{stated.value}'", rule, remedy, where)
            else:
                what, remedy = f"{stated.what}: unknown symbol '{name}'", _declared(name, stated, allowed)
                yield Problem(what, f"'{stated.value}'", _RULES["motion"], remedy, where)
        if not unknown:
            both = known.both if stated.scope in ("motion", "spread") else frozenset[str]()
            yield from meaning_problems(stated.what, stated.value, allowed, both, where)


def _declared(name: str, stated: Stated, allowed: frozenset[str]) -> str:
    """The remedy for an unknown symbol of a description: what was meant, or to declare it."""
    assert isinstance(stated.value, Expression)
    if stated.scope == "shape":
        return _REMEDIES["shape"]
    if name_of(name) in RESERVED and name != name_of(name):
        plain = name_of(name)
        return f"no coordinate is called {plain}; write {plain} without backquotes for what it means in every formula"
    near = unknown_symbol_remedy(name, stated.value.written, allowed) if allowed else ""
    declare = f"declare it under parameters{' or inputs' if stated.scope == 'motion' else ''}: {name}"
    if near.startswith("use one of"):
        return f"{near}; or {declare}"
    return f"{near} Otherwise {declare}" if near.endswith("?") else near or declare


def meaning_problems(
    what: str, formula: Value, allowed: frozenset[str], both: frozenset[str], where: str = ""
) -> Iterator[Problem]:
    """Formulas that can be read in two ways.

    Args:
        what: The object that the formula belongs to.
        formula: The formula; as a text it is judged as it was written.
        allowed: Symbols that it may use.
        both: Symbols that are both a coordinate and the rate of another.
        where: "file:line".
    """
    if not isinstance(formula, Expression):
        return
    for name in without_quotes(formula, both):
        other = name.removeprefix("d")
        yield Problem(
            f"{what}: '{name}' has two meanings",
            f"'{formula.written}'",
            f"'{name}' is the coordinate of that name, and the rate of '{other}'",
            f"write {quoted(name)} for the coordinate, d{quoted(other)} for the rate",
            where,
        )
    meant = two_meanings(formula, allowed)
    if meant is not None:
        symbol, remedy = meant
        rule = f"a name of other signs than letters, digits and _ stands between backquotes: {spelled(symbol)}"
        yield Problem(f"{what}: it could also mean '{symbol}'", f"'{formula.written}'", rule, remedy, where)


def power_problems(system: System, broken: frozenset[str]) -> Iterator[Problem]:
    """Virtual power on speeds that do not exist, or that are prescribed."""
    joints = [body.joint for body in system.bodies if body.joint is not None]
    speeds = {name for joint in joints if not joint.prescribed for name in speed_symbols(joint)}
    for power in system.virtual_power:
        for speed, _ in power.forces:
            if speed not in speeds | broken:
                yield Problem(
                    f"virtual power '{power.name}': '{speed}' is not a speed",
                    ", ".join(sorted(speeds)[:12]),
                    "a force is given for a free speed: d and the coordinate's name",
                    did_you_mean(speed, speeds),
                    system.origin.get(("virtual_power", power.name), ""),
                )


def element_problems(joint: Joint, where: str) -> Iterator[Problem]:
    """Elements and rotors on coordinates that do not exist, or that have no sense for them."""
    speeds = len(speed_symbols(joint))
    for thing in (*joint.elements, *joint.rotors):
        label = type(thing).__name__.lower()
        if not 0 <= thing.coordinate < speeds:
            yield Problem(
                f"joint '{joint.name}': {label} on coordinate {thing.coordinate}",
                f"{speeds} speeds",
                "coordinates of a joint count from 0",
                f"use 0 to {speeds - 1}",
                where,
            )
        elif label in ("spring", "stop") and joint.traits.quasi_velocities:
            yield Problem(
                f"joint '{joint.name}': a {label} on a {joint.kind} joint",
                "quaternion coordinates",
                "springs and stops act on coordinates whose rates are the speeds",
                "use a potential, or a general joint with angles",
                where,
            )
        elif isinstance(thing, Friction) and thing.sticks and joint.traits.quasi_velocities:
            yield Problem(
                f"joint '{joint.name}': friction that sticks on a {joint.kind} joint",
                "speeds that are no rates of coordinates",
                "friction sticks to coordinates whose rates are the speeds",
                "use a general joint with angles, or sticks=False",
                where,
            )
