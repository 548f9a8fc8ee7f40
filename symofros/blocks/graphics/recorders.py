"""Graphics (section 6.2 of the paper): what is kept and what is drawn of a run."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.blocks.quantities import frame_ports, motion_port
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Values
from symofros.diagrams.external_block import ExternalBlock, Running
from symofros.diagrams.settings import Plot
from symofros.errors import DescriptionError


def open_ports(name: str, signals: tuple[str, ...], environment: Environment) -> Ports:
    """An input for each name, of any shape."""
    if not signals or len(set(signals)) < len(signals) or not all(signal.isidentifier() for signal in signals):
        raise DescriptionError(
            f"block '{name}': no inputs can be named so",
            f"{list(signals)}"[:80],
            "signals are different names, one an input",
            "for example [desired, actual]",
        )
    return Ports(tuple(Port(signal, environment.inputs.get(signal)) for signal in signals))


@dataclass(frozen=True, kw_only=True)
class Scope(Block):
    """Draws its inputs over time in one picture, when a run is plotted.

    Attributes:
        signals: Names of its inputs.
        title: Above the picture; the block's name by default.
    """

    signals: tuple[str, ...]
    title: str = ""

    def ports(self, environment: Environment) -> Ports:
        """The signals."""
        return open_ports(self.name, self.signals, environment)

    def shown(self) -> tuple[Plot, ...]:
        """All of them together."""
        return (Plot(self.title, self.signals),)


@dataclass(frozen=True, kw_only=True)
class Store(ExternalBlock):
    """Keeps its inputs at samples of its own, whatever interval the run is recorded at.

    `run.kept[name]` has them afterwards: "t" (n) and each signal (n, *shape).

    Attributes:
        signals: Names of its inputs.
        most: Samples that are kept; the oldest are dropped.
    """

    signals: tuple[str, ...]
    most: int = 1_000_000

    def ports(self, environment: Environment) -> Ports:
        """The signals."""
        if "t" in self.signals or self.most < 1:
            raise DescriptionError(
                f"block '{self.name}': can't store that",
                f"{self.signals}, {self.most}",
                "t is the name of the times, and at least one sample is kept",
                "rename the signal",
            )
        return open_ports(self.name, self.signals, environment)

    def begin(self, environment: Environment) -> Running:
        """Begin a run without stored samples."""
        return _Stored(self.signals, self.most)


class _Stored(Running):
    """Samples of one run."""

    def __init__(self, signals: tuple[str, ...], most: int) -> None:
        self._signals = signals
        self._rows: deque[tuple[Any, ...]] = deque(maxlen=most)

    def call(self, t: float, inputs: Mapping[str, Array]) -> Mapping[str, Any]:
        """Keep one sample."""
        self._rows.append((t, *(np.array(inputs[name]) for name in self._signals)))
        return {}

    def kept(self) -> Mapping[str, Array]:
        """Times and signals."""
        rows = list(zip(*self._rows, strict=True)) or [()] * (len(self._signals) + 1)
        return {name: np.array(row) for name, row in zip(("t", *self._signals), rows, strict=True)}


@dataclass(frozen=True, kw_only=True)
class StatePlot(Block):
    """Draws a mechanism's coordinates and its speeds, a picture each.

    Attributes:
        model: Model of the mechanism.
    """

    model: str

    def ports(self, environment: Environment) -> Ports:
        """Coordinates q (nq) and speeds v (nv)."""
        record = environment.model(self.model)
        return Ports((motion_port("q", record, "q"), motion_port("v", record, "v")))

    def shown(self) -> tuple[Plot, ...]:
        """Two pictures."""
        return Plot(f"{self.name}: coordinates", ("q",)), Plot(f"{self.name}: speeds", ("v",))


@dataclass(frozen=True, kw_only=True)
class ExtremityPlot(Block):
    """Draws where frames of a mechanism are, x, y and z over time, a picture a frame.

    Attributes:
        model: Model of the mechanism.
        frames: Frames whose origins are drawn.
    """

    model: str
    frames: tuple[str, ...]

    def ports(self, environment: Environment) -> Ports:
        """Coordinates q (nq) in; out "p_FRAME" (3), the frame's origin in the world [m], dots read as underscores."""
        record = environment.model(self.model)
        for frame in self.frames:
            environment.frame(self.model, frame)
        outputs = tuple(Port(port, (3,), "m") for port in self._frames())
        return Ports((motion_port("q", record, "q"),), outputs)

    def compute(self, context: EvaluationContext) -> Values:
        """Positions by the model's own kinematics."""
        q = context.inputs["q"]
        return {
            port: context.call(self.model, "frame_pose", frame, q=q, t=context.t)["p"]
            for port, frame in self._frames().items()
        }

    def shown(self) -> tuple[Plot, ...]:
        """The outputs."""
        return tuple(Plot(f"{self.name}: {frame}", (port,)) for port, frame in self._frames().items())

    def _frames(self) -> dict[str, str]:
        """Output -> the frame whose position it is."""
        return frame_ports(self.name, "p_", self.frames)
