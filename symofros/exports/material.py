"""What every export is made of: the model's C text, its names and sizes, where it starts, how it steps."""

from __future__ import annotations

from dataclasses import dataclass, field

from symofros.description import System
from symofros.exports.c.event_plan import EventPlan
from symofros.exports.c.parameter_check import Judged
from symofros.runtime.beams import BEAM_LIMIT, ElasticBeam
from symofros.runtime.calls import Signature
from symofros.runtime.record import ModelRecord
from symofros.simulation.stepping.methods import Method


@dataclass(frozen=True)
class Stepping:
    """How an export steps by itself.

    Attributes:
        method: Method of sf.simulate.
        dt: Step, or longest step within a communication interval [s].
        rtol: Relative bound of the local error of adaptive methods.
        atol: Absolute.
        beam_limit: Estimated error of the beams' theory beyond which stepping fails.
    """

    method: Method
    dt: float
    rtol: float
    atol: float
    beam_limit: float = BEAM_LIMIT


@dataclass(frozen=True)
class Check:
    """One function at one reference point.

    Attributes:
        inputs: All input arrays but the parameters', one after the other.
        outputs: All output arrays, from the interpreter.
    """

    inputs: tuple[float, ...]
    outputs: tuple[float, ...]


@dataclass(frozen=True)
class Material:
    """One model, ready to be wrapped.

    Attributes:
        system: System as the user stated it.
        record: Names, sizes, defaults.
        c_name: Name of files and symbols in C.
        source: C text of the model.
        functions: Keys of the functions in it, in order.
        signatures: Inputs and outputs of each function, in that order.
        checks: Reference points of each function, in that order.
        points: Number of values of each.
        q_start: First configuration (nq).
        v_start: First speeds (nv).
        reach: Change of each coordinate that is of order one (nq), where constraints may move the start.
        stepping: Stepping method and its settings.
        beams: Elastic beams, at the default parameters.
        outputs: Frames whose positions are outputs of blocks and FMUs.
        generator: Name and version of what wrote it.
        reactions: Whether the package has reactions and efforts of actuators.
        notes: Remarks for the user.
        events: Events that its steps look for, and what they do; None where there are none.
    """

    system: System
    record: ModelRecord
    c_name: str
    source: str
    functions: tuple[tuple[str, str], ...]
    signatures: tuple[Signature, ...]
    checks: tuple[Check, ...]
    points: int
    q_start: tuple[float, ...]
    v_start: tuple[float, ...]
    reach: tuple[float, ...]
    stepping: Stepping
    beams: tuple[ElasticBeam, ...]
    outputs: tuple[str, ...]
    generator: str
    reactions: bool
    notes: tuple[str, ...] = field(default=())
    events: EventPlan | None = None

    @property
    def judged(self) -> tuple[Judged, ...]:
        """The description, by which run-time parameters are judged."""
        return (Judged(self.system, self.record.par_names),)

    @property
    def frames(self) -> tuple[str, ...]:
        """Frames that functions were generated for, in order."""
        return tuple(dict.fromkeys(frame for _, frame in self.functions if frame))
