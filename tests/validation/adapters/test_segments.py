"""Beams as rigid links with springs: what two engines without beams make of them as links grow in number."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.reference.beams import data
from tests.validation.subjects import UNIT, states_of
from validation.adapters.exudyn.ancf import Strip, princeton
from validation.adapters.lumped import Lumped, lumped
from validation.adapters.mujoco import tree as mujoco
from validation.adapters.pinocchio import tree as pinocchio
from validation.adapters.segments import segmented
from validation.comparison.errors import compute, state_errors, typical_scales
from validation.contract.interface import Subject, Unsupported
from validation.contract.quantities import QUANTITIES

TREE_ENGINES = {"pinocchio": pinocchio.build, "mujoco": mujoco.build}


def cantilever(joint: sf.Joint | None = None, **changed: Any) -> sf.System:
    """A beam of unit length, mass and stiffness; its polar inertia is one that a short link can have."""
    plain = {"EI_z": 1.0, "bend_y": 1, "rhoJ": 1e-6}
    beam = sf.Beam("b", joint or sf.Joint("root"), 1.0, **({"rhoA": 1.0} | plain | changed))
    return sf.System("cantilever", [beam], gravity=(0, 0, 0))


def rotor(radius: float) -> sf.System:
    """The same, free to bend both ways, at a radius of a hub."""
    hub = sf.RigidBody("hub", sf.Joint("turn", "revolute"), sf.Inertia(1.0, moments=(1.0, 1.0, 1.0)))
    root = sf.Joint("root", "fixed", "hub", position=(radius, 0, 0))
    (beam,) = cantilever(root, EI_y=1.0, bend_z=1).bodies
    return sf.System("rotor", [hub, beam], gravity=(0, 0, 0))


def links_of(system: sf.System, links: int, engine: str = "pinocchio") -> Lumped:
    found = lumped(system, "b", links, TREE_ENGINES[engine])
    assert not isinstance(found, Unsupported), found
    return found


def orders(errors: list[Any]) -> np.ndarray:
    """Of convergence, where the number of links doubles."""
    sizes = np.abs(np.array(errors))
    return np.log2(sizes[:-1] / sizes[1:])


@pytest.mark.parametrize("engine", TREE_ENGINES)
@pytest.mark.parametrize(
    "row",
    [row for row in data("elastica_tip_load")["table"] if row["alpha"] in (0.05, 0.75, 10)],
    ids=lambda row: f"alpha {row['alpha']}",
)
def test_deflection_at_rest_converges_to_the_elastica(engine: str, row: dict[str, Any]) -> None:
    exact = np.array([1.0 - row["tip_shortening"], row["tip_y"]])
    poses = [links_of(cantilever(), n, engine).tip_at_rest((0, row["alpha"], 0))[:2] for n in (8, 16, 32)]
    np.testing.assert_allclose(orders([float(np.linalg.norm(pose - exact)) for pose in poses]), 2.0, atol=0.02)
    # Richardson's extrapolation shows that the limit itself is right.
    np.testing.assert_allclose((4 * poses[2] - poses[1]) / 3, exact, atol=2e-6)


@pytest.mark.parametrize(("turn", "plane"), [("yaw", "chord"), ("pitch", "flap")])
@pytest.mark.parametrize(("eta", "atol"), [(0, 0.01), (3, 0.01), (12, 0.09)])
def test_frequencies_of_a_spinning_beam_converge(turn: str, plane: str, eta: int, atol: float) -> None:
    """The faster it spins, the thinner the layer at the root that bends, and the later the order shows."""
    (row,) = (row for row in data("spinning_cantilever")["table"] if row["eta"] == eta and row["delta"] == 1)
    exact = np.array(row[plane][:2])
    found = [links_of(rotor(1.0), n).spinning(eta, turn, 2) for n in (16, 32)]
    np.testing.assert_allclose(orders([x - exact for x in found]), 2.0, atol=atol)
    np.testing.assert_allclose((4 * found[1] - found[0]) / 3, exact, rtol=1e-4)


@pytest.mark.slow
def test_a_strip_bent_both_ways_twists_as_exudyns_does() -> None:
    """The Princeton strip at 45 degrees: three models that share nothing, to 1e-4 of the deflection."""
    strip, load = Strip(), 8.896
    part = float(np.sqrt(0.5))
    beam = sf.Beam(
        "b",
        sf.Joint("root"),
        strip.length,
        1.0,
        EI_y=strip.EI_y,
        EI_z=strip.EI_z,
        GJ=strip.GJ,
        bend_y=1,
        bend_z=1,
        twist=1,
    )
    system = sf.System("strip", [beam], gravity=(0, 0, 0))
    tips = [links_of(system, n).tip_at_rest((0, load * part, load * part))[:3] for n in (4, 8, 16)]
    assert np.all(orders([tips[1] - tips[0], tips[2] - tips[1]]) < 1.7)  # Turns that follow each other: first order.
    first = [2 * fine - coarse for coarse, fine in zip(tips, tips[1:], strict=False)]
    tip = (4 * first[1] - first[0]) / 3 - (strip.length, 0, 0)
    coarse, fine = (princeton(load, np.pi / 4, n)[0] for n in (16, 32))
    exact = (4 * fine - coarse) / 3
    exact[1:] -= load * part * strip.length / strip.GA  # Ours does not shear.
    np.testing.assert_allclose(tip, exact, atol=1e-4 * float(np.linalg.norm(exact)))
    linear = load * part * strip.length**3 / 3 / np.array([strip.EI_z, strip.EI_y])
    assert np.all(np.abs(exact[1:] / linear - 1) > 0.03)  # So the coupling is felt.


def test_two_engines_agree_on_the_links() -> None:
    """A tapered beam with everything, carrying a body on its tip, on a joint that moves."""
    system = carrying({"rhoA": "1.2 - x/2", "EI_y": "1 - x/2", "GJ": 0.5, "bend_z": 2, "twist": 1, "damping": 0.1})
    found = segmented(system, "b", 5)
    assert not isinstance(found, Unsupported)
    subject = Subject("links", found, ("tip", "load"))
    states = states_of(subject)
    ours, theirs = pinocchio.build(subject), mujoco.build(subject)
    assert not isinstance(ours, Unsupported) and not isinstance(theirs, Unsupported)
    scales = typical_scales(ours, states)
    for name in ("mass_matrix", "bias", "frame_pose", "frame_jacobian"):
        quantity = QUANTITIES[name]
        errors = state_errors(quantity, compute(ours, quantity, states), compute(theirs, quantity, states), scales)
        assert errors.max() <= quantity.tolerance, name


def carrying(changed: dict[str, Any]) -> sf.System:
    beams = cantilever(sf.Joint("root", "free"), **changed)
    load = sf.RigidBody("load", sf.Joint("grip", "fixed", "b", "tip", (0.1, 0, 0)), UNIT)
    return replace(beams, bodies=(*beams.bodies, load))


def test_links_weigh_and_balance_like_the_beam() -> None:
    """Straight, the links are the same rigid body as the beam, taper and what the tip carries included."""
    system = carrying({"rhoA": "1.2 - x/2"})
    found = segmented(system, "b", 3)
    assert not isinstance(found, Unsupported)
    blocks = []
    for each in (system, found):
        model = sf.compile(each, sf.Options(("mass_matrix",), backend="interpreter"))
        q = np.zeros(model.nq)
        q[6] = 1.0
        blocks.append(model.mass_matrix(q)[:6, :6])
    np.testing.assert_allclose(blocks[1], blocks[0], atol=1e-13)


def test_damping_is_in_proportion_to_stiffness() -> None:
    found = segmented(cantilever(damping=0.25), "b", 4)
    assert not isinstance(found, Unsupported)
    hinges = [body.joint for body in found.bodies[1:] if body.joint is not None]
    assert [element for joint in hinges for element in joint.elements] == [sf.Spring(4.0), sf.Damper(1.0)] * 4


@pytest.mark.parametrize("axis", [0.3, 1.0])
def test_a_load_at_a_station_acts_there(axis: float) -> None:
    system = cantilever(loads=(sf.BeamLoad((0, 1.0, 0), at=axis, axes="world"),))
    found = segmented(system, "b", 4)
    assert not isinstance(found, Unsupported)
    model = sf.compile(found, sf.Options(("generalized_force",), backend="interpreter"))
    arms = np.maximum(axis - (np.arange(4) + 0.5) / 4, 0.0)
    np.testing.assert_allclose(model.generalized_force(np.zeros(4), np.zeros(4), ()), arms, atol=1e-15)


@pytest.mark.parametrize(
    ("changed", "word"),
    [
        ({"bend_y": 0}, "rigid"),
        ({"loads": (sf.BeamLoad((0, 1.0, 0)),)}, "spread"),
        ({"loads": (sf.BeamLoad((0, 1.0, 0), at=1.0),)}, "axes of its root"),
    ],
    ids=lambda x: x if isinstance(x, str) else "",
)
def test_what_links_cannot_represent_is_named(changed: dict[str, Any], word: str) -> None:
    answer = segmented(cantilever(**changed), "b", 4)
    assert isinstance(answer, Unsupported) and word in answer.reason
