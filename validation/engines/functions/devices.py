"""What small models of MJCF do: each of one feature, by formulas; scenes of many, as MuJoCo does."""

from __future__ import annotations

import numpy as np

from ..models.covering import COVERING
from ..truth.arithmetic import Exact, exact
from ..truth.devices import COMPILED
from ..truth.devices import DEVICES as _BY_GROUP
from ..truth.dynamics import Point, Truth
from .function import Function

# Stage of MuJoCo's pipeline -> the fields of its data that it makes.
_STAGES = {
    "kinematics": "xpos xquat xmat xipos ximat xanchor xaxis site_xpos site_xmat geom_xpos",
    "com_pos": "subtree_com cdof cinert",
    "tendon": "ten_length",
    "transmission": "actuator_length",
    "com_vel": "cvel cdof_dot",
    "fwd_velocity": "ten_velocity actuator_velocity",
    "passive": "qfrc_spring qfrc_damper qfrc_gravcomp qfrc_fluid qfrc_passive",
    "rne": "qfrc_bias",
    "fwd_actuation": "act_dot actuator_force qfrc_actuator",
    "fwd_acceleration": "qfrc_smooth qacc_smooth",
    "forward": "qfrc_constraint qacc energy",
    "sensor_pos": "sensordata:POS",
    "sensor_vel": "sensordata:VEL",
    "sensor_acc": "sensordata:ACC",
    "step": "qpos qvel act time",
}
# Name of a function -> field, what the engine calls it, stage.
FIELDS = {
    f"scene_{field.replace(':', '_').lower()}": (field, f"{stage}: {field.partition(':')[0]}", stage)
    for stage, fields in _STAGES.items()
    for field in fields.split()
}


def _one(t: Truth, s: Point) -> Exact:
    return exact(np.ones(1))


DEVICES = {
    name: Function(device.text, device.truth, (group,))
    for group, devices in (_BY_GROUP | COMPILED).items()
    for name, device in devices.items()
} | {
    name: Function(
        f"1 if {field} of a scene after a step is MuJoCo's up to roundings, more by how many times they are exceeded",
        _one,
        (COVERING,),
    )
    for name, (field, _, _) in FIELDS.items()
}
