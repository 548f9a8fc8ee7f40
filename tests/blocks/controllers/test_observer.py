"""Forces from outside, found by momentum: against the filter of the forces that act."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.blocks import Constant, ForwardDynamics, MomentumObserver
from symofros.blocks.controllers.observer import _turning
from symofros.diagrams.tensor import Tensor
from symofros.expr.graph import Graph

_PUSH = np.array([1.5, 0.0, -2.0, 0.0, 0.3, 0.0])
_RATE, _STEP = 40.0, 1e-3
_TIP = "tip"


def felt(system: sf.System, frame: str, start: dict[str, float], **options: float) -> tuple[sf.DiagramRun, np.ndarray]:
    """A run with a wrench unknown to the observer, and the generalized force of it (n, nv)."""
    diagram = sf.Diagram("felt")
    diagram.add_model("m", system, start)
    diagram.add(Constant(name="push", value=_PUSH))
    port = "wrench_" + frame.replace(".", "_")
    diagram.add(ForwardDynamics(name="plant", model="m", perturbed=(frame,)), **{port: "push.y"})
    diagram.add(MomentumObserver(name="seen", model="m", gain=_RATE, **options), q="plant.q", v="plant.v")
    run = sf.Simulation(diagram).run(0.3, dt=_STEP, record=_STEP)
    J = sf.compile(system).frame_jacobian(frame, run["plant.q"])
    return run, np.einsum("nij,i->nj", J, _PUSH)


def filtered(tau: np.ndarray) -> np.ndarray:
    """What a filter of that rate makes of a force that goes straight from sample to sample (n, nv)."""
    out = np.zeros_like(tau)
    x, slope = _RATE * _STEP, np.diff(tau, axis=0)
    e = np.exp(-x)
    for k in range(len(tau) - 1):
        out[k + 1] = e * out[k] + (1.0 - e) * tau[k] + (1.0 - (1.0 - e) / x) * slope[k]
    return out


@pytest.mark.parametrize("name", ["arm", "body"])
def test_an_observer_is_the_filter_of_what_acts(name: str) -> None:
    """Of an arm in motion, and of a tumbling body whose momentum turns in its own axes."""
    if name == "arm":
        run, tau = felt(MODELS["double_pendulum"], _TIP, {"q1": 0.4, "dq1": 1.0, "dq2": -2.0})
    else:
        nose = sf.Frame("nose", (0.3, 0.1, 0.2))
        inertia = sf.Inertia(2.0, (0.05, -0.1, 0.02), (0.2, 0.3, 0.4))
        body = sf.RigidBody("body", sf.Joint("f", "free"), inertia, (nose,))
        start = {"f.vx": 1.0, "f.vz": -0.5, "f.wx": 2.0, "f.wy": 3.0, "f.wz": -1.0}
        run, tau = felt(sf.System("free", (body,)), "nose", start)
    expected = filtered(tau)
    assert np.abs(expected).max() > 0.2
    np.testing.assert_allclose(run["seen.r"], expected, atol=2e-5 * np.abs(tau).max())


def test_a_sampled_observer_follows_it() -> None:
    """To the order of its period."""
    run, tau = felt(MODELS["double_pendulum"], _TIP, {"q1": 0.4, "dq1": 1.0}, period=_STEP)
    assert np.abs(run["seen.r"] - filtered(tau)).max() < 3.0 * _RATE * _STEP * np.abs(tau).max()


@pytest.mark.parametrize("gain", [4.0, 90.0, 3000.0])
def test_a_sampled_observer_is_the_filter_of_a_force_that_stays(gain: float) -> None:
    """r[k] = f (1 - exp(-K T k)) on a mass that nothing else moves, at gains beyond 1 / T, too."""
    slide = sf.RigidBody("mass", sf.Joint("x", "prismatic", axis=(1.0, 0.0, 0.0), actuated=True), sf.Inertia(2.0))
    diagram, T = sf.Diagram("felt"), 0.01
    diagram.add_model("m", sf.System("slider", (slide,), gravity=(0.0, 0.0, 0.0)))
    diagram.add(Constant(name="push", value=[0.7]))
    diagram.add(Constant(name="known", value=[0.0]))
    diagram.add(ForwardDynamics(name="plant", model="m"), u="push.y")
    diagram.add(MomentumObserver(name="seen", model="m", gain=gain, period=T), q="plant.q", v="plant.v", u="known.y")
    run = sf.Simulation(diagram).run(0.2, record=T)
    assert np.abs(run["seen.r"][:, 0] - 0.7 * (1.0 - np.exp(-gain * run.t))).max() < 1e-9


def test_unsuitable_gains_and_mechanisms_of_observers_are_refused() -> None:
    with pytest.raises(sf.DescriptionError, match="gain is out of bounds"):
        MomentumObserver(name="o", model="m", gain=-20.0, period=1e-3)
    diagram = sf.Diagram("bars")
    diagram.add_model("m", MODELS["four_bar"])
    diagram.add(ForwardDynamics(name="plant", model="m"))
    diagram.add(MomentumObserver(name="o", model="m"), q="plant.q", v="plant.v")
    with pytest.raises(sf.DescriptionError, match="a model with constraints"):
        sf.Simulation(diagram)


def test_momentum_in_turning_axes_changes_as_it_does_in_axes_at_rest(rng: np.random.Generator) -> None:
    """Of slides, a ball joint and a free joint: ad_v^T p by differences of momenta that stay in axes at rest."""
    kinds = (("linear", 1), ("quaternion", 3), ("pose", 6), ("linear", 2))
    starts = np.cumsum([0, *(size for _, size in kinds)])
    segments = [SimpleNamespace(kind=kind, v=at, size=n) for (kind, n), at in zip(kinds, starts[:-1], strict=True)]
    v, p, g = *rng.standard_normal((2, int(starts[-1]))), Graph()
    model = SimpleNamespace(segments=segments)
    context: Any = SimpleNamespace(
        environment=SimpleNamespace(model=lambda _: model),
        inputs={"v": Tensor.numbers(g, v)},
        numbers=lambda values: Tensor.numbers(g, values),
    )
    found = np.array([g.number(edge) for edge in _turning(context, "m", Tensor.numbers(g, p)).flat], dtype=float)
    wanted = np.zeros_like(v)
    w, W, V = v[1:4], v[7:10], v[4:7]
    wanted[1:4] = np.cross(p[1:4], w)
    wanted[4:7], wanted[7:10] = np.cross(p[4:7], W), np.cross(p[7:10], W) + np.cross(p[4:7], V)
    np.testing.assert_allclose(found, wanted, atol=1e-14)
    assert found @ v == pytest.approx(0.0, abs=1e-13)  # It does no work.
