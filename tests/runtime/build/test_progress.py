"""Whoever waits for a function that is generated at its first call is told so; a known one is silent."""

from __future__ import annotations

import io
import logging
import sys
import time
from pathlib import Path

import pytest

import symofros as sf
from reference_models.rigid.random_tree import random_tree
from symofros.runtime.build import progress
from symofros.runtime.build.progress import Progress


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


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_terminal_is_told_what_takes_long_and_wiped_clean(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr(progress, "PATIENCE", 0.01)
    with pytest.raises(ZeroDivisionError), Progress("arm", "residual_derivatives") as shown:
        shown.begin("generating")
        while not terminal.getvalue():
            time.sleep(0.005)
        raise ZeroDivisionError
    lines = terminal.getvalue().split("\r")
    assert lines[1] == "symofros: arm: residual_derivatives: generating, 0 s"
    assert lines[-2].strip() == lines[-1] == ""


def test_what_is_quick_leaves_a_terminal_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    with Progress("arm", "bias") as shown:
        shown.begin("generating")
    assert terminal.getvalue() == ""
