"""WebAssembly of a diagram: one module with its program and loop, an ES module around it, a self-test."""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
from pathlib import Path
from string import Template
from typing import Any

from symofros.base.c_text import comment
from symofros.diagrams.diagram import Diagram
from symofros.exports.c.unity import unity
from symofros.exports.diagram import DIAGRAM_LOOP, TOLERANCE, DiagramProgram, diagram_program, loop_files
from symofros.exports.diagram_interface import Quantity
from symofros.exports.folder import Exported, write_folder
from symofros.exports.material import Stepping
from symofros.exports.wasm.wasm import as_json, as_line, check_compiler, compiled, statuses
from symofros.native import native_text


def write_diagram_wasm(
    diagram: Diagram, folder: Path, outputs: Sequence[str] | None, stepping: Stepping, generator: str
) -> Exported:
    """Write the WebAssembly module of a diagram; arguments as of `write_diagram`.

    Raises:
        CompileError: There is no ziglang package, or it failed; with its command and messages.
        ExportError: The diagram calls Python, or the folder is not ours.
    """
    check_compiler()
    program = diagram_program(diagram, outputs, stepping, generator)
    name, title, shown = program.name, diagram.name, program.interface
    module = _module(program, title, generator)
    names = {
        "inputs": [item.name for item in shown.inputs],
        "outputs": [item.name for item in shown.outputs],
        "parameters": [item.name for item in shown.parameters],
    }
    types = {key: " | ".join(map(json.dumps, of)) or "never" for key, of in names.items()}
    first = program.first
    expected = {"inputs": list(first.given), "until": first.until, "outputs": list(first.signals)}
    files: dict[str, str | bytes] = {
        f"{name}.mjs": _script(program, title, module, generator),
        f"{name}.d.ts": Template(native_text("exports/symofros_wasm_program.d.ts.in")).substitute(
            title=as_line(title), **types
        ),
        f"{name}.wasm": module,
        "selftest.mjs": Template(_SELFTEST).substitute(name=name, tolerance=TOLERANCE, expected=as_json(expected)),
    }
    return write_folder(folder, "wasm", name, files, generator, program.notes)


def _module(program: DiagramProgram, title: str, generator: str) -> bytes:
    """The bytes of the module."""
    name = program.name
    glue = unity(
        name,
        f"{comment(title)} for WebAssembly, by {generator}.",
        [f'#include "{name}.h"', f"#define SYM_WASM_PROGRAM {name}_program"],
        ['#include "symofros_wasm_program.c"'],
        included=("symofros_diagram.c",),
        loop=DIAGRAM_LOOP,
    )
    own = {"module.c": glue, "symofros_wasm_program.c": native_text("exports/symofros_wasm_program.c")}
    return compiled({**program.files, **loop_files(), **own}, ["module.c", *program.c_files])


def _script(program: DiagramProgram, title: str, module: bytes, generator: str) -> str:
    """The ES module: the runtime, names and places, the bytes of the WebAssembly module."""
    shown = program.interface
    tables: dict[str, Any] = {
        "inputs": _places(shown.inputs),
        "outputs": _places(shown.outputs),
        "parameters": _places(shown.parameters),
        "period": program.period,
    }
    lines = [
        f"// {as_line(title)}: written by {generator}.",
        native_text("exports/symofros_wasm_program.mjs"),
        f"const STATUSES = {as_json(statuses())};",
        f"const TABLES = {as_json(tables)};",
        f'const BYTES = "{base64.b64encode(module).decode()}";',
        "",
        "/** The diagram of this file. */",
        "export async function load() {",
        "  return Program.load(Uint8Array.from(atob(BYTES), (c) => c.charCodeAt(0)), TABLES);",
        "}",
        "",
    ]
    return "\n".join(lines)


def _places(quantities: Sequence[Quantity]) -> dict[str, dict[str, Any]]:
    """Name -> where a quantity begins in its array, its width, shape and units."""
    places, at = dict[str, dict[str, Any]](), 0
    for item in quantities:
        places[item.name] = {"at": at, "width": item.width, "shape": list(item.shape), "units": list(item.units)}
        at += item.width
    return places


_SELFTEST = """\
// node selftest.mjs: the outputs after a while, as those of the same diagram run from Python.
import { load } from "./$name.mjs";

const expected = $expected;
const program = await load(), it = program.instance();
let at = 0;
for (const [name, { width }] of Object.entries(program.inputs)) it.set(name, expected.inputs.slice(at, (at += width)));
it.advance(expected.until);
const found = Object.keys(program.outputs).flatMap((name) => Array.from(it.get(name)));
const worst = Math.max(0, ...found.map((x, i) => Math.abs(x - expected.outputs[i])));
console.log(`selftest $${worst.toExponential(3)}`);
process.exit(worst <= $tolerance * Math.max(1, ...expected.outputs.map(Math.abs)) ? 0 : 1);
"""
