"""MJX: MuJoCo in JAX, from MuJoCo's own compiler."""

from __future__ import annotations

from ..interface import Convention, Tree, Unsupported
from . import mujoco
from .writing.source import Source, SourcePlugin, Way

_SETUP = """import jax
jax.config.update("jax_enable_x64", True)
from mujoco import mjx
mx, empty = mjx.put_model(m), mjx.make_data(m)
# Compiled once a tree: kinematics and what rests on them.
def terms(q, v):
    d = mjx.com_vel(mx, mjx.com_pos(mx, mjx.kinematics(mx, empty.replace(qpos=q, qvel=v))))
    return mjx.full_m(mx, mjx.crb(mx, d)), mjx.rne(mx, d).qfrc_bias, d.xpos, d.xmat
terms = jax.jit(terms)
links = [m.body(name).id for name in {links}]"""

WAYS = {
    "mass_matrix": Way("crb, full_m", "value = terms(q, v)[0]"),
    "bias": Way("rne", "value = terms(q, v)[1]"),
    "gravity": Way("rne", "value = terms(q, 0 * v)[1]"),
    "link_poses": Way("kinematics", "p, R = terms(q, v)[2:]\nvalue = [[*p[k], *np.ravel(R[k])] for k in links]"),
}


def write(tree: Tree) -> Source | Unsupported:
    """The text that builds the tree in MuJoCo, and puts it into JAX."""
    source = mujoco.write(tree)
    if isinstance(source, Unsupported):
        return source
    setup = _SETUP.format(links=[link.name for link in tree.links])
    return Source((*source.lines, *setup.split("\n")), source.slots, source.nq, source.nv)


PLUGIN = SourcePlugin(
    name="mjx",
    package="mujoco-mjx",
    extra="symofros[engine-mjx]",
    conventions=(
        Convention("model", "of MuJoCo's compiler; conventions are MuJoCo's"),
        Convention("precision", "single unless JAX is told otherwise"),
    ),
    kinds=mujoco.PLUGIN.kinds,
    ways=WAYS,
    write=write,
    calls=4,
)
