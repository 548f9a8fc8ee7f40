"""Orbits and gravity by Basilisk: orbitalMotion, its models of gravity."""

from __future__ import annotations

from ...truth.spaceflight.orbits import HARMONICS, MU, ZONAL
from ..writing.source import Way, ways_of

_IMPORT = "from Basilisk.utilities import orbitalMotion as om\n"
# Elements as `truth.spaceflight.orbits` has them; `sign` is -1 and the eccentricity's power too for hyperbolas.
ELEMENTS = """def part(x): return x / (1 + abs(x))
e = 0.5 + part(a[1]) / 4
oe = om.ClassicElements()
oe.a, oe.e, oe.i, oe.Omega, oe.omega, oe.f = 2 + part(a[0]), e, 1.25 + part(v[0]), v[1], v[2], tau[0]
"""
_OPEN = "oe.a, oe.e, oe.f = -oe.a, 1 / e, tau[0] / 2\n"
# Position and velocity by these, without the engine.
STATE = """(c, s), (d, z), (g, h) = ((np.cos(x), np.sin(x)) for x in (oe.Omega, oe.i, oe.omega))
R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array([[1, 0, 0], [0, d, -z], [0, z, d]])
R = R @ np.array([[g, -h, 0], [h, g, 0], [0, 0, 1]])
p = oe.a * (1 - oe.e**2)
r = R @ np.array([np.cos(oe.f), np.sin(oe.f), 0]) * p / (1 + oe.e * np.cos(oe.f))
w = R @ np.array([-np.sin(oe.f), oe.e + np.cos(oe.f), 0]) * np.sqrt({MU} / p)
""".replace("{MU}", repr(MU))
_LISTED = "value = [oe.a, oe.e, oe.i, *(f(x) for x in (oe.Omega, oe.omega, oe.f) for f in (np.cos, np.sin))]"
# Of a model of gravity in C++: columns.
_FIELD = (
    "from Basilisk.simulation import {0}\nmodel = {0}.{1}()\nmodel.muBody = {2}\n{3}model.initializeParameters()\n"
    "value = np.ravel(model.computeField((v2 + [1.0, -1.5, 2.0]).reshape(3, 1)))"
)


def _coefficients() -> str:
    """Triangles of the coefficients of the harmonics, by degree and order."""
    degrees = range(max(n for n, _ in HARMONICS) + 1)
    cosines, sines = ([[HARMONICS.get((n, m), (0.0, 0.0))[k] for m in range(n + 1)] for n in degrees] for k in range(2))
    cosines[0][0] = 1.0
    return f"model.maxDeg, model.radEquator = {max(degrees)}, 1.0\nmodel.cBar, model.sBar = {cosines}, {sines}\n"


WAYS = ways_of(f"""
== orbit_anomalies | E2f, E2M, f2E, M2E
{_IMPORT}{ELEMENTS}x = tau[0]
value = [om.E2f(x, e), om.E2M(x, e), om.f2E(x, e), om.M2E(x, e)]
== orbit_anomalies_open | H2f, H2N, f2H, N2H
{_IMPORT}{ELEMENTS}x, e = tau[0], 1 / e
value = [om.H2f(x, e), om.H2N(x, e), om.f2H(x / 2, e), om.N2H(x, e)]
== orbit_frame | hillFrame | {_IMPORT}{ELEMENTS}{STATE}value = np.ravel(om.hillFrame(r, w))
== orbit_frame_position | rv2hill | {_IMPORT}{ELEMENTS}{STATE}value = np.ravel(om.rv2hill(r, w, r + v2, w + tau))
== orbit_frame_back | hill2rv | {_IMPORT}{ELEMENTS}{STATE}value = np.ravel(om.hill2rv(r, w, v2, tau))
== orbit_equinoctial | clElem2eqElem
{_IMPORT}{ELEMENTS}eq = om.EquinoctialElements()
om.clElem2eqElem(oe, eq)
value = [eq.a, eq.P1, eq.P2, eq.Q1, eq.Q2, np.cos(eq.l), np.sin(eq.l), np.cos(eq.L), np.sin(eq.L)]
== gravity_point_mass | PointMassGravityModel, computeField
{_FIELD.format("pointMassGravityModel", "PointMassGravityModel", MU, "")}
== gravity_harmonics | SphericalHarmonicsGravityModel, computeField
{_FIELD.format("sphericalHarmonicsGravityModel", "SphericalHarmonicsGravityModel", MU, _coefficients())}
""")
for _end, _own in (("", ""), ("_open", _OPEN)):
    for _kind in ("", "_parab"):
        _name = f":{_kind[1:]}" if _kind else ""
        WAYS |= ways_of(f"""
== orbit_state{_end}{_name} | elem2rv{_kind} | {_IMPORT}{ELEMENTS}{_own}value = np.ravel(om.elem2rv{_kind}({MU}, oe))
== orbit_elements{_end}{_name} | rv2elem{_kind}
{_IMPORT}{ELEMENTS}{_own}{STATE}oe = om.rv2elem{_kind}({MU}, r, w)
{_LISTED}
""")
# Of a sum over degrees the last part: it is as many digits short as it is smaller than the largest.
for _n in ZONAL:
    _less = f" - om.jPerturb(r, {_n - 1}, 'CELESTIAL_EARTH')" if _n > 2 else ""
    WAYS[f"gravity_zonal_{_n}"] = Way(
        "jPerturb",
        f"{_IMPORT}r = om.REQ_EARTH * (v2 + [1.0, -1.5, 2.0])\n"
        f"value = om.jPerturb(r, {_n}, 'CELESTIAL_EARTH'){_less}\n"
        f"value = value * om.REQ_EARTH**2 / (om.MU_EARTH * om.J{_n}_EARTH)",
        1e-9,
    )
