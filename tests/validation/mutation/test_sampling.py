"""The draw is spread over all modules, and is the same again."""

from __future__ import annotations

from collections import Counter
from itertools import islice
from pathlib import Path

import pytest

from validation.mutation.fault import KINDS
from validation.mutation.sampling import drawn, modules

ROOT = Path(__file__).parents[3]


@pytest.mark.slow
def test_five_hundred_faults_reach_every_folder_and_every_kind() -> None:
    faults = list(islice(drawn(ROOT, 0), 500))
    assert len({fault.id for fault in faults}) == 500
    assert {fault.kind for fault in faults} == set(KINDS)
    folders = {module.rpartition("/")[0] for module in modules(ROOT)}
    assert {fault.module.rpartition("/")[0] for fault in faults} == folders
    assert max(Counter(fault.module for fault in faults).values()) < 15
