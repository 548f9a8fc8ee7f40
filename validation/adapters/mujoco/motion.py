"""MuJoCo through time: its own integrators and soft constraints, timed by the processor, one motion or many."""

from __future__ import annotations

import time
from dataclasses import dataclass
from time import process_time
from typing import Any

import mujoco
import numpy as np
from mujoco import rollout

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
    m = held(engine, targets, stiffness, damping)
    m.opt.integrator, m.opt.timestep = INTEGRATORS["RK4"], h
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
