"""MuJoCo through time with any of its integrators, timed: of the processor, and stepping only."""

from __future__ import annotations

import time
from typing import Any

import mujoco
import numpy as np

from ...mechanics.geometry import Array
from .tree import quiet

INTEGRATORS = {
    "Euler": mujoco.mjtIntegrator.mjINT_EULER,
    "implicit": mujoco.mjtIntegrator.mjINT_IMPLICIT,
    "implicitfast": mujoco.mjtIntegrator.mjINT_IMPLICITFAST,
    "RK4": mujoco.mjtIntegrator.mjINT_RK4,
}


def held(engine: Any, targets: Array, stiffness: float, damping: float) -> Any:
    """MuJoCo's model of a tree of hinges, with a spring and a damper on each joint.

    Args:
        engine: Engine of `validation.adapters.mujoco.tree`.
        targets: Coordinates at which the springs rest, in our convention (nq).
        stiffness: Stiffness of each [N m/rad].
        damping: Damping of each [N m s/rad].
    """
    m = engine.model
    m.jnt_stiffness[:], m.dof_damping[:] = stiffness, damping
    m.qpos_spring[:] = engine.chart.coordinates(targets[None])[0]
    return m


def loaded(mjcf: str) -> Any:
    """A model from its text."""
    return mujoco.MjModel.from_xml_string(mjcf)


def stepped(m: Any, integrator: str, h: float, q0: Array, v0: Array, times: int, between: int) -> tuple[Array, float]:
    """Step a model and read its positions now and then.

    Args:
        m: Model.
        integrator: One of INTEGRATORS.
        h: Step [s].
        q0: MuJoCo's positions at the start (nq).
        v0: First speeds (nv).
        times: Number of readings, the start not counted.
        between: Steps from one reading to the next, taken by one call.

    Returns:
        Positions (times + 1, nq), and seconds of the processor for the steps.
    """
    m.opt.integrator, m.opt.timestep = INTEGRATORS[integrator], h
    d: Any = mujoco.MjData(m)
    d.qpos[:], d.qvel[:] = q0, v0
    q = np.empty((times + 1, m.nq))
    q[0] = q0
    seconds = 0.0
    with quiet():
        began = time.thread_time()
        for k in range(1, times + 1):
            mujoco.mj_step(m, d, between)
            q[k] = d.qpos
        seconds = time.thread_time() - began
    return q, seconds
