"""MuJoCo through time, with its own integrators and its soft constraints."""

from __future__ import annotations

from dataclasses import dataclass
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
