"""Reactions of a model: wrenches that joints transmit, efforts of prescribed motions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from symofros.errors import ShapeError
from symofros.runtime.calls.kernel import Array, Kernel
from symofros.runtime.functions import ArrayLike
from symofros.runtime.methods.constraints import ConstraintFunctions
from symofros.runtime.methods.states import StateFunctions


class ContactForces(NamedTuple):
    """State of the balls of contacts.

    Attributes:
        gap: Distance of each ball from the surface, negative where it penetrates it (..., nk) [m].
        push: Normal force (..., nk) [N].
        force: Force on the ball, in world axes (..., nk, 3) [N]; the surface's body gets the opposite.
        point: Point in the world where it acts (..., nk, 3) [m].
        share: Penetration over the radius of the ball, or of the surface; zero of points on planes (..., nk).
    """

    gap: Array
    push: Array
    force: Array
    point: Array
    share: Array


class ReactionFunctions(ConstraintFunctions, StateFunctions):
    """Methods of a model that tell of the reactions in a motion; arguments as in `Model`."""

    def joint_wrenches(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        u: ArrayLike,
        lam: ArrayLike | None = None,
        *,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
        z: ArrayLike | None = None,
    ) -> Array:
        """What each joint transmits from its parent to its body (..., joints, 6) [N, N m].

        The force f_Bo_B, then the moment n_Bo_B about the origin of the body frame B, both along its axes, in the order
        of `names.joints`: constraint forces of the joint, its springs, dampers, friction and actuators together. They
        are what the motion takes beyond the weight and all other loads (docs/theory/rigid.md, section 11). Of an
        elastic beam "BEAM.tip" is what its tip transmits to what it carries, in the frame of the tip. Bodies on fixed
        joints are parts of the body that carries them.

        Args:
            q: Configuration (..., nq).
            v: Speeds (..., nv).
            a: Rates of the speeds (..., nv): with `forward_dynamics`, the wrenches of the motion under u.
            u: Inputs (..., nu): loads may depend on them; efforts of actuators count through a alone.
            lam: Multipliers (..., nc), from `forward_dynamics` or `sf.actuator_efforts`; needed where loops are closed.
            par: Run-time parameters.
            t: Time.
            z: States of forces (..., nz): loads may depend on them.
        """
        return self._reactions("joint_wrenches", q, v if z is None else self._with_states(v, z), a, u, lam, par, t)

    def section_forces(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        u: ArrayLike,
        lam: ArrayLike | None = None,
        *,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
        z: ArrayLike | None = None,
    ) -> Array:
        """Force and moment inside elastic beams (..., sections, 6) [N, N m], in the order of `names.sections`.

        Normal force N, shear forces Vy and Vz, torque T and bending moments My and Mz: what the part of the beam beyond
        the station does to the part before it, about the beam's axis and along the section's axes; N is positive
        in tension. They hold what lies beyond in its motion against its weight and all loads, so that in equilibrium
        they are exact for the deformed shape (docs/theory/beams.md, section 9). A load at a station counts there as
        beyond it. Stations are those of `Beam.stations`.

        Arguments as of `joint_wrenches`.
        """
        return self._reactions("section_forces", q, v if z is None else self._with_states(v, z), a, u, lam, par, t)

    def prescribed_efforts(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        u: ArrayLike,
        lam: ArrayLike | None = None,
        *,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
        z: ArrayLike | None = None,
    ) -> Array:
        """Efforts of the drives of prescribed motions (..., speeds) [N m or N], in the order of `names.prescribed`.

        Arguments as of `joint_wrenches`. A drive's power is its effort times its speed; its effort counts what its
        rotors and its armature take (docs/theory/rigid.md, (49)).
        """
        return self._reactions("prescribed_efforts", q, v if z is None else self._with_states(v, z), a, u, lam, par, t)

    def contact_forces(
        self,
        q: ArrayLike,
        v: ArrayLike,
        u: ArrayLike | None = None,
        *,
        lam: ArrayLike | None = None,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
        z: ArrayLike | None = None,
    ) -> ContactForces:
        """Distances and forces of contacts, in the order of `names.contacts`.

        Args:
            q: Configuration (..., nq).
            v: Speeds (..., nv).
            u: Inputs, for prescribed motions.
            lam: Multipliers (..., nc), as of a run: the forces of rigid contacts, which are not numbers without them.
            par: Run-time parameters.
            t: Time.
            z: States of forces (..., nz), such as the deflections of bristles.
        """
        given = {"q": q, "v": v if z is None else self._with_states(v, z), "u": u, "t": t}
        found = ContactForces(*self._call("contact_forces", "", given, par))
        if not self.record.rigid_contacts:
            return found
        push, force = found.push.copy(), found.force.copy()
        for ball in self.record.rigid_contacts:
            k = self.names.contacts.index(ball.name)
            push[..., k], force[..., k, :] = np.nan, np.nan
            if lam is not None:
                parts = [self.closure_wrench(name, q, lam, u=u, par=par, t=t) for name in ball.constraints]
                push[..., k], force[..., k, :] = np.asarray(lam)[..., ball.rows[2]], np.sum(parts, axis=0)[..., :3]
        return found._replace(push=push, force=force)

    def contact_state(self) -> Kernel:
        """States of the balls of rigid contacts, one after the other: each as of `RigidContactRecord.state`."""
        own = self._kernels.get(("contact_state", ""))
        return own or self.formulas([x for ball in self.record.rigid_contacts for x in ball.state], derivatives=False)

    def _reactions(
        self,
        name: str,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        u: ArrayLike,
        lam: ArrayLike | None,
        par: ArrayLike | None,
        t: ArrayLike,
    ) -> Array:
        if lam is None and self.nc:
            raise ShapeError(
                f"{name} of model '{self.record.name}': no lam",
                f"{self.nc} constraints, whose forces joints carry too",
                "(..., nc) multipliers",
                "give those of forward_dynamics(..., multipliers=True) or of sf.actuator_efforts",
            )
        given = {"q": q, "v": v, "a": a, "u": u, "lam": np.zeros(0) if lam is None else lam, "t": t}
        return self._one(name, given, par)
