"""Small models of MJCF in MuJoCo: read by its XML, and made in other ways."""

from __future__ import annotations

from ...interface import Slot
from ...truth.devices import DEVICES
from ..writing.source import Source, Way

_COMPILED = "def compiled(text): return mj.MjModel.from_xml_string(text)"
# `answer` keeps the models, each by its text.
_ANSWER = """models = {}
def answer(text, field, steps, **given):
    if text not in models: models[text] = compiled(text)
    m = models[text]
    d = mj.MjData(m)
    for name, numbers in given.items(): getattr(d, name)[:] = numbers
    if not steps: mj.mj_forward(m, d)
    for _ in range(steps): mj.mj_step(m, d)
    return np.array(getattr(d, field), float).ravel()"""
# MuJoCo writes six digits: of these models numbers take more.
_LONG = ("drive_cylinder_of_diameter",)
_MADE = {
    "to_xml": """def compiled(text):
    spec = mj.MjSpec.from_string(text)
    spec.compile()
    return mj.MjModel.from_xml_string(spec.to_xml())""",
    "copy": "def compiled(text): return mj.MjSpec.from_string(text).copy().compile()",
    "attach": """def compiled(text):
    child, parent = mj.MjSpec.from_string(text), mj.MjSpec()
    parent.option = child.option
    parent.attach(child, prefix='own_', frame=parent.worldbody.add_frame())
    return parent.compile()""",
}


def ways() -> dict[str, Way]:
    """A way of each device, and those of models that are made in other ways."""
    first = {name: Way(device.about, device.code) for devices in DEVICES.values() for name, device in devices.items()}
    others = {
        f"{name}:{how}": way._replace(native=f"{how}, {way.native}", built=((_COMPILED, text),))
        for how, text in _MADE.items()
        for name, way in first.items()
        if how != "to_xml" or name not in _LONG
    }
    return first | others


WAYS = ways()


def write() -> Source:
    """Text that answers of any device: the tree stands for its numbers, a turn is a quaternion."""
    slots = ((Slot("quaternion wxyz, body speeds", (0, 1, 2, 3), (0, 1, 2)),),)
    return Source(("import numpy as np", "import mujoco as mj", _COMPILED, *_ANSWER.split("\n")), slots, 4, 3)
