"""Our models of one subject: which are compiled as users get them."""

from __future__ import annotations

from dataclasses import replace

import pytest

import symofros as sf
from reference_models import MODELS
from symofros import tools
from validation.adapters import compiled
from validation.comparison.variants import ModelVariants
from validation.contract.interface import Subject
from validation.inputs.sampling import sample
from validation.mechanics.assembly import assemble


def test_the_description_as_it_stands_is_optimised_and_its_variants_are_not(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: dict[bool, tuple[str, ...] | None] = {}
    system = MODELS["spinning_beam"]
    (beam,) = system.bodies
    system = replace(system, bodies=(replace(beam, retain="first_order"),))

    class Noted(tools.Evaluators):
        def __init__(self, given: sf.System, options: sf.Options) -> None:
            asked[given == system] = options.flags
            super().__init__(given, options)

    monkeypatch.setattr(compiled, "Evaluators", Noted)
    subject, assembly = Subject("beam", system), assemble(system)
    model = compiled.build(subject)
    variants = ModelVariants(subject, assembly, model, sample(assembly, model.model.nu, 2, 0, 0))
    assert variants.untruncated is not model
    assert asked == {True: None, False: compiled.UNOPTIMISED}
    assert "-O0" in compiled.UNOPTIMISED and "-march=native" in compiled.UNOPTIMISED
