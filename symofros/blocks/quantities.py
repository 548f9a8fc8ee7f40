"""Units of a model's vectors, where all entries share one."""

from __future__ import annotations

from symofros.runtime.record import ModelRecord


def joint_units(record: ModelRecord) -> tuple[str, str, str, str]:
    """Of q, v, a and efforts; all angles, or else left open, since a vector has one unit."""
    turns = len(record.q_names) == len(record.v_names) and all(record.periodic) and bool(record.periodic)
    efforts = set(record.u_names) <= set(record.v_names)
    return ("rad", "rad/s", "rad/s^2", "N m" if efforts else "") if turns else ("", "", "", "")
