"""Engines that know no rotors get them from a second model; and a wrong rotor is found out."""

from __future__ import annotations

from dataclasses import replace

import pytest

import symofros as sf
from reference_models import MODELS
from reference_models.rigid.random_tree import random_tree
from tests.models import sampled
from tests.validation.subjects import subject_of
from validation.adapters import rotors
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


@pytest.mark.parametrize(
    ("change", "wrong"),
    [
        ({"ratio": 61.0}, {"mass_matrix", "bias", "kinetic_energy"}),
        ({"axis": (0.0, 1.0, 0.01), "carrier": "inner"}, {"mass_matrix", "bias", "kinetic_energy"}),
        ({"axis": (0.0, 1.0, 0.0), "carrier": "inner"}, set()),
    ],
    ids=["ratio", "axis", "same axis"],
)
def test_a_changed_rotor_is_detected(
    change: dict[str, object], wrong: set[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    stated = MODELS["gyroscope"]
    shaft = stated.body("shaft")
    assert shaft.joint is not None
    other = replace(shaft.joint, rotors=(replace(shaft.joint.rotors[0], **change),))  # type: ignore[arg-type]
    changed = stated.with_bodies(replace(shaft, joint=other))
    honest = rotors.build
    monkeypatch.setattr(rotors, "build", lambda factory, subject: honest(factory, replace(subject, system=changed)))
    found = verdicts(stated)
    for engine in FEW.engines:
        judged = {quantity: status for (name, quantity), status in found.items() if name == engine}
        disagreeing = {quantity for quantity, status in judged.items() if status == "disagree"}
        assert wrong <= disagreeing and bool(wrong) == bool(disagreeing), (engine, disagreeing)
