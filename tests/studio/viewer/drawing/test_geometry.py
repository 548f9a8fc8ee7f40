"""What is drawn of a mechanism."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from reference_models.closed.spatial import delta_guess
from symofros.studio.viewer.drawing.drawing import Drawing, same_geometry
from symofros.studio.viewer.drawing.poses import Mechanism, beam_sweep, connector_sweep
from tests.models import sampled

# Beams, rods, slides, wheels, free bodies, joints of every kind, loops in the plane and in space, a long chain.
SMALL = tuple(
    "flexible_slider_crank rolling_disc slider_crank free_boom planar_robot car cart_pole gyroscope joint_zoo"
    " space_arm chain7 ssrms stewart delta_rods".split()
)


@cache
def mechanism(name: str) -> Mechanism:
    return Mechanism(MODELS[name])


@cache
def drawing(name: str) -> Drawing:
    return mechanism(name).drawing()


@pytest.mark.parametrize("name", sampled(tuple(MODELS), SMALL))
def test_every_reference_model_is_drawn(name: str) -> None:
    found, links = drawing(name), len(mechanism(name).tree.links)
    names = [item.name for item in (*found.parts, *found.beams, *found.connectors)]
    assert len(names) == len(set(names))
    assert all(-1 <= part.link < links and np.all(np.isfinite(part.mesh.vertices)) for part in found.parts)
    assert all(part.mesh.faces.max() < len(part.mesh.vertices) for part in found.parts)
    assert found.parts and 0.0 < found.size < 100.0
    # Where loops can't be closed from the neutral configuration, it is that which is shown.
    posture = mechanism(name).posture(mechanism(name).closed(mechanism(name).state())[0].q)
    for sweep in (
        *(beam_sweep(x, posture) for x in found.beams),
        *(connector_sweep(x, posture) for x in found.connectors),
    ):
        assert np.all(np.isfinite(sweep.points)) and np.all(np.isfinite(sweep.axes))
    # Every piece is of an entry of the description, and every body can be chosen: it is drawn, or has its frame.
    system = MODELS[name]
    bodies = {body.name for body in system.bodies}
    entries = {"world"} | {f"bodies/{body}" for body in bodies} | {f"bodies/{body}/joint" for body in bodies}
    entries |= {f"bodies/{body.name}/frames/{frame.name}" for body in system.bodies for frame in body.frames}
    entries |= {f"closures/{item.name}" for item in system.constraints if isinstance(item, (sf.Closure, sf.Rod))}
    entries |= {f"nonholonomic/{item.name}" for item in system.constraints}
    entries |= {f"connections/{item.name}" for item in system.connections}
    pieces = (*found.parts, *found.beams, *found.connectors, *found.triads)
    assert {piece.name: piece.element for piece in pieces if piece.element not in entries} == {}
    ground = {f"bodies/{mechanism(name).tree.frames[0].qualified}"}
    assert {f"bodies/{body}" for body in bodies} - {piece.element for piece in pieces} <= ground


def test_bodies_have_boxes_and_links_from_joint_to_joint_and_joints_their_signs() -> None:
    of_four_bar = {part.name: part.mesh.vertices for part in drawing("four_bar").parts}
    pin, bar = of_four_bar["joints/q1"], of_four_bar["bodies/crank"]
    assert np.ptp(pin[:, 1]) > 1.5 * np.ptp(pin[:, [0, 2]], axis=0).max()  # About -y.
    assert bar[:, 0].min() == pytest.approx(0.0, abs=0.02) and bar[:, 0].max() == pytest.approx(1.0, abs=0.02)
    found = {part.name: part for part in drawing("puma560").parts}
    assert {f"inertias/link{i}" for i in range(1, 7)} <= found.keys()
    assert {f"joints/q{i}" for i in range(1, 7)} <= found.keys()
    assert not drawing("puma560").inertias_fit  # Its first link's moments are a placeholder, of a cube of 1.4 m.
    assert drawing("planar_robot").inertias_fit


def test_a_closure_shows_its_gap_and_a_rod_is_as_long_as_it_is_stated_where_loops_are_closed() -> None:
    (gap,), it = drawing("four_bar").connectors, mechanism("four_bar")
    for q3, least, most in ((1.2, 0.0, 1e-12), (1.0, 0.1, 1.0)):
        ends = connector_sweep(gap, it.posture([1.2, -1.2, q3])).points
        assert least <= np.linalg.norm(ends[1] - ends[0]) < most
    it = mechanism("delta")
    state, why = it.closed(it.state(delta_guess()))
    assert not why
    posture = it.posture(state.q)
    lengths = {f"constraints/{item.name}": item.length for item in it.system.constraints if isinstance(item, sf.Rod)}
    rods = [connector for connector in drawing("delta").connectors if connector.name in lengths]
    assert rods
    for rod in rods:
        stated = lengths[rod.name]
        length = np.linalg.norm(np.diff(connector_sweep(rod, posture).points, axis=0))
        assert length == pytest.approx(sf.evaluate(stated, it.system.parameter_values()), abs=1e-9)


def test_a_rolling_disc_touches_the_ground() -> None:
    system = MODELS["rolling_disc"]
    it = mechanism("rolling_disc")
    mark = next(part for part in drawing("rolling_disc").parts if part.name.startswith("constraints/"))
    (contact,) = (item for item in system.constraints if isinstance(item, sf.Rolling))
    assert np.linalg.norm(mark.mesh.vertices[:, :2], axis=1).max() == pytest.approx(
        sf.evaluate(contact.radius, system.parameter_values())
    )
    assert it.model.nc == 3


def test_a_beam_that_is_stiffer_one_way_is_drawn_wider_that_way() -> None:
    def outline(**more: float) -> np.ndarray:
        beam = sf.Beam("b", sf.Joint("clamp"), 1.0, 1.0, bend_y=1, bend_z=1, **({"EI_z": 4.0, "EI_y": 1.0} | more))
        return np.ptp(Mechanism(sf.System("s", [beam])).drawing().beams[0].outline, axis=0)

    wide = outline()
    assert wide[0] / wide[1] == pytest.approx(2.0)
    # Also without a frame at its tip.
    bare = replace(sf.Beam("b", sf.Joint("clamp"), 1.0, 1.0, EI_z=1.0, bend_y=2), frames=())
    it = Mechanism(sf.System("s", [bare]))
    assert beam_sweep(it.drawing().beams[0], it.posture([0.1, 0.2])).points[-1, 1] != 0.0
    # A round bar of radius 0.02 m: A = rhoA for unit density, I = A r^2/4.
    assert np.allclose(outline(rhoI_y=1e-4, rhoI_z=1e-4), 0.04)


@pytest.mark.parametrize(
    "name", ["planar_robot", "puma560", pytest.param("flexible_mss", marks=pytest.mark.slow), "joint_zoo"]
)
def test_links_are_where_the_whole_model_has_them(name: str, rng: np.random.Generator) -> None:
    it, model = mechanism(name), sf.compile(MODELS[name])
    q, _ = model.random_state(rng)
    posture = it.posture(q)
    for triad in drawing(name).triads:
        p, R = model.frame_pose(triad.name, q)
        assert np.allclose(posture.p[triad.link] + posture.R[triad.link] @ triad.position, p, atol=1e-12)
        assert np.allclose(posture.R[triad.link] @ triad.rotation, R, atol=1e-12)


def test_exaggeration_scales_elastic_coordinates_only_and_attached_bodies_stay_on_the_tip() -> None:
    it = mechanism("planar_robot")
    posture = it.posture(np.full(it.model.nq, 0.01), exaggeration=7.0)
    elastic = np.array(["[" in name for name in it.model.names.q])
    assert np.allclose(posture.q[elastic], 0.07) and np.allclose(posture.q[~elastic], 0.01) and elastic.sum() == 6
    end = beam_sweep(drawing("planar_robot").beams[0], posture).points[-1]
    tip = next(triad for triad in drawing("planar_robot").triads if triad.name == "link1.tip")
    assert np.allclose(end, posture.p[tip.link] + posture.R[tip.link] @ tip.position, atol=1e-12)


def test_parameters_change_the_drawing_where_it_depends_on_them() -> None:
    it = mechanism("planar_robot")
    names, par = it.model.names.par, np.array(it.model.parameter_values)
    longer, stiffer = par.copy(), par.copy()
    longer[names.index("L1")] *= 2
    stiffer[names.index("k1")] *= 2
    assert same_geometry(it.drawing(), it.drawing(stiffer)) and not same_geometry(it.drawing(), it.drawing(longer))
    assert it.drawing(longer).beams[0].length == pytest.approx(1.0)


def test_loops_that_cannot_close_are_reported() -> None:
    it = mechanism("four_bar")
    state, why = it.closed(it.state([0.5, -2.0, 2.5]), held=("q1", "q2"))
    assert "can't be assembled" in why and np.array_equal(state.q, [0.5, -2.0, 2.5])


def test_contacts_show_their_balls_and_the_solids_that_push_them() -> None:
    """Extents of the pieces, in their frames."""
    solids: dict[str, tuple[dict[str, Any], tuple[float, float]]] = {
        "sphere": ({"surface_radius": 0.3}, (-0.3, 0.3)),
        "capsule": ({"surface_radius": 0.1, "length": 0.4}, (-0.3, 0.3)),
        "box": ({"size": (0.2, 0.4, 0.6)}, (-0.3, 0.3)),
    }
    ball = sf.RigidBody("ball", sf.Joint("j", "free"), sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)))
    other = sf.RigidBody("other", sf.Joint("k", "free"), sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)))
    for surface, (measures, extent) in solids.items():
        points = [(0, 0, 0.5), (0, 0, -0.5)]
        touch = sf.Contact("c", ("ball", None), ("other", None), 1e4, surface, 0.05, points, **measures)
        found = {
            part.name: part for part in Mechanism(sf.System("s", [ball, other], connections=[touch])).drawing().parts
        }
        z = found["constraints/c.surface"].mesh.vertices[:, 2]
        np.testing.assert_allclose((z.min(), z.max()), extent, atol=1e-3)
        z = found["constraints/c.balls"].mesh.vertices[:, 2]
        np.testing.assert_allclose((z.min(), z.max()), (-0.55, 0.55), atol=1e-3)
        assert found["constraints/c.balls"].element == "contacts/c"
    hollow = replace(touch, surface="cylinder", surface_radius=0.5, size=None, inside=True)
    names = [part.name for part in Mechanism(sf.System("s", [ball, other], connections=[hollow])).drawing().parts]
    assert "constraints/c.balls" in names and "constraints/c.surface" not in names


def test_names_with_dots_lead_to_the_elements_that_have_them() -> None:
    inertia = sf.Inertia(1.0, (0, 0, 0), (1, 1, 1))
    inner = sf.RigidBody("arm", sf.Joint("j", "revolute"), inertia, [sf.Frame("left.tip", (1, 0, 0))])
    outer = sf.RigidBody(
        "arm.left", sf.Joint("k", "revolute", "arm", "left.tip"), inertia, [sf.Frame("end", (1, 0, 0))]
    )
    drawn = Mechanism(sf.System("s", [inner, outer])).drawing()
    elements = {triad.element for triad in drawn.triads}
    assert {"bodies/arm/frames/left.tip", "bodies/arm.left", "bodies/arm.left/frames/end"} <= elements
