"""Units, shapes and coordinates that blocks have in common."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal

from symofros.base.measures import OTHER, ROTATION, TRANSLATION
from symofros.blocks.checks import refuse
from symofros.diagrams.block import Environment, Port, Ports, Shape
from symofros.runtime.record import ModelRecord

# Of q, v, a and the effort, by the kind of a speed; elastic coordinates and those of the user's own joints have units
# of their own, which are not known here.
_UNITS = {
    ROTATION: ("rad", "rad/s", "rad/s^2", "N m"),
    TRANSLATION: ("m", "m/s", "m/s^2", "N"),
    OTHER: ("", "", "", ""),
}
NO_UNIT = "1"
# Of (linear; angular) vectors.
WRENCH = ("N",) * 3 + ("N m",) * 3
VELOCITY = ("m/s",) * 3 + ("rad/s",) * 3
ACCELERATION = ("m/s^2",) * 3 + ("rad/s^2",) * 3
Quantity = Literal["q", "v", "a", "effort", "u"]


def entry_units(record: ModelRecord, quantity: Quantity) -> tuple[str, ...]:
    """Units of the entries of a model's q (nq), v, a, efforts (nv) or inputs u (nu); "" where they are not known."""
    kinds = record.measures.kinds(len(record.v_names))
    if quantity == "u":
        efforts = dict(zip(record.v_names, entry_units(record, "effort"), strict=True))
        return tuple("" if record.driven else efforts.get(name, "") for name in record.u_names)
    column = ("q", "v", "a", "effort").index(quantity)
    if quantity != "q":
        return tuple(_UNITS[kind][column] for kind in kinds)
    units: list[str] = []
    for segment in record.segments:
        along = segment.size if segment.kind == "linear" else segment.translations
        units += [_UNITS[kinds[segment.v + i]][column] for i in range(along)]
        units += [NO_UNIT] * (segment.size - along)
    return tuple(units)


def with_units(port: Port, units: Sequence[str]) -> Port:
    """A port whose entries have these units: one unit where they are all alike."""
    if len(set(units)) <= 1:
        return replace(port, unit=units[0] if units else "", units=())
    return replace(port, unit="", units=tuple(units))


def motion_port(name: str, record: ModelRecord, quantity: Quantity, default: Any = None) -> Port:
    """A port for a model's q (nq), v, a, efforts (nv) or inputs u (nu), with the units of their entries."""
    units = entry_units(record, quantity)
    return with_units(Port(name, (len(units),), "", default), units)


def passed_units(environment: Environment, stated: str, names: Sequence[str]) -> tuple[str, ...]:
    """Units of a signal that goes through a block: the stated one, or else that of the first input that has one."""
    if stated:
        return (stated,)
    return next((environment.units[name] for name in names if name in environment.units), ("",))


def passing(environment: Environment, shape: Shape | None, stated: str) -> Ports:
    """An input u and an output y of one shape and one unit: the stated unit, or that of the connected signal or bus."""
    units, signals = passed_units(environment, stated, ("u",)), environment.buses.get("u", ())
    u, y = (replace(with_units(Port(name, shape), units), signals=signals) for name in ("u", "y"))
    return Ports((u,), (y,))


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
