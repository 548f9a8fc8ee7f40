"""A diagram as one C program: its parts, its instants, the loop, and a main that runs them in real time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from string import Template

import numpy as np

from symofros.base.arrays import Array
from symofros.base.c_text import c_string, comment, doubles, integers, strings
from symofros.base.names import identifier, package_name
from symofros.diagrams.diagram import Diagram
from symofros.diagrams.external_block import ExternalBlock
from symofros.diagrams.program.compiled import (
    Resolved,
    fuser,
    part_beams,
    reads_accelerations,
    record_of,
    resolve,
)
from symofros.diagrams.program.fused_functions import Fuser
from symofros.diagrams.program.layout import Part
from symofros.errors import ExportError
from symofros.exports.c.c_package import INTEGRATOR_HEADERS
from symofros.exports.c.event_plan import EventPlan, planned
from symofros.exports.c.parameter_check import Judged
from symofros.exports.c.plant import plant_text
from symofros.exports.diagram_interface import Interface, default_outputs, entry_names, entry_units, table
from symofros.exports.diagram_start import FirstMotion, first_motion
from symofros.exports.folder import Exported, write_folder
from symofros.exports.functions import cell, names_table
from symofros.exports.material import Stepping
from symofros.expr import with_instants
from symofros.generator import model_source, run_passes
from symofros.native import amalgamated, header_files, native_text
from symofros.runtime.beams import ElasticBeam
from symofros.runtime.record import ModelRecord

PROGRAM_HEADERS = (*INTEGRATOR_HEADERS, "diagrams/symofros_diagram.h", "diagrams/symofros_program.h")
DIAGRAM_LOOP = "diagrams/symofros_diagram.c"
# Of the self-test, whose signals are those of the same run from Python.
TOLERANCE = "1e-9"


@dataclass(frozen=True)
class PartMaterial:
    """A part, ready to be wrapped as a plant; see exports.plant.Moving."""

    c_name: str
    record: ModelRecord
    stepping: Stepping
    frames: tuple[str, ...]
    q_start: tuple[float, ...]
    v_start: tuple[float, ...]
    beams: tuple[ElasticBeam, ...]
    judged: tuple[Judged, ...]
    generator: str
    events: EventPlan | None = None


def write_diagram(
    diagram: Diagram, folder: Path, outputs: Sequence[str] | None, stepping: Stepping, generator: str
) -> Exported:
    """Write the C package of a diagram.

    Args:
        diagram: The diagram; its inlets are inputs.
        folder: Target folder: a new one, or one that an export wrote.
        outputs: Signals that the program tells; by default its outlets, or else what moves.
        stepping: How the parts step: by an explicit method.
        generator: Name and version.

    Raises:
        ExportError: The diagram calls Python, or the folder is not ours.
    """
    program = diagram_program(diagram, outputs, stepping, generator)
    name, files, first, shown = program.name, program.files, program.first, program.interface
    fields = {
        "name": name,
        "heading": cell(diagram.name),
        "inputs": table(shown.inputs),
        "outputs": table(shown.outputs),
        "parameters": table(shown.parameters),
        "names": names_table(record_of(program.resolved, None)),
        "generator": generator,
        "version": generator.rpartition(" ")[2],
        "until": repr(first.until),
        "given": doubles(first.given),
        "reference": doubles(first.signals),
        "tolerance": TOLERANCE,
        "step": repr(stepping.dt),
        "sources": " ".join(file for file in files if file.endswith(".c")),
    }
    files["main.c"] = Template(native_text("exports/diagram_main.c.in")).substitute(fields)
    files["README.md"] = Template(native_text("exports/diagram_README.md.in")).substitute(fields)
    files["CMakeLists.txt"] = Template(native_text("exports/diagram_CMakeLists.txt.in")).substitute(fields)
    return write_folder(folder, "c", name, files | loop_files(), generator, program.notes)


def loop_files() -> dict[str, str]:
    """File name -> text of what every program builds on: the loop and its headers."""
    return {**header_files(*PROGRAM_HEADERS), "symofros_diagram.c": amalgamated(DIAGRAM_LOOP)}


@dataclass(frozen=True)
class DiagramProgram:
    """A diagram as C text, ready to be wrapped.

    Attributes:
        name: Prefix of files and symbols.
        resolved: The diagram, its inlets open.
        interface: Inputs, outputs, parameters.
        first: How it begins.
        files: File name -> text, of what is generated.
        period: Base period of what is sampled, or else the step of the parts [s].
    """

    name: str
    resolved: Resolved
    interface: Interface
    first: FirstMotion
    files: dict[str, str]
    period: float

    @property
    def c_files(self) -> list[str]:
        """Names of the generated files that are compiled."""
        return [file for file in self.files if file.endswith(".c")]

    @property
    def notes(self) -> tuple[str, ...]:
        """Remarks for the user."""
        closed_form = "no constraints: accelerations are in closed form"
        return (*(() if self.resolved.layout.condition_names else (closed_form,)), *self.first.notes)


def diagram_program(
    diagram: Diagram, outputs: Sequence[str] | None, stepping: Stepping, generator: str
) -> DiagramProgram:
    """The C text of a diagram; arguments and errors as of `write_diagram`."""
    resolved = resolve(diagram)
    _refuse(resolved, stepping)
    shown = outputs or default_outputs(diagram, resolved)
    interface = Interface.of(resolved, shown)
    name, title = package_name(diagram.name), diagram.name
    write = fuser(resolved)
    files: dict[str, str] = {f"{name}.h": _header(name, title, interface, generator)}
    first = first_motion(diagram, interface, shown, stepping)
    for i, (q, v) in enumerate(first.starts):
        files |= _part_files(resolved, write, i, (q, v), stepping, generator)
    instants = run_passes(write.samples(resolved.schedule.sets, interface.sources))
    files[f"{name}_instants.c"] = model_source(
        instants, record_of(resolved, None), generator, c_name=f"{name}_instants"
    )
    files[f"{name}_program.c"] = _program(resolved, name, interface, reads_accelerations(instants), generator)
    period = float(resolved.schedule.base) if resolved.schedule.instants else stepping.dt
    return DiagramProgram(name, resolved, interface, first, files, period)


def _refuse(resolved: Resolved, stepping: Stepping) -> None:
    """Refuse diagrams that a stand-alone program can't run.

    Raises:
        ExportError: The diagram calls Python, or steps by an implicit method.
    """
    wired = resolved.wired
    external = [name for name, block in wired.blocks.items() if isinstance(block, ExternalBlock)]
    if external:
        raise ExportError(
            f"diagram '{wired.name}': no C program",
            "; ".join(f"block '{name}' calls Python" for name in external),
            "a program of its own has no Python in it",
            "leave it out, or make what it takes an outlet and what it gives an inlet",
        )
    if stepping.method.kind not in ("explicit", "semi_implicit"):
        raise ExportError(
            f"diagram '{wired.name}': method '{stepping.method.name}'",
            "an implicit method",
            "diagrams step by explicit methods",
            "use rk4 or dopri5",
        )


def _part_files(
    resolved: Resolved, write: Fuser, number: int, start: tuple[Array, Array], stepping: Stepping, generator: str
) -> dict[str, str]:
    """Name -> text of the files of one part."""
    layout, part = resolved.layout, resolved.layout.parts[number]
    record, c_name = record_of(resolved, part), f"{identifier(resolved.wired.name)}_part{number}"
    q, v = start
    located = {
        kind: model_source(run_passes(program), record, generator, None, f"{c_name}_{kind}")
        for kind, program in write.located(part).items()
    }
    material = PartMaterial(
        c_name,
        record,
        stepping,
        (),
        tuple(q.tolist()),
        tuple(v.tolist()),
        part_beams(resolved, part, np.array(layout.par)),
        _judged(resolved, part),
        generator,
        _event_plan(resolved, part, c_name, {f"{c_name}_{kind}.inc": text for kind, text in located.items()}),
    )
    motion = run_passes(with_instants(write.motion(part, whole=False)))
    files = {f"{c_name}.c": model_source(motion, record, generator, c_name=c_name), f"{c_name}.h": _part_header(c_name)}
    return (
        files | {f"{c_name}_plant.c": plant_text(material)} | (dict(material.events.files) if material.events else {})
    )


def _judged(resolved: Resolved, part: Part) -> tuple[Judged, ...]:
    """The descriptions of all models, and once more of those with parameters of their own that events change."""
    layout, models = resolved.layout, resolved.wired.models
    judged = []
    for model in models.names:
        places = list(layout.parameters["", model].range)
        judged.append(Judged(models.system(model), models.record(model).par_names, tuple(places)))
    for name in part.blocks:
        if name in layout.kept:
            model = resolved.wired.blocks[name].mechanism()
            places = layout.places_of(name, model)
            judged.append(Judged(models.system(model), models.record(model).par_names, tuple(places)))
    return tuple(judged)


def _event_plan(resolved: Resolved, part: Part, c_name: str, files: Mapping[str, str]) -> EventPlan | None:
    """The events that stop a part, crossings of blocks first; None where there are none."""
    switching = resolved.switching(part)
    if switching is not None:
        return planned(c_name, switching.events, switching.stated, record_of(resolved, part), files)
    return planned(c_name, resolved.crossings, None, record_of(resolved, part), files) if resolved.crossings else None


def _header(name: str, title: str, interface: Interface, generator: str) -> str:
    guard = f"SYMOFROS_PROGRAM_{name.upper()}_H"
    return "\n".join(
        [
            f"/* {comment(title)}: a diagram as a program; generated by {generator}. */",
            f"#ifndef {guard}",
            f"#define {guard}",
            "",
            '#include "symofros_program.h"',
            "",
            "/* Where inputs begin in `inputs`, outputs in `signals`, parameters in `par`, and how wide they are. */",
            *interface.enumerations(name.upper()),
            "",
            "#ifdef __cplusplus",
            'extern "C" {',
            "#endif",
            f"const sym_program *{name}_program(void);",
            "#ifdef __cplusplus",
            "}",
            "#endif",
            "#endif",
            "",
        ]
    )


def _part_header(c_name: str) -> str:
    guard = f"SYMOFROS_PART_{c_name.upper()}_H"
    return "\n".join(
        [
            f"#ifndef {guard}",
            f"#define {guard}",
            '#include "symofros_instance.h"',
            f"const sym_model *{c_name}_model(void);",
            f"const sym_plant *{c_name}_plant(void);",
            "#endif",
            "",
        ]
    )


def _program(resolved: Resolved, name: str, interface: Interface, back: bool, generator: str) -> str:
    """NAME_program.c: the constants of symofros_program.h."""
    wired, layout, plan = resolved.wired, resolved.layout, resolved.schedule
    parts = layout.parts
    kept = [f"{{{', '.join(map(str, row))}}}" for row in layout.kept_rows]
    lines = [
        f"/* {comment(wired.name)} as a program. Generated by {generator}. */",
        "#include <math.h>",
        f'#include "{name}.h"',
        *(f'#include "{name}_part{i}.h"' for i in range(len(parts))),
        "",
        f"const sym_model *{name}_instants_model(void);",
        _array(
            "const sym_plant *(*const",
            "parts)(void)",
            ", ".join(f"{name}_part{i}_plant" for i in range(len(parts))) or "NULL",
        ),
        *(
            _array("const int32_t", key, integers(places))
            for key, places in (
                ("q_offset", [part.q.start for part in parts]),
                ("v_offset", [part.v.start for part in parts]),
                ("c_offset", [part.conditions.start for part in parts]),
                ("lock_inputs", layout.lock_inputs),
            )
        ),
        _array("const double", "u_start", doubles(layout.u0)),
        *_signals(layout.signals),
        _array("const sym_kept", "kept", ", ".join(kept) or "{0, 0, 0, 0}"),
        _array("const int64_t", "instant_tick", integers(k for k, _ in plan.instants)),
        _array("const int32_t", "instant_set", integers(which for _, which in plan.instants)),
        _array("const char *const", "set_functions", strings(f"due_{i}" for i in range(len(plan.sets)))),
        *(
            _array("const char *const", key, strings(texts))
            for key, texts in (
                ("output_names", entry_names(interface.outputs)),
                ("output_units", entry_units(interface.outputs)),
                ("input_names", entry_names(interface.inputs)),
                ("input_units", entry_units(interface.inputs)),
            )
        ),
        f"static const sym_program {name}_program_struct = {{",
        f"    {c_string(wired.name)}, {name}_instants_model,",
        f"    {len(parts)}, parts, q_offset, v_offset, c_offset, u_start,",
        f"    {len(layout.signals)}, {len(layout.lock_inputs)}, {len(resolved.crossings)}, {int(back)},",
        "    signals, lock_inputs,",
        f"    {float(plan.base.numerator)!r}, {float(plan.base.denominator)!r}, {plan.cycle}, {len(plan.instants)},",
        f"    instant_tick, instant_set, {len(plan.sets)}, {len(entry_names(interface.outputs))},",
        f"    set_functions, output_names, output_units, {len(entry_names(interface.inputs))},",
        f"    input_names, input_units, {len(kept)}, kept",
        "};",
        "",
        f"const sym_program *{name}_program(void) {{ return &{name}_program_struct; }}",
        "",
    ]
    return "\n".join(lines)


def _array(kind: str, name: str, values: str) -> str:
    label = name.replace(")(void)", "[])(void)") if ")(void)" in name else f"{name}[]"
    return f"static {kind} {label} = {{{values}}};"


def _signals(signals: Sequence[tuple[int, np.ndarray, np.ndarray, bool]]) -> list[str]:
    lines, rows = [], []
    for i, (at, t, values, linear) in enumerate(signals):
        lines.append(_array("const double", f"signal_t{i}", doubles(t.tolist())))
        lines.append(_array("const double", f"signal_y{i}", doubles(values.tolist())))
        rows.append(f"{{{at}, {int(linear)}, {len(t)}, signal_t{i}, signal_y{i}}}")
    return [*lines, _array("const sym_signal", "signals", ", ".join(rows) or "{0, 0, 0, NULL, NULL}")]
