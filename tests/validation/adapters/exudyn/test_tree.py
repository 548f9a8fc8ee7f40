"""Exudyn's kinematic trees and bodies with Euler parameters: engine against engine, to rounding."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import reference_models
import symofros as sf
from tests.validation.subjects import UNIT, every_kind, floating_arm, states_of, tree
from validation.adapters.charted import ChartedEngine
from validation.adapters.exudyn import tree as exudyn
from validation.adapters.exudyn.mapped import MappedEngine
from validation.adapters.pinocchio import tree as pinocchio
from validation.comparison.errors import compute, state_errors, typical_scales
from validation.contract.interface import Subject, Unsupported
from validation.contract.quantities import QUANTITIES, TREE_QUANTITIES

OFFERED = TREE_QUANTITIES - {"frame_jacobian_rate"}


def chain() -> Subject:
    """Hinges and slides about oblique axes, inertia in joint space, a frame on the base."""
    joints = [
        sf.Joint("a", "revolute", "base", None, (0.1, 0.2, 0.3), sf.Rotation.rpy(0.3, -0.2, 0.5), (1, 2, 2)),
        sf.Joint("b", "prismatic", "one", None, (0.3, 0, 0.1), sf.Rotation.rpy(1.0, 0.4, 0), (0, 3, 4), armature=0.3),
        sf.Joint("c", "universal", "two", "end", axis=(1, 0, 0), axis2=(0, 0, -1), armature=0.2),
    ]
    ends = (sf.Frame("end", (0.1, 0.2, -0.3), sf.Rotation.rpy(0.1, 0.2, 0.3)),)
    moving = [sf.RigidBody(n, j, UNIT, ends) for n, j in zip(("one", "two", "three"), joints, strict=True)]
    base = sf.RigidBody("base", frames=(sf.Frame("mount", (1, 2, 3), sf.Rotation.rpy(0.4, 0, 0)),))
    system = sf.System("chain", [base, *moving], gravity=(1.0, 2.0, -9.0))
    return Subject("chain", system, ("three.end", "mount", "one.end"))


def errors(subject: Subject, ours: Any, theirs: Any) -> dict[str, float]:
    states = states_of(subject)
    scales = typical_scales(theirs, states)
    both = OFFERED & theirs.capabilities
    values = {name: [compute(one, QUANTITIES[name], states) for one in (ours, theirs)] for name in both}
    return {name: float(state_errors(QUANTITIES[name], *pair, scales).max()) for name, pair in values.items()}


@pytest.mark.parametrize("subject", [every_kind(), chain(), *(tree(seed) for seed in range(6))], ids=lambda s: s.label)
def test_exudyn_agrees_with_pinocchio(subject: Subject) -> None:
    ours, theirs = exudyn.build(subject), pinocchio.build(subject)
    assert not isinstance(ours, Unsupported) and not isinstance(theirs, Unsupported)
    assert ours.capabilities == OFFERED
    for name, error in errors(subject, ours, theirs).items():
        assert error <= QUANTITIES[name].tolerance, name


def test_trees_of_hinges_and_slides_go_through_its_own_recursions() -> None:
    assert isinstance(exudyn.build(chain()), ChartedEngine)
    assert isinstance(exudyn.build(floating_arm()), MappedEngine)


def test_beams_are_left_to_finite_elements() -> None:
    built = exudyn.build(Subject("spinning", reference_models.MODELS["spinning_beam"]))
    assert isinstance(built, Unsupported) and "beam" in built.reason


def test_frames_on_the_base_rest() -> None:
    subject = chain()
    engine = exudyn.build(subject)
    assert isinstance(engine, ChartedEngine)
    assert not np.any(engine.frame_acceleration(states_of(subject))[:, 1])
