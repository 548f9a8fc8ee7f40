"""The regressor of a model, and the names of its columns (docs/theory/rigid.md, section 4)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
import numpy.typing as npt

from symofros.base.arguments import check_argument
from symofros.base.smoothed_sign import smoothed_sign
from symofros.errors import ArgumentError
from symofros.runtime.calls.kernel import Array
from symofros.runtime.functions import ArrayLike, Functions

# Inertial parameters of a link, in the order of the regressor's columns: mass, first moments m c, second moments about
# the origin of the body frame.
INERTIAL = ("m", "mx", "my", "mz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")
JointTerm = Literal["viscous", "coulomb", "armature"]


class IdentificationFunctions(Functions):
    """Methods of a model that are linear in inertial parameters; arguments as in `Model`."""

    def regressor(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        *,
        u: ArrayLike | None = None,
        par: ArrayLike | None = None,
        joint_terms: Sequence[JointTerm] = (),
        minimum_velocity: npt.ArrayLike = 1e-3,
    ) -> Array:
        """Regressor Y (..., nv, 10 links) with M a + h = Y pi, for the links' inertial parameters pi.

        Ten a link, in the order of the tree: m, m c (3), Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the origin of its body
        frame, along its axes; what is fixed to a body counts with it. Rotors, armatures and beams are not in pi, and
        neither are the forces of joints, dampers and friction among them, unless `joint_terms` asks for columns:

            M a + h + friction = Y pi,    nv columns each:  "viscous"   d v_k
                                                            "coulomb"   f sign(v_k), smoothed
                                                            "armature"  I a_k

        They are `Damper.coefficient` or `Friction.viscous`, `Friction.dynamic`, and `Joint.armature`: a rotor counts
        with its inertia times the square of its ratio, without its gyroscopic moments. What is not linear (Stribeck's
        `static`) has no column. `regressor_columns` names all of them.

        Args:
            q: Coordinates (..., nq).
            v: Speeds (..., nv).
            a: Accelerations (..., nv).
            u: Inputs, where they prescribe motion.
            par: Run-time parameters.
            joint_terms: Terms of the joints that get columns behind those of the links, in this order.
            minimum_velocity: Speed below which the sign of a speed is smoothed, as that of `Friction`, or one for each
                speed (nv) [rad/s or m/s].

        Raises:
            ArgumentError: A term is unknown, or a minimum velocity not above zero.
        """
        self._check_terms(joint_terms)
        Y = self._one("regressor", {"q": q, "v": v, "a": a, "u": u}, par)
        if not joint_terms:
            return Y
        speeds, rates = np.asarray(self._array("v", v, self.nv)), np.asarray(self._array("a", a, self.nv))
        values = {
            "viscous": speeds,
            "coulomb": smoothed_sign(speeds, self._smoothing(minimum_velocity)),
            "armature": rates,
        }
        columns = [
            np.broadcast_to(values[term][..., np.newaxis] * np.eye(self.nv), (*Y.shape[:-1], self.nv))
            for term in joint_terms
        ]
        return np.concatenate([Y, *columns], axis=-1).astype(Y.dtype)

    def regressor_columns(self, joint_terms: Sequence[JointTerm] = ()) -> tuple[str, ...]:
        """Names of the columns of `regressor`: "m(arm)", "mx(arm)", ..., "Izz(arm)" of each body, "viscous(q1)", ..."""
        self._check_terms(joint_terms)
        record = self.record
        links = [f"{each}({link})" for link in record.link_names for each in INERTIAL]
        return (*links, *(f"{term}({speed})" for term in joint_terms for speed in record.v_names))

    def _check_terms(self, joint_terms: Sequence[JointTerm]) -> None:
        check_argument("regressor: joint_terms", joint_terms, Sequence[JointTerm])
        if len(set(joint_terms)) < len(joint_terms):
            what, rule = f"model '{self.record.name}': regressor: a term is named twice", "a term has its columns once"
            raise ArgumentError(what, ", ".join(joint_terms), rule, "name each term once")

    def _smoothing(self, minimum_velocity: npt.ArrayLike) -> Array:
        given = np.asarray(minimum_velocity)
        if (
            given.shape not in ((), (self.nv,))
            or given.dtype.kind not in "fiu"
            or not np.all((given > 0.0) & (given < np.inf))
        ):
            raise ArgumentError(
                f"model '{self.record.name}': regressor: minimum_velocity can't be taken",
                f"{minimum_velocity!r:.60}",
                f"a finite number above zero, or one for each of {self.nv} speeds",
                "take that of the joint's Friction; 0.001 is its default",
            )
        return given.astype(np.float64)
