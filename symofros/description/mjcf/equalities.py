"""Equality constraints of a compiled MJCF model: points and frames that stay together, joints that follow others.

MuJoCo holds them by soft forces; here they are exact conditions. With b1, b2 the two bodies and the entries d of
`eq_data`: a connect joins the point d[0:3] of b1 to d[3:6] of b2; a weld joins the frame of b1 at d[3:6], turned by the
quaternion d[6:10], to the point d[0:3] of b2 and to its axes; between sites, both join the sites. A joint follows
another by a polynomial of the distances from the reference, q1 - ref1 = sum of d[i] (q2 - ref2)^i.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.base.names import symbol_of
from symofros.description.constraints import AXES, Closure, Coupling
from symofros.description.forces import Anchor
from symofros.description.frames import Frame
from symofros.description.imported.geometry import Exact, rotation_of
from symofros.description.joints.joint import WORLD
from symofros.description.mjcf.names import Names
from symofros.description.remarks import Remarks
from symofros.description.values import Term
from symofros.expr.expression import Expression

# mjtEq, mjtObj and mjtDisableBit of mujoco/mjmodel.h, which never change: compiled models are stored by them.
CONNECT, WELD, JOINT = range(3)
_SITE = 6
_NO_EQUALITIES = 1 << 0 | 1 << 1
_DEGREE = 4
_TORQUE_SCALE = 10  # Index in eq_data of a weld.


class EqualityReader:
    """Reads the equality constraints of a model.

    Args:
        model: An MjModel.
        bodies: Names of the bodies.
        joints: Names of the joints.
        sites: Names of the sites.
        remarks: Remarks on what is ignored or changed.
        exact: Makes numbers exact.

    Attributes:
        frames: Frames that closures need, by the index of their body.
        constraints: The constraints.
    """

    def __init__(self, model: Any, bodies: Names, joints: Names, sites: Names, remarks: Remarks, exact: Exact) -> None:
        self.model, self.bodies, self.joints, self.sites = model, bodies, joints, sites
        self.remarks = remarks
        self.exact = exact
        self.names = Names("equality", [model.equality(i).name for i in range(model.neq)])
        self.frames: dict[int, tuple[Frame, ...]] = {}
        self.constraints = tuple(self._constraints())

    def _constraints(self) -> Iterator[Closure | Coupling]:
        m = self.model
        for i in range(m.neq):
            name = self.names[i]
            if m.opt.disableflags & _NO_EQUALITIES or not m.eq_active0[i]:
                self.remarks.add("equality constraints that are switched off ignored", "constraint", name)
                continue
            self.remarks.add("equality constraints hold exactly, in MuJoCo softly", "constraint", name)
            yield self._coupling(i) if m.eq_type[i] == JOINT else self._closure(i)

    def _closure(self, i: int) -> Closure:
        m, data = self.model, np.array(self.model.eq_data[i])
        ends = int(m.eq_obj1id[i]), int(m.eq_obj2id[i])
        # d[10] scales a weld's rotations beside its translations; at zero MuJoCo leaves them free.
        rotations = AXES if m.eq_type[i] == WELD and data[_TORQUE_SCALE] else ()
        if m.eq_objtype[i] == _SITE:
            first, second = (self._body(int(m.site_bodyid[site]), self.sites[site]) for site in ends)
            return Closure(self.names[i], first, second, AXES, rotations)
        if m.eq_type[i] == WELD:
            places = (data[3:6], rotation_of(data[6:10])), (data[0:3], np.eye(3))
        else:
            places = (data[0:3], np.eye(3)), (data[3:6], np.eye(3))
        first, second = (
            self._frame(body, f"{self.names[i]}_{side}", *place)
            for body, side, place in zip(ends, ("first", "second"), places, strict=True)
        )
        return Closure(self.names[i], first, second, AXES, rotations)

    def _frame(self, body: int, name: str, p: Array, R: Array) -> Anchor:
        """A frame of its own on a body."""
        name = self.sites.fresh(name)
        self.frames[body] = (*self.frames.get(body, ()), Frame(name, *self.exact.placement(p, R)))
        return self._body(body, name)

    def _body(self, body: int, frame: str) -> Anchor:
        return (self.bodies[body] if body else WORLD, frame)

    def _coupling(self, i: int) -> Coupling:
        m = self.model
        first, second = int(m.eq_obj1id[i]), int(m.eq_obj2id[i])
        coefficients = [float(c) for c in m.eq_data[i][: _DEGREE + 1]]
        residual = self._distance(first) - Term(coefficients[0])
        if second >= 0 and any(coefficients[1:]):
            x = power = self._distance(second)
            for c in coefficients[1:]:
                if c:
                    residual = residual - (power if c == 1.0 else Term(c) * power)
                power = power * x
        return Coupling(self.names[i], residual.value)

    def _distance(self, joint: int) -> Term:
        """Coordinate of a hinge or slide, counted from its reference."""
        q = Term(Expression("symbol", name=symbol_of(self.joints[joint])))
        ref = float(self.model.qpos0[self.model.jnt_qposadr[joint]])
        return q - Term(ref) if ref else q
