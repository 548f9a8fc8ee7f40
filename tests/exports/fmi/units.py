"""Functional mock-up units that tests make, and a unit that is called by hand."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model, FMU2Slave
from fmpy.fmi3 import FMU3Model, FMU3Slave
from fmpy.simulation import FMICallException

import symofros as sf
from symofros.exports.c import compiling
from tests.exports.cases import MODELS, PLANAR, system_of
from tests.exports.fmi.logs import heard
from tests.models import sampled
from tests.simulation.beam_models import cantilever_system

FLOATING = sf.load(Path(__file__).with_name("floating.yaml"))

# The importer moves the first joint and the last; the tip moves with them.
DRIVEN = sf.load(Path(__file__).with_name("driven.yaml"))
# The importer turns the base by a quaternion.
TURNED = sf.System(
    "turned",
    (
        sf.RigidBody("base", sf.Joint("gimbal", "ball", prescribed=True), sf.Inertia(1.0, moments=(1, 1, 1))),
        sf.RigidBody("arm", sf.Joint("q1", "revolute", "base", axis=(0, 1, 0)), sf.Inertia(1.0, (0.3, 0.1, 0))),
    ),
)
# A weak beam under its weight, which is a parameter; a column under axial load.
BLADE = sf.Beam("blade", sf.Joint("root", "fixed"), 1.0, 1.0, EI_z=1.0, bend_y=2)
LIMP = sf.System("limp", (BLADE,), [sf.Parameter("g", 0.2)], gravity=(0, "-g", 0))
BENT = {"limp": LIMP, "column": cantilever_system()}
OWN = {"floating": FLOATING, "driven": DRIVEN, "planar": PLANAR, "turned": TURNED}


def simulated(path: str, **options: Any) -> tuple[Any, list[str]]:
    """What FMPy's simulator returns, or None where the unit refuses to go on, and the unit's log."""
    with heard() as (logger, log):
        try:
            return fmpy.simulate_fmu(path, logger=logger, **options), log
        except FMICallException:
            return None, log


def system_called(name: str) -> sf.System:
    return (OWN | BENT)[name] if name in OWN | BENT else system_of(name)


def exported(of: sf.System | sf.Diagram, version: int, folder: Path, quick: bool = True, **options: Any) -> Path:
    """The unit of a system or a diagram, its library compiled in a fraction of the time; or as it ships."""
    target: Any = f"fmu{version}"
    with pytest.MonkeyPatch.context() as patch:
        if quick:
            patch.setattr(compiling, "FLAGS", ("-O0", *(flag for flag in compiling.FLAGS if flag != "-O2")))
        return sf.export(of, target, folder, **options).files[0]


ONE_VERSION = [pytest.param(2, marks=pytest.mark.slow), 3]
# Every model by one version of the standard in every run, by the other with --slow; a loop by both.
VERSIONS = {"planar_robot": 3, "floating": 2, "driven": 3, "planar": 3, "spatial_rod": 3}
# The robot takes as long to make as all others: a beam that a motor turns stands for it.
SAMPLED = sampled(MODELS, ("four_bar", "spatial_rod"))


def by_version(*cases: Any) -> list[Any]:
    """Models and versions that a test is tried with."""
    listed = [case if hasattr(case, "values") else pytest.param(case) for case in cases]
    return [
        pytest.param(version, *case.values, marks=[*case.marks, *([pytest.mark.slow] if other else [])])
        for case in listed
        for version in (2, 3)
        for other in [VERSIONS.get(case.values[0], version) != version]
    ]


class Unit:
    """An instance of a unit, of either version of FMI, called by hand."""

    def __init__(self, path: Path, version: int, cosim: bool, folder: Path) -> None:
        fmpy.extract(str(path), folder)
        self.path, self.version, self.description = path, version, fmpy.read_model_description(str(path))
        kind: Any = {(2, 0): FMU2Model, (2, 1): FMU2Slave, (3, 0): FMU3Model, (3, 1): FMU3Slave}[version, int(cosim)]
        interface = self.description.coSimulation if cosim else self.description.modelExchange
        self.fmu = kind(
            guid=self.description.guid,
            unzipDirectory=str(folder),
            instanceName="it",
            modelIdentifier=interface.modelIdentifier,
        )
        self.fmu.instantiate()
        self.references = {variable.name: variable.valueReference for variable in self.description.modelVariables}

    def start(self) -> None:
        if self.version == 2:
            self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def get(self, *names: str) -> np.ndarray:
        read = self.fmu.getReal if self.version == 2 else self.fmu.getFloat64
        return np.array(read([self.references[name] for name in names]))

    def set(self, name: str, value: float) -> None:
        (self.fmu.setReal if self.version == 2 else self.fmu.setFloat64)([self.references[name]], [value])

    def named(self, prefix: str) -> list[str]:
        return [name for name in self.references if name.startswith(prefix)]

    def save(self) -> Any:
        return (self.fmu.getFMUstate if self.version == 2 else self.fmu.getFMUState)()

    def restore(self, state: Any) -> None:
        (self.fmu.setFMUstate if self.version == 2 else self.fmu.setFMUState)(state)

    def pack(self, state: Any) -> Any:
        """A state as bytes, which the unit declares to give."""
        assert self.description.coSimulation.canGetAndSetFMUstate and self.description.coSimulation.canSerializeFMUstate
        return (self.fmu.serializeFMUstate if self.version == 2 else self.fmu.serializeFMUState)(state)

    def unpack(self, text: Any) -> Any:
        return (self.fmu.deSerializeFMUstate if self.version == 2 else self.fmu.deserializeFMUState)(text)

    def twice(self, steps: int, h: float, *names: str) -> Iterator[np.ndarray]:
        """What some variables are after each of so many steps, from the present state on and, gone back to it, anew."""
        saved, start = self.save(), self.get("time")[0]
        for _ in range(2):
            rows = []
            for k in range(steps):
                self.fmu.doStep(start + k * h, h)
                rows.append(self.get(*names))
            yield np.array(rows)
            self.restore(saved)

    def continuous(self) -> None:
        """Enter the mode in which states move."""
        (self.fmu.newDiscreteStates if self.version == 2 else self.fmu.updateDiscreteStates)()
        self.fmu.enterContinuousTimeMode()

    def states(self, x: np.ndarray) -> None:
        array = (ctypes.c_double * len(x))(*x)
        self.fmu.setContinuousStates(array, len(x))

    def slope(self, unknown: list[str], known: list[str], seed: np.ndarray) -> np.ndarray:
        at = [[self.references[name] for name in names] for names in (unknown, known)]
        return np.array(self.fmu.getDirectionalDerivative(at[0], at[1], list(seed)))
