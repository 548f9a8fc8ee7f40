"""<include> of SDFormat: other models of folders that may be read, put in their places as nested models.

What an <include> states, <name>, <pose> and <static>, replaces what the model states of itself. With `merge` the
model's contents become the including model's own, placed by a frame `_merged__NAME__model__`, as SDFormat has it. How
deep includes go, how many there are and how many elements they bring is bounded.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from symofros.base.sources import Source
from symofros.description.packages import MAX_SHOWN, Packages
from symofros.description.reading import read_bytes, resolved
from symofros.description.sdf.frames import MODEL
from symofros.description.sdf.values import SdfValues
from symofros.description.xml_nodes import Element, parse_xml
from symofros.errors import Argument, DescriptionError, Problem

MAX_BYTES = 16 << 20
MAX_INCLUDES, MAX_DEPTH, MAX_ELEMENTS = 1000, 16, 300_000
_VERSIONS = re.compile(r"1\.([5-9]|1[0-9])\Z")
_IN_FRAME = frozenset({"relative_to", "frame"})
_MODEL = re.compile(r"model://([^/]+)(?:/(.*))?\Z")
_RULE = "an <include> names a model's folder, or file, by <uri>: model://NAME, or a path from the file's folder"
_KNOWN = frozenset({"uri", "name", "pose", "static", "placement_frame"})


class Includes:
    """Replaces each <include> of a document by the model that it names.

    Args:
        packages: Folders that may be read.
        values: Collects faults and remarks, and knows the version of each file.

    Attributes:
        sources: Files that were read.
    """

    def __init__(self, packages: Packages, values: SdfValues) -> None:
        self.packages, self.values = packages, values
        self.sources: list[Source] = []
        self._models: dict[Path, Element | None] = {}
        self._count = self._elements = 0

    def expand(self, element: Element, folder: Path, within: tuple[Path, ...] = ()) -> None:
        """Put models in the places of the includes of an element and of the models in it.

        Args:
            element: A <world>, <model> or root element.
            folder: Folder of its file.
            within: Files that are being included, the outermost first.

        Raises:
            DescriptionError: There are more than anybody uses.
        """
        children: list[Element] = []
        for child in element.children:
            if child.tag == "include":
                children += self._included(child, element, folder, within)
            else:
                children.append(child)
            if child.tag in ("model", "world"):
                self.expand(child, folder, within)
        element.children = children

    def _included(
        self, include: Element, element: Element, folder: Path, within: tuple[Path, ...]
    ) -> Iterator[Element]:
        """The elements that replace an <include>; none if it is refused."""
        self._count += 1  # Also of those that are refused: each takes time, and may be a fault to tell.
        self._check_bounds(include)
        if not self._is_plain(include, element):
            return
        file = self._file(include, folder)
        if file is None:
            return
        if file in within or len(within) >= MAX_DEPTH:
            chain = " -> ".join(path.parent.name for path in (*within, file))
            rule = f"includes are nested {MAX_DEPTH} deep at most, and in no circle"
            self.values.fault(include, "includes are nested too deep", f"{chain:.300}", rule, "drop one of them")
            return
        model = self._model(include, file)
        if model is None:
            return
        self._elements += _size(model)
        self._check_bounds(include)
        copy = _copied(model)
        self._override(copy, include)
        self.expand(copy, file.parent, (*within, file))
        if self.values.truth(include.attributes.get("merge", "false"), include, "<include>"):
            yield from merged(copy, include)
        else:
            yield copy

    def _check_bounds(self, include: Element) -> None:
        """Refuse more than anybody uses.

        Raises:
            DescriptionError: It is more.
        """
        if self._count > MAX_INCLUDES or self._elements > MAX_ELEMENTS:
            stated = f"more than {MAX_INCLUDES} includes, or {MAX_ELEMENTS} elements in them"
            raise DescriptionError(
                "the file includes too much", stated, "a mechanism is smaller", "split it", include.where
            )

    def _is_plain(self, include: Element, within: Element) -> bool:
        """Whether it is placed by its own frame, and merged into a model if at all."""
        placement = self.values.text(include, "placement_frame")
        merge = self.values.truth(include.attributes.get("merge", "false"), include, "<include>")
        static = include.first("static") is not None
        if placement:
            found, remedy = f"placement_frame '{placement:.60}'", "state the pose of the model's frame"
        elif merge and (within.tag != "model" or static):
            found = f"merge in <{within.tag}>{', with <static>' if static else ''}"
            remedy = "leave merge out, or merge it into a <model>, which then says whether it is static"
        else:
            for child in (child for child in include.children if child.tag not in _KNOWN):
                self.values.remarks.add(f"<{child.tag:.60}> of <include> ignored", "include", f"line {include.line}")
            return True
        rule = "an included model is placed by its own frame, and becomes part of a model by merge"
        self.values.fault(include, "the <include> can't be read", found, rule, remedy)
        return False

    def _file(self, include: Element, folder: Path) -> Path | None:
        """The file that an <include> names; None after a fault."""
        uri = self.values.text(include, "uri").removeprefix("file://")
        model = _MODEL.match(uri)
        argument: Argument | None = None
        if model:
            root = self.packages.model(model[1])
            place = None if root is None else self.packages.file(model[2] or ".", root)
            if root is None:
                argument = Argument("packages", "FOLDER", f"{model[1]:.{MAX_SHOWN}}")
        elif uri and "://" not in uri and "\0" not in uri and not Path(uri).is_absolute():
            place, stated = self.packages.file(uri, folder), resolved(folder) / uri
            if place is None and os.path.exists(stated):
                argument = self.packages.widening(stated)
        else:
            self.values.fault(include, "<include> names no model", f"<uri> '{uri:.80}'", _RULE, "mend its <uri>")
            return None
        file = None if place is None else self._of_folder(place) if os.path.isdir(place) else place
        if file is not None and os.path.isfile(file):
            return file
        self._not_found(include, uri, file is not None, argument)
        return None

    def _not_found(self, include: Element, uri: str, readable: bool, argument: Argument | None) -> None:
        """Note that an included file is missing, where its place may be read, or that it may not."""
        if argument is not None:
            remedy = f"name its folder, or the folder of models that it lies in: {argument.call}"
        elif readable:
            remedy = "mend its <uri>, or put the file there"
        else:
            remedy = "mend its <uri>, copy the model beside the file, or name its folder as one of packages"
        found = "no such file there" if readable else "no such file there, or it may not be read"
        rule = "included models lie in the folder of the file or below, in a model's folder beside it, or where you say"
        what = f"the included model '{uri:.80}' is not found"
        self.values.add(Problem(what, found, rule, remedy, self.values.where(include), argument))

    def _of_folder(self, folder: Path) -> Path | None:
        """The SDFormat file of a model's folder, by model.config or else model.sdf; None if it may not be read."""
        config = folder / "model.config"
        if not os.path.isfile(config) or not self.packages.allows(resolved(config)):
            return self.packages.file("model.sdf", folder)
        try:
            root = parse_xml(read_bytes(config, MAX_BYTES), str(config))
        except DescriptionError:
            return self.packages.file("model.sdf", folder)
        files = [(_version(child), child.text) for child in root.all("sdf") if child.text and "\0" not in child.text]
        name = max(files, default=(0, "model.sdf"))[1]
        return self.packages.file(name, folder)

    def _model(self, include: Element, file: Path) -> Element | None:
        """The model of a file; None after a fault, which is noted once."""
        if file not in self._models:
            self._models[file] = self._read(include, file)
        return self._models[file]

    def _read(self, include: Element, file: Path) -> Element | None:
        try:
            content = read_bytes(file, MAX_BYTES)
            root = parse_xml(content, str(file))
        except DescriptionError as error:
            refusal = error.problems[0]
            self.values.add(replace(refusal, what=f"an included model: {refusal.what}"))
            return None
        self.sources.append(Source.of(file, content))
        models = list(root.all("model"))
        if self.version(root) is None:
            return None
        if len(models) != 1 or root.first("world"):
            rule, remedy = "an included file holds one <model>", "include a file of one model"
            self.values.fault(root, "the included file holds no model, or several", f"{len(models)}", rule, remedy)
            return None
        return models[0]

    def version(self, root: Element) -> int | None:
        """Minor version of a file, which is noted; None after a fault."""
        stated = root.attributes.get("version", "")
        if root.tag != "sdf" or not _VERSIONS.match(stated):
            self.values.fault(
                root,
                "the file is no SDFormat of version 1.5 or later",
                f'<{root.tag:.60} version="{stated:.20}">',
                "the root element is <sdf>, its version 1.5 to 1.19",
                "convert an older file by `gz sdf --print FILE`",
            )
            return None
        self.values.versions[root.file] = int(stated.removeprefix("1."))
        return self.values.versions[root.file]

    def _override(self, model: Element, include: Element) -> None:
        """Let an <include> state name, pose and whether the model is static."""
        name = self.values.text(include, "name")
        if name:
            model.attributes["name"] = name
        stated = [child for child in include.children if child.tag in ("pose", "static")]
        replaced = {child.tag for child in stated}
        model.children = [*stated, *(child for child in model.children if child.tag not in replaced)]


def merged(model: Element, include: Element) -> list[Element]:
    """The contents of an included model for the including one, after a proxy frame for the model's own.

    Args:
        model: The included model, with what the <include> overrides of it.
        include: The <include>.
    """
    proxy = f"_merged__{model.attributes.get('name', '')}__model__"
    pose = model.first("pose") or Element("pose", {}, include.line, file=include.file)
    stated = pose.attributes if pose.attributes.keys() & _IN_FRAME else {"relative_to": MODEL, **pose.attributes}
    parts = (part.attributes.get("name", "") for tag in ("link", "model") for part in model.all(tag))
    canonical = model.attributes.get("canonical_link") or next(parts, "")
    placed = replace(pose, attributes=dict(stated))
    frame = Element("frame", {"name": proxy, "attached_to": canonical}, include.line, [placed], include.file)
    contents = [child for child in model.children if child.tag not in ("pose", "static")]
    for child in contents:
        _refer(child, proxy)
    return [frame, *contents]


def _refer(element: Element, proxy: str) -> None:
    """Redirect an element's references to the frame of a merged model, named or implied, to its proxy frame."""
    if element.tag in ("link", "frame", "model"):
        pose = element.first("pose")
        if pose is None:
            pose = Element("pose", {}, element.line, file=element.file)
            element.children.append(pose)
        if not pose.attributes.keys() & _IN_FRAME and not element.attributes.get("attached_to"):
            pose.attributes["relative_to"] = proxy
        if element.tag == "frame" and not element.attributes.get("attached_to"):
            element.attributes["attached_to"] = proxy
    # What is in a nested model means that one's frame.
    pending = [*element.all("pose")] if element.tag == "model" else [element]
    while pending:
        part = pending.pop()
        pending += part.children
        for name in ("relative_to", "attached_to", "expressed_in", "frame"):
            if part.attributes.get(name) == MODEL:
                part.attributes[name] = proxy
        if part.tag in ("parent", "child") and part.text == MODEL:
            part.text = proxy


def _version(element: Element) -> int:
    stated = _VERSIONS.match(element.attributes.get("version", ""))
    return int(stated[1]) if stated else 0


def _copied(element: Element) -> Element:
    return replace(element, attributes=dict(element.attributes), children=[_copied(one) for one in element.children])


def _size(element: Element) -> int:
    return 1 + sum(map(_size, element.children))
