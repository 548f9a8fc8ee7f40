"""What a run says: what kernels take, how far they are from C, how fast they and rollouts are; who was not there."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import isnan

from ..reporting.plain import Number
from ..timing.models import Labelled

# Largest differences from C, relative to a state's largest entry. Rounding is amplified by the condition of M.
TOLERANCES = {"double": 1e-9, "single": 1e-2}
PEER = "MuJoCo Warp"


class Compared(Labelled):
    """What is compared with C where a graphics processor ran it, with its precision, its rate and its error."""

    precision: str
    rate: Number
    error: Number

    @property
    def right(self) -> bool:
        """Whether the numbers are C's, as far as they were computed; NaN for a number of C's is none of them."""
        return isnan(self.rate) or self.error <= TOLERANCES[self.precision]


@dataclass(frozen=True)
class KernelRow(Compared):
    """One function as a kernel.

    Attributes:
        model: Label of the model.
        function: Name of the function.
        precision: "double" or "single".
        fused: Whether products and sums are fused.
        registers: Registers of a thread.
        stack: Local memory of the deepest call [bytes].
        spilled: Bytes stored and loaded because registers ran out.
        moved: Bytes of arrays that a state reads and writes.
        rate: States a second, with all arrays on the device; NaN without a graphics processor.
        error: Largest difference from C, relative to the largest entry of a state's result; NaN without one.
    """

    model: str
    function: str
    precision: str
    fused: bool
    registers: int
    stack: int
    spilled: int
    moved: int
    rate: Number
    error: Number


@dataclass(frozen=True)
class PeerRow(Labelled):
    """One function, or a step of semi-implicit Euler ("step"), of all states by MuJoCo Warp, in single precision.

    Attributes:
        model: Label of the model.
        function: Name of the function.
        states: States in a call, by which it is the fastest.
        rate: States a second.
        error: Largest difference from C as above; of a step, of the configurations after all steps.
    """

    model: str
    function: str
    states: int
    rate: Number
    error: Number

    @property
    def task(self) -> str:
        """Name of the function."""
        return "step of semi-implicit Euler" if self.function == "step" else super().task


@dataclass(frozen=True)
class RolloutRow(Compared):
    """Motions by steps of constant length.

    Attributes:
        model: Label of the model.
        function: "step".
        method: Stepping method.
        precision: "double" or "single".
        rate: Steps a second, all motions together.
        error: Largest difference of a configuration at the end from `simulate_batch`, relative to its largest entry.
    """

    model: str
    function: str
    method: str
    precision: str
    rate: Number
    error: Number


@dataclass
class Record:
    """Everything of a run.

    Attributes:
        device: Name of the graphics processor; "" without one.
        architecture: What the kernels are compiled for.
        copied: Bandwidth of the memory, read and written, by a kernel that copies [B/s]; NaN without a processor.
        kernels: Functions.
        rollouts: Motions.
        peers: What MuJoCo Warp makes of the same.
        absent: Why the peer has no numbers; "" where it has.
        failed: Model, function, and why it could not be done.
    """

    device: str = ""
    architecture: str = ""
    copied: Number = float("nan")
    kernels: list[KernelRow] = field(default_factory=list)
    rollouts: list[RolloutRow] = field(default_factory=list)
    peers: list[PeerRow] = field(default_factory=list)
    absent: str = ""
    failed: list[tuple[str, str, str]] = field(default_factory=list)

    @property
    def wrong(self) -> int:
        """Number of rows whose numbers are further from C than is asked for."""
        return sum(not row.right for rows in (self.kernels, self.rollouts) for row in rows)

    @property
    def ok(self) -> bool:
        """Whether something was learned, and all numbers are C's."""
        return bool(self.kernels) and not self.failed and self.wrong == 0
