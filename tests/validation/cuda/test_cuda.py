"""Kernels beside C, with a driver whose processor is the host; the report with and without a graphics processor."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import pytest

from symofros.runtime.cuda import cuda_model, figures
from symofros.runtime.cuda.driver import Driver
from symofros.runtime.cuda.nvrtc import KernelUsage
from tests.cuda_on_host import compile_on_host, host_driver
from validation.cuda import kernels, report, states, warp
from validation.cuda.record import PEER, KernelRow, Record, RolloutRow
from validation.cuda.states import Subject
from validation.reporting.command import Run
from validation.reporting.markdown import page
from validation.reporting.provenance import Provenance, stamp

USAGE = KernelUsage(registers=40, stack=16, spill_stores=8, spill_loads=24)


@pytest.fixture(scope="module")
def device(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Driver]:
    """A driver of the host, whose kernels are C++, and batches small enough for it."""
    made = host_driver(tmp_path_factory.mktemp("driver"))
    patch = pytest.MonkeyPatch()
    compile_on_host(patch, made, tmp_path_factory.mktemp("kernels"))
    patch.setattr(report, "present", lambda: made)
    patch.setattr(report, "copied", lambda _: 4e12)
    patch.setattr(report, "_STATES", 8)
    patch.setattr(cuda_model, "usage_of", lambda *_: _Everything())
    patch.setattr(kernels, "MOTIONS", 16)
    patch.setattr(kernels, "_REPEATS", 1)
    patch.setattr(figures, "_STATES", 16)
    patch.setattr(figures, "_DIFFERENT", 8)
    for module in (states, kernels):
        patch.setattr(module, "STEPS", 4)
    yield made
    patch.undo()


class _Everything(dict[str, KernelUsage]):
    def __missing__(self, key: str) -> KernelUsage:
        return USAGE


def test_kernels_and_rollouts_are_compared_with_c(device: Driver, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(warp, "missing", lambda: f"{PEER}: not here")
    monkeypatch.setattr(report, "MODELS", ("planar2R",))
    monkeypatch.setattr(report, "FUNCTIONS", ("dynamics", "forward_dynamics"))
    data = report.measure(Run(report.TOPIC, Path("nowhere")))
    assert data["ok"], data
    assert len(data["kernels"]) == 8 and len(data["rollouts"]) == 4
    for row in data["kernels"]:
        assert row["rate"] > 0.0 and row["spilled"] == 32
        assert 0.0 <= row["error"] < (1e-12 if row["precision"] == "double" else 1e-4)
    assert all(0.0 <= row["error"] < (1e-12 if row["precision"] == "double" else 1e-4) for row in data["rollouts"])
    text = shown(data)
    assert "8 kernels differ from C by at most" in text and "MuJoCo Warp: not here" in text


def test_kernel_results_that_differ_from_c_are_reported(device: Driver, monkeypatch: pytest.MonkeyPatch) -> None:
    """A planted fault: C's side gets other inputs."""
    subject = Subject.of("planar2R", 4)
    kernel = kernels.kernels_of(subject, ("bias",))[0]
    monkeypatch.setattr(Subject, "expected", lambda self, function: 1.001 * np.ones((4, 2)))
    row = kernels.row(kernel, USAGE, device)
    assert not row.right
    assert not Record(kernels=[row]).ok


def test_nan_results_are_wrong() -> None:
    assert not KernelRow("panda", "bias", "double", False, 1, 0, 0, 8, 1e9, math.nan).right
    assert not RolloutRow("panda", "step", "rk4", "single", 1e9, math.nan).right


def shown(data: Mapping[str, object]) -> str:
    data = json.loads(json.dumps({"seconds": 1.0, **stamp(), **data}))
    return page(report.TOPIC.compose(data), Provenance.of(data), "")
