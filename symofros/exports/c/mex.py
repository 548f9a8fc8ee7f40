"""Functions of Matlab and Octave: of a model the calls of the SYMOFROS paper's section 8, of a diagram its steps."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from symofros.base.c_text import c_string, comment
from symofros.diagrams.diagram import Diagram
from symofros.exports.c.c_package import model_files
from symofros.exports.c.unity import MODEL_LOOP, unity
from symofros.exports.diagram import DIAGRAM_LOOP, diagram_program, loop_files
from symofros.exports.folder import Exported, write_folder
from symofros.exports.functions import states_note
from symofros.exports.material import Material, Stepping
from symofros.native import native_text

_HELP = """{name}  {title}: {nq} coordinates, {nv} speeds, {nu} inputs, {npar} parameters, {nc} constraints.

[SysDim, SysSet, FlexLink, Parameter, Frame, Info] = {name}(0)        sizes, names, defaults
[Mnl, gnl] = {name}(1, X, U, Parameters, t)           mass matrix and Q - h: Mnl*a = gnl for a tree
[a, lam] = {name}(2, X, U, Parameters, t)             direct dynamics: accelerations, multipliers
tau = {name}(3, X, A, U, Parameters, t)               inverse dynamics
[p, R, V, J, dJ] = {name}(4, X, frame, U, Parameters, t)   kinematics of a frame, by name or number
[phi, G, gamma] = {name}(5, X, U, Parameters, t)      holonomic constraints
[rate, G, gamma] = {name}(6, X, U, Parameters, t)     non-holonomic constraints: G*v - b
[T, V] = {name}(7, X, U, Parameters, t)               kinetic and potential energy
[A, B] = {name}(8, X, U, Parameters, t)               linearisation: x' = A*x + B*u
[T, X] = {name}(9, X, U, Parameters, [t0 t_end dt])   simulation, inputs held; events act

X = [q; v]. U, Parameters and t may be left out or empty: defaults, and t = 0. SI units, radians.
V, J, dJ: linear part first, in world axes. An empty {name}() prints this text.{states}
"""

_DIAGRAM_HELP = """{name}  {title}: a diagram of {inputs} inputs, {outputs} outputs, {parameters} parameters.

[Inputs, Outputs, Parameters, Info] = {name}(0)       names, units, first values; base period
y = {name}(1, U, Parameters)          begins a motion: outputs at t = 0
[y, t] = {name}(2, t, U)              moves to time t: outputs there
[T, Y] = {name}(3, T, U, Parameters)  a whole motion: Y has a row for each time

A call moves mechanisms to its time under the inputs of the call before; what is sampled at that time
reads the inputs of the call. U of flag 3 is a column that holds, or has a row for each time. U and
Parameters may be left out or empty: first values; U of flag 2: as it is. An event that ends the motion
ends T, or gives a t before that asked for. An empty {name}() prints this text.
"""

_BUILD = """% Builds {name}, in Octave or Matlab: run it in this folder.
% Seen from elsewhere, a function of that name is another one, which this folder hides.
here = pwd();
cd(tempdir());
kind = exist('{name}');
place = which('{name}');
cd(here);
if any(kind == [2 3 5 6]) && ~strncmp(place, here, numel(here))
  error('symofros:{name}:taken', ['{name} is a function already, which this one would hide; ' ...
    'export the model by another name, such as my_{name}']);
end
if exist('OCTAVE_VERSION', 'builtin')
  [output, status] = mkoctfile('--mex', {sources}, '-o', ['{name}.' mexext()]);
  if status ~= 0
    error('symofros:{name}:build', '%s', output);
  end
else
  mex('-output', '{name}', {sources});
end
clear('{name}');
rehash();
"""


def write_mex(material: Material, folder: Path) -> Exported:
    """NAME_mex.c with what it includes, NAME.m with the help, and build_NAME.m.

    Raises:
        ExportError: The folder is not ours.
    """
    name, record = material.c_name, material.record
    text = _HELP.format(
        name=name,
        title=comment(record.name),
        nq=len(record.q_names),
        nv=len(record.v_names),
        nu=len(record.u_names),
        npar=len(record.par_names),
        nc=record.nc,
        states="".join(f"\n{note}." for note in states_note(record)),
    )
    beams = [body for body in material.system.beams if body.modes]
    rows = [
        f"    {{{c_string(beam.name)}, {record.q_names.index(beam.coordinates[0])}, {beam.modes}}}" for beam in beams
    ]
    listed = ",\n".join(rows) or "    {NULL, 0, 0}"
    own = [
        f"#define SYM_MEX_PLANT {name}_plant",
        f"#define SYM_MEX_BEAMS {len(beams)}",
        "static const struct {\n    const char *name;\n    int32_t first, count;\n} "
        f"sym_mex_beams[] = {{\n{listed}\n}};",
    ]
    files = _function(name, record.name, text, own, material.generator) | model_files(material)
    return write_folder(folder, "mex", name, files, material.generator, material.notes)


def write_diagram_mex(
    diagram: Diagram, folder: Path, outputs: Sequence[str] | None, stepping: Stepping, generator: str
) -> Exported:
    """The same files of a diagram; arguments as of `write_diagram`.

    Raises:
        ExportError: The diagram calls Python, or the folder is not ours.
    """
    program = diagram_program(diagram, outputs, stepping, generator)
    name, shown = program.name, program.interface
    text = _DIAGRAM_HELP.format(
        name=name,
        title=comment(diagram.name),
        inputs=sum(item.width for item in shown.inputs),
        outputs=sum(item.width for item in shown.outputs),
        parameters=sum(item.width for item in shown.parameters),
    )
    own = [
        f'#include "{name}.h"',
        f"#define SYM_MEX_PROGRAM {name}_program",
        f"#define SYM_MEX_PERIOD {program.period!r}",
    ]
    files = _function(name, diagram.name, text, own, generator, program.c_files) | program.files | loop_files()
    return write_folder(folder, "mex", name, files, generator, program.notes)


def _function(
    name: str, title: str, text: str, own: Sequence[str], generator: str, compiled: Sequence[str] | None = None
) -> dict[str, str]:
    """File name -> text of a function, its help and its build script.

    Args:
        name: Name of the function.
        title: Name of the model or the diagram.
        text: Its help.
        own: Lines that say what it wraps.
        generator: Name and version.
        compiled: Of a diagram, names of its files that are compiled; a model is included by the function's file.
    """
    shown = "\n".join(f"    {c_string(line)} {c_string(chr(10))}" for line in text.splitlines())
    body = "symofros_mex.c" if compiled is None else "symofros_mex_program.c"
    glue = unity(
        name,
        f"{comment(title)} as a function of Matlab or Octave, by {generator}.",
        [f"#define SYM_MEX_NAME {c_string(name)}", *own, f"static const char *const sym_mex_help =\n{shown};"],
        [
            "#if defined(__GNUC__) && !defined(_WIN32)",
            '#define SYM_MEX_EXPORT __attribute__((visibility("default")))',
            "#else",
            "#define SYM_MEX_EXPORT",
            "#endif",
            f'#include "{body}"',
        ],
        ['"mex.h"'],
        linked=compiled is not None,
        included=() if compiled is None else ("symofros_diagram.c",),
        loop=MODEL_LOOP if compiled is None else DIAGRAM_LOOP,
    )
    sources = ", ".join(f"'{file}'" for file in (f"{name}_mex.c", *(compiled or ())))
    commented = "".join(f"% {line}".rstrip() + "\n" for line in text.splitlines())
    return {
        f"{name}_mex.c": glue,
        **{file: native_text(f"exports/{file}") for file in (body, "symofros_mex_arrays.h")},
        f"build_{name}.m": _BUILD.format(name=name, sources=sources),
        f"{name}.m": commented + _UNBUILT.format(name=name),
    }


_UNBUILT = """function varargout = {name}(varargin)
error('symofros:{name}:build', 'run build_{name} in the folder of {name}.m first');
"""
