"""The same mechanism stated otherwise: other names, another order, other frames of links, other zeros and signs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import symofros as sf
from symofros.base.arrays import Array
from symofros.description import IDENTITY_POSE, Pose
from symofros.exports.interchange.rigid import Axis, RigidLink, rigid_links
from symofros.studio.differences.alignment import displacement
from symofros.studio.differences.mechanism import Move


def restated(
    system: sf.System, seed: int, *, names: bool = True, frames: bool = True, zeros: bool = True, fuse: bool = True
) -> sf.System:
    """A system of revolute, continuous, prismatic, fixed and free joints, stated otherwise.

    Args:
        system: The system.
        seed: Of the draw.
        names: Whether links and joints get other names; names of frames that stand for themselves stay.
        frames: Whether frames of links that carry or weigh something are placed otherwise.
        zeros: Whether coordinates get other zeros and signs.
        fuse: Whether some massive links on fixed joints become two.
    """
    rng = np.random.default_rng(seed)
    links, _ = rigid_links(system, None)
    carriers = {link.parent for link in links}
    gauges: dict[str, Pose] = {}
    called = {str(name): f"part_{k}" for k, name in enumerate(rng.permutation([link.name for link in links]))}
    bodies = []
    for link in links:
        stands = link.parent is None or (not link.mass and link.name not in carriers and link.joint.kind == "fixed")  # type: ignore[union-attr]
        gauges[link.name] = _gauge(link.axes, rng) if frames and not stands else IDENTITY_POSE
        body = _body(link, gauges, rng if zeros else None)
        if names and not stands:
            body = replace(
                body, name=called[link.name], joint=body.joint and replace(body.joint, name=f"j_{called[link.name]}")
            )
        if names and body.joint is not None:
            carried = next(x for x in links if x.name == link.parent)
            parent = called[str(link.parent)] if carried.parent is not None else str(link.parent)
            body = replace(body, joint=replace(body.joint, parent=parent))
        bodies.append(body)
    if fuse:
        bodies = [part for body in bodies for part in _split(body, rng)]
    if not names:
        return sf.System(system.name, tuple(bodies), gravity=system.gravity)
    return sf.System(system.name, tuple(_shuffled(bodies, rng)), gravity=system.gravity)


def _gauge(axes: tuple[Axis, ...], rng: np.random.Generator) -> Pose:
    """A frame of a link in its own: anywhere, but on the axis of a turn."""
    R = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    R *= np.sign(np.linalg.det(R))
    on_axis = axes and axes[0].turns
    p = 0.1 * rng.normal() * np.array(axes[0].direction) if on_axis else 0.1 * rng.normal(size=3)
    return Pose(p, R)


def _body(link: RigidLink, gauges: dict[str, Pose], rng: np.random.Generator | None) -> sf.RigidBody:
    G = gauges[link.name]
    R, center = G.R.T, G.inverse().p + G.R.T @ link.center
    I = R @ link.inertia @ R.T  # noqa: E741
    moments = (I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[0, 2], I[1, 2])
    inertia = sf.Inertia(link.mass, tuple(center), moments) if link.mass else None
    frames = []
    for name, p, turn in link.frames:
        at = G.inverse() @ Pose(p, turn)
        frames.append(sf.Frame(name, tuple(at.p), _rotation(at.R)))
    waive = ("massless_tip", "nonphysical_inertia")
    if link.joint is None:
        return sf.RigidBody(link.name, None, inertia, tuple(frames), waive)
    placed = gauges[str(link.parent)].inverse() @ Pose(link.position, link.rotation)
    joint = replace(link.joint, parent=str(link.parent), frame=None, effort=(), actuated=False)
    if link.axes:
        axis, sign, offset = np.array(link.axes[0].direction), 1.0, 0.0
        if rng is not None:
            sign, offset = rng.choice([-1.0, 1.0]), 0.3 * rng.normal()
        kind = "turn" if link.axes[0].turns else "slide"
        placed = placed @ displacement(_move(kind, axis), offset)
        limits = _limits(joint.limits, sign, offset)
        joint = replace(joint, axis=tuple(sign * (G.R.T @ axis)), limits=limits)
    placed = placed @ G
    joint = replace(joint, position=tuple(placed.p), rotation=_rotation(placed.R))
    return sf.RigidBody(link.name, joint, inertia, tuple(frames), waive)


def _move(kind: str, axis: Array) -> Move:
    return Move("", kind, kind, axis, np.zeros(3), 0.0, IDENTITY_POSE, IDENTITY_POSE, -1, {}, False)


def _limits(limits: sf.Limits | None, sign: float, offset: float) -> sf.Limits | None:
    """Limits of q' in q = sign q' + offset."""
    if limits is None or limits.lower is None or limits.upper is None:
        return limits
    ends = sorted((sign * (limits.lower - offset), sign * (limits.upper - offset)))
    return replace(limits, lower=ends[0], upper=ends[1])


def _rotation(R: Array) -> sf.Rotation:
    return sf.Rotation("matrix", tuple(R.ravel().tolist()))


def _split(body: sf.RigidBody, rng: np.random.Generator) -> list[sf.RigidBody]:
    """Some of the massive bodies as a massless one with a welded one on it."""
    if body.joint is None or body.inertia is None or rng.random() < 0.7:
        return [body]
    R = _gauge((), rng)
    I = np.array(body.inertia.moments, dtype=float)  # noqa: E741
    full = np.array([[I[0], I[3], I[4]], [I[3], I[1], I[5]], [I[4], I[5], I[2]]])
    full = R.R.T @ full @ R.R
    moments = (full[0, 0], full[1, 1], full[2, 2], full[0, 1], full[0, 2], full[1, 2])
    center = R.inverse().p + R.R.T @ np.array(body.inertia.center_of_mass, dtype=float)
    welded = sf.Joint(f"{body.name}_weld", "fixed", body.name, None, tuple(R.p), _rotation(R.R))
    inertia = sf.Inertia(body.inertia.mass, tuple(center), moments)
    return [replace(body, inertia=None), sf.RigidBody(f"{body.name}_load", welded, inertia, (), body.waive)]


def _shuffled(bodies: list[sf.RigidBody], rng: np.random.Generator) -> list[sf.RigidBody]:
    """In another order, parents before children."""
    left, placed, order = list(bodies), {"world"}, list[sf.RigidBody]()
    while left:
        ready = [body for body in left if body.joint is None or body.joint.parent in placed]
        body = ready[rng.integers(len(ready))]
        left.remove(body)
        placed.add(body.name)
        order.append(body)
    return order
