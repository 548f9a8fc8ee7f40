"""Scenes of features (`models.covering`) by Newton's reader, as its MuJoCo solver states them to MuJoCo."""

from __future__ import annotations

from ...interface import SINGLE, Tree, Unsupported
from ..mujoco import covered
from ..writing.source import Source
from .ways import IMPORTS

# Weight, steps and what ends iterations are the solver's own, which the file does not state to it.
# Its solver's servos at joints come first.
_STEPPED = """def stepped(m, given):
    b = newton.ModelBuilder()
    newton.solvers.SolverMuJoCo.register_custom_attributes(b)
    b.add_mjcf(TEXT)
    n = newton.solvers.SolverMuJoCo(b.finalize(device="cpu"), use_mujoco_cpu=True).mj_model
    n.opt.timestep, n.opt.tolerance, n.opt.iterations = m.opt.timestep, 0.0, m.opt.iterations
    gain, held = m.actuator_gainprm[:, 0], -m.actuator_biasprm[:, 1:3]
    is_servo = (gain != 0.0) & (gain == np.where(held[:, 0], held[:, 0], held[:, 1]))
    order = np.argsort(~(is_servo & (m.actuator_trntype == 0) & (m.actuator_dyntype == 0)), kind='stable')
    d = in_c(dict(given, ctrl=given['ctrl'][order]), n)
    return lambda name: getattr(d, name)[np.argsort(order)] if name[:5] == 'actua' else getattr(d, name)"""
# Its solver's model has no sensors, numbers principal axes of inertia as it finds them, and has the mass centres of
# bodies without mass elsewhere.
_UNSTATED = (
    *("scene_ximat", "scene_xipos", "scene_subtree_com"),
    *(f"scene_sensordata_{stage}" for stage in ("pos", "vel", "acc")),
)
WAYS = covered.ways(_UNSTATED)


def write(tree: Tree) -> Source | Unsupported:
    """Text that answers of a scene."""
    if any("cylinder" in one for one in tree.features):
        return Unsupported("cylinders are none of what its reader knows", offered=False)
    return covered.write(tree, "mujoco", SINGLE, "\n".join((*IMPORTS, _STEPPED)))
