"""The generator against Lagrange's equations by SymPy: thirty digits at rational points."""

from __future__ import annotations

import pytest

import symofros as sf
from reference_models import MODELS
from validation.studies.oracle import NotDerivable, compare, derive

DIGITS = 30
PAR = [sf.Parameter("m", 1.5), sf.Parameter("a", 0.25), sf.Parameter("J", 0.375), sf.Parameter("k", 2.75)]
SOLID = sf.Inertia("m", ("a", 0.125, "-a/2"), ("J", "2*J", "1.5*J", "J/8", 0, "-J/4"))
ROUND = sf.Inertia("m", (0, 0, 0), ("J", "J", "J"))


def system(*joints: sf.Joint, inertia: sf.Inertia = SOLID, **more: object) -> sf.System:
    """Bodies in series on these joints."""
    bodies = [sf.RigidBody(f"b{i}", joint, inertia) for i, joint in enumerate(joints)]
    return sf.System("s", bodies, PAR, gravity=(1.0, -2.0, -9.5), **more)  # type: ignore[arg-type]


def on(i: int, **joint: object) -> sf.Joint:
    parent = f"b{i - 1}" if i else "world"
    return sf.Joint(**{"name": f"q{i}", "kind": "revolute", "parent": parent, "position": ("a", 0, 0.5), **joint})  # type: ignore[arg-type]


CASES: dict[str, sf.System] = {
    "double pendulum": MODELS["double_pendulum"],
    "cart-pole": MODELS["cart_pole"],
    "axes that are not coordinate axes": system(on(0, axis=(1, 2, 2)), on(1, axis=(2, -1, 2))),
    "screw and cylindrical": system(
        on(0, kind="screw", pitch="a", axis=(0, 1, 0)), on(1, kind="cylindrical", axis=(1, 0, 0)), inertia=ROUND
    ),
    "universal": system(on(0), on(1, kind="universal", axis=(1, 0, 0), axis2=(0, 0, 1))),
    "planar": system(on(0, kind="planar"), on(1, axis=(0, 1, 0))),
    "Euler angles": system(
        on(0, kind="general", coordinates=("x", "y", "z"), moving_rotation=sf.Rotation.rpy("x", "y", "z"))
    ),
    "curved path by matrix": system(
        on(0, kind="general", coordinates=("s",), moving_position=("cos(s)", "a*sin(s)", "s/4"),
           moving_rotation=sf.Rotation.matrix([["cos(2*s)", "-sin(2*s)", 0], ["sin(2*s)", "cos(2*s)", 0], [0, 0, 1]])),
        on(1, axis=(0, 1, 0)),
    ),
    "rotors": system(
        on(0, axis=(0, 0, 1)),
        on(1, axis=(0, 1, 0), rotors=(sf.Rotor("J/50", 40.0, (0, 1, 0)), sf.Rotor("J/60", "-k", (1, 0, 2), "b1")),
           armature="J/10"),
        inertia=ROUND,
    ),
    "forces": system(
        on(0, elements=(sf.Spring("k", "a", "k/3"), sf.Damper("m", "a"), sf.Friction("J", "k", 0.125, "a"))),
        on(1, axis=(0, 1, 0), effort=("u1*sin(q0) - k*dq1 + t",)),
        inertia=ROUND, inputs=[sf.Input("u1")],
        virtual_power=[sf.VirtualPower("p", {"dq0": "k*(q1 - q0)", "dq1": "-k*(q1 - q0)"})],
        potentials=[sf.Potential("v", "k*sin(q0)*q1^2")],
    ),
    "prescribed base": system(
        on(0, kind="general", coordinates=("X", "Y"), moving_position=("X", "Y", "X*Y"), prescribed=True,
           moving_rotation=sf.Rotation.axis_angle((0, 0, 1), "X")),
        on(1, axis=(1, 0, 0)),
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_thirty_digits(case: str) -> None:
    digits = compare(CASES[case], points=1)
    assert min(digits.values()) >= DIGITS, digits


def test_the_oracle_can_disagree() -> None:
    """A model that is off by 1e-12 in one mass agrees to twelve digits, not to thirty."""
    from dataclasses import replace

    import validation.studies.oracle as oracle

    stated = CASES["planar"]
    body = stated.bodies[0]
    heavier = stated.with_bodies(replace(body, inertia=replace(SOLID, mass=sf.formula("m*(1 + 2^-40)"))))
    derived = derive(heavier)
    honest = oracle.derive
    try:
        oracle.derive = lambda system: derived
        digits = compare(stated, points=1)
    finally:
        oracle.derive = honest
    assert 10 < digits["mass_matrix"] < 14


def test_quaternions_are_refused_in_words() -> None:
    with pytest.raises(NotDerivable, match="quaternion"):
        derive(MODELS["space_arm"])
