"""Blocks fed by samples, run compiled and interpreted, which must agree."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros import blocks
from symofros.diagrams.block import Block
from symofros.errors import Problem

# The same formulas in the same order: only the steps' sums and the C compiler's fused operations may differ.
ROUNDING = 1e-12

STEP = 0.01


def run(block: Block, inputs: Mapping[str, Any] | None = None, **options: Any) -> Mapping[str, np.ndarray]:
    """Outputs of a block over time, by port, and "t"; inputs by port, options as of `run_each`."""
    return run_each([(block, inputs or {})], **options)[0]


def run_each(
    fed: Sequence[tuple[Block, Mapping[str, Any]]],
    t_end: float | None = None,
    models: Mapping[str, tuple[sf.System, Mapping[str, float]]] | None = None,
    kind: str = "hold",
    dt: float = STEP,
    compare: float = ROUNDING,
    compiled: bool = False,
) -> list[Mapping[str, np.ndarray]]:
    """Outputs of blocks over time, by port, and "t"; what the interpreted run gives is compared.

    The blocks stand in one diagram, so that the compiler is called once for all.

    Args:
        fed: Blocks, each with port -> its values over time, one row a multiple of dt.
        t_end: Where to end; by default with the inputs.
        models: Name -> system, start.
        kind: Of the inputs between samples.
        dt: Step, and interval of records.
        compare: Largest difference, absolute or relative; 0 leaves the interpreted run out.
        compiled: Whether C evaluates single blocks in the interpreted run; else NumPy does.
    """
    diagram = sf.Diagram("blocks")
    for name, (system, start) in (models or {}).items():
        diagram.add_model(name, system, start)
    rows = 0
    for block, inputs in fed:
        sources = {}
        for port, given in inputs.items():
            value = np.asarray(given, dtype=float)
            rows = max(rows, len(value))
            sequence, reshape = f"source_{block.name}_{port}", f"given_{block.name}_{port}"
            samples = value.reshape(len(value), -1)
            diagram.add(blocks.Sequence(name=sequence, t=dt * np.arange(len(value)), values=samples, kind=kind))
            diagram.add(blocks.Reshape(name=reshape, shape=value.shape[1:]), u=f"{sequence}.y")
            sources[port] = f"{reshape}.y"
        diagram.add(block, **sources)
    end = t_end if t_end is not None else dt * (rows - 1)
    simulation = sf.Simulation(diagram)
    record = simulation.run(end, dt=dt, record=dt)
    assert record.outcome.ok, record.outcome
    other = simulation.interpret(end, dt=dt, record=dt, compiled=compiled) if compare else None
    outputs = []
    for block, _ in fed:
        ports = [port.name for port in simulation.resolved.wired.ports[block.name].outputs]
        signals = {port: np.asarray(record[f"{block.name}.{port}"]) for port in ports}
        for port, value in signals.items() if other is not None else ():
            signal = f"{block.name}.{port}"
            np.testing.assert_allclose(other[signal], value, rtol=compare, atol=compare, err_msg=signal)
        outputs.append({"t": np.asarray(record.t), **signals})
    return outputs


def refused(make: Callable[[], object], found: str, remedy: str = "") -> Problem:
    """Wrong fields are refused, in four parts: the block, what was found, a rule, a remedy."""
    with pytest.raises(sf.DescriptionError) as caught:
        make()
    problem = caught.value.problems[0]
    assert problem.what and found in problem.found, problem
    assert problem.rule and problem.remedy and remedy in problem.remedy, problem
    return problem
