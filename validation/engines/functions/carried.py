"""Wholes of trees and of subtrees, links as another sees them, points of links, rates of coordinates."""

from __future__ import annotations

import numpy as np

from ..truth import carried, derived, points
from .function import Function, functions_of


def _wholes() -> dict[str, Function]:
    rows = {
        "mass_centre_velocity": ("velocity of the mass centre (3)", carried.centre_velocity),
        "mass_centre_acceleration": ("its acceleration (3)", carried.centre_acceleration),
        "subtree_masses": ("masses of the links' subtrees (L)", carried.subtree_masses),
        "subtree_centres": ("their mass centres (L, 3)", carried.subtree_centres),
        "subtree_centre_jacobians": ("their Jacobians (L, 3, nv)", carried.subtree_jacobians),
        "subtree_centre_velocities": ("their velocities (L, 3)", carried.subtree_velocities),
        "subtree_centre_accelerations": ("their accelerations (L, 3)", carried.subtree_accelerations),
        "total_mass": ("mass of the tree (1)", carried.total_mass),
        "centroidal_inertia": (
            "momentum of all links, as one body, about the mass centre for twists there, along the world's axes (6, 6)",
            carried.centroidal_inertia,
        ),
        "link_distances": (f"distances of the links' origins from {carried.AFAR} (L)", carried.distances),
        "carried_inertias": (
            "composite inertias of the links' subtrees, at each link's frame along its axes (L, 6, 6)",
            carried.carried_inertias,
        ),
        "link_regressors": (
            "Y (L, 6, 10): wrench that moves each link against gravity, at its origin along its axes, is Y parameters",
            carried.link_regressors,
        ),
        "static_regressor": ("Y (3, 4 L): the mass centre is Y (m, m c of each link)", carried.static_regressor),
        "mechanical_energy": ("T + V (1)", carried.energy),
        "stored_energy_rate": (
            "rate of V along v (1)",
            lambda t, s: t.kinematics.along(lambda q: np.array([t.V(q)]), s.q, s.v),
        ),
        "base_wrench": (
            "what the world exerts on the first links, about its origin along its axes (6)",
            carried.base_wrench,
        ),
        "link_accelerations_driven": ("link_accelerations at the accelerations that tau makes (L, 6)", carried.driven),
        "coordinate_rates": ("N v (nq)", carried.coordinate_rates),
        "speeds_of_rates": ("v, of N v (nv)", lambda t, s: s.v),
        "link_turning": (
            "angular velocities of the links (L, 3)",
            lambda t, s: derived.velocities(t, s.q, s.v, "aligned")[:, 3:],
        ),
        "coordinates_of_links": ("q, of the poses that the links have there (nq)", lambda t, s: s.q),
        "coordinates_normalized": ("q, of q with those doubled that have unit length (nq)", lambda t, s: s.q),
        "speeds_of_links": ("v, of the velocities that the links have there (nv)", lambda t, s: s.v),
        "squared_distance": ("the square of v2, of q and where v2 leads (1)", carried.squared_distance),
    }
    return functions_of(rows)


def _relative() -> dict[str, Function]:
    """Links as the first link sees them, along its axes."""
    rows = {
        "relative_poses": ("positions and rows of R in the first link (L, 12)", carried.relative_poses),
        "relative_velocities": ("rates of these positions, angular velocities (L, 6)", carried.relative_velocities),
        "relative_accelerations": ("rates of the rates, angular accelerations (L, 6)", carried.relative_accelerations),
        "relative_jacobians": ("Jacobians of these velocities (L, 6, nv)", carried.relative_jacobians),
    }
    return functions_of(rows)


def _points() -> dict[str, Function]:
    """A point of each link (`points.POINT`), along the world's axes."""
    rows = {
        "point_jacobians": ("Jacobians (L, 3, nv)", points.jacobians),
        "point_velocities": ("velocities (L, 3)", points.velocities),
        "point_accelerations": ("accelerations (L, 3)", points.accelerations),
        "point_velocity_products": ("accelerations at a = 0 (L, 3)", points.products),
        "point_velocities_dq": ("derivatives of the velocities by q (L, 3, nv)", points.velocities_dq),
        "point_accelerations_dq": ("derivatives of the accelerations by q (L, 3, nv)", points.accelerations_dq),
        "point_accelerations_dv": ("derivatives of the accelerations by v (L, 3, nv)", points.accelerations_dv),
    }
    return functions_of(rows)


def _placements() -> dict[str, Function]:
    """What other placements of joints would make of links' poses."""
    rows = {
        f"placement_regressor_{frame}": (
            "twists of the links for twists of what places each joint, along the axes that it places (L, 6, 6 L)",
            carried.placement_regressor(frame),
        )
        for frame in derived.FRAMES
    }
    return functions_of(rows)


CARRIED = _wholes() | _relative() | _points() | _placements()
