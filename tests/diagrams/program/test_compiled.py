"""What a diagram is compiled with."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import symofros as sf
from symofros.base.options import Options
from symofros.diagrams.program import compiled
from symofros.runtime.build.toolchain import Toolchain
from tests.diagrams.parts import ramp


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
    run = sf.Simulation(rising(), Options(flags=flags)).run(0.02, dt=0.01)
    before = len(used)
    assert run["ramp.y"].shape[1:] == (2,)
    assert len(used) == before + 1 and set(used) == {flags}


def test_another_backend_is_refused_immediately() -> None:
    simulation = sf.Simulation(rising(), Options(backend="interpreter"))
    with pytest.raises(sf.CompileError, match=r"backend 'interpreter'\n(.*\n)*  remedy: interpret it"):
        _ = simulation.compiled
    assert simulation.interpret(0.02, dt=0.01, compiled=False)["ramp.y"][-1, 1] == pytest.approx(0.04)
