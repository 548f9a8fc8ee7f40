"""Sections of beams between root and tip: frames, bodies and closures there (docs/theory/rods.md, section 5)."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.mechanics.beams.rods import BODY, GRAVITY, HUB, rod
from tests.validation.subjects import assert_agrees
from validation.procedures.equations import identities

MOTION = (
    "mass_matrix",
    "bias",
    "generalized_force",
    "frame_pose",
    "frame_velocity",
    "frame_acceleration",
    "frame_jacobian",
    "frame_jacobian_rate",
)
FRAMES = (sf.Frame("tip"), sf.Frame("middle", at=0.5))
ELBOW = sf.Joint("elbow", "revolute", "rod", "middle", axis=(1, 2, 0), position=(0.1, 0.0, 0.05))
CLAMP = sf.Joint("clamp", "fixed", "rod", "tip", position=(0.0, -0.2, 0.0))
CARRIED = (sf.RigidBody("arm", ELBOW, BODY), sf.RigidBody("hand", CLAMP, BODY))


def stated(theory: str = "strain", sections: int = 4, **changed: Any) -> sf.System:
    """A beam on a hub with bodies at its middle and its tip."""
    more: dict[str, Any] = {"sections": sections}
    if theory == "second_order":
        more = {"theory": theory, "family": "spline", "retain": "all"}
    beam = rod((1, 1, 1), HUB, frames=FRAMES, **more)
    return sf.System("whole", (beam, *CARRIED), gravity=GRAVITY, **changed)


def interpreted(system: sf.System, *functions: str, **options: Any) -> sf.Model:
    return sf.compile(system, sf.Options(functions, ("tip", "middle"), backend="interpreter", **options))


@cache
def whole(theory: str = "strain") -> sf.Model:
    return interpreted(stated(theory), *MOTION, "kinetic_energy", "coriolis_matrix")


@pytest.mark.parametrize("theory", ["strain", "second_order"])
def test_stations_keep_the_identities_of_the_equations(theory: str) -> None:
    assert_agrees(identities.velocity_terms, stated(theory))
    assert_agrees(identities.moving_frames, stated(theory))


def test_a_closure_at_a_station_has_position_and_jacobian_of_its_frame(rng: np.random.Generator) -> None:
    ground = sf.RigidBody("ground", frames=(sf.Frame("post", (0.3, 0.4, 0.1)),))
    closure = sf.Closure("stay", ("ground", "post"), ("rod", "middle"))
    system = stated("second_order", constraints=(closure,))
    m = interpreted(replace(system, bodies=(ground, *system.bodies)), "constraint", "constraint_jacobian")
    q = 0.5 * rng.standard_normal(m.nv)
    p, _ = whole("second_order").frame_pose("middle", q)
    assert m.constraint(q) == pytest.approx(p - (0.3, 0.4, 0.1), abs=1e-14)
    assert m.constraint_jacobian(q) == pytest.approx(whole("second_order").frame_jacobian("middle", q)[:3], abs=1e-14)


def test_a_load_at_a_station_is_a_force_on_its_frame(rng: np.random.Generator) -> None:
    force, torque = (1.0, -2.0, 0.5), (0.3, 0.2, -0.1)
    load = sf.BeamLoad(force, torque, at=0.5, axes="world")
    system = stated("second_order", 0)
    beam = replace(system.bodies[0], loads=(load,))
    m = interpreted(replace(system, bodies=(beam, *CARRIED)), "generalized_force")
    q = 0.5 * rng.standard_normal(m.nv)
    added = m.generalized_force(q, 0 * q, ()) - whole("second_order").generalized_force(q, 0 * q, ())
    assert added == pytest.approx(whole("second_order").frame_jacobian("middle", q).T @ (*force, *torque), abs=1e-13)


def test_a_rigid_beam_has_its_stations_along_its_axis() -> None:
    beam = rod((0, 0, 0), HUB, frames=FRAMES, theory="second_order", family="spline")
    m = sf.compile(sf.System("s", (beam,)), sf.Options(("frame_pose",), backend="interpreter"))
    p, R = m.frame_pose("rod", np.array([0.4]))
    for name, xi in (("tip", 1.0), ("middle", 0.5)):
        assert m.frame_pose(name, np.array([0.4]))[0] == pytest.approx(p + 1.3 * xi * R[:, 0], abs=1e-15)


def test_segments_keep_frames_at_their_stations() -> None:
    q = {n: np.zeros(n) for n in (1, 3)}
    poses = []
    for n in (1, 3):
        beam = rod((1, 0, 0), curvature_z=0.8, frames=FRAMES, segments=n, sections=10)
        m = sf.compile(sf.System("s", (beam,)), sf.Options(("frame_pose",), backend="interpreter"))
        poses.append([m.frame_pose(frame.name, q[n]) for frame in FRAMES])
    for (p, R), (other, turned) in zip(*poses, strict=True):
        assert p == pytest.approx(other, abs=1e-9)
        assert pytest.approx(turned, abs=1e-12) == R


def test_articulated_bodies_carry_what_stands_on_sections() -> None:
    """Two bodies on one section and one on another, against the factors of M."""
    turned = {"axis": (0, 1, 1), "rotation": sf.Rotation.rpy(0.3, 0, 0.2)}
    bodies = [
        sf.RigidBody(name, sf.Joint(f"to_{name}", "prismatic", "rod", place, **turned), BODY)  # type: ignore[arg-type]
        for name, place in (("one", "middle"), ("two", "middle"), ("three", "quarter"))
    ]
    beam = rod((1, 0, 0), HUB, frames=(*FRAMES, sf.Frame("quarter", at=0.25)), sections=1, rotary_inertia=True)
    system = sf.System("whole", (beam, *bodies), gravity=GRAVITY)
    given = {way: interpreted(system, "forward_dynamics", forward_dynamics=way) for way in ("articulated", "factors")}
    model = given["factors"]
    q, v = model.random_state(np.random.default_rng(4))
    u = np.linspace(-1.0, 1.0, model.nu)
    one, other = (m.forward_dynamics(0.3 * q, v, u) for m in given.values())
    np.testing.assert_allclose(one, other, rtol=0, atol=1e-10 * np.abs(other).max())
