"""Direct kinematics: where frames are and how they move; their Jacobians (section 6.1 of the paper)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from symofros.blocks.checks import refuse
from symofros.blocks.quantities import joint_units
from symofros.blocks.rotations import quaternion_of_matrix
from symofros.diagrams.block import At, Block, Known, Port, Ports, Values
from symofros.diagrams.tensor import Tensor, stacked


def _motion_ports(known: Known, model: str, names: str) -> tuple[Port, ...]:
    """Inputs q, v, a of a model, rates zero where nothing is connected."""
    record = known.model(model)
    units = dict(zip("qva", joint_units(record)[:3], strict=True))
    sizes = {"q": len(record.q_names), "v": len(record.v_names), "a": len(record.v_names)}
    return tuple(Port(name, (sizes[name],), units[name], None if name == "q" else 0.0) for name in names)


def _frame_ports(*count: int) -> tuple[Port, ...]:
    """Outputs of `_frame_motion`, of one frame or of a count of them."""
    return (
        Port("p", (*count, 3), "m"),
        Port("R", (*count, 3, 3)),
        Port("quaternion", (*count, 4)),
        Port("velocity", (*count, 6)),
        Port("acceleration", (*count, 6)),
    )


def _frame_motion(at: At, model: str, frame: str) -> dict[str, Tensor]:
    q, v, a = (at.inputs[name] for name in "qva")
    pose = at.call(model, "frame_pose", frame, q=q, t=at.t)
    V = at.call(model, "frame_velocity", frame, q=q, v=v, t=at.t)["V"]
    A = at.call(model, "frame_acceleration", frame, q=q, v=v, a=a, t=at.t)["A"]
    return {
        "p": pose["p"],
        "R": pose["R"],
        "quaternion": quaternion_of_matrix(pose["R"]),
        "velocity": V,
        "acceleration": A,
    }


@dataclass(frozen=True, kw_only=True)
class ForwardKinematics(Block):
    """Pose, velocity and acceleration of a frame: p, R, J v, J a + J' v.

    Attributes:
        model: The model.
        frame: Frame of the model.
    """

    model: str
    frame: str

    def ports(self, known: Known) -> Ports:
        """Motion q, v, a in; p (3), R (3, 3), quaternion (4), velocity and acceleration (6), linear first, out."""
        known.frame(self.model, self.frame)
        return Ports(_motion_ports(known, self.model, "qva"), _frame_ports())

    def compute(self, at: At) -> Values:
        """By the model's own functions."""
        return _frame_motion(at, self.model, self.frame)


@dataclass(frozen=True, kw_only=True)
class Extremities(Block):
    """Poses, velocities and accelerations of several frames at once.

    Attributes:
        model: The model.
        frames: Names of the frames; none: all of the model's but the world's.
    """

    model: str
    frames: Any = ()

    def _frames(self, known: Known) -> list[str]:
        chosen = list(self.frames) or [name for name in known.model(self.model).frame_names if name != "world"]
        if not chosen:
            raise refuse(self.name, "no frames", f"model '{self.model}'", "a model with frames", "add a frame")
        return [known.frame(self.model, name) for name in chosen]

    def ports(self, known: Known) -> Ports:
        """Motion in; p (k, 3), R (k, 3, 3), quaternion (k, 4), velocity and acceleration (k, 6) out."""
        k = len(self._frames(known))
        return Ports(_motion_ports(known, self.model, "qva"), _frame_ports(k))

    def compute(self, at: At) -> Values:
        """Frame by frame; what they share is computed once."""
        found = [_frame_motion(at, self.model, frame) for frame in self._frames(at.known)]
        return {key: stacked([motion[key] for motion in found]) for key in found[0]}


@dataclass(frozen=True, kw_only=True)
class Jacobian(Block):
    """J and J' of a frame, in translation and rotation: J v is its velocity (linear; angular), world axes.

    Attributes:
        model: The model.
        frame: Frame of the model.
    """

    model: str
    frame: str

    def ports(self, known: Known) -> Ports:
        """Motion q, v in; J, rate (6, nv); translation and rotation are rows 0 to 2 and 3 to 5 of J (3, nv)."""
        known.frame(self.model, self.frame)
        nv = len(known.model(self.model).v_names)
        return Ports(
            _motion_ports(known, self.model, "qv"),
            (
                Port("J", (6, nv)),
                Port("rate", (6, nv)),
                Port("translation", (3, nv)),
                Port("rotation", (3, nv)),
            ),
        )

    def compute(self, at: At) -> Values:
        """By the model's own functions."""
        q, v = at.inputs["q"], at.inputs["v"]
        J = at.call(self.model, "frame_jacobian", self.frame, q=q, t=at.t)["J"]
        rate = at.call(self.model, "frame_jacobian_rate", self.frame, q=q, v=v, t=at.t)["dJ"]
        return {"J": J, "rate": rate, "translation": J[:3], "rotation": J[3:]}
