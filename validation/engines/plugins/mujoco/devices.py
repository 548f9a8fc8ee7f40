"""Small models of MJCF in MuJoCo: each by itself, made in other ways, and all that one model holds."""

from __future__ import annotations

import re
from collections.abc import Collection

from ...interface import Slot
from ...truth.devices import COMPILED, DEVICES
from ..writing.source import Source, Way

# The tree stands for the numbers that devices are given.
SLOTS = ((Slot("quaternion wxyz, body speeds", (0, 1, 2, 3), (0, 1, 2)),),)
_COMPILED = "def compiled(text): return mj.MjModel.from_xml_string(text)"
# Models with geoms meet each other, and one has one set of options: the others of a group are attached to one another.
_OPTIONS = re.compile("<option.*</option>")
_TOGETHER = """
def joined(texts):
    parent, parts = mj.MjSpec(), [mj.MjModel.from_xml_string(text) for text in texts]
    for k, text in enumerate(texts):
        child = mj.MjSpec.from_string(text)
        if not k: parent.option = child.option
        parent.attach(child, prefix=f'd{k}_', frame=parent.worldbody.add_frame())
    return parent.compile(), [mj.MjData(part) for part in parts]
def known(text, prepared):
    try: prepared(mj.MjModel.from_xml_string(text))
    except Exception: return False
    return True
def all_known(lot, prepared):
    try:
        m, parts = joined(lot)
        return lot, prepared(m), parts
    except Exception:
        lot = [one for one in lot if known(one, prepared)]  # Releases that know less.
        m, parts = joined(lot)
        return lot, prepared(m), parts
def found(text, prepared=lambda m: m):
    lot = next(one for one in LOTS if text in one)
    if lot[0] not in lots: lots[lot[0]] = all_known(lot, prepared)
    texts, whole, parts = lots[lot[0]]
    if text not in texts: prepared(mj.MjModel.from_xml_string(text))  # Says why.
    def places(field):
        sizes = [len(getattr(part, field)) for part in parts[:texts.index(text) + 1]]
        return slice(sum(sizes[:-1]), sum(sizes))
    return whole, places
lots = {}"""
# `answer` keeps the models, each by its text.
ANSWER = """models = {}
def answer(text, field, steps, **given):
    if text not in models: models[text] = compiled(text)
    m = models[text]
    d = mj.MjData(m)
    for name, numbers in given.items(): getattr(d, name)[:] = numbers
    if not steps: mj.mj_forward(m, d)
    for _ in range(steps): mj.mj_step(m, d)
    return np.array(getattr(d if hasattr(d, field) else m, field), float).ravel()"""
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


_AMONG = """
def among(text, field, steps, **given):
    m, places = found(text)
    d = mj.MjData(m)
    for name, numbers in given.items(): getattr(d, name)[places(name)] = numbers
    if not steps: mj.mj_forward(m, d)
    for _ in range(steps): mj.mj_step(m, d)
    return np.array(getattr(d, field)[places(field)], float).ravel()"""


def together(group: str, names: Collection[str]) -> str:
    """Statements that define `found`, of the models of a group of devices with these names, as few as hold them all."""
    lots: dict[str, dict[str, None]] = {}
    for name, device in DEVICES[group].items():
        if name in names:
            options = _OPTIONS.search(device.model)
            alone = device.model if "<geom" in device.model or "energy" in device.read else ""
            lots.setdefault(alone or (options.group() if options else ""), {})[device.model] = None
    return f"LOTS = {[list(lot) for lot in lots.values()]!r}{_TOGETHER}"


def ways() -> dict[str, Way]:
    """A way of each device, and those of models that are made in other ways."""
    first = {
        name: Way(device.about, device.code)
        for devices in (DEVICES | COMPILED).values()
        for name, device in devices.items()
    }
    others = {
        f"{name}:{how}": way._replace(native=f"{how}, {way.native}", built=((_COMPILED, text),))
        for how, text in _MADE.items()
        for name, way in first.items()
        if (how != "to_xml" or name not in _LONG) and (how != "attach" or not name.startswith("compiled_"))
    }
    for group, devices in DEVICES.items():
        built = ((_COMPILED, f"{_COMPILED}\n{together(group, devices)}{_AMONG}"),)
        for name in devices:
            way = first[name]
            native, code = f"among others, {way.native}", way.code.replace("answer(", "among(", 1)
            others[f"{name}:among others"] = way._replace(native=native, code=code, built=built)
    return first | others


WAYS = ways()


def write() -> Source:
    """Text that answers of any device: the tree stands for its numbers, a turn is a quaternion."""
    return Source(("import numpy as np", "import mujoco as mj", _COMPILED, *ANSWER.split("\n")), SLOTS, 4, 3)
