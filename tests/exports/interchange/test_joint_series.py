"""MJCF of bodies that only carry: joints are gathered on the next body, or a note says that MuJoCo refuses them."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import mujoco
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import symofros as sf
from reference_models import MODELS
from symofros.exports.interchange.rigid import _parents_first
from symofros.mechanics.topology.tree import build_tree
from tests.models import sampled

SAME = 1e-10
SOLID = sf.Inertia(1.3, (0.2, 0.1, -0.3), (1.0, 1.2, 0.9, 0.1, 0.0, -0.1))
KINDS = ("revolute", "prismatic", "universal", "cylindrical", "fixed")


def series(seed: int, links: int) -> sf.System:
    """A branching tree of frames and axes at random, most of whose bodies only carry."""
    rng, bodies = np.random.default_rng(seed), list[sf.RigidBody]()
    for i in range(links):
        parent = bodies[int(rng.integers(max(0, i - 2), i))].name if i else "world"
        kind = KINDS[int(rng.integers(0, len(KINDS)))] if i else "revolute"
        joint = sf.Joint(
            f"q{i}",
            kind,  # type: ignore[arg-type]
            parent,
            position=tuple(rng.normal(size=3)),
            rotation=sf.Rotation.rpy(*rng.normal(size=3)),
            axis=(1, 0.3, 0.1),
            axis2=(-0.3, 1, 0) if kind == "universal" else (0, 1, 0),
        )
        bodies.append(sf.RigidBody(f"b{i}", joint, SOLID if rng.random() < 0.4 else None))
    parents = {body.joint.parent for body in bodies if body.joint is not None}
    ends = [body if body.name in parents else sf.RigidBody(body.name, body.joint, SOLID) for body in bodies]
    return sf.System("series", ends)


def mass_matrix(engine: mujoco.MjModel, model: sf.Model, q: np.ndarray) -> np.ndarray:
    """MuJoCo's, in our order of speeds; joints of single axes."""
    data = mujoco.MjData(engine)
    joints = [engine.joint(name) for name in model.names.q]
    for joint, value in zip(joints, q, strict=True):
        data.qpos[joint.qposadr[0]] = value
    mujoco.mj_forward(engine, data)
    M = np.zeros((engine.nv, engine.nv))
    mujoco.mj_fullM(engine, data, M)
    order = [joint.dofadr[0] for joint in joints]
    return M[np.ix_(order, order)]


@settings(max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(seed=st.integers(0, 10**6), links=st.integers(1, 7))
def test_exported_mjcf_has_the_same_mass_matrix(
    tmp_path_factory: pytest.TempPathFactory, seed: int, links: int
) -> None:
    system = series(seed, links)
    done = sf.export(system, "mjcf", tmp_path_factory.mktemp("mjcf"))
    try:
        engine = mujoco.MjModel.from_xml_path(str(done.files[0]))
    except ValueError as error:
        assert any("MuJoCo refuses" in note for note in done.notes), error
        return
    assert not any("MuJoCo refuses" in note for note in done.notes)
    model = sf.compile(system, sf.Options(backend="interpreter"))
    q = np.random.default_rng(seed).normal(size=model.nq)
    if model.nv:
        ours = model.mass_matrix(q)
        np.testing.assert_allclose(mass_matrix(engine, model, q), ours, rtol=0, atol=SAME * np.abs(ours).max())


def test_a_chain_of_massless_carriers_becomes_one_body(tmp_path: Path) -> None:
    """Gimbal rings: three turns about places of their own, one body."""
    bodies = [
        sf.RigidBody("outer", sf.Joint("roll", "revolute", axis=(1, 0, 0), position=(0, 0, 1)), None),
        sf.RigidBody("inner", sf.Joint("pitch", "revolute", "outer", axis=(0, 1, 0), position=(0.1, 0, 0)), None),
        sf.RigidBody("camera", sf.Joint("yaw", "revolute", "inner", position=(0, 0.2, 0)), SOLID),
    ]
    done = sf.export(sf.System("gimbal", bodies), "mjcf", tmp_path)
    engine = mujoco.MjModel.from_xml_path(str(done.files[0]))
    assert (engine.nbody, engine.njnt, done.notes) == (2, 3, ())
    np.testing.assert_allclose(engine.joint("roll").pos, [-0.1, -0.2, 0.0], atol=1e-15)


@pytest.mark.parametrize(("carriers", "kind"), [(3, "universal"), (6, "revolute"), (2, "universal"), (5, "revolute")])
def test_no_body_takes_over_more_joints_than_mujoco_lets_it_have(carriers: int, kind: str, tmp_path: Path) -> None:
    """Six: a body with them all loads; what more of them there are is left, with the note that MuJoCo refuses it."""
    bodies, parent = [], "world"
    for i in range(carriers + 1):
        joint = sf.Joint(f"q{i}", kind, parent, position=(0, 0, 0.1), axis=(i % 2, 1 - i % 2, 0), axis2=(0, 0, 1))  # type: ignore[arg-type]
        parent = f"b{i}"
        bodies.append(sf.RigidBody(parent, joint, SOLID if i == carriers else None))
    done = sf.export(sf.System("chain", bodies), "mjcf", tmp_path)
    gathered = (carriers + 1) * (2 if kind == "universal" else 1)
    if gathered <= 6:
        assert mujoco.MjModel.from_xml_path(str(done.files[0])).njnt == gathered and not done.notes
    else:
        assert any("MuJoCo refuses" in note for note in done.notes)
        with pytest.raises(ValueError, match="mass and inertia of moving bodies"):
            mujoco.MjModel.from_xml_path(str(done.files[0]))


def test_notes_name_frames_of_carriers_and_refused_items(tmp_path: Path) -> None:
    """A carrier of two bodies can't be gathered; a frame of one has no place in the body that takes it over."""
    ring = sf.RigidBody("ring", sf.Joint("a", "revolute"), None, [sf.Frame("mark", (1, 0, 0))])
    wheels = [
        sf.RigidBody(f"wheel{i}", sf.Joint(f"w{i}", "revolute", "ring", "mark", axis=(i, 1, 0)), SOLID)
        for i in range(2)
    ]
    one = sf.export(sf.System("one", [ring, wheels[0]]), "mjcf", tmp_path / "one")
    assert one.notes == ("frames of bodies that only carry dropped: mark",)
    two = sf.export(sf.System("two", [ring, *wheels]), "mjcf", tmp_path / "two")
    assert two.notes == (
        "MuJoCo refuses bodies that move and have no mass (its option boundmass gives them some): ring",
    )


@pytest.mark.parametrize("name", sampled(MODELS, ["puma560", "car", "four_bar", "gyroscope", "space_arm"]))
def test_reference_models_load_in_mujoco_or_a_note_gives_the_reason(name: str, tmp_path: Path) -> None:
    build_tree(MODELS[name])
    try:
        done = sf.export(MODELS[name], "mjcf", tmp_path)
    except sf.ExportError:
        return
    try:
        mujoco.MjModel.from_xml_path(str(done.files[0]))
    except ValueError as error:
        assert any("MuJoCo refuses" in note for note in done.notes), error


def test_links_are_put_behind_their_parents_in_their_own_order() -> None:
    """A child that comes first waits, and so do its children."""
    parents = {"a": None, "b": "a", "c": "b", "d": "a", "e": "c", "f": None}
    for order in ("abcdef", "fedcba", "ecbadf", "bfaced"):
        links: Any = [SimpleNamespace(name=name, parent=parents[name]) for name in order]
        found = "".join(link.name for link in _parents_first(links))
        assert sorted(found) == sorted(order)
        assert all(found.index(parent) < found.index(name) for name, parent in parents.items() if parent)
        assert found == order if order == "abcdef" else found != order
