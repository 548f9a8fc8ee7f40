"""What the rest of the generator asks of an elastic beam, whatever its theory; `theories.py` has one row a theory.

`BeamTheory` answers from the description alone: functions, sizes and units of the coordinates, shape, what judges a
deformation. `BeamEquations` answers on a graph: kinematics, inertia, forces, section forces. A theory is a folder
beside this module that implements the two.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symofros.description.beams.beam import Beam, BeamLoad
from symofros.description.beams.elastic import Direction
from symofros.description.beams.shapes import Family, UserShape
from symofros.description.values import Value
from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3, Vec3
from symofros.mechanics.beams.fields import Field, Form
from symofros.mechanics.beams.integrals import LengthIntegrator, Lower
from symofros.mechanics.beams.piecewise import Piecewise
from symofros.mechanics.spatial.across import AcrossJoint
from symofros.mechanics.spatial.inertia import LinkInertia
from symofros.mechanics.spatial.wrench import LinkMotion, Wrench

Array = npt.NDArray[np.float64]
Rows = tuple[tuple[float, ...], ...]


@dataclass(frozen=True, eq=False)
class BeamEquations(ABC):
    """What the equations of motion ask of one beam in a graph.

    Vectors are in the frame L of the link at the root unless stated; B is the beam's own frame there.

    Attributes:
        beam: The beam as described.
        along: Integration over its length.
        R_LB: The beam's frame in the link's frame.
        order: Degree in elastic coordinates and speeds up to which terms of the equations of motion are kept.
    """

    beam: Beam
    along: LengthIntegrator
    R_LB: Mat3
    order: float

    @property
    def g(self) -> Graph:
        """The graph."""
        return self.along.g

    @property
    def coordinates(self) -> tuple[Edge, ...]:
        """Edges of the elastic coordinates."""
        return self.along.coordinates

    def root_motion(self, motion: LinkMotion) -> tuple[Vec3, Vec3, Vec3]:
        """Angular velocity, angular acceleration and acceleration of the root, in B."""
        R_BL = self.R_LB.T
        return R_BL.times(motion.w_WL_L), R_BL.times(motion.alpha_WL_L), R_BL.times(motion.a_WLo_L)

    # Kinematics.

    @abstractmethod
    def across(self, xi: float, speeds: Sequence[Edge], deflected: bool) -> AcrossJoint:
        """The motion of a section in the root frame B.

        Args:
            xi: Station x/L of the section.
            speeds: Rates of the elastic coordinates.
            deflected: Whether the section is where its deflection puts it also in a theory whose equations of motion
                leave it at its undeformed place.
        """

    @abstractmethod
    def section(self, xi: float) -> tuple[Vec3, Mat3]:
        """Where the equations of motion have the section at a station: p_BS in B, and R_BS."""

    # Inertia.

    @abstractmethod
    def undeformed(self) -> LinkInertia:
        """The part of the inertia about the root that is constant; what deformation adds is not regrouped."""

    @abstractmethod
    def deformed(self) -> LinkInertia:
        """Change of the inertia by deformation, to the beam's order."""

    @abstractmethod
    def first_moment_change(self) -> Vec3:
        """Change of the first moment by deformation, one order further: its gradient is the weight's force."""

    @abstractmethod
    def modal_mass(self, i: int, j: int) -> Edge:
        """M_ij of two elastic coordinates."""

    @abstractmethod
    def momentum(self, i: int) -> tuple[Vec3, Vec3]:
        """Linear momentum and angular momentum about the root per unit rate of coordinate i."""

    @abstractmethod
    def inertia_forces(
        self, motion: LinkMotion, speeds: Sequence[Edge], rates: Sequence[Edge]
    ) -> tuple[Wrench, list[Edge]]:
        """Inertia forces beside those of the constant part: the wrench on the root, and one on each coordinate.

        Args:
            motion: Motion of the link at the root, with gravity as an acceleration of the base.
            speeds: Rates of the elastic coordinates.
            rates: Second derivatives of the elastic coordinates.
        """

    @abstractmethod
    def inertia_beyond(self, motion: LinkMotion, speeds: Sequence[Edge], rates: Sequence[Edge]) -> Iterator[Wrench]:
        """Wrench about the root, in B, that all inertia beyond each of the beam's stations takes."""

    @abstractmethod
    def kinetic_energy_twice(self, w: Vec3, v: Vec3, speeds: Sequence[Edge]) -> Edge:
        """Twice the kinetic energy beside that of the constant part.

        Args:
            w: Angular velocity of the root [rad/s].
            v: Velocity of the root [m/s].
            speeds: Rates of the elastic coordinates.
        """

    # Forces.

    @property
    @abstractmethod
    def strain_energy(self) -> Form:
        """Strain energy as a form of the elastic coordinates."""

    @abstractmethod
    def damping_energy(self, speeds: tuple[Edge, ...]) -> Form:
        """Rayleigh's dissipation function as a form of the rates of the elastic coordinates."""

    def elastic_forces(self, speeds: tuple[Edge, ...]) -> list[Edge]:
        """Elastic and damping forces on the elastic coordinates (docs/theory/beams.md, eqs. 7, 14)."""
        dissipation = self.damping_energy(speeds)
        return [
            -self.g.add(elastic.value(), viscous.value())
            for elastic, viscous in zip(self.strain_energy.gradient, dissipation.gradient, strict=True)
        ]

    @abstractmethod
    def load(self, load: BeamLoad, k: int, d: Vec3) -> tuple[Wrench, list[Edge]]:
        """Component k of a load, along d in B: the wrench about the root in B, the force on each coordinate."""

    @abstractmethod
    def load_beyond(self, load: BeamLoad, k: int, d: Vec3, xi: float) -> Iterator[Wrench]:
        """Wrenches about the root, in B, that component k of a load adds up to beyond a station."""


class Interpolated(NamedTuple):
    """Properties that a theory evaluates at some stations, and interpolates between them.

    Attributes:
        properties: Label and values of what is interpolated.
        known: Stations x/L at which it is known.
        between: Stations at which it is used.
        weights: Weights of the values at the former in those at the latter.
    """

    properties: Sequence[tuple[str, Sequence[Value]]] = ()
    known: tuple[float, ...] = ()
    between: tuple[float, ...] = ()
    weights: Rows = ()


class Judged(NamedTuple):
    """Measures that a deformation is judged by (docs/theory/beams.md, 6; rods.md, 6).

    Attributes:
        counts: Number of coordinates of bend_y, bend_z and the others.
        xi: Stations x/L (s).
        angles: Yaw, pitch or twist of the section at each station by each coordinate, of a beam of unit length (s, n).
        displacements: Whether each coordinate is a displacement (n), which counts by the length.
        EI_z: Stiffness against bending in the x-y plane at mid-length; 0 of a theory that does not err by bending.
        EI_y: Stiffness against bending in the x-z plane at mid-length.
        sections: Number of sections, of a theory that errs by their number alone; else 0.
        integration_error: Of such a theory: numbers of the parameters -> elastic coordinates (n) -> error of the shape
            over the length. None of a theory that errs by its bending.
    """

    counts: tuple[int, int, int]
    xi: tuple[float, ...]
    angles: Rows
    displacements: tuple[bool, ...]
    EI_z: Value = 0.0
    EI_y: Value = 0.0
    sections: int = 0
    integration_error: Callable[[Mapping[str, float]], Callable[[Array], float]] | None = None


class BeamShape(ABC):
    """Where the sections of a beam are at some stations, for given elastic coordinates: in numbers."""

    @abstractmethod
    def points(self, length: float, q: Array) -> Array:
        """p_BS of the stations, in the axes of the root (..., S, 3) [m].

        Args:
            length: Length of the beam [m].
            q: Elastic coordinates (..., n).
        """

    @abstractmethod
    def axes(self, length: float, q: Array) -> Array:
        """R_BS of the sections (..., S, 3, 3)."""


class BeamTheory(ABC):
    """One beam as described, by its theory.

    Args:
        beam: The beam.
    """

    def __init__(self, beam: Beam) -> None:
        self.beam = beam

    @classmethod
    @abstractmethod
    def family_functions(
        cls, family: Family, direction: Direction, count: int, user: tuple[UserShape, ...] = ()
    ) -> Sequence[tuple[Piecewise, bool]]:
        """The first functions of a family for one direction, each with whether its coordinate is a length.

        Args:
            family: Name of the family.
            direction: Direction of the functions.
            count: Number of functions.
            user: Functions stated by the user, for family "user".

        Raises:
            FamilyError: The family has none, or not as many.
        """

    @property
    @abstractmethod
    def functions(self) -> Sequence[Piecewise]:
        """Shape functions, one a coordinate.

        Raises:
            FamilyError: The family has no such functions.
        """

    @property
    @abstractmethod
    def units(self) -> tuple[str, ...]:
        """SI unit of each elastic coordinate."""

    @abstractmethod
    def sizes(self, length: float) -> tuple[float, ...]:
        """Sizes of the elastic coordinates up to which the theory holds: bounds for random states.

        Args:
            length: Length of the beam [m].
        """

    def resolved(self, number: Callable[[Value, float], float]) -> Beam:
        """The beam with what it leaves to the generator chosen.

        Args:
            number: The number of a value at a station x [m]; NaN where it has none.
        """
        return self.beam

    @property
    def interpolated(self) -> Interpolated:
        """Properties interpolated between stations; none where all integrals are exact or checked."""
        return Interpolated()

    @property
    @abstractmethod
    def strains(self) -> Mapping[int, Field]:
        """Fields of the strains with functions, by their number (`strain.section_law`): their linear terms count."""

    @property
    @abstractmethod
    def judged(self) -> Judged:
        """Data by which a deformation of this beam is judged."""

    @abstractmethod
    def shape(self, values: Mapping[str, float], stations: Sequence[float]) -> BeamShape:
        """Poses of the sections at some stations, as functions of the elastic coordinates.

        Args:
            values: Number of each parameter.
            stations: Stations x/L (S).
        """

    @abstractmethod
    def equations(
        self, g: Graph, lower: Lower, coordinates: tuple[Edge, ...], R_LB: Mat3 | None = None
    ) -> BeamEquations:
        """The beam in a graph.

        Args:
            g: The graph that operations are added to.
            lower: Lowering of values of the description to edges.
            coordinates: Edges of the elastic coordinates.
            R_LB: The beam's frame in the frame of the link at its root; the same if not given.
        """
