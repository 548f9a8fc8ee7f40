"""Basilisk: rotations, orbits, guidance, tanks that drain, spacecraft with effectors."""

from __future__ import annotations

from ...interface import Convention, Slot, Tree, Unsupported
from ...truth.spaceflight.tanks import LENGTH, MASS, RADIUS
from ..writing.source import Source, SourcePlugin, Way
from . import craft, kinematics, modules, orbits, parts

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


WAYS = kinematics.WAYS | orbits.WAYS | craft.WAYS | modules.WAYS | parts.WAYS | _unset()

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
    if tree.asked == "spacecraft":
        return craft.write(tree)
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
        Convention("spacecraft", "a free hub with effectors: linear velocity before, angular after"),
    ),
    kinds={},
    ways=WAYS,
    write=write,
    demands={
        "turns": "RigidBodyKinematics",
        "spacecraft": "Spacecraft",
        "dampers": "c of effectors",
        "springs": "k of effectors",
    },
    calls=4,
)
