"""Wrenches of constraints: their virtual power is that of the multipliers, and statics has closed forms."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS

CLOSED = (
    "four_bar",
    "slider_crank",
    "parallelogram",
    "bricard",
    "stewart",
    "delta",
    "grasp",
    "rolling_disc",
    "sleigh",
    "flexible_slider_crank",
)
G = 9.81


@cache
def model(name: str) -> sf.Model:
    functions = ("closure_wrenches", "constraint_jacobian", "frame_jacobian")
    return sf.compile(MODELS[name], sf.Options(functions=functions, backend="interpreter"))


def ends(system: sf.System, name: str) -> list[tuple[str, str]]:
    """Which frame each side of a constraint is: ("first", frame), ("second", frame)."""
    (constraint,) = (item for item in system.constraints if item.name == name)
    if isinstance(constraint, sf.Closure | sf.Rod):
        anchors = {"first": constraint.first, "second": constraint.second}
    else:
        anchors = {"first": ("world", None), "second": constraint.anchor}  # type: ignore[union-attr]
    return [(side, body if frame is None else f"{body}.{frame}") for side, (body, frame) in anchors.items()]


@pytest.mark.parametrize("name", CLOSED)
def test_closure_wrenches_have_the_power_of_the_multipliers(name: str) -> None:
    """G^T lam = the sum of J^T W over the frames of every constraint, on the constraints and off them."""
    m, system = model(name), MODELS[name]
    rng = np.random.default_rng(0)
    q, _ = m.random_state(rng)
    lam = rng.normal(size=m.nc)
    total = np.zeros(m.nv)
    for constraint in system.constraints:
        for side, frame in ends(system, constraint.name):
            total += m.frame_jacobian(frame, q).T @ m.closure_wrench(constraint.name, q, lam, on=side)  # type: ignore[arg-type]
    wanted = m.constraint_jacobian(q).T @ lam
    assert np.abs(total - wanted).max() < 1e-13 * max(1.0, np.abs(wanted).max())


def loaded(constraint: sf.Constraint, joint: sf.Joint, frame: sf.Frame) -> tuple[sf.Model, np.ndarray]:
    """One body of 2 kg with its mass centre at x = 0.3, held; and its multipliers at rest."""
    body = sf.RigidBody("b", joint, sf.Inertia(2.0, (0.3, 0, 0), (0.1, 0.2, 0.3)), [frame])
    m = sf.compile(sf.System("s", [body], constraints=[constraint]), sf.Options(backend="interpreter"))
    return m, m.forward_dynamics(m.neutral(), np.zeros(m.nv), [], multipliers=True)[1]


class TestStatics:
    def test_a_support_carries_its_share_of_the_weight(self) -> None:
        """The support at 1 m carries 0.3 of the weight."""
        rest = sf.Closure("rest", ("world", None), ("b", "end"), ("z",))
        m, lam = loaded(rest, sf.Joint("hinge", "revolute", axis=(0, 1, 0)), sf.Frame("end", (1, 0, 0)))
        assert m.closure_wrench("rest", [0.0], lam) == pytest.approx([0, 0, 0.3 * 2 * G, 0, 0, 0], abs=1e-12)
        # The ground feels it where the support is: 1 m from its own origin.
        down = m.closure_wrench("rest", [0.0], lam, on="first")
        assert down == pytest.approx([0, 0, -0.6 * G, 0, 0.6 * G, 0], abs=1e-12)

    def test_rod_tension_balances_the_weight(self) -> None:
        """A rod at 30 degrees to a bar's end holds the share 0.3 of the weight: T sin 30 = 0.3 m g."""
        x = 1 - np.cos(np.pi / 6)
        hook = sf.RigidBody("hook", None, None, [sf.Frame("eye", (x, 0, 0.5))])
        bar = sf.RigidBody(
            "b",
            sf.Joint("hinge", "revolute", axis=(0, 1, 0)),
            sf.Inertia(2.0, (0.3, 0, 0)),
            [sf.Frame("end", (1, 0, 0))],
        )
        rod = sf.Rod("rod", ("hook", "eye"), ("b", "end"), 1.0)
        m = sf.compile(sf.System("s", [hook, bar], constraints=[rod]), sf.Options(backend="interpreter"))
        _, lam = m.forward_dynamics([0.0], [0.0], [], multipliers=True)
        force = m.closure_wrench("rod", [0.0], lam)[:3]
        along = np.array([-np.cos(np.pi / 6), 0, 0.5])
        assert force == pytest.approx(0.3 * 2 * G / 0.5 * along, rel=1e-12)


def test_a_condition_by_formula_has_no_wrench_on_bodies() -> None:
    slide = sf.RigidBody("b", sf.Joint("x", "prismatic"), sf.Inertia(1.0))
    stated = sf.System("s", [slide], constraints=[sf.Nonholonomic("n", {"dx": 1.0})])
    m = sf.compile(stated, sf.Options(backend="interpreter"))
    with pytest.raises(sf.UnknownNameError, match="conditions by formula have a generalized force"):
        m.closure_wrench("n", [0.0], [0.0])
