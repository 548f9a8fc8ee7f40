"""Frames of an SDFormat file: poses that refer to each other, resolved to poses in the world and to bodies.

Names are those of SDFormat: `model::link` from outside of a nested model, `__model__` for a model's own frame. The
frame of a link, model or <frame> without `attached_to` is stated in that of its model, of a joint in that of its child.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from symofros.description.frames import IDENTITY_POSE, Pose
from symofros.description.joints.joint import WORLD
from symofros.description.sdf.values import SdfValues
from symofros.description.xml_nodes import Element
from symofros.errors import did_you_mean

MODEL = "__model__"
SEPARATOR = "::"


@dataclass
class FrameNode:
    """One frame of the file.

    Attributes:
        element: The link, joint, frame or model that it belongs to.
        scope: Prefix of names in its model; "" outside of named models.
        pose: Its pose in the frame that it refers to.
        relative_to: Full name of that frame.
        attached_to: Full name of the frame whose body it is fixed to; "" for a link and the world.
    """

    element: Element
    scope: str
    pose: Pose
    relative_to: str
    attached_to: str


class Frames:
    """The frames of a file by their full names.

    Args:
        values: Reads the numbers.
        root: Element of the file.
    """

    def __init__(self, values: SdfValues, root: Element) -> None:
        self.values = values
        self.nodes: dict[str, FrameNode] = {WORLD: FrameNode(root, "", IDENTITY_POSE, "", "")}
        self._in_world: dict[str, Pose] = {WORLD: IDENTITY_POSE}
        self._bodies: dict[str, str] = {WORLD: WORLD}

    def add(self, name: str, element: Element, scope: str, default: str, attached_to: str = "") -> None:
        """Add a frame.

        Args:
            name: Full name.
            element: Element with its <pose>.
            scope: Prefix of the names that its attributes use.
            default: Full name of the frame that it refers to where it names none.
            attached_to: Full name of the frame whose body it is fixed to.
        """
        owner = f"{element.tag} '{name}'"
        if name in self.nodes:
            self.values.fault(
                element,
                f"{owner}: the name is taken",
                f"lines {self.nodes[name].element.line} and {element.line}",
                "links, joints, frames and models of a model have different names",
                "rename one of them",
            )
            return
        stated = element.first("pose")
        relative_to = self.values.pose_frame(stated, owner)
        full = self.full(scope, relative_to) if relative_to else default
        self.nodes[name] = FrameNode(element, scope, self.values.pose(stated, owner), full, attached_to)

    def full(self, scope: str, name: str) -> str:
        """Full name of what a model calls by a name; of a model in it, that of its frame."""
        if name == WORLD and scope + name not in self.nodes:
            return WORLD
        own = f"{scope}{SEPARATOR}{name}" if scope else name
        return f"{own}{SEPARATOR}{MODEL}" if f"{own}{SEPARATOR}{MODEL}" in self.nodes else own

    def of_model(self, scope: str) -> str:
        """Full name of the frame of the model with a prefix of names, which is "" for a single one; else the world."""
        own = self.full(scope, MODEL)
        return own if own in self.nodes else WORLD

    def check(self) -> None:
        """Note the frames that refer to none or to each other in a circle, and take them for the world's."""
        for name, node in list(self.nodes.items()):
            for label in ("relative_to", "attached_to"):
                target = self.full("", getattr(node, label))
                if target and target not in self.nodes:
                    near = [other.removeprefix(node.scope + SEPARATOR) for other in self.nodes if other != name]
                    self.values.fault(
                        node.element,
                        f"{node.element.tag} '{name}': there is no frame '{target}'",
                        f"{label} '{target}'",
                        "poses refer to links, joints, frames and models of their model",
                        did_you_mean(target, near),
                    )
                    target = WORLD
                setattr(node, label, target)
        for label in ("relative_to", "attached_to"):
            for circle in list(self._circles(label)):
                node = self.nodes[circle[0]]
                self.values.fault(
                    node.element,
                    f"{node.element.tag} '{circle[0]}': its frame refers to itself",
                    " -> ".join([*circle, circle[0]][:6]),
                    "frames refer to each other without a circle",
                    f"name another frame as {label}",
                )
                setattr(node, label, WORLD)

    def _circles(self, label: str) -> Iterator[list[str]]:
        """Frames that refer to each other in a circle, each circle once; every frame is looked at once."""
        looked_at: set[str] = set()
        for name in self.nodes:
            passed: dict[str, None] = {}
            while name in self.nodes and name not in looked_at:
                looked_at.add(name)
                passed[name] = None
                name = getattr(self.nodes[name], label)
            if name in passed:
                chain = list(passed)
                yield chain[chain.index(name) :]

    def in_world(self, name: str) -> Pose:
        """Pose of a frame in the world, where all coordinates are as the file places the links."""
        chain = [name]
        while chain[-1] not in self._in_world:
            chain.append(self.nodes[chain[-1]].relative_to or WORLD)
        for frame in reversed(chain[:-1]):
            node = self.nodes[frame]
            self._in_world[frame] = self._in_world[node.relative_to or WORLD] @ node.pose
        return self._in_world[name]

    def relative(self, name: str, to: str) -> Pose:
        """Pose of a frame in another one."""
        node = self.nodes[name]
        if node.relative_to == to:  # Not one rounding more than the file has.
            return node.pose
        return self.in_world(to).inverse() @ self.in_world(name)

    def body(self, name: str) -> str:
        """Full name of the link that a frame is fixed to, or the world."""
        chain = [name]
        while chain[-1] not in self._bodies:
            node = self.nodes[chain[-1]]
            if node.element.tag == "link" or not node.attached_to:
                self._bodies[chain[-1]] = chain[-1] if node.element.tag == "link" else WORLD
            else:
                chain.append(node.attached_to)
        self._bodies |= dict.fromkeys(chain, self._bodies[chain[-1]])
        return self._bodies[name]
