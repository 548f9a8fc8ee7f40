"""FMUs of models whose forces have states, by FMPy: the last speeds are those (docs/theory/states.md, section 1)."""

from __future__ import annotations

from functools import cache
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

import symofros as sf
from tests.exports.fmi.units import exported

_DRIVE: Any = {"dx": "4*sin(9*t)"}
_ELEMENTS = sf.LuGre(2.0, 3e3, 20.0, static=3.0, stribeck_velocity=0.05), sf.Hysteresis(80.0, 0.5, 2.0)
_START = {"x": 0.1, "dx": 0.4, "x.bristle": 2e-4, "x.slip": -1e-3}
_END = 0.5


@cache
def dragged() -> sf.System:
    """A block that is pulled to and fro on bristles, beside an element that slips."""
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=_ELEMENTS)
    return sf.System(
        "dragged", (sf.RigidBody("b", joint, sf.Inertia(1.5)),), virtual_power=(sf.VirtualPower("drive", _DRIVE),)
    )


def simulated(**settings: Any) -> dict[str, float]:
    run = sf.simulate(sf.compile(dragged()), [0.1], [0.4], _END, z0=[2e-4, -1e-3], **settings)
    ends = run.q[-1, 0], run.v[-1, 0], *run.z[-1]
    return dict(zip(("q.x", "v.x", "v.'x.bristle'", "v.'x.slip'"), ends, strict=True))


@pytest.fixture(scope="module", params=[pytest.param(2, marks=pytest.mark.slow), 3])
def path(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> str:
    return str(exported(dragged(), request.param, tmp_path_factory.mktemp("fmu") / "out", start=_START, dt=1e-3))


def test_a_unit_moves_its_states_as_python_does(path: str) -> None:
    """Co-Simulation by its own steps; Model Exchange by FMPy's CVODE, to its tolerance."""
    assert validate_fmu(path) == []
    settings: dict[str, Any] = {"stop_time": _END, "output_interval": 0.01}
    found = fmpy.simulate_fmu(path, fmi_type="CoSimulation", **settings)
    for name, value in simulated(dt=1e-3).items():
        assert found[name][-1] == pytest.approx(value, rel=1e-10, abs=1e-13), name
    found = fmpy.simulate_fmu(path, fmi_type="ModelExchange", relative_tolerance=1e-9, **settings)
    for name, value in simulated(method="dopri5", rtol=1e-11, atol=1e-13).items():
        assert found[name][-1] == pytest.approx(value, rel=1e-5, abs=1e-8), name


def test_idle_coordinates_of_a_unit_are_integrals_of_its_states(path: str) -> None:
    """Nothing depends on them, and they are what their rates say."""
    found = fmpy.simulate_fmu(path, fmi_type="CoSimulation", stop_time=_END, output_interval=1e-3)
    for name in ("x.bristle", "x.slip"):
        z = found[f"v.'{name}'"]
        assert found[f"q.'{name}.integral'"][-1] == pytest.approx(np.trapezoid(z, dx=1e-3), rel=1e-3), name
