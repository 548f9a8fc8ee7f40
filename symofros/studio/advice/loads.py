"""What beams and elastic joints meet in a motion: accelerations, spins, masses they carry, how far outputs are."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.base.options import Options
from symofros.compiler import compile_system
from symofros.description import DIRECTIONS, STATION, Beam, Body, Direction, System, Value
from symofros.expr import evaluate
from symofros.mechanics.beams import AXES, TURNING, section_law
from symofros.studio.advice import estimators
from symofros.studio.advice.scene import Scene
from symofros.studio.advice.scene_runner import ReferenceSolution

_STATIONS = np.linspace(0.0, 1.0, 5)
# Samples at each end of a motion whose differences are one-sided.
_EDGE = 2
# How much of a displacement that an output does not ride on is taken to reach it, by reaction.
_REACTION = 0.1


class TipDeflection(NamedTuple):
    """Displacement [m] and slope [rad] of a tip."""

    displacement: float
    slope: float


@dataclass(frozen=True)
class BeamLoads:
    """One beam in a motion; largest values over time.

    Attributes:
        beam: Beam as described.
        length: Length [m].
        rhoA: Mean [kg/m].
        stiffness: Least EI_z (bend_y), EI_y (bend_z) and GJ (twist) [N m^2]; those of rigid directions are infinite.
        outboard: Mass carried by the tip [kg].
        spin: Angular speed across the axis [rad/s].
        across: Acceleration of the root along y and z, less gravity [m/s^2].
        turning: Angular acceleration about z (bends along y), y and x [rad/s^2].
        along: Acceleration of the root along x, less gravity [m/s^2].
        force: Force on the tip along y and z, by the motion and the weight of what it carries [N].
        moment: Moment on the tip about z (bends along y) and about y, of the same causes [N m].
        period: Characteristic periods of the loads along y and z [s].
        moment_of_inertia: Moment of inertia of what is outboard, about the beam's axis [kg m^2].
        tip: Largest displacement of the tip across the axis, in the simulation [m].
        reach: Displacement of outputs per displacement of the tip, in units of what is allowed [1/m].
        lever: The same per slope of the tip [1/rad].
    """

    beam: Beam
    length: float
    rhoA: float
    stiffness: dict[Direction, float]
    outboard: float
    spin: float
    across: tuple[float, float]
    turning: tuple[float, float, float]
    along: float
    force: tuple[float, float]
    moment: tuple[float, float]
    period: tuple[float, float]
    moment_of_inertia: float
    tip: float
    reach: float
    lever: float

    def eta(self, direction: Direction) -> float:
        """Dimensionless spin, Omega sqrt(rhoA L^4/EI), for bending in a direction."""
        return self.spin * math.sqrt(self.rhoA * self.length**4 / self.stiffness[direction])

    @property
    def gain(self) -> float:
        """Outputs per displacement of the tip whose slope goes with it, in units of what is allowed [1/m]."""
        return self.reach + 1.5 * self.lever / self.length

    def deflection(self, direction: Direction, functions: int | None = None, modes: bool = False) -> TipDeflection:
        """Quasi-static displacement and slope of the tip, or what some shape functions leave out of them."""
        if direction == "twist":
            # A torque at the tip is met exactly by one function.
            couple = self.moment_of_inertia * self.turning[2] * self.length / self.stiffness["twist"]
            return TipDeflection(0.0, 0.0 if functions else couple)
        i = 0 if direction == "bend_y" else 1
        return TipDeflection(
            *estimators.deflection(
                self.rhoA,
                self.stiffness[direction],
                self.length,
                self.across[i],
                self.turning[i],
                self.force[i],
                self.moment[i],
                functions,
                modes,
            )
        )

    def share(self, bent: TipDeflection) -> float:
        """Effect of a displacement and a slope of the tip on outputs, in units of the tolerance."""
        return bent.displacement * self.reach + bent.slope * self.lever

    def frequency(self, direction: Direction) -> float:
        """First one of bending [rad/s]."""
        return estimators.first_frequency(self.rhoA, self.stiffness[direction], self.length, self.outboard)

    def periods(self, direction: Direction) -> float:
        """Number of periods of the first bending mode within the time that the load takes to come and go."""
        return self.frequency(direction) * self.period[direction == "bend_z"] / (2.0 * math.pi)

    def stiffening(self, direction: Direction) -> float:
        """Relative shift of the first frequency by foreshortening."""
        EI = self.stiffness[direction]
        pull = self.outboard * (self.along + self.spin**2 * self.length)
        gamma = self.rhoA * self.along * self.length**3 / EI
        return estimators.stiffening(self.eta(direction), gamma, pull * self.length**2 / EI)


@dataclass(frozen=True)
class Observed:
    """A motion as its estimators see it: poses of the frames that matter, in the scene's samples."""

    system: System
    scene: Scene
    reference: ReferenceSolution
    poses: dict[str, tuple[Array, Array]]

    @classmethod
    def of(cls, system: System, scene: Scene, reference: ReferenceSolution) -> Observed:
        """Poses by the interpreter: 400 of them take less time than compiling them."""
        beams = system.beams
        names = [body.name for body in system.bodies if body.joint is not None]
        names += [f"{beam.name}.{frame.name}" for beam in beams for frame in beam.frames] + list(scene.frames)
        names = list(dict.fromkeys(names))
        model = compile_system(reference.system, Options(("frame_pose",), tuple(names), backend="interpreter"))
        run = reference.run
        return cls(system, scene, reference, {n: model.frame_pose(n, run.q, u=run.u, par=run.par) for n in names})

    @property
    def dt(self) -> float:
        """Between samples [s]."""
        return float(self.scene.times[1])

    def number(self, value: Value, x: float = 0.0) -> float:
        """A value at a station, with the default parameters."""
        return evaluate(value, {**self.system.parameter_values(), STATION: x})

    def outboard_of(self, name: str) -> list[Body]:
        """The bodies that a body carries, itself left out."""
        carriers = {name}
        while True:  # Children may be described before their parents.
            more = {b.name for b in self.system.bodies if b.joint is not None and b.joint.parent in carriers} - carriers
            if not more:
                return [body for body in self.system.bodies if body.name in carriers - {name}]
            carriers |= more

    def mass(self, body: Body) -> float:
        """[kg]."""
        if isinstance(body, Beam):
            length = self.number(body.length)
            return length * float(np.mean([self.number(body.rhoA, x * length) for x in _STATIONS]))
        return self.number(body.inertia.mass) if body.inertia is not None else 0.0

    def reach(self, name: str, places: Array, length: float) -> tuple[float, float]:
        """What a displacement and a turn at a place do to outputs, in units of what is allowed [1/m, 1/rad].

        Args:
            name: The body that is displaced.
            places: Positions over time (n, 3) [m].
            length: Length that relates rotations of joints to displacements [m].
        """
        carried = {body.name for body in self.outboard_of(name)} | {name}
        shift = turn = 0.0
        for output in self.scene.outputs:
            bound = output.bound(self.reference.trial.values[output.name])
            if bound == 0.0 or output.kind in ("effort", "speed"):
                continue
            if output.kind == "coordinate":
                shift, turn = max(shift, _REACTION / (length * bound)), max(turn, _REACTION / bound)
                continue
            share = (1.0 if self.bearer(output.of) in carried else _REACTION) / bound
            distance = float(np.linalg.norm(self.poses[output.of][0] - places, axis=1).max())
            shift, turn = max(shift, share), max(turn, share * distance)
        return shift, turn

    def bearer(self, frame: str) -> str:
        """The body of a frame, given by its name or with its body's."""
        for body in self.system.bodies:
            if frame == body.name or any(frame in (one.name, f"{body.name}.{one.name}") for one in body.frames):
                return body.name
        return ""

    def beam(self, beam: Beam) -> BeamLoads:
        """Loads on a beam in the motion, largest values over time."""
        length = self.number(beam.length)
        p, R = self.poses[beam.name]
        gravity = np.array([self.number(value) for value in self.system.gravity])
        w = _rates(R, self.dt)
        turning = np.gradient(w, self.dt, axis=0)
        accelerated = np.gradient(np.gradient(p, self.dt, axis=0), self.dt, axis=0) - gravity
        a = np.einsum("nji,nj->ni", R, accelerated)
        inner = slice(_EDGE, -_EDGE)
        carried = self.outboard_of(beam.name)
        tip_frame = f"{beam.name}.{beam.frames[0].name}"
        tip = np.einsum("nji,nj->ni", R, self.poses[tip_frame][0] - p)
        load = [a[inner, k] + sign * turning[inner, j] * length for k, j, sign in ((1, 2, 1.0), (2, 1, -1.0))]
        periods = [estimators.characteristic_period(one, self.dt) for one in load]
        force, moment = self._on_tip(carried, self.poses[tip_frame][0], R, gravity)
        size = np.abs(a[inner]).max(axis=0)
        turns = np.abs(turning[inner]).max(axis=0)
        return BeamLoads(
            beam,
            length,
            self.mass(beam) / length,
            self._least_stiffness(beam, length),
            sum(map(self.mass, carried)),
            float(np.linalg.norm(w[:, 1:], axis=1).max()),
            (float(size[1]), float(size[2])),
            (float(turns[2]), float(turns[1]), float(turns[0])),
            float(size[0]),
            (float(force[1]), float(force[2])),
            (float(moment[2]), float(moment[1])),
            (periods[0], periods[1]),
            self._about_axis(beam, carried),
            float(np.linalg.norm(tip[:, 1:], axis=1).max()),
            *self.reach(beam.name, self.poses[tip_frame][0], length),
        )

    def _least_stiffness(self, beam: Beam, length: float) -> dict[Direction, float]:
        """Least stiffness along the beam of each direction that turns sections, without forces along or across it."""
        stiffness = section_law(beam, range(TURNING)).stiffness
        least = {}
        for direction in DIRECTIONS:
            axis, _ = AXES[direction]
            value = stiffness.get((axis, axis), 0.0)
            least[direction] = min(self.number(value, float(x) * length) for x in _STATIONS) or math.inf
        return least

    def _on_tip(self, bodies: Iterable[Body], tip: Array, R: Array, gravity: Array) -> tuple[Array, Array]:
        """Largest force (3) and moment (3) about a tip, in the beam's axes, by masses at the bodies' mass centres."""
        force, moment = np.zeros_like(tip), np.zeros_like(tip)
        for body in bodies:
            centre = self._centre(body)
            accelerated = np.gradient(np.gradient(centre, self.dt, axis=0), self.dt, axis=0) - gravity
            force += self.mass(body) * accelerated
            moment += self.mass(body) * np.cross(centre - tip, accelerated)
        inner = slice(_EDGE, -_EDGE)
        of_force, of_moment = (np.abs(np.einsum("nji,nj->ni", R, x)[inner]).max(axis=0) for x in (force, moment))
        return of_force, of_moment

    def _centre(self, body: Body) -> Array:
        """The mass centre over time, in the world (n, 3) [m]; a beam's at half its length."""
        p, R = self.poses[body.name]
        if isinstance(body, Beam):
            local = np.array([0.5 * self.number(body.length), 0.0, 0.0])
        else:
            stated = body.inertia.center_of_mass if body.inertia is not None else (0.0, 0.0, 0.0)
            local = np.array([self.number(value) for value in stated])
        centre: Array = p + R @ local
        return centre

    def _about_axis(self, beam: Beam, carried: Iterable[Body]) -> float:
        """Moment of inertia of masses about the beam's axis, as they stand at the start [kg m^2]."""
        p, R = self.poses[beam.name]
        total = sum(self.number(beam.rhoJ, float(x)) for x in _STATIONS) / len(_STATIONS) * self.number(beam.length) / 2
        for body in carried:
            away = R[0].T @ (self._centre(body)[0] - p[0])
            total += self.mass(body) * float(away[1] ** 2 + away[2] ** 2)
        return total


def _rates(R: Array, dt: float) -> Array:
    """Angular velocities in the body's axes (n, 3) of rotations (n, 3, 3)."""
    turn = np.einsum("nji,njk->nik", R[:-1], R[1:])
    skew = (turn - np.swapaxes(turn, 1, 2)) / 2.0
    axis = np.stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]], axis=-1)
    sine, cosine = np.linalg.norm(axis, axis=1), (np.trace(turn, axis1=1, axis2=2) - 1.0) / 2.0
    angle = np.arctan2(sine, cosine)
    w = axis * (angle / np.where(sine > 0.0, sine, 1.0))[:, None] / dt
    # Between samples; at a sample, the mean of its neighbours.
    rates: Array = np.concatenate([w[:1], (w[1:] + w[:-1]) / 2.0, w[-1:]])
    return rates
