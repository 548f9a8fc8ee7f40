"""The generator against SymPy's derivations by Kane's method: thirty digits at rational points."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

import symofros as sf
from symofros.description.forces import Damper, Friction, Spring, Stop
from symofros.description.joints.joint_kinds import JOINT_KINDS
from validation.__main__ import app
from validation.oracle import compare, kane
from validation.oracle.models import EXACT, MODELS
from validation.oracle.scope import NotDerivable

# With parameters or numbers as axes, in trees, of joints and forces that other models show too: with --slow.
SLOW = (
    *("axes by parameters", "constant axes", "universal", "branches", "general, by matrix", "massless between"),
    *("cylindrical", "planar", "general, by angles", "connections"),
)
CASES = [pytest.param(name, marks=[pytest.mark.slow] if name in SLOW else []) for name in MODELS]
SYSTEMS = [model.system for model in MODELS.values()]
JOINTS = [body.joint for system in SYSTEMS for body in system.bodies if body.joint is not None]


@pytest.mark.parametrize("name", CASES, ids=lambda x: x.replace(" ", "_"))
def test_oracle_models_agree_to_the_stated_digits(name: str) -> None:
    result = compare.check(name)
    assert result.ok, result.digits


def test_the_models_have_everything_a_description_may_state() -> None:
    # "continuous" is "revolute" without limits, which no equation knows.
    assert {joint.kind for joint in JOINTS} | {"continuous"} == set(JOINT_KINDS)
    assert {type(e) for joint in JOINTS for e in joint.elements} == {Spring, Damper, Stop, Friction}
    assert any(joint.prescribed for joint in JOINTS) and any(joint.armature for joint in JOINTS)
    assert {rotor.axis is None for joint in JOINTS for rotor in joint.rotors} == {True, False}
    assert any(body.inertia is None for system in SYSTEMS for body in system.bodies)
    loads = [load for system in SYSTEMS for body in system.bodies for load in body.loads]
    assert {(load.at, load.axes) for load in loads} == {
        (at, axes) for at in ("body", "center_of_mass", "tip") for axes in ("body", "world")
    }
    assert {c.length == 0.0 for system in SYSTEMS for c in system.connections} == {True, False}
    assert all(any(getattr(system, name) for system in SYSTEMS) for name in ("virtual_power", "potentials", "inputs"))


def test_exactness_is_asked_of_all_but_rounded_axes() -> None:
    assert [name for name, model in MODELS.items() if model.digits < EXACT] == ["constant axes"]


def heavier(system: sf.System) -> sf.System:
    body = system.bodies[-1]
    assert body.inertia is not None
    return system.with_bodies(replace(body, inertia=replace(body.inertia, mass=sf.formula("m*(1 + 2^-40)"))))


def stiffer(system: sf.System) -> sf.System:
    first, *rest = system.connections
    return replace(system, connections=(replace(first, stiffness=sf.formula("k*(1 + 2^-40)")), *rest))


def pushed(system: sf.System) -> sf.System:
    return replace(system, virtual_power=(sf.VirtualPower("more", (("dq0", 2.0**-36),)),))


DYNAMIC = ("mass_matrix", "bias", "kinetic_energy", "potential_energy")


@pytest.mark.parametrize(
    "name, change, functions",
    [
        ("screw", heavier, DYNAMIC),
        ("connections", stiffer, ("potential_energy", "generalized_force")),
        ("connections", pushed, ("generalized_force",)),
    ],
)
def test_the_oracle_can_disagree(name, change, functions) -> None:  # type: ignore[no-untyped-def]
    """A description that is off by 1e-12 in one place agrees to twelve digits or so, not to thirty."""
    digits = compare.agreement(MODELS[name].system, lambda system: kane.derive(change(system)), points=1, seed=0)
    assert {function for function in digits if digits[function] < EXACT} == set(functions)
    assert all(10 < digits[function] < 15 for function in functions)


def test_a_prescribed_motion_with_quaternions_is_refused() -> None:
    driven = sf.System("s", (sf.RigidBody("b", sf.Joint("j", "ball", prescribed=True)),))
    with pytest.raises(NotDerivable, match="joint 'j': a prescribed motion with quaternions"):
        kane.derive(driven)


def test_the_oracle_command_succeeds(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["oracle", "--model", "cart-pole", "--points", "1", "--json", "-o", str(tmp_path)])
    content = json.loads(result.stdout)
    assert result.exit_code == 0 and content["ok"]
    assert [(row["derivation"], row["ok"]) for row in content["comparisons"]] == [("kane", True)]
