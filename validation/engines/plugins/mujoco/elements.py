"""MuJoCo's elements beyond bodies: equality constraints, tendons, actuators, sensors."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from ...interface import STEP, Actuator, Array, Constraint, End, Joint, Muscle, Tendon, Tree, Wrap, vector
from ..writing.source import ways_of

KINDS = {
    "point": "equality/connect",
    "weld": "equality/weld",
    "coupling": "equality/joint; equality/tendon of a fixed tendon",
    "polynomial": "equality/joint, polycoef",
    "path": "equality/tendon of a spatial tendon",
    "floor": "geom, condim 1",
}
# As hard as MuJoCo lets a constraint be: it bounds impedances by mjMAXIMP, 0.9999.
_HARD = 'solimp="0.9999 0.9999 0.001"'


def _text(values: Iterable[float]) -> str:
    return " ".join(repr(float(value)) for value in values)


def _site(name: str, end: End) -> str:
    R = np.array(end.R)
    return f'<site name="{name}" pos="{_text(end.p)}" xyaxes="{_text([*R[:, 0], *R[:, 1]])}"/>'


def _surface(name: str, wrap: Wrap) -> str:
    """A geom that a tendon wraps around and nothing meets."""
    R, kind = np.array(wrap.end.R), "sphere" if wrap.is_sphere else "cylinder"
    size = f"{wrap.radius!r}" if wrap.is_sphere else f"{wrap.radius!r} 1"
    at = f'pos="{_text(wrap.end.p)}" xyaxes="{_text([*R[:, 0], *R[:, 1]])}"'
    aside = _site(f"{name}_side", End("", p=vector(np.array(wrap.end.p) + R @ wrap.side))) if wrap.side else ""
    return f'<geom name="{name}" type="{kind}" size="{size}" {at} mass="0" contype="0" conaffinity="0"/>{aside}'


def _wrapped(name: str, wrap: Wrap) -> str:
    return f'<geom geom="{name}"' + (f' sidesite="{name}_side"' if wrap.side else "") + "/>"


def _met(number: int, one: Constraint, link: str) -> str:
    """A ball of a link that meets a floor alone, and in the world "" the floor, which meets balls of its own number."""
    (end,), (radius, height) = one.ends, one.coefficients
    if not link:
        plane = f'type="plane" size="0 0 1" pos="0 0 {height!r}" contype="{2**number}" conaffinity="0"'
        return f'<geom name="f{number}" {plane} condim="1"/>'
    ball = f'type="sphere" size="{radius!r}" pos="{_text(end.p)}" mass="0" contype="0" conaffinity="{2**number}"'
    return f'<geom name="g{number}" {ball} condim="1"/>' if end.link == link else ""


def sites(tree: Tree, link: str) -> str:
    """The sites of a link, "" for the world, for constraints, tendons, sensors; and what tendons wrap around."""
    lines: list[tuple[str, Constraint | Tendon]] = [(f"s{number}", one) for number, one in enumerate(tree.constraints)]
    lines += [(f"n{number}", one) for number, one in enumerate(tree.tendons)]
    sensors = "".join(_site(f"o{k}", end) for k, end in enumerate(tree.sensors) if end.link == link)
    for number, actuator in enumerate(tree.actuators):
        sensors += "".join(_site(f"u{number}_{k}", end) for k, end in enumerate(actuator.ends) if end.link == link)
    for number, tendon in enumerate(tree.tendons):
        wraps = ((k, wrap) for k, wrap in enumerate(tendon.wraps) if wrap.end.link == link)
        sensors += "".join(_surface(f"w{number}_{k}", wrap) for k, wrap in wraps)
    sensors += "".join(_met(number, one, link) for number, one in enumerate(tree.constraints) if one.kind == "floor")
    return sensors + "".join(
        _site(f"{name}_{place}", end)
        for name, one in lines
        if one.kind not in ("coupling", "polynomial", "floor")
        for place, end in enumerate(one.ends)
        if end.link == link
    )


def elements(tree: Tree) -> str:
    """The elements of MJCF beyond bodies, with links' joints named as the links."""
    held = [(number, one) for number, one in enumerate(tree.constraints) if one.kind != "floor"]
    equalities = [_equality(number, one) for number, one in held]
    tendons = [_tendon(number, one) for number, one in held]
    tendons += [_line(f"n{number}", f"n{number}", one, _spring(one)) for number, one in enumerate(tree.tendons)]
    parts = {
        "tendon": tendons,
        "equality": equalities,
        "actuator": [_actuator(k, one) for k, one in enumerate(tree.actuators)],
    }
    parts["sensor"] = [_sensor(kind, k) for k in range(len(tree.sensors)) for kind in _SENSORS]
    return "".join(f"<{name}>{''.join(part)}</{name}>" for name, part in parts.items() if any(part))


_SENSORS = ("accelerometer", "gyro", "velocimeter", "force", "torque", "frameangacc", "magnetometer")


def _sensor(kind: str, k: int) -> str:
    at = f'objtype="site" objname="o{k}"' if kind.startswith("frame") else f'site="o{k}"'
    return f'<{kind} name="{kind}{k}" {at}/>'


def _spring(one: Tendon) -> str:
    heavy = f' armature="{one.armature!r}"' if one.armature else ""
    heavy += f' limited="true" range="{_text(one.limits)}"' if one.limits else ""
    heavy += f' frictionloss="{one.friction!r}"' if one.friction else ""
    return f' stiffness="{one.stiffness!r}" damping="{one.damping!r}" springlength="{one.rest!r}"{heavy}'


def _driven(number: int, one: Actuator) -> str:
    """What an actuator acts on, and its gear."""
    if one.crank:
        at = f'cranksite="u{number}_0" slidersite="u{number}_1" cranklength="{one.crank!r}"'
    elif one.ends:
        at = f'site="u{number}_0"' + (f' refsite="u{number}_1"' if len(one.ends) > 1 else "")
        wrench = (one.gear * part for part in one.wrench)
        return f'{at} gear="{_text(wrench)}"'
    else:
        at = f'joint="{one.link}"' if one.tendon is None else f'tendon="n{one.tendon}"'
    return f'{at} gear="{one.gear!r}"'


def _muscle(one: Muscle) -> str:
    """A general actuator whose control is the activation."""
    parameters = (*one.operating, one.peak, 200.0, *one.zeros, one.fastest, one.passive, one.lengthening)
    return (
        f'general gaintype="muscle" biastype="muscle" lengthrange="{_text(one.lengths)}"'
        f' gainprm="{_text(parameters)}" biasprm="{_text(parameters)}"'
    )


def _actuator(number: int, one: Actuator) -> str:
    """A motor, a servo of position or velocity, or the general one."""
    _, b1, b2 = one.bias
    is_affine = any(one.slopes)
    gain = f'gaintype="affine" gainprm="{_text((one.gain, *one.slopes))}"' if is_affine else f'gainprm="{one.gain!r}"'
    element = f'general {gain} biastype="affine" biasprm="{_text(one.bias)}"'
    if one.muscle is not None:
        element = _muscle(one.muscle)
    elif one.activation is None and not is_affine:
        match one:
            case Actuator(gain=1.0, bias=(0.0, 0.0, 0.0)):
                element = "motor"
            case Actuator(bias=(0.0, _, 0.0)) if one.gain == -b1:
                element = f'position kp="{one.gain!r}"'
            case Actuator(bias=(0.0, 0.0, _)) if one.gain == -b2:
                element = f'velocity kv="{one.gain!r}"'
    limits = f' ctrllimited="true" ctrlrange="{_text(one.control_limits)}"' if one.control_limits else ""
    limits += f' forcelimited="true" forcerange="{_text(one.force_limits)}"' if one.force_limits else ""
    group = ' group="1"' if one.is_disabled else ""
    return f'<{element} name="a{number}" {_driven(number, one)}{limits}{group}{_activation(one)}/>'


_DYNAMICS = {"exact filter": "filterexact"}


def _activation(one: Actuator) -> str:
    """Attributes of an actuator's state."""
    state = one.activation
    if state is None:
        return ""
    made = f' dyntype="{_DYNAMICS.get(state.kind, state.kind)}"'
    made += f' dynprm="{_text(state.times)}"' if state.times else ""
    made += f' actlimited="true" actrange="{_text(state.limits)}"' if state.limits else ""
    return made + (' actearly="true"' if state.is_early else "")


def options(tree: Tree) -> str:
    """Attributes of options that a tree needs."""
    made = f' timestep="{STEP}"' if "activations" in tree.forces else ""
    if tree.medium:
        density, viscosity, wind = tree.medium
        made += f' density="{density!r}" viscosity="{viscosity!r}" wind="{_text(wind)}"'
    return made + (' actuatorgroupdisable="1"' if any(one.is_disabled for one in tree.actuators) else "")


def forces(joint: Joint) -> str:
    """The attributes that state a joint's damper and spring."""
    stated = {"damping": joint.damping, "stiffness": joint.stiffness, "springref": joint.rest}
    made = "".join(f' {name}="{value!r}"' for name, value in stated.items() if value)
    limits = f' actuatorfrclimited="true" actuatorfrcrange="{_text(joint.force_limits)}"' if joint.force_limits else ""
    return made + limits


def limits(joint: Joint) -> str:
    """The attributes that state a joint's limits and dry friction."""
    made = f' limited="true" range="{_text(joint.limits)}"' if joint.limits else ""
    return made + (f' frictionloss="{joint.friction!r}"' if joint.friction else "")


def controls(tree: Tree) -> list[str]:
    """Statements that set actuators' controls and states; the control of a muscle without a state is its activation."""
    states = [one.activation.state for one in tree.actuators if one.activation]
    controls = [one.muscle.activation if one.muscle and not one.activation else one.control for one in tree.actuators]
    made = [f"d.ctrl[:] = {controls}"] if tree.actuators else []
    return [*made, f"states = {states}", "d.act[:] = states"] if states else made


def _equality(number: int, one: Constraint) -> str:
    first, second = (*one.ends, *one.ends)[:2]
    if one.kind == "weld" and second == End(
        second.link
    ):  # By bodies: the second's own frame is at a pose in the first.
        others = f' body2="{second.link}"' if second.link else ""
        w, x, y, z = quaternion_of(np.array(first.R))
        pose = f'relpose="{_text([*first.p, w, x, y, z])}"'
        scale = f' torquescale="{one.torque_scale!r}"' if one.torque_scale != 1.0 else ""
        return f'<weld body1="{first.link}"{others} {pose}{scale} {_HARD}/>'
    if one.by_bodies:
        bodies = "".join(f' body{k + 1}="{end.link}"' for k, end in enumerate(one.ends) if end.link)
        return f'<connect{bodies} anchor="{_text(one.ends[0].p)}" {_HARD}/>'
    if one.kind in ("point", "weld"):
        name = {"point": "connect", "weld": "weld"}[one.kind]
        return f'<{name} site1="s{number}_0" site2="s{number}_1" {_HARD}/>'
    if one.kind == "polynomial":
        driven, driver = (end.link for end in one.ends)
        coefficients = _text((*one.coefficients, *[0.0] * 5)[:5])
        return f'<joint joint1="{driven}" joint2="{driver}" polycoef="{coefficients}" {_HARD}/>'
    if _is_joint(one):
        ratio = -one.coefficients[1] / one.coefficients[0]
        driven, driver = (end.link for end in one.ends)
        return f'<joint joint1="{driven}" joint2="{driver}" polycoef="0 {ratio!r} 0 0 0" {_HARD}/>'
    return f'<tendon tendon1="t{number}" {_HARD}/>'


def quaternion_of(R: Array) -> tuple[float, float, float, float]:
    """Quaternion (w, x, y, z) of a rotation (3, 3), with w >= 0: of its four multiples, the longest."""
    (a, b, c), (d, e, f), (g, h, i) = np.asarray(R).tolist()
    multiples = np.array(
        [
            [1.0 + a + e + i, h - f, c - g, d - b],
            [h - f, 1.0 + a - e - i, b + d, c + g],
            [c - g, b + d, 1.0 - a + e - i, f + h],
            [d - b, c + g, f + h, 1.0 - a - e + i],
        ]
    )
    row = max(multiples, key=lambda one: float(one @ one))
    w, x, y, z = (row * math.copysign(1.0, row[0]) / math.sqrt(row @ row)).tolist()
    return w, x, y, z


def _is_joint(one: Constraint) -> bool:
    """Whether a coupling is one of MuJoCo's between two joints: one coordinate itself, and a multiple of another."""
    return one.kind == "coupling" and len(one.ends) == 2 and one.coefficients[0] == 1.0


def _tendon(number: int, one: Constraint) -> str:
    return (
        "" if one.kind in ("point", "weld", "polynomial") or _is_joint(one) else _line(f"t{number}", f"s{number}", one)
    )


def _line(name: str, sites: str, one: Constraint | Tendon, more: str = "") -> str:
    """A tendon, spatial over sites or fixed."""
    if one.kind == "path":
        wraps = (
            {wrap.after: _wrapped(f"w{sites[1:]}_{k}", wrap) for k, wrap in enumerate(one.wraps)}
            if isinstance(one, Tendon)
            else {}
        )
        via = ""
        for place in range(len(one.ends)):
            via += f'<site site="{sites}_{place}"/>'
            via += wraps.get(place, "")
        return f'<spatial name="{name}"{more}>{via}</spatial>'
    parts = zip(one.ends, one.coefficients, strict=True)
    inside = "".join(f'<joint joint="{end.link}" coef="{coefficient!r}"/>' for end, coefficient in parts)
    return f'<fixed name="{name}"{more}>{inside}</fixed>'


def spelling(tree: Tree) -> dict[str, str]:
    """Code of trees whose rows stand along no axes: sums and lengths."""
    if any(one.kind in ("point", "weld") for one in tree.constraints):
        return {}
    return {"axes() @ ": "", " @ axes().T": "", "np.linalg.solve(axes().T, d.efc_force)": "d.efc_force"}


def optional(tree: Tree) -> dict[str, tuple[str, ...]]:
    """Statements that define `axes`: what turns a tree's rows into the first frames' axes, block for block.

    Rows of angles stand there as they are, and are halves: MuJoCo's residual is the sine of half an angle, with the
    sign of the product of the frames' quaternions.
    """
    if not tree.constraints:
        return {}
    blocks, turns = [], []
    for number, one in enumerate(tree.constraints):
        turns += [f"{3 if one.kind in ('point', 'weld') else 1} * [1]"]
        way = f"sign('s{number}_0', 's{number}_1')"
        if one.kind == "weld" and one.ends[1] == End(
            one.ends[1].link
        ):  # The pose has a quaternion of its own, with w > 0.
            way += f" * np.sign(m.site('s{number}_0').quat[0])"
        turns += [f"3 * [{way}]"] * (one.kind == "weld")
        if one.kind in ("point", "weld"):
            blocks.append(f"d.site_xmat[m.site('s{number}_0').id].reshape(3, 3).T")
            blocks += [f"2 * {way} * np.eye(3)"] * (one.kind == "weld")
        else:
            blocks.append("np.eye(1)")
    lines: list[str] = []
    if any("sign" in block for block in blocks):
        lines += [
            "def turned(name):",
            "    site, quaternion = m.site(name), np.zeros(4)",
            "    mj.mju_mulQuat(quaternion, d.xquat[m.site_bodyid[site.id]], site.quat)",
            "    return quaternion",
            "def sign(a, b): return np.sign(turned(a) @ turned(b))",
        ]
    axes = (*lines, f"def axes(): return block_diag({', '.join(blocks)})", *_BLOCKS)
    return {"axes": axes, "ways_round": (f"def ways_round(): return np.array({' + '.join(turns)})",)}


_BLOCKS = (
    "def block_diag(*parts):",
    "    n, at = sum(map(len, parts)), 0",
    "    R = np.zeros((n, n))",
    "    for part in parts:",
    "        R[at:at + len(part), at:at + len(part)], at = part, at + len(part)",
    "    return R",
)
# Without stiffness and damping the reference acceleration is what the state alone makes of it.
_SET = "m.eq_solref[:] = 0.0\nm.opt.jacobian, m.opt.tolerance = mj.mjtJacobian.mjJAC_DENSE, 0.0\n"
_AT = f"{_SET}d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau\nmj.mj_forward(m, d)\n"
_J = "J = d.efc_J.reshape(-1, m.nv)\n"

# At given accelerations the forces of soft constraints are far from those that keep them, and known: what holds a link
# does all but what they do there. w: force, and moment if any, at the first frame and along its axes.
BOUND = """from copy import copy
n = copy(m)
n.eq_solimp[:, :2] = 0.5
d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, 0.0
mj.mj_forward(n, d)
d.qacc[:] = a
mj.mj_inverse(n, d)
forces = d.efc_force
given, value = np.linalg.solve(axes().T, forces), []
def carries(top, body): return body == top or (body > 0 and carries(top, m.body_parentid[body]))
for k in sensed:
    own, total = m.site(f'o{k}').id, np.zeros(6)
    for c in range(m.neq):
        first, second = (m.site(f's{c}_{end}').id for end in (0, 1))
        R = d.site_xmat[first].reshape(3, 3)
        w = np.r_[np.split(given, m.neq)[c], np.zeros(3)][:6]
        force, moment, arm = R @ w[:3], R @ w[3:], d.site_xpos[first] - d.site_xpos[own]
        for site, way in ((first, 1), (second, -1)):
            if carries(m.site_bodyid[own], m.site_bodyid[site]):
                total += way * np.r_[force, moment + np.cross(arm, force)]
    R = d.site_xmat[own].reshape(3, 3).T
    value.append(np.r_[data('force', k) + R @ total[:3], data('torque', k) + R @ total[3:]])"""

# Constraints are springs by design (MuJoCo's documentation, "Constraint model"): at the largest impedance a regulariser
# of 1e-4 of the inertia that a row sees, by an estimate at the reference configuration, stands beside J M^-1 J^T.
SOFT = 1e-2
# Far from there the inertia that a row sees is a fraction of the estimate, and forces between redundant rows take the
# weakest direction of J M^-1 J^T, down to a twentieth of its diagonal: 1e-4 becomes some hundredths.
SOFT_FORCES = 5e-2
# What is left of loops that are closed but for roundings, times the stiffness of constraints and the step.
_AT_REST = 1e-9

WAYS = ways_of(f"""
== constraint_jacobian | efc_J | {_AT}{_J}value = axes() @ J
== constraint_velocity_products | -efc_aref | {_AT}value = -axes() @ d.efc_aref
== constraint_residuals | efc_pos | {_AT.replace("= q, v", "= q2, v")}value = d.efc_pos * ways_round()
== constraint_residual_products | -efc_aref | {_AT.replace("= q, v", "= q2, v")}value = -d.efc_aref * ways_round()
== constraint_points | eq_data | value = m.eq_data[:, :6]
== wrench_sensors:bound | mj_inverse with constraints, force, torque | {BOUND}
== step_at_rest ~ {_AT_REST} | mj_step
from copy import copy
n = copy(m)
n.opt.gravity[:], n.opt.timestep = 0.0, {STEP}
d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, 0.0, 0.0
mj.mj_step(n, d)
value = np.r_[d.qpos, d.qvel]
== # Of a row of rotation that of the angular velocity, though the row is of half of it.
== constraint_diagonal | efc_diagApprox, efc_diagA
{_AT}value = d.efc_diagApprox if hasattr(d, 'efc_diagApprox') else d.efc_diagA
== delassus | mj_solveM with efc_J
{_AT}{_J}X = np.zeros_like(J)
mj.mj_solveM(m, d, X, J)
value = axes() @ J @ X.T @ axes().T
== constrained_acceleration ~ {SOFT} | mj_forward: qacc | {_AT}value = d.qacc
== constraint_forces ~ {SOFT_FORCES} | mj_forward: efc_force | {_AT}value = np.linalg.solve(axes().T, d.efc_force)
""")
