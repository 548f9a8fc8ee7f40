"""Whoever waits for a function that is generated at its first call gets a message; a known one is silent."""

from __future__ import annotations

import logging
from pathlib import Path

import pytest

import symofros as sf
from reference_models.rigid.random_tree import random_tree


def test_generating_and_compiling_are_logged_and_known_functions_are_silent(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path))
    model = sf.compile(random_tree(31))
    caplog.set_level(logging.INFO, logger="symofros")
    model.mass_matrix(model.neutral())
    label = f"{model.record.name}: mass_matrix"
    messages = caplog.messages
    assert messages[:2] == [f"{label}: generating", f"{label}: compiling"]
    assert messages[2].startswith(f"{label}: done after ") and len(messages) == 3
    caplog.clear()
    again = sf.compile(random_tree(31))
    again.mass_matrix(again.neutral())
    assert not caplog.messages
