"""MuJoCo's model of a description: joints of several coordinates, whose parts may lie apart."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.validation.subjects import UNIT
from validation.adapters import interpreted
from validation.adapters.mujoco import tree as mujoco
from validation.adapters.pinocchio import tree as pinocchio
from validation.comparison.errors import compute, state_errors, typical_scales
from validation.comparison.variants import with_forces
from validation.contract.interface import Subject, Unsupported
from validation.contract.quantities import QUANTITIES
from validation.inputs.sampling import sample
from validation.mechanics.assembly import Assembly, assemble
from validation.mechanics.geometry import Placement, about_axis

X, Y, Z = np.eye(3)
# The second axis of the universal joint lies off the first, and is turned about it.
OFFSET = Placement(about_axis(Z, 0.4) @ about_axis(X, -0.7), np.array([0.3, -0.2, 0.1]))
COMPARED = ("mass_matrix", "bias", "potential_energy", "forward_dynamics", "frame_pose", "frame_velocity")


def system(joint: sf.Joint) -> sf.System:
    """A body on a joint between an arm and a hand, with mass on both sides."""
    arm = sf.RigidBody("arm", sf.Joint("shoulder", "revolute", axis=(1, 2, 3)), UNIT)
    tip = sf.RigidBody("hand", sf.Joint("wrist", "revolute", "body", position=(0.4, 0.1, 0)), UNIT, [sf.Frame("tip")])
    return sf.System("hooke", [arm, sf.RigidBody("body", joint, UNIT), tip], gravity=(1.0, 2.0, -9.0))


def offset_universal() -> sf.System:
    """The joint with the offset, written out as formulas: R = Rz(a) R_offset Rx(b), p = Rz(a) p_offset."""
    x, y, z = OFFSET.p
    moved = (f"{x}*cos(a) - ({y})*sin(a)", f"{x}*sin(a) + ({y})*cos(a)", z)
    R_a = (("cos(a)", "-sin(a)", "0"), ("sin(a)", "cos(a)", "0"), ("0", "0", "1"))
    R_b = (("1", "0", "0"), ("0", "cos(b)", "-sin(b)"), ("0", "sin(b)", "cos(b)"))
    offset = OFFSET.R.tolist()

    def entry(i: int, m: int) -> str:
        return " + ".join(f"({R_a[i][j]})*({offset[j][k]})*({R_b[k][m]})" for j in range(3) for k in range(3))

    R = [[entry(i, m) for m in range(3)] for i in range(3)]
    more: dict[str, Any] = {"moving_position": moved, "moving_rotation": sf.Rotation.matrix(R)}
    return system(sf.Joint("j", "general", "arm", position=(0.2, 0, 0.5), coordinates=("a", "b"), **more))


@pytest.mark.parametrize("engine", [mujoco, pinocchio], ids=lambda engine: engine.NAME)
def test_parts_of_one_joint_may_lie_apart(engine: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """No joint kind of today has an offset between its parts: the universal joint is given one here."""
    universal = system(sf.Joint("j", "universal", "arm", position=(0.2, 0, 0.5), axis=Z, axis2=X))

    def assembled(subject: Subject) -> Assembly:
        assembly = assemble(subject.system)
        movers = tuple(replace(mover, X_AP=OFFSET) if mover.continues else mover for mover in assembly.movers)
        return replace(assembly, movers=movers)

    frames = ("tip",)
    own = interpreted.build(Subject("own", offset_universal(), frames))
    monkeypatch.setattr(Subject, "assembly", property(assembled))
    built = engine.build(Subject("hooke", universal, frames))
    assert not isinstance(built, Unsupported)
    states = with_forces(own, sample(assemble(universal), own.model.nu, 20))
    scales = typical_scales(own, states)
    for name in COMPARED:
        quantity = QUANTITIES[name]
        errors = state_errors(quantity, compute(own, quantity, states), compute(built, quantity, states), scales)
        assert errors.max() <= quantity.tolerance, name
