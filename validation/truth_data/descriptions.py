"""A tree as files: URDF and MJCF where those formats have its joints, our YAML always, and its numbers as JSON."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import symofros as sf

from ..engines.interface import Joint, Link, Tree, Unsupported
from ..engines.plugins.writing.urdf import describe
from ..engines.proving.pieces import OURS, Layout

# Constructors turn numbers into values; their types say what they keep.
_s: Any = sf
# Kinds that our descriptions call otherwise.
_KINDS = {"helical": "screw"}


def system(tree: Tree) -> sf.System:
    """The tree as our description."""
    names = [item.name for item in tree.links]
    bodies = tuple(_body(item, names[item.parent] if item.parent >= 0 else "world") for item in tree.links)
    return sf.System(tree.name, bodies, gravity=tree.gravity)


def _body(item: Link, parent: str) -> sf.RigidBody:
    (joint,) = item.joints
    stated: dict[str, Any] = {"position": joint.p, "rotation": _s.Rotation.matrix(joint.R)}
    if joint.kind in ("revolute", "prismatic", "helical"):
        stated["axis"] = joint.axis
    if joint.kind == "helical":
        stated["pitch"] = joint.pitch
    J = item.inertia
    moments = J[0][0], J[1][1], J[2][2], J[0][1], J[0][2], J[1][2]
    moved = _s.Joint(f"joint_{item.name}", _KINDS.get(joint.kind, joint.kind), parent, **stated)
    return sf.RigidBody(item.name, moved, _s.Inertia(item.mass, item.com, moments))


def files(tree: Tree) -> dict[str, str]:
    """Suffix -> text of the tree in each format that states it."""
    stated = system(tree)
    with tempfile.TemporaryDirectory(prefix="symofros-truth-") as private:
        path = Path(private) / "model.yaml"
        sf.save(stated, path)
        texts = {"yaml": path.read_text(encoding="utf-8")}
        described = describe(tree)
        if not isinstance(described, Unsupported):
            texts["urdf"] = described.text + "\n"
        if all(joint.kind != "helical" for item in tree.links for joint in item.joints):
            (written,) = (
                Path(file)
                for file in sf.export(stated, "mjcf", Path(private) / "mjcf").files
                if str(file).endswith(".xml")
            )
            texts["xml"] = written.read_text(encoding="utf-8")
    return texts


def numbers(tree: Tree) -> dict[str, Any]:
    """The tree as plain data with every digit: the mechanism that the tabulated values belong to."""
    made = Layout.ours(tree)
    return {
        "name": tree.name,
        "gravity": list(tree.gravity),
        "nq": made.nq,
        "nv": made.nv,
        "links": [_link(item, slots) for item, slots in zip(tree.links, made.slots, strict=True)],
    }


def _link(item: Link, slots: Any) -> dict[str, Any]:
    (joint,) = item.joints
    stated: dict[str, Any] = {
        "name": item.name,
        "parent": item.parent,
        "mass": item.mass,
        "com": list(item.com),
        "inertia": [list(row) for row in item.inertia],
        "joint": _joint(joint),
    }
    if slots:
        stated["joint"] |= {"chart": OURS[joint.kind], "q": list(slots[0].q), "v": list(slots[0].v)}
    return stated


def _joint(joint: Joint) -> dict[str, Any]:
    stated: dict[str, Any] = {"kind": joint.kind, "R": [list(row) for row in joint.R], "p": list(joint.p)}
    if joint.kind in ("revolute", "prismatic", "helical"):
        stated["axis"] = list(joint.axis)
    if joint.kind == "helical":
        stated["pitch"] = joint.pitch
    return stated
