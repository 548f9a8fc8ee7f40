"""A functional mock-up unit in a diagram: co-simulation or model exchange, by FMPy in a process of its own."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Literal

import numpy as np

from symofros.base.arrays import Array
from symofros.blocks.checks import number, numbers, path_text, refuse
from symofros.blocks.fmu import fmu_worker
from symofros.blocks.fmu.unit_description import UnitDescription, UnitPort, known, unit_description, unit_ports
from symofros.blocks.generic.sampling import needs_period
from symofros.description.workers import Conversation
from symofros.diagrams.block import Environment, Ports
from symofros.diagrams.external_block import ExternalBlock, NativeCode, Running
from symofros.errors import SymofrosError

Kind = Literal["co_simulation", "model_exchange"]
_LOADING = 60.0  # [s]


@dataclass(frozen=True, kw_only=True)
class FMU(ExternalBlock):
    """A functional mock-up unit of FMI 2 or 3 as a block; the sample time is the communication step.

    Its native code runs, in a process of its own that is bounded in time and memory, only after consent. Between
    samples its inputs are held, for model exchange too, which CVODE integrates there, events included.

    Attributes:
        file: Path of the unit.
        variant: "co_simulation" or "model_exchange"; None: the first that the unit offers.
        inputs: Port -> variable, or scalar variables of its entries; None: a port for each input of the unit.
        outputs: Port -> variable, or scalar variables of its entries; None: a port for each output of the unit.
        start: Variable -> number, or numbers of an array, before the unit is initialised.
        feedthrough: Whether outputs answer to inputs of the same sample; None: as the unit states it.
        rtol: Relative tolerance.
        timeout: Of one sample [s].
        allow_native: Consent to run the native code of the file: of whatever it holds, or, by their SHA-256 digest in
            hexadecimal, of certain bytes alone. Files of diagrams can't state it.
    """

    file: str
    variant: Kind | None = None
    inputs: Any = None
    outputs: Any = None
    start: Any = None
    feedthrough: bool | None = None
    rtol: float = 1e-8
    timeout: float = 10.0
    allow_native: bool | str = False

    def __post_init__(self) -> None:
        """A path as text, numbers that can be, and a sample time."""
        object.__setattr__(self, "file", path_text(self.name, "file", self.file))
        number(self.name, "rtol", self.rtol, 0.0, 1.0, exclusive=True)
        number(self.name, "timeout", self.timeout, 0.0, exclusive=True)
        for variable, values in dict(self.start or {}).items():
            numbers(self.name, f"start of '{variable:.60}'", values)
        needs_period(self)

    def feeds_through(self) -> bool:
        """Whether outputs answer to inputs of the same sample."""
        return self._unit().feeds_through if self.feedthrough is None else self.feedthrough

    def native_code(self) -> NativeCode:
        """The unit's file, and what that states of itself."""
        unit = self._unit()
        return NativeCode(self.file, unit.name, unit.author, unit.tool)

    def ports(self, environment: Environment) -> Ports:
        """The unit's inputs and outputs, or those that are stated."""
        given, taken = self._ports("input"), self._ports("output")
        return Ports(tuple(one.port for one in given), tuple(one.port for one in taken))

    def _unit(self) -> UnitDescription:
        return unit_description(self.name, self.file)

    def _ports(self, direction: str) -> list[UnitPort]:
        stated = self.inputs if direction == "input" else self.outputs
        return unit_ports(self.name, self._unit(), direction, None if stated is None else dict(stated))

    def _starts(self, unit: UnitDescription) -> list[tuple[str, list[float]]]:
        """Variables and their values before the unit is initialised."""
        starts = []
        for name, values in dict(self.start or {}).items():
            variable = known(self.name, unit, name, "start")
            entries = np.asarray(values, dtype=np.float64).reshape(-1).tolist()
            if len(entries) != variable.size:
                shape = f"shape {variable.shape}"
                raise refuse(self.name, f"start of '{name:.60}'", f"{len(entries)} numbers", shape, "give that many")
            fixed = variable.variability == "constant" or variable.initial == "calculated"
            if fixed or (variable.causality in ("output", "local", "independent") and variable.initial is None):
                found = f"causality {variable.causality}, initial {variable.initial}"
                rule = "parameters, inputs and what is exact at the start can be set"
                raise refuse(self.name, f"'{name:.60}' has no start", found, rule, "drop it")
            starts.append((name, entries))
        return starts

    def _variant(self, unit: UnitDescription) -> str:
        if not unit.kinds or (self.variant or unit.kinds[0]) not in unit.kinds:
            offered = ", ".join(unit.kinds) or "neither co-simulation nor model exchange"
            raise refuse(
                self.name, f"the unit is not for {self.variant or 'that'}", offered, "it offers it", "change it"
            )
        return self.variant or unit.kinds[0]

    def begin(self, environment: Environment) -> Running:
        """Start the unit's process.

        Raises:
            DescriptionError: There is no consent to run native code, or to that of other bytes; or what is stated does
                not fit the unit.
        """
        unit = self._unit()
        variant, starts = self._variant(unit), self._starts(unit)
        if not self.allow_native:
            raise refuse(
                self.name,
                "it would run native code of a file",
                self.file,
                "native code can do all that you can; it runs with your consent alone",
                "FMU(..., allow_native=True), load_diagram(path, allow_native=True), or simulate --allow-native",
            )
        return _RunningUnit(self, variant, starts, (self._ports("input"), self._ports("output")))


class _RunningUnit(Running):
    """A unit in one run."""

    def __init__(
        self,
        block: FMU,
        variant: str,
        starts: list[tuple[str, list[float]]],
        ports: tuple[list[UnitPort], list[UnitPort]],
    ) -> None:
        self._block, self._starts, (self._given, self._taken) = block, starts, ports
        self._through, self._begun = block.feeds_through(), False
        self._folder = TemporaryDirectory(prefix="symofros_fmu_")  # Which a unit that crashes can't leave behind.
        self._unit = Conversation(fmu_worker.__file__)
        try:
            file, folder = _consented(block, Path(self._folder.name)), f"{self._folder.name}/unpacked"
            self._ask({"load": file, "folder": folder, "kind": variant, "rtol": block.rtol}, _LOADING)
        except BaseException:
            self.end()
            raise

    def _ask(self, task: Mapping[str, Any], timeout: float, t: float | None = None) -> dict[str, Any]:
        answer = self._unit.ask(task, timeout)
        if "fault" in answer:
            when = "" if t is None else f" at t = {t:.9g} s"
            rule, remedy = "the unit loads, and answers at each sample", "ask its maker, or try another variant"
            what = f"block '{self._block.name}': the unit '{self._block.file}' fails{when}"
            raise SymofrosError(what, f"{answer['fault']:.600}", rule, remedy)
        return answer

    def call(self, t: float, inputs: Mapping[str, Array]) -> Mapping[str, Any]:
        """Outputs at a sample, to which the unit moves with the inputs held since the sample before.

        Args:
            t: Time [s].
            inputs: Inputs at this sample; of a unit without feedthrough those of the sample before.
        """
        entries = [x for one in self._given for x in inputs[one.port.name].reshape(-1).tolist()]
        answer: dict[str, Any] = {}
        if not self._begun:
            given, taken = (
                [(v.name, v.size) for one in ports for v in one.variables] for ports in (self._given, self._taken)
            )
            first = entries if self._through else None
            task = {"begin": t, "step": self._block.period, "set": self._starts, "inputs": given, "outputs": taken}
            answer = self._ask({**task, "values": first}, _LOADING, t)
            self._begun = True
        if self._through or not answer:
            before, after = (None, entries) if self._through else (entries, None)
            answer = self._ask({"to": t, "before": before, "after": after}, self._block.timeout, t)
        outputs, at = {}, 0
        for one in self._taken:
            size = sum(variable.size for variable in one.variables)
            outputs[one.port.name] = np.array(answer["values"][at : at + size]).reshape(one.port.shape or ())
            at += size
        return outputs

    def end(self) -> None:
        """End the process."""
        self._unit.close()
        self._folder.cleanup()


def _consented(block: FMU, folder: Path) -> str:
    """The file to load: a copy of the bytes that the consent is to, which nobody can exchange after the check."""
    if block.allow_native is True:
        return block.file
    data = Path(block.file).read_bytes()
    found = hashlib.sha256(data).hexdigest()
    if found != block.allow_native:
        rule, remedy = "consent is to the bytes that were seen", "look at the file again, and consent anew"
        raise refuse(block.name, f"the unit '{block.file}' has changed since", f"SHA-256 {found}", rule, remedy)
    copy = folder / "consented.fmu"
    copy.write_bytes(data)
    return str(copy)
