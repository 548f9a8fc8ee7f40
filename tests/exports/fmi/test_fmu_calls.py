"""Calls of an instance of an FMU: derivatives, saved states, parameters, and calls that are refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from fmpy.simulation import FMICallException

from tests.exports.fmi.units import OWN, SAMPLED, by_version, simulated

# Central differences of a function of size 1 by a step of 1e-6.
DIFFERENCES = 1e-6


@pytest.mark.parametrize(("version", "name"), by_version(*SAMPLED, *OWN))
def test_directional_derivatives_match_the_functions(unit: Any, name: str, rng: np.random.Generator) -> None:
    it = unit(name, cosim=False)
    it.start()
    it.continuous()
    states = it.named("q.") + it.named("v.")
    inputs = it.named("u.")
    unknown = it.named("der(") + it.named("p.")
    # Away from the start, where much is zero; quaternions among the states may be of any length.
    x = it.get(*states) + 0.2 * rng.standard_normal(len(states))
    u = rng.standard_normal(len(inputs))
    turns = [
        k
        for k, label in enumerate(inputs)
        if label.endswith((".qx", ".qy", ".qz", ".qw", ".qx'", ".qy'", ".qz'", ".qw'"))
    ]
    u[turns] /= np.linalg.norm(u[turns]) if turns else 1.0

    def values(x: np.ndarray, u: np.ndarray) -> np.ndarray:
        it.states(x)
        for label, value in zip(inputs, u, strict=True):
            it.set(label, value)
        return it.get(*unknown)

    dx, du, h = rng.standard_normal(len(states)), rng.standard_normal(len(inputs)), 1e-6
    wanted = (values(x + h * dx, u + h * du) - values(x - h * dx, u - h * du)) / (2 * h)
    values(x, u)
    found = it.slope(unknown, states + inputs, np.concatenate([dx, du]))
    assert np.abs(found - wanted).max() < DIFFERENCES * max(1.0, np.abs(wanted).max())


def test_parameters_are_separate_per_instance(unit: Any) -> None:
    one, other = unit("four_bar", cosim=True), unit("four_bar", cosim=True)
    one.set("par.m", 5.0)
    for it in (one, other):
        it.start()
    assert (one.get("par.m")[0], other.get("par.m")[0]) == (5.0, 1.0)
    assert one.get("energy.kinetic")[0] == pytest.approx(5.0 * other.get("energy.kinetic")[0], rel=1e-12)


@pytest.mark.parametrize(("value", "ok"), [(5.0, True), (1e-6, True), (0.0, False), (-5.0, False)])
def test_parameters_that_the_description_refuses_are_refused(unit: Any, value: float, ok: bool) -> None:
    it = unit("four_bar", cosim=True)
    it.set("par.m", value)
    if ok:
        it.start()
        return
    with pytest.raises(FMICallException):
        it.start()


def test_the_condition_that_a_parameter_does_not_meet_is_named(made: Any, version: int) -> None:
    done, log = simulated(str(made("four_bar", version)), stop_time=0.01, start_values={"par.m": -5.0})
    assert done is None and "mass >= 0" in "".join(log), log


def test_calls_forbidden_by_the_standard_are_refused(unit: Any) -> None:
    it = unit("four_bar", cosim=True)
    forbidden = [
        lambda: it.fmu.doStep(0.0, 0.01),  # before initialisation
        lambda: it.get("q.q1"),
        lambda: it.set("der(v.q1)", 1.0),  # calculated
        lambda: it.set("par.m", float("nan")),
        lambda: it.set("lam.'loop.x'", 0.0) if "lam.'loop.x'" in it.references else it.set("time", 1.0),
    ]
    for call in forbidden:
        with pytest.raises(FMICallException):
            call()
    it.start()
    for call in (
        lambda: it.set("q.q1", 0.0),  # a state is not set while it moves
        lambda: it.fmu.doStep(0.5, 0.01),  # not where it is
        lambda: it.fmu.doStep(0.0, -0.01),
        it.fmu.enterInitializationMode,
    ):
        with pytest.raises(FMICallException):
            call()
    it.references["nothing"] = 10_000
    with pytest.raises(FMICallException):
        it.get("nothing")
    it.fmu.doStep(0.0, 0.01)
    it.fmu.terminate()
    with pytest.raises(FMICallException):
        it.fmu.doStep(0.01, 0.01)
    it.fmu.reset()
    it.start()
    it.fmu.doStep(0.0, 0.01)
