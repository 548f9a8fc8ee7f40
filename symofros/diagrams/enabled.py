"""Continuous blocks of parts that a signal enables, and all blocks of a part as they run on its condition.

docs/theory/diagrams.md, section 11.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from symofros.diagrams.block import LEAST_ABOVE_ZERO, Block, Crossing, Environment, EvaluationContext, Values
from symofros.diagrams.conditional import ENABLED, AboveZero, Condition, Conditional, OnCondition, refused
from symofros.diagrams.external_block import ExternalBlock
from symofros.diagrams.tensor import Tensor
from symofros.errors import DescriptionError, Problem, did_you_mean

# Crossings of a continuous block that runs on a condition.
_ENABLES, _DISABLES = "enables", "disables"
# Its memory: whether it is enabled; outputs at the instant at which it was disabled; memory of the block itself.
_ON, _HELD, _OWN = "on", "held_", "own_"


@dataclass(frozen=True, kw_only=True)
class Enabled(OnCondition):
    """A continuous block that is enabled and disabled at instants, which are located in time (12)-(14)."""

    def states(self, environment: Environment) -> Mapping[str, Any]:
        """States of the block."""
        return self.block.states(environment)

    def memory(self, environment: Environment) -> Mapping[str, Any]:
        """Whether it is enabled, its outputs while it is not, and what the block keeps."""
        own = {_OWN + key: value for key, value in self.block.memory(environment).items()}
        if own and type(self.block).crossings is Block.crossings:
            rule = "what is enabled in time has states, or memory that changes at crossings located in time"
            kept = ", ".join(key.removeprefix(_OWN) for key in own)
            raise refused(self.name, "in a conditional part it keeps memory", kept, rule, "give it a period")
        ports = self.block.ports(environment).outputs
        held = {_HELD + port.name: self.initial_value(port) for port in ports if self._holds(port.name)}
        return {_ON: 0.0, **held, **own}

    def inside(self, context: EvaluationContext) -> EvaluationContext:
        """Where the block's own formulas are written: its memory, and no signals of the condition."""
        own = {key.removeprefix(_OWN): value for key, value in context.memory.items() if key.startswith(_OWN)}
        return replace(super().inside(context), memory=own)

    def _holds(self, output: str) -> bool:
        """Whether an output keeps its last value while the block is not enabled; else it is the initial one then."""
        return self.condition.outputs == "held" or not self.is_outlet(output)

    def memory_at_start(self, context: EvaluationContext) -> Values:
        """Whether it is enabled from the start, and what the block keeps then."""
        on = self._level(context).apply("step")
        return {_ON: on, **self._begun(context, on, context.memory)}

    def _begun(self, context: EvaluationContext, begins: Tensor, before: Mapping[str, Tensor]) -> Values:
        """Memory of the block: as at its start where it is enabled anew (1), else as before."""
        first = {key: context.numbers(value) for key, value in self.block.memory(context.environment).items()}
        at_start = self.block.memory_at_start(replace(self.inside(context), memory=first))
        first = {_OWN + key: value for key, value in (first | dict(at_start)).items()}
        return {key: begins * value + (1.0 - begins) * before[key] for key, value in first.items()}

    def compute(self, context: EvaluationContext) -> Values:
        """Outputs of the block while it is enabled; else those of the instant before, or initial ones (12)."""
        on, outputs = context.memory[_ON], self.block.compute(self.inside(context))
        ports = {port.name: port for port in self.block.ports(context.environment).outputs}
        kept = {
            name: context.memory[_HELD + name] if self._holds(name) else self.initial_value(port)
            for name, port in ports.items()
        }
        return {name: on * value + (1.0 - on) * kept[name] for name, value in outputs.items()}

    def rates(self, context: EvaluationContext) -> Values:
        """Rates of the block while it is enabled; else states stand still (13)."""
        rates = self.block.rates(self.inside(context))
        return {name: context.memory[_ON] * rate for name, rate in rates.items()}

    def crossings(self, context: EvaluationContext) -> Mapping[str, Crossing]:
        """The signal's, and those of the block; what it keeps crossings change only while it is enabled (14a)."""
        level, own, on = self._level(context), dict(self.block.crossings(self.inside(context))), context.memory[_ON]
        if self.block.memory(context.environment):
            off = {"rising": -1.0, "falling": 1.0}
            own = {
                name: replace(one, value=on * one.value + (1.0 - on) * off[one.direction]) for name, one in own.items()
            }
        return {_ENABLES: Crossing(level, "rising"), _DISABLES: Crossing(level, "falling"), **own}

    def crossed(self, context: EvaluationContext, which: str) -> Values:
        """What the signal enables or disables, and what a crossing of the block changes while it is enabled (14)."""
        on, states, memory = context.memory[_ON], context.states, context.memory
        if which == _DISABLES:
            held = {_HELD + name: value for name, value in self.compute(context).items() if self._holds(name)}
            return {_ON: context.numbers(0.0), **held}
        if which == _ENABLES:
            if self.condition.states != "reset":
                return {_ON: context.numbers(1.0)}
            first = self.block.states(context.environment)
            begun = {key: on * states[key] + (1.0 - on) * np.asarray(value, float) for key, value in first.items()}
            return {_ON: context.numbers(1.0), **begun, **self._begun(context, 1.0 - on, memory)}
        changed, before = self.block.crossed(self.inside(context), which), {**states, **memory}
        own = {key if key in states else _OWN + key: value for key, value in changed.items()}
        return {key: on * value + (1.0 - on) * before[key] for key, value in own.items()}

    def _level(self, context: EvaluationContext) -> Tensor:
        """The signal, so that it is below zero where it does not enable."""
        return context.inputs[self.inputs[ENABLED]] - LEAST_ABOVE_ZERO


def on_condition(
    blocks: Mapping[str, Block], condition: Condition, outlets: Mapping[str, str]
) -> Iterator[tuple[str, Block]]:
    """Blocks of a part as they run on a condition, by their names in the part.

    Args:
        blocks: Name in the part -> block.
        condition: The condition.
        outlets: Outlet -> source, in the part.

    Raises:
        DescriptionError: A block can't run on a condition, or an initial value is that of no outlet.
    """
    initial, problems = _initial(blocks, condition, outlets), list(_unmet(blocks, condition, outlets))
    for name, block in blocks.items():
        problems += _unfit(block, condition, name in initial)
    if problems:
        raise DescriptionError(problems)
    for name, block in blocks.items():
        known: dict[str, Any] = {"condition": condition, "initial": initial.get(name, {})}
        if block.period is not None:
            sampling: dict[str, Any] = {"period": block.period, "offset": block.offset}
            level = block.level + 1 if isinstance(block, Conditional) else 0
            yield name, Conditional(name=block.name, block=block, level=level, **sampling, **known)
        elif _moves(block) or name in initial:
            yield name, Enabled(name=block.name, block=block, **known)
        else:
            yield name, block
    for name in condition.signals():
        yield name, AboveZero(name=name)


def _initial(
    blocks: Mapping[str, Block], condition: Condition, outlets: Mapping[str, str]
) -> dict[str, dict[str, Any]]:
    """Block -> output that outlets read, "" for the only one -> its value before; several outlets may state the value.

    Raises:
        DescriptionError: They state different ones.
    """
    initial: dict[str, dict[str, Any]] = {}
    stated: dict[tuple[str, str], str] = {}
    for outlet, source in outlets.items():
        block, _, port = source.rpartition(".") if "." in source else (source, "", "")
        port = "" if block in outlets.values() else port  # A block that is a source has one output.
        values = initial.setdefault(block, {})
        if outlet not in condition.initial:
            values.setdefault(port, 0.0)
            continue
        other = stated.setdefault((block, port), outlet)
        values[port] = condition.initial[outlet]
        if not np.array_equal(values[port], condition.initial[other]):
            what, found = f"condition: initial values of '{other}' and '{outlet}' differ", f"both read '{source}'"
            raise DescriptionError(what, found, "an output has one value before the part runs", "state one of them")
    return initial


def _unmet(blocks: Mapping[str, Block], condition: Condition, outlets: Mapping[str, str]) -> Iterator[Problem]:
    """Why blocks can't have a condition together."""
    for outlet in condition.initial.keys() - outlets.keys():
        what, known = f"condition: initial value of '{outlet}'", ", ".join(outlets) or "none"
        yield Problem(what, "no such outlet", f"outlets: {known}", did_you_mean(outlet, outlets))
    for name in condition.signals():
        if name in blocks:
            rule, remedy = "the signals of a condition are read by blocks of these names", "rename the block"
            yield Problem(f"condition: block '{name}' is taken", name, rule, remedy)
    rates = {(block.period, block.offset) for block in blocks.values() if block.period is not None}
    if condition.triggered and len(rates) > 1:
        rule = "all samples of a triggered part look for the edge at the same times"
        found = ", ".join(f"{period} s from {offset} s" for period, offset in sorted(rates)[:4])
        yield Problem("condition: a triggered part of several rates", found, rule, "give all one period")


def _moves(block: Block) -> bool:
    """Whether a continuous block has states, or what changes at crossings."""
    kind = type(block)
    return [kind.states, kind.memory, kind.crossings] != [Block.states, Block.memory, Block.crossings]


def _unfit(block: Block, condition: Condition, is_read: bool) -> Iterator[Problem]:
    """Why a block can't run on a condition."""
    what, kind = f"block '{block.name}' in a conditional part", type(block)
    if isinstance(block, ExternalBlock):
        rule = "Python is called at each sample of its block"
        yield Problem(f"{what} calls Python", kind.__name__, rule, "leave it outside, and feed the part by it")
    elif kind.mechanism is not Block.mechanism:
        rule = "a mechanism moves at all times"
        yield Problem(f"{what} moves a mechanism", kind.__name__, rule, "leave it outside, and feed it by the part")
    elif isinstance(block, Enabled):
        rule = "what is continuous is enabled by one signal"
        yield Problem(f"{what} is continuous", "a condition within another", rule, "give it a period")
    elif block.keeps_instants() and condition.states == "held" and not condition.triggered:
        rule = "time passes while it is not enabled: what it keeps of instants begins anew with the part"
        yield Problem(f"{what} keeps instants", kind.__name__, rule, "states='reset', or give it a period")
    elif block.period is None and condition.triggered and (_moves(block) or is_read):
        found = "states of its own" if _moves(block) else "an outlet reads it"
        rule = "what runs at edges is sampled: states, and what outlets read"
        yield Problem(f"{what} is continuous", found, rule, "give it a period, or enable the part")
