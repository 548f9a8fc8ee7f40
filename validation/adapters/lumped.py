"""Rest and steady spin of a beam of rigid links, by an engine that knows no beams (see `segments`)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import symofros as sf

from ..contract.interface import States, Subject, TreeEngine, Unsupported
from ..mechanics.assembly import assemble
from ..mechanics.geometry import Array
from ..mechanics.parts import coordinate_symbols
from .segments import segmented

# Of central differences [rad]: their error is its square, and rounding over it.
_STEP = 1e-5


@dataclass(frozen=True)
class Lumped:
    """A system with a segmented beam, as functions of its n coordinates: a hub's turn if there is one, then hinges.

    Attributes:
        engine: Has the tip for its only frame.
        names: Names of the coordinates.
        springs: Stiffness of each (n,) [N m/rad].
    """

    engine: TreeEngine
    names: tuple[str, ...]
    springs: Array

    def _states(self, q: Array, rate: float) -> States:
        q = np.atleast_2d(q)
        v = np.zeros_like(q)
        v[:, 0] = rate
        return States(q, v, 0 * q, np.zeros((len(q), 0)), 0 * q, 0 * q)

    def imbalance(self, q: Array, force: Array, rate: float = 0.0) -> Array:
        """H + K q - J^T force (N, n).

        Args:
            q: Coordinates (N, n).
            force: Force on the tip, in world axes (3,) [N].
            rate: The first speed; the others are zero.
        """
        states = self._states(q, rate)
        J = self.engine.frame_jacobian(states)[:, 0, :3]
        return np.asarray(self.engine.bias(states) + self.springs * states.q - np.einsum("nki,k->ni", J, force))

    def tangent(self, q: Array, force: Array, rate: float = 0.0) -> Array:
        """The derivative of the imbalance (n, n) at coordinates (n,), by central differences."""
        steps = _STEP * np.eye(len(q))
        ahead, behind = (self.imbalance(q + dq, force, rate) for dq in (steps, -steps))
        return np.asarray((ahead - behind).T / (2.0 * _STEP))

    def tip_at_rest(self, force: tuple[float, float, float], increments: int = 5) -> Array:
        """Position of the tip and the rows of its rotation (12,) under a dead load on it, by Newton's method.

        Args:
            force: Force in world axes [N].
            increments: Steps in which it is applied.

        Raises:
            RuntimeError: The imbalance stays above 1e-7 of the load.
        """
        q, whole = np.zeros(len(self.names)), np.array(force)
        for part in range(1, increments + 1):
            load = whole * part / increments
            for _ in range(4):
                q = q - np.linalg.solve(self.tangent(q, load), self.imbalance(q, load)[0])
        if not np.abs(self.imbalance(q, whole)).max() <= 1e-7 * np.abs(whole).max():
            raise RuntimeError(f"no state of rest was found in {increments} increments")
        pose: Array = self.engine.frame_pose(self._states(q, 0.0))[0, 0]
        return pose

    def spinning(self, rate: float, turn: str, count: int) -> Array:
        """Circular frequencies (count,) about the straight steady state of a hub that is held at its rate [rad/s].

        Args:
            rate: Rate of the first coordinate [rad/s].
            turn: "yaw" (in the plane of rotation) or "pitch"; the straight beam does not couple them.
            count: Number of frequencies.
        """
        own = [i for i, name in enumerate(self.names) if name.endswith(turn)]
        q = np.zeros(len(self.names))
        K = self.tangent(q, np.zeros(3), rate)[np.ix_(own, own)]
        M = self.engine.mass_matrix(self._states(q, rate))[0][np.ix_(own, own)]
        return np.asarray(np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(M, K)).real))[:count])


def lumped(
    system: sf.System, beam: str, links: int, build: Callable[[Subject], TreeEngine | Unsupported]
) -> Lumped | Unsupported:
    """A system with a beam as rigid links, by an engine.

    Args:
        system: System with a beam that has a frame `tip`; its other joints have one coordinate each.
        beam: Name of the beam.
        links: The number of hinges.
        build: The engine's.
    """
    links_only = segmented(system, beam, links)
    if isinstance(links_only, Unsupported):
        return links_only
    engine = build(Subject(f"{system.name}, {links} links", links_only, ("tip",)))
    if isinstance(engine, Unsupported):
        return engine
    names = [name for described in assemble(links_only).joints for name in coordinate_symbols(described.joint)]
    stiffness = {
        coordinate_symbols(body.joint)[element.coordinate]: float(sf.evaluate(element.stiffness, {}))
        for body in links_only.bodies
        if body.joint is not None
        for element in body.joint.elements
        if isinstance(element, sf.Spring)
    }
    return Lumped(engine, tuple(names), np.array([stiffness.get(name, 0.0) for name in names]))
