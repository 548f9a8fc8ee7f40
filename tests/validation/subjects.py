"""Subjects and states that the harness is tested on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import symofros as sf
from reference_models.rigid.random_tree import random_inertia, random_tree
from validation.contract.interface import States, Subject
from validation.inputs.frames import chosen_frames
from validation.inputs.sampling import sample
from validation.mechanics.assembly import Assembly, assemble
from validation.mechanics.geometry import Array
from validation.procedures.catalogue import Procedure, first_scene

UNIT = sf.Inertia(1.0, (0.1, -0.2, 0.3), (0.5, 0.6, 0.7, 0.01, 0.02, 0.03))

# One of every joint that moves, a free joint on a moving body among them.
EVERY_KIND = ("free", "revolute", "ball", "prismatic", "free", "continuous")


def assert_agrees(procedure: Procedure, system: sf.System) -> None:
    """Every cell of a procedure of the harness keeps its tolerance, at a random state of a system, interpreted."""
    cells = list(procedure(first_scene(system, assemble(system), "interpreter")))
    wrong = [cell for cell in cells if not cell.error <= cell.tolerance]
    assert cells and not wrong, wrong


def subject_of(system: sf.System) -> Subject:
    return Subject(system.name, system, chosen_frames(assemble(system)))


def tree(seed: int) -> Subject:
    return subject_of(random_tree(seed, n=8))


def every_kind() -> Subject:
    rng = np.random.default_rng(5)
    parent, bodies = "world", []
    for i, kind in enumerate(EVERY_KIND):
        position, axis = rng.uniform(-0.5, 0.5, 3), rng.standard_normal(3)
        rotation = sf.Rotation.quaternion(*rng.standard_normal(4))
        joint = sf.Joint(f"q{i}", kind, parent, None, position, rotation, axis)
        bodies.append(sf.RigidBody(f"b{i}", joint, random_inertia(rng), (sf.Frame("tip", rng.uniform(-1, 1, 3)),)))
        parent = f"b{i}"
    return subject_of(sf.System("every_kind", bodies, gravity=(1.0, 2.0, -9.0)))


def floating_arm() -> Subject:
    """Small, with a velocity that turns with the body."""
    bodies = [
        sf.RigidBody("hull", sf.Joint("hull", "free"), UNIT),
        sf.RigidBody(
            "arm",
            sf.Joint("shoulder", "revolute", "hull", None, (0.1, 0.2, 0.3)),
            UNIT,
            [sf.Frame("hand", (0.5, 0.1, 0.2))],
        ),
    ]
    return subject_of(sf.System("floating_arm", bodies))


def pendulum(**changes: object) -> sf.System:
    joint = sf.Joint("q", "revolute", axis=(0.0, 1.0, 0.0))
    return replace(sf.System("pendulum", [sf.RigidBody("rod", joint, UNIT)]), **changes)


def states_of(subject: Subject, count: int = 30) -> States:
    """Random states with random forces, for engines that are compared without our model."""
    assembly = assemble(subject.system)
    states = sample(assembly, 0, count)
    rng = np.random.default_rng(7)
    return replace(states, applied=rng.uniform(-9, 9, states.v.shape), passive=rng.uniform(-9, 9, states.v.shape))


def moved(assembly: Assembly, q: Array, dq: Array) -> Array:
    """q after a small displacement dq, to first order: enough for central differences."""
    result = q.copy()
    for mover in assembly.movers:
        if mover.kind in ("revolute", "prismatic"):
            result[:, mover.q] += dq[:, mover.v]
            continue
        start, w = mover.q.stop - 4, dq[:, mover.v.stop - 3 : mover.v.stop]
        x, scalar = q[:, start : start + 3], q[:, start + 3, None]
        # q' = q (w, 0) / 2, w in body axes; R' = R [w]x.
        rate = np.concatenate([scalar * w + np.cross(x, w), -np.sum(x * w, axis=1, keepdims=True)], axis=1) / 2
        if mover.kind == "free":
            v = dq[:, mover.v.start : mover.v.start + 3]
            t = 2 * np.cross(x, v)
            result[:, mover.q.start : start] += v + scalar * t + np.cross(x, t)
        quaternion = q[:, start : start + 4] + rate
        result[:, start : start + 4] = quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True)
    return result


URDF = """<?xml version="1.0" encoding="utf-8"?>
<robot name="two_link">
  <link name="base"/>
  <link name="zeta"><inertial><origin xyz="0.1 0.2 0.3" rpy="0.1 0.2 0.3"/><mass value="2"/>
    <inertia ixx="0.4" ixy="0.01" ixz="0.02" iyy="0.5" iyz="0.03" izz="0.6"/></inertial>
    <visual><geometry><mesh filename="package://nowhere/zeta.stl"/></geometry></visual></link>
  <link name="alpha"><inertial><mass value="1"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <link name="slider"><inertial><mass value="0.5"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <joint name="z" type="revolute"><parent link="base"/><child link="zeta"/><origin xyz="0 0 1" rpy="0.3 0 0"/>
    <axis xyz="0 1 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="a" type="continuous"><parent link="base"/><child link="alpha"/><axis xyz="1 0 0"/></joint>
  <joint name="s" type="prismatic"><parent link="zeta"/><child link="slider"/><origin xyz="0.5 0 0"/>
    <axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>
"""
