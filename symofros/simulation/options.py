"""How a run is stepped, kept on its constraints, and recorded."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from symofros.base.arguments import CheckedCalls, check_fields, with_fields
from symofros.errors import SymofrosError, UnknownNameError, did_you_mean, near_name
from symofros.runtime.beams import BEAM_LIMIT

Stabilisation = Literal["projection", "baumgarte", "none"]
# What the functions that take these options by name call their own arguments; those of runs of diagrams.
_CALL = ("q0", "v0", "t_end", "z0", "u", "par")
DIAGRAM_CALL = ("t_end", "parameters", "starts", "threads")
# What runs of diagrams, their files and the command line call an option.
_ALIASES = {"record": "output"}
# Names that other tools have for options and arguments, in small letters, by ours: by spelling, `t` would be near `t0`.
_OTHER_NAMES = {
    "t_end": "t tf t_f t1 tmax t_max tend t_final tfinal t_stop t_span time duration end end_time stop_time seconds",
    "t0": "t_start start_time",
    "dt": "h step timestep time_step step_size stepsize delta_t",
    "method": "solver integrator scheme algorithm",
    "q0": "x0 y0 q initial initial_state",
    "v0": "v dq dq0 qd qd0 qdot qdot0",
    "z0": "z states",
    "u": "tau input inputs control controls controller torques",
    "par": "p params parameter parameters args",
    "rtol": "tol tolerance reltol",
    "atol": "abstol",
    "output": "t_eval",
}
_OURS = {name: ours for ours, names in _OTHER_NAMES.items() for name in names.split()}


@dataclass(frozen=True)
class SimulationOptions(metaclass=CheckedCalls):
    """How a run is stepped, kept on its constraints, and recorded: of one model, of a batch, of a diagram.

    Attributes:
        method: Name of the stepping method. Fixed steps: "rk4", "semi_implicit_euler", "euler"; implicit, for stiff
            beams and joints: "implicit_euler", "generalized_alpha"; for long conservative runs: "variational". Steps
            chosen by `rtol` and `atol`: "dopri5", "dop853" and, for stiff models, "rodas4"; from SUNDIALS, where
            scikit-sundae is installed: "cvode" (stiff), "cvode_adams", and "ida", which solves the equations of
            constrained models with their multipliers (DAE).
        dt: Step [s], 1e-3 where a fixed step needs one; first step of adaptive methods.
        t0: Start time [s].
        rtol: Bound of the local error of adaptive methods, relative to each coordinate and speed; refused with others.
        atol: Bound of the local error of adaptive methods, absolute; refused with others.
        adaptive: False makes an adaptive method step by `dt`; None leaves each method as it is.
        max_step: Longest step of adaptive methods [s].
        max_steps: Number of steps after which the run ends; None for no bound.
        output: Times to record: None for every `every`-th step, an interval [s], or times (n) [s]. A batch records its
            last state by default, a diagram about 2000 times in all; it takes an interval alone, and steps end at the
            recorded times. `record` is the same. Where events act at such a time, the state after them is recorded;
            without `output`, both.
        every: Number of steps between records where `output` is None; single runs only.
        stabilisation: How constraints are kept: "projection" onto them after each step, "baumgarte" by gains, or
            "none", by accelerations alone, which drifts.
        gains: Baumgarte's gains, as `Model.forward_dynamics` takes them; both min(20, 1/(2 dt)) [1/s] by default.
        beam_limit: Estimated error of the beams' second-order theory, relative to the deflection, beyond which the run
            ends (docs/theory/beams.md, section 6); `math.inf` for no limit. From 0.01 on it is noted.
        realtime: Pace against the clock: True, or seconds of motion a second; overruns are counted; single runs only.
    """

    method: str = "rk4"
    dt: float | None = None
    t0: float = 0.0
    rtol: float = 1e-6
    atol: float = 1e-9
    adaptive: bool | None = None
    max_step: float = math.inf
    max_steps: int | None = None
    output: float | ArrayLike | None = None
    every: int = 1
    stabilisation: Stabilisation = "projection"
    gains: ArrayLike | None = None
    beam_limit: float = BEAM_LIMIT
    realtime: float | bool = False

    def __post_init__(self) -> None:
        """Refuse fields of the wrong type."""
        check_fields(self)

    def changed(self, changes: Mapping[str, Any], arguments: Sequence[str] = _CALL) -> SimulationOptions:
        """These options with some fields replaced.

        Args:
            changes: Values by field.
            arguments: Names of the other arguments of the call that they were given in, which may have been meant.

        Raises:
            UnknownNameError: A name is not that of a field.
        """
        names = list(self.__dataclass_fields__)
        chosen = {_ALIASES.get(name, name): value for name, value in changes.items()}
        for name in chosen:
            if name not in names:
                rule = f"options are the fields of SimulationOptions, beside the arguments {', '.join(arguments)}"
                remedy = _meant(name, names, arguments)
                raise UnknownNameError(f"simulation: no option '{name}'", name, rule, remedy)
        return with_fields(self, chosen) if chosen else self

    def refuse(self, names: Sequence[str], what: str, rule: str, remedy: str = "leave it out") -> None:
        """Refuse options that are stated and have no effect on this kind of run.

        Args:
            names: Names of fields.
            what: What kind of options they are, for the message.
            rule: Why they mean nothing.
            remedy: The change to make.

        Raises:
            SymofrosError: One of them is not as by default.
        """
        for name in names:
            value = getattr(self, name)
            if value is not None and (np.ndim(value) or value != getattr(USUAL, name)):
                raise SymofrosError(f"{what}, '{name}'", repr(value)[:60], rule, remedy)


USUAL = SimulationOptions()


def _meant(name: str, names: Sequence[str], arguments: Sequence[str]) -> str:
    """The option or argument that is called so elsewhere, or the nearest one, or the list of options."""
    ours = _OURS.get(name.lower())
    if ours in names or ours in arguments:
        return f"did you mean '{ours}'?"
    return near_name(name, [*names, *arguments]) or did_you_mean(name, names)
