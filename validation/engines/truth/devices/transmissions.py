"""What actuators act on: turns of balls and of free bodies, sums of tendons, tendons with pulleys, contacts.

With r the rotation vector of a ball's quaternion q, its actuator of the gear g has the length g r and the force g u
along the turned axes, R^T g u along those before ("in parent"); the vector is the same along both. On such lengths a
servo goes the shorter way round (XML reference, general/joint, position).
"""

from __future__ import annotations

from collections.abc import Callable

from ..arithmetic import Exact, exact, root
from ..dynamics import Point
from ..geometry.turns import rotation_vector, turned_by
from .device import BALL, Device, body, clipped, model, pi, slide, turn_of

_TURNED = "qpos=q, qvel=a, ctrl=tau[:1]"
_FREE = "qpos=np.r_[v, q], qvel=np.r_[a, tau], ctrl=v2[:1]"
_GEAR = "0.5 -1 2"
_G = exact((0.5, -1.0, 2.0))
_BALL, _FREE_BODY = body(BALL), body('<freejoint name="j"/>')
_Of = Callable[[Point], object]


def _on(world: str, element: str, given: str, read: str, value: _Of) -> Device:
    about = "ball" if world is _BALL else "free joint"
    return Device(
        f"actuator/{element} of a {about}", model(world, f"<actuator><{element}/></actuator>"), given, read, value
    )


def _balls() -> dict[str, Device]:
    own, before = f'motor joint="j" gear="{_GEAR}"', f'motor jointinparent="j" gear="{_GEAR}"'

    def length(s: Point) -> object:
        return _G @ rotation_vector(turn_of(s.q))

    def round_about(s: Point) -> object:
        apart = s.tau[0] - rotation_vector(turn_of(s.q))[2]
        whole = 2 * pi()
        return 3 * (apart - whole * (apart / whole).to_integral_value())

    return {
        "ball_actuated": _on(_BALL, own, _TURNED, "qfrc_actuator", lambda s: _G * s.tau[0]),
        "ball_actuated_in_parent": _on(
            _BALL, before, _TURNED, "qfrc_actuator", lambda s: turn_of(s.q).T @ _G * s.tau[0]
        ),
        "ball_actuator_length": _on(_BALL, own, _TURNED, "actuator_length", length),
        "ball_actuator_length_in_parent": _on(_BALL, before, _TURNED, "actuator_length", length),
        "ball_actuator_speed": _on(_BALL, own, _TURNED, "actuator_velocity", lambda s: _G @ s.a),
        "ball_actuator_speed_in_parent": _on(
            _BALL, before, _TURNED, "actuator_velocity", lambda s: _G @ (turn_of(s.q) @ s.a)
        ),
        "ball_servo_round_about": _on(
            _BALL, 'position joint="j" gear="0 0 1" kp="3"', _TURNED, "actuator_force", round_about
        ),
    }


def _orientations() -> dict[str, Device]:
    """Force kp log(q^-1 target) - kv w along the turned axes, of a bounded length."""

    def force(s: Point, target: Exact, least: float = 0.0) -> Exact:
        torque = 4 * rotation_vector(turn_of(s.q).T @ target) - s.a / 2
        length = root(torque @ torque)
        return torque * (clipped(length, 0, least) / length) if least else torque

    element, by_vector = 'orientation joint="j" kp="4" kv="0.5"', "qpos=q, qvel=a, ctrl=tau"
    by_quaternion = "qpos=q, qvel=a, ctrl=2 * q2"
    return {
        "ball_oriented": _on(_BALL, element, by_vector, "actuator_force", lambda s: force(s, turned_by(s.tau))),
        "ball_oriented_by_quaternion": _on(
            _BALL, f'{element} input="quat"', by_quaternion, "actuator_force", lambda s: force(s, turn_of(s.q2))
        ),
        "ball_oriented_at_limit": _on(
            _BALL,
            f'{element} forcerange="0 2"',
            by_vector,
            "actuator_force",
            lambda s: force(s, turned_by(s.tau), 2.0),
        ),
        "ball_oriented_along_speeds": _on(
            _BALL, element, by_vector, "qfrc_actuator", lambda s: force(s, turned_by(s.tau))
        ),
    }


def _free() -> dict[str, Device]:
    gear, six = "1 -2 3 0.5 -1 2", exact((1.0, -2.0, 3.0))
    own, before = f'motor joint="j" gear="{gear}"', f'motor jointinparent="j" gear="{gear}"'
    return {
        "free_body_actuated": _on(
            _FREE_BODY, own, _FREE, "qfrc_actuator", lambda s: [*(six * s.v2[0]), *(_G * s.v2[0])]
        ),
        "free_body_actuated_in_parent": _on(
            _FREE_BODY,
            before,
            _FREE,
            "qfrc_actuator",
            lambda s: [*(six * s.v2[0]), *(turn_of(s.q).T @ _G * s.v2[0])],
        ),
        "free_body_actuator_speed": _on(_FREE_BODY, own, _FREE, "actuator_velocity", lambda s: six @ s.a + _G @ s.tau),
    }


# Sites of the world that a tendon runs from, and the one of the slide that it runs to.
_FIRST, _SECOND, _MOVING = (-1.0, 0.5, 0.25), (2.0, -1.0, 0.5), (0.25, 0.125, -0.5)


def _text(x: tuple[float, ...]) -> str:
    return " ".join(map(repr, x))


def _pulleys() -> dict[str, Device]:
    sites = f'<site name="w" pos="{_text(_FIRST)}"/><site name="o" pos="{_text(_SECOND)}"/>'
    world = sites + slide(more=f'<site name="p" pos="{_text(_MOVING)}"/>')
    way = '<site site="w"/><site site="p"/><pulley divisor="4"/><site site="o"/><site site="p"/>'

    def tendon(more: str, before: str = "") -> str:
        return f'<tendon><spatial name="t"{more}>{before}{way}</spatial></tendon>'

    def parts(s: Point, first: int) -> tuple[Exact, Exact]:
        """Length and its derivative by the slide's coordinate, of a first branch that counts by its part."""
        at = exact(_MOVING) + exact((1.0, 0.0, 0.0)) * s.v[0]
        length, arm = 0 * s.v[0], 0 * s.v[0]
        for start, divisor in ((_FIRST, first), (_SECOND, 4)):
            apart = at - exact(start)
            own = root(apart @ apart)
            length, arm = length + own / divisor, arm + apart[0] / own / divisor
        return length, arm

    def device(read: str, value: _Of, more: str = "", before: str = "") -> Device:
        about = f"tendon/spatial/pulley{more}"
        return Device(about, model(world, tendon(more, before)), "qpos=v[:1], qvel=a[:1]", read, value)

    halved = '<pulley divisor="2"/>'
    return {
        "pulley_length": device("ten_length", lambda s: parts(s, 1)[0]),
        "pulley_length_of_two": device("ten_length", lambda s: parts(s, 2)[0], before=halved),
        "pulley_speed": device("ten_velocity", lambda s: parts(s, 1)[1] * s.a[0]),
        "pulley_speed_of_two": device("ten_velocity", lambda s: parts(s, 2)[1] * s.a[0], before=halved),
        "pulley_spring": device(
            "qfrc_passive",
            lambda s: -3 * (parts(s, 1)[0] - 1) * parts(s, 1)[1],
            ' stiffness="3" springlength="1"',
        ),
    }


def _bounded_tendons(gear: int) -> dict[str, Device]:
    """Two motors on a tendon of twice a coordinate, one with a gear, and what it lets through."""
    tendon = '<tendon><fixed name="t" actuatorfrcrange="-0.5 0.75"><joint joint="j" coef="2"/></fixed></tendon>'
    sensor, given = '<sensor><tendonactuatorfrc tendon="t"/></sensor>', "qpos=v[:1], ctrl=tau[:2]"
    motors = f'<actuator><motor name="m" tendon="t"/><motor tendon="t" gear="{gear}"/></actuator>'
    text, about = model(slide(), tendon + motors + sensor), f"tendon actuatorfrcrange, gear {gear}"
    geared = "_with_gear" if gear > 1 else ""

    def force(s: Point) -> Exact:
        return clipped(s.tau[0] + gear * s.tau[1], -0.5, 0.75)

    return {
        f"tendon_clipped{geared}": Device(about, text, given, "qfrc_actuator", lambda s: 2 * force(s)),
        f"tendon_clipped_sensor{geared}": Device(f"{about}, tendonactuatorfrc", text, given, "sensordata", force),
    }


def _adhering() -> dict[str, Device]:
    """A ball above a floor, within the gap in which contacts are found but do nothing."""
    ball = '<geom type="sphere" size="0.25" margin="0" gap="0.25"/>'
    up = body('<joint name="j" type="slide" axis="0 0 1"/>', ball, 'pos="0 0 0.25"')
    text = model(
        f'<geom type="plane" size="4 4 1"/>{up}',
        '<actuator><adhesion body="b" ctrlrange="0 0.5" gain="3"/></actuator>',
    )
    return {
        "adhesion": Device(
            "actuator/adhesion",
            text,
            "qpos=0 * v[:1] + 0.0625, ctrl=tau[:1]",
            "qfrc_actuator",
            lambda s: -3 * clipped(s.tau[0], 0, 0.5),
        )
    }


DEVICES = _balls() | _orientations() | _free() | _pulleys() | _bounded_tendons(1) | _bounded_tendons(3) | _adhering()
