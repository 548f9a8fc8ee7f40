"""MJCF: what each element and attribute means, alone and with another (`mjcf_meaning`)."""

from __future__ import annotations

from functools import cache

from ..files.readers import Reading
from .edits import Edit, Feature, Features, with_features
from .mjcf_meaning import meaning
from .pairs import Pair

_INERTIAL = '<inertial pos="{}" mass="{}" diaginertia="0.2 0.3 0.4"/>'
_PLAIN = (
    '<mujoco model="m"><compiler angle="radian"/><option/><default/><worldbody>'
    '<body name="a" pos="0.1 0.2 0.3"><joint name="a" axis="0 0 1"/>' + _INERTIAL.format("0.1 -0.2 0.3", 2) + ""
    '<body name="b" pos="0 0 0.5"><joint name="b" axis="0 1 0"/>' + _INERTIAL.format("0 0.1 0.2", 1) + ""
    "</body></body></worldbody></mujoco>"
)
_A, _B = ".//body[@name='a']", ".//body[@name='b']"
_JA, _JB = f"{_A}/joint", f"{_B}/joint"
_IA, _IB = f"{_A}/inertial", f"{_B}/inertial"
_SECOND = '<joint type="slide" axis="1 0 0"/>'


def _on(path: str, **attributes: str | None) -> list[Edit]:
    return [(path, attributes)]


def _euler(text: str, **compiler: str | None) -> list[Edit]:
    return [("compiler", compiler), (_A, {"euler": text})]


def _geoms(*stated: str, beside: bool = False) -> list[Edit]:
    geoms = "".join(f"<geom {one}/>" for one in stated)
    return [(_B, f"+{geoms}"), *([] if beside else [(_IB, "-")])]


def _classes(text: str, *more: Edit) -> list[Edit]:
    return [("default", f"+{text}"), *more]


def _section(text: str) -> Feature:
    return [(".", f"+{text}")]


def _actuator(text: str, more: str = "") -> Feature:
    return _section(f'<actuator><{text} joint="b" {more}/></actuator>')


_RADIANS, _DEGREES = "0.3 -0.4 0.5", "30 -20 50"
_LIMITS = 'ctrlrange="-0.25 0.125" forcerange="-1 0.375"'
_LOST = '<joint damping="3" frictionloss="0.25" armature="0.5"/>'
_NAMED = f'<default class="k">{_LOST}</default>'
_BOX = 'type="box" size="0.1 0.2 0.3"'
_SPREAD = 'stiffness="3" damping="0.5" springlength="0.25" armature="0.125"'
_SUM = '<joint joint="a" coef="1"/><joint joint="b" coef="-0.5"/>'

FEATURES: Features = {
    "angles": {
        "euler": _euler(_RADIANS),
        "euler in degrees": _euler(_DEGREES, angle="degree"),
        "euler, angle left out": _euler(_DEGREES, angle=None),
        **{f"eulerseq {one}": _euler(_RADIANS, eulerseq=one) for one in ("zyx", "yxy", "XYZ", "ZXZ")},
        "two compiler elements, angle in the second": [
            (_A, {"euler": _RADIANS}),
            (".", '<compiler autolimits="true"/>'),
        ],
        "two compiler elements, eulerseq in the second": [
            (_A, {"euler": _RADIANS}),
            (".", '+<compiler eulerseq="zyx"/>'),
        ],
        "two compiler elements, angle in the first": [
            (_A, {"euler": _RADIANS}),
            (".", '+<compiler autolimits="true"/>'),
        ],
    },
    "orientation": {
        "quat": _on(_B, quat="0.2 0.4 -0.4 0.8"),
        "quat of length 2": _on(_B, quat="0.4 0.8 -0.8 1.6"),
        "axisangle": _on(_B, axisangle="0.6 0 0.8 0.7"),
        "axisangle of an axis of length 2": _on(_B, axisangle="1.2 0 1.6 0.7"),
        "euler of the second body": _on(_B, euler="0.7 -0.2 0.4"),
        "xyaxes, not at right angles": _on(_B, xyaxes="2 1 -2 0 3 0"),
        "zaxis": _on(_B, zaxis="1 2 2"),
        "zaxis against z": _on(_B, zaxis="0 1 -0.000001"),
    },
    "masses": {
        "total mass set": _on("compiler", settotalmass="6"),
        "mass bounded": _on("compiler", boundmass="1.5"),
        "moments bounded": _on("compiler", boundinertia="0.25"),
        "moments balanced": [("compiler", {"balanceinertia": "true"}), (_IA, {"diaginertia": "0.25 0.5 1.5"})],
    },
    "joint": {
        "axis left out": _on(_JB, axis=None),
        "slide": _on(_JB, type="slide"),
        "slide, axis left out": _on(_JB, type="slide", axis=None),
        "axis oblique": _on(_JB, axis="0.6 0 0.8"),
        "axis of length 2": _on(_JB, axis="0 2 0"),
        "anchor of a joint": _on(_JB, pos="0 -0.1 0.2"),
        "ball": _on(_JB, type="ball", axis=None),
        "ball with an anchor": _on(_JB, type="ball", axis=None, pos="0 -0.1 0.2"),
        "losses of a ball": _on(_JB, type="ball", axis=None, damping="3", frictionloss="0.25"),
        "two joints of a body": [(_JB, f'=<joint name="b" axis="0 1 0"/>{_SECOND}')],
        "slide before hinge": [(_JB, f'={_SECOND}<joint name="b" axis="0 1 0"/>')],
        "two hinges with anchors": [
            (_JB, '=<joint name="b" axis="0 1 0" pos="0 -0.1 0.2"/><joint axis="1 0 0" pos="0.3 0 0"/>'),
        ],
        "reference angle": _on(_JB, ref="0.4"),
        "reference of a slide": _on(_JB, type="slide", ref="0.4"),
        "fixed body": [(_JB, "-")],
    },
    "losses": {
        "damping": _on(_JB, damping="3"),
        "dry friction": _on(_JB, frictionloss="0.25"),
        "spring": _on(_JB, stiffness="7"),
        "spring with a place": _on(_JB, stiffness="7", springref="0.4"),
        "armature": _on(_JB, armature="0.5"),
    },
    "limits": {
        "range of a hinge": _on(_JB, range="-0.5 1.25"),
        "range, limited": _on(_JB, range="-0.5 1.25", limited="true"),
        "range without limits: limited false": _on(_JB, range="-0.5 1.25", limited="false"),
        "range without limits: zeros": _on(_JB, range="0 0"),
        "range without limits: zeros, limited auto": _on(_JB, range="0 0", limited="auto"),
        "range without limits: limited false, autolimits false": [
            ("compiler", {"autolimits": "false"}),
            (_JB, {"range": "-0.5 1.25", "limited": "false"}),
        ],
        "range, limited by hand": [
            ("compiler", {"autolimits": "false"}),
            (_JB, {"range": "-0.5 1.25", "limited": "true"}),
        ],
        "limits of a joint's forces": _on(_JB, actuatorfrcrange="-0.125 0.25"),
    },
    "first joint": {
        "free joint": [(_JA, "=<freejoint/>"), (_A, {"pos": None})],
        "joint of type free": [(_JA, '=<joint type="free"/>'), (_A, {"pos": None})],
        "ball first": _on(_JA, type="ball", axis=None),
        "slide first": _on(_JA, type="slide"),
        "anchor first": _on(_JA, pos="0.25 0 -0.125"),
        "reference angle first": _on(_JA, ref="-0.5"),
        "range first": _on(_JA, range="-1 0.75"),
    },
    "inertia": {
        "inertia in full": _on(_IA, diaginertia=None, fullinertia="0.21 0.32 0.43 0.01 -0.02 0.03"),
        "inertial frame turned": _on(_IA, quat="0.2 0.4 -0.4 0.8"),
        "inertial frame turned by angles": _on(_IA, euler="0.5 0.6 0.7"),
        "equal moments, frame turned": _on(_IA, diaginertia="0.3 0.3 0.3", quat="0.2 0.4 -0.4 0.8"),
    },
    "geoms": {
        "geom, all left out": _geoms('size="0.1"'),
        "geom by density": _geoms('size="0.1" density="700"'),
        **{
            f"geom {kind}": _geoms(f'type="{kind}" size="{size}" pos="0.1 -0.2 0.3" euler="0.5 0.6 0.7"')
            for kind, size in (
                ("box", "0.1 0.2 0.3"),
                ("ellipsoid", "0.1 0.2 0.3"),
                ("cylinder", "0.1 0.3"),
                ("capsule", "0.1 0.3"),
            )
        },
        **{
            f"geom {kind} from end to end": _geoms(f'type="{kind}" size="0.1" fromto="0 0 0 0.2 0.4 -0.4"')
            for kind in ("cylinder", "capsule")
        },
        "two geoms": _geoms('size="0.1" pos="0 0 0.3" mass="1"', 'size="0.1" pos="0 0 -0.3" mass="2"'),
        "shell of a box": _geoms(f'{_BOX} shellinertia="true" density="6"'),
        "shell of a ball": _geoms('size="0.2" shellinertia="true" mass="3"'),
        "geom of a mass before its density": _geoms(f'{_BOX} mass="3" density="700"'),
        "geom that meets nothing": _geoms('size="0.1" contype="0" conaffinity="0" group="2"'),
        "geoms without mass": _geoms('size="0.1"', 'size="0.3" pos="1 1 1" mass="0"', 'size="0.2" density="0"'),
        "geoms beside inertia": _geoms(f'{_BOX} mass="9"', 'size="0.2" pos="1 2 3"', beside=True),
        "geoms beside inertia, inertiafromgeom false": [
            ("compiler", {"inertiafromgeom": "false"}),
            *_geoms(f'{_BOX} mass="9"', beside=True),
        ],
        "geoms beside inertia, inertiafromgeom true": [
            ("compiler", {"inertiafromgeom": "true"}),
            *_geoms(f'{_BOX} mass="9"', beside=True),
        ],
    },
    "classes": {
        "joints by default": _classes(_LOST),
        "class of a joint": _classes(_NAMED, (_JB, {"class": "k"})),
        "childclass of a body": _classes(_NAMED, (_B, {"childclass": "k"})),
        "childclass handed down": _classes(_NAMED, (_A, {"childclass": "k"})),
        "class within a class": _classes(
            f'<default class="k">{_LOST}<default class="l"><joint damping="2"/></default></default>',
            (_JB, {"class": "l"}),
        ),
        "class of nothing before childclass": _classes(
            f'{_NAMED}<default class="p"/>', (_B, {"childclass": "k"}), (_JB, {"class": "p"})
        ),
        "main class before childclass": _classes(
            f'<joint damping="0.5"/>{_NAMED}', (_B, {"childclass": "k"}), (_JB, {"class": "main"})
        ),
        "attribute before childclass": _classes(_NAMED, (_B, {"childclass": "k"}), (_JB, {"damping": "1"})),
        "ranges by default": _classes('<joint range="-0.5 1.25"/>'),
        "ranges of a class": _classes(
            '<default class="k"><joint range="-0.5 1.25"/></default>', (_B, {"childclass": "k"})
        ),
        "anchors by default": _classes('<joint pos="0.125 0 -0.25"/>'),
        "references by default": _classes('<joint ref="0.25"/>'),
        "axis by default": _classes('<joint axis="1 0 0"/>', (_JA, {"axis": None}), (_JB, {"axis": None})),
        "geom by default": _classes(f'<geom {_BOX} density="500"/>', *_geoms("")),
        "geom of a class": _classes(
            f'<geom {_BOX}/><default class="k"><geom mass="3"/></default>', *_geoms('class="k"')
        ),
        "class of a geom before childclass": _classes(
            '<default class="h"><geom density="2000"/></default><default class="p"/>',
            (_B, {"childclass": "h"}),
            *_geoms(f'class="p" {_BOX}'),
        ),
        "actuators by default": _classes('<motor gear="3" ctrlrange="-0.25 0.25"/>'),
        "defaults of one element in two sections": [
            (".", '+<default><joint damping="3"/></default><default><joint armature="0.5"/></default>'),
        ],
    },
    "frames": {
        "frame around a body": [(_B, f'^<frame pos="0.125 -0.25 0.5" euler="{_RADIANS}"/>')],
        "frames around a body": [
            (_B, f'^<frame pos="0.125 -0.25 0.5" euler="{_RADIANS}"><frame quat="0.2 0.4 -0.4 0.8"/></frame>'),
        ],
        "frame without a turn": [(_B, '^<frame pos="0.125 -0.25 0.5"/>')],
        "frame of a class": [("default", f"+{_NAMED}"), (_B, '^<frame childclass="k"/>')],
        "frame around the first body": [(_A, f'^<frame pos="0.125 -0.25 0.5" euler="{_RADIANS}"/>')],
    },
    "gravity": {
        "oblique gravity": _on("option", gravity="1 -2 -3"),
        "gravity switched off": [("option", '+<flag gravity="disable"/>')],
        "two sections of options": [("option", {"gravity": "1 -2 -3"}), (".", '+<option timestep="0.25"/>')],
    },
    "gravity compensation": {"gravity compensation": [*_on(_A, gravcomp="0.25"), *_on(_B, gravcomp="1")]},
    "sites": {
        "site": [(_B, '+<site name="o0" pos="0.1 -0.2 0.3"/>')],
        "site turned": [(_B, '+<site name="o0" pos="0.1 -0.2 0.3" euler="0.5 0.6 0.7"/>')],
        "site by default": [
            ("default", '+<site pos="0.1 -0.2 0.3" euler="0.5 0.6 0.7"/>'),
            (_B, '+<site name="o0"/>'),
        ],
        "sites of two bodies": [
            (_A, '+<site name="o0" pos="0 0.5 0"/>'),
            (_B, '+<site name="o1" pos="0.1 -0.2 0.3"/>'),
        ],
    },
    "drives": {
        "actuator: motor": _actuator("motor", 'gear="2"'),
        "actuator: motor with limits": _actuator("motor", f'gear="2" {_LIMITS}'),
        "actuator: position": _actuator("position", 'kp="3" gear="0.5"'),
        "actuator: position with damping": _actuator("position", 'kp="3" kv="0.25"'),
        "actuator: velocity": _actuator("velocity", 'kv="4" gear="0.5"'),
        "actuator: general": _actuator("general", 'gainprm="2" biastype="affine" biasprm="0.25 -1 -0.5" gear="-1.5"'),
        "tendon of a sum": _section(f"<tendon><fixed {_SPREAD}>{_SUM}</fixed></tendon>"),
        "tendon of a sum by default": [
            ("default", f"+<tendon {_SPREAD}/>"),
            (".", f"+<tendon><fixed>{_SUM}</fixed></tendon>"),
        ],
    },
    "besides": {
        "sites, cameras and lights": [
            (_A, '+<site name="s" size="0.3" type="box" pos="1 2 3"/><camera pos="1 1 1"/><light pos="1 1 1"/>'),
        ],
        "geoms of the world": [("worldbody", '<geom type="plane" size="1 1 1"/><geom size="2" mass="5"/>')],
        "custom numbers and statistics": _section(
            '<custom><numeric name="n" data="1 2"/></custom><statistic extent="3"/><size njmax="500"/>'
        ),
        "materials and textures": _section(
            '<asset><texture name="t" type="2d" builtin="flat" width="8" height="8"/><material name="m" texture="t"/>'
            "</asset>"
        ),
    },
    "order": {
        "elements of a body turned round": [(_B, "~")],
        "elements of the first body turned round": [(_A, "~")],
        "sections turned round": [(".", "~")],
    },
}
_BALLS = ("ball", "ball with an anchor", "losses of a ball")
_FREE = ("free joint", "joint of type free")
_LIMITED = (
    *("range first", "ranges by default", "ranges of a class"),
    *("actuator: motor with limits", "actuators by default"),
)
_BY_HAND = ("range, limited by hand", "range without limits: limited false, autolimits false")
# What has no meaning or none that is documented: springs and ranges of balls, bounds and balance of inertia that is no
# diagonal; compiled numbers of what does not move.
NEVER: tuple[Pair, ...] = tuple(
    frozenset(pair)
    for pair in (
        *((one, factor) for one in (*_BALLS, "fixed body") for factor in ("limits", "drives")),
        *((one, other) for one in _BALLS for other in ("spring", "spring with a place")),
        ("fixed body", "losses"),
        # Drives of a link are of its only joint.
        *((one, "drives") for one in ("two joints of a body", "slide before hinge", "two hinges with anchors")),
        *((one, other) for one in (*_BALLS, "ball first") for other in ("ranges by default", "ranges of a class")),
        *((one, "references by default") for one in (*_BALLS, "ball first", *_FREE)),
        *((one, other) for one in _FREE for other in ("frame around the first body", "angles", "anchors by default")),
        *((one, other) for one in _FREE for other in ("ranges by default", "tendon of a sum", "drives")),
        ("ball first", "tendon of a sum"),
        ("ball first", "tendon of a sum by default"),
        *((one, other) for one in _BY_HAND for other in _LIMITED),
        *((one, "geoms") for one in ("geom by default", "geom of a class", "class of a geom before childclass")),
        *((one, "axis by default") for one in (*_BALLS, "ball first", *_FREE)),
        *(("moments bounded", other) for other in ("inertia in full", "geoms")),
        *(("mass bounded", other) for other in ("geoms",)),
        *(("moments balanced", other) for other in ("inertia", "geoms")),
    )
)


@cache
def files() -> dict[str, Reading]:
    """All of them, by name."""
    return with_features("mjcf", _PLAIN, FEATURES, meaning, 260, NEVER)
