"""Models with quaternions for the frameworks' tests, and states whose quaternions are of any length."""

from __future__ import annotations

import numpy as np

import symofros as sf


def hopper() -> sf.System:
    """A free body with a leg on a hinge that an input drives and a damper brakes."""
    base = sf.RigidBody("base", sf.Joint("float", "free"), sf.Inertia("m", (0.1, -0.05, 0.2), (0.5, 0.6, 0.7)))
    hip = sf.Joint(
        "hip", "revolute", "base", position=(0.2, 0.1, 0.0), axis=(0, 1, 0), actuated=True, elements=[sf.Damper("d")]
    )
    leg = sf.RigidBody("leg", hip, sf.Inertia(0.8, (0, 0, -0.2), (0.05, 0.06, 0.02)), [sf.Frame("toe", (0.1, 0, -0.4))])
    return sf.System("hopper", [base, leg], parameters=[sf.Parameter("m", 3.0), sf.Parameter("d", 0.2)])


def swing() -> sf.System:
    """A hinge that an input drives, and a body that hangs from it by a ball joint."""
    hinge = sf.Joint("hinge", "revolute", axis=(0, 1, 0), actuated=True)
    arm = sf.RigidBody("arm", hinge, sf.Inertia(0.8, (0.1, 0, -0.2), (0.05, 0.06, 0.02)))
    wrist = sf.Joint("wrist", "ball", "arm", position=(0, 0, -0.4))
    body = sf.RigidBody(
        "body", wrist, sf.Inertia("m", (0, 0.1, -0.1), (0.02, 0.03, 0.04)), [sf.Frame("toe", (0, 0, -1))]
    )
    return sf.System("swing", [arm, body], parameters=[sf.Parameter("m", 0.5)])


SYSTEMS = {"hopper": hopper, "swing": swing}


def states(m: sf.Model, n: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Configurations (n, nq) whose quaternions are not of unit length, and speeds (n, nv)."""
    q, v = (np.array(x) for x in zip(*(m.random_state(rng) for _ in range(n)), strict=True))
    for turning in turns(m):
        q[:, turning] *= rng.uniform(0.6, 1.7, size=(n, 1))
    return q, v


def turns(m: sf.Model) -> list[slice]:
    """The quaternions of q."""
    segments = [segment for segment in m.record.segments if segment.kind != "linear"]
    return [slice(segment.q + segment.translations, segment.q + segment.size) for segment in segments]


def unit(m: sf.Model, q: np.ndarray) -> np.ndarray:
    """The same configurations with unit quaternions."""
    q = q.copy()
    for turning in turns(m):
        q[..., turning] /= np.linalg.norm(q[..., turning], axis=-1, keepdims=True)
    return q


def rate_matrix(m: sf.Model, q: np.ndarray) -> np.ndarray:
    """N (nq, nv) of one configuration with unit quaternions, by differences along the manifold: q' = N v."""
    h = 1e-6
    return np.column_stack([(m.integrate(q, h * e) - m.integrate(q, -h * e)) / (2 * h) for e in np.eye(m.nv)])
