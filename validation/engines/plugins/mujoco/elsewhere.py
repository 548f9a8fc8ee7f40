"""Small models of MJCF in what computes from MuJoCo's models: MJX and MuJoCo Warp, which compile a model for long."""

from __future__ import annotations

from collections.abc import Collection

from ...truth.devices import DEVICES
from ..writing.source import Source, Way
from .devices import SLOTS, together


def ways(without: Collection[str]) -> dict[str, Way]:
    """Ways of the devices that are not among some."""
    every = {name: device for devices in DEVICES.values() for name, device in devices.items()}
    return {name: Way(device.about, device.code) for name, device in every.items() if name not in without}


def write(group: str, offered: Collection[str], lines: tuple[str, ...]) -> Source:
    """Text that answers of a group.

    Args:
        group: Its name.
        offered: Devices that the engine knows.
        lines: Statements that define `answer` by `found`.
    """
    made = together(group, offered).split("\n")
    return Source(("import numpy as np", "import mujoco as mj", *made, *lines), SLOTS, 4, 3)
