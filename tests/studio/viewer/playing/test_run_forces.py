"""Arrows of forces: what they are obeys Newton's law, where they stand is where it acts, their scale is stated."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.errors import SymofrosError, UnknownNameError
from symofros.studio.viewer.drawing.layers import ArrowScale
from symofros.studio.viewer.drawing.poses import Mechanism
from symofros.studio.viewer.playing.run_forces import RunForces

FORCES, MOMENTS = frozenset({"forces"}), frozenset({"moments"})
GRAVITY = np.array([0.0, 0.0, -9.81])


@cache
def loop() -> tuple[Mechanism, sf.Trajectory, RunForces]:
    """A falling four-bar linkage."""
    mechanism = Mechanism(MODELS["four_bar"])
    model = sf.compile(mechanism.system)
    start = sf.assemble(model, [0.6, 0.0, 0.0], held=(model.names.v[0],)).q
    run = sf.simulate(model, start, t_end=0.1, dt=1e-3)
    return mechanism, run, RunForces(run, mechanism.tree, mechanism.drawing())


def of(mechanism: Mechanism, run: sf.Trajectory, forces: RunForces, k: int, layer: str = "forces") -> np.ndarray:
    """Tails and vectors (K, 2, 3) of a layer's arrows at a record."""
    posture = mechanism.posture(run.q[k], run.u[k], run.par)
    ends, scale = forces.arrows(float(run.t[k]), posture, frozenset({layer}))[layer], forces.scales[layer]
    assert scale is not None
    ends = ends[np.isfinite(ends).all(axis=(1, 2))]
    return np.stack([ends[:, 0], (ends[:, 1] - ends[:, 0]) * scale.value / scale.length], axis=1)


def test_joint_and_closure_hold_a_body_by_newtons_law() -> None:
    mechanism, run, forces = loop()
    p, R = run.frames["coupler"]
    C = p + R @ np.array([0.5, 0.0, 0.0])
    for k in (20, 50, 80):
        acceleration = (C[k + 1] - 2 * C[k] + C[k - 1]) / 1e-6
        found = of(mechanism, run, forces, k)
        ends = [run.frames[name][0][k] for name in ("coupler", "coupler.end")]
        held = [next(f for tail, f in found if np.allclose(tail, end, atol=1e-9)) for end in ends]
        assert np.linalg.norm(held[1]) > 0.5
        np.testing.assert_allclose(sum(held) + GRAVITY, acceleration, atol=1e-3)


def test_a_loop_that_is_closed_more_than_needed_says_that_its_forces_are_not_unique() -> None:
    """A plane four-bar whose closure holds its third direction as well, which its joints do already."""
    mechanism, _, forces = loop()
    assert len(forces.legend(FORCES)) == 1
    (closure,) = mechanism.system.constraints
    more = Mechanism(replace(mechanism.system, constraints=[replace(closure, translations=list("xyz"))]))
    model = sf.compile(more.system)
    start = sf.assemble(model, [0.6, 0.0, 0.0], held=(model.names.v[0],)).q
    run = sf.simulate(model, start, t_end=0.01, dt=1e-3)
    drawn = RunForces(run, more.tree, more.drawing())
    assert "undetermined" in drawn.legend(FORCES)[1] and drawn.legend(frozenset()) == []


def test_a_loop_that_is_flat_at_its_start_has_forces_that_are_unique() -> None:
    """A parallelogram, one crank of it beside, whose two conditions are one where all links are along a line."""
    flat = MODELS["parallelogram"]
    mechanism = Mechanism(replace(flat, constraints=flat.constraints[:1]))
    model = sf.compile(mechanism.system)
    run = sf.simulate(model, sf.assemble(model, [0.6, -0.6, 0.6, 0.0], held=("q1",)).q, t_end=0.01, dt=1e-3)
    q = run.q.copy()
    q[0] = 0.0
    assert model.constrained_dynamics(q[0], run.v[0], run.u[0])[2] == 1
    assert len(RunForces(replace(run, q=q), mechanism.tree, mechanism.drawing()).legend(FORCES)) == 1


def test_a_beating_of_rounding_is_no_moment_and_hidden_layers_have_no_arrows() -> None:
    mechanism, run, forces = loop()
    assert forces.scales["moments"] is None
    posture = mechanism.posture(run.q[0])
    assert forces.legend(FORCES | MOMENTS)[1] == "no moments in this run" and forces.legend(frozenset()) == []
    assert not any(len(ends) for ends in forces.arrows(0.0, posture, frozenset({"bodies"})).values())


def test_arrows_are_linear_in_time_between_records() -> None:
    mechanism, run, forces = loop()
    posture = mechanism.posture(run.q[10])
    at = [forces.arrows(t, posture, FORCES)["forces"] for t in (0.010, 0.0105, 0.011)]
    np.testing.assert_allclose(at[1], (at[0] + at[2]) / 2, atol=1e-12)
    assert not np.allclose(at[0], at[2], atol=1e-5)


def test_a_ball_at_rest_is_carried_by_its_contact_and_a_cantilever_by_a_moment() -> None:
    ball = sf.RigidBody("ball", sf.Joint("free", "free"), sf.Inertia(0.4, moments=(1.6e-3,) * 3))
    floor = sf.Contact("floor", ("ball", None), ("world", None), 1e4, exponent=1.0, radius=0.1)
    arm = sf.RigidBody(
        "arm", sf.Joint("hinge", "revolute", axis=(0, 1, 0), actuated=True), sf.Inertia(2.0, (0.5, 0, 0), (0.1,) * 3)
    )
    system = sf.System("held", [ball, arm], connections=[floor])
    model = sf.compile(system)
    start = model.neutral()
    start[model.names.q.index("free.px")] = -1.0
    start[model.names.q.index("free.pz")] = 0.1 - 0.4 * 9.81 / 1e4
    run = sf.simulate(model, start, u=[-9.81], t_end=0.01, dt=1e-3)
    mechanism = Mechanism(system)
    forces = RunForces(run, mechanism.tree, mechanism.drawing())
    carried = {tuple(np.round(tail, 3)): f for tail, f in of(mechanism, run, forces, 5)}
    np.testing.assert_allclose(carried[0.0, 0.0, 0.0], [0.0, 0.0, 2.0 * 9.81], atol=1e-9)
    assert len(carried) == 2
    np.testing.assert_allclose(sum(carried.values()), [0.0, 0.0, 2.4 * 9.81], atol=1e-6)
    [(_, moment)] = of(mechanism, run, forces, 5, "moments")
    np.testing.assert_allclose(moment, [0.0, -9.81, 0.0], atol=1e-9)


def rigid(spin: float, plate: bool) -> tuple[sf.Trajectory, np.ndarray, np.ndarray]:
    """A ball on the ground, or on a plate that swings down: run, forces on it and number of forces at three records."""
    ball = sf.RigidBody("ball", sf.Joint("free", "free"), sf.Inertia(0.4, moments=(1.6e-3,) * 3))
    surface = ("plate", "top") if plate else ("world", None)
    floor = sf.Contact("floor", ("ball", None), surface, restitution=0.0, radius=0.1, friction=0.3)
    hinge = sf.Joint("hinge", "revolute", axis=(0, 1, 0))
    top = sf.Frame("top", (0.2, 0.0, 0.0), sf.Rotation.rpy(0, 0, 0.4))
    swing = sf.RigidBody("plate", hinge, sf.Inertia(3.0, (0.5, 0, 0), (0.5,) * 3), frames=[top])
    system = sf.System("rigid", [swing, ball] if plate else [ball], connections=[floor])
    model = sf.compile(system)
    start, speeds = model.neutral(), np.zeros(model.nv)
    x, z = (model.names.q.index(f"free.p{axis}") for axis in "xz")
    start[x], start[z] = 0.15, 0.1
    speeds[model.names.v.index("free.wy")] = spin
    run = sf.simulate(model, start, speeds, t_end=0.05, dt=1e-3)
    mechanism = Mechanism(system)
    forces = RunForces(run, mechanism.tree, mechanism.drawing())
    found = [of(mechanism, run, forces, k) for k in (10, 20, 30)]
    held = [f for each in found for tail, f in each if tail[2] < 0.09 and tail[0] > 0.05]
    return run, np.array(held), np.array([len(each) for each in found])


@pytest.mark.parametrize(("spin", "plate", "arrows"), [(40.0, False, 1), (0.0, False, 1), (40.0, True, 2)])
def test_rigid_contacts_carry_a_ball_by_newtons_law(spin: float, plate: bool, arrows: int) -> None:
    """Sliding, at rest, and on a surface that turns; the joint of a free ball transmits nothing."""
    run, held, count = rigid(spin, plate)
    p = run.frames["ball"][0]
    for force, k in zip(held, (10, 20, 30), strict=True):
        acceleration = (p[k + 1] - 2 * p[k] + p[k - 1]) / 1e-6
        np.testing.assert_allclose(force / 0.4 + GRAVITY, acceleration, atol=2e-2)
        assert spin == 0.0 or np.linalg.norm(force[:2]) > 0.1
    assert (count == arrows).all()


@pytest.mark.parametrize(("largest", "length", "value"), [(37.0, 0.2, 20.0), (0.0099, 0.2, 0.005), (1000.0, 0.2, 1e3)])
def test_the_scale_is_of_round_numbers(largest: float, length: float, value: float) -> None:
    scale = ArrowScale.of("forces", largest, 1.5)
    assert scale is not None and (scale.length, scale.value) == (length, value)
    assert scale.legend.startswith(f"forces (red): {length:g} m is {value:g} N, none below")
    points = np.zeros((3, 3))
    ends = scale.arrows(points, np.array([[value, 0, 0], [0.99 * scale.smallest, 0, 0], [np.nan, 0, 0]]))
    np.testing.assert_allclose(ends[0], [[0, 0, 0], [length, 0, 0]], atol=1e-12)
    assert np.isnan(ends[1:]).all()
    assert ArrowScale.of("forces", 0.0, 1.5) is None and ArrowScale.of("forces", np.nan, 1.5) is None


def test_the_page_shows_and_hides_the_forces_of_the_run_that_plays() -> None:
    _, run, _ = loop()
    with sf.Viewer(MODELS["four_bar"], port=0) as viewer:
        viewer.play((run.t, run.q))
        assert "forces" not in viewer._panel._boxes
        viewer.play(run)
        viewer.toggle()
        viewer.set_layer("forces", True)

        def node() -> object:
            return viewer._server.scene.get_handle_by_name("/mechanism/forces")

        assert "forces (red): 0.2 m is" in viewer._panel._legend.content and viewer._panel._boxes["forces"].value
        viewer.seek(0.0)
        first = np.array(node().points)  # type: ignore[attr-defined]
        viewer.seek(0.1)
        assert node().visible and np.abs(node().points - first).max() > 1e-3  # type: ignore[attr-defined]
        # As many arrows throughout; those that do not show are out of sight, but of some length: pages keep others.
        assert len(node().points) == len(first) == 4  # type: ignore[attr-defined]
        assert (np.linalg.norm(np.diff(node().points, axis=1), axis=-1) > 1e-3).all()  # type: ignore[attr-defined]
        viewer.slide(0, 0.3)  # Of no run.
        assert not node().visible  # type: ignore[attr-defined]
        viewer.seek(0.05)
        viewer.set_layer("forces", False)
        assert not node().visible and viewer._panel._legend.content == ""  # type: ignore[attr-defined]


def test_recordings_show_forces_with_their_scale(tmp_path: Path) -> None:
    mechanism, run, _ = loop()
    plain, shown = (
        sf.record(mechanism.system, run, tmp_path / f"{i}.png", show=show, size=(160, 120)).read_bytes()
        for i, show in enumerate(((), ("forces",)))
    )
    assert plain != shown
    page = sf.record(mechanism.system, run, tmp_path / "m.html", show=("forces",), rate=10).read_text()
    assert "forces (red): 0.2 m is" in page
    with pytest.raises(SymofrosError, match="give the trajectory"):
        sf.record(mechanism.system, (run.t, run.q), tmp_path / "m.html", show=("forces",))
    with pytest.raises(UnknownNameError, match="did you mean 'forces'"):
        sf.record(mechanism.system, run, tmp_path / "m.html", show=("force",))
