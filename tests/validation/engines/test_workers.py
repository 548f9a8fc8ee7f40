"""One worker for many jobs: what is left of one is never taken for an answer to the next."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.validation.engines.fakes import install
from validation.engines.matrix import SEED
from validation.engines.models.kinds import tree_of
from validation.engines.workers import Crashed, Job, Worker


@pytest.mark.parametrize("functions", (("mass_matrix",), ("mass_matrix", "gravity")))
def test_reading_only_the_first_answer_leaves_the_worker_usable(functions: tuple[str, ...]) -> None:
    job = Job("pinocchio", tree_of("revolute x"), functions, SEED)
    with Worker() as worker:
        answers = [next(iter(worker.ask(job))).value for _ in range(3)]
    assert not any(isinstance(answer, Crashed) for answer in answers)


def test_an_engine_that_crashed_takes_the_process_of_the_others_along_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    tree = tree_of("revolute x")
    processes: list[int] = []
    with Worker() as worker:
        for engine in ("dying", "pinocchio", "dying", "pinocchio"):
            (answer,) = worker.ask(Job(engine, tree, ("mass_matrix",)))
            assert isinstance(answer.value, Crashed) == (engine == "dying")
            processes += worker.call(("os", "getpid"))
    assert len(set(processes)) == 1


def test_jax_keeps_what_it_compiles_for_the_next_process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path))
    with Worker() as worker:
        said = [next(worker.call(("os", "getenv"), name)) for name in ("JAX_COMPILATION_CACHE_DIR", "SYMOFROS_CACHE")]
    assert said == [str(tmp_path / "compiled"), str(tmp_path)] and Path(said[0]).is_dir()
