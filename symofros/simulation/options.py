"""How a run is stepped, kept on its constraints, and recorded."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar, Literal, Protocol, TypeVar

from numpy.typing import ArrayLike

from symofros.base.arguments import CheckedCalls, check_fields
from symofros.errors import Problem, UnknownNameError, did_you_mean
from symofros.runtime.beams import BEAM_LIMIT

Stabilisation = Literal["projection", "baumgarte", "none"]
STABILISATIONS = ("projection", "baumgarte", "none")


@dataclass(frozen=True)
class SimulationOptions(metaclass=CheckedCalls):
    """How a run is stepped, kept on its constraints, and recorded.

    Attributes:
        method: Name of the stepping method. Fixed steps: "rk4", "semi_implicit_euler", "euler"; implicit, for stiff
            beams and joints: "implicit_euler", "generalized_alpha"; for long conservative runs: "variational". Steps
            chosen by `rtol` and `atol`: "dopri5", "dop853" and, for stiff models, "rodas4"; from SUNDIALS, where
            scikit-sundae is installed: "cvode" (stiff), "cvode_adams", and "ida", which solves the equations of
            constrained models with their multipliers (DAE).
        dt: Step [s], 1e-3 where a fixed step needs one; first step of adaptive methods.
        t0: Start time [s].
        rtol: Bound of the local error of adaptive methods, relative to each coordinate and speed.
        atol: Bound of the local error of adaptive methods, absolute.
        adaptive: False makes an adaptive method step by `dt`; None leaves each method as it is.
        max_step: Longest step of adaptive methods [s].
        max_steps: Number of steps after which the run ends; None for no bound.
        output: Times to record: None for every `every`-th step, an interval [s], or times (n) [s]. A batch records its
            last state by default.
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
        """Refuse what is of another type."""
        check_fields(self)

    def changed(self, changes: Mapping[str, Any]) -> SimulationOptions:
        """These options with some fields replaced.

        Raises:
            UnknownNameError: A name is not that of a field.
        """
        return with_changes(self, changes)


class _Dataclass(Protocol):
    __dataclass_fields__: ClassVar[dict[str, Any]]


_Options = TypeVar("_Options", bound=_Dataclass)


def with_changes(options: _Options, changes: Mapping[str, Any]) -> _Options:
    """Options with some fields replaced.

    Raises:
        UnknownNameError: A name is not that of a field.
    """
    names = [item.name for item in fields(options)]
    for name in changes:
        if name not in names:
            raise UnknownNameError(
                Problem(
                    f"simulation: no option '{name}'",
                    name,
                    f"options are the fields of {type(options).__name__}",
                    did_you_mean(name, names),
                )
            )
    return replace(options, **changes)
