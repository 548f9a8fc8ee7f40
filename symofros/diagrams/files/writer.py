"""A diagram as YAML that reads back as the same diagram; its models and parts as references to their files."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from ruamel.yaml.comments import CommentedMap, CommentedSeq

from symofros.base.arguments import checked
from symofros.base.stored import write_atomically
from symofros.description import resolved
from symofros.description.yaml import key_text, value_text, yaml_text
from symofros.diagrams.block import Block, ModelSetup
from symofros.diagrams.conditional import Condition
from symofros.diagrams.diagram import INSIDE, Diagram, Part
from symofros.diagrams.files.fields import CONSENT, MISSING, same, write
from symofros.diagrams.files.inlets import written_inlets
from symofros.diagrams.files.paths import DIAGRAMS
from symofros.diagrams.files.reader import HEAD, VERSION, load_diagram
from symofros.diagrams.files.reading_options import reading_entries
from symofros.diagrams.files.registry import entry_of, kind_of
from symofros.diagrams.program.variants import with_functions
from symofros.diagrams.settings import RunSettings
from symofros.errors import DescriptionError
from symofros.loading import load, save

Plain = dict[str, Any]


@checked
def save_diagram(diagram: Diagram, path: str | os.PathLike[str]) -> list[Path]:
    """Write a diagram; each file is there whole or not at all.

    Models that were read from files in the folder, and are as they were there, are written as references to them;
    others are written beside the diagram as NAME_MODEL.yaml. The same holds for parts, which else stay inline.

    Args:
        diagram: Diagram to write.
        path: Ends in .yaml or .yml.

    Returns:
        The files written, the diagram's last.

    Raises:
        DescriptionError: Something that no file can state: a field that holds a Python object, a part that was changed
            after it was included.
    """
    file = Path(path)
    if file.suffix.lower() not in DIAGRAMS:
        raise DescriptionError(
            f"diagram '{diagram.name}' can't be written to '{file.name}'",
            file.suffix or "no suffix",
            f"it ends in {' or '.join(DIAGRAMS)}",
            "choose one of them",
        )
    writer = _Writer(file)
    document = {HEAD: VERSION, **writer.document(diagram)}
    for target, setup in writer.models.items():
        save(setup.system, target)
    write_atomically(file, yaml_text(_styled(document, 0)))
    return [*writer.models, file]


class _Writer:
    """Collects the models that have no file yet."""

    def __init__(self, file: Path) -> None:
        self.file, self.folder = file, resolved(file.parent)
        self.models: dict[Path, ModelSetup] = {}

    def document(self, diagram: Diagram) -> Plain:
        """The sections, empty ones left out."""
        replayed = _replayed(diagram)
        parts = {name: self.part(name, part) for name, part in diagram.parts.items()}
        own = [block for name, block in diagram.blocks.items() if name not in replayed.blocks]
        names = {block.name for block in own}
        loose = {
            f"{block}.{port}": source
            for (block, port), source in diagram.wires.items()
            if block not in names and (block, port) not in replayed.wires
        }
        sections: Plain = {
            "name": diagram.name,
            "models": {
                name: self.model(diagram.name, name, setup)
                for name, setup in diagram.models.items()
                if name not in replayed.models
            },
            "simulation": _settings(diagram.simulation),
            "blocks": {block.name: _block(diagram, block, self.folder) for block in own},
            "parts": parts,
            "wires": loose,
            "inlets": written_inlets(diagram),
            "outlets": {name: source for name, source in diagram.outlets.items() if name not in replayed.outlets},
        }
        return {key: value for key, value in sections.items() if value}

    def model(self, diagram: str, name: str, setup: ModelSetup) -> Plain:
        """A reference; the model's own file is written where there is none that still says the same."""
        entries = self.reference(setup)
        if entries is None:
            stem = "".join(c if c.isalnum() else "_" for c in f"{self.file.stem}_{name}")
            target = self.folder / f"{stem}.yaml"
            while target in self.models and self.models[target].system != setup.system:
                target = target.with_name(f"{target.stem}_.yaml")
            self.models[target] = setup
            entries = {"file": target.name}
        return entries | {
            key: write(value) for key, value in (("start", setup.start), ("parameters", setup.parameters)) if value
        }

    def reference(self, setup: ModelSetup) -> Plain | None:
        """Reference to the file that a model came from; None where that is elsewhere, or says something else by now."""
        origin = setup.file
        if origin is None or not Path(origin.path).is_relative_to(self.folder):
            return None
        stated = reading_entries(origin.reading, self.folder)
        if stated is None:
            return None
        try:
            system = load(origin.path, **origin.reading)
        except DescriptionError:
            return None
        if origin.functions is not None:
            system = with_functions(system, origin.functions)
        if system != setup.system:
            return None
        entries: Plain = {"file": Path(origin.path).relative_to(self.folder).as_posix()}
        if origin.functions is not None:
            entries["functions"] = origin.functions
        return entries | stated

    def part(self, name: str, part: Part) -> Plain:
        """A part by its file, or inline."""
        entries: Plain = {}
        path = Path(part.diagram.file) if part.diagram.file else None
        if path and path != resolved(self.file) and path.is_relative_to(self.folder) and _unchanged(part.diagram, path):
            entries["file"] = path.relative_to(self.folder).as_posix()
        else:
            inside = self.document(part.diagram)
            entries["diagram"] = {key: value for key, value in inside.items() if key != "simulation"}
        more = {"models": dict(part.models), "inputs": dict(part.inputs), "condition": _condition(part.condition)}
        more["parameters"] = {key: write(value) for key, value in part.parameters.items()}
        return entries | {key: value for key, value in more.items() if value}


def _replayed(diagram: Diagram) -> Diagram:
    """A new diagram that includes the parts of a diagram, and nothing else.

    Raises:
        DescriptionError: A part was changed after it was included.
    """
    replayed = Diagram(diagram.name)
    for name, part in diagram.parts.items():
        replayed.include(name, part.diagram, part.models, part.condition, part.parameters, **part.inputs)
        changed = [
            key
            for key, block in replayed.blocks.items()
            if key.startswith(name + INSIDE) and not _alike(block, diagram.blocks.get(key))
        ]
        changed += [key for key, setup in replayed.models.items() if diagram.models.get(key) != setup]
        changed += [".".join(key) for key, source in replayed.wires.items() if diagram.wires.get(key) != source]
        if changed:
            raise DescriptionError(
                f"diagram '{diagram.name}': part '{name}' can't be written",
                changed[0],
                "a part is written as it was included",
                "change the part before it is included",
            )
    return replayed


def _condition(condition: Condition | None) -> Plain:
    """What a condition states that it would not be without."""
    if condition is None:
        return {}
    stated = {item.name: getattr(condition, item.name) for item in fields(condition)}
    return {key: write(value) for key, value in stated.items() if value and value != vars(Condition).get(key)}


def _unchanged(diagram: Diagram, path: Path) -> bool:
    """Whether the file of a part still states the part's diagram."""
    try:
        stated = load_diagram(path, network=True)
    except DescriptionError:
        return False
    outside = stated.blocks.keys() ^ diagram.blocks.keys()
    return (
        not outside
        and all(_alike(block, diagram.blocks[name]) for name, block in stated.blocks.items())
        and (
            (stated.models, stated.wires, stated.outlets) == (diagram.models, diagram.wires, diagram.outlets)
            and written_inlets(stated) == written_inlets(diagram)
        )
    )


def _alike(a: Block, b: Block | None) -> bool:
    """Whether two blocks say the same."""
    if type(a) is not type(b):
        return False
    pairs = [(getattr(a, f.name), getattr(b, f.name)) for f in fields(a) if f.init and f.name != CONSENT]
    return all(_alike(*pair) if isinstance(pair[0], Block) else same(*pair) for pair in pairs)


def _path(value: Any, folder: Path) -> str:
    """A file that a block names, from the diagram's folder.

    Raises:
        TypeError: It lies elsewhere.
    """
    path = resolved(Path(str(value)))
    if not path.is_relative_to(folder):
        raise TypeError(f"'{value}' lies outside the diagram's folder")
    return path.relative_to(folder).as_posix()


def _block(diagram: Diagram, block: Block, folder: Path) -> Plain:
    entries: Plain = {"kind": kind_of(type(block))}
    for item in fields(block):
        value = getattr(block, item.name)
        default = item.default if item.default is not MISSING else None
        if item.default_factory is not MISSING:
            default = item.default_factory()
        has_default = item.default is not MISSING or item.default_factory is not MISSING
        if item.name in ("name", CONSENT) or not item.init or (has_default and same(value, default)):
            continue
        try:
            entries[entry_of(item.name)] = _path(value, folder) if item.name in block.paths and value else write(value)
        except TypeError as error:
            raise DescriptionError(
                f"diagram '{diagram.name}': block '{block.name}' can't be written: {item.name}",
                f"{error}",
                "files state numbers, texts, lists of them, and files of their folder",
                "copy such a file there, or keep this diagram in Python",
            ) from None
    inputs = {port: source for (name, port), source in diagram.wires.items() if name == block.name}
    return entries | ({"inputs": inputs} if inputs else {})


def _settings(settings: RunSettings) -> Plain:
    stated: Plain = {"t_end": settings.t_end} if settings.t_end is not None else {}
    stated |= settings.keywords()
    if settings.plots:
        stated["plots"] = [
            {"title": plot.title, "signals": list(plot.signals)} | ({"xy": True} if plot.xy else {})
            for plot in settings.plots
        ]
    return {key: write(value) for key, value in stated.items()}


def _styled(value: Any, depth: int) -> Any:
    """Sections and named things on lines of their own, small things in braces and brackets."""
    if isinstance(value, list):
        sequence = CommentedSeq(_styled(item, 9) for item in value)
        if not any(isinstance(item, Mapping) for item in value):
            sequence.fa.set_flow_style()
        return sequence
    if not isinstance(value, Mapping):
        return value_text(value) if isinstance(value, str) else value
    mapping = CommentedMap(
        (key_text(key), _styled(item, depth + (2 if key == "inputs" else 1))) for key, item in value.items()
    )
    inside = "diagram" in value or any(key in value for key in ("models", "blocks", "parts"))
    if depth > 2 and not inside and not any(isinstance(item, Mapping) for item in value.values()):
        mapping.fa.set_flow_style()
    return mapping
