"""Renaming a body, frame, joint, coordinate, parameter or input, with every reference to it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from symofros.base.names import TIME, rate_symbol, symbol_of
from symofros.description import KINDS, STATION, WORLD, Joint
from symofros.description.yaml import DIAGRAM, default_joint_name
from symofros.errors import DescriptionError
from symofros.expr import CONSTANTS
from symofros.mechanics.topology import motion_symbols
from symofros.studio.editor.editing.data_edits import Edit, Path, edited, fault, section_of
from symofros.studio.editor.editing.diagram_renaming import renaming_in_diagram
from symofros.studio.editor.editing.formulas import formulas, names_in, with_names

# Mappings whose keys are speeds that formulas could name, of actions parameters, too.
_BY_SPEED = (("virtual_power", None), ("nonholonomic", "coefficients"), ("events", "action"))
# What formulas of events call the forces of a section's entries, and where balls of contacts are.
_FORCES = dict.fromkeys(("closures", "couplings", "nonholonomic"), ("lam", "wrench")) | {"contacts": ("contact",)}
_BARE = ("parameters", "inputs")


def renaming(data: Any, edit: Edit) -> list[Edit]:
    """The edits that a renaming consists of; the references first, so that all paths are those of the document.

    Args:
        data: The document.
        edit: Its op is "rename": `path` is that of a body, frame, parameter, input, of another named entry, of a
            joint (or its name), or of a general joint's coordinate; `key` is the new name.

    Raises:
        EditError: There is no such entry, or the name is taken or unusable.
    """
    path, new = edit.path, edit.key
    if isinstance(data, dict) and DIAGRAM in data:
        return renaming_in_diagram(data, edit)
    if path[:1] == ("bodies",) and path[2:] in (("joint",), ("joint", "name")):
        return _joint(data, path[:3], new)
    if len(path) == 5 and path[0] == "bodies" and path[2:4] == ("joint", "coordinates"):
        old = str(_at(data, path))
        names = {symbol_of(f"{rate}{old}"): symbol_of(f"{rate}{new}") for rate in ("", "d", "dd")}
        names |= {rate_symbol(old, order): rate_symbol(new, order) for order in (1, 2)}
        return [*_symbols(data, path, names), Edit("set", path, new)]
    edited(data, edit)  # Whether it can be done at all.
    edits: list[Edit] = []
    if len(path) == 2 and path[0] == "bodies":
        edits = _body(data, path, new)
    elif len(path) == 4 and path[0] == "bodies" and path[2] == "frames":
        edits = _frame(data, str(path[1]), str(path[3]), new)
    elif len(path) == 2 and path[0] in _BARE:
        of = symbol_of if path[0] == "inputs" else str
        edits = _symbols(data, path, {of(str(path[1])): of(new)})
    elif len(path) == 2 and path[0] in _FORCES:
        edits = _symbols(data, path, _forces(data, _FORCES[str(path[0])], str(path[1]), new))
        if "lam" in _FORCES[str(path[0])] and path[1] in section_of(data, "switches"):
            edits.append(Edit("rename", ("switches", path[1]), key=new))
    return [*edits, edit]


def _forces(data: Any, groups: tuple[str, ...], old: str, new: str) -> dict[str, str]:
    """What formulas of events call the forces of a constraint, contact or joint, before and after."""
    begins = {f"{group}.{old}": f"{group}.{new}" for group in groups}
    used = {name for _, text in formulas({"events": section_of(data, "events")}) for name in names_in(text)}
    return {
        name: to + name.removeprefix(begin)
        for name in sorted(used)
        for begin, to in begins.items()
        if name == begin or name.startswith((f"{begin}.", f"{begin}["))
    }


def _body(data: Any, at: Path, new: str) -> list[Edit]:
    """References to a body; the names of its joint's coordinates, where they are made of its own."""
    old = str(at[1])
    if new == WORLD:
        raise fault(at, f"'{WORLD}'", f"'{WORLD}' is the ground's own name", "choose another")
    edits = [Edit("set", path, new) for path, name in _bodies_named(data) if name == old and old != WORLD]
    joint = section_of(section_of(section_of(data, "bodies"), old), "joint")
    if joint and "name" not in joint:
        names = default_joint_name(old), default_joint_name(new)
        before, after = (symbols_of(joint, name) for name in names)
        edits += _symbols(data, at, dict(zip(before, after, strict=True)) | _forces(data, ("reaction",), *names))
    return edits


def _bodies_named(data: Any) -> Iterator[tuple[Path, str]]:
    """Every place that names a body."""
    for name, body in section_of(data, "bodies").items():
        joint = section_of(body, "joint")
        if isinstance(joint.get("parent"), str):
            yield ("bodies", name, "joint", "parent"), joint["parent"]
        rotors = joint.get("rotors")
        for i, rotor in enumerate(rotors if isinstance(rotors, list) else []):
            if isinstance(rotor, dict) and isinstance(rotor.get("carrier"), str):
                yield ("bodies", name, "joint", "rotors", i, "carrier"), rotor["carrier"]
    for path, anchor in anchors(data):
        if isinstance(anchor.get("body"), str):
            yield (*path, "body"), anchor["body"]


def anchors(data: Any) -> Iterator[tuple[Path, dict[str, Any]]]:
    """Every place that names a body with a frame of it."""
    for section, sides in (
        ("connections", ("first", "second")),
        ("contacts", ("first", "second")),
        ("closures", ("first", "second")),
        ("nonholonomic", ("knife_edge", "rolling")),
    ):
        for name, entry in section_of(data, section).items():
            for side in sides:
                if anchor := section_of(entry, side):
                    yield (section, name, side), anchor


def _frame(data: Any, body: str, old: str, new: str) -> list[Edit]:
    """References to a frame: of joints that sit in it, anchors, loads."""
    bodies = section_of(data, "bodies")
    base = next((name for name, entry in bodies.items() if "joint" not in (entry or {})), WORLD)
    names = {body, WORLD} if body == base else {body}
    edits = []
    for name, entry in bodies.items():
        joint = section_of(entry, "joint")
        if joint.get("frame") == old and joint.get("parent", WORLD) in names:
            edits.append(Edit("set", ("bodies", name, "joint", "frame"), new))
    for path, anchor in anchors(data):
        if anchor.get("frame") == old and anchor.get("body") in names:
            edits.append(Edit("set", (*path, "frame"), new))
    loads = section_of(bodies, body).get("loads")
    for i, load in enumerate(loads if isinstance(loads, list) else []):
        if isinstance(load, dict) and load.get("at") == old:
            edits.append(Edit("set", ("bodies", body, "loads", i, "at"), new))
    return edits


def _joint(data: Any, path: Path, new: str) -> list[Edit]:
    """A joint's name, and its coordinates and speeds wherever they are used."""
    joint = _at(data, path)
    if not isinstance(joint, dict):
        raise fault(path, "no joint", "the path leads to a joint", "give the body a joint")
    if not new:
        raise fault(path, "no name", "a joint has a name", "give one")
    old = joint.get("name", default_joint_name(str(path[1])))
    before, after = symbols_of(joint, str(old)), symbols_of(joint, new)
    names = dict(zip(before, after, strict=True)) | _forces(data, ("reaction",), str(old), new)
    return [*_symbols(data, path, names), Edit("set", (*path, "name"), new)]


def symbols_of(joint: dict[str, Any], name: str) -> tuple[str, ...]:
    """Symbols of the coordinates, speeds and rates of a joint in formulas; none of user-defined kinds."""
    kind: Any = joint.get("kind")
    if kind not in KINDS or KINDS[kind].user_defined:
        return ()
    try:
        return motion_symbols(Joint(name, kind=kind))
    except DescriptionError:
        return ()


def taken(data: Any) -> set[str]:
    """The names that formulas could use."""
    names = {TIME, *CONSTANTS, *section_of(data, "parameters"), *map(symbol_of, section_of(data, "inputs"))}
    for body, entry in section_of(data, "bodies").items():
        if section_of(entry, "beam"):
            names.add(STATION)
        joint = section_of(entry, "joint")
        stated = joint.get("coordinates") if joint.get("kind") == "general" else None
        if isinstance(stated, list):
            names.update(symbol_of(f"{rate}{name}") for rate in ("", "d", "dd") for name in stated)
        elif joint:
            names.update(symbols_of(joint, str(joint.get("name", default_joint_name(body)))))
    return names


def _symbols(data: Any, at: Path, new: dict[str, str]) -> list[Edit]:
    """Names exchanged in all formulas, and where speeds are keys.

    Raises:
        EditError: A new name is taken, and could not be distinguished afterwards; or can't be printed.
    """
    clash = sorted(set(new.values()) & (taken(data) - new.keys()))
    if clash:
        raise fault(at, f"'{clash[0][:50]}' is taken", "names that formulas use are unique", "choose another name")
    edits = []
    for path, text in formulas(data):
        changed = with_names(text, new)
        if changed != text:
            edits.append(Edit("set", path, changed))
    for path, speeds in speeds_as_keys(data):
        edits += [Edit("rename", (*path, speed), key=new[speed]) for speed in speeds if speed in new]
    odd = [name for name in new.values() if not name or not name.isprintable()]
    if odd:
        raise fault(at, f"{odd[0]!r:.50}", "a name has characters that can be printed", "choose another name")
    # A formula within a mapping is changed under its old key, before the key is.
    return edits


def speeds_as_keys(data: Any) -> Iterator[tuple[Path, list[str]]]:
    """Every mapping whose keys are speeds: its path, and these."""
    for section, inner in _BY_SPEED:
        for name, entry in section_of(data, section).items():
            speeds = section_of(entry, inner) if inner else entry
            if isinstance(speeds, dict):
                yield ((section, name, inner) if inner else (section, name)), list(speeds)


def _at(data: Any, path: Path) -> Any:
    for step in path:
        if isinstance(data, dict) and step in data or isinstance(data, list) and step in range(len(data)):
            data = data[step]  # type: ignore[index]
        else:
            raise fault(path, f"no '{step}'", "the path leads to an entry that exists", "reload the document")
    return data
