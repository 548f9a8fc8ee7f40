"""What is derived from the equations at a state, against the conditions that define it and central differences."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

import symofros as sf

from ...mechanics.assembly import Mover, assemble
from ...mechanics.geometry import Array
from ..scene import Cell, Scene, derivative, freedoms, off

# Rounding of solutions; what central differences of fourth order leave; where Newton's method stops.
SOLVED, DIFFERENCED, CONVERGED = 1e-9, 1e-7, 1e-7
SEED = 4


def linearised(scene: Scene) -> Iterator[Cell]:
    """A and B against differences of the accelerations; a frame's outputs against differences of its pose."""
    model, q, v, manifold = scene.model, scene.q, scene.v, scene.manifold
    u, zero = scene.law(0.0, q, v), np.zeros(model.nv)
    held = replace(scene, law=lambda *_: u)

    def accelerations(x: Array) -> Array:
        return held.acceleration(0.0, manifold.retract(q, x[: model.nv]), v + x[model.nv :])

    by_state = derivative(accelerations, np.zeros(2 * model.nv))
    A, B = model.linearize(q, v, u)
    allowed = np.eye(2 * model.nv)
    if model.nc:  # Elsewhere the accelerations of violated constraints are nobody's.
        G = model.constraint_jacobian(q, u=u)
        allowed = np.linalg.qr(allowed[:, : model.nv] @ freedoms(G))[0]
    yield Cell("A", off(A[model.nv :] @ allowed, by_state @ allowed), DIFFERENCED)
    kinematics = np.hstack([-manifold.adjoint(v), np.eye(model.nv)])
    yield Cell("A of the kinematics", off(A[: model.nv], kinematics), SOLVED)
    if model.nu:

        def pushed(change: Array) -> Array:
            return replace(scene, law=lambda *_: u + change).acceleration(0.0, q, v)

        yield Cell("B", off(B[model.nv :], derivative(pushed, np.zeros(model.nu))), DIFFERENCED)
    for frame in model.names.frames[-1:]:
        outputs = [("frame_pose", frame), ("frame_velocity", frame)]
        matrices = model.linearize(q, v, u, outputs=outputs)
        R = model.frame_pose(frame, q, u=u)[1]

        def pose(x: Array, frame: str = frame, R: Array = R) -> Array:
            at, turned = model.frame_pose(frame, manifold.retract(q, x[: model.nv]), u=u)
            return np.concatenate([at, Rotation.from_matrix(turned @ R.T).as_rotvec()])

        def velocity(x: Array, frame: str = frame) -> Array:
            moved = manifold.retract(q, x[: model.nv])
            return np.asarray(model.frame_velocity(frame, moved, v + x[model.nv :], u=u))

        rows = np.vstack([derivative(one, np.concatenate([zero, zero])) for one in (pose, velocity)])
        yield Cell(f"C of {frame}", off(matrices.C, rows), DIFFERENCED)


def differentiated(scene: Scene) -> Iterator[Cell]:
    """Derivatives of inverse dynamics by state and parameters, the regressor, and base parameters."""
    model, q, v = scene.model, scene.q, scene.v
    a = np.random.default_rng(SEED).standard_normal(model.nv)
    u, par = scene.law(0.0, q, v), np.asarray(model.parameter_values)

    def inverse(x: Array) -> Array:
        moved = scene.manifold.retract(q, x[: model.nv])
        return np.asarray(model.inverse_dynamics(moved, v + x[model.nv :], a, u=u))

    by_q, by_v = model.inverse_dynamics_derivatives(q, v, a, u=u)
    rows = derivative(inverse, np.zeros(2 * model.nv))
    yield Cell("inverse dynamics by state", off(np.hstack([by_q, by_v]), rows), DIFFERENCED)
    if model.npar:
        share = par * between(scene)
        by_par = derivative(lambda x: np.asarray(model.inverse_dynamics(q, v, a, u=u, par=par + share * x)), 0 * par)
        ours = model.inverse_dynamics_by_par(q, v, a, u=u) * share
        yield Cell("inverse dynamics by parameters", off(ours, by_par), DIFFERENCED)
        by_par = derivative(lambda x: np.asarray(model.forward_dynamics(q, v, u, par=par + share * x)), 0 * par)
        yield Cell("forward dynamics by parameters", off(model.forward_dynamics_by_par(q, v, u) * share, by_par), 1e-6)


def between(scene: Scene) -> Array:
    """1 for parameters that may have values near their own, 0 for those of switches, which are 0 or 1 (npar)."""
    formulas = (switch.engaged for switch in scene.system.switches)
    switching = set[str]().union(*(x.symbols() for x in formulas if not isinstance(x, int | float)))
    return np.array([float(name not in switching) for name in scene.model.names.par])


def identified(scene: Scene) -> Iterator[Cell]:
    """The regressor and base parameters of a tree of rigid bodies: M a + h, without what joints do besides."""
    pi = np.concatenate([_inertial(mover) for mover in assemble(scene.system).movers])
    model, rng = scene.model, np.random.default_rng(SEED)
    n = 8
    q = np.array([model.random_state(rng)[0] for _ in range(n)])
    v, a = rng.standard_normal((2, n, model.nv))
    Y = model.regressor(q, v, a)
    efforts = np.einsum("...ij,...j->...i", model.mass_matrix(q), a) + model.bias(q, v)
    yield Cell("regressor", off(Y @ pi, efforts), SOLVED)
    terms = model.regressor(q, v, a, joint_terms=("armature", "viscous", "coulomb"))
    diagonals = np.stack([x[:, :, None] * np.eye(model.nv) for x in (a, v, np.sign(v))], axis=2)
    wanted = np.concatenate([Y, diagonals.reshape(n, model.nv, -1)], axis=-1)
    yield Cell("regressor with terms of joints", off(terms, wanted), SOLVED)
    base = sf.base_parameters(model)
    stacked = Y.reshape(-1, len(pi))
    rank = int(np.linalg.matrix_rank(model.regressor(*_many(model, rng)).reshape(-1, len(pi)), rtol=1e-9))
    error = off(stacked[:, list(base.independent)] @ (base.combine @ pi), efforts.ravel())
    yield Cell("base parameters", error + float(rank != len(base.independent)), SOLVED)


def _inertial(mover: Mover) -> Array:
    """Mass, first moment, and Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the origin of the body frame (10)."""
    inertial = np.zeros(10)
    for part in mover.masses:
        c, m = part.p_BC, part.mass
        about = part.J_BC + m * (c @ c * np.eye(3) - np.outer(c, c))
        inertial += [m, *(m * c), about[0, 0], about[0, 1], about[1, 1], about[0, 2], about[1, 2], about[2, 2]]
    return inertial


def _many(model: sf.Model, rng: np.random.Generator) -> tuple[Array, Array, Array]:
    q = np.array([model.random_state(rng)[0] for _ in range(40)])
    return q, rng.standard_normal((40, model.nv)), rng.standard_normal((40, model.nv))


def closed(scene: Scene, held: str) -> Iterator[Cell]:
    """Projection, assembly: residuals, and changes that are least in the metric of M."""
    model, manifold, rng = scene.model, scene.manifold, np.random.default_rng(SEED)
    q = manifold.retract(scene.q, 1e-3 * rng.standard_normal(model.nv))
    v = scene.v + 0.1 * rng.standard_normal(model.nv)
    on_q, on_v, left = model.project(q, v)
    M, G = model.mass_matrix(on_q), model.constraint_jacobian(on_q)
    phi, rate = np.abs(model.constraint(on_q)).max(), np.abs(model.constraint_rate(on_q, on_v)).max()
    yield Cell("projection: what is left", float(max(phi, rate)), 1e-10)
    yield Cell("projection: what is said to be left", abs(float(left) - float(phi)), 1e-12)
    free = freedoms(G)
    change = M @ (on_v - v)
    yield Cell(
        "projection of speeds: least change", float(np.abs(free.T @ change).max() / np.abs(change).max()), SOLVED
    )
    if manifold.nq == manifold.nv and np.abs(model.constraint(q)).max() > 0.0:
        change = M @ (on_q - q)  # Newton's steps are least each, in metrics that differ in the second order.
        yield Cell("projection of q: least change", float(np.abs(free.T @ change).max() / np.abs(change).max()), 1e-2)
    start = sf.assemble(model, q, v)
    G = model.constraint_jacobian(start.q)
    free = freedoms(G)
    wished = v - start.v
    gap = np.abs(model.constraint(start.q)).max() + np.abs(model.constraint_rate(start.q, start.v)).max()
    yield Cell("assembly: what is left", float(gap), 1e-10)
    yield Cell("assembly of speeds: least change", float(np.abs(free.T @ wished).max() / np.abs(wished).max()), SOLVED)
    yield Cell("assembly: rank", float(start.rank != np.linalg.matrix_rank(G)), 0.5)
    kept = sf.assemble(model, q, v, held=[held])
    i = model.names.v.index(held)
    gap = np.abs(model.constraint(kept.q)).max() + np.abs(model.constraint_rate(kept.q, kept.v)).max()
    moved = abs(float(model.difference(q, kept.q)[i])) + abs(float(kept.v[i] - v[i]))
    yield Cell("assembly that holds a speed", float(gap) + moved, 1e-9)


def at_rest(scene: Scene, guess: Array, held: tuple[str, ...] = ()) -> Iterator[Cell]:
    """Equilibrium by its equations; modes and the state space there by differences of the accelerations."""
    model, manifold = scene.model, scene.manifold
    u = scene.law(0.0, guess, np.zeros(model.nv))
    rest = sf.equilibrium(model, guess, u=u, held=held, beam_limit=np.inf)
    efforts = model.inverse_dynamics(rest.q, np.zeros(model.nv), np.zeros(model.nv), u=u)
    if model.nu:
        M, h, Q = model.dynamics(rest.q, np.zeros(model.nv), u)
        efforts = h - Q
    size = float(np.abs(model.bias(guess, np.zeros(model.nv), u=u)).max()) or 1.0
    G = model.constraint_jacobian(rest.q, u=u) if model.nc else np.zeros((0, model.nv))
    gap = float(np.abs(model.constraint(rest.q, u=u)).max()) if model.nc else 0.0
    left = np.abs(efforts - rest.effort - (G.T @ rest.lam if model.nc else 0.0)).max() / size
    kept = [model.names.v.index(name) for name in held]
    stayed = float(np.abs(np.asarray(model.difference(guess, rest.q))[kept]).max(initial=0.0))
    idle = np.delete(rest.effort, kept)
    yield Cell("equilibrium", float(left) + gap + stayed + float(np.abs(idle).max(initial=0.0)), 1e-9)
    if held:
        return
    still = replace(scene, q=rest.q, v=np.zeros(model.nv), law=lambda *_: u)

    def slopes(x: Array) -> Array:
        q, v = manifold.retract(rest.q, x[: model.nv]), x[model.nv :]
        if model.nc:
            q, v, _ = model.project(q, v, u=u)
        return still.acceleration(0.0, q, v)

    S = freedoms(G)
    n = S.shape[1]
    allowed = np.block([[S, np.zeros_like(S)], [np.zeros_like(S), S]])
    lower = derivative(lambda x: slopes(allowed @ x), np.zeros(2 * n))
    A = np.vstack([np.hstack([np.zeros((n, n)), np.eye(n)]), S.T @ lower])
    wanted = np.linalg.eigvals(A)
    space = sf.state_space(model, rest.q, u=u)
    yield Cell("state space", _spectra(np.linalg.eigvals(space.A), wanted), 1e-6)
    found = sf.modes(model, rest.q, u=u, beam_limit=np.inf)
    both = np.concatenate([found.eigenvalues, found.eigenvalues[found.eigenvalues.imag > 1e-9].conj()])
    # A rigid motion counts once, and has two zeros where nothing damps it.
    twice = min(len(wanted) - len(both), int(np.sum(found.eigenvalues == 0.0)))
    both = np.concatenate([both, np.zeros(max(0, twice))])
    yield Cell("modes", _spectra(both, wanted), 1e-6)
    shape_error = 0.0
    for s, shape in zip(found.eigenvalues, found.shapes.T, strict=True):
        x = np.concatenate([S.T @ shape, s * (S.T @ shape)])
        shape_error = max(shape_error, float(np.abs(A @ x - s * x).max() / max(1.0, np.abs(s * x).max())))
        shape_error = max(shape_error, abs(float(np.abs(shape).max()) - 1.0))
    yield Cell("shapes of modes", shape_error, 1e-4)
    sizes = np.abs(found.eigenvalues)
    ratios = -found.eigenvalues.real / np.where(sizes > 0.0, sizes, 1.0)
    yield Cell("frequencies and damping", off(found.frequencies, sizes) + off(found.damping + 1, ratios + 1), SOLVED)


def _spectra(ours: Any, wanted: Any) -> float:
    """Distance between two sets of eigenvalues, relative to the largest wanted one."""
    if len(ours) != len(wanted):
        return float("inf")
    distances = np.abs(np.asarray(ours)[:, None] - np.asarray(wanted)[None, :])
    size = float(np.abs(wanted).max()) or 1.0
    return float(max(distances.min(axis=0).max(), distances.min(axis=1).max())) / size


def reached(scene: Scene, frame: str) -> Iterator[Cell]:
    """Inverse kinematics: the pose is reached, the rest is nearest; and a frame's motion gives speeds and rates."""
    model, manifold = scene.model, scene.manifold
    start = np.random.default_rng(SEED)
    goal = manifold.retract(scene.q, 0.3 * start.standard_normal(model.nv))
    p, R = model.frame_pose(frame, goal)
    for name, target in (("position", sf.Target(p)), ("pose", sf.Target(p, R)), ("rotation", sf.Target(None, R))):
        answer = sf.inverse_kinematics(model, {frame: target}, scene.q)
        at, turned = model.frame_pose(frame, answer.q)
        error = 0.0 if name == "rotation" else float(np.abs(at - p).max())
        error += 0.0 if name == "position" else float(np.abs(turned - R).max())
        yield Cell(f"inverse kinematics of a {name}", error + float(not answer.converged), 1e-8)
    rest = sf.inverse_kinematics(model, {frame: sf.Target(p)}, goal, rest=scene.q)
    J = model.frame_jacobian(frame, rest.q)[:3]
    away = np.asarray(model.difference(scene.q, rest.q))
    left = float(np.abs(freedoms(J).T @ away).max()) / (float(np.linalg.norm(away)) or 1.0)
    gap = float(np.abs(model.frame_pose(frame, rest.q)[0] - p).max())
    yield Cell("inverse kinematics nearest to rest", gap + left + float(not rest.converged), 1e-5)
    yield Cell("its distance", abs(rest.distance - float(np.linalg.norm(away))), 1e-8)


def traced(scene: Scene, frame: str) -> Iterator[Cell]:
    """A frame's motion, made from a known motion of the joints of a tree, gives that motion back."""
    model, rng = scene.model, np.random.default_rng(SEED)
    t = np.linspace(0.0, 0.3, 5)[:, None]
    slopes = 0.5 * rng.standard_normal((2, model.nv))
    q = scene.q + slopes[0] * np.sin(t) + slopes[1] * t**2
    v, a = slopes[0] * np.cos(t) + 2 * slopes[1] * t, -slopes[0] * np.sin(t) + 2 * slopes[1]
    p, R = model.frame_pose(frame, q)
    velocity = model.frame_velocity(frame, q, v)
    acceleration = model.frame_acceleration(frame, q, v, a)
    ours = sf.joint_motion(model, frame, p, velocity, acceleration, R, q=q[0])
    error = max(off(one, wanted) for one, wanted in zip(ours, (q, v, a), strict=True))
    yield Cell("motion of joints from a frame's", error, CONVERGED)


def driven(scene: Scene, actuators: tuple[str, ...]) -> Iterator[Cell]:
    """Efforts of actuators that make a mechanism move as given: the equations hold, and efforts are least."""
    model, rng = scene.model, np.random.default_rng(SEED)
    free = freedoms(model.constraint_jacobian(scene.q)) if model.nc else np.eye(model.nv)
    a = free @ rng.standard_normal(free.shape[1])
    if model.nc:
        G, gamma = model.constraint_jacobian(scene.q), model.constraint_bias(scene.q, scene.v)
        a = a + np.linalg.pinv(G) @ (gamma - G @ a)
    for sizes in (None, np.arange(1.0, len(actuators) + 1)):
        answer = sf.actuator_efforts(model, scene.q, scene.v, a, actuators, sizes=sizes)
        M, h, Q = model.dynamics(scene.q, scene.v, answer.u)
        acting = np.zeros((model.nv, len(actuators)))
        for k, name in enumerate(actuators):
            if name not in model.names.u:
                acting[model.names.v.index(name), k] = 1.0
        G = model.constraint_jacobian(scene.q) if model.nc else np.zeros((0, model.nv))
        left = M @ a + h - Q - acting @ answer.efforts - (G.T @ answer.lam if model.nc else 0.0)
        size = float(np.abs(M @ a + h).max()) or 1.0
        yield Cell(f"efforts of {len(actuators)} actuators", float(np.abs(left).max()) / size, 1e-8)
        columns = acting.copy()
        for k, name in enumerate(actuators):
            if name in model.names.u:
                unit = np.eye(model.nu)[model.names.u.index(name)]
                columns[:, k] = model.dynamics(scene.q, scene.v, answer.u + unit)[2] - Q
        idle = freedoms(free.T @ columns)
        weights = np.ones(len(actuators)) if sizes is None else sizes
        scaled = np.asarray(answer.efforts) / weights**2
        least = float(np.abs(idle.T @ scaled).max(initial=0.0)) / (float(np.abs(scaled).max()) or 1.0)
        wrong = float(int(answer.redundancy) != idle.shape[1])
        yield Cell(f"least efforts of {len(actuators)} actuators", least + wrong, 1e-8)
