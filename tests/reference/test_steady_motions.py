"""Steady motions against closed forms: a ball on a turntable, a coin, a rattleback, tops, a dual-spin satellite."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import symofros as sf
from tests.models import interpreted
from tests.reference.motion import rotation

# The gravity of every system here that has any.
G = 9.81
CHANGES = "the linearised equations change along this motion"


def turntable(turn: float = 2.0, radius: float = 0.1) -> sf.System:
    """A homogeneous ball that rolls on a plane which turns about the world's z axis."""
    x, y, z, w = (f"o.q{axis}" for axis in "xyzw")
    first = (f"1-2*({y}^2+{z}^2)", f"2*({x}*{y}-{z}*{w})", f"2*({x}*{z}+{y}*{w})")
    second = (f"2*({x}*{y}+{z}*{w})", f"1-2*({x}^2+{z}^2)", f"2*({y}*{z}-{x}*{w})")
    spins, J = [f"o.w{axis}" for axis in "xyz"], "2/5*m*r^2"
    slips = (
        sf.Nonholonomic("x", {"dx": 1} | {v: f"-r*({R})" for v, R in zip(spins, second, strict=True)}, "-turn*y"),
        sf.Nonholonomic("y", {"dy": 1} | {v: f"r*({R})" for v, R in zip(spins, first, strict=True)}, "turn*x"),
    )
    bodies = [
        sf.RigidBody("along", sf.Joint("x", "prismatic", axis=(1, 0, 0))),
        sf.RigidBody("across", sf.Joint("y", "prismatic", "along", axis=(0, 1, 0))),
        sf.RigidBody("ball", sf.Joint("o", "ball", "across"), sf.Inertia("m", moments=(J, J, J))),
    ]
    parameters = [sf.Parameter("m", 1.3), sf.Parameter("r", radius), sf.Parameter("turn", turn)]
    return sf.System("turntable", bodies, parameters, constraints=slips)


ADAPTIVE = {"rtol": 1e-9, "atol": 1e-11}


@pytest.mark.parametrize(
    ("method", "steps", "error"),
    [("rk4", {"dt": 2e-3}, 1e-7), ("dopri5", ADAPTIVE, 1e-7), ("generalized_alpha", {"dt": 2e-3}, 1e-3)],
)
def test_a_ball_on_a_turntable_goes_round_in_circles(method: str, steps: dict[str, float], error: float) -> None:
    """Earnshaw: with 2/7 of the turntable's speed, wherever it starts and however fast."""
    model = sf.compile(turntable())
    start = sf.assemble(model, {"x": 1.0}, {"dx": 0.3, "dy": 0.2}, held=["x", "y"])
    run = sf.simulate(model, start.q, start.v, t_end=6.0, method=method, output=0.5, **steps)
    rate = 2.0 / 7.0 * 2.0
    expected = 1.0 + (0.3 + 0.2j) * np.expm1(1j * rate * run.t) / (1j * rate)
    np.testing.assert_allclose(run["x"] + 1j * run["y"], expected, atol=error)
    assert not run.outcome.notes


def test_modes_of_a_ball_on_a_turntable_are_those_of_its_circles_or_noted() -> None:
    """Away from the axis a ball that stays in place spins about a fixed axis, and its own axes turn under it."""
    model = interpreted(turntable())
    found = sf.modes(model, model.neutral())
    np.testing.assert_allclose(found.frequencies, [0.0, 0.0, 0.0, 4.0 / 7.0], rtol=1e-9)
    assert not found.notes
    stays = sf.equilibrium(model, {"x": 1.0}, {"o.wx": 20.0})
    (note,) = sf.modes(model, stays.q, stays.v).notes
    assert note.startswith(CHANGES)


def coin() -> sf.Model:
    """A thin disc, its yaw, lean and spin one joint each, that rolls."""
    bodies = [
        sf.RigidBody("x", sf.Joint("x", "prismatic", axis=(1, 0, 0))),
        sf.RigidBody("y", sf.Joint("y", "prismatic", "x", axis=(0, 1, 0))),
        sf.RigidBody("z", sf.Joint("z", "prismatic", "y")),
        sf.RigidBody("yaw", sf.Joint("yaw", "revolute", "z")),
        sf.RigidBody("lean", sf.Joint("lean", "revolute", "yaw", axis=(1, 0, 0))),
        sf.RigidBody(
            "disc",
            sf.Joint("spin", "revolute", "lean", rotation=sf.Rotation.rpy(-np.pi / 2, 0, 0)),
            sf.Inertia(1.0, moments=(0.0625, 0.0625, 0.125)),
        ),
    ]
    return interpreted(sf.System("coin", bodies, constraints=[sf.Rolling("roll", ("disc", None), 0.5)]))


def test_zeros_of_a_rolling_coin_that_count_three_times_are_rigid_motions() -> None:
    """Yaw's speed adds up to yaw, and yaw to a shift aside; what is left is the lean, with I_d + m r^2."""
    model = coin()
    for spin in (2.3, 2.8):
        upright = sf.assemble(model, {"z": 0.5}, {"dspin": spin}, held=["yaw", "lean", "spin"])
        found = sf.modes(model, upright.q, upright.v)
        s2 = (G * 0.5 - 0.125 * (0.125 + 0.25) / 0.0625 * spin**2) / (0.0625 + 0.25)
        np.testing.assert_array_equal(found.eigenvalues[:3], 0.0)
        np.testing.assert_allclose(found.eigenvalues[3:] ** 2, s2, rtol=1e-6)
        assert not found.notes


def test_a_coin_that_turns_is_no_steady_motion_of_coordinates_along_the_world() -> None:
    """C Omega w cos(lean) - A Omega^2 sin cos + m g r sin = 0, C at the contact; it goes round, and x, y accelerate."""
    model, lean, turn = coin(), 0.3, 1.5
    w = (0.0625 * turn**2 * np.cos(lean) - G * 0.5) * np.tan(lean) / (0.375 * turn)
    q = np.array([0.0, 0.0, 0.5 * np.cos(lean), 0.0, lean, 0.0])
    spin = w - turn * np.sin(lean)
    moving = sf.assemble(model, q, {"dyaw": turn, "dspin": spin}, held=["yaw", "lean", "spin", "z"])
    a = model.forward_dynamics(moving.q, moving.v, [])
    assert abs(a[4]) < 1e-12 and abs(a[1]) > 1.0
    assert sf.modes(model, moving.q, moving.v).notes
    with pytest.raises(sf.EquilibriumError, match="G v - b = .* at 'roll.slip_x'"):
        sf.equilibrium(model, moving.q, moving.v)
    with pytest.raises(sf.EquilibriumError, match="G a - gamma = .* at 'roll.slip_y'"):
        sf.equilibrium(model, moving.q, moving.v, held=["x", "y", "yaw", "spin"])


# Semi-axes of the rattleback's ellipsoid [m], its mass 1 kg and its inertia, whose axes are turned by 0.05 about z.
AXES, TURN = np.array([0.2, 0.03, 0.02]), rotation(np.array([0.0, 0.0, np.sin(0.025), np.cos(0.025)]))
I_STONE = TURN @ np.diag([1.6e-3, 8e-3, 8.8e-3]) @ TURN.T


def rattleback() -> sf.System:
    """An ellipsoid that rolls on a plane: v + w x r = 0 in its axes, with r = -D^2 n/|D n| and n the vertical."""
    x, y, z, w = (f"o.q{axis}" for axis in "xyzw")
    n = [f"2*({x}*{z}-{y}*{w})", f"2*({y}*{z}+{x}*{w})", f"(1-2*({x}^2+{y}^2))"]
    size = " + ".join(f"{a**2}*({k})^2" for a, k in zip(AXES, n, strict=True))
    r = [f"(-{a**2}*({k})/sqrt({size}))" for a, k in zip(AXES, n, strict=True)]
    rolls = [
        sf.Nonholonomic(f"r{i}", {f"o.v{'xyz'[i]}": 1, f"o.w{'xyz'[j]}": r[k], f"o.w{'xyz'[k]}": f"-{r[j]}"})
        for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
    ]
    moments = (*np.diag(I_STONE), I_STONE[0, 1], 0.0, 0.0)
    stone = sf.RigidBody("stone", sf.Joint("o", "free", position=(0, 0, AXES[2])), sf.Inertia(1.0, moments=moments))
    return sf.System("rattleback", [stone], constraints=rolls)


def stone_rates(t: float, state: np.ndarray) -> np.ndarray:
    """Rates of the vertical and of w in its axes, by moments about the point that touches."""
    n, w = state[:3], state[3:]
    D2n, size, n_rate = AXES**2 * n, np.linalg.norm(AXES * n), np.cross(n, w)
    r, r_rate = -D2n / size, -(AXES**2) * n_rate / size + D2n * (D2n @ n_rate) / size**3
    across = np.cross(r, np.eye(3)).T  # across @ a = r x a
    force = np.cross(r_rate, w) + np.cross(w, np.cross(r, w)) + G * n  # Without r x w'.
    return np.r_[n_rate, np.linalg.solve(I_STONE - across @ across, across @ force - np.cross(w, I_STONE @ w))]


def test_a_rattleback_reverses_a_spin_of_one_sign() -> None:
    """Its rocking along grows with one sign of the spin and decays with the other (Bondi, 1986)."""
    system, start = rattleback(), np.array([0.05, 0.02, -5.0])
    model = interpreted(system)
    growth = [sf.modes(model, model.neutral(), {"o.wz": spin}).eigenvalues.real for spin in (-5.0, 5.0)]
    np.testing.assert_allclose(growth[0], -growth[1], rtol=1e-6, atol=1e-9)
    assert growth[0].max() == pytest.approx(1.951, rel=1e-3)
    v = np.r_[np.cross([0.0, 0.0, -AXES[2]], start), start]
    own = solve_ivp(stone_rates, (0.0, 8.0), np.r_[0.0, 0.0, 1.0, start], "DOP853", rtol=1e-11, atol=1e-12).y[3:, -1]
    run = sf.simulate(sf.compile(system), model.neutral(), v, t_end=8.0, method="dopri5", rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(run.v[-1, 3:], own, atol=1e-5)
    assert run.v[-1, 5] > 4.0 and not run.outcome.notes


def test_a_precessing_top_nods_at_its_known_frequency() -> None:
    """Omega^2 - 2 m g l cos/A + (m g l/(A Omega))^2, A about the point; its angles have rigid motions and no others."""
    mgl, A, C, lean, spin = G * 0.4, 0.18, 0.03, 0.5, 60.0
    bodies = [
        sf.RigidBody("precession", sf.Joint("psi", "revolute")),
        sf.RigidBody("nutation", sf.Joint("theta", "revolute", "precession", axis=(1, 0, 0))),
        sf.RigidBody("top", sf.Joint("phi", "revolute", "nutation"), sf.Inertia(1.0, (0, 0, 0.4), (0.02, 0.02, C))),
    ]
    model = interpreted(sf.System("top", bodies))
    turn = (C * spin - np.sqrt((C * spin) ** 2 - 4 * A * np.cos(lean) * mgl)) / (2 * A * np.cos(lean))
    steady = sf.equilibrium(model, [0, lean, 0], [turn, 0, spin - turn * np.cos(lean)], held=["psi", "phi"])
    assert steady.q[1] == pytest.approx(lean, rel=1e-9)
    found = sf.modes(model, steady.q, steady.v)
    nods = np.sqrt(turn**2 - 2 * mgl * np.cos(lean) / A + (mgl / (A * turn)) ** 2)
    np.testing.assert_allclose(found.eigenvalues, [0.0, 0.0, 1j * nods], rtol=1e-8, atol=1e-9)
    assert not found.notes


def test_a_dual_spin_satellite_nutates() -> None:
    """|H|/I_t less the platform's own spin, in its axes."""
    wheel = sf.RigidBody("wheel", sf.Joint("w", "revolute", "bus"), sf.Inertia(5.0, moments=(0.25, 0.25, 0.5)))
    bus = sf.RigidBody("bus", sf.Joint("f", "free"), sf.Inertia(100.0, moments=(10.0, 10.0, 8.0)))
    model = interpreted(sf.System("satellite", (bus, wheel), gravity=(0, 0, 0)))
    found = sf.modes(model, model.neutral(), {"f.wz": 0.2, "w": 100.0})
    assert found.frequencies[-1] == pytest.approx((8.5 * 0.2 + 0.5 * 100.0) / 10.25 - 0.2, rel=1e-9)
    assert found.damping == pytest.approx(0.0, abs=1e-9) and not found.notes


def test_speeds_that_a_hinge_does_not_allow_are_no_steady_motion() -> None:
    """Hooke's joint at an angle: its second shaft turns too, by 1/cos or cos of the angle, and not steadily."""
    bodies = [
        sf.RigidBody("ground", frames=[sf.Frame("bearing", rotation=sf.Rotation.rpy(0, 0, 0.6))]),
        sf.RigidBody("in", sf.Joint("a", "revolute", axis=(1, 0, 0)), sf.Inertia(1.0, moments=(0.01, 0.02, 0.02))),
        sf.RigidBody(
            "out",
            sf.Joint("u", "universal", "in", axis=(0, 1, 0), axis2=(0, 0, 1)),
            sf.Inertia(1.0, moments=(0.03, 0.02, 0.02)),
        ),
    ]
    bearing = sf.Closure("bearing", ("ground", "bearing"), ("out", None), (), ("y", "z"))
    model = interpreted(sf.System("hooke", bodies, constraints=[bearing], gravity=(0, 0, 0)))
    state = sf.assemble(model, [0, 0, 0.6], {"a": 1.0}, held=["a"])
    along = np.array([np.cos(0.6), np.sin(0.6), 0.0])
    assert model.frame_velocity("out", state.q, state.v)[3:] @ along == pytest.approx(1.0 / np.cos(0.6), rel=1e-9)
    for analyse in (sf.equilibrium, sf.modes, sf.state_space):
        with pytest.raises(sf.SymofrosError, match="violates its constraints\n  found:  G v - b"):
            analyse(model, state.q, [1.0, 0.0, 0.0])
    with pytest.raises(sf.AssemblyError, match="violates its constraints\n  found:  phi"):
        sf.modes(model, state.q + 0.1)
