"""The order in which questions are asked where not all are."""

from __future__ import annotations

import pytest

from validation.engines import asking
from validation.engines.models.covering.edits import BETWEEN
from validation.engines.models.files.readers import Reading


def test_who_stops_early_has_asked_of_all_files_with_one_feature(monkeypatch: pytest.MonkeyPatch) -> None:
    lots = asking.lots()
    monkeypatch.setattr(asking, "lots", lambda: lots)
    order, questions = list(asking.in_turn()), asking.questions()
    assert sorted(order) == sorted(questions)
    files = [name for name in order if isinstance(questions[name], Reading)]
    last = max(order.index(name) for name in files if BETWEEN not in name)
    assert sum(BETWEEN in name for name in order[:last]) < len(files) / 12
    (chains,) = (lot for lot in lots if "chain 1:" in next(iter(lot)))
    assert len(chains.keys() & order[:last]) <= 12
    of_scenes = [name.partition(":")[0] for name in order if name.startswith("scene ")]
    assert of_scenes == [f"scene {1 + k}" for k in range(len(of_scenes))]
