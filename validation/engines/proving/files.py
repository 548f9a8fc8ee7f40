"""Files made simpler where their formats say what that means for the tree that they state."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from xml.etree import ElementTree

from ..interface import IDENTITY, ORIGIN, Tree
from .pieces import Pieces

Element = ElementTree.Element
_URDF = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
_MJCF = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
_SDF = "<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>"
_INERTIALS = {"urdf": _URDF, "mjcf": _MJCF, "sdf": _SDF}


@dataclass(frozen=True)
class File:
    """A file and the tree that it states.

    Attributes:
        form: Its format.
        text: Its text.
        tree: The tree.
        pieces: A state of the tree.
    """

    form: str
    text: str
    tree: Tree
    pieces: Pieces


def simpler(file: File) -> Iterator[File]:
    """The file without its last link, with links of one kilogram at their origins, with joints unplaced."""
    for k, link in enumerate(file.tree.links):
        if k == len(file.tree.links) - 1 and k:
            yield from _without(file, link.name)
        yield from _plain(file, k)
        yield from _unplaced(file, k)


def _text(root: Element) -> str:
    return ElementTree.tostring(root, encoding="unicode").replace(" />", "/>")


def _body(root: Element, name: str) -> Element | None:
    """The element of a link."""
    return next((one for one in root.iter() if one.tag in ("link", "body") and one.get("name") == name), None)


def _without(file: File, name: str) -> Iterator[File]:
    root = ElementTree.fromstring(file.text)
    for parent in list(root.iter()):
        for child in list(parent):
            named = child.tag in ("link", "body") and child.get("name") == name
            held = child.tag == "joint" and child.find("child") is not None and child.get("name") == f"joint_{name}"
            if named or held:
                parent.remove(child)
    tree = replace(file.tree, links=file.tree.links[:-1])
    yield replace(file, text=_text(root), tree=tree, pieces=file.pieces[:-1])


def _plain(file: File, k: int) -> Iterator[File]:
    """An element <inertial> of a kilogram and unit moments, in place of the link's."""
    root = ElementTree.fromstring(file.text)
    body = _body(root, file.tree.links[k].name)
    inertial = None if body is None else body.find("inertial")
    if body is None or inertial is None:
        return
    place = list(body).index(inertial)
    body.remove(inertial)
    body.insert(place, ElementTree.fromstring(_INERTIALS[file.form]))
    link = replace(file.tree.links[k], mass=1.0, com=ORIGIN, inertia=IDENTITY)
    yield _changed(file, root, k, link)


def _unplaced(file: File, k: int) -> Iterator[File]:
    """A joint at the origin of the link before, along its axes; SDF places links in other ways, too."""
    link = file.tree.links[k]
    if len(link.joints) != 1:
        return
    root = ElementTree.fromstring(file.text)
    if file.form == "urdf":
        joint = next((one for one in root.iter("joint") if one.get("name") == f"joint_{link.name}"), None)
        origin = None if joint is None else joint.find("origin")
        if joint is None or origin is None:
            return
        joint.remove(origin)
    elif file.form == "mjcf":
        body = _body(root, link.name)
        if body is None or not set(body.keys()) <= {"name", "pos"}:
            return
        body.attrib.pop("pos", None)
    else:
        return
    yield _changed(file, root, k, replace(link, joints=(replace(link.joints[0], R=IDENTITY, p=ORIGIN),)))


def _changed(file: File, root: Element, k: int, link: object) -> File:
    links = (*file.tree.links[:k], link, *file.tree.links[k + 1 :])
    return replace(file, text=_text(root), tree=replace(file.tree, links=links))  # type: ignore[arg-type]
