"""MuJoCo's own reading of a URDF file: a second opinion on our importer, not only on our equations."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree

import mujoco
import numpy as np

from ...contract.interface import Subject, Unsupported, UrdfSource
from ...contract.quantities import SECOND_ROUTE
from ...mechanics.assembly import Assembly, assemble
from .tree import MujocoEngine, chart_of, compiled, explain, quiet

NAME = "mujoco-urdf"
_ROOT_JOINT = "root_joint"


def build(subject: Subject) -> MujocoEngine | Unsupported:
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


def _read(source: UrdfSource, assembly: Assembly) -> MujocoEngine | Unsupported:
    try:
        spec = mujoco.MjSpec.from_string(_bare(source.text))
    except ValueError as error:
        return Unsupported(explain(str(error)))
    spec.option.gravity = assembly.gravity
    names = {mover.joint.name: mover.joint.name for mover in assembly.movers}
    if source.floating_base:
        spec.worldbody.first_body().add_freejoint(name=_ROOT_JOINT)
        names[assembly.movers[0].joint.name] = _ROOT_JOINT
    model = compiled(spec)
    if isinstance(model, Unsupported):
        return model
    if model.nv != assembly.nv:
        return Unsupported(f"{model.nv} speeds, ours has {assembly.nv}")
    try:
        chart = chart_of(model, assembly, names)
    except KeyError as error:
        return Unsupported(str(error.args[0]))
    return MujocoEngine(NAME, model, chart, capabilities=SECOND_ROUTE)


def _bare(urdf: bytes) -> str:
    """The file without shapes, whose meshes need not be at hand, and with MuJoCo's own section: radians."""
    root = ElementTree.fromstring(urdf)
    for link in root.iter("link"):
        for shape in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(shape)
    for own in root.findall("mujoco"):
        root.remove(own)
    ElementTree.SubElement(ElementTree.SubElement(root, "mujoco"), "compiler", fusestatic="true", angle="radian")
    return ElementTree.tostring(root, encoding="unicode")
