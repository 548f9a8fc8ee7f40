"""Parts that are included with parameters of their own, as subsystems with masks are."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros import blocks


def law() -> sf.Diagram:
    """y = limit(gain k u), a formula within a part of the part."""
    inner = sf.Diagram("inner")
    inner.add(blocks.Formula(name="f", formulas={"y": "k*x"}, constants={"k": 3.0}, period=0.1))
    inner.add_inlet("x", "f.x")
    inner.outlets = {"y": "f.y"}
    part = sf.Diagram("law")
    part.add(blocks.Gain(name="g", gain=2.0), u="inner.y")
    part.add(blocks.Saturation(name="limit", low=-1e3, high=1e3), u="g.y")
    part.include("inner", inner)
    part.add_inlet("u", "inner.x")
    part.outlets = {"y": "limit.y"}
    return part


def twice() -> sf.Diagram:
    """Two laws from one part: one with other numbers, one on a condition and within limits."""
    whole = sf.Diagram("twice")
    whole.add(blocks.Constant(name="one", value=1.0))
    whole.include("left", law(), None, None, {"g.gain": 5.0, "inner/f.k": -1.0}, u="one")
    condition = sf.Condition(enabled="one")
    whole.include("right", law(), None, condition, {"inner/f.k": 7.0, "limit.high": 4.0, "limit.low": 3.5}, u="one")
    whole.include("plain", law(), u="one")
    return whole


def ends(diagram: sf.Diagram, **parameters: Any) -> list[float]:
    run = sf.Simulation(diagram).interpret(0.2, dt=0.1, parameters=parameters)
    return [float(run[f"{part}.y"][-1]) for part in ("left", "right", "plain")]


def test_a_part_has_the_parameters_that_it_is_included_with(tmp_path: Path) -> None:
    """Those of parts within it, too, and on conditions; runs change them, and a file keeps them."""
    assert ends(twice()) == [-5.0, 4.0, 6.0]
    assert ends(twice(), **{"left/inner/f.k": 2.0, "right/limit.high": 3.8}) == [10.0, 3.8, 6.0]
    sf.save_diagram(twice(), tmp_path / "twice.yaml")
    read = sf.load_diagram(tmp_path / "twice.yaml")
    assert ends(read) == [-5.0, 4.0, 6.0]
    assert read.parts["left"].parameters == {"g.gain": 5.0, "inner/f.k": -1.0}
    assert read.parts["left"].diagram.blocks["g"].gain == 2.0  # type: ignore[attr-defined]


def test_models_of_parts_have_parameters_of_their_own() -> None:
    """Two pendulums of other lengths from one part, beside the model alone; models of the whole keep theirs."""
    part = sf.Diagram("swing")
    part.add_model("arm", MODELS["pendulum"], start={"q": 0.3})
    part.add(blocks.ForwardDynamics(name="arm", model="arm"))
    part.outlets = {"q": "arm.q"}
    whole = sf.Diagram("two")
    whole.include("short", part, parameters={"arm.L": 0.5})
    whole.include("long", part, None, None, {"arm.L": 2.0})
    moved = sf.Simulation(whole).run(1.0, dt=1e-3, record=0.1)
    for name, length in (("short", 0.5), ("long", 2.0)):
        model = sf.compile(MODELS["pendulum"]).with_parameters(L=length)
        alone = sf.simulate(model, [0.3], t_end=1.0, dt=1e-3, output=0.1)
        assert np.abs(moved[f"{name}.q"] - alone.q).max() < 1e-12
    whole = sf.Diagram("shared")
    whole.add_model("mine", MODELS["pendulum"])
    with pytest.raises(sf.DescriptionError, match=r"no parameter 'arm.L'(.|\n)*own models: none"):
        whole.include("swing", part, {"arm": "mine"}, None, {"arm.L": 2.0})


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [
        ("g.gein", 1.0, "did you mean 'g.gain'"),
        ("g.gain", "much", "finite"),
        ("g.gain", [1.0, np.nan], "finite"),
        ("limit.low", 2e3, "part 'p': block 'limit': low is above high"),
    ],
)
def test_parameters_that_a_part_lacks_or_refuses_are_refused(name: str, value: Any, says: str) -> None:
    with pytest.raises(sf.DescriptionError, match=says):
        sf.Diagram("whole").include("p", law(), parameters={name: value})
