"""MuJoCo through time, with its own integrators and its soft constraints."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter
from typing import Any

import mujoco
import numpy as np

from ...mechanics.geometry import Array
from .tree import quiet


@dataclass(frozen=True)
class MujocoMotion:
    """A run.

    Attributes:
        q: Positions at the end (nq).
        v: Speeds at the end (nv).
        energy: Energy at samples on the way (n) [J].
        violation: Largest distance between frames that are to coincide, at those samples [m].
        warning: Warning of the engine; "" if none.
    """

    q: Array
    v: Array
    energy: Array
    violation: float
    warning: str


def move(mjcf: str, q0: Array, v0: Array, t_end: float, samples: int = 200) -> MujocoMotion:
    """Step a model of MJCF text from a state; the loop between samples is MuJoCo's own.

    Args:
        mjcf: Model as MJCF, with its time step and integrator.
        q0: Positions (nq).
        v0: Speeds (nv).
        t_end: Duration, of whole steps [s].
        samples: Number of samples of energy and closures.
    """
    m: Any = mujoco.MjModel.from_xml_string(mjcf)
    d: Any = mujoco.MjData(m)
    d.qpos[:], d.qvel[:] = q0, v0
    steps = round(t_end / m.opt.timestep)
    energy, violation, taken = [], 0.0, 0
    for sample in range(samples + 1):
        due = steps * sample // samples
        if due > taken:
            with quiet():
                mujoco.mj_step(m, d, due - taken)  # What it says is counted by kind in d.warning.
            taken = due
        mujoco.mj_forward(m, d)
        mujoco.mj_energyPos(m, d)
        mujoco.mj_energyVel(m, d)
        energy.append(float(d.energy.sum()))
        if m.neq:
            violation = max(violation, float(np.abs(d.efc_pos[: 3 * m.neq]).max()))
    said = [mujoco.mjtWarning(k).name for k in range(len(d.warning)) if d.warning[k].number]
    return MujocoMotion(np.array(d.qpos), np.array(d.qvel), np.array(energy), violation, ", ".join(said))


def servo(
    engine: Any, q0: Array, v0: Array, targets: Array, stiffness: float, damping: float, h: float, steps: int
) -> tuple[Array, Array, float]:
    """A tree held by a spring and a damper on each joint, stepped by MuJoCo's RK4.

    Args:
        engine: Engine of `validation.adapters.mujoco.tree`, hinges and slides only.
        q0: Our coordinates (nq).
        v0: Our speeds (nv).
        targets: Coordinates at which the springs rest (nq).
        stiffness: Stiffness of each.
        damping: Damping of each.
        h: Step [s].
        steps: Number of steps.

    Returns:
        Our coordinates and speeds at the end, and the seconds that MuJoCo's loop took.
    """
    m = engine.model
    m.opt.integrator, m.opt.timestep = mujoco.mjtIntegrator.mjINT_RK4, h
    m.jnt_stiffness[:], m.dof_damping[:] = stiffness, damping
    m.qpos_spring[:] = engine.chart.coordinates(targets[None])[0]
    d: Any = mujoco.MjData(m)
    d.qpos[:] = engine.chart.coordinates(q0[None])[0]
    d.qvel[:] = engine.chart.speeds(q0[None], v0[None])[0]
    began = perf_counter()
    with quiet():
        mujoco.mj_step(m, d, steps)
    seconds = perf_counter() - began
    # Coordinates of hinges and slides are those of the speeds: the chart's transform reorders both.
    T = engine.chart.transform(q0[None])[0]
    return T.T @ np.array(d.qpos), T.T @ np.array(d.qvel), seconds
