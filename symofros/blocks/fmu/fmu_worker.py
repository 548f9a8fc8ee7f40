"""A process in which the native code of one functional mock-up unit runs: a script of its own, by FMPy.

It imports nothing else of this package. Each line that it reads is a task in JSON, each line that it writes an answer:

    {"describe": file}                    what the unit states of itself, without running anything of it
    {"load": file, "folder", "kind", "rtol"}
                                          unpack it into a new folder, instantiate it: "co_simulation", "model_exchange"
    {"begin": t, "step", "set": [[name, values]], "inputs": [names], "outputs": [names], "values": values | null}
                                          initialise it at a time, with inputs if they are known, and give its outputs
    {"to": t, "before": values | null, "after": values | null}
                                          move it to a time with some inputs, set others there, and give its outputs

An answer has "values", which are those of the outputs one after the other, or "fault", which ends the process.
"""

from __future__ import annotations

import json
import math
import os
import sys
import zipfile
from pathlib import Path
from typing import Any

MEMORY = 8 << 30  # [bytes] of address space
MAX_UNPACKED = 2 << 30  # [bytes]
MAX_FILES = 20_000
MAX_VARIABLES = 100_000
MAX_LOG = 1000  # Characters of the unit's last messages.
MAX_ITERATIONS = 1000  # Of the discrete states at one event, and of events between two samples.
MAX_SOLVER_STEPS = 1_000_000
ROUNDING = 1e-6  # Of a communication step, by differences of times.

NUMERIC = {
    **dict.fromkeys(("Real", "Float32", "Float64"), float),
    **dict.fromkeys(("Integer", "Enumeration", "Int8", "Int16", "Int32", "Int64"), int),
    **dict.fromkeys(("UInt8", "UInt16", "UInt32", "UInt64"), int),
    "Boolean": bool,
}


class Fault(Exception):
    """What went wrong, in words for the user."""


def unpacked(file: str, folder: str) -> None:
    """Unpack a unit into a new folder; its paths and sizes are bounded."""
    with zipfile.ZipFile(file) as archive:
        entries = archive.infolist()
        if len(entries) > MAX_FILES or sum(entry.file_size for entry in entries) > MAX_UNPACKED:
            raise Fault(f"it unpacks to more than {MAX_FILES} files or {MAX_UNPACKED >> 30} GiB")
        archive.extractall(folder)  # Which leaves out drives, leading slashes and "..".


def described(file: str) -> dict[str, Any]:
    """What the unit states of itself."""
    import fmpy  # An extra, looked for by the parent.

    stated = fmpy.read_model_description(file, validate=False)
    if stated.fmiVersion == "1.0":
        raise Fault("it is of FMI 1.0; FMI 2 and 3 can be imported")
    if len(stated.modelVariables) > MAX_VARIABLES:
        raise Fault(f"it has more than {MAX_VARIABLES} variables")
    kinds = [
        kind
        for kind, of_kind in (("co_simulation", stated.coSimulation), ("model_exchange", stated.modelExchange))
        if of_kind is not None
    ]
    variables = [
        {
            "name": variable.name,
            "causality": variable.causality or "local",
            "variability": variable.variability or "continuous",
            "initial": variable.initial,
            "type": variable.type,
            "unit": variable.unit or (variable.declaredType.unit if variable.declaredType else None) or "",
            "shape": shape_of(variable),
            "start": start_of(variable),
        }
        for variable in stated.modelVariables
        if variable.type in NUMERIC
    ]
    through = any(
        output.dependencies is None or any(one.causality == "input" for one in output.dependencies)
        for output in stated.outputs
    )
    return {
        "name": stated.modelName,
        "author": stated.author or "",
        "tool": stated.generationTool or "",
        "kinds": kinds,
        "variables": variables,
        "feeds_through": through,
    }


def shape_of(variable: Any) -> list[int]:
    """The shape of an array of FMI 3, as it is before structural parameters change."""
    shape = []
    for dimension in variable.dimensions or ():
        by = dimension.variable
        shape.append(int(dimension.start) if dimension.start is not None else int(by.start))
    return shape


def start_of(variable: Any) -> list[float] | None:
    """The start values of a variable."""
    if variable.start is None:
        return None
    stated = variable.start.split() if isinstance(variable.start, str) else [variable.start]
    return [float({"true": 1, "false": 0}.get(str(x).lower(), x)) for x in stated]


class Unit:
    """A unit that is instantiated.

    Args:
        file: The unit.
        folder: A new folder, which the unit may use as long as it runs.
        kind: "co_simulation" or "model_exchange".
        rtol: Relative tolerance of the solver of a model exchange, and the one that a co-simulation gets.
    """

    def __init__(self, file: str, folder: str, kind: str, rtol: float) -> None:
        import fmpy  # An extra, looked for by the parent.

        unpacked(file, folder)
        self.stated = fmpy.read_model_description(folder, validate=False)
        self._exchanged, self._rtol = kind == "model_exchange", rtol
        self._third = self.stated.fmiVersion.startswith("3")
        self._variables = {variable.name: variable for variable in self.stated.modelVariables}
        self.said = ""
        if not Path(folder, "binaries").is_dir():
            raise Fault("it has no binaries, but sources alone: compile it, for example by fmpy compile FILE")
        self.fmu = fmpy.instantiate_fmu(
            folder,
            self.stated,
            "ModelExchange" if self._exchanged else "CoSimulation",
            logger=self._log,
            require_functions=False,
        )

    def _log(self, *said: Any) -> None:
        """Keep a message of the unit; FMI 2 and 3 put other things before it."""
        self.said = (said[-1] or b"").decode("utf-8", "replace")[:MAX_LOG]

    # Values.

    def _call(self, verb: str, variable: Any) -> Any:
        kind = variable.type
        if kind == "Enumeration":
            kind = "Int64" if self._third else "Integer"
        return getattr(self.fmu, f"{verb}{kind}")

    def set(self, name: str, values: list[float]) -> None:
        """Set a variable; whole numbers and truths are those nearest."""
        variable = self._variables[name]
        kind = NUMERIC[variable.type]
        if kind is not float and not all(math.isfinite(x) for x in values):
            raise Fault(f"'{name}' is {values}, and of type {variable.type}")
        given = [x >= 0.5 if kind is bool else round(x) if kind is int else x for x in values]
        self._call("set", variable)([variable.valueReference], given)

    def get(self, name: str, size: int) -> list[float]:
        """The values of a variable."""
        variable = self._variables[name]
        get, reference = self._call("get", variable), [variable.valueReference]
        return [float(x) for x in (get(reference, size) if self._third else get(reference))]

    def outputs(self) -> list[float]:
        """The values of all outputs, one after the other."""
        return [value for name, size in self._outputs for value in self.get(name, size)]

    def apply(self, values: list[float]) -> None:
        """Set all inputs, one after the other."""
        at = 0
        for name, size in self._inputs:
            self.set(name, values[at : at + size])
            at += size

    # Time.

    def begin(self, task: dict[str, Any]) -> None:
        """Initialise it at a time."""
        self._inputs, self._outputs, self._step = task["inputs"], task["outputs"], task["step"]
        t = self.t = task["begin"]
        if not self._third:
            self.fmu.setupExperiment(tolerance=self._rtol, startTime=t)
        for name, values in task["set"]:
            self.set(name, values)
        if self._third:
            self.fmu.enterInitializationMode(tolerance=self._rtol, startTime=t)
        else:
            self.fmu.enterInitializationMode()
        if task["values"] is not None:
            self.apply(task["values"])  # What the unit samples as it is initialised.
        self.fmu.exitInitializationMode()
        if self._exchanged:
            self._begin_exchange()

    def _begin_exchange(self) -> None:
        from fmpy.sundials import CVodeSolver  # Of the extra, too, and of model exchange alone.

        self._discrete()
        fmu = self.fmu
        self._solver = CVodeSolver(
            nx=self.stated.numberOfContinuousStates,
            nz=self.stated.numberOfEventIndicators,
            get_x=fmu.getContinuousStates,
            set_x=fmu.setContinuousStates,
            get_dx=fmu.getContinuousStateDerivatives if self._third else fmu.getDerivatives,
            get_z=fmu.getEventIndicators,
            get_nominals=fmu.getNominalsOfContinuousStates,
            set_time=fmu.setTime,
            input=_Held(),
            startTime=self.t,
            relativeTolerance=self._rtol,
            maxNumSteps=MAX_SOLVER_STEPS,
        )

    def _discrete(self) -> None:
        """Update the discrete states until nothing changes, and go on in continuous time."""
        update = self.fmu.updateDiscreteStates if self._third else self.fmu.newDiscreteStates
        for _ in range(MAX_ITERATIONS):
            again, ends, _, _, defined, at = update()
            if ends:
                raise Fault(f"the unit ends the simulation at t = {self.t:.9g} s")
            if not again:
                self._event = at if defined else math.inf
                self.fmu.enterContinuousTimeMode()
                return
        raise Fault(f"its discrete states do not settle within {MAX_ITERATIONS} iterations at t = {self.t:.9g} s")

    def move(self, t: float) -> None:
        """Move it to a time, with its inputs as they are."""
        if t <= self.t:
            return
        step = t - self.t
        if abs(step - self._step) < ROUNDING * self._step:
            step = self._step  # Units that count steps of their own would lose one by the rounding of a difference.
        if self._exchanged:
            self._integrate(t)
        elif self._third:
            _, ends, _, last = self.fmu.doStep(self.t, step)
            if ends:
                raise Fault(f"the unit ends the simulation at t = {last:.9g} s")
        else:
            self.fmu.doStep(self.t, step)
        self.t = t

    def _integrate(self, end: float) -> None:
        for _ in range(MAX_ITERATIONS):
            goal = min(end, max(self._event, self.t))
            state_event, _, reached = self._solver.step(self.t, goal) if goal > self.t else (False, None, goal)
            self.t = reached
            self.fmu.setTime(reached)
            step_event = False
            if self._third or self.stated.modelExchange.needsCompletedIntegratorStep:
                step_event, ends = self.fmu.completedIntegratorStep()
                if ends:
                    raise Fault(f"the unit ends the simulation at t = {self.t:.9g} s")
            if state_event or step_event or reached >= self._event:
                self.changed()
            if reached >= end:
                return
        raise Fault(f"more than {MAX_ITERATIONS} events before t = {end:.9g} s")

    def changed(self, inputs: list[float] | None = None) -> None:
        """Let it see an event, or inputs that are others from now on."""
        if self._exchanged:
            self.fmu.enterEventMode()
        if inputs is not None:
            self.apply(inputs)
        if self._exchanged:
            self._discrete()
            self._solver.reset(self.t)


class _Held:
    """What the solver asks for inputs: they are held."""

    def apply(self, _t: float) -> None:
        """Do nothing between samples."""


class Session:
    """The tasks of one process."""

    def __init__(self) -> None:
        self._unit: Unit | None = None
        self._applied: list[float] | None = None

    def answer(self, task: dict[str, Any]) -> dict[str, Any]:
        """The answer to a task."""
        if "describe" in task:
            return described(task["describe"])
        if "load" in task:
            self._unit = Unit(task["load"], task["folder"], task["kind"], task["rtol"])
            return {}
        unit = self._unit
        if unit is None:
            raise Fault("no unit is loaded")
        try:
            if "begin" in task:
                unit.begin(task)
                self._applied = task["values"]
            else:
                self._set(unit, task["before"])
                unit.move(task["to"])
                self._set(unit, task["after"])
            return {"values": unit.outputs()}
        except Fault:
            raise
        except Exception as error:
            said = f"; it says: {unit.said}" if unit.said else ""
            raise Fault(f"{error}{said}") from None

    def _set(self, unit: Unit, inputs: list[float] | None) -> None:
        if inputs is not None and inputs != self._applied:
            unit.changed(inputs)
            self._applied = inputs


def main() -> None:
    """Answer tasks until there are no more."""
    import resource  # Windows has none.

    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    # What native code prints goes to the standard error; answers have a way of their own.
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)
    session = Session()
    for line in sys.stdin:
        try:
            answer = session.answer(json.loads(line))
        except Fault as error:
            answer = {"fault": str(error)}
        except Exception as error:
            answer = {"fault": f"{type(error).__name__}: {error}"}
        answers.write(json.dumps(answer) + "\n")
        if "fault" in answer:
            break


if __name__ == "__main__":
    main()
