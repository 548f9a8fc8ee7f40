"""Names and indices of q, v, u and par: the only place where an index is assigned."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from symofros.description.system import Joint, System
from symofros.expr.graph import Slot

# Joint kind -> (nq, nv); a general joint has as many as it names.
_SIZES: dict[str, tuple[int, int]] = {
    "fixed": (0, 0),
    "revolute": (1, 1),
    "continuous": (1, 1),
    "prismatic": (1, 1),
    "screw": (1, 1),
    "cylindrical": (2, 2),
    "universal": (2, 2),
    "planar": (3, 3),
    "ball": (4, 3),
    "free": (7, 6),
}

_QUATERNION = ("qx", "qy", "qz", "qw")
_SUFFIXES_Q: dict[str, tuple[str, ...]] = {
    "ball": _QUATERNION,
    "free": ("px", "py", "pz", *_QUATERNION),
    "cylindrical": ("angle", "length"),
    "universal": ("angle1", "angle2"),
    "planar": ("x", "y", "angle"),
}
_SUFFIXES_V: dict[str, tuple[str, ...]] = _SUFFIXES_Q | {
    "ball": ("wx", "wy", "wz"),
    "free": ("vx", "vy", "vz", "wx", "wy", "wz"),
}
# Joints whose speeds are not the rates of their coordinates.
QUASI_VELOCITIES = ("ball", "free")


def joint_sizes(joint: Joint) -> tuple[int, int]:
    """Number of coordinates and of speeds of a joint."""
    if joint.kind == "general":
        return len(joint.coordinates), len(joint.coordinates)
    return _SIZES[joint.kind]


def angles(joint: Joint) -> list[bool]:
    """Which coordinates of a joint come around after one turn."""
    stated = {"cylindrical": [True, False], "universal": [True, True], "planar": [False, False, True]}
    return stated.get(joint.kind) or [joint.kind in ("revolute", "continuous", "screw")] * joint_sizes(joint)[0]


def rate_symbols(joint: Joint) -> tuple[str, ...]:
    """What formulas and inputs call the rates of a prescribed joint's speeds."""
    return tuple(f"d{name}" for name in speed_symbols(joint))


def coordinate_names(joint: Joint) -> tuple[str, ...]:
    """Names of a joint's coordinates: its own name if there is one, its own names, or name.qx and so on."""
    return _names(joint, _SUFFIXES_Q)


def speed_names(joint: Joint) -> tuple[str, ...]:
    """Names of a joint's speeds, alike."""
    return _names(joint, _SUFFIXES_V)


def _names(joint: Joint, suffixes: dict[str, tuple[str, ...]]) -> tuple[str, ...]:
    if joint.kind == "general":
        return joint.coordinates
    if joint.kind in suffixes:
        return tuple(f"{joint.name}.{suffix}" for suffix in suffixes[joint.kind])
    return (joint.name,) if joint_sizes(joint)[0] else ()


def speed_symbols(joint: Joint) -> tuple[str, ...]:
    """What formulas call a joint's speeds: d + coordinate where the speed is its rate, otherwise the speed's name."""
    if joint.kind in QUASI_VELOCITIES:
        return speed_names(joint)
    return tuple(f"d{name}" for name in coordinate_names(joint))


@dataclass(frozen=True)
class CoordinateMap:
    """Which name has which index.

    Attributes:
        q: Coordinate names, in order; likewise the speeds v, the inputs u and the run-time parameters par.
        efforts: How many of the inputs are forces; the rest prescribe motion.
        par_default: Values of the run-time parameters.
        constants: Values of the constant parameters, by name.
        symbols: What formulas may use -> its slot; constants are not among them.
    """

    q: tuple[str, ...]
    v: tuple[str, ...]
    u: tuple[str, ...]
    efforts: int
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
    free = [joint for joint in joints if not joint.prescribed]
    q = tuple(name for joint in free for name in coordinate_names(joint))
    v = tuple(name for joint in free for name in speed_names(joint))
    motors = tuple(name for joint in free if joint.actuated for name in speed_names(joint))
    stated = tuple(item.name for item in system.inputs)
    driven = tuple(
        name
        for joint in joints
        if joint.prescribed
        for name in (*coordinate_names(joint), *speed_symbols(joint), *rate_symbols(joint))
    )
    run_time = [parameter for parameter in system.parameters if not parameter.constant]
    symbols = {name: Slot("q", i) for i, name in enumerate(q)}
    symbols |= {name: Slot("v", i) for i, name in enumerate(s for joint in free for s in speed_symbols(joint))}
    symbols |= {name: Slot("u", i) for i, name in enumerate(stated)}
    efforts = len(stated) + len(motors)
    symbols |= {name: Slot("u", efforts + i) for i, name in enumerate(driven)}
    symbols |= {parameter.name: Slot("par", i) for i, parameter in enumerate(run_time)}
    symbols["t"] = Slot("t", 0)
    return CoordinateMap(
        q,
        v,
        stated + motors + driven,
        efforts,
        tuple(parameter.name for parameter in run_time),
        tuple(float(parameter.value) for parameter in run_time),
        {parameter.name: float(parameter.value) for parameter in system.parameters if parameter.constant},
        symbols,
    )
