"""How well diagrams keep pace with the clock: a robot under computed torque, with and without Python in the loop."""

from __future__ import annotations

import os
import socket
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from typing import Annotated

import numpy as np
import typer

import symofros as sf
from symofros.blocks import (
    Block,
    Environment,
    EvaluationContext,
    ForwardDynamics,
    Port,
    Ports,
    Store,
    UdpReceiver,
    UdpTransmitter,
    Values,
    joined,
)
from symofros.tools import Jitter, jitter_of

from .. import references
from ..mechanics.geometry import Array
from ..reporting.command import Run
from ..reporting.record import Data

ROBOT = references.FOLDER / "rigid" / "puma560.yaml"
# Of the motion that is followed: half its width [rad], its frequency [rad/s].
SWING, RATE = 0.4, 2.0
# Of the controller [1/s^2], [1/s].
KP, KD = 400.0, 40.0
# Edges of bins of lateness [us], twelve a decade.
_EDGES = np.logspace(-1, 5, 73)


@dataclass(frozen=True, kw_only=True)
class Following(Block):
    """Computed torque along a sine of every joint: tau = ID(q, v, a_d + kp e + kd e')."""

    model: str

    def ports(self, environment: Environment) -> Ports:
        """The robot's state in, efforts out."""
        size = (len(environment.model(self.model).q_names),)
        return Ports((Port("q", size), Port("v", size)), (Port("effort", size),))

    def compute(self, context: EvaluationContext) -> Values:
        """Motor effort by the model's inverse dynamics, at the desired acceleration with PD feedback."""
        q, v = context.inputs["q"], context.inputs["v"]
        phase = context.t * RATE
        sine, cosine = phase.apply("sin"), phase.apply("cos")
        wanted = -SWING * RATE**2 * sine + KP * (SWING * sine - q) + KD * (SWING * RATE * cosine - v)
        return {
            "effort": context.call(self.model, "inverse_dynamics", q=q, v=v, a=joined([wanted]), t=context.t)["tau"]
        }


@dataclass(frozen=True)
class TimedDiagram:
    """One diagram to be timed.

    Attributes:
        what: In words.
        make: Gives the diagram, whose instants are a period apart.
        period: Period of its instants [s].
    """

    what: str
    make: Callable[[], sf.Diagram]
    period: float


@dataclass(frozen=True)
class Timed:
    """How one diagram kept pace.

    Attributes:
        what: The diagram.
        first: Whether its thread came before ordinary programs (SCHED_FIFO).
        period: Between instants [s].
        jitter: How late they began.
        late: Each of them (n) [s].
        busy: Processor time of the loop, an instant [s].
    """

    what: str
    first: bool
    period: float
    jitter: Jitter
    late: np.ndarray
    busy: float


def clock() -> sf.Diagram:
    """Nothing moves: what the operating system's own waking is worth."""
    return sf.Diagram("clock")


def robot(period: float, *, python: bool = False) -> sf.Diagram:
    """A PUMA 560 that follows a sine; with Python in the loop it keeps its state and sends it to itself by UDP."""
    d = sf.Diagram("robot")
    d.add_model("arm", sf.load(ROBOT))
    d.add(ForwardDynamics(name="plant", model="arm"), u="control.effort")
    d.add(Following(name="control", model="arm", period=period), q="plant.q", v="plant.v")
    if python:
        port = _free_port()
        d.add(Store(name="log", signals=("q", "v"), period=period), q="plant.q", v="plant.v")
        d.add(UdpTransmitter(name="tx", port=port, period=period), signal="plant.q")
        d.add(UdpReceiver(name="rx", port=port, size=6, period=period))
    return d


TIMED_DIAGRAMS = (
    TimedDiagram("the clock alone, 1 kHz", clock, 1e-3),
    TimedDiagram("robot, 1 kHz", lambda: robot(1e-3), 1e-3),
    TimedDiagram("robot, with Python and UDP, 1 kHz", lambda: robot(1e-3, python=True), 1e-3),
    TimedDiagram("robot, 5 kHz", lambda: robot(2e-4), 2e-4),
)


# Of SCHED_FIFO, from 1 to 99; any is above every ordinary program.
_PRIORITY = 20


@contextmanager
def coming_first(wanted: bool) -> Iterator[None]:
    """While inside, the calling thread comes before ordinary programs.

    Raises:
        OSError: The system has no such thing (AttributeError), or does not permit it.
    """
    if not wanted:
        yield
        return
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(_PRIORITY))
    try:
        yield
    finally:
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))


def may_come_first() -> bool:
    """Whether this process may ask for that."""
    try:
        with coming_first(True):
            return True
    except (OSError, AttributeError):
        return False


def run(seconds: float, diagram: TimedDiagram, first: bool = False) -> Timed:
    """Run a diagram in real time.

    Args:
        seconds: How long.
        diagram: Which.
        first: Whether its thread comes before ordinary programs.

    Raises:
        SymofrosError: The run did not come to its end, or the robot left its path: then timing it means nothing.
    """
    simulation = sf.Simulation(diagram.make())
    settings = {"dt": diagram.period, "record": diagram.period}
    simulation.run(10.0 * diagram.period, **settings)  # What is loaded at first use is no jitter.
    with coming_first(first):
        result = simulation.run(seconds, realtime=True, **settings)
    if not result.outcome.ok:
        raise sf.SymofrosError(f"{diagram.what}: {result.outcome}")
    if "plant" in result.compiled.resolved.wired.blocks:
        error = np.abs(result["plant.q"][-1] - SWING * np.sin(RATE * result.t[-1])).max()
        if seconds > 1.0 and not error < 0.02:
            raise sf.SymofrosError(f"{diagram.what}: the robot is {error:.2g} rad off its path")
    cost = result.cost
    return Timed(diagram.what, first, diagram.period, jitter_of(cost), cost.late, cost.worked / len(cost.late))


def _free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


def measure(
    progress: Run, seconds: Annotated[float, typer.Option(min=0.01, help="Length of each diagram.")] = 20.0
) -> Data:
    """Keep pace with the clock, and say how well."""
    ways = (False, True) if may_come_first() else (False,)
    progress.expect(len(ways) * len(TIMED_DIAGRAMS), "in real time")
    diagrams = []
    for first in ways:
        for diagram in TIMED_DIAGRAMS:
            row = run(seconds, diagram, first)
            stated = {name: getattr(row, name) for name in ("what", "first", "period", "busy")}
            diagrams.append({**stated, **asdict(row.jitter), "late": _share_later(row.late)})
            progress.advance()
    return {"diagrams": diagrams, "length": seconds, "cores": os.cpu_count(), "load": os.getloadavg()[0]}


def _share_later(late: Array) -> dict[str, list[float]]:
    """Share of the instants that began later than each of some times [us], as far as there are any."""
    shares = 1.0 - np.searchsorted(np.sort(1e6 * late), _EDGES) / len(late)
    used = int(np.count_nonzero(shares)) + 1
    return {"us": [float(f"{x:.4g}") for x in _EDGES[:used]], "share": [float(f"{x:.4g}") for x in shares[:used]]}
