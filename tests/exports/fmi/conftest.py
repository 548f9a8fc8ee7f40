"""Units of models, made once, and instances of them."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.exports.cases import STARTS, STEP
from tests.exports.fmi.units import Unit, exported, system_called


@pytest.fixture(scope="session")
def made(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """(name, version) -> path; each made once."""
    known: dict[tuple[str, int], Path] = {}

    def make(name: str, version: int) -> Path:
        if (name, version) not in known:
            folder = tmp_path_factory.mktemp("fmu") / "out"
            stated: dict[str, Any] = {"limp": {"method": "dopri5"}, "column": {}}
            options = {"start": STARTS.get(name)} | stated.get(name, {"dt": STEP.get(name, 1e-3)})
            quick = (name, version) != ("four_bar", 3)
            known[name, version] = exported(system_called(name), version, folder, quick, **options)
        return known[name, version]

    return make


@pytest.fixture(params=[2, 3])
def version(request: pytest.FixtureRequest) -> int:
    return request.param


@pytest.fixture
def unit(made: Any, version: int, tmp_path: Path) -> Iterator[Any]:
    units = []

    def make(name: str, cosim: bool) -> Unit:
        units.append(Unit(made(name, version), version, cosim, tmp_path / str(len(units))))
        return units[-1]

    yield make
    for one in units:
        one.fmu.freeInstance()
        shutil.rmtree(tmp_path, ignore_errors=True)
