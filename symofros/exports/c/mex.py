"""A function of Matlab and Octave: the calls of the SYMOFROS paper's section 8, and more flags of the kind."""

from __future__ import annotations

from pathlib import Path

from symofros.base.c_text import c_string, comment
from symofros.errors import ExportError, Problem
from symofros.exports.c.c_package import model_files
from symofros.exports.c.unity import unity
from symofros.exports.folder import Exported, write_folder
from symofros.exports.functions import states_note
from symofros.exports.material import Material
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

# Words of the languages, and what the script below calls: no function may hide it.
_TAKEN = frozenset(
    "classdef spmd until unwind_protect"
    " any cd clear error exist mex mexext mkoctfile numel pwd rehash strncmp tempdir which".split()
)
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
  [output, status] = mkoctfile('--mex', '{name}_mex.c', '-o', ['{name}.' mexext()]);
  if status ~= 0
    error('symofros:{name}:build', '%s', output);
  end
else
  mex('-output', '{name}', '{name}_mex.c');
end
clear('{name}');
rehash();
"""


def write_mex(material: Material, folder: Path) -> Exported:
    """NAME_mex.c with what it includes, NAME.m with the help, and build_NAME.m.

    Raises:
        ExportError: The folder is not ours, or Matlab has another use for the name.
    """
    name, record = material.c_name, material.record
    if name in _TAKEN:
        rule, remedy = "the model becomes a function of its name, which hides no other", f"for example name='my_{name}'"
        raise ExportError(Problem("mex: the name is taken in Matlab and Octave", name, rule, remedy))
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
    shown = "\n".join(f"    {c_string(line)} {c_string(chr(10))}" for line in text.splitlines())
    beams = [body for body in material.system.beams if body.modes]
    rows = [
        f"    {{{c_string(beam.name)}, {record.q_names.index(beam.coordinates[0])}, {beam.modes}}}" for beam in beams
    ]
    listed = ",\n".join(rows) or "    {NULL, 0, 0}"
    glue = unity(
        name,
        f"{comment(record.name)} as a function of Matlab or Octave, by {material.generator}.",
        [
            f"#define SYM_MEX_PLANT {name}_plant",
            f"#define SYM_MEX_NAME {c_string(name)}",
            f"#define SYM_MEX_BEAMS {len(beams)}",
            "static const struct {\n    const char *name;\n    int32_t first, count;\n} "
            f"sym_mex_beams[] = {{\n{listed}\n}};",
            f"static const char *const sym_mex_help =\n{shown};",
        ],
        [
            "#if defined(__GNUC__) && !defined(_WIN32)",
            '#define SYM_MEX_EXPORT __attribute__((visibility("default")))',
            "#else",
            "#define SYM_MEX_EXPORT",
            "#endif",
            '#include "symofros_mex.c"',
        ],
        ['"mex.h"'],
    )
    commented = "".join(f"% {line}".rstrip() + "\n" for line in text.splitlines())
    files = {
        f"{name}_mex.c": glue,
        "symofros_mex.c": native_text("exports/symofros_mex.c"),
        f"build_{name}.m": _BUILD.format(name=name),
        f"{name}.m": commented + _UNBUILT.format(name=name),
    }
    return write_folder(folder, "mex", name, files | model_files(material), material.generator, material.notes)


_UNBUILT = """function varargout = {name}(varargin)
error('symofros:{name}:build', 'run build_{name} in the folder of {name}.m first');
"""
