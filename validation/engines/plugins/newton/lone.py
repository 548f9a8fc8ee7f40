"""Newton's solvers of bodies with all their coordinates: one body on a joint, and one that a distance holds."""

from __future__ import annotations

from dataclasses import replace

from ...interface import STEP, Slot, Tree, Unsupported
from ..writing.source import Source, Way
from .model import write
from .ways import IMPORTS, QV

# Builders of some releases take a number for gravity, of others a vector.
_WEIGHTLESS = ("m.gravity.zero_()",)
# What iterations leave of constraints, and springs in their place; orientations that go along their rate.
_LEFT, _SOFT = 1e-3, 1e-2
_STEPPED = (
    f"{QV}after, control = m.state(), m.control()\ncontrol.joint_f.assign(tau.astype(np.float32))\n"
    f"newton.solvers.{{solver}}.step(s, after, control, None, {STEP})\n"
)
_READ = (
    "q1, v1 = wp.zeros(m.joint_coord_count, device='cpu'), wp.zeros(m.joint_dof_count, device='cpu')\n"
    "newton.eval_ik(m, after, q1, v1)\nvalue = np.r_[q1.numpy(), v1.numpy()]"
)


def _step(solver: str, slack: float) -> Way:
    """A step, read in the joint's coordinates."""
    return Way(solver.partition("(")[0], _STEPPED.format(solver=solver) + _READ, slack)


_XPBD, _FORCES = "SolverXPBD(m, angular_damping=0.0)", "SolverSemiImplicit(m, angular_damping=0.0)"
WAYS = {
    "step_of_wheel": _step(_XPBD, _SOFT),
    "step_of_wheel:SolverSemiImplicit": _step(_FORCES, _SOFT),
    "step_of_wheel:SolverFeatherstone": Way(
        "SolverFeatherstone",
        _STEPPED.format(solver="SolverFeatherstone(m, angular_damping=0.0)")
        + "value = np.r_[after.joint_q.numpy(), after.joint_qd.numpy()]",
    ),
    "wheel_wrench": Way(
        "SolverXPBD, body_parent_f",
        _STEPPED.format(solver=_XPBD).replace("v.astype", "(0 * v).astype") + "value = after.body_parent_f.numpy()[0]",
        _LEFT,
    ),
    "distance_after_step": Way(
        "SolverXPBD, add_joint_distance",
        "s, after = m.state(), m.state()\nat = np.zeros((1, 7), np.float32)\nat[0, 6] = 1\n"
        "at[0, :3] = (abs(q[0]) + 0.5) * np.array([0.48, 0.6, 0.64])\ns.body_q.assign(at)\ns.body_qd.zero_()\n"
        f"newton.solvers.SolverXPBD(m, iterations=16).step(s, after, None, None, {STEP})\n"
        "value = [np.linalg.norm(after.body_q.numpy()[0, :3])]",
        _LEFT,
    ),
}


def write_wheel(tree: Tree) -> Source | Unsupported:
    """Text that builds a body on its joint, whose state has the wrench of what holds it."""
    made = write(replace(tree, asked="", gravity=Tree("", ()).gravity))
    if isinstance(made, Unsupported):
        return made
    asked = 'hasattr(b, "request_state_attributes") and b.request_state_attributes("body_parent_f")'
    place = next(k for k, line in enumerate(made.lines) if line.startswith("b = ")) + 1
    return replace(made, lines=(*made.lines[:place], asked, *made.lines[place:], *_WEIGHTLESS))


def write_held(tree: Tree) -> Source:
    """Text that builds a body which a distance holds."""
    ((joint,), mass) = tree.links[0].joints, tree.links[0].mass
    least, greatest = joint.limits
    body = f"mass={mass!r}, inertia=wp.mat33({[list(row) for row in tree.links[0].inertia]!r}), lock_inertia=True"
    lines = (
        *IMPORTS,
        "b = newton.ModelBuilder()",
        f"b0 = b.add_link({body})",
        f"b.add_articulation([b.add_joint_distance(-1, b0, min_distance={least!r}, max_distance={greatest!r})])",
        'm = b.finalize(device="cpu")',
        *_WEIGHTLESS,
    )
    return Source(lines, ((Slot("length", (0,), (0,)),),), 1, 1)
