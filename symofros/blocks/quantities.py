"""Units, shapes and coordinates that blocks have in common."""

from __future__ import annotations

import re
from collections.abc import Sequence

from symofros.blocks.checks import refuse
from symofros.diagrams.block import Environment, Shape
from symofros.runtime.record import ModelRecord


def joint_units(record: ModelRecord) -> tuple[str, str, str, str]:
    """Of q, v, a and efforts; all angles, or else left open, since a vector has one unit."""
    turns = len(record.q_names) == len(record.v_names) and all(record.periodic) and bool(record.periodic)
    efforts = set(record.u_names) <= set(record.v_names)
    return ("rad", "rad/s", "rad/s^2", "N m" if efforts else "") if turns else ("", "", "", "")


def common_shape(environment: Environment, names: Sequence[str]) -> Shape | None:
    """The shape that inputs of one shape have, as soon as one of them is known."""
    return next((environment.inputs[name] for name in names if name in environment.inputs), None)


def frame_ports(block: str, prefix: str, frames: Sequence[str]) -> dict[str, str]:
    """Port -> frame, for ports of a block that are named after frames: the prefix and the name that the block states.

    All but letters, digits and underscores becomes an underscore, "wrench_link2_tip" for the frame "link2.tip", so that
    ports are names in Python and in "block.port".

    Args:
        block: Name.
        prefix: Such as "wrench_".
        frames: Frames as the block states them.

    Raises:
        DescriptionError: Two frames have one port.
    """
    ports = {prefix + re.sub(r"\W", "_", frame): frame for frame in frames}
    if len(ports) < len(frames):
        raise refuse(
            block,
            "two frames have one port",
            ", ".join(frames),
            "different names, dots read as underscores",
            "leave out those that stand twice, or rename one",
        )
    return ports


def actuated_names(record: ModelRecord) -> list[str]:
    """Speeds of actuated joints, in the order of the model's inputs: those that inputs are named after."""
    return [name for name in record.u_names if name in record.v_names]


def scalar_coordinates(record: ModelRecord) -> dict[str, tuple[int, int]]:
    """Coordinate whose rate is its speed -> its places in q and v; those of ball and free joints have none."""
    return {
        record.q_names[segment.q + i]: (segment.q + i, segment.v + i)
        for segment in record.segments
        if segment.kind == "linear"
        for i in range(segment.size)
    }
