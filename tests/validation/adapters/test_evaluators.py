"""Ways to evaluate one program: state by state, by vectors, by the interpreter."""

from __future__ import annotations

import numpy as np
import pytest

from reference_models import MODELS
from symofros.generator import programs
from symofros.runtime.calls.kernel import SHARED_PARAMETERS
from validation.adapters import compiled, interpreted, vectors
from validation.contract.interface import States, Subject

SUBJECT = Subject("double_pendulum", MODELS["double_pendulum"], ("tip",))


def test_all_routes_share_one_program(monkeypatch: pytest.MonkeyPatch) -> None:
    formed = []
    form = programs.form_program

    def counted(*given: object) -> object:
        formed.append(given)
        return form(*given)  # type: ignore[arg-type]

    monkeypatch.setattr(programs, "form_program", counted)
    monkeypatch.setattr(compiled, "_LATEST", type(compiled._LATEST)(maxlen=4))
    subject = Subject("double_pendulum", MODELS["double_pendulum"], ("tip",))
    interpreted.build(subject)
    once = len(formed)
    compiled.build(subject)
    vectors.build(subject)
    assert len(formed) == once > 0


@pytest.mark.parametrize("n", [5, 700])
def test_vectors_are_used_for_any_number_of_states(n: int) -> None:
    rng = np.random.default_rng(n)
    q, v, a, u = (rng.standard_normal((n, 2)) for _ in range(4))
    states = States(q, v, a, u, 0 * u, 0 * u)
    by_states, by_vectors = compiled.build(SUBJECT), vectors.build(SUBJECT)
    for name in vectors.FUNCTIONS:
        kernel = by_vectors.model._kernels[name, ""]
        assert kernel.has(SHARED_PARAMETERS)  # type: ignore[attr-defined]
        ours, theirs = (getattr(one, name)(states) for one in (by_states, by_vectors))
        np.testing.assert_allclose(theirs, ours, rtol=1e-12, atol=1e-12)
