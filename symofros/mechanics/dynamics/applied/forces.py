"""Generalized forces Q and the potential energy of everything that is a force (docs/theory/rigid.md, section 10)."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from symofros.base.manifold import ManifoldKind
from symofros.base.names import symbol_of
from symofros.description.forces import WITH_STATE, JointElement
from symofros.description.joints.joint import Joint
from symofros.expr.derivative import along
from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.quaternion import Quaternion
from symofros.mechanics.dynamics.applied.beam_loads import beam_loads
from symofros.mechanics.dynamics.applied.contacts import bristle_rates
from symofros.mechanics.dynamics.applied.elements import element_energy, element_force, state_rate
from symofros.mechanics.dynamics.applied.loads import connection_energy, wrenches
from symofros.mechanics.dynamics.jourdain import virtual_power
from symofros.mechanics.kinematics.frames import FrameKinematics
from symofros.mechanics.kinematics.links import MovingBeam, TreeKinematics
from symofros.mechanics.kinematics.lowering import Lowering
from symofros.mechanics.spatial.wrench import Wrench, no_wrench
from symofros.mechanics.topology.coordinates import joint_sizes, state_names
from symofros.mechanics.topology.sticking import mode_name, sticks
from symofros.mechanics.topology.tree import Link, SpanningTree


def generalized_forces(kinematics: TreeKinematics, frames: FrameKinematics) -> list[Edge]:
    """Q: joint efforts and elements, virtual power by formula, potentials, loads and connections.

    Args:
        kinematics: Kinematics of the tree.
        frames: Kinematics of the frames where loads and connections act.

    Returns:
        One edge a speed.
    """
    g, system = kinematics.g, kinematics.tree.system
    total = joint_forces(kinematics.lowering, kinematics.tree)
    index = {name: i for i, name in enumerate(kinematics.lowering.coordinates.speed_symbols)}
    for power in system.virtual_power:
        for speed, formula in power.forces:
            total[index[speed]] = g.add(total[index[speed]], kinematics.lowering.value(formula))
    potentials = [kinematics.lowering.value(potential.energy) for potential in system.potentials]
    if potentials:
        total = [
            g.sub(force, slope) for force, slope in zip(total, _gradient(kinematics, g.sum(potentials)), strict=True)
        ]
    for state in system.states:
        total[index[symbol_of(state.name)]] = kinematics.lowering.value(state.rate)
    for name, rate in bristle_rates(kinematics, frames):
        total[index[symbol_of(name)]] = rate
    acting, modal = applied_wrenches(kinematics, frames)
    for beam, forces in zip(kinematics.beams, modal, strict=True):
        _add_modal(kinematics, beam, total, forces)
        speeds = () if beam.tip is None else kinematics.links[beam.tip].speeds
        _add_modal(kinematics, beam, total, beam.equations.elastic_forces(speeds))
    if acting is not None:
        total = [g.add(a, b) for a, b in zip(total, virtual_power(kinematics, acting), strict=True)]
    return total


def applied_wrenches(
    kinematics: TreeKinematics, frames: FrameKinematics
) -> tuple[list[Wrench] | None, list[list[Edge]]]:
    """Wrench of loads and connections on each link, and what loads do to elastic coordinates.

    Returns:
        One wrench a link, of a beam on its root, or None if nothing acts; and forces on the elastic coordinates of each
        beam, none without loads along it.
    """
    acting = wrenches(kinematics, frames)
    modal: list[list[Edge]] = []
    for beam in kinematics.beams:
        forces: list[Edge] = []
        if beam.equations.beam.loads:
            wrench, forces = beam_loads(kinematics, frames, beam)
            acting = acting or [no_wrench(kinematics.g) for _ in kinematics.links]
            acting[beam.root] = acting[beam.root] + wrench
        modal.append(forces)
    return acting, modal


def _add_modal(kinematics: TreeKinematics, beam: MovingBeam, total: list[Edge], forces: list[Edge]) -> None:
    if beam.tip is not None:
        for k, force in enumerate(forces, start=kinematics.links[beam.tip].first_speed):
            total[k] = kinematics.g.add(total[k], force)


def stored_energy(kinematics: TreeKinematics, frames: FrameKinematics) -> Edge:
    """The potential energy of joint elements, connections and formulas; gravity's is another function's."""
    g, lowering = kinematics.g, kinematics.lowering
    parts = [lowering.value(potential.energy) for potential in kinematics.tree.system.potentials]
    for link in kinematics.tree.links:
        for element, own in _with_own(lowering, link.joint):
            parts.append(element_energy(lowering, element, _coordinate(lowering, link, element.coordinate), own))
    parts += [beam.equations.strain_energy.value() for beam in kinematics.beams]
    return g.sum([*parts, connection_energy(kinematics, frames)])


def _coordinate(lowering: Lowering, link: Link, index: int) -> Edge:
    """The coordinate an element acts on; the zero where the joint has fewer (dampers do without)."""
    q = lowering.coordinates_of(link.joint)
    return q[index] if index < len(q) else ZERO


def joint_forces(lowering: Lowering, tree: SpanningTree) -> list[Edge]:
    """Efforts, actuators and elements (nv): their virtual power on their own speed is the force itself (eq. 23)."""
    g = lowering.g
    total: list[Edge] = [ZERO] * len(tree.coordinates.v)
    actuator = len(tree.system.inputs)

    def add(k: int, edge: Edge) -> None:
        total[k] = g.add(total[k], edge)

    for link in tree.links:
        start, size = link.v
        if size == 0:
            continue  # Forces on a prescribed motion do no virtual power.
        speeds = lowering.speeds_of(link.joint)
        for k, value in enumerate(link.joint.effort):
            add(start + k, lowering.value(value))
        for element, own in _with_own(lowering, link.joint):
            k = element.coordinate
            add(start + k, element_force(lowering, element, _coordinate(lowering, link, k), speeds[k], own))
            if isinstance(element, WITH_STATE):
                add(g.slot[own].index, state_rate(lowering, element, speeds[k], own))
        if link.joint.actuated:
            for k in range(size):
                add(start + k, g.input("u", actuator + k))
            actuator += size
    return total


def _with_own(lowering: Lowering, joint: Joint) -> Iterator[tuple[JointElement, Edge]]:
    """A joint's elements, each with its state or mode, where it has one."""
    states = map(symbol_of, state_names(joint))
    for element in joint.elements:
        if isinstance(element, WITH_STATE):
            yield element, lowering.symbol(next(states))
        else:
            yield element, lowering.symbol(mode_name(joint, element.coordinate)) if sticks(element) else ZERO


def _gradient(kinematics: TreeKinematics, energy: Edge) -> list[Edge]:
    """The rate of an energy per unit of each speed: its gradient through q' = N v (eq. 38)."""
    return along(kinematics.g, [energy], rates_per_speed(kinematics))[0]


def rates_per_speed(kinematics: TreeKinematics, prescribed: bool = False) -> list[dict[Edge, Edge]]:
    """Rates of the coordinates per unit of each free speed, or of each prescribed one: columns of N in q' = N v."""
    rates = [
        _RATES[link.joint.traits.manifold](kinematics.g, kinematics.lowering.coordinates_of(link.joint), k)
        for link in kinematics.tree.links
        if link.joint.prescribed == prescribed
        for k in range(joint_sizes(link.joint)[1] if prescribed else link.v[1])
    ]
    return rates if prescribed else rates + [{idle: ONE} for idle, _ in _states(kinematics)]


def _states(kinematics: TreeKinematics) -> list[tuple[Edge, Edge]]:
    """The states of forces, each as its idle coordinate and the speed that it is."""
    g, first = kinematics.g, len(kinematics.tree.coordinates.q) - kinematics.nv
    return [(g.input("q", first + k), g.input("v", k)) for k in kinematics.states]


def coordinate_rates(kinematics: TreeKinematics) -> dict[Edge, Edge]:
    """The rate of every coordinate, q' = N v; of prescribed ones, their given speeds."""
    g, lowering = kinematics.g, kinematics.lowering
    rates: dict[Edge, Edge] = dict(_states(kinematics))
    for link in kinematics.tree.links:
        q = lowering.coordinates_of(link.joint)
        for k, speed in enumerate(lowering.speeds_of(link.joint)):
            for coordinate, slope in _RATES[link.joint.traits.manifold](g, q, k).items():
                part = g.mul(slope, speed)
                rates[coordinate] = g.add(rates.get(coordinate, ZERO), part)
    return rates


def _own_rate(g: Graph, q: tuple[Edge, ...], k: int) -> dict[Edge, Edge]:
    return {q[k]: ONE}


def _ball_rate(g: Graph, q: tuple[Edge, ...], k: int) -> dict[Edge, Edge]:
    """Rates of a quaternion per unit angular velocity along axis k of D."""
    quaternion = Quaternion.of(g, *q)
    return dict(zip(quaternion, quaternion.rate(k), strict=True))


def _free_rate(g: Graph, q: tuple[Edge, ...], k: int) -> dict[Edge, Edge]:
    """Rates of position and quaternion per unit body velocity: the position moves along column k of R_PD."""
    if k >= 3:
        return _ball_rate(g, q[3:], k - 3)
    direction = Quaternion.of(g, *q[3:]).matrix.column(k)
    return dict(zip(q[:3], direction, strict=True))


_RATES: dict[ManifoldKind, Callable[[Graph, tuple[Edge, ...], int], dict[Edge, Edge]]] = {
    "linear": _own_rate,
    "quaternion": _ball_rate,
    "pose": _free_rate,
}
