"""Functional mock-up units: FMI 2.0 and 3.0, Model Exchange and Co-Simulation, binary and sources."""

from __future__ import annotations

import hashlib
import importlib.util
import io
import platform
import sys
import zipfile
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from string import Template
from uuid import UUID

from symofros.base.c_text import c_string, comment, doubles, strings
from symofros.diagrams.diagram import Diagram
from symofros.errors import ExportError
from symofros.exports.c.c_package import model_files
from symofros.exports.c.compiling import shared_library
from symofros.exports.c.event_plan import refuse_ends
from symofros.exports.c.unity import MODEL_LOOP, unity
from symofros.exports.diagram import DIAGRAM_LOOP, DiagramProgram, diagram_program, loop_files
from symofros.exports.fmi.fmu_description import Unit, build_xml, description_xml
from symofros.exports.fmi.fmu_variables import Variable, diagram_variables, variables
from symofros.exports.folder import Exported, write_folder
from symofros.exports.material import Material, Stepping
from symofros.native import native_text

_MACHINES = {"x86_64": "x86_64", "amd64": "x86_64", "aarch64": "aarch64", "arm64": "aarch64"}
_SYSTEMS = {"linux": ("linux", ".so"), "darwin": ("darwin", ".dylib"), "win32": ("windows", ".dll")}
_OLD_NAMES = {("x86_64", "linux"): "linux64", ("x86_64", "darwin"): "darwin64", ("x86_64", "windows"): "win64"}
# Included by the files of both versions' interfaces, before and after the standard's header.
_BOTH = "symofros_fmi.h"
_COMMON = "symofros_fmi_shared.h"
# As FMI 3 asks of sources; functions of a shared library have no prefix. In FMI 2 importers define FMI2_FUNCTION_PREFIX
# where sources of several units go into one program.
_PREFIXED = Template("""\
#if !defined(FMI3_FUNCTION_PREFIX)
#define FMI3_FUNCTION_PREFIX ${name}_
#endif
""")
_SHARED = {2: (), 3: ("-DFMI3_OVERRIDE_FUNCTION_PREFIX",)}
_INTERFACE = {2: ("symofros_fmi2.c",), 3: ("symofros_fmi3.c", "symofros_fmi3_none.c")}
# The same content gives the same archive, byte for byte.
_EPOCH = (1980, 1, 1, 0, 0, 0)


def write_fmu2(material: Material, folder: Path) -> Exported:
    """NAME.fmu of FMI 2.0 in a folder."""
    return _write(material, folder, 2)


def write_fmu3(material: Material, folder: Path) -> Exported:
    """NAME.fmu of FMI 3.0 in a folder."""
    return _write(material, folder, 3)


def _write(material: Material, folder: Path, version: int) -> Exported:
    name = material.c_name
    sources = model_files(material)
    token = _token([*sources.values(), *material.outputs, *material.functions[-1]], version)
    frames = strings(material.outputs) if material.outputs else "NULL"
    own = [
        f"#define SYM_FMU_PLANT {name}_plant",
        f"#define SYM_FMU_FRAMES {len(material.outputs)}",
        f"static const char *const sym_fmu_frames[] = {{{frames}}};",
        f"static const double sym_fmu_reach[] = {{{doubles(material.reach)}}};",
        '#include "symofros_fmu.h"',
    ]
    sources[f"{name}_fmi{version}.c"] = _glue(name, material.record.name, material.generator, own, version, token)
    stepping, record = material.stepping, material.record
    unit = Unit(
        record.name,
        name,
        f"{len(record.v_names)} speeds, {record.nc} constraints",
        material.generator,
        stepping,
        max(10 * stepping.dt, 1e-3),
        (f"{name}_fmi{version}.c",),
        exchanged=material.events is None,
        judged=bool(material.beams),
    )
    return _packed(
        unit, folder, version, token, {**sources, **_core("symofros_fmu.h")}, variables(material), material.notes
    )


def write_diagram_fmu2(
    diagram: Diagram, folder: Path, outputs: Sequence[str] | None, stepping: Stepping, generator: str
) -> Exported:
    """NAME.fmu of FMI 2.0 of a diagram; arguments as of `write_diagram`."""
    return _write_diagram(diagram_program(diagram, outputs, stepping, generator), folder, stepping, generator, 2)


def write_diagram_fmu3(
    diagram: Diagram, folder: Path, outputs: Sequence[str] | None, stepping: Stepping, generator: str
) -> Exported:
    """NAME.fmu of FMI 3.0 of a diagram; arguments as of `write_diagram`."""
    return _write_diagram(diagram_program(diagram, outputs, stepping, generator), folder, stepping, generator, 3)


def _write_diagram(program: DiagramProgram, folder: Path, stepping: Stepping, generator: str, version: int) -> Exported:
    name, title, shown = program.name, program.resolved.wired.name, program.interface
    for switching in map(program.resolved.switching, program.resolved.layout.parts):
        refuse_ends(() if switching is None else switching.events)
    sources = program.files | loop_files()
    token = _token([*sources.values()], version)
    own = [f'#include "{name}.h"', f"#define SYM_FMU_PROGRAM {name}_program", '#include "symofros_fmu_program.h"']
    main = f"{name}_fmi{version}.c"
    loop = ["symofros_diagram.c"]
    sources[main] = _glue(name, title, generator, own, version, token, loop, DIAGRAM_LOOP)
    unit = Unit(
        title,
        name,
        f"a diagram: {len(shown.inputs)} inputs, {len(shown.outputs)} outputs, {len(shown.parameters)} parameters",
        generator,
        stepping,
        program.period,
        (main, *program.c_files),
        exchanged=False,
        serialised=False,
    )
    listed = diagram_variables(shown)
    return _packed(unit, folder, version, token, {**sources, **_core("symofros_fmu_program.h")}, listed, program.notes)


def _core(header: str) -> dict[str, str]:
    """File name -> text of a unit's core."""
    return {file: native_text(f"exports/{file}") for file in ("symofros_fmu_codes.h", header)}


def _packed(
    unit: Unit,
    folder: Path,
    version: int,
    token: str,
    sources: dict[str, str],
    listed: Sequence[Variable],
    notes: tuple[str, ...],
) -> Exported:
    """The archive of a unit, its library compiled."""
    for file in (_BOTH, _COMMON, *_INTERFACE[version]):
        sources[file] = native_text(f"exports/{file}")
    library = shared_library(sources, unit.sources, [fmi_headers()], ("-DSYM_EXPORT=", *_SHARED[version]))
    place, suffix = _platform(version)
    entries: dict[str, str | bytes] = {
        "modelDescription.xml": description_xml(unit, listed, version, token, _created()),
        f"binaries/{place}/{unit.c_name}{suffix}": library,
        **{f"sources/{file}": text for file, text in sources.items()},
    }
    if version == 3:
        entries["sources/buildDescription.xml"] = build_xml(unit)
    archive = {f"{unit.c_name}.fmu": _archive(entries)}
    return write_folder(folder, f"fmu{version}", unit.c_name, archive, unit.generator, notes)


def fmi_headers() -> Path:
    """The folder of the standard's headers, which the FMPy package carries.

    Raises:
        ExportError: FMPy is not installed.
    """
    spec = importlib.util.find_spec("fmpy")
    if spec is None or spec.origin is None:
        raise ExportError.of_extra(
            "an FMU needs the headers of the FMI standard",
            "no package fmpy",
            "they are read from the package FMPy",
            "fmi",
        )
    return Path(spec.origin).parent / "c-code"


def _glue(
    name: str,
    title: str,
    generator: str,
    own: Sequence[str],
    version: int,
    token: str,
    included: Sequence[str] = (),
    loop: str = MODEL_LOOP,
) -> str:
    """The C file of the interface, over what `own` defines and includes."""
    return unity(
        name,
        f"{comment(title)} as an FMU of FMI {version}.0, by {generator}.",
        [f"#define SYM_FMU_TOKEN {c_string(token)}", *own, f'#include "{_BOTH}"'],
        [
            *(_PREFIXED.substitute(name=name).splitlines() if version == 3 else ()),
            f'#include "fmi{version}Functions.h"',
            *(f'#include "{file}"' for file in _INTERFACE[version]),
        ],
        linked=True,
        included=included,
        loop=loop,
    )


def _token(parts: Sequence[str], version: int) -> str:
    """Token of an FMU, a digest of its content: other models, outputs or FMI versions have other tokens."""
    digest = hashlib.sha256("\0".join([*parts, str(version)]).encode()).digest()
    return f"{{{UUID(bytes=digest[:16])}}}"


def _platform(version: int) -> tuple[str, str]:
    """Folder of the binary, and its suffix."""
    machine = _MACHINES.get(platform.machine().lower(), platform.machine().lower())
    system, suffix = _SYSTEMS.get(sys.platform, (sys.platform, ".so"))
    if version == 2:
        return _OLD_NAMES.get((machine, system), f"{system}-{machine}"), suffix
    return f"{machine}-{system}", suffix


def _created() -> str:
    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def _archive(entries: dict[str, str | bytes]) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in entries.items():
            archive.writestr(zipfile.ZipInfo(name, _EPOCH), content, zipfile.ZIP_DEFLATED)
    return stream.getvalue()
