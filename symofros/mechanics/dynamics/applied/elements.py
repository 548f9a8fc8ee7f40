"""Joint elements: springs, dampers, stops and friction as force and energy of one coordinate (theory, section 10)."""

from __future__ import annotations

from symofros.base.smoothed_sign import PEAK, TERMS
from symofros.description.forces import WITH_STATE, Damper, Friction, Hysteresis, JointElement, LuGre, Spring, Stop
from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.mechanics.kinematics.lowering import Lowering

# Stribeck velocity where none is given, as a multiple of the minimum velocity.
_STRIBECK = 10.0
# Most Stribeck velocities over which friction rises to its maximum: below 1.58, its slope is largest at rest.
_LONGEST_RISE = 1.5


def element_force(lowering: Lowering, element: JointElement, q: Edge, v: Edge, own: Edge = ZERO) -> Edge:
    """The force of an element on its own speed.

    Args:
        lowering: Edges of the element's numbers.
        element: The element as described.
        q: The coordinate it acts on; unused by dampers and friction.
        v: The speed.
        own: State of an element that has one, mode of friction that sticks; of others not used.
    """
    g = lowering.g
    if isinstance(element, Spring):
        x = g.sub(q, lowering.value(element.rest))
        cubic = g.mul(lowering.value(element.cubic), g.mul(x, x))
        return -g.mul(g.add(lowering.value(element.stiffness), cubic), x)
    if isinstance(element, Damper):
        quadratic = g.mul(lowering.value(element.quadratic), g.call("abs", v))
        return -g.mul(g.add(lowering.value(element.coefficient), quadratic), v)
    if isinstance(element, Stop):
        return _stop_force(lowering, element, q, v)
    if isinstance(element, LuGre):
        bristles = g.mul(lowering.value(element.stiffness), own)
        lag = g.mul(lowering.value(element.damping), _bristle_rate(lowering, element, v, own))
        return -g.add(g.add(bristles, lag), g.mul(lowering.value(element.viscous), v))
    if isinstance(element, Hysteresis):
        return -g.mul(lowering.value(element.stiffness), own)
    return _friction_by_mode(lowering, element, v, own) if element.sticks else _friction(lowering, element, v)


def state_rate(lowering: Lowering, element: LuGre | Hysteresis, v: Edge, z: Edge) -> Edge:
    """The rate of an element's state at speed v."""
    if isinstance(element, LuGre):
        return _bristle_rate(lowering, element, v, z)
    return _slip_rate(lowering, element, v, z)


def _bristle_rate(lowering: Lowering, element: LuGre, v: Edge, z: Edge) -> Edge:
    """docs/theory/states.md, (6)."""
    g, level = lowering.g, lowering.value(element.dynamic)
    if element.static is not None and element.stribeck_velocity is not None:
        y = g.div(v, lowering.value(element.stribeck_velocity))
        level = g.add(level, g.mul(g.sub(lowering.value(element.static), level), g.call("exp", -g.mul(y, y))))
    share = g.div(g.mul(lowering.value(element.stiffness), z), level)
    return g.sub(v, g.mul(g.call("abs", v), share))


def _slip_rate(lowering: Lowering, element: Hysteresis, v: Edge, z: Edge) -> Edge:
    """docs/theory/states.md, (10)."""
    g = lowering.g
    share = g.call("abs", g.div(g.mul(lowering.value(element.stiffness), z), lowering.value(element.force)))
    grows = g.call("max", g.mul(v, g.call("sign", z)), ZERO)
    slipped = g.mul(g.call("pow", share, lowering.value(element.sharpness)), grows)
    return g.sub(v, g.mul(slipped, g.call("sign", z)))


def element_energy(lowering: Lowering, element: JointElement, q: Edge, own: Edge = ZERO) -> Edge:
    """The potential energy an element stores, at its coordinate and its state."""
    g = lowering.g
    if isinstance(element, WITH_STATE):
        return g.mul(g.mul(g.constant(0.5), lowering.value(element.stiffness)), g.mul(own, own))
    if isinstance(element, Spring):
        x = g.sub(q, lowering.value(element.rest))
        x2 = g.mul(x, x)
        quartic = g.mul(g.mul(g.constant(0.5), lowering.value(element.cubic)), x2)
        return g.mul(g.mul(g.constant(0.5), g.add(lowering.value(element.stiffness), quartic)), x2)
    if isinstance(element, Stop):
        total = ZERO
        for excess, _ in _excess(lowering, element, q):
            total = g.add(total, g.mul(excess, excess))
        return g.mul(g.mul(g.constant(0.5), lowering.value(element.stiffness)), total)
    return ZERO


def _excess(lowering: Lowering, stop: Stop, q: Edge) -> list[tuple[Edge, int]]:
    """Excess of q over each limit, and the sign of the direction that leads further."""
    g = lowering.g
    excesses = []
    if stop.upper is not None:
        excesses.append((g.call("max", g.sub(q, lowering.value(stop.upper)), ZERO), 1))
    if stop.lower is not None:
        excesses.append((g.call("max", g.sub(lowering.value(stop.lower), q), ZERO), -1))
    return excesses


def _stop_force(lowering: Lowering, stop: Stop, q: Edge, v: Edge) -> Edge:
    g = lowering.g
    total = ZERO
    for excess, outward in _excess(lowering, stop, q):
        # The damper acts beyond the limit, and on motion further out only: a stop pushes, it never pulls.
        further = g.call("max", g.mul(outward * v, g.call("sign", excess)), ZERO)
        push = g.mul(lowering.value(stop.stiffness), excess)
        push = g.add(push, g.mul(lowering.value(stop.damping), further))
        total = g.add(total, -outward * push)
    return total


def _friction(lowering: Lowering, friction: Friction, v: Edge) -> Edge:
    """Coulomb, Stribeck and viscous friction; docs/theory/rigid.md, (56) to (58)."""
    g = lowering.g
    dynamic, static, slow = lowering.value(friction.dynamic), friction.static, lowering.value(friction.minimum_velocity)
    peak, fall_range = _peak_and_fall(lowering, friction, slow)
    speed = g.call("abs", v)
    xi = g.div(v, g.call("max", speed, peak))
    square = g.mul(xi, xi)
    rise = smoothed_sign(g, square)
    level = g.mul(dynamic, rise)
    if static is not None:
        y, width = g.div(g.call("max", g.sub(speed, peak), ZERO), fall_range), g.div(peak, fall_range)
        flank = g.mul(g.mul(g.constant(0.5), width), g.sub(ONE, square))
        fallen = g.sub(g.call("exp", -g.mul(y, y)), g.add(ONE, g.mul(flank, flank)))
        level = g.add(level, g.mul(g.sub(lowering.value(static), dynamic), g.add(rise, fallen)))
    if friction.factor != 1.0:
        level = g.mul(level, g.call("max", lowering.value(friction.factor), ZERO))
    return -g.add(g.mul(level, xi), g.mul(lowering.value(friction.viscous), v))


def _friction_by_mode(lowering: Lowering, friction: Friction, v: Edge, mode: Edge) -> Edge:
    """Friction of one sign while the joint slides, none while it is held, else the smooth one: constraints.md, (35)."""
    g = lowering.g
    square = g.mul(mode, mode)
    smooth = g.mul(g.sub(ONE, square), g.sub(ONE, g.mul(g.constant(0.5), mode)))
    sign = g.div(g.mul(mode, g.sub(g.constant(4.0), square)), g.constant(3.0))
    level = lowering.value(friction.dynamic)
    if friction.static is not None and friction.stribeck_velocity is not None:
        y = g.div(v, lowering.value(friction.stribeck_velocity))
        level = g.add(level, g.mul(g.sub(lowering.value(friction.static), level), g.call("exp", -g.mul(y, y))))
    slides = g.add(level, g.mul(sign, g.mul(lowering.value(friction.viscous), v)))
    return g.sub(g.mul(smooth, _friction(lowering, friction, v)), g.mul(sign, slides))


def _peak_and_fall(lowering: Lowering, friction: Friction, slow: Edge) -> tuple[Edge, Edge]:
    """Speed at which friction has its maximum, and the range of speeds over which it falls beyond."""
    g = lowering.g
    peak = g.mul(g.constant(PEAK), slow)
    if friction.stribeck_velocity is None:
        return peak, g.mul(g.constant(_STRIBECK), slow)
    fall_range = lowering.value(friction.stribeck_velocity)
    return g.call("min", peak, g.mul(g.constant(_LONGEST_RISE), fall_range)), fall_range


def smoothed_sign(g: Graph, square: Edge) -> Edge:
    """The smoothed sign over xi, of xi^2: (56)."""
    inner = g.add(g.constant(TERMS[1]), g.mul(g.constant(TERMS[2]), square))
    return g.add(g.constant(TERMS[0]), g.mul(inner, square))
