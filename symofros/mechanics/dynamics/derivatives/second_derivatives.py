"""Second derivatives of the inverse dynamics (docs/theory/linear.md, section 6)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product

from symofros.base.routes import Choice, choose
from symofros.expr.derivative import along, directional
from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.mechanics.dynamics.applied.forces import rates_per_speed
from symofros.mechanics.dynamics.bodies.rotors import is_on_turning_axes
from symofros.mechanics.dynamics.derivatives.differentiation import by_inputs, weighted_derivatives
from symofros.mechanics.dynamics.derivatives.hessians import commuting
from symofros.mechanics.dynamics.equations import Equations
from symofros.mechanics.dynamics.mass_matrix import Matrix
from symofros.mechanics.dynamics.momentum import coadjoint
from symofros.mechanics.kinematics.links import TreeKinematics

Tensor = list[list[list[Edge]]]


def second_derivatives(e: Equations) -> tuple[Tensor, ...]:
    """Second derivatives of the inverse dynamics by (q, q), (v, v), (q, v) and (a, q) (nv x nv x nv each, eq. 11)."""
    kinematics, by_v, by_mass = e.kinematics, e.inverse_dynamics_by_v, mass_matrix_derivatives(e.kinematics, e.M)
    if route(e).method == "mass matrix":
        by_speeds = _sum(
            e.g, bias_second_derivatives(kinematics, e.M, by_mass), by_two_speeds(kinematics, e.passive_slopes)
        )
    else:
        by_speeds = by_two_speeds(kinematics, by_v)
    return (
        by_two_coordinates(kinematics, e.inverse_dynamics_by_q),
        by_speeds,
        by_coordinates_and_speeds(kinematics, by_v),
        by_mass,
    )


def hessian_vector_product(e: Equations) -> list[list[Edge]]:
    """Change of the derivatives of tau_bar . tau by q, v and a along (dq, dv, da): forward over reverse (eq. 13)."""
    weights = [e.g.input("tau_bar", k) for k in range(e.nv)]
    gradient = weighted_derivatives(e.kinematics, e.inverse_dynamics, weights, ("q", "v", "a"))
    return [along_direction(e.kinematics, edges) for edges in (gradient["q"], gradient["v"], gradient["a"])]


def by_two_speeds(kinematics: TreeKinematics, slopes: Matrix) -> Tensor:
    """Derivatives of by_v by the speeds once more: T[i][j][k] = T[i][k][j] (nv x nv x nv).

    Args:
        kinematics: Kinematics of the tree.
        slopes: Derivatives by the speeds (nv x nv).
    """
    speeds = [{kinematics.g.input("v", k): ONE} for k in range(kinematics.nv)]
    return _symmetric(kinematics, slopes, speeds, range(kinematics.nv))


def bias_second_derivatives(kinematics: TreeKinematics, M: Matrix, by_mass: Tensor) -> Tensor:
    """Derivatives of h by two speeds, which M determines (nv x nv x nv, eq. 11a)."""
    g, nv = kinematics.g, kinematics.nv
    turning = [by_inputs(kinematics, coadjoint(kinematics, row), "v", nv) for row in M]
    tensor = [[[ZERO] * nv for _ in range(nv)] for _ in range(nv)]
    for i, j in product(range(nv), repeat=2):
        for k in range(j, nv):
            christoffel = g.sub(g.add(by_mass[i][j][k], by_mass[i][k][j]), by_mass[j][k][i])
            edge = g.sub(christoffel, g.add(turning[k][i][j], turning[j][i][k]))
            tensor[i][j][k] = tensor[i][k][j] = edge
    return tensor


def by_two_coordinates(kinematics: TreeKinematics, slopes: Matrix) -> Tensor:
    """Derivatives of by_q along the manifold once more (nv x nv x nv).

    T[i][j][k] is the change of slope j as q moves with speed k. It is symmetric in j and k unless both belong to one
    joint that turns about several axes, whose motions do not commute (eq. 12).

    Args:
        kinematics: Kinematics of the tree.
        slopes: Derivatives by q (nv x nv).
    """
    return _symmetric(kinematics, slopes, rates_per_speed(kinematics), commuting(kinematics, kinematics.nv))


def by_coordinates_and_speeds(kinematics: TreeKinematics, slopes: Matrix) -> Tensor:
    """Derivatives of by_v along the manifold of q: T[i][j][k] by q_j, then by v_k (nv x nv x nv)."""
    nv = kinematics.nv
    flat = along(kinematics.g, [edge for row in slopes for edge in row], rates_per_speed(kinematics))
    return [[[flat[i * nv + k][j] for k in range(nv)] for j in range(nv)] for i in range(nv)]


def mass_matrix_derivatives(kinematics: TreeKinematics, M: Matrix) -> Tensor:
    """Derivatives of M along the manifold of q: T[i][j][k] of M_ij by q_k, symmetric in i and j (nv x nv x nv)."""
    nv = kinematics.nv
    lower = [(i, j) for i in range(nv) for j in range(i + 1)]
    rows = dict(zip(lower, along(kinematics.g, [M[i][j] for i, j in lower], rates_per_speed(kinematics)), strict=True))
    return [[rows[max(i, j), min(i, j)] for j in range(nv)] for i in range(nv)]


def along_direction(kinematics: TreeKinematics, edges: Sequence[Edge]) -> list[Edge]:
    """The change of some edges along the inputs (dq, dv, da), dq along the manifold."""
    g = kinematics.g
    seeds: dict[Edge, Edge] = {g.input(x, k): g.input(f"d{x}", k) for x in "va" for k in range(kinematics.nv)}
    for k, column in enumerate(rates_per_speed(kinematics)):
        for edge, rate in column.items():
            seeds[edge] = g.add(seeds.get(edge, ZERO), g.mul(rate, g.input("dq", k)))
    return directional(g, edges, seeds)


def route(e: Equations) -> Choice:
    """Whether h follows from v.M v/2, as (11a) has it; M and h of beams agree to the order of their theory."""
    figures = {
        "elastic_beams": sum(beam.tip is not None for beam in e.kinematics.beams),
        "turning_rotors": sum(is_on_turning_axes(e.kinematics, rotor) for rotor in e.rotors),
    }
    return choose("inverse dynamics by two speeds", figures)


def _sum(g: Graph, one: Tensor, other: Tensor) -> Tensor:
    """The entries of two tensors added."""
    return [
        [[g.add(x, y) for x, y in zip(*lines, strict=True)] for lines in zip(*matrices, strict=True)]
        for matrices in zip(one, other, strict=True)
    ]


def _symmetric(
    kinematics: TreeKinematics,
    slopes: Matrix,
    directions: Sequence[Mapping[Edge, Edge]],
    first: Sequence[int],
) -> Tensor:
    """Derivatives of slopes along directions: column j along those from first[j] on, the others by symmetry."""
    nv = kinematics.nv
    tensor = [[[ZERO] * nv for _ in range(nv)] for _ in range(nv)]
    for j in range(nv):
        changes = along(kinematics.g, [slopes[i][j] for i in range(nv)], directions[first[j] :])
        for i, change in enumerate(changes):
            for k, edge in enumerate(change, first[j]):
                tensor[i][j][k] = edge
                if first[k] > j:
                    tensor[i][k][j] = edge
    return tensor
