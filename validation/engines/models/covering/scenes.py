"""Small scenes of MJCF that cover each pair of features: what is wrong of two of them together shows in one scene.

A scene has options for all of it, and chains of two bodies beside each other; each has features of the table below.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache

from ...interface import ORIGIN, Joint, Link, Tree
from .pairs import Table, covering, levels

# What a tree is asked about that stands for the numbers of a scene (`Tree.asked`).
COVERING = "scenes of features"
CHAINS = 3
_UNCONSTRAINED, _UNBOUND = "unconstrained", "unbound"
# Factor -> feature -> what stands in the file; the first is that of scenes that state none.
OPTIONS: Table[str] = {
    "integrator": {name: f'integrator="{name}"' for name in ("Euler", "implicitfast", "implicit", "RK4")},
    "jacobian": {name: f'jacobian="{name}"' for name in ("dense", "sparse")},
    "cone": {name: f'cone="{name}"' for name in ("pyramidal", "elliptic")},
    "solver": {name: f'solver="{name}"' for name in ("Newton", "CG")},
    "medium": {"empty": "", "dense air": 'density="1.25"', "viscous wind": 'viscosity="0.5" wind="1 2 0.5"'},
    "flag": {"all enabled": "", "energy": 'energy="enable"'}
    | {
        f"no {name}": f'{name}="disable"'
        for name in (
            *("spring", "damper", "gravity", "clampctrl", "actuation", "constraint", "equality", "limit"),
            *("frictionloss", "refsafe", "eulerdamp", "sensor"),
        )
    },
    "constraints": {"constrained": "", _UNCONSTRAINED: ""},
    "sensors": {
        "no sensors": "",
        "acceleration sensors": '<accelerometer site="s{k}"/><force site="s{k}"/><torque site="s{k}"/>'
        '<framelinacc objtype="site" objname="s{k}"/><frameangacc objtype="site" objname="s{k}"/>'
        '<jointactuatorfrc joint="i{k}"/>',
        "velocity sensors": '<velocimeter site="s{k}"/><gyro site="s{k}"/><jointvel joint="i{k}"/>'
        '<framelinvel objtype="site" objname="s{k}" reftype="body" refname="a{k}"/>'
        '<frameangvel objtype="site" objname="s{k}"/><subtreelinvel body="a{k}"/><subtreeangmom body="a{k}"/>',
        "position sensors": '<framepos objtype="site" objname="s{k}" reftype="body" refname="a{k}"/>'
        '<framequat objtype="site" objname="s{k}"/><framexaxis objtype="site" objname="s{k}"/><jointpos joint="i{k}"/>'
        '<subtreecom body="a{k}"/><magnetometer site="s{k}"/>',
    },
}
_GEAR = 'gear="0.75 -0.5 0.25 0.5 1 -0.25"'
_TENDON = '<tendon><{kind} name="t{{k}}" {springs}>{path}</{kind}></tendon>'
_FIXED = '<joint joint="i{k}" coef="0.75"/>'
_STRAIGHT = '<site site="w{k}"/><site site="r{k}"/><site site="s{k}"/>'
_PULLED = '<site site="w{k}"/><site site="r{k}"/><pulley divisor="2"/><site site="r{k}"/><site site="s{k}"/>'
_SPRUNG = 'stiffness="3" springlength="0.25" damping="0.5"'
CHAIN: Table[str] = {
    "joint": {"no chain": ""}
    | {name: f'type="{name}" axis="0.6 0 0.8" pos="0.1 0.2 0"' for name in ("hinge", "slide")}
    | {"ball": 'type="ball" pos="0.1 0.2 0"', "free": 'type="free"'},
    # Attributes of both joints; of one of its joints or bodies.
    "passive": {
        "loose": "",
        "damper": 'damping="0.5"',
        "spring": 'stiffness="3"',
        "spring, damper": 'stiffness="2" damping="0.25"',
        "armature": 'armature="0.5"',
        "gravcomp": 'BODY gravcomp="0.75"',
        "actuatorgravcomp": 'BODY gravcomp="0.5" JOINT actuatorgravcomp="true"',
        "springref": 'JOINT stiffness="2" springref="0.5"',
        "actuatorfrcrange": 'JOINT actuatorfrcrange="-0.125 0.25"',
    },
    # ATTRIBUTES are those of the second joint.
    "bound": {
        _UNBOUND: "",
        "connect": '<equality><connect body1="b{k}" anchor=".1 .2 .3" {soft}/></equality>',
        "weld": '<equality><weld body1="b{k}" relpose=".1 .2 .3 .6 .8 0 0" torquescale="0.5" {soft}/></equality>',
        "mocap weld": '<equality><weld body1="mocap{k}" body2="b{k}" relpose=".1 .2 .3 .6 0 .8 0" {soft}/></equality>',
        "site connect": '<equality><connect site1="s{k}" site2="w{k}" {soft}/></equality>',
        "joint equality": '<equality><joint joint1="i{k}" polycoef=".1 0 0 0 0"/></equality>',
        "tendon equality": '<tendon><fixed name="e{k}"><joint joint="i{k}" coef="2"/></fixed></tendon>'
        '<equality><tendon tendon1="e{k}" polycoef=".1 0 0 0 0"/></equality>',
        "limit": 'ATTRIBUTES range="2 3" margin="0.1" solreflimit="0.03 0.8"',
        "tendon limit": '<tendon><fixed limited="true" range="3 4"><joint joint="i{k}" coef="0.5"/></fixed></tendon>',
        "frictionloss": 'ATTRIBUTES frictionloss="0.25"',
        "tendon frictionloss": '<tendon><fixed frictionloss="0.2"><joint joint="i{k}" coef="0.5"/></fixed></tendon>',
        "contact": '<geom type="sphere" size="2" mass="0" conaffinity="0"/>',
    },
    "line": {
        "no tendon": "",
        "fixed tendon": _TENDON.format(kind="fixed", springs=_SPRUNG, path=_FIXED),
        "spatial tendon": _TENDON.format(kind="spatial", springs=_SPRUNG, path=_STRAIGHT),
        "pulley": _TENDON.format(kind="spatial", springs='springlength="0.1 0.2" stiffness="2"', path=_PULLED),
    },
    "drive": {
        "not driven": "",
        "motor": "<motor {at}/>",
        "position": '<position kp="3" kv="0.5" {at}/>',
        "velocity": '<velocity kv="2" {at}/>',
        "intvelocity": '<intvelocity kp="2" actrange="-1 1" {at}/>',
        "damper drive": '<damper kv="2" ctrlrange="0 1" {at}/>',
        "cylinder": '<cylinder timeconst="0.25" area="2" bias="0.5 -1 -0.25" {at}/>',
        "muscle": '<general dyntype="muscle" gaintype="muscle" biastype="muscle" lengthrange="-4 4" '
        'dynprm="0.125 0.25" gainprm="0.75 1 5 1 0.5 1.5 1.5 1.25 1.25" '
        'biasprm="0.75 1 5 1 0.5 1.5 1.5 1.25 1.25" {at}/>',
        "filter": '<general dyntype="filter" dynprm="0.25" gainprm="2" biastype="affine" biasprm="0.1 -1 -0.5" {at}/>',
        "filterexact": '<general dyntype="filterexact" dynprm="0.25" gainprm="2" {at}/>',
        "actearly": '<general dyntype="integrator" gaintype="affine" gainprm="1 -0.5 -4" actearly="true" {at}/>',
        "filter with actearly": '<general dyntype="filterexact" dynprm="0.25" gainprm="2" '
        'actearly="true" actrange="-0.25 0.125" {at}/>',
        "ctrlrange": '<general gaintype="affine" gainprm="2 0 -1" ctrlrange="-0.125 0.25" {at}/>',
        "forcerange": '<general gainprm="2" biastype="affine" biasprm="0 0 -3" forcerange="-0.25 0.125" {at}/>',
    },
    "transmission": {
        "joint": 'joint="{joint}{k}"',
        "jointinparent": 'jointinparent="{joint}{k}"',
        "tendon": 'tendon="t{k}"',
        "site": 'site="s{k}"',
        "refsite": 'site="s{k}" refsite="w{k}"',
        "crank": 'slidersite="r{k}" cranksite="s{k}" cranklength="9"',
    },
}
_BODIES = """<site name="w{k}" pos="{x} 0.5 0" euler="0.5 0.25 1"/><body name="a{k}" pos="{x} 0 2" {compensation}>\
<joint name="j{k}" {first}/><inertial pos="0.1 -0.2 0.3" euler="0.3 0.2 0.1" mass="2" diaginertia="0.3 0.4 0.5"/>\
<site name="r{k}" pos="0.1 0 0.2" euler="0.2 1 0"/>\
<body name="b{k}" pos="0 0.5 0.25" euler="0.4 0 0.3"><joint name="i{k}" axis="0 1 0" {second}/>\
<inertial pos="0 0.2 0.1" mass="1" diaginertia="0.1 0.2 0.25"/>\
<site name="s{k}" pos="0.1 0.2 0.3" euler="1.5 0 0.5"/>{geoms}</body></body>"""
_SOFT = 'solref="0.5 1"'
_MOCAP = '<body name="mocap{k}" mocap="true" pos="1 2 1"/>'
_PLANE = '<geom type="plane" size="9 9 1" contype="0"/>'
# Scenes without these come first. MJX, docs/mjx.rst, "Feature parity": integrators Euler, RK4, implicitfast, which
# excludes fluid drag; transmissions joint, jointinparent, site, tendon; no energy.
_UNKNOWN = ("implicit", "crank", "energy")
RARE = ((*_UNKNOWN, "CG", "dense air", "viscous wind", "elliptic"), _UNKNOWN, ())
# Where there are to be no constraints, none is.
NEVER = frozenset(frozenset((_UNCONSTRAINED, one)) for one in CHAIN["bound"] if one != _UNBOUND)


def mjcf(features: Sequence[str]) -> str:
    """The scene with some features; those of a chain begin with its number."""
    options = levels(OPTIONS, features)
    text = {factor: OPTIONS[factor][one] for factor, one in options.items()}
    bodies, after = [_PLANE] if any("contact" in one for one in features) else [], []
    for k in range(CHAINS):
        own = levels(CHAIN, [one.partition(": ")[2] for one in features if one.startswith(f"{k}: ")])
        if own["joint"] != "no chain":
            body, more = _chain(k, own)
            bodies.append(body)
            after += [more, f"<sensor>{_sensors(options, own).format(k=k)}</sensor>"]
    option = " ".join(text[name] for name in ("integrator", "jacobian", "cone", "solver", "medium"))
    return (
        f'<mujoco><compiler angle="radian"/><option timestep="0.03125" tolerance="0" {option}><flag {text["flag"]}/>'
        f"</option><worldbody>{''.join(bodies)}</worldbody>{''.join(after)}</mujoco>"
    )


def _chain(k: int, own: Mapping[str, str]) -> tuple[str, str]:
    """A chain's bodies, and the elements after the world."""
    text = {factor: CHAIN[factor][one] for factor, one in own.items()}
    both, _, joint = text["passive"].partition("JOINT ")
    both, _, compensation = both.partition("BODY ")
    bound, line, at = text["bound"], text["line"], text["transmission"]
    second = " ".join((both, joint, bound.removeprefix("ATTRIBUTES ") if bound.startswith("ATTRIBUTES") else ""))
    geoms = bound if bound.startswith("<geom") else ""
    after = bound if bound.startswith(("<equality", "<tendon")) else ""
    if own["transmission"] == "tendon" and text["drive"] and not line:
        line = _TENDON.format(kind="fixed", springs="", path=_FIXED)
    # A servo's length along a free joint is none.
    driven = "i" if own["joint"] == "free" else "j"
    drive = text["drive"].format(at=f'name="m{k}" {at.format(joint=driven, k=k)} {_GEAR}')
    first = f"{text['joint']} {both}"
    body = _BODIES.format(k=k, x=4 * k, compensation=compensation, first=first, second=second, geoms=geoms)
    if own["bound"] == "mocap weld":
        body += _MOCAP.format(k=k)
    # So soft that velocity products show beside what springs pull with.
    return body, f"{(after + line).format(k=k, soft=_SOFT)}<actuator>{drive}</actuator>"


def _sensors(options: Mapping[str, str], own: Mapping[str, str]) -> str:
    """Sensors of a chain, with those of the tendon, the drive and the ball that it has."""
    text = OPTIONS["sensors"][options["sensors"]]
    kind = {"<f": "pos", "<v": "vel", "<a": "frc"}.get(text[:2], "")
    # Without actuation MuJoCo leaves the speeds of actuators at zero, which its documentation does not say.
    is_stated = own["drive"] != "not driven" and (kind != "vel" or options["flag"] != "no actuation")
    more = [f'<actuator{kind} actuator="m{{k}}"/>'] if kind and is_stated else []
    if kind in ("pos", "vel"):
        more += [f'<tendon{kind} tendon="t{{k}}"/>'] if own["line"] != "no tendon" else []
        ball = {"pos": "ballquat", "vel": "ballangvel"}[kind]
        more += [f'<{ball} joint="j{{k}}"/>'] if own["joint"] == "ball" else []
    return text + "".join(more)


@cache
def scenes() -> tuple[tuple[str, ...], ...]:
    """Features of one scene after the other, until there is each pair; first features of factors are left out."""
    chain = {**CHAIN, "joint": {one: text for one, text in CHAIN["joint"].items() if one != "no chain"}}
    return tuple(covering(OPTIONS, chain, CHAINS, RARE, NEVER))


def trees() -> dict[str, Tree]:
    """A tree for each scene: a free body, whose numbers its state takes."""
    body = Link("a", -1, (Joint("free"),))
    made = (
        Tree(f"scene {number + 1}: {', '.join(features)}", (body,), ORIGIN, asked=COVERING, features=features)
        for number, features in enumerate(scenes())
    )
    return {tree.name: tree for tree in made}
