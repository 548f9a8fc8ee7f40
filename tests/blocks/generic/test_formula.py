"""Blocks that users write: formulas and functions of Python's."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import Formula, PythonBlock
from tests.blocks.support import STEP, run


def test_formulas_use_inputs_constants_and_time(rng: np.random.Generator) -> None:
    u, x = rng.normal(size=(6, 3)), rng.normal(size=6)
    block = Formula(
        name="f",
        formulas={"y": "k*u[0] + sin(x)*t", "z": ["u[2]^2", "max(x, 0)", "pi"]},
        constants={"k": 2.5},
        units={"x": "rad", "y": "N"},
    )
    found = run(block, {"u": u, "x": x})
    np.testing.assert_allclose(found["y"], 2.5 * u[:, 0] + np.sin(x) * found["t"], atol=1e-14)
    np.testing.assert_allclose(found["z"], np.stack([u[:, 2] ** 2, np.maximum(x, 0), np.full(6, np.pi)], 1), atol=1e-14)


def test_constants_are_run_time_parameters() -> None:
    diagram = sf.Diagram("one")
    diagram.add(Formula(name="f", formulas="k*t", constants={"k": 1.0}))
    assert sf.Simulation(diagram).run(1.0, dt=0.1, parameters={"f.k": 3.0})["f.y"][-1] == pytest.approx(3.0)


def test_python_blocks_are_called_at_samples_and_notified_of_the_run() -> None:
    heard: list[object] = []

    def function(t: float, inputs: object) -> dict[str, object]:
        heard.append(t)
        return {"y": 2.0 * inputs["u"]}  # type: ignore[index]

    block = PythonBlock(
        name="p",
        function=function,
        inputs={"u": None},
        outputs={"y": (2,)},
        period=2 * STEP,
        on_begin=lambda: heard.append("begin"),
        on_end=lambda: heard.append("end"),
    )
    u = np.arange(10.0).reshape(5, 2)
    found = run(block, {"u": u}, compare=0)["y"]
    np.testing.assert_array_equal(found, 2 * u[[0, 0, 2, 2, 4]])
    assert heard == ["begin", 0.0, 2 * STEP, 4 * STEP, "end"]
    run(block, {"u": u})


def test_outputs_of_python_functions_are_checked() -> None:
    block = PythonBlock(name="p", function=lambda t, inputs: {"y": [1, 2, 3]}, outputs={"y": (2,)}, period=STEP)
    diagram = sf.Diagram("one")
    diagram.add(block)
    simulation = sf.Simulation(diagram)
    with pytest.raises(sf.DescriptionError, match="returned something else"):
        simulation.interpret(STEP)
    run = simulation.run(STEP)
    assert run.outcome.kind == "input failed" and "returned something else" in run.outcome.reason
