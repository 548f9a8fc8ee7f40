"""MJCF: sites, actuators, frames and copies (mujoco.readthedocs.io, XML reference)."""

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
    PLACED,
    Reading,
    about,
    along,
    diagonal,
    hung,
    in_series,
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


def _sites() -> Iterator[tuple[str, Reading]]:
    """Where sites stand: on moving bodies, fixed ones, the world, stated in every way."""
    R = in_series(("x", 0.5), ("y", 0.6), ("z", 0.7))
    p = (0.1, -0.2, 0.3)

    def of(name: str, text: str, *ends: End) -> tuple[str, Reading]:
        title = f"mjcf: {name}"
        return title, Reading("mjcf", text, Tree(title, (FIRST, NEXT), sensors=ends), asked=PLACED)

    def on_b(name: str, site: str, end: End) -> tuple[str, Reading]:
        return of(name, file(b=JOINT_B + MB + site), end)

    # From (0, 0, 0) to (0.2, 0.4, -0.4): z along the way from the end to the beginning, at the middle.
    along_it = about((-2.0, 1.0, 0.0), math.acos(-2.0 / 3.0))
    ends = End("b", rows(np.array(along_it)), (0.1, 0.2, -0.2))
    yield on_b("site from end to end", '<site name="o0" type="capsule" size="0.1" fromto="0.2 0.4 -0.4 0 0 0"/>', ends)
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
    """Bodies that don't move, frames, copies."""
    still = hung(FIRST, kind="fixed")
    yield _of("fixed body with mass first", file(a=MA), still, NEXT)
    nothing = replace(still, mass=0.0, com=ORIGIN, inertia=diagonal(0.0, 0.0, 0.0))
    yield _of("fixed body without inertia first", file(a=""), nothing, NEXT)
    frame = '<frame pos="0.2 -0.1 0.4" euler="0.3 -0.4 0.5">'
    R = in_series(("x", 0.3), ("y", -0.4), ("z", 0.5))
    p = rows(np.outer(np.ones(3), np.array([0.2, -0.1, 0.4]) + np.array(R) @ np.array([0.1, 0.2, 0.3])))[0]
    wrapped = file().replace("<worldbody>", f"<worldbody>{frame}").replace("</worldbody>", "</frame></worldbody>")
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


def files() -> dict[str, Reading]:
    """All of them, by name."""
    return dict(
        [
            *_sites(),
            *_driven(),
            *_trees(),
        ]
    )
