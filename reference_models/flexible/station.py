"""MSS with its flexibility: SSRMS with flexible booms and joints, SPDM with flexible joints.

The paper's introduction asks for 22 rigid and more than 30 flexible degrees of freedom, and prints no parameters; here
are 22 + 35. Lengths and masses are those of the rigid `mss`; boom stiffness is that of a carbon-fibre tube of 0.35 m
diameter, joint stiffnesses are plausible for the torque of each arm.
"""

from __future__ import annotations

from dataclasses import replace

import symofros as sf

from ..rigid.station import mss

# Stiffness [N m/rad] and damping [N m s/rad] of a joint, and inertia of its motor seen at the output [kg m^2], by arm.
_JOINTS = {"ssrms": (6.0e4, 60.0, 40.0), "spdm_left": (9.0e3, 6.0, 2.0), "spdm_right": (9.0e3, 6.0, 2.0)}
_BOOMS = ("ssrms_link3", "ssrms_link4")
_EI, _GJ, _RADIUS = 4.0e6, 2.5e6, 0.175  # [N m^2], [N m^2], [m]


def flexible_mss(bending: int = 3, twist: int = 1) -> sf.System:
    """The station's arms on elastic joints, the two long booms as beams.

    Args:
        bending: Shape functions of each boom in each plane.
        twist: Shape functions of each boom in twist.
    """
    system = mss()
    bodies: list[sf.Body] = []
    for body in system.bodies:
        assert isinstance(body, sf.RigidBody) and body.joint is not None
        arm = next((arm for arm in _JOINTS if body.name.startswith(f"{arm}_link")), None)
        joint = body.joint
        if arm is not None:
            gear, joint = _elastic(body.joint, arm)
            bodies.append(gear)
        bodies.append(_boom(body, joint, bending, twist) if body.name in _BOOMS else replace(body, joint=joint))
    return replace(system, name="flexible_mss", bodies=tuple(bodies))


def _elastic(joint: sf.Joint, arm: str) -> tuple[sf.RigidBody, sf.Joint]:
    """A motor that turns a massless gear output, and the spring from there to the link."""
    stiffness, damping, inertia = _JOINTS[arm]
    gear = sf.RigidBody(f"{joint.name}_gear", replace(joint, armature=inertia))
    elements = (sf.Spring(stiffness), sf.Damper(damping))
    return gear, sf.Joint(f"{joint.name}_twist", "revolute", gear.name, axis=joint.axis, elements=elements)


def _boom(body: sf.RigidBody, joint: sf.Joint, bending: int, twist: int) -> sf.Beam:
    """A uniform tube of the body's mass and length."""
    (end,) = body.frames
    assert body.inertia is not None and isinstance(body.inertia.mass, float) and isinstance(end.position[0], float)
    rhoA = body.inertia.mass / end.position[0]
    return sf.Beam(
        body.name,
        joint,
        end.position[0],
        rhoA,
        EI_z=_EI,
        EI_y=_EI,
        GJ=_GJ,
        rhoJ=rhoA * _RADIUS**2,
        bend_y=bending,
        bend_z=bending,
        twist=twist,
        family="legendre",
        damping=1e-3,
        frames=(sf.Frame("end"),),
    )
