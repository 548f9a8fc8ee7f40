"""Many motions whose caller makes the steps: native/stepping/batches/by_hand.c on the batch stepper's slots."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.base.events import Event
from symofros.runtime.calls import together
from symofros.runtime.model import Model
from symofros.simulation.batch_inputs import BatchInputs
from symofros.simulation.inputs import InputPlan
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.batch_stepper import SLOTS, BatchResults, BatchStepper, InitialStates, lines
from symofros.simulation.stepping.by_hand import Numbers, held_by_hand
from symofros.simulation.stepping.met import Met
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.stepper import Stepper


class Held(NamedTuple):
    """Inputs of the motions that are followed, by the calls that made steps: a chain that later ones never alter.

    Attributes:
        before: Earlier ones.
        u: Those that are given by hand (m, number of `inputs`); None: those held before.
        steps: Number of steps that they were held for.
        total: Number of all, the earlier ones included.
    """

    before: Held | None
    u: Array | None
    steps: int
    total: int


class Followed(NamedTuple):
    """Where a motion begins that can be made once more: t, q, v, z, run-time parameters, and inputs held before."""

    t: float
    q: Array
    v: Array
    z: Array
    par: Array
    before: Held | None


@dataclass(frozen=True)
class BatchState:
    """All that the following steps of many motions depend on.

    Attributes:
        owner: What it is a state of: that takes it, and its copies.
        par: Run-time parameters (npar), or (n, npar).
        arrays: The arrays that C writes, first times, configurations and speeds.
        groups: What C keeps of each group of slots: numbers of it and of its runs, and its memory.
        given: Parameters that motions begin with, as par.
        met: Events that each motion has met.
        followed: Motions that can be made once more, by number.
        held: Their inputs.
    """

    owner: object
    par: Array = field(repr=False)
    arrays: tuple[npt.NDArray[Any], ...] = field(repr=False)
    groups: tuple[tuple[npt.NDArray[Any], ...], ...] = field(repr=False)
    given: Array = field(repr=False)
    met: Mapping[int, tuple[Met, ...]] = field(repr=False)
    followed: Mapping[int, Followed] = field(repr=False, default_factory=dict)
    held: Held | None = field(repr=False, default=None)

    @property
    def t(self) -> Array:
        """Times (n) [s]."""
        return self.arrays[0]

    @property
    def q(self) -> Array:
        """Configurations (n, nq)."""
        return self.arrays[1]

    @property
    def v(self) -> Array:
        """Speeds (n, nv)."""
        return self.arrays[2]


class _Group:
    """What C keeps of a group of slots between two calls, read and written without the pointers in it."""

    def __init__(self, single: Stepper, group: Any, memory: Array) -> None:
        self._memory = memory
        self._runs = Numbers(single, "sym_run", group.runs, group.slots)
        self._group = Numbers(single, "sym_batch", single.ffi.addressof(group))
        raw = single.memory.raw
        self._pointing = [raw(group.runs, "sym_run", group.slots)]
        # The memory has all of the slots then; their numbers are set at each call.
        if single.run.tableau.fsal_stage or single.events:
            self._pointing.append(raw(group.systems, "sym_system", group.slots))
            self._pointing.append(raw(group.signals, "sym_signal", group.slots * single.system.n_signals))

    def read(self) -> tuple[npt.NDArray[Any], ...]:
        return self._group.read(), self._runs.read(), self._memory.copy()

    def write(self, group: npt.NDArray[Any], runs: npt.NDArray[Any], memory: npt.NDArray[Any]) -> None:
        own = [structs.copy() for structs in self._pointing]
        self._memory[...] = memory
        for structs, kept in zip(self._pointing, own, strict=True):
            structs[...] = kept
        self._runs.write(runs)
        self._group.write(group)


class _Part(BatchStepper):
    """The motions of one thread, in groups of as many slots."""

    def __init__(
        self, shared: HandBatch, model: Model, settings: Settings, initial: InitialStates, first: int, end: int
    ) -> None:
        self._shared, self._first, self._end = shared, first, end
        super().__init__(model, settings, initial, shared.results, first, 1)

    def _lay_out(self) -> None:
        batch, all_parts, ffi = self._batch, self._shared, self.single.ffi
        bounds = [*range(self._first, self._end, SLOTS), self._end]
        batch.t0, batch.max_steps = self._memory.shared(all_parts.t0), 0
        self.groups = groups = ffi.new("sym_batch[]", len(bounds) - 1)
        self.kept: list[_Group] = []
        # As many in each: they lie alike in the memory that groups share.
        slots, shared = max(2, min(SLOTS, self._end - self._first)), None
        for i, end in enumerate(bounds[1:]):
            groups[i] = batch[0]
            group = groups[i]
            group.next, group.stride, group.n, group.slots = end, 1, end, slots
            own, size = self._sizes(ffi.addressof(group))
            shared = lines(size) if shared is None else shared
            memory = lines(own)
            self._start(ffi.addressof(group), memory, shared)
            self.kept.append(_Group(self.single, group, memory))
        self.hand = hand = ffi.new("sym_hand_batch *")
        hand.groups, hand.n_groups = groups, len(groups)
        hand.n_held, hand.held = len(all_parts.held), self._memory.own("int32_t[]", list(all_parts.held))
        hand.first, hand.n = self._first, self._end
        hand.u, hand.begins = self._memory.shared(all_parts.constant), self._memory.shared(all_parts.begins)

    def step(self, u: Any, steps: int) -> None:
        """Make steps of each motion that can go on."""
        status = self._native.sym_hand_batch_step(self.hand, u, steps)
        self.take_events()
        while status == Status.RECORDS_FULL:
            status = self._native.sym_hand_batch_go_on(self.hand, u)
            self.take_events()

    @property
    def rows(self) -> slice:
        """Rows of the motions of this part among all."""
        return slice(self._first, self._end)

    @property
    def changed(self) -> list[npt.NDArray[Any]]:
        """What events change besides the states, of its motions."""
        if self.single.actions is None:
            return [self._event_terminal[self.rows]] if self.single.events else []
        return [array[self.rows] for array in (self._event_terminal, self._acted_at, self._contact_memory)]

    @property
    def par(self) -> Array:
        """Present run-time parameters (m, npar) of its motions, where actions change them."""
        return self._par[self.rows]


class HandBatch:
    """Motions that are stepped by hand together.

    Args:
        model: Compiled to C.
        settings: Settings of each; fixed steps, no end.
        plan: Inputs; what neither signals nor formulas give is given by hand,
        fixed: unless it is one of these, by name.
        par: Run-time parameters (n, npar), or (1, npar) for all.
        n: Number of motions.
        threads: Number of threads that share them.
        events: Zero crossings to locate in each.

    Attributes:
        results: Where C writes times, states and statuses.
        constant: Inputs that are held (n, nu).
        t0: First times (n) [s].
        q0: First configurations (n, nq), v0 speeds (n, nv), of those that begin at the next step.
        begins: Which motions (n) do.
        met: Events that each motion has met since it began, by its number.
    """

    def __init__(
        self,
        model: Model,
        settings: Settings,
        plan: InputPlan,
        fixed: Container[str],
        par: Array,
        n: int,
        threads: int,
        events: Sequence[Event] = (),
    ) -> None:
        self.held = held_by_hand(model, plan, fixed)
        self.results = BatchResults.empty(model, n, 0)
        self.q0, self.v0, self.t0 = np.tile(model.neutral(), (n, 1)), np.zeros((n, model.nv)), np.zeros(n)
        self.default, self.constant = plan.constant.copy(), np.tile(plan.constant, (n, 1))
        self.begins = np.zeros(n, dtype=np.int32)
        inputs = BatchInputs(plan, self.constant, (0,) * len(plan.signals))
        initial = InitialStates(self.q0, self.v0, par, inputs, n, settings.t0, tuple(events))
        groups = -(-n // SLOTS)
        count = max(1, min(threads, groups))
        bounds = [min(n, SLOTS * (groups * i // count)) for i in range(count)] + [n]
        self._parts = [_Part(self, model, settings, initial, *of) for of in zip(bounds, bounds[1:], strict=False)]
        arrays = {field.name: getattr(self.results, field.name) for field in fields(self.results)}
        self._written = [arrays.pop(name) for name in ("t_last", "q_last", "v_last")] + [*arrays.values()]
        self._written += [self.constant, self.t0, self.q0, self.v0, self.begins]
        self._written += [array for part in self._parts for array in part.changed]
        self._groups = [group for part in self._parts for group in part.kept]
        self.single, self.met = self._parts[0].single, dict[int, tuple[Met, ...]]()

    def reset(self, chosen: npt.NDArray[np.intp], t: Array, q: Array, v: Array, par: Array | None) -> None:
        """Restart the motions of these numbers at the next step, their inputs those of the description."""
        self.t0[chosen], self.q0[chosen], self.v0[chosen] = t, q, v
        results = self.results
        results.t_last[chosen], results.q_last[chosen], results.v_last[chosen] = t, q, v
        results.status[chosen], results.steps[chosen], self.begins[chosen] = Status.RUNNING, 0, 1
        self.constant[chosen] = self.default
        for k in chosen if self.met else ():
            self.met.pop(int(k), None)
        for part in self._parts:
            part.forget_events(chosen)
            if par is not None:
                part.set_parameters(chosen, par)

    def present_parameters(self) -> Array:
        """Run-time parameters (n, npar), where actions change them."""
        return np.concatenate([part.par for part in self._parts])

    def inputs_at_start(self, chosen: npt.NDArray[np.intp], u: Array | None) -> Array:
        """All inputs (m, nu) of motions of these numbers at their first states, given those that are held (n, ...)."""
        single, constant = self._parts[0].single, self.constant[chosen]
        if u is not None:
            constant[:, list(self.held)] = u[chosen]
        view = single.memory.view(single.system.u_constant, len(self.default))
        inputs = np.empty_like(constant)
        for row, k in enumerate(chosen):
            view[:] = constant[row]
            inputs[row] = single.inputs_at(self.t0[k], self.q0[k], self.v0[k])
        view[:] = self.default
        return inputs

    def step(self, u: Array | None, steps: int) -> None:
        """Make steps, each thread those of its motions."""
        ffi = self._parts[0].single.ffi
        pointer = ffi.NULL if u is None else ffi.from_buffer("double[]", u)
        together([partial(part.step, pointer, steps) for part in self._parts])
        for part in self._parts:
            for k, met in part.met:
                self.met[k] = (*self.met.get(k, ()), met)
            part.met.clear()

    def save(self, owner: object, par: Array, given: Array) -> BatchState:
        """All that C has written, and the parameters."""
        arrays, groups = (array.copy() for array in self._written), (group.read() for group in self._groups)
        return BatchState(owner, par.copy(), tuple(arrays), tuple(groups), given.copy(), dict(self.met))

    def restore(self, state: BatchState, par: Array | None) -> None:
        """Go on from a state that `save` gave, bit by bit as from there.

        Args:
            state: The state.
            par: Its parameters (n, npar) where motions have others now.
        """
        if par is not None:
            for part in self._parts:
                part.set_parameters(np.arange(len(par)), par)
        for to, array in zip(self._written, state.arrays, strict=True):
            to[...] = array
        for group, kept in zip(self._groups, state.groups, strict=True):
            group.write(*kept)
        self.met = dict(state.met)
