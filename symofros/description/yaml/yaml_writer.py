"""The native file out: a System as YAML that reads back as the same system."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import fields
from typing import Any

from pydantic import ValidationError
from ruamel.yaml.comments import CommentedMap, CommentedSeq

from symofros.base.events import Event
from symofros.description.beams.beam import Beam
from symofros.description.constraints import (
    AXES,
    Closure,
    Constraint,
    Coupling,
    KnifeEdge,
    Nonholonomic,
    Rod,
    Rolling,
    Touching,
)
from symofros.description.forces import WITH_STATE, Anchor
from symofros.description.frames import Frame
from symofros.description.quoting import text_among
from symofros.description.system import Body, Inertia, System
from symofros.description.values import Rotation, Value
from symofros.description.yaml.derived import NounEntry
from symofros.description.yaml.faults import problem_of
from symofros.description.yaml.fields import AnchorEntry
from symofros.description.yaml.schema import (
    VERSION,
    FrameEntry,
    InertiaEntry,
    InputEntry,
    JointEntry,
    LimitsEntry,
    NativeFile,
    ParameterEntry,
    default_joint_name,
)
from symofros.description.yaml.schema_beam import BeamEntry, BeamLoadEntry, SamplesEntry
from symofros.description.yaml.schema_constraints import KnifeEdgeEntry, RollingEntry, SwitchEntry
from symofros.description.yaml.schema_events import EventEntry
from symofros.description.yaml.schema_forces import (
    ELEMENTS,
    ConnectionEntry,
    ContactEntry,
    LoadEntry,
    RotorEntry,
)
from symofros.description.yaml.yaml_output import key_text, value_text, yaml_text
from symofros.errors import DescriptionError, Problem
from symofros.expr.expression import Expression, needs_quotes

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
        "couplings",
        "nonholonomic",
        "switches",
        "events",
        "virtual_power",
        "potentials",
        "states",
    }
)

Plain = dict[str, Any]

_ENTRIES: dict[type, type[NounEntry]] = {
    entry.noun: entry for entry in (BeamLoadEntry, LimitsEntry, LoadEntry, RotorEntry, SamplesEntry)
}


def write_yaml(system: System) -> str:
    """The text of the native file; `read_yaml` gives an equal system from it.

    Args:
        system: System to write. Fields at their defaults are left out; numbers are exact.

    Raises:
        DescriptionError: The format can't hold it: two things of one name, or a formula that is too long.
    """
    problems = list(_duplicates(system))
    if problems:
        raise DescriptionError(problems)
    document = _spelled(_document(system), *_needing_quotes(system))
    try:
        NativeFile.model_validate(document)
    except ValidationError as error:
        raise DescriptionError([problem_of(fault, "", document) for fault in error.errors(include_url=False)]) from None
    return yaml_text(_styled(document, ""))


def _duplicates(system: System) -> Iterator[Problem]:
    groups = [("parameter", [item.name for item in system.parameters])]
    groups += [("input", [item.name for item in system.inputs]), ("body", [item.name for item in system.bodies])]
    groups += [("connection", [item.name for item in system.connections])]
    groups += [("virtual power", [item.name for item in system.virtual_power])]
    groups += [("potential", [item.name for item in system.potentials])]
    groups += [("state", [item.name for item in system.states])]
    groups += [("constraint", [item.name for item in system.constraints])]
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
        head["gravity"] = _plain(system.gravity)
    document: Plain = {"symofros": VERSION, "system": head}
    document["parameters"] = {item.name: _entry(ParameterEntry, item) for item in system.parameters}
    document["inputs"] = {item.name: _entry(InputEntry, item) for item in system.inputs}
    document["bodies"] = {item.name: _body(item) for item in system.bodies}
    document["connections"] = {item.name: _entry(ConnectionEntry, item) for item in system.springs}
    document["contacts"] = {item.name: _entry(ContactEntry, item) for item in system.contacts}
    document["virtual_power"] = {
        item.name: {speed: _number(force) for speed, force in item.forces} for item in system.virtual_power
    }
    document["potentials"] = {item.name: _number(item.energy) for item in system.potentials}
    document["states"] = {item.name: _number(item.rate) for item in system.states}
    for item in system.constraints:
        section, entry = _constraint(item)
        document.setdefault(section, {})[item.name] = entry
    document["switches"] = {item.constraint: _entry(SwitchEntry, item) for item in system.switches}
    document["events"] = {name: _event(event) for name, event in system.events.items()}
    return {section: entries for section, entries in document.items() if entries}


def _event(event: Event) -> Any:
    """Its formula alone where there is nothing else to say."""
    entries = _entry(EventEntry, event)
    return entries["formula"] if len(entries) == 1 else entries


def event_data(event: Event) -> Any:
    """An event as plain data, for files of other kinds that state some: formulas are texts."""
    return _spelled(_event(event), [], frozenset())


def _entry(entry: type[NounEntry], noun: Any) -> Plain:
    """The entries of a noun that the file requires or that differ from their defaults."""
    defaults = {item.name: item.default for item in fields(noun)}
    entries: Plain = {}
    for name, stated in entry.model_fields.items():
        if name in defaults and (stated.is_required() or getattr(noun, name) != defaults[name]):
            value = getattr(noun, name)
            entries[name] = _anchor(value) if stated.annotation is AnchorEntry else _plain(value)
    return entries


def _plain(value: Any) -> Any:
    """A field of a noun as data of the file."""
    if isinstance(value, Rotation):
        values = [_number(number) for number in value.values]
        return {value.kind: [values[:3], values[3:6], values[6:]] if value.kind == "matrix" else values}
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    for name, entry in ELEMENTS.items():
        if isinstance(value, entry.noun):
            return {name: _entry(entry, value)}
    if type(value) in _ENTRIES:
        return _entry(_ENTRIES[type(value)], value)
    return value if isinstance(value, (str, int)) else _number(value)


def _body(body: Body) -> Plain:
    entries: Plain = {}
    if body.joint is not None:
        joint = _entry(JointEntry, body.joint)
        if body.joint.name == default_joint_name(body.name):
            del joint["name"]
        entries["joint"] = joint
    if isinstance(body, Beam):
        entries["beam"] = _entry(BeamEntry, body)
        if body.shapes:
            entries["beam"]["shapes"] = {
                direction: [_plain(shape) for shape in given] for direction, given in body.shapes
            }
    elif body.inertia is not None:
        entries["inertia"] = _inertia(body.inertia)
    if body.frames != (() if not isinstance(body, Beam) else (Frame("tip"),)):
        entries["frames"] = {frame.name: _entry(FrameEntry, frame) for frame in body.frames}
    if body.waive:
        entries["waive"] = [*body.waive]
    if body.loads and not isinstance(body, Beam):
        entries["loads"] = _plain(body.loads)
    return entries


def _inertia(inertia: Inertia) -> Plain:
    """Products of inertia that are all zero are left out."""
    entries = _entry(InertiaEntry, inertia)
    if "moments" in entries and not any(inertia.moments[3:]):
        entries["moments"] = entries["moments"][:3]
    return entries


def _anchor(anchor: Anchor) -> Plain:
    body, frame = anchor
    return {"body": body} | ({"frame": frame} if frame is not None else {})


def _constraint(item: Constraint) -> tuple[str, Any]:
    """Section and entry of a constraint."""
    if isinstance(item, Closure | Rod):
        return "closures", _closure(item)
    if isinstance(item, Coupling):
        return "couplings", _number(item.residual)
    assert not isinstance(item, Touching), "the generator states it, of a contact"
    return "nonholonomic", _condition(item)


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
    kind, entry = ("knife_edge", KnifeEdgeEntry) if isinstance(item, KnifeEdge) else ("rolling", RollingEntry)
    return {kind: _anchor(item.anchor) | _entry(entry, item)}


def _number(value: Value) -> Any:
    """A number in its shortest exact form; a formula as it is."""
    if not isinstance(value, float):
        return value
    whole = abs(value) < _WHOLE and value.is_integer() and str(value) != "-0.0"
    return int(value) if whole else value


def _needing_quotes(system: System) -> tuple[list[str], frozenset[str]]:
    """Symbols that formulas could take for operations on others; and those of coordinates that are rates by name."""
    names = {item.name for item in system.parameters} | {item.name for item in system.inputs}
    names |= {state.name for state in system.states}
    stems = {name for body in system.beams for name in body.coordinates}
    for joint in (body.joint for body in system.bodies if body.joint is not None):
        suffixes = (*joint.traits.coordinate_suffixes, *(joint.traits.speed_suffixes or ()))
        own = {*joint.coordinates, *(f"{joint.name}.{suffix}" if suffix else joint.name for suffix in suffixes)}
        kinds = {element.state for element in joint.elements if isinstance(element, WITH_STATE)}
        counts = ("", *range(2, len(joint.elements) + 1))
        names |= {f"{stem}.{kind}{count}" for stem in own for kind in kinds for count in counts}
        stems |= own
    rates = {f"d{stem}" for stem in stems}
    return needs_quotes(names | stems | rates | {f"d{rate}" for rate in rates}), frozenset(stems & rates)


def _spelled(value: Any, symbols: list[str], both: frozenset[str]) -> Any:
    """The same data with formulas as texts."""
    if isinstance(value, dict):
        return {key: _spelled(item, symbols, both) for key, item in value.items()}
    if isinstance(value, list):
        return [_spelled(item, symbols, both) for item in value]
    return text_among(value, symbols, both) if isinstance(value, Expression) else value


def _styled(value: Any, role: str) -> Any:
    """The same data with its layout: sections, bodies and their parts on lines, small things in braces."""
    if isinstance(value, str):
        return value_text(value)
    if isinstance(value, list):
        sequence = CommentedSeq(_styled(item, "item") for item in value)
        sequence.fa.set_flow_style()
        return sequence
    if not isinstance(value, dict):
        return value
    mapping = CommentedMap((key_text(key), _styled(item, _role(key, role))) for key, item in value.items())
    if role not in _OPEN or not value:
        mapping.fa.set_flow_style()
    return mapping


def _role(key: str, owner: str) -> str:
    """Role of an entry in the layout: "body", "item", or its key at the top level and in bodies."""
    if owner == "bodies":
        return "body"
    return key if owner in ("", "body") else "item"
