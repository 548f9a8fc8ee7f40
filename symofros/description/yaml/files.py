"""The native file in: YAML, with the parts it includes, to a System; every fault found, each with its line."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from symofros.base.events import Event
from symofros.base.names import rate_symbol, symbol_of
from symofros.base.sources import Source
from symofros.description.constraints import Constraint, Coupling, Switch
from symofros.description.contacts import Contact
from symofros.description.forces import Connection, ForceState, Potential, VirtualPower
from symofros.description.reading import YAML_SUFFIXES, in_order, kind_of, read_bytes, refuse_size, resolved
from symofros.description.reading import Reading as Reading
from symofros.description.system import Body, Input, Parameter, System
from symofros.description.yaml.faults import placed_problems
from symofros.description.yaml.fields import Entry, Name
from symofros.description.yaml.schema import BodyEntry, InputEntry, NativeFile, SystemEntry, default_joint_name
from symofros.description.yaml.schema_events import ShortEvent
from symofros.description.yaml.yaml_nodes import Node, YamlFault
from symofros.description.yaml.yaml_pieces import compose
from symofros.description.yaml.yaml_writer import write_yaml as write_yaml
from symofros.errors import DescriptionError, Problem, did_you_mean, first_of

MAX_BYTES = 4 << 20
MAX_INCLUDE_DEPTH = 10
MAX_FILES = 100
# The entry that diagrams' files begin with (symofros/diagrams/files).
DIAGRAM = "symofros_diagram"

_SECTIONS = {
    "parameters": "parameter",
    "inputs": "input",
    "bodies": "body",
    "connections": "connection",
    "contacts": "connection",
    "virtual_power": "virtual_power",
    "potentials": "potential",
    "states": "state",
    "closures": "constraint",
    "couplings": "constraint",
    "nonholonomic": "constraint",
    "switches": "switch",
    "events": "event",
}
_SUFFIXES = ("px", "py", "pz", "qx", "qy", "qz", "qw", "vx", "vy", "vz", "wx", "wy", "wz")


def read_yaml(
    path: str | os.PathLike[str], text: str | None = None, composed: tuple[Node, list[Problem]] | None = None
) -> Reading:
    """Read a native description and what it includes.

    Args:
        path: The main file. Files that it includes lie in its folder or below.
        text: Content of the main file, where that is not written yet; then only its name and folder are used.
        composed: Root of that text and its duplicate keys, as `compose_text(text, "")` gives them, where known.

    Returns:
        The system without the entries that could not be read, and every problem. No system where names are missing
        wholesale (a section or an included file), because each use of one would then look like a fault of its own.
    """
    main = Path(path)
    merger = _Merger(resolved(main.parent))
    if text is not None:
        merger.unwritten[resolved(main)] = text.encode("utf-8")
    merger.composed = composed
    merger.add(main, str(main), ())
    return merger.reading(main.stem)


def read_event(name: str, node: Node) -> Event:
    """An event of a file of another kind, which states it as native files do.

    Raises:
        YamlFault: With every problem, each at ":line".
    """
    inside = Node(1, {"events": Node(1, {name: node}, 1)}, 1)
    try:
        file = _Events.model_validate(inside.plain())
    except ValidationError as error:
        raise YamlFault([problem for problem, _ in placed_problems(error, inside, "", inside.plain())]) from None
    event: Event = file.events[name].build(name=name)
    return event


class _Events(Entry):
    events: dict[Name, ShortEvent]


@dataclass
class _Merger:
    """Collects the entries of a file and of the files it includes."""

    folder: Path
    system: SystemEntry = field(default_factory=SystemEntry)
    parameters: list[Parameter] = field(default_factory=list)
    inputs: list[Input] = field(default_factory=list)
    bodies: list[Body] = field(default_factory=list)
    connections: list[Connection | Contact] = field(default_factory=list)
    virtual_power: list[VirtualPower] = field(default_factory=list)
    potentials: list[Potential] = field(default_factory=list)
    constraints: list[Constraint] = field(default_factory=list)
    switches: list[Switch] = field(default_factory=list)
    states: list[ForceState] = field(default_factory=list)
    events: dict[str, Event] = field(default_factory=dict)
    origin: dict[tuple[str, ...], str] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)
    broken: set[str] = field(default_factory=set)
    incomplete: bool = False
    seen: set[Path] = field(default_factory=set)
    bytes_left: int = field(default_factory=lambda: MAX_BYTES)
    unwritten: dict[Path, bytes] = field(default_factory=dict)
    composed: tuple[Node, list[Problem]] | None = None
    sources: list[Source] = field(default_factory=list)
    paths: dict[Path, Path] = field(default_factory=dict)

    def reading(self, default_name: str) -> Reading:
        problems, broken = tuple(self.problems), frozenset(self.broken)
        if self.incomplete:
            return Reading(None, problems, broken)
        x, y, z = self.system.gravity
        system = System(
            self.system.name or default_name,
            tuple(self.bodies),
            tuple(self.parameters),
            tuple(self.inputs),
            (x, y, z),
            tuple(self.connections),
            tuple(self.virtual_power),
            tuple(self.potentials),
            tuple(self.constraints),
            origin=self.origin,
            switches=tuple(self.switches),
            states=tuple(self.states),
            events=self.events,
        )
        return Reading(system, problems, broken, self.all_sources())

    def all_sources(self) -> tuple[Source, ...]:
        """The files, by each path that includes state: links among them may lead elsewhere another time."""
        if self.unwritten:
            return ()
        by_file = {source.file: source for source in self.sources}
        return (self.sources[0], *(by_file[str(to)]._replace(path=str(path)) for path, to in self.paths.items()))

    def add(self, path: Path, shown: str, including: tuple[Path, ...]) -> None:
        """Read one file, after the files it includes."""
        self.seen.add(resolved(path))
        try:
            root, problems = self.document(path, shown)
            _refuse_diagram(root, shown)
            file, faults, broken = _validate(root, shown)
        except (YamlFault, DescriptionError) as error:
            self.problems += error.problems
            self.incomplete = True
            return
        self.problems += in_order([*problems, *faults])
        self.broken |= broken
        self.incomplete |= file is None
        if file is None:
            return
        here = (*including, resolved(path))
        for i, text in enumerate(file.include or ()):
            where = f"{shown}:{root.at(('include', i)).line}"
            self.include(text, path, shown, here, where)
        self.merge(file, root, shown, bool(including))

    def document(self, path: Path, shown: str) -> tuple[Node, list[Problem]]:
        """Root of a file, and its duplicate keys."""
        data = self.bytes_of(path)
        if self.composed is None:
            return compose(data, shown)
        (root, problems), self.composed = self.composed, None  # Of the main file only.
        return root, [replace(problem, where=f"{shown}{problem.where}") for problem in problems]

    def bytes_of(self, path: Path) -> bytes:
        """A file's content; the limit is on the main file and all it includes together."""
        data = self.unwritten.get(resolved(path))
        if data is None:
            data = read_bytes(path, self.bytes_left)
            self.sources.append(Source.of(path, data))
        refuse_size(path, data, self.bytes_left)
        self.bytes_left -= len(data)
        return data

    def include(self, text: str, path: Path, shown: str, here: tuple[Path, ...], where: str) -> None:
        """Follow one include, if it is allowed; a file that is included twice counts once."""
        try:
            stated = resolved(path).parent / text
            target = resolved(stated)
            problem = self.refusal(text, target, here)
        except (OSError, ValueError) as error:  # A NUL character, or a loop of links.
            problem = Problem(
                "include: not a path", str(error), "an include is a relative path", "name a file of this folder"
            )
        if problem:
            self.problems.append(Problem(problem.what, problem.found, problem.rule, problem.remedy, where))
            self.incomplete = True
            return
        self.paths[stated] = target
        if target not in self.seen:
            self.add(target, os.path.normpath(Path(shown).parent / text), here)

    def refusal(self, text: str, target: Path, here: tuple[Path, ...]) -> Problem | None:
        """Why a file may not be included."""
        what = f"include '{text:.100}'"
        if Path(text).is_absolute() or not target.is_relative_to(self.folder):
            return Problem(
                f"{what} leaves the main file's folder",
                text[:100],
                "included files lie in that folder or below, links followed",
                "copy the file there",
            )
        if target.suffix not in YAML_SUFFIXES:
            return Problem(
                f"{what} is not a native description",
                target.suffix or "no suffix",
                f"included files end in {' or '.join(YAML_SUFFIXES)}",
                "rename it, or load it by itself",
            )
        if target in here:
            names = " -> ".join(file.name for file in [*here[here.index(target) :], target])
            return Problem(
                f"{what} closes a cycle",
                names,
                "files include each other in one direction",
                "remove one of the includes",
            )
        if len(here) > MAX_INCLUDE_DEPTH or len(self.seen) >= MAX_FILES:
            return Problem(
                f"{what} goes too far",
                f"{len(here)} levels, {len(self.seen)} files",
                f"at most {MAX_INCLUDE_DEPTH} levels and {MAX_FILES} files",
                "put parts together in fewer files",
            )
        if not target.is_file():
            there = [file.name for file in target.parent.glob("*.y*ml")] if target.parent.is_dir() else []
            kind = kind_of(target)
            return Problem(
                f"{what}: {'there is no such file' if kind == 'no such file' else f'it is {kind}'}",
                text[:100],
                "an included file exists, and is a regular one",
                did_you_mean(target.name, sorted(there)) or "put the file there, or drop the include",
            )
        return None

    def merge(self, file: NativeFile, root: Node, shown: str, included: bool) -> None:
        """Add one file's entries to those merged so far; names that another file has are noted as problems."""
        system_line = f"{shown}:{root.at(('system',)).key_line}"
        if file.system is not None and included:
            self.problems.append(
                Problem(
                    "an included file has a 'system' section",
                    "system",
                    "only the main file has one",
                    "remove it, or move it there",
                    system_line,
                )
            )
        elif file.system is not None:
            self.system = file.system
            self.origin["system",] = system_line

        def fresh(section: str) -> Iterator[tuple[str, Any]]:
            """The entries of a section that no other file has."""
            entries: Mapping[str, Any] = getattr(file, section) or {}
            return (item for item in entries.items() if self.is_new(section, item[0], root, shown))

        self.parameters += [parameter.build(name=name) for name, parameter in fresh("parameters")]
        self.inputs += [(entry or InputEntry()).build(name=name) for name, entry in fresh("inputs")]
        for name, body in fresh("bodies"):
            self.bodies.append((body or BodyEntry()).build(name))
            self.origin |= dict(_body_origin(self.bodies[-1], root, shown))
        for section in ("connections", "contacts"):
            self.connections += [connection.build(name=name) for name, connection in fresh(section)]
        self.virtual_power += [VirtualPower(name, tuple(forces.items())) for name, forces in fresh("virtual_power")]
        self.potentials += [Potential(name, energy) for name, energy in fresh("potentials")]
        self.states += [ForceState(name, rate) for name, rate in fresh("states")]
        self.constraints += [closure.build(name) for name, closure in fresh("closures")]
        self.constraints += [Coupling(name, residual) for name, residual in fresh("couplings")]
        self.constraints += [condition.build(name) for name, condition in fresh("nonholonomic")]
        self.switches += [switch.build(constraint=name) for name, switch in fresh("switches")]
        self.events |= {name: event.build(name=name) for name, event in fresh("events")}

    def is_new(self, section: str, name: str, root: Node, shown: str) -> bool:
        """Record where a named thing stands; whether no other file has one of that name."""
        kind = _SECTIONS[section]
        where = f"{shown}:{root.at((section, name)).key_line}"
        first = self.origin.setdefault((kind, name), where)
        if first == where:
            return True
        self.problems.append(
            Problem(
                f"{kind} '{name}' is in two files",
                f"{first} and {where}",
                "a name is given once in a file and all it includes",
                "rename one of them",
                where,
            )
        )
        return False


def _refuse_diagram(root: Node, shown: str) -> None:
    """Refuse the file of a diagram as a whole, instead of each of its entries.

    Raises:
        DescriptionError: The file is one of a diagram.
    """
    if isinstance(root.value, dict) and DIAGRAM in root.value and "symofros" not in root.value:
        raise DescriptionError(
            "the file is a diagram of blocks, not a mechanism",
            f"it begins with {DIAGRAM}",
            "a description of a mechanism begins with symofros: 1",
            "open the model that the diagram names under 'models'; `symofros simulate` runs diagrams",
            f"{shown}:{root.value[DIAGRAM].key_line}",
        )


def _validate(root: Node, shown: str) -> tuple[NativeFile | None, list[Problem], set[str]]:
    """A file's entries, faulty ones left out; None if a whole section is unreadable."""
    data = root.plain()
    try:
        return NativeFile.model_validate(data), [], set()
    except ValidationError as error:
        placed = placed_problems(error, root, shown, data)
    problems = first_of(problem for problem, _ in placed)
    broken: set[str] = set()
    for _, path in placed:
        section = path[0] if path else ""
        if section in _SECTIONS and len(path) > 1:
            broken |= _names_of(str(section), str(path[1]), data[section].pop(path[1], None))
        elif section in ("", "include", *_SECTIONS):
            return None, problems, broken
        else:
            data.pop(section, None)
    return NativeFile.model_validate({**data, "symofros": 1}), problems, broken


def _names_of(section: str, name: str, entry: Any) -> set[str]:
    """Names that refer to an unreadable entry: its name and, for a body, its coordinates and speeds."""
    if section != "bodies":
        return {name}
    joint = entry.get("joint") if isinstance(entry, dict) else None
    stated = joint.get("name") if isinstance(joint, dict) else None
    own = stated if isinstance(stated, str) else default_joint_name(name)
    symbols = {symbol_of(own), f"d{own}", rate_symbol(own)}
    return {name, own, *symbols, *(f"{own}.{suffix}" for suffix in _SUFFIXES)}


def _body_origin(body: Body, root: Node, shown: str) -> Iterator[tuple[tuple[str, ...], str]]:
    if body.joint is not None:
        yield ("joint", body.joint.name), f"{shown}:{root.at(('bodies', body.name, 'joint')).key_line}"
    for frame in body.frames:
        line = root.at(("bodies", body.name, "frames", frame.name)).key_line
        yield ("frame", body.name, frame.name), f"{shown}:{line}"
