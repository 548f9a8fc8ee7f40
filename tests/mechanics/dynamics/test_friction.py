"""The law of smooth friction (docs/theory/rigid.md, (56) to (58)), for random numbers."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import symofros as sf
from symofros.base.smoothed_sign import smoothed_sign

ROUNDING = 1e-12


def slider(friction: sf.Friction | sf.Stop, *parameters: sf.Parameter) -> sf.Model:
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(friction,))
    body = sf.RigidBody("block", joint, sf.Inertia(1.0))
    return sf.compile(sf.System("slider", (body,), parameters), sf.Options(backend="interpreter"))


@cache
def stated_by_parameters() -> sf.Model:
    friction = sf.Friction("c", "s", "v0", "d", "w")  # type: ignore[arg-type]
    values = {"c": 1.0, "s": 2.0, "v0": 1e-3, "d": 0.0, "w": 1e-2}
    return slider(friction, *(sf.Parameter(name, value) for name, value in values.items()))


def forces(m: sf.Model, v: np.ndarray) -> np.ndarray:
    """Against the motion (n), at speeds (n)."""
    return -m.generalized_force(np.zeros((len(v), 1)), v[:, np.newaxis], np.zeros(0))[:, 0]


def levels(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high).map(lambda exponent: float(10.0**exponent))


@settings(max_examples=60, deadline=None)
@given(s=levels(-6, 6), share=st.floats(0.0, 1.0), v0=levels(-6, 1), ratio=levels(-4, 4))
def test_the_maximum_is_static_friction_whatever_the_ratios(s: float, share: float, v0: float, ratio: float) -> None:
    c, w = share * s, ratio * v0
    m = stated_by_parameters().with_parameters(c=c, s=s, v0=v0, w=w)
    peak = min(15 / 8 * v0, 1.5 * w)
    rise, fall = np.linspace(0.0, peak, 201), peak + w * np.linspace(0.0, 7.0, 201)
    up, down = forces(m, rise), forces(m, fall)
    assert up.max() == pytest.approx(s, rel=ROUNDING) and down.max() == pytest.approx(s, rel=ROUNDING)
    assert up[-1] == pytest.approx(s, rel=ROUNDING) and up[0] == 0.0
    # It rises all the way, most steeply at rest, and falls all the way.
    assert np.all(np.diff(up) > -ROUNDING * s) and np.all(np.diff(down) < ROUNDING * s)
    assert np.diff(up).max() == pytest.approx(up[1], rel=1e-3)
    assert down[-1] == pytest.approx(c, abs=ROUNDING * s)
    assert np.array_equal(forces(m, -rise), -up) and np.array_equal(forces(m, -fall), -down)
    slope = (15 * s / peak - 2 * (s - c) * peak / w**2) / 8
    assert forces(m, np.array([1e-9 * peak]))[0] == pytest.approx(1e-9 * peak * slope, rel=1e-9)


@settings(max_examples=40, deadline=None)
@given(share=st.floats(0.0, 1.0), ratio=levels(-1, 2))
def test_the_curvature_is_the_same_on_both_sides_of_the_peak(share: float, ratio: float) -> None:
    m = stated_by_parameters().with_parameters(c=share, s=1.0, v0=1.0, w=ratio)
    peak = min(15 / 8, 1.5 * ratio)
    h = 1e-4 * peak
    left, right = (forces(m, peak + side * h * np.arange(3.0)) for side in (-1.0, 1.0))
    bends = [float(x[0] - 2 * x[1] + x[2]) / h**2 for x in (left, right)]
    expected = -2.0 * (1.0 - share) / ratio**2
    # What a second difference on one side is off by.
    assert bends == pytest.approx([expected] * 2, abs=3e-3 * 15 / peak**2)
    assert abs(left[1] - left[0]) < 30.0 * 1e-8 and abs(right[1] - right[0]) < 30.0 * 1e-8  # No slope at the peak.


@pytest.mark.parametrize("static", [None, 0.7])
def test_friction_without_a_peak_is_the_smoothed_sign(static: float | None) -> None:
    m = slider(sf.Friction(0.7, static, 0.01))
    v = np.linspace(-0.05, 0.05, 1001)
    F = forces(m, v)
    np.testing.assert_allclose(F, 0.7 * smoothed_sign(v, 0.01), rtol=1e-15, atol=1e-16)
    assert np.all(np.abs(F)[np.abs(v) > 15 / 8 * 0.01] == 0.7)
    assert forces(m, np.array([1e-9]))[0] == pytest.approx(0.7 * 1e-7, rel=1e-12)


def test_static_below_dynamic_friction_rises_with_speed() -> None:
    F = -forces(slider(sf.Friction(1.0, 0.4, 0.01)), np.linspace(0.0, 1.0, 2001))
    assert np.all(np.diff(F) * np.sign(F[-1]) >= 0.0)
    assert F[-1] == pytest.approx(np.sign(F[-1]), rel=1e-12)
    assert abs(forces(slider(sf.Friction(1.0, 0.4, 0.01)), np.array([15 / 8 * 0.01]))[0]) == pytest.approx(
        0.4, rel=1e-12
    )


def test_a_factor_scales_dry_friction_alone_and_never_drives() -> None:
    """Load, temperature as a state, position; below zero it counts as zero."""
    levels: dict[str, Any] = dict(dynamic=0.7, static=1.1, minimum_velocity=0.02, stribeck_velocity=0.1)
    plain = slider(sf.Friction(**levels))
    friction = sf.Friction(**levels, viscous=0.3, factor="1 + 2*abs(motor) - T + x")
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(friction,))
    system = sf.System("rubs", (sf.RigidBody("block", joint, sf.Inertia(1.0)),), inputs=(sf.Input("motor"),),
                       states=(sf.ForceState("T", "dx^2"),))  # fmt: skip
    m = sf.compile(system, sf.Options(backend="interpreter"))
    v = np.linspace(-0.5, 0.5, 41)
    dry = forces(plain, v)
    for motor, T, x in ((0.5, 0.3, 0.2), (-1.0, 0.0, -0.5), (0.0, 3.0, 0.1)):
        factor = max(1 + 2 * abs(motor) - T + x, 0.0)
        found = -m.generalized_force(np.full((41, 1), x), v[:, None], np.full((41, 1), motor), z=[T])[:, 0]
        np.testing.assert_allclose(found, factor * dry + 0.3 * v, rtol=1e-13, atol=1e-15)
    A, B = m.linearize([0.2], [0.3], [0.5], z=[0.3])
    assert [A[1, 0], A[1, 2], B[1, 0]] == pytest.approx([-k * forces(plain, np.array([0.3]))[0] for k in (1, -1, 2)])
    assert "factor" not in repr(sf.Friction(1.0)) and "name='T'" in repr(sf.Friction(1.0, factor="T"))  # type: ignore[arg-type]
    with pytest.raises(sf.DescriptionError, match="level of parameters"):
        sf.Friction(1.0, sticks=True, factor=2.0)


def test_friction_of_nan_speeds_is_nan() -> None:
    for friction in (sf.Friction(1.0), sf.Friction(1.0, 2.0)):
        assert np.isnan(forces(slider(friction), np.array([np.nan]))[0])


@pytest.mark.parametrize(
    ("entries", "words"),
    [
        ({"minimum_velocity": 0.0}, ("friction minimum_velocity 0", "above zero")),
        ({"minimum_velocity": -0.1}, ("friction minimum_velocity -0.1", "above zero")),
        ({"static": 2.0, "stribeck_velocity": 0.0}, ("friction stribeck_velocity 0", "above zero")),
        ({"dynamic": -1.0}, ("friction dynamic -1", "against the motion")),
        ({"static": -2.0}, ("friction static -2", "against the motion")),
    ],
)
def test_numbers_that_make_no_friction_are_refused(entries: dict[str, float], words: tuple[str, ...]) -> None:
    with pytest.raises(sf.DescriptionError) as caught:
        slider(sf.Friction(**{"dynamic": 1.0} | entries))
    assert all(word in str(caught.value) for word in words), caught.value
    # The same numbers as parameters of a run.
    names = {"dynamic": "c", "minimum_velocity": "v0", "static": "s", "stribeck_velocity": "w"}
    with pytest.raises(sf.SymofrosError) as refused:
        stated_by_parameters().with_parameters(**{names[key]: value for key, value in entries.items()})
    assert all(word in str(refused.value) for word in words), refused.value


@pytest.mark.parametrize(
    ("entries", "said"),
    [
        ({"stiffness": -1.0, "upper": 1.0}, "stop stiffness -1"),
        ({"stiffness": 1.0, "damping": -2.0, "upper": 1.0}, "stop damping -2"),
        ({"stiffness": 1.0, "lower": 1.0, "upper": -2.0}, "stop upper minus lower limit -3"),
    ],
)
def test_numbers_that_make_no_stop_are_refused(entries: dict[str, float], said: str) -> None:
    with pytest.raises(sf.DescriptionError, match=said):
        slider(sf.Stop(**entries))


def test_friction_that_sticks_is_smooth_in_functions_and_of_one_sign_in_its_modes() -> None:
    """As without `sticks` at mode 0; else constant in sign, none where held, (constraints.md, 35)."""
    stated: dict[str, Any] = dict(dynamic=0.7, static=1.1, minimum_velocity=0.02, viscous=0.3, stribeck_velocity=0.1)
    smooth, sticks = slider(sf.Friction(**stated)), slider(sf.Friction(**stated, sticks=True))
    v = np.concatenate([np.linspace(-0.5, 0.5, 101), [0.0]])
    assert sticks.names.par == ("x.mode",) and sticks.names.constraints == ("x.stuck",)
    zeros = np.zeros((len(v), 1))
    a, lam, rank = sticks.constrained_dynamics(zeros, v[:, None], np.zeros((len(v), 0)))
    assert np.array_equal(a, smooth.forward_dynamics(zeros, v[:, None], np.zeros((len(v), 0))))
    assert not lam.any() and not rank.any()
    for mode in (1.0, -1.0, 2.0):
        F = sticks.generalized_force(zeros, v[:, None], np.zeros((len(v), 0)), par=[mode])[:, 0]
        level = 0.7 + (1.1 - 0.7) * np.exp(-((v / 0.1) ** 2))
        expected = np.zeros_like(v) if mode == 2.0 else -mode * level - 0.3 * v
        assert np.abs(F - expected).max() < 1e-15
