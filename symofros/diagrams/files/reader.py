"""A diagram's YAML file in. It is as untrusted as a model: bounded, without tags; every fault with its line."""

from __future__ import annotations

import inspect
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from symofros.base.arguments import checked
from symofros.description import MODEL_SUFFIXES, System, in_order, read_bytes, resolved
from symofros.description.yaml import DIAGRAM, Node, YamlFault, compose
from symofros.diagrams.block import Block, ModelFile
from symofros.diagrams.conditional import SIGNAL, Condition
from symofros.diagrams.diagram import Diagram
from symofros.diagrams.files.blocks import MAX_BLOCKS, BlockReader, Permissions
from symofros.diagrams.files.fields import Misfit, read
from symofros.diagrams.files.inlets import read_inlets
from symofros.diagrams.files.paths import DIAGRAMS, refused
from symofros.diagrams.files.reading_options import READING, read_options
from symofros.diagrams.files.registry import kinds
from symofros.diagrams.files.run_settings import read_settings
from symofros.errors import DescriptionError, Problem, SymofrosError
from symofros.loading import load

VERSION = 1
MAX_BYTES = 4 << 20
MAX_FILES = 100
MAX_LEVELS = 10

HEAD = DIAGRAM
SECTIONS = (HEAD, "name", "models", "simulation", "blocks", "parts", "inlets", "outlets", "wires")
MODEL = ("file", "functions", *READING, "start", "parameters")
PART = ("file", "diagram", "models", "inputs", "condition", "parameters")

_ARGUMENTS = frozenset(inspect.signature(Diagram.include).parameters) - {"inputs"}


@checked
def load_diagram(
    path: str | os.PathLike[str],
    *,
    blocks: Iterable[type[Block]] = (),
    network: bool = False,
    allow_native: bool = False,
) -> Diagram:
    """Read a diagram and the models it names (docs/diagrams.md).

    Args:
        path: A YAML file. Models and parts lie in its folder or below.
        blocks: Classes of blocks of the caller's own, which files may state by their names in snake case.
        network: Whether blocks may reach other machines than this one.
        allow_native: Whether blocks may run the native code of files, as of functional mock-up units.

    Raises:
        DescriptionError: With every fault that was found. What concerns the diagram as a whole (wires, shapes, units,
            loops) is found by `sf.Simulation`, which knows the same lines.
    """
    diagram, problems = read_diagram(path, blocks=blocks, network=network, allow_native=allow_native)
    if problems or diagram is None:
        raise DescriptionError(problems)
    return diagram


def read_diagram(
    path: str | os.PathLike[str],
    text: str | None = None,
    *,
    blocks: Iterable[type[Block]] = (),
    network: bool = False,
    allow_native: bool | Mapping[str, str] = False,
) -> tuple[Diagram | None, list[Problem]]:
    """Read a diagram as far as it can be read, and everything that is wrong with its file.

    Args:
        path: File of the diagram, as of `load_diagram`.
        text: Content of the file, where that is not written yet; then only its name and folder are used.
        blocks: Classes of blocks of the caller's own.
        network: Whether blocks may reach other machines than this one.
        allow_native: Whether blocks may run the native code of files; or of which: path -> SHA-256 digest of its bytes.
    """
    file = Path(path)
    shared = _Shared(resolved(file.parent), kinds(blocks), network, allow_native)
    if text is not None:
        shared.unwritten[resolved(file)] = text.encode("utf-8")
    diagram = shared.file(file, str(file), ())
    return diagram, list(in_order(shared.problems))


@dataclass
class _Shared(Permissions):
    """State shared by the readers of one diagram's files."""

    problems: list[Problem] = field(default_factory=list)
    systems: dict[tuple[Path, str], System | None] = field(default_factory=dict)
    files: int = 0
    bytes_left: int = MAX_BYTES
    unwritten: dict[Path, bytes] = field(default_factory=dict)

    def file(self, path: Path, shown: str, including: tuple[Path, ...]) -> Diagram | None:
        """A file's diagram, as far as it can be read."""
        self.files += 1
        try:
            data = self.unwritten.get(resolved(path)) or read_bytes(path, self.bytes_left)
            self.bytes_left -= len(data)
            root, repeated = compose(data, shown)
        except (YamlFault, DescriptionError) as error:
            self.problems += error.problems
            return None
        self.problems += repeated
        reader = _Reader(self, path, shown, (*including, resolved(path)))
        entries = reader.mapping(root, "the file", SECTIONS)
        rule = f"a diagram's file begins with {HEAD}: {VERSION}"
        if not reader.missing(root, "the file", HEAD, entries, rule) and entries[HEAD].value != VERSION:
            reader.fault(
                entries[HEAD],
                f"{HEAD}: a version that is not known",
                entries[HEAD].plain(),
                rule,
                "take a newer symofros",
            )
        diagram = reader.diagram(entries, path.stem)
        diagram.file = str(resolved(path))
        return diagram


class _Reader(BlockReader):
    """Reader of one file of a diagram."""

    def __init__(self, shared: _Shared, path: Path, shown: str, here: tuple[Path, ...]) -> None:
        super().__init__(shown, shared.problems, path.parent, shared)
        self.shared, self.here = shared, here

    def diagram(self, entries: Mapping[str, Node], name: str) -> Diagram:
        """The diagram that the entries of a file or of an inline part state."""
        diagram = Diagram(self.text(entries["name"], "name") if "name" in entries else name)
        for key, read_one in (("models", self.model), ("blocks", self.block), ("parts", self.part)):
            if key in entries:
                for one, node in self.mapping(entries[key], key).items():
                    read_one(diagram, one, node)
        if "simulation" in entries:
            diagram.simulation = read_settings(self, diagram, entries["simulation"])
        if "wires" in entries:
            for target, node in self.mapping(entries["wires"], "wires").items():
                block, _, port = target.rpartition(".")
                self.wire(diagram, block, port, node)
        if "inlets" in entries:
            read_inlets(self, diagram, entries["inlets"])
        if "outlets" in entries:
            for one, node in self.mapping(entries["outlets"], "outlets").items():
                diagram.outlets[one] = self.text(node, f"outlet '{one:.60}'")
                diagram.origin["outlet", one] = self.where(node)
        return diagram

    def model(self, diagram: Diagram, name: str, node: Node) -> None:
        """A model by its file."""
        what = f"model '{name:.60}'"
        entries = self.mapping(node, what, MODEL)
        diagram.origin["model", name] = self.where(node, key=True)
        if self.missing(node, what, "file", entries, "a model is read from a file"):
            return
        options = read_options(self, entries, what, self.base, self.shared.folder)
        functions = None
        if "functions" in entries:
            value = entries["functions"].value
            if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= 100:
                self.fault(
                    entries["functions"],
                    f"{what}: functions",
                    value,
                    "a whole number from 0 to 100",
                    "0 makes it rigid",
                )
                return
            functions = value
        system = self.system(entries["file"], what, options)
        start, parameters = (
            self.numbers(entries[key], f"{what}: {key}") if key in entries else {} for key in ("start", "parameters")
        )
        if system is None:
            return
        file = ModelFile(str(resolved(self.base / entries["file"].value)), functions, options)
        try:
            diagram.add_model(name, system, start, parameters, functions, file)
        except DescriptionError as error:
            self.take(node, error.problems)

    def system(self, node: Node, what: str, options: Mapping[str, Any]) -> System | None:
        """The System described by a file; the same object for the same file and options."""
        text = self.text(node, f"{what}: file", 1000)
        problem = refused(text, self.base, self.shared.folder, MODEL_SUFFIXES) if text else None
        if not text or problem:
            self.take(node, [problem] if problem else [])
            return None
        path = resolved(self.base / text)
        key = path, repr(options)
        if key not in self.shared.systems:
            try:
                shown = Path(os.path.relpath(path)) if not Path(self.file).is_absolute() else path
                self.shared.systems[key] = load(shown, **options)
            except DescriptionError as error:
                self.shared.systems[key] = None
                self.take(node, error.problems)
        return self.shared.systems[key]

    def part(self, diagram: Diagram, name: str, node: Node) -> None:
        """A diagram inside this one, from a file or inline."""
        what = f"part '{name:.60}'"
        entries = self.mapping(node, what, PART)
        if ("file" in entries) == ("diagram" in entries):
            self.fault(
                node,
                f"{what} is not of one origin",
                ", ".join(entries) or "nothing",
                "a part has either a file or a diagram",
                "add one of them",
            )
            return
        if "diagram" in entries:
            inside = self.mapping(entries["diagram"], f"{what}: diagram", SECTIONS[1:])
            inner: Diagram | None = self.diagram(inside, name)
        else:
            inner = self.from_file(entries["file"], what)
        models, inputs = (
            self.texts(entries[key], f"{what}: {key}") if key in entries else {} for key in ("models", "inputs")
        )
        if inner is None:
            return
        if len(diagram.blocks) + len(inner.blocks) > MAX_BLOCKS:
            self.fault(node, "too many blocks", f"more than {MAX_BLOCKS}", f"at most {MAX_BLOCKS}", "drop parts")
            return
        self.drop_reserved(inputs, what, entries)
        condition = self.condition(what, entries["condition"]) if "condition" in entries else None
        if condition is not None:
            for signal in condition.signals():
                diagram.origin["input", f"{name}/{signal}", SIGNAL] = self.where(entries["condition"])
        stated = self.mapping(entries["parameters"], f"{what}: parameters") if "parameters" in entries else {}
        values = {key: value.plain() for key, value in stated.items()}
        try:
            diagram.include(name, inner, models, condition, values, **inputs)
        except DescriptionError as error:
            self.take(node, error.problems)
        for inlet in filter(inner.inlets.__contains__, inputs):
            for target in inner.fed_by(inlet):
                block, _, port = f"{name}/{target}".rpartition(".")
                diagram.origin["input", block, port] = self.where(entries["inputs"].value[inlet])

    def drop_reserved(self, inputs: dict[str, str], what: str, entries: Mapping[str, Node]) -> None:
        """Note and leave out inlets that are called as arguments of `Diagram.include`."""
        for reserved in sorted(inputs.keys() & _ARGUMENTS):
            self.fault(
                entries["inputs"],
                f"{what}: no inlet can be called '{reserved}'",
                f"'{reserved}'",
                "the name is one of Diagram.include's own",
                "rename the inlet",
            )
            del inputs[reserved]

    def condition(self, what: str, node: Node) -> Condition | None:
        """When a part runs; None where that could not be read."""
        try:
            condition: Condition = read(Condition, node)
        except Misfit as error:
            rule, remedy = error.rule, "such as {enabled: logic.on, states: reset}"
            self.fault(error.node, f"{what}: condition does not fit", error.node.plain(), rule, remedy)
        except SymofrosError as error:
            self.take(node, error.problems)
        else:
            return condition
        return None

    def from_file(self, node: Node, what: str) -> Diagram | None:
        """A part's file."""
        text = self.text(node, f"{what}: file", 1000)
        problem = refused(text, self.base, self.shared.folder, DIAGRAMS) if text else None
        target = resolved(self.base / text) if text and not problem else Path()
        if not problem and text and target in self.here:
            names = " -> ".join(file.name for file in [*self.here[self.here.index(target) :], target])
            problem = Problem(
                f"{what} closes a cycle",
                names,
                "diagrams contain each other in one direction",
                "remove one of the parts",
            )
        if not problem and (len(self.here) > MAX_LEVELS or self.shared.files >= MAX_FILES):
            problem = Problem(
                f"{what} goes too far",
                f"{len(self.here)} levels, {self.shared.files} files",
                f"at most {MAX_LEVELS} levels and {MAX_FILES} files",
                "put parts together",
            )
        if not text or problem:
            self.take(node, [problem] if problem else [])
            return None
        return self.shared.file(self.base / text, os.path.normpath(Path(self.file).parent / text), self.here)
