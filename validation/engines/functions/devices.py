"""What small models of MJCF do, each of one feature."""

from __future__ import annotations

from ..truth.devices import COMPILED
from ..truth.devices import DEVICES as _BY_GROUP
from .function import Function

DEVICES = {
    name: Function(device.text, device.truth, (group,))
    for group, devices in (_BY_GROUP | COMPILED).items()
    for name, device in devices.items()
}
