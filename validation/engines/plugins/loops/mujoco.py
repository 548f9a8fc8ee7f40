"""MuJoCo's equality constraints: connect, weld, joint, and tendons, fixed and spatial."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ...interface import Constraint, End, Tree
from ..writing.source import Way

KINDS = {
    "point": "equality/connect",
    "weld": "equality/weld",
    "coupling": "equality/joint; equality/tendon of a fixed tendon",
    "path": "equality/tendon of a spatial tendon",
}
# As hard as MuJoCo lets a constraint be: it bounds impedances by mjMAXIMP, 0.9999.
_HARD = 'solimp="0.9999 0.9999 0.001"'


def _text(values: Iterable[float]) -> str:
    return " ".join(repr(float(value)) for value in values)


def _site(name: str, end: End) -> str:
    R = np.array(end.R)
    return f'<site name="{name}" pos="{_text(end.p)}" xyaxes="{_text([*R[:, 0], *R[:, 1]])}"/>'


def sites(tree: Tree, link: str) -> str:
    """The sites of a link, "" for the world, that constraints hold."""
    return "".join(
        _site(f"s{number}_{place}", end)
        for number, one in enumerate(tree.constraints)
        if one.kind != "coupling"
        for place, end in enumerate(one.ends)
        if end.link == link
    )


def elements(tree: Tree) -> str:
    """The elements of MJCF that state a tree's constraints, with links' joints named as the links."""
    equalities = [_equality(number, one) for number, one in enumerate(tree.constraints)]
    tendons = [_tendon(number, one) for number, one in enumerate(tree.constraints)]
    stated = f"<tendon>{''.join(tendons)}</tendon>" if any(tendons) else ""
    return f"{stated}<equality>{''.join(equalities)}</equality>" if equalities else ""


def _equality(number: int, one: Constraint) -> str:
    if one.kind in ("point", "weld"):
        name = {"point": "connect", "weld": "weld"}[one.kind]
        return f'<{name} site1="s{number}_0" site2="s{number}_1" {_HARD}/>'
    if _is_joint(one):
        ratio = -one.coefficients[1] / one.coefficients[0]
        first, second = (end.link for end in one.ends)
        return f'<joint joint1="{first}" joint2="{second}" polycoef="0 {ratio!r} 0 0 0" {_HARD}/>'
    return f'<tendon tendon1="t{number}" {_HARD}/>'


def _is_joint(one: Constraint) -> bool:
    """Whether a coupling is one of MuJoCo's between two joints: one coordinate itself, and a multiple of another."""
    return one.kind == "coupling" and len(one.ends) == 2 and one.coefficients[0] == 1.0


def _tendon(number: int, one: Constraint) -> str:
    if one.kind == "path":
        via = "".join(f'<site site="s{number}_{place}"/>' for place in range(len(one.ends)))
        return f'<spatial name="t{number}">{via}</spatial>'
    if one.kind == "coupling" and not _is_joint(one):
        parts = zip(one.ends, one.coefficients, strict=True)
        inside = "".join(f'<joint joint="{end.link}" coef="{coefficient!r}"/>' for end, coefficient in parts)
        return f'<fixed name="t{number}">{inside}</fixed>'
    return ""


def spelling(tree: Tree) -> dict[str, str]:
    """Code of trees whose rows stand along no axes: sums and lengths."""
    if any(one.kind in ("point", "weld") for one in tree.constraints):
        return {}
    return {"axes() @ ": "", " @ axes().T": "", "np.linalg.solve(axes().T, d.efc_force)": "d.efc_force"}


def optional(tree: Tree) -> dict[str, tuple[str, ...]]:
    """Statements that define `axes`: what turns a tree's rows into the first frames' axes, block for block.

    Rows of angles stand there as they are, and are halves: MuJoCo's residual is the sine of half an angle, with the
    sign of the product of the frames' quaternions.
    """
    if not tree.constraints:
        return {}
    blocks = []
    for number, one in enumerate(tree.constraints):
        if one.kind in ("point", "weld"):
            blocks.append(f"d.site_xmat[m.site('s{number}_0').id].reshape(3, 3).T")
            blocks += [f"2 * sign('s{number}_0', 's{number}_1') * np.eye(3)"] * (one.kind == "weld")
        else:
            blocks.append("np.eye(1)")
    lines: list[str] = []
    if any("sign" in block for block in blocks):
        lines += [
            "def turned(name):",
            "    site, quaternion = m.site(name), np.zeros(4)",
            "    mj.mju_mulQuat(quaternion, d.xquat[m.site_bodyid[site.id]], site.quat)",
            "    return quaternion",
            "def sign(a, b): return np.sign(turned(a) @ turned(b))",
        ]
    return {"axes": (*lines, f"def axes(): return block_diag({', '.join(blocks)})", *_BLOCKS)}


_BLOCKS = (
    "def block_diag(*parts):",
    "    n, at = sum(map(len, parts)), 0",
    "    R = np.zeros((n, n))",
    "    for part in parts:",
    "        R[at:at + len(part), at:at + len(part)], at = part, at + len(part)",
    "    return R",
)
# Without stiffness and damping the reference acceleration is what the state alone makes of it.
_SET = "m.eq_solref[:] = 0.0\nm.opt.jacobian, m.opt.tolerance = mj.mjtJacobian.mjJAC_DENSE, 0.0\n"
_AT = f"{_SET}d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau\nmj.mj_forward(m, d)\n"
_J = "J = d.efc_J.reshape(-1, m.nv)\n"

# Constraints are springs by design (MuJoCo's documentation, "Constraint model"): at the largest impedance a regulariser
# of 1e-4 of the inertia that a row sees, by an estimate at the reference configuration, stands beside J M^-1 J^T.
_SOFT = 1e-2
# Far from there the inertia that a row sees is a fraction of the estimate, and forces between redundant rows take the
# weakest direction of J M^-1 J^T, down to a twentieth of its diagonal: 1e-4 becomes some hundredths.
_SOFT_FORCES = 5e-2

WAYS = {
    "constraint_jacobian": Way("efc_J", f"{_AT}{_J}value = axes() @ J"),
    "constraint_velocity_products": Way("-efc_aref", f"{_AT}value = -axes() @ d.efc_aref"),
    "delassus": Way(
        "mj_solveM with efc_J",
        f"{_AT}{_J}X = np.zeros_like(J)\nmj.mj_solveM(m, d, X, J)\nvalue = axes() @ J @ X.T @ axes().T",
    ),
    "constrained_acceleration": Way("mj_forward: qacc", f"{_AT}value = d.qacc", _SOFT),
    "constraint_forces": Way(
        "mj_forward: efc_force", f"{_AT}value = np.linalg.solve(axes().T, d.efc_force)", _SOFT_FORCES
    ),
}
