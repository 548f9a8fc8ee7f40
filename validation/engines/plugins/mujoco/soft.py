"""MuJoCo's limits and dry friction: accelerations by each solver, forces by fields, products and the inverse."""

from __future__ import annotations

from ..writing.source import Way, ways_of
from .forces import COPY

_SET = "d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau\n"
# What is left of a residual where iterations stop.
_ITERATED = 1e-6


def _solver(name: str, jacobian: str) -> str:
    options = f"n.opt.solver, n.opt.jacobian = mj.mjtSolver.mjSOL_{name}, mj.mjtJacobian.mjJAC_{jacobian}\n"
    options += "n.opt.tolerance, n.opt.iterations = 0.0, 500\n"
    return f"{COPY}{options}{_SET}d.qacc_warmstart[:] = 0\nmj.mj_forward(n, d)\n"


_NEWTON = _solver("NEWTON", "DENSE")
WAYS = {
    f"limited_acceleration{way}": Way(
        f"mj_forward, {name}, {jacobian}",
        f"{_solver(name, jacobian)}value = d.qacc",
        0.0 if name == "NEWTON" else _ITERATED,
    )
    for way, name, jacobian in (
        ("", "NEWTON", "DENSE"),
        (":sparse", "NEWTON", "SPARSE"),
        (":conjugate gradients", "CG", "DENSE"),
        (":projected Gauss-Seidel", "PGS", "DENSE"),
        (":projected Gauss-Seidel, sparse", "PGS", "SPARSE"),
    )
} | ways_of(f"""
== limiting_forces | qfrc_constraint | {_NEWTON}value = d.qfrc_constraint
== limiting_forces:mj_mulJacTVec | efc_force, mj_mulJacTVec
{_NEWTON}value = np.zeros(m.nv)
mj.mj_mulJacTVec(n, d, value, d.efc_force)
== limiting_forces:mj_constraintUpdate | mj_mulJacVec, mj_constraintUpdate
{_NEWTON}apart = np.zeros(d.nefc)
mj.mj_mulJacVec(n, d, apart, d.qacc)
mj.mj_constraintUpdate(n, d, apart - d.efc_aref, None, 0)
value = d.qfrc_constraint
== limiting_forces:mj_inverse | mj_inverse: qfrc_constraint | {_NEWTON}mj.mj_inverse(n, d)\nvalue = d.qfrc_constraint
== floor_forces | mj_contactForce
{_NEWTON}value, wrench = np.zeros(sum(m.geom(k).name.startswith('g') for k in range(m.ngeom))), np.zeros(6)
for k, one in enumerate(d.contact):
    mj.mj_contactForce(n, d, k, wrench)
    value[int(m.geom(int(one.geom[1])).name[1:])] = wrench[0]
== limited_inverse ~ {_ITERATED} | mj_inverse | {_NEWTON}mj.mj_inverse(n, d)\nvalue = d.qfrc_inverse
""")
