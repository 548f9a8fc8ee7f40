"""MuJoCo: its tree algorithms, without contacts and without its integrators, by the engine matrix's plug-in."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import mujoco

from ...contract.conventions import Chart, Slot
from ...contract.interface import Subject, Unsupported
from ...engines.plugins.mujoco import WAYS
from ...engines.plugins.writing.source import Source, SourceModel
from ...mechanics.joint_kinds import PartKind
from ..charted import ChartedEngine
from ..charted import build as build_charted

NAME = "mujoco"
# Kinds of simple joints that it has.
_JOINTS: frozenset[PartKind] = frozenset({"revolute", "prismatic", "ball", "free"})


def write(engine: ChartedEngine, path: Path) -> None:
    """Save an engine's MuJoCo model as a binary file, for programs in C."""
    mujoco.mj_saveModel(engine.model, str(path))


def build(subject: Subject) -> ChartedEngine | Unsupported:
    """MuJoCo's model of a description, body by body, with everything fixed to a body merged into it."""
    engine = build_charted(NAME, subject, _JOINTS, whole=True, merged=True)
    return Unsupported(explain(engine.reason)) if isinstance(engine, Unsupported) else engine


def charted(name: str, model: Any, slots: tuple[Slot, ...], capabilities: frozenset[str]) -> ChartedEngine:
    """An engine on a model that MuJoCo read itself; its contacts, constraints and actuators are disabled.

    Args:
        name: Name of the route.
        model: An MjModel.
        slots: Where it keeps our joints.
        capabilities: Quantities that it is compared by.
    """
    off = mujoco.mjtDisableBit
    model.opt.disableflags |= off.mjDSBL_CONTACT | off.mjDSBL_CONSTRAINT | off.mjDSBL_ACTUATION
    source = Source(("import numpy as np", "import mujoco as mj", "d = mj.MjData(m)"), (), model.nq, model.nv)
    chart = Chart(slots, model.nq, model.nv)
    return ChartedEngine(
        name, mujoco.__version__, SourceModel(source, WAYS, {"m": model}), chart, capabilities=capabilities
    )


@contextmanager
def quiet() -> Iterator[None]:
    """Suppress MuJoCo's warnings: it would log them into a file in the folder that the user happens to be in."""
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda message: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)


def explain(message: str) -> str:
    """MuJoCo's two-line complaint as one phrase that begins with the name of the thing."""
    complaint, _, where = message.partition("\n")
    complaint = complaint.removeprefix("ValueError: ").removeprefix("Error: ").strip()
    name = re.search(r"name '([^']+)'", where)
    return f"body '{name[1]}': {complaint}" if name else complaint
