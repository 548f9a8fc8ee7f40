"""The plug-in that pytest loads where this package is installed: options, and nothing heavy until one is given.

pytest --symofros-model robot.urdf                       # your robot by every engine that can represent it
pytest --symofros-model robot.urdf --symofros-engine mujoco --symofros-tier smoke
pytest --symofros-model robot.urdf --symofros-baseline stored/check.json
"""

from __future__ import annotations

from typing import Any

import pytest

from symofros.commands.reading_options import OPTIONS
from symofros.errors import SymofrosError
from symofros.harness import harness_module

TIERS = ("smoke", "standard", "full")


def pytest_addoption(parser: Any) -> None:
    """The options."""
    group = parser.getgroup("symofros", "cross-checks of multibody models and engines (symofros)")
    group.addoption(
        "--symofros-model",
        action="append",
        metavar="MODEL",
        help="check this model: a URDF, MJCF, SDF, USD or YAML file, or a name of the standard set; repeatable",
    )
    group.addoption(
        "--symofros-engine",
        action="append",
        metavar="ENGINE",
        help="only by this engine; repeatable. Without models: the standard set, as large as the tier; an engine of "
        "a plug-in (entry point symofros.engines) is held to the truth on each kind of joint that it has",
    )
    group.addoption("--symofros-tier", choices=TIERS, default="standard", help="how much is checked (standard)")
    for item in OPTIONS:
        stated: dict[str, Any] = {"default": item.default}
        if item.default == ():
            stated = {"action": "append", "default": []}
        if item.default is False:
            stated = {"action": "store_true"}
        else:
            stated["metavar"] = item.metadata["metavar"]
        group.addoption(f"--symofros-{item.metadata['flag']}", help=item.metadata["help"], **stated)
    group.addoption(
        "--symofros-baseline",
        metavar="FILE",
        help="a check.json of before: fail where a cell is less accurate, or slower if it holds speeds",
    )


def pytest_configure(config: Any) -> None:
    """Markers of the tiers: `-m "not symofros"` leaves all of these tests out."""
    config.addinivalue_line("markers", "symofros: a cross-check by SYMOFROS")
    for tier in TIERS:
        config.addinivalue_line("markers", f"symofros_{tier}: a cross-check that is part of the {tier} tier")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(session: Any, config: Any, items: list[Any]) -> None:
    """Add the cross-checks that are asked for; -k and -m choose among them as among other tests."""
    if config.getoption("--symofros-model") or config.getoption("--symofros-engine"):
        try:
            checks = harness_module("ci.items").cross_checks
        except SymofrosError as error:
            raise pytest.UsageError(str(error)) from None
        items += checks(session, config)


def pytest_unconfigure(config: Any) -> None:
    """End the processes that engines ran in."""
    if config.getoption("--symofros-engine", None):
        harness_module("ci.items").finish()
