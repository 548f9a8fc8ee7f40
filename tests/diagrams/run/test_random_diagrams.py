"""Random diagrams of blocks of every rate: the compiled run is the interpreted one, by another program."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros import blocks
from symofros.blocks import MachineState, Transition
from symofros.diagrams.block import Block

PERIODS = (0.01, 0.02, 0.03, 0.05)
MACHINE: dict[str, Any] = {
    "machine_states": {
        "a": MachineState(during={"y": "u"}),
        "b": MachineState(entry={"y": "y + 0.1"}, exit={"y": "elapsed"}),
    },
    "transitions": [Transition("a", "b", "u - 0.4"), Transition("b", "a", "-u - elapsed")],
    "outputs": {"y": 0.2},
}
TABLE: dict[str, Any] = {"x": [-1.0, 0.0, 0.3, 2.0], "y": [2.0, -1.0, 0.5, 1.0], "outside": "extend"}
# What a block is made of, but its name and its samples; the sampled ones alone, and those of either kind.
SAMPLED: tuple[Callable[..., Block], ...] = (
    lambda **n: blocks.Integrator(low=-1.0, high=1.0, **n),
    lambda **n: blocks.UnitDelay(start=0.3, **n),
    lambda **n: blocks.TransportDelay(delay=0.037, start=0.3, **n),
    lambda **n: blocks.Relay(lower=-0.2, upper=0.3, **n),
    lambda **n: blocks.RateLimit(rising=4.0, falling=7.0, **n),
    lambda **n: blocks.Quantizer(step=0.13, **n),
    lambda **n: blocks.StateMachine(**MACHINE, **n),
    lambda **n: blocks.TransferFunction(num=[1.0, 0.2], den=[1.0, -0.3, 0.1], **n),
)
EITHER: tuple[Callable[..., Block], ...] = (
    lambda **n: blocks.Saturation(low=-0.5, high=0.7, **n),
    lambda **n: blocks.LookupTable(**TABLE, **n),
    lambda **n: blocks.Derivative(tau=0.05, **n),
    lambda **n: blocks.DeadZone(low=-0.2, high=0.1, **n),
    lambda **n: blocks.Formula(formulas={"y": "1.2*sin(u) + 0.4*u"}, **n),
)


def part(period: float) -> sf.Diagram:
    """Two rates: an integral, and a delay of it."""
    inside = sf.Diagram("part")
    inside.add(blocks.Integrator(name="sum", start=0.2, period=period))
    inside.add(blocks.UnitDelay(name="late", period=2 * period), u="sum.y")
    inside.add(blocks.Sum(name="both", period=period), u1="sum.y", u2="late.y")
    inside.add_inlet("u", "sum.u", shape=())
    inside.outlets = {"y": "both.y"}
    return inside


def drawn(rng: np.random.Generator) -> tuple[sf.Diagram, list[str]]:
    """A diagram, and its outputs."""
    diagram = sf.Diagram("drawn")
    diagram.add(blocks.Sine(name="wave", frequency=1.7, amplitude=2.0, phase=float(rng.uniform(0.0, 6.0))))
    diagram.add(blocks.Noise(name="noise", seed=int(rng.integers(100)), period=0.01))
    sources = ["wave.y", "noise.y"]
    for k in range(16):
        period, name = float(rng.choice(PERIODS)), f"b{k}"
        samples = {"period": period, "offset": float(rng.choice([0.0, 0.0, 0.005]))}
        u, kind = str(rng.choice(sources)), rng.integers(4)
        if kind == 0:
            held = [("held", "reset")[i] for i in rng.integers(0, 2, 2)]
            when: Any = {"enabled": str(rng.choice(sources)), "outputs": held[0], "states": held[1]}
            diagram.include(name, part(period), None, sf.Condition(**when), u=u)
        else:
            makes = EITHER if kind == 1 else SAMPLED
            is_sampled = makes is SAMPLED or rng.random() < 0.5
            make = makes[int(rng.integers(len(makes)))]
            diagram.add(make(name=name, **(samples if is_sampled else {})), u=u)
        sources.append(f"{name}.y")
    return diagram, sources


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(1, 10))])
def test_random_diagrams_run_compiled_as_interpreted(seed: int) -> None:
    diagram, outputs = drawn(np.random.default_rng(seed))
    simulation = sf.Simulation(diagram)
    run, other = (each(0.4, dt=5e-3, record=0.01) for each in (simulation.run, simulation.interpret))
    assert run.outcome.ok
    for output in outputs:
        np.testing.assert_allclose(other[output], run[output], rtol=1e-9, atol=1e-9, err_msg=output)
