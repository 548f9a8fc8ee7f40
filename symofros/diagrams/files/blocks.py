"""The section `blocks` of a diagram's file: what a block of a kind needs, and what it may reach."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from symofros.description import resolved
from symofros.description.yaml import Node, YamlFault
from symofros.diagrams.block import Block
from symofros.diagrams.diagram import Diagram
from symofros.diagrams.files.entries import Entries
from symofros.diagrams.files.fields import CONSENT, Misfit, read, required, runs_native_code, types_of
from symofros.diagrams.files.paths import refused
from symofros.diagrams.files.registry import INPUTS, KIND, entry_of
from symofros.errors import DescriptionError, Problem, SymofrosError, did_you_mean

MAX_BLOCKS = 10_000
COMMON = ("kind", "period", "offset", "inputs")


@dataclass
class Permissions:
    """What the blocks of files may be, and reach.

    Attributes:
        folder: Folder whose files may be named.
        kinds: Classes of blocks by their names in files.
        network: Whether blocks may reach other machines than this one.
        allow_native: Whether blocks may run the native code of files; or of which: path -> SHA-256 digest of its bytes.
    """

    folder: Path
    kinds: Mapping[str, type[Block]]
    network: bool
    allow_native: bool | Mapping[str, str]

    def consent(self, file: str) -> bool | str:
        """Consent to run the native code of a file, as of FMU."""
        given = self.allow_native
        return given if isinstance(given, bool) else given.get(file, False)


class BlockReader(Entries):
    """Reads the blocks of one file.

    Args:
        file: File name as it is shown.
        problems: List that receives the faults.
        base: Folder of the file.
        allowed: What blocks may be, and reach.
    """

    def __init__(self, file: str, problems: list[Problem], base: Path, allowed: Permissions) -> None:
        super().__init__(file, problems)
        self.base, self.allowed = base, allowed

    def block(self, diagram: Diagram, name: str, node: Node) -> None:
        """A block of a kind, its fields by the class."""
        what = f"block '{name:.60}'"
        if len(diagram.blocks) >= MAX_BLOCKS:
            self.fault(node, "too many blocks", f"more than {MAX_BLOCKS}", f"at most {MAX_BLOCKS}", "split the diagram")
            return
        entries = self.mapping(node, what)
        if self.missing(node, what, "kind", entries, "a block is of a kind"):
            return
        kind = self.text(entries["kind"], f"{what}: kind")
        if kind not in self.allowed.kinds:
            if kind:
                self.fault(
                    entries["kind"],
                    f"{what}: no kind of blocks '{kind:.60}'",
                    f"'{kind:.60}'",
                    "kinds are the classes of symofros.blocks in snake_case",
                    did_you_mean(kind, self.allowed.kinds),
                )
            return
        owner = self.allowed.kinds[kind]
        block = self.made(what, kind, owner, name, node, entries)
        if block is None:
            return
        reach = block.reaches()
        if reach and not self.allowed.network:
            self.fault(
                node,
                f"{what} reaches another machine",
                reach,
                "a diagram's file stays on this machine unless its reader says otherwise",
                "load_diagram(path, network=True), or simulate --network",
            )
        try:
            diagram.add(block)
        except DescriptionError as error:
            self.take(node, error.problems)
            return
        diagram.origin["block", name] = self.where(node, key=True)
        if "inputs" in entries:
            for port, item in self.mapping(entries["inputs"], f"{what}: inputs").items():
                self.wire(diagram, name, port, item)

    def made(
        self, what: str, kind: str, owner: type[Block], name: str, node: Node, entries: Mapping[str, Node]
    ) -> Block | None:
        """The block, if its fields are of their types and all there."""
        names = {entry_of(name): name for name in types_of(owner) if name != "name"}
        types = types_of(owner)
        known = list(dict.fromkeys([*COMMON, *names]))
        before = len(self.problems)
        values: dict[str, Any] = {}
        for key, item in self.mapping(node, f"{what} ({kind})", known).items():
            if key in (KIND, INPUTS):
                continue
            try:
                value = read(types[names[key]], item)
                values[names[key]] = self.inside(value, item) if names[key] in owner.paths else value
            except Misfit as error:
                self.fault(
                    error.node,
                    f"{what}: {key} does not fit",
                    error.node.plain(),
                    error.rule,
                    f"see the fields of {kind}",
                )
            except YamlFault as error:
                inside = [
                    replace(one, what=f"{what}: {one.what}", where=f"{self.file}{one.where}") for one in error.problems
                ]
                self.take(item, inside)
            except SymofrosError as error:
                self.take(item, [replace(one, what=f"{what}: {key}: {one.what}") for one in error.problems])
            except (ValueError, TypeError) as error:
                self.fault(item, f"{what}: {key} does not fit", f"{error}", f"as {kind} takes it", "mend it")
        for key in sorted({entry_of(name) for name in required(owner) - {"name"}} - entries.keys()):
            self.missing(node, what, key, entries, f"{kind} needs {key}")
        if len(self.problems) > before:
            return None
        if runs_native_code(owner):
            values[CONSENT] = self.allowed.consent(values["file"])
        try:
            return owner(name=name, **values)
        except DescriptionError as error:
            self.take(node, error.problems, key=True)
        except (SymofrosError, ValueError, TypeError) as error:
            problem = Problem(
                f"{what} ({kind}) can't be made", f"{error}"[:200], "its fields fit each other", "mend them"
            )
            self.take(node, [problem], key=True)
        return None

    def inside(self, value: Any, node: Node) -> Any:
        """The whole path of a file that a block names; nothing is read from elsewhere than the diagram's folder."""
        if not isinstance(value, str) or not value:
            return value
        problem = refused(value, self.base, self.allowed.folder)
        self.take(node, [problem] if problem else [])
        return str(resolved(self.base / value)) if not problem else value

    def wire(self, diagram: Diagram, block: str, port: str, node: Node) -> None:
        """An input and its source."""
        source = self.text(node, f"input '{block:.60}.{port:.60}'", 1000)
        if not source:
            return
        try:
            diagram.connect(source, f"{block}.{port}")
        except DescriptionError as error:
            self.take(node, error.problems)
        diagram.origin.setdefault(("input", block, port), self.where(node))
