"""What kernels are measured by, on the driver whose processor is the host."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from symofros.runtime.cuda import figures
from symofros.runtime.cuda.cuda_model import CudaModel
from symofros.runtime.cuda.driver import Driver


@pytest.mark.parametrize("most", [1, 5000])
def test_a_measured_batch_is_whole_copies_of_the_different_states(
    device: Driver, on_device: CudaModel, most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As many as a batch may hold, one copy at least; the same batch as often as the time is divided by, and before."""
    given: list[dict[str, Any]] = []
    evaluate = CudaModel.evaluate

    def watched(model: CudaModel, *names: str, **arrays: Any) -> Any:
        given.append(arrays)
        return evaluate(model, *names, **arrays)

    monkeypatch.setattr(figures, "_STATES", most)
    monkeypatch.setattr(CudaModel, "evaluate", watched)
    assert 0.0 < figures.states_per_second(on_device, "dynamics", "", device) < np.inf
    assert len(given) == 1 + figures._STARTED * figures._REPEATS
    assert all(arrays["q"] is given[0]["q"] for arrays in given)
    q, count = given[0]["q"].numpy(), max(1, most // figures._DIFFERENT) * figures._DIFFERENT
    assert q.shape == given[0]["v"].shape == (count, 2)
    assert len(np.unique(q, axis=0)) == figures._DIFFERENT
    assert given[0]["out"]["M"].shape == (count, 2, 2)
