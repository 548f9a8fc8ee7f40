"""Functional mock-up units: FMI 2.0 and 3.0, Model Exchange and Co-Simulation, binary and sources."""

from __future__ import annotations

import hashlib
import importlib.util
import io
import platform
import sys
import zipfile
from datetime import UTC, datetime
from pathlib import Path
from string import Template
from uuid import UUID

from symofros.base.c_text import c_string, comment, strings
from symofros.errors import ExportError, Problem
from symofros.exports.c.c_package import model_files
from symofros.exports.c.compiling import shared_library
from symofros.exports.c.unity import unity
from symofros.exports.fmi.fmu_description import build_xml, description_xml
from symofros.exports.fmi.fmu_variables import variables
from symofros.exports.folder import Exported, write_folder
from symofros.exports.material import Material
from symofros.native import native_text

_MACHINES = {"x86_64": "x86_64", "amd64": "x86_64", "aarch64": "aarch64", "arm64": "aarch64"}
_SYSTEMS = {"linux": ("linux", ".so"), "darwin": ("darwin", ".dylib"), "win32": ("windows", ".dll")}
_OLD_NAMES = {("x86_64", "linux"): "linux64", ("x86_64", "darwin"): "darwin64", ("x86_64", "windows"): "win64"}
_HEADERS = ("symofros_fmu.h", "symofros_fmi.h")
# Included by the files of both versions' interfaces.
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
    token = _token(material, sources, version)
    sources[f"{name}_fmi{version}.c"] = _glue(material, version, token)
    for file in (*_HEADERS, _COMMON, *_INTERFACE[version]):
        sources[file] = native_text(f"exports/{file}")
    library = shared_library(sources, f"{name}_fmi{version}.c", [fmi_headers()], _SHARED[version])
    place, suffix = _platform(version)
    fmi_variables = variables(material)
    entries: dict[str, str | bytes] = {
        "modelDescription.xml": description_xml(material, fmi_variables, version, token, _created()),
        f"binaries/{place}/{name}{suffix}": library,
        **{f"sources/{file}": text for file, text in sources.items()},
    }
    if version == 3:
        entries["sources/buildDescription.xml"] = build_xml(name)
    return write_folder(
        folder, f"fmu{version}", name, {f"{name}.fmu": _archive(entries)}, material.generator, material.notes
    )


def fmi_headers() -> Path:
    """The folder of the standard's headers, which the FMPy package carries.

    Raises:
        ExportError: FMPy is not installed.
    """
    spec = importlib.util.find_spec("fmpy")
    if spec is None or spec.origin is None:
        raise ExportError(
            Problem.of_extra(
                "an FMU needs the headers of the FMI standard",
                "no package fmpy",
                "they are read from the package FMPy",
                "fmi",
            )
        )
    return Path(spec.origin).parent / "c-code"


def _glue(material: Material, version: int, token: str) -> str:
    name = material.c_name
    frames = strings(material.outputs) if material.outputs else "NULL"
    return unity(
        name,
        f"{comment(material.record.name)} as an FMU of FMI {version}.0, by {material.generator}.",
        [
            f"#define SYM_FMU_PLANT {name}_plant",
            f"#define SYM_FMU_TOKEN {c_string(token)}",
            f"#define SYM_FMU_FRAMES {len(material.outputs)}",
            f"static const char *const sym_fmu_frames[] = {{{frames}}};",
            *(f'#include "{file}"' for file in _HEADERS),
        ],
        [
            *(_PREFIXED.substitute(name=name).splitlines() if version == 3 else ()),
            f'#include "fmi{version}Functions.h"',
            *(f'#include "{file}"' for file in _INTERFACE[version]),
        ],
        linked=True,
    )


def _token(material: Material, sources: dict[str, str], version: int) -> str:
    """Token of an FMU, a digest of its content: other models, outputs or FMI versions have other tokens."""
    parts = [*sources.values(), *material.outputs, *material.functions[-1], str(version)]
    digest = hashlib.sha256("\0".join(parts).encode()).digest()
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
