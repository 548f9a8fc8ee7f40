"""How far the numeric engines reach: what of a description none of them is given."""

from __future__ import annotations

from collections.abc import Collection

import symofros as sf

from ..contract.interface import Unsupported
from ..mechanics.assembly import Assembly, Mover
from ..mechanics.joint_kinds import PartKind


def unrepresented(system: sf.System, assembly: Assembly, joints: Collection[PartKind]) -> Unsupported | None:
    """The first thing of a description that an engine can't be built for."""
    for mover in assembly.movers:
        if mover.kind not in joints:
            return Unsupported(
                f"joint '{mover.joint.name}': no {mover.kind} joint, and no series of simple ones for it"
            )
    for body in system.bodies:
        joint = body.joint
        if isinstance(body, sf.Beam):
            return Unsupported(f"beam '{body.name}': no elastic bodies with foreshortening")
        if joint is not None and joint.prescribed:
            return Unsupported(f"joint '{joint.name}': a prescribed motion")
        if joint is not None and joint.rotors:
            return Unsupported(f"joint '{joint.name}': a rotor with its gyroscopic effect")
    return None


def armature(system: sf.System, mover: Mover) -> float:
    """The inertia added to each speed of a joint."""
    return float(sf.evaluate(mover.joint.armature, system.parameter_values()))


def bears_its_weight_alone(system: sf.System) -> bool:
    """Whether no force acts on bodies but their weight, so that joints carry what an engine knows of."""
    loads = any(body.loads for body in system.bodies)
    return not loads and not system.connections


def stores_energy(system: sf.System) -> bool:
    """Whether anything but the weight has potential energy."""
    joints = [body.joint for body in system.bodies if body.joint is not None]
    springs = any(isinstance(element, (sf.Spring, sf.Stop)) for joint in joints for element in joint.elements)
    strained = any(body.modes for body in system.beams)
    return springs or strained or bool(system.connections or system.potentials)
