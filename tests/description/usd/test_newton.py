"""Newton's own reading of a stage, where Newton is installed: mass matrices and poses, to its single precision."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.description.usd.models import body, joint, prim, stage
from tests.late import require

require("pxr.Usd", "usd")
newton = require("newton", "engine-newton")
require("newton_usd_schemas", "engine-newton")

SINGLE = 5e-6
LINKS = 6


def vector(rng: np.random.Generator, size: float = 1.0) -> tuple[float, float, float]:
    x, y, z = map(float, rng.uniform(-size, size, 3))
    return x, y, z


def quaternion(rng: np.random.Generator) -> tuple[float, ...]:
    q = rng.standard_normal(4)
    return tuple(map(float, q / np.linalg.norm(q)))


def random_tree(seed: int) -> str:
    """A tree in which both frames of each joint are off their bodies."""
    rng = np.random.default_rng(seed)
    parts = []
    for k in range(LINKS):
        moments = tuple(map(float, np.sort(rng.uniform(0.5, 1.0, 3))))
        mass: dict[str, Any] = {"mass": float(rng.uniform(1.0, 3.0)), "centerOfMass": vector(rng, 0.3)}
        parts.append(body(f"b{k}", **mass, diagonalInertia=moments, principalAxes=quaternion(rng)))
        parent, kind = f"b{rng.integers(k)}" if k else "", "Prismatic" if k and rng.integers(2) else "Revolute"
        frames: dict[str, Any] = {"localPos0": vector(rng), "localRot0": quaternion(rng)}
        frames |= {"localPos1": vector(rng, 0.5), "localRot1": quaternion(rng)}
        parts.append(joint(kind, f"j{k}", parent, f"b{k}", axis="XYZ"[int(rng.integers(3))], **frames))
    text = stage(*parts).replace(
        'def Xform "robot"\n', 'def Xform "robot" (prepend apiSchemas = ["PhysicsArticulationRootAPI"])\n'
    )
    return text + prim("PhysicsScene", "scene")


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_newton_reads_the_same_mechanism(tmp_path: Path, seed: int) -> None:
    file = tmp_path / "robot.usda"
    file.write_text(random_tree(seed))
    builder = newton.ModelBuilder()
    builder.add_usd(str(file))
    theirs = builder.finalize(device="cpu")
    state, rng = theirs.state(), np.random.default_rng(seed)
    q = rng.uniform(-1.0, 1.0, theirs.joint_coord_count).astype(np.float32)
    state.joint_q.assign(q)
    state.joint_qd.zero_()
    newton.eval_fk(theirs, state.joint_q, state.joint_qd, state)
    H, poses = newton.eval_mass_matrix(theirs, state).numpy()[0], state.body_q.numpy()
    joints, bodies = ([str(path).rpartition("/")[2] for path in row] for row in (theirs.joint_label, theirs.body_label))
    ours = sf.compile(sf.load(file), sf.Options(backend="interpreter"))
    order = [joints.index(name) for name in ours.names.q]
    own = q[order].astype(float)
    M = ours.mass_matrix(own)
    assert np.abs(M - H[np.ix_(order, order)]).max() < SINGLE * np.abs(M).max()
    for name, pose in zip(bodies, poses, strict=True):
        np.testing.assert_allclose(ours.frame_pose(name, own)[0], pose[:3], atol=10.0 * SINGLE)
