"""One worker for many jobs: what is left of one is never taken for an answer to the next."""

from __future__ import annotations

import pytest

from validation.engines.matrix import SEED
from validation.engines.models.kinds import tree_of
from validation.engines.workers import Crashed, Job, Worker


@pytest.mark.parametrize("functions", (("mass_matrix",), ("mass_matrix", "gravity")))
def test_reading_only_the_first_answer_leaves_the_worker_usable(functions: tuple[str, ...]) -> None:
    job = Job("pinocchio", tree_of("revolute x"), functions, SEED)
    with Worker() as worker:
        answers = [next(iter(worker.ask(job))).value for _ in range(3)]
    assert not any(isinstance(answer, Crashed) for answer in answers)
