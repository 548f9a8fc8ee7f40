"""Reverse mode, second derivatives, momenta and C(q, v), against the definitions that tie them to other functions.

What they are tied to, M, h, the derivatives of inverse dynamics and frames, is compared with engines.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

import symofros as sf

from ...comparison.retained import omitted_orders
from ...contract.quantities import ROUNDING
from ...mechanics.assembly import Mover, assemble
from ...mechanics.geometry import Array
from ..scene import DIFFERENCE, Cell, Scene, off
from . import analyses
from .analyses import DIFFERENCED, SEED

# Function that has vector-Jacobian products -> its inputs, and its outputs.
TRANSPOSED: Mapping[str, tuple[str, str]] = {
    "mass_matrix": ("q", "M"),
    "bias": ("q v", "h"),
    "generalized_force": ("q v u", "Q"),
    "inverse_dynamics": ("q v a", "tau"),
    "forward_dynamics": ("q v u", "a lam"),
    "residual": ("q v a u lam", "R phi phi_rate"),
    "kinetic_energy": ("q v", "T"),
    "potential_energy": ("q", "V"),
    "constraint": ("q", "phi"),
    "constraint_rate": ("q v", "phi_rate"),
    "constraint_bias": ("q v", "gamma"),
    "joint_wrenches": ("q v a u lam", "wrench"),
    "center_of_mass": ("q", "p_WScm"),
    "centroidal_momentum": ("q v", "h_G"),
    "frame_pose": ("q", "p R"),
    "frame_velocity": ("q v", "V"),
    "frame_acceleration": ("q v a", "A"),
    "frame_jacobian": ("q", "J"),
}
# What these are asked of is compiled at once.
_SECOND = ("inverse_dynamics_derivatives", "inverse_dynamics_second_derivatives", "inverse_dynamics_hvp")
_VELOCITY_TERMS = ("mass_matrix", "mass_matrix_pattern", "mass_matrix_values", "bias", "coriolis_matrix")
_MOMENTA = (
    "center_of_mass",
    "centroidal_momentum",
    "centroidal_momentum_matrix",
    "centroidal_momentum_rate",
    "frame_pose",
    "frame_velocity",
)
# Matrix of second derivatives -> the function whose gradient changes by it, its inputs, the outputs that are weighted.
CURVED: Mapping[str, tuple[str, str, str]] = {
    "inverse_dynamics_hessian": ("inverse_dynamics", "q v a", "tau"),
    "forward_dynamics_hessian": ("forward_dynamics", "q v u", "a lam"),
    "frame_position_hessian": ("frame_pose", "q", "p_WF"),
}
_CURVED = (*CURVED, *(f"{gradient}_vjp" for gradient, _, _ in CURVED.values()))
# Of a direction: beams bend by a few hundredths, and differences take two steps of DIFFERENCE along it.
_REACH = 0.1
_LEAST = 1e-4  # Of the values: the smallest change that is not of their rounding.
_CONSTRAINT_FUNCTIONS = ("constraint", "constraint_rate", "constraint_bias")


def transposed(scene: Scene) -> Iterator[Cell]:
    """Vector-Jacobian products by all inputs, parameters too, against changes of the weighted sum of the outputs."""
    frames = scene.model.names.frames[-1:]
    absent = _CONSTRAINT_FUNCTIONS * (not scene.model.nc)
    if scene.model.nc:
        G = scene.model.constraint_jacobian(scene.q, u=scene.law(0.0, scene.q, scene.v))
        # Where conditions repeat each other, multipliers are not unique, nor are their derivatives.
        absent += ("forward_dynamics",) * int(np.linalg.matrix_rank(G) < len(G))
    names = [name for name in TRANSPOSED if name not in absent and (frames or not name.startswith("frame"))]
    asked = tuple(text for name in names for text in (name, f"{name}_vjp"))
    model = sf.compile(scene.system, sf.Options(asked, frames, backend=scene.backend)).with_parameter_checks(False)
    rng = np.random.default_rng(SEED)
    sizes = {"v": model.nv, "a": model.nv, "u": model.nu, "lam": model.nc, "par": model.npar}
    state: dict[str, Any] = {group: rng.standard_normal(size) for group, size in sizes.items()} | {
        "q": scene.q,
        "v": scene.v,
        "par": np.asarray(model.parameter_values),
    }
    steps = {group: _REACH * rng.standard_normal(size) for group, size in {"q": model.nv, **sizes}.items()}
    steps["par"] *= state["par"] * analyses.between(scene)
    for name in names:
        stated, outputs = (text.split() for text in TRANSPOSED[name])
        inputs = [group for group in steps if group in (*stated, "u", "par")]
        of, bar = (frames[-1], "_WF_bar") if name.startswith("frame") else ("", "_bar")

        def values(h: float, name: str = name, of: str = of, inputs: list[str] = inputs) -> list[Array]:
            moved: dict[str, Any] = {group: state[group] + h * steps[group] for group in inputs if group != "q"}
            return [*model.evaluate(name, of, q=scene.manifold.retract(scene.q, h * steps["q"]), **moved)]

        weights = [rng.standard_normal(np.shape(value)) for value in values(0.0)][: len(outputs)]
        change = sum(float(np.sum(w * y)) for w, y in zip(weights, _rates(values), strict=False))
        given = {group: state[group] for group in inputs}
        given |= {f"{output}{bar}": w for output, w in zip(outputs, weights, strict=False)}
        products = model.vjp(name, of, **given)
        along = {group: float(products[group] @ steps[group]) for group in products}
        # Where nothing changes, differences are the rounding of the values.
        least = _LEAST * sum(float(np.abs(w * y).sum()) for w, y in zip(weights, values(0.0), strict=False))
        size = max(sum(map(abs, along.values())), abs(change), least) or 1.0
        missing = float(set(products) != set(inputs))
        yield Cell(f"{name}: vector-Jacobian products", abs(sum(along.values()) - change) / size + missing, DIFFERENCED)


def twice_differentiated(scene: Scene) -> Iterator[Cell]:
    """Second derivatives of inverse dynamics against changes of the first; Hessian-vector products against both."""
    model, q, v = sf.compile(scene.system, sf.Options(_SECOND, backend=scene.backend)), scene.q, scene.v
    rng = np.random.default_rng(SEED)
    a, tau_bar, dq, dv, da = rng.standard_normal((5, model.nv))
    by_qq, by_vv, by_qv, by_aq = model.inverse_dynamics_second_derivatives(q, v, a)

    def first(h: float) -> list[Array]:
        return [*model.inverse_dynamics_derivatives(scene.manifold.retract(q, h * dq), v + h * dv, a + h * da)]

    qv, aq = by_qv.swapaxes(1, 2), by_aq.swapaxes(1, 2)
    changes = by_qq @ dq + by_qv @ dv + aq @ da, qv @ dq + by_vv @ dv
    for by, ours, reference in zip(("coordinates", "speeds"), changes, _rates(first), strict=True):
        yield Cell(f"second derivatives by {by}", off(ours, reference), DIFFERENCED)
    products = model.inverse_dynamics_hvp(q, v, a, tau_bar, dq, dv, da)
    contracted = [tau_bar @ change for change in (*changes, by_aq @ dq)]
    yield Cell("Hessian-vector products", off(np.concatenate(products), np.concatenate(contracted)), ROUNDING)


def balanced(scene: Scene) -> Iterator[Cell]:
    """T = v M v / 2; M a + h - Q is inverse dynamics; T + V changes by the power of inputs and of what dissipates."""
    model, q, v = scene.model, scene.q, scene.v
    u, still = scene.law(0.0, q, v), 0.0 * v
    w = np.random.default_rng(SEED).standard_normal(model.nv)
    M, h, Q = model.dynamics(q, v, 0.0 * u)
    yield Cell("kinetic energy", off(model.kinetic_energy(q, v), 0.5 * v @ M @ v), ROUNDING)
    yield Cell("inverse dynamics", off(model.inverse_dynamics(q, v, w), M @ w + h - Q), ROUNDING)
    a = model.forward_dynamics(q, v, u)
    driven = model.generalized_force(q, v, u)
    left = np.abs(M @ a + h - driven).max() / ((np.abs(M) @ np.abs(a)).max() or 1.0)
    yield Cell("forward dynamics", float(left), ROUNDING)
    if omitted_orders(scene.system) or any(getattr(body, "loads", ()) for body in scene.system.bodies):
        return  # Terms that an order leaves out, and loads that follow bodies, have no energy.

    def energy(t: float) -> list[Array]:
        at, speeds = scene.manifold.retract(q, t * v), v + t * a
        return [np.atleast_1d(model.kinetic_energy(at, speeds) + model.potential_energy(at))]

    (rate,) = _rates(energy)
    power = v * (driven - model.generalized_force(q, still, 0.0 * u))
    size = float(np.abs(v * (M @ a)).sum() + np.abs(v * h).sum()) or 1.0
    yield Cell("power", abs(float(rate[0] - power.sum())) / size, DIFFERENCED)


def moving_frames(scene: Scene) -> Iterator[Cell]:
    """Velocities, accelerations and Jacobians of frames, against changes of their poses along a motion."""
    model, q, v = scene.model, scene.q, scene.v
    a = np.random.default_rng(SEED).standard_normal(model.nv)
    for frame in model.names.frames[-3:]:
        J, dJ = model.frame_jacobian(frame, q), model.frame_jacobian_rate(frame, q, v)
        velocity, acceleration = model.frame_velocity(frame, q, v), model.frame_acceleration(frame, q, v, a)
        R = model.frame_pose(frame, q)[1]

        def along(t: float, frame: str = frame, R: Array = R) -> list[Array]:
            at = scene.manifold.retract(q, t * v)
            p, turned = model.frame_pose(frame, at)
            place = np.concatenate([p, Rotation.from_matrix(turned @ R.T).as_rotvec()])
            return [place, model.frame_velocity(frame, at, v + t * a), model.frame_jacobian(frame, at)]

        by_place, by_velocity, by_jacobian = _rates(along)
        yield Cell(f"velocity of {frame}", off(velocity, by_place), DIFFERENCED)
        yield Cell(f"acceleration of {frame}", off(acceleration, by_velocity), DIFFERENCED)
        yield Cell(f"rate of the Jacobian of {frame}", off(dJ, by_jacobian), DIFFERENCED)
        yield Cell(f"Jacobian of {frame}", off(J @ v, velocity), ROUNDING)
        yield Cell(f"Jacobian of {frame} and its rate", off(J @ a + dJ @ v, acceleration), ROUNDING)


def weighted_curvature(scene: Scene) -> Iterator[Cell]:
    """Second derivatives of weighted dynamics and of a frame's place by all inputs, against changes of gradients."""
    frames = scene.model.names.frames[-1:]
    model = sf.compile(scene.system, sf.Options(_CURVED, frames, backend=scene.backend))
    rng = np.random.default_rng(SEED)
    sizes = {"a": model.nv, "u": model.nu, "lam": model.nc, "tau": model.nv, "p_WF": 3}
    state: dict[str, Any] = {"q": scene.q, "v": scene.v, "par": np.asarray(model.parameter_values)}
    state |= {group: rng.standard_normal(sizes[group]) for group in "au"}
    for name, (gradient, inputs, outputs) in CURVED.items():
        of = model.names.frames[-1] if name.startswith("frame") else ""
        at = {group: state[group] for group in (*inputs.split(), "par")}
        weights: dict[str, Any] = {f"{output}_bar": rng.standard_normal(sizes[output]) for output in outputs.split()}
        steps = {group: rng.standard_normal(model.nv if group == "q" else len(x)) for group, x in at.items()}
        steps["par"] *= at["par"] * analyses.between(scene)

        def slopes(
            h: float,
            gradient: str = gradient,
            of: str = of,
            at: Mapping[str, Any] = at,
            weights: Mapping[str, Any] = weights,
            steps: Mapping[str, Array] = steps,
        ) -> list[Array]:
            moved: dict[str, Any] = {group: x + h * steps[group] for group, x in at.items() if group != "q"}
            by = model.vjp(gradient, of, q=scene.manifold.retract(at["q"], h * steps["q"]), **moved, **weights)
            return [np.concatenate([by[group] for group in at])]

        (change,) = _rates(slopes)
        (H,) = model.evaluate(name, of, **at, **weights)
        along = H @ np.concatenate([*steps.values()])
        yield Cell(name.replace("_", " "), off(along, change), DIFFERENCED)


def velocity_terms(scene: Scene) -> Iterator[Cell]:
    """M by its entries; C(q, v) v is what h has of the speeds, and C + C^T the rate of M, so that M' - 2 C is skew."""
    model = sf.compile(scene.system, sf.Options(_VELOCITY_TERMS, (), backend=scene.backend))
    q, v = scene.q, scene.v
    M, C, h = model.mass_matrix(q), model.coriolis_matrix(q, v), model.bias(q, v)
    dense = np.zeros_like(M)
    dense[model.mass_matrix_pattern()] = model.mass_matrix_values(q)
    yield Cell("M by entries", off(dense + np.tril(dense, -1).T, M), ROUNDING)
    yield Cell("C v and the weight", off(C @ v + model.bias(q, 0.0 * v), h), ROUNDING)
    if omitted_orders(scene.system):
        return  # What an order leaves out of M, of C and of h is not of one degree.
    (by_M,) = _rates(lambda t: [model.mass_matrix(scene.manifold.retract(q, t * v))])
    yield Cell("C and its transpose", off(C + C.T, by_M), DIFFERENCED)


def momenta(scene: Scene) -> Iterator[Cell]:
    """C(q, v), M by entries; the momentum about the mass centre of a tree of rigid bodies."""
    yield from velocity_terms(scene)
    movers = assemble(scene.system).movers
    bodies = tuple(mover.body for mover in movers)
    model, q, v = sf.compile(scene.system, sf.Options(_MOMENTA, bodies, backend=scene.backend)), scene.q, scene.v
    a = np.random.default_rng(SEED).standard_normal(model.nv)

    def moving(t: float) -> list[Array]:
        return [model.centroidal_momentum(scene.manifold.retract(q, t * v), v + t * a)]

    (by_momentum,) = _rates(moving)
    rate = model.centroidal_momentum_rate(q, v, a)
    yield Cell("rate of the momentum about the mass centre", off(rate, by_momentum), DIFFERENCED)
    center, momentum = _about_mass_center(movers, model, q, v)
    yield Cell("mass centre", off(model.center_of_mass(q), center), ROUNDING)
    ours = model.centroidal_momentum(q, v)
    if not any(mover.joint.rotors for mover in movers):  # Whose spin no body's frame has.
        yield Cell("momentum about the mass centre", off(ours, momentum), ROUNDING)
    yield Cell("its matrix", off(model.centroidal_momentum_matrix(q) @ v, ours), ROUNDING)


def _about_mass_center(movers: Sequence[Mover], model: sf.Model, q: Array, v: Array) -> tuple[Array, Array]:
    """Mass centre and momentum about it, body by body from the motion of the frames."""
    points, masses, spins = [], [], []
    for mover in movers:
        p, R = model.frame_pose(mover.body, q)
        velocity = model.frame_velocity(mover.body, q, v)
        for part in mover.masses:
            arm = R @ part.p_BC
            masses.append(part.mass)
            points.append([p + arm, velocity[:3] + np.cross(velocity[3:], arm)])
            spins.append(R @ part.J_BC @ R.T @ velocity[3:])
    weights, places = np.array(masses)[:, None, None], np.array(points)
    center = (weights * places).sum(axis=0)[0] / weights.sum()
    linear = weights[:, 0] * places[:, 1]
    angular = np.cross(places[:, 0] - center, linear) + np.array(spins)
    return center, np.concatenate([linear.sum(axis=0), angular.sum(axis=0)])


def _rates(values: Callable[[float], list[Array]]) -> list[Array]:
    """Derivatives at zero of several functions of one number, by central differences of fourth order."""
    far_back, back, ahead, far = (values(k * DIFFERENCE) for k in (-2, -1, 1, 2))
    return [(8 * (y - x) - (z - w)) / (12 * DIFFERENCE) for w, x, y, z in zip(far_back, back, ahead, far, strict=True)]
