"""The table of extras that are installed by themselves has all of them."""

from __future__ import annotations

import datetime
import runpy

from tests.docs.pages import ROOT

SCRIPT = runpy.run_path(str(ROOT / ".ci/extras.py"))


def test_each_extra_has_a_trial() -> None:
    assert set(SCRIPT["TRIALS"]) == set(SCRIPT["extras"]())


def test_each_small_extra_is_tried_on_some_day() -> None:
    first = datetime.date(2027, 1, 1)
    days = [SCRIPT["of_the_day"](first + datetime.timedelta(n)) for n in range(60)]
    assert set(days) == set(SCRIPT["extras"]()) - set(SCRIPT["LARGE"])
