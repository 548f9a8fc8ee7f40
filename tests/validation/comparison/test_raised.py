"""An exception inside an adapter is a failed row with its words; the other engines go on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import pytest

from reference_models import MODELS
from validation.adapters import ROUTES, Missing
from validation.checking import Settings, check
from validation.comparison.errors import raised
from validation.contract.interface import Engine, Subject
from validation.contract.raised import Raised, attempted
from validation.cross_check.record import Record, as_data
from validation.cross_check.report import compose

SETTINGS = Settings(states=8)
SUBJECT = Subject("double_pendulum", MODELS["double_pendulum"])


@dataclass(frozen=True)
class Raising:
    """An engine of which one method raises."""

    engine: Any
    method: str

    def __getattr__(self, name: str) -> Any:
        if name == self.method:
            return self._raise
        return getattr(self.engine, name)

    def _raise(self, *_: object) -> None:
        raise IndexError("index 9 is out of bounds")


def raising(engine: str, method: str) -> Any:
    def build(subject: Subject) -> Engine:
        factory = ROUTES[engine].load()
        assert not isinstance(factory, Missing)
        return Raising(factory(subject), method)  # type: ignore[return-value]

    return build


def broken(_: Subject) -> Engine:
    raise KeyError("no such joint")


@pytest.mark.parametrize("engine", ["pinocchio", "description", "interpreted"])
def test_an_adapter_that_cannot_build_is_one_failed_row(engine: str) -> None:
    found = check(SUBJECT, SETTINGS, {engine: broken})
    (row,) = [row for row in found.comparisons if row.engine == engine]
    assert (row.quantity, row.status) == ("all", "failed") and not found.ok
    assert row.note.startswith("raises KeyError: 'no such joint' (test_raised.py:")
    assert {"mujoco", "exudyn"} <= {one.engine for one in found.compared}


@pytest.mark.parametrize("quantity", ["mass_matrix", "frame_jacobian_rate", "kinetic_energy"])
def test_a_quantity_that_raises_is_one_failed_row_and_the_others_are_compared(quantity: str) -> None:
    found = check(SUBJECT, SETTINGS, {"pinocchio": raising("pinocchio", quantity)})
    rows = [row for row in found.comparisons if row.engine == "pinocchio"]
    failed = {row.quantity for row in rows if row.status == "failed"}
    assert failed == ({quantity, "motion_energy"} if quantity == "kinetic_energy" else {quantity})
    assert {row.status for row in rows} == {"failed", "agree"} and not found.ok
    data = as_data(SETTINGS, [found], 1.0, ())
    assert not data["ok"] and Record.of(data).rows("failed")
    report = compose(data)
    assert report.ok is False and not report.refused
    assert any("raises IndexError: index 9 is out of bounds" in line for line in report.missed)


def test_an_exception_in_our_model_is_our_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    from validation.adapters.compiled import SymofrosEngine

    def fault(*_: object) -> None:
        raise ValueError("ours")

    monkeypatch.setattr(SymofrosEngine, "frame_velocity", fault)
    found = check(SUBJECT, SETTINGS)
    rows = [row for row in found.comparisons if row.quantity == "frame_velocity"]
    assert {(row.engine, row.status) for row in rows} == {("symofros", "failed")} and not found.ok
    assert "pinocchio" in {row.engine for row in found.compared}


def test_words_are_one_line_and_an_interrupt_goes_through() -> None:
    def fault(error: BaseException) -> None:
        raise error

    said = attempted(fault, ValueError("two\nlines"))
    assert isinstance(said, Raised) and said.words.startswith("ValueError: two lines (test_raised.py:")
    assert isinstance(attempted(fault, SystemExit(3)), Raised)
    assert raised("m", "e", "q", said).note == f"raises {said.words}"
    with pytest.raises(KeyboardInterrupt):
        attempted(fault, KeyboardInterrupt())
