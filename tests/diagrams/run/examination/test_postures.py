"""Singular postures of interpreted runs: which rank counts as whole."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from symofros.diagrams.run.examination import postures


@pytest.mark.parametrize("count", [3, 40, 4000])
def test_the_rank_of_a_run_is_that_of_most_of_its_records(count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where it begins in a singular posture, too."""
    ranks: list[int] = []
    monkeypatch.setattr(postures, "prescribed_inputs", lambda *_: np.zeros((count, 0)))
    monkeypatch.setattr(postures, "nearest_to_singular", lambda model, moved, par, rank, between: ranks.append(rank))
    monkeypatch.setattr(postures, "near_singular_notes", lambda found: [])

    def evaluate(name: str, q: np.ndarray, **_: Any) -> tuple[np.ndarray]:
        assert name == "constraint_jacobian"
        return (np.array([np.diag([1.0, float(x > 0.0)]) for (x,) in q]),)

    place = SimpleNamespace(slice=slice(0, 1), start=0)
    record, model = SimpleNamespace(nc=2, driven=0), SimpleNamespace(evaluate=evaluate)
    models = SimpleNamespace(record=lambda _: record, constraints=lambda _: model)
    piece = SimpleNamespace(block=SimpleNamespace(mechanism=lambda: "m"))
    resolved = SimpleNamespace(wired=SimpleNamespace(models=models), pieces={"plant": piece})
    layout = SimpleNamespace(
        q={"plant": place}, v={"plant": place}, lock_inputs=(), kept=(), parameters_of=lambda *_: np.zeros(0)
    )
    q = np.linspace(0.0, 1.0, count)[:, np.newaxis]
    run: Any = SimpleNamespace(
        layout=layout, states=(q[:, 0], q, q), energies=SimpleNamespace(resolved=resolved, par=np.zeros(0))
    )
    assert not postures.posture_notes(run, lambda *_: None)  # type: ignore[arg-type]
    assert ranks == [2]
