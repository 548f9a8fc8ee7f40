"""Rotors for engines that know none, from two models of the same engine: one without rotors, one where they are bodies.

With the rotors' spins coupled to the joints that drive them, speeds of the second model are v' = G v; with the rotors
locked, v' = G_0 v. What spinning brings is the difference, so that (docs/theory/rigid.md, section 9)

    M = M_plain + G^T M' G - G_0^T M' G_0,     h = h_plain + G^T h'(G v) - G_0^T h'(G_0 v)

and a rotor's mass and locked inertia, which belong to its carrier, cancel: any will do.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import cast

import numpy as np

import symofros as sf

from ..contract.interface import Engine, EngineFactory, SolvedEngine, States, Subject, TreeEngine, Unsupported
from ..contract.quantities import FORCES_STATED, TREE_QUANTITIES
from ..mechanics.assembly import assemble
from ..mechanics.geometry import Array


@dataclass(frozen=True)
class _Spin:
    """A rotor as a body: its joint, the index of the speed that drives it, and the ratio."""

    joint: str
    driver: int
    ratio: float


def has_rotors(system: sf.System) -> bool:
    """Whether any joint drives a rotor."""
    return any(body.joint is not None and body.joint.rotors for body in system.bodies)


def build(factory: EngineFactory, subject: Subject) -> Engine | Unsupported:
    """An engine's model of a description with rotors."""
    plain = without_rotors(subject.system)
    bodies, spins = _rotor_bodies(subject.system)
    explicit = replace(subject, system=plain.with_bodies(*bodies), frames=())
    engines = [factory(replace(subject, system=plain)), factory(explicit)]
    for engine in engines:
        if isinstance(engine, Unsupported):
            return engine
    one, other = (cast(TreeEngine, engine) for engine in engines)
    return RotorEngine(one, other, *_speed_maps(plain, explicit.system, spins))


def without_rotors(system: sf.System) -> sf.System:
    """The same mechanism, its joints driving nothing."""
    return system.with_bodies(
        *(replace(body, joint=replace(body.joint, rotors=())) for body in system.bodies if body.joint is not None)
    )


def _rotor_bodies(system: sf.System) -> tuple[list[sf.RigidBody], list[_Spin]]:
    """Each rotor as a ball of its axial inertia, which is the same about whatever axis the joint has."""
    bodies, spins = [], []
    values = system.parameter_values()
    for described in assemble(system).joints:
        joint = described.joint
        for k, rotor in enumerate(joint.rotors):
            name = f"rotor {k} of {joint.name}"
            if rotor.axis is None:
                bearing = sf.Joint(
                    name, "revolute", joint.parent, joint.frame, rotation=joint.rotation, axis=joint.axis
                )
            else:
                bearing = sf.Joint(name, "revolute", rotor.carrier or joint.parent, axis=rotor.axis)
            ball = sf.Inertia(1.0, moments=(rotor.inertia,) * 3)
            bodies.append(sf.RigidBody(name, bearing, ball))
            driver = described.v.start + rotor.coordinate
            spins.append(_Spin(name, driver, float(sf.evaluate(rotor.ratio, values))))
    return bodies, spins


def _speed_maps(plain: sf.System, explicit: sf.System, spins: list[_Spin]) -> tuple[Array, Array, Array]:
    """G, G_0 (nv', nv), and the indices of our coordinates among those of the explicit model (nq)."""
    without, with_rotors = assemble(plain), assemble(explicit)
    place = {described.joint.name: described for described in with_rotors.joints}
    locked, at = np.zeros((with_rotors.nv, without.nv)), np.zeros(without.nq, dtype=int)
    for described in without.joints:
        there = place[described.joint.name]
        locked[there.v, described.v] = np.eye(described.v.stop - described.v.start)
        at[described.q] = np.arange(there.q.start, there.q.stop)
    coupled = locked.copy()
    for spin in spins:
        coupled[place[spin.joint].v.start, spin.driver] = spin.ratio
    return coupled, locked, at


class RotorEngine(SolvedEngine):
    """A tree engine with the rotors of a description.

    Args:
        plain: Engine without rotors, for all that rotors leave as it is.
        explicit: Engine with rotors as bodies.
        coupled: G, to the speeds of the explicit model with rotors driven by their joints (nv', nv).
        locked: G_0, the same with rotors that do not spin (nv', nv).
        at: Indices of the coordinates of `plain` among those of `explicit`; the others, angles of balls, do not matter.
    """

    def __init__(self, plain: TreeEngine, explicit: TreeEngine, coupled: Array, locked: Array, at: Array) -> None:
        self._plain, self._explicit, self._coupled, self._locked, self._at = plain, explicit, coupled, locked, at
        self._nq = len(at) + len(coupled) - coupled.shape[1]
        self.name, self.version = plain.name, plain.version
        # What rotors do to further quantities is not stated here.
        self.capabilities = plain.capabilities & (TREE_QUANTITIES | FORCES_STATED)

    def __getattr__(self, name: str) -> Callable[[States], Array]:
        """Quantities that rotors do not change."""
        method: Callable[[States], Array] = getattr(self._plain, name)
        return method

    def _moving(self, states: States, G: Array) -> States:
        q = np.zeros((len(states), self._nq))
        q[:, self._at] = states.q
        v = states.v @ G.T
        return States(q, v, 0.0 * v, states.u, 0.0 * v, 0.0 * v)

    def mass_matrix(self, states: States) -> Array:
        """M (N, nv, nv)."""
        M = self._explicit.mass_matrix(self._moving(states, self._locked))
        coupled, locked = (G.T @ M @ G for G in (self._coupled, self._locked))
        return self._plain.mass_matrix(states) + coupled - locked

    def bias(self, states: States) -> Array:
        """Coriolis, centrifugal, gyroscopic and gravity forces h (N, nv)."""
        coupled, locked = (self._explicit.bias(self._moving(states, G)) @ G for G in (self._coupled, self._locked))
        return self._plain.bias(states) + coupled - locked

    def kinetic_energy(self, states: States) -> Array:
        """T (N,) [J]."""
        coupled, locked = (
            self._explicit.kinetic_energy(self._moving(states, G)) for G in (self._coupled, self._locked)
        )
        return self._plain.kinetic_energy(states) + coupled - locked
