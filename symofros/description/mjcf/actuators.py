"""Actuators of a compiled MJCF model: inputs, and the forces that they make by formula.

With the gear r of a hinge or slide, length l = r q and velocity l' = r v, the control c within its range, MuJoCo has

    force = gain c + bias,    gain = g0 + g1 l + g2 l',    bias = b0 + b1 l + b2 l',    effort = r force,

with force and the sum of a joint's efforts within their ranges. On a ball joint, a free joint or a site the gear is the
direction of a moment or wrench; the length there is no formula of coordinates, so only what does without it is read.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from symofros.base.names import speed_column, symbol_of
from symofros.description.forces import Load
from symofros.description.mjcf.joints import BALL, FREE, JointEfforts
from symofros.description.mjcf.names import Names
from symofros.description.remarks import Remarks
from symofros.description.system import Input
from symofros.description.values import Term, Value
from symofros.expr.expression import Expression

# mjtTrn, mjtGain, mjtBias and mjtDisableBit of mujoco/mjmodel.h, which never change.
_ON_JOINT, _IN_PARENT, _ON_SITE = 0, 1, 4
_FIXED, _AFFINE = 0, 1
_UNCLAMPED, _NO_ACTUATION = 1 << 8, 1 << 11
_NO_RANGE = (-np.inf, np.inf)

Range = tuple[float, float]


class ActuatorReader:
    """Reads the actuators of a model.

    Args:
        model: An MjModel.
        joints: Names of the joints.
        sites: Names of the sites.
        remarks: Remarks on what is ignored.

    Attributes:
        inputs: An input for each actuator that is read, named like it.
        efforts: Efforts on joints.
        loads: Loads on bodies, by their index.
    """

    def __init__(self, model: Any, joints: Names, sites: Names, remarks: Remarks) -> None:
        self.model, self.joints, self.sites = model, joints, sites
        self.remarks = remarks
        self.inputs: list[Input] = []
        self.loads: dict[int, tuple[Load, ...]] = {}
        self._efforts: dict[int, list[Term]] = {}
        self._driven: set[int] = set()
        self._joint_names = frozenset(joints[j] for j in range(model.njnt))
        self._names = self._input_names()
        for i in range(model.nu):
            self._read(i)
        if np.any(model.body_gravcomp):  # Together with the actuators' efforts MuJoCo bounds it, here it is a load.
            for j in np.flatnonzero(model.jnt_actgravcomp & model.jnt_actfrclimited).tolist():
                self.remarks.add("actuatorfrcrange does not bound the compensation of gravity", "joint", joints[j])
        self.efforts = {
            **{j: JointEfforts(actuated=True) for j in self._driven},
            **{j: JointEfforts(self._bounded(j, e), j in self._driven) for j, e in self._efforts.items()},
        }

    def _input_names(self) -> list[str]:
        """Names of the actuators; formulas must tell them from coordinates and speeds, so some get a suffix."""
        m = self.model
        suffixes = ("", ".px", ".py", ".pz", ".qx", ".qy", ".qz", ".qw", ".vx", ".vy", ".vz", ".wx", ".wy", ".wz")
        taken = {f"{rate}{joint}{suffix}" for joint in self._joint_names for suffix in suffixes for rate in ("", "d")}
        stated = [m.actuator(i).name for i in range(m.nu)]
        wanted = [f"{name}_control" if name in taken else name for name in stated]
        names = Names("actuator", wanted)
        return [names[i] if names[i] not in taken else names.fresh(f"{names[i]}_control") for i in range(m.nu)]

    def _read(self, i: int) -> None:
        m, name = self.model, self._names[i]
        target, place = int(m.actuator_trnid[i][0]), int(m.actuator_trntype[i])
        obstacle = self._obstacle(i, place, target)
        if obstacle:
            on_axis = place in (_ON_JOINT, _IN_PARENT) and m.jnt_type[target] not in (BALL, FREE)
            if on_axis:
                self._driven.add(target)
            instead = "an effort on the joint is the input instead" if on_axis else "ignored"
            self.remarks.add(f"actuators {obstacle}: {instead}", "actuator", name)
            return
        if np.any(m.actuator_armature[i]) or np.any(m.actuator_damping[i]) or np.any(m.actuator_dampingpoly[i]):
            self.remarks.add("armature and damping of actuators ignored", "actuator", name)
        self.inputs.append(Input(name))
        gear = [float(ratio) for ratio in m.actuator_gear[i]]
        if place == _ON_SITE:
            body, at = int(m.site_bodyid[target]), self.sites[target]
            self._push(body, self._force(i, [], []), (gear[:3], at, "body"), (gear[3:], at, "body"))
        elif m.jnt_type[target] == FREE:
            axes = "world" if place == _IN_PARENT else "body"
            force = self._force(i, [], [])
            self._push(int(m.jnt_bodyid[target]), force, (gear[:3], "body", "world"), (gear[3:], "body", axes))
        elif m.jnt_type[target] == BALL:
            speeds = [f"{self.joints[target]}.{suffix}" for suffix in ("wx", "wy", "wz")]
            self._drive(target, self._force(i, [], _dot(gear, speeds)), gear[:3])
        else:
            joint = self.joints[target]
            self._drive(
                target,
                self._force(i, _dot(gear, [joint]), _dot(gear, [speed_column(joint, self._joint_names)])),
                gear[:1],
            )

    def _obstacle(self, i: int, place: int, target: int) -> str:
        """Why an actuator can't be a formula of its control, as a clause for notes; "" if it can."""
        m = self.model
        if m.opt.disableflags & _NO_ACTUATION or m.opt.disableactuator & 1 << int(np.clip(m.actuator_group[i], 0, 30)):
            return "that are switched off"
        if np.any(m.actuator_dyntype[i]) or np.any(m.actuator_actnum[i]):
            return "with activation dynamics"
        if np.any(m.actuator_delay[i]) or m.actuator_gaintype[i] > _AFFINE or m.actuator_biastype[i] > _AFFINE:
            return "with muscles, motors, regulators or delays of MuJoCo's own"
        gain, bias = self._coefficients(i)
        if place == _ON_SITE:
            if m.actuator_trnid[i][1] >= 0:
                return "between two sites"
        elif place not in (_ON_JOINT, _IN_PARENT):
            return "that drive neither joints nor sites"
        elif m.jnt_type[target] == BALL and place == _IN_PARENT:
            return "along axes of a ball joint's parent"
        elif m.jnt_type[target] not in (BALL, FREE):
            return ""
        velocity = gain[2] or bias[2]
        if gain[1] or bias[1] or (velocity and (place == _ON_SITE or m.jnt_type[target] == FREE)):
            return "that follow a length or velocity of a free joint, ball joint or site"
        return ""

    def _coefficients(self, i: int) -> tuple[list[float], list[float]]:
        """Coefficients of 1, l and l' in the gain and in the bias."""
        m = self.model
        gain, bias = ([float(x) for x in values[i][:3]] for values in (m.actuator_gainprm, m.actuator_biasprm))
        return (gain if m.actuator_gaintype[i] == _AFFINE else [gain[0], 0.0, 0.0]), (
            bias if m.actuator_biastype[i] == _AFFINE else [0.0, 0.0, 0.0]
        )

    def _force(self, i: int, length: list[Term], velocity: list[Term]) -> Term:
        """Force of an actuator, by its input."""
        m = self.model
        limited = bool(m.actuator_ctrllimited[i]) and not m.opt.disableflags & _UNCLAMPED
        control = _clamped(_symbol(self._names[i]), m.actuator_ctrlrange[i] if limited else _NO_RANGE)
        gain, bias = (_sum(_affine(c, length, velocity)) for c in self._coefficients(i))
        force = _sum([_scaled(1.0, control, gain), bias])
        return _clamped(force, m.actuator_forcerange[i] if m.actuator_forcelimited[i] else _NO_RANGE)

    def _drive(self, joint: int, force: Term, gear: Sequence[float]) -> None:
        efforts = self._efforts.get(joint) or [Term(0.0)] * len(gear)
        self._efforts[joint] = [_sum([e, _scaled(r, force)]) for e, r in zip(efforts, gear, strict=True)]

    def _push(self, body: int, force: Term, *parts: tuple[Sequence[float], str, Any]) -> None:
        """Add the force and the moment of an actuator to the loads on a body; fixed bodies are skipped."""
        if self.model.body_treeid[body] < 0:
            return
        for kind, (direction, at, axes) in zip(("force", "torque"), parts, strict=True):
            if any(direction):
                x, y, z = (_scaled(ratio, force).value for ratio in direction)
                load = Load((x, y, z), at=at, axes=axes) if kind == "force" else Load((0, 0, 0), (x, y, z), at, axes)
                self.loads[body] = (*self.loads.get(body, ()), load)

    def _bounded(self, joint: int, efforts: list[Term]) -> tuple[Value, ...]:
        """Efforts of all actuators of a joint within the joint's own range."""
        m = self.model
        bounds = m.jnt_actfrcrange[joint] if m.jnt_actfrclimited[joint] else _NO_RANGE
        return tuple(_clamped(effort, bounds).value for effort in efforts)


def _symbol(name: str) -> Term:
    return Term(Expression("symbol", name=symbol_of(name)))


def _dot(ratios: Sequence[float], names: Sequence[str]) -> list[Term]:
    """The terms of the sum of ratio times symbol."""
    return [_scaled(ratio, _symbol(name)) for ratio, name in zip(ratios, names, strict=False) if ratio]


def _affine(coefficients: Sequence[float], length: list[Term], velocity: list[Term]) -> list[Term]:
    constant, of_length, of_velocity = coefficients
    parts = [(of_length, length), (of_velocity, velocity)]
    return [Term(constant), *(_scaled(c, _sum(terms)) for c, terms in parts if c)]


def _sum(terms: Sequence[Term]) -> Term:
    """The sum, without terms that are zero."""
    kept = [term for term in terms if term.value != 0.0]
    total = kept[0] if kept else Term(0.0)
    for term in kept[1:]:
        total = total + term
    return total


def _scaled(factor: float, *terms: Term) -> Term:
    """The product, without factors that are one."""
    if factor == 0.0 or any(term.value == 0.0 for term in terms):
        return Term(0.0)
    kept = [term for term in (Term(factor), *terms) if term.value != 1.0]
    product = kept[0] if kept else Term(1.0)
    for term in kept[1:]:
        product = product * term
    return product


def _clamped(term: Term, bounds: Any) -> Term:
    """A formula within a range; infinite bounds are none."""
    lower, upper = (float(bound) for bound in bounds)
    if lower > -np.inf:
        term = term.maximum(Term(lower))
    return term.minimum(Term(upper)) if upper < np.inf else term
