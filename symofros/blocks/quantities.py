"""Units, shapes and coordinates that blocks have in common."""

from __future__ import annotations

from collections.abc import Sequence

from symofros.diagrams.block import Known, Shape
from symofros.runtime.record import ModelRecord


def joint_units(record: ModelRecord) -> tuple[str, str, str, str]:
    """Of q, v, a and efforts; all angles, or else left open, since a vector has one unit."""
    turns = len(record.q_names) == len(record.v_names) and all(record.periodic) and bool(record.periodic)
    efforts = set(record.u_names) <= set(record.v_names)
    return ("rad", "rad/s", "rad/s^2", "N m" if efforts else "") if turns else ("", "", "", "")


def common_shape(known: Known, names: Sequence[str]) -> Shape | None:
    """The shape that inputs of one shape have, as soon as one of them is known."""
    return next((known.inputs[name] for name in names if name in known.inputs), None)


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
