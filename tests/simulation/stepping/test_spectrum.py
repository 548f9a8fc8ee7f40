"""The spectrum of a mechanism with loops is that of its motion: changes that leave the constraints are none of it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.base.rotations import quaternion_exp, quaternion_product
from symofros.simulation.inputs import plan_inputs
from symofros.simulation.options import SimulationOptions
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.methods import METHODS
from symofros.simulation.stepping.stepper import Stepper
from tests.models import compiled
from tests.simulation.mechanisms import loop

BAR = sf.Inertia(1.0, (0.0, 0.1, -0.5), (0.09, 0.08, 0.02))
# A bar on a ball joint, and what holds the free bar's end in the same place.
HUNG = sf.System("hung", (sf.RigidBody("bar", sf.Joint("b", "ball"), BAR),))
PINNED = sf.System(
    "pinned",
    (sf.RigidBody("bar", sf.Joint("b", "free"), BAR, (sf.Frame("end"),)),),
    constraints=(sf.Closure("pin", ("world", None), ("bar", "end"), ("x", "y", "z")),),
)
STEP = 1e-2


def spectrum(model: sf.Model, q: Any, v: Any, u: Any = None, step: float = STEP) -> Any:
    """Basis, derivative and motion about a state."""
    plan = plan_inputs(model, u)
    settings = Settings.of(model, SimulationOptions(method="rk4", dt=step), 1.0)
    stepper = Stepper(model, METHODS["rk4"], plan, (), model.parameter_values)
    settings.apply(stepper)
    inputs = stepper.inputs_at(0.0, np.asarray(q), np.asarray(v))
    seen = stepper.spectrum(0.0, np.asarray(q), np.asarray(v), inputs, step, 2 * model.nv, stepper.moving)
    assert seen is not None
    return seen


def rates(model: sf.Model, q: Any, v: Any, u: Any = None, step: float = STEP) -> np.ndarray:
    """The rates [1/s] of the modes about a state, in order; slow ones, which rounding hides, left out."""
    seen = spectrum(model, q, v, u, step)
    values = np.linalg.eigvals(seen[1]) / step
    return np.sort_complex(values[np.abs(values) > 1.0])


@pytest.mark.parametrize("speed", [0.0, -3.0, 2.0])
def test_the_motion_of_a_loop_is_that_of_the_state(speed: float) -> None:
    """Of a state just beside the constraints as well: h v and h^2 a of the nearest one on them."""
    model = compiled("slider_crank")
    start = sf.assemble(model, {"turn": 0.6}, {"turn": speed}, held=("turn",))
    a = model.constrained_dynamics(start.q, start.v, np.zeros(model.nu))[0]
    for beside in (0.0, 1e-6):
        basis, _, motion = spectrum(model, start.q + beside, start.v)
        found = basis.T @ motion
        expected = np.concatenate([STEP * start.v, STEP**2 * a])
        np.testing.assert_allclose(found, expected, atol=1e-12 + 1e2 * beside * np.abs(expected).max())


@pytest.mark.parametrize("yaw", [0.7, 2.5])
def test_a_loop_has_the_modes_of_its_tree(yaw: float) -> None:
    """At rest, where modes do not depend on coordinates; turned by some angle about the vertical."""
    tree, loop = sf.compile(HUNG), sf.compile(PINNED)
    tilt = -np.arctan2(0.1, 0.5)  # Its mass centre hangs below the pin.
    q = quaternion_product(quaternion_exp(np.array([0.0, 0.0, yaw])), quaternion_exp(np.array([tilt, 0.0, 0.0])))
    still = np.zeros(3)
    expected = rates(tree, q, still)
    assert np.abs(tree.forward_dynamics(q, still, [])).max() < 1e-12 and len(expected) == 4
    found = rates(loop, np.concatenate([still, q]), np.zeros(6))
    np.testing.assert_allclose(np.sort(found.imag), np.sort(expected.imag), rtol=3e-3)
    np.testing.assert_allclose(found.real, 0.0, atol=3e-3 * np.abs(expected).max())


def test_a_loop_without_freedom_has_no_modes() -> None:
    """A four-bar whose crank is prescribed."""
    bars = {"inertia": lambda length: sf.Inertia(length, (length / 2, 0, 0), (0.1, 0.1, 0.1)), "rows": (("x", "y"), ())}
    driven = loop((0.5, 1.2, 0.8), 1.0, (0, 0, 1), first={"prescribed": True}, gravity=(0, -9.81, 0), **bars)
    model = sf.compile(driven)
    start = sf.assemble(model, {"q2": 0.8, "q3": 1.8}, u=[0.3, 20.0, 0.0])
    law = {"q1": "0.3 + 20*t"}
    assert not len(rates(model, start.q, start.v, law))
    for dt in (0.005, 0.01):
        run = sf.simulate(model, start.q, start.v, 2.0, u=law, method="rk4", dt=dt)
        assert run.outcome.ok and not run.outcome.notes, run.outcome


@pytest.mark.parametrize("method", ["rk4", "generalized_alpha", "rodas4"])
def test_an_overconstrained_mechanism_has_the_modes_of_its_one_freedom(method: str) -> None:
    """Beside its manifold Bricard's conditions have full rank, and would let it move no more."""
    model = compiled("bricard")
    adaptive = False if method == "rodas4" else None
    for dt in (5e-3, 1e-3):
        run = sf.simulate(model, t_end=2.0, method=method, dt=dt, adaptive=adaptive, output=0.02)
        assert run.outcome.ok and not run.outcome.notes, run.outcome
    assert (
        np.abs(rates(model, run.q[50], run.v[50], step=1e-4)).max(initial=0.0) < 10.0
    )  # Those that lock it would be of 1e3 or more.


@pytest.mark.parametrize("spin", [0.0, 1.08e-3, 0.01])
@pytest.mark.parametrize("kind", ["free", "planar"])
def test_a_satellite_in_orbit_has_slow_modes_alone(kind: str, spin: float) -> None:
    """It flies 7.5 km in a step, which turns it by nothing: a radian is no metre. Runs bear no note."""
    mu, radius = 3.986004418e14, 7e6
    x, y = ("s.px", "s.py") if kind == "free" else ("s.x", "s.y")
    body = sf.RigidBody("s", sf.Joint("s", kind), sf.Inertia(500.0, moments=(100.0, 120.0, 90.0)))  # type: ignore[arg-type]
    pull = sf.Potential("g", sf.formula(f"-{mu}*500/sqrt({x}^2 + {y}^2)"))
    model = sf.compile(sf.System("orbit", (body,), gravity=(0, 0, 0), potentials=(pull,)))
    n = np.sqrt(mu / radius**3)
    start = dict(zip(model.names.q, model.neutral(), strict=True)) | {x: radius}
    names = model.names.v
    speeds = {names[1]: radius * n, names[-1]: spin}
    run = sf.simulate(model, start, speeds, t_end=600.0, dt=1.0)
    assert run.outcome.notes == ()
    assert run.q[-1, :2] == pytest.approx(radius * np.array([np.cos(600 * n), np.sin(600 * n)]), abs=2e-3)
    q, v = (np.array([given.get(k, 0.0) for k in keys]) for given, keys in ((start, model.names.q), (speeds, names)))
    seen = spectrum(model, q, v, step=1.0)
    assert np.abs(np.linalg.eigvals(seen[1])).max() < 0.1


@pytest.mark.parametrize("warmth", [1e3, 1e9])
def test_a_state_has_a_scale_of_its_own_whichever_way_it_goes(warmth: float) -> None:
    """Beside a vibration: its rate is its own, and it hides nothing of the motion as it falls or rises fast."""
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(sf.Spring(2.25e6), sf.Damper(0.5)))
    body, state = sf.RigidBody("body", joint, sf.Inertia(1.0)), sf.ForceState("T", sf.formula("-40*T"))
    model = sf.compile(sf.System("warm", (body,), gravity=(0, 0, 0), states=(state,))).carried
    fast, sizes = np.sqrt(2.25e6 - 0.25**2), []
    for sign in (1.0, -1.0):
        x = sign * 1e-5, sign * 1e-3
        _, matrix, motion = spectrum(model, [x[0], 0.0], [x[1], sign * warmth], step=1e-3)
        values = np.linalg.eigvals(matrix) / 1e-3
        wanted = np.array([-40.0, -0.25 - 1j * fast, -0.25 + 1j * fast, 0.0])
        np.testing.assert_allclose(np.sort_complex(values), wanted, atol=1e-4)
        sizes.append(np.linalg.norm(motion))
    of_motion = np.hypot(1e-3 * x[1], 1e-6 * (2.25e6 * x[0] + 0.5 * x[1]))
    assert sizes == pytest.approx([np.sqrt(2.0) * of_motion] * 2, rel=1e-4)  # The state counts as much as the motion.
