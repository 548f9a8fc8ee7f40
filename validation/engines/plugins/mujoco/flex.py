"""MuJoCo's flexible bodies: two models of one, and what they differ in, as part of what they are."""

from __future__ import annotations

from ...interface import Tree, Unsupported
from ..writing.source import Source

_BODIES = {
    "solid": 'count="3 2 2" dim="3" mass="1"><elasticity young="1e4" poisson="0.2"/>',
    "shell that bends": 'count="3 3 1" dim="2" mass="0.1">'
    '<elasticity young="1e6" poisson="0.2" thickness="0.01" elastic2d="bend"/>',
    "shell that stretches": 'count="3 3 1" dim="2" mass="0.1">'
    '<elasticity young="1e5" poisson="0.2" thickness="0.01" elastic2d="stretch"/>',
    "cable": 'count="5 1 1" dim="1" mass="0.1"><edge stiffness="10" damping="0.1"/>',
}
_EULER, _IMPLICIT = "mjINT_EULER", "mjINT_IMPLICITFAST"
# What is compared, as code of a model's answer, and of the difference between answers.
_RELATIONS = {
    "forces in a turned frame": ("d.qfrc_passive", _EULER, "outcome(TURNED) - first"),
    "step in a turned frame": ("stepped(m, d)", _EULER, "outcome(TURNED) - first"),
    "implicit step in a turned frame": ("stepped(m, d)", _IMPLICIT, "outcome(TURNED) - first"),
    "forces in a shifted frame": ("d.qfrc_passive", _EULER, "outcome(pos='4 -8 16') - first"),
    "sum of forces": ("d.qfrc_passive", _EULER, "first.reshape(-1, 3).sum(axis=0)"),
    "moment of forces": ("d.qfrc_passive", _EULER, "np.cross(vertices(), first.reshape(-1, 3)).sum(axis=0) / 0.1"),
}


def write(tree: Tree) -> Source | Unsupported:
    """Text that makes `difference`, the largest part of the answer by which two models differ."""
    body, _, relation = tree.name.removeprefix("flexible ").partition(": ")
    answer, integrator, apart = _RELATIONS[relation]
    component = f'<flexcomp name="f" type="grid" spacing=".1 .1 .1" radius=".005" {_BODIES[body]}</flexcomp>'
    if "<edge" not in component:
        component = component.replace("<elasticity", '<edge equality="false"/><elasticity')
    lines = f'''import numpy as np
import mujoco as mj
TURNED = "0.8 0.6 0 0"
def made(quat="1 0 0 0", pos="0 0 0"):
    return mj.MjModel.from_xml_string(f"""<mujoco><option gravity="0 0 0" timestep="0.01">
<flag contact="disable"/></option><worldbody>
<body name="p" quat="{{quat}}" pos="{{pos}}">{component}</body></worldbody></mujoco>""")
def placed(m):
    m.opt.integrator, d = mj.mjtIntegrator.{integrator}, mj.MjData(m)
    d.qpos[:], d.qvel[:] = 0.01 * np.sin(np.arange(m.nq) ** 2), 0.1 * np.cos(np.arange(m.nv) ** 2)
    mj.mj_forward(m, d)
    return d
def stepped(m, d):
    before = d.qvel.copy()
    mj.mj_step(m, d)
    return d.qvel - before
def outcome(quat="1 0 0 0", pos="0 0 0"):
    m = made(quat, pos)
    d = placed(m)
    return np.array({answer})
def vertices():
    m = made()
    d = placed(m)
    return d.flexvert_xpos.copy()
def difference():
    first = outcome()
    apart = {apart}
    return np.array([np.max(np.abs(apart)) / np.max(np.abs(first))])'''
    return Source(tuple(lines.split("\n")), ((),), 0, 0)
