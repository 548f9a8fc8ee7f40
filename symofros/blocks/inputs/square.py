"""The paper's square (section 8): from where the tool is to a corner, and around."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.blocks.checks import choice, number, numbers, refuse, whole
from symofros.blocks.inputs.laws import LAWS, moves, through
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Values
from symofros.diagrams.tensor import Tensor, joined

_AXES = "xyz"


@dataclass(frozen=True, kw_only=True)
class Square(Block):
    """A path from a start to a corner, then around a rectangle, each move by one law: p = p_0 + sum d_k s_k(t).

    Moves stop at corners, or blend: the next one begins before the one before is over, and the corner is rounded.

    Attributes:
        corner: The first corner (2) or (3) [m]; as many numbers everywhere.
        first: Vector from the first corner to the second [m].
        second: Vector from the second corner to the third [m]; the fourth corner closes a parallelogram.
        start: First corner [m]; None: where `frame` of `model` is at the model's first state.
        model: Model of `frame`, where `start` is not given.
        frame: Frame at the first corner, where `start` is not given.
        axes: World axes along which the numbers are.
        leave: Time to leave the start [s].
        approach: Duration of the way to the corner [s].
        side: Duration of a side [s].
        laps: Number of times around.
        law: quintic, septic (continuous jerk) or trapezoidal.
        blend: Share of a move's time that the next one overlaps it by, 0 (stop at corners) to 0.5.
        accelerating: Share of a move's time that a trapezoidal law accelerates.
    """

    corner: Any
    first: Any
    second: Any
    start: Any = None
    model: str = ""
    frame: str = ""
    axes: str = "xy"
    leave: float = 0.0
    approach: float = 2.0
    side: float = 2.0
    laps: int = 1
    law: str = "quintic"
    blend: float = 0.0
    accelerating: float = 0.25

    def __post_init__(self) -> None:
        """Points along the axes, times above zero, a known law, and a start."""
        size = len(self.axes)
        if not size or len(set(self.axes)) < size or set(self.axes) - set(_AXES):
            raise refuse(self.name, "axes", repr(self.axes), "some of x, y, z, each once", 'write for example "xy"')
        for field in ("corner", "first", "second"):
            numbers(self.name, field, getattr(self, field), (size,))
        for field in ("approach", "side"):
            number(self.name, field, getattr(self, field), 0.0, exclusive=True)
        number(self.name, "leave", self.leave)
        number(self.name, "blend", self.blend, 0.0, 0.5)
        number(self.name, "accelerating", self.accelerating, 0.0, 0.5, exclusive=True)
        whole(self.name, "laps", self.laps, 0, 20)
        choice(self.name, "law", self.law, LAWS)
        if self.start is not None:
            numbers(self.name, "start", self.start, (size,))
        elif not self.model or not self.frame:
            raise refuse(
                self.name,
                "no start",
                "neither start nor model and frame",
                "the path begins at a point, or where a model's frame is first",
                "give start, or model and frame",
            )

    def ports(self, environment: Environment) -> Ports:
        """Outputs p, v, a (number of axes)."""
        if self.start is None:
            environment.frame(self.model, self.frame)
        shape = (len(self.axes),)
        return Ports((), (Port("p", shape, "m"), Port("v", shape, "m/s"), Port("a", shape, "m/s^2")))

    @property
    def durations(self) -> list[float]:
        """Duration of each move [s]: the approach, then the four sides of each lap."""
        return [float(self.approach)] + [float(self.side)] * (4 * self.laps)

    @property
    def begins(self) -> Array:
        """When each move begins [s]."""
        return through(float(self.leave), self.durations, float(self.blend))

    @property
    def finish(self) -> float:
        """When the path is over [s]."""
        return float(self.begins[-1] + self.durations[-1])

    def _start(self, context: EvaluationContext) -> Tensor:
        if self.start is not None:
            return context.numbers(self.start)
        q, _ = context.environment.start(self.model)
        p = context.call(self.model, "frame_pose", self.frame, q=context.numbers(q), t=context.t)["p"]
        return p[[_AXES.index(axis) for axis in self.axes]]

    def compute(self, context: EvaluationContext) -> Values:
        """The start and the moves."""
        start = self._start(context)
        first, second = np.asarray(self.first, dtype=np.float64), np.asarray(self.second, dtype=np.float64)
        around = [first, second, -first, -second] * self.laps
        steps = [context.numbers(self.corner) - start, *map(context.numbers, around)]
        share = moves(context.t, self.law, self.begins, np.array(self.durations), float(self.accelerating))
        return {
            "p": start + weighted(share.s, steps),
            "v": weighted(share.rate, steps),
            "a": weighted(share.acceleration, steps),
        }


def weighted(shares: Tensor, steps: list[Tensor]) -> Tensor:
    """The sum of steps (m), each times its share."""
    return joined([(shares * joined([step[i] for step in steps])).sum() for i in range(len(steps[0]))])
