"""SDFormat in, as its specification and Drake read it: models of links, whose roots float unless a joint holds them.

A file is untrusted: its size is bounded, document types are refused, models that it includes lie in folders that may be
read (`includes.py`), and meshes are only named, where they lie in these.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from symofros.base.sources import Source
from symofros.description.forces import Load
from symofros.description.frames import Frame
from symofros.description.imported.building import reading_of
from symofros.description.imported.geometry import Exact
from symofros.description.imported.options import DEFAULT_OPTIONS, ImportOptions
from symofros.description.imported.tree import GRAVITY, ImportedBody, ImportedTree
from symofros.description.joints.joint import WORLD
from symofros.description.packages import Packages
from symofros.description.reading import Reading, read_bytes, resolved
from symofros.description.sdf.frames import MODEL, SEPARATOR, Frames
from symofros.description.sdf.includes import Includes
from symofros.description.sdf.joints import JointReader, SdfJoint
from symofros.description.sdf.values import SdfValues
from symofros.description.urdf.visuals import Visuals
from symofros.description.visual import Visual
from symofros.description.xml_nodes import Element, parse_xml
from symofros.errors import DescriptionError, Problem

# Shape -> its sizes, which are children here and attributes in URDF.
_SIZES = {
    "box": {"size": "size"},
    "sphere": {"radius": "radius"},
    "cylinder": {"radius": "radius", "length": "length"},
    "capsule": {"radius": "radius", "length": "length"},
    "mesh": {"uri": "filename", "scale": "scale"},
}


def as_urdf(link: Element) -> Element:
    """A link of nothing but its visual shapes, as URDF states them."""
    return Element("link", {}, link.line, [_visual(visual) for visual in link.all("visual")], link.file)


def _visual(visual: Element) -> Element:
    line, children = visual.line, list[Element]()
    pose, geometry, material = (visual.first(tag) for tag in ("pose", "geometry", "material"))
    if pose is not None and pose.text:
        entries = pose.text.split()
        # Other than x y z roll pitch yaw in radians is no URDF, which the reader of visuals then says.
        plain = not any(pose.attributes.get(label) for label in ("relative_to", "frame", "rotation_format", "degrees"))
        placed = {"xyz": " ".join(entries[:3]), "rpy": " ".join(entries[3:]) if plain else "?"}
        children.append(Element("origin", placed, line))
    shape = geometry.children[0] if geometry is not None and geometry.children else None
    if shape is not None:
        names = _SIZES.get(shape.tag, {})
        sizes = {names[child.tag]: child.text for child in shape.children if child.tag in names}
        children.append(Element("geometry", {}, line, [Element(shape.tag, sizes, line)]))
    diffuse = material.first("diffuse") if material is not None else None
    if diffuse is not None:
        entries = diffuse.text.split()
        color = Element("color", {"rgba": " ".join(entries if len(entries) == 4 else [*entries, "1"])}, line)
        children.append(Element("material", {}, line, [color]))
    return Element("visual", dict(visual.attributes), line, children)


MAX_BYTES = 16 << 20
MAX_LINKS = 10_000
# Of no meaning to mechanics, so not worth a remark.
_SILENT = frozenset(
    {"pose", "gui", "scene", "light", "physics", "self_collide", "allow_auto_disable", "static", "gravity", "name"}
    | {"atmosphere", "magnetic_field", "spherical_coordinates", "audio", "state", "must_be_base_link"}
)
_READ = frozenset({"model", "link", "joint", "frame"})
# Gravity of a <world> that states none [m/s^2].
_GRAVITY = (0.0, 0.0, -9.8)


def read_sdf(
    path: str | os.PathLike[str], options: ImportOptions = DEFAULT_OPTIONS, *, packages: Packages | None = None
) -> Reading:
    """Read an SDFormat file, of version 1.5 or later.

    Args:
        path: The file; one <model>, or a <world> of models.
        options: How it is read.
        packages: Further folders that its files may be read from.

    Returns:
        The system, and every problem.

    Raises:
        DescriptionError: The file can't be read.
    """
    file = os.fspath(path)
    values = SdfValues(file, options.snap_tol)
    readable = packages or Packages(Path(path))
    includes = Includes(readable, values)
    content = read_bytes(Path(path), MAX_BYTES)
    root = parse_xml(content, file)
    if includes.version(root) is not None:
        includes.expand(root, readable.folder, (resolved(Path(path)),))
    # What refers to a model that is not there is no fault of its own.
    world = None if values.problems else _world(root, values)
    tree = None if world is None else _Importer(readable, values, world, options).tree()
    if tree is None:
        raise DescriptionError(values.problems)
    return reading_of(tree, (Source.of(Path(path), content), *includes.sources))


def _world(root: Element, values: SdfValues) -> Element | None:
    """The element that holds the models: the <world>, or the root."""
    worlds = list(root.all("world"))
    if len(worlds) > 1 or (worlds and root.first("model")):
        values.fault(
            root,
            "the file has several worlds, or a world beside a model",
            f"{len(worlds)} worlds",
            "one <world>, or one <model>",
            "keep one of them",
        )
        return None
    return worlds[0] if worlds else root


class _Importer:
    def __init__(self, packages: Packages, values: SdfValues, world: Element, options: ImportOptions) -> None:
        self.values, self.world, self.options = values, world, options
        self.exact = Exact(values.snap_tol)
        self.frames = Frames(values, world)
        self.joints = JointReader(values, self.frames, self.exact)
        self.visuals = Visuals(packages, world, values.remarks)
        self.links: dict[str, Element] = {}
        self.canonical: dict[str, str] = {}
        self.static: set[str] = set()
        self.origin: dict[tuple[str, ...], str] = {("system",): values.where(world)}

    def tree(self) -> ImportedTree | None:
        """The bodies of the file; None after faults, which are noted."""
        models = list(self.world.all("model"))
        if not models:
            self.values.fault(self.world, "there is no model", "no <model>", "a file holds a model", "add one")
            return None
        # A single model's names stand as they are; those of several have the model's name before them.
        alone = len(models) == 1 and self.world.tag == "sdf"
        for model in models:
            self.model(model, "" if alone else self.values.attribute(model, "name", "a model") or "?", "")
        self.scope(self.world, "", self.world.tag == "world")
        self.frames.check()
        if self.values.problems:
            return None
        named = models[0].attributes.get("name", "model")
        tree = ImportedTree(
            named if len(models) == 1 else self.world.attributes.get("name", "world"),
            self.options,
            self.values.where(self.world),
            remarks=self.values.remarks,
            exact=self.exact,
            gravity=self.gravity(),
            origin=self.origin,
            problems=self.values.problems,
        )
        self.grow(tree)
        tree.visuals = {name: shapes for name, link in self.links.items() if (shapes := self.shapes(name, link))}
        return tree

    def model(self, model: Element, scope: str, around: str) -> None:
        """Read a model: its frame, the models in it and its other contents.

        Args:
            model: The element.
            scope: Prefix of its names.
            around: Prefix of the names of the model that it is nested in; "" in the world.
        """
        if self.values.truth(self.values.text(model, "static", "false"), model, f"model '{scope}'"):
            self.static.add(scope)
        own = self.frames.full(scope, MODEL)
        # A model that is placed by one of its frames has its own where that leads it.
        placed = model.attributes.get("placement_frame")
        if placed:
            self.values.fault(
                model,
                f"model '{model.attributes.get('name')}' is placed by one of its frames",
                f"placement_frame '{placed:.60}'",
                "the pose of a model is that of its own frame",
                "state the pose of the model's frame, and drop placement_frame",
            )
        self.frames.add(own, model, around, self.frames.of_model(around))
        for inner in model.all("model"):
            name = self.values.attribute(inner, "name", "a model") or "?"
            self.model(inner, f"{scope}{SEPARATOR}{name}" if scope else name, scope)
        self.scope(model, scope, True)
        first = next(model.all("link"), None)
        named = model.attributes.get("canonical_link") or (
            first.attributes.get("name", "") if first is not None else ""
        )
        inner_models = [inner.attributes.get("name", "") for inner in model.all("model")]
        if named and own in self.frames.nodes:
            self.frames.nodes[own].attached_to = self.frames.full(scope, named)
        elif inner_models and own in self.frames.nodes:
            self.frames.nodes[own].attached_to = self.frames.full(scope, inner_models[0])

    def scope(self, element: Element, scope: str, remarked: bool) -> None:
        """Take up links, joints and frames of a model, or of the world."""
        default = self.frames.of_model(scope)
        for child in element.children:
            if child.tag not in _READ and child.tag not in _SILENT and remarked:
                name = child.attributes.get("name", f"line {child.line}")
                self.values.remarks.add(f"<{child.tag:.60}> ignored", "element", name)
            if child.tag not in _READ - {"model"} or element.tag == "sdf":
                continue
            stated = self.values.attribute(child, "name", f"a {child.tag}")
            if stated is None:
                continue
            name = f"{scope}{SEPARATOR}{stated}" if scope else stated
            if child.tag == "link":
                self.link(child, name, scope, default)
            elif child.tag == "joint":
                self.joints.add(name, child, scope)
                self.origin["joint", name] = self.origin["constraint", name] = self.values.where(child)
            else:
                attached = child.attributes.get("attached_to", "")
                to = self.frames.full(scope, attached) if attached else default
                self.frames.add(name, child, scope, to, to)
                self.origin["frame", name] = self.values.where(child)

    def link(self, element: Element, name: str, scope: str, default: str) -> None:
        """Take up a link."""
        self.frames.add(name, element, scope, default)
        if len(self.links) >= MAX_LINKS:
            problem = Problem("too many links", f"more than {MAX_LINKS}", f"at most {MAX_LINKS}", "split the model")
            raise DescriptionError(problem)
        self.links[name] = element
        self.values.remark_unread(element, "link", name)
        self.origin["body", name] = self.values.where(element)
        for tag in ("collision", "sensor", "light", "battery", "audio_source", "projector", "particle_emitter"):
            if element.first(tag):
                self.values.remarks.add(f"<{tag}> of links ignored", "link", name)
        for tag in ("kinematic", "enable_wind"):
            if self.values.truth(self.values.text(element, tag, "false"), element, f"link '{name}'"):
                self.values.remarks.add(f"<{tag}> ignored", "link", name)

    def grow(self, tree: ImportedTree) -> None:
        """Add bodies depth first, constraints, and frames."""
        above: dict[str, tuple[SdfJoint, str]] = {}
        below: dict[str, list[str]] = {}
        closing: list[SdfJoint] = []
        for joint in self.joints.joints.values():
            missing = [end for end in (joint.parent, joint.child) if end not in self.frames.nodes]
            parent, child = ("" if missing else self.frames.body(end) for end in (joint.parent, joint.child))
            if missing or child == WORLD or parent == child:
                ends = f"parent '{joint.parent}', child '{joint.child}'"
                rule = "a joint joins two different links, and its child is not the world"
                self.values.fault(
                    joint.element, f"joint '{joint.name}' joins no two links", ends, rule, "mend its ends"
                )
            elif self.is_static(child) and (joint.kind != "fixed" or not self.is_static(parent)):
                self.values.fault(
                    joint.element,
                    f"joint '{joint.name}' moves a link of a static model",
                    f"type '{joint.element.attributes.get('type')}', child '{joint.child}'",
                    "static models stand still in the world",
                    "drop <static>, or the joint",
                )
            elif child in above or self.carries(child, parent, above):
                closing.append(joint)
            else:
                above[child] = joint, parent
                below.setdefault(parent, []).append(child)
        closures = [made for joint in closing if (made := self.joints.closing(joint, tree.frames)) is not None]
        for name, node in self.frames.nodes.items():
            if node.element.tag == "frame":
                body = self.frames.body(name)
                frame = Frame(name, *self.exact.placement(*self.frames.relative(name, body)))
                tree.frames.setdefault(body, []).append(frame)
        tree.bodies = list(self.bodies(above, below))
        tree.constraints = (*closures, *self.joints.couplings())

    @staticmethod
    def carries(child: str, parent: str, above: dict[str, tuple[SdfJoint, str]]) -> bool:
        """Whether a link carries, through others, the one that is to be its parent."""
        while parent in above and parent != child:
            parent = above[parent][1]
        return parent == child

    def bodies(self, above: dict[str, tuple[SdfJoint, str]], below: dict[str, list[str]]) -> Iterator[ImportedBody]:
        """The bodies, depth first, children in the order of the file."""
        stack = [name for name in reversed(list(self.links)) if name not in above or above[name][1] == WORLD]
        while stack:
            name = stack.pop()
            stack.extend(reversed(below.get(name, [])))
            body = self.root(name) if name not in above else self.joints.carried(above[name][0], name, above[name][1])
            element = self.links[name]
            body.inertia = self.values.mass_properties(element, name)
            if not self.values.truth(self.values.text(element, "gravity", "true"), element, f"link '{name}'"):
                self.values.remarks.add("gravity of links is switched off by a load", "link", name)
                mass = float(body.inertia.mass) if isinstance(body.inertia.mass, float) else 0.0
                x, y, z = (-mass * g for g in self.gravity())
                body.loads = (Load((x, y, z), at="center_of_mass", axes="world"),)
            yield body

    def is_static(self, link: str) -> bool:
        """Whether a link is of a static model, or the world."""
        return link == WORLD or any(not scope or link.startswith(scope + SEPARATOR) for scope in self.static)

    def root(self, name: str) -> ImportedBody:
        """A link that no joint holds: it floats, unless its model is static."""
        if self.is_static(name):
            self.values.remarks.add("links of static models are fixed to the world", "link", name)
            return ImportedBody(name, placement=self.exact.placement(*self.frames.relative(name, WORLD)))
        self.values.remarks.add("links without a joint to the world float", "link", name)
        return ImportedBody(name, floats=True)

    def gravity(self) -> tuple[float, float, float]:
        """Acceleration of gravity: the world's, or, of a model by itself, that of our descriptions [m/s^2]."""
        default = _GRAVITY if self.world.tag == "world" else GRAVITY
        x, y, z = self.values.given(self.world, "gravity", "the world", default)
        return x, y, z

    def shapes(self, name: str, link: Element) -> tuple[Visual, ...]:
        """Visual shapes of a link."""
        return self.visuals.of(as_urdf(link), name, Path(link.file).parent)
