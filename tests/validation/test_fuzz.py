"""A short run of the fuzz campaign, and that it sees what it looks for."""

from __future__ import annotations

import pytest

import symofros as sf
from validation.studies import fuzz


def test_no_input_crashes_or_hangs_the_readers() -> None:
    result = fuzz.fuzz(1500, seed=7)
    assert not result.faults, result.faults[0]
    # Both answers occur for both readers: the inputs are neither all sound nor all rubbish.
    assert {"file read", "file refused", "formula read", "formula refused"} == set(result.answers)


def test_a_crash_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    def crash(path: object) -> sf.System:
        raise RecursionError("deep")

    monkeypatch.setattr(sf, "load", crash)
    result = fuzz.fuzz(20, seed=0)
    assert len(result.faults) == 2 and "RecursionError" in result.faults[0][0]
