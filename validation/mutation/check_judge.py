"""`check` as a judge of faults: a few small models that between them have every part of the mechanics."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import reference_models
import symofros as sf
from validation.adapters import ROUTES, compiled, interpreted
from validation.check import Settings, check
from validation.contract.interface import Subject

_PLACES = {"battery.yaml": Path(__file__).parent, "arm.urdf": Path(__file__).parents[1] / "corpus"}
STATES = 8
# Compared by interpreted programs, which needs no compiler; in the order of cost: most faults show in the first ones.
GENERAL = (
    "double_pendulum",
    "rolling_disc",  # Free joint, conditions on speeds.
    "friction_arm",
    "battery.yaml",  # Rotors, elements, parameters, turned frames, universal, cylindrical, ball, free.
    "gyroscope",
    "four_bar",
    "flyball_governor",  # Parameters, springs.
    "joint_zoo",
    "car",
    "spinning_beam",
)
BEAMS = ("spinning_beam", "flexible_slider_crank", "planar_robot", "double_pendulum")
FILES = ("arm.urdf",)
# Compared compiled, free motion included: what writes C, and what steps, shows there only.
WRITTEN = ("double_pendulum", "heavy_top", "friction_arm", "rolling_disc", "four_bar", "spinning_beam")
STEPPED = ("double_pendulum", "heavy_top", "friction_arm")
_STEPPING = ("symofros/simulation/", "symofros/native/stepping/", "symofros/native/diagrams/")
_WRITING = ("symofros/native/model/", "symofros/generator/codegen/")
_FORMING = ("symofros/generator/", "symofros/expr/packs/", "symofros/expr/numerics/")


def interpreted_models(module: str) -> tuple[str, ...]:
    """The models whose interpreted programs are compared where a module has a fault."""
    if module.startswith(_STEPPING + _WRITING):
        return ()
    if "beam" in module:
        return BEAMS
    return (FILES if "/urdf/" in module else ()) + GENERAL


def compiled_models(module: str) -> tuple[str, ...]:
    """The models that are compiled and compared, with their free motions, where a module has a fault."""
    return STEPPED if module.startswith(_STEPPING) else WRITTEN if module.startswith(_WRITING + _FORMING) else ()


def subject(name: str) -> Subject:
    """A model of the battery."""
    if name in _PLACES:
        return Subject(name, sf.load(_PLACES[name] / name))
    return Subject(name, reference_models.MODELS[name])


def judge(module: str) -> dict[str, Any]:
    """Whether `check` sees the fault that is planted in this process's package.

    Args:
        module: Where the fault is.
    """
    warnings.simplefilter("ignore")
    build = compiled.build
    others = tuple(name for name in ROUTES if name != "interpreted")
    compiled.build = interpreted.build
    for name in interpreted_models(module):
        verdict = _verdict(name, lambda one: check(one, Settings(STATES, engines=others, first=1)))
        if verdict is not None:
            return verdict
    compiled.build = build
    for name in compiled_models(module):
        verdict = _verdict(name, lambda one: check(one, Settings(STATES)))
        if verdict is not None:
            return verdict
    return {"status": "passed"}


def _verdict(name: str, asked: Callable[[Subject], Any]) -> dict[str, Any] | None:
    """What is wrong with a model; None if nothing is."""
    try:
        result = asked(subject(name))
    except sf.CompileError as error:
        return {"status": "raised", "model": name, "reason": f"CompileError: {error}"[:300]}
    except Exception as error:
        return {"status": "raised", "model": name, "reason": f"{type(error).__name__}: {error}"[:300]}
    for row in result.comparisons:
        if not row.ok:
            status = "disagreed" if row.status == "disagree" else "failed"
            return {"status": status, "model": name, "reason": f"{row.engine} {row.quantity} {row.error} {row.note}"}
    return None
