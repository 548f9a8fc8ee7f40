"""Pinocchio's own reading of a URDF file, a second opinion on our importer, and what its parser says on the way."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pinocchio as pin

from ...contract.conventions import Chart, Slot
from ...contract.interface import Subject, Unsupported, UrdfSource
from ...contract.quantities import SECOND_ROUTE
from ...engines.plugins.pinocchio import CLOSING, WAYS
from ...engines.plugins.writing.source import Source, SourceModel
from ...mechanics.assembly import Assembly, Mover, assemble
from ..charted import ChartedEngine


@contextmanager
def parser_messages() -> Iterator[list[str]]:
    """Keep what C++ writes to the stream of errors: the lines are there at the end, without blank space around them."""
    lines: list[str] = []
    sys.stderr.flush()
    kept = os.dup(2)
    with tempfile.TemporaryFile() as file:
        os.dup2(file.fileno(), 2)
        try:
            yield lines
        finally:
            os.dup2(kept, 2)
            os.close(kept)
            file.seek(0)
            lines += [line.strip() for line in file.read().decode(errors="replace").splitlines() if line.strip()]


NAME = "pinocchio-urdf"
_ROOT_JOINT = "root_joint"


def build(subject: Subject) -> ChartedEngine | Unsupported:
    """Pinocchio's model of the file that the description was read from."""
    if subject.urdf is None:
        return Unsupported("not read from a URDF file")
    engine = _read(subject.urdf, assemble(subject.urdf.verbatim))
    if isinstance(engine, Unsupported):
        return Unsupported(f"its own reading of the file: {engine.reason}")
    return engine


def _read(source: UrdfSource, assembly: Assembly) -> ChartedEngine | Unsupported:
    root = (pin.JointModelFreeFlyer(), _ROOT_JOINT) if source.floating_base else ()
    try:
        with parser_messages() as said:
            model = pin.buildModelFromXML(source.text.decode(), *root)
    except (ValueError, RuntimeError) as error:
        return Unsupported("; ".join([str(error), *said[:1]]))
    model.gravity.linear = assembly.gravity
    if any(joint.shortname() == "JointModelPlanar" for joint in model.joints):
        return Unsupported("a planar joint, whose speeds are the body's own in Pinocchio")
    if model.nv != assembly.nv:
        return Unsupported(f"{model.nv} speeds, ours has {assembly.nv}")
    names = [mover.joint.name for mover in assembly.movers]
    if source.floating_base:
        names[0] = _ROOT_JOINT
    for name in names:
        if not model.existJointName(name):
            return Unsupported(f"no joint '{name}'")
    slots = tuple(_slot(model, mover, name) for mover, name in zip(assembly.movers, names, strict=True))
    text = Source(("import numpy as np", "import pinocchio as pin"), (), model.nq, model.nv, closing=CLOSING)
    chart, made = Chart(slots, model.nq, model.nv), SourceModel(text, WAYS, {"m": model})
    return ChartedEngine(NAME, pin.__version__, made, chart, capabilities=SECOND_ROUTE)


def _slot(model: Any, mover: Mover, name: str) -> Slot:
    joint = model.joints[model.getJointId(name)]
    turns = mover.kind == "revolute" and joint.nq == 2
    return Slot(mover, joint.idx_q, joint.idx_v, "cos sin" if turns else "")
