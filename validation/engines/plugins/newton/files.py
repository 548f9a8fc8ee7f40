"""Newton's readers of files."""

from __future__ import annotations

from importlib.util import find_spec

from ...interface import Tree, Unsupported
from ..writing.numbering import numbered
from ..writing.source import Source, Way
from .model import builder
from .ways import IMPORTS, ROTATION

READERS = {
    "urdf": "b.add_urdf(TEXT)",
    "mjcf": "b.add_mjcf(TEXT)",
    "usd": "from pxr import Usd\nstage = Usd.Stage.CreateInMemory()\nstage.GetRootLayer().ImportFromString(TEXT)\n"
    # A body on a joint in the world is none of its articulations, of which functions are asked.
    "b.add_usd(stage, apply_up_axis_from_stage=True)\n"
    "b.articulation_count or b.add_articulation(list(range(b.joint_count)))",
}
_CHARTS = {
    ("revolute", ""): "angle",
    ("revolute", "unbounded"): "angle",
    ("prismatic", ""): "length",
    ("ball", ""): "quaternion xyzw, parent speeds",
}


def write_reading(tree: Tree, form: str, text: str) -> Source | Unsupported:
    """Text that has Newton read a file."""
    if any(joint.mimics for link in tree.links for joint in link.joints):
        return Unsupported("what mimics is a constraint of its solvers", offered=False)
    if form == "usd" and find_spec("pxr") is None:
        return Unsupported("OpenUSD is not installed: pip install usd-core", offered=False)
    made = numbered(tree, _CHARTS)
    if isinstance(made, Unsupported):
        return made
    slots, nq, nv = made
    names = [link.name for link in tree.links]
    lines = (
        *IMPORTS,
        f"TEXT = {text!r}",
        builder(tree) if form == "urdf" else "b = newton.ModelBuilder()",
        "newton.solvers.SolverMuJoCo.register_custom_attributes(b)",
        READERS[form],
        'm = b.finalize(device="cpu")',
    )
    labels = f"bodies = [[x.split('/')[-1] for x in m.body_label].index(name) for name in {names!r}]"
    optional = {"rotation": ROTATION, "bodies": (labels,)}
    if tree.sensors:
        optional["sensed"] = (f"sensed = range({len(tree.sensors)})",)
    # Of lengths over sites it keeps the way, not the derivative.
    lacks = ("tendon_arms",) if any(one.kind == "path" for one in tree.tendons) else ()
    return Source(lines, slots, nq, nv, optional, lacks, spelling={"s.body_q.numpy()]": "s.body_q.numpy()[bodies]]"})


# Of all tendons the joints that they sum.
_ARMS = """arms = np.zeros((len(m.mujoco.tendon_stiffness) if hasattr(m.mujoco, 'tendon_joint') else 0, len(v)))
def part(name): return getattr(m.mujoco, 'tendon_' + name).numpy()
for k in range(len(arms)):
    for place in range(part('joint_adr')[k], part('joint_adr')[k] + part('joint_num')[k]):
        arms[k, m.joint_qd_start.numpy()[part('joint')[place]]] += part('coef')[place]
"""
_REACHES = """value = np.zeros((len(m.mujoco.actuator_gear), len(v)))
kinds, targets = m.mujoco.actuator_trntype.numpy(), m.mujoco.actuator_trnid.numpy()[:, 0]
for row, kind, k, gear in zip(value, kinds, targets, m.mujoco.actuator_gear.numpy()):
    if kind == 2: row += gear[0] * arms[k]
    else: row[k] = gear[0]
"""
_SITES = """places, value = m.shape_transform.numpy()[:, :3], []
for pair in m.mujoco.actuator_trnid.numpy():
    value.append(np.ravel([places[k] if k >= 0 else np.full(3, np.nan) for k in pair]))"""


def _field(name: str, what: str = "") -> Way:
    """An array of the attributes that its MuJoCo solver registers."""
    return Way(f"mujoco.{name}", f"value = m.mujoco.{name}.numpy(){what}")


WAYS = {
    "tendon_arms": Way("mujoco.tendon_coef", f"{_ARMS}value = arms"),
    "tendon_stiffnesses": _field("tendon_stiffness"),
    "tendon_dampings": _field("tendon_damping"),
    "tendon_rests": _field("tendon_springlength", "[:, 0]"),
    "tendon_armatures": _field("tendon_armature"),
    "actuator_arms": Way("mujoco.actuator_trnid", _ARMS + _REACHES),
    "actuator_gears": _field("actuator_gear", "[:, 0]"),
    "actuator_gains": _field("actuator_gainprm", "[:, 0]"),
    "actuator_biases": _field("actuator_biasprm", "[:, :3]"),
    "actuator_control_limits": _field("actuator_ctrlrange"),
    "actuator_force_limits": _field("actuator_forcerange"),
    "actuator_sites": Way("mujoco.actuator_trnid", _SITES),
    "weight_shares": _field("gravcomp", "[bodies]"),
    "link_bodies": Way(
        "body_mass, body_com, body_inertia",
        "value = [[mass, *(mass * com), *I[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]] for mass, com, I in zip(\n"
        "    m.body_mass.numpy()[bodies], m.body_com.numpy()[bodies], m.body_inertia.numpy()[bodies])]",
    ),
    "coupled_coefficients": Way(
        "constraint_mimic_coef0, constraint_mimic_coef1, joint_mimic_coeffs",
        "value = np.c_[m.constraint_mimic_coef0.numpy(), m.constraint_mimic_coef1.numpy()]\n"
        "if hasattr(m, 'joint_mimic_joint'):\n"
        "    value = np.r_[value, m.joint_mimic_coeffs.numpy()[m.joint_mimic_joint.numpy() >= 0]]",
    ),
    "joint_drives": Way(
        "joint_target_ke, joint_target_kd",
        "targets = m.joint_target_q if hasattr(m, 'joint_target_q') else m.joint_target_pos\n"
        "value = np.c_[m.joint_target_ke.numpy(), m.joint_target_kd.numpy(), targets.numpy()]",
    ),
}
