"""Names and indices of q, v, u and par: the only place where an index is assigned."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from symofros.description.system import Joint, System
from symofros.expr.graph import Slot

# Joint kind -> (nq, nv).
JOINT_SIZES: dict[str, tuple[int, int]] = {
    "fixed": (0, 0),
    "revolute": (1, 1),
    "continuous": (1, 1),
    "prismatic": (1, 1),
    "ball": (4, 3),
    "free": (7, 6),
}

_QUATERNION = ("qx", "qy", "qz", "qw")
_SUFFIXES_Q: dict[str, tuple[str, ...]] = {"ball": _QUATERNION, "free": ("px", "py", "pz", *_QUATERNION)}
_SUFFIXES_V: dict[str, tuple[str, ...]] = {
    "ball": ("wx", "wy", "wz"),
    "free": ("vx", "vy", "vz", "wx", "wy", "wz"),
}


def coordinate_names(joint: Joint) -> tuple[str, ...]:
    """Names of a joint's coordinates: its own name if there is one, otherwise name.qx and so on."""
    return _names(joint, _SUFFIXES_Q)


def speed_names(joint: Joint) -> tuple[str, ...]:
    """Names of a joint's speeds, alike."""
    return _names(joint, _SUFFIXES_V)


def _names(joint: Joint, suffixes: dict[str, tuple[str, ...]]) -> tuple[str, ...]:
    if joint.kind in suffixes:
        return tuple(f"{joint.name}.{suffix}" for suffix in suffixes[joint.kind])
    return (joint.name,) if JOINT_SIZES[joint.kind][0] else ()


def speed_symbols(joint: Joint) -> tuple[str, ...]:
    """What formulas call a joint's speeds: d + coordinate where the speed is its rate, otherwise the speed's name."""
    return tuple(f"d{n}" for n in speed_names(joint)) if joint.kind not in _SUFFIXES_V else speed_names(joint)


@dataclass(frozen=True)
class CoordinateMap:
    """Which name has which index.

    Attributes:
        q: Coordinate names, in order; likewise the speeds v, the inputs u and the run-time parameters par.
        par_default: Values of the run-time parameters.
        constants: Values of the constant parameters, by name.
        symbols: What formulas may use -> its slot; constants are not among them.
    """

    q: tuple[str, ...]
    v: tuple[str, ...]
    u: tuple[str, ...]
    par: tuple[str, ...]
    par_default: tuple[float, ...]
    constants: dict[str, float]
    symbols: dict[str, Slot]


def map_coordinates(system: System, joints: Sequence[Joint]) -> CoordinateMap:
    """Assign the indices.

    Args:
        system: For its parameters and inputs.
        joints: The moving joints, in the order of the links.
    """
    q = tuple(name for joint in joints for name in coordinate_names(joint))
    v = tuple(name for joint in joints for name in speed_names(joint))
    motors = tuple(name for joint in joints if joint.actuated for name in speed_names(joint))
    stated = tuple(item.name for item in system.inputs)
    run_time = [parameter for parameter in system.parameters if not parameter.constant]
    symbols = {name: Slot("q", i) for i, name in enumerate(q)}
    symbols |= {name: Slot("v", i) for i, name in enumerate(s for joint in joints for s in speed_symbols(joint))}
    symbols |= {name: Slot("u", i) for i, name in enumerate(stated)}
    symbols |= {parameter.name: Slot("par", i) for i, parameter in enumerate(run_time)}
    symbols["t"] = Slot("t", 0)
    return CoordinateMap(
        q, v, stated + motors,
        tuple(parameter.name for parameter in run_time),
        tuple(float(parameter.value) for parameter in run_time),
        {parameter.name: float(parameter.value) for parameter in system.parameters if parameter.constant},
        symbols,
    )  # fmt: skip
