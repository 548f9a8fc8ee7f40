"""sf.export: a description, compiled for somebody else's environment."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np

from symofros.base.arguments import checked
from symofros.base.arrays import Array
from symofros.base.functions import FRAME_FUNCTIONS, exported
from symofros.base.names import coordinate_of, package_name, speed_of
from symofros.base.options import Options
from symofros.compiler import GENERATOR, Compilation, compile_system
from symofros.description import System
from symofros.diagrams.diagram import Diagram
from symofros.errors import DescriptionError, ExportError, UnknownNameError, did_you_mean
from symofros.exports.c.c_package import write_c_package
from symofros.exports.c.event_plan import TARGETS as EVENT_TARGETS
from symofros.exports.c.event_plan import event_plan
from symofros.exports.c.mex import write_diagram_mex, write_mex
from symofros.exports.c.reference import POINTS, checks
from symofros.exports.c.sfunction import write_diagram_sfunction, write_sfunction
from symofros.exports.cuda.cuda_package import write_cuda_package
from symofros.exports.diagram import write_diagram
from symofros.exports.fmi.fmu import write_diagram_fmu2, write_diagram_fmu3, write_fmu2, write_fmu3
from symofros.exports.folder import Exported as Exported
from symofros.exports.folder import check_folder
from symofros.exports.functions import states_note
from symofros.exports.interchange.mjcf import write_mjcf
from symofros.exports.interchange.urdf import write_urdf
from symofros.exports.limits import beams_note, events_note, joints_of, limits_note
from symofros.exports.material import Material, Stepping
from symofros.exports.wasm import wasm
from symofros.exports.wasm.program import write_diagram_wasm
from symofros.exports.wasm.wasm import write_wasm
from symofros.expr import OPERANDS
from symofros.generator import InterpretedUnit
from symofros.loading import load
from symofros.mechanics.topology import OTHER_FUNCTIONS
from symofros.runtime.calls import LaneOptions
from symofros.runtime.model import Model
from symofros.simulation.analysis.kinematics.starts import ClosedStart, closed_start, singular_start, stated_names
from symofros.simulation.analysis.reach import reach_of
from symofros.simulation.options import USUAL
from symofros.simulation.stepping.methods import METHODS, method_meant

Target = Literal["c", "cuda", "mex", "sfunction", "fmu2", "fmu3", "wasm", "urdf", "mjcf"]
TARGETS: tuple[Target, ...] = get_args(Target)

_COMPILED: dict[str, Callable[[Material, Path], Exported]] = {
    "c": write_c_package,
    "mex": write_mex,
    "sfunction": write_sfunction,
    "fmu2": write_fmu2,
    "fmu3": write_fmu3,
    "wasm": write_wasm,
}
_DIAGRAMS: dict[str, Callable[[Diagram, Path, Sequence[str] | None, Stepping, str], Exported]] = {
    "c": write_diagram,
    "mex": write_diagram_mex,
    "sfunction": write_diagram_sfunction,
    "fmu2": write_diagram_fmu2,
    "fmu3": write_diagram_fmu3,
    "wasm": write_diagram_wasm,
}
# Functions of reactions, in packages of C alone.
REACTIONS = ("joint_wrenches", "prescribed_efforts", "section_forces")
# How programs and FMUs step where nobody says.
_OF_RUNS = ("method", "rtol", "atol", "beam_limit")
# Importers of units ask for intervals, not for steps: where none is stated, errors are bounded.
_BY_INTERVALS, _BOUNDED = ("fmu2", "fmu3"), {"method": "dopri5"}
_STEPPING: dict[str, Any] = {"dt": 1e-3} | {name: getattr(USUAL, name) for name in _OF_RUNS}
_TARGETS_WITH_CHOSEN_FUNCTIONS = ("c", "wasm")
# Targets whose steps, or those of whose hosts, end at instants of formulas of time.
_STEPPED = ("c", "mex", "wasm", "fmu2", "fmu3")
_UNKNOWN_INSTANTS = (
    "formulas of time bend, jump or are narrow at instants that Simulink's solvers do not know: a step may pass"
    " over a pulse unseen; bound the step by the shortest of them"
)
# Targets that give exact derivatives of their outputs, by inputs too.
_DIFFERENTIATED = ("fmu2", "fmu3")
_DESCRIBED: dict[str, Callable[[System, str | None, Path, str], Exported]] = {"urdf": write_urdf, "mjcf": write_mjcf}


@checked
def export(
    model: System | Diagram | str | os.PathLike[str],
    target: Target,
    folder: str | os.PathLike[str],
    *,
    name: str | None = None,
    frames: Sequence[str] | None = None,
    functions: Sequence[str] = (),
    outputs: Sequence[str] | None = None,
    start: Mapping[str, float] | None = None,
    method: str | None = None,
    dt: float | None = None,
    rtol: float | None = None,
    atol: float | None = None,
    beam_limit: float | None = None,
    events: Mapping[str, Any] | None = None,
) -> Exported:
    """Write a model for another environment; all targets wrap the same C, whose interface is symofros_model.h.

    Args:
        model: A system, or the path of its description; or a diagram, which becomes a program of its own
            ("c", "mex", "sfunction", "fmu2", "fmu3", "wasm"): its inlets are inputs, its outlets outputs.
        target: "c" (a package that builds by CMake, tests itself and simulates in real time), "cuda" (kernels, one
            thread a state), "mex" (Matlab, Octave), "sfunction" (Simulink), "fmu2", "fmu3" (FMI, Model Exchange and
            Co-Simulation), "wasm" (WebAssembly with an ES module and a page that simulates), "urdf" or "mjcf" (what
            these can hold; the notes say what they can't).
        folder: A new one, an empty one, or one of an earlier export.
        name: Name of files and functions; made of the system's name by default.
        frames: Frames to generate kinematics for; all by default, of CUDA the last one. This, `functions` and `start`
            are of models, not of diagrams, which state themselves what they need and where they start.
        functions: Of "wasm", functions of the model beside those that every module has, such as
            "forward_dynamics_derivatives" or "joint_wrenches"; each makes it larger. Of "c", the functions that the
            package has beside those that its stepping method calls, in place of all: a fraction of the text of a large
            robot. Efforts of actuators then need "dynamics", and of loops the functions of constraints.
        outputs: Of those frames, the ones whose positions are outputs of FMUs; the last one by default. Of a diagram,
            the signals that its program tells; by default its outlets, or else what moves.
        start: Names of coordinates, and d + names of speeds -> first values; the neutral state at rest by default.
            A model with constraints starts at the nearest state that meets them.
        method: Stepping method of Co-Simulation, as in `simulate`; not those of SUNDIALS. Of a diagram, this and what
            follows are by default what it states for its runs; otherwise rk4, but for FMUs of a model without `dt`
            dopri5, whose steps follow from the model.
        dt: Step of that method [s]; of an adaptive one the first. 1e-3 by default.
        rtol: Relative error of an adaptive method's step. 1e-6 by default.
        atol: Absolute bound of the local error of adaptive methods. 1e-9 by default.
        beam_limit: Estimated error of the beams' theory beyond which stepping fails, by default as in `simulate`; from
            0.01 on FMUs log a warning.
        events: Name -> formula or Event, with actions as of `simulate`, which the steps of "c", "fmu2", "fmu3" and
            "mex" look for and do; such an FMU has no Model Exchange, and events of units and "mex" end nothing. Of a
            model, whose own events are looked for, too, as in `simulate`.

    Returns:
        What was written, and notes on what the format lacks.

    Raises:
        ExportError: The folder is not ours, or the format can't hold the model.
        DescriptionError: The description can't be a mechanism.
        ArgumentError: No such target, or an argument of another type.
        UnknownNameError: No such frame, function, coordinate or method.
        AssemblyError: No state near the start meets the constraints.
        CompileError: An FMU's binary or a WebAssembly module does not compile.
    """
    stated = {"method": method, "dt": dt, "rtol": rtol, "atol": atol, "beam_limit": beam_limit}
    given = {name: value for name, value in stated.items() if value is not None}
    if isinstance(model, Diagram):
        _refuse_of_models(model, frames=frames, functions=functions, start=start, events=events)
        stepping = _stepping(model.simulation.keywords_with(given))
        named = model if name is None else replace(model, name=name)
        return _export_diagram(named, target, Path(folder), outputs, stepping)
    system = model if isinstance(model, System) else load(model)
    place = Path(folder)
    check_folder(place)  # Before the work, not only after it.
    if target == "cuda":
        Compilation(system).record.refuse_sticking(f"export: '{target}'")
        Compilation(system).record.refuse_rigid_contacts(f"export: '{target}'")
    if functions and target not in _TARGETS_WITH_CHOSEN_FUNCTIONS:
        raise ExportError(
            f"export: '{target}' has functions of its own",
            ", ".join(functions),
            f"functions are chosen for {' and '.join(_TARGETS_WITH_CHOSEN_FUNCTIONS)}",
            "leave `functions` out",
        )
    if target in _DESCRIBED:
        event_plan(
            Compilation(system), compile_system(system, Options(backend="interpreter")).carried, events, "", target
        )
        Compilation(system).tree  # noqa: B018 - refuses what is no mechanism
        return _DESCRIBED[target](system, name, place, GENERATOR)
    with _with_stepping():
        if target == "cuda" and not events:
            return write_cuda_package(system, name, frames, place)
        material = _material(
            system, name, frames, functions, outputs, start or {}, _stepping(given, target), target, events
        )
    return _COMPILED[target](material, place)


def _refuse_of_models(diagram: Diagram, **given: object) -> None:
    """Refuse arguments that have a meaning for a model alone.

    Raises:
        ExportError: One of them is given.
    """
    stated = [name for name, value in given.items() if value]
    if stated:
        raise ExportError(
            f"diagram '{diagram.name}': {stated[0]} is an argument of models",
            ", ".join(stated),
            "a diagram states where its mechanisms start and which functions its blocks need",
            "add_model(..., start={...}) for a start, `outputs` for signals; or export a mechanism alone",
        )


def _export_diagram(
    diagram: Diagram, target: str, folder: Path, outputs: Sequence[str] | None, stepping: Stepping
) -> Exported:
    """A diagram as a program, its inlets inputs, its outlets outputs."""
    if target not in _DIAGRAMS:
        raise ExportError(
            f"diagram '{diagram.name}': no target '{target}'",
            target,
            f"a diagram becomes a program, function of Matlab, block, FMU or module: {', '.join(_DIAGRAMS)}",
            "use target 'c', or export its mechanisms alone",
        )
    check_folder(folder)
    return _DIAGRAMS[target](diagram, folder, outputs, stepping, GENERATOR)


def _stepping(given: Mapping[str, Any], target: str = "") -> Stepping:
    """Stepping settings of an export of a model to a target, or of a diagram: given ones, otherwise defaults."""
    chosen = {**_STEPPING, **(_BOUNDED if target in _BY_INTERVALS and "dt" not in given else {}), **given}
    method = chosen["method"]
    known = [item.name for item in METHODS.values() if not item.family.multistep]
    if method not in known:
        raise UnknownNameError(
            f"export: no method '{method}'", f"'{method}'", ", ".join(known), method_meant(method, known)
        )
    for label in ("dt", "rtol", "atol"):
        value = chosen[label]
        if not (np.isfinite(value) and value > 0):
            raise ExportError(f"export: {label} is not positive", str(value), f"{label} > 0", "leave it out")
        if label != "dt" and label in given and not METHODS[method].adaptive:
            what, rule = f"export: {label} has no effect", "it bounds errors of adaptive methods; others step by dt"
            raise ExportError(what, f"method '{method}'", rule, f"leave {label} out, or method='dopri5'")
    return Stepping(METHODS[method], **{name: float(chosen[name]) for name in ("dt", "rtol", "atol", "beam_limit")})


@contextmanager
def _with_stepping() -> Iterator[None]:
    """Remedies of an export, which steps whatever functions are asked for, propose no others."""
    try:
        yield
    except DescriptionError as error:
        reworded = (replace(problem, remedy=problem.remedy.replace(OTHER_FUNCTIONS, "")) for problem in error.problems)
        raise DescriptionError([*reworded]) from None


def _material(
    system: System,
    name: str | None,
    frames: Sequence[str] | None,
    further: Sequence[str],
    outputs: Sequence[str] | None,
    start: Mapping[str, float],
    stepping: Stepping,
    target: Target,
    events: Mapping[str, Any] | None,
) -> Material:
    """Material of an export: C packages have reactions, FMUs derivatives of outputs by prescribed motions."""
    _refuse_variational(system, stepping)
    chosen = target == "c" and bool(further)
    reactions = _reactions(system) if target == "c" and not chosen else ()
    needs = (*stepping.method.family.functions, *reactions)
    if any(body.modes for body in system.beams):
        needs = (*needs, "beam_stiffness", "mass_matrix")
    if (events or system.events) and system.switches:
        needs = (*needs, "constraint", "frame_pose")
    described = Compilation(system)
    instants, constrained = described.has_instants, described.record.nc > 0
    if target in _STEPPED and instants:
        needs = (*needs, OPERANDS)
    if not stepping.method.family.rigid_contacts:
        described.record.refuse_rigid_contacts(f"export: '{target}' by '{stepping.method.name}'", by_method=True)
    if described.record.sticking or described.record.rigid_contacts:
        needs = (*needs, "constraint")
    stepped = ("forward_dynamics", "project") if constrained else ("forward_dynamics",)
    offered = stepped if chosen else wasm.functions(constrained) if target == "wasm" else exported(constrained)
    functions = tuple(dict.fromkeys((*offered, *further, *needs)))
    compilation = Compilation(system, Options(functions, None if frames is None else tuple(frames)))
    record = compilation.record
    c_name = package_name(name or record.name)
    framed = [request.frame for request in compilation.requests if request.name in FRAME_FUNCTIONS]
    shown = _outputs(record.frame_names, framed, outputs)
    if target in _DIFFERENTIATED and record.driven and shown:
        compilation.request(("frame_derivatives",), shown)
    interpreted = compile_system(system, Options(backend="interpreter")).carried
    first, beams = _start(interpreted, start), interpreted.beams()
    kernels = InterpretedUnit(compilation.program).kernels
    order = tuple((request.name, request.frame) for request in compilation.requests)
    return Material(
        system,
        record,
        c_name,
        compilation.source(c_name, LaneOptions(in_rows=True) if target == "wasm" else None),
        order,
        tuple(kernels[key].signature for key in order),
        checks(record, kernels, order, first.q),
        POINTS,
        tuple(first.q.tolist()),
        tuple(first.v.tolist()),
        _reach(interpreted, first.q) if constrained else (1.0,) * len(record.q_names),
        stepping,
        beams,
        shown,
        GENERATOR,
        target == "c",
        (
            *system.notes,
            *limits_note(joints_of(system)),
            *beams_note(beams),
            *states_note(record),
            *first.notes,
            *singular_start(interpreted, first.q),
            *(events_note(system) if target not in EVENT_TARGETS else ()),
            *((_UNKNOWN_INSTANTS,) if instants and target not in _STEPPED else ()),
        ),
        event_plan(compilation, interpreted, events, c_name, target),
    )


def _reactions(system: System) -> tuple[str, ...]:
    """Names of the functions of reactions: efforts of drives and forces inside beams where there are any."""
    prescribed = any(body.joint is not None and body.joint.prescribed for body in system.bodies)
    inside = any(body.modes and body.stations for body in system.beams)
    wanted = {"joint_wrenches": True, "prescribed_efforts": prescribed, "section_forces": inside}
    return tuple(name for name in REACTIONS if wanted[name])


def _refuse_variational(system: System, stepping: Stepping) -> None:
    if stepping.method.family.trees_only and system.constraints:
        raise ExportError(
            "export: 'variational' steps trees only",
            f"'{system.name}' has constraints",
            "its principle is written for free coordinates",
            "use rk4",
        )


def _outputs(known: Sequence[str], generated: Sequence[str], wanted: Sequence[str] | None) -> tuple[str, ...]:
    made = list(dict.fromkeys(generated))
    if wanted is None:
        return tuple(made[-1:])
    for frame in wanted:
        if frame not in made:
            raise UnknownNameError(
                f"export: no frame '{frame}' among those generated",
                ", ".join(made[:12]),
                "outputs are frames of the model",
                did_you_mean(frame, made or list(known)),
            )
    return tuple(wanted)


def _reach(model: Model, q: Array) -> tuple[float, ...]:
    """Change of each coordinate that is of order one (nq), components of quaternions by 1."""
    of_speeds, reach = (
        reach_of(model, model.constraint_jacobian(q), model.mass_matrix(q), None).speeds,
        np.ones(model.nq),
    )
    for s in model.record.segments:
        shifts = s.size if s.kind == "linear" else s.translations
        reach[s.q : s.q + shifts] = of_speeds[s.v : s.v + shifts]
    return tuple(reach.tolist())


def _start(model: Model, given: Mapping[str, float]) -> ClosedStart:
    """Initial state on the constraints; given coordinates and speeds keep their values."""
    q, v = model.neutral(), np.zeros(model.nv)
    for label, value in given.items():
        coordinate, speed = coordinate_of(label, model.names.q), speed_of(label, model.names.v)
        if coordinate:
            q[model.names.q.index(coordinate)] = value
        elif speed:
            v[model.names.v.index(speed)] = value
        else:
            raise UnknownNameError(
                f"export: no coordinate or speed '{label}'",
                label,
                "start gives coordinates by name, speeds by d + name",
                did_you_mean(label, [*model.names.q, *(f"d{speed}" for speed in model.names.v)]),
            )
    return closed_start(model, q, v, *stated_names(model.names.q, model.names.v, given))
