"""Basilisk: rotations by its RigidBodyKinematics, tanks that drain; its spacecraft are not asked."""

from __future__ import annotations

from ..interface import Convention, Slot, Tree, Unsupported
from ..truth.tanks import LENGTH, MASS, RADIUS
from .writing.source import HALF_TURNS, Source, SourcePlugin, Way

_SEQUENCES = "121 123 131 132 212 213 231 232 312 313 321 323".split()
# Sets of attitude parameters -> how their functions are called: to and from quaternions, to matrices.
_SETS = {"MRP": "MRP", "gibbs": "Gibbs", "PRV": "PRV"} | {f"euler{one}": f"Euler{one}" for one in _SEQUENCES}


def _ways_of(own: str, of: str) -> dict[str, Way]:
    """Through a set of parameters: R from its own matrix, from a matrix, from a quaternion and back, R Q."""
    there, back = f"rbk.EP2{of}", f"rbk.{own}2C"
    again = f"rbk.EP2C(rbk.{own}2EP({there}(q)))"
    return {
        f"rotation_matrix:{own}2C": Way(f"EP2{of}, {own}2C", f"value = {back}({there}(q)).T.ravel()"),
        f"rotation_matrix:C2{of}": Way(f"C2{of}, {own}2C", f"value = {back}(rbk.C2{of}(rbk.EP2C(q))).T.ravel()"),
        f"rotation_matrix:{own}2EP": Way(f"EP2{of}, {own}2EP", f"value = {again}.T.ravel()"),
        f"rotation_composed:add{of}": Way(
            f"add{of}", f"value = {back}(rbk.add{of}({there}(q), {there}(q2))).T.ravel()"
        ),
        f"rotation_angle:sub{of}": Way(
            f"sub{of}", f"C = {back}(rbk.sub{of}({there}(q2), {there}(q)))\nvalue = [np.linalg.norm(rbk.C2PRV(C))]"
        ),
    }


WAYS = {
    "rotation_matrix": Way("EP2C", "value = rbk.EP2C(q).T.ravel()"),
    "rotation_matrix:C2EP": Way("C2EP", "value = rbk.EP2C(rbk.C2EP(rbk.EP2C(q))).T.ravel()"),
    "rotation_half_turns": Way("C2EP", f"{HALF_TURNS}value = [rbk.EP2C(rbk.C2EP(H)).T.ravel() for H in half_turns]"),
    "rotation_composed": Way("addEP", "value = rbk.EP2C(rbk.addEP(q, q2)).T.ravel()"),
    "rotation_angle": Way("subEP", "value = [np.linalg.norm(rbk.C2PRV(rbk.EP2C(rbk.subEP(q2, q))))]"),
    "rotation_logarithm": Way("C2PRV", "value = rbk.C2PRV(rbk.EP2C(q))"),
    "rotation_exponential": Way("PRV2C", "value = rbk.PRV2C(v).T.ravel()"),
    "rotation_vector_rates": Way("BmatPRV", "value = rbk.BmatPRV(tau)"),
    "rotation_vector_rates:dPRV": Way("dPRV", "value = np.transpose([rbk.dPRV(tau, w) for w in np.eye(3)])"),
    "rotation_vector_speeds": Way("BinvPRV", "value = rbk.BinvPRV(tau)"),
}
for _own, _of in _SETS.items():
    WAYS |= _ways_of(_own, _of)
# Modules of effectors, and the placements that they begin with.
_EFFECTORS = {
    "hingedRigidBody": ("r_HB_B, dcm_HB",),
    "nHingedRigidBody": ("r_HB_B, dcm_HB",),
    "dualHingedRigidBody": ("r_H1B_B, dcm_H1B",),
    "spinningBodyOneDOF": ("r_SB_B, dcm_S0B",),
    "spinningBodyTwoDOF": ("r_S1B_B, dcm_S10B", "r_S2S1_S1, dcm_S20S1"),
}
_UNSET = """from Basilisk.simulation import {module}
one = {module}.{name}()
p, C = (np.array(x) for x in ({p}, {C}))
value = [*p.flat, *C.T.flat]"""


def _unset() -> dict[str, Way]:
    """Placements of effectors before anybody sets them."""
    ways = {}
    for short, pairs in _EFFECTORS.items():
        module, name = f"{short}StateEffector", f"{short[0].upper()}{short[1:]}StateEffector"
        for p, C in (pair.split(", ") for pair in pairs):
            code = _UNSET.format(module=module, name=name, p=f"one.{p}", C=f"one.{C}")
            ways[f"pose_unset:{name} {C}"] = Way(f"{name}: {p}, {C}", code)
    return ways


WAYS |= _unset()

# Models of tanks -> names of their functions.
_TANKS = {
    "Emptying": "emptying",
    "ConstantVolume": "of_constant_volume",
    "ConstantDensity": "of_constant_density",
    "UniformBurn": "burning_evenly",
    "CentrifugalBurn": "burning_outwards",
}
_OF_TANKS = (
    ("centre", "computeTankProps", "r_TcT_T"),
    ("centre_rate", "computeTankPropDerivs", "rPrime_TcT_T"),
    ("moments", "computeTankProps", "ITankPntT_T"),
    ("moment_rates", "computeTankPropDerivs", "IPrimeTankPntT_T"),
)
_DRAINED = f"""from Basilisk.simulation import fuelTank
t = fuelTank.FuelTankModel{{model}}()
t.propMassInit, t.radiusTankInit, t.r_TcT_TInit = {MASS}, {RADIUS}, [[0.0], [0.0], [0.0]]
if hasattr(t, 'lengthTank'): t.lengthTank = {LENGTH}
f = (1 + v[0] / (1 + abs(v[0]))) / 2
m, m1 = {{left}}
t.computeTankProps(m)
t.computeTankPropDerivs(m, m1)
value = {{value}}"""


def _tanks() -> dict[str, Way]:
    """Mass centres and moments of tanks by what is left, and their rates."""
    ways = {}
    for model, kind in _TANKS.items():
        by_height = f"{MASS} * f**2 * (3 - 2 * f), {MASS} * 6 * f * (1 - f) * v[1]"
        left = by_height if kind == "emptying" else f"{MASS} * f, {MASS} * v[1]"
        for name, call, field in _OF_TANKS:
            value = f"np.array(t.{field})[2]" if field.startswith("r") else f"np.diag(np.array(t.{field}))"
            code = _DRAINED.format(model=model, left=left, value=value)
            ways[f"tank_{name}_{kind}"] = Way(f"FuelTankModel{model}, {call}: {field}", code)
    return ways


WAYS |= _tanks()


def write(tree: Tree) -> Source | Unsupported:
    """Text that imports it: a turn is a quaternion."""
    if tree.asked != "turns":
        return Unsupported("rotations only", offered=False)
    slots = ((Slot("quaternion wxyz, body speeds", (0, 1, 2, 3), (0, 1, 2)),),)
    lines = ("import numpy as np", "from Basilisk.utilities import RigidBodyKinematics as rbk")
    return Source(lines, slots, 4, 3)


PLUGIN = SourcePlugin(
    name="basilisk",
    package="bsk",
    extra="symofros[engine-basilisk]",
    conventions=(
        Convention("direction cosine matrix", "the transpose of R: from the axes before to those of the body"),
        Convention("quaternion", "Euler parameters, w, x, y, z"),
        Convention("angular velocity", "along the axes of the body"),
        Convention("successive rotations", "addEP(a, b): first a, then b, about the axes that a has turned"),
        Convention("spacecraft", "hubs with effectors, about the mass centre of all; not asked here"),
    ),
    kinds={},
    ways=WAYS,
    write=write,
    demands={"turns": "RigidBodyKinematics"},
)
