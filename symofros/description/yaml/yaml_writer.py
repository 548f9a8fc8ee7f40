"""The native file out: a System as YAML that reads back as the same system."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import fields
from io import StringIO
from typing import Any

from pydantic import ValidationError
from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq

from symofros.description.beam import Beam, BeamLoad, Samples, UserShape
from symofros.description.constraints import AXES, Closure, KnifeEdge, Nonholonomic, Rod, Rolling
from symofros.description.forces import Anchor, Connection, JointElement, Load, Rotor
from symofros.description.frames import Frame
from symofros.description.joint import WORLD, Joint, Limits
from symofros.description.system import Body, Inertia, Parameter, System
from symofros.description.values import ORIGIN, Rotation, Value
from symofros.description.yaml.faults import problem_of
from symofros.description.yaml.schema import VERSION, NativeFile, default_joint_name
from symofros.errors import DescriptionError, Problem

LINE_WIDTH = 120

# Below this, a whole number reads better without ".0" and is the same double.
_WHOLE = 1e15

# Mappings that stay on lines of their own; any other is short and reads better in braces.
_OPEN = frozenset(
    {
        "",
        "system",
        "parameters",
        "inputs",
        "bodies",
        "body",
        "joint",
        "inertia",
        "beam",
        "frames",
        "connections",
        "closures",
        "nonholonomic",
        "virtual_power",
        "potentials",
    }
)

Plain = dict[str, Any]


def write_yaml(system: System) -> str:
    """The text of the native file; `read_yaml` gives an equal system from it.

    Args:
        system: What to write. Fields at their defaults are left out; numbers are exact.

    Raises:
        DescriptionError: The format can't hold it: two things of one name, or a formula that is too long.
    """
    problems = list(_duplicates(system))
    if problems:
        raise DescriptionError(problems)
    document = _document(system)
    try:
        NativeFile.model_validate(document)
    except ValidationError as error:
        raise DescriptionError([problem_of(fault, "") for fault in error.errors(include_url=False)]) from None
    stream = StringIO()
    yaml = YAML()
    yaml.width = LINE_WIDTH
    yaml.dump(_styled(document, ""), stream)
    return stream.getvalue()


def _duplicates(system: System) -> Iterator[Problem]:
    groups = [("parameter", [item.name for item in system.parameters])]
    groups += [("input", [item.name for item in system.inputs]), ("body", [item.name for item in system.bodies])]
    groups += [(f"body '{body.name}': frame", [frame.name for frame in body.frames]) for body in system.bodies]
    for kind, names in groups:
        for name, count in Counter(names).items():
            if count > 1:
                yield Problem(
                    f"{kind} '{name}' can't be written",
                    f"{count} of that name",
                    "names are the keys of a mapping in the file",
                    "rename all but one",
                )


def _document(system: System) -> Plain:
    head: Plain = {"name": system.name}
    if system.gravity != System("").gravity:
        head["gravity"] = _list(system.gravity)
    document: Plain = {"symofros": VERSION, "system": head}
    document["parameters"] = {item.name: _parameter(item) for item in system.parameters}
    document["inputs"] = {item.name: _texts(item) for item in system.inputs}
    document["bodies"] = {item.name: _body(item) for item in system.bodies}
    document["connections"] = {item.name: _connection(item) for item in system.connections}
    document["virtual_power"] = {
        item.name: {speed: _number(force) for speed, force in item.forces} for item in system.virtual_power
    }
    document["potentials"] = {item.name: _number(item.energy) for item in system.potentials}
    holonomic = (Closure, Rod)
    document["closures"] = {item.name: _closure(item) for item in system.constraints if isinstance(item, holonomic)}
    document["nonholonomic"] = {
        item.name: _condition(item) for item in system.constraints if not isinstance(item, holonomic)
    }
    return {section: entries for section, entries in document.items() if entries}


def _texts(item: Any) -> Plain:
    return {key: text for key in ("unit", "description") if (text := getattr(item, key))}


def _parameter(parameter: Parameter) -> Plain:
    constant = {"constant": True} if parameter.constant else {}
    return {"value": _number(float(parameter.value)), **constant, **_texts(parameter)}


def _body(body: Body) -> Plain:
    entries: Plain = {}
    if body.joint is not None:
        entries["joint"] = _joint(body.joint, body.name)
    if body.inertia is not None:
        entries["inertia"] = _inertia(body.inertia)
    if isinstance(body, Beam):
        entries["beam"] = _beam(body)
    if body.frames != (() if not isinstance(body, Beam) else (Frame("tip"),)):
        entries["frames"] = {frame.name: _placement(frame) for frame in body.frames}
    if body.waive:
        entries["waive"] = [*body.waive]
    if body.loads and not isinstance(body, Beam):
        entries["loads"] = [_changed(load, Load()) for load in body.loads]
    return entries


def _beam(beam: Beam) -> Plain:
    required = {"length": _number(beam.length), "rhoA": _number(beam.rhoA)}
    plain = Beam("", beam.joint, 0.0, 0.0)
    entries = required | _changed(beam, plain, "name", "joint", "length", "rhoA", "frames", "loads", "waive", "shapes")
    if beam.shapes:
        entries["shapes"] = {direction: [_shape(shape) for shape in given] for direction, given in beam.shapes}
    if beam.loads:
        entries["loads"] = [_changed(load, BeamLoad()) for load in beam.loads]
    return entries


def _shape(shape: UserShape) -> Any:
    return {"xi": [*shape.xi], "values": [*shape.values]} if isinstance(shape, Samples) else _number(shape)


def _anchor(anchor: Anchor) -> Plain:
    body, frame = anchor
    return {"body": body} | ({"frame": frame} if frame is not None else {})


def _closure(item: Closure | Rod) -> Plain:
    ends = {"first": _anchor(item.first), "second": _anchor(item.second)}
    if isinstance(item, Rod):
        return {**ends, "length": _number(item.length)}
    translations = {} if item.translations == AXES else {"translations": [*item.translations]}
    return {**ends, **translations, **({"rotations": [*item.rotations]} if item.rotations else {})}


def _condition(item: KnifeEdge | Rolling | Nonholonomic) -> Plain:
    if isinstance(item, Nonholonomic):
        right = {"right": _number(item.right)} if item.right != 0.0 else {}
        return {"coefficients": {speed: _number(value) for speed, value in item.coefficients}, **right}
    if isinstance(item, KnifeEdge):
        return {"knife_edge": _anchor(item.anchor) | ({"axis": item.axis} if item.axis != "y" else {})}
    plain = Rolling("", item.anchor, 0.0)
    return {
        "rolling": _anchor(item.anchor)
        | {"radius": _number(item.radius)}
        | _changed(item, plain, "name", "anchor", "radius")
    }


def _connection(connection: Connection) -> Plain:
    ends = {"first": _anchor(connection.first), "second": _anchor(connection.second)}
    numbers = {key: getattr(connection, key) for key in ("stiffness", "length", "damping")}
    return {**ends, **{key: _number(value) for key, value in numbers.items() if value != 0.0}}


def _element(element: JointElement) -> Plain:
    """An element under its kind's name; what has no default is always written."""
    kind = type(element).__name__.lower()
    first = fields(element)[0].name
    default = type(element)(0.0)
    return {kind: {first: _number(getattr(element, first)), **_changed(element, default, first)}}


def _changed(stated: Any, default: Any, *without: str) -> Plain:
    """The fields of a dataclass that differ from a default one's."""
    entries: Plain = {}
    for item in fields(stated):
        value = getattr(stated, item.name)
        if item.name not in without and value != getattr(default, item.name):
            entries[item.name] = _plain(value)
    return entries


def _plain(value: Any) -> Any:
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    return value if isinstance(value, (str, int)) else _number(value)


def _joint(joint: Joint, body: str) -> Plain:
    entries: Plain = {} if joint.name == default_joint_name(body) else {"name": joint.name}
    entries["kind"] = joint.kind
    if joint.parent != WORLD:
        entries["parent"] = joint.parent
    if joint.frame is not None:
        entries["frame"] = joint.frame
    entries |= _placement(joint)
    if joint.axis != Joint("").axis:
        entries["axis"] = _list(joint.axis)
    if joint.actuated:
        entries["actuated"] = True
    if joint.effort:
        entries["effort"] = _list(joint.effort)
    if joint.limits is not None:
        entries["limits"] = _limits(joint.limits)
    plain = Joint("")
    for key in ("axis2", "moving_position"):
        if getattr(joint, key) != getattr(plain, key):
            entries[key] = _list(getattr(joint, key))
    for key in ("pitch", "armature"):
        if getattr(joint, key) != 0.0:
            entries[key] = _number(getattr(joint, key))
    if joint.coordinates:
        entries["coordinates"] = [*joint.coordinates]
    if not joint.moving_rotation.is_identity:
        entries["moving_rotation"] = _rotation(joint.moving_rotation)
    if joint.prescribed:
        entries["prescribed"] = True
    if joint.elements:
        entries["elements"] = [_element(element) for element in joint.elements]
    if joint.rotors:
        entries["rotors"] = [
            {"inertia": _number(rotor.inertia), **_changed(rotor, Rotor(0.0), "inertia")} for rotor in joint.rotors
        ]
    return entries


def _placement(placed: Joint | Frame) -> Plain:
    entries: Plain = {}
    if placed.position != ORIGIN:
        entries["position"] = _list(placed.position)
    if not placed.rotation.is_identity:
        entries["rotation"] = _rotation(placed.rotation)
    return entries


def _limits(limits: Limits) -> Plain:
    bounds = {"lower": limits.lower, "upper": limits.upper, "velocity": limits.velocity, "effort": limits.effort}
    return {name: _number(float(bound)) for name, bound in bounds.items() if bound is not None}


def _inertia(inertia: Inertia) -> Plain:
    entries: Plain = {"mass": _number(inertia.mass)}
    if inertia.center_of_mass != ORIGIN:
        entries["center_of_mass"] = _list(inertia.center_of_mass)
    moments = inertia.moments if any(inertia.moments[3:]) else inertia.moments[:3]
    if any(moments):
        entries["moments"] = _list(moments)
    if inertia.about != "center_of_mass":
        entries["about"] = inertia.about
    if not inertia.rotation.is_identity:
        entries["rotation"] = _rotation(inertia.rotation)
    return entries


def _rotation(rotation: Rotation) -> Plain:
    values = _list(rotation.values)
    return {rotation.kind: [values[:3], values[3:6], values[6:]] if rotation.kind == "matrix" else values}


def _list(values: Iterable[Value]) -> list[Any]:
    return [_number(value) for value in values]


def _number(value: Value) -> Any:
    """A number in its shortest exact form, a formula as text."""
    if not isinstance(value, float):
        return str(value)
    whole = abs(value) < _WHOLE and value.is_integer() and str(value) != "-0.0"
    return int(value) if whole else value


def _styled(value: Any, role: str) -> Any:
    """The same data with its layout: sections, bodies and their parts on lines, small things in braces."""
    if isinstance(value, list):
        sequence = CommentedSeq(_styled(item, "item") for item in value)
        sequence.fa.set_flow_style()
        return sequence
    if not isinstance(value, dict):
        return value
    mapping = CommentedMap((key, _styled(item, _role(key, role))) for key, item in value.items())
    if role not in _OPEN or not value:
        mapping.fa.set_flow_style()
    return mapping


def _role(key: str, owner: str) -> str:
    """What an entry is to the layout; names of things are not keys of the format."""
    if owner == "bodies":
        return "body"
    return key if owner in ("", "body") else "item"
