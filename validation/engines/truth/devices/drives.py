"""Actuators on a slide: shortcuts of MJCF, what they make of damping ratios, states, delays, limits.

With x, x' the slide's coordinate and speed, u the control and w the state. A damping ratio r stands for
kv = 2 r sqrt(kp m), m the mass that the actuator feels, (J M^-1 J^T)^-1 (XML reference, position/dampratio). A direct
current motor of the constant K and resistance R makes K / R (u - K x'), with inductance L of the current i K i with
L i' = u - R i - K x'.
"""

from __future__ import annotations

from collections.abc import Callable

from ..arithmetic import Exact, cos_sin
from ..dynamics import Point
from .device import MASS, Device, H, clipped, model, number, pi, slide

_MOVED = "qpos=v[:1], qvel=a[:1]"
_CONTROLLED = f"{_MOVED}, ctrl=tau[:1]"
_STATED = f"{_CONTROLLED}, act=v2[:1]"
_OF_TWO, _OF_THREE = f"{_MOVED}, ctrl=tau[:2]", f"{_MOVED}, ctrl=tau"
Force = Callable[[Exact, Exact, Exact, Exact], object]


def _drive(
    element: str,
    force: Force,
    read: str = "actuator_force",
    given: str = _CONTROLLED,
    steps: int = 0,
    world: str = "",
    option: str = "",
    inside: str = "",
) -> Device:
    """An actuator on the joint of a slide; its force of x, x', u, w."""
    name, _, more = element.partition(" ")
    text = f'<actuator><{name} joint="j" {more}/></actuator>'
    about = element + (f", option {option}{inside}" if option or inside else "")

    def value(s: Point) -> object:
        return force(s.v[0], s.a[0], s.tau[0], s.v2[0])

    return Device(f"actuator/{about}", model(world or slide(), text, option, inside), given, read, value, steps)


def _of_controls(element: str, force: Callable[[Exact, Exact, Exact], object], given: str) -> Device:
    """An actuator of several controls u; its force of x, x', u."""
    return _drive(element, lambda *_: 0, given=given)._replace(value=lambda s: force(s.v[0], s.a[0], s.tau))


def _decay(time: float) -> Exact:
    """1 - exp(-h / T) of a step h."""
    return 1 - (-H / number(time)).exp()


def _shortcuts() -> dict[str, Device]:
    servo = 'position kp="4" kv="0.5"'
    filtered = f'{servo} timeconst="0.25"'
    integrated = 'intvelocity kp="4" kv="0.5"'
    cylinder = 'cylinder timeconst="0.25" area="3" bias="0.5 -2 -0.75"'
    damper = 'damper kv="3" ctrlrange="0 0.5"'
    heavy = slide('armature="2"')
    return {
        "drive_motor": _drive('motor gear="3"', lambda x, r, u, w: 3 * u, "qfrc_actuator"),
        "drive_servo": _drive(servo, lambda x, r, u, w: 4 * (u - x) - r / 2),
        "drive_servo_of_damping_ratio": _drive(
            'position kp="8" dampratio="0.75"', lambda x, r, u, w: 8 * (u - x) - 6 * r
        ),
        "drive_servo_of_damping_ratio_and_gear": _drive(
            'position kp="8" dampratio="0.75" gear="2"', lambda x, r, u, w: 8 * (u - 2 * x) - 3 * 2 * r
        ),
        "drive_servo_of_damping_ratio_and_armature": _drive(
            'position kp="4" dampratio="0.5"', lambda x, r, u, w: 4 * (u - x) - 4 * r, world=heavy
        ),
        "drive_servo_filtered": _drive(filtered, lambda x, r, u, w: 4 * (w - x) - r / 2, given=_STATED),
        "drive_servo_filtered_rate": _drive(filtered, lambda x, r, u, w: 4 * (u - w), "act_dot", _STATED),
        "drive_servo_filtered_step": _drive(
            filtered, lambda x, r, u, w: w + (u - w) * _decay(0.25), "act", _STATED, steps=1
        ),
        "drive_integrated_velocity": _drive(integrated, lambda x, r, u, w: 4 * (w - x) - r / 2, given=_STATED),
        "drive_integrated_velocity_rate": _drive(integrated, lambda x, r, u, w: u, "act_dot", _STATED),
        "drive_integrated_velocity_in_range": _drive(
            f'{integrated} actrange="-0.25 0.375"',
            lambda x, r, u, w: clipped(w + H * u, -0.25, 0.375),
            "act",
            _STATED,
            steps=1,
        ),
        "drive_integrated_velocity_in_inherited_range": _drive(
            f'{integrated} inheritrange="1"',
            lambda x, r, u, w: clipped(w + H * u, -0.5, 0.25),
            "act",
            _STATED,
            steps=1,
            world=slide('range="-0.5 0.25"'),
        ),
        "drive_damper": _drive(damper, lambda x, r, u, w: -3 * r * clipped(u, 0, 0.5)),
        "drive_velocity": _drive('velocity kv="1.5"', lambda x, r, u, w: (u - r) * number(1.5)),
        "drive_cylinder": _drive(
            cylinder, lambda x, r, u, w: 3 * w + number(0.5) - 2 * x - number(0.75) * r, given=_STATED
        ),
        "drive_cylinder_rate": _drive(cylinder, lambda x, r, u, w: 4 * (u - w), "act_dot", _STATED),
        "drive_cylinder_step": _drive(cylinder, lambda x, r, u, w: w + H * 4 * (u - w), "act", _STATED, steps=1),
        "drive_cylinder_of_diameter": _drive(
            'cylinder timeconst="0.25" diameter="0.5"', lambda x, r, u, w: pi() / 16 * w, given=_STATED
        ),
    }


def _controllers() -> dict[str, Device]:
    def torque(x: Exact, r: Exact, u: Exact) -> Exact:
        return 8 * (u[0] - x) + 2 * (u[1] - r)

    integral = 'pid kp="8" kv="2" ki="3" input="pos"'
    return {
        "drive_pid": _of_controls('pid kp="8" kv="2"', torque, _OF_TWO),
        "drive_pid_fed_forward": _of_controls(
            'pid kp="8" kv="2" input="pos vel ff"', lambda x, r, u: torque(x, r, u) + u[2], _OF_THREE
        ),
        "drive_pid_without_setpoints": _drive('pid kp="8" kv="2" input="ff"', lambda x, r, u, w: u - 8 * x - 2 * r),
        "drive_pid_integral": _drive(integral, lambda x, r, u, w: 8 * (u - x) - 2 * r + 3 * w, given=_STATED),
        "drive_pid_integral_rate": _drive(integral, lambda x, r, u, w: u - x, "act_dot", _STATED),
        "drive_pid_of_damping_ratio": _drive(
            'pid kp="8" dampratio="0.75" input="pos"', lambda x, r, u, w: 8 * (u - x) - 6 * r
        ),
        "drive_pid_in_ranges": _of_controls(
            'pid kp="8" kv="2" input="pos vel ff" posrange="-0.25 0.5" velrange="-0.5 0.125" ffrange="-0.125 0.25"',
            lambda x, r, u: (
                8 * (clipped(u[0], -0.25, 0.5) - x) + 2 * (clipped(u[1], -0.5, 0.125) - r) + clipped(u[2], -0.125, 0.25)
            ),
            _OF_THREE,
        ),
        "drive_dc_motor_controller": _of_controls(
            'dcmotor resistance="2" motorconst="0.5 0.5" controller="8 0 2 0 0 0" input="pos vel"', torque, _OF_TWO
        ),
    }


def _motors() -> dict[str, Device]:
    plain = 'dcmotor resistance="2" motorconst="0.5 0.5"'
    inductive = f'{plain} inductance="0.5 0"'
    quarter = number(0.25)

    def electric(x: Exact, r: Exact, u: Exact, w: Exact) -> Exact:
        return (u - r / 2) / 4

    return {
        "drive_dc_motor": _drive(plain, electric),
        "drive_dc_motor_of_two_constants": _drive('dcmotor resistance="2" motorconst="0.25 1"', electric),
        "drive_dc_motor_nominal": _drive('dcmotor nominal="12 3 4"', lambda x, r, u, w: (u - 3 * r) / 4),
        "drive_dc_motor_cogging": _drive(
            f'{plain} cogging="0.5 3 0.25"',
            lambda x, r, u, w: electric(x, r, u, w) + cos_sin(3 * x + quarter)[1] / 2,
        ),
        # At any other current it counts as it is after the step.
        "drive_dc_motor_steady_current": _drive(
            inductive, electric, given=f"{_CONTROLLED}, act=(tau[:1] - a[:1] / 2) / 2"
        ),
        "drive_dc_motor_current_rate": _drive(
            inductive, lambda x, r, u, w: 2 * (u - 2 * w - r / 2), "act_dot", _STATED
        ),
        "drive_dc_motor_passive": _drive(f'{plain} input="none"', lambda x, r, u, w: -r / 8, given=_MOVED),
    }


def _limits() -> dict[str, Device]:
    gravity = 'gravity="-9.5 0 0"'
    by_drive = 'actuatorgravcomp="true"'
    borne = 'gravcomp="0.5"'
    weight = number(9.5)
    motor = "motor"
    return {
        "drive_control_clipped": _drive('motor ctrlrange="-0.25 0.375"', lambda x, r, u, w: clipped(u, -0.25, 0.375)),
        "drive_control_unclipped_by_flag": _drive(
            'motor ctrlrange="-0.25 0.375"', lambda x, r, u, w: u, inside='<flag clampctrl="disable"/>'
        ),
        "drive_force_clipped": _drive('motor forcerange="-0.25 0.375"', lambda x, r, u, w: clipped(u, -0.25, 0.375)),
        "drive_none_by_flag": _drive(
            motor, lambda x, r, u, w: 0 * u, "qfrc_actuator", inside='<flag actuation="disable"/>'
        ),
        "drive_clipped_at_joint": _drive(
            'motor gear="2"',
            lambda x, r, u, w: clipped(2 * u, -0.25, 0.375),
            "qfrc_actuator",
            world=slide('actuatorfrcrange="-0.25 0.375"'),
        ),
        "drive_bears_weight": _drive(
            motor, lambda x, r, u, w: u + weight, "qfrc_actuator", world=slide(by_drive, "", borne), option=gravity
        ),
        "drive_bears_weight_within_range": _drive(
            motor,
            lambda x, r, u, w: clipped(u + weight, -4, 9.25),
            "qfrc_actuator",
            world=slide(f'{by_drive} actuatorfrcrange="-4 9.25"', "", borne),
            option=gravity,
        ),
        "drive_bears_weight_not_passively": _drive(
            motor, lambda x, r, u, w: 0 * u, "qfrc_passive", world=slide(by_drive, "", borne), option=gravity
        ),
        "drive_armature": _drive('motor gear="2" armature="0.5"', lambda x, r, u, w: 2 * u / (MASS + 2), "qacc"),
        "drive_damping": _drive('motor gear="2" damping="1.5"', lambda x, r, u, w: -6 * r, "qfrc_passive"),
        "drive_damping_polynomial": _drive(
            'motor damping="1.5 0.5 0.25"',
            lambda x, r, u, w: -(r * number(1.5) + r * abs(r) / 2 + r**3 / 4),
            "qfrc_passive",
        ),
        "drive_damping_step": _drive(
            'motor gear="2" damping="1.5"',
            lambda x, r, u, w: r + H * (2 * u - 6 * r) / (MASS + 6 * H),
            "qvel",
            steps=1,
        ),
    }


def _delays() -> dict[str, Device]:
    """A delay of two steps: controls of the first two steps are zero; interpolated half of a step before."""
    two = f'motor nsample="2" delay="{float(2 * H)}"'
    between = f'motor nsample="3" delay="{float(3 * H / 2)}" interp="linear"'
    return {
        "drive_delayed_two_steps": _drive(two, lambda x, r, u, w: r, "qvel", steps=2),
        "drive_delayed_three_steps": _drive(two, lambda x, r, u, w: r + H * u / MASS, "qvel", steps=3),
        "drive_delayed_four_steps": _drive(two, lambda x, r, u, w: r + 2 * H * u / MASS, "qvel", steps=4),
        "drive_delayed_and_interpolated": _drive(between, lambda x, r, u, w: r + H * u / 2 / MASS, "qvel", steps=2),
    }


DEVICES = _shortcuts() | _controllers() | _motors() | _limits() | _delays()
