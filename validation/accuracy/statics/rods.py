"""Geometrically exact rods at rest: the elastica, a circle, Bathe's arc, the Princeton strip, two rods in a loop."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

import symofros as sf

from ...adapters.exudyn.ancf import Strip
from ...mechanics.geometry import Array
from ...reporting.figures import Chart, Figure, curves
from ...reporting.findings import Finding, Study
from ..beams import cantilever, interpreted
from .elastica import exact

FUNCTIONS = ("generalized_force", "frame_pose")
# P L^2/EI of the elastica, bent by 86 degrees; errors of its tip over L, the larger component, by a Ritz solution with
# 3 to 7 curvatures and exact integrals, to two digits: 3.6e-6 is 3.645e-6.
LOAD, ELASTICA = 15.0, {3: 2.3e-3, 4: 3.5e-5, 5: 1.8e-5, 6: 3.65e-6, 7: 5.7e-7}
# Bathe and Bolourchi 1979: an arc of 45 degrees of radius 100 under a force across its plane; errors over the radius.
RADIUS, MODULUS, ACROSS, BATHE = 100.0, 1e7, 600.0, {2: 3.2e-3, 3: 1.4e-4}
# Two rods side by side whose tips are joined, under a force on the tips; errors of the tips over L.
APART, PULL, PARALLEL = 0.3, (1.5, -0.8), {3: 4e-5, 5: 1.2e-8, 7: 1e-11}
# The Princeton strip under its largest load, at these angles; errors over its length.
HEAVY, ANGLES, PRINCETON = 13.345, (15.0, 45.0, 75.0), {2: 9e-4, 3: 5e-5}


def rest(m: sf.Model, steps: int, **loads: float) -> Array:
    """Coordinates at rest under loads, by Newton's method with differences, from step to step of the loads."""
    q = np.zeros(m.nq)
    still, width = np.zeros(m.nv), 1e-6 * np.eye(m.nq)
    for share in np.linspace(0.0, 1.0, steps + 1)[1:].tolist():
        loaded = m.with_parameters(**{name: share * load for name, load in loads.items()})
        for _ in range(12):
            force = loaded.generalized_force(q, still, ())
            ahead, behind = (loaded.generalized_force(q + s * width, still, ()) for s in (1.0, -1.0))
            step = np.linalg.solve((ahead - behind).T / 2e-6, force)
            q = q - step
            if np.abs(step).max() < 1e-11:
                break
    return q


def shooting(length: float, stiffness: Array, curved: Array, force: Array) -> Array:
    """Tip (3) of an inextensible rod from the origin along x under a force on its tip, by the moment in each section.

    Args:
        length: Length [m].
        stiffness: GJ, EI_y, EI_z (3) [N m^2].
        curved: Twist rate and curvatures without stress (3) [1/m].
        force: Force on the tip, in the axes of the root (3) [N].
    """

    def ends(tip: Array, share: float) -> Array:
        def slope(_: float, state: Array) -> Array:
            R = state[3:].reshape(3, 3)
            x, y, z = curved + R.T @ np.cross(tip - state[:3], share * force) / stiffness
            return np.concatenate([R[:, 0], (R @ np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])).ravel()])

        start = np.concatenate([np.zeros(3), np.eye(3).ravel()])
        run = solve_ivp(slope, (0.0, length), start, "DOP853", rtol=1e-10, atol=1e-10 * length)
        return np.asarray(run.y[:3, -1])

    tip = ends(np.array([length, 0.0, 0.0]), 0.0)
    for share in (0.25, 0.5, 0.75, 1.0):
        tip = fsolve(lambda p, s=share: ends(p, s) - p, tip, xtol=1e-11)
    return np.asarray(tip)


def elastica(functions: int) -> float:
    """Error of the tip against the elastica's over L, in the larger of its two components."""
    load = sf.BeamLoad((0.0, sf.formula("P", "load"), 0.0), at=1.0, axes="world")
    rod = cantilever(bend_y=functions, loads=(load,), theory="strain")
    m = interpreted(rod, functions=FUNCTIONS, parameters=["P"])
    p, _ = m.frame_pose("tip", rest(m, 3, P=LOAD))
    deflection, shortening = exact(LOAD)
    return float(max(abs(p[0] - 1.0 + shortening), abs(p[1] - deflection)))


def circle(sections: int) -> float:
    """Distance of the tip from the root over L under the moment that rolls the rod up."""
    load = sf.BeamLoad(torque=(0.0, 0.0, sf.formula("T", "load")), at=1.0)
    rod = cantilever(bend_y=1, loads=(load,), theory="strain", sections=sections)
    m = interpreted(rod, functions=FUNCTIONS, parameters=["T"])
    p, _ = m.frame_pose("tip", rest(m, 1, T=2.0 * np.pi))
    return float(np.linalg.norm(p))


def spatial(length: float, functions: int, stiffness: Array, loads: dict[str, float], **more: Any) -> Array:
    """Tip (3) of a rod with as many functions of each strain, under a force on it."""
    components = [sf.formula(name, "load") for name in ("Fx", "Fy", "Fz")]
    GJ, EI_y, EI_z = stiffness.tolist()
    rod = sf.Beam(
        "b",
        sf.Joint("root", "fixed"),
        length,
        1.0,
        GJ=GJ,
        EI_y=EI_y,
        EI_z=EI_z,
        rhoJ=1.0,
        bend_y=functions,
        bend_z=functions,
        twist=functions,
        family="legendre",
        theory="strain",
        loads=(sf.BeamLoad(components, at=1.0, axes="world"),),  # type: ignore[arg-type]
        **more,
    )
    m = interpreted(rod, functions=FUNCTIONS, parameters=["Fx", "Fy", "Fz"])
    p, _ = m.frame_pose("tip", rest(m, 6, **loads))
    return np.asarray(p)


def bathe(functions: int) -> float:
    """Distance of the tip of the curved cantilever from that of the exact rod, over the radius."""
    length, stiffness = RADIUS * np.pi / 4, MODULUS / 12.0 * np.array([1.0, 1.0, 1.0])
    tip = spatial(length, functions, stiffness, {"Fz": ACROSS}, curvature_z=1.0 / RADIUS)
    known = shooting(length, stiffness, np.array([0.0, 0.0, 1.0 / RADIUS]), np.array([0.0, 0.0, ACROSS]))
    return float(np.linalg.norm(tip - known)) / RADIUS


def strip(functions: int, degrees: float, load: float = HEAVY) -> float:
    """Distance of the tip of the Princeton strip from that of the exact rod, over its length."""
    beam, turned = Strip(), np.radians(degrees)
    stiffness = np.array([beam.GJ, beam.EI_y, beam.EI_z])
    loads = {"Fy": load * float(np.cos(turned)), "Fz": load * float(np.sin(turned))}
    known = shooting(beam.length, stiffness, np.zeros(3), np.array([0.0, loads["Fy"], loads["Fz"]]))
    return float(np.linalg.norm(spatial(beam.length, functions, stiffness, loads) - known)) / beam.length


def parallel_reference() -> Array:
    """Joined tips (2) of two upright rods, by shooting for their curvatures at the root and the force between tips."""

    def ends(curvature: float, force: Array) -> Array:
        def slope(_: float, y: Array) -> list[float]:
            c, s = np.cos(y[0]), np.sin(y[0])
            return [y[1], force[0] * s - force[1] * c, c, s]

        run = solve_ivp(slope, (0.0, 1.0), [np.pi / 2, curvature, 0.0, 0.0], "DOP853", rtol=1e-13, atol=1e-14)
        return np.asarray(run.y[:, -1])

    def conditions(x: Array) -> Array:
        left, right = ends(x[0], np.array(PULL) + x[2:]), ends(x[1], -x[2:])
        return np.array([left[1], right[1], left[2] - right[2] - APART, left[3] - right[3]])

    x = fsolve(conditions, [-0.5, 0.5, -0.4, 4.0], xtol=1e-13)
    return ends(x[0], np.array(PULL) + x[2:])[2:]


def parallel(functions: int) -> float:
    """Distance of the joined tips of two rods, a parallel robot in a plane, from those of the exact rods over L."""
    upright = sf.Rotation.rpy(0.0, 0.0, np.pi / 2)
    pull = sf.BeamLoad((*PULL, 0.0), at=1.0, axes="world")
    shared: dict[str, Any] = {"EI_z": 1.0, "bend_y": functions, "family": "legendre", "theory": "strain"}
    left = sf.Beam("left", sf.Joint("foot", "fixed", rotation=upright), 1.0, 1.0, loads=(pull,), **shared)
    foot = sf.Joint("other foot", "fixed", position=(APART, 0.0, 0.0), rotation=upright)
    closure = sf.Closure("tips", ("left", "tip"), ("right", "tip"))
    m = interpreted(
        left,
        sf.Beam("right", foot, 1.0, 1.0, **shared),
        functions=(*FUNCTIONS, "constraint", "constraint_jacobian"),
        constraints=(closure,),
    )
    n, nc = m.nq, 2  # Out of the plane the closure holds by itself.
    x = np.zeros(n + nc)
    x[0], x[functions] = -0.45, -0.2

    def residual(x: Array) -> Array:
        q = x[:n]
        G = m.constraint_jacobian(q)[:nc]
        return np.concatenate([m.generalized_force(q, 0.0 * q, ()) + G.T @ x[n:], m.constraint(q)[:nc]])

    for _ in range(12):
        columns = [residual(x + step) - residual(x - step) for step in 1e-6 * np.eye(n + nc)]
        x = x - np.linalg.solve(np.array(columns).T / 2e-6, residual(x))
    p, _ = m.frame_pose("left.tip", x[:n])
    return float(np.linalg.norm(p[:2] - parallel_reference()))


def study(quick: bool) -> Study:
    """Measure tip errors of strain-based rods at rest on five problems with reference solutions."""
    plane = {n: elastica(n) for n in ELASTICA}
    closing = {n: circle(n) for n in (6, 8, 10)}
    curved = {n: bathe(n) for n in BATHE}
    pairs = {n: parallel(n) for n in PARALLEL if n < (7 if quick else 8)}
    angles = ANGLES[1:2] if quick else ANGLES
    strips = {n: max(strip(n, at) for at in angles) for n in PRINCETON}
    findings = [
        Finding(
            f"elastica, {n} functions: error of the tip over L, larger component",
            error,
            ELASTICA[n],
            reason="a Ritz solution's",
        )
        for n, error in plane.items()
    ]
    findings.append(
        Finding("rolled up, 8 sections: the tip's distance from the root over L", closing[8], 1e-9, reason="quadrature")
    )
    findings += [
        Finding(f"Bathe's arc, {n} functions a strain: error over the radius", error, BATHE[n], reason="convergence")
        for n, error in curved.items()
    ]
    findings += [
        Finding(f"Princeton strip, {n} functions a strain: error over L", error, PRINCETON[n], reason="convergence")
        for n, error in strips.items()
    ]
    findings += [
        Finding(f"two rods joined at their tips, {n} functions: error over L", error, PARALLEL[n], reason="convergence")
        for n, error in pairs.items()
    ]
    answer = (
        f"A rod of three strains is off the elastica by {plane[3]:.1g} L at 86 degrees, one of seven by {plane[7]:.1g} "
        f"L; in space three functions a strain place Bathe's arc to {curved[3]:.1g} of its radius, and the Princeton "
        f"strip to {strips[3]:.1g} of its length under its largest load. No load ends the theory."
    )
    figure = Figure(
        "Errors fall exponentially with the number of functions of a strain, in a plane and in space.",
        (
            Chart(
                "error of the tip",
                "functions a strain  [1]",
                "error over the length  [1]",
                tuple(
                    curve
                    for name, errors in (
                        ("elastica", plane),
                        ("two rods", pairs),
                        ("Bathe's arc", curved),
                        ("Princeton strip", strips),
                    )
                    for curve in curves(np.array(list(errors)), {name: np.array(list(errors.values()))})
                ),
                log="y",
            ),
        ),
    )
    return Study("How exact is a rod by its strains?", answer, (figure,), tuple(findings), ())
