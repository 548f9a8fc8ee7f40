"""Sensors of all kinds: of joints and their limits, time, rays, images, places; what delays and intervals make of them.

A camera looks along -z of its frame, x to the right and y up in the image; a point at X, Y, Z there is seen at
W / 2 - f X / Z pixels from the left and H / 2 + f Y / Z from the top, f = H / (2 tan(fovy / 2)).
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal

from ..arithmetic import Exact, exact, root
from ..dynamics import Point
from ..geometry.poses import AWAY
from .device import BALL, Device, H, body, clipped, model, number, slide, turn_of

_MOVED = "qpos=v[:1], qvel=a[:1]"
_Of = Callable[[Point], object]


def _of_joint(sensor: str, value: _Of, attributes: str = "", steps: int = 0, before: str = "") -> Device:
    """A sensor beside a slide."""
    text = model(slide(attributes), f"{before}<sensor><{sensor}/></sensor>")
    return Device(f"sensor/{sensor} {attributes}", text, _MOVED, "sensordata", value, steps)


def _joints() -> dict[str, Device]:
    below, above = 'range="2 1000"', 'range="-1000 -2"'
    ball = model(body(BALL), '<sensor><ballquat joint="j"/><ballangvel joint="j"/></sensor>')
    tendon = '<tendon><fixed name="t" range="4 4000"><joint joint="j" coef="2"/></fixed></tendon>'

    def limit(apart: Callable[[Exact], Exact], of: Callable[[Exact, Exact], Exact]) -> _Of:
        """Zero where the limit is not reached."""
        return lambda s: of(apart(s.v[0]), s.a[0]) if apart(s.v[0]) < 0 else Decimal(0)

    def from_below(x: Exact) -> Exact:
        return x - 2

    def from_above(x: Exact) -> Exact:
        return -2 - x

    return {
        "sensed_joint_place": _of_joint('jointpos joint="j"', lambda s: s.v[0]),
        "sensed_joint_speed": _of_joint('jointvel joint="j"', lambda s: s.a[0]),
        "sensed_joint_place_cut_off": _of_joint(
            'jointpos joint="j" cutoff="0.25"', lambda s: clipped(s.v[0], -0.25, 0.25)
        ),
        "sensed_limit_below": _of_joint('jointlimitpos joint="j"', limit(from_below, lambda x, r: x), below),
        "sensed_limit_above": _of_joint('jointlimitpos joint="j"', limit(from_above, lambda x, r: x), above),
        "sensed_limit_speed_below": _of_joint('jointlimitvel joint="j"', limit(from_below, lambda x, r: r), below),
        "sensed_limit_speed_above": _of_joint('jointlimitvel joint="j"', limit(from_above, lambda x, r: -r), above),
        "sensed_tendon_limit": _of_joint(
            'tendonlimitpos tendon="t"', limit(from_below, lambda x, r: 2 * x), before=tendon
        ),
        "sensed_tendon_limit_speed": _of_joint(
            'tendonlimitvel tendon="t"', limit(from_below, lambda x, r: 2 * r), before=tendon
        ),
        "sensed_ball": Device(
            "sensor/ballquat, ballangvel",
            ball,
            "qpos=q, qvel=a",
            "sensordata",
            lambda s: [*s.q, *s.a],
        ),
    }


def _timed() -> dict[str, Device]:
    """Steps read sensors at their beginnings: at 0, h, 2 h ... of a slide at constant speed."""
    place, two = 'jointpos joint="j"', float(2 * H)
    delayed, sometimes = f'{place} nsample="2" delay="{two}"', f'{place} nsample="1" interval="{two}"'

    def at(k: int) -> _Of:
        return lambda s: s.v[0] + k * H * s.a[0]

    return {
        "sensed_time": _of_joint("clock", lambda s: 2 * H, steps=3),
        "sensed_before_delay": _of_joint(delayed, lambda s: Decimal(0), steps=2),
        "sensed_after_delay": _of_joint(delayed, at(1), steps=4),
        "sensed_at_interval": _of_joint(sometimes, at(2), steps=3),
        "sensed_between_intervals": _of_joint(sometimes, at(0), steps=2),
    }


_GAZE = "mocap_pos=v[None], mocap_quat=q[None]"


def _rays() -> dict[str, Device]:
    """Lengths of rays from v along z of q, to a sphere about the origin from within, or from where it leads outside."""
    looker = '<body mocap="true"><site name="o"/></body>'
    world = f'<geom type="sphere" size="4"/>{looker}'

    def met(s: Point) -> Exact:
        """Distance along the ray; -1 for none."""
        u = turn_of(s.q)[:, 2]
        half, apart = s.v @ u, s.v @ s.v - 16
        inner = half * half - apart
        if inner < 0 or (apart > 0 and half > 0):
            return Decimal(-1)
        return -half - root(inner) if apart > 0 else -half + root(inner)

    def all_data(s: Point) -> object:
        distance, u = met(s), turn_of(s.q)[:, 2]
        if distance < 0:
            return [distance, *[Decimal(0)] * 3, *s.v, *[Decimal(0)] * 6]
        point = s.v + distance * u
        return [distance, *u, *s.v, *point, *(point / 4)]

    def ray(more: str, value: _Of) -> Device:
        sensor = f'rangefinder site="o"{more}'
        return Device(f"sensor/{sensor}", model(world, f"<sensor><{sensor}/></sensor>"), _GAZE, "sensordata", value)

    return {
        "sensed_range": ray("", met),
        "sensed_range_with_all": ray(' data="dist dir origin point normal"', all_data),
    }


def _images() -> dict[str, Device]:
    """A point at (4, -8, 8), as a camera at v sees it that is turned by q."""

    def camera(attributes: str, value: Callable[[Exact, Exact, Exact], object]) -> Device:
        site = f'<site name="p" pos="{" ".join(map(repr, AWAY))}"/>'
        world = f'{site}<body mocap="true"><camera name="c" resolution="64 32" {attributes}/></body>'

        def seen(s: Point) -> object:
            return value(*(turn_of(s.q).T @ (exact(AWAY) - s.v)))

        text = model(world, '<sensor><camprojection site="p" camera="c"/></sensor>')
        return Device(f"sensor/camprojection, camera {attributes}", text, _GAZE, "sensordata", seen)

    return {
        "sensed_image": camera('fovy="90"', lambda x, y, z: [32 - 16 * x / z, 16 + 16 * y / z]),
        "sensed_image_of_focal_lengths": camera(
            'focalpixel="48 40" sensorsize="0.5 0.25"', lambda x, y, z: [32 - 48 * x / z, 16 + 40 * y / z]
        ),
    }


def _places() -> dict[str, Device]:
    """Readings of an object at v: within a site; distance from a ball at (4, -8, 8), normal and nearest points."""
    shapes = {
        "sphere": ('size="0.75"', lambda x: x @ x < number(0.75) ** 2),
        "box": ('type="box" size="0.5 0.75 0.25"', lambda x: all(abs(x) < exact((0.5, 0.75, 0.25)))),
        "ellipsoid": (
            'type="ellipsoid" size="0.5 0.75 1"',
            lambda x: sum((x / exact((0.5, 0.75, 1.0))) ** 2) < 1,
        ),
        "cylinder": (
            'type="cylinder" size="0.75 0.5"',
            lambda x: x[:2] @ x[:2] < number(0.75) ** 2 and abs(x[2]) < number(0.5),
        ),
    }
    object_at = '<body name="b" mocap="true"><geom name="g" size="0.25"/></body>'

    def within(holds: Callable[[Exact], object]) -> _Of:
        return lambda s: Decimal(int(bool(holds(s.v))))

    made = {}
    for shape, (attributes, holds) in shapes.items():
        sensor = '<sensor><insidesite site="s" objtype="xbody" objname="b"/></sensor>'
        made[f"sensed_inside_{shape}"] = Device(
            f"sensor/insidesite {attributes}",
            model(f'<site name="s" {attributes}/>{object_at}', sensor),
            _GAZE,
            "sensordata",
            within(holds),
        )
    pair = f'<geom name="h" size="0.5" pos="{" ".join(map(repr, AWAY))}"/>{object_at}'
    both = 'geom1="g" geom2="h" cutoff="1000"'
    sensors = f"<sensor><distance {both}/><normal {both}/><fromto {both}/></sensor>"

    def apart(s: Point) -> object:
        way = exact(AWAY) - s.v
        length = root(way @ way)
        u = way / length
        return [length - number(0.75), *u, *(s.v + u / 4), *(exact(AWAY) - u / 2)]

    made["sensed_distance"] = Device(
        "sensor/distance, normal, fromto", model(pair, sensors), _GAZE, "sensordata", apart
    )
    return made


def _contacts() -> dict[str, Device]:
    """A ball of radius 1/4 in the floor, a sixteenth deep, at y = v[0]."""
    joints = '<joint type="slide" axis="0 1 0"/>'
    ball = body(joints, '<geom name="g" type="sphere" size="0.25"/>', 'pos="0 0 0.1875"')
    sensor = 'contact geom1="f" geom2="g" data="found dist pos normal"'
    text = model(f'<geom name="f" type="plane" size="0 0 1"/>{ball}', f"<sensor><{sensor}/></sensor>")
    deep = number(-0.0625)
    return {
        "sensed_contact": Device(
            f"sensor/{sensor}",
            text,
            "qpos=v[:1]",
            "sensordata",
            lambda s: [1, deep, 0, s.v[0], deep / 2, 0, 0, 1],
        )
    }


DEVICES = _joints() | _timed() | _rays() | _images() | _places() | _contacts()
