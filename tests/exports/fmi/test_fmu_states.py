"""What an FMU keeps between calls, and what it must not: rates, stop time, errors of beams, parameters set aside."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.simulation import FMICallException, instantiate_fmu

import symofros as sf
from tests.exports.cases import PLANAR
from tests.exports.fmi.logs import heard
from tests.exports.fmi.units import LIMP, Unit, exported

SAME = 1e-12
# Differences of fourth order by a relative step of 1e-3.
BY_PARAMETERS = 1e-9
# The planar robot of all exports, whose stiffness and length may be tuned.
TUNED = sf.load(Path(__file__).with_name("tuned.yaml"))


@pytest.fixture(scope="module", params=[pytest.param(2, marks=pytest.mark.slow), 3])
def made(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """System -> an instance of it; each unit is made once."""
    version, known, units = request.param, dict[str, Any](), list[Unit]()

    def make(system: sf.System, cosim: bool, **options: Any) -> Unit:
        if system.name not in known:
            known[system.name] = exported(system, version, tmp_path_factory.mktemp("fmu") / "out", **options)
        units.append(Unit(known[system.name], version, cosim, tmp_path_factory.mktemp("unit")))
        return units[-1]

    yield make
    for unit in units:
        unit.fmu.freeInstance()


def initialising(unit: Unit) -> None:
    if unit.version == 2:
        unit.fmu.setupExperiment(startTime=0.0)
    unit.fmu.enterInitializationMode()


def test_rates_use_the_latest_input(made: Any) -> None:
    """Nothing but the input changes between the calls."""
    unit, model = made(PLANAR, False), sf.compile(PLANAR)
    unit.start()
    unit.continuous()
    for u in (0.0, 0.7, -1.3):
        unit.set("u.q1", u)
        wanted = model.forward_dynamics(model.neutral(), np.zeros(model.nv), [u])
        assert unit.get(*unit.named("der(v.")) == pytest.approx(wanted, rel=SAME, abs=SAME)


def test_rates_after_a_reset_use_the_start(made: Any) -> None:
    """Asked for before anything else is evaluated; the state and the input of before are gone."""
    unit = made(PLANAR, False)
    initialising(unit)
    first = unit.get(*unit.named("der("))
    unit.fmu.exitInitializationMode()
    unit.continuous()
    unit.states(np.full(len(unit.named("q.")) + len(unit.named("v.")), 0.3))
    unit.set("u.q1", 2.0)
    assert np.abs(unit.get(*unit.named("der(")) - first).max() > 0.1
    unit.fmu.reset()
    initialising(unit)
    assert np.array_equal(unit.get(*unit.named("der(")), first)


def test_no_step_exceeds_the_stop_time(made: Any) -> None:
    unit = made(PLANAR, True)
    if unit.version == 2:
        unit.fmu.setupExperiment(startTime=0.0, stopTime=0.025)
        unit.fmu.enterInitializationMode()
    else:
        unit.fmu.enterInitializationMode(startTime=0.0, stopTime=0.025)
    unit.fmu.exitInitializationMode()
    unit.fmu.doStep(0.0, 0.01)
    unit.fmu.doStep(0.01, 0.01)
    with pytest.raises(FMICallException):
        unit.fmu.doStep(0.02, 0.01)
    unit.fmu.doStep(0.02, 0.005)
    unit.fmu.reset()
    unit.start()  # Without a stop time.
    unit.fmu.doStep(0.0, 0.05)


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_a_beam_is_judged_again_after_a_reset(made: Any, kind: str) -> None:
    """A run with a remark, after a reset one without, after another one again with it."""
    path = str(made(LIMP, True, method="dopri5").path)
    about, reported = fmpy.read_model_description(path), []
    with heard() as (logger, log):
        unit = instantiate_fmu(fmpy.extract(path), about, fmi_type=kind, logger=logger)
        for g in (0.5, 0.1, 0.5):
            log.clear()
            given: Any = {"start_values": {"par.g": g}, "fmu_instance": unit, "fmi_type": kind}
            fmpy.simulate_fmu(path, stop_time=1.0, output_interval=0.02, logger=logger, **given)
            reported.append([line for line in log if "second-order theory errs" in line])
            unit.reset()
        unit.freeInstance()
    assert reported[0] == reported[2] and len(reported[0]) == 1 and not reported[1]


def test_parameter_derivatives_are_available_during_initialisation(made: Any) -> None:
    """FMI counts them among the knowns of initial unknowns. Parameters are what they were afterwards."""
    unit, model = made(TUNED, False, outputs=["tip"]), sf.compile(TUNED)
    initialising(unit)
    unit.set("q.q1", 0.3)
    unit.set("u.q1", 0.5)
    unknown = [*unit.named("der(v."), *unit.named("p.tip")]
    first = unit.get(*unknown)

    def values(L: float, m: float) -> np.ndarray:
        q, par = [0.3, 0.0], {"L": L, "m": m}
        rates = model.forward_dynamics(q, [0.0, 0.0], [0.5], par=par)
        return np.concatenate([rates, model.frame_pose("tip", q, par=par)[0]])

    h = 1e-4
    by = [
        (values(0.8 + h, 1.5) - values(0.8 - h, 1.5)) / (2 * h),
        (values(0.8, 1.5 + h) - values(0.8, 1.5 - h)) / (2 * h),
    ]
    for known, wanted in zip(("par.L", "par.m"), by, strict=True):
        assert unit.slope(unknown, [known], np.array([1.0])) == pytest.approx(wanted, rel=1e-6, abs=1e-6)
    both = unit.slope(unknown, ["par.L", "par.m", "q.q2"], np.array([2.0, -1.0, 0.4]))
    alone = unit.slope(unknown, ["q.q2"], np.array([0.4]))
    apart = [unit.slope(unknown, [name], np.array([1.0])) for name in ("par.L", "par.m")]
    assert both == pytest.approx(alone + 2.0 * apart[0] - apart[1], rel=BY_PARAMETERS, abs=BY_PARAMETERS)
    assert np.array_equal(unit.get(*unknown), first) and unit.get("par.L")[0] == 0.8
