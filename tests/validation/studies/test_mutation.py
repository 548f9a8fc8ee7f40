"""The harness fails when it should: planted faults are caught, and a weak harness is seen to miss them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import reference_models
import symofros as sf
from validation.contract import quantities
from validation.studies import mutation
from validation.studies.faults import FaultSimulator, faults_at
from validation.studies.mutation import mutate


@pytest.mark.parametrize("name", ["double_pendulum", "space_arm"])
def test_every_fault_that_matters_is_caught(name: str) -> None:
    score = mutate(name, reference_models.MODELS[name], 250)
    assert sum(score.planted.values()) == 250
    assert score.ok, score.survivors
    assert sum(score.caught.values()) > 200


def test_a_lenient_harness_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """With a tolerance of one percent, constants that are off by 1e-6 pass; the score must say so."""
    for name, quantity in list(quantities.QUANTITIES.items()):
        monkeypatch.setitem(mutation.QUANTITIES, name, replace(quantity, tolerance=1e-2))
    score = mutate("double_pendulum", reference_models.MODELS["double_pendulum"], 400)
    assert score.too_small["constant perturbed"] > 0 and score.largest_small > 1e-9


def test_a_blind_reference_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """A comparison that always agrees catches nothing, and every fault that matters survives."""
    seen: list[int] = []
    honest = mutation._Harness._against

    def blind(self: mutation._Harness, fault: object, references: object) -> tuple[float, bool]:
        seen.append(1)
        # Called twice for a fault that was not caught: against the engine, then against the sound program.
        return (0.0, True) if len(seen) % 2 else honest(self, fault, references)  # type: ignore[arg-type]

    monkeypatch.setattr(mutation._Harness, "_against", blind)
    score = mutate("pendulum", reference_models.MODELS["pendulum"], 40)
    assert not score.ok and len(score.survivors) > 30 and score.caught.total() == 0


def test_an_incremental_evaluation_equals_a_full_one() -> None:
    program = sf.program_of(reference_models.MODELS["double_pendulum"], ("mass_matrix", "bias"))
    rng = np.random.default_rng(0)
    n = 4
    inputs = {name: rng.standard_normal((n, size)) for name, size in program.sizes.items()}
    simulator = FaultSimulator(program, inputs)
    node = simulator.nodes[len(simulator.nodes) // 2]
    for fault in faults_at(program.graph, node, program.sizes, rng):
        whole = FaultSimulator(simulator.mutant(fault), inputs)
        touched, outputs = simulator.affected(fault)
        for function in program.functions:
            expected = whole.outputs(function)
            found = outputs(function)
            assert all(np.array_equal(a, b) for a, b in zip(found, expected, strict=True)), fault
            sound = simulator.outputs(function)
            if function not in touched:
                assert all(np.array_equal(a, b) for a, b in zip(sound, expected, strict=True)), fault
