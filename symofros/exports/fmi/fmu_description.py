"""modelDescription.xml and buildDescription.xml."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from xml.etree import ElementTree as Tree

from symofros.base.units import BASE, parse
from symofros.errors import DescriptionError
from symofros.exports.fmi.fmu_variables import Variable
from symofros.exports.material import Stepping


@dataclass(frozen=True)
class Unit:
    """What a unit says of itself, whatever it holds.

    Attributes:
        name: Name for people.
        c_name: Prefix of its functions.
        about: Description for people.
        generator: Name and version of the generator.
        stepping: How it steps by itself.
        interval: Communication step that it proposes [s].
        sources: C files that are compiled, the one with the interface first.
        exchanged: Whether Model Exchange is offered, with derivatives.
        serialised: Whether states that it keeps can be serialised.
        judged: Whether steps of an importer's integrator are judged at their ends, as bending beams are.
    """

    name: str
    c_name: str
    about: str
    generator: str
    stepping: Stepping
    interval: float
    sources: tuple[str, ...]
    exchanged: bool = True
    serialised: bool = True
    judged: bool = False


def description_xml(unit: Unit, variables: Sequence[Variable], version: int, token: str, created: str) -> str:
    """The text of modelDescription.xml.

    Args:
        unit: The unit.
        variables: Its variables.
        version: 2 or 3.
        token: GUID, or instantiation token.
        created: Date and time, ISO.
    """
    head = {
        "fmiVersion": "2.0" if version == 2 else "3.0",
        "modelName": unit.name,
        "guid" if version == 2 else "instantiationToken": token,
        "description": unit.about,
        "generationTool": unit.generator,
        "generationDateAndTime": created,
        "variableNamingConvention": "structured",
    }
    if version == 2:
        head["numberOfEventIndicators"] = "0"
    root = Tree.Element("fmiModelDescription", head)
    _interfaces(root, unit, version)
    _units(root, variables)
    categories = Tree.SubElement(root, "LogCategories")
    for name in ("logStatusWarning", "logStatusError", "logStatusDiscard"):
        Tree.SubElement(categories, "Category", {"name": name})
    Tree.SubElement(root, "DefaultExperiment", {"startTime": "0", "stopTime": "1", "stepSize": repr(unit.interval)})
    into = Tree.SubElement(root, "ModelVariables")
    for variable in variables:
        (_variable2 if version == 2 else _variable3)(into, variable)
    (_structure2 if version == 2 else _structure3)(root, variables)
    Tree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + Tree.tostring(root, encoding="unicode") + "\n"


def _interfaces(root: Tree.Element, unit: Unit, version: int) -> None:
    common = {"modelIdentifier": unit.c_name}
    offered, serialised = (str(offers).lower() for offers in (unit.exchanged, unit.serialised))
    if version == 2:
        both = {
            "canGetAndSetFMUstate": "true",
            "canSerializeFMUstate": serialised,
            "providesDirectionalDerivative": offered,
        }
    else:
        both = {
            "canGetAndSetFMUState": "true",
            "canSerializeFMUState": serialised,
            "providesDirectionalDerivatives": offered,
        }
    stepping = {"canHandleVariableCommunicationStepSize": "true"}
    if version == 3 and not unit.stepping.method.adaptive:
        stepping["fixedInternalStepSize"] = repr(unit.stepping.dt)
    # Ends of steps are where the bending of beams is judged.
    exchange = {"needsCompletedIntegratorStep": "true"} if version == 3 and unit.judged else {}
    for kind, more in (("ModelExchange", exchange), ("CoSimulation", stepping))[0 if unit.exchanged else 1 :]:
        entry = Tree.SubElement(root, kind, common | both | more)
        if version == 2:
            files = Tree.SubElement(entry, "SourceFiles")
            for source in unit.sources:
                Tree.SubElement(files, "File", {"name": source})


def _units(root: Tree.Element, variables: Sequence[Variable]) -> None:
    into = Tree.SubElement(root, "UnitDefinitions")
    for unit in sorted({variable.unit for variable in variables if variable.unit}):
        entry = Tree.SubElement(into, "Unit", {"name": unit})
        if base := _base(unit):
            Tree.SubElement(entry, "BaseUnit", base)


def _base(name: str) -> dict[str, str]:
    """Powers of the units of SI, and the factor by which values are multiplied; {} of a text that is no unit."""
    try:
        unit = parse(name.replace(".", " "))
    except DescriptionError:  # Units of parameters are any text.
        return {}
    powers = {base: str(power) for base, power in zip(BASE, unit.powers, strict=True) if power}
    return powers if unit.scale == 1.0 else {**powers, "factor": repr(unit.scale)}


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


def build_xml(unit: Unit) -> str:
    """buildDescription.xml of FMI 3: the files to compile, which include the others."""
    root = Tree.Element("fmiBuildDescription", {"fmiVersion": "3.0"})
    entry = Tree.SubElement(root, "BuildConfiguration", {"modelIdentifier": unit.c_name})
    files = Tree.SubElement(entry, "SourceFileSet", {"language": "C99"})
    for source in unit.sources:
        Tree.SubElement(files, "SourceFile", {"name": source})
    Tree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + Tree.tostring(root, encoding="unicode") + "\n"
