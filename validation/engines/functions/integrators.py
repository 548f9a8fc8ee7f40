"""One step of integrators."""

from __future__ import annotations

from collections.abc import Iterable

from ..truth import steps
from .function import Function


def _steps() -> dict[str, Function]:
    """One step of `interface.STEP` from q and v under tau: coordinates, then speeds, after it."""
    after = "q+, v+ (nq + nv) after a step:"
    single, runge_kutta = steps.single, steps.runge_kutta
    rows = {
        "semi_implicit": ("v+ = v + h M^-1 f, f = tau + Q - (bias); q+ where v+ leads in h", single("nothing")),
        "dampers_implicit": ("M + h D in place of M, D of the joints' dampers", single("dampers")),
        "semi_implicit_straight": ("the same with q+ = q + h N(q) v+", single("nothing", steps.straight)),
        "dampers_implicit_straight": ("the same with q+ = q + h N(q) v+", single("dampers", steps.straight)),
        "semi_implicit_normalized": (
            "v+ = v + h M^-1 f, q+ = q + h N(q) v+ with quaternions brought to unit length",
            single("nothing", steps.normalized),
        ),
        "forces_implicit": ("M + h D in place of M, D = -dQ/dv, for lone free bodies -df/dv", single("forces")),
        "velocities_implicit": ("M + h D in place of M, D = -df/dv", single("velocities")),
        "stiffness_implicit": ("v+ = v + h (M + h D + h^2 K)^-1 (f - h K v)", single("stiffness")),
        "stiffness_implicit_straight": ("the same with q+ = q + h N(q) v+", single("stiffness", steps.straight)),
        "stiffness_implicit_lone": ("the same, for lone free bodies D = -df/dv", single("discrete")),
        "euler": ("q+ = q + h N v, v+ = v + h M^-1 f", runge_kutta(steps.EULER)),
        "midpoint": ("the midpoint rule, in coordinates", runge_kutta(steps.MIDPOINT)),
        "rk2": ("Heun's method of order 2, in coordinates", runge_kutta(steps.HEUN)),
        "rk3": ("Kutta's method of order 3, in coordinates", runge_kutta(steps.THIRD)),
        "rk4": ("the classical method of order 4, in coordinates", runge_kutta(steps.CLASSICAL)),
        "trapezoidal": ("the trapezoidal rule for q (flat charts) and v", steps.trapezoidal),
        "rk4_manifold": ("the same, of displacements (Munthe-Kaas)", runge_kutta(steps.CLASSICAL, on_manifold=True)),
    }
    return {f"step_{name}": Function(f"{after} {text}", truth) for name, (text, truth) in rows.items()}


def _derivatives(names: Iterable[str]) -> dict[str, Function]:
    """Derivatives of steps, of trees that forces act on, by where they begin and by forces."""
    acted_on = ("dampers", "springs", "tendons", "actuators")
    made = {}
    for name in names:
        step = STEPS[name].truth
        made[f"{name}_derivative"] = Function(
            "derivative of q+, v+ of that step by q, v along speeds (2 nv, 2 nv)", steps.derivative(step), acted_on
        )
        made[f"{name}_force_derivative"] = Function(
            "derivative of q+ along speeds and v+ of that step by tau (2 nv, nv)", steps.by_forces(step), acted_on
        )
    return made


STEPS = _steps()
STEPS |= _derivatives(
    f"step_{name}"
    for name in (
        *("dampers_implicit", "forces_implicit", "velocities_implicit"),
        *("dampers_implicit_straight", "stiffness_implicit_straight"),
    )
)
STEPS["step_dampers_implicit_control_derivative"] = Function(
    "derivative of q+ along speeds and v+ of that step by the controls (2 nv, nu)",
    steps.by_controls(STEPS["step_dampers_implicit"].truth),
    ("actuators",),
)
