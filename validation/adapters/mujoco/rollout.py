"""Many motions of one tree by MuJoCo's own loop over trajectories, `mujoco.rollout`."""

from __future__ import annotations

from time import process_time
from typing import Any

import mujoco
import numpy as np
from mujoco import rollout

from ...mechanics.geometry import Array


def roll_out(
    engine: Any,
    q0: Array,
    v0: Array,
    targets: Array,
    stiffness: float,
    damping: float,
    h: float,
    steps: int,
    threads: int = 1,
) -> tuple[Array, float]:
    """Trees held by a spring and a damper on each joint, stepped by RK4.

    Args:
        engine: Engine of `validation.adapters.mujoco.tree`, hinges and slides only.
        q0: Our coordinates (n, nq).
        v0: Our speeds (n, nv).
        targets: Coordinates at which the springs rest (nq).
        stiffness: Stiffness of each.
        damping: Damping of each.
        h: Step [s].
        steps: Number of steps.
        threads: MjData that share the trajectories, a thread each.

    Returns:
        Our coordinates at the end (n, nq), and the processor seconds that the loop took, all threads together.
    """
    m = engine.model
    m.opt.integrator, m.opt.timestep = mujoco.mjtIntegrator.mjINT_RK4, h
    m.jnt_stiffness[:], m.dof_damping[:] = stiffness, damping
    m.qpos_spring[:] = engine.chart.coordinates(targets[None])[0]
    start = np.hstack([np.zeros((len(q0), 1)), engine.chart.coordinates(q0), engine.chart.speeds(q0, v0)])
    states = np.empty((len(q0), steps, start.shape[1]))
    data: list[Any] = [mujoco.MjData(m) for _ in range(threads)]
    with rollout.Rollout(nthread=threads if threads > 1 else 0) as loop:
        began = process_time()
        loop.rollout(m, data if threads > 1 else data[:1], start, nstep=steps, state=states, skip_checks=False)
        seconds = process_time() - began
    # Coordinates of hinges and slides are those of the speeds: the chart's transform reorders both.
    T = engine.chart.transform(q0[:1])[0]
    return states[:, -1, 1 : 1 + m.nq] @ T, seconds
