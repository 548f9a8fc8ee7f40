"""MJCF: what its elements mean, and what counts where they are left out (mujoco.readthedocs.io, XML reference)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from ...interface import ORIGIN, Actuator, End, Joint, Link, Rows, Tree, Vector, rows
from . import readers
from .readers import (
    BODY,
    DRIVEN,
    IDENTITY,
    NEXT,
    OBLONG,
    PASSIVE,
    PLACED,
    PRINCIPAL,
    PRODUCTS,
    Reading,
    about,
    along,
    diagonal,
    hung,
    in_series,
    rpy_rotation,
)

RADIAN = '<compiler angle="radian"/>'
MA = '<inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/>'
MB = '<inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/>'
JOINT_A, JOINT_B = '<joint axis="0 0 1"/>', '<joint axis="0 1 0"/>'
_AT_A, _AT_B = 'pos="0.1 0.2 0.3"', 'pos="0 0 0.5"'
# The first body is not turned.
FIRST = hung(BODY, R=IDENTITY)
# Density of geoms that state none [kg/m^3].
_WATER = 1000.0

_of = partial(readers.reading, "mjcf")


def file(a: str = JOINT_A + MA, b: str = JOINT_B + MB, head: str = RADIAN, at: tuple[str, str] = ("", "")) -> str:
    """Two bodies: what each states inside, what goes before them, and further attributes of each."""
    inner = f'<body name="b" {_AT_B} {at[1]}>{b}</body>'
    return f'<mujoco model="m">{head}<worldbody><body name="a" {_AT_A} {at[0]}>{a}{inner}</body></worldbody></mujoco>'


def _turns() -> Iterator[tuple[str, Reading]]:
    """Ways to state an orientation."""
    angles = (0.3, -0.4, 0.5)
    euler = f'euler="{" ".join(map(str, angles))}"'
    degrees = [math.radians(one) for one in (30.0, -20.0, 50.0)]

    def turned(name: str, attribute: str, R: Rows, head: str = RADIAN) -> tuple[str, Reading]:
        return _of(name, file(head=head, at=(attribute, "")), hung(FIRST, R=R), NEXT)

    def ordered(sequence: str, R: Rows) -> tuple[str, Reading]:
        return turned(f"eulerseq {sequence}", euler, R, f'<compiler angle="radian" eulerseq="{sequence}"/>')

    def by(letters: str, values: tuple[float, ...] = angles) -> Rows:
        return in_series(*zip(letters, values, strict=True))

    yield turned("euler", euler, by("xyz"))
    yield turned("euler in degrees", 'euler="30 -20 50"', by("xyz", tuple(degrees)), '<compiler angle="degree"/>')
    yield turned("euler, angle left out", 'euler="30 -20 50"', by("xyz", tuple(degrees)), "")
    yield ordered("zyx", by("zyx"))
    yield ordered("yxy", by("yxy"))
    yield ordered("XYZ", rpy_rotation(*angles))
    yield ordered("ZXZ", in_series(("z", angles[2]), ("x", angles[1]), ("z", angles[0])))
    # Of the quaternion (1, 2, -2, 4) / 5: w, x, y, z.
    yield turned("quat", 'quat="0.2 0.4 -0.4 0.8"', about((2.0, -2.0, 4.0), 2.0 * math.acos(0.2)))
    yield turned("axisangle", 'axisangle="0.6 0 0.8 0.7"', about((0.6, 0.0, 0.8), 0.7))
    in_degrees = about((0.6, 0.0, 0.8), math.radians(70.0))
    yield turned("axisangle, angle left out", 'axisangle="0.6 0 0.8 70"', in_degrees, "")
    x = np.array([2.0, 1.0, -2.0]) / 3.0
    z = np.cross(x, (0.0, 1.0, 0.0)) / np.linalg.norm(np.cross(x, (0.0, 1.0, 0.0)))
    axes = rows(np.stack([x, np.cross(z, x), z], axis=1))
    yield turned("xyaxes, not at right angles", 'xyaxes="2 1 -2 0 3 0"', axes)
    first = '<compiler autolimits="true"/>'
    yield turned("two compiler elements, angle in the second", euler, by("xyz"), first + RADIAN)
    ordered_next = f'{RADIAN}<compiler eulerseq="zyx"/>'
    yield turned("two compiler elements, eulerseq in the second", euler, by("zyx"), ordered_next)
    yield turned("two compiler elements, angle in the first", euler, by("xyz"), RADIAN + first)
    yield turned("zaxis", 'zaxis="1 2 2"', about((-2.0, 1.0, 0.0), math.acos(2.0 / 3.0)))
    yield turned(
        "zaxis against z", 'zaxis="0 1 -0.000001"', about((-1.0, 0.0, 0.0), math.acos(-1e-6 / math.hypot(1, 1e-6)))
    )


def _joints() -> Iterator[tuple[str, Reading]]:
    """What joints state, alone and several to a body."""

    def second(name: str, text: str, *joints: Joint, head: str = RADIAN) -> tuple[str, Reading]:
        place = Joint("fixed", p=(0.0, 0.0, 0.5))
        return _of(name, file(b=text + MB, head=head), FIRST, replace(NEXT, joints=(place, *joints)))

    y, x = (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)
    hinge, slide = Joint("revolute", axis=y), Joint("prismatic", axis=x)
    yield _of("plain", file(), FIRST, NEXT)
    yield second("axis left out", "<joint/>", Joint("revolute"))
    yield second("slide, axis left out", '<joint type="slide"/>', Joint("prismatic"))
    yield second("axis oblique", '<joint axis="0.6 0 0.8"/>', Joint("revolute", axis=(0.6, 0.0, 0.8)))
    yield second("axis of length 2", '<joint axis="0 2 0"/>', hinge)
    anchor, back = Joint("fixed", p=(0.0, -0.1, 0.2)), Joint("fixed", p=(0.0, 0.1, -0.2))
    yield second("anchor of a joint", '<joint axis="0 1 0" pos="0 -0.1 0.2"/>', anchor, hinge, back)
    ball = Joint("ball")
    yield second("ball", '<joint type="ball"/>', ball)
    yield second("ball with an anchor", '<joint type="ball" pos="0 -0.1 0.2"/>', anchor, ball, back)
    yield second("two joints of a body", f'{JOINT_B}<joint type="slide" axis="1 0 0"/>', hinge, slide)
    yield second("slide before hinge", f'<joint type="slide" axis="1 0 0"/>{JOINT_B}', slide, hinge)
    anchors = '<joint axis="0 1 0" pos="0 -0.1 0.2"/><joint axis="1 0 0" pos="0.3 0 0"/>'
    between = Joint("fixed", p=(0.3, 0.1, -0.2))
    pair = (anchor, hinge, between, Joint("revolute", axis=x), Joint("fixed", p=(-0.3, 0.0, 0.0)))
    yield second("two hinges with anchors", anchors, *pair)
    before = Joint("fixed", R=about(y, -0.4))
    yield second("reference angle", '<joint axis="0 1 0" ref="0.4"/>', before, hinge)
    degrees = Joint("fixed", R=about(y, math.radians(-40.0)))
    yield second("reference angle, angle left out", '<joint axis="0 1 0" ref="40"/>', degrees, hinge, head="")
    pulled = Joint("fixed", p=(-0.4, 0.0, 0.0))
    yield second("reference of a slide", '<joint type="slide" axis="1 0 0" ref="0.4"/>', pulled, slide, head="")
    yield second("armature", '<joint axis="0 1 0" armature="0.5"/>', replace(hinge, armature=(0.5,)))
    heavy = replace(slide, armature=(0.5,))
    yield second("armature of a slide", '<joint type="slide" axis="1 0 0" armature="0.5"/>', heavy)
    losses = '<joint axis="0 1 0" range="-1 1" damping="3" stiffness="7" springref="0.4" frictionloss="0.3"/>'
    yield _of("limits, springs and dampers", file(b=losses + MB), FIRST, NEXT, asked=PASSIVE)
    loose = file().replace(_AT_A, "").replace(JOINT_A, "<freejoint/>")
    free = replace(FIRST, joints=(Joint("free"),))
    yield _of("free joint", loose, free, NEXT)
    yield _of("joint of type free", loose.replace("<freejoint/>", '<joint type="free"/>'), free, NEXT)


def _inertias() -> Iterator[tuple[str, Reading]]:
    """What bodies state of inertia, and what geoms beside it count for."""

    def first(name: str, inertial: str, head: str = RADIAN, **changes: object) -> tuple[str, Reading]:
        return _of(name, file(JOINT_A + inertial, head=head), replace(FIRST, **changes), NEXT)  # type: ignore[arg-type]

    full = MA.replace('diaginertia="0.2 0.3 0.4"', f'fullinertia="{" ".join(map(str, PRODUCTS))}"')
    yield first("inertia in full", full, inertia=OBLONG)
    R = about((2.0, -2.0, 4.0), 2.0 * math.acos(0.2))
    quat = MA.replace("/>", ' quat="0.2 0.4 -0.4 0.8"/>')
    yield first("inertial frame turned", quat, inertia=along(R, PRINCIPAL))
    euler = MA.replace("/>", ' euler="0.5 0.6 0.7"/>')
    by_angles = in_series(("x", 0.5), ("y", 0.6), ("z", 0.7))
    yield first("inertial frame turned by angles", euler, inertia=along(by_angles, PRINCIPAL))
    equal = quat.replace("0.2 0.3 0.4", "0.3 0.3 0.3")
    yield first("equal moments, frame turned", equal, inertia=diagonal(0.3, 0.3, 0.3))
    # Mass centres have no default; without a position the frame stands at the body's.
    shapes = '<geom type="box" size="0.1 0.2 0.3" mass="9"/><geom size="0.2" pos="1 2 3"/>'
    yield first("geoms beside inertia", MA + shapes)
    never = '<compiler angle="radian" inertiafromgeom="false"/>'
    yield first("geoms beside inertia, inertiafromgeom false", MA + shapes, never)
    box = '<geom type="box" size="0.1 0.2 0.3" pos="0.1 -0.2 0.3" mass="3"/>'
    boxed = {"mass": 3.0, "inertia": diagonal(0.13, 0.1, 0.05)}
    always = '<compiler angle="radian" inertiafromgeom="true"/>'
    text = file(JOINT_A + MA + box, JOINT_B + box, always)
    second = replace(NEXT, com=BODY.com, **boxed)  # type: ignore[arg-type]
    yield _of("geoms beside inertia, inertiafromgeom true", text, replace(FIRST, **boxed), second)  # type: ignore[arg-type]
    total = '<compiler angle="radian" settotalmass="6"/>'
    double = [replace(one, mass=2.0 * one.mass, inertia=diagonal(0.4, 0.6, 0.8)) for one in (FIRST, NEXT)]
    yield _of("total mass set", file(head=total), *double)
    decoration = '<site name="s" size="0.3" type="box" pos="1 2 3"/><camera pos="1 1 1"/><light pos="1 1 1"/>'
    yield first("sites, cameras and lights", MA + decoration)


def solid_of(kind: str, x: float, y: float, z: float) -> tuple[float, Vector]:
    """Volume and moments, for unit density, of a shape: radii or half sizes; of those about z: radius, -, half."""
    if kind == "box":
        volume, k = 8.0 * x * y * z, 1.0 / 3.0
    elif kind == "ellipsoid":
        volume, k = 4.0 / 3.0 * math.pi * x * y * z, 1.0 / 5.0
    else:
        volume = 2.0 * math.pi * x * x * z
        across, lengthwise = volume * (x * x / 4.0 + z * z / 3.0), volume * x * x / 2.0
        if kind == "capsule":
            ends = 4.0 / 3.0 * math.pi * x**3
            volume += ends
            across += ends * (0.4 * x * x + z * z + 0.75 * x * z)
            lengthwise += ends * 0.4 * x * x
        return volume, (across, across, lengthwise)
    return volume, (volume * k * (y * y + z * z), volume * k * (x * x + z * z), volume * k * (x * x + y * y))


def dense(solid: tuple[float, Vector], density: float = _WATER, R: Rows = IDENTITY, com: Vector = ORIGIN) -> Link:
    """The second link, of one solid."""
    volume, moments = solid
    inertia = along(R, diagonal(*(density * one for one in moments)))
    return replace(NEXT, mass=density * volume, com=com, inertia=inertia)


def _defaults() -> Iterator[tuple[str, Reading]]:
    """Classes of defaults, and which of them counts."""

    def stated(name: str, classes: str, a: Link, b: Link, text: str = "") -> tuple[str, Reading]:
        head = f"{RADIAN}<default>{classes}</default>"
        return _of(name, (text or file()).replace(RADIAN, head), a, b)

    def turning(link: Link, *axis: float) -> Link:
        return hung(link, axis=axis)

    geared = [hung(one, armature=(0.5,)) for one in (FIRST, NEXT)]
    yield stated("armature by default", '<joint armature="0.5"/>', geared[0], geared[1])
    x, y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    outer = '<joint axis="1 0 0"/>'
    classes = f'{outer}<default class="k"><joint axis="0 1 0"/></default>'
    bare, named, main = "<joint/>", '<joint class="k"/>', '<joint class="main"/>'

    def bodies(a: str, b: str, *at: str) -> str:
        return file(a + MA, b + MB, at=(at[0], at[1]) if at else ("", ""))

    yield stated("axis by default", outer, turning(FIRST, *x), turning(NEXT, *x), bodies(bare, bare))
    yield stated("class of a joint", classes, turning(FIRST, *x), turning(NEXT, *y), bodies(bare, named))
    child = 'childclass="k"'
    yield stated("childclass of a body", classes, turning(FIRST, *x), turning(NEXT, *y), bodies(bare, bare, "", child))
    passed = bodies(bare, bare, child, "")
    yield stated("childclass handed down", classes, turning(FIRST, *y), turning(NEXT, *y), passed)
    before = bodies(main, bare, child, "")
    yield stated("class before childclass", classes, turning(FIRST, *x), turning(NEXT, *y), before)
    own = bodies(bare, '<joint axis="0 0 1"/>', child, "")
    yield stated("attribute before class", classes, turning(FIRST, *y), turning(NEXT, 0.0, 0.0, 1.0), own)
    nested = '<default class="k"><joint type="slide"/><default class="l"><joint axis="1 0 0"/></default></default>'
    slide = Joint("prismatic", p=(0.0, 0.0, 0.5), axis=x)
    deep = file(b='<joint class="l"/>' + MB)
    yield stated("class within a class", nested, FIRST, replace(NEXT, joints=(slide,)), deep)
    solid = '<geom type="box" size="0.1 0.2 0.3" density="500"/>'
    shaped = file(b=JOINT_B + "<geom/>")
    yield stated("geom by default", solid, FIRST, dense(solid_of("box", 0.1, 0.2, 0.3), 500.0), shaped)
    heavier = '<default class="h"><geom density="2000"/></default><default class="p"/>'
    plain = file(b=JOINT_B + '<geom class="p" type="box" size="0.1 0.2 0.3"/>', at=("", 'childclass="h"'))
    yield stated("class of a geom before childclass", heavier, FIRST, dense(solid_of("box", 0.1, 0.2, 0.3)), plain)
    massive = '<geom type="box" size="0.1 0.2 0.3"/><default class="k"><geom mass="3"/></default>'
    heavy = replace(NEXT, mass=3.0, com=ORIGIN, inertia=diagonal(0.13, 0.1, 0.05))
    yield stated("geom of a class", massive, FIRST, heavy, file(b=JOINT_B + '<geom class="k"/>'))


def _sites() -> Iterator[tuple[str, Reading]]:
    """Where sites stand: on moving bodies, fixed ones, the world, stated in every way."""
    R = in_series(("x", 0.5), ("y", 0.6), ("z", 0.7))
    p = (0.1, -0.2, 0.3)

    def of(name: str, text: str, *ends: End) -> tuple[str, Reading]:
        title = f"mjcf: {name}"
        return title, Reading("mjcf", text, Tree(title, (FIRST, NEXT), sensors=ends), asked=PLACED)

    def on_b(name: str, site: str, end: End, head: str = RADIAN) -> tuple[str, Reading]:
        return of(name, file(b=JOINT_B + MB + site, head=head), end)

    yield on_b("site", '<site name="o0" pos="0.1 -0.2 0.3"/>', End("b", p=p))
    yield on_b("site turned", '<site name="o0" pos="0.1 -0.2 0.3" euler="0.5 0.6 0.7"/>', End("b", R, p))
    both = file(JOINT_A + MA + '<site name="o0" pos="0 0.5 0"/>', JOINT_B + MB + '<site name="o1" pos="0.1 -0.2 0.3"/>')
    yield of("sites of two bodies", both, End("a", p=(0.0, 0.5, 0.0)), End("b", p=p))
    # From (0, 0, 0) to (0.2, 0.4, -0.4): z along the way from the end to the beginning, at the middle.
    along_it = about((-2.0, 1.0, 0.0), math.acos(-2.0 / 3.0))
    ends = End("b", rows(np.array(along_it)), (0.1, 0.2, -0.2))
    yield on_b("site from end to end", '<site name="o0" type="capsule" size="0.1" fromto="0.2 0.4 -0.4 0 0 0"/>', ends)
    head = f'{RADIAN}<default><site pos="0.1 -0.2 0.3" euler="0.5 0.6 0.7"/></default>'
    yield on_b("site by default", '<site name="o0"/>', End("b", R, p), head)
    fixed = '<body pos="0.2 0.1 0" euler="0.5 0.6 0.7"><site name="o0" pos="0.1 -0.2 0.3"/></body>'
    at = tuple(float(x) for x in np.array((0.2, 0.1, 0.0)) + np.array(R) @ np.array(p))
    yield on_b("site of a body that does not move", fixed, End("b", R, (at[0], at[1], at[2])))
    world = file().replace("<worldbody>", '<worldbody><site name="o0" pos="0.1 -0.2 0.3" euler="0.5 0.6 0.7"/>')
    yield of("site of the world", world, End("", R, p))


def _driven() -> Iterator[tuple[str, Reading]]:
    """Actuators that state their numbers, or take them from classes."""
    links = (FIRST, NEXT)
    text = file('<joint name="a" axis="0 0 1"/>' + MA, '<joint name="b" axis="0 1 0"/>' + MB)
    kinds = {
        "motor": ('gear="2"', Actuator("b", gear=2.0, control=0.5)),
        "position": ('kp="3"', Actuator("b", gain=3.0, bias=(0.0, -3.0, 0.0), control=0.5)),
        "velocity": ('kv="4"', Actuator("b", gain=4.0, bias=(0.0, 0.0, -4.0), control=0.5)),
        # Its force is -kv control speed.
        "damper": ('kv="5" ctrlrange="0 1"', Actuator("b", gain=0.0, bias=(0.0, 0.0, -2.5), control=0.5)),
        "general": (
            'gainprm="2" biastype="affine" biasprm="0.25 -1 -0.5"',
            Actuator("b", gain=2.0, bias=(0.25, -1.0, -0.5), control=0.5),
        ),
    }
    for kind, (stated, actuator) in kinds.items():
        named = f'<default class="k"><{kind} {stated}/></default>'
        ways = {
            kind: ("", f'<{kind} joint="b" {stated}/>'),
            f"{kind} by default": (f"<default><{kind} {stated}/></default>", f'<{kind} joint="b"/>'),
            f"{kind} of a class": (f"<default>{named}</default>", f'<{kind} class="k" joint="b"/>'),
        }
        for name, (classes, element) in ways.items():
            title = f"mjcf: {name}"
            whole = text.replace(RADIAN, RADIAN + classes)
            whole = whole.replace("</mujoco>", f"<actuator>{element}</actuator></mujoco>")
            yield title, Reading("mjcf", whole, Tree(title, links, actuators=(actuator,)), asked=DRIVEN)


def _trees() -> Iterator[tuple[str, Reading]]:
    """Bodies that don't move, frames, copies, gravity."""
    still = hung(FIRST, kind="fixed")
    yield _of("fixed body with mass first", file(a=MA), still, NEXT)
    yield _of("fixed body with mass", file(b=MB), FIRST, hung(NEXT, kind="fixed"))
    nothing = replace(still, mass=0.0, com=ORIGIN, inertia=diagonal(0.0, 0.0, 0.0))
    yield _of("fixed body without inertia first", file(a=""), nothing, NEXT)
    frame = '<frame pos="0.2 -0.1 0.4" euler="0.3 -0.4 0.5">'
    R = in_series(("x", 0.3), ("y", -0.4), ("z", 0.5))
    p = rows(np.outer(np.ones(3), np.array([0.2, -0.1, 0.4]) + np.array(R) @ np.array([0.1, 0.2, 0.3])))[0]
    wrapped = file().replace("<worldbody>", f"<worldbody>{frame}").replace("</worldbody>", "</frame></worldbody>")
    yield _of("frame around a body", wrapped, hung(FIRST, R=R, p=p), NEXT)
    twice = f'{frame}<frame pos="0.1 0.2 0.3">'
    inner = wrapped.replace(frame, twice).replace("</frame>", "</frame></frame>")
    inner = inner.replace(f'name="a" {_AT_A}', 'name="a"')
    yield _of("frame within a frame", inner, hung(FIRST, R=R, p=p), NEXT)
    box = dense(solid_of("box", 0.1, 0.2, 0.3), R=R, com=(0.2, -0.1, 0.4))
    shaped = file(b=f'{JOINT_B}{frame}<geom type="box" size="0.1 0.2 0.3"/></frame>')
    yield _of("frame around a geom", shaped, FIRST, box)
    # Another ball stands in no frame: a file that loses one is read all the same.
    ball, moved, own = '<geom size="0.1" mass="5"/>', 'pos="0.2 0 0"', '<geom size="0.1" pos="-0.4 0 0" mass="1"/>'
    after = f'<frame pos="0 0.4 0"><body name="c">{JOINT_A}{MB}</body></frame><frame {moved}>{ball}</frame>'
    solid = replace(NEXT, mass=6.0, com=(0.1, 0.0, 0.0), inertia=diagonal(0.024, 0.324, 0.324))
    hanging = Link("c", 1, (Joint("revolute", p=(0.0, 0.4, 0.0), axis=(0.0, 0.0, 1.0)),), 1.0, NEXT.com, NEXT.inertia)
    yield _of("frames of a body and then of a geom", file(b=JOINT_B + own + after), FIRST, solid, hanging)
    before = f'<frame {moved}>{ball}</frame><frame pos="0 0.4 0"><body name="c">{JOINT_A}{MB}</body></frame>'
    yield _of("frames of a geom and then of a body", file(b=JOINT_B + own + before), FIRST, solid, hanging)
    classes = f'{RADIAN}<default><default class="k"><joint axis="1 0 0"/></default></default>'
    classed = file("<joint/>" + MA, "<joint/>" + MB, classes).replace(
        "<worldbody>", '<worldbody><frame childclass="k">'
    )
    classed = classed.replace("</worldbody>", "</frame></worldbody>")
    along_x = [hung(one, axis=(1.0, 0.0, 0.0)) for one in (FIRST, NEXT)]
    yield _of("childclass of a frame", classed, *along_x)
    copied = f'<body name="b" {_AT_B}>{JOINT_B}{MB}</body>'
    copies = f'<replicate count="2" offset="0 0.3 0" sep="">{copied}</replicate>'
    alone = f'<worldbody><body name="a" {_AT_A}>{JOINT_A}{MA}{copies}</body></worldbody>'
    only = f'<mujoco model="m">{RADIAN}{alone}</mujoco>'
    second = replace(hung(NEXT, p=(0.0, 0.3, 0.5)), name="b1")
    yield _of("replicate", only, FIRST, replace(NEXT, name="b0"), second)
    aside = file(head=f'{RADIAN}<option gravity="1 -2 -3"/>')
    title = "mjcf: gravity aside"
    yield title, Reading("mjcf", aside, Tree(title, (FIRST, NEXT), gravity=(1.0, -2.0, -3.0)))


def files() -> dict[str, Reading]:
    """All of them, by name."""
    return dict(
        [
            *_joints(),
            *_turns(),
            *_inertias(),
            *_defaults(),
            *_sites(),
            *_driven(),
            *_trees(),
        ]
    )
