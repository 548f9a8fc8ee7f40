"""MuJoCo's own reading of a URDF file: a second opinion on our importer, not only on our equations."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from typing import Any

import mujoco
import numpy as np

from ...contract.conventions import FREE_WXYZ, Slot
from ...contract.interface import Subject, Unsupported, UrdfSource
from ...contract.quantities import SECOND_ROUTE
from ...mechanics.assembly import Assembly, Mover, assemble
from ..charted import ChartedEngine
from .tree import charted, explain, quiet

NAME = "mujoco-urdf"
_ROOT_JOINT = "root_joint"


def build(subject: Subject) -> ChartedEngine | Unsupported:
    """MuJoCo's model of the file that the description was read from."""
    if subject.urdf is None:
        return Unsupported("not read from a URDF file")
    assembly = assemble(subject.urdf.verbatim)
    for part in (part for mover in assembly.movers for part in mover.masses):
        if part.mass == 0.0 and np.any(part.J_BC):
            return Unsupported(f"body '{part.body}': inertia without mass, which MuJoCo drops when it fuses bodies")
    with quiet():
        engine = _read(subject.urdf, assembly)
    if isinstance(engine, Unsupported):
        return Unsupported(f"its own reading of the file: {engine.reason}")
    return engine


def _read(source: UrdfSource, assembly: Assembly) -> ChartedEngine | Unsupported:
    names = {mover.name: mover.name for mover in assembly.movers}
    try:
        spec = mujoco.MjSpec.from_string(bare(source.text))
        spec.option.gravity = assembly.gravity
        if source.floating_base:
            spec.worldbody.first_body().add_freejoint(name=_ROOT_JOINT)
            names[assembly.movers[0].name] = _ROOT_JOINT
        model = spec.compile()
    except ValueError as error:
        return Unsupported(explain(str(error)))
    if model.nv != assembly.nv:
        return Unsupported(f"{model.nv} speeds, ours has {assembly.nv}")
    try:
        slots = tuple(_slot(model.joint(names[mover.name]), mover) for mover in assembly.movers)
    except KeyError as error:
        return Unsupported(str(error.args[0]))
    return charted(NAME, model, slots, SECOND_ROUTE)


def _slot(joint: Any, mover: Mover) -> Slot:
    free = mover.kind == "free"
    return Slot(mover, int(joint.qposadr[0]), int(joint.dofadr[0]), FREE_WXYZ if free else "", grounded=free)


def bare(urdf: bytes) -> str:
    """The file without shapes, whose meshes need not be at hand, and with MuJoCo's own section: radians."""
    root = ElementTree.fromstring(urdf)
    for link in root.iter("link"):
        for shape in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(shape)
    for own in root.findall("mujoco"):
        root.remove(own)
    ElementTree.SubElement(ElementTree.SubElement(root, "mujoco"), "compiler", fusestatic="true", angle="radian")
    return ElementTree.tostring(root, encoding="unicode")
