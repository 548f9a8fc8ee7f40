"""Kernels with their launchers, the same model in C beside them, and an example that compares and times."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from string import Template

from symofros.base.c_text import comment, doubles
from symofros.base.functions import FRAME_FUNCTIONS
from symofros.base.names import package_name
from symofros.base.options import Options
from symofros.compiler import GENERATOR, Compilation
from symofros.description import System
from symofros.exports.folder import Exported, write_folder
from symofros.exports.functions import NamedFunction, cell, functions_table, names_table, states_note
from symofros.exports.limits import events_note, joints_of, limits_note
from symofros.generator import DeviceCode
from symofros.native import header_files, native_text
from symofros.runtime.calls import Precision

# What users of batches ask for; each kernel takes seconds to compile.
FUNCTIONS = (
    "dynamics",
    "forward_dynamics",
    "inverse_dynamics",
    "kinetic_energy",
    "potential_energy",
    "forward_dynamics_derivatives",
    "inverse_dynamics_derivatives",
    "frame_pose",
    "frame_velocity",
    "frame_jacobian",
)
_REAL: dict[Precision, str] = {"double": "double", "single": "float"}


def write_cuda_package(system: System, name: str | None, frames: Sequence[str] | None, folder: Path) -> Exported:
    """The CUDA package of a model.

    Args:
        system: System as the user stated it.
        name: Name of files and functions; made of the system's name by default.
        frames: Frames to generate kinematics for; the last one by default.
        folder: Target folder.

    Raises:
        ExportError: The folder is not ours.
        UnknownNameError: There is no such frame.
    """
    made = Compilation(system)
    chosen = made.record.frame_names[-1:] if frames is None else tuple(frames)
    functions = FUNCTIONS if chosen else tuple(x for x in FUNCTIONS if x not in FRAME_FUNCTIONS)
    made = Compilation(system, Options(functions, chosen))
    program, record = made.program, made.record
    c_name = package_name(name or record.name)
    prefixes: dict[Precision, str] = {"double": c_name, "single": f"{c_name}_single"}
    codes = {precision: made.device_code(precision, prefix) for precision, prefix in prefixes.items()}
    left_out = [function.name for function in program.functions if function.solver is not None]
    fields = {
        "name": c_name,
        "upper": c_name.upper(),
        "title": comment(record.name),
        "heading": cell(record.name),
        "generator": GENERATOR,
        "version": GENERATOR.rpartition(" ")[2],
        "npre": max(1, len(program.init)),
        "nq": len(record.q_names),
        "nv": len(record.v_names),
        "nu": len(record.u_names),
        "declarations": "\n".join(line for code in codes.values() for line in _declarations(code)),
        "functions": functions_table([NamedFunction(k.symbol, k.signature) for k in codes["double"].kernels]),
        "names": names_table(record),
        "u_start": doubles(record.u_default),
        "bytes": next(k.bytes_of_state("double") for k in codes["double"].kernels),
        "array_arguments": "".join(f", arrays[{k}]" for k in range(len(_declared(codes["double"])[0][2]) - 1)),
        "rollouts": _rollouts_text(codes["double"]),
    }
    files = {f"{c_name}_{precision}.cu": f"{code.text}\n\n{_launchers(code)}\n" for precision, code in codes.items()}
    templates = {
        f"{c_name}_cuda.h": "cuda.h.in",
        "main.cu": "cuda_main.cu.in",
        "CMakeLists.txt": "cuda_CMakeLists.txt.in",
        "README.md": "cuda_README.md.in",
    }
    files |= {file: Template(native_text(f"exports/{text}")).substitute(fields) for file, text in templates.items()}
    files |= {f"{c_name}.c": made.source(c_name)} | header_files("model/symofros_model.h")
    return write_folder(folder, "cuda", c_name, files, GENERATOR, (*system.notes, *_notes(made, left_out)))


def _notes(made: Compilation, left_out: Sequence[str]) -> tuple[str, ...]:
    """Notes on what kernels and rollouts leave out: limits, functions without kernels, bending of beams, instants."""
    notes = [*limits_note(joints_of(made.system)), *states_note(made.record), *events_note(made.system)]
    if left_out:
        notes.append(
            f"no kernels of {', '.join(left_out)}: a routine with pivots finishes them; they are in the C file"
        )
    if any(body.modes for body in made.system.beams):
        notes.append("rollouts do not judge how far beams bend, as sf.simulate does: judge their records")
    if made.has_instants:
        notes.append(
            "formulas of time bend, jump or are narrow at instants within steps of rollouts, which end at none of them:"
            " what is shorter than a step may pass unseen"
        )
    return tuple(notes)


def _rollouts_text(code: DeviceCode) -> str:
    """Paragraph of the README on rollouts."""
    if not code.rollouts:
        return "This model has no rollouts: its accelerations take a solver."
    methods = " and ".join(f"`{symbol}` (`{method}` of `sf.simulate`)" for method, symbol in code.rollouts.items())
    return (
        f"Rollouts: {methods}. They take `steps` steps of `dt` from `q0`, `v0`, `t0`, with the inputs `u` of each\n"
        "step held over it, and write each `every`-th state into `q` and `v`. A step that is too long is not noticed:\n"
        "compare with a shorter one."
    )


def _declared(code: DeviceCode) -> list[tuple[str, str, list[str]]]:
    """(kernel, its arguments as declared, their names) of each launcher."""
    real = _REAL[code.precision]
    declared = []
    for kernel in code.kernels:
        names = [name for name, _ in (*kernel.signature.inputs, *kernel.signature.outputs)]
        arguments = [f"const {real} *pre", *(f"sym_strided {name}" for name in names)]
        declared.append((kernel.symbol, ", ".join(arguments), ["pre", *names]))
    stated = {
        "pre": f"const {real} *pre",
        "steps": "long long steps",
        "every": "long long every",
        "dt": "double dt",
        "q0": "sym_strided q0",
        "v0": "sym_strided v0",
        "u": "sym_sequence u",
        "t0": "sym_strided t0",
        "q": "sym_sequence q",
        "v": "sym_sequence v",
    }
    declared += [(symbol, ", ".join(stated.values()), list(stated)) for symbol in code.rollouts.values()]
    return declared


def _declarations(code: DeviceCode) -> list[str]:
    return [f"int {symbol}_launch(void *stream, long long n, {arguments});" for symbol, arguments, _ in _declared(code)]


def _launchers(code: DeviceCode) -> str:
    """Functions that the host calls: one grid, the error of its launch."""
    lines = ["#if defined(__CUDACC__) && !defined(__CUDACC_RTC__)"]
    for symbol, arguments, names in _declared(code):
        lines += [
            f'extern "C" int {symbol}_launch(void *stream, long long n, {arguments}) {{',
            "    const unsigned blocks = (unsigned)((n + SYM_BLOCK - 1) / SYM_BLOCK);",
            f"    if (n > 0) {symbol}<<<blocks, SYM_BLOCK, 0, (cudaStream_t)stream>>>(n, {', '.join(names)});",
            "    return (int)cudaGetLastError();",
            "}",
        ]
    return "\n".join([*lines, "#endif"])
