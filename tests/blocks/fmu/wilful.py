"""A unit of FMI 2 in native code that does what its input says; see wilful.c."""

from __future__ import annotations

import subprocess
import zipfile
from pathlib import Path

from symofros.exports.fmi.fmu import fmi_headers

_STATED = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="wilful" guid="wilful" author="A. Pump" generationTool="a compiler">
  <CoSimulation modelIdentifier="wilful" canHandleVariableCommunicationStepSize="true"/>
  <ModelVariables>
    <ScalarVariable name="pump.u" valueReference="0" causality="input" variability="continuous">
      <Real start="0" unit="N.m"/>
    </ScalarVariable>
    <ScalarVariable name="pump.y" valueReference="1" causality="output" variability="continuous">
      <Real unit="furlong"/>
    </ScalarVariable>
    <ScalarVariable name="fixed" valueReference="2" causality="parameter" variability="fixed" initial="exact">
      <Real start="0.5"/>
    </ScalarVariable>
    <ScalarVariable name="first" valueReference="3" causality="output" variability="continuous">
      <Real/>
    </ScalarVariable>
    <ScalarVariable name="milliseconds" valueReference="4" causality="output" variability="discrete">
      <Real/>
    </ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="2"/><Unknown index="4"/><Unknown index="5"/></Outputs>
  </ModelStructure>
</fmiModelDescription>
"""


def wilful_unit(folder: Path) -> Path:
    """A unit in a folder that passes its input on, crashes, hangs, fails, prints or ends, as its input says."""
    source, library, unit = Path(__file__).with_name("wilful.c"), folder / "wilful.so", folder / "wilful.fmu"
    command = ["cc", "-shared", "-fPIC", "-I", str(fmi_headers()), "-o", str(library), str(source)]
    subprocess.run(command, check=True)
    with zipfile.ZipFile(unit, "w") as archive:
        archive.writestr("modelDescription.xml", _STATED)
        archive.write(library, "binaries/linux64/wilful.so")
    return unit


def changed(unit: Path) -> None:
    """Change the bytes of a unit, not what it does: a comment at the end of the archive."""
    with zipfile.ZipFile(unit, "a") as archive:
        archive.comment += b"changed"
