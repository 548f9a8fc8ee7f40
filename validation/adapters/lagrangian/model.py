"""A description as nodes of the Lagrangian engine: joints as motions, beams with shape functions of their own."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

import symofros as sf

from ...mechanics import shape_functions as families
from ...mechanics.assembly import Assembly, Mover
from ...mechanics.geometry import Array, Placement
from ...mechanics.parts import coordinate_symbols, input_symbol, rate_symbols, rates_by_coordinate, speed_symbols
from ...mechanics.rod import STRAINS
from ...mechanics.shape_functions import Shape
from ..description import evaluate
from . import rod as rods
from .beam import POINTS, SX, Flexible, Line, rotation_about
from .rod import ExactRod, Strain
from .tree import WORLD, Manifold, Node, Rotor, Solid, Symbols, quaternion_rotation

_CASADI: Mapping[str, Callable[..., SX]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "pow": lambda a, b: a**b,
    "neg": lambda a: -a,
    "sqrt": ca.sqrt,
    "exp": ca.exp,
    "log": ca.log,
    "sin": ca.sin,
    "cos": ca.cos,
    "tan": ca.tan,
    "asin": ca.asin,
    "acos": ca.acos,
    "atan": ca.atan,
    "atan2": ca.atan2,
    "sinh": ca.sinh,
    "cosh": ca.cosh,
    "tanh": ca.tanh,
    "abs": ca.fabs,
    "sign": ca.sign,
    "min": ca.fmin,
    "max": ca.fmax,
}

SECTION = ("rhoA", "EI_z", "EI_y", "GJ", "rhoJ", "rhoI_y", "rhoI_z")


class Translation:
    """Nodes of a description, one for each mover of its assembly, in the same order.

    Args:
        system: The description.
        assembly: The same as numbers.
    """

    def __init__(self, system: sf.System, assembly: Assembly) -> None:
        self.system, self.assembly = system, assembly
        self._numbers: dict[str, Any] = {"pi": np.pi, "t": 0.0, **system.parameter_values()}

    def build(self) -> tuple[list[Node], Symbols]:
        """The nodes, and the symbols that loads on beams are formulas of."""
        nodes = [self._node(mover) for mover in self.assembly.movers]
        symbols = Symbols.of(nodes, len(self.system.inputs))
        values = self._values(symbols)
        for i, mover in enumerate(self.assembly.movers):
            beam = nodes[i].body
            if isinstance(beam, Flexible | ExactRod):
                nodes[i] = replace(nodes[i], body=replace(beam, loads=self._loads(mover, beam.length, values)))
        return nodes, symbols

    def number(self, value: sf.Expression | float) -> float:
        """A formula of parameters."""
        return float(evaluate(value, self._numbers))

    def _node(self, mover: Mover) -> Node:
        solid = _solid(mover) if mover.masses else None
        if mover.kind == "elastic":
            beam = self.system.body(mover.body)
            assert isinstance(beam, sf.Beam)
            return Node(
                mover.parent,
                self._rod(beam) if beam.elastic.is_exact else self._flexible(beam),
                motion=lambda _: _constant(mover.X_AP),
                tip=solid,
                at=self._first(mover),
            )
        if mover.kind == "section":
            return Node(mover.parent, solid, at=self._first(mover), station=mover.length)
        manifold: Manifold = mover.kind if mover.kind == "ball" or mover.kind == "free" else "flat"
        across = self._across(mover)

        def motion(x: SX) -> tuple[SX, SX]:
            p_A, R_A = _constant(mover.X_AP)
            p, R = across(x)
            return p_A + R_A @ p, R_A @ R

        rotors = tuple(self._rotors(mover))
        return Node(
            mover.parent,
            solid,
            mover.part.speeds,
            motion,
            mover.joint.prescribed,
            manifold,
            rotors,
            at=self._first(mover),
        )

    def _first(self, mover: Mover) -> tuple[int, int]:
        """First coordinate and speed of a joint; its parts need not come in the order of its coordinates."""
        if not mover.joint.prescribed:
            return mover.q.start, mover.v.start
        names = [joint.name for joint in self.assembly.driven_joints]
        before = self.assembly.driven_joints[: names.index(mover.joint.name)]
        q, v = (sum(len(symbols(joint)) for joint in before) for symbols in (coordinate_symbols, speed_symbols))
        return q + mover.part.first, v + mover.part.first

    def _across(self, mover: Mover) -> Callable[[SX], tuple[SX, SX]]:
        """Position and rotation of the moving frame in P, of the coordinates."""
        axis, none, still = ca.SX(mover.axis), ca.SX.zeros(3), ca.SX.eye(3)
        simple: dict[str, Callable[[SX], tuple[SX, SX]]] = {
            "revolute": lambda x: (none, rotation_about(axis, x[0])),
            "prismatic": lambda x: (axis * x[0], still),
            "screw": lambda x: (axis * mover.pitch * x[0], rotation_about(axis, x[0])),
            "ball": lambda x: (none, quaternion_rotation(x)),
            "free": lambda x: (x[:3], quaternion_rotation(x[3:])),
            "general": lambda x: self._general(mover.joint, x),
        }
        return simple[mover.kind]

    def _general(self, joint: sf.Joint, x: SX) -> tuple[SX, SX]:
        values = self._numbers | {name: x[i] for i, name in enumerate(joint.coordinates)}
        p, turn = (
            [ca.SX(evaluate(value, values, _CASADI)) for value in part]
            for part in (joint.moving_position, joint.moving_rotation.values)
        )
        return ca.vertcat(*p), _rotation(joint.moving_rotation.kind, turn)

    def _rotors(self, mover: Mover) -> list[Rotor]:
        armature = self.number(mover.joint.armature)
        rotors = [Rotor(armature, 1.0, k, WORLD, (0, 0, 1)) for k in range(mover.part.speeds) if armature]
        for rotor in mover.joint.rotors:
            k = rotor.coordinate - mover.part.first
            if 0 <= k < mover.part.speeds:
                carrier, axis = self._bearing(mover, rotor)
                rotors.append(Rotor(self.number(rotor.inertia), self.number(rotor.ratio), k, carrier, axis))
        return rotors

    def _bearing(self, mover: Mover, rotor: sf.Rotor) -> tuple[int, list[float]]:
        if rotor.axis is None:
            return mover.parent, (mover.X_AP.R @ mover.axis).tolist()
        name = rotor.carrier or mover.joint.parent
        site = self.assembly.frames.get(name)
        axis = np.array([self.number(value) for value in rotor.axis])
        axis = axis / np.linalg.norm(axis)
        return (WORLD, axis.tolist()) if site is None else (site.mover, (site.X_BF.R @ axis).tolist())

    def _flexible(self, beam: sf.Beam) -> Flexible:
        L = self.number(beam.length)
        counts = beam.bend_y, beam.bend_z, beam.twist
        functions, breaks = [], set()
        for direction, count in zip(("bend_y", "bend_z", "twist"), counts, strict=True):
            shapes, ends = self._shapes(beam, direction, count, L) if count else ((), ())
            functions.append(shapes)
            breaks |= set(ends)
        sections: dict[str, Any] = {name: self._section(getattr(beam, name)) for name in SECTION}
        # The square of u is the highest power in T; for n polynomials of degree n + 1 it has degree 4 n + 2.
        points = max(POINTS, 2 * max(counts) + 6)
        return Flexible(
            L,
            v=functions[0],
            w=functions[1],
            twist=functions[2],
            damping=self.number(beam.damping),
            foreshortening=beam.foreshortening,
            rotary_inertia=beam.rotary_inertia,
            breaks=tuple(sorted(breaks)),
            points=points,
            **sections,
        )

    def _rod(self, beam: sf.Beam) -> ExactRod:
        L = self.number(beam.length)
        strains: list[Strain] = []
        breaks: set[float] = set()
        counts = [getattr(beam, direction) for direction in STRAINS]
        for count, (direction, (axis, sign)) in zip(counts, STRAINS.items(), strict=True):
            if beam.family == "user":
                functions = [self._strain(stated) for stated in beam.user_shapes(direction)]  # type: ignore[arg-type]
            else:
                functions, ends = families.strain_family(beam.family, count)
                breaks |= {L * end for end in ends}
            strains += [Strain(axis, sign, value) for value in functions]
        labels = (*SECTION, "EA", "GA_y", "GA_z", "EI_yz", "rhoI_yz")
        sections: dict[str, Any] = {name: self._section(getattr(beam, name)) for name in labels}
        for name in ("tension_center", "shear_center", "mass_center"):
            sections[name] = tuple(map(self._section, getattr(beam, name)))
        sections["stiffness"] = tuple(tuple(map(self._section, row)) for row in beam.stiffness)
        pre = beam.twist_rate, beam.curvature_y, beam.curvature_z
        unstressed = self._section(pre[0]), self._section(pre[1]), self._section(pre[2])
        return ExactRod(
            L,
            strains=tuple(strains),
            unstressed=unstressed,
            breaks=tuple(sorted(breaks)),
            points=beam.sections or rods.sections_chosen(counts, beam.family, bool(breaks)),
            damping=self.number(beam.damping),
            rotary_inertia=beam.rotary_inertia,
            sixth=bool(beam.sections) or beam.family == "user" or max(counts[:3]) > 2 or any(map(callable, unstressed)),
            **sections,
        )

    def _strain(self, stated: Any) -> Callable[[Array], Array]:
        return lambda xi: np.array([float(evaluate(stated, self._numbers | {"xi": at})) for at in xi.tolist()])

    def _section(self, value: sf.Expression | float) -> float | Callable[[float], float]:
        if not isinstance(value, sf.Expression):
            return value
        return lambda x: float(evaluate(value, self._numbers | {"x": x}))

    def _shapes(
        self, beam: sf.Beam, direction: Any, count: int, L: float
    ) -> tuple[tuple[Shape, ...], tuple[float, ...]]:
        bending = direction != "twist"
        if beam.family != "user":
            return families.of_family(beam.family, count, L, bending)
        shapes, breaks = [], set()
        for stated in beam.user_shapes(direction):
            if isinstance(stated, sf.Samples):
                shapes.append(families.through(stated.xi, stated.values, L, bending))
                breaks |= {L * xi for xi in stated.xi}
            else:
                shapes.append(self._formula(stated, L))
                breaks |= {L * k / 8 for k in range(1, 8)}
        return tuple(shapes), tuple(breaks)

    def _formula(self, stated: sf.Expression | float, L: float) -> Shape:
        """A function of xi, differentiated by CasADi."""
        xi = ca.SX.sym("xi")
        value = ca.SX(evaluate(stated, self._numbers | {"xi": xi}, _CASADI))
        slope = ca.jacobian(value, xi)

        def curve(expression: SX) -> Callable[[Any], Array]:
            function = ca.Function("curve", [xi], [expression])
            return lambda x: np.array(function(np.reshape(x, (1, -1)))).reshape(np.shape(x))

        return families.stretched(curve(value), curve(slope), curve(ca.jacobian(slope, xi)), L)

    def _values(self, symbols: Symbols) -> dict[str, Any]:
        """What formulas of loads stand for."""
        values = self._numbers | {input_symbol(item.name): symbols.u[i] for i, item in enumerate(self.system.inputs)}
        for described in self.assembly.free_joints:
            for speeds in (speed_symbols(described.joint), rates_by_coordinate(described.joint)[0]):
                values |= {name: symbols.seen[described.v.start + i] for i, name in enumerate(speeds)}
        for described in self.assembly.free_joints:  # Rather than the rate of another joint, if both have one name.
            names = coordinate_symbols(described.joint)
            values |= {name: symbols.q[described.q.start + i] for i, name in enumerate(names)}
        i = k = 0
        for joint in self.assembly.driven_joints:
            for name in coordinate_symbols(joint):
                values[name], i = symbols.s[i], i + 1
            plain, others = (speed_symbols(joint), rate_symbols(joint)), rates_by_coordinate(joint)
            for speed, rate, same_speed, same_rate in zip(*plain, *others, strict=True):
                values |= dict.fromkeys((speed, same_speed), symbols.ds[k])
                values |= dict.fromkeys((rate, same_rate), symbols.dds[k])
                k += 1
        return values

    def _loads(self, mover: Mover, length: float, values: Mapping[str, Any]) -> tuple[Line, ...]:
        beam = self.system.body(mover.body)
        assert isinstance(beam, sf.Beam)

        def along(vector: Any) -> Callable[[float], list[SX]]:
            return lambda x: [ca.SX(evaluate(value, {**values, "x": x}, _CASADI)) for value in vector]

        return tuple(
            Line(
                along(load.force),
                along(load.torque),
                None if load.at is None else load.at * length,
                load.axes,
            )
            for load in beam.loads
        )


def _solid(mover: Mover) -> Solid:
    mass = mover.merged()
    J = mass.J_BC
    return Solid(mass.mass, mass.p_BC.tolist(), (*np.diag(J), J[0, 1], J[0, 2], J[1, 2]))


def _constant(X: Placement) -> tuple[SX, SX]:
    return ca.SX(X.p), ca.SX(X.R)


def _rotation(kind: str, values: list[SX]) -> SX:
    if kind == "matrix":
        return ca.reshape(ca.vertcat(*values), 3, 3).T
    if kind == "quaternion":
        quaternion = ca.vertcat(*values)
        return quaternion_rotation(quaternion / ca.norm_2(quaternion))
    if kind == "axis_angle":
        return rotation_about(values[:3], values[3])
    roll, pitch, yaw = values
    return rotation_about((0, 0, 1), yaw) @ rotation_about((0, 1, 0), pitch) @ rotation_about((1, 0, 0), roll)
