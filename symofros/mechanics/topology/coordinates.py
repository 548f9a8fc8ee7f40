"""Names and indices of q, v, u and par: the only place where an index is assigned."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from symofros.base.names import TIME, rate_symbol, symbol_of
from symofros.description.forces import WITH_STATE
from symofros.description.joints.joint import Joint
from symofros.description.system import System
from symofros.expr.graph import Slot


def joint_sizes(joint: Joint) -> tuple[int, int]:
    """Number of coordinates and of speeds of a joint."""
    return len(coordinate_names(joint)), len(speed_names(joint))


def angles(joint: Joint) -> tuple[bool, ...]:
    """Whether each coordinate of a joint is periodic; user-defined ones count as not periodic."""
    return (False,) * len(joint.coordinates) if joint.traits.user_defined else joint.traits.angles


def joint_units(joint: Joint) -> tuple[str, ...]:
    """SI unit of each coordinate of a joint; "" for user-defined ones and components of a quaternion."""
    if joint.traits.user_defined:
        return ("",) * len(joint.coordinates)
    return tuple(coordinate.unit for coordinate in joint.traits.coordinates)


def coordinate_names(joint: Joint) -> tuple[str, ...]:
    """Names of a joint's coordinates: the user's own, or the joint's name with the suffixes of its kind."""
    return _names(joint, joint.traits.coordinate_suffixes)


def coordinate_symbols(joint: Joint) -> tuple[str, ...]:
    """Symbols of a joint's coordinates in formulas: their names, but for those that formulas reserve."""
    return tuple(map(symbol_of, coordinate_names(joint)))


def speed_names(joint: Joint) -> tuple[str, ...]:
    """Names of a joint's speeds: those of its coordinates, but for quasi-velocities."""
    suffixes = joint.traits.speed_suffixes
    return _names(joint, joint.traits.coordinate_suffixes if suffixes is None else suffixes)


def _names(joint: Joint, suffixes: tuple[str, ...]) -> tuple[str, ...]:
    if joint.traits.user_defined:
        return joint.coordinates
    return tuple(f"{joint.name}.{suffix}" if suffix else joint.name for suffix in suffixes)


def speed_symbols(joint: Joint) -> tuple[str, ...]:
    """Names of a joint's speeds in formulas: d + coordinate where the speed is its rate, otherwise the speed's name."""
    if joint.traits.quasi_velocities:
        return speed_names(joint)
    return tuple(f"d{name}" for name in coordinate_names(joint))


def rate_symbols(joint: Joint) -> tuple[str, ...]:
    """Names in formulas and inputs of the rates of a prescribed joint's speeds."""
    return tuple(f"d{name}" for name in speed_symbols(joint))


def speed_keys(joint: Joint) -> tuple[str, ...]:
    """Symbols of a joint's speeds that nothing else can have, of which `speed_symbols` are short forms."""
    if joint.traits.quasi_velocities:
        return speed_names(joint)
    return tuple(map(rate_symbol, coordinate_names(joint)))


def rate_keys(joint: Joint) -> tuple[str, ...]:
    """The same of the rates of a prescribed joint's speeds."""
    if joint.traits.quasi_velocities:
        return tuple(map(rate_symbol, speed_names(joint)))
    return tuple(rate_symbol(name, 2) for name in coordinate_names(joint))


def state_names(joint: Joint) -> Iterator[str]:
    """Names of the states of a joint's elements, in their order: of its speed, and what the state is."""
    counts = Counter[str]()
    for element in joint.elements:
        # One on a coordinate that does not exist is refused elsewhere.
        if isinstance(element, WITH_STATE) and 0 <= element.coordinate < len(speed_names(joint)):
            kind = f"{speed_names(joint)[element.coordinate]}.{element.state}"
            counts[kind] += 1
            yield kind if counts[kind] == 1 else f"{kind}{counts[kind]}"


def motion_symbols(joint: Joint) -> tuple[str, ...]:
    """All that formulas may call the coordinates of a joint, its speeds and their rates, in one order for all names."""
    of_motion = (coordinate_symbols, speed_symbols, rate_symbols, speed_keys, rate_keys)
    return tuple(name for names in of_motion for name in names(joint))


@dataclass(frozen=True)
class CoordinateMap:
    """Index map: names to indices of q, v, u, par.

    Attributes:
        q: Names of the coordinates, in order; v of the speeds, u of the inputs, par of the run-time parameters.
        efforts: Number of inputs that are forces; the rest prescribe motion.
        par_default: Values of the run-time parameters.
        constants: Values of the constant parameters, by name.
        symbols: Slots by the names that formulas use; constants are not among them.
        keys: Slots of speeds and of prescribed rates by symbols that nothing else has; formulas may use them, too.
        speed_symbols: What formulas call the speeds, in the order of v.
        states: Names of the states of forces. Each is carried as a speed, the last of v, beside an idle coordinate, the
            last of q (docs/theory/states.md, section 1).
    """

    q: tuple[str, ...]
    v: tuple[str, ...]
    u: tuple[str, ...]
    efforts: int
    par: tuple[str, ...]
    par_default: tuple[float, ...]
    constants: dict[str, float]
    symbols: dict[str, Slot]
    keys: dict[str, Slot]
    speed_symbols: tuple[str, ...]
    states: tuple[str, ...] = ()


def idle_coordinate(state: str) -> str:
    """Name of the coordinate beside a state of a force: the state's integral, which nothing depends on."""
    return f"{state}.integral"


def map_coordinates(system: System, joints: Sequence[Joint]) -> CoordinateMap:
    """Assign the indices.

    Args:
        system: The system, with its parameters and inputs.
        joints: The moving joints, in the order of the links.
    """
    free = [joint for joint in joints if not joint.prescribed]
    q = tuple(name for joint in free for name in coordinate_names(joint))
    v = tuple(name for joint in free for name in speed_names(joint))
    states = tuple(state.name for state in system.states) + tuple(name for joint in free for name in state_names(joint))
    states += tuple(name for contact in system.contacts for names in contact.state_names for name in names)
    actuated = tuple(name for joint in free if joint.actuated for name in speed_names(joint))
    stated = tuple(item.name for item in system.inputs)
    prescribed = tuple(
        name
        for joint in joints
        if joint.prescribed
        for name in (*coordinate_names(joint), *speed_symbols(joint), *rate_symbols(joint))
    )
    run_time = [parameter for parameter in system.parameters if not parameter.constant]
    efforts = len(stated) + len(actuated)
    rates = tuple(name for joint in free for name in speed_symbols(joint))
    symbols = {name: Slot("v", i) for i, name in enumerate(rates)}
    keys = {name: Slot("v", i) for i, name in enumerate(name for joint in free for name in speed_keys(joint))}
    symbols |= {symbol_of(name): Slot("u", efforts + i) for i, name in enumerate(prescribed)}
    driven = [joint for joint in joints if joint.prescribed]
    given = [name for joint in driven for name in (*coordinate_symbols(joint), *speed_keys(joint), *rate_keys(joint))]
    keys |= {name: Slot("u", efforts + i) for i, name in enumerate(given)}
    # Where a coordinate has the name of another's rate, formulas mean the coordinate, or are refused.
    symbols |= {symbol_of(name): Slot("q", i) for i, name in enumerate(q)}
    symbols |= {symbol_of(name): Slot("v", len(v) + i) for i, name in enumerate(states)}
    symbols |= {symbol_of(name): Slot("u", i) for i, name in enumerate(stated)}
    symbols |= {parameter.name: Slot("par", i) for i, parameter in enumerate(run_time)}
    symbols[TIME] = Slot("t", 0)
    return CoordinateMap(
        q + tuple(map(idle_coordinate, states)),
        v + states,
        stated + actuated + prescribed,
        efforts,
        tuple(parameter.name for parameter in run_time),
        tuple(float(parameter.value) for parameter in run_time),
        {parameter.name: float(parameter.value) for parameter in system.parameters if parameter.constant},
        symbols,
        keys,
        rates + tuple(map(symbol_of, states)),
        states,
    )
