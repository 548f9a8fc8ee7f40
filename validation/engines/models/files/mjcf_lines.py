"""MJCF: tendons, actuators, gravity compensation; sections stated twice (mujoco.readthedocs.io, XML reference)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ...interface import ORIGIN, Actuator, End, Link, Tendon, Tree
from .mjcf import FIRST, JOINT_A, JOINT_B, MA, MB, RADIAN, file
from .readers import ACTUATORS, IDENTITY, NEXT, READ, TENDONS, Reading, hung

_JOINTS = ('<joint name="a" axis="0 0 1"/>' + MA, '<joint name="b" axis="0 1 0"/>' + MB)
_LINKS = (FIRST, NEXT)
_SITES = ('<site name="n" pos="0.25 0 -0.5"/>', '<site name="o" pos="0 0.125 0.5"/>')
_SUM = Tendon("coupling", (End("a"), End("b")), (1.0, -0.5), 3.0, 0.5, 0.25, 0.125)
_MADE = 'stiffness="3" damping="0.5" springlength="0.25" armature="0.125"'
_PARTS = '<joint joint="a" coef="1"/><joint joint="b" coef="-0.5"/>'
_PATH = ("path", (End("a", p=(0.25, 0.0, -0.5)), End("b", p=(0.0, 0.125, 0.5))))
_VIA = '<site site="n"/><site site="o"/>'
_DRIVEN = ("actuator_forces", "actuated_forces")


def _file(parts: str, classes: str = "", joints: tuple[str, str] = _JOINTS) -> str:
    """Two hinges with a site on each link, classes before them and parts after them."""
    a, b = (one + site for one, site in zip(joints, _SITES, strict=True))
    return file(a, b, RADIAN + classes).replace("</mujoco>", f"{parts}</mujoco>")


def _of(
    name: str, text: str, asked: tuple[str, ...], links: tuple[Link, ...] = _LINKS, **acting: object
) -> tuple[str, Reading]:
    title = f"mjcf: {name}"
    return title, Reading("mjcf", text, Tree(title, links, **acting), asked=asked)  # type: ignore[arg-type]


def _tendons() -> Iterator[tuple[str, Reading]]:
    """Fixed tendons and those over sites: their own numbers, by default, of classes; in several sections."""
    lengths = (*TENDONS, "tendon_lengths")
    path = Tendon(*_PATH, (), 3.0, 0.5, 0.25, 0.125)

    def stated(name: str, inside: str, *tendons: Tendon, classes: str = "") -> tuple[str, Reading]:
        return _of(f"tendon {name}", _file(inside, classes), lengths, tendons=tendons)

    kinds = {"of a sum": ("fixed", _PARTS, _SUM), "over sites": ("spatial", _VIA, path)}
    for name, (kind, inside, tendon) in kinds.items():
        yield stated(name, f"<tendon><{kind} {_MADE}>{inside}</{kind}></tendon>", tendon)
        bare = f"<tendon><{kind}>{inside}</{kind}></tendon>"
        yield stated(f"{name} by default", bare, tendon, classes=f"<default><tendon {_MADE}/></default>")
        named = f'<default><tendon stiffness="7"/><default class="k"><tendon {_MADE}/></default></default>'
        of_class = f'<tendon><{kind} class="k">{inside}</{kind}></tendon>'
        yield stated(f"{name} of a class", of_class, tendon, classes=named)
        own = f'<default><tendon stiffness="7" {_MADE.partition(" ")[2]}/></default>'
        first = f'<tendon><{kind} stiffness="3">{inside}</{kind}></tendon>'
        yield stated(f"{name}, attribute before default", first, tendon, classes=own)
    plain = replace(_SUM, coefficients=(2.0, 0.25), stiffness=1.5, damping=0.0, armature=0.0)
    other = f'<tendon><fixed stiffness="1.5" springlength="0.25">{_PARTS.replace("-0.5", "0.25").replace("1", "2")}'
    other = f"<tendon><fixed {_MADE}>{_PARTS}</fixed></tendon>{other}</fixed></tendon>"
    yield stated("sections, two of them", other, _SUM, plain)


_KINDS = {
    "motor": ('gear="2"', Actuator(gear=2.0, control=0.5)),
    "position": ('kp="3" gear="0.5"', Actuator(gear=0.5, gain=3.0, bias=(0.0, -3.0, 0.0), control=0.5)),
    "position with damping": ('kp="3" kv="0.25"', Actuator(gain=3.0, bias=(0.0, -3.0, -0.25), control=0.5)),
    "velocity": ('kv="4" gear="0.5"', Actuator(gear=0.5, gain=4.0, bias=(0.0, 0.0, -4.0), control=0.5)),
    "general": (
        'gainprm="2" biastype="affine" biasprm="0.25 -1 -0.5" gear="-1.5"',
        Actuator(gear=-1.5, gain=2.0, bias=(0.25, -1.0, -0.5), control=0.5),
    ),
}


def _element(kind: str, more: str) -> str:
    return f"<{kind.partition(' ')[0]} {more}/>"


def _actuators() -> Iterator[tuple[str, Reading]]:
    """Actuators of joints, tendons and sites: gears, gains, limits; by default of each other's elements."""
    asked = (*ACTUATORS, *_DRIVEN)

    def stated(
        name: str,
        inside: str,
        *actuators: Actuator,
        classes: str = "",
        asked: tuple[str, ...] = asked,
        tendons: tuple[Tendon, ...] = (),
        joints: tuple[str, str] = _JOINTS,
    ) -> tuple[str, Reading]:
        text = _file(inside, classes, joints)
        return _of(f"actuator: {name}", text, asked, tendons=tendons, actuators=actuators)

    def within(inside: str) -> str:
        return f"<actuator>{inside}</actuator>"

    for kind, (numbers, actuator) in _KINDS.items():
        own = replace(actuator, link="b")
        yield stated(kind, within(_element(kind, f'joint="b" {numbers}')), own)
        limits = 'ctrlrange="-0.25 0.125" forcerange="-1 0.375"'
        bound = replace(own, control_limits=(-0.25, 0.125), force_limits=(-1.0, 0.375))
        yield stated(f"{kind} with limits", within(_element(kind, f'joint="b" {numbers} {limits}')), bound)
        by_default = f"<default>{_element(kind, limits)}</default>"
        yield stated(
            f"{kind} with limits by default", within(_element(kind, f'joint="b" {numbers}')), bound, classes=by_default
        )
    motor, second = Actuator("a", gear=2.0, control=0.5), Actuator("b", gear=-0.5, control=0.25)
    pair = '<motor joint="a" gear="2"/>', '<motor joint="b" gear="-0.5"/>'
    yield stated("sections, two of them", "".join(map(within, pair)), motor, second)
    # Defaults of actuators are those of one element, whatever it is called.
    yield stated(
        "motor by default of a general one",
        within('<motor joint="b"/>'),
        Actuator("b", gear=3.0, control=0.5),
        classes='<default><general gear="3"/></default>',
    )
    on_sum = within('<motor tendon="f" gear="2"/>')
    tendon = f'<tendon><fixed name="f" {_MADE}>{_PARTS}</fixed></tendon>'
    yield stated("on a tendon", tendon + on_sum, Actuator(tendon=0, gear=2.0, control=0.5), tendons=(_SUM,))
    of_sites = ("actuator_sites", "actuator_gains", "actuator_biases", "actuator_lengths", "actuated_forces")
    a, b = End("a", p=(0.25, 0.0, -0.5)), End("b", p=(0.0, 0.125, 0.5))
    for name, ends, at in (("a site", (a, b), 'site="n" refsite="o"'), ("the other", (b, a), 'site="o" refsite="n"')):
        apart = Actuator(control=0.5, ends=ends, wrench=(0.5, -1.0, 0.25, 0.0, 0.0, 0.0))
        inside = within(f'<general {at} gear="0.5 -1 0.25 0 0 0"/>')
        yield stated(f"at {name} of two, by the reference site", inside, apart, asked=of_sites)
    ranged = _JOINTS[0], '<joint name="b" axis="0 1 0" range="-0.5 1.25"/>' + MB
    servo = replace(_KINDS["position"][1], link="b", gear=1.0, control_limits=(-0.5, 1.25))
    inherits = within('<position joint="b" kp="3" inheritrange="1"/>')
    yield stated("range that is inherited", inherits, servo, joints=ranged)
    narrow = within('<position joint="b" kp="3" inheritrange="0.5"/>')
    yield stated(
        "half of a range that is inherited", narrow, replace(servo, control_limits=(-0.0625, 0.8125)), joints=ranged
    )


def _sections() -> Iterator[tuple[str, Reading]]:
    """Sections that are stated twice, which add to each other; gravity compensation."""
    geared = [hung(one, armature=(0.5,)) for one in _LINKS]
    twice = '<default><joint armature="0.5"/></default><default><geom density="500"/></default>'
    yield _of("two sections of defaults", file(head=RADIAN + twice), READ, tuple(geared))
    again = '<default><joint armature="0.25" damping="3"/></default><default><joint armature="0.5"/></default>'
    losses = ("joint_dampings",)
    lost = tuple(hung(one, armature=(0.5,), damping=3.0) for one in _LINKS)
    yield _of("defaults of one element in two sections", file(head=RADIAN + again), (*losses, "mass_matrix"), lost)
    first = '<worldbody><site name="w"/></worldbody><worldbody>'
    yield _of("two sections of bodies", file().replace("<worldbody>", first), READ)
    whole = f'{RADIAN}<option gravity="1 -2 -3"/><option timestep="0.25"/>'
    title = "mjcf: two sections of options"
    yield title, Reading("mjcf", file(head=whole), Tree(title, _LINKS, gravity=(1.0, -2.0, -3.0)))
    # Of 1 kg and unit moments, as readers take that read no masses: gravity shows alone.
    plain = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
    one, other = (joint.replace("<joint", '<joint type="slide"') + plain for joint in (JOINT_A, JOINT_B))
    unit = tuple(replace(hung(link, kind="prismatic"), mass=1.0, com=ORIGIN, inertia=IDENTITY) for link in _LINKS)
    title = "mjcf: gravity of unit masses"
    text = file(one, other, RADIAN + '<option gravity="1 -2 -3"/>')
    yield title, Reading("mjcf", text, Tree(title, unit, gravity=(1.0, -2.0, -3.0)))
    borne = tuple(replace(one, compensation=part) for one, part in zip(_LINKS, (0.25, 1.0), strict=True))
    weights = file(JOINT_A + MA, JOINT_B + MB, at=('gravcomp="0.25"', 'gravcomp="1"'))
    yield _of("gravity compensation", weights, ("weight_shares",), borne)


def files() -> dict[str, Reading]:
    """All of them, by name."""
    return dict([*_tendons(), *_actuators(), *_sections()])
