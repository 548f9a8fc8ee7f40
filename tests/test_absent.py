"""The closing line of a run: what was left out, and for which option or extra."""

from __future__ import annotations

import re
import sys
import tomllib

import pytest

from tests.absent import by_need, summary
from tests.docs.pages import ROOT
from tests.late import late, needs_extra, require


def test_skipped_tests_are_counted_by_requirement() -> None:
    slow, browser = "left out for its time; run with --slow", "needs Chromium; run with --browser"
    skipped = [("a", slow), ("b", slow), ("c", browser), ("d", needs_extra("jax", "jax")), ("e", "no /proc here")]
    needs = by_need(skipped)
    assert needs == {"--slow": ["a", "b"], "--browser": ["c"], "extra jax": ["d"], "": ["e"]}
    assert summary(needs) == "left out: 2 for --slow, 1 for --browser, 1 for extra jax, 1 that this machine can't run"
    assert summary({}) == ""


def test_files_that_are_skipped_by_each_worker_count_once() -> None:
    assert summary({"extra usd": ["tests/description/usd/test_usd.py"] * 2}) == "left out: 1 for extra usd"


def test_a_missing_package_skips_with_its_extra() -> None:
    with pytest.raises(pytest.skip.Exception, match="needs the extra 'network': the package no_such is not installed"):
        require("no_such", "network")


def test_extras_named_in_tests_are_defined_by_the_distribution() -> None:
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    asks = re.compile(r'(?<![\w.])(?:require|late)\("[\w.]+", "([\w-]+)"\)')
    named = {extra for path in (ROOT / "tests").rglob("*.py") for extra in asks.findall(path.read_text())}
    assert len(named) > 10 and named <= set(extras)


def test_attribute_queries_of_pytest_import_nothing() -> None:
    sys.modules.pop("nturl2path", None)
    module = late("nturl2path")
    assert not any(hasattr(module, name) for name in ("__test__", "__bases__", "__wrapped__", "_mock_name"))
    assert "nturl2path" not in sys.modules
    assert callable(module.pathname2url) and "nturl2path" in sys.modules
