"""Sub-assemblies that a user keeps: bodies with what holds them together, taken out of a document and put into one."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from symofros.description import WORLD
from symofros.description.yaml import VERSION, default_joint_name
from symofros.studio.editor.editing.data_edits import SECTIONS, Edit, Path, edited, fault, same, section_of
from symofros.studio.editor.editing.formulas import formulas, names_in
from symofros.studio.editor.editing.renaming import anchors, renaming, speeds_as_keys, symbols_of, taken

Json = dict[str, Any]

# Sections that hold what acts between bodies, and the symbols of bodies.
_BETWEEN = ("connections", "contacts", "closures", "couplings", "nonholonomic", "virtual_power", "potentials")


def extracted(data: Any, bodies: list[str]) -> Json:
    """A document of some bodies, what connects them and joins them to the ground, and the names that they use.

    Args:
        data: The document that they are in.
        bodies: Their names. Where the parent of one is not among them, it will stand on the world.

    Raises:
        EditError: There is no such body, or one is the base.
    """
    stated = section_of(data, "bodies")
    ground = {WORLD, *(name for name, body in stated.items() if not section_of(body, "joint"))}
    for name in bodies:
        if not section_of(stated.get(name), "joint"):
            raise fault(
                ("bodies", name), "no such body, or no joint", "a part is made of bodies with joints", "choose others"
            )
    if not bodies:
        raise fault(("bodies",), "no bodies", "a part has one body at least", "choose some")
    part: Json = {
        "symofros": VERSION,
        "bodies": {name: _rooted(stated[name], bodies) for name in stated if name in bodies},
    }
    foreign = _symbols(data) - _symbols(part)
    for section in _BETWEEN:
        kept = {
            name: entry
            for name, entry in section_of(data, section).items()
            if _belongs(section, name, entry, set(bodies), ground, _symbols(part), foreign)
        }
        if kept:
            part[section] = kept
    held = {name for section in _BETWEEN for name in section_of(part, section)}
    switches = {name: entry for name, entry in section_of(data, "switches").items() if name in held}
    part |= {"switches": switches} if switches else {}
    part["bodies"] = {**_base_in_use(part, data), **part["bodies"]}
    used = {name for _, text in formulas(part) for name in names_in(text)}
    for section in ("parameters", "inputs"):
        kept = {name: entry for name, entry in section_of(data, section).items() if name in used}
        if kept:
            part[section] = kept
    return {section: part[section] for section in SECTIONS if section in part}


def _rooted(body: Json, bodies: list[str]) -> Json:
    """A body whose parent is in the part, or that stands on the world."""
    joint = dict(body["joint"])
    if joint.get("parent") not in bodies:
        joint.pop("parent", None)
        joint.pop("frame", None)
    return {**body, "joint": joint}


def _base_of(data: Any) -> str | None:
    """The body without a joint."""
    return next((name for name, body in section_of(data, "bodies").items() if not section_of(body, "joint")), None)


def _base_in_use(part: Json, data: Any) -> Json:
    """The base of a document, with those of its frames that links of a part name; empty where they name none."""
    base = _base_of(data)
    if base is None:
        return {}
    named = [anchor for _, anchor in anchors(part) if anchor.get("body") in (WORLD, base)]
    used = {anchor.get("frame") for anchor in named}
    frames = {name: frame for name, frame in _frames(data, base).items() if name in used}
    is_named = any(anchor.get("body") == base for anchor in named)
    return {base: {"frames": frames} if frames else {}} if frames or is_named else {}


def _frames(data: Any, body: str) -> Json:
    return section_of(section_of(section_of(data, "bodies"), body), "frames")


def _belongs(
    section: str, name: str, entry: Any, bodies: set[str], ground: set[str], own: set[str], foreign: set[str]
) -> bool:
    """Whether something between bodies concerns those of the part, and no others but the ground."""
    alone = {section: {name: entry}}
    held = [anchor.get("body") for _, anchor in anchors(alone)]
    used = {symbol for _, text in formulas(alone) for symbol in names_in(text)}
    used |= {speed for _, speeds in speeds_as_keys(alone) for speed in speeds}
    if held:
        return not bodies.isdisjoint(held) and all(body in bodies | ground for body in held) and not used & foreign
    return bool(used & own) and not used & foreign


def _symbols(data: Any) -> set[str]:
    """Symbols of formulas for the coordinates and speeds of a document's bodies, and for their rates."""
    symbols: set[str] = set()
    for name, body in section_of(data, "bodies").items():
        joint = section_of(body, "joint")
        stated = joint.get("coordinates") if joint.get("kind") == "general" else None
        if isinstance(stated, list):
            symbols.update(f"{rate}{symbol}" for rate in ("", "d", "dd") for symbol in stated)
        symbols.update(symbols_of(joint, str(joint.get("name", default_joint_name(name)))) if joint else ())
    return symbols


def insertion(data: Any, part: Json, parent: str | None, frame: str | None) -> list[Edit]:
    """The edits that put a part into a document; what clashes is renamed, equal parameters and inputs are shared.

    Links to the ground stay there: frames of the part's base become frames of the document's, equal ones are shared.

    Args:
        data: The document.
        part: Part as `extracted` makes it.
        parent: The body that carries what stood on the world; None: the world.
        frame: The frame of that body.

    Raises:
        EditError: The part is unusable.
    """
    part = _distinct(data, part)
    base = _base_of(data)
    edits: list[Edit] = []
    for section in SECTIONS:
        for name, entry in section_of(part, section).items():
            if section in ("symofros", "include", "system", "options"):
                continue
            there = section_of(data, section)
            if section in ("parameters", "inputs") and name in there and same(there[name], entry):
                continue
            if section == "bodies" and name == base:
                edits += [
                    Edit("set", (section, name, "frames", frame), value)
                    for frame, value in _frames(part, name).items()
                    if frame not in _frames(data, name)
                ]
                continue
            edits.append(Edit("set", (section, name), _carried(entry, parent, frame) if section == "bodies" else entry))
    return edits


def _carried(body: Any, parent: str | None, frame: str | None) -> Any:
    joint = section_of(body, "joint")
    if parent is None or not joint or "parent" in joint:
        return body
    placed = {"kind": joint.get("kind"), "parent": parent, **({"frame": frame} if frame else {}), **joint}
    return {**body, "joint": {"name": placed.pop("name"), **placed} if "name" in placed else placed}


def _distinct(data: Any, part: Json) -> Json:
    """The part with names that the document does not have yet."""
    for rename in (_distinct_symbols, _distinct_bodies, _distinct_joints, _distinct_relations, _on_one_base):
        part = rename(data, part)
    return part


def _distinct_symbols(data: Any, part: Json) -> Json:
    """Parameters and inputs: one that is there and is the same stays."""
    names = taken(data)
    for section in ("parameters", "inputs"):
        there = section_of(data, section)
        for name, entry in list(section_of(part, section).items()):
            if name in names and not (name in there and same(there[name], entry)):
                part = _renamed(part, (section, name), _free(name, names | taken(part)))
    return part


def _distinct_bodies(data: Any, part: Json) -> Json:
    for name in list(section_of(part, "bodies")):
        bodies = {*section_of(data, "bodies"), *section_of(part, "bodies")}
        if name in section_of(data, "bodies"):
            part = _renamed(part, ("bodies", name), _free(name, bodies))
    return part


def _distinct_joints(data: Any, part: Json) -> Json:
    """Joints and their coordinates."""
    names, joints = taken(data), _joints(data)
    for name, body in list(section_of(part, "bodies").items()):
        joint = section_of(body, "joint")
        own = str(joint.get("name", default_joint_name(name)))
        if joint and (own in joints or set(symbols_of(joint, own)) & names):
            part = _renamed(part, ("bodies", name, "joint"), _free(own, joints | _joints(part) | names | taken(part)))
        stated = joint.get("coordinates")
        for i, symbol in enumerate(stated if isinstance(stated, list) else []):
            if symbol in names:
                part = _renamed(part, ("bodies", name, "joint", "coordinates", i), _free(symbol, names | taken(part)))
    return part


def _distinct_relations(data: Any, part: Json) -> Json:
    """What stands between bodies: connections, constraints, forces."""
    for section in _BETWEEN:
        for name in list(section_of(part, section)):
            if name in section_of(data, section):
                known = {*section_of(data, section), *section_of(part, section)}
                part = _renamed(part, (section, name), _free(name, known))
    return part


def _on_one_base(data: Any, part: Json) -> Json:
    """Frames of the part's base, under the name of the document's."""
    own, base = _base_of(part), _base_of(data)
    if own is None or base is None:
        return part
    there = _frames(data, base)
    for name, frame in _frames(part, own).items():
        if name in there and not same(there[name], frame):
            part = _renamed(part, ("bodies", own, "frames", name), _free(name, {*there, *_frames(part, own)}))
    return _renamed(part, ("bodies", own), base)


def _joints(data: Any) -> set[str]:
    """Names of joints, those that nothing formulas use follows from included."""
    bodies = section_of(data, "bodies").items()
    return {str(section_of(body, "joint").get("name", default_joint_name(name))) for name, body in bodies}


def _renamed(part: Json, path: Path, new: str) -> Json:
    for edit in renaming(part, Edit("rename", path, key=new)):
        part = edited(part, edit)
    return part


def _free(name: str, known: Iterable[str]) -> str:
    """The next free name: motor3 -> motor4, hook -> hook2."""
    stem = name.rstrip("0123456789")
    first = int(name[len(stem) :][-9:] or 1) + 1
    known = set(known)
    return next(new for n in range(first, first + len(known) + 1) if (new := f"{stem}{n}") not in known)
