"""What a diagram is compiled with."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.base.options import Options
from symofros.diagrams.program import compiled
from symofros.runtime.build.toolchain import Toolchain
from tests.diagrams.parts import arm, moving, ramp
from tests.simulation.mechanisms import slide


def rising() -> sf.Diagram:
    d = sf.Diagram("ramp")
    d.add(ramp())
    return d


def test_signals_are_compiled_with_the_diagrams_options(monkeypatch: pytest.MonkeyPatch) -> None:
    used: list[Any] = []
    build = compiled.build_library

    def build_library(text: str, header: str, toolchain: Toolchain, flags: tuple[str, ...] | None) -> Path:
        used.append(flags)
        return build(text, header, toolchain, flags)

    monkeypatch.setattr(compiled, "build_library", build_library)
    flags = ("-O1", "-ffp-contract=off")
    run = sf.Simulation(rising(), Options(backend="c", flags=flags)).run(0.02, dt=0.01)
    before = len(used)
    assert run["ramp.y"].shape[1:] == (2,)
    assert len(used) == before + 1 and set(used) == {flags}


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
def test_tapes_have_the_bits_of_c_without_contraction(method: str) -> None:
    """A sampled controller, whose instants are functions of their own, and an arm; nothing is compiled of them."""
    diagram, names = arm(MODELS["double_pendulum"], 2.5e-3, q1=0.3), ("plant.q", "plant.v", "plant.a", "pd.effort")
    exact, tape = Options(backend="c", flags=("-O1", "-ffp-contract=off")), Options(backend="tape")
    ran = [sf.Simulation(diagram, options).run(0.05, method=method, record=1e-3) for options in (exact, tape)]
    assert all(np.array_equal(ran[0][name], ran[1][name]) and np.ptp(ran[0][name]) > 0 for name in names)
    assert sf.Simulation(diagram, tape).compiled.sources == ("", "")


def test_another_backend_is_refused_immediately() -> None:
    simulation = sf.Simulation(rising(), Options(backend="interpreter"))
    with pytest.raises(sf.CompileError, match=r"backend 'interpreter'\n(.*\n)*  remedy: interpret it"):
        _ = simulation.compiled
    assert simulation.interpret(0.02, dt=0.01, compiled=False)["ramp.y"][-1, 1] == pytest.approx(0.04)


def test_parts_know_where_their_forces_bend() -> None:
    model = sf.Simulation(moving(slide(sf.Stop(1e4, upper=0.1)))).compiled.parts[0]
    t, u = np.linspace(0.0, 1.0, 5)[:, np.newaxis], np.zeros((5, model.nu))

    def bends(end: float) -> bool:
        states = {"t": t, "q": end * t, "v": np.full((5, 1), end), "u": u}
        return model.formula_instants.bend([], np.array(model.record.par_default), states)

    assert bends(0.2) and not bends(0.01)
