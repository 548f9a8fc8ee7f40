"""What of an MJCF document reaches MuJoCo: a whitelist. The rest is ignored with a remark, or refused."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from symofros.description.mjcf.files import Folder, size
from symofros.description.remarks import Remarks
from symofros.description.xml_nodes import Element
from symofros.errors import did_you_mean

# MuJoCo's time for copies grows with the square of their number: seconds for as many.
MAX_COPIES = 10_000

_KEPT_SECTIONS = frozenset({"compiler", "option", "default", "asset", "worldbody", "equality", "actuator"})
_IGNORED_SECTIONS = frozenset(
    {
        "contact",
        "custom",
        "deformable",
        "extension",
        "keyframe",
        "sensor",
        "size",
        "statistic",
        "tendon",
        "visual",
    }
)
# Of no meaning to mechanics, so not worth a remark.
_SILENT = frozenset({"custom", "extension", "size", "statistic", "visual"})

_BODY = frozenset({"body", "frame", "replicate", "joint", "freejoint", "inertial", "geom", "site"})
_EQUALITIES = frozenset({"connect", "weld", "joint"})
_ACTUATORS = frozenset({"general", "motor", "position", "velocity", "intvelocity", "damper", "cylinder", "muscle"})
# What an actuator drives that is not kept.
_DRIVEN = {"tendon": "tendon", "cranksite": "slider-crank", "slidersite": "slider-crank", "body": "body"}
_ELSEWHERE = _DRIVEN.keys()
# What acts on bodies through a tendon.
_PASSIVE = frozenset({"stiffness", "damping", "frictionloss", "armature", "range", "limited"})
_KEPT: dict[str, frozenset[str]] = {
    "mujoco": _KEPT_SECTIONS,
    "option": frozenset({"flag"}),
    "default": frozenset({"default", "joint", "geom", "site", "mesh", "material", "equality"}) | _ACTUATORS,
    "equality": _EQUALITIES,
    "actuator": _ACTUATORS,
    "asset": frozenset({"mesh", "material"}),
    **dict.fromkeys(("worldbody", "body", "frame", "replicate"), _BODY),
}
_IGNORED: dict[str, frozenset[str]] = {
    "mujoco": _IGNORED_SECTIONS,
    **dict.fromkeys(("worldbody", "body", "frame", "replicate"), frozenset({"camera", "light"})),
}
# What adds bodies, masses or forces in ways that only MuJoCo's own simulation knows.
_REFUSED: dict[str, str] = {
    "attach": "attach the other model in MuJoCo, and save the whole",
    "composite": "state its bodies one by one",
    "flexcomp": "a soft body is no rigid tree",
    "plugin": "state the body without it",
}
# Pictures, and folders of files that are handed over by name.
_DROPPED_ATTRIBUTES = frozenset({"texture", "meshdir", "texturedir", "assetdir", "strippath"})


class Sections:
    """Cuts a document down to what describes a rigid tree.

    Attributes:
        folder: Folder of the model, which collects its faults.
        remarks: Remarks on what is ignored.
    """

    def __init__(self, folder: Folder, remarks: Remarks) -> None:
        self.folder = folder
        self.remarks = remarks

    def kept(self, root: Element) -> Element:
        """The document without ignored elements; refused and unknown ones are noted as faults."""
        result = self._kept(root)
        copies = self._expanded(result) - size(result)
        if copies > MAX_COPIES:
            self.folder.fault(
                result,
                "the model is too large",
                f"<replicate> makes too many elements: {copies}, empty copies counted",
                f"at most {MAX_COPIES}",
                "replicate fewer",
            )
        return result

    def _kept(self, element: Element, is_asset: bool = False) -> Element:
        # A default that names a file would have MuJoCo open it.
        dropped = _DROPPED_ATTRIBUTES if is_asset else _DROPPED_ATTRIBUTES | {"file"}
        attributes = {k: text for k, text in element.attributes.items() if k not in dropped}
        return replace(element, attributes=attributes, children=list(self._children(element)))

    def _children(self, element: Element) -> Iterator[Element]:
        kept, ignored = _KEPT.get(element.tag, frozenset()), _IGNORED.get(element.tag, frozenset())
        for child in element.children:
            driven = sorted(_ELSEWHERE & child.attributes.keys()) if element.tag == "actuator" else []
            if driven:
                self.remarks.add(f"actuators that drive a {_DRIVEN[driven[0]]} ignored", "actuator", _name(child))
            elif element.tag in ("equality", "actuator") and child.tag not in kept:
                self.remarks.add(f"<{child.tag}> of <{element.tag}> ignored", "element", _name(child))
            elif child.tag in kept:
                yield self._kept(child, element.tag == "asset")
            elif child.tag in _REFUSED:
                self.folder.fault(
                    child,
                    f"<{child.tag}> can't be read",
                    f"in <{element.tag}>",
                    f"bodies are stated by <body>, <frame> and <replicate>, without {_listed(_REFUSED)}",
                    _REFUSED[child.tag],
                )
            elif child.tag in ignored:
                self._remark(child, element.tag)
            elif element.tag in ("worldbody", "body", "frame", "replicate", "mujoco"):
                self.folder.fault(
                    child,
                    f"<{child.tag:.60}> is unknown in <{element.tag}>",
                    f"<{child.tag:.60}>",
                    f"<{element.tag}> holds {_listed(kept | ignored)}",
                    did_you_mean(child.tag, kept | ignored),
                )

    def _remark(self, element: Element, section: str) -> None:
        """Say that an element is ignored; of a whole section, each element in it."""
        if element.tag in _SILENT:
            return
        whole = section == "mujoco"
        for item in element.children if whole else [element]:
            self.remarks.add(f"<{element.tag}> ignored", "element", _name(item))
            passive = sorted(_PASSIVE & item.attributes.keys()) if element.tag == "tendon" else []
            for label in passive:
                self.remarks.add(f"{label} of <tendon> ignored", "tendon", _name(item))

    def _expanded(self, element: Element) -> int:
        """Number of elements that MuJoCo makes of one; empty copies count, as they take time, too."""
        inside = sum(map(self._expanded, element.children))
        if element.tag != "replicate":
            return 1 + inside
        count = element.attributes.get("count", "1").strip()
        if not (count.isascii() and count.isdigit() and len(count) <= 9):
            self.folder.fault(
                element, "<replicate> has a bad 'count'", f"'{count:.60}'", "a whole number", 'write count="10"'
            )
            return 1
        return 1 + int(count) * max(1, inside)


def _name(element: Element) -> str:
    return element.attributes.get("name") or f"{element.tag} in line {element.line}"


def _listed(tags: frozenset[str] | dict[str, str]) -> str:
    return ", ".join(f"<{tag}>" for tag in sorted(tags))
