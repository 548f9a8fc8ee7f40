"""Modules of Basilisk's guidance, control and environment: messages in, one update or two, messages out."""

from __future__ import annotations

from ...truth.geometry.poses import AWAY, MOMENTS
from ...truth.spaceflight.guidance import CUBIC, DENSITY, DIPOLE, HEIGHT, LIMIT, OUTER, K, P
from ...truth.spaceflight.orbits import MU
from ..writing.source import Way
from .orbits import ELEMENTS, STATE

_ASK = """import importlib
from Basilisk.architecture import bskLogging, messaging
bskLogging.setDefaultLogLevel(bskLogging.BSK_ERROR)
def mrp(e): return (np.array(e[1:]) * (1 if e[0] >= 0 else -1) / (1 + abs(e[0]))).tolist()
def message(name, **fields):
    payload = getattr(messaging, name + 'Payload')()
    for field, value in fields.items(): setattr(payload, field, np.array(value).tolist())
    return getattr(messaging, name)().write(payload)
def update(module, times=1, **inputs):
    for name, (kind, fields) in inputs.items():
        inputs[name] = message(kind, **fields)
        getattr(module, name).subscribeTo(inputs[name])
    if hasattr(module, 'SelfInit'): module.SelfInit()
    module.Reset(0)
    for k in range(times): module.UpdateState(500000000 * k)
    return inputs
def made(folder, name, kind=''):
    there = importlib.import_module('Basilisk.' + folder + '.' + name)
    return getattr(there, kind or name)()
"""
_ORBIT = f"from Basilisk.utilities import orbitalMotion as om\n{ELEMENTS}{STATE}"
_FOLLOWED = "out = m.attRefOutMsg.read()\nvalue = [*rbk.MRP2C(out.sigma_RN).T.flat, *out.omega_RN_N, *out.domega_RN_N]"
_ERRORS = "('AttGuidMsg', dict(sigma_BR=v2, omega_BR_B=v, omega_RN_B=a, domega_RN_B=tau))"
_VEHICLE = f"('VehicleConfigMsg', dict(ISCPntB_B=np.ravel({[list(row) for row in MOMENTS]})))"
_GAINS = f"m.K, m.P, m.knownTorquePntB_B = {K}, {P}, {list(OUTER)}\n"


def _way(native: str, kind: str, code: str, folder: str = "fswAlgorithms") -> Way:
    name = native.partition(",")[0]
    return Way(native, f"{_ASK}m = made({folder!r}, {name!r}{f', {kind!r}' if kind else ''})\n{code}")


# Of an orbit that is 64 times as large: what is nearer than 1 m the modules take for the centre.
def _orbiting(more: str = "") -> str:
    state = "('NavTransMsg', dict(r_BN_N=64 * r, v_BN_N=64 * w))"
    return f"{_ORBIT}{more}kept = update(m, transNavInMsg={state})\n{_FOLLOWED}"


def _torque(more: str) -> str:
    return f"{_GAINS}{more}kept = update(m, guidInMsg={_ERRORS}, vehConfigInMsg={_VEHICLE})\n" + (
        "value = m.cmdTorqueOutMsg.read().torqueRequestBody"
    )


_PLACED = (
    "kept = message('SCStatesMsg', r_BN_N=v2 + [1.0, -1.5, 2.0])\nm.addSpacecraftToModel(kept)\n"
    "m.Reset(0)\nm.UpdateState(0)\nout = m.envOutMsgs[0].read()\n"
)
WAYS = {
    "guidance_tracking": _way(
        "attTrackingError",
        "",
        "kept = update(m, attNavInMsg=('NavAttMsg', dict(sigma_BN=mrp(q), omega_BN_B=v)),\n"
        "    attRefInMsg=('AttRefMsg', dict(sigma_RN=mrp(q2), omega_RN_N=a, domega_RN_N=tau)))\n"
        "out = m.attGuidOutMsg.read()\n"
        "value = [*out.sigma_BR, *out.omega_BR_B, *out.omega_RN_B, *out.domega_RN_B]",
    ),
    "guidance_orbit_frame": _way("hillPoint", "", _orbiting()),
    "guidance_along_velocity": _way("velocityPoint", "", _orbiting(f"m.mu = {64**3 * MU}\n")),
    "guidance_turning_on": _way(
        "eulerRotation",
        "",
        "m.angleSet, m.angleRates = (v2 / 4).tolist(), v.tolist()\n"
        "kept = update(m, attRefInMsg=('AttRefMsg', dict(sigma_RN=mrp(q2), omega_RN_N=a, domega_RN_N=tau)))\n"
        + _FOLLOWED,
    ),
    "guidance_pointing": _way(
        "locationPointing",
        "",
        "m.pHat_B = [1.0, 0.0, 0.0]\n"
        "kept = update(m, 2, scAttInMsg=('NavAttMsg', dict(sigma_BN=mrp(q), omega_BN_B=v)),\n"
        "    scTransInMsg=('NavTransMsg', dict(r_BN_N=a)),\n"
        f"    locationInMsg=('GroundStateMsg', dict(r_LN_N=a + v2 + {list(AWAY)})))\n"
        "out = m.attGuidOutMsg.read()\nvalue = [*out.sigma_BR, *out.omega_BR_B, *out.omega_RN_B]",
    ),
    "control_feedback": _way("mrpFeedback", "", _torque("m.Ki, m.controlLawType = -1.0, 0\n")),
    "control_feedback_whole": _way("mrpFeedback", "", _torque("m.Ki, m.controlLawType = -1.0, 1\n")),
    "control_feedback:mrpPD": _way("mrpPD", "", _torque("")),
    "control_steering": _way(
        "mrpSteering",
        "",
        f"m.K1, m.K3, m.omega_max, m.ignoreOuterLoopFeedforward = {K}, {CUBIC}, {LIMIT}, False\n"
        f"kept = update(m, guidInMsg={_ERRORS})\n"
        "out = m.rateCmdOutMsg.read()\nvalue = [*out.omega_BastR_B, *out.omegap_BastR_B]",
    ),
    "field_of_a_dipole": _way(
        "magneticFieldCenteredDipole",
        "MagneticFieldCenteredDipole",
        f"m.planetRadius, m.g11, m.h11, m.g10 = 1.0, *{list(DIPOLE)}\n{_PLACED}value = out.magField_N",
        "simulation",
    ),
    "density_of_air": _way(
        "exponentialAtmosphere",
        "ExponentialAtmosphere",
        f"m.planetRadius, m.baseDensity, m.scaleHeight = 1.0, {DENSITY}, {HEIGHT}\n"
        f"{_PLACED}value = [out.neutralDensity]",
        "simulation",
    ),
}
