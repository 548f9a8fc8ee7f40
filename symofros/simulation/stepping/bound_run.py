"""What a run is bound to: the structs of C filled, the model's functions and the inputs among them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from symofros.base.arrays import Array
from symofros.base.events import Event
from symofros.errors import CompileError, SymofrosError
from symofros.runtime.calls import CompiledKernel, Kernel, NativeMemory, constants, native_library
from symofros.runtime.model import Model
from symofros.runtime.record import HELD
from symofros.simulation.actions import Actions, plan_actions
from symofros.simulation.events import opens_of
from symofros.simulation.inputs import InputPlan
from symofros.simulation.stepping.methods import Method
from symofros.simulation.stepping.tableaus import native_tableau
from symofros.simulation.user_functions import named_function

_INPUT_CALLBACK = "int32_t(void *, double, const double *, const double *, double *)"


class InputValueError(ValueError):
    """A function of inputs returned what is no input."""


class BoundRun:
    """The structs of one run of one model, filled.

    Args:
        model: Compiled to C.
        method: The stepping method.
        inputs: The inputs by how they are evaluated.
        events: Zero crossings to locate.
        par: Run-time parameters (npar).
        plan: Gives the actions of events.

    Attributes:
        memory: Arrays that C points to.
        system: The sym_system: the model's functions and the evaluation point.
        run: The sym_run: settings, present state, counters.
        inputs: Inputs by how they are evaluated.
        moving: Whether each speed is one of the motion (nv), and no state of a force or, of a diagram's part, a block.
        same_inputs_again: Whether an input function gives the run's inputs once more; None: not asked yet.
        kernels: Slot of the system, such as "forward_dynamics" -> the function bound to it.
        beams: Elastic beams at the parameters.
        beam_record: Largest error of each beam, when that was, and the elastic coordinates of all, each then.
        failure: Exception that an input function raised; it ended the run.
        actions: Actions of the events; None where they have none.

    Raises:
        SymofrosError: The model is interpreted, or an action can't be done.
    """

    def __init__(
        self,
        model: Model,
        method: Method,
        inputs: InputPlan,
        events: Sequence[Event],
        par: Array,
        plan: Callable[[Model, Sequence[Event]], Actions | None] = plan_actions,
    ) -> None:
        self.native, self.memory = native_library(), NativeMemory()
        self.ffi = self.memory.ffi
        self.model, self.method, self.events, self.par = model, method, events, par
        self.inputs, self.moving = inputs, np.arange(model.nv) < model.nv - model.nz
        self.same_inputs_again: bool | None = None
        self.failure: BaseException | None = None
        self.beams = model.beams(par)
        self.kernels: dict[str, CompiledKernel] = {}
        mechanism, memory = _mechanism_of(model)
        self.memory.keep(memory)
        self.system = self.ffi.new("sym_system *", mechanism[0])
        self.run = self.ffi.new("sym_run *")
        self.run.system = self.system
        self._fill_method()
        self._place()
        self._fill_beams()
        if model.record.sticking:
            self.system.held = self.memory.own("int32_t[]", len(model.record.sticking))
            self._hold()
        self._fill_inputs(inputs)
        self._fill_events()
        self._bind_functions()
        self._fill_actions(plan(model, events))
        self._fill_contacts()

    def _place(self) -> None:
        """Memory of the present state and of the evaluation point, in one array."""
        run, system = self.run, self.system
        nq, nv, nc = system.nq, system.nv, system.nc
        places = [(run, "q", nq), (run, "v", nv), (system, "q", nq), (system, "v", nv), (system, "u", system.nu)]
        places += [(system, "t", 1), (system, "a", nv), (system, "lam", nc), (system, "rank", 1)]
        self._point = self.memory.zeros_at(*places, (system, "gains", 2 * nc))

    def _fill_contacts(self) -> None:
        """Balls of rigid contacts (docs/theory/constraints.md, section 15)."""
        system, memory = self.system, self.memory
        if not self.model.record.rigid_contacts:
            return
        if not self.method.family.rigid_contacts:
            self.model.record.refuse_rigid_contacts(f"simulation by '{self.method.name}'", by_method=True)
        self._bind("contact_state", self.model.contact_state())
        system.contact_work = memory.zeros(int(self.native.sym_contact_work_size(system)))
        system.contact_memory = memory.zeros(int(self.native.sym_contact_memory_size(system)))
        if self.actions is None:
            self.run.par = memory.doubles(self.par)
        self.native.sym_run_forget_contacts(self.run)

    @property
    def contact_memory(self) -> Array:
        """What steps remember of the balls of rigid contacts, a view; empty without any."""
        size = int(self.native.sym_contact_memory_size(self.system))
        return self.memory.view(self.system.contact_memory, size)

    def _hold(self) -> None:
        """Tell which coordinates friction holds, by their modes (docs/theory/constraints.md, section 14)."""
        for i, one in enumerate(self.model.record.sticking):
            self.system.held[i] = self.par[one.mode] == HELD

    def _fill_beams(self) -> None:
        """What judges the bending of the beams, and memory for the largest of each."""
        system, run, memory, n = self.system, self.run, self.memory, len(self.beams)
        run.beam_limit = math.inf
        firsts = np.cumsum([0, *[beam.size for beam in self.beams]])
        size = int(firsts[-1])
        places = [(run, "beam_reference", 2 * size), (run, "beam_weight", self.model.nv)]
        record = memory.zeros_at((run, "beam_error", n), (run, "beam_t", n), (run, "beam_q", size), *places)
        self.beam_record = record[:n], record[n : 2 * n], record[2 * n : 2 * n + size]
        if not n:
            return
        system.n_beams = n
        system.beams = memory.own(
            "sym_beam[]",
            [
                (
                    beam.q,
                    beam.v,
                    first,
                    beam.size,
                    *beam.counts,
                    len(blocks),
                    memory.doubles(blocks),
                    beam.EI_z,
                    beam.EI_y,
                    beam.NEGLIGIBLE,
                    beam.contrast,
                )
                for beam, first in zip(self.beams, firsts.tolist(), strict=False)
                for blocks in (beam.angle_blocks,)
            ],
        )
        run.beam_scale = memory.doubles(np.concatenate([beam.scale for beam in self.beams]))
        run.beam_guard = memory.own("sym_beam_guard[]", n)
        run.beam_reach = memory.doubles(np.concatenate([beam.reach for beam in self.beams]))

    def _fill_inputs(self, inputs: InputPlan) -> None:
        system, memory = self.system, self.memory
        system.u_constant = memory.doubles(inputs.constant)
        if inputs.signals:
            signals = [
                (index, int(linear), len(t), memory.shared(t), memory.shared(values))
                for index, t, values, linear in inputs.signals
            ]
            system.n_signals, system.signals = len(signals), memory.own("sym_signal[]", signals)
        if indices := sorted(inputs.formulas):
            system.n_law, system.law_inputs = len(indices), memory.own("int32_t[]", indices)
            derivatives = self.method.family.implicit
            self._bind("law", self.model.formulas([inputs.formulas[i] for i in indices], derivatives))
        if inputs.callback is not None:
            system.callback = memory.callback(_INPUT_CALLBACK, self._input_callback(inputs.callback))

    def _fill_events(self) -> None:
        system, memory, events = self.system, self.memory, self.events
        if events:
            system.n_events = len(events)
            system.event_direction = memory.own("int32_t[]", [event.sign for event in events])
            system.event_terminal = memory.own("int32_t[]", [event.cut for event in events])
            formulas = [event.formula for event in events]
            self._bind("events", self.model.formulas(formulas, derivatives=False, reactions=True))
            system.events_of_reactions = int("lam" in dict(self.kernels["events"].signature.inputs))
        if self.inputs.callback is not None:  # Each evaluation of the inputs is a call of it.
            written, names = " ".join(str(event.formula) for event in events), self.model.names
            needs_inputs = system.events_of_reactions or any(name in written for name in {*names.u} - {*names.q})
            system.events_free_of_inputs = int(not needs_inputs)

    def _fill_actions(self, actions: Actions | None) -> None:
        """What events do: native/stepping/events/actions.c."""
        self.actions = actions
        if actions is None:
            return
        run, memory, model, events = self.run, self.memory, self.model, self.events
        switches = model.record.switches
        plan = self._actions = self.ffi.new("sym_actions *")
        places = actions.places
        plan.npar, plan.n_assignments, plan.n_switches = model.npar, len(places), len(switches)
        plan.assignments = memory.own("sym_assignment[]", places)
        plan.acts = memory.own("int32_t[]", [int(event.acts) for event in events])
        plan.once = memory.own("int32_t[]", [int(event.once) for event in events])
        plan.restitution = memory.doubles([event.coefficient for event in events])
        plan.opens = memory.own("int32_t[]", opens_of(events))
        plan.refuses = memory.callback("int32_t(void *, const double *)", self._refuses)
        plan.engaged, sticking = memory.zeros(len(switches)), len(model.record.sticking)
        plan.first_mode, plan.modes = (
            actions.stated.first_mode,
            memory.zeros(model.npar + 2 * sticking + len(model.record.rigid_contacts)),
        )
        self._bind_call(plan, "values", actions.kernel)
        if model.nc:
            self._bind_call(plan, "constraint", model.kernel("constraint"))
        self._fill_switches(plan)
        run.actions, run.par = plan, memory.doubles(self.par)
        run.acted_at = memory.doubles([-math.inf] * (len(events) + 1))

    def _fill_switches(self, plan: Any) -> None:
        """The constraints that engage and release, and the poses of the frames that hold their relative rotation."""
        memory, kind, switches = self.memory, "int32_t[]", self.model.record.switches
        turning = [switch for switch in switches if switch.rotation]
        plan.poses = memory.own("sym_call[]", 2 * len(turning))
        for i, frame in enumerate(frame for switch in turning for frame in switch.frames):
            self._bind_call(plan.poses, i, self.model.kernel("frame_pose", frame))
        plan.switches = memory.own("sym_switch[]", len(switches))
        for i, switch in enumerate(switches):
            of = plan.switches[i]
            of.moment, of.n_offsets = int(switch.moment), len(switch.offsets)
            of.row, of.place = (memory.own(kind, [pair[k] for pair in switch.offsets]) for k in (0, 1))
            if switch.rotation:
                of.rotation, of.pose = memory.own(kind, list(switch.rotation)), 2 * turning.index(switch)

    def _refuses(self, _data: Any, par: Any) -> int:
        """Whether parameters that an action sets are not allowed; their words are asked for later."""
        try:
            self.check_changed(self.memory.view(par, self.model.npar).copy())
        except SymofrosError:
            return 1
        except BaseException as error:  # It may not pass through C.
            self.failure = error
            return 1
        return 0

    def check_changed(self, par: Array) -> None:
        """Check run-time parameters (npar) that change in a run.

        Raises:
            SymofrosError: They violate a condition, or change beams, whose bending is judged over the whole run.
        """
        self.model.checked_parameters(par)
        for before, after in zip(self.beams, self.model.beams(par), strict=True):
            if (before.EI_z, before.EI_y, *before.scale) != (after.EI_z, after.EI_y, *after.scale):
                found = f"EI_z, EI_y = {before.EI_z:g}, {before.EI_y:g} before"
                rule = "the length and stiffness of an elastic beam stay the same in a run"
                raise SymofrosError("an action changes an elastic beam", found, rule, "make two runs")

    def _bind_functions(self) -> None:
        """The model's functions, each in the slot of its name."""
        system = self.system
        outputs = {"a": system.a, "lam": system.lam, "rank": system.rank}
        self._bind("forward_dynamics", self.model.kernel("forward_dynamics"), outputs)
        for name in self.method.family.functions:
            self._bind(name, self.model.kernel(name))
        if self.model.nc:
            self._bind("project", self.model.kernel("project"))

    def _bind(self, slot: str, kernel: Kernel, outputs: dict[str, Any] | None = None) -> None:
        self.kernels[slot] = self._bind_call(self.system, slot, kernel, outputs)

    def _bind_call(
        self, owner: Any, place: str | int, kernel: Kernel, outputs: dict[str, Any] | None = None
    ) -> CompiledKernel:
        """A function in a field of a struct, or in an entry of an array, as a call at the evaluation point."""
        call = self.ffi.addressof(owner, place) if isinstance(place, str) else self.ffi.addressof(owner[place])
        bound = self.memory.bind(call, kernel, self.par, outputs)
        if not self.native.sym_system_bind(self.system, call):
            raise CompileError(f"the integrator does not know every input of '{kernel.signature.name}'")
        return bound

    def _input_callback(self, function: Callable[[float, Array, Array], Any]) -> Callable[..., int]:
        """A Python function as the inputs; what it raises is kept and ends the run."""
        nq, nv, nu, view = self.model.nq, self.model.nv, self.model.nu, self.memory.view
        names = self.model.names.u

        def call(_data: Any, t: float, q: Any, v: Any, u: Any) -> int:
            try:
                values = np.asarray(function(t, view(q, nq).copy(), view(v, nv).copy()), dtype=np.float64)
                if values.shape != (nu,):
                    what = f"the input function {named_function(function)} returned shape {values.shape}"
                    raise InputValueError(f"{what}, not ({nu},)")
                if not np.isfinite(values).all():
                    i = int(np.flatnonzero(~np.isfinite(values))[0])
                    what = f"input '{names[i]}' is {values[i]} at t = {t:.6g} s"
                    raise InputValueError(f"{what}, by the input function {named_function(function)}")
                view(u, nu)[:] = values
            except BaseException as error:  # It may not pass through C; the loop raises it again.
                self.failure = error
                return 1
            return 0

        return call

    def _fill_method(self) -> None:
        self.run.method = constants()[self.method.constant]
        self.native.sym_run_set_defaults(self.run)
        self.run.tableau = native_tableau(self.method.tableau)[0][0]  # All methods live as long as the program.


# A sym_system that knows the mechanism and nothing of a run, with the memory that it points into, by the model.
_MECHANISMS: WeakKeyDictionary[Model, tuple[Any, NativeMemory]] = WeakKeyDictionary()


def _mechanism_of(model: Model) -> tuple[Any, NativeMemory]:
    """The mechanism of a model to C, made once: sizes, segments, conditions, friction that sticks, rigid contacts."""
    if model in _MECHANISMS:
        return _MECHANISMS[model]
    record, memory, kinds = model.record, NativeMemory(), constants()
    system = memory.ffi.new("sym_system *")
    system.nq, system.nv, system.nu, system.nc = model.nq, model.nv, model.nu, model.nc
    system.npar, system.n_contacts, system.n_sticking = model.npar, len(record.rigid_contacts), len(record.sticking)
    system.n_segments, system.n_quaternion_inputs = len(record.segments), len(record.quaternion_inputs)
    system.segments = memory.own("sym_segment[]", [(kinds[s.constant], s.q, s.v, s.size) for s in record.segments])
    on_speeds = [int(name in record.speed_conditions) for name in model.names.constraints]
    system.on_speeds = memory.own("int32_t[]", on_speeds)
    system.group = memory.own("int32_t[]", list(record.measures.group))
    system.quaternion_inputs = memory.own("int32_t[]", record.quaternion_inputs)
    system.sticking = memory.own("sym_sticking[]", [(one.q, one.v, one.mode, one.row) for one in record.sticking])
    balls = [
        (ball.mode, list(ball.pushes), list(ball.way), ball.apart, ball.pole, list(ball.rows))
        for ball in record.rigid_contacts
    ]
    system.contacts = memory.own("sym_rigid_contact[]", balls)
    return _MECHANISMS.setdefault(model, (system, memory))
