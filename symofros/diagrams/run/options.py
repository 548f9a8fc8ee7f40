"""How a diagram is run in C: stepping, constraints, recording, pace."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from numpy.typing import ArrayLike

from symofros.base.arguments import check_fields
from symofros.runtime.beams import BEAM_LIMIT
from symofros.runtime.model import Model
from symofros.simulation.options import SimulationOptions, Stabilisation, with_changes
from symofros.simulation.settings import Settings, check_pace


@dataclass(frozen=True)
class DiagramOptions:
    """Options of a run of a compiled diagram.

    Attributes:
        t0: Start time [s]; instants are counted from it.
        method: An explicit method of `sf.simulate`: rk4, euler, semi_implicit_euler, dopri5, dop853.
        dt: Step [s]; steps also end at instants.
        record: Interval of recording [s]; by default about 2000 times in all. Steps end at recorded times, too.
        rtol: Relative bound of the local error of adaptive methods.
        atol: Absolute bound of the local error of adaptive methods.
        stabilisation: Method of keeping constraints, as in `sf.simulate`.
        gains: Baumgarte's gains, as in `sf.simulate`.
        beam_limit: Estimated error of the beams' theory beyond which the run ends, as in `sf.simulate`.
        realtime: Pace against the clock: True, or seconds of motion a second.
        threads: Number of threads that share the parts that meet at samples only; results do not depend on it.
    """

    t0: float = 0.0
    method: str = "rk4"
    dt: float | None = None
    record: float | None = None
    rtol: float = 1e-6
    atol: float = 1e-9
    stabilisation: Stabilisation = "projection"
    gains: ArrayLike | None = None
    beam_limit: float = BEAM_LIMIT
    realtime: float | bool = False
    threads: int = 1

    def __post_init__(self) -> None:
        """Refuse what is of another type."""
        check_fields(self)
        check_pace(self.realtime)

    def changed(self, changes: Mapping[str, Any]) -> DiagramOptions:
        """These options with some fields replaced.

        Raises:
            UnknownNameError: A name is not that of a field.
        """
        return with_changes(self, changes, ("t_end", "parameters"))

    def settings(self, model: Model, t_end: float) -> Settings:
        """Settings of the stepping of one part.

        Raises:
            SymofrosError: The options contradict each other.
        """
        options = SimulationOptions(
            self.method,
            self.dt,
            self.t0,
            self.rtol,
            self.atol,
            stabilisation=self.stabilisation,
            gains=self.gains,
            beam_limit=self.beam_limit,
        )
        return Settings.of(model, options, t_end)
