"""A beam as rigid links with springs between them: an ordinary system, which engines without beams can evaluate.

The beam is cut into N cells, with a hinge in the middle of each: the first and the last link are half as long as the
others. A hinge turns by yaw, pitch and roll, as far as the beam has functions for them, against springs EI/h and GJ/h.

It represents finite turns, and with them foreshortening and the coupling of bending and twist, without any order of
approximation; each link has the mass of its piece of the beam, tapered or not. What it approximates is curvature,
lumped at hinges. In one plane everything errs by C/N^2: measured orders are 2.00 for static deflections (4 % at N = 4
and a deflection of 0.8 L) and 1.95 to 2.00 for the frequencies of spinning beams from N = 16 on. Out of one plane the
turns of one hinge follow each other, which leaves an error of first order; Richardson's extrapolation over three N
removes both (`tests/validation/adapters/test_segments.py`).

It can't represent stretch, shear, loads that are spread or that follow the root, nor forces and constraints beside the
beam's own. Without `rotary_inertia` the mass of a link still turns with it: an error of second order again. MuJoCo
takes it only with a polar inertia that is not zero and that a body as short as half a link can have.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import symofros as sf

from ..contract.interface import Unsupported
from ..mechanics.quadrature import STATION, gauss_stations

# Gauss nodes a link.
_POINTS = 16
_TURNS = ("yaw", "pitch", "roll")


@dataclass(frozen=True)
class _Numbers:
    """A beam's section as numbers, at the default parameters."""

    beam: sf.Beam
    parameters: dict[str, float]

    @property
    def length(self) -> float:
        return float(sf.evaluate(self.beam.length, self.parameters))

    def at(self, value: sf.Expression | float, x: float) -> float:
        return float(sf.evaluate(value, {**self.parameters, STATION: x}))

    def moment(self, value: sf.Expression | float, a: float, b: float, power: int = 0, about: float = 0.0) -> float:
        """The integral of value (x - about)^power from a to b."""
        stations, weights = gauss_stations((a, b), _POINTS)
        values = np.array([self.at(value, x) for x in stations.tolist()])
        return float(weights @ (values * (stations - about) ** power))

    def inertia(self, a: float, b: float, origin: float) -> sf.Inertia:
        """Of the piece from a to b, in a frame at a station of the axis."""
        beam = self.beam
        mass = self.moment(beam.rhoA, a, b)
        center = self.moment(beam.rhoA, a, b, 1) / mass
        across = self.moment(beam.rhoA, a, b, 2, center)
        turned = [across + (self.moment(x, a, b) if beam.rotary_inertia else 0.0) for x in (beam.rhoI_y, beam.rhoI_z)]
        return sf.Inertia(mass, (center - origin, 0.0, 0.0), (self.moment(beam.rhoJ, a, b), *turned))


def segmented(system: sf.System, name: str, links: int) -> sf.System | Unsupported:
    """The system with one of its beams replaced by rigid links.

    Args:
        system: System with the beam.
        name: Name of the beam. The link at its root keeps it; the others are name_1 to name_N.
        links: N, the number of hinges, 1 or more. Coordinates are name_1_yaw, name_1_pitch, name_1_roll and so on.

    Raises:
        ValueError: There is no hinge.
        DescriptionError: There is no such body.
    """
    if links < 1:
        raise ValueError(f"{links} links: a beam is cut into one or more")
    beam = system.body(name)
    if not isinstance(beam, sf.Beam):
        return Unsupported(f"body '{name}': no beam")
    obstacle = _obstacle(system, beam)
    if obstacle is not None:
        return obstacle
    numbers = _Numbers(beam, system.parameter_values())
    L = numbers.length
    h = L / links
    ends = [0.0, *(h * (k + 0.5) for k in range(links)), L]
    pieces = [_link(numbers, k, ends, h) for k in range(links + 1)]
    for load in beam.loads:
        station = L * (load.at or 0.0)
        k = min(sum(end <= station for end in ends[1:-1]), links)
        pieces[k] = _loaded(pieces[k], load, station - ends[k])
    last = pieces[-1]
    frames = tuple(_moved(numbers, frame, L - ends[-2]) for frame in beam.frames)
    pieces[-1] = replace(last, frames=(*last.frames, *frames))
    bodies: list[sf.Body] = []
    for body in system.bodies:
        bodies += pieces if body is beam else [_carried(body, name, last.name)]
    return replace(system, bodies=tuple(bodies))


def _obstacle(system: sf.System, beam: sf.Beam) -> Unsupported | None:
    obstacles = {
        f"beam '{beam.name}': rigid": not beam.modes,
        f"beam '{beam.name}': a load that is spread": any(load.at is None for load in beam.loads),
        f"beam '{beam.name}': a load along the axes of its root": any(load.axes == "body" for load in beam.loads),
        f"system '{system.name}': connections, potentials, virtual powers or constraints": bool(
            system.connections or system.potentials or system.virtual_power or system.constraints
        ),
    }
    return next((Unsupported(reason) for reason, applies in obstacles.items() if applies), None)


def _link(numbers: _Numbers, k: int, ends: list[float], h: float) -> sf.RigidBody:
    beam = numbers.beam
    name = beam.name if k == 0 else f"{beam.name}_{k}"
    inertia = numbers.inertia(ends[k], ends[k + 1], ends[k])
    joint = beam.joint if k == 0 else _hinge(numbers, k, ends, h)
    # A link of a slender beam may have more moment about its axis than a body of its length can.
    return sf.RigidBody(name, joint, inertia, waive=("nonphysical_inertia", "massless_tip"))


def _hinge(numbers: _Numbers, k: int, ends: list[float], h: float) -> sf.Joint:
    """Turns by yaw, pitch and roll where the beam bends and twists, with the stiffness of one cell."""
    beam = numbers.beam
    names = {turn: f"{beam.name}_{k}_{turn}" for turn in _TURNS}
    counts = (beam.bend_y, beam.bend_z, beam.twist)
    stiffness = (beam.EI_z, beam.EI_y, beam.GJ)
    used = [(turn, value) for turn, count, value in zip(_TURNS, counts, stiffness, strict=True) if count]
    delay = float(sf.evaluate(beam.damping, numbers.parameters))
    elements: list[Any] = []
    for i, (_, value) in enumerate(used):
        spring = numbers.at(value, ends[k]) / h
        elements.append(sf.Spring(spring, coordinate=i))
        if delay:
            elements.append(sf.Damper(delay * spring, coordinate=i))
    chosen = {turn: names[turn] if any(turn == u for u, _ in used) else 0.0 for turn in _TURNS}
    return sf.Joint(
        f"{beam.name}_{k}_hinge",
        "general",
        beam.name if k == 1 else f"{beam.name}_{k - 1}",
        position=(ends[k] - ends[k - 1], 0.0, 0.0),
        coordinates=tuple(names[turn] for turn, _ in used),
        moving_rotation=sf.Rotation.rpy(chosen["roll"], chosen["pitch"], chosen["yaw"]),
        elements=tuple(elements),
    )


def _loaded(body: sf.RigidBody, load: sf.BeamLoad, x: float) -> sf.RigidBody:
    frame = sf.Frame(f"load_{len(body.loads)}", (x, 0.0, 0.0))
    stated = sf.Load(load.force, load.torque, frame.name, "world")
    return replace(body, frames=(*body.frames, frame), loads=(*body.loads, stated))


def _moved(numbers: _Numbers, frame: sf.Frame, x: float) -> sf.Frame:
    """A frame of the tip, seen from the last hinge."""
    along, y, z = frame.position
    return replace(frame, position=(float(sf.evaluate(along, numbers.parameters)) + x, y, z))


def _carried(body: sf.Body, beam: str, last: str) -> sf.Body:
    """A body of the system; what the beam's tip carried, the last link does."""
    joint = body.joint
    if joint is None or joint.parent != beam or joint.frame is None:
        return body
    return replace(body, joint=replace(joint, parent=last))
