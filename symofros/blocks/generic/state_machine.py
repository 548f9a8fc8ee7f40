"""A state machine: states, transitions by conditions, outputs assigned at entry, at exit and during."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from symofros.base.arguments import CheckedCalls
from symofros.base.arrays import Array
from symofros.blocks.checks import known_name, numbers, refuse
from symofros.blocks.generic.formula import bindings_of, input_ports, input_sizes, read_formula
from symofros.diagrams.block import Block, Crossing, Environment, EvaluationContext, Port, Ports, Values
from symofros.diagrams.tensor import Tensor, joined
from symofros.expr import Expression, NoValueError, lower

MAX_STATES = 64
# Output that tells the active state, and the name of the time in it.
_STATE, _ELAPSED = "state", "elapsed"
# Share of a sample by which the time in a state may fall short of what a condition asks for: rounding.
_ROUNDING = 1e-9


@dataclass(frozen=True)
class MachineState(metaclass=CheckedCalls):
    """A state of a machine: what outputs are there; those that it does not assign keep their values.

    Attributes:
        during: Output -> formula, at each sample in the state; of a continuous machine at all times in it.
        entry: Output -> formula, at the sample that enters the state, in place of `during`; of a continuous machine
            what the output keeps from there on, where `during` does not assign it.
        exit: Output -> formula, where it is left; what the next state assigns goes before it.
    """

    during: Mapping[str, str | float] = field(default_factory=dict)
    entry: Mapping[str, str | float] = field(default_factory=dict)
    exit: Mapping[str, str | float] = field(default_factory=dict)


@dataclass(frozen=True)
class Transition(metaclass=CheckedCalls):
    """A way from a state to another, or to itself, which enters it anew.

    Attributes:
        leave: State that it leaves.
        enter: State that it enters.
        when: Formula; the transition is taken at a sample where it is zero or more, by a continuous machine where it
            becomes so.
    """

    leave: str
    enter: str
    when: str


@dataclass(frozen=True, kw_only=True)
class StateMachine(Block):
    """One of several states at a time, changed where a condition holds.

    Sampled, a sample takes one transition at most: of those that leave the active state, the first stated whose `when`
    is zero or more. The first sample enters the first state. Continuous, a transition is taken where its `when`
    becomes zero or more, located in time, or at once where it is so as its state is entered. Names in formulas are
    inputs (scalars, or entries such as u[0]), constants, outputs (their values at the sample before; continuous, those
    with which the state was entered, and at entry and exit those at that instant), the time t, and `elapsed`, the time
    since the state was entered [s]. All formulas are evaluated at all times and must be finite.

    Attributes:
        machine_states: State -> what it assigns, in order; output `state` is the number of the active one, from 0.
        transitions: Ways between states; of those that leave one state, earlier ones go first.
        outputs: Output -> its value before anything is assigned.
        first: First state; "": the first of `machine_states`.
        constants: Name -> number, run-time parameters.
        units: Input or output -> unit.
    """

    machine_states: Mapping[str, MachineState]
    transitions: Sequence[Transition] = ()
    outputs: Mapping[str, float] = field(default_factory=dict)
    first: str = ""
    constants: Mapping[str, float] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """States that are reached, formulas that can be read, names that are there."""
        self._refuse_other_types()
        if not 0 < len(self.machine_states) <= MAX_STATES:
            raise refuse(self.name, "states", f"{len(self.machine_states)} of them", f"1 to {MAX_STATES}", "state some")
        for name, value in (*self.constants.items(), *self.outputs.items()):
            numbers(self.name, f"'{name:.40}'", value, ())
        taken = [*self.constants, *self.outputs, "t", _ELAPSED, _STATE]
        for name in taken:
            if taken.count(name) > 1:
                rule = f"constants and outputs have names of their own, none of them t, {_ELAPSED} or {_STATE}"
                raise refuse(self.name, f"name '{name:.40}' is taken", repr(name), rule, "rename it")
        for transition in self.transitions:
            for name in (transition.leave, transition.enter):
                known_name(self.name, "state", name, self.machine_states)
        for state in self.machine_states.values():
            for output in (*state.during, *state.entry, *state.exit):
                known_name(self.name, "output", output, self.outputs)
        inputs = self._sizes
        for name in self.units:
            known_name(self.name, "input or output", name, {*inputs, *self.outputs})
        self._refuse_unreachable()

    def _refuse_other_types(self) -> None:
        """Refuse states and transitions that are something else."""
        if not isinstance(self.machine_states, Mapping):
            rule, remedy = "a mapping: name -> MachineState", "machine_states={'idle': MachineState(during={'y': 0})}"
            raise refuse(self.name, "machine_states has no names", repr(self.machine_states), rule, remedy)
        for name, state in self.machine_states.items():
            if not isinstance(state, MachineState):
                rule, remedy = "a MachineState", "MachineState(during={'y': 0})"
                raise refuse(self.name, f"state '{name!s:.40}' is none", repr(state), rule, remedy)
        for way in self.transitions:
            if not isinstance(way, Transition):
                rule, remedy = "a Transition", "Transition('idle', 'busy', 'x - 1')"
                raise refuse(self.name, "a transition is none", repr(way), rule, remedy)

    def _refuse_unreachable(self) -> None:
        """Refuse states that no transitions lead to."""
        reached, waiting = set[str](), [known_name(self.name, "state", self._first, self.machine_states)]
        while waiting:
            state = waiting.pop()
            reached.add(state)
            waiting += [way.enter for way in self.transitions if way.leave == state and way.enter not in reached]
        for state in self.machine_states:
            if state not in reached:
                rule = f"transitions lead from the first state, '{self._first}', to each"
                raise refuse(self.name, f"state '{state:.40}' is never entered", state, rule, "add one, or drop it")

    @property
    def _first(self) -> str:
        return self.first or next(iter(self.machine_states))

    @cached_property
    def _conditions(self) -> list[Expression]:
        """Conditions of the transitions."""
        return [read_formula(self.name, f"{way.leave} to {way.enter}", way.when) for way in self.transitions]

    @cached_property
    def _actions(self) -> dict[tuple[str, str, str], Expression]:
        """(state, "during", "entry" or "exit", output) -> formula."""
        return {
            (name, when, output): read_formula(self.name, f"{name}.{when}.{output}", formula)
            for name, state in self.machine_states.items()
            for when in ("during", "entry", "exit")
            for output, formula in getattr(state, when).items()
        }

    @cached_property
    def _sizes(self) -> dict[str, int | None]:
        """Input -> least size of its vector; None: a scalar."""
        known = {"t", _ELAPSED, *self.constants, *self.outputs}
        return input_sizes(self.name, [*self._conditions, *self._actions.values()], known)

    def ports(self, environment: Environment) -> Ports:
        """An input for each name in formulas; the outputs, and the number of the active state."""
        outputs = (Port(name, (), self.units.get(name, "")) for name in self.outputs)
        inputs = input_ports(self.name, self._sizes, environment, self.units)
        return Ports(inputs, (*outputs, Port(_STATE, ())))

    def parameters(self) -> dict[str, Array]:
        """The constants."""
        return {name: np.asarray(value, dtype=np.float64) for name, value in self.constants.items()}

    def with_parameters(self, values: Mapping[str, Any]) -> Block:
        """Block with other values of constants."""
        return replace(self, constants={**self.constants, **values})

    def memory(self, environment: Environment) -> dict[str, Any]:
        """Which state is active (n), the outputs, whether it began; samples since the state was entered, or when."""
        active = [float(name == self._first) for name in self.machine_states]
        since = {"samples" if self.period is not None else "entered": 0.0}
        return {"active": active, **since, "began": 0.0, **{_kept(k): v for k, v in self.outputs.items()}}

    def compute(self, context: EvaluationContext) -> Values:
        """The outputs, and the number of the state."""
        after = self._next(context) if self.period is not None else self._present(context)
        number = (after["active"] * [float(i) for i in range(len(self.machine_states))]).sum()
        return {_STATE: number, **{name: after[_kept(name)] for name in self.outputs}}

    def update(self, context: EvaluationContext) -> Values:
        """Sampled: what is kept after a sample."""
        return self._next(context) if self.period is not None else {}

    def memory_at_start(self, context: EvaluationContext) -> Values:
        """Continuous: the first state is entered."""
        return {} if self.period is not None else self._entered(context, "", self._first)

    def keeps_instants(self) -> bool:
        """Continuous: that at which the active state was entered."""
        return self.period is None

    def crossings(self, context: EvaluationContext) -> dict[str, Crossing]:
        """Continuous: conditions of transitions that leave the active state; -1 in other states."""
        if self.period is not None:
            return {}
        bindings, memory = self._bindings(context, self._elapsed(context)), context.memory
        found = {}
        for name, way, condition in zip(self._ways, self.transitions, self._conditions, strict=True):
            leaves = memory["began"] * memory["active"][list(self.machine_states).index(way.leave)]
            value = leaves * self._value(context, condition, bindings) - (1.0 - leaves)
            found[name] = Crossing(value, "rising")
        return found

    def crossed(self, context: EvaluationContext, which: str) -> Values:
        """What is kept after a transition, if its state is still active: an earlier one may have left it."""
        way = self._ways[which]
        leaves = context.memory["active"][list(self.machine_states).index(way.leave)]
        after = self._entered(context, way.leave, way.enter)
        return {key: leaves * value + (1.0 - leaves) * context.memory[key] for key, value in after.items()}

    @cached_property
    def _ways(self) -> dict[str, Transition]:
        """Name of a crossing -> transition."""
        ways: dict[str, Transition] = {}
        for way in self.transitions:
            name = f"{way.leave}_to_{way.enter}"
            same = sum(one.leave == way.leave and one.enter == way.enter for one in ways.values())
            ways[f"{name}_{same + 1}" if same else name] = way
        return ways

    def _elapsed(self, context: EvaluationContext) -> Tensor:
        """Continuous: time since the state was entered."""
        return context.t - context.memory["entered"]

    def _present(self, context: EvaluationContext) -> dict[str, Tensor]:
        """Continuous: the active state, and the outputs."""
        memory, now = context.memory, {"active": context.memory["active"]}
        bindings = self._bindings(context, self._elapsed(context))
        for output in self.outputs:
            value = memory[_kept(output)]
            for i, name in enumerate(self.machine_states):
                if (name, "during", output) in self._actions:
                    assigned = self._value(context, self._actions[name, "during", output], bindings)
                    value = memory["active"][i] * assigned + (1.0 - memory["active"][i]) * value
            now[_kept(output)] = value
        return now

    def _entered(self, context: EvaluationContext, leave: str, enter: str) -> dict[str, Tensor]:
        """Continuous: what is kept after a state is left, if one was, and another one entered."""
        active = [float(name == enter) for name in self.machine_states]
        after = {"active": context.numbers(active), "entered": context.t, "began": context.numbers(1.0)}
        present = self._present(context) if leave else context.memory
        kept, elapsed = {**context.memory, **present}, self._elapsed(context)
        for name, when in ((leave, "exit"), (enter, "entry")):
            bindings = self._bindings(replace(context, memory=kept), elapsed)
            kept = kept | {
                _kept(output): self._value(context, self._actions[name, when, output], bindings)
                for output in self.outputs
                if (name, when, output) in self._actions
            }
            elapsed = context.numbers(0.0)
        after.update((_kept(output), kept[_kept(output)]) for output in self.outputs)
        return after

    def _next(self, context: EvaluationContext) -> dict[str, Tensor]:
        """What is kept after a sample."""
        memory, names = context.memory, list(self.machine_states)
        taken = list(self._taken(context))
        left = [_total(context, (fires for way, fires in taken if way.leave == name)) for name in names]
        entered = [_total(context, (fires for way, fires in taken if way.enter == name)) for name in names]
        first = 1.0 - memory["began"]
        entered = [fires + first if name == self._first else fires for name, fires in zip(names, entered, strict=True)]
        active = [memory["began"] * (memory["active"][i] - left[i]) + entered[i] for i in range(len(names))]
        samples = (memory["samples"] + 1.0) * (1.0 - _total(context, entered))
        after = {"active": joined([item.reshape(1) for item in active]), "samples": samples}
        after["began"] = context.numbers(1.0)
        period = float(self.period or 0.0)
        known, stages = dict(context.memory), (("exit", left), ("during", active), ("entry", entered))
        for when, holds in stages:
            elapsed = (memory["samples"] + 1.0) * period if when == "exit" else samples * period
            bindings = self._bindings(replace(context, memory=known), elapsed)
            for output in self.outputs:
                value = after.get(_kept(output), memory[_kept(output)])
                for name, now in zip(names, holds, strict=True):
                    if (name, when, output) in self._actions:
                        assigned = self._value(context, self._actions[name, when, output], bindings)
                        value = now * assigned + (1.0 - now) * value
                after[_kept(output)] = value
            if when == "exit":  # What it assigns is there when the next state is entered.
                known |= {_kept(output): after[_kept(output)] for output in self.outputs}
        return after

    def _taken(self, context: EvaluationContext) -> Iterator[tuple[Transition, Tensor]]:
        """Each transition, and 1 where it is taken, else 0."""
        memory = context.memory
        open_ways = [memory["began"] * memory["active"][i] for i in range(len(self.machine_states))]
        since = (memory["samples"] + (1.0 + _ROUNDING)) * float(self.period or 0.0)
        bindings, numbers_of = self._bindings(context, since), {name: i for i, name in enumerate(self.machine_states)}
        for way, condition in zip(self.transitions, self._conditions, strict=True):
            holds = self._value(context, condition, bindings).apply("step")
            fires = open_ways[numbers_of[way.leave]] * holds
            open_ways[numbers_of[way.leave]] = open_ways[numbers_of[way.leave]] * (1.0 - holds)
            yield way, fires

    def _bindings(self, context: EvaluationContext, elapsed: Tensor) -> dict[str, Any]:
        """Names in formulas -> their values."""
        before = {name: context.memory[_kept(name)].flat[0] for name in self.outputs}
        return {**bindings_of(context), **before, _ELAPSED: elapsed.flat[0]}

    def _value(self, context: EvaluationContext, formula: Expression, bindings: Mapping[str, Any]) -> Tensor:
        """A formula's value.

        Raises:
            DescriptionError: It has none.
        """
        try:
            return Tensor.of(context.g, [lower(formula, context.g, bindings)], ())
        except NoValueError as error:
            rule = "constant parts are within the domain of functions"
            raise refuse(self.name, "a formula has no value", error.problem.found, rule, "mend the formula") from None


def _kept(output: str) -> str:
    """The name of an output's memory."""
    return f"held_{output}"


def _total(context: EvaluationContext, terms: Iterator[Tensor] | Sequence[Tensor]) -> Tensor:
    """The sum of scalars; 0 of none."""
    total = context.numbers(0.0)
    for term in terms:
        total = total + term
    return total
