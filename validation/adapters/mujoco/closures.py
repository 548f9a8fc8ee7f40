"""MuJoCo's equality constraints as it hands them to its solver."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from ...mechanics.geometry import Array


def connections(mjcf: str, q: Array, v: Array) -> tuple[Array, Array, Array]:
    """Of `connect`s: gaps (n, 3) [m], their Jacobian (n, 3, nv), and their rates (n, 3), in world axes.

    Args:
        mjcf: A model without other constraints.
        q: Positions (nq).
        v: Speeds (nv).
    """
    m: Any = mujoco.MjModel.from_xml_string(mjcf)
    m.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    d: Any = mujoco.MjData(m)
    d.qpos[:], d.qvel[:] = q, v
    mujoco.mj_forward(m, d)
    J = np.array(d.efc_J).reshape(-1, m.nv)[: 3 * m.neq]
    return np.array(d.efc_pos[: 3 * m.neq]).reshape(-1, 3), J.reshape(-1, 3, m.nv), (J @ v).reshape(-1, 3)
