"""The settings of a run, checked before it starts."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array, numeric, real_array
from symofros.errors import AssemblyError, ShapeError, SymofrosError, UnknownNameError
from symofros.native import native_number
from symofros.runtime.manifold import UNIT_TOLERANCE as UNIT_TOLERANCE
from symofros.runtime.manifold import at_unit_length
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.kinematics.facing import refuse_opposite
from symofros.simulation.inputs import InputPlan
from symofros.simulation.options import SimulationOptions
from symofros.simulation.stepping.methods import METHODS, Method, method_meant
from symofros.simulation.stepping.stepper import Stepper

# Share of the largest kinetic energy that projections onto the constraints may take in a run. What the error of a step
# takes is of second order in that error: a run that loses a hundredth has steps that are wrong by tenths. Closed
# reference models lose less than 1e-4, those at steps that are far too long more than 1e-2.
LOSS_LIMIT = 0.01
# Of a step: nearer to one of its ends a sample begins there.
_AT_END = 1e-6
# Intervals of a run in which adaptive steps are looked into where next to nothing happens.
LOOKS = native_number("stepping/events/quiet_steps.c", "SYM_LOOKS")
# Share of a step within which the end of one is another's.
_AT_MARK = native_number("stepping/events/actions.c", "SYM_AT_MARK")
# Share of a step within which an event that acts twice acts without end.
_AT_ONCE = native_number("stepping/instances/instance.c", "SYM_AT_ONCE")
# Gains of 20/s hold a loop through its singular posture (tests of the N-four-bar), and lose accuracy on long steps.
_GAIN, _GAIN_STEP = 20.0, 0.5


def vector(model: Model, name: str, values: ArrayLike, size: int) -> Array:
    """A vector of that size, finite.

    Raises:
        ShapeError: It is something else.
    """
    array = real_array(model.by_name(name, values))
    if array is None or array.shape != (size,) or not np.all(np.isfinite(array)):
        fault, remedy = f"{type(values).__name__} {values!r:.60}", "one state a run: see model.nq, model.nv"
        if array is not None:
            fault = str(array.shape) if array.shape != (size,) else "a number that is not finite"
        elif hasattr(values, part := name.rstrip("0")):  # A result that holds one, such as of `assemble`.
            fault, remedy = f"an object of type {type(values).__name__}", f"pass its vector, .{part}"
        raise ShapeError(
            f"model '{model.record.name}': {name} does not fit",
            fault,
            f"{name} is a finite array of shape ({size},)",
            remedy,
        )
    return array


def first_configuration(model: Model, q0: ArrayLike | None) -> Array:
    """The configuration (nq) that a motion starts from, its quaternions at unit length; neutral if not given.

    Raises:
        ShapeError: It is no finite vector of that size, or a quaternion is no rotation.
    """
    if q0 is None:
        return model.neutral()
    return at_unit_length(model.record, "q", vector(model, "q0", q0, model.nq), "q0")


def _wrong(what: str, found: object, rule: str, remedy: str) -> SymofrosError:
    return SymofrosError(f"simulation: {what}", str(found), rule, remedy)


@dataclass(frozen=True)
class Settings:
    """The options of a run, checked and with their defaults filled in for a model.

    Attributes:
        method: Stepping method.
        adaptive: Whether it chooses its steps.
        stabilisation: Method of keeping constraints.
        t0: Start time [s].
        t_end: End time [s].
        dt: Step [s]; 0: an adaptive method finds its first.
        rtol: Relative bound of the local error.
        atol: Absolute bound of the local error.
        max_step: Longest step [s]; 0: no bound.
        max_steps: Number of steps after which the run ends; None: no bound.
        every: Number of steps between records; 0: records at `grid` only.
        grid: Times to record at (n) [s].
        project: Whether the state is projected onto the constraints after each step.
        gains: Baumgarte's gains (2 nc).
        beam_limit: Estimated error of the beams' theory beyond which the run ends.
        realtime: Seconds of motion a second; 0: as fast as possible.
    """

    method: Method
    adaptive: bool
    stabilisation: str
    t0: float
    t_end: float
    dt: float
    rtol: float
    atol: float
    max_step: float
    max_steps: int | None
    every: int
    grid: Array
    project: bool
    gains: Array
    beam_limit: float
    realtime: float

    @property
    def instant(self) -> float:
        """Time that counts as one instant to actions of events [s]; 0: a share of the time so far, as steps adapt."""
        return 0.0 if self.adaptive and math.isfinite(self.t_end) else _AT_ONCE * self.dt

    @property
    def judged(self) -> bool:
        """Whether its steps can be judged by how they amplify a mode: fixed ones, of most families."""
        return not self.adaptive and self.method.family.judged

    def samples_within_steps(self, jumps: Array) -> bool:
        """Whether held samples, which begin at `jumps`, do so within fixed steps: stages read one or the other."""
        if self.adaptive:
            return False
        steps = (jumps[(jumps > self.t0) & (jumps < self.t_end)] - self.t0) / self.dt
        return bool(np.any(np.abs(steps - np.rint(steps)) > _AT_END))

    @classmethod
    def of(cls, model: Model, options: SimulationOptions, t_end: float) -> Settings:
        """Settings of a run of a model.

        Raises:
            UnknownNameError: No such method.
            SymofrosError: A number is out of its range, or options contradict each other.
        """
        _check(options, t_end)
        method = METHODS[options.method]
        # Where all motion is given there is no error to adapt to.
        adapts = model.nv > 0 and (method.adaptive if options.adaptive is None else options.adaptive)
        step = options.dt if options.dt is not None else 0.0 if adapts else 1e-3
        if not adapts and model.nv > 0 and options.max_step < step:
            found, rule = f"dt = {step:g}, max_step = {options.max_step:g}", "steps of fixed length are dt long"
            raise _wrong(
                "steps are longer than max_step", found, rule, f"dt={options.max_step:g}, or an adaptive method"
            )
        return cls(
            method=method,
            adaptive=adapts,
            stabilisation=options.stabilisation,
            t0=options.t0,
            t_end=t_end,
            dt=step,
            rtol=options.rtol,
            atol=options.atol,
            max_step=options.max_step if math.isfinite(options.max_step) else 0.0,
            max_steps=options.max_steps,
            every=options.every if options.output is None else 0,
            grid=_grid(options.output, options.t0, t_end),
            project=model.nc > 0 and options.stabilisation == "projection" and not method.family.keeps_constraints,
            gains=_gains(model, options.stabilisation, options.gains, step),
            beam_limit=options.beam_limit,
            realtime=float(options.realtime),
        )

    def onwards(self, t: float, steps: int, records: int) -> Settings:
        """Settings of the next part of a run that begins anew at a time [s], after so many steps and records.

        Fixed steps stay where they were: the first one ends where it would have, and is a part of its own.
        """
        left = None if self.max_steps is None else self.max_steps - steps
        part = replace(self, t0=t, max_steps=left, grid=self.grid if self.every else self.grid[records:])
        if self.adaptive:
            return part
        mark = self.t0 + self.dt * math.ceil((t - self.t0) / self.dt)
        if min(mark - t, self.dt - (mark - t)) <= _AT_MARK * self.dt or mark >= self.t_end:
            return part
        return replace(part, t_end=mark, dt=mark - t, grid=part.grid[part.grid <= mark])

    def apply(self, stepper: Stepper) -> None:
        """Write the settings into a run."""
        run = stepper.run
        run.t0 = run.t = self.t0
        run.adaptive = int(self.adaptive)
        run.t_end, run.h, run.rtol, run.atol = self.t_end, self.dt, self.rtol, self.atol
        run.max_step, run.record_every, run.project = self.max_step, self.every, int(self.project)
        run.beam_limit = self.beam_limit
        stepper.system.longest_step = 0.0 if self.adaptive else max(stepper.system.longest_step, self.dt)
        # Prescribed speeds may jump, and then take energy that nothing else gives.
        run.loss_limit = math.inf if stepper.model.record.driven else LOSS_LIMIT
        run.grid, run.n_grid = stepper.memory.doubles(self.grid), len(self.grid)
        run.realtime_scale = 1.0 / self.realtime if self.realtime else 0.0
        stepper.set_gains(self.gains)
        if math.isfinite(self.t_end):  # Steps by hand have no end, and are looked ahead of as they are made.
            stepper.look_ahead(self.t0, self.t_end)
        if self.adaptive:
            run.look_every = (self.t_end - self.t0) / LOOKS


def _check(options: SimulationOptions, t_end: float) -> None:
    """Refuse options that mean nothing, or contradict each other, whatever the model."""
    o = options
    if o.method not in METHODS:
        rule, remedy = "a method has one of these names", method_meant(o.method)
        raise UnknownNameError(f"simulation: no method '{o.method}'", ", ".join(METHODS), rule, remedy)
    if not (math.isfinite(o.t0) and math.isfinite(t_end) and t_end >= o.t0):
        raise _wrong("no span of time", f"t0 = {o.t0}, t_end = {t_end}", "t_end is not before t0", "set t_end")
    if o.dt is not None and not (math.isfinite(o.dt) and o.dt > 0):
        raise _wrong("the step is not positive", o.dt, "dt > 0", "1e-3 s suits most arms")
    for name, value in (("rtol", o.rtol), ("atol", o.atol), ("max_step", o.max_step), ("beam_limit", o.beam_limit)):
        if not value > 0:
            raise _wrong(f"{name} is not positive", value, f"{name} > 0", "leave it out")
    check_pace(o.realtime)
    if o.every < 1:
        raise _wrong("nothing would be recorded", f"every = {o.every}", "every >= 1", "use output= for times")
    if o.gains is not None and o.stabilisation != "baumgarte":
        rule = "gains act in Baumgarte's stabilisation only"
        raise _wrong("gains without Baumgarte", f"stabilisation '{o.stabilisation}'", rule, "stabilisation='baumgarte'")
    if not (METHODS[o.method].adaptive if o.adaptive is None else o.adaptive):
        rule = f"steps of fixed length estimate no error, which it would bound: by '{o.method}' they are dt long"
        remedy = "method='dopri5' or another adaptive one, or dt in its place"
        o.refuse(("rtol", "atol"), "simulation: an option of adaptive steps", rule, remedy)
    if o.output is not None:
        rule = "states are recorded at the times of `output`, or after each so many steps"
        o.refuse(("every",), "simulation: an option of runs without `output`", rule)
    if o.adaptive and not METHODS[o.method].adaptive:
        what, remedy = f"'{o.method}' does not adapt its steps", "use dopri5, dop853 or rodas4"
        raise _wrong(what, "adaptive=True", "it estimates no error", remedy)


def check_pace(realtime: float | bool) -> None:
    """Refuse a pace against the clock that is negative, infinite or not a number.

    Raises:
        SymofrosError: It is.
    """
    if not 0.0 <= float(realtime) < math.inf:
        rule = "realtime is True, or seconds of motion a second, 0 for as fast as possible"
        raise _wrong("no pace against the clock", f"realtime = {realtime}", rule, "realtime=True")


def check_fit(model: Model, settings: Settings, inputs: InputPlan) -> None:
    """Refuse a model, inputs or stabilisation that the method does not support.

    Raises:
        SymofrosError: The model, its inputs or how constraints are kept do not suit the method.
    """
    name, family, baumgarte = settings.method.name, settings.method.family, settings.stabilisation == "baumgarte"
    if family.implicit and inputs.callback is not None:
        raise _wrong(
            f"'{name}' needs the derivatives of the inputs",
            "a Python function",
            "implicit methods differentiate what they step",
            "give formulas or Signals",
        )
    if (family.implicit or family.keeps_constraints) and baumgarte and model.nc:
        raise _wrong(
            f"'{name}' with Baumgarte's stabilisation",
            "gains",
            "implicit methods keep constraints by projection or by their equations",
            "stabilisation='projection'",
        )
    if family.multistep and (settings.project or not settings.adaptive):
        raise _wrong(
            f"'{name}' with projection or fixed steps",
            "a history of steps that would be cut",
            "SUNDIALS chooses its steps; CVODE keeps constraints by Baumgarte's gains, IDA by its equations",
            "method='ida', stabilisation='baumgarte', or rodas4 with projection",
        )
    if family.multistep and settings.realtime:
        what, rule = f"'{name}' keeps no pace against the clock", "SUNDIALS makes its steps as fast as it can"
        raise _wrong(what, f"realtime = {settings.realtime:g}", rule, "method='rk4', or realtime=False")
    if family.trees_only and (model.nc or model.record.driven):
        raise _wrong(
            f"'{name}' steps trees of free motion only",
            f"model '{model.record.name}' has constraints or prescribed joints",
            "its discrete principle is written for free coordinates",
            "use generalized_alpha, or rk4 with projection",
        )


# Of `output`: its times alone are 1.6 GB.
MAX_RECORDS = 200_000_000
# Beyond, a first state is a mistake and not what drift leaves.
CLOSED = 1e-6


def check_start(model: Model, settings: Settings, q: Array, v: Array, u: Array, par: Array) -> None:
    """Refuse a first state that does not meet the constraints; Baumgarte's gains may pull one in.

    Raises:
        AssemblyError: With the constraint that is off most.
    """
    if not model.nc:
        return
    refuse_opposite(model, q, u, par)
    if settings.stabilisation == "baumgarte":
        return
    for what, values in (
        ("phi", model.constraint(q, u=u, par=par, t=settings.t0)),
        ("G v - b", model.constraint_rate(q, v, u=u, par=par, t=settings.t0)),
    ):
        worst = int(np.argmax(np.abs(values)))
        condition = model.names.constraints[worst]
        if not abs(values[worst]) <= CLOSED:
            raise AssemblyError(
                f"model '{model.record.name}': the first state does not keep '{condition}'",
                f"{what} = {values[worst]:.3g}",
                f"|{what}| <= {CLOSED:g} at the start",
                "start from sf.assemble(model, q0, v0), or pull it in by stabilisation='baumgarte'",
            )


def _grid(output: float | npt.ArrayLike | None, t0: float, t_end: float) -> Array:
    if output is None:
        return np.zeros(0)
    times = numeric("output", output)
    if times.ndim == 0:
        interval = float(times)
        if not (math.isfinite(interval) and interval > 0):
            raise _wrong("the output interval is not positive", interval, "output > 0", "give an interval in seconds")
        count = (t_end - t0) / interval * (1 + 1e-12)
        if not count < MAX_RECORDS:
            rule, remedy = f"a run records at most {MAX_RECORDS} states", "a longer interval, or a shorter run"
            raise _wrong("too many states to record", f"{count:.3g} of them", rule, remedy)
        found = t0 + interval * np.arange(math.floor(count) + 1)
        if abs(found[-1] - t_end) <= 1e-9 * interval:  # Rounding may put it behind the end, where no step comes.
            found[-1] = t_end
        return np.asarray(found, dtype=np.float64)
    if times.ndim != 1 or times.size == 0 or not (np.all(np.diff(times) > 0) and t0 <= times[0] <= times[-1] <= t_end):
        raise ShapeError(
            "simulation: output times do not fit",
            f"shape {times.shape}" if np.isfinite(times).all() else "times that are not finite",
            f"times (n) increase from {t0} to {t_end} at most",
            "sort them",
        )
    return times


def _gains(model: Model, stabilisation: str, gains: npt.ArrayLike | None, step: float) -> Array:
    if stabilisation != "baumgarte" or not model.nc:
        return np.zeros(2 * model.nc)
    if gains is None:
        return np.full(2 * model.nc, min(_GAIN, _GAIN_STEP / step) if step else _GAIN)
    given = numeric("gains", gains)
    given = np.repeat(given, model.nc) if given.shape == (2,) else given
    if given.shape != (2 * model.nc,) or not np.all(given >= 0):
        raise ShapeError(
            "simulation: gains do not fit",
            str(given.shape),
            f"(alpha, beta), or ({2 * model.nc},): alphas, then betas, none negative",
            "give two numbers",
        )
    return given
