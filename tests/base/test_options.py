"""Options that are accepted without effect say so; the others say nothing."""

from __future__ import annotations

import warnings
from typing import Any

import pytest

import symofros as sf


@pytest.mark.parametrize(("name", "value"), [("tune", True), ("processors", "any")])
def test_an_option_without_effect_warns_if_given(name: str, value: Any) -> None:
    with pytest.warns(FutureWarning, match=f"{name}={value!r}.* has no effect") as caught:
        sf.Options(**{name: value})
    assert caught[0].filename == __file__


def test_options_with_an_effect_do_not_warn() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sf.Options(tune=False, processors="native", packs=False)
