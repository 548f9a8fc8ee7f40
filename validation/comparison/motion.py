"""A free motion: the mechanism falls under gravity, and its energy is watched by every engine.

Energy is conserved by the equations, not by an integrator. So two things are kept apart: at each state on the way, our
T + V and another engine's agree to rounding; and our own energy drifts by what a fourth-order method may lose, which
halving the step divides by 2^4. Of the drift's T + V the energy in springs is left out: Q does work on them, and all
of Q's work is counted.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

import symofros as sf

from ..contract.interface import States
from ..mechanics.geometry import Array
from .errors import Comparison

MOTIONS = 4
DURATION = 0.1  # [s]
STEP = 1e-3  # [s]
RECORDED = 50  # States kept of each motion.

# Below this relative drift, rounding rules and halving the step no longer helps: some 1e3 evaluations' worth of eps.
ROUNDING_DRIFT = 1e-11

# A fourth-order method's error falls by 16 when the step is halved: an order of three is asked for, and errors are half
# of what is allowed wherever the order is four. Orders differ from four by less than 0.05 (terms of order five are
# still felt at the coarser step), while a wrong term has the order zero.
HALVING = 8.0

# A drift above this says that the steps are too long for the motion, and so nothing about the order.
RESOLVED = 1e-3

# Then the motion is watched for a shorter time in as many steps: robots' files have dampers that stop light links
# within microseconds, and some (1e11 N s/m) that stand for a brake. A wrong term is found all the same, as its drift
# does not depend on the length of the steps.
SHORTENINGS = tuple(10.0**-k for k in range(10))

# A motor, friction or contact model with a corner in it makes any integrator lose its order, and says nothing of us.
_CORNERS = frozenset({"sign", "abs", "min", "max"})


@dataclass(frozen=True)
class FreeMotion:
    """Free motions from several initial states.

    Attributes:
        states: States on the way, of all motions (N).
        scale: The energy that moves about: largest kinetic energy and largest change of potential energy [J].
        drift: Largest change of T + V less the work done by Q, relative to `scale`, with `step` and with `step` / 2.
        step: Length of the longer steps [s].
    """

    states: States
    scale: float
    drift: tuple[float, float]
    step: float = STEP


def fall(model: sf.Model, q: Array, v: Array, weightless: sf.Model | None = None) -> FreeMotion:
    """Let a model fall from initial states, with zero inputs, with two step lengths.

    Args:
        model: Model with forward_dynamics, generalized_force and the energies.
        q: Initial coordinates (N, nq).
        v: Initial speeds (N, nv).
        weightless: The same without gravity, with potential_energy; None where only the weight has potential energy.
    """
    for shortening in SHORTENINGS:
        motion = _fall(model, q, v, weightless, DURATION * shortening)
        if all(drift <= RESOLVED for drift in motion.drift):
            break
    return motion


def _fall(model: sf.Model, q: Array, v: Array, weightless: sf.Model | None, duration: float) -> FreeMotion:
    # A diverging motion gets a verdict; NumPy's warning adds nothing.
    with np.errstate(over="ignore", invalid="ignore"):
        coarse, fine = (_integrate(model, q, v, weightless, duration, steps) for steps in (_STEPS, 2 * _STEPS))
        scale = max(float(np.ptp(fine.potential, axis=0).max()), float(fine.kinetic.max())) or 1.0
        drift = (float(coarse.drift.max()) / scale, float(fine.drift.max()) / scale)
    return FreeMotion(fine.states, scale, drift, duration / _STEPS)


_STEPS = round(DURATION / STEP)


@dataclass(frozen=True)
class _Run:
    states: States
    kinetic: Array
    potential: Array
    drift: Array


def _integrate(model: sf.Model, q: Array, v: Array, weightless: sf.Model | None, duration: float, steps: int) -> _Run:
    h = duration / steps
    u = np.zeros((len(q), model.nu))
    work = np.zeros(len(q))
    kept = [(q, v, work)]
    for k in range(steps):
        q, v, done = step(model, q, v, u, h)
        work = work + done
        if (k + 1) % (steps // RECORDED) == 0:
            kept.append((q, v, work))
    qs, vs = np.array([state[0] for state in kept]), np.array([state[1] for state in kept])
    kinetic, potential = model.kinetic_energy(qs, vs), model.potential_energy(qs)
    elastic = weightless.potential_energy(qs) if weightless is not None else 0.0 * potential
    balance = kinetic + potential - elastic - np.array([state[2] for state in kept])
    zero = np.zeros((len(qs) * len(q), model.nv))
    no_inputs = np.zeros((len(zero), model.nu))
    states = States(qs.reshape(-1, model.nq), vs.reshape(-1, model.nv), zero, no_inputs, zero, zero)
    return _Run(states, kinetic, potential, np.abs(balance - balance[0]))


def step(model: sf.Model, q: Array, v: Array, u: Array, h: float) -> tuple[Array, Array, Array]:
    """One step of the classical fourth-order method on a manifold.

    Commutator-free, after Celledoni, Marthinsen, Owren, Commutator-free Lie group methods, FGCS 19 (2003) 341-352.
    Weighting the stages' velocities once, as in flat space, would be of second order on rotations.

    Returns:
        q, v after h seconds, and the work that Q did in them.
    """

    def rates(q: Array, v: Array) -> tuple[Array, Array, Array]:
        power = np.sum(model.generalized_force(q, v, u) * v, axis=-1)
        return v, model.forward_dynamics(q, v, u), power

    v1, a1, p1 = rates(q, v)
    q2 = model.integrate(q, h / 2 * v1)
    v2, a2, p2 = rates(q2, v + h / 2 * a1)
    v3, a3, p3 = rates(model.integrate(q, h / 2 * v2), v + h / 2 * a2)
    v4, a4, p4 = rates(model.integrate(q2, h * v3 - h / 2 * v1), v + h * a3)
    q_half = model.integrate(q, h / 12 * (3 * v1 + 2 * v2 + 2 * v3 - v4))
    q_next = model.integrate(q_half, h / 12 * (-v1 + 2 * v2 + 2 * v3 + 3 * v4))
    return q_next, v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4), h / 6 * (p1 + 2 * p2 + 2 * p3 + p4)


def judge_drift(label: str, motion: FreeMotion) -> Comparison:
    """Whether our energy drifts as a fourth-order method's does and no faster."""
    coarse, fine = motion.drift
    if not (math.isfinite(coarse) and math.isfinite(fine)):
        return Comparison(label, "symofros", "energy_drift", "failed", note="the free motion did not stay finite")
    tolerance = min(max(coarse / HALVING, ROUNDING_DRIFT), RESOLVED)
    return Comparison(
        label,
        "symofros",
        "energy_drift",
        "agree" if fine <= tolerance else "disagree",
        len(motion.states),
        fine,
        tolerance,
        note=f"steps of {motion.step:g} and {motion.step / 2:g} s drift by {coarse:.1e} and {fine:.1e}",
        extra={"drift_coarse": coarse, "drift_fine": fine},
    )


def smoothness_obstacle(joints: Sequence[sf.Joint]) -> str:
    """Why no integrator keeps its order on joints with such efforts and elements; "" if they are smooth."""
    used = sorted({kind for joint in joints for formula in joint.effort for kind in operations(formula)} & _CORNERS)
    bent = sorted({corner for joint in joints for element in joint.elements if (corner := _corner(element))})
    if not used and not bent:
        return ""
    where = f"an effort uses {', '.join(used)}" if used else f"a joint has {', '.join(bent)}"
    return f"{where}: no integrator keeps its order across a corner"


def _corner(element: object) -> str:
    """Name of a joint element whose force has a corner, possibly rounded within a step; "" for others."""
    if isinstance(element, sf.Damper):
        return "a quadratic damper" if element.quadratic != 0.0 else ""
    return {sf.Stop: "a stop", sf.Friction: "dry friction"}.get(type(element), "")


def operations(formula: sf.Expression | float) -> frozenset[str]:
    """The operations that a formula uses."""
    if not isinstance(formula, sf.Expression):
        return frozenset()
    return frozenset({formula.kind}).union(*(operations(arg) for arg in formula.args))
