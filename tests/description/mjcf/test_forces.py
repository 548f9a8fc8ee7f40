"""Actuators and equality constraints of MJCF: MuJoCo's own forces and constraint Jacobians for the same file."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

import symofros as sf
from symofros.description.yaml.files import read_yaml
from tests.description.mjcf.test_mjcf import FLOOR, STATES, Reference, close, write

ARM = """
    <compiler angle="radian"/>
    <worldbody><site name="ground" pos="0.2 0 1"/><body name="a" pos="0 0 1" euler="0.1 0.2 0.3">
      <joint name="q1" axis="0 1 0" ref="0.2" {q1}/><geom type="box" size="0.1 0.2 0.3" pos="0.2 0 0"/>
      <body name="b" pos="0.5 0 0" euler="0.4 0 0"><joint name="q2" type="slide" axis="1 0 1"/>
        <geom type="box" size="0.1 0.1 0.2"/><site name="tip" pos="0.3 0 0.1" euler="0 0.5 0"/>
        <body name="c" pos="0 0.3 0"><joint name="q3" type="ball" pos="0 0.1 0"/>
          <geom type="box" size="0.2 0.1 0.05" pos="0.1 0 0"/><site name="end" pos="0.2 0 0"/></body></body></body>
    <body name="d"><freejoint name="float"/><geom type="box" size="0.1 0.2 0.3" pos="0.1 0 0"/>
      <site name="rotor" pos="0.2 0.1 0" euler="0.3 0.2 0"/></body>
    </worldbody>"""
ACTUATORS = {
    "motor": '<motor name="m" joint="q1" gear="3" ctrlrange="-1 1"/><motor joint="q2" forcerange="-0.5 0.7"/>',
    "position": '<position joint="q1" kp="4" kv="1.5" gear="2"/><position joint="q2" kp="3" inheritrange="0"/>',
    "velocity": '<velocity joint="q1" kv="2" ctrlrange="-1 0.5"/><damper joint="q2" kv="3" ctrlrange="0 1"/>',
    "general": """<general joint="q1" gaintype="affine" gainprm="1 2 3" biastype="affine" biasprm="4 5 6" gear="0.5"/>
        <general jointinparent="q2" gainprm="7" biastype="affine" biasprm="1 -2 0.5" forcerange="-3 3"/>""",
    "two on a joint": '<motor joint="q1" gear="2"/><velocity joint="q1" kv="3"/>',
    "ball": '<motor joint="q3" gear="1 -2 3"/><velocity joint="q3" kv="2" gear="0 1 0.5"/>',
    "free": '<motor joint="float" gear="1 2 3 4 5 6"/><motor jointinparent="float" gear="0 0 1 2 0 1"/>',
    "sites": '<motor site="rotor" gear="0 0 1 0 0 0.1"/><motor site="tip" gear="1 2 3 0 0 0"/><motor site="ground"/>',
    "named like a joint": '<motor name="q1" joint="q1"/><motor name="dq2" joint="q2"/><motor name="t" joint="q2"/>',
    "default class": '<general class="strong" joint="q1"/>',
}
DEFAULT = (
    '<default><default class="strong"><general gainprm="9" biastype="affine" biasprm="0 -9 0"/></default></default>'
)


@pytest.mark.parametrize("name", ACTUATORS)
def test_actuator_forces_match_mujoco(tmp_path: Path, name: str) -> None:
    limits = 'actuatorfrclimited="true" actuatorfrcrange="-4 3"' if name == "two on a joint" else ""
    path = write(tmp_path, f"{DEFAULT}{ARM.format(q1=limits)}<actuator>{ACTUATORS[name]}</actuator>")
    model = sf.compile(sf.load(path), sf.Options(backend="interpreter"))
    reference = Reference(path)
    d = reference.d
    assert model.nu == reference.m.nu
    rng = np.random.default_rng(1)
    for _ in range(STATES):
        q, v = model.random_state(rng)
        d.ctrl[:] = u = 2.0 * rng.normal(size=model.nu)
        T = reference.at(q, v)
        force = T.T @ (d.qfrc_actuator + d.qfrc_passive)
        close(model.generalized_force(q, v, u), force, 1.0)


def test_actuators_and_constraints_survive_writing_and_reading(tmp_path: Path) -> None:
    text = ARM.format(q1="") + f"<actuator>{ACTUATORS['general']}{ACTUATORS['ball']}</actuator>"
    system = sf.load(write(tmp_path, text + f"<equality>{EQUALITIES['joint'][0]}{EQUALITIES['weld'][0]}</equality>"))
    sf.save(system, tmp_path / "model.yaml")
    assert read_yaml(tmp_path / "model.yaml").system == system


# Name -> constraint, rows of MuJoCo's Jacobian that are not zero.
EQUALITIES = {
    "connect": ('<connect body1="c" body2="d" anchor="0.1 0.2 0.3"/>', 3),
    "connect to the world": ('<connect body1="c" anchor="0.1 0 0.3"/>', 3),
    "connect sites": ('<connect site1="end" site2="rotor"/>', 3),
    "weld": ('<weld body1="b" body2="d"/>', 6),
    "weld with anchor": ('<weld body1="b" body2="d" anchor="0.1 0.2 0.3" torquescale="0.5"/>', 6),
    "weld in another pose": ('<weld body1="b" body2="d" relpose="0.1 0.2 0.3 0.8 0.6 0 0" anchor="0 0.1 0"/>', 6),
    "weld of positions only": ('<weld body1="b" body2="d" anchor="0.1 0.2 0.3" torquescale="0"/>', 3),
    "weld sites": ('<weld site1="tip" site2="rotor"/>', 6),
    "joint": ('<joint joint1="q1" joint2="q2" polycoef="0.1 2 -0.3 0.2 0.05"/>', 1),
    "joint to a constant": ('<joint joint1="q2" polycoef="0.3 0 0 0 0"/>', 1),
}


def row_space(G: np.ndarray) -> np.ndarray:
    """The projector onto the rows, which does not depend on how conditions are combined."""
    return np.asarray(np.linalg.pinv(G) @ G)


def assembled(model: sf.Model, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """A state on the constraints, from guesses ever farther from the posture of the file."""
    for spread in np.linspace(0.3, 3.0, 50):
        guess = model.integrate(model.neutral(), spread * rng.normal(size=model.nv))
        try:
            return sf.assemble(model, q=guess).q, rng.normal(size=model.nv)
        except sf.AssemblyError:
            continue
    raise AssertionError("no guess leads to the constraints")


@pytest.mark.parametrize("name", EQUALITIES)
def test_equalities_constrain_the_same_speeds_as_in_mujoco(tmp_path: Path, name: str) -> None:
    text, rows = EQUALITIES[name]
    path = write(tmp_path, ARM.format(q1="") + f"<equality>{text}</equality>")
    model = sf.compile(sf.load(path), sf.Options(backend="interpreter"))
    assert model.nc == rows
    reference = Reference(path)
    m, d = reference.m, reference.d
    m.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    m.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    rng = np.random.default_rng(2)
    for _ in range(3):
        q, v = assembled(model, rng)
        T = reference.at(q, v)
        G_mujoco = d.efc_J.reshape(d.nefc, -1)
        assert d.ne == d.nefc and np.any(G_mujoco, axis=1).sum() == rows
        close(d.efc_pos, np.zeros(d.nefc), 1.0)
        G = model.constraint_jacobian(q)
        np.testing.assert_allclose(row_space(G), row_space(G_mujoco @ T), atol=1e-9)


def test_couplings_have_the_residual_of_mujoco(tmp_path: Path) -> None:
    path = write(tmp_path, ARM.format(q1="") + f"<equality>{EQUALITIES['joint'][0]}</equality>")
    model = sf.compile(sf.load(path), sf.Options(backend="interpreter"))
    reference = Reference(path)
    q, v = model.random_state(np.random.default_rng(3))
    reference.at(q, v)
    close(model.constraint(q), reference.d.efc_pos[:1])


HINGE = '<worldbody><body name="a"><joint name="q" axis="0 1 0" {}/><geom size="0.1" pos="1 0 0"/></body></worldbody>'


@pytest.mark.parametrize(
    ("attributes", "said"),
    [
        ('stiffness="1" springyield="0.5"', True),
        ('stiffness="0 0 2" springyield="0.5"', True),
        ('stiffness="1"', False),
        ('springyield="0.5"', False),  # There is no spring to yield.
    ],
)
def test_the_ignored_yield_of_springs_is_noted(tmp_path: Path, attributes: str, said: bool) -> None:
    notes = sf.load(write(tmp_path, HINGE.format(attributes))).notes
    assert notes == ("yield of springs ignored: 1 joint (q)",) * said


@pytest.mark.parametrize(("compiler", "said"), [('<compiler settotalmass="5"/>', True), ("", False)])
def test_mujoco_warnings_become_notes(tmp_path: Path, compiler: str, said: bool) -> None:
    (*notes,) = sf.load(write(tmp_path, compiler + HINGE.format(""))).notes
    assert [note.startswith("MuJoCo warns: 1 remark (compiler attribute") for note in notes] == [True] * said, notes


@pytest.mark.parametrize(
    "text", ["", '<default><geom contype="0"/></default>' + FLOOR, '<option><flag contact="disable"/></option>' + FLOOR]
)
def test_shapes_without_contacts_get_no_note(tmp_path: Path, text: str) -> None:
    assert not sf.load(write(tmp_path, text + HINGE.format(""))).notes


@pytest.mark.parametrize("flag", ["constraint", "frictionloss", "limit"])
def test_friction_and_limits_that_are_switched_off_do_not_act(tmp_path: Path, flag: str) -> None:
    text = HINGE.format('frictionloss="2" range="-1 1"')
    path = write(tmp_path, f'<option><flag {flag}="disable"/></option>{text}')
    off = sf.load(path, dissipation="all", limits="stops")
    (joint,) = (body.joint for body in off.bodies if body.joint is not None)
    kinds = {type(element) for element in joint.elements}
    gone = {"constraint": {sf.Friction, sf.Stop}, "frictionloss": {sf.Friction}, "limit": {sf.Stop}}[flag]
    assert kinds == {sf.Friction, sf.Stop} - gone
