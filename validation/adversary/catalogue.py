"""The attacks by name."""

from __future__ import annotations

from .attack import Attack
from .attacks import (
    beam_runs,
    beam_statics,
    closed_dynamics,
    diagram_runs,
    engaging_runs,
    event_runs,
    held_apart,
    inverse_kinematics,
    loop_runs,
    overconstrained_runs,
    pushed_runs,
    rigid_trees,
    rolling_runs,
    step_sizes,
)

_MODULES = (
    rigid_trees,
    closed_dynamics,
    loop_runs,
    rolling_runs,
    step_sizes,
    diagram_runs,
    beam_statics,
    beam_runs,
    inverse_kinematics,
    event_runs,
    pushed_runs,
    overconstrained_runs,
    held_apart,
    engaging_runs,
)
ATTACKS: dict[str, Attack] = {module.ATTACK.name: module.ATTACK for module in _MODULES}
