"""Plain C: a folder that builds and installs by CMake, tests itself, and simulates in real time."""

from __future__ import annotations

from pathlib import Path
from string import Template

from symofros.base.c_text import comment
from symofros.exports.c.plant import header_text, plant_text, selftest_text
from symofros.exports.c.reactions import efforts_text
from symofros.exports.c.typed import eigen_text, named_functions, typed_text
from symofros.exports.folder import Exported, write_folder
from symofros.exports.functions import cell, functions_table, names_table
from symofros.exports.material import Material
from symofros.native import amalgamated, header_files, native_text

# Two back ends, two compilers, and the conditioning of a robot's mass matrix lie between the points and the C code.
SELFTEST_TOLERANCE = "1e-9"
INTEGRATOR_HEADERS = (
    "model/symofros_model.h",
    "stepping/symofros_stepper.h",
    "stepping/instances/symofros_instance.h",
)


def model_files(material: Material) -> dict[str, str]:
    """What every target builds on: the model, its plant, the stepping loop."""
    name = material.c_name
    return {
        f"{name}.c": material.source,
        f"{name}.h": header_text(material),
        f"{name}_plant.c": plant_text(material),
        **(material.events.files if material.events else {}),
        **header_files(*INTEGRATOR_HEADERS),
        "symofros_stepper.c": amalgamated("stepping/symofros_stepper.c"),
    }


def write_c_package(material: Material, folder: Path) -> Exported:
    """The C package of a model.

    Raises:
        ExportError: The folder is not ours.
    """
    name, functions = material.c_name, named_functions(material)
    shown = next((item for item in functions if item.signature.name == "dynamics"), functions[0])
    arguments = [label for label, _ in (*shown.signature.inputs, *shown.signature.outputs)]
    version = material.generator.rpartition(" ")[2]
    fields = {
        "name": name,
        "generator": material.generator,
        "version": version,
        "tolerance": SELFTEST_TOLERANCE,
        "title": comment(material.record.name),
        "heading": cell(material.record.name),
        "functions": functions_table(functions),
        "names": names_table(material.record),
        "notes": "".join(["\n## Notes\n\n", *(f"- {note}\n" for note in material.notes)]) if material.notes else "",
        "example": f"{shown.symbol}({', '.join(['pre', *arguments, 'work'])})",
    }
    filled = {"main.c": "main.c.in", "CMakeLists.txt": "CMakeLists.txt.in", f"{name}.pc.in": "model.pc.in"}
    filled["README.md"] = "README.md.in"
    files = model_files(material) | {f"{name}_selftest.c": selftest_text(material)}
    files |= {f"{name}_functions.h": typed_text(material), f"{name}.hpp": eigen_text(material)}
    files |= {f"{name}_efforts.c": efforts_text(material)} | header_files("exports/symofros_efforts.h")
    files |= {file: Template(native_text(f"exports/{source}")).substitute(fields) for file, source in filled.items()}
    return write_folder(folder, "c", name, files, material.generator, material.notes)
