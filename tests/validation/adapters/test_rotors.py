"""Engines that know no rotors get them from a second model; and a wrong rotor is found out."""

from __future__ import annotations

from dataclasses import replace

import pytest

import symofros as sf
from reference_models.rigid.random_tree import random_tree
from tests.models import sampled
from tests.validation.subjects import subject_of
from validation.checking import Settings, check

FEW = Settings(states=20, engines=("pinocchio", "mujoco"))


def verdicts(system: sf.System) -> dict[tuple[str, str], str]:
    return {(row.engine, row.quantity): row.status for row in check(subject_of(system), FEW).comparisons}


def with_rotors(seed: int) -> sf.System:
    """A random tree with rotors: on a parent and its joint's axis, on the own link, on a far body, two on one joint."""
    tree = random_tree(300 + seed, n=7, kinds=("revolute", "prismatic", "ball", "revolute", "free"))
    driving = [body for body in tree.bodies if body.joint and body.joint.kind == "revolute"]
    wheels = [
        (sf.Rotor(0.02, 11.0),),
        (sf.Rotor(0.01, -7.0, (1, 2, 0), driving[-1].name), sf.Rotor(0.03, 5.0)),
        (sf.Rotor(0.02, 13.0, (0, 1, 1), driving[0].name),),
    ]
    pairs = zip(driving, wheels, strict=False)
    return tree.with_bodies(*(replace(body, joint=replace(body.joint, rotors=driven)) for body, driven in pairs))


@pytest.mark.parametrize("seed", sampled(range(4), [0]))
def test_engines_agree_on_rotors(seed: int) -> None:
    found = verdicts(with_rotors(seed))
    for engine in FEW.engines:
        for quantity in ("mass_matrix", "bias", "kinetic_energy", "inverse_dynamics", "forward_dynamics"):
            assert found[engine, quantity] == "agree", (engine, quantity)
    assert "disagree" not in found.values()
