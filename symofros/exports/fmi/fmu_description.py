"""modelDescription.xml and buildDescription.xml."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree as Tree

from symofros.exports.fmi.fmu_variables import Variable
from symofros.exports.material import Material

_BASES: dict[str, dict[str, str]] = {
    "s": {"s": "1"},
    "m": {"m": "1"},
    "m/s": {"m": "1", "s": "-1"},
    "m/s2": {"m": "1", "s": "-2"},
    "rad": {"rad": "1"},
    "rad/s": {"rad": "1", "s": "-1"},
    "rad/s2": {"rad": "1", "s": "-2"},
    "N": {"kg": "1", "m": "1", "s": "-2"},
    "N.m": {"kg": "1", "m": "2", "s": "-2"},
    "J": {"kg": "1", "m": "2", "s": "-2"},
    "kg": {"kg": "1"},
}


def description_xml(material: Material, variables: Sequence[Variable], version: int, token: str, created: str) -> str:
    """The text of modelDescription.xml.

    Args:
        material: The model.
        variables: Variables of the model.
        version: 2 or 3.
        token: GUID, or instantiation token.
        created: Date and time, ISO.
    """
    head = {
        "fmiVersion": "2.0" if version == 2 else "3.0",
        "modelName": material.record.name,
        "guid" if version == 2 else "instantiationToken": token,
        "description": f"{len(material.record.v_names)} speeds, {material.record.nc} constraints",
        "generationTool": material.generator,
        "generationDateAndTime": created,
        "variableNamingConvention": "structured",
    }
    if version == 2:
        head["numberOfEventIndicators"] = "0"
    root = Tree.Element("fmiModelDescription", head)
    _interfaces(root, material, version)
    _units(root, variables)
    categories = Tree.SubElement(root, "LogCategories")
    for name in ("logStatusWarning", "logStatusError", "logStatusDiscard"):
        Tree.SubElement(categories, "Category", {"name": name})
    Tree.SubElement(
        root, "DefaultExperiment", {"startTime": "0", "stopTime": "1", "stepSize": repr(_communication(material))}
    )
    into = Tree.SubElement(root, "ModelVariables")
    for variable in variables:
        (_variable2 if version == 2 else _variable3)(into, variable)
    (_structure2 if version == 2 else _structure3)(root, variables)
    Tree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + Tree.tostring(root, encoding="unicode") + "\n"


def _communication(material: Material) -> float:
    return max(10 * material.stepping.dt, 1e-3)


def _interfaces(root: Tree.Element, material: Material, version: int) -> None:
    common = {"modelIdentifier": material.c_name}
    if version == 2:
        both = {"canGetAndSetFMUstate": "true", "canSerializeFMUstate": "true", "providesDirectionalDerivative": "true"}
    else:
        both = {
            "canGetAndSetFMUState": "true",
            "canSerializeFMUState": "true",
            "providesDirectionalDerivatives": "true",
        }
    stepping = {"canHandleVariableCommunicationStepSize": "true"}
    if version == 3 and not material.stepping.method.adaptive:
        stepping["fixedInternalStepSize"] = repr(material.stepping.dt)
    # Ends of steps are where the bending of beams is judged.
    exchange = {"needsCompletedIntegratorStep": "true"} if version == 3 and material.beams else {}
    for kind, more in (("ModelExchange", exchange), ("CoSimulation", stepping)):
        entry = Tree.SubElement(root, kind, common | both | more)
        if version == 2:
            Tree.SubElement(Tree.SubElement(entry, "SourceFiles"), "File", {"name": f"{material.c_name}_fmi2.c"})


def _units(root: Tree.Element, variables: Sequence[Variable]) -> None:
    into = Tree.SubElement(root, "UnitDefinitions")
    for unit in sorted({variable.unit for variable in variables if variable.unit}):
        entry = Tree.SubElement(into, "Unit", {"name": unit})
        if unit in _BASES:
            Tree.SubElement(entry, "BaseUnit", _BASES[unit])


def _typed(variable: Variable) -> dict[str, str]:
    typed = {}
    if variable.unit:
        typed["unit"] = variable.unit
    if variable.start is not None:
        typed["start"] = repr(variable.start)
    return typed


def _common(variable: Variable) -> dict[str, str]:
    common = {
        "name": variable.name,
        "valueReference": str(variable.reference),
        "causality": variable.causality,
        "variability": variable.variability,
    }
    if variable.initial:
        common["initial"] = variable.initial
    if variable.about:
        common["description"] = variable.about
    return common


def _variable2(into: Tree.Element, variable: Variable) -> None:
    typed = _typed(variable)
    if variable.derivative is not None:
        typed["derivative"] = str(variable.derivative + 1)  # Indices count from one.
    Tree.SubElement(Tree.SubElement(into, "ScalarVariable", _common(variable)), "Real", typed)


def _variable3(into: Tree.Element, variable: Variable) -> None:
    typed = _typed(variable)
    if variable.derivative is not None:
        typed["derivative"] = str(variable.derivative)
    Tree.SubElement(into, "Float64", _common(variable) | typed)


def _groups(variables: Sequence[Variable]) -> list[tuple[str, str, list[Variable]]]:
    """(element of FMI 2, element of FMI 3, variables)."""
    derivatives = [variable for variable in variables if variable.derivative is not None]
    states = {variable.derivative for variable in derivatives}
    outputs = [variable for variable in variables if variable.causality == "output"]
    unknown = [
        variable
        for variable in variables
        if variable.initial in ("approx", "calculated")
        and (variable.causality == "output" or variable.derivative is not None or variable.reference in states)
    ]
    return [
        ("Outputs", "Output", outputs),
        ("Derivatives", "ContinuousStateDerivative", derivatives),
        ("InitialUnknowns", "InitialUnknown", unknown),
    ]


def _structure2(root: Tree.Element, variables: Sequence[Variable]) -> None:
    structure = Tree.SubElement(root, "ModelStructure")
    for element, _, members in _groups(variables):
        if not members:
            continue
        into = Tree.SubElement(structure, element)
        for variable in members:
            # What an initial unknown depends on is left open: on parameters, too.
            depends = None if element == "InitialUnknowns" else variable.depends
            stated = {} if depends is None else {"dependencies": " ".join(str(i + 1) for i in depends)}
            Tree.SubElement(into, "Unknown", {"index": str(variable.reference + 1), **stated})


def _structure3(root: Tree.Element, variables: Sequence[Variable]) -> None:
    structure = Tree.SubElement(root, "ModelStructure")
    for _, element, members in _groups(variables):
        for variable in members:
            depends = None if element == "InitialUnknown" else variable.depends
            stated = {} if depends is None else {"dependencies": " ".join(map(str, depends))}
            Tree.SubElement(structure, element, {"valueReference": str(variable.reference), **stated})


def build_xml(c_name: str) -> str:
    """buildDescription.xml of FMI 3: one file that includes the others."""
    root = Tree.Element("fmiBuildDescription", {"fmiVersion": "3.0"})
    entry = Tree.SubElement(root, "BuildConfiguration", {"modelIdentifier": c_name})
    files = Tree.SubElement(entry, "SourceFileSet", {"language": "C99"})
    Tree.SubElement(files, "SourceFile", {"name": f"{c_name}_fmi3.c"})
    Tree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + Tree.tostring(root, encoding="unicode") + "\n"
