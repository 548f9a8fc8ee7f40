"""Parts that run while a signal is above zero, or at its edges (docs/theory/diagrams.md, section 11).

What of them is continuous: `enabled.py`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from symofros.base.arguments import CheckedCalls
from symofros.base.arrays import Array, numeric
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Values
from symofros.diagrams.settings import Plot
from symofros.diagrams.tensor import Tensor
from symofros.errors import DescriptionError, did_you_mean
from symofros.simulation.inputs import Signal

# Blocks of a conditional part that read its signals, their input and their outputs.
ENABLED, TRIGGERED, SIGNAL, ON, LEVEL = "enabled", "triggered", "signal", "on", "level"
_EDGES, _KEPT = ("rising", "falling", "either"), ("held", "reset")
# Memory of a block that runs on a condition: whether it was enabled, whether the trigger was above zero (-1: unknown),
# outputs; memory of the block itself.
_WAS_ENABLED, _WAS_ABOVE, _HELD, _OWN = "was_enabled", "was_above", "held_", "own_"


@dataclass(frozen=True)
class Condition(metaclass=CheckedCalls):
    """When a part of a diagram runs: while a signal is above zero, at its edges, or at edges of one while another is.

    Attributes:
        enabled: Source of the signal that has to be above zero; True: an inlet feeds "PART.enabled".
        triggered: Source of the signal at whose edges the part runs once; True: one feeds "PART.triggered".
        edge: From zero or less to above it (rising), back (falling), or either.
        outputs: While the part is not enabled, outlets keep their last values (held), or those of `initial` (reset).
        states: Where it is enabled again, states go on from what they were (held), or begin anew (reset).
        initial: Outlet -> its value before the part runs, a number for all entries or one each; zero for the others.
    """

    enabled: str | bool = False
    triggered: str | bool = False
    edge: Literal["rising", "falling", "either"] = "rising"
    outputs: Literal["held", "reset"] = "held"
    states: Literal["held", "reset"] = "held"
    initial: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """One signal at least; what is said of enabling has a signal that enables."""
        for key in (ENABLED, TRIGGERED):
            if not isinstance(getattr(self, key), (str, bool)):
                found, rule = f"{getattr(self, key)!r:.40}", f"{key} names a signal, or is True"
                raise DescriptionError(f"condition: {key} is no source", found, rule, "such as 'logic.on'")
        if not (self.enabled or self.triggered):
            rule, remedy = "enabled, triggered, or both name a signal", "such as enabled='logic.on'"
            raise DescriptionError("condition: no signal", "neither is stated", rule, remedy)
        if not self.enabled and "reset" in (self.outputs, self.states):
            what, rule = "condition: a reset without `enabled`", "resets follow from enabling; a trigger alone holds"
            raise DescriptionError(what, f"outputs {self.outputs}, states {self.states}", rule, "leave it out")
        if self.edge not in _EDGES:
            rule, remedy = f"edge is one of {', '.join(_EDGES)}", did_you_mean(str(self.edge), _EDGES)
            raise DescriptionError("condition: unknown edge", f"{self.edge!r:.40}", rule, remedy)
        for key in ("outputs", "states"):
            if getattr(self, key) not in _KEPT:
                found, rule = f"{getattr(self, key)!r:.40}", f"{key} is one of {', '.join(_KEPT)}"
                raise DescriptionError(f"condition: unknown {key}", found, rule, "state one of them")
        for outlet, value in self.initial.items():
            if not np.all(np.isfinite(numeric(f"condition: initial value of '{outlet}'", value))):
                what, rule = f"condition: initial value of '{outlet}'", "finite numbers"
                raise DescriptionError(what, f"{value!r:.40}", rule, "give others")

    def signals(self) -> dict[str, str | bool]:
        """Block that tells a signal of the condition -> source of the signal, or True."""
        return {key: by for key, by in ((ENABLED, self.enabled), (TRIGGERED, self.triggered)) if by}


@dataclass(frozen=True, kw_only=True)
class AboveZero(Block):
    """Whether a signal is above zero: what a condition reads."""

    def ports(self, environment: Environment) -> Ports:
        """Input signal, a scalar; outputs on, and level, the signal itself."""
        return Ports((Port(SIGNAL, ()),), (Port(ON, ()), Port(LEVEL, ())))

    def compute(self, context: EvaluationContext) -> Values:
        """1 above zero, else 0; the signal, whose crossings are located."""
        return {ON: 1.0 - (-context.inputs[SIGNAL]).apply("step"), LEVEL: context.inputs[SIGNAL]}


@dataclass(frozen=True, kw_only=True)
class OnCondition(Block):
    """A block that runs on a condition.

    Attributes:
        block: The block.
        condition: When it runs.
        initial: Output -> its value before; "" stands for the only one.
        level: How many conditions there are inside.
    """

    block: Block
    condition: Condition
    initial: Mapping[str, Any] = field(default_factory=dict)
    level: int = 0

    @property
    def inputs(self) -> dict[str, str]:
        """Signal of its own condition -> port that reads it."""
        return {key: f"{key}{'_outside' * self.level}" for key in self.condition.signals()}

    def ports(self, environment: Environment) -> Ports:
        """Ports of the block, and the condition's signals."""
        ports = self.block.ports(environment)
        for port in ports.inputs:
            if port.name in self.inputs.values():
                rule, remedy = "a block of a conditional part has no input of its condition's name", "rename the input"
                raise refused(self.name, f"input '{port.name}' is taken", port.name, rule, remedy)
        return Ports((*ports.inputs, *(Port(name, ()) for name in self.inputs.values())), ports.outputs)

    def initial_value(self, port: Port) -> Array:
        """Value of an output before the block runs."""
        value = np.asarray(self.initial.get(port.name, self.initial.get("", 0.0)), dtype=np.float64)
        shape = port.shape or ()
        if value.shape not in ((), shape):
            rule = f"a number for all entries, or shape {shape}"
            raise refused(self.name, f"initial value of '{port.name}'", value.shape, rule, "give it that shape")
        return np.broadcast_to(value, shape)

    def inside(self, context: EvaluationContext) -> EvaluationContext:
        """Where the block's own formulas are written: without the condition's signals."""
        inputs = {key: value for key, value in context.inputs.items() if key not in self.inputs.values()}
        return replace(context, inputs=inputs)

    def is_outlet(self, output: str) -> bool:
        """Whether an outlet of the part reads an output."""
        return output in self.initial or "" in self.initial

    def samples(self) -> Mapping[str, Signal]:
        """Samples of the block."""
        return self.block.samples()

    def notes(self, environment: Environment) -> Iterable[str]:
        """Notes of the block."""
        return self.block.notes(environment)

    def lock_inputs(self) -> tuple[str, ...]:
        """Lock inputs of the block."""
        return self.block.lock_inputs()

    def shown(self) -> tuple[Plot, ...]:
        """Plots of the block."""
        return self.block.shown()

    def parameters(self) -> dict[str, Array]:
        """Parameters of the block."""
        return self.block.parameters()

    def with_parameters(self, values: Mapping[str, Any]) -> Block:
        """Block inside with other values."""
        return replace(self, block=self.block.with_parameters(values))


@dataclass(frozen=True, kw_only=True)
class Conditional(OnCondition):
    """A sampled block that runs on a condition; at other samples its memory and outputs stay."""

    def memory(self, environment: Environment) -> dict[str, Any]:
        """Memory of the block, its outputs, and what the condition's signals were."""
        own = {_OWN + key: value for key, value in self.block.memory(environment).items()}
        held = {_HELD + port.name: self.initial_value(port) for port in self.block.ports(environment).outputs}
        was = {ENABLED: {_WAS_ENABLED: 0.0}, TRIGGERED: {_WAS_ABOVE: -1.0}}
        return {**own, **held, **{key: value for signal in self.inputs for key, value in was[signal].items()}}

    def compute(self, context: EvaluationContext) -> Values:
        """Outputs of the block where it runs; else those before, or those that they are reset to."""
        now = self._run(context)
        outputs = {}
        for name, value in self.block.compute(now.inside).items():
            other = context.memory[_HELD + name]
            if self.condition.outputs == "reset" and self.is_outlet(name):
                port = next(port for port in self.block.ports(context.environment).outputs if port.name == name)
                other = now.enabled * other + (1.0 - now.enabled) * self.initial_value(port)
            outputs[name] = now.runs * value + (1.0 - now.runs) * other
        return outputs

    def update(self, context: EvaluationContext) -> Values:
        """What the block keeps where it runs, and what the condition's signals were."""
        now, outputs = self._run(context), self.compute(context)
        kept = dict(now.inside.memory)
        for key, value in self.block.update(now.inside).items():
            kept[key] = now.runs * value + (1.0 - now.runs) * kept[key]
        was = {ENABLED: (_WAS_ENABLED, now.enabled), TRIGGERED: (_WAS_ABOVE, now.above)}
        return {
            **{_OWN + key: value for key, value in kept.items()},
            **{_HELD + key: value for key, value in outputs.items()},
            **dict(was[signal] for signal in self.inputs),
        }

    def _run(self, context: EvaluationContext) -> _Run:
        """Whether the block runs, and where its formulas are written."""
        memory, inputs, one = context.memory, context.inputs, context.numbers(1.0)
        own = {key.removeprefix(_OWN): value for key, value in memory.items() if key.startswith(_OWN)}
        enabled = above = runs = one
        if self.condition.enabled:
            enabled = runs = inputs[self.inputs[ENABLED]]
            if self.condition.states == "reset":
                begins, first = enabled * (1.0 - memory[_WAS_ENABLED]), self.block.memory(context.environment)
                own = {key: begins * _numbers(first[key]) + (1.0 - begins) * value for key, value in own.items()}
        if self.condition.triggered:
            above, was = inputs[self.inputs[TRIGGERED]], memory[_WAS_ABOVE]
            rises, falls = above * (1.0 - was * was), (1.0 - above) * (0.5 * was * (was + 1.0))
            runs = runs * {"rising": rises, "falling": falls, "either": rises + falls}[self.condition.edge]
        return _Run(runs, enabled, above, replace(self.inside(context), memory=own))


def unconditional(block: Block) -> Block:
    """The block itself, of one that runs on conditions."""
    return unconditional(block.block) if isinstance(block, OnCondition) else block


def _numbers(value: Any) -> Array:
    return np.asarray(value, dtype=np.float64)


@dataclass(frozen=True)
class _Run:
    """A sample of a block on a condition.

    Attributes:
        runs: 1 where it runs, else 0.
        enabled: 1 where it is enabled, else 0.
        above: 1 where the trigger is above zero, else 0.
        inside: Where the block's own formulas are written; its memory is reset where it begins anew.
    """

    runs: Tensor
    enabled: Tensor
    above: Tensor
    inside: EvaluationContext


def refused(block: str, what: str, found: object, rule: str, remedy: str) -> DescriptionError:
    """A refusal, said of a block."""
    return DescriptionError(f"block '{block}': {what}", f"{found}", rule, remedy)
