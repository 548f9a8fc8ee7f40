"""External blocks, which call functions outside the diagram, and what one run of such a block holds."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.block import Block, Environment, EvaluationContext, Values


class Running(ABC):
    """An external block in one run: what is open and what is counted is that run's alone."""

    @abstractmethod
    def call(self, t: float, inputs: Mapping[str, Array]) -> Mapping[str, Any]:
        """The outputs at a sample.

        Args:
            t: Time [s].
            inputs: Input port -> its signal, in its shape; a copy.
        """

    def kept(self) -> Mapping[str, Array]:
        """What the block stored during the run, by name, as `DiagramRun.kept` holds it; read after the run."""
        return {}

    def end(self) -> None:  # noqa: B027 - most have nothing to close.
        """After the run, however it ended."""


@dataclass(frozen=True)
class NativeCode:
    """A file whose native code a block runs, once there is consent.

    Attributes:
        file: Path of the file.
        model: What the file states that it is.
        author: Who made it, as the file states; "" where it states none.
        tool: Program that wrote it, as the file states.
    """

    file: str
    model: str
    author: str
    tool: str


@dataclass(frozen=True, kw_only=True)
class ExternalBlock(Block, ABC):
    """A block that the loop calls at its samples; its formulas are unknown."""

    shares: ClassVar[bool] = True  # What Python calls may fill a list of the caller's.

    def feeds_through(self) -> bool:
        """Whether outputs answer to inputs of the same sample; else it is called with those of the one before."""
        return True

    def native_code(self) -> NativeCode | None:
        """The native code that the block runs; None of a block that runs none."""
        return None

    def memory(self, environment: Environment) -> Mapping[str, Any]:
        """The inputs of the sample before, where outputs do not answer to those of the same one."""
        return {} if self.feeds_through() else {port: np.zeros(shape) for port, shape in environment.inputs.items()}

    def update(self, context: EvaluationContext) -> Values:
        """Keep the inputs."""
        return {port: context.inputs[port] for port in self.memory(context.environment)}

    @abstractmethod
    def begin(self, environment: Environment) -> Running:
        """Prepare a run, for example open connections; several runs of one block may overlap."""
