"""Small models of MJCF, each of one feature, and what they do by formulas of their own."""

from __future__ import annotations

from . import bound, compiled, drives, sensors, springs, transmissions
from .device import Device as Device

# What a tree is asked about that stands for some of them (`Tree.asked`) -> name of a function -> device.
DEVICES: dict[str, dict[str, Device]] = {
    "drives": drives.DEVICES,
    "transmissions": transmissions.DEVICES,
    "springs and dampers": springs.DEVICES,
    "sensors of all kinds": sensors.DEVICES,
    "solver's parameters": bound.DEVICES,
}
# The same of what MuJoCo's compiler makes of them.
COMPILED = {"compiled models": compiled.DEVICES}
