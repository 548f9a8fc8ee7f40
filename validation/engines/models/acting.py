"""Trees that forces of their own act on: dampers, springs, gravity compensation, tendons, actuators."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import zip_longest

import numpy as np

from ..interface import ORIGIN, Activation, Actuator, End, Joint, Link, Medium, Muscle, Tendon, Tree, Wrap
from .files.readers import about
from .kinds import OBLIQUE, link, placed, shifted, turned


def _chain(name: str, *joints: Joint, branches: bool = False) -> tuple[Link, ...]:
    """Links one after the other, or the last two on the first."""
    draw = np.random.default_rng([ord(letter) for letter in name])
    parents = [-1, 0, 0] if branches else range(-1, len(joints) - 1)
    return tuple(link(draw, "abcdef"[k], parents[k], placed(draw, joint)) for k, joint in enumerate(joints))


_HINGE, _SLIDE = Joint("revolute", axis=OBLIQUE), Joint("prismatic", axis=OBLIQUE)
_DAMPED = replace(_HINGE, damping=0.75)
_SPRUNG = replace(_HINGE, stiffness=3.0, rest=0.25)


def _passive() -> list[Tree]:
    both, slide = replace(_DAMPED, stiffness=2.0, rest=-0.5), replace(_SLIDE, damping=1.5, stiffness=8.0, rest=0.125)
    borne = tuple(
        replace(one, compensation=part)
        for one, part in zip(_chain("borne", *[_HINGE] * 3), (1.0, 0.0, 0.5), strict=True)
    )
    draw = np.random.default_rng(9)
    body = link(draw, "a", -1, Joint("free", damping=0.5))
    return [
        Tree("a damper and two free hinges", _chain("one damper", _HINGE, _DAMPED, _HINGE)),
        Tree("dampers on hinges", _chain("dampers", *[_DAMPED] * 3)),
        Tree(
            "dampers on a slide and a ball",
            _chain("slide and ball", replace(_SLIDE, damping=1.5), Joint("ball", damping=0.5)),
        ),
        Tree("springs on hinges", _chain("springs", *[_SPRUNG] * 3)),
        Tree("springs and dampers on hinges and a slide", _chain("both", both, slide, both)),
        Tree("springs and dampers on branches", _chain("both, branched", both, both, slide, branches=True)),
        Tree("a damped free body", (body,)),
        Tree("a damped hinge on a damped free base", _carried(body)),
        Tree("gravity compensation", borne),
        Tree("gravity compensation of fixed links", _compensated_and_fixed()),
    ]


def _dragged() -> list[Tree]:
    """Links without products of inertia, in oil, in a thin fluid, in wind; free, and on joints that are damped too."""

    def boxes(name: str, *joints: Joint) -> tuple[Link, ...]:
        moments = ((0.25, 0.0, 0.0), (0.0, 0.375, 0.0), (0.0, 0.0, 0.5))
        return tuple(replace(one, inertia=moments) for one in _chain(name, *joints))

    hinges, free = boxes("drag", _HINGE, _DAMPED, _SLIDE), boxes("drag", Joint("free"))
    alone = (replace(free[0], joints=(Joint("free"),)),)
    wind = (2.0, -1.0, 0.5)
    return [
        Tree("links in oil", hinges, medium=Medium(0.0, 0.75)),
        Tree("links in a thin fluid", hinges, medium=Medium(4.0, 0.0)),
        Tree("links in wind", hinges, medium=Medium(1.25, 0.125, wind)),
        Tree("free body in wind", alone, medium=Medium(1.25, 0.125, wind)),
    ]


def _carried(base: Link) -> tuple[Link, ...]:
    return base, link(np.random.default_rng(10), "b", 0, placed(np.random.default_rng(12), _DAMPED))


def _compensated_and_fixed() -> tuple[Link, ...]:
    """Gravity compensation of links that are fixed to the one before."""
    links = _chain("borne and fixed", _HINGE, Joint("fixed"), _HINGE, Joint("fixed"))
    return tuple(replace(one, compensation=part) for one, part in zip(links, (0.0, 1.0, 0.25, 0.5), strict=True))


def _pulley(name: str, second: Joint, wrap: Wrap) -> Tree:
    """A tendon from the world to a hinge that faces it, around what lies between them."""
    draw = np.random.default_rng([ord(letter) for letter in name])
    links = (
        link(draw, "a", -1, Joint("revolute", p=(0.125, 0.0, 0.0), axis=(0.0, 0.0, 1.0))),
        link(draw, "b", 0, replace(second, p=(0.75, 0.0, 0.0))),
    )
    ends = (End("", p=(-1.0, 0.125, 0.25)), End("b", p=(0.25, 0.0625, -0.125)))
    return Tree(name, links, tendons=(Tendon("path", ends, stiffness=4.0, damping=0.5, rest=0.25, wraps=(wrap,)),))


def _wrapped() -> list[Tree]:
    slide = Joint("prismatic", axis=(0.6, 0.0, 0.8))
    turn = Joint("revolute", axis=(0.0, 0.6, 0.8))
    R = about((0.0, 1.0, 0.0), 0.25)
    ball, own = Wrap(0, End("", p=(0.0625, 0.0, 0.0)), 0.5, True), Wrap(0, End("a", p=(0.0, 0.03125, 0.0)), 0.5, True)
    drum, turned_drum = Wrap(0, End("", p=(0.0625, 0.0, 0.0)), 0.5, False), Wrap(0, End("a", R=R), 0.5, False)
    around_a_ball = _pulley("tendon around a sphere", turn, ball)
    motor = Actuator(tendon=0, gear=2.0, gain=1.5, bias=(0.25, -3.0, -0.5), control=0.75)
    return [
        around_a_ball,
        _pulley("tendon around a sphere that moves", slide, own),
        _pulley("tendon around a cylinder", slide, drum),
        _pulley("tendon around a turned cylinder that moves", turn, turned_drum),
        replace(around_a_ball, name="actuator on a tendon around a sphere", actuators=(motor,)),
    ]


def _sided() -> list[Tree]:
    """Tendons that pass a surface on the side of a point: the nearer side, the farther, beside their plane.

    The ends stand on either side of the surface, where the ways on both sides of it cross themselves nowhere.
    """
    ball, drum = Wrap(0, End(""), 0.5, True), Wrap(0, End("", R=about((1.0, 0.0, 0.0), 0.25)), 0.5, False)
    sides = {
        "on one side of a sphere": ball._replace(side=(0.0, 0.5, 1.0)),
        "on the other side of a sphere": ball._replace(side=(0.0, -0.5, -1.0)),
        "around a sphere on the side of a point beside its plane": ball._replace(side=(0.0, 3.0, -1.25)),
        "on one side of a cylinder": drum._replace(side=(0.0, 1.0, 0.5)),
        "on the other side of a cylinder": drum._replace(side=(0.0, -1.0, 0.5)),
    }
    slider = link(np.random.default_rng(23), "a", -1, Joint("prismatic", p=(3.0, 0.0, 0.0), axis=(1.0, 0.0, 0.0)))
    ends = (End("", p=(-1.0, 0.125, 0.25)), End("a", p=(0.25, 0.125, 0.25)))
    path = Tendon("path", ends, stiffness=4.0, damping=0.5, rest=0.25)
    return [Tree(f"tendon {name}", (slider,), tendons=(replace(path, wraps=(wrap,)),)) for name, wrap in sides.items()]


def _heavy() -> list[Tree]:
    links = _chain("heavy tendons", _HINGE, _SLIDE, _HINGE)
    ends = tuple(End(one.name) for one in links)
    coupled = Tendon("coupling", ends, (1.0, -0.5, 2.0), armature=0.75)
    draw = np.random.default_rng(17)
    path = tuple(End(name, p=shifted(draw, 0.3)) for name in ("", "a", "c"))
    over = Tendon("path", path, armature=0.5)
    return [
        Tree("tendon of a sum with armature", links, tendons=(coupled,)),
        Tree("tendon over points with armature", links, tendons=(over,)),
    ]


def _tendons() -> list[Tree]:
    draw = np.random.default_rng(11)
    links = _chain("tendons", _HINGE, _SLIDE, _HINGE)
    ends = tuple(End(one.name) for one in links)
    coupled = Tendon("coupling", ends, (1.0, -0.5, 2.0), stiffness=4.0, damping=0.5, rest=0.25)
    apart = replace(coupled, ends=ends[::2], coefficients=(1.0, 2.0), damping=2.5)
    path = tuple(End(name, p=shifted(draw, 0.3)) for name in ("", "a", "c"))
    over = Tendon("path", path, stiffness=4.0, damping=0.5, rest=0.25)
    pulled = (
        Actuator(tendon=0, gear=2.0, gain=1.5, control=0.75),
        Actuator(tendon=1, gear=-0.5, gain=3.0, bias=(0.25, -3.0, -0.5)),
    )
    return [
        Tree("tendon of a sum", links, tendons=(coupled,)),
        Tree("tendon of a sum of the first and the last of three joints", links, tendons=(apart,)),
        Tree("tendon over points", links, tendons=(over,)),
        Tree(
            "tendon over points of one branch", _chain("short", *[_HINGE] * 3), tendons=(replace(over, ends=path[1:]),)
        ),
        Tree("actuators on tendons", links, tendons=(coupled, over), actuators=pulled),
    ]


def _actuators() -> list[Tree]:
    links = _chain("actuators", _DAMPED, _SLIDE, _SPRUNG)
    motor = Actuator("a", gear=3.0, control=0.75)
    servo = Actuator("b", gear=0.5, gain=6.0, bias=(0.0, -6.0, 0.0), control=-0.5)
    brake = Actuator("c", gear=2.0, gain=1.5, bias=(0.0, 0.0, -1.5), control=0.5)
    general = Actuator("b", gear=-1.5, gain=0.5, bias=(0.25, -1.0, -0.75), control=2.0, control_limits=(-1.0, 1.0))
    clamped = _chain("clamped", *[replace(_HINGE, force_limits=(-0.25, 0.125))] * 2, _SLIDE)
    fast = replace(brake, bias=(0.0, 0.0, -1.5), control=8.0)
    off = replace(general, is_disabled=True)
    return [
        Tree(
            "actuators clamped at their joints",
            clamped,
            actuators=(fast, replace(fast, link="a"), replace(fast, link="b")),
        ),
        Tree("actuators disabled", links, actuators=(motor, off, replace(brake, is_disabled=True))),
        Tree("motors", links, actuators=(motor, replace(motor, link="b", gear=-1.0))),
        Tree("servos of position and velocity", links, actuators=(servo, brake)),
        Tree("actuators of all kinds", links, actuators=(motor, servo, brake, general)),
        Tree("actuators at their limits", links, actuators=(replace(general, force_limits=(-0.125, 0.125)), motor)),
    ]


def _plain_motors() -> list[Tree]:
    """Forces along joints and no more: alone, at their bounds, and with rotors."""
    links = _chain("plain motors", _HINGE, _SLIDE, _HINGE)
    geared = _chain("geared motors", *(replace(one, armature=(0.75,)) for one in (_HINGE, _SLIDE)), _HINGE)
    motors = tuple(Actuator(one.name, control=force) for one, force in zip(links, (0.75, -2.5, 1.25), strict=True))
    bounded = tuple(replace(one, force_limits=(-1.0, 1.0)) for one in motors)
    return [
        Tree("forces along joints at their effort limits", links, actuators=bounded),
        Tree("forces along joints", links, actuators=motors),
        Tree("forces along two of three joints", links, actuators=motors[1:]),
        Tree("forces along joints with rotors at their effort limits", geared, actuators=bounded[:2]),
    ]


def _servos_along_joints() -> list[Tree]:
    """Servos of position and speed and no more, with what is fed forward, and actuators against the order of joints."""
    links, damped = _chain("plain servos", _HINGE, _SLIDE, _HINGE), _chain("plain servos", _DAMPED, _SLIDE, _DAMPED)
    motors = tuple(Actuator(one.name, control=force) for one, force in zip(links, (0.75, -2.5, 1.25), strict=True))
    servos = tuple(
        Actuator(one.name, gain=6.0, bias=(0.25, -stiffness, -damping), control=control)
        for one, stiffness, damping, control in zip(
            links, (6.0, 3.0, 12.0), (0.5, 1.5, 0.25), (0.5, -1.0, 0.75), strict=True
        )
    )
    return [
        Tree("servo along a hinge", links[:1], actuators=servos[:1]),
        Tree("servos along joints", links, actuators=servos),
        Tree("servos along damped joints", damped, actuators=servos),
        Tree("servos against the order of joints", links, actuators=servos[::-1]),
        Tree("servo before a force against the order of joints", links, actuators=(servos[2], motors[0])),
        Tree("forces against the order of joints", links, actuators=motors[::-1]),
    ]


def _plain_actuators() -> list[Tree]:
    """Actuators of bodies of equal moments: velocity feedback, and what is disabled, alone and beside others."""
    inertia = ((0.125, 0.0, 0.0), (0.0, 0.125, 0.0), (0.0, 0.0, 0.125))
    slide, hinge = Joint("prismatic", axis=(1.0, 0.0, 0.0)), Joint("revolute", axis=(0.0, 0.0, 1.0))
    links = (Link("a", -1, (slide,), 2.0, ORIGIN, inertia), Link("b", 0, (hinge,), 1.0, (0.5, 0.0, 0.0), inertia))
    brake = Actuator("a", gear=2.0, gain=1.5, bias=(0.0, 0.0, -1.5), control=0.5)
    off = replace(brake, is_disabled=True)
    loose = Link("c", -1, (Joint("free"),), 1.0, ORIGIN, inertia)
    return [
        # What one step's length changes is large: singles show it, too.
        Tree("velocity feedback after a free body", (loose, links[0]), actuators=(replace(brake, gear=16.0),)),
        Tree("velocity feedback", links, actuators=(brake,)),
        Tree("velocity feedback disabled", links, actuators=(off,)),
        Tree("velocity feedback disabled beside others", links, actuators=(off, replace(brake, link="b"))),
        Tree("servo disabled beside others", links, actuators=(brake, replace(off, link="b", bias=(0.0, -1.5, 0.0)))),
    ]


def _muscles() -> list[Tree]:
    """Muscles on joints whose coordinates go from -1 to 1: within the lengths that they pull at, and beyond."""
    links = _chain("actuators", _DAMPED, _SLIDE, _SPRUNG)
    muscles = (
        Muscle(0.625, (-1.0, 1.0), (0.75, 1.05), peak=10.0),
        Muscle(0.625, (-0.25, 0.25), (0.5, 1.6), peak=4.0),
        Muscle(0.625, (-0.5, 0.5), (0.875, 1.0), peak=2.0),
    )
    pairs = list(zip(links, (1.0, -0.5, 2.0), muscles, strict=True))
    pulls = tuple(Actuator(one.name, gear=gear, muscle=muscle) for one, gear, muscle in pairs)
    strained = tuple(
        Actuator(one.name, gear=gear, muscle=muscle._replace(lengths=(at, at + 0.5)))
        for one, gear, muscle in pairs
        for at in (-3.0, 3.0)
    )
    return [
        Tree("muscles", links, actuators=pulls),
        Tree("muscles beyond their ranges", links, actuators=strained),
    ]


def _states() -> list[Tree]:
    """Actuators with states: integrators and filters, at the states' limits, of actearly, of servos and of muscles."""
    links = _chain("actuators", _DAMPED, _SLIDE, _SPRUNG)
    servo = Actuator("b", gear=0.5, gain=6.0, bias=(0.0, -6.0, 0.0), control=-0.5)
    general = Actuator("c", gear=-1.5, gain=0.5, bias=(0.25, -1.0, -0.75), control=2.0, control_limits=(-1.0, 1.0))
    motor = Actuator("a", gear=3.0, control=0.75)
    integrator, filtered, exact = (
        Activation(kind, 0.375, times)
        for kind, times in (("integrator", ()), ("filter", (0.125,)), ("exact filter", (0.125,)))
    )
    kinds = {
        "integrators": integrator,
        "integrators with actearly": integrator._replace(is_early=True),
        "integrators at their limits": integrator._replace(limits=(-0.25, 0.3751)),
        "filters": filtered,
        "filters with actearly": filtered._replace(is_early=True),
        "filters at their limits": filtered._replace(limits=(-0.25, 0.3751)),
        "exact filters": exact,
        "exact filters with actearly": exact._replace(is_early=True),
        "exact filters faster than a step": exact._replace(times=(0.0078125,)),
    }
    pulled = Muscle(0.625, (-1.0, 1.0), (0.75, 1.05), peak=10.0)
    grown = Activation("muscle", 0.375, (0.0625, 0.25))
    muscles = tuple(
        Actuator(name, gear=gear, muscle=pulled, control=control, activation=grown)
        for name, gear, control in (("a", 1.0, 0.75), ("b", -0.5, 0.125), ("c", 2.0, 1.5))
    )
    made = [
        Tree(
            f"actuators with {name}",
            links,
            actuators=tuple(replace(x, activation=one) for x in (motor, servo, general)),
        )
        for name, one in kinds.items()
    ]
    mixed = (motor, replace(servo, activation=filtered), replace(general, activation=integrator))
    early = tuple(replace(one, activation=grown._replace(is_early=True)) for one in muscles)
    return [
        *made,
        Tree("actuators with states and without", links, actuators=mixed),
        Tree("muscles with activations", links, actuators=muscles),
        Tree("muscles with activations with actearly", links, actuators=early),
        Tree("muscles with activations before a motor", links, actuators=(*muscles, motor)),
    ]


def _affine() -> list[Tree]:
    """Actuators whose gains depend on length and speed: of controls and of states, beside others, at limits, disabled.

    What lengths and speeds make of a force is then in proportion to what drives the actuator. Neither makes it grow:
    MuJoCo's `discrete` leaves out what would.
    """
    links = _chain("actuators", _DAMPED, _SLIDE, _SPRUNG)
    first = Actuator("a", gear=2.0, gain=0.5, slopes=(1.0, -1.5), bias=(0.25, -1.0, -0.5), control=0.75)
    second = Actuator("b", gear=-0.5, gain=1.5, slopes=(0.0, -3.0), control=2.0, control_limits=(-1.0, 1.0))
    third = Actuator("c", gear=1.5, gain=0.25, slopes=(-0.5, -2.0), bias=(0.0, 0.0, -0.75), control=0.5)
    motor = Actuator("b", gear=3.0, control=0.75)
    every = (first, second, third)
    integrated, filtered = Activation("integrator", 0.375), Activation("filter", 0.625, (0.125,))
    moved = (
        replace(first, activation=integrated),
        replace(second, activation=filtered),
        replace(third, activation=integrated._replace(state=1.25)),
    )

    def early(one: Actuator) -> Actuator:
        assert one.activation is not None
        return replace(one, activation=one.activation._replace(is_early=True))

    made = {
        "affine gains": every,
        "affine gains of activations": moved,
        "affine gains of activations with actearly": tuple(map(early, moved)),
        "affine gains of activations before a motor": (*moved, motor),
        "affine gains of activations after a motor": (motor, *moved),
        "affine gains of activations at their limits": tuple(
            replace(one, force_limits=(-0.125, 0.0625)) for one in moved
        ),
        "affine gains disabled beside others": (replace(first, is_disabled=True), moved[1], third),
    }
    return [Tree(name, links, actuators=actuators) for name, actuators in made.items()]


def _remote() -> list[Tree]:
    """Actuators at a frame, between frames, and on the slider of a crank."""
    links = _chain("actuators", _DAMPED, _SLIDE, _SPRUNG)
    draw = np.random.default_rng(19)
    c, a, world = (End(name, turned(draw), shifted(draw, 0.3)) for name in ("c", "a", ""))
    wrench = (0.5, -1.0, 0.75, 0.25, 0.5, -0.125)
    at_site = Actuator(gain=0.5, control=2.0, control_limits=(-1.0, 1.0), ends=(c,), wrench=wrench)
    apart = Actuator(
        gear=2.0,
        gain=0.5,
        bias=(0.25, -1.0, -0.75),
        control=2.0,
        control_limits=(-1.0, 1.0),
        ends=(c, a),
        wrench=(*wrench[:3], 0.0, 0.0, 0.0),
    )
    slider = (End("b", p=(0.25, 0.125, 0.0625)), End("", p=(0.5, 0.25, 0.125)))
    crank = Actuator(ends=slider, crank=4.0, gear=1.5, control=0.75)
    return [
        Tree("actuator at a site", links, actuators=(at_site,)),
        Tree("actuators between sites", links, actuators=(apart, replace(apart, ends=(c, world)))),
        Tree("actuators between sites, seen from the link beyond", links, actuators=(replace(apart, ends=(a, c)),)),
        Tree("slider and crank", links, actuators=(crank, replace(crank, crank=3.0, ends=(c, a)))),
    ]


def _in_turn(*families: Callable[[], list[Tree]]) -> dict[str, Tree]:
    """Trees by name, one of each family after the other: who stops early has asked of each."""
    rounds = zip_longest(*(family() for family in families))
    return {tree.name: tree for trees in rounds for tree in trees if tree is not None}


def passive() -> dict[str, Tree]:
    """Dampers, springs, media, tendons."""
    return _in_turn(_passive, _tendons, _wrapped, _dragged, _heavy, _sided)


def driven() -> dict[str, Tree]:
    """Actuators."""
    return _in_turn(
        *(_plain_motors, _plain_actuators, _servos_along_joints, _states, _actuators, _affine, _remote, _muscles)
    )


def trees() -> dict[str, Tree]:
    """All of them, by name."""
    return driven() | passive()
