"""`check` as a judge of faults: a few models of its standard set that between them have every part of the mechanics."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from typing import Any

import symofros as sf

from ..adapters import ROUTES, compiled, interpreted
from ..checking import Settings, check
from ..comparison.errors import Comparison
from ..contract.interface import Subject
from ..inputs.cases import named
from ..procedures.catalogue import PROCEDURES

STATES = 8
# Compared by interpreted programs, which needs no compiler; in the order of cost: most faults show in the first ones.
GENERAL = (
    "double_pendulum",
    "rolling_disc",  # Free joint, conditions on speeds.
    "friction_arm",
    "battery",  # Rotors, elements, parameters, turned frames, universal, cylindrical, ball, free.
    "gyroscope",
    "four_bar",
    "flyball_governor",  # Parameters, springs.
    "joint_zoo",
    "car",
    "spinning_beam",
    "flexible_pendulum",
    "soft_pendulum",
)
BEAMS = ("spinning_beam", "soft_pendulum", "beam_zoo", "flexible_slider_crank", "planar_robot", "double_pendulum")
RODS = ("soft_pendulum", "beam_zoo", "spinning_beam")
READ = {"urdf": ("sampler", "ur5"), "mjcf": ("creature",)}
# Compared compiled, free motion included: what writes C shows there only.
WRITTEN = ("double_pendulum", "heavy_top", "friction_arm", "rolling_disc", "four_bar", "spinning_beam")
# Of sums in vectors, whose lanes are copied from other vectors.
PACKED = ("planar_robot",)
# Relations and derivatives of what procedures have no model of: motors of every kind, equal limbs, other readers.
ASKED = ("motors", "mirrored", "sampler", "creature")
# Loops whose conditions repeat each other, where a module solves with them.
REPEATED = ("bricard", "two_four_bars")
_SOLVING = ("kkt", "null_space", "project", "constrained", "dense")
_STEPPING = ("symofros/simulation/", "symofros/native/stepping/", "symofros/native/diagrams/")
_WRITING = ("symofros/native/model/", "symofros/generator/codegen/")
# What no function of a model depends on.
_APART = ("symofros/exports/", "symofros/interop/", "symofros/diagrams/", "symofros/blocks/", "symofros/runtime/cuda/")
_FORMING = ("symofros/generator/", "symofros/expr/packs/", "symofros/expr/numerics/")


def interpreted_models(module: str) -> tuple[str, ...]:
    """The models whose interpreted programs are compared where a module has a fault."""
    if module.startswith(_STEPPING + _WRITING + _APART):
        return ()
    if any(f"/{name}" in module for name in ("rod", "strains", "flexible")):
        return RODS
    read = next((names for folder, names in READ.items() if f"/{folder}/" in module), ())
    rods = ("delta_rods",) if "constraints" in module else ()
    return read or (BEAMS if "beam" in module else GENERAL + rods)


def compiled_models(module: str) -> tuple[str, ...]:
    """The models that are compiled and compared, with their free motions, where a module has a fault."""
    if module.startswith(_STEPPING):
        return ()
    solving = module.startswith(_WRITING) and any(name in module for name in _SOLVING)
    packed = PACKED if module.startswith(_WRITING + _FORMING) and "pack" in module else ()
    return (WRITTEN if module.startswith(_WRITING + _FORMING) else ()) + packed + (REPEATED if solving else ())


def subject(name: str) -> Subject:
    """A model of the standard set."""
    return named([name])[0].load()


def judge(module: str) -> dict[str, Any]:
    """Whether `check` sees the fault that is planted in this process's package."""
    warnings.simplefilter("ignore")
    others = tuple(name for name in ROUTES if name != "interpreted")

    def by_interpreter(one: Subject) -> Iterable[Comparison]:
        build, compiled.build = compiled.build, lambda made, _=None: interpreted.build(made)  # type: ignore[assignment]
        try:
            return check(one, Settings(STATES, engines=others, first=1)).comparisons
        finally:
            compiled.build = build

    def by_compiler(one: Subject) -> Iterable[Comparison]:
        return check(one, Settings(STATES, engines=tuple(ROUTES))).comparisons

    def by_own_questions(one: Subject) -> Iterable[Comparison]:
        """Relations, derivatives and procedures."""
        return check(one, Settings(STATES, engines=())).comparisons

    stages = [
        *((name, by_interpreter) for name in interpreted_models(module)),
        *((name, by_own_questions) for name in (*PROCEDURES, *ASKED)),
        *((name, by_compiler) for name in compiled_models(module)),
    ]
    if module.startswith(_WRITING + _FORMING):
        stages.sort(key=lambda stage: stage[1] is by_own_questions)
    for name, asked in stages:
        verdict = _verdict(name, asked)
        if verdict is not None:
            return verdict
    return {"status": "passed"}


def _verdict(name: str, asked: Callable[[Subject], Iterable[Comparison]]) -> dict[str, Any] | None:
    """Status and reason of a model's first disagreement, failure or exception; None if there is none."""
    try:
        for row in asked(subject(name)):
            if not row.ok:
                status = "disagreed" if row.status == "disagree" else "failed"
                reason = f"{row.engine} {row.quantity} {row.error} {row.note}"
                return {"status": status, "model": name, "reason": reason[:300]}
    except sf.CompileError as error:
        return {"status": "raised", "model": name, "reason": f"CompileError: {error}"[:300]}
    except Exception as error:
        return {"status": "raised", "model": name, "reason": f"{type(error).__name__}: {error}"[:300]}
    return None
