import os
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.validation.subjects import URDF
from validation.checking import ModelResult, Settings
from validation.contract.interface import Subject
from validation.inputs.cases import Case
from validation.worker_pool import ONE_THREAD, longest_first, run, run_case

FEW = Settings(states=10, engines=("pinocchio",))


@dataclass(frozen=True)
class Dying(Case):
    def load(self) -> Subject:
        os._exit(9)


@dataclass(frozen=True)
class Faulty(Case):
    def load(self) -> Subject:
        raise ZeroDivisionError("a fault of ours")


def arm(tmp_path: Path) -> Case:
    path = tmp_path / "arm.urdf"
    path.write_text(URDF)
    return Case("arm", path)


def test_a_model_that_does_not_load_is_a_failed_row(tmp_path: Path) -> None:
    result = run_case(Case("nowhere", tmp_path / "nowhere.urdf"), FEW)
    (row,) = result.comparisons
    assert row.status == "failed" and row.quantity == "load" and "nowhere" in row.note and not result.ok
    assert str(tmp_path) not in row.note


def test_an_internal_fault_is_a_failed_row_with_its_place() -> None:
    (row,) = run_case(Faulty("bad"), FEW).comparisons
    assert row.status == "failed" and row.quantity == "check"
    assert row.note.startswith("ZeroDivisionError: a fault of ours (test_worker_pool.py:")


def test_large_models_and_those_of_many_procedures_come_first() -> None:
    labels = ("gyroscope", "pendulum", "mss")
    assert [case.label for case in longest_first([Case(label) for label in labels])] == ["pendulum", "mss", "gyroscope"]


@pytest.mark.parametrize("workers", [1, 2])
def test_a_bad_model_does_not_stop_the_others(tmp_path: Path, workers: int) -> None:
    results: dict[str, ModelResult] = {}
    cases = [arm(tmp_path), Faulty("bad"), *([Dying("dead")] if workers > 1 else [])]
    run(cases, FEW, workers, lambda result: results.update({result.label: result}))
    assert set(results) == {case.label for case in cases}
    assert results["arm"].ok and not results["bad"].ok
    if workers > 1:
        assert "ended with code 9" in results["dead"].comparisons[0].note


def test_an_interrupt_keeps_finished_results(tmp_path: Path) -> None:
    results: list[ModelResult] = []

    def done(result: ModelResult) -> None:
        results.append(result)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run([arm(tmp_path), Faulty("bad"), Faulty("worse")], FEW, 2, done)
    assert len(results) == 1


@dataclass(frozen=True)
class Telling(Case):
    def load(self) -> Subject:
        raise ZeroDivisionError(" ".join(os.environ[name] for name in ONE_THREAD))


def test_workers_have_one_thread_of_linear_algebra_unless_more_are_stated(monkeypatch: pytest.MonkeyPatch) -> None:
    """Threads of several workers wait for each other at full load; the variables count where NumPy is loaded later."""
    for name in ONE_THREAD:
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("MKL_NUM_THREADS", "3")
    notes: list[str] = []
    run([Telling("a"), Telling("b")], FEW, 2, lambda result: notes.append(result.comparisons[0].note))
    assert all(note.startswith("ZeroDivisionError: 1 1 3 ") for note in notes) and len(notes) == 2
    assert "OMP_NUM_THREADS" not in os.environ
