"""One block at a time: fed by samples, run compiled and interpreted, which must agree."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import Reshape, Sequence
from symofros.diagrams.block import Block
from symofros.errors import Problem

# The same formulas in the same order: only the steps' sums and the C compiler's fused operations may differ.
ROUNDING = 1e-12

STEP = 0.01


def run(
    block: Block,
    inputs: Mapping[str, Any] | None = None,
    t_end: float | None = None,
    models: Mapping[str, tuple[sf.System, Mapping[str, float]]] | None = None,
    kind: str = "hold",
    dt: float = STEP,
    compare: float = ROUNDING,
    compiled: bool = False,
) -> Mapping[str, np.ndarray]:
    """Outputs of a block over time, by port, and "t"; what the interpreted run gives is compared.

    Args:
        block: The block.
        inputs: Port -> its values over time, one row a multiple of dt.
        t_end: Where to end; by default with the inputs.
        models: Name -> system, start.
        kind: Of the inputs between samples.
        dt: Step, and interval of records.
        compare: Largest difference, absolute or relative; 0 leaves the interpreted run out.
        compiled: Whether C evaluates single blocks in the interpreted run; else NumPy does.
    """
    diagram = sf.Diagram("one")
    for name, (system, start) in (models or {}).items():
        diagram.add_model(name, system, start)
    values = {port: np.asarray(value, dtype=float) for port, value in (inputs or {}).items()}
    sources = {}
    for port, value in values.items():
        rows = value.reshape(len(value), -1)
        diagram.add(Sequence(name=f"source_{port}", t=dt * np.arange(len(value)), values=rows, kind=kind))
        diagram.add(Reshape(name=f"given_{port}", shape=value.shape[1:]), u=f"source_{port}.y")
        sources[port] = f"given_{port}.y"
    diagram.add(block, **sources)
    end = t_end if t_end is not None else dt * (max(map(len, values.values())) - 1)
    simulation = sf.Simulation(diagram)
    found = simulation.run(end, dt=dt, record=dt)
    assert found.outcome.ok, found.outcome
    ports = [port.name for port in simulation.resolved.wired.ports[block.name].outputs]
    signals = {port: np.asarray(found[f"{block.name}.{port}"]) for port in ports}
    if compare:
        other = simulation.interpret(end, dt=dt, record=dt, compiled=compiled)
        for port, value in signals.items():
            np.testing.assert_allclose(other[f"{block.name}.{port}"], value, rtol=compare, atol=compare, err_msg=port)
    return {"t": np.asarray(found.t), **signals}


def refused(make: Callable[[], object], found: str, remedy: str = "") -> Problem:
    """What is stated wrongly is refused, and told in four parts: the block, what was found, a rule, a remedy."""
    with pytest.raises(sf.DescriptionError) as caught:
        make()
    problem = caught.value.problems[0]
    assert problem.what and found in problem.found, problem
    assert problem.rule and problem.remedy and remedy in problem.remedy, problem
    return problem
