"""Springs and dampers by polynomials, of joints, balls, free bodies, tendons; bodies in a fluid; gravity compensation.

A polynomial a, b, c of the displacement y makes -(a y + b y^2 + c y^3), of the speed -(a v + b v |v| + c v^3)
(Computation, "Polynomial forces"). A time constant T and a damping ratio r make m / (T r)^2 and 2 m / T
(XML reference, joint/springdamper). Ellipsoids of semi-axes r in a fluid of density and viscosity: with the area A
that they cast along their velocity, the normal n of the section that casts it and C the coefficients,
-density (C0 A + C1 (A_max - A)) |v| v, density C3 A (v n / |v|) (n x v) x v, -6 pi viscosity r v and
-8 pi viscosity r^3 w (Computation, "Fluid forces"). Their added mass does nothing to what only moves along, or
to a ball that only turns.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..arithmetic import Exact, cross, exact, root
from ..dynamics import Point
from ..geometry.turns import rotation_vector
from .device import BALL, MASS, Device, H, body, model, number, pi, slide, turn_of

_MOVED = "qpos=v[:1], qvel=a[:1]"
_TURNED = "qpos=q, qvel=a"
_Of = Callable[[Exact, Exact], object]


def _stretched(y: Exact) -> Exact:
    return 2 * y - y * y / 2 + number(0.75) * y**3


def _stored(y: Exact) -> Exact:
    return y * y - y**3 / 6 + number(0.1875) * y**4


def _damped(v: Exact) -> Exact:
    return number(1.5) * v + v * abs(v) / 2 + v**3 / 4


STIFFNESS, DAMPING = 'stiffness="2 -0.5 0.75"', 'damping="1.5 0.5 0.25"'


def _joint(attributes: str, of: _Of, read: str = "qfrc_passive", steps: int = 0, inside: str = "") -> Device:
    """A slide; its force of x and x'."""
    text = model(slide(attributes), inside=inside)
    return Device(f"joint {attributes}{inside}", text, _MOVED, read, lambda s: of(s.v[0], s.a[0]), steps)


def _tendon(attributes: str, of: _Of, joint: str = "") -> Device:
    """A tendon of twice a slide's coordinate; its force along the slide."""
    tendon = f'<tendon><fixed {attributes}><joint joint="j" coef="2"/></fixed></tendon>'
    return Device(
        f"tendon {attributes}",
        model(slide(joint), tendon),
        _MOVED,
        "qfrc_passive",
        lambda s: of(s.v[0], s.a[0]),
    )


def _of_joints() -> dict[str, Device]:
    quarter, at_rest = number(0.25), 'springref="0.25"'
    both = f"{STIFFNESS} {DAMPING} {at_rest}"
    return {
        "spring_polynomial": _joint(f"{STIFFNESS} {at_rest}", lambda x, r: -_stretched(x - quarter)),
        "spring_polynomial_energy": _joint(
            f"{STIFFNESS} {at_rest}",
            lambda x, r: _stored(x - quarter),
            "energy[:1]",
            inside='<flag energy="enable"/>',
        ),
        "damper_polynomial": _joint(DAMPING, lambda x, r: -_damped(r)),
        "damper_polynomial_step": _joint(
            DAMPING,
            lambda x, r: r - H * _damped(r) / (MASS + H * (number(1.5) + abs(r) + number(0.75) * r * r)),
            "qvel",
            steps=1,
        ),
        "spring_of_time_constant": _joint('springdamper="0.25 0.5"', lambda x, r: -128 * x - 16 * r),
        "springs_disabled": _joint(both, lambda x, r: -_damped(r), inside='<flag spring="disable"/>'),
        "dampers_disabled": _joint(both, lambda x, r: -_stretched(x - quarter), inside='<flag damper="disable"/>'),
    }


def _of_tendons() -> dict[str, Device]:
    half = number(0.5)

    def banded(x: Exact, r: Exact) -> Exact:
        length = 2 * x
        return -2 * _stretched(min(length + half, 0 * x) + max(length - half / 2, 0 * x))

    return {
        "tendon_spring_polynomial": _tendon(
            f'{STIFFNESS} springlength="0.5"', lambda x, r: -2 * _stretched(2 * x - half)
        ),
        "tendon_spring_beyond_a_band": _tendon(f'{STIFFNESS} springlength="-0.5 0.25"', banded),
        "tendon_spring_of_joints_at_rest": _tendon(
            STIFFNESS, lambda x, r: -2 * _stretched(2 * x - half), 'springref="0.25"'
        ),
        "tendon_damper_polynomial": _tendon(DAMPING, lambda x, r: -2 * _damped(2 * r)),
    }


def _of_turns() -> dict[str, Device]:
    ball = body(BALL.replace("/>", ' stiffness="3" damping="0.5"/>'))
    free = body('<joint name="j" type="free" stiffness="3"/>', "", 'pos="0.5 -0.25 1"')
    borne = body("<freejoint/>", "", 'gravcomp="0.75"')
    place = exact((0.5, -0.25, 1.0))
    weighed = model(borne, option='gravity="1 -2 -8"')
    whole = "qpos=np.r_[v, q], qvel=0"
    return {
        "ball_spring_and_damper": Device(
            "joint ball stiffness damping",
            model(ball),
            _TURNED,
            "qfrc_passive",
            lambda s: -3 * rotation_vector(turn_of(s.q)) - s.a / 2,
        ),
        "free_body_spring": Device(
            "joint free stiffness",
            model(free),
            whole,
            "qfrc_passive",
            lambda s: [*(-3 * (s.v - place)), *(-3 * rotation_vector(turn_of(s.q)))],
        ),
        "free_body_gravity_compensation": Device(
            "body gravcomp", weighed, whole, "qfrc_passive[:3]", lambda s: exact((-1.5, 3.0, 12.0))
        ),
    }


_AXES = (0.25, 0.5, 0.75)


def _fluid(
    shape: str, option: str, coefficients: str, given: str, read: str, value: Callable[[Point], object]
) -> Device:
    geom = f'<geom {shape} fluidshape="ellipsoid" fluidcoef="{coefficients}" contype="0" conaffinity="0"/>'
    text = model(body("<freejoint/>", geom), option=option)
    return Device(f"geom fluidshape, fluidcoef {coefficients}", text, given, read, value)


def _in_fluid() -> dict[str, Device]:
    ellipsoid, ball = f'type="ellipsoid" size="{" ".join(map(repr, _AXES))}"', 'type="sphere" size="0.25"'
    along, thin = 'density="2" wind="0.5 -1 0.25"', 'viscosity="0.5"'
    moving, turning = "qpos=np.r_[0, 0, 0, q], qvel=np.r_[a, 0, 0, 0]", "qpos=np.r_[0, 0, 0, q], qvel=np.r_[0, 0, 0, a]"
    x, y, z = exact(_AXES)
    squares = exact(_AXES) ** 2

    def seen(s: Point) -> tuple[Exact, Exact, Exact]:
        """Rotation, velocity against the wind along the body's axes, the area that is cast along it."""
        R = turn_of(s.q)
        v = R.T @ (s.a - exact((0.5, -1.0, 0.25)))
        others = np.array([squares[1] * squares[2], squares[2] * squares[0], squares[0] * squares[1]])
        return R, v, pi() * root((others**2 @ v**2) / (others @ v**2))

    def drag(s: Point) -> object:
        R, v, area = seen(s)
        return R @ (-2 * (number(0.5) * area + number(0.25) * (pi() * z * y - area)) * root(v @ v) * v)

    def lift(s: Point) -> object:
        R, v, area = seen(s)
        normal = v / squares
        normal = normal / root(normal @ normal)
        return R @ (2 * area * (v @ normal) / root(v @ v) * cross(cross(normal, v), v))

    return {
        "fluid_drag_of_ellipsoid": _fluid(ellipsoid, along, "0.5 0.25 0 0 0", moving, "qfrc_passive[:3]", drag),
        "fluid_lift_of_ellipsoid": _fluid(ellipsoid, along, "0 0 0 1 0", moving, "qfrc_passive[:3]", lift),
        "fluid_resistance_of_ellipsoid": _fluid(
            ellipsoid, thin, "0.5 0.25 1.5 1 1", moving, "qfrc_passive", lambda s: [*(-pi() * 3 / 2 * s.a), 0, 0, 0]
        ),
        "fluid_resistance_to_turning": _fluid(
            ball, thin, "0.5 0.25 1.5 1 1", turning, "qfrc_passive", lambda s: [0, 0, 0, *(-pi() / 16 * s.a)]
        ),
    }


DEVICES = _of_joints() | _of_tendons() | _of_turns() | _in_fluid()
