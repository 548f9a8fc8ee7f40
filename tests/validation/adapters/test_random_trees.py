"""Random trees against the engines: shape, joints, axes, placements, inertias drawn by hypothesis, which shrinks a
disagreement to a minimal tree.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import symofros as sf
from tests.models import sampled
from validation.adapters import interpreted
from validation.adapters.compiled import SymofrosEngine
from validation.adapters.mujoco import tree as mujoco
from validation.adapters.pinocchio import tree as pinocchio
from validation.comparison.errors import compute, state_errors, typical_scales
from validation.comparison.variants import with_forces
from validation.contract.interface import Subject, Unsupported
from validation.contract.quantities import QUANTITIES, TREE_QUANTITIES
from validation.inputs.sampling import sample
from validation.mechanics.assembly import assemble

STATES = 12
KINDS = ("revolute", "prismatic", "ball", "free", "fixed", "universal", "cylindrical", "planar", "screw", "euler")

small = st.sampled_from([0.0, 0.25, -0.5, 1.0])
# As files write them: right angles of few decimals, axes with the noise of a product in single precision.
angle = st.sampled_from([0.0, np.pi / 2, -np.pi / 2, np.pi, 0.3, 3.1415926536, 1.5707, 1e-9])
axis = st.sampled_from([(1.0, 0, 0), (0, 1.0, 0), (0, 0, -1.0), (1.0, 2.0, -0.5), (1.0, 6e-9, 0), (1e-7, 0, 2.0)])
rotation = st.builds(sf.Rotation.rpy, angle, angle, angle)
vector = st.tuples(small, small, small)


@st.composite
def inertias(draw: st.DrawFn) -> sf.Inertia:
    """A physical inertia: two moments, and a third between their difference and their sum."""
    a, b = draw(st.sampled_from([0.1, 0.4, 1.0])), draw(st.sampled_from([0.2, 0.5]))
    share = draw(st.sampled_from([0.1, 0.5, 0.9]))
    c = abs(a - b) + share * (a + b - abs(a - b))
    return sf.Inertia(draw(st.sampled_from([0.5, 2.0])), draw(vector), (a, b, c), rotation=draw(rotation))


@st.composite
def trees(draw: st.DrawFn) -> sf.System:
    """One to six bodies; each on any of those before it."""
    bodies: list[sf.RigidBody] = []
    for i in range(draw(st.integers(1, 6))):
        parent = draw(st.sampled_from(["world", *(body.name for body in bodies)]))
        kind = draw(st.sampled_from(KINDS if i else [k for k in KINDS if k != "fixed"]))
        more: dict[str, object] = {}
        if kind == "euler":
            names = tuple(f"{c}{i}" for c in "xyzabc")
            more = {"coordinates": names, "moving_position": names[:3], "moving_rotation": sf.Rotation.rpy(*names[3:])}
        elif kind == "universal":
            more = {"axis2": (0.2, -1.0, 0.5)}
        elif kind == "screw":
            more = {"pitch": 0.3}
        joint = sf.Joint(
            f"q{i}",
            "general" if kind == "euler" else kind,
            parent,
            None,
            draw(vector),
            draw(rotation),
            draw(axis),
            armature=draw(st.sampled_from([0.0, 0.05])),
            **more,
        )
        bodies.append(sf.RigidBody(f"b{i}", joint, draw(inertias())))
    return sf.System("tree", bodies, gravity=draw(st.sampled_from([(0, 0, -9.81), (1.0, 2.0, 3.0)])))


@pytest.mark.parametrize("engine", sampled((pinocchio, mujoco), [pinocchio]), ids=["pinocchio", "mujoco"])
@settings(max_examples=12, suppress_health_check=list(HealthCheck), derandomize=True)
@given(trees())
def test_random_trees_agree(engine: object, system: sf.System) -> None:
    assembly = assemble(system)
    subject = Subject("tree", system, frames=(system.bodies[-1].name,))
    theirs = engine.build(subject)  # type: ignore[attr-defined]
    if isinstance(theirs, Unsupported):
        assert "screw" in theirs.reason or "armature" in theirs.reason, theirs.reason
        return
    ours = interpreted.build(subject)
    states = with_forces(ours, sample(assembly, ours.model.nu, STATES))
    scales = typical_scales(ours, states)
    for name in sorted((TREE_QUANTITIES | {"joint_wrenches"}) & theirs.capabilities):
        quantity = QUANTITIES[name]
        errors = state_errors(quantity, compute(ours, quantity, states), compute(theirs, quantity, states), scales)
        assert errors.max() <= quantity.tolerance, (name, errors.max())


@pytest.mark.parametrize("way", ["articulated", "factors"])
@settings(max_examples=25, suppress_health_check=list(HealthCheck), derandomize=True)
@given(system=trees())
def test_both_forward_dynamics_methods_match_pinocchio(
    way: Literal["articulated", "factors"], system: sf.System
) -> None:
    """Pinocchio's own articulated bodies."""
    subject = Subject("tree", system)
    theirs = pinocchio.build(subject)
    if isinstance(theirs, Unsupported):
        return
    options = sf.Options(backend="interpreter", forward_dynamics=way)
    ours = SymofrosEngine("symofros", sf.compile(system, options))
    states = with_forces(ours, sample(assemble(system), ours.model.nu, STATES))
    expected, found = theirs.forward_dynamics(states), ours.forward_dynamics(states)
    # A joint across gravity rests: what an engine then gives is the rounding of a quarter turn, a share of gravity.
    scale = max(np.abs(expected).max(), np.linalg.norm(system.gravity))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * scale)


@settings(max_examples=15, suppress_health_check=list(HealthCheck), derandomize=True)
@given(system=trees(), which=st.integers(0, 5))
def test_the_drive_effort_of_a_prescribed_joint_matches_inverse_dynamics(system: sf.System, which: int) -> None:
    """The same motion, one joint of it prescribed: its effort and those of the other joints are as before."""
    described = assemble(system).joints
    chosen = described[which % len(described)]
    bodies = [
        replace(body, joint=replace(body.joint, prescribed=True))
        if body.joint is not None and body.joint.name == chosen.joint.name
        else body
        for body in system.bodies
    ]
    options = sf.Options(backend="interpreter")
    free, driven = sf.compile(system, options), sf.compile(system.with_bodies(*bodies), options)
    states = sample(assemble(system), 0, STATES)
    motion = np.hstack([states.q[:, chosen.q], states.v[:, chosen.v], states.a[:, chosen.v]])
    q = np.delete(states.q, chosen.q, axis=1)
    v, a = np.delete(states.v, chosen.v, axis=1), np.delete(states.a, chosen.v, axis=1)
    tau = free.inverse_dynamics(states.q, states.v, states.a)
    tolerance = 1e-12 * max(1.0, np.abs(tau).max())
    np.testing.assert_allclose(driven.prescribed_efforts(q, v, a, motion), tau[:, chosen.v], rtol=0, atol=tolerance)
    wanted = np.delete(tau, chosen.v, axis=1)
    np.testing.assert_allclose(driven.inverse_dynamics(q, v, a, u=motion), wanted, rtol=0, atol=tolerance)
