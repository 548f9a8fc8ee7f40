"""Rotations by Basilisk's RigidBodyKinematics: between all parameters, their rates and second rates."""

from __future__ import annotations

from ...truth.geometry.attitudes import ANGLES, SEQUENCES
from ..writing.source import HALF_TURNS, Way, ways_of

# Sets of attitude parameters -> how their functions are called: to and from quaternions, to matrices.
_SETS = {"MRP": "MRP", "gibbs": "Gibbs", "PRV": "PRV"} | {f"euler{one}": f"Euler{one}" for one in SEQUENCES}


def _through(own: str, of: str) -> dict[str, Way]:
    """Through a set of parameters: R from its own matrix, from a matrix, from a quaternion and back, R Q."""
    there, back = f"rbk.EP2{of}", f"rbk.{own}2C"
    again = f"rbk.EP2C(rbk.{own}2EP({there}(q)))"
    return ways_of(f"""
== rotation_matrix:{own}2C | EP2{of}, {own}2C | value = {back}({there}(q)).T.ravel()
== rotation_matrix:C2{of} | C2{of}, {own}2C | value = {back}(rbk.C2{of}(rbk.EP2C(q))).T.ravel()
== rotation_matrix:{own}2EP | EP2{of}, {own}2EP | value = {again}.T.ravel()
== rotation_composed:add{of} | add{of} | value = {back}(rbk.add{of}({there}(q), {there}(q2))).T.ravel()
== rotation_angle:sub{of} | sub{of}
C = {back}(rbk.sub{of}({there}(q2), {there}(q)))
value = [np.linalg.norm(rbk.C2PRV(C))]
""")


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

# Parts of a rate that a set's matrices leave out.
_FACTORS = {"MRP": 4, "gibbs": 2}


def _of_parameters(own: str, of: str) -> dict[str, Way]:
    """Functions of a set of parameters: R through each other set, the matrices of its rates."""
    name, x = own.lower(), f"(tau / 4 + {list(ANGLES)})" if own.startswith("euler") else "tau"
    ways = {f"attitude_of_{name}": Way(f"{own}2C", f"value = rbk.{own}2C({x}).T.ravel()")}
    for there, back in [*((other, mine) for mine, other in _SETS.items()), ("EP", "EP")]:
        if back == own or (own.startswith("euler") and back.startswith("euler")):
            continue
        call = f"{own}2{there}"
        ways[f"attitude_of_{name}:{call}"] = Way(call, f"value = rbk.{back}2C(rbk.{call}({x})).T.ravel()")
    factor = _FACTORS.get(own, 1)
    rates = f"np.transpose([rbk.d{of}({x}, w) for w in np.eye(3)])"
    return ways | {
        f"attitude_rates_{name}": Way(f"Bmat{of}", f"value = rbk.Bmat{of}({x}) / {factor}"),
        f"attitude_rates_{name}:d{of}": Way(f"d{of}", f"value = {rates}"),
        f"attitude_speeds_{name}": Way(f"Binv{of}", f"value = {factor} * rbk.Binv{of}({x})"),
    }


for _own, _of in _SETS.items():
    WAYS |= _through(_own, _of) | _of_parameters(_own, _of)
WAYS |= ways_of("""
== attitude_of_mrp:MRPshadow | MRPshadow | value = rbk.MRP2C(rbk.MRPshadow(tau)).T.ravel()
== attitude_of_prv:PRV2elem | PRV2elem, elem2PRV | value = rbk.PRV2C(rbk.elem2PRV(rbk.PRV2elem(tau))).T.ravel()
== attitude_speeds_mrp:dMRP2Omega | dMRP2Omega | value = np.transpose([rbk.dMRP2Omega(tau, x) for x in np.eye(3)])
== mrp_rates_rate | BdotmatMRP | value = rbk.BdotmatMRP(tau, a) / 4
== mrp_second_rates | ddMRP | value = rbk.ddMRP(tau, a, rbk.dMRP2Omega(tau, a), v2)
== mrp_acceleration | ddMRP2dOmega | value = rbk.ddMRP2dOmega(tau, a, v2)
== mrp_switched | MRPswitch | value = rbk.MRPswitch(tau, 1.0)
== rotations_elementary | euler1, euler2, euler3
value = [f(x).T.ravel() for f, x in zip((rbk.euler1, rbk.euler2, rbk.euler3), v)]
== rotations_elementary:Mi | Mi | value = [rbk.Mi(x, k).T.ravel() for k, x in enumerate(v, 1)]
== angles_wrapped | Picheck | value = [rbk.Picheck(x) for x in (*(16 * v), *v)]
== quaternion_rates | dEP | value = rbk.dEP(q, v)
== quaternion_rates:BmatEP | BmatEP | value = rbk.BmatEP(q) @ v / 2
== quaternion_rates:BinvEP | BinvEP | value = rbk.BinvEP(q).T @ v / 2
""")
