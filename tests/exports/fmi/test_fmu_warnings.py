"""What FMUs log or refuse in a run: beams beyond their theory, quaternions of another length."""

from __future__ import annotations

import math
import re
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import fmpy
import numpy as np
import pytest

import symofros as sf
from tests.exports.fmi.units import ONE_VERSION, VERSIONS, exported, simulated
from tests.simulation.beam_models import at_rest


@pytest.mark.parametrize("version", ONE_VERSION)
@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_beams_beyond_their_theory_are_reported(made: Any, version: int, kind: str) -> None:
    """A warning from 1 % on; beyond the limit a step of Co-Simulation is discarded, and Model Exchange is ended."""
    remarks: dict[float, list[str]] = {}
    ends: dict[float, float] = {}
    for g in (0.2, 0.5, 60.0):
        given = {"stop_time": 1.0, "output_interval": 0.01, "start_values": {"par.g": g}}
        run, log = simulated(str(made("limp", version)), fmi_type=kind, **given)
        ends[g] = math.nan if run is None else float(run["time"][-1])
        remarks[g] = [line for line in log if "second-order theory errs" in line]
    assert not remarks[0.2] and ends[0.2] == pytest.approx(1.0)
    assert len(remarks[0.5]) == 1 and "'blade'" in remarks[0.5][0] and ends[0.5] == pytest.approx(1.0)
    assert remarks[60.0] and not ends[60.0] == pytest.approx(1.0)


@pytest.mark.parametrize("version", ONE_VERSION)
@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_logs_report_the_error_of_beam_theory_at_rest(made: Any, version: int, kind: str) -> None:
    """Axial loads count, at the present length."""
    for share, L in ((0.95, 1.0), (0.9, 0.1), (0.8, 1.0), (-5.0, 10.0)):
        model, rest = at_rest(share, L)
        start = {f"par.{name}": value for name, value in model.parameters.items()}
        start |= {f"q.'{name}'": value for name, value in zip(model.names.q, rest.q.tolist(), strict=True)}
        given = {"stop_time": 0.1 * L**2, "output_interval": 0.005 * L**2, "start_values": start}
        run, log = simulated(str(made("column", version)), fmi_type=kind, **given)
        assert run is not None
        stated = [re.search(r"errs by about ([\d.]+) %", line) for line in log if "second-order theory errs" in line]
        wanted = [100.0 * rest.bendings[0].error] if rest.bendings[0].error > 0.01 else []
        assert [float(match[1]) for match in stated if match] == pytest.approx(wanted, rel=0.05)


@pytest.mark.parametrize("scale", [0.0, 2.0, -1e150, 1.0 + 1e-6])
def test_start_quaternions_are_normalised_or_refused(made: Any, scale: float) -> None:
    """A start of another length is refused in words; one of few digits is a rotation."""
    path = str(made("floating", VERSIONS["floating"]))
    start = {name: scale * value for name, value in quaternion_start(path).items()}
    run, log = simulated(path, stop_time=0.01, output_interval=0.005, start_values=start)
    if abs(scale - 1.0) < 1e-3:
        assert len(run) == 3
    else:
        assert run is None and any("no rotation" in line for line in log)


@pytest.mark.parametrize("version", ONE_VERSION)
@pytest.mark.parametrize("given", [0.7, None])
def test_a_start_that_constraints_move_is_logged(made: Any, version: int, given: float | None) -> None:
    """The crank alone was turned: the loop was closed elsewhere, without a word."""
    path = str(made("four_bar", version))
    start = {} if given is None else {"q.q1": given}
    run, log = simulated(path, stop_time=0.01, output_interval=0.005, start_values=start)
    assert len(run) == 3
    moved = [line for line in log if "does not meet the constraints and was moved onto them: 'q" in line]
    assert len(moved) == (given is not None)


def test_a_start_is_moved_by_a_share_of_its_mechanism(tmp_path: Path) -> None:
    """A crank of 2 mm, its slider half a millimetre off: less than what was said, of any mechanism."""
    inertia, pin = sf.Inertia(1e-3, moments=(1e-9, 1e-9, 1e-9)), (sf.Frame("pin", (2e-3, 0, 0)),)
    crank = sf.RigidBody("crank", sf.Joint("turn", "revolute", axis=(0, 0, 1)), inertia, frames=pin)
    slider = sf.RigidBody("slider", sf.Joint("slide", "prismatic", axis=(1, 0, 0)), inertia)
    yoke = sf.Closure("yoke", ("slider", None), ("crank", "pin"), ("x",))
    small = sf.System("small", (crank, slider), constraints=(yoke,))
    path = str(exported(small, 3, tmp_path / "fmu", start={"turn": 1.0, "slide": 2e-3 * math.cos(1.0)}))
    for off in (1e-6, 5e-4):
        start = {"q.slide": 2e-3 * math.cos(1.0) + off}
        _, log = simulated(path, stop_time=0.01, output_interval=0.005, start_values=start)
        assert any("was moved onto them" in line for line in log) == (off > 1e-5)


def bounced(**options: Any) -> tuple[float, list[str]]:
    """Error of the heights of a ball on a stop of 1e5 N/m in Co-Simulation, relative to their range, and the log."""
    stop = sf.Stop(1e5, lower=0.0)
    ball = sf.RigidBody(
        "ball", sf.Joint("z", "prismatic", axis=(0, 0, 1), elements=(stop,)), sf.Inertia(1.0, moments=(1, 1, 1))
    )
    system = sf.System("bouncing", (ball,), gravity=(0, 0, -9.81))
    with TemporaryDirectory() as folder:
        path = str(exported(system, 3, Path(folder) / "fmu", start={"z": 0.1}, **options))
        run, log = simulated(path, fmi_type="CoSimulation", stop_time=1.0, output_interval=0.01)
    exact = sf.simulate(sf.compile(system), [0.1], t_end=1.0, output=0.01, method="dop853", rtol=1e-11, atol=1e-13)
    return float(np.abs(run["q.z"] - exact.q[:, 0]).max() / np.ptp(exact.q)), log


def test_steps_without_a_stated_length_follow_from_the_model() -> None:
    """By default steps of 1 ms met the stop: 2.2 % off, in silence."""
    error, log = bounced()
    assert error < 2e-3 and not log


@pytest.mark.parametrize("dt", [1e-3, 1e-4])
def test_steps_that_are_too_long_are_logged(dt: float) -> None:
    """They were made in silence; steps of a tenth are not too long."""
    error, log = bounced(dt=dt)
    said = [line for line in log if f"steps of at most {dt:.3g} s do not determine the motion" in line]
    assert (error > 0.02) == (len(said) == 1) == (dt == 1e-3) and len(log) == len(said)


def test_a_variable_that_is_not_set_is_named(made: Any) -> None:
    """ "not allowed in this mode, or not a legal value" named neither the variable nor which of the two it was."""
    path = str(made("four_bar", 3))
    first = next(v for v in fmpy.read_model_description(path).modelVariables if v.name.startswith("q."))
    run, log = simulated(path, stop_time=0.01, start_values={first.name: math.nan})
    words = f"value reference {first.valueReference} is not set to nan: values are finite"
    assert run is None and any(words in line for line in log)


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
@pytest.mark.parametrize("length", [0.0, 1.01, -1.0])
def test_input_quaternions_are_normalised_or_refused(made: Any, kind: Any, length: float) -> None:
    path = str(made("turned", 3))
    inputs = [v.name for v in fmpy.read_model_description(path).modelVariables if v.causality == "input"]
    (last,) = (name for name in inputs if name.rstrip("'").endswith("qw"))
    run, log = simulated(path, fmi_type=kind, stop_time=0.01, output_interval=0.005, start_values={last: length})
    if length == -1.0:
        assert len(run) == 3
    else:
        assert run is None
        assert any("inputs that prescribe a motion" in line and "no rotation" in line for line in log)


def quaternion_start(path: str) -> dict[str, float]:
    """Start values of the components of quaternions."""
    variables = fmpy.read_model_description(path).modelVariables
    ends = ("qx'", "qy'", "qz'", "qw'")
    return {v.name: float(v.start) for v in variables if v.name.startswith("q.") and v.name.endswith(ends)}
