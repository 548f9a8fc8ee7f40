"""MJCF in: MuJoCo's own compiler reads the model, and what it compiled becomes our description.

A model file is untrusted. MuJoCo never sees it: it gets a text that is written anew from what a whitelist keeps
(`mjcf_sections`), and the content of meshes that we have read (`mjcf_meshes`), so that it opens no file itself.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

from symofros.description.imported.building import reading_of
from symofros.description.imported.options import DEFAULT_OPTIONS, ImportOptions
from symofros.description.mjcf.files import Folder
from symofros.description.mjcf.meshes import Meshes
from symofros.description.mjcf.model import Importer, Stated
from symofros.description.mjcf.sections import Sections
from symofros.description.mjcf.visuals import textures_of
from symofros.description.packages import Packages
from symofros.description.reading import Reading
from symofros.description.remarks import Remarks
from symofros.description.xml_nodes import Element
from symofros.errors import DescriptionError, Problem

_LINE = re.compile(r",? ?line (\d+)")
MAX_WARNINGS = 10


def read_mjcf(
    path: str | os.PathLike[str], options: ImportOptions = DEFAULT_OPTIONS, *, packages: Packages | None = None
) -> Reading:
    """Read an MJCF file; needs the package `mujoco`.

    Args:
        path: The main file; what it includes, and the meshes that give inertia, lie in its folder or below.
        options: How it is read.
        packages: Further folders that its files may be read from.

    Returns:
        The system, and every problem.

    Raises:
        DescriptionError: The file can't be read.
    """
    folder, remarks = Folder(Path(path), packages), Remarks()
    document = vetted(folder, remarks)
    if folder.problems:
        raise DescriptionError(folder.problems)
    model = compiled(document, remarks)
    return reading_of(Importer(model, document.stated, remarks, options).tree())


@dataclass(frozen=True)
class Document:
    """A document as it is handed to MuJoCo.

    Attributes:
        text: MJCF of nothing but a tree of bodies.
        lines: The element that each line of the text came from.
        assets: Content of mesh files by name.
        stated: Entries of the document that the compiled model does not keep.
    """

    text: str
    lines: tuple[Element, ...]
    assets: dict[str, bytes]
    stated: Stated


def vetted(folder: Folder, remarks: Remarks) -> Document:
    """Read the model's files and keep what describes a tree; the folder collects the faults.

    Raises:
        DescriptionError: The main file can't be read, is too large, is no XML, or is no MJCF.
    """
    root = folder.document()
    if root.tag != "mujoco":
        remedy = "name a URDF file .urdf" if root.tag == "robot" else ""
        raise DescriptionError(
            "the file is not an MJCF model",
            f"the root element is <{root.tag:.60}>",
            "the root element is <mujoco>",
            remedy,
            root.where,
        )
    sections = Sections(folder, remarks)
    kept = sections.kept(root)
    meshes = Meshes(folder, kept, root, remarks)
    meshes.cut()
    pairs = list(_written(kept))
    name = root.attributes.get("model") or folder.main.stem
    stated = Stated(name, str(folder.main), _places(kept), meshes.drawn, meshes.by_name, textures_of(folder, root))
    return Document("\n".join(line for line, _ in pairs), tuple(e for _, e in pairs), meshes.assets, stated)


def compiled(document: Document, remarks: Remarks) -> Any:
    """The model that MuJoCo compiles from a document.

    Raises:
        DescriptionError: MuJoCo is not installed, or refuses the model.
    """
    try:
        import mujoco  # Only those who read MJCF need it.
    except ImportError as error:
        raise DescriptionError.of_extra(
            f"'{document.stated.file}' can't be read: MJCF needs MuJoCo",
            str(error),
            "MuJoCo's own compiler reads MJCF files",
            "mjcf",
        ) from None
    try:
        with _warnings(mujoco, remarks):
            return mujoco.MjModel.from_xml_string(document.text, document.assets)
    except (ValueError, mujoco.FatalError) as error:
        raise DescriptionError(_explained(str(error), document)) from None


def _explained(message: str, document: Document) -> Problem:
    """MuJoCo's complaint, which names a line of our text, about the line of the file."""
    match = _LINE.search(message)
    line = int(match[1]) if match else 0
    where = document.lines[line - 1].where if 0 < line <= len(document.lines) else document.stated.file
    complaint, _, rest = _LINE.sub("", message).strip().partition("\n")
    complaint = complaint.removeprefix("XML ").removeprefix("Error: ").strip()
    return Problem(
        f"MuJoCo refuses the model: {complaint:.300}",
        f"{rest.strip():.300}",
        "MuJoCo's own compiler reads MJCF files",
        "mend what it complains of; MuJoCo's XML reference says what each attribute may be",
        where,
    )


@contextmanager
def _warnings(mujoco: Any, remarks: Remarks) -> Iterator[None]:
    """MuJoCo's warnings as remarks; it would log them into the folder that the user happens to be in."""
    said: list[str] = []
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(said.append)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)
        for text in said[:MAX_WARNINGS]:
            remarks.add("MuJoCo warns", "remark", " ".join(text.split())[:200])


def _written(element: Element) -> Iterator[tuple[str, Element]]:
    """The element as text, a tag a line, each with the element it came from."""
    attributes = "".join(f" {name}={quoteattr(text)}" for name, text in element.attributes.items())
    if not element.children:
        yield f"<{element.tag}{attributes}/>", element
        return
    yield f"<{element.tag}{attributes}>", element
    for child in element.children:
        yield from _written(child)
    yield f"</{element.tag}>", element


def _places(element: Element) -> dict[tuple[str, ...], str]:
    """(kind, name) of named bodies, joints and constraints -> place in the file."""
    kinds = {"body": "body", "joint": "joint", "freejoint": "joint"}
    places: dict[tuple[str, ...], str] = {}
    pending = list(element.children)
    for item in (item for section in element.all("equality") for item in section.children if "name" in item.attributes):
        places["constraint", item.attributes["name"]] = item.where
    pending = [child for child in pending if child.tag != "equality"]
    while pending:
        item = pending.pop()
        pending += item.children
        if item.tag in kinds and "name" in item.attributes:
            places[kinds[item.tag], item.attributes["name"]] = item.where
    return places
