"""Position, velocity, acceleration and Jacobians of frames, in world axes (docs/theory/rigid.md, section 8)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from symofros.expr.edges import ZERO, Edge
from symofros.expr.vector import Mat3, Vec3
from symofros.mechanics.kinematics.links import TreeKinematics
from symofros.mechanics.spatial.across import PartialVelocity
from symofros.mechanics.topology.tree import BASE, NamedFrame


@dataclass(frozen=True)
class Pose:
    """Position and rotation of a frame F, or of a link's frame, in the world W."""

    p_WF: Vec3
    R_WF: Mat3


@dataclass(frozen=True)
class Rates:
    """Velocity and acceleration of a frame F, or of a link's frame, in the world W and its axes."""

    v_WFo_W: Vec3
    w_WF_W: Vec3
    a_WFo_W: Vec3
    alpha_WF_W: Vec3


class FrameKinematics:
    """The frames of one tree; link results are shared between frames and functions."""

    def __init__(self, kinematics: TreeKinematics) -> None:
        self.kinematics = kinematics
        self.g = kinematics.g
        self._poses: dict[int, Pose] = {BASE: Pose(Vec3(self.g), Mat3.identity(self.g))}
        self._placements: dict[str, tuple[Mat3, Vec3]] = {}

    def link_pose(self, index: int) -> Pose:
        """Pose of a link."""
        path = [i for i in self.kinematics.tree.ancestors(index) if i not in self._poses]
        for i in reversed(path):
            link = self.kinematics.links[i]
            parent = self._poses[link.parent]
            p = (parent.p_WF + parent.R_WF.times(link.p_AL)).named(f"p_WL[{link.name}]")
            self._poses[i] = Pose(p, link.R_AL.after(parent.R_WF))
        return self._poses[index]

    def pose(self, frame: NamedFrame) -> Pose:
        """Pose of a frame."""
        link = self.link_pose(frame.link)
        R_LF, p_LF = self._in_link(frame)
        return Pose(link.p_WF + link.R_WF.times(p_LF), link.R_WF @ R_LF)

    def _in_link(self, frame: NamedFrame) -> tuple[Mat3, Vec3]:
        if frame.qualified not in self._placements:
            placed = self.kinematics.lowering.placement(frame.placement, self.kinematics.in_link(frame.link))
            self._placements[frame.qualified] = placed
        return self._placements[frame.qualified]

    def _partials(self, index: int) -> list[PartialVelocity]:
        """Partial velocities of a link's own joint in world axes; their rates are those seen in the link."""
        R_WL = self.link_pose(index).R_WF
        return [
            PartialVelocity(*map(R_WL.times, (partial.w, partial.v, partial.w_rate, partial.v_rate)))
            for partial in self.kinematics.links[index].partial_velocities
        ]

    def _link_rates(self, frame: NamedFrame, v_rate: Sequence[Edge] | None) -> dict[int, Rates]:
        """Rates of every link on the way to a frame (eqs. 28, 29); without v', accelerations are left zero."""
        zero = Vec3(self.g)
        rates = {BASE: Rates(zero, zero, zero, zero)}
        for i in reversed(self.kinematics.tree.ancestors(frame.link)):
            link = self.kinematics.links[i]
            parent = rates[link.parent]
            r = self.link_pose(i).p_WF - self.link_pose(link.parent).p_WF
            w_AL_W, v_ALo_W, w_AL_W_rate, v_ALo_W_rate = zero, zero, zero, zero
            v_rates = [ZERO] * len(link.partial_velocities) if v_rate is None else link.speed_rates(v_rate)
            for partial, speed, rate in zip(self._partials(i), link.speeds, v_rates, strict=True):
                w_AL_W, v_ALo_W = w_AL_W + partial.w.scaled(speed), v_ALo_W + partial.v.scaled(speed)
                w_AL_W_rate = w_AL_W_rate + (partial.w.scaled(rate) + partial.w_rate.scaled(speed))
                v_ALo_W_rate = v_ALo_W_rate + (partial.v.scaled(rate) + partial.v_rate.scaled(speed))
            w_r = parent.w_WF_W.cross(r)
            alpha = parent.alpha_WF_W + (w_AL_W_rate + parent.w_WF_W.cross(w_AL_W))
            a = parent.a_WFo_W + (parent.alpha_WF_W.cross(r) + parent.w_WF_W.cross(w_r))
            a = a + (v_ALo_W_rate + (parent.w_WF_W + parent.w_WF_W + w_AL_W).cross(v_ALo_W))
            rates[i] = Rates(parent.v_WFo_W + w_r + v_ALo_W, parent.w_WF_W + w_AL_W, a, alpha)
        return rates

    def velocity(self, frame: NamedFrame) -> list[Edge]:
        """Linear, then angular velocity of the frame (6)."""
        rates = self._rates(frame, None)
        return [*rates.v_WFo_W, *rates.w_WF_W]

    def acceleration(self, frame: NamedFrame, v_rate: Sequence[Edge]) -> list[Edge]:
        """Linear, then angular acceleration: the rate of `velocity` (6)."""
        rates = self._rates(frame, v_rate)
        return [*rates.a_WFo_W, *rates.alpha_WF_W]

    def _rates(self, frame: NamedFrame, v_rate: Sequence[Edge] | None) -> Rates:
        link = self._link_rates(frame, v_rate)[frame.link]
        r = self.link_pose(frame.link).R_WF.times(self._in_link(frame)[1])
        w_r = link.w_WF_W.cross(r)
        a_WFo_W = link.a_WFo_W + (link.alpha_WF_W.cross(r) + link.w_WF_W.cross(w_r))
        return Rates(link.v_WFo_W + w_r, link.w_WF_W, a_WFo_W, link.alpha_WF_W)

    def jacobian(self, frame: NamedFrame) -> list[list[Edge]]:
        """The partial velocities of the frame: 6 rows of nv edges (eq. 30)."""
        p_WF = self.pose(frame).p_WF
        rows = self._empty()
        for i in self._free(frame):
            r = p_WF - self.link_pose(i).p_WF
            for k, partial in enumerate(self._partials(i)):
                self._fill(rows, self.kinematics.links[i].first_speed + k, partial.v + partial.w.cross(r), partial.w)
        return rows

    def jacobian_rate(self, frame: NamedFrame) -> list[list[Edge]]:
        """The time derivative of `jacobian` (eq. 31)."""
        rates = self._link_rates(frame, None)
        v_WFo_W = self._rates(frame, None).v_WFo_W
        p_WF = self.pose(frame).p_WF
        rows = self._empty()
        for i in self._free(frame):
            r, r_rate = p_WF - self.link_pose(i).p_WF, v_WFo_W - rates[i].v_WFo_W
            for k, partial in enumerate(self._partials(i)):
                # Partial velocities turn with the link, on top of what they change in it.
                w_k_rate = partial.w_rate + rates[i].w_WF_W.cross(partial.w)
                v_k_rate = partial.v_rate + rates[i].w_WF_W.cross(partial.v)
                linear = v_k_rate + (w_k_rate.cross(r) + partial.w.cross(r_rate))
                self._fill(rows, self.kinematics.links[i].first_speed + k, linear, w_k_rate)
        return rows

    def _free(self, frame: NamedFrame) -> list[int]:
        """Links on the way to a frame whose motion is not prescribed."""
        return [i for i in self.kinematics.tree.ancestors(frame.link) if self.kinematics.links[i].rates is None]

    def _empty(self) -> list[list[Edge]]:
        return [[ZERO] * self.kinematics.nv for _ in range(6)]

    @staticmethod
    def _fill(rows: list[list[Edge]], k: int, linear: Vec3, angular: Vec3) -> None:
        for row, edge in zip(rows, (*linear, *angular), strict=True):
            row[k] = edge
