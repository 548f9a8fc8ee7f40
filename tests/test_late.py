"""Modules that tests load late."""

from __future__ import annotations

import sys

from tests.late import late


def test_what_pytest_asks_of_every_name_imports_nothing() -> None:
    sys.modules.pop("nturl2path", None)
    module = late("nturl2path")
    assert not any(hasattr(module, name) for name in ("__test__", "__bases__", "__wrapped__", "_mock_name"))
    assert "nturl2path" not in sys.modules
    assert callable(module.pathname2url) and "nturl2path" in sys.modules
